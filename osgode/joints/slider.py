"""The slider."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import POSITION_LIMIT, number
from osgode.joints.base import JointFields
from osgode.joints.limits import LimotFields, motor_fields, stop_fields, stops_field
from osgode.joints.servo import ServoDriven, ServoFields
from osgode.joints.spots import BODY1, BODY2, Axis, Coordinate
from osgode.maths import Vec3, Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class SliderFields(JointFields, LimotFields, ServoFields):
    """The keyword arguments of `Slider` beside its axis."""


class Slider(ServoDriven):
    """Lets ``body1`` move along one axis against ``body2``, or against the static world, without turning.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        axis: direction in the world, any length but 0. Positive positions move ``body1`` along it.
        stops: (low, high) positions in metres, or None.
        motor_velocity, motor_max_force: m/s and N.
    """

    KIND = lib.OO_SLIDER

    axis = Axis(BODY1, "The axis that it slides along, as body1 has it.")
    position = Coordinate.position(0, "How far body1 has moved along the axis from where it was anchored.")
    position_rate = Coordinate.position_rate(0, "How fast it moves.")

    stops = stops_field(POSITION_LIMIT, math.inf, "m", "The positions at which it stops.")
    motor_velocity, motor_max_force, cfm = motor_fields(0, turning=False)
    stop_bounce, stop_erp, stop_cfm, stop_stiffness, stop_damping, fudge_factor = stop_fields(0, "", turning=False)

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        axis: Vec3Like = (1.0, 0.0, 0.0),
        name: str = "",
        **fields: Unpack[SliderFields],
    ) -> None:
        super().__init__(body1, body2, name=name, spots={"axis": axis}, **fields)

    @property
    def error(self) -> float:
        """How far ``body1`` is beside the axis, metres."""
        origin = self._rest[0].position
        way = self._carried(origin, BODY1, is_point=True) - self._carried(origin, BODY2, is_point=True)
        return way.cross(self._seen("axis", BODY2)).length

    @property
    def angular_error(self) -> float:
        """By what angle the bodies are turned against each other, radians."""
        return self._turned()

    def add_force(self, force: float) -> None:
        """Push ``body1`` along the axis with ``force`` (N) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_force()", "force", force)
        self._push("add_force", self.axis * value, self._middle())

    def _middle(self) -> Vec3:
        """Halfway between the centres of mass: a push along the axis there turns neither body more than the other."""
        first = self.body1.world_centre_of_mass
        return first if self.body2 is None else (first + self.body2.world_centre_of_mass) / 2
