"""Surfaces against closed formulas: sliding, sticking, bouncing, rolling, belts, tyres, soft ground."""

import math

import numpy as np
import pytest

import osgode as oo

G = 9.81
SOLVERS = pytest.mark.parametrize("solver", ["quick", "exact"])


def ground(step_size=1 / 500, solver="quick", tilt=0.0, turn=0.0, **fields):
    """A World whose gravity is tilted by ``tilt`` about z, so that down the slope is +x, and a big box as floor.

    The floor's top is y = 0; the box itself may be turned about y.
    """
    world = oo.World(gravity=(G * math.sin(tilt), -G * math.cos(tilt), 0), step_size=step_size, solver=solver)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    place = space.attach(oo.Placeable(position=(0, -1, 0), rotation=oo.Quat.from_axis_angle((0, 1, 0), turn)))
    floor = place.attach(oo.Box((60, 2, 60), **fields))
    return world, space, floor


def put(space, geom, height, **fields):
    body = space.attach(oo.Body(position=(0, height, 0), **fields))
    body.attach(oo.Placeable()).attach(geom)
    return body


def brick(**fields):
    return oo.Box((0.4, 0.2, 0.4), mass=2, **fields)


# -- friction


@SOLVERS
@pytest.mark.parametrize(("speed", "friction"), [(3, 0.5), (2, 0.2), (4, 0.8)])
def test_a_sliding_box_stops_within_v2_over_2_mu_g(speed, friction, solver):
    world, space, _ = ground(solver=solver)
    world.surfaces.fallback = oo.Surface(friction)
    body = put(space, brick(), 0.1)
    world.run(0.2)
    start = body.position.x
    body.linear_velocity = (speed, 0, 0)
    world.run(3)
    assert body.position.x - start == pytest.approx(speed**2 / (2 * friction * G), rel=0.01)
    assert body.linear_velocity.length < 1e-3


@SOLVERS
@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_a_box_sticks_and_slips_at_tan_angle_equal_mu(friction, solver):
    for factor, slips in ((0.98, False), (1.02, True)):
        angle = math.atan(friction * factor)
        world, space, _ = ground(solver=solver, tilt=angle)
        world.iterations = 60
        world.surfaces.fallback = oo.Surface(friction)
        body = put(space, brick(), 0.1)
        world.run(0.5)
        before = body.linear_velocity.x
        world.run(1)
        gained = body.linear_velocity.x - before
        if slips:
            assert gained == pytest.approx(G * (math.sin(angle) - friction * math.cos(angle)), rel=0.1)
        else:
            assert abs(gained) < 1e-3
            assert abs(body.linear_velocity.x) < 5e-3


@SOLVERS
@pytest.mark.parametrize("bounce", [0.3, 0.5, 0.8])
def test_a_ball_bounces_to_e_squared_of_its_height(bounce, solver):
    """Height above the lowest place, between the moments of touching: h1 = e^2 h0."""
    world, space, _ = ground(step_size=1 / 20000, solver=solver)
    world.surfaces.fallback = oo.Surface(0.5, bounce=bounce, bounce_velocity=0.01)
    body = put(space, oo.Sphere(0.2, mass=1), 1.2)
    heights, rising = [], False
    last = body.position.y
    while len(heights) < 2:
        world.step()
        now = body.position.y
        if rising and now < last:
            heights.append(last - 0.2)
            rising = False
        elif now > last:
            rising = True
        last = now
    assert heights[0] == pytest.approx(bounce**2 * 1.0, rel=0.02)
    assert heights[1] == pytest.approx(bounce**2 * heights[0], rel=0.02)


@SOLVERS
def test_a_sphere_rolls_with_five_sevenths(solver):
    angle = 0.2
    world, space, _ = ground(solver=solver, tilt=angle)
    world.surfaces.fallback = oo.Surface(1.0)
    body = put(space, oo.Sphere(0.3, mass=2), 0.3)
    world.run(0.2)
    before = body.linear_velocity.x
    world.run(1)
    assert body.linear_velocity.x - before == pytest.approx(5 / 7 * G * math.sin(angle), rel=0.01)
    assert -body.angular_velocity.z * 0.3 == pytest.approx(body.linear_velocity.x, rel=0.01)


def test_rolling_friction_stops_a_ball_and_none_does_not():
    speeds = {}
    for rolling in (0.0, 0.02):
        world, space, _ = ground()
        world.surfaces.fallback = oo.Surface(1.0, rolling_friction=rolling)
        body = put(space, oo.Sphere(0.3, mass=2), 0.3, linear_velocity=(2, 0, 0), angular_velocity=(0, 0, -2 / 0.3))
        world.run(2)
        speeds[rolling] = body.linear_velocity.x
    assert speeds[0.0] == pytest.approx(2, rel=0.01)
    assert speeds[0.02] < 1.9


@pytest.mark.parametrize("solver", ["exact"])
def test_balls_in_a_row_pass_the_blow_to_the_last(solver):
    """Newton's cradle: with the exact solver, e = 1 and small gaps, the last flies on with the speed of the first."""
    world = oo.World(gravity=(0, 0, 0), step_size=1 / 2000, solver=solver, erp=0.0)
    world.surfaces.fallback = oo.Surface(0.0, bounce=1.0, bounce_velocity=0.0)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    balls = []
    for i in range(5):
        body = space.attach(oo.Body(position=(0.202 * i, 0, 0)))
        body.attach(oo.Placeable()).attach(oo.Sphere(0.1, mass=1))
        balls.append(body)
    balls[0].linear_velocity = (1, 0, 0)
    world.run(0.2)
    assert [body.linear_velocity.x for body in balls] == pytest.approx([0, 0, 0, 0, 1], abs=1e-6)


# -- soft ground


@pytest.mark.parametrize("stiffness", [2e3, 2e4])
def test_a_soft_surface_sinks_by_weight_over_stiffness(stiffness):
    """One contact of a ball: depth = m g / k."""
    world, space, _ = ground()
    world.surfaces.fallback = oo.Surface(0.5, stiffness=stiffness, damping=2 * math.sqrt(stiffness * 2))
    body = put(space, oo.Sphere(0.3, mass=2), 0.3)
    world.run(3)
    assert 0.3 - body.position.y == pytest.approx(2 * G / stiffness, rel=0.02)


# -- belts


@SOLVERS
@pytest.mark.parametrize("turn", [0.0, 0.7, 2.5])
def test_a_belt_carries_a_box_to_its_speed(turn, solver):
    """Along its own axes, however it stands; by friction mu g until then: after v / (mu g) it moves with the belt."""
    world, space, _ = ground(solver=solver, turn=turn, surface_velocity=(1.5, 0, 0))
    world.surfaces.fallback = oo.Surface(0.4)
    body = put(space, brick(), 0.1, rotation=oo.Quat.from_axis_angle((0, 1, 0), turn))
    along = oo.Quat.from_axis_angle((0, 1, 0), turn).rotate((1, 0, 0))
    world.run(0.5 * 1.5 / (0.4 * G))
    assert 0.3 < body.linear_velocity.dot(along) / 1.5 < 0.7
    world.run(2)
    assert body.linear_velocity.dot(along) == pytest.approx(1.5, rel=0.01)
    assert (body.linear_velocity - along * 1.5).length < 0.015


@pytest.mark.parametrize("first", ["belt", "load"])
def test_a_belt_works_whichever_geom_comes_first(first):
    world = oo.World(gravity=(0, -G, 0), step_size=1 / 500)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    belt = oo.Placeable(position=(0, -1, 0))
    belt.attach(oo.Box((60, 2, 60), surface_velocity=(0, 0, -2)))
    body = oo.Body(position=(0, 0.1, 0))
    body.attach(oo.Placeable()).attach(brick())
    for node in (belt, body) if first == "belt" else (body, belt):
        space.attach(node)
    world.run(2)
    assert tuple(body.linear_velocity) == pytest.approx((0, 0, -2), abs=0.02)


def test_a_plane_and_a_mesh_can_be_belts():
    for geom in (
        oo.Plane(surface_velocity=(1, 0, 0)),
        oo.Trimesh(
            ([(-20, 0, -20), (-20, 0, 20), (20, 0, 20), (20, 0, -20)], [(0, 1, 2), (0, 2, 3)]),
            surface_velocity=(1, 0, 0),
        ),
    ):
        world = oo.World(gravity=(0, -G, 0), step_size=1 / 500)
        space = world.attach(oo.HashSpace())
        world.collide(space)
        (space if isinstance(geom, oo.Plane) else space.attach(oo.Placeable())).attach(geom)
        body = put(space, brick(), 0.1)
        world.run(2)
        assert body.linear_velocity.x == pytest.approx(1, rel=0.01)


def test_a_belt_on_a_body_drives_it_over_the_ground():
    """A tank's track: the underside runs backwards, so it goes forwards."""
    world, space, _ = ground()
    world.surfaces.fallback = oo.Surface(0.8)
    tank = put(space, brick(surface_velocity=(-1.2, 0, 0)), 0.1)
    world.run(2)
    assert tank.linear_velocity.x == pytest.approx(1.2, rel=0.01)


def test_a_belt_and_its_load_push_each_other_alike():
    """Momentum: a free plate with a running top, on ice, and a load of the same mass part with 1 m/s between them."""
    world, space, floor = ground()
    floor.surface = oo.Surface(0.0)
    world.surfaces.fallback = oo.Surface(0.5)
    plate = put(space, oo.Box((4, 0.2, 4), mass=2, surface_velocity=(1, 0, 0)), 0.1)
    load = put(space, brick(), 0.3)
    world.run(1.0)
    assert load.linear_velocity.x - plate.linear_velocity.x == pytest.approx(1, rel=0.01)
    assert load.linear_velocity.x + plate.linear_velocity.x == pytest.approx(0, abs=0.01)


def test_two_belts_add_up():
    world, space, _ = ground(surface_velocity=(1, 0, 0))
    body = put(space, brick(surface_velocity=(-0.5, 0, 0)), 0.1)
    world.run(2)
    assert body.linear_velocity.x == pytest.approx(1.5, rel=0.01)


def test_a_belt_carries_up_a_slope_that_holds():
    angle = 0.25
    world, space, _ = ground(tilt=angle, surface_velocity=(-1, 0, 0))
    world.surfaces.fallback = oo.Surface(0.6)
    body = put(space, brick(), 0.1)
    world.run(2)
    assert body.linear_velocity.x == pytest.approx(-1, rel=0.01)


def test_starting_a_belt_wakes_what_sleeps_on_it():
    world, space, floor = ground()
    world.auto_disable = True
    body = put(space, brick(), 0.1)
    world.run(3)
    assert not body.enabled
    floor.surface_velocity = (1, 0, 0)
    world.run(1)
    assert body.linear_velocity.x == pytest.approx(1, rel=0.01)


# -- directions


@SOLVERS
@pytest.mark.parametrize("owner", ["body", "floor"])
@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_friction_along_and_across_a_direction(owner, turn, solver):
    """A skate: much friction along its axle, little across it. Sliding decelerates by mu g of that way."""
    surface = oo.Surface(0.8, direction=(0, 0, 1), friction_across=0.1)
    for axis, friction in (((0, 0, 1), 0.8), ((1, 0, 0), 0.1)):
        world, space, _ = ground(solver=solver, turn=turn, surface=surface if owner == "floor" else None)
        turned = oo.Quat.from_axis_angle((0, 1, 0), turn)
        body = put(space, brick(surface=surface if owner == "body" else None), 0.1, rotation=turned)
        world.run(0.2)
        way = turned.rotate(axis)
        body.linear_velocity = way * 4.0
        body.angular_velocity = (0, 0, 0)
        world.run(0.4)
        assert body.linear_velocity.dot(way) == pytest.approx(4 - friction * G * 0.4, abs=0.08)
        assert (body.linear_velocity - way * body.linear_velocity.dot(way)).length < 0.02


def test_slip_across_lets_a_tyre_creep_only_that_way():
    """Slip is speed per force: pushed with F it creeps with slip F, n contacts share the force."""
    surface = oo.Surface(2.0, direction=(1, 0, 0), slip=0.0, slip_across=0.01)
    world, space, _ = ground()
    world.iterations = 100
    body = put(space, oo.Sphere(0.3, mass=2, surface=surface), 0.3)
    body.fixed_mass = oo.Mass(2.0, inertia=np.eye(3) * 1e6)  # it can hardly turn
    for way, creep in (((1, 0, 0), 0.0), ((0, 0, 1), 0.01 * 10)):
        body.linear_velocity = (0, 0, 0)
        for _ in range(500):
            body.add_force(oo.Vec3(*way) * 10)
            world.step()
        assert body.linear_velocity.dot(way) == pytest.approx(creep, abs=0.002)


def test_of_two_own_surfaces_that_of_lower_friction_counts():
    """And an own one goes before the table."""
    for one, other, table, expected in (
        (0.9, 0.2, 0.5, 0.2),
        (0.2, 0.9, 0.5, 0.2),
        (0.3, None, 0.9, 0.3),
        (None, 0.3, 0, 0.3),
    ):
        world, space, floor = ground()
        floor.surface = None if one is None else oo.Surface(one)
        world.surfaces.fallback = oo.Surface(table)
        body = put(space, brick(surface=None if other is None else oo.Surface(other)), 0.1)
        world.run(0.2)
        body.linear_velocity = (4, 0, 0)
        world.run(0.3)
        assert body.linear_velocity.x == pytest.approx(4 - expected * G * 0.3, abs=0.05)


def test_less_friction_wakes_what_sleeps_on_a_slope():
    world, space, floor = ground(tilt=0.3)
    world.auto_disable = True
    floor.surface = oo.Surface(0.8)
    body = put(space, brick(), 0.1)
    world.run(4)
    assert not body.enabled
    floor.surface = oo.Surface(0.0)
    world.run(0.5)
    assert body.linear_velocity.x > 1
