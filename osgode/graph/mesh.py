"""Triangle meshes to draw and to collide with."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from osgode.errors import ModelError
from osgode.maths import Float32Array, IndexArray, Vec3

Simpler: TypeAlias = "tuple[tuple[Mesh, float], ...]"


class Mesh:
    """Triangles with a normal and a texture coordinate per vertex; never changed once made.

    Compared by identity: drawables that share one Mesh are drawn together.

    Args:
        vertices: (n, 3), metres.
        triangles: (m, 3) indices, counter-clockwise seen from outside.
        normals: (n, 3) of length 1; computed from the triangles if not given.
        uvs: (n, 2) texture coordinates, (0, 0) at the bottom left of the image; zeros if not given.
        name: for messages.

    Raises:
        ModelError: if the arrays don't fit together, are empty, or are not finite.
    """

    vertices: Final[Float32Array]
    triangles: Final[IndexArray]
    normals: Final[Float32Array]
    uvs: Final[Float32Array]
    centre: Final[Vec3]
    """The middle of the bounding box."""
    radius: Final[float]
    """The radius of a sphere about the middle that holds every vertex."""
    simplify: Callable[[], Simpler] | None = None
    """Makes `simpler`; None if there are none."""
    solid_behind: bool = False
    """Whether it is the surface of a half-space: then it throws no shadow from its front, where all others are."""

    def __init__(
        self,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        normals: npt.ArrayLike | None = None,
        uvs: npt.ArrayLike | None = None,
        name: str = "",
    ) -> None:
        self.name = name
        self.vertices = self._array("vertices", vertices, 3)
        count = len(self.vertices)
        self.triangles = self._indices(triangles, count)
        if normals is None:
            normals = vertex_normals(self.vertices, self.triangles)
        self.normals = self._array("normals", normals, 3, count)
        self.uvs = self._array("uvs", np.zeros((count, 2)) if uvs is None else uvs, 2, count)
        for array in (self.vertices, self.triangles, self.normals, self.uvs):
            array.flags.writeable = False
        centre = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2
        self.centre = Vec3(*map(float, centre))
        arms = self.vertices.astype(np.float64) - centre  # squares of millimetres are too small for float32
        self.radius = float(np.sqrt((arms**2).sum(axis=1).max()))

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r} of {len(self.vertices)} vertices, {len(self.triangles)} triangles>"

    def _indices(self, value: npt.ArrayLike, count: int) -> IndexArray:
        triangles = np.asarray(value)
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
            raise ModelError(f"Mesh {self.name!r}: triangles has shape {triangles.shape}; it must be (m, 3)")
        if not np.issubdtype(triangles.dtype, np.integer):
            raise ModelError(f"Mesh {self.name!r}: triangles has type {triangles.dtype}; it must be whole numbers")
        if triangles.min() < 0 or triangles.max() >= count:
            raise ModelError(
                f"Mesh {self.name!r}: triangles refer to vertices {triangles.min()} to {triangles.max()}; "
                f"there are {count}"
            )
        return np.array(triangles, dtype=np.uint32, order="C")

    def _array(self, name: str, value: npt.ArrayLike, width: int, length: int | None = None) -> Float32Array:
        array = np.array(value, dtype=np.float32, order="C")
        if array.ndim != 2 or array.shape[1] != width or not len(array) or length not in (None, len(array)):
            wanted = "n" if length is None else str(length)
            raise ModelError(f"Mesh {self.name!r}: {name} has shape {array.shape}; it must be ({wanted}, {width})")
        if not np.isfinite(array).all():
            raise ModelError(f"Mesh {self.name!r}: {name} holds a number that is not finite")
        return array

    @cached_property
    def simpler(self) -> Simpler:
        """Meshes with fewer triangles that may cast shadows in its stead, the simplest first; made when first asked.

        Each with the most by which its outline is off, in metres.
        """
        return () if self.simplify is None else self.simplify()

    @property
    def bounds(self) -> tuple[Vec3, Vec3]:
        """The lowest and highest corner of the bounding box."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return Vec3(*map(float, low)), Vec3(*map(float, high))


def vertex_normals(vertices: Float32Array, triangles: IndexArray) -> Float32Array:
    """Normals per vertex, the area-weighted mean of those of its triangles: (n, 3) of length 1."""
    corners = vertices[triangles].astype(np.float64)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros((len(vertices), 3))
    for k in range(3):
        np.add.at(normals, triangles[:, k], faces)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    up = np.array([0.0, 1.0, 0.0])
    return np.where(lengths > 1e-20, normals / np.maximum(lengths, 1e-20), up).astype(np.float32)
