"""What joints have to bear, against statics, and how they break."""

import math

import pytest

import osgode as oo

G = 9.81
H = 1 / 120


def earth(**fields):
    return oo.World(**{"gravity": (0, -G, 0), "solver": "exact", "step_size": H} | fields)


def block(world, mass=2.0, at=(0, 0, 0), off=(0, 0, 0), name=""):
    """A cube whose origin is at a point and whose centre of mass is off it."""
    body = world.attach(oo.Body(position=at, name=name))
    body.fixed_mass = oo.Mass.box((0.5, 0.5, 0.5), mass=mass).translated(off)
    return body


def near(value, tolerance=1e-5):
    return pytest.approx(value, abs=tolerance)


# -- reactions


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


# -- breaking


class Hears:
    """A listener that writes down what it hears, and when."""

    def __init__(self, world, log=None):
        self.world, self.log = world, [] if log is None else log

    def __call__(self, event):
        self.log.append((event.joint.name, event.reason, self.world.steps, event.force, event.torque))


@pytest.mark.parametrize("make", [oo.Ball, oo.Hinge, oo.Fixed, oo.Universal], ids=lambda c: c.__name__)
@pytest.mark.parametrize(("limit", "breaks"), [(2 * G * 1.001, False), (2 * G * 0.999, True)])
def test_a_joint_breaks_above_its_force(make, limit, breaks):
    world = earth()
    body = block(world)
    joint = make(body, name="it", break_force=limit)
    log = joint.on_let_go(Hears(world)).log
    world.step(30)
    assert joint.broken is joint.released is breaks
    assert joint.is_live is not breaks
    assert (body.position.y < -0.1) is breaks
    if breaks:
        assert log == [("it", "broke", 1, pytest.approx(2 * G, rel=1e-5), pytest.approx(0.0, abs=1e-5))]
        assert world.joints == ()
        assert joint not in body.joints
        assert "broken" in repr(joint)
    else:
        assert not log
        assert joint.reaction.force1 == near((0, 2 * G, 0), 1e-4)


@pytest.mark.parametrize(("limit", "breaks"), [(2 * G * 1.5 * 1.001, False), (2 * G * 1.5 * 0.999, True)])
@pytest.mark.parametrize("both", [False, True], ids=["static", "both"])
def test_a_joint_breaks_above_its_torque_about_the_anchor(limit, breaks, both):
    """A beam's end 1.5 m from the wall; its weight alone would not break it."""
    world = earth()
    wall = world.attach(oo.Body(kinematic=True)) if both else None
    joint = oo.Fixed(block(world, at=(1.5, 0, 0)), wall, anchor=(0, 0, 0), break_torque=limit, break_force=1e3)
    log = joint.on_let_go(Hears(world)).log
    world.step(30)
    assert joint.broken is breaks
    assert [entry[1] for entry in log] == ["broke"] * breaks
    if breaks:
        assert log[0][4] == pytest.approx(2 * G * 1.5, rel=1e-4)


def test_taken_at_the_far_end_the_same_beam_bears_no_torque():
    """The anchor says where the seam is."""
    world = earth()
    joint = oo.Fixed(block(world, at=(1.5, 0, 0)), anchor=(1.5, 0, 0), break_torque=0.1)
    world.step(30)
    assert not joint.broken


def crane(**fields):
    """A body on a joint, on which a falling bucket pulls harder and harder by a spring."""
    world = earth()
    body, bucket = block(world), block(world, mass=20.0, at=(0, 3, 0))
    oo.DoubleBall(bucket, body, stiffness=200.0)
    return world, oo.Ball(body, name="rope", **fields)


@pytest.mark.parametrize("count", [1, 7, 1000])
def test_it_breaks_in_the_right_step_of_many(count):
    """The first in which it bears too much, however many are asked for in one call.

    As seen by the same crane with a joint that holds, and is released by hand after that very step.
    """
    world, joint = crane(break_force=100.0)
    log = joint.on_let_go(Hears(world)).log
    while world.steps < 1000:
        world.step(min(count, 1000 - world.steps))
    [(_, _, broke, force, _)] = log
    again, held = crane(feedback=True)
    forces = []
    for _ in range(broke):
        again.step()
        forces.append(held.reaction.force1.length)
    assert broke > 10
    assert max(forces[:-1]) <= 100.0 < forces[-1] == force
    held.release()
    again.step(1000 - broke)
    assert joint.body1.position == held.body1.position
    assert world.steps == 1000


def test_the_listener_is_called_after_the_step_with_all_done():
    """It sees the joint let go of, at the time of the step; steps that were asked for beyond it go on afterwards."""
    world = earth()
    joint = oo.Ball(block(world), break_force=1.0)
    seen = []

    @joint.on_let_go
    def note(event):
        seen.append((world.steps, world.time, event.joint.broken, event.joint.is_live, world.joints, event.joint.body1))

    world.step(1000)
    assert seen == [(1, pytest.approx(H), True, False, (), joint.body1)]
    assert world.steps == 1000
    assert world.time == pytest.approx(1000 * H)


def test_joints_that_break_in_one_step_are_told_in_the_order_of_the_world():
    """All have let go before the first is told."""
    world = earth()
    log, joints = [], []
    for i in range(5):
        joint = oo.Ball(block(world, at=(3 * i, 0, 0)), name=str(i), break_force=1.0 if i != 2 else 1e6)
        joints.append(joint)

        @joint.on_let_go
        def note(event):
            log.append(event.joint.name)
            assert [joint.broken for joint in joints] == [True, True, False, True, True]

    world.step()
    assert log == ["0", "1", "3", "4"]
    assert world.joints == (joints[2],)


def test_every_listener_hears_though_one_raises():
    """Those of the same joint and of the others; then the error leaves step, and the World goes on."""
    world = earth()
    heard = []
    for i in range(2):
        joint = oo.Ball(block(world, at=(3 * i, 0, 0)), name=str(i), break_force=1.0)

        @joint.on_let_go
        def fail(event):
            raise RuntimeError(f"listener of {event.joint.name}")

        joint.on_let_go(lambda event: heard.append(event.joint.name))
    with pytest.raises(ExceptionGroup, match=r"several .* failed") as caught:
        world.step(10)
    assert heard == ["0", "1"]
    assert [str(error) for error in caught.value.exceptions] == ["listener of 0", "listener of 1"]
    assert world.joints == ()
    world.step(10)
    assert world.steps == 11


def test_every_listener_hears_of_a_body_that_leaves_though_one_raises():
    world = earth()
    body = block(world)
    heard = []
    for i in range(3):
        joint = oo.Ball(body, block(world, at=(3 + i, 0, 0)), name=str(i))

        @joint.on_let_go
        def fail(event):
            heard.append((event.joint.name, event.reason))
            raise RuntimeError(event.joint.name)

    with pytest.raises(ExceptionGroup, match=r"several .* failed") as caught:
        world.detach(body)
    assert heard == [("0", "left"), ("1", "left"), ("2", "left")]
    assert [str(error) for error in caught.value.exceptions] == ["0", "1", "2"]
    assert "raised by a joint listener of Ball '1', which left" in caught.value.exceptions[1].__notes__
    assert not body.is_live


def test_a_listener_may_change_the_tree():
    """It takes the body out, puts another in, and joins that; the next steps are as if it had been so before."""
    world = earth()
    space = world.attach(oo.SimpleSpace())
    body = space.attach(oo.Body())
    body.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    joint = oo.Ball(body, break_force=1.0)
    made = []

    @joint.on_let_go
    def rebuild(event):
        space.detach(event.joint.body1)
        fresh = space.attach(oo.Body(position=(0, 10, 0)))
        fresh.fixed_mass = oo.Mass.sphere(0.5, mass=2)
        made.append(oo.Ball(fresh, break_force=1.0))
        made[-1].on_let_go(lambda event: world.detach(space))

    world.step(20)
    assert not body.is_live
    assert made[0].broken
    assert not space.is_live
    assert world.bodies == world.joints == ()
    assert world.steps == 20


def test_a_listener_may_not_step():
    world = earth()
    joint = oo.Ball(block(world), break_force=1.0)
    joint.on_let_go(lambda event: world.step())
    with pytest.raises(oo.StateError, match="from a listener inside a step"):
        world.step()
    assert joint.broken


def test_a_listener_taken_back_hears_nothing():
    world = earth()
    joint = oo.Ball(block(world), break_force=1.0)
    hears = joint.on_let_go(Hears(world))
    joint.remove_on_let_go(hears)
    with pytest.raises(ValueError, match="not in list"):
        joint.remove_on_let_go(hears)
    world.step()
    assert joint.broken
    assert not hears.log


def test_asleep_or_switched_off_nothing_breaks():
    """The last step's load is of no account then; awake or switched on, it breaks at once."""
    world = earth(auto_disable=True)
    body = block(world)
    joint = oo.Ball(body, feedback=True)
    world.run(3.0)
    assert not body.enabled
    assert joint.reaction.force1.length > 1.0
    joint.break_force = 1.0
    body.enabled = False
    world.step(10)
    assert not joint.broken
    body.wake()
    world.step()
    assert joint.broken

    off = oo.Ball(block(world, at=(5, 0, 0)), break_force=1.0, enabled=False)
    world.step(10)
    assert not off.broken
    off.enabled = True
    world.step()
    assert off.broken


def test_a_broken_joint_wakes_its_bodies_and_stays_broken():
    world = earth()
    body = block(world)
    joint = oo.Ball(body, break_force=1.0)
    world.step()
    space = world.attach(oo.SimpleSpace())
    world.detach(body)
    space.attach(body)
    assert joint.broken
    assert not joint.is_live
    joint.release()
    joint.break_force = None
    world.step(10)
    assert body.linear_velocity.y == pytest.approx(-G * 10 * H, rel=1e-6)


def test_a_limit_taken_away_in_time_breaks_nothing():
    world = earth()
    joint = oo.Ball(block(world), break_force=1.0, break_torque=1.0)
    joint.break_force = None
    world.step(5)
    assert not joint.broken
    joint.break_torque = None
    joint.break_force = 1.0
    world.step()
    assert joint.broken


def test_limits_survive_leaving_and_another_world():
    """And the anchor that the torque is taken about, when the centre of mass has moved."""
    world = earth()
    body = block(world, at=(1, 0, 0))
    joint = oo.Fixed(body, anchor=(0, 0, 0), break_torque=100.0)
    world.detach(body)
    body.fixed_mass = oo.Mass.box((0.5, 0.5, 0.5), mass=2).translated((3, 0, 0))
    other = earth()
    other.attach(body)
    other.step(3)
    assert joint.reaction.torque == near((0, 0, 8 * G), 1e-3)
    assert not joint.broken
    joint.break_torque = 8 * G * 0.999
    other.step()
    assert joint.broken


def test_release_and_leaving_are_told_apart_from_breaking():
    world = earth()
    body, second = block(world), block(world, at=(3, 0, 0))
    joint = oo.Ball(body, second, name="it", break_force=1e9)
    log = joint.on_let_go(Hears(world)).log
    world.detach(body)
    world.attach(body)
    joint.release()
    joint.release()
    assert [entry[1] for entry in log] == ["left", "released"]
    assert not joint.broken


@pytest.mark.parametrize("bad", [-1.0, math.nan, "x"])
@pytest.mark.parametrize("name", ["break_force", "break_torque"])
def test_bad_limits_are_refused(name, bad):
    world = earth()
    joint = oo.Ball(block(world))
    with pytest.raises(oo.FieldError, match=rf"Ball\.{name} is "):
        setattr(joint, name, bad)
    assert getattr(joint, name) is None


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
