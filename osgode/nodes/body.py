"""Rigid bodies: transforms that the simulation moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from osgode.fields import POSITION_LIMIT, UNFIT, Check, vector
from osgode.graph.transforms import PoseSource, Transform
from osgode.maths import ZERO, FloatArray, Pose, Quat, Vec3, Vec3Like, quat, vec3
from osgode.native import ffi, lib
from osgode.nodes.bodystate import (
    FORCE_LIMIT,
    BodyFields,
)
from osgode.nodes.realm import Realm
from osgode.nodes.touch import Listening
from osgode.nodes.tunnelling import Tunnelling

if TYPE_CHECKING:
    from osgode.joints.base import Joint

POINT, PUSH = vector(POSITION_LIMIT), vector(FORCE_LIMIT)


class Body(Listening, Tunnelling, Transform):
    """A rigid body: parts placed below it by Placeables move as one.

    Its frame is the one that its author placed: `position` and `rotation` are that frame's, and
    `linear_velocity` is the velocity of the frame's origin, wherever the centre of mass may be. The mass is
    the sum of the masses of the geoms below (see `mass_properties`).
    A `kinematic` one is moved by its velocities alone, or glides where it is told to (see `glide_to`).

    Directly under a World a body moves, but its geoms are in no space and touch nothing.
    """

    PARENTS = ("Space", "World")

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Unpack[BodyFields]) -> None:
        super().__init__(name=name, visible=visible, **fields)

    def _start(self) -> None:
        super()._start()
        self._id: Any = None
        self._index = -1

    # -- pose

    def local_matrix(self) -> FloatArray:
        """The 4x4 matrix from body axes to world axes, live."""
        return self.pose.matrix()

    def pose_row(self) -> tuple[PoseSource, int] | None:
        """The World and the row of its pose tables, or None outside of a World."""
        world = self.world
        return None if world is None else (world, self._index)

    def interpolated_pose(self, interpolation: float) -> Pose:
        """The pose between the step before the last (0) and the last (1): what a picture shows.

        Outside of a World, where nothing moves, `pose`.
        """
        world = self.world
        if world is None:
            return self.pose
        realm = self._live("interpolated_pose")
        last = realm.poses[self._index].tolist()
        if interpolation >= 1.0:
            return Pose(vec3(last[:3]), quat(last[3:]))
        before = realm.previous[self._index].tolist()
        # As `World.interpolated_poses`, without numpy: it takes several times as long for a single row.
        x, y, z, *turn = (one + (other - one) * interpolation for one, other in zip(before, last, strict=True))
        if sum(one * other for one, other in zip(before[3:], last[3:], strict=True)) < 0.0:  # the shorter way round
            turn = [
                one * (interpolation - 1.0) + other * interpolation
                for one, other in zip(before[3:], last[3:], strict=True)
            ]
        return Pose(Vec3(x, y, z), Quat(*turn).normalized())

    # -- acting on it

    def add_force(self, force: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """Push with ``force`` (N, world axes) in the next step, at the centre of mass or ``at`` a point of the world.

        Raises:
            FieldError: for numbers that are not finite.
            StateError: outside of a World.
        """
        f = self._argument("add_force", "force", force, PUSH)
        with self._live("add_force").holding():
            if at is None:
                lib.dBodyAddForce(self._id, *f)
            else:
                lib.dBodyAddForceAtPos(self._id, *f, *self._argument("add_force", "at", at, POINT))
            lib.dBodyEnable(self._id)

    def add_local_force(self, force: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """The same with ``force`` along body axes and ``at`` in the body's frame."""
        f = self._argument("add_local_force", "force", force, PUSH)
        point = None if at is None else self.local_to_world(self._argument("add_local_force", "at", at, POINT))
        self.add_force(self.vector_to_world(f), at=point)

    def add_torque(self, torque: Vec3Like) -> None:
        """Turn with ``torque`` (N m, world axes) during the next step."""
        t = self._argument("add_torque", "torque", torque, PUSH)
        with self._live("add_torque").holding():
            lib.dBodyAddTorque(self._id, *t)
            lib.dBodyEnable(self._id)

    def add_local_torque(self, torque: Vec3Like) -> None:
        """The same with ``torque`` along body axes."""
        self.add_torque(self.vector_to_world(self._argument("add_local_torque", "torque", torque, PUSH)))

    def apply_impulse(self, impulse: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """Change the velocities at once, as a hit of ``impulse`` (N s, world axes) does.

        The hit is at the centre of mass, or ``at`` a point of the world: ``dv = J / m``, ``dw = I^-1 (r x J)``.
        """
        j = self._argument("apply_impulse", "impulse", impulse, PUSH)
        arm = ZERO if at is None else self._argument("apply_impulse", "at", at, POINT) - self.world_centre_of_mass
        self._kick("apply_impulse", j, arm.cross(j))

    def apply_angular_impulse(self, impulse: Vec3Like) -> None:
        """Change the angular velocity at once, as a twist of ``impulse`` (N m s, world axes) does."""
        self._kick("apply_angular_impulse", ZERO, self._argument("apply_angular_impulse", "impulse", impulse, PUSH))

    def apply_local_impulse(self, impulse: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """As `apply_impulse`, with ``impulse`` along body axes and ``at`` in the body's frame."""
        j = self._argument("apply_local_impulse", "impulse", impulse, PUSH)
        point = None if at is None else self.local_to_world(self._argument("apply_local_impulse", "at", at, POINT))
        self.apply_impulse(self.vector_to_world(j), at=point)

    def apply_local_angular_impulse(self, impulse: Vec3Like) -> None:
        """As `apply_angular_impulse`, with ``impulse`` along body axes."""
        j = self._argument("apply_local_angular_impulse", "impulse", impulse, PUSH)
        self.apply_angular_impulse(self.vector_to_world(j))

    def _kick(self, doing: str, linear: Vec3, angular: Vec3) -> None:
        with self._live(doing).holding():
            if self.kinematic:
                return
            properties = self.mass_properties
            turn = np.array(self.rotation.to_matrix())
            spin = turn @ np.linalg.solve(np.array(properties.inertia), turn.T @ np.array(angular))
            centre = Vec3(*ffi.unpack(lib.dBodyGetLinearVel(self._id), 3)) + linear / properties.mass
            turning = self.angular_velocity + tuple(map(float, spin))
            for name, value in (("linear_velocity", centre), ("angular_velocity", turning)):
                self.FIELDS[name].check(self.describe(), name, value)
            lib.dBodySetAngularVel(self._id, *turning)
            lib.dBodySetLinearVel(self._id, *centre)
            lib.dBodyEnable(self._id)

    def _argument(self, call: str, name: str, value: Vec3Like, check: Check[Vec3]) -> Vec3:
        try:
            return check.convert(value)
        except UNFIT:
            return check(f"{self.describe()}.{call}()", name, value)  # raises, and says of what

    @property
    def asleep(self) -> bool:
        """Whether it sleeps: it came to rest, or `enabled` was set to False."""
        return not self.enabled

    def wake(self) -> None:
        """Let it move again if it has fallen asleep; pushes, hits and set velocities do so too."""
        realm = self._realm
        if realm is not None:
            with realm.holding():
                lib.dBodyEnable(self._id)

    # -- joints and touching

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The joints that hold this body."""
        return tuple(self._joints)

    # -- entering and leaving

    def _enter(self, realm: Realm) -> None:
        index = self._made(realm.add_body(self))
        self._index = index
        self._id = realm.ptr.bodies[index].id
        super()._enter(realm)
        self._enter_mass()
        self._enter_fields()
        self._snap()

    def _settle(self) -> None:
        super()._settle()
        for joint in self._joints:
            joint._sync()

    def _leave(self) -> None:
        realm = self._live("changing it")
        for joint in self._joints:
            if not joint.is_live:
                continue
            joint._drop()
            for other in joint._bodies:
                if other is not self:
                    other.wake()
        self._halt()
        self._leave_fields()
        super()._leave()
        realm.remove_body(self._index)
        self._id = None
        self._index = -1
        self._com = ZERO
