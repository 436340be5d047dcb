"""The ball joint: where it holds, how far it is off, and anchoring it anew."""

import pytest

import osgode as oo
from tests.joints.held import ANCHOR, BALL, Held, each_attachment, put, turn


def test_where_it_is_by_default():
    """At the origin of body1, in a World and outside."""
    world = oo.World()
    first, second = oo.Body(position=(1, 2, 3)), oo.Body(position=(4, 5, 6))
    assert oo.Ball(first, second).anchor == (1, 2, 3)
    world.attach(first)
    world.attach(second)
    ball = oo.Ball(second, first)
    assert ball.anchor == ball.anchor2 == (4, 5, 6)


@each_attachment
@pytest.mark.parametrize("live", [True, False])
def test_the_error_is_how_far_the_two_sides_are_apart(both, live):
    held = Held(BALL, both)
    if not live:
        held.world.detach(held.space)
    held.check()
    held.body1.position += (0.3, -0.4, 1.2)
    assert held.joint.error == pytest.approx(1.3, abs=1e-9)
    assert held.joint.anchor == pytest.approx(held.moved.transform(ANCHOR) + oo.Vec3(0.3, -0.4, 1.2), abs=1e-9)
    assert held.joint.anchor2 == pytest.approx(held.ride.transform(ANCHOR), abs=1e-9)
    if both:
        held.body2.position += (0.3, -0.4, 1.2)
        assert held.joint.error == pytest.approx(0, abs=1e-9)


@each_attachment
@pytest.mark.parametrize("live", [True, False])
def test_setting_the_anchor_anchors_it_anew(both, live):
    """Where it is set both sides meet, though they were apart before."""
    held = Held(BALL, both, fields={**BALL.fields, "enabled": False})
    before = held.own()
    held.body1.position += (1, 1, 1)
    if not live:
        held.world.detach(held.space)
    held.joint.anchor = [5, -6, 7]
    assert held.joint.anchor == pytest.approx((5, -6, 7), abs=1e-9)
    if not live:
        held.world.attach(held.space)
    assert held.joint.anchor2 == pytest.approx((5, -6, 7), abs=1e-9)
    assert held.joint.error == pytest.approx(0, abs=1e-9)
    assert held.own() == before
    held.joint.enabled = True
    held.check_it_holds()
    put(held.body1, turn(1.2, oo.Vec3(5, -6, 7)) * held.body1.pose)
    assert held.joint.error == pytest.approx(0, abs=1e-9)


@each_attachment
def test_bodies_turn_about_it_freely(both):
    """Spinning about the anchor: the speed stays, and so does the anchor."""
    held = Held(BALL, both, way=0.0)
    held.world.solver = "exact"
    held.world.step_size = 1e-4
    held.body1.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    spin = (held.body1.position - held.joint.anchor).normalized() * 4  # about the line through its middle
    held.body1.angular_velocity = spin
    held.world.step(100)
    assert held.body1.angular_velocity == pytest.approx(spin, abs=1e-6)
    assert held.joint.error < 1e-9
    assert held.joint.anchor2 == pytest.approx(held.ride.transform(ANCHOR), abs=1e-9)


@pytest.mark.parametrize("solver", ["quick", "exact"])
def test_a_soft_ball_gives_way_and_a_hard_one_does_not(solver):
    """Hung on it, a weight of 2 kg pulls a soft one down by force * cfm * step / erp: 20 N * 1e-3 / (120 * 0.2)."""
    errors = []
    for cfm in (1e-3, 1e-10):
        world = oo.World(gravity=(0, -10, 0), solver=solver)
        weight = world.attach(oo.Body(fixed_mass=oo.Mass.sphere(0.5, mass=2)))
        ball = oo.Ball(weight, cfm=cfm, erp=0.2)
        world.run(3)
        errors.append(ball.error)
    assert errors[0] == pytest.approx(20 * 1e-3 / 120 / 0.2, rel=1e-3)
    assert errors[1] < 1e-8
