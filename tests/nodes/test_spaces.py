"""Spaces: every kind finds the same pairs, alone, nested and across; and their limits."""

import itertools
import math
import random

import numpy as np
import pytest

import osgode as oo
from osgode.native import lib

KINDS = [oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace]


def scatter(seed, count=24):
    """Boxes and balls, some static, some touching, one far away."""
    draw = random.Random(seed)
    for i in range(count):
        place = [draw.uniform(-1.8, 1.8) for _ in range(3)]
        if i == 0:
            place = [500.0, 0.0, 0.0]
        geom = oo.Box([draw.uniform(0.2, 2) for _ in range(3)], name=str(i))
        if i % 3 == 0:
            geom = oo.Sphere(draw.uniform(0.2, 1), name=str(i))
        turn = oo.Quat.from_axis_angle((1, i, 2), i)
        if i % 4 == 0:
            node = oo.Placeable(position=place, rotation=turn)
            node.attach(geom)
        else:
            node = oo.Body(position=place, rotation=turn)
            node.attach(oo.Placeable()).attach(geom)
        yield node


def pairs(world):
    """The names of the geoms that touch in the next step."""
    world.step()
    return {frozenset(world.geom_of_slot(row[slot]).name for slot in ("slot1", "slot2")) for row in world.contacts}


def expected(seed, keep=lambda a, b: True):
    """Every pair tested, each in a World with nothing else."""
    found = set()
    for i, j in itertools.combinations(range(24), 2):
        if not keep(i, j):
            continue
        world = oo.World(gravity=(0, 0, 0))
        space = world.attach(oo.SimpleSpace())
        world.collide(space)
        for k, node in enumerate(scatter(seed)):
            if k in (i, j):
                space.attach(node)
        found |= pairs(world)
    return found


@pytest.fixture(scope="module")
def all_pairs():
    return {seed: expected(seed) for seed in (1, 2)}


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_space_finds_all_pairs(kind, seed, all_pairs):
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(kind())
    world.collide(space)
    for node in scatter(seed):
        space.attach(node)
    assert pairs(world) == all_pairs[seed]
    assert len(all_pairs[seed]) > 20


@pytest.mark.parametrize(("one", "other"), list(itertools.product(KINDS, repeat=2)))
def test_every_kind_finds_all_pairs_across_to_every_other(one, other, all_pairs):
    """And those only."""
    world = oo.World(gravity=(0, 0, 0))
    first, second = world.attach(one()), world.attach(other())
    world.collide(first, second)
    for i, node in enumerate(scatter(1)):
        (first if i % 2 else second).attach(node)
    assert pairs(world) == {pair for pair in all_pairs[1] if len({int(name) % 2 for name in pair}) == 2}


@pytest.mark.parametrize(("outer", "inner"), list(itertools.product(KINDS, repeat=2)))
def test_a_nested_space_belongs_to_the_one_around_it(outer, inner, all_pairs):
    """Pairs inside the inner one, inside the outer one, and between both, each once."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(outer())
    low, deep = space.attach(inner()), space.attach(oo.SimpleSpace()).attach(inner())
    world.collide(space)
    world.collide(low)  # declared twice, done once
    for i, node in enumerate(scatter(1)):
        (deep, low, space)[i % 3].attach(node)
    assert pairs(world) == all_pairs[1]
    slots = [tuple(sorted((int(row["slot1"]), int(row["slot2"])))) for row in world.contacts]
    runs = [key for key, _ in itertools.groupby(slots)]
    assert len(runs) == len(set(runs))


@pytest.mark.parametrize(("one", "other"), list(itertools.product(KINDS, repeat=2)))
def test_things_can_move_from_any_kind_to_any_other(one, other, all_pairs):
    """Then the pairs are found there; the emptied space can go."""
    world = oo.World(gravity=(0, 0, 0))
    first, second = world.attach(one()), world.attach(other())
    for space in (first, second):
        world.collide(space)
    nodes = [first.attach(node) for node in scatter(1)]
    assert pairs(world) == all_pairs[1]
    for node in nodes:
        node.move_to(second)
    world.detach(first)
    geoms = [geom for node in nodes for geom in node.walk() if isinstance(geom, oo.Geom)]
    assert all(lib.dSpaceQuery(second._id, geom._id) for geom in geoms)
    assert lib.dSpaceGetNumGeoms(second._id) == len(geoms) == 24
    for node, fresh in zip(nodes, scatter(1), strict=True):
        node.position, node.rotation = fresh.position, fresh.rotation
    assert pairs(world) == all_pairs[1]


@pytest.mark.parametrize("outer", KINDS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_space_that_entered_before_its_parts_home_can_go_first(kind, outer):
    """Whatever the order in which spaces and geoms were made, dropping the World frees them without an assert."""
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    geoms = [space.attach(oo.Sphere()) for _ in range(20)]
    inner = world.attach(oo.HashSpace())
    late = world.attach(kind())
    for geom in geoms[:10]:
        geom.move_to(late)
    later = world.attach(outer())
    for node in (inner, late, *geoms[10:]):
        node.move_to(later)
    world.collide(later)
    world.step(2)
    del world, space, inner, late, later, node, geom
    assert not any(geom.is_live for geom in geoms)


@pytest.mark.parametrize(("one", "other"), list(itertools.product(KINDS, repeat=2)))
@pytest.mark.parametrize("moved", ["plane", "static", "asleep", "space"])
def test_what_stands_still_can_move_to_another_space(moved, one, other):
    """ODE takes it for granted that what is added to a space has just moved; and aborts if it hasn't."""
    world = oo.World(gravity=(0, 0, 0), erp=0.0)
    first, second = world.attach(one()), world.attach(other())
    for space in (first, second):
        world.collide(space)
    ball = second.attach(oo.Body(position=(0, 0.49, 0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    late = second.attach(oo.Box(name="late"))
    if moved == "space":
        node = first.attach(oo.SimpleSpace())
        node.attach(oo.Plane())
    elif moved == "asleep":
        node = first.attach(oo.Body(enabled=False))
        node.attach(oo.Placeable(position=(0, -0.5, 0))).attach(oo.Box((3, 1, 3)))
    else:
        node = first.attach(oo.Plane() if moved == "plane" else oo.Box((3, 0.1, 3)))
    world.step()
    second.detach(late)
    node.move_to(second)
    world.step(3)
    assert len(world.contacts) > 0
    node.move_to(first)
    world.step(3)
    assert len(world.contacts) == 0
    node.move_to(second)
    node.move_to(first)
    node.move_to(second)
    ball.position = (0, 0.4, 0)
    world.step()
    assert len(world.contacts) > 0


# -- what collides is told to the World


def test_only_what_was_declared_collides(all_pairs):
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    for node in scatter(1):
        space.attach(node)
    assert pairs(world) == set()
    world.collide(space)
    assert pairs(world) == all_pairs[1]
    world.stop_colliding(space)
    assert pairs(world) == set()
    world.stop_colliding(space)
    assert world.collided == ()


def test_a_pair_of_spaces_is_declared_once_either_way_round():
    world = oo.World()
    a, b = world.attach(oo.SimpleSpace()), world.attach(oo.HashSpace())
    for pair in ((a, b), (b, a), (a, None), (a, None)):
        world.collide(*pair)
    assert world.collided == ((a, b), (a, None))
    world.stop_colliding(b, a)
    assert world.collided == ((a, None),)


def test_a_space_outside_is_left_out_until_it_comes_back():
    world = oo.World(gravity=(0, 0, 0))
    space = oo.SimpleSpace()
    world.collide(space)
    world.step()
    world.attach(space)
    for _ in range(2):
        space.attach(oo.Body()).attach(oo.Placeable()).attach(oo.Sphere(name=str(len(space.children))))
    assert len(pairs(world)) == 1
    world.detach(space)
    assert pairs(world) == set()
    oo.World().attach(space)
    assert pairs(world) == set()


@pytest.mark.parametrize("odd", [None, 5, "space", oo.Body()], ids=str)
def test_only_spaces_collide(odd):
    world = oo.World(name="it")
    space = world.attach(oo.SimpleSpace())
    with pytest.raises(oo.TreeError, match=r"World 'it'\.collide\(\).*no Space"):
        world.collide(odd)
    if odd is not None:
        with pytest.raises(oo.TreeError, match="no Space"):
            world.collide(space, odd)
    assert world.collided == ()


def test_a_space_does_not_collide_with_what_is_in_it():
    world = oo.World()
    outer = world.attach(oo.SimpleSpace(name="outer"))
    inner = outer.attach(oo.SimpleSpace(name="inner"))
    for pair in ((outer, inner), (inner, outer), (outer, outer)):
        with pytest.raises(oo.TreeError, match="one is in the other"):
            world.collide(*pair)
    apart = world.attach(oo.SimpleSpace(name="apart"))
    world.collide(outer, apart)
    apart.move_to(inner)
    with pytest.raises(oo.TreeError, match=r"'apart'.*one is in the other"):
        world.step()
    apart.move_to(world)
    world.step()


def test_a_world_of_spaces_that_collide_nowhere_is_warned_of_once(caplog):
    world = oo.World(name="it")
    world.attach(oo.SimpleSpace())
    world.step(2)
    world.step(2)
    assert caplog.text.count("World 'it' has spaces but was told to collide none") == 1


# -- limits


@pytest.mark.parametrize("kind", KINDS)
def test_the_ends_of_the_world_can_be_reached(kind):
    """At the limit of positions, 1e8 m, every kind of space still finds what touches and nothing aborts."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(kind())
    world.collide(space)
    for corner in itertools.product((1 - 1e8, 1e8 - 1), repeat=3):
        for k in (0.0, 0.5):
            x, y, z = corner
            body = space.attach(oo.Body(position=(x - math.copysign(k, x), y, z)))
            body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    space.attach(oo.Placeable()).attach(oo.Box((1e7, 1, 1)))
    world.step()
    assert len(world.contacts) == 8


@pytest.mark.parametrize("kind", KINDS)
def test_parts_far_from_a_body_at_the_end_of_the_world_are_still_counted(kind):
    """ODE's hash space aborts where it can't count cells; no geom gets there while bodies and offsets are allowed."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(kind(**({"levels": (-3, 3)} if kind is oo.HashSpace else {})))
    world.collide(space)
    turn = oo.Quat.between((1, 1, 1), (1, 0, 0))
    for sign in (-1, 1):
        body = space.attach(
            oo.Body(position=(sign * 1e8, 0, 0), rotation=turn, name="far", linear_velocity=(1e9, 0, 0))
        )
        for end in (-2.5e7, 2.5e7):
            body.attach(oo.Placeable(position=(end, end, end))).attach(oo.Sphere(0.05, mass=0))
        body.attach(oo.Placeable(position=(-sign * 2.5e7,) * 3)).attach(oo.Sphere(0.05, mass=1e3))
        body.children[0].attach(oo.Box((1e7, 1e7, 1e7), mass=0))
    with pytest.raises(oo.PhysicsError, match="Body 'far'"):
        world.step(20)
    for body in world.bodies:
        body.position = body.linear_velocity = (0, 0, 0)
    world.step()
    with pytest.raises(oo.FieldError, match=r"Placeable\.position"):
        oo.Placeable(position=(3e7, 0, 0))
    with pytest.raises(oo.FieldError, match=r"Mass\.centre"):
        oo.Mass(1.0, (0, 3e7, 0))


def test_levels_of_a_hash_space_reach_ode():
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace(levels=(-3, -3)))
    world.collide(space)
    for size in (0.01, 1, 100, 1e5, 1e7):
        body = space.attach(oo.Body())
        body.attach(oo.Placeable()).attach(oo.Box((size, size, size), mass=1e6))
    world.step()
    assert len({frozenset((int(r["slot1"]), int(r["slot2"]))) for r in world.contacts}) == 10


def test_a_quadtree_holds_what_is_outside_of_it_too():
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.QuadTreeSpace(extent=(1, 1, 1), depth=8))
    world.collide(space)
    for x in (0.0, 0.5, 1000.0, 1000.5):
        space.attach(oo.Body(position=(x, 0, 0))).attach(oo.Placeable()).attach(oo.Sphere(0.5))
    world.step()
    assert np.allclose(np.abs(world.contacts["geom"]["normal"][:, 0]), 1.0)
    assert len(world.contacts) == 2


@pytest.mark.parametrize("axes", ["".join(axes) for axes in itertools.permutations("xyz")])
def test_sweep_and_prune_takes_its_axes_in_any_order(axes, all_pairs):
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.SweepAndPruneSpace(axes=axes))
    world.collide(space)
    for node in scatter(1):
        space.attach(node)
    assert pairs(world) == all_pairs[1]
