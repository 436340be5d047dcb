"""Rigid bodies: transforms that the simulation moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from osgode.fields import POSITION_LIMIT, vector
from osgode.graph.transforms import PoseSource, Transform
from osgode.mass import Mass
from osgode.maths import ZERO, FloatArray, Pose, Vec3, Vec3Like
from osgode.native import checked, ffi, lib
from osgode.nodes.base import physics_nodes
from osgode.nodes.bodystate import (
    FORCE_LIMIT,
    BodyFields,
    BodyState,
    read_linear,
    read_position,
    write_linear,
    write_position,
)
from osgode.nodes.realm import Realm
from osgode.nodes.touch import Listening

if TYPE_CHECKING:
    from osgode.joints.base import Joint
    from osgode.nodes.geom import Geom

MASSLESS = Mass(1.0)
"""What a body has in which nothing has mass: 1 kg and unit inertia, as a new body in ODE."""


class Body(Listening, BodyState, Transform):
    """A rigid body: parts placed below it by Placeables move as one.

    Its frame is the one that its author placed: `position` and `rotation` are that frame's, and
    `linear_velocity` is the velocity of the frame's origin, wherever the centre of mass may be. The mass is
    the sum of the masses of the geoms below (see `mass_properties`).

    Directly under a World a body moves, but its geoms are in no space and touch nothing.
    """

    PARENTS = ("Space", "World")

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Unpack[BodyFields]) -> None:
        super().__init__(name=name, visible=visible, **fields)

    def _start(self) -> None:
        self._id: Any = None
        self._index = -1
        self._com = ZERO
        self._joints: list[Joint] = []

    # -- pose

    @property
    def body(self) -> Body:
        """Itself."""
        return self

    @property
    def pose(self) -> Pose:
        """Position and rotation of the body's frame."""
        return Pose(self.position, self.rotation)

    def local_matrix(self) -> FloatArray:
        """The 4x4 matrix from body axes to world axes, live."""
        return self.pose.matrix()

    def pose_row(self) -> tuple[PoseSource, int] | None:
        """The World and the row of its pose tables, or None outside of a World."""
        world = self.world
        return None if world is None else (world, self._index)

    def local_to_world(self, point: Vec3Like) -> Vec3:
        """A point of the body's frame in the world, metres."""
        return self.pose.transform(point)

    def world_to_local(self, point: Vec3Like) -> Vec3:
        """A point of the world in the body's frame, metres."""
        return self.pose.inverse().transform(point)

    def vector_to_world(self, vector: Vec3Like) -> Vec3:
        """A direction in body axes, turned to world axes."""
        return self.rotation.rotate(vector)

    def vector_to_local(self, vector: Vec3Like) -> Vec3:
        """A direction in world axes, turned to body axes."""
        return self.rotation.conjugate().rotate(vector)

    def velocity_at(self, point: Vec3Like) -> Vec3:
        """The velocity (m/s) of the material point of the body that is at ``point`` of the world now."""
        return self.linear_velocity + self.angular_velocity.cross(Vec3(*point) - self.position)

    # -- mass

    @property
    def geoms(self) -> tuple[Geom, ...]:
        """The geoms that are parts of this body."""
        from osgode.nodes.geom import Geom

        return tuple(node for node in physics_nodes(self) if isinstance(node, Geom))

    @property
    def mass_properties(self) -> Mass:
        """Mass, centre of mass and inertia in the body's frame: `fixed_mass`, or the sum of its parts.

        A body without any mass has 1 kg and unit inertia at its origin.

        Raises:
            FieldError: if a part has no volume (an open mesh) or the sum is out of ODE's range.
        """
        if self.fixed_mass is not None:
            return self.fixed_mass
        total: Mass | None = None
        for geom in self.geoms:
            part = geom.part_mass
            if part is not None:
                total = part if total is None else total + part
        return total or MASSLESS

    @property
    def mass(self) -> float:
        """The whole mass, kg."""
        return self.mass_properties.mass

    @property
    def inertia(self) -> FloatArray:
        """The inertia tensor about the centre of mass along body axes: (3, 3), kg m2."""
        return np.array(self.mass_properties.inertia)

    @property
    def centre_of_mass(self) -> Vec3:
        """The centre of mass in the body's frame, metres."""
        return self.mass_properties.centre

    @property
    def world_centre_of_mass(self) -> Vec3:
        """The centre of mass in the world, metres."""
        return self.local_to_world(self.centre_of_mass)

    @property
    def momentum(self) -> Vec3:
        """Mass times velocity of the centre of mass, kg m/s."""
        return self.velocity_at(self.world_centre_of_mass) * self.mass

    @property
    def angular_momentum(self) -> Vec3:
        """About the centre of mass, along world axes, kg m2/s."""
        turn = np.array(self.rotation.to_matrix())
        return Vec3(*map(float, turn @ self.inertia @ turn.T @ np.array(self.angular_velocity)))

    @property
    def kinetic_energy(self) -> float:
        """Of moving and turning, joules."""
        speed = self.velocity_at(self.world_centre_of_mass)
        return 0.5 * self.mass * speed.dot(speed) + 0.5 * self.angular_momentum.dot(self.angular_velocity)

    # -- acting on it

    def add_force(self, force: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """Push with ``force`` (N, world axes) in the next step, at the centre of mass or ``at`` a point of the world.

        Raises:
            FieldError: for numbers that are not finite.
            StateError: outside of a World.
        """
        f = self._argument("add_force", "force", force, FORCE_LIMIT)
        with self._live("add_force").editing():
            if at is None:
                lib.dBodyAddForce(self._id, *f)
            else:
                lib.dBodyAddForceAtPos(self._id, *f, *self._argument("add_force", "at", at, POSITION_LIMIT))
            lib.dBodyEnable(self._id)

    def add_local_force(self, force: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """The same with ``force`` along body axes and ``at`` in the body's frame."""
        f = self._argument("add_local_force", "force", force, FORCE_LIMIT)
        point = None if at is None else self.local_to_world(self._argument("add_local_force", "at", at, POSITION_LIMIT))
        self.add_force(self.vector_to_world(f), at=point)

    def add_torque(self, torque: Vec3Like) -> None:
        """Turn with ``torque`` (N m, world axes) during the next step."""
        t = self._argument("add_torque", "torque", torque, FORCE_LIMIT)
        with self._live("add_torque").editing():
            lib.dBodyAddTorque(self._id, *t)
            lib.dBodyEnable(self._id)

    def add_local_torque(self, torque: Vec3Like) -> None:
        """The same with ``torque`` along body axes."""
        self.add_torque(self.vector_to_world(self._argument("add_local_torque", "torque", torque, FORCE_LIMIT)))

    def apply_impulse(self, impulse: Vec3Like, *, at: Vec3Like | None = None) -> None:
        """Change the velocities at once, as a hit of ``impulse`` (N s, world axes) does.

        The hit is at the centre of mass, or ``at`` a point of the world: ``dv = J / m``, ``dw = I^-1 (r x J)``.
        """
        j = self._argument("apply_impulse", "impulse", impulse, FORCE_LIMIT)
        arm = (
            ZERO
            if at is None
            else self._argument("apply_impulse", "at", at, POSITION_LIMIT) - self.world_centre_of_mass
        )
        self._kick("apply_impulse", j, arm.cross(j))

    def apply_angular_impulse(self, impulse: Vec3Like) -> None:
        """Change the angular velocity at once, as a twist of ``impulse`` (N m s, world axes) does."""
        self._kick(
            "apply_angular_impulse", ZERO, self._argument("apply_angular_impulse", "impulse", impulse, FORCE_LIMIT)
        )

    def _kick(self, doing: str, linear: Vec3, angular: Vec3) -> None:
        with self._live(doing).editing():
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

    def _argument(self, call: str, name: str, value: Vec3Like, limit: float) -> Vec3:
        return vector(limit)(f"{self.describe()}.{call}()", name, value)

    def wake(self) -> None:
        """Let it move again if it has fallen asleep; pushes, hits and set velocities do so too."""
        if self._realm is not None:
            with self._realm.editing():
                lib.dBodyEnable(self._id)

    # -- joints and touching

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The joints that hold this body."""
        return tuple(self._joints)

    # -- entering and leaving

    def _enter(self, realm: Realm) -> None:
        properties = self.mass_properties
        index = self._made(realm.add_body(self))
        self._index = index
        self._id = realm.ptr.bodies[index].id
        super()._enter(realm)
        self._put_mass(properties)
        self._enter_fields()
        self._snap()

    def _settle(self) -> None:
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
        self._leave_fields()
        super()._leave()
        realm.remove_body(self._index)
        self._id = None
        self._index = -1
        self._com = ZERO

    def _put_mass(self, properties: Mass) -> None:
        """Give ODE a mass, the reference point being moved to its centre first if need be."""
        realm = self._live("changing it")
        if properties.centre != self._com:
            position, velocity = read_position(self), read_linear(self)
            self._com = properties.centre
            realm.ptr.bodies[self._index].com = self._com
            write_position(self, position)
            write_linear(self, velocity)
            for geom in self.geoms:
                geom._place()
            for joint in self._joints:
                joint._remake()
        kinematic = self.kinematic
        inertia = [value for row in properties.inertia for value in row]
        checked(
            lib.oo_body_set_mass(realm.ptr, self._index, properties.mass, inertia), f"{self.describe()}: setting mass"
        )
        if kinematic:  # setting a mass makes ODE's body dynamic again
            lib.dBodySetKinematic(self._id)

    def _parts_changed(self) -> None:
        """Called when a part came, went, moved, or changed its mass: nothing visible moves, only the bookkeeping."""
        if self._realm is not None:
            self._put_mass(self.mass_properties)
