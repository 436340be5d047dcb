"""Text as pixels: measuring and drawing strings with the font that comes with pygame."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from osgode.graph.appearance import Image
from osgode.render.extras import require

if TYPE_CHECKING:
    import pygame

LARGEST = 8192
"""Pixels of a side of a drawn text; larger pictures are refused by some graphics cards, and seen on no screen."""


@lru_cache(maxsize=32)
def _font(size: int) -> pygame.font.Font:
    pg = require("pygame")
    # Named by its path: asked for by name, pygame would shrink it.
    return pg.font.Font(str(Path(pg.__file__).parent / pg.font.get_default_font()), size)  # type: ignore[no-any-return]


def font(size: int) -> pygame.font.Font:
    """The font with an em of ``size`` pixels."""
    module = require("pygame.font")
    if not module.get_init():  # at the first use, or after somebody called pygame.quit
        _font.cache_clear()
        module.init()
    return _font(max(1, int(size)))


def _lines(text: str) -> list[str]:
    """The lines of a text, without the one character that pygame refuses."""
    return text.replace("\0", "").split("\n")


def measure_text(text: str, size: int = 18) -> tuple[int, int]:
    """The width and height in pixels that ``text`` takes, of one line or several.

    Needs no window and no graphics card.

    Raises:
        MissingExtraError: if pygame is not installed.
    """
    lines = _lines(text)
    face = font(size)
    return max(face.size(line)[0] for line in lines), face.get_linesize() * len(lines)


def rasterise(text: str, size: int) -> Image:
    """How opaque each pixel of ``text`` is: (height, width) bytes, first row at the top; cut off at `LARGEST`."""
    surfarray = require("pygame.surfarray")
    face = font(size)
    width, height = (min(side, LARGEST) for side in measure_text(text, size))
    result = np.zeros((max(height, 1), max(width, 1)), np.uint8)
    step = face.get_linesize()
    for number, line in enumerate(_lines(text)):
        if line and number * step < height:
            alpha = surfarray.array_alpha(face.render(line, True, (255, 255, 255))).T
            part = result[number * step :][: alpha.shape[0], : alpha.shape[1]]
            np.maximum(part, alpha[: part.shape[0], : part.shape[1]], out=part)
    return result
