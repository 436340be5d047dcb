"""Meshes of arrows, 1 long: for showing directions, ways of sliding and ways of turning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from osgode.graph.mesh import Mesh
from osgode.graph.primitives import SEGMENTS, Indices, _revolve
from osgode.maths import FloatArray

SHAFT, HEAD, TIP = 0.03, 0.09, 0.25
"""Radius of the shaft, radius and length of the head."""
RING, OPEN, HIGH = 0.28, math.pi / 2, 0.62
"""Radius of the ring of turning, the angle that it leaves open, and where along the arrow it lies."""

Part: TypeAlias = tuple[FloatArray, Indices, FloatArray]
"""Vertices, triangles, normals."""


@lru_cache(4)
def arrow_mesh(*, slides: bool = False, turns: bool = False) -> Mesh:
    """An arrow from the origin to (0, 0, 1).

    Args:
        slides: with a second head behind the first.
        turns: with a ring about it, whose own head shows the positive way round by the right-hand rule.
    """
    parts = [_turned([(SHAFT, 0.0, 1.0, 0.0), (SHAFT, 1.0 - TIP, 1.0, 0.0)]), _head(1.0 - TIP)]
    if slides:
        parts.append(_head(1.0 - 1.7 * TIP))
    if turns:
        parts += _ring()
    starts = np.cumsum([0, *(len(vertices) for vertices, _, _ in parts[:-1])])
    return Mesh(
        np.vstack([vertices for vertices, _, _ in parts]),
        np.vstack([triangles + start for (_, triangles, _), start in zip(parts, starts, strict=True)]),
        np.vstack([normals for _, _, normals in parts]),
        name="arrow",
    )


def _turned(profile: Sequence[tuple[float, float, float, float]]) -> Part:
    """The surface of (radius, z, radial part of the normal, its z part) turned about Z."""
    rows = np.column_stack([profile, np.zeros(len(profile))])
    vertices, triangles, normals, _ = _revolve(rows, (1.0, 1.0), SEGMENTS)
    return vertices, triangles, normals


def _head(foot: float) -> Part:
    """A cone along Z."""
    radial, along = np.array([TIP, HEAD]) / math.hypot(TIP, HEAD)
    side = [(HEAD, foot, radial, along), (0.0, foot + TIP, radial, along)]
    return _turned([(0.0, foot, 0.0, -1.0), (HEAD, foot, 0.0, -1.0), *side])


def _ring() -> list[Part]:
    """A tube bent about Z, and a head at its end."""
    bend = np.linspace(0.0, 2 * math.pi - OPEN, 33)[:, None]
    around = np.linspace(0.0, 2 * math.pi, 9)[None, :]
    outwards = np.stack([np.cos(bend), np.sin(bend), 0 * bend], axis=-1)
    normals = np.cos(around)[..., None] * outwards + np.sin(around)[..., None] * np.array([0.0, 0.0, 1.0])
    vertices = RING * outwards + SHAFT * normals + np.array([0.0, 0.0, HIGH])
    columns = around.shape[1]
    i, j = np.meshgrid(np.arange(len(bend) - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    b, c, d = a + 1, a + columns, a + columns + 1
    triangles = np.vstack([np.column_stack([a, d, b]), np.column_stack([a, c, d])])
    tube = vertices.reshape(-1, 3), triangles, normals.reshape(-1, 3)
    points, faces, slopes = _head(0.0)
    end = float(bend[-1, 0])
    out, along = np.array([math.cos(end), math.sin(end), 0.0]), np.array([-math.sin(end), math.cos(end), 0.0])
    axes = np.column_stack([np.cross((0.0, 0.0, 1.0), along), [0.0, 0.0, 1.0], along])
    return [tube, (points @ axes.T + RING * out + (0.0, 0.0, HIGH), faces, slopes @ axes.T)]
