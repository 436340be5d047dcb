"""How long it takes until osgode can be used: to import it, and to install it."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import venv
from pathlib import Path

from benchmarks.timing import ROOT, Spread, fresh, row, seconds

IMPORT_AIM = 0.4
INSTALL_AIM = 60.0
EXTRAS = ("trimesh", "moderngl", "pygame", "PIL", "imageio_ffmpeg")
"""What an import must not load."""


def run_import() -> None:
    """Print the time of a process that imports osgode, less that of one that does nothing."""
    print("Start (median and quartiles of 15 processes)")
    loaded = fresh(f"import json, osgode, sys; print(json.dumps([name for name in {EXTRAS} if name in sys.modules]))")
    if loaded:
        raise AssertionError(f"import osgode loads {loaded}")
    nothing = Spread.of([seconds(lambda: fresh("print(0)")) for _ in range(15)]).median
    numpy = Spread.of([seconds(lambda: fresh("import numpy; print(0)")) - nothing for _ in range(15)])
    time = Spread.of([seconds(lambda: fresh("import osgode; print(0)")) - nothing for _ in range(15)])
    text = f"{time.text()} s, {numpy.median:.3f} s of it numpy"
    row("import osgode", text, f"{IMPORT_AIM} s", good=time.median < IMPORT_AIM)


def run_install() -> None:
    """Print the time of ``pip install .`` in a copy of the checkout and an environment of its own."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],  # noqa: S607
        cwd=ROOT,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    ).stdout
    with tempfile.TemporaryDirectory() as folder:
        copy, environment = Path(folder, "copy"), Path(folder, "environment")
        for name in filter(None, listed.split("\0")):
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, copy / name, follow_symlinks=False)
        venv.create(environment, with_pip=True)
        command = [str(environment / "bin" / "python"), "-m", "pip", "install", "--quiet", "."]
        time = seconds(lambda: subprocess.run(command, cwd=copy, check=True))
        test = [str(environment / "bin" / "python"), "-c", "import osgode; osgode.World().step()"]
        subprocess.run(test, cwd=folder, check=True)
    row("pip install .", f"{time:.1f} s, downloads included", f"{INSTALL_AIM:g} s", good=time < INSTALL_AIM)
