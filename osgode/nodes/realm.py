"""The one owner of everything that a World has in ODE."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from osgode.errors import PhysicsError, StateError
from osgode.maths import FloatArray
from osgode.native import ffi, lib

if TYPE_CHECKING:
    import weakref
    from types import TracebackType

    from osgode.nodes.base import PhysicsNode
    from osgode.nodes.body import Body
    from osgode.nodes.meshdata import MeshData
    from osgode.nodes.world import World

POSE_WIDTH = 7


class Realm:
    """The natives of one World, the tables that C writes, and who may touch them.

    A live node holds its Realm, never its World: so a World goes when its last outside reference goes, and
    its finalizer closes the Realm. That turns the nodes that are still referred to into plain data and
    frees every native. Nothing else in osgode has a finalizer.
    """

    def __init__(self) -> None:
        self.ptr: Any = lib.oo_world_new()
        if self.ptr == ffi.NULL:
            raise PhysicsError("a World can't be made: out of memory, or ODE refused")
        self.world_ref: weakref.ref[World] | None = None
        self.busy = False
        self.stepping = False
        self.members: dict[PhysicsNode | Any, None] = {}
        self.bodies: list[Body] = []
        self.geoms: list[PhysicsNode | None] = []
        self.inherited: dict[str, Any] = {}
        self.pairs_changed = False
        self._retired: list[int] = []
        self._ripe: list[int] = []
        self._lock = threading.RLock()
        self._meshes: dict[int, tuple[Any, MeshData, int]] = {}
        self._own_surfaces: list[int] = []
        self.poses: FloatArray = np.zeros((0, POSE_WIDTH))
        self.previous: FloatArray = np.zeros((0, POSE_WIDTH))
        self._grow_tables(16)

    # -- one thread at a time

    def editing(self) -> Realm:
        """Hold the World for a change: ``with realm.editing():``.

        Raises:
            StateError: if another thread is changing or stepping it.
        """
        if not self._lock.acquire(blocking=False):
            raise StateError(
                "another thread is stepping or changing this World; use one thread per World, or wait for it to be done"
            )
        return self

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._lock.release()

    # -- bodies

    def add_body(self, body: Body) -> int:
        """Make a native body and return its index in the tables."""
        if len(self.bodies) == len(self.poses):
            self._grow_tables(2 * len(self.poses))
        index: int = lib.oo_body_new(self.ptr)
        if index >= 0:
            self.bodies.append(body)
        return index

    def remove_body(self, index: int) -> None:
        """Free a native body; the last one takes its place in the tables."""
        lib.oo_body_free(self.ptr, index)
        last = self.bodies.pop()
        if index < len(self.bodies):
            self.bodies[index] = last
            last._index = index
            last._touch()

    def _grow_tables(self, capacity: int) -> None:
        count = len(self.bodies)
        for name in ("poses", "previous"):
            grown = np.zeros((capacity, POSE_WIDTH))
            grown[:count] = getattr(self, name)[:count]
            setattr(self, name, grown)
            setattr(self.ptr, name, ffi.cast("double *", grown.ctypes.data))
        self.ptr.table_capacity = capacity

    # -- geoms and spaces

    def add_slot(self, slot: int, node: PhysicsNode) -> None:
        """Note which node a slot of the C core belongs to."""
        while len(self.geoms) <= slot:
            self.geoms.append(None)
        self.geoms[slot] = node

    def remove_slot(self, slot: int) -> None:
        """Free a native geom or space. The next step may still report that it is no longer touched."""
        lib.oo_geom_free(self.ptr, slot)
        self._retired.append(slot)

    def forget_retired(self) -> None:
        """Let go of nodes whose end of touching has been told: call it when the events of a step are read."""
        for slot in self._ripe:
            if not self.ptr.geoms[slot].flags & lib.OO_ALIVE:
                self.geoms[slot] = None
        self._ripe, self._retired = self._retired, []

    # -- meshes and surfaces, shared by geoms

    def take_mesh(self, data: MeshData) -> Any:
        """The native of mesh data, made for the first geom that uses it; NULL if ODE refused."""
        native, _, uses = self._meshes.get(id(data), (None, data, 0))
        if native is None:
            vertices, triangles = data.vertices, data.triangles
            native = lib.oo_mesh_new(
                self.ptr,
                ffi.cast("double *", vertices.ctypes.data),
                len(vertices),
                ffi.cast("unsigned int *", triangles.ctypes.data),
                len(triangles),
            )
            if native == ffi.NULL:
                return native
        self._meshes[id(data)] = (native, data, uses + 1)
        return native

    def give_mesh(self, data: MeshData) -> None:
        """Free the native of mesh data with the last geom that used it."""
        native, _, uses = self._meshes.pop(id(data))
        if uses > 1:
            self._meshes[id(data)] = (native, data, uses - 1)
        else:
            lib.oo_mesh_free(self.ptr, native)

    def take_surface(self, row: Any) -> int:
        """A place for the surface of one geom in the C core's table, behind those of the pairs."""
        index = self._own_surfaces.pop() if self._own_surfaces else self.ptr.surface_count
        if lib.oo_set_surface(self.ptr, index, row) != lib.OO_OK:
            raise PhysicsError("out of memory")
        return int(index)

    def give_surface(self, index: int) -> None:
        """Give that place back."""
        self._own_surfaces.append(index)

    # -- the end

    def close(self) -> None:
        """Turn every live node into plain data and free all natives."""
        self.ptr.contact_count = 0  # so that nothing is woken by what goes
        for node in reversed(list(self.members)):
            node._leave()
        lib.oo_world_free(self.ptr)
        self.ptr = None
