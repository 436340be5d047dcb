"""Springs, stops and motors: the fields that joints share.

Parameters of a second and third axis have the numbers of the first plus 0x100 and 0x200, as in ODE.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, ClassVar, TypedDict

from osgode.errors import FieldError, shown
from osgode.fields import SMALLEST, Check, Field, Followed, NumberField, number, optional
from osgode.joints.base import Joint
from osgode.native import lib
from osgode.springs import implicit

Stops = tuple[float, float] | None
OptionalNumber = Field[float | None, float | None]

STRONGEST_AT_STOP = 1e9
"""N or N m: at a stop ODE adds the motor's force to the loads, and the stop gives way by force * CFM * step size."""

ERP: Check[float] = number(0.0, 1.0)
CFM: Check[float] = number(SMALLEST, 1e6)


def param(
    code: int, default: float, check: Check[float], *, after: str = "", unit: str = "", doc: str = ""
) -> NumberField:
    """A field for one of ODE's joint parameters."""
    return NumberField(
        default,
        check,
        lambda joint: joint._param(code),
        lambda joint, value: joint._set_param(code, value),
        after=after,
        quiet=True,
        unit=unit,
        doc=doc,
    )


class Softness(Followed):
    """ERP or CFM: its own value, or that of the spring it belongs to, or the World's.

    Args:
        code: ODE's parameter.
        of_world: "erp" or "cfm".
        spring: what stands before and after "stiffness" in the names of the spring's fields, None if there is none.
        doc: one sentence for the reference.
    """

    def __init__(self, code: int, of_world: str, spring: tuple[str, str] | None, doc: str) -> None:
        self.of_world = of_world
        self.spring = spring
        super().__init__(
            ERP if of_world == "erp" else CFM,
            lambda joint: joint._param(code),
            lambda joint, value: joint._set_param(code, value),
            lambda joint, _: self._from_spring(joint),
            doc=doc,
        )
        self.after = "_sprung" if spring is not None else ""

    def _from_spring(self, joint: Any) -> float:
        realm = joint._realm
        spring = None if self.spring is None else joint._spring(*self.spring)
        if spring is not None:
            erp, cfm = implicit(spring[0], spring[1], realm.ptr.step_size)
            return erp if self.of_world == "erp" else cfm
        get: Callable[[Any], float] = lib.dWorldGetERP if self.of_world == "erp" else lib.dWorldGetCFM
        return get(realm.ptr.id)


def spring_fields(
    codes: tuple[int, int], place: tuple[str, str], what: str, *, turning: bool
) -> tuple[Softness, Softness, OptionalNumber, OptionalNumber]:
    """The fields erp, cfm, stiffness and damping of something that gives way.

    Args:
        codes: ODE's parameters of ERP and CFM.
        place: what stands before and after these names in the names of the fields.
        what: it is, for the reference.
        turning: whether it gives way in angles.
    """
    stiff, damp = ("N m/rad", "N m s/rad") if turning else ("N/m", "N s/m")
    instead = "instead of " + " and ".join(f"{place[0]}{name}{place[1]}" for name in ("erp", "cfm"))
    return (
        Softness(codes[0], "erp", place, f"The part of the error of {what} that is corrected in one step."),
        Softness(codes[1], "cfm", place, f"Softness of {what}: speed of giving way per force, 1/(N s/m)."),
        Field(None, optional(number(0.0, 1e15)), after="_sprung", unit=stiff, doc=f"Of {what} as a spring, {instead}."),
        Field(None, optional(number(0.0, 1e15)), after="_sprung", unit=damp, doc=f"Of {what}, with its stiffness."),
    )


def motor_fields(group: int, turning: bool) -> tuple[NumberField, NumberField, Softness]:
    """The fields motor_velocity, motor_max_force and cfm of one axis."""
    code = 0x100 * group
    speed, force = ("rad/s", "N m") if turning else ("m/s", "N")
    return (
        param(
            code + lib.dParamVel, 0.0, number(-1e9, 1e9), after="_driven", unit=speed, doc="Which the motor aims at."
        ),
        param(
            code + lib.dParamFMax,
            0.0,
            number(0.0, math.inf, infinite=True),
            after="_driven",
            unit=force,
            doc=f"What the motor may use; 0: no motor. With stops at most {STRONGEST_AT_STOP:g}.",
        ),
        Softness(code + lib.dParamCFM, "cfm", None, "How soft the motor is."),
    )


def stop_fields(
    group: int, after: str, turning: bool
) -> tuple[NumberField, Softness, Softness, OptionalNumber, OptionalNumber, NumberField]:
    """The fields stop_bounce, stop_erp, stop_cfm, stop_stiffness, stop_damping and fudge_factor of one axis."""
    code = 0x100 * group
    return (
        param(code + lib.dParamBounce, 0.0, number(0.0, 1.0), doc="Part of the speed that comes back from a stop."),
        *spring_fields(
            (code + lib.dParamStopERP, code + lib.dParamStopCFM), ("stop_", after), "the stops", turning=turning
        ),
        param(
            code + lib.dParamFudgeFactor,
            1.0,
            number(0.0, 1.0),
            doc="Part of the motor's force with which it leaves a stop, against jumping off it.",
        ),
    )


def stops_field(limit: float, unlimited: float, unit: str, doc: str, group: int = 0) -> Field[Stops, Stops]:
    """The low and high stop of one axis.

    Args:
        limit: what both must lie within.
        unlimited: the high stop that means none (the low one is -inf). For a hinge pi: with inf, a stop that is
            taken away while the hinge is at it leaves ODE with a wrong count of rows.
        unit: for the reference.
        doc: for the reference.
        group: of ODE's parameters.
    """
    low_code, high_code = 0x100 * group + lib.dParamLoStop, 0x100 * group + lib.dParamHiStop

    end = number(-limit, limit)

    def convert(value: Any) -> tuple[float, float]:
        low, high = (end.convert(v) for v in value)
        if low > high:
            raise ValueError
        return low, high

    def read(joint: Any) -> Stops:
        low, high = joint._param(low_code), joint._param(high_code)
        return None if math.isinf(low) or math.isinf(high) else (low, high)

    def write(joint: Any, value: Stops) -> None:
        low, high = (-math.inf, unlimited) if value is None else value
        # ODE ignores a low stop above the high one, so the range is opened first.
        joint._set_param(low_code, -math.inf)
        joint._set_param(high_code, high)
        joint._set_param(low_code, low)

    words = f"two numbers (low, high) from {-limit:g} to {limit:g}, the lower first, or None"
    check: Check[Stops] = Check(words, lambda value: None if value is None else convert(value))
    return Field(None, check, read, write, after="_driven", quiet=True, unit=unit, doc=doc)


class SpringFields(TypedDict, total=False):
    """The keyword arguments of joints that give way as a whole."""

    erp: float | None
    cfm: float | None
    stiffness: float | None
    damping: float | None


class LimotFields(TypedDict, total=False):
    """The keyword arguments of the only axis of a joint."""

    stops: Stops
    stop_bounce: float
    stop_erp: float | None
    stop_cfm: float | None
    stop_stiffness: float | None
    stop_damping: float | None
    motor_velocity: float
    motor_max_force: float
    fudge_factor: float
    cfm: float | None


class Limot1Fields(TypedDict, total=False):
    """The keyword arguments of the first of several axes."""

    stops1: Stops
    stop_bounce1: float
    stop_erp1: float | None
    stop_cfm1: float | None
    stop_stiffness1: float | None
    stop_damping1: float | None
    motor_velocity1: float
    motor_max_force1: float
    fudge_factor1: float
    cfm1: float | None


class Limot2Fields(TypedDict, total=False):
    """The keyword arguments of the second of several axes."""

    stops2: Stops
    stop_bounce2: float
    stop_erp2: float | None
    stop_cfm2: float | None
    stop_stiffness2: float | None
    stop_damping2: float | None
    motor_velocity2: float
    motor_max_force2: float
    fudge_factor2: float
    cfm2: float | None


class Limot3Fields(TypedDict, total=False):
    """The keyword arguments of the third axis."""

    stops3: Stops
    stop_bounce3: float
    stop_erp3: float | None
    stop_cfm3: float | None
    stop_stiffness3: float | None
    stop_damping3: float | None
    motor_velocity3: float
    motor_max_force3: float
    fudge_factor3: float
    cfm3: float | None


class MotorFields(TypedDict, total=False):
    """The motors of three axes without stops."""

    motor_velocity1: float
    motor_max_force1: float
    cfm1: float | None
    motor_velocity2: float
    motor_max_force2: float
    cfm2: float | None
    motor_velocity3: float
    motor_max_force3: float
    cfm3: float | None


class Driven(Joint):
    """A joint with motors, and perhaps with stops."""

    MOTORS: ClassVar[dict[int | None, tuple[NumberField, NumberField]]] = {}
    """Of each axis, None for the only one: the fields of the motor's force and velocity."""
    STOPPED: ClassVar[tuple[tuple[Field[Stops, Stops], NumberField], ...]] = ()
    """Of each axis with stops: their field, and that of the motor's force."""
    _driver: Any = None
    """What drives the motor instead of a user: a servo."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        fields, start = cls.FIELDS, "motor_max_force"
        axes = sorted(name.removeprefix(start) for name in fields if name.startswith(start))
        cls.MOTORS = {
            int(axis) if axis else None: (fields[start + axis], fields[f"motor_velocity{axis}"]) for axis in axes
        }
        cls.STOPPED = tuple((fields[f"stops{axis}"], fields[start + axis]) for axis in axes if f"stops{axis}" in fields)

    def _driven(self) -> None:
        self._check_force()
        self._wake()

    def _check_force(self) -> None:
        """Refuse a motor that is too strong for the stops of its axis, or whose axis there isn't."""
        for field, force in self.STOPPED:
            strength = getattr(self, force.name)
            if strength > STRONGEST_AT_STOP and (stops := getattr(self, field.name)) is not None:
                raise FieldError(
                    f"{self.describe()}.{force.name} is {strength:g}; "
                    f"with {field.name}={stops} it must be at most {STRONGEST_AT_STOP:g}"
                )

    def motor(self, velocity: float, max_force: float, *, axis: int | None = None) -> None:
        """Drive at ``velocity`` (rad/s or m/s) with at most ``max_force`` (N m or N).

        Args:
            velocity: what the motor aims at.
            max_force: what it may use.
            axis: which, from 1, for a joint with several.

        Raises:
            FieldError: for a bad number, or an axis that the joint hasn't got.
        """
        fields = self.MOTORS.get(axis) if axis is None or type(axis) is int else None
        if fields is None:
            known = [str(each) for each in self.MOTORS if each is not None]
            right = f"must be one of {', '.join(known)}" if known else "must not be given"
            raise FieldError(f"{self.describe()}.motor().axis is {shown(axis)}; it {right}")
        values = fields[0].checked(self, max_force), fields[1].checked(self, velocity)
        realm = self._realm
        if realm is None or self._driver is not None:
            for field, value in zip(fields, values, strict=True):
                setattr(self, field.name, value)
            return
        with realm.holding():
            before = fields[0].own(self)
            fields[0]._put(self, values[0])
            if values[0] > STRONGEST_AT_STOP or values[0] > before == 0.0:  # else it was allowed before
                try:
                    self._check_force()
                except BaseException:
                    fields[0]._put(self, before)
                    raise
            fields[1]._put(self, values[1])
            self._rouse()
