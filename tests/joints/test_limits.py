"""Stops and motors of hinges and sliders: holding, freeing, and what is refused."""

import math
import threading

import pytest

import osgode as oo
from tests.joints.held import AXIS, HINGE, SLIDER, Held, each_attachment, each_moving, put, shift, turn


def coordinate(joint):
    return joint.angle if isinstance(joint, oo.Hinge) else joint.position


def rate(joint):
    return joint.angle_rate if isinstance(joint, oo.Hinge) else joint.position_rate


def driven(kind, both=False, **fields):
    """At 0, driven at 2 rad/s or m/s, strong enough to be at speed within some steps."""
    held = Held(kind, both, way=0.0, fields={"motor_velocity": 2.0, "motor_max_force": 500.0, **fields})
    held.world.solver = "exact"
    return held


each_solver = pytest.mark.parametrize(("solver", "near"), [("quick", 2e-2), ("exact", 2e-3)])


@each_solver
@each_attachment
@each_moving
def test_stops_hold_against_the_motor_on_both_sides(kind, both, solver, near):
    held = driven(kind, both, stops=(-0.4, 0.6))
    held.world.solver = solver
    held.world.run(1.0)
    assert coordinate(held.joint) == pytest.approx(0.6, abs=near)
    held.joint.motor_velocity = -2.0
    held.world.run(1.5)
    assert coordinate(held.joint) == pytest.approx(-0.4, abs=near)


@each_solver
@each_attachment
@each_moving
def test_stops_taken_away_and_given_back_at_the_stop(kind, both, solver, near):
    """Each time it runs free without, and is held at the next stop with; many times, and it never ends the process."""
    held = driven(kind, both)
    joint, world = held.joint, held.world
    world.solver = solver
    stop = 0.0
    for k in range(8):
        stop = 0.3 * (k + 1)
        joint.stops = (-1.0, stop)
        world.run(0.4)
        assert coordinate(joint) == pytest.approx(stop, abs=near)
        assert solver == "quick" or rate(joint) == pytest.approx(0.0, abs=1e-2)
        joint.stops = None
        assert joint.stops is None
        world.step(3)
        assert rate(joint) > 0.05
        assert coordinate(joint) > stop
    world.run(0.5)
    assert rate(joint) == pytest.approx(2.0, rel=1e-2)


@each_moving
def test_stops_removed_without_a_motor_leave_it_free(kind):
    """Resting at its stop and pushed against it, it holds; freed, the same push moves it at once."""
    held = Held(kind, both=False, way=0.0, fields={"stops": (-1.0, 0.0)})
    world, joint = held.world, held.joint
    world.solver = "exact"
    push = joint.add_torque if kind is HINGE else joint.add_force
    for _ in range(20):
        push(5.0)
        world.step()
    assert coordinate(joint) == pytest.approx(0.0, abs=1e-6)
    joint.stops = None
    push(5.0)
    world.step()
    assert rate(joint) > 1e-3
    world.step(50)
    assert coordinate(joint) > 1e-4


@pytest.mark.parametrize("way", [1, -1])
def test_a_hinge_without_stops_turns_through_half_a_turn(way):
    """From exactly pi, where ODE's own way to say "no stop" is near, it goes on turning at its speed."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body())
    hinge = oo.Hinge(body, stops=(-1, 1))
    hinge.stops = None
    body.rotation = (0, 0, 1, 0)
    assert abs(hinge.angle) == math.pi
    body.angular_velocity = (0, way, 0)
    world.step(12)
    assert hinge.angle == pytest.approx(way * (0.1 - math.pi), abs=1e-5)
    assert hinge.angle_rate == pytest.approx(way, abs=1e-9)


@each_attachment
@each_moving
@pytest.mark.parametrize("value", [0.0, 0.5, -0.25])
def test_equal_stops_hold_it_there_from_both_sides(kind, both, value):
    for velocity in (2.0, -2.0):
        held = driven(kind, both, stops=(value, value), motor_velocity=velocity)
        assert held.joint.stops == (value, value)
        held.world.run(1.5)
        assert coordinate(held.joint) == pytest.approx(value, abs=5e-3)
        held.joint.stops = None
        held.world.run(0.2)
        assert abs(coordinate(held.joint) - value) > 0.1


@each_attachment
@each_moving
@pytest.mark.parametrize(("start", "stops", "end"), [(1.0, (-0.5, 0.5), 0.5), (-1.0, (-0.5, 0.5), -0.5)])
def test_outside_its_stops_it_comes_back_to_the_nearer(kind, both, start, stops, end):
    held = Held(kind, both, way=0.0)
    held.world.solver = "exact"
    motion = turn(start) if kind is HINGE else shift(AXIS * start)
    put(held.body1, held.ride * motion * held.ride.inverse() * held.body1.pose)
    assert coordinate(held.joint) == pytest.approx(start, abs=1e-9)
    held.joint.stops = stops
    for _ in range(60):
        held.world.step()
        for body in held.bodies:
            body.linear_velocity = body.angular_velocity = (0, 0, 0)
    assert coordinate(held.joint) == pytest.approx(end, abs=1e-3)


@each_moving
@pytest.mark.parametrize("live", [True, False])
@pytest.mark.parametrize(
    "bad", [(1.0, 0.5), (0.0,), (0, 1, 2), 1.0, (math.nan, 1), (0, math.nan), (-math.inf, 0), (0, math.inf), "ab", ()]
)
def test_bad_stops_are_refused(kind, live, bad):
    held = Held(kind, both=True, fields={"stops": (-0.5, 0.75)})
    if not live:
        held.world.detach(held.space)
    with pytest.raises(oo.FieldError, match=rf"{kind} 'it'\.stops is .*; it must be two numbers \(low, high\)"):
        held.joint.stops = bad
    assert held.joint.stops == (-0.5, 0.75)
    with pytest.raises(oo.FieldError, match=r"'it'\.stops is "):
        kind.make(held.body1, held.body2, stops=bad)
    assert held.body1.joints == (held.joint,)


def test_a_hinge_has_stops_within_half_a_turn():
    hinge = oo.Hinge(oo.Body(), stops=(-math.pi, math.pi))
    assert hinge.stops == (-math.pi, math.pi)
    for bad in ((0, 3.1416), (-3.1416, 0), (3.2, 3.3), (0, 1e9)):
        with pytest.raises(oo.FieldError, match=r"Hinge\.stops is "):
            hinge.stops = bad
    assert hinge.stops == (-math.pi, math.pi)


def test_a_slider_has_stops_within_the_bounds_of_the_world():
    slider = oo.Slider(oo.Body(), stops=(-1e8, 1e8))
    assert slider.stops == (-1e8, 1e8)
    for bad in ((0, 1.1e8), (-1.1e8, 0)):
        with pytest.raises(oo.FieldError, match=r"Slider\.stops is "):
            slider.stops = bad


@each_moving
def test_stops_move_past_each_other(kind):
    """A new pair on either side of the old one is kept as it is, in whichever order ODE is told."""
    held = Held(kind, both=True)
    for stops in ((1.0, 2.0), (-2.0, -1.0), (2.5, 3.0), (-3.0, 3.0), (0.0, 0.0), (-1.5, -1.5), None, (1, 1)):
        held.joint.stops = stops
        assert held.joint.stops == stops


@each_moving
def test_a_stop_gives_back_its_share_of_the_speed(kind):
    """Run into at v, it is left at stop_bounce * v."""
    held = Held(kind, both=False, way=0.0, fields={"stops": (-9 if kind is SLIDER else -3, 0.25), "stop_bounce": 0.5})
    held.world.solver = "exact"
    held.joint.motor(1.0, 1e6)
    held.world.step(3)
    held.joint.motor(0.0, 0.0)
    fast = rate(held.joint)
    assert fast == pytest.approx(1.0, rel=1e-2)
    while rate(held.joint) > 0:
        held.world.step()
        assert held.world.steps < 100
    assert rate(held.joint) == pytest.approx(-0.5 * fast, rel=2e-2)


@each_moving
def test_a_motor_is_set_as_one(kind):
    held = Held(kind, both=True)
    held.joint.motor(1.5, 20)
    assert (held.joint.motor_velocity, held.joint.motor_max_force) == (1.5, 20.0)
    for bad in ((math.nan, 30), (2.0, -1), (math.inf, 30), (2.0, math.nan), ("x", 30), (2.0, None)):
        with pytest.raises(oo.FieldError, match=rf"{kind} 'it'\.motor_(velocity|max_force) is "):
            held.joint.motor(*bad)
        assert (held.joint.motor_velocity, held.joint.motor_max_force) == (1.5, 20.0)


@each_moving
def test_a_motor_without_force_does_nothing(kind):
    held = driven(kind, motor_max_force=0.0)
    held.world.step(30)
    assert coordinate(held.joint) == pytest.approx(0.0, abs=1e-9)


@each_attachment
@each_moving
def test_a_motor_at_speed_0_is_a_brake(kind, both):
    held = driven(kind, both)
    held.world.run(0.3)
    assert rate(held.joint) == pytest.approx(2.0, rel=1e-2)
    held.joint.motor(0.0, 500.0)
    held.world.run(0.3)
    assert rate(held.joint) == pytest.approx(0.0, abs=1e-3)


@each_moving
@pytest.mark.parametrize("order", [("stops", "motor_max_force"), ("motor_max_force", "stops")])
def test_stops_and_an_overwhelming_motor_exclude_each_other(kind, order):
    """Of 2e9 the stop would give way; whichever comes second is refused, and nothing changes."""
    values = {"stops": (-1.0, 1.0), "motor_max_force": 2e9}
    held = Held(kind, both=True)
    first, second = order
    setattr(held.joint, first, values[first])
    default = getattr(held.joint, second)
    with pytest.raises(oo.FieldError, match=f"{kind} 'it'"):
        setattr(held.joint, second, values[second])
    assert getattr(held.joint, second) == default
    assert getattr(held.joint, first) == values[first]
    with pytest.raises(oo.FieldError, match=f"{kind} 'it'"):
        kind.make(held.body1, held.body2, **{name: values[name] for name in order})
    assert held.body1.joints == (held.joint,)
    setattr(held.joint, first, None if first == "stops" else 0.0)
    setattr(held.joint, second, values[second])
    assert getattr(held.joint, second) == values[second]


def pushes(joint):
    (joint.add_torque if isinstance(joint, oo.Hinge) else joint.add_force)(1.0)


WAKING = {
    "motor": lambda joint: joint.motor(1.0, 5.0),
    "velocity": lambda joint: setattr(joint, "motor_velocity", 1.0),
    "force": lambda joint: setattr(joint, "motor_max_force", 5.0),
    "stops": lambda joint: setattr(joint, "stops", (0.5, 1.0)),
    "no stops": lambda joint: setattr(joint, "stops", None),
    "push": pushes,
}


@each_attachment
@each_moving
@pytest.mark.parametrize("what", WAKING)
def test_what_drives_a_joint_wakes_its_bodies(kind, both, what):
    """Or a sleeping door would not open."""
    held = Held(kind, both)
    for body in held.bodies:
        body.enabled = False
    WAKING[what](held.joint)
    assert all(body.enabled for body in held.bodies)


@each_attachment
@each_moving
def test_a_joint_made_with_a_motor_wakes_its_bodies(kind, both):
    held = Held(kind, both)
    held.joint.release()
    for body in held.bodies:
        body.enabled = False
    joint = kind.make(held.body1, held.body2 if both else None, motor_velocity=1.0, motor_max_force=1e3)
    assert all(body.enabled for body in held.bodies)
    held.world.run(0.1)
    assert coordinate(joint) > 0


@each_moving
def test_refused_settings_wake_nothing(kind):
    held = Held(kind, both=True)
    held.body1.enabled = held.body2.enabled = False
    for name, bad in (("stops", (1, 0)), ("motor_velocity", math.nan), ("motor_max_force", -1)):
        with pytest.raises(oo.FieldError):
            setattr(held.joint, name, bad)
    with pytest.raises(oo.FieldError):
        held.joint.motor(1.0, -1.0)
    assert not held.body1.enabled
    assert not held.body2.enabled


@each_moving
def test_a_motor_set_outside_drives_when_the_bodies_come_in(kind):
    held = Held(kind, both=True, way=0.0)
    held.world.detach(held.space)
    held.joint.motor(1.0, 500.0)
    held.joint.stops = (-0.5, 0.25)
    held.world.attach(held.space)
    held.world.solver = "exact"
    held.world.run(0.2)
    assert rate(held.joint) == pytest.approx(1.0, rel=1e-2)
    held.world.run(0.5)
    assert coordinate(held.joint) == pytest.approx(0.25, abs=2e-3)


@each_moving
def test_a_stop_holds_on_while_masses_change(kind):
    """At its stop it is made again five times, driven all the while, and stays there."""
    held = driven(kind, stops=(-0.5, 0.25))
    held.world.run(0.5)
    for k in range(5):
        held.body1.fixed_mass = oo.Mass(3.0 + k, oo.Vec3(0.1 * k, 0.2, -0.1))
        held.world.run(0.1)
        assert coordinate(held.joint) == pytest.approx(0.25, abs=2e-3)


@pytest.mark.parametrize("live", [False, True])
def test_a_motor_too_strong_for_the_stops_is_refused_with_both_its_numbers(live):
    world = oo.World()
    body = oo.Body(position=(1, 0, 0))
    hinge = oo.Hinge(body, stops=(-1, 1), motor_velocity=0.5, motor_max_force=3.0)
    if live:
        world.attach(body)
    for velocity, force in ((2.0, 1.1e9), (2.0, math.inf), (math.nan, 4.0), (2.0, -1.0), (2.0, math.nan), ("2", 4.0)):
        with pytest.raises(oo.FieldError):
            hinge.motor(velocity, force)
        assert (hinge.motor_velocity, hinge.motor_max_force) == (0.5, 3.0)
    hinge.stops = None
    hinge.motor(2.0, math.inf)
    assert (hinge.motor_velocity, hinge.motor_max_force) == (2.0, math.inf)
    with pytest.raises(oo.FieldError, match="at most 1e"):
        hinge.stops = (-1, 1)
    assert hinge.stops is None
    hinge.motor(-1.0, 7.0)
    hinge.stops = (-1, 1)
    assert (hinge.motor_velocity, hinge.motor_max_force, hinge.stops) == (-1.0, 7.0, (-1.0, 1.0))


def test_setting_a_motor_while_another_thread_steps_is_refused():
    world = oo.World()
    body = world.attach(oo.Body())
    hinge = oo.Hinge(body)
    errors = []

    def drive():
        try:
            hinge.motor(1.0, 2.0)
        except oo.StateError as error:
            errors.append(error)

    with world._realm.editing():
        thread = threading.Thread(target=drive)
        thread.start()
        thread.join()
    assert len(errors) == 1
    assert (hinge.motor_velocity, hinge.motor_max_force) == (0.0, 0.0)
