"""Rockets: slow at first, faster in each step, ten seconds of fuel, an explosion where they hit."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.examples.game.explosion import DURATION, Explosion
from osgode.examples.game.rocket import (
    ACCELERATION,
    EXPIRES,
    FUEL,
    RECOIL,
    RELOAD,
    ROCKET_LENGTH,
    ROCKET_MASS,
    START_SPEED,
    Rocket,
    RocketLauncher,
)
from tests.examples.game.bearer import AHEAD, EYE, Range


def launched(**settings):
    scene = Range(bearer=False, ground=False, **settings)
    rocket = scene.moving.attach(Rocket((0.0, 10.0, 0.0)))
    return scene, rocket


def test_a_rocket_is_accelerated_in_each_step_along_its_flight():
    """V = v0 + a t, and it flies straight on, in spite of gravity, as long as it burns."""
    scene, rocket = launched()
    assert rocket.rocket.linear_velocity == (0.0, 0.0, -START_SPEED)
    before = START_SPEED
    for _ in range(120):
        scene.world.step()
        speed = rocket.rocket.linear_velocity.length
        assert speed >= before
        before = speed
    # It pushes itself for the first time after its first step.
    assert before == pytest.approx(START_SPEED + ACCELERATION * 119 / 120, rel=1e-6)
    scene.world.run(seconds=4.0)
    assert rocket.burning
    assert rocket.rocket.linear_velocity.length == pytest.approx(START_SPEED + ACCELERATION * 5.0, rel=1e-2)
    assert rocket.rocket.position.y == pytest.approx(10.0, abs=1e-6)
    assert rocket.rocket.position.z == pytest.approx(-(START_SPEED * 5 + ACCELERATION * 12.5), rel=1e-2)


def test_after_ten_seconds_its_fuel_is_gone_and_it_falls_with_its_nose_ahead():
    scene, rocket = launched()
    scene.world.run(seconds=FUEL - 1 / 120)
    assert FUEL == 10.0
    assert rocket.burning
    assert not rocket.rocket.gravity
    scene.world.run(seconds=2 / 120)
    assert not rocket.burning
    assert rocket.rocket.gravity
    ahead, height = rocket.rocket.linear_velocity.z, rocket.rocket.position.y
    scene.world.run(seconds=5.0)
    velocity = rocket.rocket.linear_velocity
    assert velocity.z == pytest.approx(ahead, rel=1e-6)
    assert velocity.y == pytest.approx(-9.81 * 5.0, rel=0.01)
    assert rocket.rocket.position.y == pytest.approx(height - 0.5 * 9.81 * 25.0, rel=0.01)
    nose = rocket.rocket.vector_to_world(AHEAD)
    assert nose.dot(velocity.normalized()) > math.cos(math.radians(1.0))


def test_a_rocket_that_hits_is_gone_in_the_next_step_and_an_explosion_is_in_its_place():
    scene, rocket = launched()
    wall = scene.fixed.attach(oo.Placeable(position=(0, 10, -30))).attach(oo.Box((20, 20, 0.1)))
    hit = []
    wall.on_touch(lambda touch: hit.append(scene.world.steps) if touch.begin else None)
    while not hit:
        assert rocket.in_simulation
        scene.world.step()
    assert rocket.in_simulation
    assert rocket.explosion is None
    where = rocket.rocket.position
    scene.world.step()
    assert not rocket.in_simulation
    assert rocket.parent is None
    explosion = rocket.explosion
    assert isinstance(explosion, Explosion)
    assert explosion.in_simulation
    assert explosion.main_body.position.distance((0.0, 10.0, -29.95 + ROCKET_LENGTH / 2)) < 0.05
    assert explosion.main_body.position.distance(where) < 0.5
    scene.world.run(seconds=DURATION + 0.1)
    assert not explosion.in_simulation
    live = oo.live_natives()
    assert (live.bodies, live.geoms, live.joints) == (0, 1, 0)


def test_the_explosion_throws_crates_outward_from_where_the_rocket_hit():
    scene, rocket = launched()
    scene.fixed.attach(oo.Plane(offset=0.0))
    rocket.place(oo.Pose(oo.Vec3(0.0, 0.25, 10.0)))
    stack = [scene.crate((0.55 * i, 0.25 + 0.5 * j, 0.0)) for i in range(-2, 3) for j in range(3)]
    scene.world.run(seconds=0.5)
    while rocket.in_simulation:
        scene.world.step()
    middle = rocket.explosion.main_body.position
    before = [crate.position.distance(middle) for crate in stack]
    scene.world.run(seconds=DURATION)
    assert all(crate.position.distance(middle) > old + 0.5 for crate, old in zip(stack, before, strict=True))
    assert max(crate.linear_velocity.length for crate in stack) > 5.0
    assert max(crate.linear_velocity.length for crate in stack) < 60.0


@pytest.mark.parametrize("speed", [8.0, 200.0])
def test_a_rocket_does_not_pass_through_a_thin_wall(speed):
    scene, rocket = launched()
    wall = oo.Box((20, 20, 0.02))
    scene.fixed.attach(oo.Placeable(position=(0, 10, -20.123))).attach(wall)
    rocket.rocket.linear_velocity = (0, 0, -speed)
    scene.world.run(seconds=2.0)
    assert rocket.explosion is not None
    assert rocket.rocket.position.z > -20.2


def test_a_rocket_that_hits_nothing_is_gone_in_the_end():
    scene, rocket = launched(gravity=(0, 0, 0))
    scene.world.run(seconds=EXPIRES - 1.0)
    assert rocket.in_simulation
    scene.world.run(seconds=1.5)
    assert not rocket.in_simulation
    assert rocket.explosion is None


def test_only_a_rocket_in_a_world_explodes():
    with pytest.raises(oo.StateError, match="in no World"):
        Rocket((0.0, 0.0, 0.0)).explode()


def test_the_launcher_shoots_along_the_aiming_ray_and_loads_again():
    scene = Range()
    launcher = scene.give(RocketLauncher((0.0, 0.5, 2.0)))

    def rockets():
        return [node for node in scene.moving.children if isinstance(node, Rocket)]

    aim = (EYE, oo.Vec3(0.3, 0.1, -1.0).normalized())
    assert launcher.loaded
    assert launcher.shown_rocket.on
    scene.shoot(launcher, charge=0.05, aim=aim)
    (rocket,) = rockets()
    assert not launcher.loaded
    assert not launcher.shown_rocket.on
    scene.shoot(launcher, charge=0.05, aim=aim)
    assert len(rockets()) == 1
    scene.world.run(seconds=1.5)
    assert rocket.in_simulation  # launcher, hand and ground have not been hit
    seen = (rocket.rocket.position - EYE).normalized()
    assert math.acos(min(seen.dot(aim[1]), 1.0)) < math.radians(1.0)
    assert RELOAD < 1.5
    assert launcher.loaded
    assert launcher.shown_rocket.on
    scene.shoot(launcher, "right", charge=0.05, aim=aim)
    assert len(rockets()) == 2


def test_the_launcher_kicks():
    scene = Range(ground=False, kinematic=False, gravity=(0, 0, 0))
    launcher = scene.give(RocketLauncher((0.0, 0.5, 2.0)))
    launcher.fire("left", 1.0, (EYE, AHEAD))
    scene.world.run(seconds=0.2)
    momentum = scene.bearer.hand.momentum + launcher.main_body.momentum
    assert momentum.length == pytest.approx(RECOIL, rel=0.01)
    assert momentum.z > 0.99 * RECOIL
    assert pytest.approx(RECOIL, rel=0.1) == ROCKET_MASS * START_SPEED  # what the rocket has got


def test_rockets_are_the_same_every_time():
    ends = []
    for _ in range(2):
        scene, _rocket = launched()
        scene.fixed.attach(oo.Plane())
        crates = [scene.crate((0.6 * (k % 3) - 0.6, 9.8 + 0.5 * (k // 3), -15.0)) for k in range(9)]
        scene.fixed.attach(oo.Placeable(position=(0, 9.5, -15))).attach(oo.Box((4, 0.1, 4)))
        scene.world.run(seconds=3.0)
        assert max(crate.position.distance((0, 10, -15)) for crate in crates) > 3.0
        ends.append(scene.world.poses.copy())
    assert np.array_equal(*ends)
