"""The mount: it turns to where it is told, holds weapons, and takes their recoil."""

import math

import pytest

import osgode as oo
from osgode.examples.game.gun import ConstructorGun
from osgode.examples.game.mount import HEIGHT, TURN_SPEED, Mount
from tests.examples.game.bearer import Range


def mounted():
    scene = Range(bearer=False)
    mount = scene.moving.attach(Mount())
    gun = scene.moving.attach(ConstructorGun((0.0, HEIGHT, 0.0)))
    mount.pick_up(gun)
    scene.world.run(seconds=0.3)
    return scene, mount, gun


def test_it_turns_no_faster_than_it_can_and_looks_where_it_is_told():
    scene, mount, gun = mounted()
    target = oo.Vec3(-6.0, 3.0, -2.0)
    mount.look_at(target)
    way = abs(mount.controls.yaw)
    assert way > 1.0
    scene.world.run(seconds=0.5 * way / TURN_SPEED)
    turned = mount.fork.rotation.angle
    assert 0.4 * way < turned < 0.6 * way
    scene.world.run(seconds=1.0)
    eye, forward = mount.aim
    assert math.acos(min(forward.dot((target - eye).normalized()), 1.0)) < math.radians(5.0)  # its eye moves too
    ahead = gun.main_body.vector_to_world((0, 0, -1))
    assert math.acos(min(ahead.dot(forward), 1.0)) < math.radians(2.0)


def test_a_full_shot_pushes_the_cradle_back_and_the_spring_brings_it_home():
    scene, mount, gun = mounted()
    gun.fire("left", 1.0, mount.aim)
    furthest = 0.0
    for _ in range(60):
        scene.world.step()
        furthest = max(furthest, mount.slide.position)
    assert 0.05 < furthest < 0.4
    scene.world.run(seconds=1.0)
    assert mount.slide.position == pytest.approx(0.0, abs=1e-3)
