"""The World: what is in it, its steps and its time, bodies that leave the bounds, and who may touch it when."""

import logging
import math
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest

import osgode as oo
from osgode.native import lib
from tests.trees import Rig, assert_photos_agree, is_consistent, photo


def heap(count=30, **fields):
    """Boxes and balls that fall on a plane and on each other."""
    world = oo.World(**fields)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane())
    for i in range(count):
        body = space.attach(oo.Body(position=(0.3 * (i % 3), 1.0 + 0.9 * i, 0.2 * (i % 2)), name=f"body {i}"))
        geom = oo.Box((1, 0.8, 0.9), density=100.0) if i % 2 else oo.Sphere(0.5, density=100.0)
        body.attach(oo.Placeable()).attach(geom)
    return world


def bits(world):
    return world.poses.tobytes() + world.velocities.tobytes()


# -- what is in it


def test_a_world_lists_its_bodies_and_joints():
    rig = Rig()
    assert set(rig.world.bodies) == set(rig.bodies)
    assert rig.world.joints == tuple(rig.joints)
    rig.joints[1].release()
    assert rig.world.joints == (rig.joints[0], rig.joints[2])
    rig.hash.detach(rig.bodies[0])
    assert rig.world.joints == (rig.joints[2],)
    assert rig.bodies[0] not in rig.world.bodies


def test_tables_are_read_only_and_grow_with_the_bodies():
    world = oo.World(gravity=(0, 0, 0))
    first = world.poses
    assert first.shape == (0, 7)
    for i in range(100):
        world.attach(oo.Body(position=(i, 0, 0)))
        assert [row[0] for row in world.poses] == [body.position.x for body in world.bodies]
    for table in (world.poses, world.previous_poses):
        assert table.shape == (100, 7)
        with pytest.raises(ValueError, match="read-only"):
            table[0, 0] = 1.0
    old = world.poses
    for _ in range(100):
        world.attach(oo.Body())
    assert old[3, 0] == 3.0  # an old view is outdated, not dangling
    world.velocities[:] = 5.0
    assert not world.velocities.any()


def test_the_table_is_what_the_bodies_say():
    world = heap(10)
    world.step(50)
    for row, velocity, body in zip(world.poses, world.velocities, world.bodies, strict=True):
        assert tuple(row) == (*body.position, *body.rotation)
        assert tuple(velocity) == pytest.approx((*body.linear_velocity, *body.angular_velocity))
    before = world.poses.copy()
    world.step()
    assert np.array_equal(world.previous_poses, before)


def test_poses_between_two_steps():
    world = oo.World(gravity=(0, 0, 0), step_size=0.1)
    turn = oo.Quat.from_axis_angle((0, 0, 1), 0.3)
    body = world.attach(oo.Body(linear_velocity=(1, 0, 0), angular_velocity=(0, 0, 3), finite_rotation_axis=(0, 0, 0)))
    world.step()
    half = world.interpolated_poses(0.5)[0]
    assert tuple(half[:3]) == pytest.approx((0.05, 0, 0))
    assert tuple(half[3:]) == pytest.approx(tuple(oo.Quat.from_axis_angle((0, 0, 1), 0.15)), abs=1e-3)
    assert tuple(world.interpolated_poses(0.0)[0]) == pytest.approx((0, 0, 0, 1, 0, 0, 0))
    assert tuple(world.interpolated_poses(1.0)[0]) == pytest.approx((0.1, 0, 0, *turn))
    assert world.matrices(1.0)[0] == pytest.approx(body.local_matrix())
    assert world.matrices(1.0).shape == (1, 4, 4)


def test_poses_between_go_the_shorter_way_round():
    """The quaternions q and -q are one rotation, and ODE may change from one to the other."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body())
    world.step()
    world._realm.previous[0, 3:] = [-1.0, 0, 0, 0]
    assert abs(world.interpolated_poses(0.5)[0, 3]) == pytest.approx(1.0)
    assert body.rotation == (1, 0, 0, 0)


# -- steps and time


def test_steps_count_and_time_goes_on():
    world = oo.World(step_size=0.25)
    world.step()
    assert (world.steps, world.time) == (1, 0.25)
    world.step(3)
    assert (world.steps, world.time) == (4, 1.0)
    world.step(0)
    world.run(0.9)
    assert (world.steps, world.time) == (8, 2.0)
    world.run(steps=2)
    world.step_size = 0.5
    world.step()
    assert (world.steps, world.time) == (11, 3.0)


def test_many_steps_are_as_many_single_steps():
    """To the bit, also when listeners divide them."""
    worlds = [heap(), heap(), heap()]
    worlds[2].bodies[0].on_touch(lambda touch: None)
    worlds[0].step(100)
    worlds[2].step(100)
    for _ in range(100):
        worlds[1].step()
    assert bits(worlds[0]) == bits(worlds[1]) == bits(worlds[2])
    assert [world.steps for world in worlds] == [100] * 3


@pytest.mark.parametrize("count", [-1, 0.5, math.nan, math.inf, "many", None, 2**40, [1], True])
def test_a_count_of_steps_is_a_whole_number(count):
    world = oo.World(name="it")
    with pytest.raises(oo.FieldError, match=r"World 'it'\.step\(\)\.count is"):
        world.step(count)
    assert world.steps == 0


@pytest.mark.parametrize("arguments", [{}, {"seconds": 1.0, "steps": 3}])
def test_run_takes_seconds_or_steps(arguments):
    with pytest.raises(oo.FieldError, match=r"World 'it'\.run\(\).*either seconds or steps"):
        oo.World(name="it").run(**arguments)


@pytest.mark.parametrize("seconds", [-1.0, math.nan, math.inf, "long", 1e12])
def test_a_time_to_run_is_a_number(seconds):
    with pytest.raises(oo.FieldError, match=r"World 'it'\.run\(\)\.seconds is"):
        oo.World(name="it").run(seconds)


def test_the_same_seed_gives_the_same_bits_and_another_does_not():
    worlds = [heap(seed=1), heap(seed=1), heap(seed=2)]
    for world in worlds:
        world.step(150)
    assert bits(worlds[0]) == bits(worlds[1]) != bits(worlds[2])
    assert worlds[0].seed == worlds[1].seed != 1


@pytest.mark.parametrize("solver", ["quick", "exact"])
def test_settings_reach_the_simulation(solver):
    """A falling body: v = g t, with either solver; gravity can be turned off for one."""
    world = oo.World(gravity=(1, -2, 3), step_size=0.01, solver=solver)
    body, light = world.attach(oo.Body()), world.attach(oo.Body(gravity=False))
    damped = world.attach(oo.Body(gravity=False, linear_velocity=(1, 0, 0), linear_damping=0.5))
    world.step(10)
    assert body.linear_velocity == pytest.approx((0.1, -0.2, 0.3))
    assert light.linear_velocity == (0, 0, 0)
    assert damped.linear_velocity.x == pytest.approx(0.5**7, rel=0.01)  # no damping below 0.01 m/s


def test_a_constructor_takes_what_the_fields_take():
    world = oo.World(gravity=(0, 0, -1), step_size=0.5, solver="exact", iterations=7, auto_disable=True, name="it")
    assert (world.gravity, world.step_size, world.solver, world.iterations) == ((0, 0, -1), 0.5, "exact", 7)
    assert world.auto_disable is True
    with pytest.raises(oo.FieldError, match=r"World 'it'\.step_size is 0"):
        oo.World(step_size=0, name="it")
    with pytest.raises(TypeError, match="did you mean 'gravity'"):
        oo.World(gravitiy=(0, 0, 0))


def test_messages_of_ode_go_to_the_log(caplog):
    """They are handed over after the step; none is printed."""
    from osgode import native

    with caplog.at_level(logging.WARNING, logger="osgode.ode"):
        native.lib.dWorldSetERP(oo.World()._id, 0.2)  # says nothing
        native.forward_messages()
    assert caplog.text == ""


# -- bodies that leave the bounds


def test_a_body_that_leaves_the_bounds_is_named_and_the_world_goes_on():
    world = oo.World(gravity=(0, 0, 0), step_size=0.1, name="world")
    space = world.attach(oo.HashSpace(name="space"))
    world.collide(space)
    slow = space.attach(oo.Body(linear_velocity=(1, 0, 0)))
    fast = space.attach(oo.Body(position=(9e7, 0, 0), linear_velocity=(1e8, 0, 0), name="fast"))
    fast.attach(oo.Placeable()).attach(oo.Sphere(0.01))
    with pytest.raises(oo.PhysicsError, match=r"Body 'fast' \(world/space/fast\).*after step 2.*position=.110000000"):
        world.step(10)
    assert world.steps == 2
    for _ in range(2):  # nothing is done as long as it is out there
        with pytest.raises(oo.PhysicsError, match="Body 'fast'"):
            world.step()
    assert world.steps == 2
    assert slow.position.x == pytest.approx(0.2)
    fast.position = (0, 5, 0)
    fast.linear_velocity = (0, 0, 0)
    world.step(2)
    assert world.steps == 4
    assert slow.position.x == pytest.approx(0.4)


def test_a_body_out_of_bounds_can_be_detached_and_put_back():
    world = oo.World(gravity=(0, 0, 0), step_size=0.1)
    fast = world.attach(oo.Body(position=(9.9e7, 0, 0), linear_velocity=(1e9, 0, 0), name="fast"))
    with pytest.raises(oo.PhysicsError, match="Body 'fast'"):
        world.step()
    world.detach(fast)
    world.step()
    assert fast.position.x > 1e8
    with pytest.raises(oo.FieldError, match=r"Body 'fast'\.position is"):
        world.attach(fast)
    assert not fast.is_live
    fast.position = (0, 0, 0)
    world.attach(fast)
    world.step()
    is_consistent(world)


def test_ends_of_touching_are_told_after_an_error_too():
    """What was detached while a body was out of bounds is still known when the World goes on."""
    world = oo.World(gravity=(0, 0, 0), step_size=0.01)
    space = world.attach(oo.SimpleSpace())
    world.collide(space)
    touching = [space.attach(oo.Body(position=(x, 0, 0))) for x in (0, 0.9)]
    for body in touching:
        body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    seen = []
    touching[0].on_touch(lambda touch: seen.append((touch.state, touch.other_body)))
    fast = space.attach(oo.Body(position=(9.9e7, 0, 0), linear_velocity=(1e9, 0, 0)))
    with pytest.raises(oo.PhysicsError):
        world.step()
    assert [state for state, _ in seen] == ["begin"]
    space.detach(touching[1])
    for _ in range(3):
        with pytest.raises(oo.PhysicsError):
            world.step()
    space.detach(fast)
    world.step()
    assert [state for state, _ in seen] == ["begin", "end"]


# -- an assert inside a step

FAILING_STEP = """
import osgode as oo, sys, pytest
from osgode.native import lib
from tests.nodes.test_world import bits, heap

def broken(**fields):
    world = heap(5, step_size=0.01, gravity=(0, -10, 0), **fields)
    space = world.children[0]
    falling = [space.attach(oo.Body(position=(50, 100, 0)))]
    pair = [space.attach(oo.Body(position=(20 + i, 5, 0), name="pair")) for i in range(2)]
    falling.append(space.attach(oo.Body(position=(60, 100, 0))))
    return world, falling, pair
"""


def run_python(code):
    """In a process of its own, since ODE's leftovers of an assert stay."""
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_an_assert_inside_a_step_is_logged_in_odes_words():
    """The error says which body it was; the log says what ODE asserted."""
    run_python(
        FAILING_STEP
        + """
import logging
said = []
class Keep(logging.Handler):
    def emit(self, record):
        said.append(record.getMessage())
logging.getLogger("osgode.ode").addHandler(Keep())
world, falling, pair = broken()
world.step()
assert said == []
oo.Hinge(*pair, axis=(0, 1, 0))
lib.dBodySetAngularVel(pair[0]._id, float("nan"), 0, 0)
with pytest.raises(oo.PhysicsError):
    world.step()
assert len(said) == 1 and "assertion" in said[0].lower(), said
"""
    )


def test_an_assert_inside_a_step_is_an_error_and_the_world_goes_on():
    """NaN is put into ODE behind the library's back: the step raises, and everything goes on from where it was."""
    run_python(
        FAILING_STEP
        + """
import gc
from osgode.native import last_error
other, reference = heap(), heap()
for solver in ("quick", "exact"):
    world, falling, pair = broken(solver=solver)
    seen = []
    for body in world.bodies:
        body.on_touch(lambda touch: seen.append((id(touch.geom), id(touch.other), touch.state)))
    world.step(150)
    other.step(20)
    joint = oo.Hinge(*pair, axis=(0, 1, 0))
    for _ in range(3):
        lib.dBodySetAngularVel(pair[0]._id, float("nan"), 0, 0)
        with pytest.raises(oo.PhysicsError, match="Body 'pair'"):
            world.step()
    steps = world.steps
    assert steps == 150
    for body in pair:
        body.position, body.rotation = (20, 5, 0), (1, 0, 0, 0)
        body.linear_velocity = body.angular_velocity = (0, 0, 0)
        body.force = body.torque = (0, 0, 0)
    speeds = [body.linear_velocity.y for body in falling]
    world.step()
    assert world.steps == steps + 1
    for body, speed in zip(falling, speeds):
        assert abs(body.linear_velocity.y - (speed - 0.1)) < 1e-9, body.linear_velocity.y - speed
    world.step(60)
    other.step(20)
    assert all(abs(v) < 1e3 for body in world.bodies for v in body.position)
    touching = set()
    for geom, met, state in seen:  # no touch begins twice, and none ends or stays that hasn't begun
        assert ((geom, met) in touching) == (state != "begin"), state
        (touching.discard if state == "end" else touching.add)((geom, met))
    assert touching
    assert "Normalize" in last_error()
    asserted = last_error()
    del world, falling, pair, body, joint
    gc.collect()
    assert oo.live_natives().worlds == 2
    assert last_error() == asserted  # all of it can be freed
reference.step(80)
assert bits(other) == bits(reference)
"""
    )


# -- one thread at a time


class Waiting:
    """The C core, whose steps take as long as a test wants."""

    def __init__(self):
        self.inside, self.go_on = threading.Event(), threading.Event()

    def __getattr__(self, name):
        return getattr(lib, name)

    def oo_run(self, world, count):
        self.inside.set()
        assert self.go_on.wait(60)
        return lib.oo_run(world, count)


TOUCHES = {
    "read a field": lambda rig: rig.bodies[0].position,
    "set a field": lambda rig: setattr(rig.bodies[0], "position", (0, 0, 0)),
    "set a field of the World": lambda rig: setattr(rig.world, "gravity", (0, 0, 0)),
    "set a default of bodies": lambda rig: setattr(rig.world, "linear_damping", 0.5),
    "step": lambda rig: rig.world.step(),
    "attach": lambda rig: rig.world.attach(oo.Body()),
    "detach": lambda rig: rig.hash.detach(rig.bodies[0]),
    "move": lambda rig: rig.bodies[0].move_to(rig.sap),
    "resize": lambda rig: setattr(rig.bodies[0].geoms[0], "size", (1, 1, 1)),
    "change bits": lambda rig: setattr(rig.bodies[0].geoms[0], "material", "ice"),
    "place": lambda rig: setattr(rig.bodies[0].children[0], "position", (1, 1, 1)),
    "push": lambda rig: rig.bodies[0].add_force((1, 0, 0)),
    "hit": lambda rig: rig.bodies[0].apply_impulse((1, 0, 0)),
    "wake": lambda rig: rig.bodies[0].wake(),
    "make a joint": lambda rig: oo.Ball(rig.bodies[0]),
    "release a joint": lambda rig: rig.joints[0].release(),
    "anchor a joint": lambda rig: setattr(rig.joints[0], "anchor", (9, 9, 9)),
    "turn a joint": lambda rig: setattr(rig.joints[0], "axis", (0, 0, 1)),
    "turn a slider": lambda rig: setattr(rig.joints[2], "axis", (0, 0, 1)),
    "read a joint": lambda rig: rig.joints[0].angle,
    "push a joint": lambda rig: rig.joints[0].add_torque(1.0),
    "give a joint a spring": lambda rig: setattr(rig.joints[1], "cfm", 0.25),
    "watch a joint": lambda rig: setattr(rig.joints[0], "feedback", True),
    "let a joint break": lambda rig: setattr(rig.joints[1], "break_force", 5.0),
    "give a joint a servo": lambda rig: setattr(rig.joints[0], "servo", oo.Servo()),
    "anchor a joint anew": lambda rig: rig.joints[1].anchor_anew(),
    "read all joints": lambda rig: rig.world.joint_states,
    "list the joints": lambda rig: rig.world.joints,
    "listen to a body": lambda rig: rig.bodies[0].on_touch(print),
    "listen to a geom": lambda rig: rig.ground.on_touch(print),
    "collide": lambda rig: rig.world.collide(rig.tree),
    "stop colliding": lambda rig: rig.world.stop_colliding(rig.hash),
    "surfaces": lambda rig: rig.world.surfaces.__setitem__(("wood", "ice"), oo.Surface(0.9)),
    "fallback": lambda rig: setattr(rig.world.surfaces, "fallback", oo.Surface(0.9)),
    "all surfaces": lambda rig: setattr(rig.world, "surfaces", oo.SurfaceTable()),
    "own surface": lambda rig: setattr(rig.ground, "surface", oo.Surface(0.9)),
    "poses": lambda rig: rig.world.poses,
    "contacts": lambda rig: rig.world.contacts,
    "velocities": lambda rig: rig.world.velocities,
    "bodies": lambda rig: rig.world.bodies,
    "bounds": lambda rig: rig.ground.bounds,
    "mass": lambda rig: setattr(rig.bodies[0].geoms[0], "mass", 7.0),
    "fix": lambda rig: setattr(rig.bodies[0], "fixed_mass", oo.Mass(3.0)),
}


def test_a_second_thread_gets_an_error_and_changes_nothing(monkeypatch):
    """Whatever it does to a World inside a step: StateError, at once, and the step goes on."""
    rig = Rig()
    fixed = oo.Fixed(rig.bodies[2])
    calls = {**TOUCHES, "fix a joint": lambda rig: fixed.fix()}
    before = (rig.world.collided, dict(rig.world.surfaces._rows), rig.world.surfaces.fallback, rig.bodies[0].joints)
    parents = {id(node): node.parents for node in rig.world.walk()}
    records = {id(node): dict(node._record) for node in rig.world.walk() if isinstance(node, oo.PhysicsNode)}
    anchors = [(dict(joint._spots), joint._rest) for joint in rig.joints]
    listeners = [list(node._touch_listeners) for node in (rig.bodies[0], rig.ground)]
    rig.world.step()
    core = Waiting()
    monkeypatch.setattr("osgode.nodes.world.lib", core)
    thread = threading.Thread(target=rig.world.step)
    thread.start()
    assert core.inside.wait(60)
    missing, messages = [], []
    try:
        for name, call in calls.items():
            try:
                call(rig)
                missing.append(name)
            except oo.StateError as error:
                messages.append(str(error))
    finally:
        core.go_on.set()
        thread.join()
    assert rig.world.steps == 2
    assert missing == []
    assert len(messages) == len(calls)
    assert all("thread" in message for message in messages)
    assert (
        rig.world.collided,
        dict(rig.world.surfaces._rows),
        rig.world.surfaces.fallback,
        rig.bodies[0].joints,
    ) == before
    assert {id(node): node.parents for node in rig.world.walk()} == parents
    assert {id(n): dict(n._record) for n in rig.world.walk() if isinstance(n, oo.PhysicsNode)} == records
    assert [(dict(joint._spots), joint._rest) for joint in rig.joints] == anchors
    assert [list(node._touch_listeners) for node in (rig.bodies[0], rig.ground)] == listeners
    is_consistent(rig.world)


def test_two_worlds_step_in_two_threads_with_the_bits_of_one():
    """Each has its own random sequence and its own threading in ODE, also with meshes, whose caches are global."""
    from tests.strategies import CUBE

    def make(seed):
        world = heap(25, seed=seed)
        space = world.children[0]
        space.attach(oo.Placeable(position=(0, 0.3, 0))).attach(oo.Trimesh(CUBE))
        for i in range(5):
            body = space.attach(oo.Body(position=(0.2 * i, 2 + i, 0)))
            body.attach(oo.Placeable()).attach(oo.Trimesh(CUBE, density=50.0))
        return world

    serial, parallel = [make(seed) for seed in range(4)], [make(seed) for seed in range(4)]
    for world in serial:
        world.step(120)
    threads = [threading.Thread(target=world.step, args=(120,)) for world in parallel]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [bits(world) for world in parallel] == [bits(world) for world in serial]


def test_a_world_may_change_threads_between_steps():
    world, reference = heap(), heap()
    reference.step(60)
    for _ in range(6):
        thread = threading.Thread(target=world.step, args=(10,))
        thread.start()
        thread.join()
    assert bits(world) == bits(reference)


def test_when_libode_was_loaded_before_the_bits_are_the_same():
    """Then ODE keeps its own random numbers, and a lock serves; nothing else changes, threads included."""
    code = """
    import ctypes, hashlib, os, sys, threading
    if sys.argv[1] == "before":
        ctypes.CDLL("libode.so.8", mode=os.RTLD_GLOBAL | os.RTLD_NOW)
    from osgode.native import lib
    from tests.nodes.test_world import bits, heap
    worlds = [heap(seed=seed) for seed in range(3)]
    threads = [threading.Thread(target=world.step, args=(100,)) for world in worlds]
    for thread in threads: thread.start()
    for thread in threads: thread.join()
    print(lib.oo_random_is_local(), hashlib.sha256(b"".join(map(bits, worlds))).hexdigest())
    """
    results = []
    for when in ("before", "after"):
        done = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(code), when],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        results.append(done.stdout.split())
    assert results[0][1] == results[1][1]
    assert results[1][0] == "1"
    assert results[0][0] == "0"


def test_a_photo_of_a_world_at_rest_does_not_change():
    """Looking at everything changes nothing."""
    rig = Rig()
    rig.world.step(5)
    before = bits(rig.world)
    first = photo(rig.world)
    assert_photos_agree(first, photo(rig.world))
    assert bits(rig.world) == before
