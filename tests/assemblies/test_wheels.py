"""Wheels: where they are, how far they sag, which way they steer and drive."""

import math

import pytest

import osgode as oo
from tests.assemblies.scenes import DOWN, ground, snapshot

RADIUS, WIDTH, STIFFNESS, MASS = 0.3, 0.2, 2e4, 400.0
HUBS = {"front left": (-0.6, -0.2, -0.9), "front right": (0.6, -0.2, -0.9)} | {
    "rear left": (-0.6, -0.2, 0.9),
    "rear right": (0.6, -0.2, 0.9),
}


def car(space, height=0.5, turned=None, **wheel):
    """A box on four wheels, those in front steered: with the springs relaxed the wheels stand on the ground."""
    chassis = space.attach(oo.Body(name="chassis", position=(0, height, 0), rotation=turned or (1, 0, 0, 0)))
    chassis.attach(oo.Placeable()).attach(oo.Box((1.0, 0.3, 2.2), mass=MASS))
    settings = {"radius": RADIUS, "width": WIDTH, "mass": 15.0, "stiffness": STIFFNESS, "damping": 2000.0} | wheel
    wheels = {
        name: oo.suspension_wheel(chassis, hub, name=name, max_steering=0.6 if "front" in name else 0.0, **settings)
        for name, hub in HUBS.items()
    }
    return chassis, wheels


def heading(chassis):
    """How far it has turned to the left, radians."""
    ahead = chassis.vector_to_world((0, 0, -1))
    return math.atan2(-ahead.x, -ahead.z)


# -- where it is


def test_a_wheel_is_a_body_beside_the_chassis_on_a_hinge2():
    _, space = ground()
    chassis, wheels = car(space)
    wheel = wheels["front left"]
    assert space.children == (chassis, *(each.hub for each in wheels.values()))
    assert type(wheel.hinge) is oo.Hinge2
    assert wheel.bodies == (wheel.hub,)
    assert wheel.joints == (wheel.hinge,)
    assert (wheel.hinge.body1, wheel.hinge.body2, wheel.chassis) == (chassis, wheel.hub, chassis)
    assert wheel.hub.name == wheel.hinge.name == "front left"
    assert wheel.mass == pytest.approx(15.0)
    assert (wheel.radius, wheel.max_steering, wheels["rear left"].max_steering) == (0.3, 0.6, 0.0)


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize(
    ("forward", "axle"), [((0, 0, -1), (-1, 0, 0)), ((1, 0, 0), (0, 0, -1)), ((0, 0, 3), (1, 0, 0))]
)
def test_hub_and_axle_are_where_the_chassis_has_them(shape, forward, axle):
    """For a chassis that stands anywhere, turned; the axle is up x forward, so right-handed rolling goes forward."""
    _, space = ground()
    turned = oo.Quat.from_axis_angle((1, 2, -1), 0.7)
    chassis = space.attach(oo.Body(position=(3, 5, -2), rotation=turned))
    wheel = oo.suspension_wheel(
        chassis,
        (-0.6, -0.2, -0.9),
        radius=0.3,
        width=0.2,
        mass=15,
        stiffness=1,
        damping=1,
        forward=forward,
        shape=shape,
    )
    hub = oo.Vec3(3, 5, -2) + turned.rotate((-0.6, -0.2, -0.9))
    assert wheel.hub.position == pytest.approx(hub)
    assert wheel.hinge.anchor == pytest.approx(hub)
    assert wheel.hinge.axis1 == pytest.approx(turned.rotate((0, 1, 0)))
    assert wheel.hinge.axis2 == pytest.approx(turned.rotate(axle))
    assert wheel.hub.vector_to_world((0, 0, 1)) == pytest.approx(turned.rotate(axle))
    (geom,) = wheel.hub.geoms
    assert type(geom) is {"cylinder": oo.Cylinder, "sphere": oo.Sphere}[shape]
    assert geom.radius == 0.3
    assert geom.material == "rubber"


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
def test_the_inertia_is_that_of_a_cylinder(shape):
    _, space = ground()
    _, wheels = car(space, shape=shape)
    inertia = wheels["rear left"].hub.inertia
    across = 15.0 * (RADIUS**2 / 4 + WIDTH**2 / 12)
    assert inertia.diagonal() == pytest.approx([across, across, 15.0 * RADIUS**2 / 2])


def test_it_moves_along_with_the_chassis_from_the_start():
    _, space = ground()
    chassis = space.attach(oo.Body(position=(0, 5, 0), linear_velocity=(1, 0, 0), angular_velocity=(0, 2, 0)))
    wheel = oo.suspension_wheel(chassis, (0, 0, -1), radius=0.3, width=0.2, mass=15, stiffness=1, damping=1)
    assert wheel.hub.linear_velocity == pytest.approx((1 - 2, 0, 0))  # w x r
    assert wheel.hub.angular_velocity == pytest.approx((0, 2, 0))


# -- springs


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize("step_size", [1 / 120, 1 / 500])
def test_the_chassis_sags_by_m_g_over_k(shape, step_size):
    world, space = ground(solver="exact", step_size=step_size)
    chassis, wheels = car(space, shape=shape)
    world.run(seconds=5)
    sag = MASS / 4 * DOWN / STIFFNESS
    assert chassis.position.y == pytest.approx(0.5 - sag, abs=0.01 * sag)
    for wheel in wheels.values():
        assert wheel.compression == pytest.approx(sag, rel=0.01)
        assert wheel.load == pytest.approx(MASS / 4 * DOWN, rel=0.01)
        assert wheel.hub.position.y == pytest.approx(RADIUS, abs=1e-4)


def test_the_load_is_what_bears_the_chassis_also_while_it_moves():
    """While the car sinks into its springs: the loads less the weight are mass times acceleration."""
    world, space = ground(solver="exact")
    chassis, wheels = car(space)
    for _ in range(12):
        before = chassis.linear_velocity.y
        world.step()
        pushed = MASS * ((chassis.linear_velocity.y - before) / world.step_size + DOWN)
        assert sum(wheel.load for wheel in wheels.values()) == pytest.approx(pushed, rel=1e-3, abs=1.0)
    assert abs(chassis.linear_velocity.y) > 0.05


def test_a_load_behind_presses_the_rear_springs():
    """50 kg over the rear axle: the rear wheels bear it all."""
    world, space = ground(solver="exact")
    chassis, wheels = car(space)
    chassis.attach(oo.Placeable(position=(0, 0.2, 0.9))).attach(oo.Box((0.5, 0.1, 0.1), mass=50.0))
    world.run(seconds=5)
    front, rear = wheels["front left"], wheels["rear right"]
    assert front.load == pytest.approx(MASS / 4 * DOWN, rel=0.02)
    assert rear.load == pytest.approx((MASS / 4 + 25.0) * DOWN, rel=0.02)


def test_the_wheels_hang_in_the_air():
    """A chassis that is held: each spring is drawn out by the weight of its wheel."""
    world, space = ground(solver="exact")
    chassis, wheels = car(space, height=3.0)
    chassis.kinematic = True
    world.run(seconds=3)
    assert wheels["rear left"].compression == pytest.approx(-15.0 * DOWN / STIFFNESS, rel=0.01)
    assert wheels["rear left"].load == pytest.approx(-15.0 * DOWN, rel=0.01)


# -- steering


@pytest.mark.parametrize("angle", [0.4, -0.4])
def test_steering_turns_the_wheels_and_the_car_that_way(angle):
    world, space = ground(iterations=60)
    chassis, wheels = car(space)
    for name in ("front left", "front right"):
        wheels[name].steering = angle
        assert wheels[name].steering == angle
    assert wheels["rear left"].steering == 0.0
    world.run(seconds=1)
    for name in ("front left", "front right"):
        assert wheels[name].hinge.angle1 == pytest.approx(angle, abs=0.01)
        # The rolling direction of the wheel: positive steering turns it to the left, towards -x.
        axle = wheels[name].hub.vector_to_world((0, 0, 1))
        ahead = axle.cross((0, 1, 0))
        assert math.atan2(-ahead.x, -ahead.z) - heading(chassis) == pytest.approx(angle, abs=0.01)
    for name in ("rear left", "rear right"):
        assert wheels[name].hinge.angle1 == pytest.approx(0.0, abs=0.005)
        wheels[name].drive(2.0, 200.0)
    world.run(seconds=2)
    assert heading(chassis) * angle > 0
    assert -chassis.position.x * angle > 0


def test_steering_takes_its_time_constant():
    """Held in the air: after ``damping / stiffness`` the wheel has gone 1 - 1/e of the way."""
    world, space = ground(solver="exact", gravity=(0, 0, 0), step_size=1e-3)
    chassis, wheels = car(space, height=3.0, steering_stiffness=1e4, steering_damping=2e3)
    chassis.kinematic = True
    wheel = wheels["front left"]
    wheel.steering = 0.5
    world.run(seconds=0.2)
    assert wheel.hinge.angle1 == pytest.approx(0.5 * (1 - math.exp(-1)), rel=0.01)


@pytest.mark.parametrize("angle", [0.61, -0.61, math.nan, "left", None])
def test_steering_too_far_is_refused(angle):
    _, space = ground()
    _, wheels = car(space)
    wheel = wheels["front left"]
    wheel.steering = 0.25
    with pytest.raises(oo.FieldError, match=r"Wheel 'front left'.steering is .*; it must be a number from -0.6 to 0.6"):
        wheel.steering = angle
    assert wheel.steering == 0.25
    with pytest.raises(oo.FieldError, match="from 0 to 0"):
        wheels["rear left"].steering = 0.1


# -- driving


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize("speed", [4.0, -4.0])
def test_positive_drives_forward_at_the_speed_of_the_rim(shape, speed):
    world, space = ground(iterations=60)
    chassis, wheels = car(space, shape=shape)
    for wheel in wheels.values():
        wheel.drive(speed, 300.0)
    world.run(seconds=3)
    assert chassis.linear_velocity == pytest.approx((0, 0, -speed), abs=0.05)
    assert chassis.position.z * speed < -5.0
    for wheel in wheels.values():
        assert wheel.speed == pytest.approx(speed, rel=0.01)
        assert wheel.hub.angular_velocity.x == pytest.approx(-speed / RADIUS, rel=0.01)  # about +-X


def test_forward_is_what_was_said():
    """A car that looks along its +x drives along it, also when it stands turned in the world."""
    world, space = ground(solver="exact")
    turned = oo.Quat.from_axis_angle((0, 1, 0), 0.5)
    chassis = space.attach(oo.Body(position=(0, 0.5, 0), rotation=turned))
    chassis.attach(oo.Placeable()).attach(oo.Box((2.2, 0.3, 1.0), mass=MASS))
    for x in (-0.9, 0.9):
        for z in (-0.6, 0.6):
            oo.suspension_wheel(
                chassis, (x, -0.2, z), radius=0.3, width=0.2, mass=15, stiffness=2e4, damping=2e3, forward=(1, 0, 0)
            ).drive(3.0, 100.0)
    world.run(seconds=3)
    assert chassis.linear_velocity == pytest.approx(turned.rotate((3, 0, 0)), abs=0.05)


def test_the_torque_is_what_drives():
    """``F = 4 T / r`` on the mass, and on the wheels' inertia: ``I / r^2`` each."""
    world, space = ground(iterations=60)
    chassis, wheels = car(space)
    world.run(seconds=2)
    for wheel in wheels.values():
        wheel.drive(100.0, 60.0)
    world.run(seconds=1)
    inert = MASS + 4 * 15.0 * 1.5
    assert -chassis.linear_velocity.z == pytest.approx(4 * 60.0 / RADIUS / inert, rel=0.03)


def test_brakes_stop_it_and_hold_it():
    world, space = ground(iterations=60)
    chassis, wheels = car(space)
    for wheel in wheels.values():
        wheel.drive(5.0, 300.0)
    world.run(seconds=3)
    start = chassis.position.z
    for wheel in wheels.values():
        wheel.brake(90.0)
    world.run(seconds=0.5)
    inert = MASS + 4 * 15.0 * 1.5
    rate = 4 * 90.0 / RADIUS / inert
    assert -chassis.linear_velocity.z == pytest.approx(5.0 - 0.5 * rate, abs=0.1)
    world.run(seconds=4)
    assert chassis.linear_velocity.length < 0.02
    assert start - chassis.position.z == pytest.approx(25 / (2 * rate), rel=0.05)


def test_coasting_it_rolls_on():
    world, space = ground(iterations=60)
    chassis, wheels = car(space)
    for wheel in wheels.values():
        wheel.drive(5.0, 300.0)
    world.run(seconds=3)
    for wheel in wheels.values():
        wheel.coast()
    world.run(seconds=2)
    assert -chassis.linear_velocity.z == pytest.approx(5.0, abs=0.15)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda wheel: wheel.drive(math.inf, 10.0), r"Wheel 'front left'.drive\(\).speed is inf"),
        (lambda wheel: wheel.drive(1.0, -10.0), r"Wheel 'front left'.drive\(\).max_torque is -10.0"),
        (lambda wheel: wheel.brake("hard"), r"Wheel 'front left'.brake\(\).torque is 'hard'"),
        (lambda wheel: wheel.brake(math.inf), r"brake\(\).torque is inf"),
    ],
)
def test_bad_driving_is_refused_and_changes_nothing(call, message):
    _, space = ground()
    _, wheels = car(space)
    wheel = wheels["front left"]
    wheel.drive(2.0, 30.0)
    with pytest.raises(oo.FieldError, match=message):
        call(wheel)
    assert wheel.hinge.motor_velocity2 == pytest.approx(2.0 / RADIUS)
    assert wheel.hinge.motor_max_force2 == 30.0


# -- coming and going


def test_a_wheel_comes_off_and_goes_on_again():
    world, space = ground(solver="exact")
    chassis, wheels = car(space)
    world.run(seconds=2)
    wheel = wheels["rear left"]
    wheel.detach()
    assert not wheel.hinge.is_live
    assert wheel.hub not in space.children
    world.run(seconds=1)
    corners = {name: chassis.local_to_world(hub).y for name, hub in HUBS.items()}
    assert min(corners, key=corners.get) == "rear left"  # it leans to where the wheel was
    assert corners["rear left"] < corners["front right"] - 0.05
    wheel.attach(space)
    assert wheel.hinge.is_live


def test_the_whole_car_moves_to_another_world_in_its_own_space():
    world, space = ground(solver="exact")
    other, elsewhere = ground(solver="exact")
    own = space.attach(oo.SimpleSpace(name="car"))
    chassis, wheels = car(own)
    world.run(seconds=3)
    own.move_to(elsewhere)
    assert chassis.world is other
    assert all(wheel.hinge.is_live for wheel in wheels.values())
    other.run(seconds=1)
    assert wheels["rear left"].compression == pytest.approx(MASS / 4 * DOWN / STIFFNESS, rel=0.01)
    assert len(world.joints) == 0


def test_a_wheel_can_be_seen_to_turn():
    """Tyre, rim and spokes, unless it is given another look; it can show what the user wants."""
    _, space = ground()
    _, plain = car(space)
    look = oo.Appearance((1.0, 0.0, 0.0, 1.0))
    _, red = car(space, appearance=look)
    mesh = oo.box_drawable((0.1, 0.1, 0.1))
    _, own = car(space, shown=mesh)
    assert len(plain["rear left"].hub.geoms[0].drawables()) == 4
    (drawn,) = red["rear left"].hub.geoms[0].drawables()
    assert drawn.appearance is look
    assert own["rear left"].hub.geoms[0].drawables() == (mesh,)


# -- what is refused

WRONG = [
    ({"hub": (0, math.inf, 0)}, r"suspension_wheel\(\).hub is"),
    ({"radius": 0.0}, r"suspension_wheel\(\).radius is 0.0"),
    ({"width": -1.0}, r"suspension_wheel\(\).width is -1.0"),
    ({"mass": 0.0}, r"suspension_wheel\(\).mass is 0.0"),
    ({"stiffness": 0.0}, r"suspension_wheel\(\).stiffness is 0.0"),
    ({"damping": -1.0}, r"suspension_wheel\(\).damping is -1.0"),
    ({"max_steering": 1.6}, r"suspension_wheel\(\).max_steering is 1.6"),
    ({"max_steering": -0.1}, r"suspension_wheel\(\).max_steering is -0.1"),
    ({"steering_stiffness": math.nan}, r"suspension_wheel\(\).steering_stiffness is nan"),
    ({"steering_damping": -1}, r"suspension_wheel\(\).steering_damping is -1"),
    ({"forward": (0, 0, 0)}, r"suspension_wheel\(\).forward is \(0, 0, 0\)"),
    ({"forward": (0, -2, 0)}, r"forward is \(0.0, -1.0, 0.0\); it must not be parallel to up"),
    ({"up": "up"}, r"suspension_wheel\(\).up is 'up'"),
    ({"shape": "box"}, r"suspension_wheel\(\).shape is 'box'; it must be one of 'cylinder', 'sphere'"),
    ({"material": "cheese"}, "material is 'cheese'"),
    ({"density": 500.0}, "density"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG, ids=lambda value: value if isinstance(value, str) else "")
def test_bad_arguments_of_wheels_are_refused_and_nothing_is_changed(arguments, message):
    _, space = ground()
    chassis = space.attach(oo.Body(name="chassis"))
    before = snapshot(space)
    rest = {"hub": (0, 0, 0), "radius": 0.3, "width": 0.2, "mass": 15, "stiffness": 1e4, "damping": 1e3} | arguments
    with pytest.raises(oo.FieldError, match=message):
        oo.suspension_wheel(chassis, **rest)
    assert snapshot(space) == before


@pytest.mark.parametrize(
    ("chassis", "message"), [(None, "chassis is None; it must be a Body"), (oo.Body(name="loose"), "stands nowhere")]
)
def test_a_wheel_needs_a_chassis_in_the_tree(chassis, message):
    with pytest.raises(oo.TreeError, match=message):
        oo.suspension_wheel(chassis, (0, 0, 0), radius=0.3, width=0.2, mass=15, stiffness=1e4, damping=1e3)
    assert chassis is None or chassis.joints == ()
