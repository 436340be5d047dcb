"""What listeners are told about touching, and what they may do about it."""

import gc
import weakref

import numpy as np
import pytest

import osgode as oo
from tests.strategies import CUBE
from tests.trees import is_consistent

GEOMS = {
    "box": lambda: oo.Box((1, 1, 1)),
    "sphere": lambda: oo.Sphere(0.5),
    "capsule": lambda: oo.Capsule(0.5, 1.0),
    "cylinder": lambda: oo.Cylinder(0.5, 1.0),
    "mesh": lambda: oo.Trimesh(CUBE),
}
FLOORS = {
    "plane": oo.Plane,
    "box": lambda: oo.Box((10, 0.5, 10)),
    "mesh": lambda: oo.Trimesh(([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], [(0, 1, 2), (0, 2, 3)])),
}


class Ground:
    """A floor whose top is y = 0, in a World, and what the listeners heard."""

    def __init__(self, floor="plane", **fields):
        self.world = oo.World(**fields)
        self.space = self.world.attach(oo.HashSpace())
        self.world.collide(self.space)
        self.floor = FLOORS[floor]()
        home = self.space
        if floor != "plane":
            home = self.space.attach(oo.Placeable(position=(0, -0.25 if floor == "box" else 0, 0)))
        home.attach(self.floor)
        self.heard = []

    def drop(self, geom, height=0.49, **fields):
        body = self.space.attach(oo.Body(position=(0, height, 0), **fields))
        body.attach(oo.Placeable()).attach(geom)
        return body

    def hear(self, touch):
        self.heard.append(touch)

    def states(self):
        return [touch.state for touch in self.heard]


# -- what they are told


def test_a_touch_begins_stays_and_ends():
    ground = Ground(gravity=(0, 0, 0), step_size=0.01)
    body = ground.drop(oo.Sphere(0.5), 0.515, linear_velocity=(0, -1, 0))
    assert body.on_touch(ground.hear) == ground.hear
    ground.world.step(2)
    assert ground.heard == []
    ground.world.step()
    assert ground.states() == ["begin"]
    (touch,) = ground.heard
    assert (touch.begin, touch.stay, touch.end) == (True, False, False)
    assert (touch.geom, touch.other) == (body.geoms[0], ground.floor)
    assert (touch.body, touch.other_body) == (body, None)
    body.linear_velocity = (0, -0.1, 0)
    ground.world.step(3)
    body.position = (0, 3, 0)
    ground.world.step(3)
    assert ground.states()[0] == "begin"
    assert set(ground.states()[1:-1]) == {"stay"}
    assert ground.states()[-1] == "end"
    assert ground.states().count("end") == 1
    last = ground.heard[-1]
    assert last.impulse == 0
    assert last.points.shape == last.normals.shape == (0, 3)
    assert last.depths.shape == (0,)


@pytest.mark.parametrize("floor", FLOORS)
@pytest.mark.parametrize("shape", GEOMS)
@pytest.mark.parametrize("listener", ["body", "geom", "floor"])
def test_what_rests_presses_with_its_weight_and_normals_point_to_the_listener(shape, floor, listener):
    """Impulse: m g dt, from every geom on every floor; points lie at the floor; normals go out of the other."""
    ground = Ground(floor, step_size=0.01, gravity=(0, -10, 0), solver="exact")
    ground.world.surfaces.fallback = oo.Surface(0.5)
    upright = oo.Quat.between((0, 0, 1), (0, 1, 0)) if shape in ("capsule", "cylinder") else (1, 0, 0, 0)
    height = 0.5 + (0.5 if shape == "capsule" else 0.0)
    geom = GEOMS[shape]()
    geom.mass = 3.0
    body = ground.drop(geom, height - 0.001, rotation=upright)
    {"body": body, "geom": geom, "floor": ground.floor}[listener].on_touch(ground.hear)
    ground.world.step(5)
    body.position = (0, height - 0.001, 0)
    body.rotation = upright
    body.linear_velocity = body.angular_velocity = (0, 0, 0)
    ground.world.erp = 0.0
    ground.world.step()
    touch = ground.heard[-1]
    pair = (geom, ground.floor) if listener != "floor" else (ground.floor, geom)
    assert (touch.geom, touch.other) == pair
    assert touch.impulse == pytest.approx(3.0 * 10 * 0.01, rel=0.02)
    up = 1.0 if listener != "floor" else -1.0
    assert len(touch.points) > 0
    assert touch.normals == pytest.approx(np.tile([0, up, 0], (len(touch.points), 1)), abs=1e-3)
    assert np.abs(touch.points[:, 1]).max() < 0.01
    assert touch.depths.max() == pytest.approx(0.001, abs=5e-4)
    rows = ground.world.contacts
    force = rows["force"].sum(axis=0)
    first = ground.world.geom_of_slot(rows["slot1"][0])
    assert force[1] == pytest.approx(30.0 if first is geom else -30.0, rel=0.02)


@pytest.mark.parametrize("kind", [oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace])
@pytest.mark.parametrize("floor_first", [True, False])
def test_forces_of_contacts_act_on_the_first_geom(kind, floor_first):
    """Whichever of the two ODE calls the first, and whether it has a body or not; so do the normals."""
    world = oo.World(gravity=(0, -10, 0), step_size=0.01)
    space = world.attach(kind())
    world.collide(space)
    body = oo.Body(position=(0, 0.499, 0))
    ball = body.attach(oo.Placeable()).attach(oo.Sphere(0.5, mass=3.0))
    floor = oo.Box((10, 1, 10))
    place = oo.Placeable(position=(0, -0.5, 0))
    place.attach(floor)
    for node in (place, body) if floor_first else (body, place):
        space.attach(node)
    ball.on_touch(lambda touch: None)
    for _ in range(2):
        world.step()
        body.position = (0, 0.499, 0)
        (row,) = world.contacts
        up = 1 if world.geom_of_slot(row["slot1"]) is ball else -1
        assert row["force"][1] * up == pytest.approx(30.0, rel=0.05) or row["force"][1] * up > 30
        assert row["geom"]["normal"][1] == up


def test_both_sides_are_told_each_from_its_own_view():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    geom = body.geoms[0]
    for node in (body, geom, ground.floor):
        node.on_touch(ground.hear)
    ground.world.step()
    assert sorted((touch.geom is geom, touch.other is geom) for touch in ground.heard) == [
        (False, True),
        (True, False),
        (True, False),
    ]
    own = next(touch for touch in ground.heard if touch.geom is geom)
    other = next(touch for touch in ground.heard if touch.geom is ground.floor)
    assert np.array_equal(own.normals, -other.normals)
    assert np.array_equal(own.points, other.points)
    assert own.impulse == other.impulse > 0


def test_each_pair_of_geoms_is_a_touch_of_its_own():
    """A body of two balls on a floor: two touches, and one ends while the other goes on."""
    ground = Ground(gravity=(0, 0, 0))
    body = ground.space.attach(oo.Body(position=(0, 0.49, 0)))
    balls = [body.attach(oo.Placeable(position=(x, 0, 0))).attach(oo.Sphere(0.5)) for x in (-1, 1)]
    body.on_touch(ground.hear)
    ground.world.step()
    assert {touch.geom for touch in ground.heard} == set(balls)
    ground.heard.clear()
    balls[0].enabled = False
    ground.world.step()
    assert {(touch.geom, touch.state) for touch in ground.heard} == {(balls[0], "end"), (balls[1], "stay")}


def test_who_does_not_listen_is_not_told():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    body.on_touch(ground.hear)
    ground.world.step()
    body.remove_on_touch(ground.hear)
    ground.world.step(3)
    assert ground.states() == ["begin"]
    with pytest.raises(ValueError, match="not in list"):
        body.remove_on_touch(ground.hear)
    assert not ground.world.contacts["force"].any()


def test_parts_that_come_later_are_listened_to_as_well():
    """Whether they are new, come from another body, or the body comes with its listener from outside."""
    ground = Ground(gravity=(0, 0, 0))
    listened, other = ground.drop(oo.Sphere(0.5), 5), ground.drop(oo.Sphere(0.5))
    listened.on_touch(ground.hear)
    ground.world.step()
    assert ground.heard == []
    part = listened.attach(oo.Placeable(position=(3, -4.51, 0))).attach(oo.Sphere(0.5))
    ground.world.step()
    assert [touch.geom for touch in ground.heard] == [part]
    ground.heard.clear()
    moved = other.geoms[0]
    moved.move_to(part.parent)
    part.parent.detach(part)
    ground.world.step()
    assert {(touch.geom, touch.state) for touch in ground.heard} == {(moved, "begin"), (part, "end")}
    ground.heard.clear()
    moved.move_to(other.children[0])
    ground.world.step(2)
    assert "stay" not in ground.states()
    ground.space.detach(listened)
    ground.space.detach(other)
    ground.world.step()
    ground.heard.clear()
    listened.position = (0, 0.49, 0)
    ground.space.attach(listened)
    ground.world.step()
    assert ground.states() == ["begin"]


@pytest.mark.parametrize("odd", [None, 5, "hear"])
def test_a_listener_can_be_called(odd):
    for node in (oo.Body(name="it"), oo.Box(name="it")):
        with pytest.raises(oo.FieldError, match=r"'it'\.on_touch\(\)\.listener is .*must be callable"):
            node.on_touch(odd)


# -- what they may do

CHANGES = {
    "detach itself": lambda ground, touch: touch.body.parent.detach(touch.body),
    "detach the other": lambda ground, touch: ground.floor.parent.detach(ground.floor),
    "detach the space": lambda ground, touch: ground.world.detach(ground.space),
    "detach its geom": lambda ground, touch: touch.geom.parent.detach(touch.geom),
    "attach another": lambda ground, touch: ground.drop(oo.Sphere(0.5)),
    "replace itself": lambda ground, touch: (
        touch.body.parent.detach(touch.body),
        [ground.drop(oo.Sphere(0.5)) for _ in range(3)],
    ),
    "move to another space": lambda ground, touch: touch.body.move_to(ground.world.attach(oo.SimpleSpace())),
    "move to another world": lambda ground, touch: touch.body.move_to(ground.other),
    "come and go": lambda ground, touch: [
        (ground.space.detach(touch.body), ground.space.attach(touch.body)) for _ in range(3)
    ],
    "resize": lambda ground, touch: setattr(touch.geom, "radius", 0.4),
    "move": lambda ground, touch: setattr(touch.body, "position", (0, 1, 0)),
    "make a joint": lambda ground, touch: oo.Ball(touch.body),
    "stop colliding": lambda ground, touch: ground.world.stop_colliding(ground.space),
    "stop listening": lambda ground, touch: touch.body.remove_on_touch(ground.acting),
    "listen twice": lambda ground, touch: touch.geom.on_touch(lambda touch: None),
    "change the gravity": lambda ground, touch: setattr(ground.world, "gravity", (0, 5, 0)),
    "drop the World": lambda ground, touch: delattr(ground, "world"),
}


@pytest.mark.parametrize("how", CHANGES)
def test_a_listener_may_change_anything(how):
    """Also what is touching: no space is locked, and the step after goes on."""
    ground = Ground()
    ground.other = oo.World()
    neighbours = [ground.drop(oo.Sphere(0.5)) for _ in range(3)]
    body = ground.drop(oo.Sphere(0.5))
    done = []

    def act(touch):
        ground.heard.append(touch)
        if not done and touch.begin and touch.other is ground.floor and touch.geom.is_live:
            done.append(touch)
            CHANGES[how](ground, touch)

    ground.acting = act
    body.on_touch(act)
    for other in neighbours:
        other.on_touch(ground.hear)
    world = ground.world
    world.step(3)
    assert done
    world.step(20)
    is_consistent(world)
    touching = set()
    for touch in ground.heard:
        key = (touch.geom, touch.other)
        assert (key in touching) == (not touch.begin)
        (touching.discard if touch.end else touching.add)(key)


def test_a_listener_must_not_step():
    """It would be a step inside a step."""
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5), name="it")
    step = body.on_touch(lambda touch: ground.world.step())
    with pytest.raises(oo.StateError, match="from a listener inside a step") as caught:
        ground.world.step()
    assert any("Body" in note or "Sphere" in note for note in caught.value.__notes__)
    assert ground.world.steps == 1
    body.remove_on_touch(step)
    ground.world.step(3)


def test_errors_of_listeners_leave_the_step_with_their_names_and_lose_nobody():
    ground = Ground()
    first, second = ground.drop(oo.Sphere(0.5, name="first")), ground.drop(oo.Sphere(0.5, name="second"), 0.48)
    second.position = (3, 0.49, 0)

    def fail(touch):
        raise LookupError(touch.geom.name)

    first.on_touch(fail)
    second.on_touch(ground.hear)
    with pytest.raises(LookupError, match="first") as caught:
        ground.world.step(10)
    assert ground.states() == ["begin"]
    assert any("Sphere 'first'" in note and "begin" in note for note in caught.value.__notes__)
    assert ground.world.steps == 1
    second.on_touch(fail)
    with pytest.raises(ExceptionGroup) as caught:
        ground.world.step(10)
    assert sorted(str(error) for error in caught.value.exceptions) == ["first", "second"]
    assert all(error.__notes__ for error in caught.value.exceptions)
    assert ground.states() == ["begin", "stay"]
    first.remove_on_touch(fail)
    second.remove_on_touch(fail)
    ground.world.step(10)
    assert ground.states() == ["begin"] + ["stay"] * 11


def test_interrupting_is_not_caught():
    """KeyboardInterrupt leaves at once, and the World stays usable."""
    ground = Ground()

    def stop(touch):
        raise KeyboardInterrupt

    ground.drop(oo.Sphere(0.5)).on_touch(stop)
    with pytest.raises(KeyboardInterrupt):
        ground.world.step()
    with pytest.raises(KeyboardInterrupt):
        ground.world.step()


def test_a_place_of_a_geom_that_left_is_not_given_away_before_its_end_is_told():
    """A new geom in the same step takes another slot, so no touch is told of the wrong one."""
    ground = Ground(gravity=(0, 0, 0))
    body = ground.drop(oo.Sphere(0.5, name="old"))
    body.on_touch(ground.hear)
    ground.world.step()
    slots = {body.geoms[0]._slot}
    for i in range(6):
        ground.space.detach(body)
        fresh = ground.drop(oo.Sphere(0.5, name=f"new {i}"))
        fresh.on_touch(ground.hear)
        slots.add(fresh.geoms[0]._slot)
        ground.heard.clear()
        ground.world.step()
        assert [(touch.body, touch.state) for touch in ground.heard if touch.end] == [(body, "end")]
        assert [(touch.geom, touch.state) for touch in ground.heard if not touch.end] == [(fresh.geoms[0], "begin")]
        ended = next(touch for touch in ground.heard if touch.end)
        assert ended.geom is body.geoms[0]
        assert ended.geom.name == ("old" if i == 0 else f"new {i - 1}")
        body = fresh
    assert len(slots) <= 4  # they are used again in the end


def test_a_listener_may_attach_into_a_place_that_was_just_given_back():
    """What it attaches is known by that place from then on."""
    ground = Ground(gravity=(0, 0, 0))
    resting, leaving = ground.drop(oo.Sphere(0.5)), ground.drop(oo.Sphere(0.5))
    resting.position = (5, 0.49, 0)
    slot = leaving.geoms[0]._slot
    fresh = []

    def attach(touch):
        if not fresh and ground.world.geom_of_slot(slot) is not None and ground.world.steps == 3:
            fresh.append(ground.drop(oo.Sphere(0.5, name="fresh")))

    resting.on_touch(attach)
    ground.world.step()
    ground.space.detach(leaving)
    ground.world.step(2)
    assert fresh[0].geoms[0]._slot == slot
    assert ground.world.geom_of_slot(slot) is fresh[0].geoms[0]
    fresh[0].on_touch(ground.hear)
    ground.world.step(2)
    assert [(touch.geom.name, touch.state) for touch in ground.heard] == [("fresh", "begin"), ("fresh", "stay")]


def test_a_place_is_empty_when_the_end_was_told():
    """Though somebody still holds the geom that had it."""
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    geom, slot = body.geoms[0], body.geoms[0]._slot
    assert ground.world.geom_of_slot(slot) is geom
    ground.world.step()
    ground.space.detach(body)
    for _ in range(2):
        ground.world.step()
    assert ground.world.geom_of_slot(slot) is None
    with pytest.raises(oo.FieldError, match="slot is -1"):
        ground.world.geom_of_slot(-1)
    assert ground.world.geom_of_slot(10_000) is None


def test_slots_do_not_grow_without_bounds():
    ground = Ground()
    for _ in range(50):
        body = ground.drop(oo.Sphere(0.5))
        body.on_touch(ground.hear)
        ground.world.step()
        ground.space.detach(body)
    assert ground.world._realm.ptr.geom_count < 10


def test_nodes_whose_end_was_told_are_let_go():
    ground = Ground()
    ground.floor.on_touch(lambda touch: None)
    body = ground.drop(oo.Sphere(0.5))
    ground.world.step()
    ref = weakref.ref(body)
    ground.space.detach(body)
    del body
    for _ in range(3):
        ground.world.step()
    gc.collect()
    assert ref() is None
