"""Draws pictures of docs/joints.md and docs/game: ``python tools/gallery.py [name ...]``; needs the extra `render`."""

import importlib
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from osgode.examples import runner

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
SIZE = (800, 450)
EXAMPLES = (
    "mobile",
    "door",
    "gate",
    "cardan",
    "suspension",
    "bridge",
    "waiter",
    "engine",
    "galton",
    "tensegrity",
    "locomotive",
    "gears",
    "springs",
    "arm",
    "player",
    "pendulums",
    "shuttle",
    "guns",
    "rocket",
    "flail",
)


def draw(name: str) -> None:
    """The example at the first of its moments, as a picture of 256 colours, which takes a third of the room."""
    kind = next(
        kind
        for kind in vars(importlib.import_module(f"osgode.examples.{name}")).values()
        if isinstance(kind, type) and issubclass(kind, runner.Example) and kind is not runner.Example
    )
    path = PICTURES / f"{name}.png"
    runner.run(kind, ["--picture", str(path), "--seconds", str(kind.MOMENTS[0])])
    full = Image.open(path).convert("RGB")
    full.quantize(palette=palette(full), dither=Image.Dither.FLOYDSTEINBERG).save(path, optimize=True)


def palette(picture: Image.Image) -> Image.Image:
    """256 colours, among them those of small things: a colour counts by the root of the room that it takes."""
    colours, counts = np.unique(np.asarray(picture).reshape(-1, 3) // 4, axis=0, return_counts=True)
    weighed = np.repeat(4 * colours + 2, np.ceil(np.sqrt(counts)).astype(int), axis=0).astype(np.uint8)
    return Image.fromarray(weighed[None]).quantize(256)


if __name__ == "__main__":
    runner.SIZE = SIZE
    for each in sys.argv[1:] or EXAMPLES:
        draw(each)
