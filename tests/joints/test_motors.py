"""Motors of every axis of every kind of joint: which way they drive, how hard, how fast, and under load."""

import math

import pytest

import osgode as oo
from tests.joints.drives import DRIVES, Rig, cases
from tests.joints.moves import E1, E2, OBLIQUE, POINT

each_drive = pytest.mark.parametrize(("drive", "count"), cases(DRIVES), ids=str)
each_solver = pytest.mark.parametrize("solver", ["quick", "exact"])
each_way = pytest.mark.parametrize("way", [1, -1], ids=["forwards", "backwards"])

FORCE, TARGET, H = 2.0, 1.5, 1 / 200


@each_solver
@each_way
@each_drive
def test_a_motor_speeds_its_axis_up_in_proportion_and_then_holds_it(drive, count, way, solver):
    """The speed is force t / inertia until it is the motor's, to 1e-6, and then that, to 1e-6: forwards and back."""
    rig = Rig(drive, count, solver=solver, h=H)
    after = int(drive.after) if drive.after else None
    rig.joint.motor(way * TARGET, FORCE, axis=after)
    steps = int(TARGET * rig.inertia() / FORCE / H)
    assert steps >= 10
    for n in (1, steps // 2, steps):
        rig.world.step(n - rig.world.steps)
        speed = way * FORCE * n * H / rig.inertia()
        assert rig.rate == pytest.approx(speed, rel=1e-6)
        if drive.rate:
            assert getattr(rig.joint, drive.rate) == pytest.approx(speed, rel=1e-6)
    for _ in range(3):
        rig.world.step(3)
        assert rig.rate == pytest.approx(way * TARGET, rel=1e-6)


@each_way
@each_drive
def test_an_infinite_motor_is_at_its_speed_at_once(drive, count, way):
    """Against any load."""
    rig = Rig(drive, count)
    rig.set(motor_max_force=math.inf, motor_velocity=way * TARGET)
    for load in (0.0, 1e3, -1e3):
        rig.push(load)
        rig.world.step()
        assert rig.rate == pytest.approx(way * TARGET, rel=1e-5)


@each_drive
def test_a_motor_under_load_has_what_the_load_leaves(drive, count):
    """(force - load) t / inertia, then its speed; under more than it can bear it gives way by (load - force) t / I."""
    rig = Rig(drive, count)
    h, inertia = rig.world.step_size, rig.inertia()
    rig.set(motor_max_force=FORCE, motor_velocity=0.5)
    for n in range(1, 4):
        rig.push(-0.75 * FORCE)
        rig.world.step()
        assert rig.rate == pytest.approx(0.25 * FORCE * n * h / inertia, rel=1e-6)
    steps = math.ceil(0.5 * inertia / (0.25 * FORCE) / h)
    for _ in range(steps):
        rig.push(-0.75 * FORCE)
        rig.world.step()
    assert rig.rate == pytest.approx(0.5, rel=1e-6)
    for n in range(1, 4):
        rig.push(-1.5 * FORCE)
        rig.world.step()
        assert rig.rate == pytest.approx(0.5 - 0.5 * FORCE * n * h / inertia, rel=1e-6)


@each_drive
def test_a_motor_aimed_at_no_speed_is_a_brake(drive, count):
    """It takes force t / inertia from the speed, then holds it at rest; without force it lets go."""
    rig = Rig(drive, count)
    h, inertia = rig.world.step_size, rig.inertia()
    rig.kick(1.0)
    assert rig.rate == pytest.approx(1.0, rel=1e-9)
    rig.set(motor_max_force=FORCE)
    rig.world.step(2)
    assert rig.rate == pytest.approx(1.0 - FORCE * 2 * h / inertia, rel=1e-6)
    rig.world.step(math.ceil(inertia / FORCE / h))
    rig.push(0.9 * FORCE)
    rig.world.step()
    assert rig.rate == pytest.approx(0.0, abs=1e-7)
    rig.set(motor_max_force=0.0)
    rig.push(FORCE)
    rig.world.step()
    assert rig.rate == pytest.approx(FORCE * h / inertia, rel=1e-6)


@pytest.mark.parametrize("drive", [drive for drive in DRIVES if 2 in drive.bodies], ids=str)
def test_a_motor_pushes_both_bodies_against_each_other(drive):
    """Momentum and spin of both together stay 0."""
    rig = Rig(drive, 2)
    rig.set(motor_max_force=FORCE, motor_velocity=TARGET)
    rig.world.step(20)
    assert rig.rate > 0.09
    first, second = rig.bodies
    assert first.momentum + second.momentum == pytest.approx((0, 0, 0), abs=1e-6)
    spins = [b.angular_momentum + b.world_centre_of_mass.cross(b.momentum) for b in rig.bodies]
    assert spins[0] + spins[1] == pytest.approx((0, 0, 0), abs=1e-6)


@each_drive
def test_setting_a_motor_wakes_the_bodies(drive, count):
    rig = Rig(drive, count)
    rig.world.auto_disable = True
    rig.world.run(3.0)
    assert not any(body.enabled for body in rig.bodies)
    rig.set(motor_velocity=TARGET)
    rig.set(motor_max_force=FORCE)
    assert all(body.enabled for body in rig.bodies)
    rig.world.step()
    assert rig.rate > 0


@pytest.mark.parametrize("relative", ["world", "body1", "body2"])
@pytest.mark.parametrize("kind", [oo.AngularMotor, oo.LinearMotor])
def test_a_motors_axis_is_carried_by_what_it_is_relative_to(kind, relative):
    """After both bodies have been turned, each in its own way, the push is along the axis as its carrier has turned."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    bodies = [world.attach(oo.Body(position=POINT)) for _ in range(2)]
    for body in bodies:
        body.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    joint = kind(*bodies, axes=[E1], relative_to=relative, motor_velocity1=1.0, motor_max_force1=1.0)
    turns = [oo.Quat.from_axis_angle(E2, 0.8), oo.Quat.from_axis_angle(OBLIQUE, -1.9)]
    for body, turn in zip(bodies, turns, strict=True):
        body.rotation = turn
    axis = {"world": E1, "body1": turns[0].rotate(E1), "body2": turns[1].rotate(E1)}[relative]
    assert joint.axes[0] == pytest.approx(axis, abs=1e-12)
    world.step()
    name = "angular_velocity" if kind is oo.AngularMotor else "linear_velocity"
    inertia = 0.4 * 2 * 0.5**2 if kind is oo.AngularMotor else 2
    speed = 1.0 * world.step_size / inertia
    assert getattr(bodies[0], name) == pytest.approx(axis * speed, abs=1e-8)
    assert getattr(bodies[1], name) == pytest.approx(axis * -speed, abs=1e-8)


def test_a_hinge2_drives_the_wheel_about_plus_axis2():
    """The wheel turns the positive way about its axis, the chassis is turned back (ODE's own sign is the other)."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    chassis, wheel = world.attach(oo.Body()), world.attach(oo.Body(position=(1, 0, 0)))
    chassis.fixed_mass = oo.Mass.box((3, 1, 2), mass=100)
    wheel.fixed_mass = oo.Mass.sphere(0.3, mass=5)
    joint = oo.Hinge2(chassis, wheel, axis1=(0, 1, 0), axis2=(0, 0, 1))
    joint.motor(2.0, 5.0, axis=2)
    world.run(1.0)
    assert wheel.angular_velocity.z > 0 > chassis.angular_velocity.z
    assert wheel.angular_velocity.z - chassis.angular_velocity.z == pytest.approx(2.0, rel=1e-6)
    assert joint.angle_rate2 == pytest.approx(2.0, rel=1e-6)
    assert joint.angle2 == pytest.approx(2.0 - 2.0 * world.step_size, abs=0.15)


@pytest.mark.parametrize("turned", [0.0, 0.7, -1.2])
@each_way
def test_an_outer_euler_motor_drives_the_cosine_of_the_middle_as_documented(turned, way):
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    body = world.attach(oo.Body())
    body.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    joint = oo.AngularMotor(body, axes=[(1, 0, 0), (0, 0, 1)], mode="euler")
    body.rotation = oo.Quat.from_axis_angle((0, 1, 0), turned)
    assert joint.angle2 == pytest.approx(turned, abs=1e-12)
    for n in (1, 2, 3):
        joint.motor(0.0, math.inf, axis=n)
    joint.motor_velocity2 = 0.4 * way
    joint.motor_velocity1 = 0.3 * way
    world.step_size = 1e-6
    world.step()
    assert joint.angle_rate2 == pytest.approx(0.4 * way, rel=1e-4)
    assert joint.angle_rate1 * math.cos(turned) == pytest.approx(0.3 * way, rel=1e-3)
    assert joint.angle_rate3 == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("cls", "n"), [(oo.AngularMotor, 2), (oo.LinearMotor, 3)])
def test_an_axis_that_a_motor_has_not_got_is_refused(cls, n):
    body = oo.Body()
    axes = [(1, 0, 0), (0, 1, 0)][: n - 1]
    joint = cls(body, axes=axes)
    with pytest.raises(oo.FieldError, match=rf"has {n - 1} axes, so there is no axis {n} to drive"):
        setattr(joint, f"motor_max_force{n}", 1.0)
    assert getattr(joint, f"motor_max_force{n}") == 0.0


@pytest.mark.parametrize("lean", [0.0, 0.3, -0.5])
def test_a_steering_brake_takes_rolling_for_steering_as_documented(lean):
    """It stops all of the spin about axis1: rate1 + cos(angle between the axes) rate2 = 0."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    chassis, wheel = world.attach(oo.Body(kinematic=True)), world.attach(oo.Body())
    wheel.fixed_mass = oo.Mass.sphere(0.3, mass=5)
    axis2 = oo.Vec3(0, math.sin(lean), math.cos(lean))
    joint = oo.Hinge2(chassis, wheel, axis1=(0, 1, 0), axis2=axis2)
    joint.motor(0.0, math.inf, axis=1)
    wheel.angular_velocity = axis2 * 4.0
    world.step()
    assert joint.angle_rate1 == pytest.approx(-math.sin(lean) * joint.angle_rate2, rel=5e-3, abs=1e-6)
    assert joint.angle_rate2 > 2.0
