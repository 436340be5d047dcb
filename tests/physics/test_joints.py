"""Bodies held by joints, against closed formulas."""

import math

import pytest

import osgode as oo

GRAVITY = 9.81


@pytest.fixture(params=["quick", "exact"])
def solver(request):
    return request.param


@pytest.mark.parametrize("amplitude", [0.02, 0.05, 0.3])
def test_a_compound_pendulum_of_two_parts_swings_by_its_inertia(amplitude, solver):
    """T = 2 pi sqrt(I / (m g d)) (1 + a^2 / 16 + 11 a^4 / 3072), to 1e-5.

    I w' = -m g d sin(a) about the hinge, linearised, with the first terms for a finite amplitude a. A rod of 2 kg
    and 1 m hangs down, with a ball of 5 kg and radius 0.2 m 1.2 m down; I and m d are the sums over both,
    each I about its own middle and moved to the hinge by Steiner's theorem.
    """
    h = 1 / 1000
    inertia = (2 / 12 * (1 + 0.1**2) + 2 * 0.5**2) + (0.4 * 5 * 0.2**2 + 5 * 1.2**2)
    moment = 2 * 0.5 + 5 * 1.2
    period = 2 * math.pi * math.sqrt(inertia / (GRAVITY * moment))
    period *= 1 + amplitude**2 / 16 + 11 * amplitude**4 / 3072

    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=h, solver=solver)
    body = world.attach(oo.Body())
    body.attach(oo.Placeable(position=(0, -0.5, 0))).attach(oo.Box((0.1, 1, 0.1), mass=2))
    body.attach(oo.Placeable(position=(0, -1.2, 0))).attach(oo.Sphere(0.2, mass=5))
    hinge = oo.Hinge(body, anchor=(0, 0, 0), axis=(0, 0, 1))
    body.rotation = oo.Quat.from_axis_angle((0, 0, 1), amplitude)
    crossings, last = [], hinge.angle
    while len(crossings) < 5:
        world.step()
        if last < 0 <= hinge.angle:  # where between the two steps, by a straight line
            crossings.append(world.time - h * hinge.angle / (hinge.angle - last))
        last = hinge.angle
    assert (crossings[-1] - crossings[0]) / 4 == pytest.approx(period, rel=1e-5)


def test_a_conical_pendulum_goes_round_at_its_height():
    """Once round takes 2 pi sqrt(height / g), height being how far below the ball joint it circles, to 0.1 %.

    Its rope pulls with m g / cos(a), of which m g tan(a) holds it on the circle: w^2 L sin(a) = g tan(a). Its own spin
    is about the vertical and stays as it is. The exact solver, because 20 iterations are too few for a
    light spin (2 cm) at the end of a long arm (2 m).
    """
    lean, rope, h = 0.5, 2.0, 1 / 2000
    height, radius = rope * math.cos(lean), rope * math.sin(lean)
    speed = math.sqrt(GRAVITY / height)
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=h, solver="exact")
    ball = world.attach(oo.Body(position=(radius, -height, 0), linear_velocity=(0, 0, -speed * radius)))
    ball.fixed_mass = oo.Mass.sphere(0.02, mass=3)
    ball.angular_velocity = (0, speed, 0)  # it turns with the rope
    joint = oo.Ball(ball, anchor=(0, 0, 0))
    turned, last = 0.0, 0.0
    for _ in range(4000):
        world.step()
        x, y, z = ball.position
        assert y == pytest.approx(-height, abs=2e-4)
        angle = math.atan2(-z, x)
        turned += (angle - last + math.pi) % (2 * math.pi) - math.pi
        last = angle
    assert turned / world.time == pytest.approx(speed, rel=1e-3)
    assert joint.error < 1e-5


@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_a_motor_spins_a_hinge_up_in_proportion_and_then_holds_its_speed(offset, solver):
    """The speed is torque t / I until it is the motor's, and that from then on.

    I about the hinge, for a box whose middle is ``offset`` away. To 1e-9 where the hinge goes through the
    middle; otherwise the joint gives way a little to the pull outwards: to 1e-4.
    """
    h, m, torque, target = 1 / 1000, 4.0, 2.0, 3.0
    inertia = m / 12 * (1.0**2 + 0.4**2) + m * offset * offset
    near = 1e-4 if offset else 1e-9
    world = oo.World(gravity=(0, 0, 0), step_size=h, solver=solver)
    body = world.attach(oo.Body())
    body.attach(oo.Placeable(position=(offset, 0, 0))).attach(oo.Box((1, 0.2, 0.4), mass=m))
    hinge = oo.Hinge(body, anchor=(0, 0, 0), axis=(0, 1, 0))
    hinge.motor(velocity=target, max_force=torque)
    steps = int(target * inertia / torque / h)
    for n in (1, steps // 3, steps):
        world.step(n - world.steps)
        assert hinge.angle_rate == pytest.approx(torque * n * h / inertia, rel=near)
    for _ in range(3):
        world.step(steps)
        assert hinge.angle_rate == pytest.approx(target, rel=1e-6)


def test_a_motor_on_a_slider_lifts_with_what_gravity_leaves_and_then_holds_its_speed(solver):
    """The speed is (F / m - g) t until it is the motor's, to 1e-9 (to 1e-7 later: the joint is soft)."""
    h, m, force, target = 1 / 500, 4.0, 50.0, 2.0
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=h, solver=solver)
    lift = world.attach(oo.Body())
    lift.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=m))
    slider = oo.Slider(lift, axis=(0, 1, 0), motor_velocity=target, motor_max_force=force)
    steps = int(target / (force / m - GRAVITY) / h)
    for n in (1, steps // 2, steps):
        world.step(n - world.steps)
        assert slider.position_rate == pytest.approx((force / m - GRAVITY) * n * h, rel=1e-9)
        assert slider.position == pytest.approx((force / m - GRAVITY) * h * h * n * (n + 1) / 2, rel=1e-9)
    world.step(steps)
    assert slider.position_rate == pytest.approx(target, rel=1e-7)
    assert lift.position.y == pytest.approx(slider.position, rel=1e-12)


def test_too_weak_a_motor_slows_the_fall_only(solver):
    """With F < m g a slider sinks at g - F / m, to 1e-9."""
    world = oo.World(gravity=(0, -GRAVITY, 0), solver=solver)
    lift = world.attach(oo.Body())
    lift.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=4))
    slider = oo.Slider(lift, axis=(0, 1, 0), motor_velocity=2.0, motor_max_force=30.0)
    world.step(60)
    assert slider.position_rate == pytest.approx(-(GRAVITY - 30 / 4) * 60 * world.step_size, rel=1e-9)


def test_a_stop_holds_a_hinge_that_gravity_turns(solver):
    """A flap that falls comes to rest at its stop, within 1e-4 rad, and stays; its other stop is never reached."""
    world = oo.World(gravity=(0, -GRAVITY, 0), solver=solver)
    flap = world.attach(oo.Body())
    flap.attach(oo.Placeable(position=(0.5, 0, 0))).attach(oo.Box((1, 0.1, 1), mass=3))
    hinge = oo.Hinge(flap, anchor=(0, 0, 0), axis=(0, 0, 1), stops=(-0.6, 0.3))
    angles = []
    for _ in range(6):
        world.run(0.5)
        angles.append(hinge.angle)
    assert angles[1:] == pytest.approx([-0.6] * 5, abs=1e-4)


def test_a_stop_gives_back_its_share_of_the_speed(solver):
    """A slider that runs into its stop at v leaves it at e v, to 1e-6, nothing else acting."""
    world = oo.World(gravity=(0, 0, 0), solver=solver)
    body = world.attach(oo.Body(linear_velocity=(2, 0, 0)))
    slider = oo.Slider(body, axis=(1, 0, 0), stops=(-5, 0.5), stop_bounce=0.4)
    world.run(0.5)
    assert slider.position_rate == pytest.approx(-0.4 * 2, rel=1e-6)


def test_bodies_fixed_together_turn_as_one(solver):
    """The speed is torque t / I with I of both about their common middle by Steiner's theorem, to 1e-6."""
    m, a, torque, h, n = 2.0, 0.6, 3.0, 1 / 500, 100
    world = oo.World(gravity=(0, 0, 0), step_size=h, solver=solver)
    left, right = (world.attach(oo.Body(position=(x, 0, 0))) for x in (-a, a))
    for body in (left, right):
        body.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=m))
    oo.Fixed(left, right)
    for _ in range(n):
        left.add_torque((torque, 0, 0))
        world.step()
    inertia = 2 * m / 12 * 2
    assert left.angular_velocity.x == pytest.approx(torque * n * h / inertia, rel=1e-6)
    assert right.angular_velocity.x == pytest.approx(torque * n * h / inertia, rel=1e-6)
