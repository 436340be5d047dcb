"""Joints of every kind survive whatever happens to their bodies, and refuse what can't be joined."""

import gc
import math

import numpy as np
import pytest

import osgode as oo
from tests.joints.held import (
    ANCHOR,
    AXIS,
    BALL,
    FIXED,
    HINGE,
    KINDS,
    REST1,
    REST2,
    SLIDER,
    Held,
    Kind,
    assert_poses,
    each_attachment,
    each_kind,
    put,
    shift,
)

# -- what happens to bodies


def moves_between_spaces(held):
    held.body1.move_to(held.sap)
    held.body1.move_to(held.inner)


def moves_out_of_all_spaces(held):
    held.body1.move_to(held.world)


def first_leaves_and_comes_back(held):
    held.space.detach(held.body1)
    assert not held.joint.is_live
    held.sap.attach(held.body1)


def second_leaves_and_comes_back(held):
    held.space.detach(held.body2)
    held.space.attach(held.body2)


def all_leave_and_come_back_the_other_way_round(held):
    for body in held.bodies:
        held.space.detach(body)
    for body in reversed(held.bodies):
        held.inner.attach(body)


def the_space_leaves_and_comes_back(held):
    held.world.detach(held.space)
    assert not held.joint.is_live
    held.world.attach(held.space)


def the_space_goes_to_another_world(held):
    held.other = oo.World(gravity=(0, 0, 0))
    held.space.move_to(held.other)
    assert held.joint.world is held.other
    assert held.world.joints == ()


def bodies_go_to_another_world_one_by_one(held):
    held.other = oo.World(gravity=(0, 0, 0))
    for body in held.bodies:
        body.move_to(held.other)


def the_world_is_dropped_and_another_made(held):
    held.body2.world.detach(held.sap)
    del held.world
    gc.collect()
    assert not held.joint.is_live
    held.world = oo.World(gravity=(0, 0, 0))
    held.space.move_to(held.world)


def a_part_comes(held):
    held.body1.attach(oo.Placeable(position=(2, -1, 0.5))).attach(oo.Box((0.2, 0.3, 0.4), mass=5))


def a_part_goes(held):
    held.body1.detach(held.body1.children[1])


def a_part_moves(held):
    held.body1.children[0].position = (-1, 2, 0.25)
    held.body1.children[0].rotation = oo.Quat.from_axis_angle((1, 0, 1), 0.4)


def a_part_gets_heavier(held):
    held.body1.geoms[1].mass = 40.0


def all_parts_go(held):
    for part in list(held.body1.children):
        held.body1.detach(part)


def fixed_mass_comes(held):
    held.body1.fixed_mass = oo.Mass(3.0, oo.Vec3(-0.4, 0.9, 2.0))


def fixed_mass_comes_and_goes(held):
    fixed_mass_comes(held)
    held.body1.fixed_mass = None


def the_second_changes_its_mass(held):
    held.body2.children[0].position = (-1, 2, 0.25)
    held.body2.fixed_mass = oo.Mass(3.0, oo.Vec3(-0.4, 0.9, 2.0))


def mass_changes_while_outside(held):
    held.space.detach(held.body1)
    a_part_comes(held)
    held.space.attach(held.body1)


def everything_twice(held):
    for happen in 2 * [a_part_comes, first_leaves_and_comes_back, fixed_mass_comes, a_part_moves, moves_between_spaces]:
        happen(held)
        held.body1.move_to(held.space)


HAPPENINGS = [
    moves_between_spaces,
    moves_out_of_all_spaces,
    first_leaves_and_comes_back,
    second_leaves_and_comes_back,
    all_leave_and_come_back_the_other_way_round,
    the_space_leaves_and_comes_back,
    the_space_goes_to_another_world,
    bodies_go_to_another_world_one_by_one,
    the_world_is_dropped_and_another_made,
    a_part_comes,
    a_part_goes,
    a_part_moves,
    a_part_gets_heavier,
    all_parts_go,
    fixed_mass_comes,
    fixed_mass_comes_and_goes,
    the_second_changes_its_mass,
    mass_changes_while_outside,
    everything_twice,
]
MASS_CHANGES = [a_part_comes, a_part_goes, a_part_moves, a_part_gets_heavier, all_parts_go, fixed_mass_comes]


def each(functions):
    return pytest.mark.parametrize("happen", functions, ids=lambda f: f.__name__)


@each(HAPPENINGS)
@each_attachment
@each_kind
def test_a_joint_survives(kind, both, happen):
    """Anchors, axis and coordinate are where geometry says, all fields are as set, and the bodies stand as before."""
    held = Held(kind, both, fields=kind.fields)
    poses = [body.pose for body in held.bodies]
    assert {name: held.own()[name] for name in kind.fields} == kind.fields
    before = held.own()
    held.check()
    happen(held)
    held.check()
    assert held.own() == before
    assert_poses(held.bodies, poses, 1e-12)
    assert held.joint.is_live
    assert held.joint.world is held.body1.world
    assert oo.live_natives().joints == 1


@each(HAPPENINGS)
@each_attachment
@each_kind
def test_a_joint_that_survived_has_nothing_to_correct(kind, both, happen):
    """Nor does a disabled one come back enabled."""
    held = Held(kind, both)
    happen(held)
    held.check_it_holds()
    held.check()
    held.joint.enabled = False
    held.body1.move_to(held.space)
    held.body2.move_to(held.space)
    all_leave_and_come_back_the_other_way_round(held)
    assert held.joint.enabled is False


@each(HAPPENINGS)
@each_attachment
@each_kind
def test_a_joint_that_survived_pulls_back_to_where_it_was_anchored(kind, both, happen):
    """From 1 cm beside what the joint allows, after the happening, to within 10 um of it: to the rest of old."""
    held = Held(kind, both, way=0.0, fields={"cfm": 1e-12})
    across = AXIS.cross((1, 0, 0)).normalized() * 0.01
    held.body1.position += across
    happen(held)
    world = held.joint.world
    world.solver = "exact"
    for _ in range(50):
        for body in held.bodies:  # it is to be pulled, not to fly
            body.linear_velocity = body.angular_velocity = (0, 0, 0)
        world.step()
    if kind is BALL or kind is HINGE:
        assert held.joint.error < 1e-5
    if kind is SLIDER:
        offset = relative(held).inverse().transform(held.body1.position) - REST1.position
        assert offset.cross(AXIS).length < 1e-5
    if kind is FIXED:
        assert_poses([held.body1], [relative(held) * REST1], 1e-5)


def relative(held):
    """How the world of rest has moved for the second body."""
    return held.body2.pose * REST2.inverse() if held.both else shift((0, 0, 0))


@each(MASS_CHANGES)
@each_attachment
@each_kind
def test_being_made_again_leaves_the_bodies_alone(kind, both, happen):
    """The frame and its velocity stay within 1e-12, and the other body's state is the same to the bit."""
    held = Held(kind, both)
    held.body1.linear_velocity, held.body1.angular_velocity = (1, -2, 0.5), (0.25, 3, -1)
    held.body2.linear_velocity, held.body2.angular_velocity = (0.1, 0.7, 5), (1, 2, -1)
    row = held.world.bodies.index(held.body2)
    poses, velocities = held.world.poses.copy(), held.world.velocities
    happen(held)
    assert held.world.joints == (held.joint,)
    assert oo.live_natives().joints == 1
    assert np.allclose(held.world.poses, poses, rtol=0, atol=1e-12)
    assert np.allclose(held.world.velocities, velocities, rtol=0, atol=1e-12)
    assert held.world.poses[row].tobytes() == poses[row].tobytes()
    assert held.world.velocities[row].tobytes() == velocities[row].tobytes()


@each_attachment
@each_kind
def test_anchoring_anew_moves_no_bit(kind, both):
    """Making the native again puts the bodies to rest and back; where nothing moves not one bit changes."""
    held = Held(kind, both)
    held.body1.linear_velocity, held.body1.angular_velocity = (1, -2, 0.5), (0.25, 3, -1)
    held.body1.force, held.body1.torque = (1, 2, 3), (4, 5, 6)
    held.world.detach(held.space)
    held.world.attach(held.space)

    def state():
        poses, velocities = held.world.poses.tobytes(), held.world.velocities.tobytes()
        return poses, held.world.previous_poses.tobytes(), velocities, held.body1.force, held.body1.torque

    before = state()
    held.joint._remake()
    assert state() == before
    for mass in (oo.Mass(2.0, held.body1.centre_of_mass), oo.Mass(9.0, held.body1.centre_of_mass)):
        held.body1.fixed_mass = mass  # the centre stays
        assert state() == before
    held.check()


@each_kind
def test_a_part_without_mass_does_not_make_the_joint_again(kind):
    held = Held(kind, both=True)
    native = held.joint._id
    held.body1.attach(oo.Placeable(position=(5, 5, 5))).attach(oo.Sphere(1, mass=0))
    assert held.joint._id == native


# -- live or not


@each_kind
def test_a_joint_is_live_while_its_bodies_are_in_one_world(kind):
    one, other = oo.World(name="one"), oo.World(name="other")
    first, second = oo.Body(), oo.Body()
    joint = kind.make(first, second)

    def state():
        return joint.is_live, joint.world, len(one.joints), len(other.joints)

    assert state() == (False, None, 0, 0)
    one.attach(first)
    assert state() == (False, None, 0, 0)
    other.attach(second)
    assert state() == (False, None, 0, 0)
    second.move_to(one)
    assert state() == (True, one, 1, 0)
    first.move_to(other)
    assert state() == (False, None, 0, 0)
    second.move_to(other)
    assert state() == (True, other, 0, 1)
    other.detach(first)
    assert state() == (False, None, 0, 0)


@each_kind
def test_a_joint_made_between_two_worlds_waits(kind):
    one, other = oo.World(), oo.World()
    first, second = one.attach(oo.Body()), other.attach(oo.Body())
    joint = kind.make(first, second, **kind.fields)
    assert not joint.is_live
    assert oo.live_natives().joints == 0
    second.move_to(one)
    assert joint.is_live
    assert {name: getattr(joint, name) for name in kind.fields} == kind.fields


@each_kind
def test_a_single_body_takes_its_joint_along(kind):
    one, other = oo.World(), oo.World()
    body = one.attach(oo.Body())
    joint = kind.make(body)
    body.move_to(other)
    assert joint.world is other
    assert joint.body1 is body
    assert joint.body2 is None


@each_attachment
@each_kind
def test_a_world_that_is_dropped_leaves_its_joints_as_plain_data(kind, both):
    held = Held(kind, both, fields=kind.fields)
    before = held.own()
    natives = oo.live_natives()
    assert natives.joints == 1
    del held.world
    gc.collect()
    assert not held.joint.is_live
    assert held.joint.world is None
    assert held.own() == before
    held.check()
    after = oo.live_natives()
    assert (after.worlds, after.bodies, after.joints, after.geoms) == (0, 0, 0, 0)
    held.joint.release()
    assert held.body1.joints == ()


READ = {
    oo.Hinge: ["angle", "angle_rate"],
    oo.Slider: ["position", "position_rate"],
}


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind in (HINGE, SLIDER) for name in READ[kind.cls]])
@pytest.mark.parametrize("why", ["outside", "one outside", "released"])
def test_what_needs_a_live_joint_says_so(kind, name, why):
    held = Held(kind, both=True)
    if why == "released":
        held.joint.release()
    else:
        held.space.detach(held.body1)
        if why == "outside":
            held.space.detach(held.body2)
    with pytest.raises(oo.StateError, match=rf"{kind} 'it'\.{name}\b"):
        getattr(held.joint, name)
    push = held.joint.add_torque if kind is HINGE else held.joint.add_force
    with pytest.raises(oo.StateError, match=rf"{kind} 'it'\.add_"):
        push(1.0)


@each_attachment
@pytest.mark.parametrize("kind", [BALL, HINGE, SLIDER], ids=str)
def test_outside_anchor_and_axis_follow_the_bodies(kind, both):
    """Moved by hand while outside, each body carries its side along; back inside ODE says the same."""
    held = Held(kind, both, way=0.0)
    for body in held.bodies:
        held.space.detach(body)
    one, two = (oo.Pose(oo.Vec3(1, 2, 3), oo.Quat.from_axis_angle((k, 1, 0), 0.7 + k)) for k in (1, 2))
    put(held.body1, one * REST1)
    if both:
        put(held.body2, two * REST2)
    for inside in (False, True):
        if inside:
            for body in held.bodies:
                held.space.attach(body)
        assert held.joint.is_live is inside
        if kind is not SLIDER:
            assert held.joint.anchor == pytest.approx(one.transform(ANCHOR), abs=1e-9)
            other = two.transform(ANCHOR) if both else ANCHOR
            assert held.joint.anchor2 == pytest.approx(other, abs=1e-9)
            assert held.joint.error == pytest.approx(one.transform(ANCHOR).distance(other), abs=1e-9)
        if kind is not BALL:
            assert held.joint.axis == pytest.approx(one.rotation.rotate(AXIS), abs=1e-9)


# -- letting go


@each_attachment
@each_kind
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
    joint = kind.make(first, second)
    joint.release()
    world = oo.World()
    world.attach(first)
    world.attach(second)
    assert not joint.is_live
    assert first.joints == second.joints == ()


@each_kind
def test_a_released_joint_holds_nothing(kind):
    """Fallen for half a second, the second body is where free fall has taken it."""
    held = Held(kind, both=False)
    held.joint.release()
    held.world.gravity = (0, -10, 0)
    height = held.body1.position.y
    held.world.step(60)
    fallen = 10 / 120**2 * 60 * 61 / 2
    assert held.body1.position.y == pytest.approx(height - fallen, abs=1e-9)


@each_kind
def test_a_disabled_joint_holds_nothing_and_is_enabled_again(kind):
    held = Held(kind, both=False, way=0.0)
    held.joint.enabled = False
    held.body1.linear_velocity = AXIS.cross((1, 0, 0)).normalized()
    before = held.body1.position
    held.world.step(30)
    assert held.body1.position.distance(before) == pytest.approx(30 / 120, rel=1e-9)
    held.joint.enabled = True
    held.world.run(3)
    if kind is not SLIDER:
        offset = held.body1.local_to_world((0, 0, 0)).distance(before)
        assert offset < 1e-3 if kind is FIXED else held.joint.error < 1e-3
    else:
        assert (held.body1.position - before).cross(AXIS).length < 1e-3


# -- sleep


@each_kind
def test_a_joint_that_is_disabled_wakes_what_it_held(kind):
    """Or what hung on it would hang on in the air."""
    held = Held(kind, both=True)
    held.body1.enabled = held.body2.enabled = False
    held.joint.enabled = False
    assert held.body1.enabled
    assert held.body2.enabled


@each_kind
def test_a_body_that_leaves_wakes_the_other(kind):
    held = Held(kind, both=True)
    held.body1.enabled = held.body2.enabled = False
    held.space.detach(held.body1)
    assert held.body2.enabled
    assert not held.body1.enabled


@each_kind
def test_a_body_that_leaves_does_not_wake_one_in_another_world(kind):
    """A joint that isn't live holds nothing, so nothing is let go."""
    one, other = oo.World(), oo.World()
    first, second = one.attach(oo.Body()), other.attach(oo.Body())
    kind.make(first, second)
    second.enabled = False
    one.detach(first)
    assert not second.enabled


@each_kind
@pytest.mark.parametrize("how", ["moved", "detached", "dropped"])
def test_what_leaves_together_sleeps_on(kind, how):
    held = Held(kind, both=True)
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


# -- what is refused


def stand(world: bool):
    first, second = oo.Body(name="first"), oo.Body(name="second")
    top = oo.World() if world else oo.Group()
    if world:
        top.attach(first)
        top.attach(second)
    return top, first, second


def unchanged(first, second, joints=0):
    gc.collect()
    assert first.joints == second.joints == ()
    assert oo.live_natives().joints == joints


@each_kind
@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize(
    ("pick", "words"),
    [
        (lambda a, b: (None, b), "body1 is None"),
        (lambda a, b: (None, None), "body1 is None"),
        (lambda a, b: (a, a), "body1 and body2 are both Body 'first'"),
        (lambda a, b: ("first", b), "body1 is 'first'"),
        (lambda a, b: (a, oo.Group()), "body2 is .*; it must be a Body or None"),
        (lambda a, b: (a, 0), "body2 is 0; it must be a Body or None"),
        (lambda a, b: (oo.World(), b), "body1 is "),
        (lambda a, b: (oo.Body, b), "body1 is "),
    ],
)
def test_bad_bodies_are_refused(kind, inside, pick, words):
    top, first, second = stand(inside)
    with pytest.raises(oo.TreeError, match=rf"{kind} 'it': {words}"):
        kind.make(*pick(first, second))
    unchanged(first, second)
    del top


NO_VECTOR = [(math.nan, 0, 0), (math.inf, 0, 0), (1, 2), (1, 2, 3, 4), 5.0, "abc", {1, 2, 3}, (True, False, "x")]
BAD = {
    "anchor": [*NO_VECTOR, (2e8, 0, 0)],
    "axis": [*NO_VECTOR, (0, 0, 0), (1e-13, 0, 0), None],
}
BAD_WHERE = [(kind, name, value) for kind in KINDS for name in kind.where for value in BAD[name]]


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize(("kind", "name", "value"), BAD_WHERE, ids=str)
def test_bad_anchors_and_axes_are_refused(kind, name, value, inside):
    top, first, second = stand(inside)
    with pytest.raises(oo.FieldError, match=rf"{kind} 'it'\.{name} is "):
        kind.make(first, second, **{name: value})
    unchanged(first, second)
    del top


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize(
    ("kind", "name", "value"), [case for case in BAD_WHERE if case[1:] != ("anchor", None)], ids=str
)
def test_bad_anchors_and_axes_are_refused_later_too(kind, name, value, inside):
    """Nothing changes: not the other of the two, nor the rest that coordinates count from."""
    held = Held(kind, both=True)
    if not inside:
        held.world.detach(held.space)
    native = held.joint._id
    with pytest.raises(oo.FieldError, match=rf"{kind} 'it'\.{name} is "):
        setattr(held.joint, name, value)
    assert held.joint._id == native
    held.check()


BAD_FIELDS = {
    "enabled": 1,
    "erp": -0.1,
    "cfm": 0.0,
    "stops": (1, 0),
    "stop_bounce": 2.0,
    "stop_erp": 1.5,
    "stop_cfm": -1.0,
    "motor_velocity": math.nan,
    "motor_max_force": -1.0,
    "fudge_factor": 1.5,
}


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind in KINDS for name in kind.cls.FIELDS], ids=str)
@pytest.mark.parametrize("inside", [True, False])
def test_a_bad_field_leaves_no_joint_behind(kind, name, inside):
    top, first, second = stand(inside)
    with pytest.raises(oo.FieldError, match=rf"{kind} 'it'\.{name} is "):
        kind.make(first, second, **{name: BAD_FIELDS[name]})
    unchanged(first, second)
    del top


@each_kind
def test_unknown_fields_are_type_errors(kind):
    top, first, second = stand(world=True)
    with pytest.raises(TypeError, match=rf"{kind} has no field 'enabeld'; did you mean 'enabled'"):
        kind.make(first, second, enabeld=True)
    with pytest.raises(TypeError, match="has no field 'zzz'; it has enabled"):
        kind.make(first, second, zzz=1)
    wrong = "stops" if kind in (BALL, FIXED) else "erp"
    with pytest.raises(TypeError, match=f"{kind} has no field '{wrong}'"):
        kind.make(first, second, **{wrong: None})
    unchanged(first, second)
    del top


def test_a_third_positional_argument_is_a_type_error():
    first, second = oo.Body(), oo.Body()
    for cls in (oo.Ball, oo.Hinge, oo.Slider, oo.Fixed):
        with pytest.raises(TypeError):
            cls(first, second, (0, 0, 0))
    unchanged(first, second)


# -- softness follows the World

FOLLOWED: list[tuple[Kind, str, str]] = [
    *((kind, name, name) for kind in (BALL, FIXED) for name in ("erp", "cfm")),
    *((kind, name, name[-3:]) for kind in (HINGE, SLIDER) for name in ("stop_erp", "stop_cfm", "cfm")),
]


@pytest.mark.parametrize(("kind", "name", "of_world"), FOLLOWED, ids=str)
def test_softness_follows_the_world_until_it_is_given(kind, name, of_world):
    held = Held(kind, both=True)
    joint, world = held.joint, held.world
    assert getattr(joint, name) == getattr(world, of_world)
    setattr(world, of_world, 0.625)
    assert getattr(joint, name) == 0.625
    setattr(joint, name, 0.375)
    setattr(world, of_world, 0.75)
    assert getattr(joint, name) == 0.375
    a_part_comes(held)
    first_leaves_and_comes_back(held)
    assert getattr(joint, name) == 0.375
    setattr(joint, name, None)
    assert getattr(joint, name) == 0.75
    held.body1.move_to(held.space)
    held.other = oo.World(**{of_world: 0.875})
    held.space.move_to(held.other)
    assert getattr(joint, name) == 0.875
    held.other.detach(held.space)
    assert getattr(joint, name) is None


# -- what it says


@each_kind
def test_its_repr_names_it_and_what_it_joins(kind):
    world = oo.World()
    first, second = world.attach(oo.Body(name="a")), oo.Body(name="b")
    assert repr(kind.make(first)) == f"<{kind} 'it': Body 'a' and the static world>"
    assert repr(kind.make(first, second, name="")) == f"<{kind}: Body 'a' and Body 'b', not live>"


@each_kind
def test_a_body_lists_its_joints_in_order(kind):
    body, others = oo.Body(), [oo.Body() for _ in range(3)]
    joints = [kind.make(body, other) for other in others]
    assert body.joints == tuple(joints)
    joints[1].release()
    assert body.joints == (joints[0], joints[2])
    assert others[1].joints == ()
    assert [other.joints for other in others] == [(joints[0],), (), (joints[2],)]


# -- joined bodies don't collide


@each_kind
def test_joined_bodies_pass_through_each_other(kind):
    """Without the joint they touch, also where both are joined to a third."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    first, second, third = (space.attach(oo.Body(position=(x, 0, 0))) for x in (0, 0.5, 50))
    for body in (first, second, third):
        body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    world.step()
    assert len(world.contacts) == 1
    joint = kind.make(first, second)
    world.step()
    assert len(world.contacts) == 0
    joint.release()
    others = [kind.make(first, third), kind.make(third, second), kind.make(first), kind.make(second)]
    assert all(other.is_live for other in others)
    world.step()
    assert len(world.contacts) == 1


def test_the_table_of_kinds_has_every_field_away_from_its_default():
    """Else surviving would prove nothing."""
    for kind in KINDS:
        assert {*kind.fields, "enabled"} == set(kind.cls.FIELDS)
        assert all(kind.cls.FIELDS[name].default != value for name, value in kind.fields.items())
