"""The hinge."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import number
from osgode.joints.anchored import Anchored, origin_of
from osgode.joints.base import JointFields
from osgode.joints.limits import LimotFields, motor_fields, stop_fields, stops_field
from osgode.joints.servo import ServoDriven, ServoFields
from osgode.joints.spots import BODY1, Axis, Coordinate
from osgode.maths import Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class HingeFields(JointFields, LimotFields, ServoFields):
    """The keyword arguments of `Hinge` beside its anchor and axis."""


class Hinge(ServoDriven, Anchored):
    """Lets ``body1`` turn about one axis against ``body2``, or against the static world.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: a point of the axis in the world, metres; the origin of ``body1`` if not given.
        axis: direction in the world, any length but 0. Positive angles turn ``body1`` about it by the right-hand rule.
        stops: (low, high) angles in radians within +-pi, or None.
        motor_velocity, motor_max_force: rad/s and N m.
    """

    KIND = lib.OO_HINGE
    TURNS = True

    axis = Axis(BODY1, "The axis that it turns about, as body1 has it.")
    angle = Coordinate.angle(0, "How far body1 is turned from where it was anchored, within +-pi.")
    angle_rate = Coordinate.angle_rate(0, "How fast it turns.")

    stops = stops_field(math.pi, math.pi, "rad", "The angles at which it stops.")
    motor_velocity, motor_max_force, cfm = motor_fields(0, turning=True)
    stop_bounce, stop_erp, stop_cfm, stop_stiffness, stop_damping, fudge_factor = stop_fields(0, "", turning=True)

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        axis: Vec3Like = (0.0, 1.0, 0.0),
        name: str = "",
        **fields: Unpack[HingeFields],
    ) -> None:
        spots = {"anchor": origin_of(body1) if anchor is None else anchor, "axis": axis}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    @property
    def angular_error(self) -> float:
        """The angle between the axis as one body has it and as the other has it, radians."""
        return self._bend("axis")

    def add_torque(self, torque: float) -> None:
        """Turn ``body1`` about the axis with ``torque`` (N m) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_torque()", "torque", torque)
        self._twist("add_torque", self.axis * value)
