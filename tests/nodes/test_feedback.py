"""What listeners are told before a collision is answered, what they may decide, and what they may do meanwhile."""

import gc
import threading
import weakref

import numpy as np
import pytest

import osgode as oo
from tests.nodes.test_touch import Ground
from tests.trees import is_consistent

BROAD = pytest.mark.parametrize("broad", ["own", "ode"])


def two_balls(**fields):
    """Two balls of 1 kg, 1 m across, that have just met and fly at each other with 2 and 1 m/s along x."""
    world = oo.World(gravity=(0, 0, 0), step_size=0.01, **fields)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    balls = []
    for name, x, speed in (("left", -0.49, 2), ("right", 0.49, -1)):
        body = space.attach(oo.Body(name=name, position=(x, 0, 0), linear_velocity=(speed, 0, 0)))
        body.attach(oo.Placeable()).attach(oo.Sphere(0.5, mass=1, name=name))
        balls.append(body)
    return world, space, *balls


# -- what they are told


def test_a_collision_is_told_before_it_acts_and_the_touch_behind():
    world, _, left, right = two_balls()
    order = []

    def ask(feedback):
        order.append(("ask", feedback.begin, left.linear_velocity.x, right.linear_velocity.x))

    left.on_collide(ask)
    left.on_touch(lambda touch: order.append(("told", touch.begin, left.linear_velocity.x > 1.9, touch.impulse > 0)))
    world.step()
    assert order == [("ask", True, 2.0, -1.0), ("told", True, False, True)]


def test_geometry_and_speeds_are_seen_from_either_side():
    """Depth 2 r - d = 0.02; both approach with 3 m/s; the normal points to whoever listens."""
    world, _, left, right = two_balls()
    seen = {}

    def look(feedback):
        seen[feedback.geom.name] = (
            feedback.other.name,
            feedback.body,
            feedback.other_body,
            feedback.points.tolist(),
            feedback.normals.tolist(),
            feedback.depths.tolist(),
            feedback.closing_speeds.tolist(),
        )

    left.on_collide(look)
    right.geoms[0].on_collide(look)
    world.step()
    for name, other, own, theirs, sign in (("left", "right", left, right, -1), ("right", "left", right, left, 1)):
        to, body, other_body, points, normals, depths, speeds = seen[name]
        assert (to, body, other_body) == (other, own, theirs)
        assert np.array(points) == pytest.approx(np.zeros((1, 3)), abs=1e-9)
        assert np.array(normals) == pytest.approx(np.array([[sign, 0, 0]]))
        assert depths == pytest.approx([0.02])
        assert speeds == pytest.approx([3.0])


def test_the_closing_speed_counts_turning_and_is_negative_for_what_parts():
    """A ball over a floor that turns about x: its lowest point moves along z only, so it approaches as it falls."""
    ground = Ground(gravity=(0, 0, 0))
    body = ground.drop(oo.Sphere(0.5), linear_velocity=(0, 0.3, 0), angular_velocity=(7, 0, 0))
    speeds = []
    body.on_collide(lambda feedback: speeds.extend(feedback.closing_speeds))
    ground.floor.on_collide(lambda feedback: speeds.extend(feedback.closing_speeds))
    ground.world.step()
    assert speeds == pytest.approx([-0.3, -0.3])


def test_begin_is_told_once_and_again_to_who_comes_later():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    first, second = [], []
    body.on_collide(lambda feedback: first.append(feedback.begin))
    ground.world.step(3)
    body.on_collide(lambda feedback: second.append(feedback.begin))
    ground.world.step(2)
    assert first == [True, False, False, False, False]
    assert second == [True, False]


def test_all_levels_hear_and_a_common_ancestor_once():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    order = []
    for name, node in (("world", ground.world), ("space", ground.space), ("body", body), ("geom", body.geoms[0])):
        node.on_collide(lambda feedback, name=name: order.append((name, feedback.geom is body.geoms[0])))
        node.on_touch(lambda touch, name=name: order.append((name, touch.geom is body.geoms[0])))
    ground.floor.on_collide(lambda feedback: order.append(("floor", feedback.geom is ground.floor)))
    ground.world.step()
    assert sorted(name for name, _ in order) == [
        "body",
        "body",
        "floor",
        "geom",
        "geom",
        *["space"] * 2,
        *["world"] * 2,
    ]
    assert {(name, side) for name, side in order if name in ("body", "geom", "floor")} == {
        ("body", True),
        ("geom", True),
        ("floor", True),
    }


def test_a_listener_that_is_registered_twice_hears_once():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    heard = []
    for _ in range(2):
        body.on_collide(heard.append)
        body.on_touch(heard.append)
    ground.world.step()
    assert len(heard) == 2
    body.remove_on_collide(heard.append)
    body.remove_on_touch(heard.append)
    ground.world.step()
    assert len(heard) == 2
    with pytest.raises(ValueError, match="not in list"):
        body.remove_on_collide(heard.append)
    with pytest.raises(oo.FieldError, match=r"on_collide\(\)\.listener is 5"):
        body.on_collide(5)


def test_it_is_good_for_as_long_as_the_listener_runs():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    kept = []
    body.on_collide(kept.append)
    ground.world.step()
    (feedback,) = kept
    assert feedback.geom is body.geoms[0]
    for use in (
        lambda: feedback.points,
        lambda: feedback.normals,
        lambda: feedback.depths,
        lambda: feedback.closing_speeds,
        lambda: feedback.refused,
        feedback.refuse,
        lambda: feedback.set_surface(oo.Surface()),
    ):
        with pytest.raises(oo.StateError, match="as long as its listener runs"):
            use()


# -- what they decide


@BROAD
def test_who_is_refused_passes_through_and_touches_nothing(broad):
    world, _, left, right = two_balls(broad_phase=broad)
    heard, asked = [], []

    @left.on_collide
    def refuse(feedback):
        asked.append((feedback.begin, feedback.refused))
        feedback.refuse()

    right.on_collide(lambda feedback: asked.append(feedback.refused))
    right.on_touch(heard.append)
    world.step(60)
    assert left.linear_velocity == (2, 0, 0)
    assert left.position.x > right.position.x
    assert heard == []
    assert asked[:2] == [(True, False), True]
    assert len(world.contacts) == 0


def test_refusing_now_and_then_begins_and_ends_touches():
    ground = Ground(gravity=(0, 0, 0))
    body = ground.drop(oo.Sphere(0.5))
    body.on_touch(ground.hear)
    on = [False, True, True, False, False, True]
    body.on_collide(lambda feedback: None if on.pop(0) else feedback.refuse())
    for _ in range(6):
        ground.world.step()
        body.position, body.linear_velocity = (0, 0.49, 0), (0, 0, 0)
    assert ground.states() == ["begin", "stay", "end", "begin"]


def test_a_surface_for_these_contacts_bounces():
    """With e = 1 balls exchange their velocities; the step after has the table's surface again."""
    world, _, left, right = two_balls(solver="exact")
    world.surfaces.fallback = oo.Surface(0.0)
    left.on_collide(lambda feedback: feedback.set_surface(oo.Surface(0.0, bounce=1.0, bounce_velocity=0)))
    world.erp = 0.0
    world.step()
    assert (left.linear_velocity.x, right.linear_velocity.x) == pytest.approx((-1, 2), abs=1e-3)


def test_a_surface_for_these_contacts_has_friction():
    """A puck that slides at 1 m/s: with mu = 0.2 it slows by mu g dt a step, without it not at all."""
    speeds = {}
    for friction in (0.0, 0.2):
        ground = Ground(gravity=(0, -10, 0), step_size=0.01)
        body = ground.drop(oo.Box((0.5, 0.2, 0.5), mass=1), 0.1, linear_velocity=(1, 0, 0))
        ground.world.surfaces.fallback = oo.Surface(0.9)
        ground.floor.on_collide(lambda feedback, mu=friction: feedback.set_surface(oo.Surface(mu)))
        ground.world.step(20)
        speeds[friction] = body.linear_velocity.x
    assert speeds[0.0] == pytest.approx(1.0, abs=1e-9)
    assert speeds[0.2] == pytest.approx(1.0 - 0.2 * 10 * 0.2, abs=0.03)


def test_a_refusal_stays_one_and_surfaces_are_checked():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    errors = []

    @body.on_collide
    def listen(feedback):
        for bad in (oo.Surface(direction=(1, 0, 0)), None, 0.5):
            try:
                feedback.set_surface(bad)
            except oo.FieldError as error:
                errors.append(str(error))
        feedback.refuse()
        feedback.set_surface(oo.Surface(1.0))
        assert feedback.refused

    start = body.position
    ground.world.step(5)
    assert len(errors) == 15
    assert body.position.y < start.y - 0.004


def test_lent_surfaces_are_taken_back():
    ground = Ground()
    ground.drop(oo.Sphere(0.5)).on_collide(lambda feedback: feedback.set_surface(oo.Surface(0.3)))
    ground.world.step(2)
    count = ground.world._realm.ptr.surface_count
    ground.world.step(50)
    assert ground.world._realm.ptr.surface_count == count


# -- what they may do to the tree


CHANGES = {
    "detach itself": lambda g, f: g.space.detach(f.body),
    "detach the floor": lambda g, f: g.floor.parent and g.space.detach(g.floor),
    "detach all": lambda g, f: [g.space.detach(child) for child in g.space.children],
    "detach the space": lambda g, f: g.space.parent and g.world.detach(g.space),
    "detach its geom": lambda g, f: f.geom.parent.detach(f.geom),
    "come and go": lambda g, f: [(g.space.detach(f.body), g.space.attach(f.body)) for _ in range(3)],
    "move far": lambda g, f: setattr(f.body, "position", (0, 50, 0)),
    "move the space": lambda g, f: f.body.move_to(g.world.attach(oo.SimpleSpace())),
    "move the world": lambda g, f: f.body.move_to(g.other),
    "move its geom": lambda g, f: f.geom.move_to(g.anchor.children[0]),
    "be of one body": lambda g, f: f.body is not None and f.other_body and f.other.move_to(f.geom.parent),
    "be static": lambda g, f: f.geom.move_to(g.space.attach(oo.Placeable())),
    "add more": lambda g, f: [g.drop(oo.Sphere(0.5)) for _ in range(30)],
    "replace": lambda g, f: (g.space.detach(f.body), [g.drop(oo.Box((1, 1, 1))) for _ in range(5)]),
    "join": lambda g, f: oo.Ball(f.body, f.other_body),
    "resize": lambda g, f: setattr(f.geom, "radius", 0.2),
    "disable": lambda g, f: setattr(f.geom, "enabled", False),
    "sense": lambda g, f: setattr(f.geom, "sensor", True),
    "own surface": lambda g, f: setattr(f.geom, "surface", oo.Surface(0.1)),
    "sleep": lambda g, f: setattr(f.body, "enabled", False),
    "listen": lambda g, f: f.geom.on_touch(g.hear),
    "stop listening": lambda g, f: g.stop(),
    "stop colliding": lambda g, f: g.world.stop_colliding(g.space),
    "change the step": lambda g, f: setattr(g.world, "step_size", 0.005),
    "change the broad phase": lambda g, f: setattr(g.world, "broad_phase", "ode"),
    "ask": lambda g, f: (g.world.cast_rays(np.zeros((9, 3)), (0, -1, 0)), g.world.overlaps(oo.Sphere(2))),
    "drop the World": lambda g, f: g.__dict__.pop("world", None),
}


@BROAD
@pytest.mark.parametrize("how", CHANGES)
def test_a_collide_listener_may_change_anything(how, broad):
    """Also what is about to collide, in the middle of the step: what is gone makes no contact."""
    ground = Ground(broad_phase=broad)
    ground.other = oo.World()
    ground.anchor = ground.drop(oo.Sphere(0.1), 30)
    bodies = [ground.drop(oo.Sphere(0.5)) for _ in range(4)]
    done = []

    def act(feedback):
        if len(done) < 2 and feedback.geom.is_live and feedback.body in bodies:
            done.append(how)
            CHANGES[how](ground, feedback)

    def stop():
        for body in bodies:
            if act in body._collide_listeners:
                body.remove_on_collide(act)

    ground.stop = stop
    world = ground.world
    for body in bodies:
        body.on_collide(act)
        body.on_touch(ground.hear)
    world.step(3)
    assert done
    world.step(20)
    assert np.isfinite(world.poses).all()
    is_consistent(world)
    if how not in ("listen", "be of one body"):
        touching = set()
        for touch in ground.heard:
            key = (touch.geom, touch.other)
            assert (key in touching) == (not touch.begin)
            (touching.discard if touch.end else touching.add)(key)


def test_contacts_of_what_is_gone_are_dropped():
    """One ball takes the other away as they meet: it flies on as if nobody had been there."""
    world, space, left, right = two_balls()
    heard = []
    left.on_collide(lambda feedback: space.detach(feedback.other_body))
    right.on_collide(lambda feedback: heard.append("it was gone"))
    left.on_touch(heard.append)
    world.step(5)
    assert left.linear_velocity == (2, 0, 0)
    assert right.world is None
    assert heard == []


def test_what_is_put_into_one_body_does_not_collide():
    world, _, left, _ = two_balls()
    heard = []
    left.on_collide(lambda feedback: feedback.other.move_to(feedback.geom.parent))
    left.on_touch(heard.append)
    world.step(3)
    assert heard == []
    assert left.linear_velocity.x == pytest.approx(2)


# -- who comes and goes hears of it


def test_a_body_hears_the_end_for_a_geom_that_is_taken_off_it():
    ground = Ground(gravity=(0, 0, 0))
    body = ground.drop(oo.Sphere(0.5))
    geom = body.geoms[0]
    for node in (body, ground.space, ground.world):
        node.on_touch(ground.hear)
    ground.world.step()
    geom.parent.detach(geom)
    ground.heard.clear()
    ground.world.step(3)
    assert [(touch.state, {touch.geom, touch.other}) for touch in ground.heard] == [("end", {geom, ground.floor})] * 3


def test_a_geom_that_goes_to_another_body_ends_for_the_one_and_begins_for_the_other():
    ground = Ground(gravity=(0, 0, 0))
    giver, taker = ground.drop(oo.Sphere(0.5)), ground.drop(oo.Sphere(0.1), 0.49)
    geom, other = giver.geoms[0], taker.geoms[0]
    other.enabled = False
    heard = []
    giver.on_touch(lambda touch: heard.append(("giver", touch.geom is geom, touch.state)))
    taker.on_touch(lambda touch: heard.append(("taker", touch.geom is geom, touch.state)))
    ground.world.step()
    geom.move_to(other.parent)
    taker.position = (0, 0.49, 0)
    ground.world.step()
    taker.position = (0, 0.49, 0)
    ground.world.step()
    assert heard == [
        ("giver", True, "begin"),
        ("taker", True, "begin"),
        ("giver", True, "end"),
        ("taker", True, "stay"),
    ]


def test_who_begins_to_listen_hears_begin_and_who_stops_hears_nothing():
    ground = Ground(gravity=(0, 0, 0))
    body = ground.drop(oo.Sphere(0.5))
    early, late = [], []
    ground.floor.on_touch(lambda touch: early.append(touch.state))
    ground.world.step(2)
    hear = body.on_touch(lambda touch: late.append(touch.state))
    ground.world.step(2)
    body.remove_on_touch(hear)
    ground.world.step(2)
    assert late == ["begin", "stay"]
    assert early == ["begin"] + ["stay"] * 5


def test_a_body_that_leaves_and_comes_back_within_a_step_ends_and_begins():
    ground = Ground(gravity=(0, 0, 0))
    body = ground.drop(oo.Sphere(0.5))
    body.on_touch(ground.hear)
    ground.world.step()
    ground.space.detach(body)
    ground.space.attach(body)
    ground.world.step()
    assert sorted(ground.states()) == ["begin", "begin", "end"]


def test_listeners_keep_no_world_alive():
    """Dropped, it is gone at once, though it is listened to on all levels and somebody still holds the geom."""
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    geom = body.geoms[0]
    for node in (ground.world, ground.space, body, geom):
        node.on_touch(lambda touch: None)
        node.on_collide(lambda feedback: None)
    ground.world.step(2)
    ref = weakref.ref(ground.world)
    gc.disable()
    try:
        del ground, body, node
        assert ref() is None
    finally:
        gc.enable()
    assert geom.world is None


# -- errors


def test_errors_leave_when_the_step_is_done_and_all_have_heard():
    ground = Ground()
    bodies = [ground.drop(oo.Sphere(0.5, name=f"ball {i}")) for i in range(3)]
    for i, body in enumerate(bodies):
        body.position = (3 * i, 0.49, 0)
    heard = []

    def fail(feedback):
        raise LookupError(feedback.geom.name)

    bodies[0].on_collide(fail)
    bodies[1].on_collide(heard.append)
    bodies[2].on_touch(heard.append)
    with pytest.raises(LookupError, match="ball 0") as caught:
        ground.world.step(5)
    assert any("collide listener of Sphere 'ball 0'" in note for note in caught.value.__notes__)
    assert ground.world.steps == 1
    assert len(heard) == 2
    bodies[2].on_touch(fail)
    with pytest.raises(ExceptionGroup) as group:
        ground.world.step()
    assert sorted(str(error) for error in group.value.exceptions) == ["ball 0", "ball 2"]
    assert ground.world.steps == 2
    assert ground.world.time == pytest.approx(2 * ground.world.step_size)


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, GeneratorExit])
def test_an_interrupted_step_is_as_if_it_had_not_begun(error):
    """The same bits afterwards as a World that was never interrupted."""

    def fresh():
        ground = Ground()
        for i in range(3):
            ground.drop(oo.Sphere(0.5)).position = (0.7 * i, 0.6, 0)
        ground.world.step(40)
        return ground

    ground, twin = fresh(), fresh()

    def stop(feedback):
        raise error

    before = ground.world.poses.tobytes()
    steps = ground.world.steps
    listener = ground.floor.on_collide(stop)
    for _ in range(3):
        with pytest.raises(error):
            ground.world.step()
        assert ground.world.steps == steps
        assert ground.world.poses.tobytes() == before
        assert len(ground.world.contacts) == 0
    ground.floor.remove_on_collide(listener)
    for _ in range(20):
        ground.world.step()
        twin.world.step()
    assert ground.world.poses.tobytes() == twin.world.poses.tobytes()


def test_an_interruption_between_errors_wins():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))

    def fail(feedback):
        raise LookupError

    def stop(touch):
        raise KeyboardInterrupt

    body.on_collide(fail)
    body.on_touch(stop)
    with pytest.raises(KeyboardInterrupt):
        ground.world.step()
    assert ground.world.steps == 1


def test_nobody_steps_from_inside_and_other_threads_wait():
    ground = Ground()
    body = ground.drop(oo.Sphere(0.5))
    caught = []

    @body.on_collide
    def listen(feedback):
        for act in (ground.world.step, lambda: ground.world.run(steps=2)):
            try:
                act()
            except oo.StateError as error:
                caught.append(str(error))

        def elsewhere():
            for act in (ground.world.step, lambda: setattr(body, "position", (0, 0, 0))):
                try:
                    act()
                except oo.StateError as error:
                    caught.append(str(error))

        thread = threading.Thread(target=elsewhere)
        thread.start()
        thread.join()

    ground.world.step()
    assert len(caught) == 4
    assert ground.world.steps == 1


def test_many_steps_in_one_call_ask_in_each():
    ground = Ground()
    asked = []
    ground.drop(oo.Sphere(0.5)).on_collide(lambda feedback: asked.append(ground.world.steps))
    ground.world.run(steps=25)
    assert asked == list(range(25))


@BROAD
def test_being_asked_changes_no_bits(broad):
    """A pile with a listener on everything, beside one without."""

    def pile(listen):
        world = oo.World(broad_phase=broad)
        space = world.attach(oo.HashSpace())
        world.collide(space)
        space.attach(oo.Plane())
        for i in range(25):
            body = space.attach(oo.Body(position=(0.2 * (i % 3), 0.5 + 0.6 * i, 0.1 * (i % 4))))
            body.attach(oo.Placeable()).attach(oo.Box((0.5, 0.5, 0.5)))
        if listen:
            world.on_collide(lambda feedback: None)
        return world

    one, other = pile(True), pile(False)
    for _ in range(300):
        one.step()
        other.step()
    assert one.poses.tobytes() == other.poses.tobytes()
