"""Stops and motors: the fields that joints with a degree of freedom share."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypedDict

from osgode.errors import FieldError
from osgode.fields import SMALLEST, Check, Field, Followed, NumberField, number
from osgode.joints.base import Joint
from osgode.native import lib

Stops = tuple[float, float] | None

STRONGEST_AT_STOP = 1e9
"""N or N m: at a stop ODE adds the motor's force to the loads, and the stop gives way by force * CFM * step size."""


def param(
    code: int, default: float, check: Check[float], *, after: str = "", unit: str = "", doc: str = ""
) -> NumberField:
    """A field for one of ODE's joint parameters."""
    return NumberField(
        default,
        check,
        lambda joint: joint._GET_PARAM(joint._id, code),
        lambda joint, value: joint._SET_PARAM(joint._id, code, value),
        after=after,
        unit=unit,
        doc=doc,
    )


def softness(code: int, getter: Callable[[Any], float], check: Check[float], *, doc: str = "") -> Followed:
    """A field for a joint parameter that ODE takes from the World when the joint is made."""
    return Followed(
        check,
        lambda joint: joint._GET_PARAM(joint._id, code),
        lambda joint, value: joint._SET_PARAM(joint._id, code, value),
        lambda joint, _: getter(joint._realm.ptr.id),
        doc=doc,
    )


ERP: Check[float] = number(0.0, 1.0)
CFM: Check[float] = number(SMALLEST, 1e6)


def _read_stops(joint: Any) -> Stops:
    low, high = joint._GET_PARAM(joint._id, lib.dParamLoStop), joint._GET_PARAM(joint._id, lib.dParamHiStop)
    return None if low == -math.inf else (low, high)


def stops_field(limit: float, unlimited: float, unit: str, doc: str) -> Field[Stops, Stops]:
    """The low and high stop.

    Args:
        limit: what both must lie within.
        unit: for the reference.
        doc: for the reference.
        unlimited: the high stop that means none (the low one is -inf). For a hinge pi: with inf, a stop that is
            taken away while the hinge is at it leaves ODE with a wrong count of rows.
    """

    def convert(value: Any) -> tuple[float, float]:
        low, high = (number(-limit, limit).convert(v) for v in value)
        if low > high:
            raise ValueError
        return low, high

    def write(joint: Any, value: Stops) -> None:
        low, high = (-math.inf, unlimited) if value is None else value
        # ODE ignores a low stop above the high one, so the range is opened first.
        joint._SET_PARAM(joint._id, lib.dParamLoStop, -math.inf)
        joint._SET_PARAM(joint._id, lib.dParamHiStop, high)
        joint._SET_PARAM(joint._id, lib.dParamLoStop, low)

    words = f"two numbers (low, high) from {-limit:g} to {limit:g}, the lower first, or None"
    check: Check[Stops] = Check(words, lambda value: None if value is None else convert(value))
    return Field(None, check, _read_stops, write, after="_driven", unit=unit, doc=doc)


class LimotFields(TypedDict, total=False):
    """The keyword arguments of joints with one degree of freedom."""

    enabled: bool
    stops: Stops
    stop_bounce: float
    stop_erp: float | None
    stop_cfm: float | None
    motor_velocity: float
    motor_max_force: float
    fudge_factor: float
    cfm: float | None


class Limot(Joint):
    """Fields of a joint with one degree of freedom: its stops ("limits") and its motor."""

    motor_velocity = param(
        lib.dParamVel, 0.0, number(-1e9, 1e9), after="_wake", doc="Which the motor aims at, rad/s or m/s."
    )
    motor_max_force = param(
        lib.dParamFMax,
        0.0,
        number(0.0, math.inf, infinite=True),
        after="_driven",
        doc=f"What it may use for that, N m or N; 0: no motor. With stops at most {STRONGEST_AT_STOP:g}.",
    )
    stop_bounce = param(lib.dParamBounce, 0.0, number(0.0, 1.0), doc="Part of the speed that comes back from a stop.")
    stop_erp = softness(
        lib.dParamStopERP, lib.dWorldGetERP, ERP, doc="The part of the error at a stop that is corrected in one step."
    )
    stop_cfm = softness(lib.dParamStopCFM, lib.dWorldGetCFM, CFM, doc="How soft the stops are.")
    fudge_factor = param(
        lib.dParamFudgeFactor, 1.0, number(0.0, 1.0), doc="Less of the motor's force at a stop, against jumping off it."
    )
    cfm = softness(lib.dParamCFM, lib.dWorldGetCFM, CFM, doc="How soft the motor is.")

    stops: Any

    def _driven(self) -> None:
        if self.motor_max_force > STRONGEST_AT_STOP and self.stops is not None:
            raise FieldError(
                f"{self.describe()}.motor_max_force is {self.motor_max_force:g}; "
                f"with stops={self.stops} it must be at most {STRONGEST_AT_STOP:g}"
            )
        self._wake()

    def motor(self, velocity: float, max_force: float) -> None:
        """Drive at ``velocity`` (rad/s or m/s) with at most ``max_force`` (N m or N)."""
        for name, value in (("motor_max_force", max_force), ("motor_velocity", velocity)):
            self.FIELDS[name].check(self.describe(), name, value)
        self.motor_max_force = max_force
        self.motor_velocity = velocity
