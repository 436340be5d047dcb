"""The World: the root of what is simulated, and the owner of its time."""

from __future__ import annotations

import logging
import math
import weakref
from time import perf_counter
from typing import TYPE_CHECKING, Any, Self, Unpack

import numpy as np

from osgode.errors import FieldError, PhysicsError, StateError, TreeError, shown
from osgode.fields import number, whole
from osgode.graph.node import Group
from osgode.materials import PUBLISHED, SurfaceTable
from osgode.maths import FloatArray, pose_matrices
from osgode.native import checked, ffi, forward_messages, lib, row_dtype
from osgode.nodes.base import PhysicsNode, physics_nodes, refuse
from osgode.nodes.body import Body
from osgode.nodes.exports import NO_TIME, Exports
from osgode.nodes.feedback import ask
from osgode.nodes.listeners import errors_of_let_go, raise_all
from osgode.nodes.queries import Queries
from osgode.nodes.realm import Realm
from osgode.nodes.spaces import Space
from osgode.nodes.touch import Ears, Listening, contact_rows, tell_touches
from osgode.nodes.worldsettings import WorldFields, WorldSettings
from osgode.scheduler import Agenda

if TYPE_CHECKING:
    from osgode.joints.base import Joint

STEP_COUNT = whole(0, 2**31)
JOINT_ROW = row_dtype("oo_joint_state")

log = logging.getLogger("osgode")


class World(Listening, Queries, Exports, WorldSettings, Group):
    """The root of a simulation: bodies and spaces attached below it exist in ODE.

    What is dropped with the World turns into plain data again and keeps its state. A World may be used by one
    thread at a time; different Worlds may step at the same time in different threads.
    """

    PARENTS = ("Group",)

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Unpack[WorldFields]) -> None:
        realm = Realm()
        realm.world_ref = weakref.ref(self)
        self._realm = realm
        self._id = realm.ptr.id
        self._pairs: list[tuple[Space, Space | None]] = []
        self._surfaces = PUBLISHED.copy()
        self._surfaces._changed = weakref.WeakMethod(self._send_surfaces)
        self._time = 0.0
        self._warned = False
        self._retired: list[tuple[int, PhysicsNode | None]] = []
        self._ripe: list[tuple[int, PhysicsNode | None]] = []
        self._touch_ears, self._collide_ears = Ears(), Ears()
        self._agenda = Agenda()
        weakref.finalize(self, realm.close).atexit = False
        super().__init__(name=name, visible=visible)
        self._set_fields({field_name: field.default for field_name, field in self.FIELDS.items()})
        self._set_fields(dict(fields))

    # -- what is in it

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies, in the order of the rows of `poses`: the last takes the place of one that leaves."""
        return tuple(self._live("bodies").bodies)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """All joints that are in effect, in the order of `joint_states`: the last takes the place of one that goes."""
        return tuple(self._live("joints").joints)

    @property
    def surfaces(self) -> SurfaceTable:
        """How each pair of materials meets: ``world.surfaces["wood", "ice"] = Surface(friction=0.05)``."""
        return self._surfaces

    @surfaces.setter
    def surfaces(self, table: SurfaceTable) -> None:
        if not isinstance(table, SurfaceTable):
            raise FieldError(f"{self.describe()}.surfaces is {shown(table)}; it must be a SurfaceTable")
        with self._live("surfaces").editing():
            self._surfaces = table.copy()
            self._surfaces._changed = weakref.WeakMethod(self._send_surfaces)
            self._send_surfaces()

    def _send_surfaces(self) -> None:
        with self._live("surfaces").editing() as realm:
            table = [surface for row in self._surfaces.matrix() for surface in row]
            rows = {surface: surface.row(self.step_size) for surface in set(table)}
            for index, surface in enumerate(table):
                checked(lib.oo_set_surface(realm.ptr, index, rows[surface], (0.0, 0.0, 0.0)), "surfaces")

    def _resized_step(self) -> None:
        self._softened()
        self._send_surfaces()
        for node in physics_nodes(self):
            node._surface_again()

    # -- what collides

    def collide(self, space: Space, other: Space | None = None) -> None:
        """From now on, test ``space`` against ``other`` in each step, or against itself.

        Without ``other`` the pairs inside ``space`` are meant, and those inside the spaces in it. A space that is
        outside of this World at the moment is left out until it comes back.

        Raises:
            TreeError: if it isn't a Space, or one contains the other.
        """
        for each in (space, other) if other is not None else (space,):
            if not isinstance(each, Space):
                raise TreeError(f"{self.describe()}.collide(): {shown(each)} is no Space")
        if other is not None:
            _check_apart(space, other)
        with self._live("collide").editing() as realm:
            if not any(_same_pair(pair, (space, other)) for pair in self._pairs):
                self._pairs.append((space, other))
                realm.pairs_changed = True

    def stop_colliding(self, space: Space, other: Space | None = None) -> None:
        """Take back what `collide` declared; nothing happens if it wasn't declared."""
        with self._live("stop_colliding").editing() as realm:
            self._pairs = [pair for pair in self._pairs if not _same_pair(pair, (space, other))]
            realm.pairs_changed = True

    @property
    def collided(self) -> tuple[tuple[Space, Space | None], ...]:
        """What `collide` declared."""
        return tuple(self._pairs)

    def _send_pairs(self, realm: Realm) -> None:
        rows: dict[tuple[Any, Any], bool] = {}
        for space, other in self._pairs:
            if space._realm is not realm or (other is not None and other._realm is not realm):
                continue
            if other is not None:
                _check_apart(space, other)
                rows[space._id, other._id] = False
            else:
                rows[space._id, ffi.NULL] = False
                for node in space.walk():
                    if isinstance(node, Space):
                        rows.setdefault((node._id, ffi.NULL), True)
        table = [(*pair, nested) for pair, nested in rows.items()]
        checked(lib.oo_set_pairs(realm.ptr, ffi.new("oo_pair[]", table), len(table)), "collide")
        realm.pairs_changed = False
        if not rows and not self._warned and any(isinstance(node, Space) for node in self.walk()):
            self._warned = True
            _log_nothing_collides(self)

    # -- time

    @property
    def time(self) -> float:
        """Simulated seconds."""
        return self._time

    @property
    def steps(self) -> int:
        """Steps done."""
        return int(self._live("steps").ptr.steps)

    def step(self, count: int = 1) -> None:
        """Simulate ``count`` steps of `step_size`.

        Each collides, moves the bodies, then tells the listeners and makes the scheduled calls that are due. All of a
        step are heard even if one raises; the error then leaves this call, and the World stays usable.

        Raises:
            PhysicsError: if a body's state is no longer finite, or it left the bounds of 1e8 m; the message names it.
            StateError: if called from inside a step, or while another thread is in one.
            FieldError: if count is not a whole number of at least 0.
        """
        if count.__class__ is not int or count != 1:  # called once a step, so the usual case is not checked at length
            count = STEP_COUNT(f"{self.describe()}.step()", "count", count)
        realm = self._live("step")
        with realm.holding():
            if realm.stepping:
                raise StateError(f"{self.describe()}.step() was called from a listener inside a step")
            realm.stepping = True
            started = perf_counter()
            realm.ptr.timings = NO_TIME
            try:
                self._step(realm, count)
            finally:
                realm.stepping = False
                self._took = perf_counter() - started

    def run(self, seconds: float | None = None, *, steps: int | None = None) -> None:
        """Simulate for a time, rounded to whole steps, or for a number of steps; see `step`."""
        if (seconds is None) == (steps is None):
            raise FieldError(f"{self.describe()}.run(): give either seconds or steps")
        if steps is None:
            steps = round(number(0.0, 1e9)(f"{self.describe()}.run()", "seconds", seconds) / self.step_size)
        self.step(steps)

    def _step(self, realm: Realm, count: int) -> None:
        ptr = realm.ptr
        left = count
        errors: list[Exception] = []
        while left:
            if realm.pairs_changed:
                self._send_pairs(realm)
            before = ptr.steps
            until_due = self._agenda.steps_until_due(before)
            realm.busy = True
            realm.ray_hits = None
            try:
                status = lib.oo_run(ptr, left if until_due is None else min(left, until_due))
            finally:
                realm.busy = False
                done = ptr.steps - before
                left -= done
                self._time += done * ptr.step_size
                forward_messages()
            if ptr.asking:
                self._ask(realm, errors)
                continue
            realm.take_back_surfaces()
            if done:
                self._tell(realm, errors)
                errors += self._agenda.make_due(ptr.steps)
            realm.broken = status == lib.OO_BROKEN
            if status < 0:
                errors.append(self._failure(realm, status))
            raise_all("several things failed in a step", errors)

    def _tell(self, realm: Realm, errors: list[Exception]) -> None:
        """After a step: tell the listeners of touches and of joints that broke. All are heard."""
        ptr = realm.ptr
        broken = [call for joint in self._overloaded(realm) for call in joint._break()] if ptr.broken_count else []
        if ptr.too_fast_count:
            self._warn_of_fast(realm)
        self._collide_ears.settle()
        ears = self._touch_ears
        try:
            if ptr.event_count and (ears.now or ears.then):
                errors += tell_touches(realm, ears)
            else:
                ears.settle()
            errors += errors_of_let_go(broken)
        finally:
            self._forget_retired(realm)

    def _failure(self, realm: Realm, status: int) -> PhysicsError:
        if realm.ptr.bad_body >= 0:
            return self._bad_body(realm.bodies[realm.ptr.bad_body])
        try:
            checked(status, f"{self.describe()} step {realm.ptr.steps + 1}")
        except PhysicsError as error:
            return error
        raise AssertionError(status)

    def _ask(self, realm: Realm, errors: list[Exception]) -> None:
        try:
            errors += ask(realm, self._collide_ears)
        except BaseException:  # a step that can't go on is as if it had not begun
            lib.oo_abandon(realm.ptr)
            raise

    def _warn_of_fast(self, realm: Realm) -> None:
        for body in realm.bodies:
            if lib.oo_body_take_warning(realm.ptr, body._index):
                log.warning(
                    "%s moves %.3g m in a step and is %.3g m thick: it may pass through things. "
                    "Set tunnelling='sweep', or a smaller step size.",
                    body.describe(),
                    math.hypot(*ffi.unpack(lib.dBodyGetLinearVel(body._id), 3)) * self.step_size,
                    2 * realm.ptr.bodies[body._index].thin,
                )

    def _overloaded(self, realm: Realm) -> list[Joint]:
        """The joints that broke in the last step."""
        indices = ffi.unpack(realm.ptr.broken_joints, realm.ptr.broken_count)
        realm.ptr.broken_count = 0
        return [joint for index in indices if (joint := realm.joint_at(index)) is not None]

    def _forget_retired(self, realm: Realm) -> None:
        """Let go of nodes whose end of touching has been told: they left before the last step but one."""
        for slot, _ in self._ripe:
            realm.forget_slot(slot)
        self._ripe, self._retired = self._retired, []

    def _bad_body(self, body: Body) -> PhysicsError:
        state = {name: tuple(getattr(body, name)) for name in ("position", "linear_velocity", "angular_velocity")}
        return PhysicsError(
            f"{body.describe()} ({body.path}) left what ODE can compute with, after step {self.steps}: "
            f"{', '.join(f'{name}={value}' for name, value in state.items())}. A body must stay within 1e8 m and "
            "1e10 m/s. Detach it, or set its position, rotation and velocities; likely causes are masses, forces or "
            "springs far too large for the step size."
        )

    # -- what the picture reads

    @property
    def poses(self) -> FloatArray:
        """The pose of each body after the last step: (n, 7) of x y z and quaternion w x y z, read-only.

        In the order of `bodies`. A view on a table that each step overwrites; fetch it again when bodies have come
        or gone.
        """
        realm = self._live("poses")
        return _view(realm.poses, realm.body_count)

    @property
    def previous_poses(self) -> FloatArray:
        """The same after the step before the last."""
        realm = self._live("previous_poses")
        return _view(realm.previous, realm.body_count)

    @property
    def velocities(self) -> FloatArray:
        """A new array of the linear (of the frame's origin) and angular velocity of each body: (n, 6)."""
        realm = self._live("velocities")
        out = np.empty((realm.body_count, 6))
        lib.oo_export_velocities(realm.ptr, ffi.cast("double *", out.ctypes.data))
        return out

    @property
    def joint_states(self) -> np.ndarray[Any, np.dtype[Any]]:
        """What each joint of `joints` reads, as a new structured array of one row a joint.

        ``position`` and ``rate``: (3,) each, the angles (rad), positions (m) and their rates in the order in which the
        kind's page of the reference lists them, 0 where there are fewer. ``force1``, ``torque1``, ``force2``,
        ``torque2``, ``torque``: as in `Reaction`, of the last step; 0 for joints without feedback.
        """
        realm = self._live("joint_states")
        out = np.empty(realm.ptr.joint_count, JOINT_ROW)
        lib.oo_export_joints(realm.ptr, ffi.cast("oo_joint_state *", out.ctypes.data))
        return out

    @property
    def contacts(self) -> np.ndarray[Any, np.dtype[Any]]:
        """A copy of the contacts of the last step, as a structured array.

        ``geom.pos``, ``geom.normal`` (out of the second geom) and ``geom.depth`` of each; ``slot1`` and ``slot2``
        say which geoms (`geom_of_slot`); ``force`` (N, on the first) where somebody listens. Hits of rays are among
        them: there ``slot1`` is the ray's, ``depth`` is the distance, and ``surface`` is ``0x7fffffff``: no response.
        """
        realm = self._live("contacts")
        rows = contact_rows(realm)
        return np.compress(rows["surface"] != lib.OO_REFUSED, rows)

    def geom_of_slot(self, slot: int) -> PhysicsNode | None:
        """The geom that a contact row names, None if it is gone."""
        slot = STEP_COUNT(f"{self.describe()}.geom_of_slot()", "slot", slot)
        return self._live("geom_of_slot").node_of_slot(slot)

    def interpolated_poses(self, interpolation: float, row: int | None = None) -> FloatArray:
        """Poses between the step before the last (0) and the last (1): (n, 7), or (1, 7) of one row."""
        rows = slice(None) if row is None else slice(row, row + 1)
        last = self.poses[rows]
        if interpolation >= 1.0:
            return last
        before = self.previous_poses[rows]
        mixed = before + (last - before) * interpolation
        q = mixed[:, 3:]
        # The shorter way round: q and -q are the same rotation.
        turned = np.einsum("ni,ni->n", before[:, 3:], last[:, 3:]) < 0
        if turned.any():
            q[turned] = before[turned, 3:] * (interpolation - 1.0) + last[turned, 3:] * interpolation
        q /= np.sqrt(np.einsum("ni,ni->n", q, q))[:, None]
        return mixed

    def matrices(self, interpolation: float) -> FloatArray:
        """The same as matrices from body to world axes: (n, 4, 4). The picture is drawn from these."""
        poses = self.interpolated_poses(interpolation)
        return pose_matrices(poses[:, :3], poses[:, 3:])

    def _native_space(self) -> Any:
        return ffi.NULL

    # -- it is never outside of itself

    def _check_place(self, parent: Group) -> None:
        super()._check_place(parent)
        if isinstance(parent, PhysicsNode) or any(isinstance(node, PhysicsNode) for node in parent.ancestors):
            raise refuse(self, parent, "a World may stand under purely visual groups only")

    def copy(self) -> Self:
        """A World can't be copied.

        Raises:
            StateError: always; copy what is below it.
        """
        raise StateError(f"{self.describe()} can't be copied; copy the bodies and spaces below it")

    def _linked(self, parent: Group) -> None:
        """Nothing: a World lives by itself."""

    def _unlinking(self, parent: Group) -> None:
        """Nothing: a World lives by itself."""

    def _unlinked(self, parent: Group) -> None:
        """Nothing: a World lives by itself."""


def _view(table: FloatArray, count: int) -> FloatArray:
    view = table[:count]
    view.flags.writeable = False
    return view


def _same_pair(pair: tuple[Space, Space | None], other: tuple[Space, Space | None]) -> bool:
    return {id(pair[0]), id(pair[1])} == {id(other[0]), id(other[1])}


def _check_apart(space: Space, other: Space) -> None:
    if space is other or space in list(other.ancestors) or other in list(space.ancestors):
        raise TreeError(
            f"{space.describe()} and {other.describe()} can't be collided with each other: one is in the other"
        )


def _log_nothing_collides(world: World) -> None:
    log.warning(
        "%s has spaces but was told to collide none of them: things will pass through each other. "
        "Call world.collide(space), or world.collide(moving, fixed).",
        world.describe(),
    )
