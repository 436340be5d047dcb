"""The hinge-2: a wheel that is steered and sprung."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import number
from osgode.joints.anchored import Anchored, not_parallel, origin_of
from osgode.joints.axes import Turning1
from osgode.joints.base import TWO_BODIES, JointFields
from osgode.joints.limits import Limot1Fields, motor_fields, spring_fields
from osgode.joints.spots import BODY1, BODY2, Axis, Coordinate
from osgode.maths import Vec3, Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class Hinge2Fields(JointFields, Limot1Fields, total=False):
    """The keyword arguments of `Hinge2` beside its anchor and axes."""

    suspension_erp: float | None
    suspension_cfm: float | None
    suspension_stiffness: float | None
    suspension_damping: float | None
    motor_velocity2: float
    motor_max_force2: float
    cfm2: float | None


class Hinge2(Turning1, Anchored):
    """A wheel (``body2``) on a chassis (``body1``): steered and sprung along ``axis1``, rolling about ``axis2``.

    All angles, rates, stops and motors are those of the wheel as the chassis sees it: a positive ``motor_velocity2``
    turns the wheel about plus ``axis2``, and a positive ``angle1`` has turned it about plus ``axis1``. (ODE counts them
    the other way, as those of the chassis against the wheel.) The wheel's own axis has no stops in ODE.

    Args:
        body1: the chassis.
        body2: the wheel; ODE needs both. For a wheel on the static world give it a kinematic body.
        anchor: the hub, a point of the world in metres; the origin of ``body2`` if not given.
        axis1: steering and suspension axis, direction in the world, up as a rule, carried by the chassis.
        axis2: wheel axis, direction in the world, carried by the wheel; not parallel to ``axis1``.
    """

    KIND = lib.OO_HINGE2
    BODIES = TWO_BODIES

    axis1 = Axis(BODY1, "The axis of steering and springing, as the chassis has it.")
    axis2 = Axis(BODY2, "The axis that the wheel rolls about, as the wheel has it.")
    angle1 = Coordinate.angle(0, "How far the wheel is steered about axis1, within +-pi.")
    angle2 = Coordinate.angle(1, "How far the wheel has rolled about axis2, within +-pi.")
    compression = Coordinate.position(2, "How far the wheel is above its rest, along axis1: the suspension's travel.")
    angle_rate1 = Coordinate.angle_rate(0, "How fast it is steered.")
    angle_rate2 = Coordinate.angle_rate(1, "How fast it rolls.")
    compression_rate = Coordinate.position_rate(2, "How fast the suspension is pressed together.")

    motor_velocity2, motor_max_force2, cfm2 = motor_fields(1, turning=True)
    suspension_erp, suspension_cfm, suspension_stiffness, suspension_damping = spring_fields(
        (lib.dParamSuspensionERP, lib.dParamSuspensionCFM), ("suspension_", ""), "the suspension", turning=False
    )

    def __init__(
        self,
        body1: Body,
        body2: Body,
        *,
        anchor: Vec3Like | None = None,
        axis1: Vec3Like = (0.0, 1.0, 0.0),
        axis2: Vec3Like = (0.0, 0.0, 1.0),
        name: str = "",
        **fields: Unpack[Hinge2Fields],
    ) -> None:
        spots = {"anchor": origin_of(body2) if anchor is None else anchor, "axis1": axis1, "axis2": axis2}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        not_parallel(self, spots, "axis1", "axis2")
        return spots

    @property
    def error(self) -> float:
        """How far the hub is off ``axis1``, metres; the suspension's travel is no error."""
        return self._gap("anchor").cross(self.axis1).length

    @property
    def angular_error(self) -> float:
        """By how much the angle between the axes differs from that at rest, radians."""

        def between(one: Vec3, other: Vec3) -> float:
            return math.atan2(one.cross(other).length, one.dot(other))

        return abs(between(self.axis1, self.axis2) - between(self._spots["axis1"], self._spots["axis2"]))

    def add_torques(self, torque1: float, torque2: float) -> None:
        """Turn the wheel about both axes (N m) in the next step, and the chassis against it."""
        check = number()
        name = f"{self.describe()}.add_torques()"
        first, second = check(name, "torque1", torque1), check(name, "torque2", torque2)
        self._twist("add_torques", -(self.axis1 * first + self.axis2 * second))
