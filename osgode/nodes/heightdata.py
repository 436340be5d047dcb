"""Heights to collide with."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError, MissingExtraError, ModelError
from osgode.fields import SIZE_LIMITS, number
from osgode.mass import refuse_complex
from osgode.maths import FloatArray
from osgode.native import ffi

if TYPE_CHECKING:
    from PIL.Image import Image

MOST = 8192
"""Samples along one side."""
HEIGHT = number(-SIZE_LIMITS[1], SIZE_LIMITS[1])


class HeightData:
    """Heights on a grid, checked once, shared by any number of geoms.

    The array is copied and can't be written to.

    Args:
        heights: (rows along +Z, columns along +X), 2 to 8192 of each, metres.

    Raises:
        ModelError: for an array of the wrong shape, or numbers that are not finite or beyond 1e7 m.
    """

    def __init__(self, heights: npt.ArrayLike, name: str = "") -> None:
        self.name = name
        label = f"HeightData {name!r}"
        try:
            refuse_complex(heights)
            table = np.array(heights, dtype=np.float64, order="C")
        except (TypeError, ValueError, OverflowError) as error:
            raise ModelError(f"{label}: heights must be a table of numbers: {error}") from error
        if table.ndim != 2 or not all(2 <= n <= MOST for n in table.shape):
            raise ModelError(f"{label}: heights has shape {table.shape}; it must be (rows, columns), 2 to {MOST} each")
        if not np.isfinite(table).all():
            raise ModelError(f"{label}: a height is not finite")
        if float(np.abs(table).max()) > SIZE_LIMITS[1]:
            raise ModelError(f"{label}: a height is beyond +-{SIZE_LIMITS[1]:g} m")
        self.heights: FloatArray = table
        self.heights.flags.writeable = False

    @property
    def shape(self) -> tuple[int, int]:
        """Rows (along z) and columns (along x)."""
        rows, columns = self.heights.shape
        return rows, columns

    def arrays(self) -> tuple[Any, int, int]:
        """What the C core copies: heights, rows, columns."""
        return ffi.from_buffer("double[]", self.heights), *self.shape

    def __repr__(self) -> str:
        return f"<HeightData {self.name!r}: {self.shape[0]} x {self.shape[1]}>"


def image_heights(source: str | os.PathLike[str] | Image, height: float) -> HeightData:
    """Heights from the brightness of an image: black is 0, white is ``height``, metres.

    The first row, the top of the image, is the one of the lowest z. 16 bits of grey are used where they are there.

    Raises:
        ModelError: if no image can be read.
        FieldError: if height is none, or the source neither a path nor an image.
        MissingExtraError: without Pillow.
    """
    try:
        from PIL import Image as images  # noqa: N813 - Pillow's class of that name is only a type here
    except ImportError as error:
        raise MissingExtraError("reading an image needs Pillow: pip install 'osgode[render]'") from error
    white = HEIGHT("Heightfield.from_image()", "height", height)
    if isinstance(source, images.Image):
        return HeightData(white * _brightness(source), "image")
    if not isinstance(source, str | os.PathLike):
        raise FieldError(f"Heightfield.from_image().source is a {type(source).__name__}; it must be a path or an image")
    try:
        with images.open(source) as image:
            grey = _brightness(image)
    except (OSError, ValueError) as error:
        raise ModelError(f"no heights can be read from {os.fspath(source)!r}: {error}") from error
    return HeightData(white * grey, Path(source).name)


def _brightness(image: Image) -> FloatArray:
    """0 to 1."""
    if image.mode.startswith("I"):  # 16 bits of grey, which Pillow may keep in 32
        return np.asarray(image, dtype=np.float64) / 65535.0
    if image.mode == "F":
        return np.asarray(image, dtype=np.float64)
    return np.asarray(image.convert("L"), dtype=np.float64) / 255.0
