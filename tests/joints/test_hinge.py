"""The hinge: the sign of its angle, rate, torque and motor, and anchoring it anew."""

import math

import pytest

import osgode as oo
from tests.joints.held import (
    ANCHOR,
    AXIS,
    HINGE,
    REST1,
    REST2,
    RIDE,
    Held,
    assert_poses,
    each_attachment,
    put,
    shift,
    solid,
    turn,
    twist,
)

ANGLES = [-3.0, -math.pi / 2, -0.4, -1e-3, 0.0, 0.3, 1.7, 3.1]


def stand(order: str):
    """A World, the bodies in the order in which they are joined, and the hinge."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    a, b = world.attach(solid(REST1, "a")), world.attach(solid(REST2, "b"))
    pair = {"a, b": (a, b), "b, a": (b, a), "a, None": (a, None), "b, None": (b, None)}[order]
    return world, pair, oo.Hinge(*pair, anchor=ANCHOR, axis=AXIS)


each_order = pytest.mark.parametrize("order", ["a, b", "b, a", "a, None", "b, None"])


@each_order
@pytest.mark.parametrize("angle", ANGLES)
def test_the_angle_is_that_of_body1_by_the_right_hand_rule(order, angle):
    """However the pair has moved since, as seen by a mark on body1 that turns about the axis as body2 sees it."""
    _world, (first, second), hinge = stand(order)
    rests = [first.pose, second.pose] if second else [first.pose]
    ride = RIDE if second else shift((0, 0, 0))
    put(first, ride * turn(angle) * rests[0])
    if second:
        put(second, ride * rests[1])
    assert hinge.angle == pytest.approx(angle, abs=1e-9)
    moved = first.rotation * rests[0].rotation.conjugate()
    seen = (second.rotation * rests[1].rotation.conjugate()).conjugate() * moved if second else moved
    assert hinge.angle == pytest.approx(twist(seen, AXIS), abs=1e-9)


@pytest.mark.parametrize("angle", ANGLES)
def test_turning_body2_turns_the_angle_back(angle):
    _world, (_, second), hinge = stand("a, b")
    put(second, turn(angle) * second.pose)
    assert hinge.angle == pytest.approx(-angle, abs=1e-9)


@pytest.mark.parametrize(
    ("turned", "angle"), [(4.0, 4.0 - 2 * math.pi), (-3.5, 2 * math.pi - 3.5), (6.5, 6.5 - 2 * math.pi)]
)
@each_order
def test_the_angle_is_within_half_a_turn(order, turned, angle):
    _world, (first, _), hinge = stand(order)
    put(first, turn(turned) * first.pose)
    assert hinge.angle == pytest.approx(angle, abs=1e-9)


@each_order
def test_the_rate_is_what_body1_turns_faster(order):
    _world, (first, second), hinge = stand(order)
    first.angular_velocity = AXIS * 1.75
    assert hinge.angle_rate == pytest.approx(1.75, abs=1e-12)
    if second:
        second.angular_velocity = AXIS * 0.5 + AXIS.cross((1, 0, 0))
        assert hinge.angle_rate == pytest.approx(1.25, abs=1e-12)


@each_order
def test_the_angle_grows_with_the_rate(order):
    """Over one short step from 0.5 rad, turning freely about the axis."""
    world, (first, second), hinge = stand(order)
    world.step_size = 1e-6
    put(first, turn(0.5) * first.pose)
    first.angular_velocity = AXIS * 2.0
    first.linear_velocity = first.angular_velocity.cross(first.position - ANCHOR)
    before = hinge.angle
    world.step()
    assert (hinge.angle - before) / 1e-6 == pytest.approx(hinge.angle_rate, rel=1e-4)
    assert hinge.angle > before or second


@each_order
def test_torque_and_motor_turn_body1_the_positive_way(order):
    world, (first, second), hinge = stand(order)
    hinge.add_torque(3.0)
    world.step()
    rate = hinge.angle_rate
    assert rate > 0
    assert first.angular_velocity.dot(AXIS) > 0
    if second:
        assert second.angular_velocity.dot(AXIS) < 0
    world.step()
    assert hinge.angle_rate == pytest.approx(rate, rel=0.05)  # for one step only
    hinge.motor(-1.5, 1e4)
    world.step(5)
    assert hinge.angle_rate == pytest.approx(-1.5, rel=1e-3)
    hinge.motor(1.5, 1e4)
    world.step(5)
    assert hinge.angle_rate == pytest.approx(1.5, rel=1e-3)
    assert (hinge.motor_velocity, hinge.motor_max_force) == (1.5, 1e4)


def test_torque_about_a_hinge_through_the_centre_is_torque_by_inertia():
    """Rate = torque h / I after one step; a box of 4 kg, 1 m by 0.4 m."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body())
    body.attach(oo.Placeable()).attach(oo.Box((1, 0.2, 0.4), mass=4))
    hinge = oo.Hinge(body)
    hinge.add_torque(-2.0)
    world.step()
    inertia = 4 / 12 * (1**2 + 0.4**2)
    assert hinge.angle_rate == pytest.approx(-2.0 / 120 / inertia, rel=1e-9)
    assert body.angular_velocity.y == pytest.approx(-2.0 / 120 / inertia, rel=1e-9)


@pytest.mark.parametrize("bad", [math.nan, math.inf, "x", None, (1, 2, 3)])
def test_bad_torques_are_refused(bad):
    _world, _, hinge = stand("a, b")
    with pytest.raises(oo.FieldError, match=r"Hinge\.add_torque\(\)\.torque is "):
        hinge.add_torque(bad)


def test_where_it_is_by_default():
    """At the origin of body1, upright."""
    hinge = oo.Hinge(oo.Body(position=(1, 2, 3)), oo.Body())
    assert hinge.anchor == hinge.anchor2 == (1, 2, 3)
    assert hinge.axis == (0, 1, 0)


@each_attachment
@pytest.mark.parametrize("live", [True, False])
def test_setting_the_anchor_anchors_it_anew(both, live):
    """At angle 0 with the axis of now, its fields kept; the angle counts from there."""
    held = Held(HINGE, both, fields=HINGE.fields)
    before, poses, axis = held.own(), [body.pose for body in held.bodies], held.joint.axis
    if not live:
        held.world.detach(held.space)
    held.joint.anchor = (5, -6, 7)
    if not live:
        held.world.attach(held.space)
    assert held.joint.anchor == pytest.approx((5, -6, 7), abs=1e-9)
    assert held.joint.anchor2 == pytest.approx((5, -6, 7), abs=1e-9)
    assert held.joint.axis == pytest.approx(axis, abs=1e-9)
    assert held.joint.angle == pytest.approx(0.0, abs=1e-9)
    assert held.own() == before
    assert_poses(held.bodies, poses, 0.0 if live else 1e-12)
    put(held.body1, turn(0.75, held.joint.anchor, axis) * held.body1.pose)
    assert held.joint.angle == pytest.approx(0.75, abs=1e-9)
    assert held.joint.error == pytest.approx(0, abs=1e-9)


@each_attachment
@pytest.mark.parametrize("live", [True, False])
def test_setting_the_axis_anchors_it_anew(both, live):
    """At angle 0 with the anchor of now, as body1 sees it."""
    held = Held(HINGE, both, fields=HINGE.fields)
    before, anchor = held.own(), held.joint.anchor
    if not live:
        held.world.detach(held.space)
    held.joint.axis = (0, 3, -4)
    assert held.joint.axis == pytest.approx((0, 0.6, -0.8), abs=1e-12)
    if not live:
        held.world.attach(held.space)
    assert held.joint.axis == pytest.approx((0, 0.6, -0.8), abs=1e-9)
    assert held.joint.anchor == pytest.approx(anchor, abs=1e-9)
    assert held.joint.anchor2 == pytest.approx(anchor, abs=1e-9)
    assert held.joint.angle == pytest.approx(0.0, abs=1e-9)
    assert held.own() == before
    held.joint.motor_max_force = 0.0
    held.check_it_holds()
    put(held.body1, turn(-2.0, anchor, (0, 0.6, -0.8)) * held.body1.pose)
    assert held.joint.angle == pytest.approx(-2.0, abs=1e-9)


def test_setting_the_axis_keeps_the_anchor_of_body1_where_the_two_are_apart():
    held = Held(HINGE, both=True)
    held.body2.position += (0.5, 0, 0)
    anchor = held.joint.anchor
    assert held.joint.error == pytest.approx(0.5, abs=1e-9)
    held.joint.axis = (1, 0, 0)
    assert held.joint.anchor == pytest.approx(anchor, abs=1e-9)
    assert held.joint.error == pytest.approx(0, abs=1e-9)


def test_a_door_on_the_static_world_swings_about_its_edge():
    """Driven at 1 rad/s for 1 s, its middle is a radian round the edge, counter-clockwise seen from above."""
    world = oo.World(gravity=(0, 0, 0))
    door = world.attach(oo.Body(position=(0.5, 0, 0)))
    door.attach(oo.Placeable()).attach(oo.Box((1, 2, 0.1), mass=10))
    hinge = oo.Hinge(door, None, anchor=(0, 0, 0), axis=(0, 1, 0), motor_velocity=1.0, motor_max_force=1e6)
    world.step(120)
    assert hinge.angle == pytest.approx(1.0, abs=1e-3)
    assert door.position == pytest.approx((0.5 * math.cos(1), 0, -0.5 * math.sin(1)), abs=2e-3)
    assert hinge.error < 2e-3


def test_turned_in_place_it_keeps_its_angle_when_its_mass_changes():
    """Anchored at its own origin, the body has turned but not moved: it counts from the rest of old all the same."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(solid(REST1, "body"))
    hinge = oo.Hinge(body, axis=AXIS)
    put(body, turn(0.75, REST1.position) * REST1)
    body.position = REST1.position
    body.fixed_mass = oo.Mass(3.0, oo.Vec3(-0.4, 0.9, 2.0))
    assert hinge.angle == pytest.approx(0.75, abs=1e-9)
    assert hinge.error == pytest.approx(0, abs=1e-9)
