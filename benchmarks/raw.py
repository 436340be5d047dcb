"""The C program of ``benchmarks/c``: built, started and told what to do."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Self

import numpy as np

from benchmarks.scenes import Scene
from benchmarks.timing import ROOT, Times
from osgode.maths import FloatArray

SOURCE = ROOT / "benchmarks" / "c" / "raw.c"
PROGRAM = ROOT / "build" / "benchmarks" / "raw"
STATE_WIDTH = 13


def build() -> None:
    """Compile the program unless that is done; ``make bench`` has done it."""
    compiled(SOURCE)


def compiled(source: Path) -> Path:
    """The program of a C file, compiled unless that is done."""
    program = PROGRAM.with_name(source.stem)
    if not program.exists() or program.stat().st_mtime <= source.stat().st_mtime:
        program.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(["cc", "-O2", "-o", program, source, "-lode", "-lm"], check=True)  # noqa: S607
    return program


class Raw:
    """A scene in a process of plain C."""

    def __init__(self, scene: Scene) -> None:
        self.count = len(scene.bodies)
        self._process = subprocess.Popen([PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._say(scene.text())
        assert self._answer() == f"{self.count} bodies"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._process.communicate()

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def step(self, count: int) -> Times:
        """Do some steps; the time that they took, as the program measured it."""
        self._say(f"step {count}\n")
        clock, processor = self._answer().split()
        return Times(int(clock) / 1e9, int(processor) / 1e9)

    def state(self) -> FloatArray:
        """(n, 13): position, quaternion, linear and angular velocity of each body."""
        self._say("state\n")
        out = self._process.stdout
        assert out is not None
        return np.frombuffer(out.read(self.count * STATE_WIDTH * 8)).reshape(self.count, STATE_WIDTH)

    def _say(self, text: str) -> None:
        into = self._process.stdin
        assert into is not None
        into.write(text.encode())
        into.flush()

    def _answer(self) -> str:
        out = self._process.stdout
        assert out is not None
        return out.readline().decode().strip()
