"""Joints that slide and turn: piston, PR (prismatic-rotoide) and PU (prismatic-universal)."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import number
from osgode.joints.anchored import Anchored, origin_of, right_angle
from osgode.joints.axes import Sliding1, Sliding3, Turning1, Turning2
from osgode.joints.base import JointFields
from osgode.joints.limits import Limot1Fields, Limot2Fields, Limot3Fields
from osgode.joints.spots import BODY1, BODY2, Axis, Coordinate
from osgode.maths import Vec3, Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class TwoAxisFields(JointFields, Limot1Fields, Limot2Fields):
    """The keyword arguments of `Piston` and `PR` beside anchor and axes."""


class PUFields(JointFields, Limot1Fields, Limot2Fields, Limot3Fields):
    """The keyword arguments of `PU` beside anchor and axes."""


class Piston(Turning2, Sliding1, Anchored):
    """Lets ``body1`` slide along an axis and turn about the same axis, as a piston in its cylinder.

    Parameters with a 1 are those of sliding (m, N), those with a 2 are of turning (rad, N m).

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: a point of the axis in the world, metres; the origin of ``body1`` if not given.
        axis: direction in the world, any length but 0.
    """

    KIND = lib.OO_PISTON

    axis = Axis(BODY1, "The axis, as body1 has it.")
    position = Coordinate.position(0, "How far body1 has moved along the axis from where it was anchored.")
    angle = Coordinate.angle(1, "How far body1 is turned about the axis, within +-pi.")
    position_rate = Coordinate.position_rate(0, "How fast it moves.")
    angle_rate = Coordinate.angle_rate(1, "How fast it turns.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        axis: Vec3Like = (1.0, 0.0, 0.0),
        name: str = "",
        **fields: Unpack[TwoAxisFields],
    ) -> None:
        spots = {"anchor": origin_of(body1) if anchor is None else anchor, "axis": axis}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    @property
    def error(self) -> float:
        """How far the anchor is beside the axis, metres."""
        return self._gap("anchor").cross(self.axis).length

    @property
    def angular_error(self) -> float:
        """The angle between the axis as one body has it and as the other has it, radians."""
        return self._bend("axis")

    def add_force(self, force: float) -> None:
        """Push ``body1`` along the axis with ``force`` (N) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_force()", "force", force)
        self._push("add_force", self.axis * value, self.anchor)

    def add_torque(self, torque: float) -> None:
        """Turn ``body1`` about the axis with ``torque`` (N m) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_torque()", "torque", torque)
        self._twist("add_torque", self.axis * value)


class PR(Turning2, Sliding1, Anchored):
    """Lets ``body1`` slide along one axis and turn about another: ODE's prismatic-rotoide joint.

    The axis of turning is fixed in ``body2`` at the anchor; the axis of sliding is fixed in ``body1`` and turns
    with it. Parameters with a 1 are those of sliding (m, N), those with a 2 are of turning (rad, N m).

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: a point of the axis of turning in the world, metres; the origin of ``body1`` if not given.
        axis1: direction of sliding in the world.
        axis2: direction of the axis of turning; within 0.01 rad of a right angle to ``axis1``, and made exact.
    """

    KIND = lib.OO_PR

    axis1 = Axis(BODY1, "The axis that it slides along, as body1 has it.")
    axis2 = Axis(BODY1, "The axis that it turns about, as body1 has it.")
    position = Coordinate.position(0, "How far body1 has moved along axis1 from where it was anchored.")
    angle = Coordinate.angle(1, "How far body1 is turned about axis2, within +-pi.")
    position_rate = Coordinate.position_rate(0, "How fast it moves along axis1.")
    angle_rate = Coordinate.angle_rate(1, "How fast it turns.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        axis1: Vec3Like = (1.0, 0.0, 0.0),
        axis2: Vec3Like = (0.0, 1.0, 0.0),
        name: str = "",
        **fields: Unpack[TwoAxisFields],
    ) -> None:
        spots = {"anchor": origin_of(body1) if anchor is None else anchor, "axis1": axis1, "axis2": axis2}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        return spots | {"axis2": right_angle(self, spots, "axis1", "axis2")}

    @property
    def error(self) -> float:
        """How far the anchor is beside the axis of sliding, metres."""
        return self._gap("anchor").cross(self.axis1).length

    @property
    def angular_error(self) -> float:
        """The angle between the axis of turning as one body has it and as the other has it, radians."""
        return self._bend("axis2")

    def add_torque(self, torque: float) -> None:
        """Turn ``body1`` about ``axis2`` with ``torque`` (N m) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_torque()", "torque", torque)
        self._twist("add_torque", self.axis2 * value)


class PU(Sliding3, Turning2, Turning1, Anchored):
    """A universal joint whose cross also slides along an axis of ``body1``: ODE's prismatic-universal joint.

    Parameters with a 1 and 2 are those of turning about ``axis1`` and ``axis2`` (rad, N m), as in `Universal`; those
    with a 3 are of sliding along ``axis3`` (m, N).

    ODE's equations leave out that ``axis3`` turns with ``body1``: while it is slid out by x and turns at w, the anchor
    stays about ``w x step_size / erp`` beside the axis (`error`).

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: the middle of the cross in the world, metres; the origin of ``body1`` if not given.
        axis1: direction in the world, carried by ``body1``.
        axis2: direction in the world, carried by ``body2``; within 0.01 rad of a right angle to ``axis1``,
            and made exact.
        axis3: direction of sliding in the world, carried by ``body1``.
    """

    KIND = lib.OO_PU

    axis1 = Axis(BODY1, "The arm of the cross that body1 holds.")
    axis2 = Axis(BODY2, "The arm of the cross that body2 holds.")
    axis3 = Axis(BODY1, "The axis that it slides along, as body1 has it.")
    angle1 = Coordinate.angle(0, "How far body1 is turned about axis1, within +-pi.")
    angle2 = Coordinate.angle(1, "How far it is turned, cross and all, about axis2 against body2, within +-pi.")
    position = Coordinate.position(2, "How far body1 has moved along axis3 from where it was anchored.")
    angle_rate1 = Coordinate.angle_rate(0, "How fast angle1 grows.")
    angle_rate2 = Coordinate.angle_rate(1, "How fast angle2 grows.")
    position_rate = Coordinate.position_rate(2, "How fast it moves along axis3.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        axis1: Vec3Like = (0.0, 1.0, 0.0),
        axis2: Vec3Like = (0.0, 0.0, 1.0),
        axis3: Vec3Like = (1.0, 0.0, 0.0),
        name: str = "",
        **fields: Unpack[PUFields],
    ) -> None:
        spots = {
            "anchor": origin_of(body1) if anchor is None else anchor,
            "axis1": axis1,
            "axis2": axis2,
            "axis3": axis3,
        }
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        return spots | {"axis2": right_angle(self, spots, "axis1", "axis2")}

    @property
    def error(self) -> float:
        """How far the anchor is beside the axis of sliding, metres."""
        return self._gap("anchor").cross(self.axis3).length

    @property
    def angular_error(self) -> float:
        """By how much the angle between the arms of the cross differs from a right one, radians."""
        return abs(math.asin(max(-1.0, min(1.0, self.axis1.dot(self.axis2)))))
