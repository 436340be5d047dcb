"""osgode's own broad phase leaves sleepers alone: who wakes, who hears, and the same bits again."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from tests.nodes.test_broad_phase import KINDS, awake, both_modes, ground, put, touching


@st.composite
def sleeping_scenes(draw):
    """Things that sleep on the floor and on each other, joints between some, and what happens to them."""
    columns = draw(st.lists(st.integers(1, 4), min_size=1, max_size=4))
    gaps = [draw(st.sampled_from([0.999, 1.0, 1.5])) for _ in columns]
    joints = draw(st.lists(st.tuples(st.integers(0, 15), st.integers(0, 15)), max_size=3))
    blow = draw(st.sampled_from(["ball", "rope", "push", "take", "floor", "teleport", "resize", "disable", "nothing"]))
    target = draw(st.integers(0, 15))
    later = draw(st.sampled_from(["take", "disable", "resize", "teleport", "nothing"]))
    return draw(st.booleans()), columns, gaps, joints, blow, target, later, draw(st.integers(0, 15))


def lay(mode, is_round, columns, gaps, joints):
    world, moving, floor = ground(mode, iterations=500, contacts_per_pair=8, step_size=1 / 240)
    bodies, x = [], 0.0
    for height, gap in zip(columns, gaps, strict=True):
        for k in range(height):
            geom = oo.Sphere(0.5, mass=1.0) if is_round else oo.Box((1, 1, 1), mass=1.0)
            bodies.append(put(moving, (x, 0.4999 + 0.9999 * k, 0), geom, name=f"part {len(bodies)}", enabled=False))
        x += gap
    for one, other in joints:
        a, b = bodies[one % len(bodies)], bodies[other % len(bodies)]
        if a is not b and not set(a.joints) & set(b.joints):
            oo.Ball(a, b, anchor=a.position)
            a.enabled = b.enabled = False
    return world, moving, floor, bodies


def happen(what, scene, target):
    """What may happen to sleepers."""
    _, moving, floor, bodies = scene
    body = bodies[target % len(bodies)]
    if what == "ball":
        put(
            moving,
            body.position + oo.Vec3(0, 0, 0.9),
            oo.Sphere(0.4, mass=0.5),
            linear_velocity=(0, 0, -3),
            name="ball",
        )
    elif what == "rope":
        weight = put(moving, (0, 30, 0), oo.Sphere(0.4, mass=0.5), name="weight")
        oo.Ball(body, weight, anchor=body.position)
    elif what == "push" and body.is_live:
        body.apply_impulse((0.0, 0.0, 0.5))
    elif what == "take" and body.is_live:
        moving.detach(body)
    elif what == "floor":
        floor.parent.detach(floor)
    elif what == "teleport":
        body.position = (0, 50, 0)
    elif what == "resize":
        geom = body.geoms[0]
        if isinstance(geom, oo.Box):
            geom.size = (0.9, 0.9, 0.9)
        else:
            geom.radius = 0.45
    elif what == "disable":
        body.geoms[0].enabled = False


@settings(max_examples=60)
@given(sleeping_scenes())
def test_the_same_bodies_wake_in_the_same_step_and_move_alike(scene):
    """Without auto-disable what wakes stays awake, so the sets agree step by step.

    Positions of balls agree within 1 mm, of boxes within 10 mm: which points ODE takes for two boxes depends on
    which comes first. In the first step after the blow both are in the same state, so the pairs of all that is awake
    after it agree too.
    """
    is_round, columns, gaps, joints, blow, target, later, second = scene
    worlds = []
    for mode in ("own", "ode"):
        world, moving, floor, bodies = lay(mode, is_round, columns, gaps, joints)
        world.step(2)
        happen(blow, (world, moving, floor, bodies), target)
        worlds.append((world, moving, floor, bodies))
    own, ode = (world for world, *_ in worlds)
    for step in range(12):
        assert awake(own) == awake(ode)
        for world, *_ in worlds:
            world.step()
        if step == 0:
            pairs, expected = touching(own), touching(ode)
            assert pairs <= expected
            assert all(pair in pairs for pair in expected if not pair.isdisjoint(awake(ode)))
        if step == 5:
            for each in worlds:
                happen(later, each, second)
        assert np.abs(own.poses - ode.poses).max(initial=0.0) < (1e-3 if is_round else 1e-2)
    assert awake(own) == awake(ode)


@settings(max_examples=40)
@given(sleeping_scenes())
def test_looking_at_all_that_sleeps_in_each_step_would_change_nothing(scene):
    """Where only steps have changed anything, what slept and sleeps isn't looked at: a huge box neither."""
    is_round, columns, gaps, joints, blow, target, later, second = scene

    def course(*, everything):
        each = world, moving, _floor, bodies = lay("own", is_round, columns, gaps, joints)
        world.auto_disable = True
        bodies[0].attach(oo.Placeable(position=(0, 0, 2))).attach(oo.Ray(length=3.0))
        far = put(moving, (0, -1e3, 0), oo.Box((2e6, 1, 2e6), mass=1.0), name="far", enabled=False, kinematic=True)
        put(moving, (300, -1e3, 0), oo.Sphere(0.5, mass=1.0), name="in it", kinematic=True)
        log = []
        for step in range(90):
            if step == 2:
                happen(blow, each, target)
            if step == 40:
                happen(later, each, second)
            if step % 8 == 4:
                far.wake()
            if step % 8 == 6:
                far.enabled = False
            hit = world.cast_ray((0.1, 20, 0.1), (0, -1, 0)) if step % 7 == 3 else None
            if everything:
                world._realm.ptr.edited = 1
            world.step()
            pairs = [(int(row["slot1"]), int(row["slot2"])) for row in world.contacts]
            log.append((pairs, awake(world), world.poses.tobytes(), hit and hit.distance))
        return log

    assert course(everything=False) == course(everything=True)


def asleep_on(mode, support):
    """A box that sleeps on a support: the floor, a static box, a sleeping box; and what takes the support away."""
    world, moving, floor = ground(mode)
    if support == "plane":
        sleeper, below = put(moving, (0, 0.5, 0), name="top", enabled=False), floor
    elif support == "static":
        place = floor.parent.attach(oo.Placeable(position=(0, 1, 0)))
        below = place.attach(oo.Box((1, 1, 1)))
        sleeper = put(moving, (0, 2, 0), name="top", enabled=False)
    else:
        below = put(moving, (0, 0.5, 0), enabled=False)
        sleeper = put(moving, (0, 1.5, 0), name="top", enabled=False)
    world.step(3)
    assert not sleeper.enabled
    return world, sleeper, below


CHANGES_OF_SUPPORT: dict[tuple[str, str], Callable] = {
    ("plane", "detach"): lambda below: below.parent.detach(below),
    ("plane", "offset"): lambda below: setattr(below, "offset", -1.0),
    ("plane", "normal"): lambda below: setattr(below, "normal", (1, 1, 0)),
    ("plane", "enabled"): lambda below: setattr(below, "enabled", False),
    ("plane", "kind"): lambda below: setattr(below, "collides_with", KINDS[0]),
    ("static", "detach"): lambda below: below.parent.detach(below),
    ("static", "detach place"): lambda below: below.parent.parent.detach(below.parent),
    ("static", "position"): lambda below: setattr(below.parent, "position", (5, 0, 0)),
    ("static", "size"): lambda below: setattr(below, "size", (1, 0.5, 1)),
    ("static", "enabled"): lambda below: setattr(below, "enabled", False),
    ("body", "detach"): lambda below: below.parent.detach(below),
    ("body", "position"): lambda below: setattr(below, "position", (5, 0.5, 0)),
    ("body", "rotation"): lambda below: setattr(below, "rotation", oo.Quat.from_axis_angle((1, 0, 0), 0.5)),
    ("body", "part"): lambda below: below.children[0].detach(below.geoms[0]),
    ("body", "size"): lambda below: setattr(below.geoms[0], "size", (1, 0.5, 1)),
    ("body", "enabled"): lambda below: setattr(below.geoms[0], "enabled", False),
    ("body", "moved, then detached"): lambda below: (
        setattr(below, "position", (5, 0.5, 0)),
        below.parent.detach(below),
    ),
}


@pytest.mark.parametrize("mode", ["own", "ode", "own, then ode"])
@pytest.mark.parametrize(("support", "change"), CHANGES_OF_SUPPORT)
def test_what_sleeps_on_something_wakes_when_that_goes_or_changes(support, change, mode):
    """By either way, though osgode's own lists no contact of two that sleep; also just after a switch."""
    world, sleeper, below = asleep_on(mode[:3], support)
    if mode == "own, then ode":
        world.broad_phase = "ode"
    CHANGES_OF_SUPPORT[support, change](below)
    assert sleeper.enabled
    before = sleeper.position
    world.step(20)
    assert (sleeper.position - before).length > 0.01


@pytest.mark.parametrize("mode", ["own", "ode"])
def test_what_only_stands_where_a_sleeper_is_wakes_nobody_when_it_goes(mode):
    """A ghost in the sleeper, a geom in a space that it was not told to collide with, and one that is beside it.

    The last one's box meets the sleeper's, the ball itself does not.
    """
    world, sleeper, floor = asleep_on(mode, "plane")
    other_space = world.attach(oo.SimpleSpace())
    ghost = floor.parent.attach(oo.Placeable(position=(0, 0.5, 0))).attach(oo.Sphere(0.4, collides_with=()))
    apart = other_space.attach(oo.Placeable(position=(0, 0.5, 0))).attach(oo.Sphere(0.4))
    corner = floor.parent.attach(oo.Placeable(position=(0.6, 1.1, 0.6)))
    corner.attach(oo.Sphere(0.15))
    world.step(2)
    ghost.parent.detach(ghost)
    apart.parent.detach(apart)
    corner.parent.detach(corner)
    assert not sleeper.enabled


@pytest.mark.parametrize("mode", ["own", "ode"])
def test_listeners_hear_that_sleepers_still_touch(mode):
    """One begin, then stay in each step without an impulse, since ODE computes no forces for what sleeps."""
    world, moving, _ = ground(mode, auto_disable=True)
    lower, upper = put(moving, (0, 0.5, 0)), put(moving, (0, 1.5, 0))
    heard = []
    upper.on_touch(lambda touch: heard.append((touch.state, touch.other.body is lower, touch.impulse)))
    world.step(200)
    assert not lower.enabled
    assert not upper.enabled
    assert [state for state, *_ in heard] == ["begin"] + ["stay"] * 199
    assert all(is_lower for _, is_lower, _ in heard)
    assert heard[-1][2] == 0.0
    assert heard[5][2] > 0.0
    del heard[:]
    moving.detach(lower)
    world.step()
    assert [state for state, *_ in heard] == ["end"]


def test_a_listened_floor_hears_of_all_that_sleep_on_it_once():
    """Three sleepers, two of them listened themselves: four sides hear one touch each in a step."""
    world, moving, floor = ground("own")
    boxes = [put(moving, (2.0 * i, 0.5, 0), enabled=False) for i in range(3)]
    heard = []
    for listened in (floor, boxes[0], boxes[1]):
        listened.on_touch(lambda touch: heard.append((touch.geom, touch.other)))
    world.step()
    sides = [(floor, box.geoms[0]) for box in boxes] + [(box.geoms[0], floor) for box in boxes[:2]]
    assert len(heard) == 5
    assert set(heard) == set(sides)


def test_contacts_of_what_sleeps_apart_are_not_listed():
    """`world.contacts` has what moves, what that wakes, and what is listened to."""
    world, moving, _ = ground("own")
    for i in range(3):
        put(moving, (5.0 * i, 0.5, 0), name=str(i), enabled=False)
    world.step()
    assert len(world.contacts) == 0
    put(moving, (0, 1.45, 0), oo.Sphere(0.5, mass=1.0), name="ball")
    world.step()
    assert touching(world) == {frozenset(("ball", "0")), frozenset(("0", None))}
    assert awake(world) == ["0", "ball"]
    world.broad_phase = "ode"
    world.step()
    assert frozenset(("1", None)) in touching(world)


def test_a_tower_that_was_struck_asleep_ends_where_odes_way_puts_it():
    """Four boxes and a ball against the uppermost: 5 mm, since the solver takes the contacts in another order."""

    def build(mode):
        world, moving, _ = ground(mode, auto_disable=True, iterations=100)
        for k in range(4):
            put(moving, (0, 0.5 + k, 0), oo.Box((1, 1, 1), mass=20.0), name=f"box {k}", enabled=False)
        world.step(5)
        put(moving, (-2, 3.6, 0), oo.Sphere(0.2, mass=1.0), linear_velocity=(6, 0, 0), name="ball")
        world.step(40)
        return world

    own, ode = both_modes(build)
    assert awake(own) == awake(ode) == ["box 0", "box 1", "box 2", "box 3", "ball"]
    assert np.abs(own.poses[:4] - ode.poses[:4]).max() < 5e-3
    assert own.poses[3, 0] > 1e-4


# -- the same again


def heap():
    """Boxes and balls that fall on each other, and fall asleep."""
    world, moving, _ = ground("own", auto_disable=True)
    bodies = []
    for i in range(25):
        x, layer = 0.8 * (i % 3) + 0.01 * i, i // 3
        geom = oo.Box((0.7, 0.6, 0.7), mass=1.0) if i % 2 else oo.Sphere(0.4, mass=1.0)
        bodies.append(put(moving, (x, 0.6 + 0.9 * layer, 0.03 * (i % 4)), geom, name=str(i)))
    return world, moving, bodies


def test_the_same_course_gives_the_same_bits():
    """Things that fall, sleep, are struck, and go: twice the same."""

    def course():
        world, moving, bodies = heap()
        world.step(150)
        bodies[3].apply_impulse((3, 2, 0))
        world.step(40)
        moving.detach(bodies[7])
        world.step(60)
        moving.attach(bodies[7])
        world.step(60)
        return world.poses.tobytes() + world.velocities.tobytes()

    assert course() == course()


def test_the_order_of_the_contacts_does_not_depend_on_how_things_came_where_they_are():
    """Kinematic bodies are led to the same places by different ways: the same pairs in the same order."""
    places = [(0.9 * (i % 5), 0.9 * (i // 5 % 5), 0.9 * (i // 25)) for i in range(60)]

    def listed(ways):
        world = oo.World(gravity=(0, 0, 0))
        space = world.attach(oo.HashSpace())
        world.collide(space)
        bodies = [put(space, place, oo.Sphere(0.5, mass=1.0), kinematic=True) for place in places]
        fixed = [space.attach(oo.Placeable(position=(x, y, z + 0.4))) for x, y, z in places[::7]]
        for place in fixed:
            place.attach(oo.Box((0.5, 0.5, 0.5)))
        for way in ways:
            for i, body in enumerate(bodies):
                body.position = way(i)
                body.enabled = (i + len(ways)) % 3 > 0
            for i, place in enumerate(fixed):
                place.position = way(3 * i)
            world.step()
        for body, position in zip(bodies, places, strict=True):
            body.position = position
        for place, (x, y, z) in zip(fixed, places[::7], strict=True):
            place.position = (x, y, z + 0.4)
        world.step()
        return [(int(row["slot1"]), int(row["slot2"])) for row in world.contacts]

    straight = listed([])
    assert len(straight) > 100
    assert straight == listed([lambda i: (math.sin(i) * 9, i, 0.0), lambda i: (0.0, 0.0, 5.0 * math.cos(7 * i))])
    assert straight == listed([lambda i: (-i, 0.0, i % 7)] * 5)
