"""Hulls of points: they hold every point, are closed and convex, and weigh what they should."""

import importlib
import itertools

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.graph.primitives import box_mesh, sphere_mesh
from osgode.mass import is_closed
from osgode.nodes.hulls import hull_of, is_convex, merged
from tests.strategies import CUBE, vectors

pytest.importorskip("scipy")


def beyond(data, points):
    """How far the points are beyond the faces at most, by the planes through their corners."""
    a, b, c = np.moveaxis(data.vertices[data.triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return float(((np.asarray(points)[:, None] - a[None]) * normals[None]).sum(axis=2).max())


@given(st.lists(vectors(5), min_size=4, max_size=60))
@settings(max_examples=100)
def test_the_hull_holds_every_point_and_is_convex(points):
    table = np.array(points)
    spread = np.linalg.svd(table - table.mean(axis=0), compute_uv=False)
    assume(spread[-1] > 1e-3)
    data = hull_of(points, "it")
    assert is_closed(data.triangles)
    assert is_convex(data)
    assert beyond(data, points) < 1e-3
    given_points = {tuple(p) for p in table.tolist()}
    assert all(tuple(v) in given_points for v in data.vertices.tolist())


def test_a_grid_of_points_on_a_cube_is_a_cube():
    """Points within faces and on edges leave no slivers; volume and inertia are a box's."""
    for n in (2, 3, 7):
        grid = np.array(list(itertools.product(np.linspace(-0.5, 0.5, n), repeat=3)))
        turn = np.array(oo.Quat.from_axis_angle((1, 2, 3), 0.8).to_matrix())
        data = hull_of(grid @ turn.T + [3, 2, 1], "it")
        assert is_convex(data)
        expected = oo.Mass.box((1, 1, 1), density=1000).rotated(oo.Quat.from_axis_angle((1, 2, 3), 0.8))
        assert data.water.mass == pytest.approx(1000)
        assert tuple(data.water.centre) == pytest.approx((3, 2, 1))
        assert np.array(data.water.inertia) == pytest.approx(np.array(expected.inertia), abs=1e-6)


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0, 0)] * 5,
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 3, 0)],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, np.nan)],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, np.inf)],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1e9)],
        [(0, 0), (1, 0), (0, 1), (1, 1)],
        [],
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1j)],
        "abcd",
        [[0, 0, 0], [1, 0], [2]],
    ],
)
def test_what_encloses_nothing_is_refused(points):
    with pytest.raises(oo.ModelError, match="ConvexHull 'it'"):
        oo.ConvexHull(points, name="it")


def test_which_meshes_are_convex():
    cube = oo.MeshData(*CUBE)
    ball = merged(oo.MeshData(sphere_mesh(1.0).vertices, sphere_mesh(1.0).triangles))
    dented = np.array(CUBE[0])
    dented[0] *= 0.2
    for data, expected in (
        (cube, True),
        (ball, True),
        (oo.MeshData(dented, CUBE[1]), False),
        (oo.MeshData(CUBE[0], CUBE[1][1:]), False),
        (oo.MeshData(CUBE[0], [t[::-1] for t in CUBE[1]]), False),
    ):
        assert is_convex(data) == expected


def test_two_cubes_side_by_side_are_not_convex():
    second = np.add(CUBE[0], (5, 0, 0))
    data = oo.MeshData(np.vstack([CUBE[0], second]), np.vstack([CUBE[1], np.array(CUBE[1]) + 8]))
    assert not is_convex(data)
    assert hull_of(data.vertices, "it").water.mass == pytest.approx(6000)


def test_a_mesh_that_is_convex_needs_no_package(monkeypatch):
    """Nor do texture seams make it open; all else names the extra that it needs."""
    monkeypatch.setattr(importlib, "import_module", _refuse)
    for source in (CUBE, oo.MeshData(*CUBE), box_mesh((1, 1, 1))):
        assert len(oo.ConvexHull(source).data.vertices) == 8
    for source in (CUBE[0], (CUBE[0], CUBE[1][1:])):
        with pytest.raises(oo.MissingExtraError, match=r"'scipy'.*osgode\[convex\]"):
            oo.ConvexHull(source)


def _refuse(name):
    raise ImportError(name)
