"""The game's button and platform."""

from itertools import pairwise

import pytest

import osgode as oo
from osgode.engine import Scene
from osgode.examples.game.platform import DEEP, SPEED, WAIT, Button, Platform
from osgode.examples.game.player import Player
from osgode.testing import Play


class Gap(Scene):
    """A button beside a platform that goes 8 m along x, one metre high."""

    def populate_world(self):
        self.static.attach(oo.Plane(material="concrete"))
        self.platform = self.dynamic.attach(Platform((0, 1, 0), (8, 1, 0)))
        self.button = self.dynamic.attach(Button((-4, 0.2, 0), self.platform.toggle))


def played(test):
    """The test with a Gap that has come to rest; a fixture would be kept by pytest for too long."""

    def run():
        with Play(Gap) as play:
            play.seconds(0.5)
            test(play)

    run.__name__, run.__doc__ = test.__name__, test.__doc__
    return run


def ball(scene, mass, height):
    body = scene.dynamic.attach(oo.Body(position=(-4, 0.2 + height, 0)))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.15, mass=mass, material="steel"))
    return body


@played
def test_nobody_presses_it(play):
    play.seconds(3)
    button, platform = play.scene.button, play.scene.platform
    assert button.armed
    assert button.presses == 0
    assert abs(button.depth) < 0.002
    assert not platform.running
    assert abs(platform.position) < 0.002


@played
def test_a_players_weight_presses_it_once_and_a_second_time_after_he_went_off(play):
    scene = play.scene
    player = scene.dynamic.attach(Player((-4, 0.25, 0)))
    play.seconds(6)
    assert scene.button.presses == 1
    assert scene.platform.running
    player.place(oo.Pose(oo.Vec3(-8, player.reach, 0)), at_rest=True)
    play.seconds(2)
    assert scene.button.armed
    assert abs(scene.button.depth) < 0.003
    player.place(oo.Pose(oo.Vec3(-4, 0.3 + player.reach, 0)), at_rest=True)
    play.seconds(1)
    assert scene.button.presses == 2
    assert not scene.platform.running


@played
def test_a_thrown_ball_presses_it_and_a_light_thing_does_not(play):
    scene = play.scene
    light = ball(scene, 5, 0.16)
    play.seconds(2)
    assert scene.button.presses == 0
    scene.dynamic.detach(light)
    heavy = ball(scene, 10, 2.0)
    play.seconds(2)
    assert scene.button.presses == 1
    scene.dynamic.detach(heavy)


@played
def test_it_comes_out_slowly(play):
    """After a press it takes many steps, and never faster than a creep."""
    button = play.scene.button
    button.cap.position = button.cap.position - (0, 0.9 * DEEP, 0)
    play.steps(2)
    assert button.presses == 1
    way = []
    while button.depth > 0.2 * DEEP:
        way.append(button.depth)
        play.steps(1)
    assert len(way) > 40
    assert all(a >= b - 1e-6 for a, b in pairwise(way))


@played
def test_the_platform_goes_waits_and_comes_back(play):
    scene = play.scene
    platform = scene.platform
    platform.toggle()
    fastest = 0.0
    while not platform.arrived:
        play.steps(1)
        fastest = max(fastest, platform.slider.position_rate)
    assert fastest == pytest.approx(SPEED, rel=0.02)
    assert platform.position == pytest.approx(8, abs=0.01)
    begin = scene.world.time
    play.until(lambda: platform.position < 7.99)
    assert scene.world.time - begin == pytest.approx(WAIT, abs=0.3)
    platform.toggle()
    play.seconds(12)
    assert platform.position == pytest.approx(0, abs=0.005)  # switched off it goes on to the end, and stays


@played
def test_a_rider_travels_with_it_and_leaves_at_the_other_end(play):
    scene = play.scene
    player = scene.dynamic.attach(Player((0.4, 1.0, 0.3), yaw=-1.5707963))
    play.seconds(1)
    place = player.feet - scene.platform.deck.position
    scene.platform.toggle()
    while not scene.platform.arrived:
        play.steps(1)
        assert (player.feet - scene.platform.deck.position - place).length < 0.05
    bank = scene.static.attach(oo.Placeable(position=(12, 0.5, 0)))
    bank.attach(oo.Box((5.4, 1, 3)))
    player.controls.move(forward=True)
    play.seconds(1)
    assert player.feet.x > 10
    assert player.feet.y == pytest.approx(1.0, abs=0.02)


@played
def test_it_carries_crates_too(play):
    scene = play.scene
    crate = scene.dynamic.attach(oo.Body(position=(0.5, 1.25, 0.5)))
    crate.attach(oo.Placeable()).attach(oo.Box((0.5, 0.5, 0.5), mass=10, material="wood"))
    play.seconds(0.5)
    place = crate.position - scene.platform.deck.position
    scene.platform.toggle()
    play.seconds(7)
    assert (crate.position - scene.platform.deck.position - place).length < 0.05
