"""The game's pendulums: their rhythm, and that nobody stops them."""

import math
from itertools import pairwise

import pytest

import osgode as oo
from osgode.engine import Scene
from osgode.examples.game.pendulum import AMPLITUDE, LENGTH, Pendulum
from osgode.testing import Play


def rhythm(in_the_way, seconds=16.0):
    """The times between turning back, and the pendulum and the thing in its way at the end."""
    scene = Scene()
    scene.static.attach(oo.Plane(material="concrete"))
    with Play(scene) as play:
        pendulum = scene.dynamic.attach(Pendulum((0, LENGTH + 0.6, 0)))
        block = None
        if in_the_way:
            block = scene.dynamic.attach(oo.Body(position=(0.8, 0.75, 0)))
            block.attach(oo.Placeable()).attach(oo.Box((0.6, 1.5, 0.6), mass=500, material="concrete"))
        turned, times = 0, []
        for _ in range(round(seconds * 120)):
            play.steps(1)
            if pendulum.turns != turned:
                turned = pendulum.turns
                times.append(scene.world.time)
        return [b - a for a, b in pairwise(times)], block and block.position


def test_it_keeps_its_rhythm_while_half_a_ton_stands_in_its_way():
    free, _ = rhythm(in_the_way=False)
    hit, place = rhythm(in_the_way=True)
    assert len(free) >= 8
    mean = sum(free) / len(free)
    assert sum(hit) / len(hit) == pytest.approx(mean, rel=0.02)
    assert max(abs(time - mean) for time in hit) < 0.02 * mean + 1 / 120
    assert math.hypot(place.x - 0.8, place.z) > 0.5  # it was hit


@pytest.mark.parametrize("phase", [0.0, 0.25, 0.4, 0.75])
def test_it_begins_where_its_phase_says(phase):
    scene = Scene()
    with Play(scene) as play:
        pendulum = scene.dynamic.attach(Pendulum((1, 5, 2), yaw=0.7, phase=phase))
        assert pendulum.angle == pytest.approx(AMPLITUDE * math.sin(math.tau * phase), abs=1e-6)
        assert (pendulum.arm.position - (1, 5, 2)).length == pytest.approx(LENGTH)
        before = pendulum.angle
        play.steps(6)
        going = math.copysign(1.0, math.cos(math.tau * phase))
        if abs(math.cos(math.tau * phase)) > 0.1:
            assert (pendulum.angle - before) * going > 0


def test_it_swings_as_wide_as_it_should():
    scene = Scene()
    with Play(scene) as play:
        pendulum = scene.dynamic.attach(Pendulum((0, 5, 0)))
        angles = []
        for _ in range(120 * 8):
            play.steps(1)
            angles.append(pendulum.angle)
        assert max(angles) == pytest.approx(AMPLITUDE, rel=0.03)
        assert min(angles) == pytest.approx(-AMPLITUDE, rel=0.03)


def test_it_goes_on_after_it_was_away():
    scene = Scene()
    with Play(scene) as play:
        pendulum = scene.dynamic.attach(Pendulum((0, 5, 0)))
        play.seconds(3)
        pendulum.leave()
        angle = pendulum.way
        play.seconds(1)
        pendulum.enter()
        assert pendulum.way == angle
        turns = pendulum.turns
        play.seconds(4)
        assert pendulum.turns >= turns + 2
