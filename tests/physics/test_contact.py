"""Things that touch, against closed formulas."""

import math

import numpy as np
import pytest

import osgode as oo

GRAVITY = 9.81


@pytest.fixture(params=["quick", "exact"])
def solver(request):
    return request.param


class Slope:
    """A plane that falls towards +x by ``angle``, and a body that lies on it; lengths are measured downhill.

    ODE's pyramid limits friction along two tangents of its own, which it takes from the normal alone: for a normal
    without z they are the line of fall and z. So on this slope Coulomb's formula holds exactly.
    """

    def __init__(self, angle, geom, height, solver):
        self.world = oo.World(gravity=(0, -GRAVITY, 0), step_size=1 / 500, solver=solver)
        space = self.world.attach(oo.HashSpace())
        self.world.collide(space)
        normal = oo.Vec3(math.sin(angle), math.cos(angle), 0)
        self.downhill = oo.Vec3(math.cos(angle), -math.sin(angle), 0)
        space.attach(oo.Plane(normal))
        self.body = space.attach(oo.Body(position=normal * height, rotation=oo.Quat.from_axis_angle((0, 0, 1), -angle)))
        self.body.attach(oo.Placeable()).attach(geom)

    def speed(self):
        return self.body.linear_velocity.dot(self.downhill)

    def acceleration(self):
        """The mean over a second, after half a second in which the contact settles."""
        self.world.run(0.5)
        before = self.speed()
        self.world.run(1.0)
        return self.speed() - before


def brick(friction):
    return oo.Box((1, 0.5, 0.8), mass=3, surface=oo.Surface(friction))


@pytest.mark.parametrize(("friction", "angle"), [(0.5, 0.4), (0.7, 0.6), (math.inf, 0.7)])
def test_a_box_sticks_where_friction_is_above_the_slope(friction, angle, solver):
    """It holds while m g sin <= mu m g cos, that is tan(angle) <= mu.

    Then it creeps by less than 0.5 mm a second with the iterative solver, and 1 um with the exact one.
    """
    assert math.tan(angle) < friction
    slope = Slope(angle, brick(friction), 0.25, solver)
    slope.world.run(0.5)
    start = slope.body.position
    slope.world.run(1.0)
    assert slope.body.position.distance(start) < (5e-4 if solver == "quick" else 1e-6)
    assert abs(slope.speed()) < 1e-4


@pytest.mark.parametrize(("friction", "angle"), [(0.0, 0.3), (0.2, 0.5), (0.4, 0.6), (0.5, 0.5)])
def test_a_box_slides_by_the_slope_less_the_friction(friction, angle, solver):
    """It follows m a = m g sin - mu m g cos, to 0.2 % of g with the iterative solver and 1e-9 with the exact one."""
    assert math.tan(angle) > friction
    slope = Slope(angle, brick(friction), 0.25, solver)
    expected = GRAVITY * (math.sin(angle) - friction * math.cos(angle))
    assert slope.acceleration() == pytest.approx(expected, abs=2e-3 * GRAVITY if solver == "quick" else 1e-9)


@pytest.mark.parametrize(
    ("geom", "shape"),
    [(oo.Sphere(0.25, mass=3), 2 / 5), (oo.Cylinder(0.25, 0.6, mass=3), 1 / 2)],
    ids=["sphere", "cylinder"],
)
def test_round_things_roll_slower_than_they_would_slide(geom, shape, solver):
    """Without slipping a = g sin / (1 + k) with I = k m r^2, and a = r dw/dt, to 1e-5.

    From m a = m g sin - f and I a / r = f r. The friction needed, k / (1 + k) m g sin, is below mu m g cos here.
    """
    angle = 0.3
    twin = geom.copy()
    twin.surface = oo.Surface(1.0)
    slope = Slope(angle, twin, 0.25, solver)
    assert slope.acceleration() == pytest.approx(GRAVITY * math.sin(angle) / (1 + shape), rel=1e-5)
    assert slope.speed() == pytest.approx(-slope.body.angular_velocity.z * 0.25, rel=1e-5)


def test_across_its_tangents_the_friction_pyramid_brakes_more():
    """On level ground ODE's tangents are x and z, each brakes by mu g: at 45 degrees that is sqrt(2) mu g in all."""
    world = oo.World(gravity=(0, -GRAVITY, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane())
    box = space.attach(oo.Body(position=(0, 0.25, 0), linear_velocity=(6, 0, 6)))
    box.attach(oo.Placeable()).attach(oo.Box((2, 0.5, 2), mass=3, surface=oo.Surface(0.4)))
    world.run(0.2)
    before = box.linear_velocity
    world.run(0.5)
    braking = (before - box.linear_velocity) / 0.5
    assert tuple(braking) == pytest.approx((0.4 * GRAVITY, 0, 0.4 * GRAVITY), abs=1e-4)
    assert braking.length == pytest.approx(math.sqrt(2) * 0.4 * GRAVITY, rel=1e-4)


@pytest.mark.parametrize("bounce", [0.5, 0.8, 1.0])
def test_a_ball_rises_to_the_square_of_the_bounce_each_time(bounce, solver):
    """From v' = e v and height = v^2 / (2 g): each top is e^2 times the last.

    A contact is found up to one step late: the height is uncertain by the way of one step, v h, for every bounce.
    """
    h, drop, radius = 1 / 4000, 1.0, 0.2
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=h, solver=solver)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane())
    ball = space.attach(oo.Body(position=(0, radius + drop, 0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(radius, mass=3, surface=oo.Surface(bounce=bounce)))
    tops, rising = [], False
    while len(tops) < 3:
        world.step()
        if rising and ball.linear_velocity.y <= 0:
            tops.append(ball.position.y - radius)
        rising = ball.linear_velocity.y > 0
    late = math.sqrt(2 * GRAVITY * drop) * h
    for k, top in enumerate(tops, 1):
        assert top == pytest.approx(drop * bounce ** (2 * k), abs=k * late)


def collide(masses, speeds, bounce, solver, offset=0.0):
    """Two spheres of radius 0.5 on their way to each other along x; ``offset`` is how far they miss a head-on hit."""
    # With an ERP of 0 the overlap of the first step isn't pushed apart, which would add to the speeds.
    world = oo.World(gravity=(0, 0, 0), step_size=1 / 2000, solver=solver, erp=0)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    surface = oo.Surface(0.5, bounce=bounce, bounce_velocity=0)
    balls = []
    for x, y, m, v in zip((-1, 1), (0, offset), masses, speeds, strict=True):
        ball = space.attach(oo.Body(position=(x, y, 0), linear_velocity=(v, 0, 0)))
        ball.attach(oo.Placeable()).attach(oo.Sphere(0.5, mass=m, surface=surface))
        balls.append(ball)
    return world, balls


@pytest.mark.parametrize(
    ("masses", "speeds"), [((2, 2), (3, 0)), ((2, 2), (3, -3)), ((1, 6), (4, 0.5)), ((8, 1), (2, -1))]
)
@pytest.mark.parametrize("bounce", [0.0, 0.6, 1.0])
def test_spheres_that_meet_head_on_keep_their_momentum(masses, speeds, bounce, solver):
    """v1' = (m1 v1 + m2 v2 + m2 e (v2 - v1)) / (m1 + m2), and v2' with 1 and 2 changed.

    Momentum to 1e-9, speeds to 1e-6: the softness of contacts (CFM) is not quite 0.
    """
    (m1, m2), (v1, v2) = masses, speeds
    world, (first, second) = collide(masses, speeds, bounce, solver)
    world.run(1)
    momentum = m1 * v1 + m2 * v2
    assert (first.momentum + second.momentum).x == pytest.approx(momentum, abs=1e-9)
    scale = abs(v1 - v2)
    expected1 = (momentum + m2 * bounce * (v2 - v1)) / (m1 + m2)
    expected2 = (momentum + m1 * bounce * (v1 - v2)) / (m1 + m2)
    assert first.linear_velocity.x == pytest.approx(expected1, abs=1e-6 * scale)
    assert second.linear_velocity.x == pytest.approx(expected2, abs=1e-6 * scale)


def test_a_glancing_hit_with_friction_keeps_momentum_and_angular_momentum(solver):
    """Only inner forces act: sum m v to 1e-9, and sum (x cross m v + I w) to what the overlap's depth leaves open.

    The contact point lies between the spheres, so friction acts on both at one point up to the depth v h.
    """
    world, balls = collide((2.0, 5.0), (3.0, -1.0), 0.5, solver, offset=0.6)

    def totals():
        linear = sum((np.array(b.momentum) for b in balls), np.zeros(3))
        turning = sum((np.cross(b.position, b.momentum) + np.array(b.angular_momentum) for b in balls), np.zeros(3))
        return linear, turning

    before = totals()
    world.run(1)
    now = totals()
    assert balls[0].angular_velocity.length > 0.1  # it was hit off centre
    assert np.allclose(now[0], before[0], atol=1e-9)
    assert np.allclose(now[1], before[1], atol=2.0 * 4.0 * 4.0 / 2000)
