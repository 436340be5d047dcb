"""The hinge."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.fields import DIRECTION, number
from osgode.joints.base import Anchored
from osgode.joints.limits import Limot, LimotFields, stops_field
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.body import Body


class Hinge(Anchored, Limot):
    """Lets ``body1`` turn about one axis against ``body2``, or against the static world.

    Args:
        anchor: a point of the axis in the world, metres; the origin of ``body1`` if not given.
        axis: direction in the world, any length but 0. Positive angles turn ``body1`` about it by the right-hand rule.
        stops: (low, high) angles in radians within +-pi, or None.
        motor_velocity, motor_max_force: rad/s and N m.
    """

    KIND = lib.OO_HINGE
    _GET_ANCHOR = staticmethod(lib.dJointGetHingeAnchor)
    _GET_ANCHOR2 = staticmethod(lib.dJointGetHingeAnchor2)
    _GET_PARAM = staticmethod(lib.dJointGetHingeParam)
    _SET_PARAM = staticmethod(lib.dJointSetHingeParam)

    stops = stops_field(math.pi, math.pi, "rad", "The angles at which it stops.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        axis: Vec3Like = (0.0, 1.0, 0.0),
        name: str = "",
        **fields: Unpack[LimotFields],
    ) -> None:
        self.name = name
        self._axis = DIRECTION(self.describe(), "axis", axis)
        super().__init__(body1, body2, anchor=anchor, name=name, **fields)

    def _anchor_native(self) -> None:
        lib.dJointSetHingeAnchor(self._id, *self._anchor)
        lib.dJointSetHingeAxis(self._id, *self._axis)

    def _reanchor(self, anchor: Vec3) -> None:
        self._axis = self.axis
        super()._reanchor(anchor)

    @property
    def axis(self) -> Vec3:
        """The axis in the world, a unit vector.

        Setting it anchors the joint anew: the present poses become those of angle 0.
        """
        if self._realm is not None:
            self._live("axis")
            out = ffi.new("dVector3")
            lib.dJointGetHingeAxis(self._id, out)
            return Vec3(out[0], out[1], out[2])
        return self._turned(self._axis, self._body1, self._rest[0])

    @axis.setter
    def axis(self, value: Vec3Like) -> None:
        wanted = DIRECTION(self.describe(), "axis", value)
        with self._anchoring():
            self._anchor = self.anchor
            self._axis = wanted
            self._rest_anew()

    @property
    def angle(self) -> float:
        """How far ``body1`` is turned from where it was anchored, radians, within +-pi.

        Raises:
            StateError: while the joint isn't live.
        """
        self._needs_live("angle")
        return float(lib.dJointGetHingeAngle(self._id))

    @property
    def angle_rate(self) -> float:
        """How fast it turns, rad/s; raises as `angle`."""
        self._needs_live("angle_rate")
        return float(lib.dJointGetHingeAngleRate(self._id))

    def add_torque(self, torque: float) -> None:
        """Turn ``body1`` about the axis with ``torque`` (N m) in the next step, and ``body2`` against it."""
        value = number()(f"{self.describe()}.add_torque()", "torque", torque)
        self._needs_live("add_torque")
        with self._live("add_torque").editing():
            lib.dJointAddHingeTorque(self._id, value)
            self._wake()
