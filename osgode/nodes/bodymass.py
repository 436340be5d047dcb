"""The mass of a body: the sum of its parts, and what stays where when that sum changes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from osgode.fields import VELOCITY_LIMIT, vector
from osgode.mass import Mass
from osgode.maths import ZERO, FloatArray, Vec3, Vec3Like
from osgode.native import checked, lib
from osgode.nodes.base import physics_nodes
from osgode.nodes.bodyframe import BodyFrame
from osgode.nodes.bodystate import read_linear, read_position, write_linear, write_position

if TYPE_CHECKING:
    from osgode.joints.base import Joint
    from osgode.nodes.body import Body
    from osgode.nodes.geom import Geom

MASSLESS = Mass(1.0)
"""What a body has in which nothing has mass: 1 kg and unit inertia, as a new body in ODE."""


class BodyMass(BodyFrame):
    """A body as a thing with mass, which it has from its parts, or was given.

    ODE's reference point is the centre of mass, so that a change of the sum moves one against the other. Usually
    the geometry stays where it is, and the reference point moves (nothing visible happens); in
    `keeping_reference_point` it is the other way round.
    """

    _joints: list[Joint]
    _mass: Mass | None
    """What is in force; None, only outside of a World: to be added up when somebody asks."""
    _keeping: int
    """How many blocks that keep the reference point are being run."""

    def _start(self) -> None:
        super()._start()
        self._com = ZERO
        self._joints = []
        self._mass = None
        self._keeping = 0

    def _copy_from(self, other: Any) -> None:
        super()._copy_from(other)
        if not self.auto_recentre:
            self._mass = other.mass_properties

    @property
    def body(self) -> Body:
        """Itself."""
        return cast("Body", self)

    # -- what is in force

    @property
    def geoms(self) -> tuple[Geom, ...]:
        """The geoms that are parts of this body."""
        from osgode.nodes.geom import Geom

        return tuple(node for node in physics_nodes(self) if isinstance(node, Geom))

    @property
    def parts_mass(self) -> Mass | None:
        """The sum of the parts as they are now, in the body's frame; None if no part has mass.

        That is what is in force too, unless there is a `fixed_mass` or `auto_recentre` is off.

        Raises:
            FieldError: if a part has no volume (an open mesh) or the sum is out of ODE's range.
        """
        total: Mass | None = None
        for geom in self.geoms:
            part = geom.part_mass
            if part is not None:
                total = part if total is None else total + part
        return total

    @property
    def mass_properties(self) -> Mass:
        """Mass, centre of mass and inertia in force, in the body's frame: `fixed_mass`, or the sum of its parts.

        A body without any mass has 1 kg and unit inertia at its origin.

        Raises:
            FieldError: as `parts_mass`.
        """
        if self._mass is None:
            self._mass = self._mass_due()
        return self._mass

    @property
    def mass(self) -> float:
        """The whole mass in force, kg."""
        return self.mass_properties.mass

    @property
    def inertia(self) -> FloatArray:
        """The inertia tensor in force about the centre of mass along body axes: (3, 3), kg m2."""
        return np.array(self.mass_properties.inertia)

    @property
    def world_inertia(self) -> FloatArray:
        """The same along world axes: ``R @ inertia @ R.T`` with the matrix R of `rotation`."""
        turn = np.array(self.rotation.to_matrix())
        turned: FloatArray = turn @ self.inertia @ turn.T
        return turned

    @property
    def centre_of_mass(self) -> Vec3:
        """The centre of mass in force, in the body's frame, metres."""
        return self.mass_properties.centre

    @property
    def world_centre_of_mass(self) -> Vec3:
        """The centre of mass in the world, metres."""
        return self.local_to_world(self.centre_of_mass)

    @property
    def centre_of_mass_velocity(self) -> Vec3:
        """The velocity of the centre of mass, m/s along world axes; setting it leaves the angular velocity as it is.

        Raises:
            FieldError: for what is no velocity.
        """
        return self.velocity_at(self.world_centre_of_mass)

    @centre_of_mass_velocity.setter
    def centre_of_mass_velocity(self, value: Vec3Like) -> None:
        wanted = vector(VELOCITY_LIMIT)(self.describe(), "centre_of_mass_velocity", value)
        self.linear_velocity = wanted - self.angular_velocity.cross(self.vector_to_world(self.centre_of_mass))

    @property
    def momentum(self) -> Vec3:
        """Mass times velocity of the centre of mass, kg m/s."""
        return self.centre_of_mass_velocity * self.mass

    @property
    def angular_momentum(self) -> Vec3:
        """About the centre of mass, along world axes, kg m2/s."""
        return Vec3(*map(float, self.world_inertia @ np.array(self.angular_velocity)))

    @property
    def kinetic_energy(self) -> float:
        """Of moving and turning, joules."""
        speed = self.centre_of_mass_velocity
        return 0.5 * self.mass * speed.dot(speed) + 0.5 * self.angular_momentum.dot(self.angular_velocity)

    # -- changing it

    def recentre(self) -> None:
        """Put in force what the parts (or `fixed_mass`) give now: mass, centre of mass, inertia.

        Needed only while `auto_recentre` is off. No geom moves and no material point changes its velocity, unless
        in a block that keeps the reference point.

        Raises:
            FieldError: if a part has no volume, or the sum is out of ODE's range; nothing is changed then.
            StateError: while another thread is in a step of the World.
        """
        with self._changing("recentre()"):
            self._put_mass(self._mass_due())

    @contextmanager
    def keeping_reference_point(self) -> Iterator[None]:
        """Let the centre of mass stay in the world while parts come, go and change: the geometry shifts instead.

        Usually it is the other way round: the geometry stays. In the block each change that moves the centre of
        mass by v in the body's axes moves the frame, and with it every geom, by -v in the world. The velocity of
        the centre of mass and the angular velocity stay, and so do the anchors, axes and angles of joints in the
        world: they hang on the reference point. A block may stand in another one. A block that ends with an
        exception has shifted what had been changed until then.

        Raises:
            StateError: if another thread is stepping or changing the World, which nobody else may do during the block.
        """
        with self._changing("keeping_reference_point()"):
            self._mass = self.mass_properties
            self._keeping += 1
            try:
                yield
            finally:
                self._keeping -= 1

    def _mass_due(self) -> Mass:
        return self.fixed_mass or self.parts_mass or MASSLESS

    def _parts_changed(self) -> None:
        if self.auto_recentre:
            self._mass_given()

    def _mass_given(self) -> None:
        if self._realm is None and self.auto_recentre and not self._keeping:
            self._mass = None
            self._tell_recentred()
        else:
            self._put_mass(self._mass_due())

    def _switched(self) -> None:
        """`auto_recentre` was switched: on, the parts count at once; off, what is in force stays."""
        if self.auto_recentre:
            self._mass_given()
        else:
            self._mass = self.mass_properties

    def _put_mass(self, due: Mass) -> None:
        """Let a mass be in force, in ODE too."""
        by = due.centre - self.mass_properties.centre
        if by != ZERO and self._keeping:
            self._check_shift(by)
        if self._realm is not None:
            self._send_mass(due)
        self._mass = due
        if by == ZERO:
            return
        if self._keeping:
            self._shift_geometry(by)
        elif self._realm is not None:
            self._shift_reference()
        self._tell_recentred()

    def _send_mass(self, mass: Mass) -> None:
        kinematic = self.kinematic
        inertia = [value for row in mass.inertia for value in row]
        status = lib.oo_body_set_mass(self._live("setting mass").ptr, self._index, mass.mass, inertia)
        checked(status, f"{self.describe()}: setting mass")
        if kinematic:  # setting a mass makes ODE's body dynamic again
            lib.dBodySetKinematic(self._id)

    def _enter_mass(self) -> None:
        """Give a new native, which is at the origin and at rest, its mass, and its reference point in the frame."""
        if self.auto_recentre:
            self._mass = self._mass_due()
        self._send_mass(self.mass_properties)
        self._send_centre()
        write_position(self, ZERO)

    def _send_centre(self) -> None:
        self._com = self.centre_of_mass
        self._live("recentring").ptr.bodies[self._index].com = self._com

    def _shift_reference(self) -> None:
        """Move ODE's reference point to the new centre; every material point stays, and keeps its velocity."""
        position, velocity = read_position(self), read_linear(self)
        self._send_centre()
        write_position(self, position)
        write_linear(self, velocity)
        for geom in self.geoms:
            geom._place()
        for joint in self._joints:
            joint._remake()

    def _shifted(self, by: Vec3) -> dict[str, Vec3]:
        """Position and velocity of a frame from which the centre of mass is farther ``by`` (in body axes)."""
        arm = self.vector_to_world(by)
        return {
            "position": self.position - arm,
            "linear_velocity": self.linear_velocity - self.angular_velocity.cross(arm),
        }

    def _check_shift(self, by: Vec3) -> None:
        for name, value in self._shifted(by).items():
            self.FIELDS[name].check(self.describe(), name, value)

    def _shift_geometry(self, by: Vec3) -> None:
        """Move the frame and the geoms against the reference point, which has moved ``by`` in the frame."""
        if self._realm is None:
            self._record.update(self._shifted(by))
        else:  # ODE's body stays, to the bit, and so do the joints on it
            self._send_centre()
            for geom in self.geoms:
                geom._place()
            lib.dBodyEnable(self._id)
            self._snap()
        for joint in self._joints:
            joint._shift_rest(self.body, -by)

    def _tell_recentred(self) -> None:
        for node in physics_nodes(self)[1:]:
            node._recentred()
