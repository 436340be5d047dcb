"""What kinematic bodies do to others as they glide: carry, push, pull along and wake them."""

import math

import pytest

import osgode as oo
from tests.nodes.test_glide import STEP, crate, near, stage

GRAVITY = 9.81
FRICTION = 0.5
"""That of the World's fallback for two things of the default material."""


def test_a_platform_carries_a_box_by_friction():
    """It slips only until it has the platform's speed, v^2 / (2 mu g) = 2.5 cm, and as far on when that stops."""
    world, space, platform = stage()
    box = crate(space, (0, 0.25, 0))
    world.run(0.5)
    speed, start = 0.5, box.position
    slip = speed**2 / (2 * FRICTION * GRAVITY)
    platform.glide_to((2, -0.1, 0), seconds=2 / speed)
    farthest = 0.0
    for _ in range(round(2 / speed / STEP)):
        world.step()
        farthest = max(farthest, abs(box.position.x - start.x - platform.position.x))
    assert slip / 2 < farthest < 0.05
    assert box.linear_velocity.x == pytest.approx(speed, abs=0.05)
    world.run(1.0)
    assert box.position.x - start.x == pytest.approx(2.0, abs=0.05)
    assert abs(box.position.z) < 0.01
    stands = box.position
    world.run(1.0)
    assert box.position.distance(stands) < 2e-3


def test_a_lift_carries_a_stack_up_and_down():
    """When it starts or stops suddenly the stack may be in the air by v^2 / (2 g), and never sinks in."""
    world, space, platform = stage(iterations=50)
    stack = [crate(space, (0, 0.25 + 0.5 * k, 0)) for k in range(3)]
    world.run(0.5)
    speed = 0.5
    air = speed**2 / (2 * GRAVITY) + 0.02
    for height in (3.0, 0.0):
        platform.glide_to((0, height - 0.1, 0), seconds=3 / speed)
        for _ in range(round(3 / speed / STEP)):
            world.step()
            top = platform.position.y + 0.1
            for k, box in enumerate(stack):
                assert -0.02 < box.position.y - top - 0.25 - 0.5 * k < air
        world.run(1.0)
        for k, box in enumerate(stack):
            assert box.position.y - height == pytest.approx(0.25 + 0.5 * k, abs=0.01)
            assert math.hypot(box.position.x, box.position.z) < 0.02


def test_a_turning_platform_carries_a_rider_round():
    """At r = 1 m and 0.5 rad/s friction holds it (w^2 r < mu g); half a turn takes it to the other side, turned."""
    world, space, platform = stage()
    rider = crate(space, (1, 0.25, 0))
    world.run(0.5)
    rate = 0.5
    slip = rate**2 / (2 * FRICTION * GRAVITY)  # of the speed w r when it starts and when it stops
    for half in (1, 2):
        platform.glide_to(rotation=oo.Quat.from_axis_angle((0, 1, 0), half * math.pi * 0.999), seconds=math.pi / rate)
        world.run(math.pi / rate)
        world.run(0.5)
        assert rider.position.x == pytest.approx((-1) ** half, abs=0.05 + slip)
        assert abs(rider.position.z) < 0.1
        facing = rider.vector_to_world((1, 0, 0))
        assert facing.x == pytest.approx((-1) ** half, abs=0.05)


def test_a_wall_pushes_boxes_at_its_speed():
    """Then they slide on by v^2 / (2 mu g)."""
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane())
    wall = space.attach(oo.Body(position=(-2, 1, 0), kinematic=True))
    wall.attach(oo.Placeable()).attach(oo.Box((0.2, 2, 4)))
    boxes = [crate(space, (-1, 0.25, z)) for z in (-1, 0, 1)]
    speed = 1.0
    wall.glide_to((1, 1, 0), seconds=3.0 / speed)
    world.run(2.5)
    for box in boxes:
        assert box.linear_velocity.x == pytest.approx(speed, abs=0.1)
        assert box.position.x - wall.position.x == pytest.approx(0.35, abs=0.02)
    world.run(1.5)
    for box in boxes:
        on = speed**2 / (2 * FRICTION * GRAVITY)
        assert box.position.x == pytest.approx(1.35 + on, abs=0.05)
        assert box.linear_velocity.length < 0.01


def test_a_joint_holds_on_to_it():
    """A pendulum hangs from it: the anchor goes along to the millimetre, and the bob follows."""
    world = oo.World(solver="exact")
    trolley = world.attach(oo.Body(position=(0, 3, 0), kinematic=True))
    bob = world.attach(oo.Body(position=(0, 2, 0)))
    bob.attach(oo.Placeable()).attach(oo.Sphere(0.1, mass=1.0))
    joint = oo.Ball(bob, trolley, anchor=(0, 3, 0))
    turn = oo.Quat.from_axis_angle((0, 1, 0), 2.0)
    trolley.glide_to((4, 4, 0), turn, seconds=4.0)
    for _ in range(480):
        world.step()
        assert joint.error < 1e-3
    assert joint.anchor2 == near((4, 4, 0))
    assert joint.anchor == near((4, 4, 0), 1e-3)
    assert bob.position.distance((4, 4, 0)) == pytest.approx(1.0, abs=0.01)


def test_it_wakes_what_sleeps_on_it():
    world, space, platform = stage(auto_disable=True)
    box = crate(space, (0, 0.25, 0))
    world.run(2.0)
    assert box.asleep
    platform.enabled = False
    platform.glide_to((1, -0.1, 0), seconds=2.0)
    assert not platform.asleep
    world.step()
    assert not box.asleep
    world.run(2.0)
    assert box.position.x == pytest.approx(1.0, abs=0.05)


def test_a_slow_platform_does_not_fall_asleep_on_its_way():
    """Slower than what counts as resting."""
    world, space, platform = stage(auto_disable=True, auto_disable_linear_threshold=0.5)
    box = crate(space, (0, 0.25, 0))
    platform.glide_to((0.1, -0.1, 0), seconds=2.0)
    world.run(1.0)
    assert platform.position.x == pytest.approx(0.05)
    world.run(1.0)
    assert platform.position == near((0.1, -0.1, 0))
    assert box.position.x == pytest.approx(0.1, abs=0.02)
