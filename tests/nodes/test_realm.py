"""The one owner of a World's natives: who may change it when, its tables, and its end."""

import gc
import threading

import pytest

import osgode as oo
from osgode.native import ffi, lib
from tests.strategies import CUBE


def elsewhere(call):
    """The result of a call in another thread, or its error."""
    out = []

    def run():
        try:
            out.append(call())
        except oo.OsgodeError as error:
            out.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return out[0]


def test_one_thread_changes_a_world_at_a_time():
    """The same one may go deeper; another gets an error at once instead of waiting."""
    world = oo.World()
    realm = world._realm
    with realm.editing(), realm.editing():
        error = elsewhere(lambda: world.attach(oo.Body()))
        assert isinstance(error, oo.StateError)
        assert "another thread" in str(error)
        assert isinstance(elsewhere(lambda: setattr(world, "gravity", (0, 0, 0))), oo.StateError)
        assert isinstance(elsewhere(world.step), oo.StateError)
        assert elsewhere(lambda: world.gravity) == world.gravity  # reading is allowed: it is not inside a step
    assert elsewhere(lambda: world.attach(oo.Body())).is_live


def test_an_error_gives_the_world_back():
    world = oo.World()
    with pytest.raises(oo.TreeError):
        world.attach(oo.Box())
    with pytest.raises(oo.FieldError):
        world.attach(oo.Body()).position = None
    assert elsewhere(lambda: world.attach(oo.Body())).is_live


def test_nothing_is_asked_while_it_is_busy():
    world = oo.World()
    body = world.attach(oo.Body(name="it"))
    world._realm.busy = True
    for call in (
        lambda: body.position,
        lambda: world.gravity,
        lambda: world.poses,
        lambda: world.joints,
        body.add_force,
    ):
        with pytest.raises((oo.StateError, TypeError), match=r"another thread|missing"):
            call()
    world._realm.busy = False
    assert body.position == (0, 0, 0)


def test_the_last_body_takes_the_place_of_one_that_leaves():
    """In C, in Python, and in what each body knows."""
    world = oo.World()
    bodies = [world.attach(oo.Body(position=(i, 0, 0))) for i in range(5)]
    world.detach(bodies[1])
    assert world.bodies == (bodies[0], bodies[4], bodies[2], bodies[3])
    assert [body._index for body in world.bodies] == [0, 1, 2, 3]
    ptr = world._realm.ptr
    for i, body in enumerate(world.bodies):
        assert ptr.bodies[i].id == body._id
        assert ptr.poses[7 * i] == body.position.x
    world.detach(bodies[3])
    assert world.bodies == (bodies[0], bodies[4], bodies[2])


def test_the_tables_of_python_are_those_of_c():
    world = oo.World()
    for _ in range(70):
        world.attach(oo.Body())
        realm = world._realm
        assert int(ffi.cast("size_t", realm.ptr.poses)) == realm.poses.ctypes.data
        assert int(ffi.cast("size_t", realm.ptr.previous)) == realm.previous.ctypes.data
        assert realm.ptr.table_capacity == len(realm.poses) >= realm.body_count == realm.ptr.body_count


def test_raw_poses_come_and_go_to_the_bit():
    """What ODE's own setters would round."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body(angular_velocity=(1, 2, 3), position=(0.1, 0.2, 0.3)))
    world.step(7)
    first, second = ffi.new("double[19]"), ffi.new("double[19]")
    lib.oo_body_read_raw(world._realm.ptr, 0, first)
    body.position, body.rotation = (5, 6, 7), (0, 1, 0, 0)
    lib.oo_body_write_raw(world._realm.ptr, 0, first)
    lib.oo_body_read_raw(world._realm.ptr, 0, second)
    assert bytes(ffi.buffer(first)) == bytes(ffi.buffer(second))


def test_a_closed_realm_has_no_natives_and_no_members():
    world = oo.World()
    space = world.attach(oo.HashSpace())
    body = space.attach(oo.Body())
    body.attach(oo.Placeable()).attach(oo.Trimesh(CUBE, surface=oo.Surface(0.25)))
    joint = oo.Hinge(body)
    realm = world._realm
    del world
    gc.collect()
    assert realm.ptr is None
    assert realm.busy
    assert list(realm.members) == []
    assert realm.bodies == []
    for node in (space, body, joint, *body.geoms):
        assert node._realm is None


def test_a_world_can_not_be_made_without_memory(monkeypatch):
    from osgode.nodes import realm

    class Poor:
        def __getattr__(self, name):
            return (lambda: ffi.NULL) if name == "oo_world_new" else getattr(lib, name)

    monkeypatch.setattr(realm, "lib", Poor())
    with pytest.raises(oo.PhysicsError, match="World can't be made"):
        oo.World()
