"""The flail: its chain holds together however it is swung."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.examples.game.flail import BALL_MASS, ITERATIONS, LINK_LENGTH, LINKS, THRUST, Flail
from tests.examples.game.bearer import AHEAD, EYE, Range

MOST_STRETCH = 0.005


def swung(seconds, iterations=ITERATIONS):
    """Swing it to and fro and round like somebody who moves the mouse fast; yields its flail after each step.

    The camera turns by up to 7 rad/s, and the hand goes round the eye at up to 4 m/s.
    """
    scene = Range(iterations=iterations)
    flail = scene.give(Flail((0.0, 0.5, 2.0)))
    hand = scene.bearer.hand
    for k in range(round(seconds * 120)):
        t = k / 120
        yaw = 2.2 * math.sin(2.9 * t) + 0.6 * math.sin(0.7 * t)
        turn = oo.Quat.from_yaw_pitch_roll(yaw * min(t, 1.0), 0.44 * math.sin(2.3 * t))
        hand.glide_to(EYE + turn.rotate((0.25, -0.2, -0.4)), turn)
        scene.world.step()
        yield flail


def test_no_link_stretches_by_five_millimetres_in_a_minute():
    worst, fastest = 0.0, 0.0
    for flail in swung(60.0):
        worst = max(worst, flail.stretch)
        fastest = max(fastest, flail.ball.linear_velocity.length)
    assert worst < MOST_STRETCH
    assert fastest > 8.0  # it was swung


def test_swinging_is_the_same_every_time():
    ends = []
    for _ in range(2):
        for flail in swung(3.0):
            end = [(*body.position, *body.rotation) for body in flail.bodies]
        ends.append(np.array(end))
    assert np.array_equal(*ends)


def test_it_is_a_chain_of_capsules_on_universal_joints_with_a_ball_at_the_end():
    flail = Flail()
    assert [type(geom) for geom in flail.geoms] == [oo.Capsule] * (1 + LINKS) + [oo.Sphere]
    assert all(isinstance(knot, oo.Universal) for knot in flail.knots)
    order = [flail.main_body, *flail.links, flail.ball]
    pairs = [(knot.body1, knot.body2) for knot in flail.knots]
    assert pairs == list(zip(order[1:], order[:-1], strict=True))


def test_at_rest_it_hangs_down_from_the_handle():
    scene = Range(iterations=ITERATIONS)
    flail = scene.give(Flail((0.0, 0.5, 2.0)))
    scene.world.run(seconds=8.0)
    top = flail.knots[0].anchor
    below = top - flail.ball.position
    assert math.hypot(below.x, below.z) < 0.02
    assert below.y == pytest.approx(LINKS * LINK_LENGTH, abs=0.01)
    assert flail.ball.linear_velocity.length < 0.05


def test_it_lies_on_the_ground_and_comes_to_rest():
    scene = Range(bearer=False, iterations=ITERATIONS, auto_disable=True)
    flail = scene.moving.attach(Flail((0.0, 0.3, 0.0)))
    scene.world.run(seconds=6.0)
    assert all(0.0 < body.position.y < 0.15 for body in flail.bodies)
    assert max(body.linear_velocity.length for body in flail.bodies) < 0.05
    assert flail.stretch < MOST_STRETCH


def test_its_ball_knocks_things_over():
    """A crate that stands to the left, and a turn of the camera by half a circle in half a second."""
    scene = Range(iterations=ITERATIONS)
    flail = scene.give(Flail((0.0, 0.5, 2.0)))
    hand = scene.bearer.hand
    scene.world.run(seconds=3.0)
    crate = scene.crate((-1.9, 0.9, -0.2), size=1.8, mass=4.0)
    worst = 0.0
    for k in range(240):
        turn = oo.Quat.from_yaw_pitch_roll(min(k / 20, 3.0), 0.3 * min(k / 20, 1.0))
        hand.glide_to(EYE + turn.rotate((0.25, -0.2, -0.4)), turn)
        scene.world.step()
        worst = max(worst, flail.stretch)
    assert crate.position.distance((-1.9, 0.9, -0.2)) > 0.1
    assert worst < 0.05  # a blow shakes it more than swinging does
    scene.world.run(seconds=0.5)
    assert flail.stretch < MOST_STRETCH


def test_a_thrust_pushes_the_ball_ahead_and_the_hand_back():
    scene = Range(ground=False, kinematic=False, gravity=(0, 0, 0), iterations=ITERATIONS)
    flail = scene.give(Flail((0.0, 0.5, 2.0)))
    flail.fire("left", 1.0, (EYE, oo.Vec3(0.0, -1.0, -1.0)))
    assert flail.ball.linear_velocity.length == pytest.approx(THRUST / BALL_MASS)
    assert flail.ball.linear_velocity.dot(AHEAD) > 0.5 * THRUST / BALL_MASS
    scene.world.step(12)
    total = sum((body.momentum for body in (*flail.bodies, scene.bearer.hand)), oo.Vec3(0.0, 0.0, 0.0))
    assert total.length < 0.02 * THRUST
