"""Hinge-2 suspensions on a whole car: sag, steering, driving."""

import math

import pytest

import osgode as oo

G = 9.81
CHASSIS, WHEEL, RADIUS = 800.0, 20.0, 0.35
STIFFNESS, DAMPING = 20000.0, 2500.0
UP, ACROSS = oo.Vec3(0, 1, 0), oo.Vec3(0, 0, 1)
CORNERS = [(x, z) for x in (1.3, -1.3) for z in (0.8, -0.8)]


class Car:
    """A chassis that looks along -x, on four ball-shaped wheels on the ground, its hubs at rest on their springs."""

    def __init__(self, *, solver="exact", h=1 / 120, friction=1.0, **fields):
        self.world = oo.World(gravity=(0, -G, 0), solver=solver, step_size=h, iterations=50)
        self.world.surfaces.fallback = oo.Surface(friction=friction)
        space = self.world.attach(oo.SimpleSpace())
        space.attach(oo.Plane())
        self.world.collide(space)
        self.chassis = space.attach(oo.Body(position=(0, 0.8, 0)))
        self.chassis.attach(oo.Placeable()).attach(oo.Box((3.4, 0.5, 1.2), mass=CHASSIS))
        self.wheels, self.joints = [], []
        for x, z in CORNERS:
            wheel = space.attach(oo.Body(position=(x, RADIUS, z)))
            wheel.attach(oo.Placeable()).attach(oo.Sphere(RADIUS, mass=WHEEL))
            self.wheels.append(wheel)
            spring = {"suspension_stiffness": STIFFNESS, "suspension_damping": DAMPING}
            self.joints.append(
                oo.Hinge2(self.chassis, wheel, axis1=UP, axis2=ACROSS, **{"stops1": (0.0, 0.0)} | spring | fields)
            )


@pytest.mark.parametrize("solver", ["quick", "exact"])
@pytest.mark.parametrize("h", [1 / 60, 1 / 120, 1 / 1000])
def test_each_spring_is_pressed_by_its_share_of_the_weight(solver, h):
    """By m g / (4 k) within 1 %, m being the chassis without its wheels; level, and the same at any step size.

    The quick solver has 50 iterations: with 20 four wheels on the ground jitter by 1 % of it.
    """
    car = Car(solver=solver, h=h)
    car.world.run(4.0)
    sag = CHASSIS * G / 4 / STIFFNESS
    for joint in car.joints:
        assert joint.compression == pytest.approx(sag, rel=0.01)
        assert joint.compression_rate == pytest.approx(0.0, abs=0.03)
        assert joint.error < 1e-4
    assert 0.8 - car.chassis.position.y == pytest.approx(sag, rel=0.01)
    up = car.chassis.vector_to_world(UP)
    assert up == pytest.approx(UP, abs=1e-3)


def test_a_load_over_one_axle_presses_its_springs_by_the_lever_rule():
    """100 kg over the front axle: its two springs bear it, those behind nothing of it, within 2 %."""
    car = Car()
    weight = 100 * G
    for _ in range(600):
        car.chassis.add_force((0, -weight, 0), at=car.chassis.local_to_world((1.3, 0, 0)))
        car.world.step()
    sag = CHASSIS * G / 4 / STIFFNESS
    for joint, (x, _) in zip(car.joints, CORNERS, strict=True):
        expected = sag + (weight / 2 / STIFFNESS if x > 0 else 0.0)
        assert joint.compression == pytest.approx(expected, rel=0.02)


def test_the_suspension_swings_as_a_spring_of_four():
    """Pressed down by an undamped spring's own means: T = 2 pi sqrt(m / 4 k) within 2 %."""
    car = Car(h=1 / 1000, suspension_damping=1e-3)
    car.chassis.linear_velocity = (0, -0.2, 0)
    level = 0.8 - CHASSIS * G / 4 / STIFFNESS
    crossings, last = [], car.chassis.position.y - level
    while len(crossings) < 4 and car.world.steps < 5000:
        car.world.step()
        now = car.chassis.position.y - level
        if last < 0 <= now:
            crossings.append(car.world.time)
        last = now
    period = (crossings[-1] - crossings[0]) / 3
    assert period == pytest.approx(2 * math.pi * math.sqrt(CHASSIS / 4 / STIFFNESS), rel=0.02)


@pytest.mark.parametrize("way", [1, -1])
def test_driven_wheels_roll_the_car(way):
    """A positive speed about +z rolls a car on the ground (which is below it) towards -x, at w r, straight on."""
    car = Car()
    car.world.run(1.0)
    for joint in car.joints:
        joint.motor(way * 10.0, 300.0, axis=2)
    car.world.run(5.0)
    for joint, wheel in zip(car.joints, car.wheels, strict=True):
        assert joint.angle_rate2 == pytest.approx(way * 10.0, rel=1e-3)
        assert wheel.angular_velocity.z == pytest.approx(way * 10.0, rel=1e-2)
        assert joint.angle1 == pytest.approx(0.0, abs=1e-3)
    assert car.chassis.linear_velocity.x == pytest.approx(-way * 10.0 * RADIUS, rel=0.01)
    assert abs(car.chassis.position.z) < 0.05


@pytest.mark.parametrize("way", [1, -1])
def test_steering_stops_hold_and_the_car_goes_round(way):
    """Front wheels steered into their stops; the car then turns the way the wheels point.

    Within 0.02 rad: while a wheel spins and the car turns, each step adds a little that ERP has to take away.
    """
    car = Car(stops1=(-0.4, 0.4))
    for joint, (x, _) in zip(car.joints, CORNERS, strict=True):
        if x > 0:
            joint.stops1 = (0.0, 0.0)
        else:
            joint.motor(way * 2.0, 500.0, axis=1)
        joint.motor(10.0, 300.0, axis=2)
    car.world.run(4.0)
    for joint, (x, _) in zip(car.joints, CORNERS, strict=True):
        assert joint.angle1 == pytest.approx(0.0 if x > 0 else way * 0.4, abs=0.02)
    # It drives towards -x with the wheels in front, at -x, turned about +y: to their left seen from above.
    assert car.chassis.angular_velocity.y * way > 0.3


def test_a_steering_motor_holds_an_angle_between_its_stops_against_the_road():
    car = Car(stops1=(-0.6, 0.6))
    for joint in car.joints:
        joint.motor(0.0, 2000.0, axis=1)
    for _ in range(240):
        car.world.step()
        for joint in car.joints:
            joint.motor_velocity1 = 5.0 * (0.25 - joint.angle1)
    for joint in car.joints:
        assert joint.angle1 == pytest.approx(0.25, abs=0.01)
