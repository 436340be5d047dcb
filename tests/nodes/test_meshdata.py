"""Triangles for collision: what is cleaned, and what is refused before ODE could read out of bounds."""

import math

import numpy as np
import pytest

import osgode as oo
from tests.strategies import CUBE

TRIANGLE = ([(0, 0, 0), (0, 0, 1), (1, 0, 0)], [(0, 1, 2)])


def test_what_is_given_is_copied_and_can_not_be_written_to():
    vertices, triangles = np.array(CUBE[0], float), np.array(CUBE[1])
    data = oo.MeshData(vertices, triangles, "cube")
    vertices[:] = 7.0
    triangles[:] = 0
    assert np.array_equal(data.vertices, CUBE[0])
    assert np.array_equal(data.triangles, CUBE[1])
    for table in (data.vertices, data.triangles):
        with pytest.raises(ValueError, match="read-only"):
            table[0] = 0
    assert (data.vertices.dtype, data.triangles.dtype) == (np.float64, np.uint32)
    assert "cube" in repr(data)


def test_degenerate_triangles_and_unused_vertices_are_dropped():
    """OPCODE gives NaN for a triangle without area, and ODE asserts for many more vertices than triangles."""
    points = [(9, 9, 9), *TRIANGLE[0], *[(i, 5, 5) for i in range(20)]]
    data = oo.MeshData(points, [(1, 2, 3), (0, 0, 0), (4, 5, 6), (1, 1, 2)])
    assert np.array_equal(data.vertices, TRIANGLE[0])
    assert np.array_equal(data.triangles, [(0, 1, 2)])


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        ([], [], r"vertices has shape \(0,\)"),
        (np.zeros((0, 3)), np.zeros((0, 3), int), "no triangle with an area"),
        (TRIANGLE[0], np.zeros((0, 3), int), "no triangle with an area"),
        ([(0, 0), (0, 1), (1, 0)], TRIANGLE[1], "vertices has shape"),
        (TRIANGLE[0], [(0, 1)], "triangles has shape"),
        (TRIANGLE[0], [0, 1, 2], "triangles has shape"),
        (TRIANGLE[0], [(0.0, 1.0, 2.0)], "integers"),
        (TRIANGLE[0], [(0, 1, 3)], "refer to vertices 0 to 3 of 3"),
        (TRIANGLE[0], [(0, 1, -1)], "refer to vertices -1"),
        (TRIANGLE[0], [(0, 1, 2**40)], "refer to vertices"),
        ([(0, 0, 0), (0, math.nan, 1), (1, 0, 0)], TRIANGLE[1], "not finite"),
        ([(0, 0, 0), (0, math.inf, 1), (1, 0, 0)], TRIANGLE[1], "not finite"),
        ([(0, 0, 0), (0, 0, 1e9), (1, 0, 0)], TRIANGLE[1], "farther than"),
        ([(0, 0, 0), (0, 0, 1), (0, 0, 2)], TRIANGLE[1], "no triangle with an area"),
        ([(0, 0, 0), (0, 0, 1e-8), (1e-8, 0, 0)], TRIANGLE[1], "no triangle with an area"),
        ([("a", "b", "c")] * 3, TRIANGLE[1], "must be tables of numbers"),
        (None, TRIANGLE[1], "vertices"),
        (TRIANGLE[0], None, "triangles"),
        (5, 5, "vertices"),
        (TRIANGLE[0], [("a", "b", "c")], "triangles"),
        (TRIANGLE[0], [(0, 1, 2), (0, 1)], "tables of numbers"),
        ([(0, 0, 0), (0, 1)], TRIANGLE[1], "tables of numbers"),
        (TRIANGLE[0], [(True, False, True)], "integers"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, triangles, message):
    """Empty, of the wrong shape, out of range or not finite: ODE would end the process or read beyond the array."""
    with pytest.raises(oo.ModelError, match=rf"MeshData 'it'.*{message}"):
        oo.MeshData(vertices, triangles, "it")


def test_water_is_the_mass_of_what_is_enclosed():
    assert oo.MeshData(*CUBE).water.mass == pytest.approx(1000.0)
    with pytest.raises(oo.FieldError, match="open"):
        _ = oo.MeshData(*TRIANGLE).water
