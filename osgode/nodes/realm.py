"""The one owner of everything that a World has in ODE."""

from __future__ import annotations

import threading
import weakref
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from osgode.errors import PhysicsError, StateError
from osgode.maths import FloatArray, Vec3Like
from osgode.native import ffi, lib

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from osgode.joints.base import Joint
    from osgode.materials import Surface
    from osgode.nodes.base import PhysicsNode
    from osgode.nodes.body import Body
    from osgode.nodes.world import World

POSE_WIDTH = 7


class Held:
    """Lets go of a lock that is held."""

    __slots__ = ("_lock",)

    def __init__(self, lock: Any) -> None:
        self._lock = lock

    def __enter__(self) -> None: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._lock.release()


class Realm:
    """The natives of one World, the tables that C writes, and who may touch them.

    A live node holds its Realm, never its World: so a World goes when its last outside reference goes, and
    its finalizer closes the Realm. That turns the nodes that are still referred to into plain data and
    frees every native. Nothing else in osgode has a finalizer.

    Python holds the finalizer, and so the Realm, for as long as the World exists. So the Realm refers to nodes
    weakly: a listener that knows its World is an ordinary circle, and the garbage collector finds it.
    """

    def __init__(self) -> None:
        self.ptr: Any = lib.oo_world_new()
        if self.ptr == ffi.NULL:
            raise PhysicsError("a World can't be made: out of memory, or ODE refused")
        self.world_ref: weakref.ref[World] | None = None
        self.busy = False
        self.stepping = False
        self.broken = False
        self.members: weakref.WeakKeyDictionary[PhysicsNode | Any, None] = weakref.WeakKeyDictionary()
        self._bodies: list[weakref.ref[Body]] = []
        self._joints: list[weakref.ref[Joint]] = []
        self._geoms: list[weakref.ref[PhysicsNode] | None] = []
        self.inherited: dict[str, Any] = {}
        self.pairs_changed = False
        self._lock = threading.RLock()
        self._held = Held(self._lock)
        self._shared: dict[tuple[int, int], tuple[Any, object, int]] = {}
        self.ray_hits: dict[int, Any] | None = None
        self._own_surfaces: list[int] = []
        self._lent: dict[Surface, int] = {}
        self.removals = 0  # of geoms and spaces, since the beginning
        self.poses: FloatArray = np.zeros((0, POSE_WIDTH))
        self.previous: FloatArray = np.zeros((0, POSE_WIDTH))
        self._grow_tables(16)

    # -- one thread at a time

    def editing(self) -> Realm:
        """Hold the World for a change: ``with realm.editing():``. The next step looks at everything anew.

        Raises:
            StateError: as `holding`.
            PhysicsError: as `holding`.
        """
        self.holding()
        return self

    def holding(self) -> Held:
        """Hold the World for a step, a question, or what does nothing to bodies but push and wake them.

        For use as ``with realm.holding():``, but it holds from this call on.

        Raises:
            StateError: if another thread is changing or stepping it.
            PhysicsError: if an assert has left a space locked, so that any change would end the process.
        """
        if self.broken:
            raise PhysicsError(
                "an ODE assert while colliding left this World unusable; make a new one. What stands in this one "
                "can be read, and is free with its state once the World is dropped"
            )
        if not self._lock.acquire(blocking=False):
            raise StateError(
                "another thread is stepping or changing this World; use one thread per World, or wait for it to be done"
            )
        return self._held

    def __enter__(self) -> Self:
        self.ptr.edited = 1
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.ptr is not None:  # it may have been closed
            self.ptr.edited = 1  # again: the block may have asked questions in between
        self._lock.release()

    # -- bodies

    def add_body(self, body: Body) -> int:
        """Make a native body and return its index in the tables."""
        if len(self._bodies) == len(self.poses):
            self._grow_tables(len(self.poses) + max(16, len(self.poses) // 4))
        index: int = lib.oo_body_new(self.ptr)
        if index >= 0:
            self._bodies.append(weakref.ref(body))
        return index

    @property
    def bodies(self) -> list[Body]:
        """All bodies, in the order of the tables."""
        return [body for ref in self._bodies if (body := ref()) is not None]

    @property
    def body_count(self) -> int:
        """How many rows of the tables are in use."""
        return len(self._bodies)

    def remove_body(self, index: int) -> None:
        """Free a native body; the last one takes its place in the tables."""
        lib.oo_body_free(self.ptr, index)
        last = self._bodies.pop()
        if index < len(self._bodies):
            self._bodies[index] = last
            if (body := last()) is not None:
                body._index = index
                body._touch()

    def _grow_tables(self, capacity: int) -> None:
        count = len(self._bodies)
        for name in ("poses", "previous"):
            grown = np.zeros((capacity, POSE_WIDTH))
            grown[:count] = getattr(self, name)[:count]
            setattr(self, name, grown)
            setattr(self.ptr, name, ffi.cast("double *", grown.ctypes.data))
        self.ptr.table_capacity = capacity

    # -- joints

    def add_joint(self, joint: Joint) -> None:
        """Note the joint whose native was made last."""
        self.members[joint] = None
        self._joints.append(weakref.ref(joint))

    @property
    def joints(self) -> list[Joint]:
        """All joints, in the order of the C core."""
        return [joint for ref in self._joints if (joint := ref()) is not None]

    def joint_at(self, index: int) -> Joint | None:
        """The joint at an index of the C core, None if it is gone."""
        return self._joints[index]()

    def remove_joint(self, joint: Joint, native: Any) -> None:
        """Free a native joint; the last one takes its place."""
        del self.members[joint]
        last = self._joints.pop()
        if native.index < len(self._joints):
            self._joints[native.index] = last
        lib.oo_joint_free(self.ptr, native)

    # -- geoms and spaces

    def add_slot(self, slot: int, node: PhysicsNode) -> None:
        """Note which node a slot of the C core belongs to."""
        while len(self._geoms) <= slot:
            self._geoms.append(None)
        self._geoms[slot] = weakref.ref(node)

    def node_of_slot(self, slot: int) -> PhysicsNode | None:
        """The geom or space that has or last had a slot, None if it is gone."""
        ref = self._geoms[slot] if 0 <= slot < len(self._geoms) else None
        return None if ref is None else ref()

    @property
    def nodes_by_slot(self) -> list[Any]:
        """Weak references to the geoms and spaces that have or last had each slot; those that a touch names exist."""
        return self._geoms

    def remove_slot(self, slot: int) -> None:
        """Free a native geom or space. The next step may still report that it is no longer touched."""
        is_space = self.ptr.geoms[slot].flags & lib.OO_IS_SPACE
        lib.oo_geom_free(self.ptr, slot)
        self.removals += 1
        world = None if self.world_ref is None else self.world_ref()
        if world is not None and not is_space:
            world._retired.append((slot, self.node_of_slot(slot)))
            world._touch_ears.set(slot, ())
            world._collide_ears.set(slot, ())

    def forget_slot(self, slot: int) -> None:
        """No longer know which node had a slot, unless it has been given to another."""
        if not self.ptr.geoms[slot].flags & lib.OO_ALIVE:
            self._geoms[slot] = None

    # -- what geoms are made from and share, and surfaces

    def take_shared(self, data: object, kind: int, make: Callable[[Any], Any]) -> Any:
        """The native of ``data``, made for the first geom of that ``kind`` that uses it; NULL if ODE refused.

        ``make`` makes it, given the C core's world.
        """
        native, _, uses = self._shared.get((id(data), kind), (None, data, 0))
        if native is None:
            native = make(self.ptr)
            if native == ffi.NULL:
                return native
        self._shared[id(data), kind] = (native, data, uses + 1)
        return native

    def give_shared(self, data: object, kind: int) -> None:
        """Free the native of ``data`` with the last geom of that ``kind`` that used it."""
        native, _, uses = self._shared.pop((id(data), kind))
        if uses > 1:
            self._shared[id(data), kind] = (native, data, uses - 1)
        else:
            lib.oo_mesh_free(self.ptr, native)

    def take_surface(self, row: Any, direction: Vec3Like = (0.0, 0.0, 0.0)) -> int:
        """A place for the surface of one geom in the C core's table, behind those of the pairs."""
        index = self._own_surfaces.pop() if self._own_surfaces else self.ptr.surface_count
        if lib.oo_set_surface(self.ptr, index, row, tuple(direction)) != lib.OO_OK:
            raise PhysicsError("out of memory")
        return int(index)

    def give_surface(self, index: int) -> None:
        """Give that place back."""
        self._own_surfaces.append(index)

    def lend_surface(self, surface: Surface) -> int:
        """The same until the end of the step."""
        if surface not in self._lent:
            self._lent[surface] = self.take_surface(surface.row(self.ptr.step_size))
        return self._lent[surface]

    def take_back_surfaces(self) -> None:
        """At the end of the step."""
        self._own_surfaces += self._lent.values()
        self._lent.clear()

    # -- the end

    def close(self) -> None:
        """Turn every live node into plain data and free all natives."""
        self.broken = False  # what goes may go; C leaks what it can't free
        lib.oo_forget_contacts(self.ptr)  # so that nothing is woken by what goes
        for node in reversed(list(self.members)):
            node._leave()
        lib.oo_world_free(self.ptr)
        self.ptr = None
        self.busy = True  # a node that is garbage itself, and has a __del__, must not reach ODE any more
