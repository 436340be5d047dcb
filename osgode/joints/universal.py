"""The universal joint."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import number
from osgode.joints.anchored import Anchored, origin_of, right_angle
from osgode.joints.axes import Turning1, Turning2
from osgode.joints.base import JointFields
from osgode.joints.limits import Limot1Fields, Limot2Fields
from osgode.joints.spots import BODY1, BODY2, Axis, Coordinate
from osgode.maths import Vec3, Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class UniversalFields(JointFields, Limot1Fields, Limot2Fields):
    """The keyword arguments of `Universal` beside its anchor and axes."""


class Universal(Turning2, Turning1, Anchored):
    """Two bodies on a cross, as in a cardan shaft: turning about the shaft is passed on, bending is free.

    A cross stands between them: ``body1`` turns about ``axis1`` against the cross, and the cross about ``axis2``
    against ``body2``; the two axes are perpendicular. A shaft bent by the angle b passes its speed on
    between ``cos b`` and ``1 / cos b`` times, twice a turn.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: the middle of the cross in the world, metres; the origin of ``body1`` if not given.
        axis1: direction in the world, carried by ``body1``.
        axis2: direction in the world, carried by ``body2``; within 0.01 rad of a right angle to ``axis1``,
            and made exact.
    """

    KIND = lib.OO_UNIVERSAL

    axis1 = Axis(BODY1, "The arm of the cross that body1 holds.")
    axis2 = Axis(BODY2, "The arm of the cross that body2 holds.")
    angle1 = Coordinate.angle(0, "How far body1 is turned about axis1, within +-pi.")
    angle2 = Coordinate.angle(1, "How far it is turned, cross and all, about axis2 against body2, within +-pi.")
    angle_rate1 = Coordinate.angle_rate(0, "How fast angle1 grows.")
    angle_rate2 = Coordinate.angle_rate(1, "How fast angle2 grows.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        axis1: Vec3Like = (1.0, 0.0, 0.0),
        axis2: Vec3Like = (0.0, 1.0, 0.0),
        name: str = "",
        **fields: Unpack[UniversalFields],
    ) -> None:
        spots = {"anchor": origin_of(body1) if anchor is None else anchor, "axis1": axis1, "axis2": axis2}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        return spots | {"axis2": right_angle(self, spots, "axis1", "axis2")}

    @property
    def angular_error(self) -> float:
        """By how much the angle between the axes differs from a right one, radians."""
        return abs(math.asin(max(-1.0, min(1.0, self.axis1.dot(self.axis2)))))

    def add_torques(self, torque1: float, torque2: float) -> None:
        """Turn ``body1`` about both axes (N m) in the next step, and ``body2`` against it."""
        check = number()
        name = f"{self.describe()}.add_torques()"
        first, second = check(name, "torque1", torque1), check(name, "torque2", torque2)
        self._twist("add_torques", self.axis1 * first + self.axis2 * second)
