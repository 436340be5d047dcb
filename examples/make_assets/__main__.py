"""``python -m osgode.examples.make_assets [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from osgode.examples.make_assets import ASSETS, make_assets

for path in make_assets(Path(sys.argv[1]) if len(sys.argv) > 1 else ASSETS):
    print(f"{path.stat().st_size:9,} {path.name}")
