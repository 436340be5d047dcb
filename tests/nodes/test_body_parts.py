"""Bodies whose parts change: what stays, who decides, and what is told; beside the machine that draws such changes."""

import math
import threading
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.native import ffi, lib
from tests.strategies import CUBE, poses, rotations, vectors


def near(expected, tolerance=1e-9):
    return pytest.approx(tuple(expected), abs=tolerance)


def part(position, mass=1.0, radius=0.25):
    place = oo.Placeable(position=position)
    place.attach(oo.Sphere(radius, mass=mass))
    return place


def dumbbell(**fields):
    """Two balls of 1 kg, 2 m apart along x, in a World without gravity; the centre of mass at x = 1 of the frame."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body(name="it", **fields))
    left, right = body.attach(part((0, 0, 0))), body.attach(part((2, 0, 0)))
    return world, body, left, right


def native_position(body):
    return tuple(ffi.unpack(lib.dBodyGetPosition(body._id), 3))


# -- keeping the reference point


@given(poses(), vectors(3), vectors(2), st.booleans())
@settings(max_examples=40)
def test_the_geometry_shifts_against_what_the_centre_moves(pose, velocity, spin, live):
    """Another ball of 1 kg at x = 4 moves the centre from 1 to 2: all geoms go back by 1 along the body's x."""
    world, body, left, right = dumbbell(position=pose.position, rotation=pose.rotation)
    body.linear_velocity, body.angular_velocity = velocity, spin
    if not live:
        world.detach(body)
    centre, drift = body.world_centre_of_mass, body.centre_of_mass_velocity
    wheres = [place.children[0].pose.position for place in (left, right)]
    with body.keeping_reference_point():
        body.attach(part((4, 0, 0)))
    shift = pose.rotation.rotate((1, 0, 0))
    assert body.centre_of_mass == near((2, 0, 0))
    assert body.world_centre_of_mass == near(centre)
    assert body.position == near(pose.position - shift)
    assert body.rotation == near(pose.rotation)
    for place, where in zip((left, right), wheres, strict=True):
        assert place.children[0].pose.position == near(where - shift)
    assert body.centre_of_mass_velocity == near(drift)
    assert body.angular_velocity == near(spin)
    assert body.linear_velocity == near(drift - spin.cross(pose.rotation.rotate((2, 0, 0))))


def test_the_native_stays_to_the_bit_and_so_do_joints_on_it():
    world, body, _, right = dumbbell(position=(1, 2, 3), rotation=oo.Quat.from_axis_angle((1, 2, 3), 1.0))
    hinge = oo.Hinge(body, anchor=(1, 2, 4), axis=(0, 1, 1))
    body.angular_velocity = (0, 1, 1)
    world.step(5)
    before = native_position(body), hinge._id, hinge.angle, hinge.anchor, hinge.axis
    assert before[2] != 0
    with body.keeping_reference_point():
        right.position = (5, 1, 1)
    assert (native_position(body), hinge._id, hinge.angle) == before[:3]
    assert hinge.anchor == near(before[3])
    assert hinge.axis == near(before[4])
    world.detach(body)
    world.attach(body)
    assert hinge.anchor == near(before[3])
    assert hinge.axis == near(before[4])
    assert hinge.angle == pytest.approx(before[2], abs=1e-9)


def test_the_picture_is_where_the_frame_is_at_once():
    world, body, _, right = dumbbell()
    world.step(2)
    with body.keeping_reference_point():
        body.detach(right)
    for table in (world.poses, world.previous_poses):
        assert tuple(table[0][:3]) == near(body.position)
    assert body.position == near((1, 0, 0))


def test_blocks_may_stand_in_one_another_and_end_with_errors():
    """Only when the outermost has ended does the geometry stay again; what was changed until an error has shifted."""
    _world, body, left, right = dumbbell()
    with body.keeping_reference_point():
        with body.keeping_reference_point():
            body.detach(right)
        assert body.position == near((1, 0, 0))
        left.position = (3, 0, 0)
        with pytest.raises(oo.FieldError), body.keeping_reference_point():
            left.position = (math.nan, 0, 0)
        assert body.position == near((-2, 0, 0))
        body.detach(left)
        body.attach(left)
    assert body.position == near((-2, 0, 0))
    assert body.world_centre_of_mass == near((1, 0, 0))
    left.position = (0, 0, 0)
    assert body.position == near((-2, 0, 0))


def test_a_shift_out_of_bounds_is_refused_and_changes_nothing():
    world, body, left, _ = dumbbell(position=(9.9e7, 0, 0))
    for live in (True, False):
        if not live:
            world.detach(body)
        before = body.position, body.mass_properties, left.position
        with pytest.raises(oo.FieldError, match=r"Body 'it'\.position"), body.keeping_reference_point():
            left.position = (-2e7, 0, 0)
        assert (body.position, body.mass_properties, left.position) == before


def test_coming_and_going_in_a_block_moves_nothing():
    world, body, _, right = dumbbell(position=(1, 1, 1))
    other = oo.World()
    with body.keeping_reference_point():
        body.move_to(other)
        body.detach(right)
        other.step()
        world.attach(other.detach(body))
    assert body.centre_of_mass == near((0, 0, 0))
    assert native_position(body) == near(body.position)
    assert body.position.distance((2, 1, 1)) < 0.01  # that World has gravity


def test_nobody_else_may_step_during_a_block():
    world, body, _, right = dumbbell()
    seen = []

    def step():
        try:
            world.step()
        except oo.StateError as error:
            seen.append(str(error))

    with body.keeping_reference_point():
        thread = threading.Thread(target=step)
        thread.start()
        thread.join()
        body.detach(right)
        world.step()  # but oneself may
    assert len(seen) == 1
    assert "another thread" in seen[0]
    thread = threading.Thread(target=step)
    thread.start()
    thread.join()
    assert len(seen) == 1


# -- recentring by hand


@pytest.mark.parametrize("live", [True, False])
def test_without_automatic_recentring_the_mass_in_force_stays(live):
    world, body, _left, right = dumbbell()
    body.auto_recentre = False
    if not live:
        world.detach(body)
    before = body.mass_properties
    body.detach(right)
    body.attach(part((0, 3, 0), mass=3.0))
    assert body.mass_properties is before
    assert (body.mass, body.centre_of_mass) == (2.0, (1, 0, 0))
    assert np.array_equal(body.inertia, before.inertia)
    assert body.parts_mass.mass == 4.0
    assert body.parts_mass.centre == near((0, 2.25, 0))
    if live:
        assert body._com == (1, 0, 0)
    frame = body.position
    body.recentre()
    assert (body.mass, body.centre_of_mass) == (4.0, near((0, 2.25, 0)))
    assert body.position == near(frame)


def test_a_mass_in_force_goes_along_out_in_over_and_into_copies():
    world, body, _, right = dumbbell()
    body.auto_recentre = False
    body.detach(right)
    other = oo.World()
    for act in (
        lambda: world.detach(body),
        lambda: world.attach(body),
        lambda: body.move_to(other),
        lambda: body.move_to(world),
    ):
        act()
        assert (body.mass, body.centre_of_mass) == (2.0, (1, 0, 0))
    twin = body.copy()
    assert (twin.mass, twin.centre_of_mass, twin.auto_recentre) == (2.0, (1, 0, 0), False)
    world.attach(twin)
    out = ffi.new("dMass *")
    lib.dBodyGetMass(twin._id, out)
    assert out.mass == 2.0
    twin.recentre()
    assert twin.mass == 1.0
    assert body.mass == 2.0


def test_switching_it_on_again_recentres_at_once():
    _, body, _, right = dumbbell()
    body.auto_recentre = False
    body.detach(right)
    body.auto_recentre = True
    assert (body.mass, body.centre_of_mass) == (1.0, (0, 0, 0))


def test_a_body_that_was_never_recentred_has_the_mass_of_an_empty_one():
    body = oo.Body(auto_recentre=False)
    body.attach(part((1, 0, 0), mass=5.0))
    assert (body.mass, body.centre_of_mass) == (1.0, (0, 0, 0))
    body.recentre()
    assert (body.mass, body.centre_of_mass) == (5.0, (1, 0, 0))


def test_a_fixed_mass_counts_at_once_in_any_case():
    for auto in (True, False):
        _, body, _, _ = dumbbell()
        body.auto_recentre = auto
        body.fixed_mass = oo.Mass.sphere(1.0, mass=7.0)
        assert body.mass == 7.0
        assert body.parts_mass.mass == 2.0
        body.fixed_mass = None
        assert body.mass == 2.0


def test_it_can_be_done_in_each_step():
    """A weight runs along a beam; recentred each step, the beam turns about where the weight is now."""
    world = oo.World(gravity=(0, 0, 0))
    beam = world.attach(oo.Body(auto_recentre=False))
    beam.attach(oo.Placeable()).attach(oo.Box((4, 0.1, 0.1), mass=1.0))
    slide = beam.attach(part((0, 0, 0), mass=3.0))
    beam.recentre()
    beam.angular_velocity = (0, 1, 0)
    for k in range(120):
        slide.position = (k / 120, 0, 0)
        assert beam.centre_of_mass.x == pytest.approx(0.75 * max(k - 1, 0) / 120)
        beam.recentre()
        assert beam.centre_of_mass.x == pytest.approx(0.75 * k / 120)
        world.step()


def test_recentring_refuses_while_another_thread_steps():
    world, body, _, right = dumbbell()
    body.auto_recentre = False
    body.detach(right)
    failed = []

    def recentre():
        try:
            body.recentre()
        except oo.StateError as error:
            failed.append(error)

    with world._realm.editing():
        thread = threading.Thread(target=recentre)
        thread.start()
        thread.join()
    assert failed
    assert body.mass == 2.0


# -- the inertia of many points

DENSITY = 50.0


def inside_box(p):
    return (np.abs(p) <= (0.4, 0.25, 0.3)).all(axis=1)


def inside_ball(p):
    return (p**2).sum(axis=1) <= 0.35**2


def inside_cylinder(p):
    return ((p[:, :2] ** 2).sum(axis=1) <= 0.3**2) & (np.abs(p[:, 2]) <= 0.4)


def inside_capsule(p):
    return (p[:, :2] ** 2).sum(axis=1) + np.maximum(np.abs(p[:, 2]) - 0.3, 0) ** 2 <= 0.2**2


def inside_mesh(p):
    """Half of the cube of CUBE: the wedge under its diagonal plane x + y = 0."""
    return (np.abs(p) <= 0.5).all(axis=1) & (p[:, 0] + p[:, 1] <= 0)


WEDGE = oo.MeshData(
    [(-0.5, -0.5, -0.5), (0.5, -0.5, -0.5), (-0.5, 0.5, -0.5), (-0.5, -0.5, 0.5), (0.5, -0.5, 0.5), (-0.5, 0.5, 0.5)],
    [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)],
)
SOLIDS = [
    (lambda: oo.Box((0.8, 0.5, 0.6), density=DENSITY), inside_box),
    (lambda: oo.Sphere(0.35, density=DENSITY), inside_ball),
    (lambda: oo.Cylinder(0.3, 0.8, density=DENSITY), inside_cylinder),
    (lambda: oo.Capsule(0.2, 0.6, density=DENSITY), inside_capsule),
    (lambda: oo.Trimesh(WEDGE, density=DENSITY), inside_mesh),
]
FAULT = 0.01
"""Of the sampling: a solid fills at least 1 / 10 of the box that 400 000 points are in, so its mass is right to
sqrt(9 / 400 000) = 1 / 200, as a standard deviation."""


@cache
def points_in(inside):
    """Of 400 000 random points of a box of edge 1.2 those within the solid, and what each weighs."""
    points = np.random.default_rng(7).uniform(-0.6, 0.6, (400_000, 3))
    return points[inside(points)], DENSITY * 1.2**3 / len(points)


def sampled(inside, pose):
    """The same in the body's frame."""
    points, weight = points_in(inside)
    return points @ np.array(pose.rotation.to_matrix()).T + np.array(pose.position), weight


@given(st.lists(st.tuples(st.sampled_from(SOLIDS), poses(1.5)), min_size=2, max_size=5), rotations())
@settings(max_examples=8)
def test_a_body_of_parts_is_what_many_points_of_it_are(parts, rotation):
    """Mass, centre and inertia against brute force, after the parts have come, moved, and one has gone again."""
    world = oo.World()
    body = world.attach(oo.Body(position=(1, 2, 3), rotation=rotation))
    gone = body.attach(part((1, 1, 1), mass=9.0))
    points = []
    for (make, inside), pose in parts:
        place = body.attach(oo.Placeable())
        place.attach(make())
        place.position, place.rotation = pose
        points.append(sampled(inside, pose))
    body.detach(gone)
    weights = np.concatenate([np.full(len(some), each) for some, each in points])
    where = np.concatenate([some for some, _ in points])
    total = weights.sum()
    centre = weights @ where / total
    arms = where - centre
    second = (weights[:, None] * arms).T @ arms
    inertia = np.trace(second) * np.identity(3) - second
    size = 1 + float(np.abs(where).max())
    assert body.mass == pytest.approx(total, rel=2 * FAULT)
    assert body.centre_of_mass == near(centre, 2 * FAULT * size)
    assert body.inertia == pytest.approx(inertia, abs=4 * FAULT * float(np.trace(inertia)))
    turn = np.array(rotation.to_matrix())
    assert body.world_inertia == pytest.approx(turn @ inertia @ turn.T, abs=4 * FAULT * float(np.trace(inertia)))


def test_an_inertia_that_is_wrong_by_a_twentieth_would_be_noticed():
    """The tolerance of the sampling above is not so wide that anything passes."""
    points, weight = sampled(inside_box, oo.Pose())
    inertia = (np.trace(points.T @ points) * np.identity(3) - points.T @ points) * weight
    wrong = oo.Box((0.8, 0.5, 0.6), density=DENSITY)._shape_mass(density=1.15 * DENSITY)
    assert np.abs(np.array(wrong.inertia) - inertia).max() > 4 * FAULT * np.trace(inertia)


# -- what a body tells and takes beside (N4)


@given(poses(), vectors(3), vectors(2), st.booleans())
@settings(max_examples=30)
def test_the_velocity_of_the_centre_can_be_set(pose, velocity, spin, live):
    world, body, _, _ = dumbbell(position=pose.position, rotation=pose.rotation)
    body.angular_velocity = spin
    if not live:
        world.detach(body)
    body.centre_of_mass_velocity = velocity
    assert body.centre_of_mass_velocity == near(velocity)
    assert body.angular_velocity == spin
    assert body.linear_velocity == near(velocity - spin.cross(pose.rotation.rotate((1, 0, 0))))


@given(poses(), vectors(5), vectors(2))
@settings(max_examples=30)
def test_impulses_may_be_given_in_body_axes(pose, impulse, point):
    """As the same in world axes."""
    _world, one, _, _ = dumbbell(position=pose.position, rotation=pose.rotation)
    _other_world, other, _, _ = dumbbell(position=pose.position, rotation=pose.rotation)
    one.apply_local_impulse(impulse, at=point)
    other.apply_impulse(one.vector_to_world(impulse), at=one.local_to_world(point))
    one.apply_local_impulse(impulse)
    other.apply_impulse(one.vector_to_world(impulse))
    one.apply_local_angular_impulse(impulse)
    other.apply_angular_impulse(one.vector_to_world(impulse))
    assert one.linear_velocity == near(other.linear_velocity)
    assert one.angular_velocity == near(other.angular_velocity)
    assert one.momentum == near(pose.rotation.rotate(impulse * 2), 1e-8)


def test_asleep_is_told():
    world, body, _, _ = dumbbell()
    assert not body.asleep
    body.enabled = False
    assert body.asleep
    world.detach(body)
    assert body.asleep
    world.attach(body)
    assert body.asleep
    body.wake()
    assert not body.asleep


def test_a_cube_of_triangles_is_a_part_like_any():
    """B1: an open mesh gives no mass, and says so; a closed one does."""
    body = oo.Body()
    body.attach(oo.Placeable(position=(1, 0, 0))).attach(oo.Trimesh(CUBE, mass=6.0))
    assert body.centre_of_mass == near((1, 0, 0))
    assert body.inertia == pytest.approx(np.identity(3))


@pytest.mark.parametrize("mass", [0.0, 1.0])
def test_a_geom_that_moves_to_another_place_of_its_body_is_there(mass):
    """Also where that changes no mass: a weightless part, or a body that does not follow its parts."""
    world = oo.World()
    body = world.attach(oo.Body(auto_recentre=mass == 0.0))
    here, there = body.attach(oo.Placeable()), body.attach(oo.Placeable(position=(3, 0, 0), rotation=(0, 1, 0, 0)))
    geom = here.attach(oo.Box(mass=mass))
    geom.move_to(there)
    assert tuple(ffi.unpack(lib.dGeomGetPosition(geom._id), 3)) == near((3, 0, 0))
    out = ffi.new("dQuaternion")
    lib.dGeomGetQuaternion(geom._id, out)
    assert tuple(out) == near((0, 1, 0, 0))
    geom.move_to(here)
    assert tuple(ffi.unpack(lib.dGeomGetPosition(geom._id), 3)) == near((0, 0, 0))


def test_a_static_geom_that_moves_to_another_place_is_there():
    world = oo.World()
    space = world.attach(oo.HashSpace())
    here, there = space.attach(oo.Placeable(position=(1, 0, 0))), space.attach(oo.Placeable(position=(3, 0, 0)))
    geom = here.attach(oo.Box())
    for place in (there, space, here):
        geom.move_to(place)
        wanted = place.position if isinstance(place, oo.Placeable) else (0, 0, 0)
        assert tuple(ffi.unpack(lib.dGeomGetPosition(geom._id), 3)) == near(wanted)
        low, high = geom.bounds
        assert (low + high) / 2 == near(wanted)


def test_a_body_that_enters_at_the_origin_has_its_centre_where_its_parts_are():
    """Nothing of its state was recorded then, so nothing else would put it there."""
    body = oo.Body()
    body.attach(part((1, 2, 3)))
    world = oo.World()
    world.attach(body)
    assert native_position(body) == (1, 2, 3)
    assert body.position == (0, 0, 0)
