"""Collision shapes as wires: a few templates of lines, and the matrices that make shapes of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np

from osgode.maths import Float32Array, FloatArray, Quat, Vec3
from osgode.nodes.convex import ConvexHull
from osgode.nodes.geom import Geom
from osgode.nodes.heightdata import HeightData
from osgode.nodes.heightfield import Heightfield
from osgode.nodes.meshdata import MeshData
from osgode.nodes.plane import Plane
from osgode.nodes.primitives import Box, Capsule, Cylinder, Sphere
from osgode.nodes.ray import Ray
from osgode.nodes.trimesh import Trimesh

FINE, COARSE = 24, 12
"""Segments of a circle, where there are few things and where there are many; multiples of 4."""
MOST = 6000
"""Lines of one mesh or heightfield: of finer ones only some are shown."""
SHARP = math.radians(20.0)
"""The angle between two triangles from which on their edge is shown of a mesh that has more than `MOST`."""
FLAT = math.radians(0.5)
"""The same for hulls: below, it is an edge of the triangulation alone."""
GRID = 20
"""Fields of the patch of a plane, along one side."""

Wire: TypeAlias = Float32Array
"""Lines of a template, (n, 2, 3)."""


class Piece(NamedTuple):
    """A template in the axes of its geom: ``scale * point``, and then ``lift`` along z."""

    wire: Wire
    scale: tuple[float, float, float]
    lift: float = 0.0


def pieces_of(geom: Geom, segments: int = FINE) -> list[Piece]:
    """What the collision shape of ``geom`` is made of, whatever is drawn for it; of a plane nothing."""
    make = _makers.get(type(geom))
    if make is None:
        make = next((found for kind, found in _KINDS.items() if isinstance(geom, kind)), _nothing)
        _makers[type(geom)] = make
    return make(geom, segments)


def plane_matrix(plane: Plane, middle: Vec3, reach: float) -> FloatArray:
    """Where `grid_wire` is a square of ``plane``, about what is nearest to ``middle``; its lines have whole steps.

    Args:
        plane: the geom.
        middle: a point of the world.
        reach: how far from it the square goes at least, metres.
    """
    normal = plane.normal
    rotation = Quat.between((0.0, 1.0, 0.0), normal)
    step = _round_up(2.0 * reach / GRID)
    own = rotation.conjugate().rotate(middle)
    corner = Vec3(step * round(own.x / step), plane.offset, step * round(own.z / step))
    matrix = np.identity(4)
    matrix[:3, :3] = np.array(rotation.to_matrix()) * step
    matrix[:3, 3] = rotation.rotate(corner)
    return matrix


# -- templates


@cache
def box_wire() -> Wire:
    """The edges of the unit cube about the origin."""
    lines = []
    for axis in range(3):
        for a in (-0.5, 0.5):
            for b in (-0.5, 0.5):
                start = np.insert([a, b], axis, -0.5)
                lines.append((start, np.insert([a, b], axis, 0.5)))
    return _wire(lines)


@cache
def sphere_wire(segments: int = FINE) -> Wire:
    """Three great circles of radius 1."""
    circle = _arc(0.0, 2 * math.pi, segments)
    return _wire(np.concatenate([circle, np.roll(circle, 1, axis=2), np.roll(circle, 2, axis=2)]))


@cache
def sides_wire() -> Wire:
    """Four lines along z, 1 long, at radius 1."""
    angles = np.arange(4) * math.pi / 2
    x, y = np.cos(angles), np.sin(angles)
    return _wire(np.stack([np.column_stack([x, y, 0 * x + z]) for z in (-0.5, 0.5)], axis=1))


@cache
def cylinder_wire(segments: int = FINE) -> Wire:
    """Of radius 1 and length 1 along z."""
    circle, up = _arc(0.0, 2 * math.pi, segments), np.array([0.0, 0.0, 0.5])
    return _wire(np.concatenate([sides_wire(), circle - up, circle + up]))


@cache
def dome_wire(segments: int = FINE) -> Wire:
    """Half a sphere of radius 1 on its circle about z: two arcs over +z."""
    over = _arc(0.0, math.pi, segments // 2)[..., [0, 2, 1]]
    return _wire(np.concatenate([_arc(0.0, 2 * math.pi, segments), over, over[..., [1, 0, 2]]]))


@cache
def grid_wire() -> Wire:
    """A square of `GRID` fields of size 1 over the xz plane, and a line 1 high along y."""
    at = np.arange(GRID + 1) - GRID / 2
    one, end = np.ones_like(at), GRID / 2
    along = np.stack([np.column_stack([at, 0 * one, side * end * one]) for side in (-1, 1)], axis=1)
    return _wire(np.concatenate([along, along[..., [2, 1, 0]], [[(0, 0, 0), (0, 1, 0)]]]))


@cache
def ray_wire() -> Wire:
    """From the origin 1 along -z."""
    return _wire([((0, 0, 0), (0, 0, -1))])


@cache
def octahedron_wire() -> Wire:
    """Edges of an octahedron of radius 1: the mark of a point."""
    return _wire(np.concatenate([_arc(0.0, 2 * math.pi, 4)[..., order] for order in ([0, 1, 2], [0, 2, 1], [2, 0, 1])]))


_meshes: WeakKeyDictionary[MeshData, dict[float, Wire]] = WeakKeyDictionary()
_fields: WeakKeyDictionary[HeightData, Wire] = WeakKeyDictionary()


def mesh_wire(data: MeshData, sharp: float = 0.0) -> Wire:
    """The edges of triangles that meet at more than an angle, and their borders; of many only the sharp ones."""
    found = _meshes.setdefault(data, {})
    if sharp not in found:
        edges = _edges(data, sharp)
        if len(edges) > MOST:
            some = _edges(data, SHARP)
            edges = some if len(some) else edges
        found[sharp] = _thinned(edges)
    return found[sharp]


def field_wire(data: HeightData) -> Wire:
    """The rows and columns of a heightfield over a square of 1 by 1; of many every second, third..."""
    found = _fields.get(data)
    if found is None:
        heights = data.heights
        rows, columns = heights.shape
        every = max(1, math.ceil(2 * rows * columns / MOST))
        x, z = np.meshgrid(np.linspace(-0.5, 0.5, columns), np.linspace(-0.5, 0.5, rows))
        points = np.stack([x, heights, z], axis=-1)
        along = points[_some(rows, every)]
        across = points[:, _some(columns, every)].swapaxes(0, 1)
        lines = [np.stack([way[:, :-1], way[:, 1:]], axis=2).reshape(-1, 2, 3) for way in (along, across)]
        found = _fields[data] = _thinned(np.concatenate(lines))
    return found


def _edges(data: MeshData, sharp: float) -> FloatArray:
    # Vertices at one place are one corner: models often have several, of different normals.
    corners, names = np.unique(data.vertices, axis=0, return_inverse=True)
    triangles = names.reshape(-1)[data.triangles].astype(np.int64)
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    ways = np.cross(b - a, c - a)
    normals = ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-300)
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owners = np.tile(np.arange(len(triangles)), 3)
    keys = sides[:, 0] * len(corners) + sides[:, 1]
    order = np.argsort(keys, kind="stable")
    _, starts, counts = np.unique(keys[order], return_index=True, return_counts=True)
    first = order[starts]
    second = order[np.minimum(starts + 1, len(order) - 1)]
    cosines = np.einsum("ij,ij->i", normals[owners[first]], normals[owners[second]])
    shown = (counts != 2) | (cosines < math.cos(sharp)) | (sharp == 0.0)
    return np.asarray(corners[sides[first[shown]]])


def _some(count: int, every: int) -> Any:
    """Numbers below ``count``, evenly, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, max(2, math.ceil(count / every))).round().astype(int))


def _thinned(lines: FloatArray) -> Wire:
    return _wire(lines[:: max(1, math.ceil(len(lines) / MOST))])


def _arc(start: float, end: float, count: int) -> FloatArray:
    """A part of the unit circle about z as ``count`` lines."""
    angles = np.linspace(start, end, count + 1)
    points = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    return np.stack([points[:-1], points[1:]], axis=1)


def _wire(lines: Any) -> Wire:
    wire = np.array(lines, np.float32)
    wire.flags.writeable = False
    return wire


def _round_up(length: float) -> float:
    """The next of 1, 2, 5, 10, 20..."""
    wanted = max(length, 1.0)
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= wanted or factor == 10.0)


# -- what geoms are made of


def _capsule(geom: Any, segments: int) -> list[Piece]:
    r, half = geom.radius, geom.length / 2
    dome = dome_wire(segments)
    return [Piece(dome, (r, r, r), half), Piece(dome, (r, r, -r), -half), Piece(sides_wire(), (r, r, 2 * half))]


def _mesh(geom: Any, _: int) -> list[Piece]:
    return [Piece(mesh_wire(geom.data, FLAT if isinstance(geom, ConvexHull) else 0.0), ONES)]


def _nothing(*_: object) -> list[Piece]:
    return []


ONES = (1.0, 1.0, 1.0)
Maker: TypeAlias = Callable[[Any, int], list[Piece]]
_KINDS: dict[type[Geom], Maker] = {
    Box: lambda geom, _: [Piece(box_wire(), geom.size)],
    Sphere: lambda geom, segments: [Piece(sphere_wire(segments), (geom.radius,) * 3)],
    Capsule: _capsule,
    Cylinder: lambda geom, segments: [Piece(cylinder_wire(segments), (geom.radius, geom.radius, geom.length))],
    Ray: lambda geom, _: [Piece(ray_wire(), (1.0, 1.0, geom.length))],
    Heightfield: lambda geom, _: [Piece(field_wire(geom.data), (geom.size[0], 1.0, geom.size[1]))],
    Trimesh: _mesh,
    ConvexHull: _mesh,
}
_makers: dict[type[Geom], Maker] = {}
"""The same for classes of users too, as they come."""
