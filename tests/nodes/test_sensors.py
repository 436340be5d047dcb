"""What sensors see, and what is told to touch."""

import pytest

import osgode as oo
from tests.nodes.test_feedback import BROAD, two_balls
from tests.nodes.test_touch import Ground


@BROAD
def test_bodies_pass_a_sensor_that_reports_them(broad):
    world = oo.World(gravity=(0, 0, 0), step_size=0.01, broad_phase=broad)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    gate = space.attach(oo.Placeable()).attach(oo.Box((0.2, 2, 2), sensor=True, name="gate"))
    body = space.attach(oo.Body(position=(-1, 0, 0), linear_velocity=(2, 0, 0)))
    ball = body.attach(oo.Placeable()).attach(oo.Sphere(0.25))
    states, inside = [], []
    gate.on_touch(lambda touch: states.append(touch.state))
    for _ in range(100):
        world.step()
        inside.append(gate.touching == (ball,))
    assert body.linear_velocity == (2, 0, 0)
    assert (states[0], states[-1]) == ("begin", "end")
    assert set(states[1:-1]) == {"stay"}
    # the ball, 0.5 m long, passes 0.2 m at 2 m/s: 0.35 s
    assert len(states) - 1 == sum(inside) == pytest.approx(35, abs=1)
    assert ball.touching == ()


@BROAD
def test_a_sensor_sees_who_sleeps_in_it(broad):
    ground = Ground(auto_disable=True, broad_phase=broad)
    body = ground.drop(oo.Box((1, 1, 1)))
    ground.world.run(3)
    assert not body.enabled
    zone = ground.space.attach(oo.Placeable(position=(0, 0.5, 0))).attach(oo.Sphere(0.3, sensor=True))
    states = []
    zone.on_touch(lambda touch: states.append((touch.state, touch.impulse)))
    ground.world.step(3)
    assert not body.enabled
    assert states == [("begin", 0), ("stay", 0), ("stay", 0)]
    assert zone.touching == (body.geoms[0],)


def test_a_sensor_on_a_body_and_two_sensors():
    world, _, left, right = two_balls()
    left.geoms[0].sensor = right.geoms[0].sensor = True
    heard = []
    left.on_touch(lambda touch: heard.append(touch.impulse))
    world.step(3)
    assert heard == [0, 0, 0]
    assert left.linear_velocity == (2, 0, 0)
    left.geoms[0].sensor = False
    world.step(2)
    assert left.linear_velocity == (2, 0, 0)
    right.geoms[0].sensor = False
    world.step()
    assert left.linear_velocity.x < 1


def test_what_lies_on_something_falls_when_that_becomes_a_sensor():
    ground = Ground("box", auto_disable=True)
    body = ground.drop(oo.Box((1, 1, 1)))
    ground.world.run(3)
    assert not body.enabled
    ground.floor.sensor = True
    ground.world.run(0.5)
    assert body.position.y < 0


def test_a_sensor_may_refuse_and_then_sees_nothing():
    world, _, left, _ = two_balls()
    left.geoms[0].sensor = True
    left.on_collide(lambda feedback: feedback.refuse())
    world.step()
    assert left.geoms[0].touching == ()


def test_touching_needs_a_world_and_forgets_who_left():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    geom = body.geoms[0]
    assert geom.touching == ()
    ground.world.step()
    assert geom.touching == (ground.floor,)
    ground.space.detach(ground.floor)
    assert geom.touching == ()
    ground.space.detach(body)
    with pytest.raises(oo.StateError, match="touching"):
        _ = geom.touching


@BROAD
def test_what_sleeps_still_touches_and_presses_nothing(broad):
    """No solver looks at it, so no force is made up from an earlier step."""
    ground = Ground(auto_disable=True, broad_phase=broad)
    body = ground.drop(oo.Box((1, 1, 1), mass=2))
    body.on_touch(ground.hear)
    ground.world.run(3)
    assert not body.enabled
    ground.heard.clear()
    ground.world.step(2)
    assert [(touch.state, touch.impulse) for touch in ground.heard] == [("stay", 0), ("stay", 0)]
