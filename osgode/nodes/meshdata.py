"""Triangles to collide with."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from osgode.errors import ModelError
from osgode.fields import SIZE_LIMITS
from osgode.mass import Mass, refuse_complex
from osgode.maths import FloatArray, IndexArray, Vec3Like
from osgode.native import ffi

SMALLEST_AREA = 1e-14
"""m2: OPCODE finds no contacts, or NaN, on a triangle without area."""


class MeshData:
    """Vertices and triangles for collision, checked and cleaned once, shared by any number of geoms.

    Degenerate triangles and unused vertices are dropped. The arrays are copied and can't be written to.

    Args:
        vertices: (n, 3), metres.
        triangles: (m, 3) indices, counter-clockwise seen from outside.

    Raises:
        ModelError: for arrays of the wrong shape, indices out of range, numbers that are not finite,
            or if no triangle is left.
    """

    def __init__(self, vertices: npt.ArrayLike, triangles: npt.ArrayLike, name: str = "") -> None:
        self.name = name
        label = f"MeshData {name!r}"
        try:
            refuse_complex(vertices)
            points = np.array(vertices, dtype=np.float64)
            faces = np.asarray(triangles)
        except (TypeError, ValueError, OverflowError) as error:
            raise ModelError(f"{label}: vertices and triangles must be tables of numbers: {error}") from error
        if points.ndim != 2 or points.shape[1] != 3:
            raise ModelError(f"{label}: vertices has shape {points.shape}; it must be (n, 3)")
        if faces.ndim != 2 or faces.shape[1] != 3 or not np.issubdtype(faces.dtype, np.integer):
            raise ModelError(f"{label}: triangles has shape {faces.shape} of {faces.dtype}; it must be (m, 3) integers")
        if not np.isfinite(points).all():
            raise ModelError(f"{label}: a vertex is not finite")
        if len(points) and float(np.abs(points).max()) > SIZE_LIMITS[1]:
            raise ModelError(f"{label}: a vertex is farther than {SIZE_LIMITS[1]:g} m from the origin")
        if len(faces) and (faces.min() < 0 or faces.max() >= len(points)):
            raise ModelError(f"{label}: triangles refer to vertices {faces.min()} to {faces.max()} of {len(points)}")
        corners = points[faces]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        faces = faces[areas > SMALLEST_AREA]
        if not len(faces):
            raise ModelError(f"{label}: there is no triangle with an area")
        used, renumbered = np.unique(faces, return_inverse=True)
        self.vertices: FloatArray = np.ascontiguousarray(points[used])
        self.triangles: IndexArray = np.ascontiguousarray(renumbered.reshape(-1, 3), dtype=np.uint32)
        self.vertices.flags.writeable = False
        self.triangles.flags.writeable = False

    @cached_property
    def water(self) -> Mass:
        """The mass of what the mesh encloses, at 1000 kg/m3.

        Raises:
            FieldError: if it is open or turned inside out.
        """
        return Mass.mesh(self.vertices, self.triangles, density=1000.0)

    def arrays(self, *, origin: Vec3Like = (0.0, 0.0, 0.0)) -> tuple[Any, int, Any, int]:
        """What the C core copies: vertices as seen from ``origin``, their number, triangles, their number."""
        vertices = np.ascontiguousarray(self.vertices - np.asarray(origin))
        return (
            ffi.from_buffer("double[]", vertices),
            len(vertices),
            ffi.from_buffer("unsigned int[]", self.triangles),
            len(self.triangles),
        )

    def __repr__(self) -> str:
        return f"<MeshData {self.name!r}: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"
