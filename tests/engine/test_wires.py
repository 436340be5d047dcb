"""Wires of collision shapes: every point lies on the shape, and all of the shape is spanned."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import osgode as oo
from osgode.engine.stamps import Stamps, across, arrows, colour, scattered, touches
from osgode.engine.wires import (
    COARSE,
    FINE,
    GRID,
    MOST,
    box_wire,
    field_wire,
    grid_wire,
    mesh_wire,
    octahedron_wire,
    pieces_of,
    plane_matrix,
)
from osgode.maths import Pose, Quat, Vec3
from osgode.nodes.meshdata import MeshData

CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE_TRIANGLES = [t for a, b, c, d in FACES for t in ((a, b, c), (a, c, d))]


def lines_of(geom, segments=FINE):
    """All lines in the axes of the geom."""
    parts = [wire * np.array(scale) + (0, 0, lift) for wire, scale, lift in pieces_of(geom, segments)]
    return np.concatenate(parts).astype(float)


def points_of(geom, segments=FINE):
    return lines_of(geom, segments).reshape(-1, 3)


def spans(points, half):
    return np.allclose(points.max(axis=0), half, atol=1e-6) and np.allclose(points.min(axis=0), -np.array(half))


def test_a_box_has_its_twelve_edges():
    lines = lines_of(oo.Box((2, 3, 4)))
    assert len(lines) == 12
    assert sorted(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).tolist()) == [2] * 4 + [3] * 4 + [4] * 4
    corners, counts = np.unique(lines.reshape(-1, 3), axis=0, return_counts=True)
    assert len(corners) == 8
    assert (counts == 3).all()
    assert spans(corners, (1, 1.5, 2))


@pytest.mark.parametrize("segments", [FINE, COARSE])
def test_points_of_round_shapes_lie_on_them(segments):
    """A capsule is what is at a distance from a line, a cylinder what is so from an axis, up to its ends."""
    ball = points_of(oo.Sphere(0.7), segments)
    assert np.allclose(np.linalg.norm(ball, axis=1), 0.7)
    assert spans(ball, (0.7,) * 3)
    pill = points_of(oo.Capsule(0.3, 2.0), segments)
    away = pill.copy()
    away[:, 2] -= np.clip(away[:, 2], -1.0, 1.0)
    assert np.allclose(np.linalg.norm(away, axis=1), 0.3, atol=1e-6)
    assert spans(pill, (0.3, 0.3, 1.3))
    tin = points_of(oo.Cylinder(0.4, 3.0), segments)
    assert np.allclose(np.hypot(tin[:, 0], tin[:, 1]), 0.4)
    assert np.allclose(np.abs(tin[:, 2]), 1.5)


def test_a_ray_is_one_line_along_minus_z():
    assert lines_of(oo.Ray(5.0)).tolist() == [[[0, 0, 0], [0, 0, -5]]]


def test_a_class_of_a_user_is_what_it_is_made_from():
    class Crate(oo.Box):
        pass

    assert np.array_equal(lines_of(Crate((1, 2, 3))), lines_of(oo.Box((1, 2, 3))))


def test_meshes_show_their_triangles_and_hulls_their_edges():
    """A cube of twelve triangles has 12 edges and 6 diagonals; on a hull the diagonals are nobody's business."""
    mesh = oo.Trimesh((CUBE, CUBE_TRIANGLES))
    assert len(lines_of(mesh)) == 18
    hull = lines_of(oo.ConvexHull(mesh.data))
    assert len(hull) == 12
    assert np.allclose(np.linalg.norm(hull[:, 1] - hull[:, 0], axis=1), 1.0)


def test_vertices_at_one_place_are_one_corner():
    """A model with a vertex for each corner of each triangle has the same edges."""
    loose = np.array(CUBE)[np.array(CUBE_TRIANGLES)].reshape(-1, 3)
    data = MeshData(loose, np.arange(36).reshape(-1, 3))
    assert len(mesh_wire(data)) == 18
    assert len(mesh_wire(data, 0.1)) == 12


def test_borders_are_shown_however_flat():
    square = MeshData([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    assert len(mesh_wire(square, 0.1)) == 4
    assert len(mesh_wire(square)) == 5


def sheet(n, height):
    """A mesh of 2 (n - 1)^2 triangles over a grid."""
    x, z = np.meshgrid(np.arange(n), np.arange(n))
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)])
    return MeshData(np.stack([x, height(x, z), z], -1).reshape(-1, 3), faces)


def test_of_fine_meshes_the_sharp_edges_are_left():
    """A roof of 90 degrees: its ridge and its border, 5 times n - 1 edges; all its edges would be too many."""
    n = 61
    roof = sheet(n, lambda x, _: -abs(x - 30.0))
    assert len(mesh_wire(roof)) == 5 * (n - 1)


@pytest.mark.parametrize("n", [61, 200])
def test_no_mesh_has_too_many_lines(n):
    """Not even one that is sharp everywhere, or nowhere."""
    rough = sheet(n, lambda x, z: 3.0 * ((x + z) % 2))
    ball = oo.Trimesh(oo.sphere_drawable(1.0).mesh).data
    assert 0 < len(mesh_wire(rough)) <= MOST
    assert 0 < len(mesh_wire(ball)) <= MOST


@pytest.mark.parametrize("shape", [(2, 2), (7, 5), (300, 200), (2, 8000)])
def test_heightfields_are_rows_and_columns(shape):
    """Every point is on the surface, the corners are there, and there are never too many."""
    heights = np.random.default_rng(3).normal(size=shape)
    field = oo.Heightfield(heights, (10.0, 20.0))
    lines = lines_of(field)
    assert len(lines) <= MOST
    if heights.size < 100:
        rows, columns = shape
        assert len(lines) == rows * (columns - 1) + columns * (rows - 1)
        for x, y, z in lines.reshape(-1, 3):
            assert field.height_at(x, z) == pytest.approx(y, abs=1e-5)
    points = lines.reshape(-1, 3)
    assert (np.abs(points).max(axis=0)[[0, 2]] == (5, 10)).all()
    assert field_wire(field.data) is field_wire(field.data)


@pytest.mark.parametrize("normal", [(0, 1, 0), (1, 0, 0), (0.3, 0.8, -0.5), (0, -1, 0)])
def test_the_patch_of_a_plane_lies_in_it(normal):
    """Every point has n . p = offset, about the foot of the given point, as far as wanted."""
    plane = oo.Plane(normal, 2.5)
    middle, reach = Vec3(30.0, 4.0, -7.0), 33.0
    matrix = plane_matrix(plane, middle, reach)
    points = grid_wire()[:-1].reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    assert np.allclose(points @ np.array(plane.normal), 2.5, atol=1e-4)
    foot = middle - plane.normal * (plane.normal.dot(middle) - 2.5)
    off = points - np.array(foot)
    edge = GRID * np.linalg.norm(matrix[:3, 0]) / 2
    assert edge >= reach
    assert np.linalg.norm(off.mean(axis=0)) <= edge / GRID * math.sqrt(2) + 1e-6
    tick = matrix[:3, :3] @ (0, 1, 0)
    assert np.allclose(tick / np.linalg.norm(tick), plane.normal)


@pytest.mark.parametrize(("reach", "step"), [(0.5, 1), (10, 1), (10.1, 2), (21, 5), (99, 10), (100.1, 20)])
def test_lines_of_planes_are_whole_steps_apart(reach, step):
    """And stay where they are while what they are about moves."""
    for x in (0.0, 0.3, 17.7):
        matrix = plane_matrix(oo.Plane(), Vec3(x, 5.0, 0.0), reach)
        assert matrix[0, 0] == step
        assert matrix[0, 3] % step == 0


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 1e-3))
def test_across_is_square(vector):
    """Two unit vectors at right angles to it and to each other, in every direction."""
    n = np.array([vector]) / math.hypot(*vector)
    axes = np.concatenate([n, *across(n)])
    assert np.allclose(axes @ axes.T, np.identity(3), atol=1e-12)


def test_arrows_end_where_they_should():
    starts, ways = np.array([(1.0, 2, 3), (0, 0, 0)]), np.array([(0.0, 0, 2), (0, 0, 0)])
    lines = arrows(starts, ways).reshape(2, 5, 2, 3)
    assert lines[0, 0].tolist() == [[1, 2, 3], [1, 2, 5]]
    assert np.allclose(lines[0, 1:, 1], (1, 2, 5))
    assert (lines[0, 1:, 0, 2] < 5).all()
    assert not lines[1].any()
    shorter = arrows(starts, ways, 0.5).reshape(2, 5, 2, 3)
    assert np.allclose(shorter[0, :, 1], (1, 2, 4))


def test_marks_of_contacts_lie_on_the_surface():
    n = np.array([(0.6, 0.8, 0.0)])
    lines = touches(np.array([(1.0, 1, 1)]), n, np.array([0.5]))
    assert np.allclose(lines[0], [(1, 1, 1), (1.3, 1.4, 1)])
    cross = lines[3:] - 1.0
    assert np.allclose(cross @ n[0], 0.0, atol=1e-7)
    assert np.allclose(cross[:, 0], -cross[:, 1])


def test_scattered_copies_are_scaled_and_moved():
    wire = octahedron_wire()
    assert len(wire) == 12
    assert np.allclose(np.linalg.norm(wire, axis=2), 1.0)
    lines = scattered(wire, np.array([(1.0, 0, 0), (0, 5, 0)]), np.array([1.0, 2.0])).reshape(2, 12, 2, 3)
    assert np.allclose(lines[1], 2 * wire + np.array((0, 5, 0)), atol=1e-6)
    low, high = np.array([(0.0, 1, 2)]), np.array([(3.0, 5, 7)])
    box = scattered(box_wire(), (low + high) / 2, high - low).reshape(-1, 3)
    assert (box.min(axis=0) == low).all()
    assert (box.max(axis=0) == high).all()


def test_stamps_are_moved_by_their_rows():
    """Each at table[row] @ matrix, in the colour of the owner; those of one template stand together."""
    table = np.array([Pose(Vec3(k, 0, 0), Quat.from_axis_angle((0, 1, 0), k)).matrix() for k in range(3)])
    line, box = np.array([[(0, 0, 0), (1, 0, 0)]], np.float32), box_wire()
    matrices = np.array([np.diag([s, 1, 1, 1.0]) for s in (1, 2, 3)])
    stamps = Stamps([line, box, line], matrices, [2, 0, -3], [0, 1, 2])
    assert stamps.count == 14
    points = stamps.points(table)
    for row, k, at in ((2, 0, 0), (-3, 2, 1)):
        expected = (table[row] @ matrices[k] @ np.array([(0, 0, 0, 1), (1, 0, 0, 1)]).T)[:3].T
        assert np.allclose(points[at], expected, atol=1e-6)
    looks = np.array([colour(1, 2, 3), colour(4, 5, 6, 7), colour(8, 9, 10)], np.uint32)
    shown = stamps.colours(looks).view(np.uint8).reshape(-1, 4)
    assert shown[:2].tolist() == [[1, 2, 3, 255], [8, 9, 10, 255]]
    assert (shown[2:] == (4, 5, 6, 7)).all()


def test_dense_stamps_fade_if_told():
    many = np.zeros((600, 2, 3), np.float32)
    stamps = Stamps([many], np.identity(4)[None], [0], [0])
    own = np.array([colour(10, 20, 30, 200)], np.uint32)
    assert (stamps.colours(own).view(np.uint8).reshape(-1, 4) == (10, 20, 30, 200)).all()
    assert (stamps.colours(own, fading=True).view(np.uint8).reshape(-1, 4) == (10, 20, 30, 100)).all()
    assert own.view(np.uint8)[3] == 200


def test_no_stamps_are_no_lines():
    nothing = Stamps([], np.zeros((0, 4, 4)), [], [])
    assert nothing.points(np.identity(4)[None]).shape == (0, 2, 3)
    assert len(nothing.colours(np.zeros(1, np.uint32))) == 0
