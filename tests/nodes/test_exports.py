"""What a World tells in bulk, against what its nodes tell one by one."""

import math
import time

import numpy as np
import pytest

import osgode as oo
from osgode.native import lib


def full_world():
    """A little of everything: things that fall, sleep, stand still, glide, look, feel."""
    scene = oo.World()
    space = scene.attach(oo.HashSpace())
    scene.collide(space)
    space.attach(oo.Plane())
    for k in range(4):
        body = space.attach(oo.Body(position=(2.0 * k, 3.0 + k, 0)))
        body.attach(oo.Placeable(position=(0.25 * k, 0, 0))).attach(oo.Box((1, 0.5, 0.25)))
    scene.bodies[1].enabled = False
    scene.bodies[2].kinematic = True
    scene.bodies[3].attach(oo.Placeable(position=(0, 1, 0))).attach(oo.Sphere(0.2, sensor=True, mass=0))
    space.attach(oo.Placeable(position=(0, 9, 0))).attach(oo.Ray(3.0))
    space.attach(oo.Placeable(position=(5, 0, 0))).attach(oo.Capsule(0.3, 1.0, enabled=False))
    return scene


def geoms(world):
    return [node for node in world.walk() if isinstance(node, oo.Geom)]


def test_timings_before_the_first_step_are_nothing():
    world = full_world()
    assert world.timings == oo.StepTimings()


@pytest.mark.parametrize("steps", [1, 7])
def test_timings_are_those_of_the_last_call(steps):
    """All phases took some time, together no more than the whole, and the earlier call is forgotten."""
    world = full_world()
    world.step(50)
    world.step(steps)
    timings = world.timings
    assert timings.steps == steps
    assert all(part > 0.0 for part in timings[:4])
    assert timings.total == pytest.approx(sum(timings[:5]))
    world.step(0)
    assert world.timings.steps == 0
    assert world.timings[:4] == (0.0,) * 4


@pytest.mark.parametrize("hook", ["on_touch", "on_collide"])
def test_time_in_listeners_is_theirs(hook):
    """Where somebody dawdles in Python it is seen there, in the middle of a step or after it."""
    world = full_world()
    world.bodies[0].position = (0, 0.2, 0)
    world.step()
    getattr(world.bodies[0], hook)(lambda _: time.sleep(0.02))
    world.step()
    timings = world.timings
    assert timings.listeners >= 0.02
    assert timings.steps == 1
    assert timings.total == pytest.approx(sum(timings[:5]))


def test_a_step_that_fails_has_taken_time_too():
    """What is told is of that call: steps that weren't done don't count."""
    world = full_world()
    world.step(3)
    world.bodies[0].on_touch(lambda _: 1 / 0)
    world.bodies[0].position = (0, 0.2, 0)
    with pytest.raises(ZeroDivisionError):
        world.step(5)
    assert world.timings.steps == 1


def test_body_states_are_what_bodies_say():
    world = full_world()
    world.step(10)
    rows = world.body_states
    assert len(rows) == len(world.bodies) == 4
    for row, body in zip(rows, world.bodies, strict=True):
        assert tuple(row["com"]) == body.centre_of_mass
        assert bool(row["asleep"]) == body.asleep
        assert bool(row["kinematic"]) == body.kinematic
    assert rows["asleep"].tolist() == [0, 1, 0, 0]
    assert rows["kinematic"].tolist() == [0, 0, 1, 0]
    assert rows["com"][3, 0] == pytest.approx(0.75)


def test_geom_states_are_what_geoms_say():
    world = full_world()
    world.step(10)
    rows = world.geom_states
    found = geoms(world)
    for geom in found:
        row = rows[geom._slot]
        assert (tuple(row["low"]), tuple(row["high"])) == geom.bounds
        assert bool(row["enabled"]) == geom.enabled
        assert bool(row["flags"] & lib.OO_SENSOR) == geom.sensor
        assert bool(row["flags"] & lib.OO_IS_RAY) == isinstance(geom, oo.Ray)
    alive = [world.geom_of_slot(slot) for slot in np.flatnonzero(rows["flags"] & lib.OO_ALIVE).tolist()]
    assert {node for node in alive if isinstance(node, oo.Geom)} == set(found)


def test_geom_states_follow_a_turn():
    """The box of a turned box: half of |R| @ size to each side of the middle."""
    world = full_world()
    body = world.bodies[0]
    body.rotation = oo.Quat.from_axis_angle((0, 0, 1), math.pi / 6)
    row = world.geom_states[body.children[0].children[0]._slot]
    c, s = math.cos(math.pi / 6), 0.5
    half = np.array([c * 1 + s * 0.5, s * 1 + c * 0.5, 0.25]) / 2
    assert np.allclose(row["high"] - row["low"], 2 * half)
    assert np.allclose((row["high"] + row["low"]) / 2, body.position)


def test_looking_at_boxes_changes_nothing():
    """A World that is looked at after each step goes on with the same bits as one that isn't."""
    results = []
    for looks in (False, True):
        for broad_phase in ("own", "ode"):
            world = oo.World(broad_phase=broad_phase)
            space = world.attach(oo.HashSpace())
            world.collide(space)
            space.attach(oo.Plane())
            for k in range(12):
                body = space.attach(oo.Body(position=(0.3 * (k % 3), 0.6 + 0.9 * k, 0.2 * (k % 2))))
                body.attach(oo.Placeable()).attach(oo.Box((0.8, 0.8, 0.8)))
            for _ in range(120):
                world.step()
                if looks:
                    world.geom_states, world.body_states  # noqa: B018 - to look is all
            results.append(world.poses.tobytes())
    assert results[:2] == results[2:]


def test_slots_of_what_is_gone_are_empty():
    world = full_world()
    geom = geoms(world)[-1]
    slot = geom._slot
    geom.parent.detach(geom)
    row = world.geom_states[slot]
    assert row["flags"] == 0
    assert (row["low"] == 0).all()
