"""What joints have to bear, against statics, and all of them read at once."""

import math

import pytest

import osgode as oo
from tests.joints.earth import G, H, block, earth, near


@pytest.mark.parametrize("solver", ["quick", "exact"])
@pytest.mark.parametrize("make", [oo.Ball, oo.Hinge, oo.Fixed, oo.Universal, oo.Slider], ids=lambda c: c.__name__)
def test_a_hanging_weight_is_held_up_by_its_weight(make, solver):
    """Straight below or at the joint, so there is no torque; along the slider nothing is held, so it lies across."""
    world = earth(solver=solver)
    body = block(world)
    joint = make(body, feedback=True)
    world.step(5)
    reaction = joint.reaction
    assert reaction.force1 == near((0, 2 * G, 0), 1e-4)
    assert reaction.torque1 == near((0, 0, 0), 1e-4)
    assert reaction.torque == near((0, 0, 0), 1e-4)
    assert reaction.force2 == (0, 0, 0)  # the static world feels nothing


@pytest.mark.parametrize("arm", [(1.5, 0, 0), (0.7, -0.4, -1.2)])
@pytest.mark.parametrize("turned", [0.0, 1.1])
def test_a_cantilever_bears_weight_and_arm_times_weight_at_its_anchor(arm, turned):
    """Force -W, and about the anchor the torque -(arm x W), about the centre of mass none of the weight's.

    About the centre of mass the joint's force at the anchor has the arm the other way round, and what it gives
    as a torque makes up for that: in rest both together are 0.
    """
    world = earth()
    body = block(world, off=(0.1, 0.2, 0.3), at=(4, 5, 6))
    body.rotation = oo.Quat.from_axis_angle((1, 2, 3), turned)
    anchor = body.world_centre_of_mass - oo.Vec3(*arm)
    joint = oo.Fixed(body, anchor=anchor, feedback=True)
    world.step(20)
    weight = oo.Vec3(0, -2 * G, 0)
    reaction = joint.reaction
    assert reaction.force1 == near(-weight)
    assert reaction.torque1 == near((0, 0, 0))
    assert reaction.torque == near(-oo.Vec3(*arm).cross(weight))


def test_a_hinge_bears_what_it_does_not_let_turn():
    """A gate of 10 kg, 2 m wide, hung level: its weight, and W times 1 m about the horizontal across it."""
    world = earth()
    gate = world.attach(oo.Body(position=(1, 0, 0)))
    gate.fixed_mass = oo.Mass.box((2, 1, 0.1), mass=10)
    hinge = oo.Hinge(gate, anchor=(0, 0, 0), axis=(0, 1, 0), feedback=True)
    world.step(20)
    assert hinge.reaction.force1 == near((0, 10 * G, 0), 1e-4)
    assert hinge.reaction.torque == near((0, 0, 10 * G), 1e-3)


def test_a_hinge_that_swings_bears_the_pull_outwards_too():
    """At the lowest point of a swing from 60 degrees: m g + m w^2 d, with w^2 = 2 m g d (1 - cos 60) / (I + m d^2)."""
    world = earth(step_size=1 / 2000)
    bob = block(world, at=(0, -2, 0), mass=3.0)
    hinge = oo.Hinge(bob, anchor=(0, 0, 0), axis=(0, 0, 1), feedback=True)
    turn = oo.Quat.from_axis_angle((0, 0, 1), math.pi / 3)
    bob.rotation, bob.position = turn, turn.rotate((0, -2, 0))
    pulls = []
    while not pulls or hinge.angle > 0:
        world.step()
        pulls.append(hinge.reaction.force1.y)
    inertia = 3.0 / 6 * 0.5**2 + 3.0 * 4
    rate_squared = 2 * 3.0 * G * 2 * 0.5 / inertia
    assert pulls[-1] == pytest.approx(3.0 * G + 3.0 * rate_squared * 2, rel=2e-3)


@pytest.mark.parametrize(
    "make",
    [
        lambda a, b: oo.Ball(a, b, anchor=(0.4, 0.2, 0.1), feedback=True),
        lambda a, b: oo.Hinge(a, b, anchor=(0.4, 0.2, 0.1), axis=(1, 1, 0), feedback=True),
        lambda a, b: oo.Slider(a, b, axis=(1, 2, 0), feedback=True),
        lambda a, b: oo.Fixed(a, b, feedback=True),
        lambda a, b: oo.Universal(a, b, anchor=(0.4, 0.2, 0.1), feedback=True),
        lambda a, b: oo.Hinge2(a, b, feedback=True),
        lambda a, b: oo.Piston(a, b, feedback=True, motor_velocity1=1, motor_max_force1=3),
        lambda a, b: oo.PR(a, b, feedback=True),
        lambda a, b: oo.PU(a, b, feedback=True),
        lambda a, b: oo.DoubleBall(a, b, feedback=True),
        lambda a, b: oo.DoubleHinge(a, b, feedback=True),
        lambda a, b: oo.AngularMotor(a, b, feedback=True, motor_velocity1=1, motor_max_force1=3),
        lambda a, b: oo.LinearMotor(a, b, feedback=True, motor_velocity1=1, motor_max_force1=3),
    ],
)
def test_what_a_joint_does_to_one_body_it_does_to_the_other_against_it(make):
    """Forces opposite; torques too, about one and the same point; and they are what changed the momenta.

    Bodies flung about, each with its own spin, in one step of the exact solver.
    """
    world = earth(gravity=(0, 0, 0))
    a = block(world, off=(0.1, 0, -0.1))
    b = block(world, mass=5.0, at=(1.3, 0.0, 0.0), off=(0, 0.1, 0))
    joint = make(a, b)
    for body, v, w in ((a, (1, -2, 0.5), (0.3, 1, -1)), (b, (-0.5, 0.2, 1), (2, -0.4, 0.6))):
        body.linear_velocity, body.angular_velocity = v, w
        body.gyroscopic = False
    before = [(body.momentum, body.angular_momentum) for body in (a, b)]
    centres = [body.world_centre_of_mass for body in (a, b)]
    turns = [body.rotation for body in (a, b)]
    inertias = [body.inertia for body in (a, b)]
    world.step()
    r = joint.reaction
    assert r.force1.length + r.torque1.length > 0.1
    assert r.force1 + r.force2 == near((0, 0, 0), 1e-6)
    about_origin = r.torque1 + centres[0].cross(r.force1) + r.torque2 + centres[1].cross(r.force2)
    if not isinstance(joint, oo.LinearMotor):  # pushes at the centres of mass, which turns the pair
        assert about_origin == near((0, 0, 0), 1e-3)
    for body, (p, _), force in zip((a, b), before, (r.force1, r.force2), strict=True):
        assert body.momentum - p == near(force * H, 1e-6)
    for body, turn, inertia, torque, (_, spin) in zip(
        (a, b), turns, inertias, (r.torque1, r.torque2), before, strict=True
    ):
        w = turn.conjugate().rotate(body.angular_velocity)
        gained = turn.rotate(inertia @ w) - spin
        assert gained == near(torque * H, 1e-6)


def test_a_chain_of_weights_is_held_link_by_link():
    """Each joint bears all that hangs below it."""
    world = earth()
    joints, last = [], None
    for i in range(4):
        body = block(world, mass=1.0 + i, at=(0, -i, 0))
        joints.append(oo.Ball(body, last, anchor=(0, 0.5 - i, 0), feedback=True))
        last = body
    world.step(10)
    masses = [1.0, 2.0, 3.0, 4.0]
    for i, joint in enumerate(joints):
        assert joint.reaction.force1 == near((0, sum(masses[i:]) * G, 0), 1e-3)
        assert joint.reaction.force2 == (near((0, -sum(masses[i:]) * G, 0), 1e-3) if i else (0, 0, 0))


@pytest.mark.parametrize("cls", [oo.Ball, oo.Hinge, oo.Transmission, oo.AngularMotor])
def test_reaction_without_feedback_is_an_error(cls):
    world = earth()
    joint = cls(block(world), block(world, at=(1, 0, 0)))
    world.step()
    with pytest.raises(oo.StateError, match=rf"{cls.__name__}\.reaction needs feedback=True"):
        _ = joint.reaction
    joint.feedback = True
    assert joint.reaction.force1 == (0, 0, 0)
    world.step()
    assert len(joint.reaction) == 5


def test_reaction_out_of_the_world_is_an_error():
    with pytest.raises(oo.StateError, match="reaction needs the joint to be live"):
        _ = oo.Ball(oo.Body(), feedback=True).reaction


def test_reactions_are_plain_values_that_stay():
    world = earth()
    joint = oo.Ball(block(world), feedback=True)
    world.step()
    kept = joint.reaction
    copy = tuple(kept)
    joint.body1.add_force((0, -100, 0))
    world.step()
    assert tuple(kept) == copy != tuple(joint.reaction)


def test_torque_about_an_anchor_beside_a_moving_body_is_taken_where_the_anchor_is():
    """A fixed arm on a turning table of its own weight: the arm is turned by half, so is the torque's axis."""
    world = earth()
    table = world.attach(oo.Body(kinematic=True))
    arm = block(world, at=(1, 0, 0))
    joint = oo.Fixed(arm, table, anchor=(0, 0, 0), feedback=True)
    turn = oo.Quat.from_axis_angle((0, 1, 0), math.pi / 2)
    table.rotation = arm.rotation = turn
    arm.position = turn.rotate((1, 0, 0))
    world.step(5)
    arm_now = oo.Vec3(0, 0, -1)
    assert joint.reaction.torque == near(-arm_now.cross((0, -2 * G, 0)), 1e-4)


# -- all at once


def test_joint_states_of_a_thousand_joints_are_what_each_reads():
    """To the bit, whatever the kind, and in the order of world.joints when some have gone."""
    world = earth(solver="quick")
    kinds = [
        (oo.Hinge, ("angle",), ("angle_rate",)),
        (oo.Slider, ("position",), ("position_rate",)),
        (oo.Universal, ("angle1", "angle2"), ("angle_rate1", "angle_rate2")),
        (oo.Piston, ("position", "angle"), ("position_rate", "angle_rate")),
        (oo.PR, ("position", "angle"), ("position_rate", "angle_rate")),
        (oo.PU, ("angle1", "angle2", "position"), ("angle_rate1", "angle_rate2", "position_rate")),
        (oo.Ball, (), ()),
        (oo.Fixed, (), ()),
    ]
    joints, reads = [], {}
    for i in range(1000):
        cls, positions, rates = kinds[i % len(kinds)]
        body = block(world, at=(3 * i, 0, 0), off=(0.1, 0.2, 0))
        body.linear_velocity, body.angular_velocity = (0.1, 0.2, 0.3), (0.2, -0.1, 0.4)
        joint = cls(body, feedback=i % 3 == 0)
        joints.append(joint)
        reads[joint] = positions, rates
    world.step(5)
    for joint in joints[::7]:
        joint.release()
    world.step()
    rows = world.joint_states
    assert len(rows) == len(world.joints) == 1000 - len(joints[::7])
    for row, joint in zip(rows, world.joints, strict=True):
        positions, rates = reads[joint]
        assert tuple(row["position"][: len(positions)]) == tuple(getattr(joint, name) for name in positions)
        assert tuple(row["rate"][: len(rates)]) == tuple(getattr(joint, name) for name in rates)
        assert not row["position"][len(positions) :].any()
        assert not row["rate"][len(rates) :].any()
        for name in ("force1", "torque1", "force2", "torque2", "torque"):
            expected = getattr(joint.reaction, name) if joint.feedback else (0, 0, 0)
            assert tuple(row[name]) == expected
    assert sum(row["force1"].any() for row in rows) > 250
    before = rows.copy()
    world.step()
    assert (rows == before).all()  # a copy, not a view
