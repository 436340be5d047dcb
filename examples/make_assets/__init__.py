"""Makes everything in examples/assets again: ``python -m osgode.examples.make_assets``, which needs Pillow.

The files are committed, so that nobody has to run this; a test compares them with what it makes.
"""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from osgode.examples.make_assets.house import house
from osgode.examples.make_assets.hull import hull
from osgode.examples.make_assets.terrain import terrain
from osgode.examples.make_assets.textures import TEXTURES, to_bytes

ASSETS = Path(__file__).parent.parent / "assets"
"""Where the committed files are."""
MODELS = (house, hull, terrain)
"""Every model; the files are named after the functions."""


def make_assets(folder: Path) -> list[Path]:
    """Write all textures and models into ``folder`` and return the files' paths."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for name, texture in TEXTURES.items():
        made.append(folder / f"{name}.png")
        Image.fromarray(to_bytes(texture())).save(made[-1], optimize=True)
    for model in MODELS:
        made += [folder / f"{model.__name__}.obj", folder / f"{model.__name__}.mtl"]
        model().write(made[-2])
    return made
