"""osgode's own broad phase against ODE's: the same pairs touch."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from tests.strategies import CUBE, rotations

SPACES = (oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace)
KINDS = ("broad-red", "broad-blue")
for name in KINDS:
    oo.define_kind(name)


def rows_by_pair(world):
    """The contacts of the last step by the names of the geoms, then by which came first: the rows without repeats.

    Two declared pairs of spaces may both have them, one in each order, which only ODE's way finds.
    """
    found = {}
    for row in world.contacts:
        first, second = (world.geom_of_slot(int(row[slot])).name for slot in ("slot1", "slot2"))
        geom = row["geom"]
        contact = (*geom["pos"][:3].tolist(), *geom["normal"][:3].tolist(), float(geom["depth"]))
        contacts = found.setdefault(frozenset((first, second)), {}).setdefault((first, second), [])
        if contact not in contacts:
            contacts.append(contact)
    return found


# -- all awake: any world, any changes of it

LENGTHS = st.sampled_from([1e-3, 0.2, 0.5, 1.0, 3.0, 1000.0, 2e6])
CENTRES = st.sampled_from([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1e7, 0.0, 0.0), (-1e7, 1e7, 1e7), (3e3, -2e3, 0.0)])
STEPS = st.integers(-6, 6).map(lambda n: n * 0.5)


@st.composite
def places(draw):
    """Near one of a few points, on a grid or off it: so that boxes touch exactly, overlap, and lie apart."""
    centre = draw(CENTRES)
    wobble = draw(st.sampled_from([0.0, 0.037, 1e-9]))
    return tuple(c + draw(STEPS) + wobble for c in centre)


@st.composite
def shapes(draw):
    """What makes a geom: a class, its arguments, and its fields."""
    fields = {
        "kind": draw(st.sampled_from(["default", *KINDS])),
        "collides_with": draw(st.sampled_from([None, None, ("default",), ("default", KINDS[0]), KINDS])),
        "enabled": draw(st.sampled_from([True, True, True, False])),
    }
    kind = draw(st.sampled_from(["box", "sphere", "capsule", "cylinder", "mesh"]))
    if kind == "box":
        return oo.Box, ((draw(LENGTHS), draw(LENGTHS), draw(LENGTHS)),), fields
    if kind == "sphere":
        return oo.Sphere, (draw(LENGTHS),), fields
    if kind == "mesh":
        return oo.Trimesh, (CUBE,), fields
    return (oo.Capsule if kind == "capsule" else oo.Cylinder), (draw(LENGTHS), draw(LENGTHS)), fields


def first_geom(thing):
    return thing if isinstance(thing, oo.Geom) else next(node for node in thing.walk() if isinstance(node, oo.Geom))


class Twin:
    """One of several worlds to which the same is done."""

    def __init__(self, mode, space_plan, pairs):
        self.world = oo.World(gravity=(0, 0, 0), broad_phase=mode, contacts_per_pair=8, refine_contacts=False)
        self.spaces = []
        for cls, above in space_plan:
            parent = self.spaces[above % len(self.spaces)] if above is not None and self.spaces else self.world
            self.spaces.append(parent.attach(cls()))
        for one, other in pairs:
            self.collide(one, other)
        self.things = []
        self.joints = []
        self.count = 0

    def space(self, index):
        return self.spaces[index % len(self.spaces)]

    def collide(self, one, other):
        try:
            self.world.collide(self.space(one), None if other is None else self.space(other))
        except oo.TreeError:
            assert other is not None  # one was in the other

    def stop(self, index):
        declared = self.world.collided
        if declared:
            self.world.stop_colliding(*declared[index % len(declared)])

    def add(self, space, place, rotation, parts, static):
        """A kinematic body, which nothing moves, or static geometry."""
        if static:
            top = oo.Placeable(position=place, rotation=rotation)
            holders = [top] * len(parts)
        else:
            top = oo.Body(position=place, rotation=rotation, kinematic=True)
            holders = [top.attach(oo.Placeable(position=(0.4 * i, 0, 0))) for i in range(len(parts))]
        for holder, (cls, arguments, fields) in zip(holders, parts, strict=True):
            self.count += 1
            holder.attach(cls(*arguments, name=f"geom {self.count}", mass=1.0, **fields))
        self.space(space).attach(top)
        self.things.append((top, self.space(space)))

    def add_plane(self, space, normal, offset):
        self.count += 1
        plane = self.space(space).attach(oo.Plane(normal=normal, offset=offset, name=f"geom {self.count}"))
        self.things.append((plane, self.space(space)))

    def change(self, how, index, value):
        if self.things:
            thing, home = self.things[index % len(self.things)]
            getattr(self, how)(thing, home, value)

    def leave(self, thing, _home, _value):
        if thing.is_live:
            thing.parent.detach(thing)

    def come_back(self, thing, home, _value):
        if not thing.is_live:
            home.attach(thing)

    def house(self, thing, _home, value):
        if thing.is_live:
            thing.move_to(self.space(int(value[0])))

    def switch(self, thing, _home, _value):
        geom = first_geom(thing)
        geom.enabled = not geom.enabled

    def mark(self, thing, _home, _value):
        first_geom(thing).kind = KINDS[0]

    def move(self, thing, _home, value):
        if isinstance(thing, oo.Plane):
            thing.offset = value[1]
        else:
            thing.position = value

    def resize(self, thing, _home, _value):
        geom = first_geom(thing)
        if isinstance(geom, oo.Box):
            geom.size = (0.5, 2.0, 1.0)
        elif hasattr(geom, "radius"):
            geom.radius = 1.25

    def join(self, thing, _home, _value):
        others = [other for other, _ in self.things if isinstance(other, oo.Body) and other is not thing]
        if isinstance(thing, oo.Body) and others:
            self.joints.append(oo.Ball(thing, others[0]))

    def release(self, _thing, _home, _value):
        if self.joints:
            self.joints.pop().release()

    def move_space(self, index, to):
        space, target = self.space(index), self.space(to)
        if target is space or space in list(target.ancestors):
            return
        space.move_to(target)
        for one, other in self.world.collided:
            if other is not None and (one in list(other.ancestors) or other in list(one.ancestors)):
                self.world.stop_colliding(one, other)

    def pairs(self):
        self.world.step()
        return rows_by_pair(self.world)


CHANGES = ("leave", "come_back", "house", "switch", "mark", "move", "resize", "join", "release")


@st.composite
def changes(draw):
    """One change, as a function of a Twin."""
    what = draw(st.sampled_from(["change", "change", "change", "change", "add", "plane", "pair", "stop", "space"]))
    one, other = draw(st.integers(0, 50)), draw(st.integers(0, 50))
    if what == "add":
        arguments = (one, draw(places()), draw(rotations()), draw(st.lists(shapes(), min_size=1, max_size=2)))
        static = draw(st.booleans())
        return lambda twin: twin.add(*arguments, static)
    if what == "plane":
        normal = draw(st.sampled_from([(0, 1, 0), (1, 0, 0), (1, 2, 3), (0, 0, -1)]))
        offset = draw(STEPS)
        return lambda twin: twin.add_plane(one, normal, offset)
    if what == "pair":
        partner = draw(st.sampled_from([None, other]))
        return lambda twin: twin.collide(one, partner)
    if what == "stop":
        return lambda twin: twin.stop(one)
    if what == "space":
        return lambda twin: twin.move_space(one, other)
    how, value = draw(st.sampled_from(CHANGES)), draw(places())
    return lambda twin: twin.change(how, one, value)


def assert_same_pairs(found, expected):
    """The same pairs, and the same contacts wherever the geoms were handed to ODE in the same order."""
    for pair in found.keys() | expected.keys():
        ours, theirs = found.get(pair, {}), expected.get(pair, {})
        if not ours or not theirs:
            depths = [row[6] for rows in (*ours.values(), *theirs.values()) for row in rows]
            assert max(depths) < 1e-6, (sorted(pair), ours, theirs)
        for order in ours.keys() & theirs.keys():
            assert sorted(ours[order]) == sorted(theirs[order]), sorted(pair)


@settings(max_examples=120)
@given(
    st.lists(st.tuples(st.sampled_from(SPACES), st.none() | st.integers(0, 9)), min_size=1, max_size=5),
    st.lists(st.tuples(st.integers(0, 4), st.none() | st.integers(0, 4)), min_size=1, max_size=4),
    st.lists(
        st.tuples(st.integers(0, 4), places(), rotations(), st.lists(shapes(), min_size=1, max_size=2), st.booleans()),
        min_size=2,
        max_size=8,
    ),
    st.lists(st.tuples(st.lists(changes(), max_size=4), st.booleans()), max_size=5),
)
def test_what_touches_is_the_same_in_any_world_after_any_changes(space_plan, pairs, things, course):
    """Three Worlds go through the same: one by osgode's own way, one by ODE's, and one that switches."""
    own, ode, switching = (Twin(mode, space_plan, pairs) for mode in ("own", "ode", "own"))
    for thing in things:
        for twin in (own, ode, switching):
            twin.add(*thing)
    for some, switch in [([], False), *course]:
        for twin in (own, ode, switching):
            for change in some:
                change(twin)
        if switch:
            world = switching.world
            world.broad_phase = "ode" if world.broad_phase == "own" else "own"
        expected = ode.pairs()
        assert_same_pairs(own.pairs(), expected)
        assert_same_pairs(switching.pairs(), expected)


def test_the_worlds_above_touch_at_all():
    """A pair of every two kinds of geoms, in one space and across two, is found by both ways."""
    makers = [oo.Box, oo.Sphere, oo.Capsule, oo.Cylinder, lambda **fields: oo.Trimesh(CUBE, **fields)]
    for one in makers:
        for other in [*makers, oo.Plane]:
            found = []
            for mode in ("own", "ode"):
                twin = Twin(mode, [(oo.HashSpace, None), (oo.SimpleSpace, None)], [(0, None), (0, 1)])
                twin.add(0, (0, 0.9, 0), oo.Quat.from_axis_angle((1, 2, 3), 0.3), [(one, (), {})], False)
                if other is oo.Plane:
                    twin.add_plane(1, (0, 1, 0), 0.5)
                else:
                    for space in (0, 1):
                        rotation = oo.Quat.from_axis_angle((3, 1, 2), 0.2)
                        twin.add(space, (0.1, 0, 0.1), rotation, [(other, (), {})], space == 1)
                found.append(set(twin.pairs()))
            across = {
                frozenset(("geom 1", "geom 2")),
                *([] if other is oo.Plane else [frozenset(("geom 1", "geom 3"))]),
            }
            assert found[0] == found[1]
            assert across <= found[0], (one, other)


def both_modes(build, **fields):
    """The same by osgode's own way and by ODE's."""
    return [build(mode, **fields) for mode in ("own", "ode")]


def ground(mode, **fields):
    """A World with what moves in one space and a floor at y = 0 in another."""
    world = oo.World(broad_phase=mode, **fields)
    moving, fixed = world.attach(oo.HashSpace(name="moving")), world.attach(oo.SimpleSpace(name="fixed"))
    world.collide(moving)
    world.collide(moving, fixed)
    return world, moving, fixed.attach(oo.Plane(name="floor"))


def put(space, position, geom=None, **fields):
    """A body with one geom."""
    body = space.attach(oo.Body(position=position, **fields))
    body.attach(oo.Placeable()).attach(geom or oo.Box((1, 1, 1), mass=1.0))
    return body


def awake(world):
    return [body.name for body in world.bodies if body.enabled]


def touching(world):
    """The names of the bodies that touch each other, or the floor (None)."""
    found = set()
    for row in world.contacts:
        bodies = [world.geom_of_slot(int(row[slot])).body for slot in ("slot1", "slot2")]
        found.add(frozenset(None if body is None else body.name for body in bodies))
    return found


# -- several pairs of spaces


def test_a_pair_of_geoms_that_was_declared_twice_has_its_contacts_once():
    """Two balls in a space that is told to collide within itself, and across the two spaces in it."""
    world = oo.World(gravity=(0, 0, 0))
    outer = world.attach(oo.SimpleSpace())
    left, right = outer.attach(oo.HashSpace()), outer.attach(oo.HashSpace())
    put(left, (0, 0, 0), oo.Sphere(0.5, mass=1.0))
    put(right, (0.9, 0, 0), oo.Sphere(0.5, mass=1.0))
    world.collide(outer)
    world.collide(left, right)
    world.collide(right, left)
    world.step()
    assert len(world.contacts) == 1
    assert world.contacts[0]["geom"]["depth"] == pytest.approx(0.1)


@pytest.mark.parametrize("count", [64, 65])
def test_any_number_of_pairs_of_spaces_may_be_declared(count):
    """Own bits tell 64 pairs apart; with more of them ODE's spaces are walked: all the same is found."""

    def build(mode):
        world = oo.World(gravity=(0, 0, 0), broad_phase=mode)
        spaces = [world.attach(oo.SimpleSpace()) for _ in range(count + 1)]
        for i, space in enumerate(spaces):
            put(space, (0.9 * i, 0, 0), oo.Sphere(0.5, mass=1.0, name=str(i)), kinematic=True)
        for one, other in itertools.pairwise(spaces):
            world.collide(one, other)
        world.step()
        return world

    own, ode = both_modes(build)
    assert set(rows_by_pair(own)) == {frozenset((str(i), str(i + 1))) for i in range(count)}
    assert rows_by_pair(own) == rows_by_pair(ode)
    assert own.broad_phase == "own"
    own.stop_colliding(*own.collided[0])
    own.step()
    assert set(rows_by_pair(own)) == {frozenset((str(i), str(i + 1))) for i in range(1, count)}


def test_a_disabled_geom_touches_nothing_across_spaces_either():
    """ODE itself asks only the geoms of one of two spaces whether they are enabled."""
    for mode in ("own", "ode"):
        world = oo.World(gravity=(0, 0, 0), broad_phase=mode)
        few, many = world.attach(oo.SimpleSpace()), world.attach(oo.SimpleSpace())
        world.collide(few, many)
        geom = put(few, (0, 0, 0)).geoms[0]
        for i in range(3):
            put(many, (0.9, 3.0 * i, 0))
        world.step()
        assert len(world.contacts) > 0
        geom.enabled = False
        world.step()
        assert len(world.contacts) == 0
