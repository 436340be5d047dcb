"""The player with the weapons: it takes what it walks to, shoots where it looks, and is kicked, not thrown over."""

import math
from contextlib import contextmanager

import pytest

import osgode as oo
from osgode.engine import Scene
from osgode.examples.game.flail import ITERATIONS, Flail
from osgode.examples.game.gun import BALL_MASS, FULL_IMPULSE, ConstructorGun
from osgode.examples.game.player import Player
from osgode.examples.game.rocket import Rocket, RocketLauncher
from osgode.testing import Play


class Yard(Scene):
    def populate_world(self):
        self.world.iterations = ITERATIONS
        self.static.attach(oo.Plane(material="earth"))
        self.player = self.dynamic.attach(Player((0, 0, 0)))
        self.gun = self.dynamic.attach(ConstructorGun((0.2, 0.1, -3.0), yaw=0.8))
        self.launcher = self.dynamic.attach(RocketLauncher((4.0, 0.2, 0.0)))
        self.flail = self.dynamic.attach(Flail((-4.0, 0.1, 0.0)))
        self.camera.ride(self.player)


@contextmanager
def yard():
    with Play(Yard) as play:
        play.seconds(0.5)
        yield play


def aim(play):
    return play.scene.camera.pose.position, play.scene.camera.forward


def test_the_player_walks_to_a_weapon_and_has_it_in_its_right_hand():
    with yard() as play:
        player, gun = play.scene.player, play.scene.gun
        play.hold("forward")
        play.until(lambda: gun.held, seconds=3.0)
        play.release("forward")
        play.seconds(1.0)
        assert gun.hand is player.arms[0]
        assert gun.carrier is player
        assert player.arsenal.in_hand is gun
        play.look(0.7, -0.4)
        play.seconds(1.0)
        ahead = gun.main_body.vector_to_world((0, 0, -1))
        assert math.acos(min(ahead.dot(play.scene.camera.forward), 1.0)) < math.radians(5.0)


@pytest.mark.parametrize("slot", [1, 2, 3])
def test_each_weapon_is_carried_without_trouble(slot):
    with yard() as play:
        player = play.scene.player
        for weapon in (play.scene.gun, play.scene.launcher, play.scene.flail):
            assert player.pick_up(weapon)
        assert player.arsenal.switch(slot)
        play.hold("right")
        stretch = 0.0
        for k in range(180):
            play.look(0.03 * math.sin(k / 20), 0.005 * math.cos(k / 13))
            play.frames(1)
            stretch = max(stretch, play.scene.flail.stretch if slot == 3 else 0.0)
            assert slot == player.arsenal.in_hand.SLOT
            assert player.torso.vector_to_world((0, 1, 0)).y > math.cos(math.radians(1.0))
        assert player.velocity.length < 6.0
        assert stretch < 0.005


def test_a_full_shot_of_the_player_hits_where_it_looks_and_pushes_it_back():
    with yard() as play:
        player, gun = play.scene.player, play.scene.gun
        player.pick_up(gun)
        play.look(0.5, -0.1)
        play.seconds(0.5)
        player.arsenal.press("left")
        play.seconds(gun.FULL_CHARGE + 0.1)
        eye, forward = aim(play)
        player.arsenal.release("left", (eye, forward))
        (shot,) = gun.shots.alive
        way = shot.linear_velocity.normalized()
        assert shot.linear_velocity.length == pytest.approx(FULL_IMPULSE / BALL_MASS, rel=0.02)
        assert math.acos(min(way.dot(forward), 1.0)) < math.radians(1.0)
        most = 0.0
        for _ in range(60):
            play.frames(1)
            most = max(most, -player.velocity.dot(forward))
            assert player.torso.vector_to_world((0, 1, 0)).y > math.cos(math.radians(1.0))
            assert gun.held
        # Half of the impulse into all of its mass is 6 m/s at the most; feet and knees take some of it at once.
        assert 1.0 < most < 0.5 * FULL_IMPULSE / (player.weight + gun.main_body.mass) + 0.5
        play.seconds(1.0)
        assert player.velocity.length < 0.3


def test_a_rocket_of_the_player_leaves_it_alone():
    with yard() as play:
        player, launcher = play.scene.player, play.scene.launcher
        player.pick_up(launcher)
        play.seconds(0.5)
        player.arsenal.press("left")
        player.arsenal.release("left", aim(play))
        (rocket,) = [node for node in play.scene.dynamic.children if isinstance(node, Rocket)]
        play.seconds(1.0)
        assert rocket.in_simulation
        assert rocket.explosion is None
        assert player.feet.y == pytest.approx(0.0, abs=0.05)
