"""Joints of every kind survive whatever happens to their bodies, and are live while these are in one World."""

import gc

import numpy as np
import pytest

import osgode as oo
from osgode.joints.spots import Coordinate
from tests.joints.held import (
    AXIS,
    EULER,
    FIXED,
    HINGE,
    KINDS,
    LINEAR,
    PLANE2D,
    SLIDER,
    USER,
    Held,
    assert_poses,
    each_held,
    each_kind,
    each_pair,
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
OF_EACH_SORT = [
    moves_between_spaces,
    first_leaves_and_comes_back,
    the_space_goes_to_another_world,
    the_world_is_dropped_and_another_made,
    a_part_comes,
    fixed_mass_comes,
    everything_twice,
]
MOST = [
    *OF_EACH_SORT,
    second_leaves_and_comes_back,
    all_parts_go,
    the_second_changes_its_mass,
    mass_changes_while_outside,
]
MASS_CHANGES = [a_part_comes, a_part_goes, a_part_moves, a_part_gets_heavier, all_parts_go, fixed_mass_comes]


def each(functions):
    return pytest.mark.parametrize("happen", functions, ids=lambda f: f.__name__)


def survives(kind, both, happen, given):
    held = Held(kind, both, fields=given)
    poses = [body.pose for body in held.bodies]
    before = held.own()
    assert {name: before[name] for name in given} == given
    held.check()
    happen(held)
    held.check()
    assert held.own() == before
    assert_poses(held.bodies, poses, 1e-12)
    assert held.joint.is_live
    assert held.joint.world is held.body1.world
    assert oo.live_natives().joints == 1


@each(HAPPENINGS)
@each_held
def test_a_joint_survives(kind, both, happen):
    """Anchors, axes and coordinates are where geometry says, all fields are as set, and the bodies stand as before."""
    survives(kind, both, happen, kind.given())


@each(OF_EACH_SORT)
@each_held
def test_springs_and_servos_survive(kind, both, happen):
    """In place of ERP, CFM and motors."""
    survives(kind, both, happen, kind.given("sprung"))


@each(MOST)
@each_held
def test_a_joint_that_survived_has_nothing_to_correct(kind, both, happen):
    """Nor does a disabled one come back enabled."""
    held = Held(kind, both)
    happen(held)
    if kind is PLANE2D:
        held.joint.straighten()  # it holds the centre of mass in the plane, which has moved
    held.check_it_holds()
    held.check()
    held.joint.enabled = False
    held.body1.move_to(held.space)
    held.body2.move_to(held.space)
    all_leave_and_come_back_the_other_way_round(held)
    assert held.joint.enabled is False


HOLDING = [(kind, both) for kind in KINDS for both in kind.attached if kind.holds]
each_holding = pytest.mark.parametrize(("kind", "both"), HOLDING, ids=str)


@each(OF_EACH_SORT)
@each_holding
def test_a_joint_that_survived_pulls_back_to_where_it_was_anchored(kind, both, happen):
    """From 1 cm and 0.02 rad beside what the joint allows, after the happening, to within 10 um: to the rest of old."""
    held = Held(kind, both, way=0.0)
    put(
        held.body1,
        shift((0.008, -0.005, 0.006)) * oo.Pose(rotation=oo.Quat.from_axis_angle((1, 2, 3), 0.02)) * held.body1.pose,
    )
    happen(held)
    world, joint = held.joint.world, held.joint
    assert joint.error + joint.angular_error > 2e-3
    world.solver, world.cfm = "exact", 1e-12
    for _ in range(60):
        for body in held.bodies:  # it is to be pulled, not to fly
            body.linear_velocity = body.angular_velocity = (0, 0, 0)
        world.step()
    assert joint.error < 1e-5
    if kind is not PLANE2D:  # ODE leaves it tilted
        assert joint.angular_error < 1e-5
    if kind is SLIDER:
        offset = relative(held).inverse().transform(held.body1.position) - held.rest1.position
        assert offset.cross(AXIS).length < 1e-5
    if kind is FIXED:
        assert_poses([held.body1], [relative(held) * held.rest1], 1e-5)


def relative(held):
    """How the world of rest has moved for the second body."""
    return held.body2.pose * held.rest2.inverse() if held.both else shift((0, 0, 0))


@each(MASS_CHANGES)
@each_held
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


@each_held
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
    held = Held(kind, kind.attached[0])
    native = held.joint._id
    held.body1.attach(oo.Placeable(position=(5, 5, 5))).attach(oo.Sphere(1, mass=0))
    assert held.joint._id == native


# -- live or not


@each_pair
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


@each_pair
def test_a_joint_made_between_two_worlds_waits(kind):
    one, other = oo.World(), oo.World()
    first, second = one.attach(oo.Body()), other.attach(oo.Body())
    joint = kind.make(first, second, **kind.given())
    assert not joint.is_live
    assert oo.live_natives().joints == 0
    second.move_to(one)
    assert joint.is_live
    assert {name: getattr(joint, name) for name in kind.given()} == kind.given()


@pytest.mark.parametrize("kind", [kind for kind in KINDS if False in kind.attached], ids=str)
def test_a_single_body_takes_its_joint_along(kind):
    one, other = oo.World(), oo.World()
    body = one.attach(oo.Body())
    joint = kind.make(body)
    body.move_to(other)
    assert joint.world is other
    assert joint.body1 is body
    assert joint.body2 is None


@pytest.mark.parametrize("variant", ["soft", "sprung"])
@each_held
def test_a_world_that_is_dropped_leaves_its_joints_as_plain_data(kind, both, variant):
    held = Held(kind, both, fields=kind.given(variant))
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


READ = {kind: [name for name in dir(kind.cls) if isinstance(getattr(kind.cls, name), Coordinate)] for kind in KINDS}
PUSHES = {kind: [name for name in dir(kind.cls) if name.startswith("add_")] for kind in KINDS}
TORQUES = {"add_torques": (1.0, 2.0), "add_torque": (1.0,), "add_force": (1.0,)}


def test_every_kind_that_moves_has_something_to_read():
    assert {kind.cls for kind in KINDS if not READ[kind]} == {oo.Ball, oo.Fixed, oo.Plane2D}


@each_kind
@pytest.mark.parametrize("why", ["outside", "one outside", "released"])
def test_what_needs_a_live_joint_says_so(kind, why):
    held = Held(kind, kind.attached[0])
    if why == "released":
        held.joint.release()
    else:
        held.space.detach(held.body1)
        if why == "outside":
            held.space.detach(held.body2)
    for name in [*READ[kind], *(["contact_points"] if kind.phase else [])]:
        with pytest.raises(oo.StateError, match=rf"{kind.title}\.{name}\b"):
            getattr(held.joint, name)
    for name in PUSHES[kind]:
        with pytest.raises(oo.StateError, match=rf"{kind.title}\.{name}\b"):
            getattr(held.joint, name)(*TORQUES[name])
    with pytest.raises(oo.StateError, match=rf"{kind.title}\.reaction\b"):
        _ = held.joint.reaction


@each_kind
def test_what_follows_from_the_bodies_can_not_be_set(kind):
    held = Held(kind, kind.attached[0])
    for name in [*READ[kind], *({"anchor2"} & set(kind.case.carried) - set(kind.where))]:
        with pytest.raises(AttributeError, match=rf"{kind.title}"):
            setattr(held.joint, name, 1.0)
    held.check()


@each_held
def test_outside_anchors_and_axes_follow_the_bodies(kind, both):
    """Moved by hand while outside, each body carries its side along; back inside ODE says the same."""
    held = Held(kind, both, way=0.0)
    for body in held.bodies:
        held.space.detach(body)
    one, two = (oo.Pose(oo.Vec3(1, 2, 3), oo.Quat.from_axis_angle((k, 1, 0), 0.7 + k)) for k in (1, 2))
    put(held.body1, one * held.rest1)
    held.moved, held.moved2 = one, two if both else shift((0, 0, 0))
    if both:
        put(held.body2, two * held.rest2)
    for inside in (False, True):
        if inside:
            for body in held.bodies:
                held.space.attach(body)
        assert held.joint.is_live is inside
        held.check_spots()
        if kind in (HINGE, FIXED) and both:
            anchor = kind.where["anchor"]
            assert held.joint.error == pytest.approx(one.transform(anchor).distance(two.transform(anchor)), abs=1e-9)


def test_all_joints_are_read_at_once_in_their_order():
    """Rows of `joint_states` are what each joint reads by itself, also when one in the middle has gone."""
    world = oo.World(gravity=(0, -10, 0))
    joints = []
    for kind in KINDS:
        first, second = (world.attach(oo.Body(position=(k, 2, 3 * k))) for k in (1, 2))
        joints.append(kind.make(first, second, feedback=True))
        first.angular_velocity, first.linear_velocity = (0.1, -0.2, 0.3), (1, 2, 3)
    joints[4].release()
    assert set(world.joints) == {*joints[:4], *joints[5:]}
    world.step(3)
    for joint, row in zip(world.joints, world.joint_states, strict=True):
        for name in READ[next(kind for kind in KINDS if kind.cls is type(joint))]:
            what = getattr(type(joint), name)
            assert getattr(joint, name) == row[what.row][what.index]
        for name, value in joint.reaction._asdict().items():
            assert value == tuple(row[name])
    assert any(row["force1"].any() for row in world.joint_states)


# -- what it says


@each_kind
def test_its_repr_names_it_and_what_it_joins(kind):
    world = oo.World()
    first, second = world.attach(oo.Body(name="a")), oo.Body(name="b")
    if False in kind.attached:
        assert repr(kind.make(first)) == f"<{kind.title}: Body 'a' and the static world>"
    if True in kind.attached:
        assert repr(kind.make(first, second, name="")) == f"<{kind.cls.__name__}: Body 'a' and Body 'b', not live>"
        joint = kind.make(first, second)
        joint.release()
        assert repr(joint) == f"<{kind.title}: Body 'a' and Body 'b', released>"


@each_pair
def test_a_body_lists_its_joints_in_order(kind):
    body, others = oo.Body(), [oo.Body() for _ in range(3)]
    joints = [kind.make(body, other) for other in others]
    assert body.joints == tuple(joints)
    joints[1].release()
    assert body.joints == (joints[0], joints[2])
    assert others[1].joints == ()
    assert [other.joints for other in others] == [(joints[0],), (), (joints[2],)]


# -- joined bodies don't collide


@each_pair
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
    others = [kind.make(first, third), kind.make(third, second)]
    if False in kind.attached:
        others += [kind.make(first), kind.make(second)]
    assert all(other.is_live for other in others)
    world.step()
    assert len(world.contacts) == 1


@each_kind
def test_the_table_of_kinds_has_every_field_away_from_its_default(kind):
    """Else surviving would prove nothing."""
    soft, sprung = kind.given(), kind.given("sprung")
    assert {*soft, *sprung, *kind.lacks, "enabled"} == set(kind.cls.FIELDS)
    assert not {*soft, *sprung} & set(kind.lacks)
    for given in (soft, sprung):
        assert all(kind.cls.FIELDS[name].default != value for name, value in given.items())


def test_the_table_has_every_kind_and_mode():
    joints = [getattr(oo, name) for name in oo.__all__]
    wanted = {cls for cls in joints if isinstance(cls, type) and issubclass(cls, oo.Joint) and cls is not oo.Joint}
    assert {kind.cls for kind in KINDS} == wanted
    assert USER.where["mode"] == "user"
    assert EULER.where["mode"] == "euler"
    modes = {kind.where["mode"] for kind in KINDS if kind.cls is oo.Transmission}
    assert modes == {"parallel", "intersecting", "chain"}
    assert not LINEAR.holds
