"""What is seen at a point of the picture: rays against the triangles that are drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from osgode.graph.drawable import Drawable
from osgode.graph.mesh import Mesh
from osgode.graph.node import Node
from osgode.maths import FloatArray, Vec3

PARALLEL = 1e-12
"""A ray meets no triangle that it makes a smaller angle with than about this, radians."""
SEAM = 1e-9
"""Share of a triangle's edges by which it counts as larger, so that no ray slips through between two of them."""


@dataclass(frozen=True, eq=False)
class Pick:
    """What is seen at a point of a picture.

    Args:
        path: the nodes from the root down to the one that shows it; one of several ways where nodes are shared.
        drawable: what was hit of that node.
        triangle: the number of the triangle in ``drawable.mesh``.
        point: where, in the axes of the root, metres.
        normal: of the triangle, of length 1, on the side that is seen.
        distance: from the eye, metres.
    """

    path: tuple[Node, ...]
    drawable: Drawable
    triangle: int
    point: Vec3
    normal: Vec3
    distance: float

    @property
    def node(self) -> Node:
        """The node that shows what was hit."""
        return self.path[-1]


class Line(NamedTuple):
    """A part of a ray: the points ``origin + t * direction`` for ``near <= t <= far``."""

    origin: FloatArray
    direction: FloatArray
    near: float
    far: float


class Crossing(NamedTuple):
    """Where a ray meets a triangle: how far along, which one, and its normal in the axes of the mesh, of any length."""

    t: float
    triangle: int
    normal: FloatArray


_edges: WeakKeyDictionary[Mesh, tuple[FloatArray, FloatArray, FloatArray]] = WeakKeyDictionary()


def entries(line: Line, spheres: FloatArray) -> FloatArray:
    """How far along a ray each of (n, 4) spheres begins, at least ``line.near``; infinite for those that it misses.

    Args:
        line: whose direction has length 1.
        spheres: centres and radii.
    """
    offsets = spheres[:, :3] - line.origin
    along = offsets @ line.direction
    half = spheres[:, 3] ** 2 - (np.einsum("ni,ni->n", offsets, offsets) - along * along)
    reach = np.sqrt(np.maximum(half, 0.0))
    met = (half >= 0.0) & (along + reach >= line.near) & (along - reach <= line.far)
    return np.where(met, np.maximum(along - reach, line.near), np.inf)


def cross(line: Line, mesh: Mesh, matrix: FloatArray) -> Crossing | None:
    """The first triangle that a ray meets, from either side, of a mesh placed by ``matrix``.

    A mesh that its matrix squeezes flat is met by nothing. (T. Moeller and B. Trumbore, "Fast, Minimum Storage
    Ray/Triangle Intersection", 1997.)
    """
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return None
    # In the axes of the mesh, with the direction as long as the matrix makes it: so t stays the same.
    origin = inverse[:3, :3] @ line.origin + inverse[:3, 3]
    direction = inverse[:3, :3] @ line.direction
    corner, edge1, edge2 = _corner_and_edges(mesh)
    side = np.cross(direction, edge2)
    slope = np.einsum("ni,ni->n", edge1, side)
    sizes = np.sqrt(np.einsum("ni,ni->n", edge1, edge1) * np.einsum("ni,ni->n", edge2, edge2))
    usable = np.abs(slope) > PARALLEL * sizes * np.linalg.norm(direction)
    slope = np.where(usable, slope, 1.0)
    away = origin - corner
    u = np.einsum("ni,ni->n", away, side) / slope
    other = np.cross(away, edge1)
    v = other @ direction / slope
    t = np.einsum("ni,ni->n", edge2, other) / slope
    met = usable & (u >= -SEAM) & (v >= -SEAM) & (u + v <= 1.0 + SEAM) & (line.near <= t) & (t <= line.far)
    hits = np.flatnonzero(met)
    if not len(hits):
        return None
    first = int(hits[np.argmin(t[hits])])
    return Crossing(float(t[first]), first, np.cross(edge1[first], edge2[first]) @ inverse[:3, :3])


def _corner_and_edges(mesh: Mesh) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A corner of each triangle and the edges from there to the two others, (m, 3) each; kept with the mesh."""
    found = _edges.get(mesh)
    if found is None:
        a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
        found = _edges[mesh] = a, b - a, c - a
    return found
