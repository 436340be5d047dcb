"""What a capsule on a mesh touches, against distances found by searching along its line."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.graph.primitives import box_mesh

RADIUS, LENGTH = 0.2, 1.0
seeds = st.integers(0, 2**32 - 1)


def meet(vertices, triangles, position, rotation, pose=((0, 0, 0), (1, 0, 0, 0)), **fields):
    """Points, normals towards the capsule, and depths, where it touches a mesh that stands at ``pose``."""
    world = oo.World(gravity=(0, 0, 0), contacts_per_pair=500)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    place = space.attach(oo.Placeable(position=pose[0], rotation=oo.Quat(*pose[1])))
    place.attach(oo.Trimesh(oo.MeshData(vertices, triangles)))
    body = space.attach(oo.Body(position=position, rotation=rotation))
    body.attach(oo.Placeable()).attach(oo.Capsule(fields.get("radius", RADIUS), fields.get("length", LENGTH), mass=1))
    found = []
    body.on_collide(lambda feedback: found.append((feedback.points, feedback.normals, feedback.depths)))
    world.step()
    if not found:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
    return tuple(np.asarray(table) for table in found[0])


def turned(random):
    q = random.normal(size=4)
    return oo.Quat(*(q / np.linalg.norm(q)))


def ends_of(position, rotation, length=LENGTH):
    arm = np.array(rotation.rotate((0, 0, length / 2)))
    return np.array(position) - arm, np.array(position) + arm


def to_segments(points, a, b):
    way = b - a
    t = np.clip(((points - a) * way).sum(-1) / (way**2).sum(-1), 0, 1)
    return np.linalg.norm(points - a - t[..., None] * way, axis=-1)


def to_triangles(points, corners):
    """How far a point is from each triangle: from its plane if it is over it, else from the nearest edge."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    n = np.cross(b - a, c - a)
    edges = ((a, b), (b, c), (c, a))
    over = np.all([(np.cross(v - u, points - u) * n).sum(-1) >= 0 for u, v in edges], axis=0)
    height = np.abs(((points - a) * n).sum(-1)) / np.linalg.norm(n, axis=-1)
    return np.where(over, height, np.min([to_segments(points, u, v) for u, v in edges], axis=0))


def line_to_triangles(a, b, corners):
    """The distance to a convex thing has one minimum along a line: it is beside the nearest of some points."""
    low, high = np.zeros(len(corners)), np.ones(len(corners))
    for _ in range(11):
        spots = np.linspace(low, high, 17)
        away = to_triangles(a + spots[..., None] * (b - a), corners)
        width, nearest = (high - low) / 16, np.take_along_axis(spots, away.argmin(0)[None], 0)[0]
        low, high = np.maximum(nearest - width, 0), np.minimum(nearest + width, 1)
    return float(away.min())


def plane_of(corners):
    n = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return n / np.linalg.norm(n)


BENT = 1 - math.cos(math.radians(6.1))
"""What counts as along a face leans by 6 degrees at most; its contacts are measured along the normal of the face."""


def check_on_both(meshes, ends, radius, found):
    """Each contact is half its depth below both surfaces."""
    points, normals, depths = found
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1)
    for point, depth in zip(points, depths, strict=True):
        assert to_triangles(point, meshes).min() <= depth / 2 + 1e-9
        assert abs(radius - to_segments(point, *ends) - depth / 2) < radius * BENT


@given(seeds, st.floats(-0.15, 0.05), st.floats(0.05, 0.5), st.floats(0.05, 2))
@settings(max_examples=120)
def test_a_capsule_is_as_deep_in_a_triangle_as_its_line_is_near(seed, gap, radius, length):
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (3, 3))
    n = plane_of(corners)
    assume(np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0])) > 0.05)
    rotation = turned(random)
    if seed % 3 == 0:  # along an edge, or nearly so
        along = corners[1] - corners[0] + random.normal(size=3) * random.choice([0, 1e-9, 0.02])
        rotation = oo.Quat.between((0, 0, 1), tuple(along / np.linalg.norm(along)))
    weights = random.dirichlet((1, 1, 1)) + random.normal(size=3) * 0.2
    position = weights @ corners + n * random.uniform(0, length)
    for _ in range(5):  # brought about as near as wanted
        ends = ends_of(position, rotation, length)
        away = line_to_triangles(*ends, corners[None])
        position = position + n * (radius + gap - away)
    gap = away - radius
    position = (ends[0] + ends[1]) / 2
    heights = [(end - corners[0]) @ n for end in ends]
    assume(min(heights) > 0)  # it is wholly in front
    found = meet(corners, [(0, 1, 2)], tuple(position), rotation, radius=radius, length=length)
    depths = found[2]
    if gap > 1e-9:
        assert len(depths) == 0
    elif gap < -1e-9:
        assert depths.max() == pytest.approx(-gap, abs=1e-7)
        check_on_both(corners[None], ends, radius, found)


def hills(random, cells=8, wild=0.3):
    spots = np.linspace(-2, 2, cells + 1)
    x, z = np.meshgrid(spots, spots)
    y = random.uniform(-wild, wild, x.shape)
    triangles = []
    for j, i in itertools.product(range(cells), repeat=2):
        a, b = j * (cells + 1) + i, j * (cells + 1) + i + 1
        c, d = a + cells + 1, b + cells + 1
        triangles += [(a, c, b), (b, c, d)] if random.random() < 0.5 else [(a, c, d), (a, d, b)]
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1), np.array(triangles)


def drop(random, meshes, rotation, depth):
    """A place over triangles where a capsule is about so deep in them, and how deep it is.

    It sinks by no more than what is missing, so that it can't pass through.
    """
    x, z = random.uniform(-0.8, 0.8, 2)
    y = 2.0
    for _ in range(8):
        missing = line_to_triangles(*ends_of((x, y, z), rotation), meshes) - RADIUS + depth
        y -= missing
    return (x, y + missing, z), depth - missing


@given(seeds, st.floats(1e-4, 0.1))
@settings(max_examples=25)
def test_on_hills_the_deepest_contact_is_where_they_are_nearest(seed, depth):
    random = np.random.default_rng(seed)
    vertices, triangles = hills(random, cells=4)
    meshes = vertices[triangles]
    rotation = turned(random)
    position, depth = drop(random, meshes, rotation, depth)
    assume(depth > 1e-5)
    found = meet(vertices, triangles, position, rotation)
    assert found[2].max() == pytest.approx(depth, abs=1e-6)
    check_on_both(meshes, ends_of(position, rotation), RADIUS, found)


@given(seeds, st.floats(1e-6, 0.5))
@settings(max_examples=150)
def test_seams_of_a_flat_mesh_are_not_felt(seed, depth):
    """In any pose, and deep in it too: every contact points up, and the deepest is that of a plane."""
    random = np.random.default_rng(seed)
    vertices, triangles = hills(random, cells=int(random.integers(3, 24)), wild=0)
    inner = np.abs(vertices[:, [0, 2]]).max(axis=1) < 1.9
    vertices[inner, 0] += random.uniform(-0.05, 0.05, inner.sum())
    vertices[inner, 2] += random.uniform(-0.05, 0.05, inner.sum())
    rotation = turned(random)
    droop = abs(ends_of((0, 0, 0), rotation)[0][1])
    x, z = random.uniform(-0.8, 0.8, 2)
    position = (x, RADIUS + droop - min(depth, RADIUS + droop - 1e-6), z)  # its middle above
    _, normals, depths = meet(vertices, triangles, position, rotation)
    assert normals == pytest.approx(np.array([(0, 1, 0)] * len(depths)), abs=1e-6)
    assert depths.max() == pytest.approx(RADIUS + droop - position[1], abs=1e-9)


@given(seeds, st.floats(1e-4, 0.05))
@settings(max_examples=25)
def test_where_the_mesh_stands_and_how_its_triangles_are_listed_does_not_matter(seed, depth):
    random = np.random.default_rng(seed)
    vertices, triangles = hills(random, cells=4)
    rotation, turn, shift = turned(random), turned(random), random.uniform(-5, 5, 3)
    position, depth = drop(random, vertices[triangles], rotation, depth)
    assume(depth > 1e-5)
    here = meet(vertices, triangles, position, rotation)
    moved = tuple(np.array(turn.rotate(position)) + shift)
    listed = np.array([np.roll(row, random.integers(3)) for row in random.permutation(triangles)])
    there = meet(vertices, listed, moved, turn * rotation, (tuple(shift), tuple(turn)))
    assert there[2].max() == pytest.approx(here[2].max(), abs=1e-9)
    back = turn.conjugate()
    for point, normal in zip(there[0], there[1], strict=True):
        spot = np.array([*back.rotate(tuple(point - shift)), *back.rotate(tuple(normal))])
        assert np.linalg.norm(np.hstack(here[:2]) - spot, axis=1).min() < 5e-3


@pytest.mark.parametrize("across", [True, False])
def test_on_the_edge_of_a_cube_it_touches_once_across_and_twice_along(across):
    """The edge along z at (0.5, 0.5): pushed away from the cube's middle."""
    cube = box_mesh((1, 1, 1))
    away = (RADIUS - 0.01) / math.sqrt(2)
    rotation = oo.Quat.between((0, 0, 1), (1, -1, 0)) if across else oo.Quat(1, 0, 0, 0)
    place = (0.5 + away, 0.5 + away, 0.1)
    points, normals, depths = meet(cube.vertices, cube.triangles, place, rotation)
    spots = [0.1] if across else [-0.4, 0.5]
    half = math.sqrt(0.5)
    assert sorted(points[:, 2]) == pytest.approx(spots, abs=1e-9)
    assert normals == pytest.approx(np.array([(half, half, 0)] * len(spots)), abs=1e-9)
    assert depths == pytest.approx(0.01)
    middle = 0.5 - 0.005 * half
    assert points[:, :2] == pytest.approx(np.array([(middle, middle)] * len(spots)), abs=1e-9)


def test_beside_the_rim_of_a_triangle_it_touches_at_both_ends_of_what_they_have_in_common():
    away = (RADIUS - 0.01) / math.sqrt(2)
    corners = [(0, 0, -0.5), (0, 0, 0.5), (1, 0, 0)]
    points, normals, depths = meet(corners, [(0, 1, 2)], (-away, away, 0.1), oo.Quat(1, 0, 0, 0))
    half = math.sqrt(0.5)
    assert sorted(points[:, 2]) == pytest.approx([-0.4, 0.5], abs=1e-9)
    assert normals == pytest.approx(np.array([(-half, half, 0)] * 2), abs=1e-9)
    assert depths == pytest.approx(0.01)


def test_what_leans_on_a_table_with_its_foot_below_it_is_not_lifted():
    """From (0.16, 0.47) down to (-0.16, -0.47): past the end of the table top at (-0.09, -0.1), its middle above."""
    top = [(-2, -0.1, -2), (-2, -0.1, 2), (-0.09, -0.1, -2), (-0.09, -0.1, 2)]
    tilt = oo.Quat.between((0, 0, 1), (1, 3, 0))
    _, normals, _ = meet(top, [(0, 1, 2), (1, 3, 2)], (0, 0, 0), tilt)
    assert not (normals[:, 1] > 0.5).any()


@pytest.mark.parametrize("side", [1, -1])
def test_only_the_front_of_a_triangle_is_solid(side):
    corners = np.array([(-2, 0, -2), (0, 0, 2), (2, 0, -2)])
    _, normals, _ = meet(corners, [(0, 1, 2)], (0, 0.15 * side, 0), oo.Quat(1, 0, 0, 0))
    assert len(normals) == (2 if side == 1 else 0)
