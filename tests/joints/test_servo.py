"""Servos: where they go, how fast, how hard, and what they survive."""

import math
from itertools import pairwise

import pytest

import osgode as oo

GRAVITY = 9.81
H = 1 / 120
MASS, RADIUS = 2.0, 0.3
INERTIA = 0.4 * MASS * RADIUS**2
AXIS = oo.Vec3(0, 1, 0)


def ball(world, **where):
    body = world.attach(oo.Body(**where))
    body.fixed_mass = oo.Mass.sphere(RADIUS, mass=MASS)
    return body


def stand(kind, *, both=False, gravity=0.0, solver="exact", **fields):
    """A World with a hinge or slider about or along the vertical through the middle of a ball, or of two."""
    world = oo.World(gravity=(0, -gravity, 0), solver=solver, step_size=H)
    body2 = ball(world) if both else None
    return world, kind(ball(world), body2, axis=AXIS, **fields)


def where(joint):
    return joint.angle if isinstance(joint, oo.Hinge) else joint.position


def rate(joint):
    return joint.angle_rate if isinstance(joint, oo.Hinge) else joint.position_rate


each_kind = pytest.mark.parametrize("kind", [oo.Hinge, oo.Slider])
each_both = pytest.mark.parametrize("both", [False, True], ids=["static", "both"])


def recurrence(target, *, frequency, ratio, max_speed, x=0.0, v=0.0):
    """The documented spring to the target: implicit Euler, cut off at the highest speed. For ever."""
    k, d = frequency**2, 2 * ratio * frequency
    while True:
        v = (v + H * k * (target - x)) / (1 + H * d + H * H * k)
        v = max(-max_speed, min(max_speed, v))
        x += H * v
        yield x, v


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("frequency", [4.0, 10.0, 300.0])
@each_both
@each_kind
def test_it_answers_a_step_as_documented(kind, both, frequency, ratio):
    """With enough force, to 2e-4: ODE turns by chords, 2 atan(w h / 2) for w h, and its motor gives way a little."""
    world, joint = stand(kind, both=both)
    joint.servo = oo.Servo(target=0.7, max_speed=50.0, max_force=1e6, frequency=frequency, damping_ratio=ratio)
    expected = recurrence(0.7, frequency=frequency, ratio=ratio, max_speed=50.0)
    near = 2e-4 if kind is oo.Slider or frequency < 100 else 3e-2
    for _, (x, v) in zip(range(240), expected, strict=False):
        world.step()
        assert where(joint) == pytest.approx(x, abs=near)
        assert rate(joint) == pytest.approx(v, abs=100 * near)
    assert joint.servo.arrived == (abs(x - 0.7) < 1e-3)


@pytest.mark.parametrize("solver", ["quick", "exact"])
@pytest.mark.parametrize("target", [-2.0, 0.5, 3.0])
@each_both
@each_kind
def test_it_arrives_and_stays_critically_damped_without_overshoot(kind, both, target, solver):
    world, joint = stand(kind, both=both, solver=solver, servo=oo.Servo(target=target, max_speed=20.0, max_force=1e4))
    most = 0.0
    for _ in range(240):
        world.step()
        most = max(most, abs(where(joint)))
    assert joint.servo.arrived
    assert where(joint) == pytest.approx(target, abs=1e-5)
    assert most <= abs(target) + 1e-5
    world.run(5.0)
    assert where(joint) == pytest.approx(target, abs=1e-6)
    assert rate(joint) == pytest.approx(0.0, abs=1e-6)


@each_both
@each_kind
def test_it_keeps_to_its_speed(kind, both):
    """A long way is done at max_speed, so it takes (way / speed) and not less."""
    world, joint = stand(kind, both=both, servo=oo.Servo(target=2.5, max_speed=0.5, max_force=1e4))
    rates = []
    for _ in range(round(2.5 / 0.5 / H)):
        world.step()
        rates.append(rate(joint))
    assert max(rates) == pytest.approx(0.5, rel=1e-6)
    assert rates[60:480] == pytest.approx([0.5] * 420, rel=1e-6)
    assert where(joint) == pytest.approx(2.5, abs=0.05)
    assert not joint.servo.arrived or abs(where(joint) - 2.5) < 1e-3
    world.run(1.5)
    assert joint.servo.arrived


@each_both
@each_kind
def test_it_keeps_to_its_force(kind, both):
    """Until it brakes it speeds up by force h / inertia in a step, no more."""
    inertia = (INERTIA if kind is oo.Hinge else MASS) / (2 if both else 1)
    force = 0.5 * inertia
    world, joint = stand(kind, both=both, servo=oo.Servo(target=3.0, max_speed=50.0, max_force=force))
    for n in range(1, 60):
        world.step()
        assert rate(joint) == pytest.approx(force * n * H / inertia, rel=1e-6)
    rates = [rate(joint)]
    for _ in range(600):
        world.step()
        rates.append(rate(joint))
    assert all(abs(b - a) <= force * H / inertia * (1 + 1e-6) for a, b in pairwise(rates))


@pytest.mark.parametrize("solver", ["quick", "exact"])
def test_a_load_does_not_shift_where_it_rests(solver):
    """A slider lifts a weight, a hinge holds an arm out level: both exactly at the target under gravity."""
    world, slider = stand(oo.Slider, gravity=GRAVITY, solver=solver, servo=oo.Servo(target=0.5, max_force=100.0))
    arm = world.attach(oo.Body(position=(5, 0, 0)))
    arm.fixed_mass = oo.Mass.box((1, 0.1, 0.1), mass=3).translated((0.5, 0, 0))
    hinge = oo.Hinge(arm, axis=(0, 0, 1), servo=oo.Servo(target=0.4, max_force=100.0))
    world.run(6.0)
    assert slider.position == pytest.approx(0.5, abs=1e-6)
    assert hinge.angle == pytest.approx(0.4, abs=1e-5)
    assert slider.servo.arrived
    assert hinge.servo.arrived


def test_a_load_stronger_than_its_force_moves_it():
    """It sinks at g - F / m."""
    world, slider = stand(oo.Slider, gravity=GRAVITY, servo=oo.Servo(target=0.0, max_force=0.5 * MASS * GRAVITY))
    world.step(60)
    assert slider.position_rate == pytest.approx(-0.5 * GRAVITY * 60 * H, rel=1e-6)
    assert not slider.servo.arrived


@each_both
@each_kind
@pytest.mark.parametrize(("target", "end"), [(2.0, 0.6), (-2.0, -0.4), (0.3, 0.3)])
def test_it_respects_the_stops(kind, both, target, end):
    world, joint = stand(kind, both=both, stops=(-0.4, 0.6), servo=oo.Servo(target=target, max_force=5.0))
    world.run(6.0)
    assert where(joint) == pytest.approx(end, abs=1e-4)
    assert joint.servo.arrived == (target == end)
    joint.servo.target = 0.1
    world.run(4.0)
    assert where(joint) == pytest.approx(0.1, abs=1e-4)


@pytest.mark.parametrize(
    ("start", "target", "way"), [(3.0, -3.0, 1), (-3.0, 3.0, -1), (2.0, -1.0, -1), (0.5, 0.5 + math.tau, 0)]
)
def test_a_hinge_without_stops_turns_the_shorter_way_round(start, target, way):
    world, hinge = stand(oo.Hinge)
    hinge.body1.rotation = oo.Quat.from_axis_angle(AXIS, start)
    hinge.servo = oo.Servo(target=target, max_force=1e3, max_speed=5.0)
    world.step(3)
    assert math.copysign(1, hinge.angle_rate) == way or abs(hinge.angle_rate) < 1e-6
    world.run(3.0)
    assert math.remainder(hinge.angle - target, math.tau) == pytest.approx(0, abs=1e-4)
    assert hinge.servo.arrived


def test_a_hinge_with_stops_never_turns_the_other_way_round():
    """From 3 to -3 through 0, since beyond 3.1 there is a stop; and after that is gone, the short way."""
    world, hinge = stand(oo.Hinge)
    hinge.body1.rotation = oo.Quat.from_axis_angle(AXIS, 3.0)
    hinge.stops = (-3.1, 3.1)
    hinge.servo = oo.Servo(target=-3.0, max_force=1e3, max_speed=5.0)
    angles = []
    for _ in range(480):
        world.step()
        angles.append(hinge.angle)
    assert min(abs(angle) for angle in angles) < 0.05
    assert angles[-1] == pytest.approx(-3.0, abs=1e-3)
    hinge.stops = None
    hinge.servo.target = 3.0
    for _ in range(240):
        world.step()
        assert abs(hinge.angle) > 2.9
    assert hinge.angle == pytest.approx(3.0, abs=1e-3)


def test_a_slider_does_not_think_in_turns():
    world, slider = stand(oo.Slider, servo=oo.Servo(target=10.0, max_speed=20.0, max_force=1e4))
    world.run(4.0)
    assert slider.position == pytest.approx(10.0, abs=1e-3)


# -- sleeping


@each_both
@each_kind
def test_a_new_target_wakes_the_bodies_that_slept_at_the_old_one(kind, both):
    world, joint = stand(kind, both=both, servo=oo.Servo(target=0.2, max_force=50.0))
    world.auto_disable = True
    world.run(6.0)
    assert not any(body.enabled for body in world.bodies)
    assert joint.servo.arrived
    joint.servo.target = -0.4
    assert all(body.enabled for body in world.bodies)
    world.run(4.0)
    assert where(joint) == pytest.approx(-0.4, abs=1e-3)


@each_kind
def test_it_does_not_fall_asleep_on_its_way(kind):
    """Slower than what counts as rest it gets there all the same; then it sleeps."""
    world, joint = stand(kind, servo=oo.Servo(target=0.05, max_speed=0.004, max_force=50.0))
    world.auto_disable = True
    assert world.auto_disable_linear_threshold > 0.004
    world.run(14.0)
    assert where(joint) == pytest.approx(0.05, abs=1e-3)
    world.run(10.0)
    assert not joint.body1.enabled
    assert where(joint) == pytest.approx(0.05, abs=1e-3)


# -- surviving


def survived(world, joint):
    world.run(4.0)
    assert joint.servo.joint is joint
    assert where(joint) == pytest.approx(0.3, abs=1e-4)
    assert joint.servo.arrived


@each_kind
def test_it_survives_leaving_and_coming_back(kind):
    world, joint = stand(kind, servo=oo.Servo(target=0.3, max_force=50.0))
    world.step(10)
    body = joint.body1
    world.detach(body)
    assert not joint.servo.arrived
    assert joint.servo.target == 0.3
    world.attach(body)
    survived(world, joint)


@each_kind
def test_it_survives_another_world(kind):
    world, joint = stand(kind, both=True, servo=oo.Servo(target=0.3, max_force=50.0))
    world.step(10)
    group = oo.SimpleSpace()
    world.attach(group)
    for body in (joint.body1, joint.body2):
        world.detach(body)
        group.attach(body)
    world.detach(group)
    other = oo.World(gravity=(0, 0, 0), step_size=H)
    other.attach(group)
    assert joint.world is other
    survived(other, joint)


@each_kind
def test_it_survives_being_made_again_and_anchored_anew(kind):
    """A part is added, which moves the centre of mass along the axis; then 0 is put elsewhere."""
    world, joint = stand(kind, servo=oo.Servo(target=0.3, max_force=50.0))
    world.step(10)
    joint.body1.fixed_mass = oo.Mass.sphere(RADIUS, mass=3 * MASS).translated((0, 0.3, 0))
    survived(world, joint)
    joint.anchor_anew()
    assert where(joint) == pytest.approx(0.0, abs=1e-9)
    survived(world, joint)


@each_kind
def test_set_while_out_of_the_world_it_drives_from_the_moment_it_enters(kind):
    body = oo.Body()
    body.fixed_mass = oo.Mass.sphere(RADIUS, mass=MASS)
    joint = kind(body, axis=AXIS)
    joint.servo = oo.Servo(max_force=50.0)
    joint.servo.target = 0.3
    world = oo.World(gravity=(0, 0, 0), step_size=H)
    world.attach(body)
    survived(world, joint)


@each_kind
def test_released_its_joint_is_driven_no_more(kind):
    world, joint = stand(kind, servo=oo.Servo(target=0.3, max_force=50.0))
    joint.release()
    world.step(10)
    assert joint.body1.position == (0, 0, 0)
    joint.servo.target = 0.7
    world.step(10)
    assert joint.body1.linear_velocity == joint.body1.angular_velocity == (0, 0, 0)


# -- misuse


@each_kind
@pytest.mark.parametrize("name", ["motor_velocity", "motor_max_force"])
def test_the_motor_is_the_servos_while_it_has_one(kind, name):
    _, joint = stand(kind, servo=oo.Servo())
    before = joint.motor_velocity, joint.motor_max_force
    with pytest.raises(oo.StateError, match=rf"{kind.__name__}\.{name} can't be set while its servo drives the motor"):
        setattr(joint, name, 1.0)
    with pytest.raises(oo.StateError, match="while its servo drives"):
        joint.motor(1.0, 1.0)
    assert (joint.motor_velocity, joint.motor_max_force) == before


@each_kind
def test_without_a_servo_the_motor_is_off_and_free(kind):
    world, joint = stand(kind, servo=oo.Servo(target=5.0, max_force=50.0))
    servo = joint.servo
    world.step(10)
    joint.servo = None
    assert servo.joint is None
    assert (joint.servo, joint.motor_velocity, joint.motor_max_force) == (None, 0.0, 0.0)
    speed = rate(joint)
    world.step(10)
    assert rate(joint) == pytest.approx(speed, rel=1e-9)
    joint.motor(-1.0, 1e3)
    world.step(10)
    assert rate(joint) == pytest.approx(-1.0, rel=1e-5)
    servo.target = 1.0
    world.step(10)
    assert rate(joint) == pytest.approx(-1.0, rel=1e-5)


@each_kind
def test_one_servo_does_not_drive_two_joints(kind):
    world, joint = stand(kind, servo=oo.Servo())
    other = kind(ball(world), axis=AXIS)
    with pytest.raises(oo.FieldError, match=rf"{kind.__name__}\.servo drives {kind.__name__} already; make another"):
        other.servo = joint.servo
    assert other.servo is None
    assert joint.servo.joint is joint
    with pytest.raises(oo.FieldError, match="already; make another one"):
        kind(ball(world), axis=AXIS, servo=joint.servo)
    servo = joint.servo
    joint.servo = None
    other.servo = servo
    assert servo.joint is other


@each_kind
def test_another_servo_takes_over(kind):
    world, joint = stand(kind, servo=oo.Servo(target=1.0))
    old, joint.servo = joint.servo, oo.Servo(target=0.3, max_force=50.0)
    assert old.joint is None
    survived(world, joint)
    joint.servo = joint.servo  # the same one: nothing happens
    assert joint.servo.joint is joint


@pytest.mark.parametrize("bad", [3.0, "servo", True, oo.Servo])
@each_kind
def test_what_is_no_servo_is_refused(kind, bad):
    _, joint = stand(kind)
    with pytest.raises(oo.FieldError, match=rf"{kind.__name__}\.servo is .*a Servo"):
        joint.servo = bad
    assert joint.servo is None


@pytest.mark.parametrize(
    ("name", "bad"),
    [
        ("target", math.nan),
        ("target", math.inf),
        ("max_speed", -1.0),
        ("max_speed", math.inf),
        ("max_force", -1.0),
        ("max_force", math.inf),
        ("frequency", 0.0),
        ("frequency", math.nan),
        ("damping_ratio", -0.5),
    ],
)
def test_bad_settings_are_refused_and_change_nothing(name, bad):
    world, joint = stand(oo.Hinge, servo=oo.Servo(target=0.3, max_force=50.0))
    before = getattr(joint.servo, name)
    with pytest.raises(oo.FieldError, match=rf"Servo of Hinge\.{name} is "):
        setattr(joint.servo, name, bad)
    assert getattr(joint.servo, name) == before
    survived(world, joint)


def test_other_kinds_have_no_servo():
    with pytest.raises((TypeError, oo.ParameterError), match="servo"):
        oo.Ball(oo.Body(), servo=oo.Servo())
    with pytest.raises(oo.ParameterError, match="Universal has no 'servo'"):
        oo.Universal(oo.Body()).servo = oo.Servo()


# -- exactly the same however it is stepped


def crowd():
    """Several servos and free bodies in one island."""
    world = oo.World(seed=3, step_size=H)
    base = world.attach(oo.Body(kinematic=True))
    joints, last = [], base
    for i in range(4):
        link = ball(world, position=(i + 1.0, 0, 0))
        servo = oo.Servo(target=0.2 * i - 0.3, max_force=500.0)
        joints.append(oo.Hinge(link, last, anchor=(i + 0.5, 0, 0), axis=(0, 0, 1), servo=servo))
        last = link
    oo.Ball(ball(world, position=(5, 0, 0)), last, anchor=(4.5, 0, 0))
    return world, joints


def state(world):
    return [(*body.position, *body.rotation, *body.linear_velocity, *body.angular_velocity) for body in world.bodies]


def test_many_steps_in_one_call_are_the_same_to_the_bit():
    one, _ = crowd()
    other, _ = crowd()
    one.step(120)
    for _ in range(120):
        other.step()
    assert state(one) == state(other)


def test_servos_of_one_island_each_hold_their_own_target():
    """An arm of four links under gravity, with a ball hanging from it: within 1e-3 rad."""
    world, joints = crowd()
    world.solver = "exact"
    world.run(8.0)
    assert [joint.angle for joint in joints] == pytest.approx([-0.3, -0.1, 0.1, 0.3], abs=1e-3)
