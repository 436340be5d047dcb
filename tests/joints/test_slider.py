"""The slider: the sign of its position, rate, force and motor, and anchoring it anew."""

import math

import numpy as np
import pytest

import osgode as oo
from tests.joints.held import AXIS, REST1, REST2, RIDE, SLIDER, Held, each_attachment, put, shift, solid, turn


def stand(order: str):
    """A World, the bodies in the order in which they are joined, and the slider."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    a, b = world.attach(solid(REST1, "a")), world.attach(solid(REST2, "b"))
    pair = {"a, b": (a, b), "b, a": (b, a), "a, None": (a, None), "b, None": (b, None)}[order]
    return world, pair, oo.Slider(*pair, axis=AXIS * 5)


def sliding_mass(first, second):
    """What a force along the axis has to speed up: u - (u r x a) I^-1 (u r x a), with u = m1 m2 / (m1 + m2).

    Nothing else acts on the pair, so it keeps its angular momentum of 0: u r x a s' + I w = 0. I is of both about
    their common centre, r from one centre to the other, s' the speed of sliding, w that of turning.
    """
    reduced = first.mass * second.mass / (first.mass + second.mass)
    r = np.array(first.world_centre_of_mass - second.world_centre_of_mass)
    inertia = reduced * (r @ r * np.eye(3) - np.outer(r, r))
    for body in (first, second):
        turned = np.array(body.rotation.to_matrix())
        inertia += turned @ body.inertia @ turned.T
    arm = reduced * np.cross(r, AXIS)
    return reduced - arm @ np.linalg.solve(inertia, arm)


each_order = pytest.mark.parametrize("order", ["a, b", "b, a", "a, None", "b, None"])


@each_order
@pytest.mark.parametrize("way", [-30.0, -0.25, 0.0, 1e-6, 2.5])
def test_the_position_is_how_far_body1_has_gone_along_the_axis(order, way):
    """However the pair has moved since; what it is pushed across the axis doesn't count."""
    _world, (first, second), slider = stand(order)
    ride = RIDE if second else shift((0, 0, 0))
    across = AXIS.cross((1, 0, 0)) * 0.5
    put(first, ride * shift(AXIS * way + across) * first.pose)
    if second:
        put(second, ride * second.pose)
    assert slider.position == pytest.approx(way, abs=1e-9)
    assert slider.axis == pytest.approx(ride.rotation.rotate(AXIS), abs=1e-9)


@pytest.mark.parametrize("way", [-30.0, 2.5])
def test_moving_body2_moves_the_position_back(way):
    _world, (_, second), slider = stand("a, b")
    second.position += AXIS * way
    assert slider.position == pytest.approx(-way, abs=1e-9)


@each_order
def test_the_rate_is_what_body1_moves_faster_along_the_axis(order):
    _world, (first, second), slider = stand(order)
    first.linear_velocity = AXIS * 1.75 + AXIS.cross((1, 0, 0))
    assert slider.position_rate == pytest.approx(1.75, abs=1e-12)
    if second:
        second.linear_velocity = AXIS * 0.5
        assert slider.position_rate == pytest.approx(1.25, abs=1e-12)


@pytest.mark.parametrize("rate", [0.0, 1.5])
@pytest.mark.parametrize("order", ["a, b", "b, a"])
def test_the_rate_is_that_of_the_position_while_the_pair_turns(order, rate):
    """The pair turns about a point far away as one, but for sliding: measured over a step of 1 us."""
    world, (first, second), slider = stand(order)
    world.step_size = 1e-6
    spin, middle = oo.Vec3(0.5, -2, 1.5), oo.Vec3(7, 7, -7)
    for body in (first, second):
        body.angular_velocity = spin
        body.linear_velocity = spin.cross(body.position - middle)
    first.linear_velocity += AXIS * rate
    assert slider.position_rate == pytest.approx(rate, abs=1e-9)
    before = slider.position
    world.step()
    assert (slider.position - before) / 1e-6 == pytest.approx(rate, abs=1e-4)


@each_order
def test_force_and_motor_move_body1_the_positive_way(order):
    """One body gets F h / m; two get what `sliding_mass` says."""
    world, (first, second), slider = stand(order)
    gained = 6.0 / 120 / (sliding_mass(first, second) if second else first.mass)
    slider.add_force(6.0)
    world.step()
    assert slider.position_rate == pytest.approx(gained, rel=1e-3 if second else 1e-9)
    world.step()
    assert slider.position_rate == pytest.approx(gained, rel=1e-2)  # for one step only
    assert slider.position > 0
    slider.motor(-1.5, 1e4)
    world.step(5)
    assert slider.position_rate == pytest.approx(-1.5, rel=1e-3)
    slider.motor(1.5, 1e4)
    world.step(5)
    assert slider.position_rate == pytest.approx(1.5, rel=1e-3)


@pytest.mark.parametrize("bad", [math.nan, math.inf, "x", None, (1, 2, 3)])
def test_bad_forces_are_refused(bad):
    _world, _, slider = stand("a, b")
    with pytest.raises(oo.FieldError, match=r"Slider\.add_force\(\)\.force is "):
        slider.add_force(bad)


def test_the_default_axis_is_x():
    assert oo.Slider(oo.Body(), oo.Body()).axis == (1, 0, 0)


@each_attachment
@pytest.mark.parametrize("live", [True, False])
def test_setting_the_axis_anchors_it_anew(both, live):
    """At position 0, its fields kept; the position counts from there."""
    held = Held(SLIDER, both, fields=SLIDER.fields)
    before = held.own()
    if not live:
        held.world.detach(held.space)
    held.joint.axis = (0, 3, -4)
    assert held.joint.axis == pytest.approx((0, 0.6, -0.8), abs=1e-12)
    if not live:
        held.world.attach(held.space)
    assert held.joint.position == pytest.approx(0.0, abs=1e-9)
    assert held.own() == before
    held.joint.motor_max_force = 0.0
    held.check_it_holds()
    held.body1.position += oo.Vec3(0, 0.6, -0.8) * 1.25
    assert held.joint.position == pytest.approx(1.25, abs=1e-9)


def test_body1_slides_without_turning():
    """Pushed beside its centre it goes along the axis, to 0.1 mm, and not round, to 1e-4."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    body = world.attach(solid(REST1, "body"))
    slider = oo.Slider(body, axis=AXIS)
    start = body.pose
    for _ in range(60):
        body.add_force(AXIS * 6.0, at=body.local_to_world((1, 1, 1)))
        world.step()
    assert slider.position == pytest.approx(6.0 / 3.0 / 120**2 * 60 * 61 / 2, rel=1e-4)
    assert (body.position - start.position).cross(AXIS).length < 1e-4
    assert (start.rotation.conjugate() * body.rotation).angle < 1e-4


def test_turned_by_hand_the_axis_turns_along():
    _world, (first, _), slider = stand("a, None")
    put(first, turn(1.0, first.position, (0, 0, 1)) * first.pose)
    assert slider.axis == pytest.approx(oo.Quat.from_axis_angle((0, 0, 1), 1.0).rotate(AXIS), abs=1e-9)
