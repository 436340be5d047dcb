"""docs/reference.md says what the field tables say."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SHOW = f"import runpy; print(runpy.run_path({str(ROOT / 'tools' / 'reference.py')!r})['page'](), end='')"


def test_reference_is_up_to_date():
    """In a process of its own, for the page lists the names of materials, and other tests make new ones known."""
    made = subprocess.run([sys.executable, "-c", SHOW], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert made == (ROOT / "docs" / "reference.md").read_text(), "run: python tools/reference.py"
