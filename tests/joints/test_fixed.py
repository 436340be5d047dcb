"""The fixed joint: it holds bodies as they stood, until `fix` is called."""

import pytest

import osgode as oo
from tests.joints.held import FIXED, Held, assert_poses, each_attachment, put, turn

ASTRAY = turn(0.2, oo.Vec3(1, 0, 0), (0, 1, 1))


def settle(held, steps=100):
    """Let the joint pull the bodies to where it wants them."""
    held.world.solver = "exact"
    for _ in range(steps):
        for body in held.bodies:
            body.linear_velocity = body.angular_velocity = (0, 0, 0)
        held.world.step()


def relation(held):
    """How body1 stands as body2, or the static world, sees it."""
    return held.body2.pose.inverse() * held.body1.pose if held.both else held.body1.pose


def assert_same(one, other, tolerance):
    assert one.position == pytest.approx(other.position, abs=tolerance)
    assert (one.rotation.conjugate() * other.rotation).angle == pytest.approx(0, abs=tolerance)


@each_attachment
def test_it_pulls_the_bodies_back_to_how_they_stood(both):
    held = Held(FIXED, both)
    wanted = relation(held)
    put(held.body1, ASTRAY * held.body1.pose)
    assert relation(held).position.distance(wanted.position) > 0.1
    settle(held)
    assert_same(relation(held), wanted, 1e-6)


@each_attachment
@pytest.mark.parametrize("live", [True, False])
def test_fix_holds_them_as_they_stand_now(both, live):
    """Where it was fixed before is forgotten; its fields are kept."""
    held = Held(FIXED, both, fields=FIXED.fields)
    before = held.own()
    put(held.body1, ASTRAY * held.body1.pose)
    poses = [body.pose for body in held.bodies]
    if not live:
        held.world.detach(held.space)
    held.joint.fix()
    if not live:
        held.world.attach(held.space)
    assert_poses(held.bodies, poses, 1e-12)
    held.check_it_holds()
    assert held.own() == before
    wanted = relation(held)
    put(held.body1, ASTRAY.inverse() * held.body1.pose)
    held.joint.erp = None
    held.joint.cfm = None
    settle(held)
    assert_same(relation(held), wanted, 1e-6)


@each_attachment
def test_fix_moves_no_bit(both):
    held = Held(FIXED, both)
    put(held.body1, ASTRAY * held.body1.pose)
    held.body1.angular_velocity = (1, 2, 3)
    before = held.world.poses.tobytes(), held.world.previous_poses.tobytes(), held.world.velocities.tobytes()
    held.joint.fix()
    assert (held.world.poses.tobytes(), held.world.previous_poses.tobytes(), held.world.velocities.tobytes()) == before


@each_attachment
def test_it_holds_against_gravity(both):
    """Two fixed together fall as one; one that is fixed to the static world hangs where it is."""
    held = Held(FIXED, both)
    held.world.gravity = (0, -10, 0)
    held.world.solver = "exact"
    before, height = relation(held), held.body1.position.y
    held.world.step(60)
    assert_same(relation(held), before, 1e-6)
    fallen = 10 / 120**2 * 60 * 61 / 2 if both else 0.0
    assert height - held.body1.position.y == pytest.approx(fallen, abs=1e-6)


@pytest.mark.parametrize("name", ["anchor1", "axis", "stops", "motor_velocity"])
def test_it_has_none_of_what_the_others_have(name):
    with pytest.raises(TypeError, match=f"Fixed has no field '{name}'"):
        oo.Fixed(oo.Body(), oo.Body(), **{name: (0, 1, 0)})
