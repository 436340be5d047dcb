"""What a car looks like: its body shell, and wheels with a tyre, five spokes on both sides, a dark inside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import numpy.typing as npt

import osgode as oo
from osgode.examples.runner import ASSETS, painted

ROUND = 32
"""Pieces that a circle is drawn with."""
SPOKES = 5

TYRE = painted(0.06, 0.06, 0.065, 0.15)
RIM = painted(0.74, 0.75, 0.78, 0.8)
INSIDE = painted(0.1, 0.1, 0.11, 0.3)

Table = npt.NDArray[np.float64]
Rings = Sequence[tuple[float, float]]


def revolved(outline: Rings) -> tuple[Table, npt.NDArray[np.int64], Table]:
    """A surface of revolution about Z: vertices, triangles and normals.

    Args:
        outline: z and radius of its rings; what lies to the right of the way from one to the next is outside.
    """
    turns = np.arange(ROUND) * (math.tau / ROUND)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    vertices: list[Table] = []
    normals: list[Table] = []
    triangles: list[npt.NDArray[np.int64]] = []
    here = np.arange(ROUND)
    following = (here + 1) % ROUND
    for k in range(len(outline) - 1):
        (z0, r0), (z1, r1) = outline[k], outline[k + 1]
        out, along = z1 - z0, r0 - r1
        length = math.hypot(out, along)
        normal = np.column_stack([circle * (out / length), np.full(ROUND, along / length)])
        first = len(vertices) * ROUND
        for z, r in ((z0, r0), (z1, r1)):
            vertices.append(np.column_stack([circle * r, np.full(ROUND, z)]))
            normals.append(normal)
        near, far = first + here, first + ROUND + here
        near_next, far_next = first + following, first + ROUND + following
        triangles += [np.column_stack([near, near_next, far_next]), np.column_stack([near, far_next, far])]
    return np.concatenate(vertices), np.concatenate(triangles), np.concatenate(normals)


def spoke(ends: tuple[float, float], halves: tuple[float, float], levels: tuple[float, float]) -> tuple[Table, Table]:
    """A bar along X that grows thinner outward: its triangles' corners (n, 3, 3) and normals.

    Args:
        ends: x of both.
        halves: half its breadth at each.
        levels: z of its foot and of its top.
    """
    a, b = np.array([ends[0], -halves[0], levels[1]]), np.array([ends[0], halves[0], levels[1]])
    c, d = np.array([ends[1], halves[1], levels[1]]), np.array([ends[1], -halves[1], levels[1]])
    down = np.array([0.0, 0.0, levels[0] - levels[1]])
    faces = [(a, d, c, b), (a, a + down, d + down, d), (c, c + down, b + down, b)]
    corners = np.array([corner for p, q, r, s in faces for corner in ((p, q, r), (p, r, s))])
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners, np.repeat(flat[:, None, :] / np.linalg.norm(flat, axis=1)[:, None, None], 3, axis=1)


@cache
def wheel_drawables(radius: float, width: float) -> tuple[oo.Drawable, ...]:
    """Tyre, rim and inside of a wheel that turns about Z.

    Args:
        radius: of the whole wheel, metres.
        width: of it, metres.
    """
    half = width / 2
    shoulder: Rings = [
        (half * z, radius * r) for z, r in ((0.9, 0.66), (1.0, 0.74), (1.0, 0.9), (0.85, 0.97), (0.5, 1.0))
    ]
    tyre = revolved([(-z, r) for z, r in shoulder] + list(reversed(shoulder)))
    lip = [(0.5, 0.58), (0.94, 0.62), (0.94, 0.68)]
    rims = [
        revolved([(half * z, radius * r) for z, r in lip]),
        revolved([(-half * z, radius * r) for z, r in reversed(lip)]),
    ]
    cap = [(0.75, 0.17), (0.82, 0.15), (0.82, 0.0)]
    rims += [
        revolved([(half * z, radius * r) for z, r in cap]),
        revolved([(-half * z, radius * r) for z, r in reversed(cap)]),
    ]
    discs = [
        revolved([(half * 0.35, radius * 0.62), (half * 0.35, 0.0)]),
        revolved([(-half * 0.35, 0.0), (-half * 0.35, radius * 0.62)]),
    ]
    ends, halves, levels = (0.1 * radius, 0.62 * radius), (0.1 * radius, 0.06 * radius), (0.35 * half, 0.78 * half)
    bars, flats = spoke(ends, halves, levels)
    for side in (1.0, -1.0):
        for k in range(SPOKES):
            turn = k * math.tau / SPOKES
            turned = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
            if side < 0:  # half a turn about X
                turned = turned @ np.diag([1.0, -1.0, -1.0])
            points, normals = (bars @ turned.T).reshape(-1, 3), (flats @ turned.T).reshape(-1, 3)
            rims.append((points, np.arange(len(points)).reshape(-1, 3), normals))
    return (
        oo.Drawable(oo.Mesh(*tyre, name="tyre"), TYRE),
        oo.Drawable(joined(rims, "rim"), RIM),
        oo.Drawable(joined(discs, "inside of a wheel"), INSIDE),
    )


def joined(parts: Sequence[tuple[Table, npt.NDArray[np.int64], Table]], name: str) -> oo.Mesh:
    """Several surfaces as one mesh."""
    firsts = np.cumsum([0] + [len(vertices) for vertices, _, _ in parts[:-1]])
    return oo.Mesh(
        np.concatenate([vertices for vertices, _, _ in parts]),
        np.concatenate([triangles + first for (_, triangles, _), first in zip(parts, firsts, strict=True)]),
        np.concatenate([normals for _, _, normals in parts]),
        name=name,
    )


@cache
def hull_drawables(colour: tuple[float, float, float] | None) -> tuple[oo.Drawable, ...]:
    """The body shell; in its own red, or painted."""
    shell = oo.load_model(ASSETS / "hull.obj").drawables
    if colour is None:
        return tuple(shell)
    # What is painted has most of the triangles: the others are lamps, glass and trim.
    most = max(shell, key=lambda part: len(part.mesh.triangles))
    paint = painted(*colour, shine=0.7)
    return tuple(oo.Drawable(part.mesh, paint, part.matrix) if part is most else part for part in shell)
