"""Stops and motors of the axes of joints that have several: numbered as ODE's groups of parameters."""

from __future__ import annotations

import math

from osgode.fields import POSITION_LIMIT
from osgode.joints.limits import Driven, motor_fields, stop_fields, stops_field


class Turning1(Driven):
    """The first axis is one of turning."""

    stops1 = stops_field(math.pi, math.pi, "rad", "The angles about the first axis at which it stops.")
    motor_velocity1, motor_max_force1, cfm1 = motor_fields(0, turning=True)
    stop_bounce1, stop_erp1, stop_cfm1, stop_stiffness1, stop_damping1, fudge_factor1 = stop_fields(0, "1", True)


class Turning2(Driven):
    """The second axis is one of turning."""

    stops2 = stops_field(math.pi, math.pi, "rad", "The angles about the second axis at which it stops.", group=1)
    motor_velocity2, motor_max_force2, cfm2 = motor_fields(1, turning=True)
    stop_bounce2, stop_erp2, stop_cfm2, stop_stiffness2, stop_damping2, fudge_factor2 = stop_fields(1, "2", True)


class Sliding1(Driven):
    """The first axis is one of sliding."""

    stops1 = stops_field(POSITION_LIMIT, math.inf, "m", "The positions at which it stops.")
    motor_velocity1, motor_max_force1, cfm1 = motor_fields(0, turning=False)
    stop_bounce1, stop_erp1, stop_cfm1, stop_stiffness1, stop_damping1, fudge_factor1 = stop_fields(0, "1", False)


class Sliding3(Driven):
    """The third axis is one of sliding."""

    stops3 = stops_field(POSITION_LIMIT, math.inf, "m", "The positions at which it stops.", group=2)
    motor_velocity3, motor_max_force3, cfm3 = motor_fields(2, turning=False)
    stop_bounce3, stop_erp3, stop_cfm3, stop_stiffness3, stop_damping3, fudge_factor3 = stop_fields(2, "3", False)
