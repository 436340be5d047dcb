"""Kinematic bodies that glide: where they are in each step, what they carry and push, and what ends it."""

import gc
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.native import lib
from tests.strategies import floats, poses

STEP = 1 / 120
NAN, INF = math.nan, math.inf


def near(expected, tolerance=1e-9):
    return pytest.approx(tuple(expected), abs=tolerance)


def same_turn(one, other, tolerance=1e-12):
    return abs(abs(sum(a * b for a, b in zip(one, other, strict=True))) - 1) <= tolerance


def lopsided(**fields):
    """A kinematic body whose centre of mass is away from its frame, in a World without gravity."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body(name="it", kinematic=True, **fields))
    body.attach(oo.Placeable(position=(0.5, 0.25, -1.0))).attach(oo.Box((1, 2, 0.5), mass=3.0))
    return world, body


def stage(**settings_):
    """A World with gravity, a space that is collided, and a platform 4 m x 0.2 m x 4 m with its top at 0."""
    world = oo.World(**settings_)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    platform = space.attach(oo.Body(name="platform", position=(0, -0.1, 0), kinematic=True))
    platform.attach(oo.Placeable()).attach(oo.Box((4, 0.2, 4)))
    return world, space, platform


def crate(space, position, edge=0.5, mass=10.0):
    body = space.attach(oo.Body(name="crate", position=position))
    body.attach(oo.Placeable()).attach(oo.Box((edge, edge, edge), mass=mass))
    return body


# -- where it is


@given(poses(), poses(), st.integers(1, 40))
@settings(max_examples=40)
def test_it_arrives_at_the_very_bits_and_stands_still(start, end, steps):
    """As if position and rotation had been set, wherever the centre of mass is; and there it stays."""
    world, body = lopsided(position=start.position, rotation=start.rotation)
    _other, twin = lopsided(position=start.position, rotation=start.rotation)
    twin.rotation, twin.position = end.rotation, end.position
    body.glide_to(end.position, end.rotation, seconds=steps * STEP)
    world.step(steps - 1)
    assert body.gliding
    world.step()
    assert not body.gliding
    assert (body.position, body.rotation) == (twin.position, twin.rotation)
    assert body.linear_velocity == body.angular_velocity == (0, 0, 0)
    world.step(5)  # in which ODE normalises the quaternion of each body anew, which may change its last bit
    assert body.position == near(twin.position, 1e-12)
    assert body.rotation == near(twin.rotation, 1e-15)
    assert body.linear_velocity == body.angular_velocity == (0, 0, 0)


def test_without_an_offset_the_bits_are_those_that_were_asked_for():
    world = oo.World()
    body = world.attach(oo.Body(kinematic=True))
    target = (0.1, 1 / 3, 1e5 / 7)
    body.glide_to(target, seconds=0.7)
    world.run(0.7)
    assert body.position == target


@given(poses(), poses(), st.integers(2, 30))
@settings(max_examples=40)
def test_on_its_way_it_moves_linearly_and_turns_evenly(start, end, steps):
    """After k of n steps: p + (q - p) k / n, and the part k / n of the shorter turn; the velocities are that way's."""
    world, body = lopsided(position=start.position, rotation=start.rotation)
    whole = end.rotation * start.rotation.conjugate()
    whole = whole if whole.w >= 0 else oo.Quat(*(-part for part in whole))
    body.glide_to(end.position, end.rotation, seconds=steps * STEP)
    for k in range(1, steps + 1):
        centre = body.world_centre_of_mass
        world.step()
        assert body.position == near(start.position + (end.position - start.position) * (k / steps), 1e-8)
        turned = body.rotation * start.rotation.conjugate()
        assert turned.angle == pytest.approx(whole.angle * k / steps, abs=1e-6)
        if k < steps:
            moved = (body.world_centre_of_mass - centre) / STEP
            assert body.centre_of_mass_velocity == near(moved, 1e-6 * (1 + moved.length))
            rate = whole.angle / (steps * STEP)
            assert body.angular_velocity.length == pytest.approx(rate, rel=1e-6, abs=1e-6)
            if 1e-3 < whole.angle < math.pi - 1e-3:  # half a turn has two shorter ways
                axis = oo.Vec3(*whole[1:]).normalized()
                assert body.angular_velocity.dot(axis) == pytest.approx(rate, rel=1e-6)


def test_it_turns_the_shorter_way_whatever_the_sign():
    """Quaternions q and -q are the same rotation."""
    for sign in (1, -1):
        world, body = lopsided()
        quarter = oo.Quat.from_axis_angle((0, 1, 0), math.pi / 2)
        body.glide_to(rotation=[sign * part for part in quarter], seconds=1.0)
        world.run(0.5)
        assert same_turn(body.rotation, oo.Quat.from_axis_angle((0, 1, 0), math.pi / 4))
        assert body.angular_velocity == near((0, math.pi / 2, 0), 1e-6)


def test_what_is_not_given_stays():
    turn = oo.Quat.from_axis_angle((1, 2, 3), 1.0)
    world, body = lopsided(position=(1, 2, 3), rotation=turn)
    body.glide_to((4, 5, 6), seconds=0.1)
    world.run(0.1)
    assert body.position == near((4, 5, 6))
    assert same_turn(body.rotation, turn)
    body.glide_to(rotation=(1, 0, 0, 0))
    world.step()
    assert body.position == near((4, 5, 6))
    assert same_turn(body.rotation, (1, 0, 0, 0))


@pytest.mark.parametrize(
    ("seconds", "steps"),
    [(None, 1), (0, 1), (0.2 * STEP, 1), (1.4 * STEP, 1), (1.6 * STEP, 2), (10 * STEP, 10), (0.5, 60)],
)
def test_time_is_rounded_to_whole_steps(seconds, steps):
    world, body = lopsided()
    body.glide_to((1, 0, 0), seconds=seconds)
    world.step(steps - 1)
    assert body.position.x == pytest.approx((steps - 1) / steps)
    assert body.gliding
    world.step()
    assert body.position == near((1, 0, 0))
    assert not body.gliding


@pytest.mark.parametrize(("later", "steps"), [(STEP / 4, 240), (STEP * 2, 30), (1.0, 1)])
def test_when_the_step_size_changes_the_time_stays(later, steps):
    """A half second of one second is left: 0.5 / later steps, at least one, at the speed that this takes."""
    world, body = lopsided()
    body.glide_to((1, 0, 0), seconds=1.0)
    world.step(60)
    world.step_size = later
    world.step(steps - 1)
    assert body.gliding
    if steps > 1:
        assert body.linear_velocity.x == pytest.approx(1.0)
    world.step()
    assert not body.gliding
    assert body.position == near((1, 0, 0))


def test_many_steps_in_one_call_are_many_calls():
    """To the bit, with what it carries; also where a listener ends the calls into C early."""
    ends = []
    for chunks in ([60], [1] * 60, [7, 13, 40]):
        for listening in (False, True):
            world, space, platform = stage()
            box = crate(space, (0.1, 0.26, 0.2))
            if listening:
                box.on_touch(lambda touch: None)
            platform.glide_to((1, 0.5, 0.3), oo.Quat.from_axis_angle((0, 1, 0), 0.5), seconds=0.4)
            for count in chunks:
                world.step(count)
            ends.append((platform.position, platform.rotation, box.position, box.rotation, box.linear_velocity))
    assert all(end == ends[0] for end in ends)


def test_damping_and_limits_of_speed_do_not_hold_it_back():
    world, body = lopsided(linear_damping=0.5, angular_damping=0.5, max_angular_speed=0.1)
    half = oo.Quat.from_axis_angle((0, 1, 0), 2.0)
    body.glide_to((3, 0, 0), half, seconds=1.0)
    world.run(0.5)
    assert body.position == near((1.5, 0, 0), 1e-9)
    assert body.angular_velocity == near((0, 2, 0))
    world.run(0.5)
    assert same_turn(body.rotation, half)


def test_several_glide_at_once_and_some_leave_meanwhile():
    """The last body takes the row of one that leaves, and its glide goes along."""
    world = oo.World(gravity=(0, 0, 0))
    bodies = [world.attach(oo.Body(position=(i, 0, 0), kinematic=True)) for i in range(6)]
    for i, body in enumerate(bodies):
        body.glide_to((i, 1.0 + i, 0), seconds=0.5 if i % 2 else 1.0)
    world.run(0.25)
    for gone in (0, 3, 5):
        world.detach(bodies[gone])
        assert not bodies[gone].gliding
    world.run(0.25)
    assert [body.gliding for body in bodies] == [False, False, True, False, True, False]
    world.run(0.5)
    for i in (1, 2, 4):
        assert bodies[i].position == near((i, 1.0 + i, 0))


@given(floats(0.1, 2), st.booleans())
@settings(max_examples=15)
def test_parts_may_come_on_the_way(offset, keeping):
    """Its frame arrives, though its centre of mass is elsewhere now."""
    world, body = lopsided()
    body.glide_to((1, 2, 3), (0, 1, 0, 0), seconds=0.2)
    world.run(0.1)
    part = oo.Placeable(position=(offset, 1, 0))
    part.attach(oo.Sphere(0.3, mass=2.0))
    if keeping:
        with body.keeping_reference_point():
            body.attach(part)
    else:
        body.attach(part)
    world.run(0.1)
    assert body.position == near((1, 2, 3))
    assert same_turn(body.rotation, (0, 1, 0, 0))
    assert not body.gliding


# -- what ends it

NEW_VELOCITY = (0.5, 0.25, 0)
ENDS = {
    "position": (lambda body: setattr(body, "position", (9, 9, 9)), (0, 0, 0), (0, 0, 0)),
    "rotation": (lambda body: setattr(body, "rotation", (0, 0, 1, 0)), (0, 0, 0), (0, 0, 0)),
    "linear_velocity": (lambda body: setattr(body, "linear_velocity", NEW_VELOCITY), NEW_VELOCITY, (0, 0, 0)),
    "angular_velocity": (lambda body: setattr(body, "angular_velocity", NEW_VELOCITY), (0, 0, 0), NEW_VELOCITY),
    "enabled": (lambda body: setattr(body, "enabled", False), (0, 0, 0), (0, 0, 0)),
    "stop_gliding": (lambda body: body.stop_gliding(), (0, 0, 0), (0, 0, 0)),
}


def under_way():
    world, body = lopsided()
    body.glide_to((1, 2, 0), oo.Quat.from_axis_angle((0, 1, 0), 1.0), seconds=1.0)
    world.run(0.5)
    return world, body


@pytest.mark.parametrize("act", ENDS)
def test_what_is_set_by_hand_ends_it_and_is_all_that_is_in_force(act):
    end, linear, angular = ENDS[act]
    world, body = under_way()
    end(body)
    assert not body.gliding
    assert body.linear_velocity == near(linear)
    assert body.angular_velocity == near(angular)
    there = body.position
    if act == "position":
        assert there == near((9, 9, 9))
    if linear == angular == (0, 0, 0):
        world.run(1.0)
        assert body.position == near(there)


def test_what_cannot_be_set_does_not_end_it():
    world, body = under_way()
    for name, bad in (("position", (NAN, 0, 0)), ("linear_velocity", (1e12, 0, 0)), ("enabled", "yes")):
        with pytest.raises(oo.FieldError):
            setattr(body, name, bad)
    for call in (
        lambda: body.glide_to((NAN, 0, 0)),
        lambda: body.glide_to(seconds=1.0),
        lambda: body.glide_to((1, 0, 0), seconds=-1),
    ):
        with pytest.raises(oo.FieldError):
            call()
    assert body.gliding
    world.run(0.5)
    assert body.position == near((1, 2, 0))


def test_a_new_target_takes_the_place_of_the_old():
    world, body = under_way()
    here = body.position
    body.glide_to((0, 0, 5), seconds=1.0)
    world.run(0.5)
    assert body.position == near((here + oo.Vec3(0, 0, 5)) / 2)
    world.run(0.5)
    assert body.position == near((0, 0, 5))


def test_a_body_that_becomes_dynamic_flies_on():
    world, body = under_way()
    here, velocity = body.world_centre_of_mass, body.centre_of_mass_velocity
    body.kinematic = False
    assert not body.gliding
    assert velocity.length > 1.0
    assert body.centre_of_mass_velocity == near(velocity)
    assert body.angular_velocity == near((0, 1, 0))
    world.run(1.0)
    assert body.world_centre_of_mass == near(here + velocity)


def test_leaving_the_world_ends_it():
    world, body = under_way()
    space = world.attach(oo.SimpleSpace())
    body.move_to(space)
    assert body.gliding
    here = body.position
    space.detach(body)
    assert not body.gliding
    assert body.linear_velocity == body.angular_velocity == (0, 0, 0)
    world.attach(body)
    world.run(1.0)
    assert body.position == near(here)
    body.glide_to((0, 0, 0), seconds=1.0)
    world.step()
    other = oo.World()
    body.move_to(other)
    assert not body.gliding
    assert body.linear_velocity == (0, 0, 0)
    body.glide_to((0, 0, 0), seconds=1.0)
    other.step()
    del other
    gc.collect()
    assert body.linear_velocity == (0, 0, 0)
    assert not body.gliding


def test_a_copy_stays_where_the_body_is():
    world, body = under_way()
    twin = body.copy()
    assert twin.position == body.position
    assert twin.linear_velocity == twin.angular_velocity == (0, 0, 0)
    world.attach(twin)
    assert not twin.gliding
    assert body.gliding


def test_a_step_that_fails_is_made_up_for():
    """A body out of bounds stops the World; when it is gone, the platform goes on to where it was sent."""
    world, body = under_way()
    bad = world.attach(oo.Body(position=(9.99e7, 0, 0), linear_velocity=(1e9, 0, 0)))
    with pytest.raises(oo.PhysicsError):
        world.step(10)
    world.detach(bad)
    world.run(0.5)
    assert body.position == near((1, 2, 0))
    assert not body.gliding


# -- what is refused


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"position": (NAN, 0, 0)}, "position"),
        ({"position": (0, 1e9, 0)}, "position"),
        ({"position": (1, 2)}, "position"),
        ({"position": "there"}, "position"),
        ({"rotation": (0, 0, 0, 0)}, "rotation"),
        ({"rotation": (1, 0, 0)}, "rotation"),
        ({"rotation": (NAN, 0, 0, 1)}, "rotation"),
        ({}, "position or rotation"),
        ({"position": (1, 0, 0), "seconds": -1}, "seconds"),
        ({"position": (1, 0, 0), "seconds": NAN}, "seconds"),
        ({"position": (1, 0, 0), "seconds": INF}, "seconds"),
        ({"position": (1, 0, 0), "seconds": "soon"}, "seconds"),
        ({"position": (9e7, 0, 0)}, "more seconds"),
    ],
    ids=str,
)
def test_a_way_that_cannot_be_gone_is_refused(arguments, words):
    world, body = lopsided()
    with pytest.raises(oo.FieldError, match=rf"Body 'it'\.glide_to\(\).*{words}"):
        body.glide_to(**arguments)
    assert not body.gliding
    world.step()
    assert body.position == (0, 0, 0)


def test_only_a_kinematic_body_in_a_world_glides():
    with pytest.raises(oo.StateError, match=r"Body 'it': glide_to needs a World"):
        oo.Body(name="it", kinematic=True).glide_to((1, 0, 0))
    world = oo.World()
    body = world.attach(oo.Body(name="it"))
    with pytest.raises(oo.StateError, match=r"Body 'it'.*not kinematic.*kinematic=True"):
        body.glide_to((1, 0, 0))
    body.stop_gliding()
    oo.Body().stop_gliding()


def test_when_nobody_glides_there_is_nothing_to_do():
    world, body = under_way()
    ptr = world._realm.ptr
    assert ptr.glide_count == 1
    world.run(0.5)
    assert ptr.glide_count == 0
    assert not lib.oo_glides(ptr, body._index)
    assert np.array_equal(world.velocities, np.zeros((1, 6)))
