"""Terrain from a grid of heights."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self, Unpack

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError
from osgode.fields import LENGTH, Check, Field, NumberField, number
from osgode.graph.drawable import Drawable
from osgode.graph.shapes import heightfield_drawable
from osgode.native import checked, lib
from osgode.nodes.geom import GeomFields
from osgode.nodes.heightdata import HeightData, image_heights
from osgode.nodes.trimesh import SharedGeom

if TYPE_CHECKING:
    from PIL.Image import Image

    from osgode.mass import Mass


def _data(value: Any) -> HeightData:
    if not isinstance(value, HeightData):
        raise TypeError
    return value


def _extent(value: Any) -> tuple[float, float]:
    if isinstance(value, str | bytes | dict | set | frozenset):
        raise TypeError
    width, depth = value
    return LENGTH.convert(width), LENGTH.convert(depth)


class HeightfieldFields(GeomFields, total=False):
    """The keyword arguments of `Heightfield`."""

    thickness: float


class Heightfield(SharedGeom):
    """Terrain: heights on a grid over the xz plane of its axes, centred on its origin, solid below.

    Between the samples it is made of triangles, two for each cell. It needs a tenth of the memory of the same surface
    as a `Trimesh`, and pushes up what has got below the surface. What takes time are the samples below a thing, so a
    very large thing is better off with coarse samples. A Trimesh meets it with its corners alone; all else
    meets its peaks and ridges too. Rays see the surface from above and from below.

    It has no volume: as a part of a body it must be given ``mass=0``.

    Args:
        heights: (rows along +z, columns along +x), metres, or HeightData to share it between geoms: ``heights[0, 0]``
            is the corner of the lowest x and z.
        size: width along x and depth along z of the whole, metres.

    Raises:
        ModelError: if the heights can't be used.
    """

    SHAPE = lib.OO_HEIGHTFIELD

    data: Field[HeightData, HeightData] = Field(
        HeightData([(0.0, 0.0), (0.0, 0.0)]),
        Check("HeightData", _data),
        fixed=True,
        doc="Its heights, given when it is made.",
    )
    size: Field[tuple[float, float], Sequence[float]] = Field(
        (1.0, 1.0),
        Check("two lengths from 1e-6 to 1e7 m", _extent),
        after="_reshaped",
        unit="m",
        doc="Width along x and depth along z.",
    )
    thickness = NumberField(
        1.0,
        number(0.0, 1e6),
        after="_reshaped",
        unit="m",
        doc="How far below its lowest point it is solid.",
    )

    def __init__(
        self,
        heights: npt.ArrayLike | HeightData,
        size: Sequence[float] = (1.0, 1.0),
        *,
        name: str = "",
        visible: bool = True,
        **fields: Unpack[HeightfieldFields],
    ) -> None:
        data = heights if isinstance(heights, HeightData) else HeightData(heights, name)
        super().__init__(name=name, visible=visible, data=data, size=size, **fields)

    @classmethod
    def from_image(
        cls,
        source: str | os.PathLike[str] | Image,
        size: Sequence[float],
        height: float,
        *,
        name: str = "",
        visible: bool = True,
        **fields: Unpack[HeightfieldFields],
    ) -> Self:
        """Terrain from an image, seen from above: white is ``height`` metres high, black is 0.

        The image's top is where z is lowest, its left where x is. One pixel is one sample.

        Args:
            source: the path of an image file, or an image of Pillow; 16 bits of grey give finer steps than 8.
            size: width along x and depth along z of the whole, metres.
            height: of white above black, metres; below 0, white is deep.
            name: for messages.
            visible: whether it is drawn.
            **fields: as in `Heightfield`.

        Raises:
            ModelError: if no image can be read.
            MissingExtraError: without Pillow.
        """
        return cls(image_heights(source, height), size, name=name, visible=visible, **fields)

    def height_at(self, x: float, z: float) -> float:
        """How high the surface is at x and z of its own axes, metres.

        Raises:
            FieldError: beyond its edges.
        """
        width, depth = self.size
        rows, columns = self.data.shape
        u = number(-width / 2, width / 2)(f"{self.describe()}.height_at()", "x", x) / width + 0.5
        v = number(-depth / 2, depth / 2)(f"{self.describe()}.height_at()", "z", z) / depth + 0.5
        i, j = min(int(u * (columns - 1)), columns - 2), min(int(v * (rows - 1)), rows - 2)
        u, v = u * (columns - 1) - i, v * (rows - 1) - j
        (a, b), (c, d) = self.data.heights[j : j + 2, i : i + 2].tolist()
        if u + v <= 1.0:  # a cell is divided from its (1, 0) corner to its (0, 1) corner
            return float(a + (b - a) * u + (c - a) * v)
        return float(d + (c - d) * (1 - u) + (b - d) * (1 - v))

    def _make_shared(self, world: Any) -> Any:
        return lib.oo_heights_new(world, *self.data.arrays())

    def _dimensions(self) -> tuple[float, ...]:
        return (*self.size, self.thickness)

    def _reshaped(self) -> None:
        if self._realm is not None:
            lib.oo_wake_touching(self._realm.ptr, self._slot)
            checked(lib.oo_heightfield_resize(self._id, self._dimensions()), f"{self.describe()}: changing its size")
        self._resized()

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:  # noqa: ARG002
        raise FieldError("a heightfield has no volume")

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (heightfield_drawable(np.asarray(self.data.heights), *self.size, self._look()),)
