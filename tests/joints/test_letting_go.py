"""Letting go: released, disabled, left by a body; who is woken by it, and who is told."""

import gc

import pytest

import osgode as oo
from tests.joints.held import AXIS, Held, each_held, each_kind, each_pair

# -- letting go


@each_held
def test_release_frees_the_native_and_wakes_the_bodies(kind, both):
    held = Held(kind, both)
    for body in held.bodies:
        body.enabled = False
    assert held.body1.joints == (held.joint,)
    held.joint.release()
    assert held.joint.released
    assert not held.joint.is_live
    assert all(body.enabled for body in held.bodies)
    assert held.body1.joints == held.body2.joints == held.world.joints == ()
    assert oo.live_natives().joints == 0
    for body in held.bodies:
        body.enabled = False
    held.joint.release()
    assert not any(body.enabled for body in held.bodies)
    held.body1.move_to(held.sap)
    held.sap.detach(held.body1)
    held.sap.attach(held.body1)
    assert not held.joint.is_live
    held.world.step()


@each_kind
def test_release_outside_of_a_world_is_for_good(kind):
    first, second = oo.Body(), oo.Body()
    joint = kind.make(first, second if True in kind.attached else None)
    joint.release()
    world = oo.World()
    world.attach(first)
    world.attach(second)
    assert not joint.is_live
    assert first.joints == second.joints == ()


@each_held
def test_a_released_joint_holds_nothing(kind, both):
    """Fallen for half a second, the body is where free fall has taken it."""
    held = Held(kind, both)
    held.joint.release()
    held.world.gravity = (0, -10, 0)
    height = held.body1.position.y
    held.world.step(60)
    fallen = 10 / 120**2 * 60 * 61 / 2
    assert held.body1.position.y == pytest.approx(height - fallen, abs=1e-9)


@each_held
def test_a_disabled_joint_holds_nothing_and_is_enabled_again(kind, both):
    held = Held(kind, both, way=0.0)
    held.joint.enabled = False
    held.body1.linear_velocity = AXIS.cross((1, 0, 0)).normalized()
    before = held.body1.position
    held.world.step(30)
    assert held.body1.position.distance(before) == pytest.approx(30 / 120, rel=1e-9)
    if not kind.holds:
        return
    off = held.joint.error + held.joint.angular_error
    assert off > 0.01
    held.joint.enabled = True
    held.world.run(3)
    assert held.joint.error + held.joint.angular_error < off / 10


# -- sleep


@each_pair
def test_a_joint_that_is_disabled_wakes_what_it_held(kind):
    """Or what hung on it would hang on in the air."""
    held = Held(kind, both=True)
    held.body1.enabled = held.body2.enabled = False
    held.joint.enabled = False
    assert held.body1.enabled
    assert held.body2.enabled


@each_pair
def test_a_body_that_leaves_wakes_the_other(kind):
    held = Held(kind, both=True)
    held.body1.enabled = held.body2.enabled = False
    held.space.detach(held.body1)
    assert held.body2.enabled
    assert not held.body1.enabled


@each_pair
def test_a_body_that_leaves_does_not_wake_one_in_another_world(kind):
    """A joint that isn't live holds nothing, so nothing is let go."""
    one, other = oo.World(), oo.World()
    first, second = one.attach(oo.Body()), other.attach(oo.Body())
    kind.make(first, second)
    second.enabled = False
    one.detach(first)
    assert not second.enabled


@each_pair
@pytest.mark.parametrize("how", ["moved", "detached", "dropped"])
@pytest.mark.parametrize("variant", ["", "soft", "sprung"])
def test_what_leaves_together_sleeps_on(kind, how, variant):
    held = Held(kind, both=True, fields=kind.given(variant) if variant else {})
    held.body1.enabled = held.body2.enabled = False
    if how == "moved":
        held.other = oo.World()
        held.space.move_to(held.other)
        assert held.joint.is_live
    elif how == "detached":
        held.world.detach(held.space)
    else:
        del held.world
        gc.collect()
    assert held.body1.world is (held.other if how == "moved" else None)
    assert not held.body1.enabled
    assert not held.body2.enabled
    if how == "detached":
        held.world.attach(held.space)
        assert held.joint.is_live
        assert not held.body1.enabled
        assert not held.body2.enabled


# -- listeners


def heard(joint):
    """A list that gets what the joint tells."""
    events = []
    joint.on_let_go(lambda event: events.append((event.joint is joint, event.reason, event.force, event.torque)))
    return events


@each_held
def test_listeners_hear_of_a_release_once(kind, both):
    held = Held(kind, both)
    events = heard(held.joint)
    held.joint.release()
    held.joint.release()
    held.world.detach(held.space)
    assert events == [(True, "released", 0.0, 0.0)]
    assert not held.joint.broken


@each_held
def test_listeners_hear_when_a_body_leaves_the_world(kind, both):
    """Once for both; what stays or comes to another World together is not lost."""
    held = Held(kind, both)
    events = heard(held.joint)
    held.body1.move_to(held.sap)
    held.body1.move_to(held.space)
    other = oo.World()
    held.space.move_to(other)
    assert events == []
    other.detach(held.space)
    assert events == [(True, "left", 0.0, 0.0)]
    other.attach(held.space)
    held.space.detach(held.body1)
    assert events == 2 * [(True, "left", 0.0, 0.0)]
    assert not held.joint.released
    held.space.attach(held.body1)
    assert held.joint.is_live


@each_pair
def test_listeners_hear_when_one_body_goes_to_another_world(kind):
    held = Held(kind, both=True)
    events = heard(held.joint)
    other = oo.World()
    held.body1.move_to(other)
    assert events == [(True, "left", 0.0, 0.0)]
    held.body2.move_to(other)
    assert held.joint.is_live
    assert len(events) == 1


@each_kind
def test_a_listener_is_taken_back(kind):
    held = Held(kind, kind.attached[0])
    events = heard(held.joint)
    listener = held.joint.on_let_go(events.append)
    held.joint.remove_on_let_go(listener)
    with pytest.raises(ValueError, match="not in list"):
        held.joint.remove_on_let_go(listener)
    held.joint.release()
    assert len(events) == 1


@pytest.mark.parametrize("bad", [None, 5, "print"])
def test_what_can_not_be_called_is_no_listener(bad):
    joint = oo.Ball(oo.Body(), name="it")
    with pytest.raises(oo.FieldError, match=r"Ball 'it'\.on_let_go\(\)\.listener is "):
        joint.on_let_go(bad)


def test_all_listeners_are_heard_before_an_error_of_one():
    joint = oo.Ball(oo.Body(), name="it")
    events = heard(joint)

    def fails(event):
        raise KeyError(event.reason)

    joint.on_let_go(fails)
    more = heard(joint)
    with pytest.raises(KeyError) as caught:
        joint.release()
    assert "raised by a joint listener of Ball 'it', which released" in caught.value.__notes__
    assert joint.released
    assert events == more == [(True, "released", 0.0, 0.0)]


@each_pair
def test_a_listener_may_join_the_bodies_again(kind):
    held = Held(kind, both=True)
    made = []
    held.joint.on_let_go(lambda event: made.append(kind.make(event.joint.body1, event.joint.body2)))
    held.joint.release()
    assert held.world.joints == tuple(made)
    held.world.step()


def test_a_world_that_is_dropped_tells_nobody():
    """There is no World left to change; the joint's state says it."""
    world = oo.World()
    joint = oo.Ball(world.attach(oo.Body()))
    events = heard(joint)
    body = joint.body1
    del world
    gc.collect()
    assert not body.is_live
    assert events == []
