"""A joint copied to other bodies holds them as it holds its own."""

import pytest

import osgode as oo
from tests.joints.held import PLANE2D, Held, each_held, each_kind, each_pair


def plain(fields):
    """Fields of a joint, with those of its servo instead of the servo."""
    return {
        name: {key: getattr(value, key) for key in value.FIELDS} if isinstance(value, oo.Servo) else value
        for name, value in fields.items()
    }


@pytest.mark.parametrize("variant", ["soft", "sprung"])
@pytest.mark.parametrize("live", [True, False])
@each_held
def test_a_copy_holds_copies(kind, both, variant, live):
    """With the same fields, coordinates and anchors; it moves its bodies to the same bits, or nearly."""
    held = Held(kind, both, fields=kind.given(variant))
    if not live:
        for body in held.bodies:
            held.space.detach(body)
    twins = [body.copy() for body in held.bodies]
    joint = held.joint.copy(*twins)
    assert type(joint) is type(held.joint)
    assert joint.name == held.joint.name
    assert (joint.body1, joint.body2) == (twins[0], twins[1] if both else None)
    assert all(body.joints == (joint,) for body in twins)
    assert all(body.joints == (held.joint,) for body in held.bodies)
    assert not joint.is_live
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    for body in twins:
        space.attach(body)
    if not live:
        for body in held.bodies:
            held.space.attach(body)
    assert joint.is_live
    assert held.joint.is_live
    own = {name: field.own(joint) for name, field in joint.FIELDS.items()}
    assert plain(own) == plain(held.own())
    for name in kind.spots:
        assert getattr(joint, name) == pytest.approx(getattr(held.joint, name), abs=1e-12)
    for name, _ in kind.case.coordinates:
        assert getattr(joint, name) == pytest.approx(getattr(held.joint, name), abs=1e-12)
    for body, twin in zip(held.bodies, twins, strict=True):
        body.linear_velocity = twin.linear_velocity = (0.1, 0.2, 0.0)
    held.world.step(20)
    world.step(20)
    for body, twin in zip(held.bodies, twins, strict=True):
        assert twin.position == pytest.approx(body.position, abs=1e-9)
        assert twin.rotation == pytest.approx(body.rotation, abs=1e-9)


@each_pair
def test_a_copy_is_a_joint_of_its_own(kind):
    """What is set, released or listened to on the one doesn't show on the other."""
    held = Held(kind, both=True, fields=kind.given("sprung"))
    held.joint.on_let_go(lambda event: pytest.fail("the copy was released, not this"))
    twins = [held.space.attach(body.copy()) for body in held.bodies]
    joint = held.joint.copy(*twins)
    assert joint.is_live
    assert set(held.world.joints) == {held.joint, joint}
    before = plain(held.own())
    joint.feedback = not held.joint.feedback
    if "servo" in joint.FIELDS:
        assert joint.servo.joint is joint
        assert held.joint.servo.joint is held.joint
        joint.servo.target = 0.25
    assert plain(held.own()) == before
    joint.release()
    assert held.joint.is_live
    assert not held.joint.released


@each_kind
def test_what_can_not_be_copied(kind):
    """The wrong bodies, another number of them, or what has been released."""
    both = True in kind.attached
    held = Held(kind, both)
    body = oo.Body()
    with pytest.raises(oo.TreeError, match=kind.title):
        held.joint.copy(None)
    with pytest.raises(oo.TreeError, match=kind.title):
        held.joint.copy(*([body] if both else [body, oo.Body()]))
    assert body.joints == ()
    held.joint.release()
    with pytest.raises(oo.StateError, match="released"):
        held.joint.copy(*([body, oo.Body()] if both else [body]))


def test_parameters_of_a_plane_are_not_shared():
    """ODE can't be asked for those of a Plane2D, so each keeps its own."""
    held = Held(PLANE2D, both=False, fields={"motor_velocity1": 2.0})
    twin = held.space.attach(held.body1.copy())
    joint = held.joint.copy(twin)
    joint.motor_velocity1 = 5.0
    assert (held.joint.motor_velocity1, joint.motor_velocity1) == (2.0, 5.0)
