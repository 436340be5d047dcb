"""Explosions: they grow, change colour, push outward what they reach, each body once in a step, and are gone."""

import itertools
import math

import numpy as np
import pytest

import osgode as oo
from osgode.examples.game.explosion import (
    COLOURS,
    CORE,
    DURATION,
    FIRST_RADIUS,
    LIFT,
    PRESSURE,
    RADIUS,
    Explosion,
    area_of,
    colour_at,
)
from tests.examples.game.bearer import Range


def empty():
    return Range(bearer=False, ground=False, gravity=(0, 0, 0))


def shown(explosion):
    """Radius and colour of its outer ball as they are drawn."""
    leaf = next(node for node in explosion.walk() if isinstance(node, oo.Leaf))
    (drawable,) = leaf.drawables()
    return leaf.parent.scale.x, drawable.appearance


def test_it_grows_and_changes_its_colour_in_each_step_and_is_gone():
    scene = empty()
    explosion = scene.moving.attach(Explosion((1.0, 2.0, 3.0), radius=4.0))
    assert explosion.main_body.gravity is False
    radii, colours = [], []
    while explosion.in_simulation:
        radius, look = shown(explosion)
        assert radius == pytest.approx(explosion.radius)
        assert look.unlit
        radii.append(radius)
        colours.append(look.colour)
        scene.world.step()
    assert len(radii) == round(DURATION * 120)
    assert radii[0] == FIRST_RADIUS
    assert all(a < b for a, b in itertools.pairwise(radii))
    assert radii[-1] == pytest.approx(4.0, rel=0.01)
    assert len(set(colours)) == len(colours)
    assert all(look[3] < 1.0 for look in colours)
    assert colours[-1][3] < 0.05
    assert explosion.main_body.position == (1.0, 2.0, 3.0)
    assert explosion.parent is None
    live = oo.live_natives()
    assert (live.bodies, live.geoms) == (0, 0)


def test_colours_are_those_of_the_table_and_between():
    for age, colour in COLOURS:
        assert colour_at(age) == pytest.approx(colour)
    (a, first), (b, second) = COLOURS[1:3]
    assert colour_at((a + b) / 2) == pytest.approx(tuple((x + y) / 2 for x, y in zip(first, second, strict=True)))
    assert colour_at(2.0) == COLOURS[-1][1]


def test_what_it_reaches_is_thrown_outward_the_nearer_the_harder():
    scene = empty()
    places = [(1.0, 0, 0), (-2.0, 0, 0), (0, 0, 3.0), (0, 0, -4.0), (0, 0, 40.0)]
    crates = [scene.crate(place) for place in places]
    explosion = scene.moving.attach(Explosion())
    scene.world.run(seconds=DURATION + 0.1)
    speeds = [crate.linear_velocity.length for crate in crates]
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[-2] > 0.5
    assert speeds[-1] == 0.0
    for crate, place in zip(crates[:-1], places, strict=False):
        way = oo.Vec3(*place).normalized()
        assert crate.linear_velocity.normalized().dot(way) > 0.9
        # As it rises, the way outward leads upwards more and more.
        assert LIFT < crate.linear_velocity.y / crate.linear_velocity.dot(way) < 2.0 * LIFT
        assert explosion.pushed[crate] == pytest.approx(crate.mass * crate.linear_velocity.length, rel=0.1)


def test_a_body_of_many_parts_is_pushed_once_in_a_step():
    """In a step in the middle of its time it gets the impulse that the formula gives, not one for each part."""
    scene = empty()
    whole = scene.crate((2.0, 0.0, 0.0), size=0.5)
    parts = scene.moving.attach(oo.Body(position=(-2.0, 0.0, 0.0)))
    for k in range(8):
        corner = tuple(0.125 * (1 if k >> axis & 1 else -1) for axis in range(3))
        parts.attach(oo.Placeable(position=corner)).attach(oo.Box((0.25, 0.25, 0.25), mass=1.25, material="wood"))
    assert area_of(parts) == pytest.approx(area_of(whole)) == pytest.approx(0.25)
    explosion = scene.moving.attach(Explosion())
    scene.world.run(seconds=DURATION / 2)
    before = [body.momentum for body in (whole, parts)]
    scene.world.step()  # at the end of which it pushes
    places = [body.position.length for body in (whole, parts)]
    expected = [explosion.impulse_at(place, 0.25) for place in places]
    for body, old, impulse, place in zip((whole, parts), before, expected, places, strict=True):
        gained = (body.momentum - old).length
        assert gained == pytest.approx(impulse, rel=1e-6)
        assert gained == pytest.approx(PRESSURE * (1 - place / RADIUS) * 0.25 / 120, rel=1e-6)
    assert whole.momentum.length == pytest.approx(parts.momentum.length, rel=1e-6)


def test_its_push_falls_with_the_distance_and_has_a_bound():
    scene = empty()
    explosion = scene.moving.attach(Explosion(radius=4.0, pressure=1000.0))
    assert explosion.impulse_at(2.0, 3.0) == pytest.approx(1000 * 0.5 * 3 / 120)
    assert explosion.impulse_at(0.0, 1.0) == explosion.impulse_at(CORE, 1.0)
    assert explosion.impulse_at(4.0, 1.0) == explosion.impulse_at(9.0, 1.0) == 0.0


def test_in_its_very_middle_things_fly_upward_and_kinematic_ones_stay():
    scene = empty()
    crate = scene.crate((0.0, 0.0, 0.0))
    lift = scene.crate((2.0, 0.0, 0.0))
    lift.kinematic = True
    scene.moving.attach(Explosion())
    scene.world.run(seconds=1.0)
    assert crate.linear_velocity.y > 5.0
    assert math.hypot(crate.linear_velocity.x, crate.linear_velocity.z) < 0.2
    assert lift.position == (2.0, 0.0, 0.0)


def test_sleepers_are_woken_and_rays_see_nothing_of_it():
    scene = Range(bearer=False, auto_disable=True)
    crate = scene.crate((1.5, 0.25, 0.0))
    scene.world.run(seconds=2.0)
    assert crate.asleep
    scene.moving.attach(Explosion((0.0, 0.3, 0.0)))
    scene.world.run(seconds=0.3)
    assert not crate.asleep
    assert crate.linear_velocity.x > 2.0
    hit = scene.world.cast_ray((-20.0, 0.3, 0.0), (1.0, 0.0, 0.0), 20.5)
    assert hit is None


def test_explosions_are_the_same_every_time():
    ends = []
    for _ in range(2):
        scene = Range(bearer=False)
        for k in range(27):
            scene.crate((0.55 * (k % 3), 0.25 + 0.5 * (k // 9), 0.55 * (k // 3 % 3)))
        scene.world.run(seconds=0.2)
        scene.moving.attach(Explosion((0.2, 0.1, 0.3)))
        scene.world.run(seconds=2.0)
        ends.append(scene.world.poses.copy())
    assert np.array_equal(*ends)
