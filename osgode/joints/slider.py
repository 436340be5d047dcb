"""The slider."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import DIRECTION, POSITION_LIMIT, number
from osgode.joints.limits import Limot, LimotFields, stops_field
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.body import Body


class Slider(Limot):
    """Lets ``body1`` move along one axis against ``body2``, or against the static world, without turning.

    Args:
        axis: direction in the world, any length but 0. Positive positions move ``body1`` along it.
        stops: (low, high) positions in metres, or None.
        motor_velocity, motor_max_force: m/s and N.
    """

    KIND = lib.OO_SLIDER
    _GET_PARAM = staticmethod(lib.dJointGetSliderParam)
    _SET_PARAM = staticmethod(lib.dJointSetSliderParam)

    stops = stops_field(POSITION_LIMIT, math.inf, "m", "The positions at which it stops.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        axis: Vec3Like = (1.0, 0.0, 0.0),
        name: str = "",
        **fields: Unpack[LimotFields],
    ) -> None:
        self.name = name
        self._axis = DIRECTION(self.describe(), "axis", axis)
        super().__init__(body1, body2, name=name, **fields)

    def _anchor_native(self) -> None:
        lib.dJointSetSliderAxis(self._id, *self._axis)

    @property
    def axis(self) -> Vec3:
        """The axis in the world, a unit vector.

        Setting it anchors the joint anew: the present poses become those of position 0.
        """
        if self._realm is not None:
            self._live("axis")
            out = ffi.new("dVector3")
            lib.dJointGetSliderAxis(self._id, out)
            return Vec3(out[0], out[1], out[2])
        return self._turned(self._axis, self._body1, self._rest[0])

    @axis.setter
    def axis(self, value: Vec3Like) -> None:
        wanted = DIRECTION(self.describe(), "axis", value)
        with self._anchoring():
            self._axis = wanted
            self._rest_anew()

    @property
    def position(self) -> float:
        """How far ``body1`` has moved along the axis from where it was anchored, metres.

        Raises:
            StateError: while the joint isn't live.
        """
        self._needs_live("position")
        return float(lib.dJointGetSliderPosition(self._id))

    @property
    def position_rate(self) -> float:
        """How fast it moves, m/s; raises as `position`."""
        self._needs_live("position_rate")
        # ODE leaves out that the axis turns with the bodies: its rate depends on where their centres of mass are.
        first, second = self._body1, self._body2
        velocity = first.linear_velocity
        if second is not None:
            velocity -= second.velocity_at(first.position)
        return self.axis.dot(velocity)

    def add_force(self, force: float) -> None:
        """Push ``body1`` along the axis with ``force`` (N) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_force()", "force", force)
        self._needs_live("add_force")
        with self._live("add_force").editing():
            lib.dJointAddSliderForce(self._id, value)
            self._wake()
