"""What is steered: where it looks, where it wants to go."""

from __future__ import annotations

import math
from typing import Any

from osgode.errors import FieldError, shown
from osgode.fields import number
from osgode.maths import ZERO, Quat, Vec3

ANGLE = number(-1e6, 1e6)
MOVES: dict[str, Vec3] = {
    "forward": Vec3(0.0, 0.0, -1.0),
    "backward": Vec3(0.0, 0.0, 1.0),
    "left": Vec3(-1.0, 0.0, 0.0),
    "right": Vec3(1.0, 0.0, 0.0),
    "ascend": Vec3(0.0, 1.0, 0.0),
    "descend": Vec3(0.0, -1.0, 0.0),
}
"""The ways in which something can want to move, in its own axes."""

Limits = tuple[float, float] | None


class Controllable:
    """Angles and wishes: what a player or a program sets, and a camera, a walker or a car follows.

    With all angles 0 it looks along -Z with Y up. Yaw turns about Y (positive to the left), then pitch about X
    (positive up), then roll about Z (positive to the left), all in radians.

    Args:
        yaw_limits, pitch_limits, roll_limits: lowest and highest angle; None: any, kept between -pi and pi.

    Raises:
        FieldError: for limits that are none.
    """

    def __init__(
        self,
        *,
        yaw_limits: Limits = None,
        pitch_limits: Limits = (-math.pi / 2, math.pi / 2),
        roll_limits: Limits = None,
    ) -> None:
        self._limits = {
            name: self._checked_limits(name, limits)
            for name, limits in (("yaw", yaw_limits), ("pitch", pitch_limits), ("roll", roll_limits))
        }
        self._angles = {"yaw": 0.0, "pitch": 0.0, "roll": 0.0}
        for name in self._angles:
            self._set(name, 0.0)
        self._moves: dict[str, None] = {}

    def _checked_limits(self, name: str, limits: Any) -> Limits:
        if limits is None:
            return None
        try:
            low, high = map(float, limits)
        except (TypeError, ValueError):
            low, high = math.nan, math.nan
        if not low <= high:
            raise FieldError(
                f"{type(self).__name__}.{name}_limits is {shown(limits)}; "
                "it must be a lowest and a highest angle, or None"
            )
        return (low, high)

    def _set(self, name: str, angle: float) -> None:
        limits = self._limits[name]
        angle = math.remainder(angle, math.tau) if limits is None else min(max(angle, limits[0]), limits[1])
        self._angles[name] = angle

    @property
    def yaw(self) -> float:
        """Angle about Y, positive to the left; set beyond its limit it stays there."""
        return self._angles["yaw"]

    @yaw.setter
    def yaw(self, value: float) -> None:
        self._set("yaw", ANGLE(type(self).__name__, "yaw", value))

    @property
    def pitch(self) -> float:
        """Angle about X, positive up; set beyond its limit it stays there."""
        return self._angles["pitch"]

    @pitch.setter
    def pitch(self, value: float) -> None:
        self._set("pitch", ANGLE(type(self).__name__, "pitch", value))

    @property
    def roll(self) -> float:
        """Angle about Z, positive to the left; set beyond its limit it stays there."""
        return self._angles["roll"]

    @roll.setter
    def roll(self, value: float) -> None:
        self._set("roll", ANGLE(type(self).__name__, "roll", value))

    def turn(self, yaw: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> None:
        """Add to the angles, within their limits.

        Raises:
            FieldError: for what is no angle; nothing is turned then.
        """
        name = f"{type(self).__name__}.turn()"
        by = {key: ANGLE(name, key, value) for key, value in (("yaw", yaw), ("pitch", pitch), ("roll", roll))}
        for key, angle in by.items():
            self._set(key, self._angles[key] + angle)

    @property
    def rotation(self) -> Quat:
        """The angles as a quaternion."""
        return Quat.from_yaw_pitch_roll(self.yaw, self.pitch, self.roll)

    # -- moving

    @property
    def moves(self) -> frozenset[str]:
        """The ways in which it wants to move now, out of `MOVES`."""
        return frozenset(self._moves)

    def move(self, **wishes: bool) -> None:
        """Want to move, or no longer: ``move(forward=True, left=False)``.

        Raises:
            FieldError: for a way that there isn't.
        """
        for name in wishes:
            if name not in MOVES:
                raise FieldError(
                    f"{type(self).__name__}.move(): there is no way {name!r}; there are {', '.join(MOVES)}"
                )
        for name, wish in wishes.items():
            if wish:
                self._moves[name] = None
            else:
                self._moves.pop(name, None)

    def stop(self) -> None:
        """Want to stand still."""
        self._moves.clear()

    @property
    def wish(self) -> Vec3:
        """Where it wants to go, in its own axes: length 1, or 0 for standing still."""
        return _direction(sum((MOVES[name] for name in MOVES if name in self._moves), ZERO))

    @property
    def movement(self) -> Vec3:
        """The same in the world, by all three angles: how something flies."""
        return self.rotation.rotate(self.wish)

    @property
    def level_movement(self) -> Vec3:
        """Where it wants to go in the world by the yaw alone, up and down left out: how something walks."""
        if not self._moves:
            return ZERO
        total = sum((MOVES[name] for name in MOVES if name in self._moves), ZERO)
        return Quat.from_yaw_pitch_roll(self.yaw).rotate(_direction(Vec3(total.x, 0.0, total.z)))


def _direction(total: Vec3) -> Vec3:
    return total.normalized() if total.length > 0.5 else ZERO
