"""Shapes that are moved through a World in thought, and how far geoms are apart."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from tests.strategies import poses, vectors

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
TETRA = ([(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)], [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])
SHAPES = {
    "sphere": lambda: oo.Sphere(0.5),
    "box": lambda: oo.Box((0.6, 1.0, 1.4)),
    "capsule": lambda: oo.Capsule(0.3, 1.2),
    "cylinder": lambda: oo.Cylinder(0.4, 1.0),
    "hull": lambda: oo.ConvexHull(TETRA),
}
each_shape = pytest.mark.parametrize("name", SHAPES)


def farthest(shape, pose, way):
    """The greatest reach of a shape along a direction of the world, by its own formula."""
    own = np.array(pose.rotation.conjugate().rotate(oo.Vec3(*way)))
    if isinstance(shape, oo.Sphere):
        reach = shape.radius
    elif isinstance(shape, oo.Box):
        reach = float((CORNERS * np.array(shape.size) / 2 @ own).max())
    elif isinstance(shape, oo.Capsule):
        reach = shape.radius + shape.length / 2 * abs(own[2])
    elif isinstance(shape, oo.Cylinder):
        reach = shape.radius * math.hypot(own[0], own[1]) + shape.length / 2 * abs(own[2])
    else:
        reach = float((np.array(shape.data.vertices) @ own).max())
    return reach + float(np.dot(way, pose.position))


def placed(world, shape, pose):
    return world.children[0].attach(oo.Placeable(position=pose.position, rotation=pose.rotation)).attach(shape)


def an_empty_world():
    world = oo.World(gravity=(0, 0, 0))
    world.attach(oo.SimpleSpace())
    return world


@given(st.sampled_from(sorted(SHAPES)), st.sampled_from(sorted(SHAPES)), poses(), poses())
@settings(max_examples=150)
def test_the_closest_points_are_where_planes_across_their_line_part_the_shapes(first, second, one, two):
    """Both shapes lie behind the planes through their points: so nothing of them can be nearer."""
    world = an_empty_world()
    a, b = placed(world, SHAPES[first](), one), placed(world, SHAPES[second](), two)
    found = a.closest_to(b)
    back = b.closest_to(a)
    assert back.distance == pytest.approx(found.distance, abs=1e-6)
    if found.distance < 1e-4:  # they touch or overlap: what is left to say is that they do
        return
    way = (found.other_point - found.point) / found.distance
    assert found.point.distance(found.other_point) == pytest.approx(found.distance, abs=1e-6)
    assert farthest(a, one, way) == pytest.approx(way.dot(found.point), abs=1e-5)
    assert farthest(b, two, -way) == pytest.approx(-way.dot(found.other_point), abs=1e-5)


@each_shape
def test_a_plane_is_as_far_as_the_lowest_point_is_high(name):
    world = an_empty_world()
    pose = oo.Pose(oo.Vec3(1, 5, 2), oo.Quat.from_axis_angle((1, 2, 3), 0.7))
    plane = world.children[0].attach(oo.Plane(offset=-1.0))
    shape = placed(world, SHAPES[name](), pose)
    lowest = -farthest(shape, pose, (0, -1, 0))
    for found in (shape.closest_to(plane), plane.closest_to(shape)):
        assert found.distance == pytest.approx(lowest + 1.0)
    assert shape.closest_to(plane).other_point.y == pytest.approx(-1.0)


def test_a_mesh_and_a_heightfield_are_as_far_as_their_nearest_triangle():
    world = an_empty_world()
    ball = placed(world, oo.Sphere(0.5), oo.Pose(oo.Vec3(0.2, 3, 0.3)))
    mesh = placed(world, oo.Trimesh(([(-9, 0, -9), (9, 0, -9), (0, 0, 9)], [(0, 2, 1)])), oo.Pose(oo.Vec3(0, 1, 0)))
    field = placed(world, oo.Heightfield(np.zeros((5, 7)), (20, 20)), oo.Pose(oo.Vec3(0, -1, 0)))
    assert ball.closest_to(mesh).distance == pytest.approx(1.5)
    assert mesh.closest_to(ball).point == pytest.approx((0.2, 1, 0.3))
    assert ball.closest_to(field).distance == pytest.approx(3.5)
    assert ball.closest_to(field).other_point == pytest.approx((0.2, -1, 0.3))


def test_overlapping_shapes_are_no_distance_apart():
    world = an_empty_world()
    box = placed(world, oo.Box((2, 2, 2)), oo.Pose())
    assert box.closest_to(placed(world, oo.Box((1, 1, 1)), oo.Pose())).distance == 0.0
    assert placed(world, oo.Sphere(0.5), oo.Pose(oo.Vec3(0, 1.4, 0))).closest_to(box).distance == pytest.approx(-0.1)


@each_shape
@given(data=st.data())
@settings(max_examples=60)
def test_a_sweep_ends_where_shapes_touch_and_not_before(name, data):
    """At the touch they are 1e-7 m apart at most; on the way there they were not; and if there is none, never."""
    world = an_empty_world()
    other = data.draw(st.sampled_from(sorted(SHAPES)))
    pose, stands = data.draw(poses()), data.draw(poses())
    motion = oo.Vec3(*data.draw(vectors(8.0)))
    target = placed(world, SHAPES[other](), stands)
    probe = placed(world, SHAPES[name](), pose)
    start = probe.closest_to(target).distance
    found = world.sweep(SHAPES[name](), pose.position, motion, pose.rotation, exclude=[probe])
    place = probe.parent

    def distance(fraction):
        place.position = pose.position + motion * fraction
        return probe.closest_to(target).distance

    if start < 1e-5:
        return
    last = 1.0 if found is None else found.fraction
    for fraction in np.linspace(0.0, last * (1 - 1e-9), 12):
        assert distance(float(fraction)) > -1e-9
    if found is not None:
        assert found.geom is target
        assert distance(found.fraction) < 2e-6
        assert found.position == pytest.approx(pose.position + motion * found.fraction)
        assert found.normal.dot(motion) < 0
        assert found.normal.length == pytest.approx(1.0)


@pytest.mark.parametrize("height", [0.01, 0.5, 3.0])
def test_nothing_is_too_thin_for_a_sweep(height):
    """A plate, a mesh and a heightfield of no thickness, met by a small ball that goes a kilometre."""
    world = an_empty_world()
    ball = oo.Sphere(0.001)
    flat = [(-1, height, -1), (1, height, -1), (1, height, 1), (-1, height, 1)]
    things = [
        placed(world, oo.Box((2, 1e-5, 2)), oo.Pose(oo.Vec3(0, height, 0))),
        placed(world, oo.Trimesh((flat, [(0, 2, 1), (0, 3, 2)])), oo.Pose(oo.Vec3(10, 0, 0))),
        placed(world, oo.Heightfield(np.full((3, 3), height), (2, 2)), oo.Pose(oo.Vec3(20, 0, 0))),
    ]
    for x, thing in zip((0.1, 10.1, 20.1), things, strict=True):
        found = world.sweep(ball, (x, 500 + height, 0.2), (0, -1000, 0))
        assert found.geom is thing
        assert found.fraction == pytest.approx((500 - 0.001) / 1000, abs=1e-7)
        assert found.normal == pytest.approx((0, 1, 0))


def test_what_overlaps_at_the_start_is_touched_at_once():
    world = an_empty_world()
    box = placed(world, oo.Box((2, 2, 2)), oo.Pose())
    found = world.sweep(oo.Sphere(0.5), (0, 1.2, 0), (5, 0, 0))
    assert (found.geom, found.fraction) == (box, 0.0)


def test_a_sweep_passes_what_it_is_told_to_pass():
    world = an_empty_world()
    near = placed(world, oo.Box((1, 1, 1)), oo.Pose(oo.Vec3(2, 0, 0)))
    far = placed(world, oo.Box((1, 1, 1)), oo.Pose(oo.Vec3(5, 0, 0)))
    sensor = placed(world, oo.Box((1, 1, 1)), oo.Pose(oo.Vec3(8, 0, 0)))
    shape = oo.Sphere(0.25)
    assert world.sweep(shape, (0, 0, 0), (9, 0, 0)).geom is near
    assert world.sweep(shape, (0, 0, 0), (9, 0, 0), exclude=[near]).geom is far
    assert world.sweep(shape, (0, 0, 0), (9, 0, 0), exclude=[near, far]).geom is sensor
    far.enabled = False
    assert world.children[0].sweep(shape, (0, 0, 0), (9, 0, 0), exclude=[near]).geom is sensor
    assert world.sweep(shape, (0, 0, 0), (0, 9, 0)) is None
    assert world.sweep(shape, (0, 0, 0), (0, 0, 0)) is None


def test_asking_leaves_everything_as_it_was():
    world = an_empty_world()
    placed(world, oo.Box((1, 1, 1)), oo.Pose(oo.Vec3(2, 0, 0)))
    shape = oo.ConvexHull(TETRA)
    world.sweep(shape, (0, 0, 0), (9, 0, 0))  # ODE keeps a block or two for the next geom
    before = oo.live_natives()
    for _ in range(3):
        world.sweep(shape, (0, 0, 0), (9, 0, 0))
    assert oo.live_natives() == before
    assert not shape.is_live


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda w, _: w.sweep("ball", (0, 0, 0), (1, 0, 0)), oo.TreeError, "shape is 'ball'; it must be a geom"),
        (lambda w, g: w.sweep(g, (0, 0, 0), (1, 0, 0)), oo.TreeError, "that is in no World"),
        (lambda w, _: w.sweep(oo.Sphere(), (math.nan, 0, 0), (1, 0, 0)), oo.FieldError, "position is"),
        (lambda w, _: w.sweep(oo.Sphere(), (0, 0, 0), (1e7, 0, 0)), oo.FieldError, "motion is"),
        (lambda w, _: w.sweep(oo.Plane(), (0, 0, 0), (1, 0, 0)), oo.FieldError, "shape is Plane; it must be a Sphere"),
        (lambda w, _: w.sweep(oo.Trimesh(TETRA), (0, 0, 0), (1, 0, 0)), oo.FieldError, "it must be a Sphere, Box"),
        (lambda w, _: w.sweep(oo.Sphere(), (0, 0, 0), (1, 0, 0), kinds="nobody"), oo.FieldError, "kinds is"),
        (lambda _, g: g.closest_to(g), oo.TreeError, "it must be another geom"),
        (lambda _, g: g.closest_to(oo.Sphere()), oo.TreeError, "of the same World"),
        (lambda _, g: g.closest_to(None), oo.TreeError, "other is None"),
        (lambda _, g: oo.Sphere().closest_to(g), oo.StateError, "needs a World"),
    ],
)
def test_bad_questions_about_shapes_are_refused(call, error, words):
    world = an_empty_world()
    geom = placed(world, oo.Box((1, 1, 1)), oo.Pose())
    with pytest.raises(error, match=words):
        call(world, geom)


def test_two_surfaces_have_no_closest_points():
    world = an_empty_world()
    one, two = (placed(world, oo.Trimesh(TETRA), oo.Pose(oo.Vec3(x, 0, 0))) for x in (0, 5))
    with pytest.raises(oo.FieldError, match="one of the two is Trimesh; it must be a Sphere, Box"):
        one.closest_to(two)
