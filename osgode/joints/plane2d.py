"""The plane-2D joint."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.joints.base import ONE_BODY, JointFields
from osgode.joints.limits import Driven, MotorFields, motor_fields
from osgode.maths import Vec3
from osgode.native import lib
from osgode.nodes.body import Body


class Plane2DFields(JointFields, MotorFields):
    """The keyword arguments of `Plane2D`."""


class Plane2D(Driven):
    """Keeps a body in the plane z = 0 of the world, free to move in it and to turn about z, for games in 2-D.

    Motors with a 1 push along x and with a 2 along y (m/s, N), those with a 3 turn about z (rad/s, N m). It has no
    stops. ODE pulls the centre of mass back to z = 0, and stops the other two ways of turning, but what has crept in
    of them stays; `straighten` takes it out.

    Args:
        body: which; there is no second one.
    """

    KIND = lib.OO_PLANE2D
    BODIES = ONE_BODY

    motor_velocity1, motor_max_force1, cfm1 = motor_fields(0, turning=False)
    motor_velocity2, motor_max_force2, cfm2 = motor_fields(1, turning=False)
    motor_velocity3, motor_max_force3, cfm3 = motor_fields(2, turning=True)

    def __init__(self, body: Body, *, name: str = "", **fields: Unpack[Plane2DFields]) -> None:
        self._params: dict[int, float] = {}
        super().__init__(body, None, name=name, spots={}, **fields)

    @property
    def error(self) -> float:
        """How far the centre of mass is off the plane, metres."""
        return abs(self.body1.world_centre_of_mass.z)

    @property
    def angular_error(self) -> float:
        """By what angle the body is tilted out of the plane since it was anchored, radians."""
        z = Vec3(0.0, 0.0, 1.0)
        now = self.body1.vector_to_world(self._rest[0].rotation.conjugate().rotate(z))
        return math.atan2(now.cross(z).length, now.dot(z))

    def straighten(self) -> None:
        """Put the body back into the plane: tilt, height, and the velocities out of it are taken away."""
        body = self.body1
        with self._changing("straighten"):
            z = Vec3(0.0, 0.0, 1.0)
            now = body.vector_to_world(self._rest[0].rotation.conjugate().rotate(z))
            axis = now.cross(z)
            if axis.length > 0.0:
                turn = type(body.rotation).from_axis_angle(axis, self.angular_error)
                centre = body.world_centre_of_mass
                body.rotation = turn * body.rotation
                body.position = body.position + (centre - body.world_centre_of_mass)
            body.position = body.position - z * body.world_centre_of_mass.z
            body.angular_velocity = Vec3(0.0, 0.0, body.angular_velocity.z)
            speed = body.velocity_at(body.world_centre_of_mass)
            body.linear_velocity = body.linear_velocity - z * speed.z

    def _copied(self) -> None:
        super()._copied()
        self._params = {}

    # ODE can be told the parameters of this kind, but not asked for them.

    def _set_param(self, code: int, value: float) -> None:
        super()._set_param(code, value)
        self._params[code] = value

    def _param(self, code: int) -> float:
        return self._params.get(code, 0.0)
