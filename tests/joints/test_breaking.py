"""How joints break, and who hears of it."""

import math

import pytest

import osgode as oo
from tests.joints.earth import G, H, block, earth, near


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
