"""Servos: motors that hold an angle or a position."""

from __future__ import annotations

import math
import weakref
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, ClassVar, TypedDict, Unpack

from osgode.errors import FieldError, StateError
from osgode.fields import VELOCITY_LIMIT, Check, Field, NumberField, number, optional
from osgode.joints.limits import STRONGEST_AT_STOP, Driven
from osgode.native import ffi, lib
from osgode.nodes.base import HasFields

if TYPE_CHECKING:
    from collections.abc import Iterator

STRENGTH: Check[float] = number(0.0, STRONGEST_AT_STOP)


class ServoArguments(TypedDict, total=False):
    """The keyword arguments of `Servo`."""

    target: float
    max_speed: float
    max_force: float
    frequency: float
    damping_ratio: float


class Servo(HasFields):
    """Drives a hinge to an angle, or a slider to a position, and holds it there: ``hinge.servo = Servo(...)``.

    A spring to the target, damped by ``damping_ratio`` (1: as fast as can be without overshooting) and of so many
    radians per second that it gets there in about ``5 / frequency`` seconds. Each step asks the joint's motor for the
    velocity that this spring has at its end (one implicit Euler step, stable at any frequency), cut off at
    ``max_speed``; the motor makes it with at most ``max_force``, and within the joint's stops. A load doesn't shift the
    rest position, unless it is stronger than ``max_force``.

    A hinge without stops turns the shorter way round. While the target isn't reached the bodies don't fall asleep.

    Args:
        target: rad or m.
        max_speed: rad/s or m/s.
        max_force: N m or N.
        frequency: rad/s.
        damping_ratio: 1 for critical.
    """

    target = NumberField(0.0, number(-1e8, 1e8), after="_send", unit="rad or m", doc="Where it drives to.")
    max_speed = NumberField(1.0, number(0.0, VELOCITY_LIMIT), after="_send", unit="rad/s or m/s")
    max_force = NumberField(100.0, STRENGTH, after="_strengthen", unit="N m or N")
    frequency = NumberField(
        10.0, number(1e-6, 1e6), after="_send", unit="rad/s", doc="How stiff it is: the higher, the sooner it is there."
    )
    damping_ratio = NumberField(1.0, number(0.0, 1e6), after="_send", doc="1: as fast as can be without overshooting.")

    def __init__(self, **fields: Unpack[ServoArguments]) -> None:
        self._record: dict[str, Any] = {}
        self._owner: weakref.ref[ServoDriven] | None = None
        self._set_fields(dict(fields))

    def describe(self) -> str:
        """What messages call it."""
        return "Servo" if self.joint is None else f"Servo of {self.joint.describe()}"

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={getattr(self, name):g}" for name in self.FIELDS)
        return f"Servo({values})"

    @property
    def joint(self) -> ServoDriven | None:
        """The joint that it drives, or None."""
        return None if self._owner is None else self._owner()

    @property
    def arrived(self) -> bool:
        """Whether the joint is within 0.001 rad or m of the target; False while it isn't live."""
        joint = self.joint
        if joint is None or not joint.is_live:
            return False
        off: float = self.target - joint._read("servo").position[0]
        return abs(math.remainder(off, math.tau) if joint._goes_round() else off) < 1e-3

    def _strengthen(self) -> None:
        joint = self.joint
        if joint is not None:
            joint._serve()

    def _send(self) -> None:
        joint = self.joint
        if joint is not None:
            joint._tell_core(self)
            joint._wake()


def _servo(value: object) -> Servo:
    if not isinstance(value, Servo):
        raise TypeError
    return value


class ServoFields(TypedDict, total=False):
    """The keyword argument of joints that a servo can drive."""

    servo: Servo | None


class ServoDriven(Driven):
    """A joint of one axis, which a servo can drive."""

    TURNS: ClassVar[bool] = False
    """Whether it is driven to an angle, the shorter way round."""

    servo: Field[Servo | None, Servo | None] = Field(
        None, optional(Check("a Servo", _servo)), after="_served", doc="Which drives the motor."
    )
    _serving = False
    _driver: Servo | None = None

    motor_velocity: NumberField
    motor_max_force: NumberField
    stops: Any

    def _served(self) -> None:
        servo, old = self.servo, self._driver
        if servo is old:
            return
        if servo is not None and servo.joint is not None:
            raise FieldError(f"{self.describe()}.servo drives {servo.joint.describe()} already; make another one")
        if old is not None:
            old._owner = None
        self._driver = servo
        if servo is not None:
            servo._owner = weakref.ref(self)
            self._serve()
        else:
            self._stop_serving()
        self._wake()

    def _copied(self) -> None:
        super()._copied()
        servo = self.servo
        if servo is not None:  # a servo drives one joint
            own = Servo()
            own._record = dict(servo._record)
            own._owner = weakref.ref(self)
            self._record["servo"] = self._driver = own

    def _serve(self) -> None:
        servo = self.servo
        if servo is None:
            return
        with self._by_servo():
            self.motor_max_force = servo.max_force
        self._tell_core(servo)

    def _tell_core(self, servo: Servo) -> None:
        if self._realm is None:
            return
        realm = self._live("servo")
        with realm.holding():
            row = servo.target, servo.max_speed, servo.frequency, servo.damping_ratio, self._goes_round()
            lib.oo_joint_drive(realm.ptr, self._native, ffi.new("oo_servo *", row))

    def _stop_serving(self) -> None:
        with self._by_servo():
            self.motor_max_force = self.motor_velocity = 0.0
        if self._realm is not None:
            lib.oo_joint_drive(self._realm.ptr, self._native, ffi.NULL)

    def _goes_round(self) -> bool:
        return self.TURNS and self.stops is None

    @contextmanager
    def _by_servo(self) -> Iterator[None]:
        self._serving = True
        try:
            yield
        finally:
            self._serving = False

    def _driven(self) -> None:
        super()._driven()
        if not self._serving:
            self._serve()  # with stops it goes another way round than without

    def __setattr__(self, name: str, value: object) -> None:
        if name in ("motor_velocity", "motor_max_force") and self._driver is not None and not self._serving:
            raise StateError(
                f"{self.describe()}.{name} can't be set while its servo drives the motor; set the servo's fields, "
                "or servo=None first"
            )
        super().__setattr__(name, value)

    def _enter_fields(self) -> None:
        super()._enter_fields()
        if self.servo is not None:
            self._tell_core(self.servo)
