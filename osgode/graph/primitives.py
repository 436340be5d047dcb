"""Meshes of simple solids, made once per size: equal arguments give the same Mesh object.

All are closed, centred on their origin, and have outward normals. Round ones are inscribed: their vertices lie
on the true surface. Texture coordinates run from 0 to 1 over each face (round a body of revolution: once
around), or, where ``texture_scale`` gives the metres of one repeat along u and v, in repeats.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache, partial
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from osgode.graph.mesh import Mesh, Simpler
from osgode.maths import FloatArray

SEGMENTS = 24
"""Corners of a full circle."""
RINGS = SEGMENTS // 2
"""Bands from pole to pole of a sphere."""
COARSE = (8, 12)
"""Corners of a full circle in the simpler meshes that cast shadows; half as many bands."""

TextureScale: TypeAlias = tuple[float, float] | None
Indices: TypeAlias = npt.NDArray[np.int64]
_CACHED = 1024

# For each face of a box: the normal, and the directions of u and v, so that side faces stand upright.
_BOX_FACES = np.array(
    [
        [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[-1, 0, 0], [0, 0, 1], [0, 1, 0]],
        [[0, 1, 0], [1, 0, 0], [0, 0, -1]],
        [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
        [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        [[0, 0, -1], [-1, 0, 0], [0, 1, 0]],
    ],
    dtype=np.float64,
)
_CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float64)
_QUAD = np.array([[0, 1, 2], [0, 2, 3]])


@lru_cache(_CACHED)
def box_mesh(size: tuple[float, float, float] = (1.0, 1.0, 1.0), texture_scale: TextureScale = None) -> Mesh:
    """A box with edges of ``size`` metres along X, Y, Z; v points up (+Y) on the side faces."""
    normal, u, v = (_BOX_FACES[:, k, None, :] for k in range(3))
    across, up = _CORNERS[None, :, 0, None] - 0.5, _CORNERS[None, :, 1, None] - 0.5
    vertices = (normal / 2 + u * across + v * up) * size
    # The edge that a face's u (or v) runs along, found by the one component of it that is not 0.
    edges = np.concatenate([np.abs(u) @ np.array(size), np.abs(v) @ np.array(size)], axis=1)
    repeats = np.ones((6, 2)) if texture_scale is None else edges / texture_scale
    return Mesh(
        vertices=vertices.reshape(-1, 3),
        triangles=(_QUAD + 4 * np.arange(6)[:, None, None]).reshape(-1, 3),
        normals=np.broadcast_to(normal, (6, 4, 3)).reshape(-1, 3),
        uvs=(_CORNERS[None] * repeats[:, None]).reshape(-1, 2),
        name="box",
    )


@lru_cache(_CACHED)
def rectangle_mesh(width: float, height: float, texture_scale: TextureScale = None, solid_behind: bool = False) -> Mesh:
    """A flat rectangle in the XY plane that faces +Z, u along X, v along Y.

    With ``texture_scale``, (0, 0) of the texture lies on the middle; for ``solid_behind`` see `Mesh.solid_behind`.
    """
    corners = (_CORNERS - 0.5) * (width, height)
    mesh = Mesh(
        vertices=np.column_stack([corners, np.zeros(4)]),
        triangles=_QUAD,
        normals=np.tile([0.0, 0.0, 1.0], (4, 1)),
        uvs=_CORNERS if texture_scale is None else corners / texture_scale,
        name="rectangle",
    )
    mesh.solid_behind = solid_behind
    return mesh


@lru_cache(_CACHED)
def sphere_mesh(radius: float = 1.0, texture_scale: TextureScale = None) -> Mesh:
    """A sphere with its poles on the Y axis: u runs around it to the east, v from the south pole to the north."""
    repeats = _repeats(radius, math.pi * radius, texture_scale)
    return _with_simpler(partial(_sphere, radius, repeats), radius)


def _sphere(radius: float, repeats: tuple[float, float], segments: int) -> Mesh:
    angles = np.linspace(-math.pi / 2, math.pi / 2, segments // 2 + 1)
    vertices, triangles, normals, uvs = _revolve(_arc(radius, angles, 0.0), repeats, segments)
    turned = [1, 2, 0]  # Z to Y, Y to X, X to Z: a rotation, so the triangles still face outwards
    return Mesh(vertices[:, turned], triangles, normals[:, turned], uvs, name="sphere")


def _with_simpler(make: Callable[[int], Mesh], radius: float) -> Mesh:
    """A round mesh that knows its simpler ones."""
    mesh = make(SEGMENTS)
    mesh.simplify = partial(_simpler, make, radius)
    return mesh


def _simpler(make: Callable[[int], Mesh], radius: float) -> Simpler:
    """The same with fewer corners, and by how much their outlines are off.

    A corner of theirs is at most half a band up or down and half a corner aside, an angle whose cosine is
    ``cos(pi / corners)**2``, from any direction; so their outline is at most what is missing there to 1 inside.
    """
    return tuple((make(corners), radius * math.sin(math.pi / corners) ** 2) for corners in COARSE)


@lru_cache(_CACHED)
def cylinder_mesh(radius: float = 1.0, length: float = 1.0, texture_scale: TextureScale = None) -> Mesh:
    """A cylinder along Z: u runs around it, v along it; on the flat ends the texture lies flat."""
    return _with_simpler(partial(_cylinder, radius, length, texture_scale), radius)


def _cylinder(radius: float, length: float, texture_scale: TextureScale, segments: int) -> Mesh:
    half = length / 2
    side = np.array([[radius, -half, 1.0, 0.0, 0.0], [radius, half, 1.0, 0.0, 1.0]])
    parts = [_revolve(side, _repeats(radius, length, texture_scale), segments)]
    angles = np.arange(segments) * (2 * math.pi / segments)
    rim = np.column_stack([np.cos(angles), np.sin(angles)])
    disc = np.vstack([[0.0, 0.0], rim]) * radius
    following = np.roll(np.arange(segments), -1)
    fan = np.column_stack([np.zeros(segments, int), 1 + np.arange(segments), 1 + following])
    for end in (1.0, -1.0):
        seen = disc * (end, 1.0)  # seen from outside, the X axis of the bottom end points left
        uvs = seen / (2 * radius) + 0.5 if texture_scale is None else seen / texture_scale
        parts.append(
            (
                np.column_stack([disc, np.full(len(disc), end * half)]),
                fan if end > 0 else fan[:, ::-1],
                np.tile([0.0, 0.0, end], (len(disc), 1)),
                uvs,
            )
        )
    starts = np.cumsum([0, *(len(part[0]) for part in parts[:-1])])
    return Mesh(
        vertices=np.vstack([part[0] for part in parts]),
        triangles=np.vstack([part[1] + start for part, start in zip(parts, starts, strict=True)]),
        normals=np.vstack([part[2] for part in parts]),
        uvs=np.vstack([part[3] for part in parts]),
        name="cylinder",
    )


@lru_cache(_CACHED)
def capsule_mesh(radius: float, length: float, texture_scale: TextureScale = None) -> Mesh:
    """A capsule along Z; ``length`` is that of the cylindrical part alone, as in ODE, and may be 0."""
    return _with_simpler(partial(_capsule, radius, length, texture_scale), radius)


def _capsule(radius: float, length: float, texture_scale: TextureScale, segments: int) -> Mesh:
    angles = np.linspace(0.0, math.pi / 2, segments // 4 + 1)
    outline = math.pi * radius + length
    lower = _arc(radius, angles - math.pi / 2, -length / 2)
    upper = _arc(radius, angles, length / 2)
    # Along the outline the texture keeps its proportions: v is the share of the outline's length.
    lower[:, 4] *= math.pi / 2 * radius / outline
    upper[:, 4] = 1.0 - (math.pi / 2 * radius / outline) * (1.0 - upper[:, 4])
    profile = np.vstack([lower, upper if length > 0 else upper[1:]])
    vertices, triangles, normals, uvs = _revolve(profile, _repeats(radius, outline, texture_scale), segments)
    return Mesh(vertices, triangles, normals, uvs, name="capsule")


def _arc(radius: float, angles: FloatArray, height: float) -> FloatArray:
    """Rows of a profile (see `_revolve`) along a circle about (0, ``height``), v from 0 to 1."""
    c, s = np.cos(angles), np.sin(angles)
    c[np.isclose(np.abs(s), 1.0, atol=1e-12)] = 0.0  # on the axis exactly, so that poles close
    v = np.linspace(0.0, 1.0, len(angles))
    return np.column_stack([radius * c, height + radius * s, c, s, v])


def _repeats(radius: float, outline: float, texture_scale: TextureScale) -> tuple[float, float]:
    """How often the texture repeats around and along; around, a whole number, or there would be a seam."""
    if texture_scale is None:
        return 1.0, 1.0
    return max(1.0, round(2 * math.pi * radius / texture_scale[0])), outline / texture_scale[1]


def _revolve(
    profile: FloatArray, repeats: tuple[float, float], segments: int
) -> tuple[FloatArray, Indices, FloatArray, FloatArray]:
    """The surface swept by a profile turned about Z: vertices, triangles, normals, texture coordinates.

    Args:
        profile: rows (radius, z, radial part of the normal, z part of it, v) from the lowest upwards; where the
            radius is 0 the surface closes.
        repeats: factors of u and v.
        segments: corners of a full circle.
    """
    columns = segments + 1  # the last lies on the first, with u = 1 instead of 0
    turn = np.arange(columns) * (2 * math.pi / segments)
    turn[-1] = 0.0
    c, s = np.cos(turn), np.sin(turn)
    radius, z, radial, axial, v = (profile[:, k, None] for k in range(5))
    flat = np.zeros_like(c)
    vertices = np.stack([radius * c, radius * s, z + flat], axis=-1).reshape(-1, 3)
    normals = np.stack([radial * c, radial * s, axial + flat], axis=-1).reshape(-1, 3)
    # At a pole each triangle has a vertex of its own, in the middle of its side of the texture.
    middle = np.where(radius == 0, 0.5, 0.0)
    u = (np.arange(columns) + middle) / segments
    uvs = np.stack([u * repeats[0], (v + flat) * repeats[1]], axis=-1).reshape(-1, 2)
    i, j = np.meshgrid(np.arange(len(profile) - 1), np.arange(segments), indexing="ij")
    a = (i * columns + j).ravel()
    b, d = a + 1, a + columns
    lower, upper = np.column_stack([a, b, d + 1]), np.column_stack([a, d + 1, d])
    on_axis = profile[:, 0] == 0
    band = i.ravel()
    triangles = np.vstack([lower[~on_axis[band]], upper[~on_axis[band + 1]]])
    # Where the band ends in the upper pole, the pole's vertex of column j serves the triangle of column j.
    top = np.flatnonzero(on_axis[band[~on_axis[band]] + 1])
    triangles[top, 2] -= 1
    used, triangles = np.unique(triangles, return_inverse=True)  # a pole has one vertex more than triangles
    return vertices[used], triangles.reshape(-1, 3), normals[used], uvs[used]
