"""The game's door."""

import math

import pytest

import osgode as oo
from osgode.engine import Scene
from osgode.examples.game.player import Player
from osgode.examples.game.swing_door import OPEN, SIZE, SwingDoor
from osgode.testing import Play


class House(Scene):
    """A wall with a door in it."""

    def populate_world(self):
        self.static.attach(oo.Plane(material="concrete"))
        for side in (-1, 1):
            wall = self.static.attach(oo.Placeable(position=(side * (SIZE[0] / 2 + 1.03), 1.5, 0)))
            wall.attach(oo.Box((2, 3, 0.2), material="brick"))
        self.door = self.dynamic.attach(SwingDoor((-SIZE[0] / 2, 0, 0)))


def test_it_opens_for_who_walks_into_it_and_falls_shut_behind():
    with Play(House) as play:
        scene = play.scene
        player = scene.dynamic.attach(Player((0, 0, 2.5)))
        scene.camera.ride(player)
        play.hold("forward")
        widest = 0.0
        while player.feet.z > -2:
            play.steps(1)
            widest = max(widest, abs(scene.door.angle))
            assert widest < OPEN + 0.1
            assert play.app.clock.elapsed < 5
        assert widest > 0.6
        play.release("forward")
        play.seconds(5)
        assert abs(scene.door.angle) < 0.02


@pytest.mark.parametrize("push", [-400.0, 400.0])
def test_it_stops_at_its_stops(push):
    with Play(House) as play:
        door = play.scene.door
        for wall in play.scene.static.children:
            play.scene.static.detach(wall)
        door.leaf.apply_impulse((0, 0, push), at=door.leaf.position)
        widest = 0.0
        for _ in range(600):
            play.steps(1)
            widest = max(widest, abs(door.angle))
        assert widest == pytest.approx(OPEN, abs=math.radians(6))
        assert abs(door.angle) < 0.05
