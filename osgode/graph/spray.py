"""What comes out of an emitter of particles, and what becomes of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from osgode.errors import FieldError
from osgode.maths import ZERO, Vec3, finite

Colour = tuple[float, float, float, float]


def checked_numbers(
    name: str, value: Any, count: int, *, least: float = -math.inf, most: float = math.inf
) -> tuple[float, ...]:
    """``value`` as so many floats.

    Raises:
        FieldError: naming ``name``, if it is not so many finite numbers between ``least`` and ``most``.
    """
    try:
        numbers = tuple(map(float, value))
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) == count and finite(numbers) and least <= min(numbers) and max(numbers) <= most:
        return numbers
    wanted = f"{count} finite numbers" if count > 1 else "a finite number"
    if math.isfinite(most):
        wanted += f" from {least:g} to {most:.6g}"
    elif math.isfinite(least):
        wanted += f", {least:g} or more"
    raise FieldError(f"{name} is {value[0] if count == 1 else value!r}; it must be {wanted}")


@dataclass(frozen=True)
class Spray:
    """What comes out of an emitter, and what becomes of it.

    Args:
        velocity: with which particles leave, in the axes of the emitter, m/s.
        spread: the greatest angle from there, radians; pi for all sides.
        radius: of the ball about the emitter's origin in which they appear, metres.
        inherit: the share of the emitter's own velocity that they take along.
        lifetime: seconds.
        jitter: the share by which speed, lifetime and size differ at random.
        gravity: acceleration in the axes of the root, m/s^2; upwards for hot smoke.
        drag: the share of the velocity against the wind that is lost in a second, as of ``exp(-drag * t)``; 1/s.
        wind: velocity of the air in the axes of the root, m/s.
        size: radius at the beginning and at the end, metres.
        colours: red, green, blue and opacity from 0 to 1, over the life at even distances; one or more.
        additive: whether they shine and add to what is behind them, instead of hiding it and being lit by the sun.
        streak: seconds of its way over which a particle is drawn out, for sparks; 0 for round ones.

    Raises:
        FieldError: if a number is not finite, or one that has to be is not 0 or more.
    """

    velocity: Vec3 = Vec3(0.0, 1.0, 0.0)
    spread: float = 0.3
    radius: float = 0.0
    inherit: float = 0.0
    lifetime: float = 2.0
    jitter: float = 0.2
    gravity: Vec3 = ZERO
    drag: float = 0.0
    wind: Vec3 = ZERO
    size: tuple[float, float] = (0.1, 0.3)
    colours: tuple[Colour, ...] = ((1.0, 1.0, 1.0, 1.0), (1.0, 1.0, 1.0, 0.0))
    additive: bool = False
    streak: float = 0.0

    def __post_init__(self) -> None:
        for name in ("velocity", "gravity", "wind"):
            object.__setattr__(self, name, Vec3(*checked_numbers(f"Spray.{name}", getattr(self, name), 3)))
        object.__setattr__(self, "size", checked_numbers("Spray.size", self.size, 2, least=0.0))
        limits = {"spread": math.pi, "inherit": math.inf, "jitter": 1.0}
        for name in ("spread", "radius", "inherit", "lifetime", "jitter", "drag", "streak"):
            given, most = (getattr(self, name),), limits.get(name, math.inf)
            (value,) = checked_numbers(f"Spray.{name}", given, 1, least=0.0, most=most)
            object.__setattr__(self, name, value)
        if self.lifetime == 0.0:
            raise FieldError("Spray.lifetime is 0; it must be above 0")
        colours = tuple(checked_numbers("Spray.colours", colour, 4, least=0.0, most=1.0) for colour in self.colours)
        if not colours:
            raise FieldError("Spray.colours is empty; there must be one or more")
        object.__setattr__(self, "colours", colours)


SMOKE = Spray(
    velocity=Vec3(0, 1.1, 0),
    spread=0.35,
    radius=0.12,
    lifetime=4.0,
    jitter=0.35,
    gravity=Vec3(0, 0.35, 0),
    drag=0.5,
    size=(0.18, 1.1),
    colours=((0.25, 0.24, 0.23, 0.0), (0.32, 0.31, 0.3, 0.5), (0.5, 0.5, 0.5, 0.25), (0.62, 0.62, 0.62, 0.0)),
)
FIRE = Spray(
    velocity=Vec3(0, 1.2, 0),
    spread=0.25,
    radius=0.22,
    lifetime=0.9,
    jitter=0.35,
    gravity=Vec3(0, 2.0, 0),
    drag=1.0,
    size=(0.3, 0.08),
    colours=((0.7, 0.3, 0.12, 0.0), (0.95, 0.4, 0.1, 0.3), (0.9, 0.2, 0.02, 0.3), (0.5, 0.06, 0.0, 0.0)),
    additive=True,
)
SPARKS = Spray(
    velocity=Vec3(0, 5.0, 0),
    spread=0.7,
    lifetime=0.8,
    jitter=0.5,
    gravity=Vec3(0, -9.81, 0),
    drag=0.4,
    size=(0.018, 0.01),
    colours=((1.0, 0.95, 0.75, 1.0), (1.0, 0.75, 0.3, 1.0), (0.9, 0.3, 0.05, 0.0)),
    additive=True,
    streak=0.04,
)
DUST = Spray(
    velocity=Vec3(0, 1.6, 0),
    spread=1.5,
    radius=0.1,
    lifetime=1.6,
    jitter=0.4,
    gravity=Vec3(0, -0.3, 0),
    drag=2.5,
    size=(0.15, 0.6),
    colours=((0.6, 0.54, 0.44, 0.0), (0.62, 0.56, 0.46, 0.4), (0.66, 0.61, 0.52, 0.2), (0.7, 0.66, 0.58, 0.0)),
)
