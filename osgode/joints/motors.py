"""Motors without an anchor: they govern how two bodies turn, or move, against each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, Unpack

from osgode.errors import FieldError, shown
from osgode.fields import DIRECTION, NumberField, choice, number
from osgode.joints.anchored import right_angle
from osgode.joints.base import JointFields
from osgode.joints.limits import (
    Driven,
    Limot1Fields,
    Limot2Fields,
    Limot3Fields,
    MotorFields,
    motor_fields,
    stop_fields,
    stops_field,
)
from osgode.joints.spots import BODY1, BODY2, Coordinate
from osgode.maths import ZERO, Vec3, Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body

SIDES = {"world": None, "body1": BODY1, "body2": BODY2}
RELATIVE = choice(*SIDES)
MODE = choice("user", "euler")


class _Motor(Driven):
    """Up to three axes, each fixed in the world or carried by a body."""

    def __init__(
        self,
        body1: Body,
        body2: Body | None,
        *,
        axes: Sequence[Vec3Like],
        relative_to: str | Sequence[str],
        name: str,
        **fields: Any,
    ) -> None:
        self.name = name
        self._axes, self._relative = self._checked_axes(axes, relative_to)
        super().__init__(body1, body2, name=name, spots={}, **fields)

    def _checked_axes(self, axes: Any, relative_to: Any) -> tuple[list[Vec3], list[str]]:
        try:
            given = list(axes)
        except TypeError:
            given = [None] * 4
        if len(given) > 3:
            raise FieldError(f"{self.describe()}.axes is {shown(axes)}; it must be a list of at most 3 directions")
        names = [relative_to] * len(given) if isinstance(relative_to, str) else list(relative_to)
        if len(names) != len(given):
            raise FieldError(
                f"{self.describe()}.relative_to is {shown(relative_to)}; it must be one of 'world', 'body1', 'body2', "
                f"or a list with one of these for each of the {len(given)} axes"
            )
        checked = [DIRECTION(self.describe(), f"axes[{i}]", axis) for i, axis in enumerate(given)]
        return checked, [RELATIVE(self.describe(), f"relative_to[{i}]", each) for i, each in enumerate(names)]

    @property
    def relative_to(self) -> tuple[str, ...]:
        """What carries each axis: "world", "body1" or "body2"."""
        return tuple(self._relative)

    @property
    def axes(self) -> tuple[Vec3, ...]:
        """The axes in the world as they stand now, unit vectors.

        Setting them anchors the joint anew: the present poses become those of rest.
        """
        return tuple(self._axis_now(axis, side) for axis, side in zip(self._axes, self._relative, strict=True))

    @axes.setter
    def axes(self, value: Sequence[Vec3Like]) -> None:
        self._set_axes(value)

    def _set_axes(self, value: Sequence[Vec3Like]) -> None:
        given = list(value) if isinstance(value, Iterable) else []
        if len(given) != len(self._axes):
            raise FieldError(
                f"{self.describe()}.axes is {shown(value)}; it must be {len(self._axes)} directions, as before"
            )
        axes, _ = self._checked_axes(given, self._relative)
        before = self._axes
        self._axes = axes
        try:
            super().anchor_anew()
        except BaseException:
            self._axes = before
            raise

    def _axis_now(self, axis: Vec3, relative_to: str) -> Vec3:
        side = SIDES[relative_to]
        return axis if side is None else self._carried(axis, side, is_point=False)

    def anchor_anew(self, **spots: Any) -> None:
        """Take the poses as they are now as those of rest: an Euler motor's angles are 0 there.

        Raises:
            FieldError: for any argument (set `axes`), or if the axes of an Euler motor are no longer perpendicular.
        """
        if spots:
            raise self._lacks(next(iter(spots)))
        now = [self._axis_now(axis, side) for axis, side in zip(self._axes, self._relative, strict=True)]
        self._set_axes(now)

    def _count(self) -> int:
        return len(self._axes)

    def _check_force(self) -> None:
        super()._check_force()
        for n in range(self._count() + 1, 4):
            if getattr(self, f"motor_max_force{n}") or getattr(self, f"stops{n}", None) is not None:
                raise FieldError(
                    f"{self.describe()} has {self._count()} axes, so there is no axis {n} to drive or stop"
                )

    def _layout(self) -> tuple[list[float], list[int]]:
        numbers = {"world": 0, "body1": 1, "body2": 2}
        flat = [value for axis in self._axes for value in axis]
        return flat, [0, len(self._axes), *(numbers[each] for each in self._relative)]


class AngularMotorFields(JointFields, Limot1Fields, Limot2Fields, Limot3Fields, total=False):
    """The keyword arguments of `AngularMotor` beside axes and mode."""

    user_angle1: float
    user_angle2: float
    user_angle3: float


class AngularMotor(_Motor):
    """Governs how two bodies turn against each other, about up to three axes; it leaves alone where they are.

    In the mode "user" each axis is fixed in the world or carried by a body, and the motor knows no angles: for stops it
    must be told them in ``user_angle1`` to ``3``. In the mode "euler" it measures three angles by itself: the first
    axis is carried by ``body1``, the third by ``body2``, and the second is across both. (Give the first and the third.)
    The outer two can't be told apart where the angle in the middle reaches +-pi/2: stop it before. A motor velocity of
    an outer axis is reached as such only near 0 in the middle: ODE drives cos(angle2) times it.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        axes: up to three directions in the world; for the mode "euler" two, perpendicular to each other.
        relative_to: what carries them: "world", "body1", "body2", or one of these for each.
        mode: "user" or "euler"; it can't be changed.
    """

    KIND = lib.OO_AMOTOR

    angle1 = Coordinate.angle(0, "About the first axis: the Euler angle, or the user's.")
    angle2 = Coordinate.angle(1, "About the second axis.")
    angle3 = Coordinate.angle(2, "About the third axis.")
    angle_rate1 = Coordinate.angle_rate(0, "How fast body1 turns about the first axis.")
    angle_rate2 = Coordinate.angle_rate(1, "How fast it turns about the second axis.")
    angle_rate3 = Coordinate.angle_rate(2, "How fast it turns about the third axis.")

    stops1 = stops_field(1e6, math.inf, "rad", "The values of angle1 at which it stops.")
    motor_velocity1, motor_max_force1, cfm1 = motor_fields(0, turning=True)
    stop_bounce1, stop_erp1, stop_cfm1, stop_stiffness1, stop_damping1, fudge_factor1 = stop_fields(
        0, "1", turning=True
    )
    stops2 = stops_field(1e6, math.inf, "rad", "The values of angle2 at which it stops.", group=1)
    motor_velocity2, motor_max_force2, cfm2 = motor_fields(1, turning=True)
    stop_bounce2, stop_erp2, stop_cfm2, stop_stiffness2, stop_damping2, fudge_factor2 = stop_fields(
        1, "2", turning=True
    )
    stops3 = stops_field(1e6, math.inf, "rad", "The values of angle3 at which it stops.", group=2)
    motor_velocity3, motor_max_force3, cfm3 = motor_fields(2, turning=True)
    stop_bounce3, stop_erp3, stop_cfm3, stop_stiffness3, stop_damping3, fudge_factor3 = stop_fields(
        2, "3", turning=True
    )

    user_angle1 = NumberField(0.0, number(-1e6, 1e6), after="_send_angles", unit="rad", doc="angle1 in mode 'user'.")
    user_angle2 = NumberField(0.0, number(-1e6, 1e6), after="_send_angles", unit="rad", doc="angle2 in mode 'user'.")
    user_angle3 = NumberField(0.0, number(-1e6, 1e6), after="_send_angles", unit="rad", doc="angle3 in mode 'user'.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        axes: Sequence[Vec3Like] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        relative_to: str | Sequence[str] = "world",
        mode: str = "user",
        name: str = "",
        **fields: Unpack[AngularMotorFields],
    ) -> None:
        self.name = name
        self._mode = MODE(self.describe(), "mode", mode)
        if self._mode == "euler":
            relative_to = ("body1", "body2")
        super().__init__(body1, body2, axes=axes, relative_to=relative_to, name=name, **fields)

    @property
    def mode(self) -> str:
        """Either "user" or "euler"."""
        return self._mode

    @property
    def axes(self) -> tuple[Vec3, ...]:
        """The axes in the world as they stand now, unit vectors; three in the mode "euler"."""
        axes = super().axes
        if self._mode == "user":
            return axes
        first, third = axes
        across = third.cross(first)
        return first, across.normalized() if across.length > 0.0 else across, third

    @axes.setter
    def axes(self, value: Sequence[Vec3Like]) -> None:
        self._set_axes(value)

    def _checked_axes(self, axes: Any, relative_to: Any) -> tuple[list[Vec3], list[str]]:
        if self._mode == "user":
            return super()._checked_axes(axes, relative_to)
        given = list(axes) if isinstance(axes, Sequence) and not isinstance(axes, str) else [axes]
        if len(given) != 2:
            raise FieldError(
                f"{self.describe()}.axes is {shown(axes)}; in the mode 'euler' it must be two directions: "
                "the first axis, which body1 carries, and the third, which body2 carries"
            )
        checked, sides = super()._checked_axes(given, relative_to)
        third = right_angle(self, {"axes[0]": checked[0], "axes[1]": checked[1]}, "axes[0]", "axes[1]")
        return [checked[0], third], sides

    def _count(self) -> int:
        return 3 if self._mode == "euler" else len(self._axes)

    def _layout(self) -> tuple[list[float], list[int]]:
        if self._mode == "user":
            return super()._layout()
        first, third = self._axes
        return [*first, *third.cross(first), *third], [1, 3, 1, 0, 2]

    def _send_angles(self) -> None:
        angles = (self.user_angle1, self.user_angle2, self.user_angle3)
        if self._mode == "euler" and any(angles):
            raise FieldError(f"{self.describe()} is in the mode 'euler' and measures its angles; it can't be told them")
        if self._realm is not None:
            self._put_angles()
            self._wake()

    def _put_angles(self) -> None:
        if self._mode == "user":
            for i, angle in enumerate((self.user_angle1, self.user_angle2, self.user_angle3)[: self._count()]):
                self._set_param(lib.OO_ANGLE + 0x100 * i, angle)

    def _enter_fields(self) -> None:
        super()._enter_fields()
        self._put_angles()

    def add_torques(self, torque1: float, torque2: float = 0.0, torque3: float = 0.0) -> None:
        """Turn ``body1`` about the axes (N m) in the next step, and ``body2`` against it."""
        check, total = number(), ZERO
        for i, (torque, axis) in enumerate(zip((torque1, torque2, torque3), self.axes, strict=False), 1):
            total += axis * check(f"{self.describe()}.add_torques()", f"torque{i}", torque)
        self._twist("add_torques", total)


class LinearMotorFields(JointFields, MotorFields):
    """The keyword arguments of `LinearMotor` beside its axes."""


class LinearMotor(_Motor):
    """Governs how fast the centres of mass of two bodies move against each other, along up to three axes.

    It knows no positions, so it has no stops.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        axes: up to three directions in the world.
        relative_to: what carries them: "world", "body1", "body2", or one of these for each.
    """

    KIND = lib.OO_LMOTOR

    rate1 = Coordinate.position_rate(0, "How fast body1 moves along the first axis.")
    rate2 = Coordinate.position_rate(1, "How fast it moves along the second axis.")
    rate3 = Coordinate.position_rate(2, "How fast it moves along the third axis.")

    motor_velocity1, motor_max_force1, cfm1 = motor_fields(0, turning=False)
    motor_velocity2, motor_max_force2, cfm2 = motor_fields(1, turning=False)
    motor_velocity3, motor_max_force3, cfm3 = motor_fields(2, turning=False)

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        axes: Sequence[Vec3Like] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        relative_to: str | Sequence[str] = "world",
        name: str = "",
        **fields: Unpack[LinearMotorFields],
    ) -> None:
        super().__init__(body1, body2, axes=axes, relative_to=relative_to, name=name, **fields)
