"""The impact event: the energy with which things hit, where, and what of."""

import math

import pytest

import osgode as oo
from osgode.examples.game.impact import THRESHOLD, on_impact
from tests.examples.game.bearer import Range


def noted(node, threshold=THRESHOLD):
    impacts = []
    return impacts, on_impact(node, impacts.append, threshold)


def test_what_falls_has_the_energy_of_its_height():
    """M g h for a ball that falls onto the ground by h, and it is told once."""
    scene = Range(bearer=False)
    ball = scene.moving.attach(oo.Body(position=(3.0, 2.2, 1.0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.2, mass=5.0, material="rubber"))
    impacts, _ = noted(ball)
    scene.world.run(seconds=2.0)
    (impact,) = impacts
    assert impact.energy == pytest.approx(5.0 * 9.81 * 2.0, rel=0.03)  # of a step, it is seen late
    assert impact.speed == pytest.approx(math.sqrt(2 * 9.81 * 2.0), rel=0.02)
    assert impact.point.distance((3.0, 0.0, 1.0)) < 0.06
    assert impact.normal.distance((0.0, 1.0, 0.0)) < 1e-9
    assert impact.materials == ("rubber", "concrete")
    assert impact.geom is ball.geoms[0]
    assert isinstance(impact.other, oo.Plane)


@pytest.mark.parametrize(("one", "two"), [(1.0, 1.0), (10.0, 0.5)])
def test_two_bodies_have_the_energy_of_their_reduced_mass(one, two):
    scene = Range(bearer=False, ground=False, gravity=(0, 0, 0))
    left = scene.moving.attach(oo.Body(position=(-1, 0, 0), linear_velocity=(4.0, 0, 0)))
    left.attach(oo.Placeable()).attach(oo.Sphere(0.2, mass=one, material="steel"))
    right = scene.moving.attach(oo.Body(position=(1, 0, 0), linear_velocity=(-2.0, 1e-3, 0)))
    right.attach(oo.Placeable()).attach(oo.Sphere(0.2, mass=two, material="wood"))
    impacts, _ = noted(scene.moving)
    scene.world.run(seconds=1.0)
    (impact,) = impacts
    assert impact.energy == pytest.approx(0.5 * (one * two / (one + two)) * 6.0**2, rel=1e-3)
    assert sorted(impact.materials) == ["steel", "wood"]
    assert abs(impact.normal.x) == pytest.approx(1.0, abs=1e-3)


def test_a_blow_beside_the_middle_counts_what_turns_too():
    """A rod that flies against a corner with its end: about a quarter of its mass, 1 / (1/m + r^2 / I), counts."""
    scene = Range(bearer=False, ground=False, gravity=(0, 0, 0))
    rod = scene.moving.attach(oo.Body(position=(0, 0, 0), linear_velocity=(0, -3.0, 0)))
    rod.attach(oo.Placeable()).attach(oo.Box((2.0, 0.02, 0.02), mass=4.0))
    scene.fixed.attach(oo.Placeable(position=(0.95, -1.0, 0))).attach(oo.Box((0.1, 0.2, 1.0)))
    impacts, _ = noted(rod)
    scene.world.run(seconds=0.6)
    quarter = 4.0 / (1.0 + 12 * 0.95**2 / 4.0)
    assert impacts[0].energy == pytest.approx(0.5 * quarter * 3.0**2, rel=0.03)


def test_what_is_soft_isnt_told_and_it_can_be_ended():
    scene = Range(bearer=False)
    crate = scene.crate((0.0, 0.2501, 0.0))
    impacts, handle = noted(crate)
    scene.world.run(seconds=0.5)
    assert impacts == []
    crate.position = (0.0, 1.0, 0.0)
    scene.world.run(seconds=1.0)
    assert len(impacts) >= 1
    crate.remove_on_collide(handle)
    impacts.clear()
    crate.position = (0.0, 1.0, 0.0)
    scene.world.run(seconds=1.0)
    assert impacts == []


def test_sensors_and_what_is_refused_are_left_out():
    scene = Range(bearer=False, gravity=(0, 0, 0))
    zone = oo.Box((1, 1, 1), sensor=True)
    scene.fixed.attach(oo.Placeable(position=(0, 2, 0))).attach(zone)
    ghost = scene.fixed.attach(oo.Placeable(position=(0, 2, -3))).attach(oo.Box((1, 1, 1)))
    ghost.on_collide(lambda feedback: feedback.refuse())
    ball = scene.moving.attach(oo.Body(position=(0, 2, 3), linear_velocity=(0, 0, -5.0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.2, mass=5.0))
    impacts, _ = noted(ball, 0.0)
    scene.world.run(seconds=2.0)
    assert ball.position.z < -5.0
    assert impacts == []


def test_a_swept_shot_hits_with_all_of_its_energy():
    scene = Range(bearer=False, ground=False, gravity=(0, 0, 0))
    shot = scene.moving.attach(oo.Body(position=(0, 0, 5), linear_velocity=(0, 0, -100.0), tunnelling="sweep"))
    shot.attach(oo.Placeable()).attach(oo.Sphere(0.067, mass=10.0))
    scene.fixed.attach(oo.Placeable(position=(0, 0, -5))).attach(oo.Box((10, 10, 0.2)))
    impacts, _ = noted(shot)
    scene.world.run(seconds=0.5)
    (impact,) = impacts
    assert impact.energy == pytest.approx(0.5 * 10.0 * 100.0**2, rel=1e-6)
