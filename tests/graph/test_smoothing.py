"""Normals for meshes without any: smooth over gentle bends, sharp at edges."""

from __future__ import annotations

import math

import numpy as np
import pytest

from osgode.graph.primitives import box_mesh, sphere_mesh
from osgode.graph.smoothing import creased


def merged(mesh_vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same surface with one vertex per place."""
    _, first, places = np.unique(np.round(mesh_vertices, 5), axis=0, return_index=True, return_inverse=True)
    return mesh_vertices[first].astype(np.float64), places.reshape(-1)[triangles]


def roof(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Two squares that share the Z axis as an edge; their normals differ by ``angle``."""
    half = angle / 2
    c, s = math.cos(half), math.sin(half)
    vertices = np.array([[0, 0, 0], [0, 0, 1], [c, -s, 0], [c, -s, 1], [-c, -s, 0], [-c, -s, 1]], np.float64)
    return vertices, np.array([[0, 1, 3], [0, 3, 2], [1, 0, 4], [1, 4, 5]])


def test_a_box_stays_sharp() -> None:
    """A cube of 8 vertices becomes one of 24 with the six normals of its faces."""
    vertices, triangles = merged(box_mesh().vertices, box_mesh().triangles)
    assert len(vertices) == 8
    at, faces, normals, uvs = creased(vertices, triangles)
    assert uvs is None
    assert len(at) == 24
    assert np.abs(normals).max(axis=1) == pytest.approx(np.ones(24))
    assert np.unique(np.round(normals) + 0.0, axis=0).tolist() == [
        [-1, 0, 0], [0, -1, 0], [0, 0, -1], [0, 0, 1], [0, 1, 0], [1, 0, 0]
    ]  # fmt: skip
    assert at[faces] == pytest.approx(vertices[triangles])


def test_a_sphere_becomes_smooth() -> None:
    """On a sphere no vertex is doubled and the normals point away from the centre."""
    vertices, triangles = merged(sphere_mesh().vertices, sphere_mesh().triangles)
    at, faces, normals, _ = creased(vertices, triangles)
    assert len(at) == len(vertices)
    assert at[faces] == pytest.approx(vertices[triangles])
    assert np.einsum("ni,ni->n", normals, at).min() > math.cos(math.radians(4))


@pytest.mark.parametrize(("degrees", "vertices"), [(30, 6), (40, 8)])
def test_the_crease_angle_decides(degrees: float, vertices: int) -> None:
    """Below the crease angle the edge is shared and its normal halfway, above it is doubled."""
    at, _, normals, _ = creased(*roof(math.radians(degrees)))
    assert len(at) == vertices
    on_edge = normals[(at[:, 0] == 0) & (at[:, 1] == 0)]
    if vertices == 6:
        assert on_edge == pytest.approx(np.tile([0, 1, 0], (2, 1)), abs=1e-9)
    else:
        assert on_edge[:, 1] == pytest.approx(np.full(4, math.cos(math.radians(20))))


def test_normals_are_smooth_across_texture_seams_and_the_seams_stay() -> None:
    """Vertices doubled for their texture coordinates get the same normal and keep those coordinates."""
    vertices, triangles = roof(math.radians(20))
    split = np.vstack([vertices, vertices[:2]])
    triangles = np.where(np.arange(4)[:, None] >= 2, np.where(triangles < 2, triangles + 6, triangles), triangles)
    uvs = np.arange(16, dtype=np.float64).reshape(8, 2)
    at, faces, normals, new_uvs = creased(split, triangles, uvs)
    assert new_uvs is not None
    assert new_uvs[faces] == pytest.approx(uvs[triangles])
    assert at[faces] == pytest.approx(split[triangles])
    assert normals[(at[:, 0] == 0)] == pytest.approx(np.tile([0, 1, 0], (4, 1)), abs=1e-9)


def test_it_makes_no_difference_how_a_flat_face_is_cut() -> None:
    """The two ends of an edge get the same normal, though one has two triangles of a side and the other has one."""
    vertices, triangles = roof(math.radians(20))
    vertices[2:4] *= (3, 3, 1)  # nor how large the sides are
    at, _, normals, _ = creased(vertices, triangles)
    assert normals[at[:, 0] == 0] == pytest.approx(np.tile([0, 1, 0], (2, 1)), abs=1e-9)


def test_the_angle_at_the_corner_is_the_weight() -> None:
    """Where sides of 90 and 45 degrees meet, the normal leans to the first in proportion."""
    vertices, triangles = roof(math.radians(20))
    at, _, normals, _ = creased(vertices, triangles[[0, 1, 3]])  # of the second side only the half at vertex 1
    shared = normals[(at == [0, 0, 1]).all(axis=1)][0]
    c, s = math.cos(math.radians(10)), math.sin(math.radians(10))
    expected = np.array([2 * s - s, 2 * c + c, 0])  # angles in the ratio 2 to 1
    assert shared == pytest.approx(expected / np.linalg.norm(expected), abs=1e-9)


def test_a_fan_of_many_triangles() -> None:
    """At the tip of a flat cone all triangles count alike, however many there are."""
    n = 50
    turn = np.arange(n) * (2 * math.pi / n)
    rim = np.column_stack([np.cos(turn), np.zeros(n), np.sin(turn)])
    vertices = np.vstack([[0, 0.1, 0], rim])
    ring = np.arange(n)
    triangles = np.column_stack([np.zeros(n, int), 1 + (ring + 1) % n, 1 + ring])
    at, _, normals, _ = creased(vertices, triangles)
    assert len(at) == n + 1
    assert normals[(at == [0, 0.1, 0]).all(axis=1)] == pytest.approx(np.array([[0, 1, 0]]), abs=1e-9)
