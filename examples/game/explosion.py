"""An explosion: a ball of fire that grows, changes its colour, pushes away what it reaches, and is gone.

It is a body without gravity and without geoms. In each step it asks its space what is in it, by `Space.overlaps`, and
pushes each body once; so nothing that looks around with rays ever takes it for something solid.
"""

from __future__ import annotations

import itertools
import math

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.game.effects import burst
from osgode.examples.game.shapes import lathed

DURATION = 0.7
"""Seconds from the flash to the last smoke."""
FIRST_RADIUS, RADIUS = 0.3, 5.0
"""At the beginning and in the end, metres."""
PRESSURE = 4000.0
"""In the middle, Pa; it falls to 0 at `RADIUS`."""
CORE = 0.3
"""Nearer than this to the middle nothing is pushed harder, metres."""
LIFT = 0.3
"""How much of the push goes upwards, for what stands on the ground is thrown, not shoved."""
COLOURS = (
    (0.0, (1.0, 1.0, 0.85, 0.95)),
    (0.15, (1.0, 0.85, 0.3, 0.85)),
    (0.4, (0.98, 0.45, 0.08, 0.6)),
    (0.7, (0.55, 0.16, 0.05, 0.35)),
    (1.0, (0.15, 0.13, 0.12, 0.0)),
)
"""Parts of its time, and red, green, blue and opacity then."""
BALL = lathed([(math.sin(a * math.pi / 32), math.cos(a * math.pi / 32)) for a in range(33)], oo.Appearance(), 64).mesh
"""Of radius 1, and rounder than spheres are drawn, since it fills the picture."""
FIREBALL = oo.Spray(
    velocity=oo.Vec3(0.0, 7.0, 0.0),
    spread=math.pi,
    radius=0.5,
    lifetime=0.8,
    jitter=0.5,
    drag=2.0,
    gravity=oo.Vec3(0.0, 3.0, 0.0),
    size=(0.5, 1.3),
    colours=((1.0, 0.7, 0.3, 0.0), (1.0, 0.55, 0.15, 0.5), (0.6, 0.15, 0.03, 0.3), (0.2, 0.04, 0.01, 0.0)),
    additive=True,
)
SPARKS = oo.Spray(
    velocity=oo.Vec3(0.0, 15.0, 0.0),
    spread=math.pi,
    lifetime=1.1,
    jitter=0.6,
    gravity=oo.Vec3(0.0, -9.81, 0.0),
    drag=0.8,
    size=(0.05, 0.02),
    colours=oo.SPARKS.colours,
    additive=True,
    streak=0.045,
)
SMOKE = oo.Spray(
    velocity=oo.Vec3(0.0, 3.5, 0.0),
    spread=math.pi,
    radius=0.8,
    lifetime=3.0,
    jitter=0.4,
    gravity=oo.Vec3(0.0, 0.8, 0.0),
    drag=1.5,
    size=(0.5, 1.9),
    colours=((0.1, 0.09, 0.08, 0.0), (0.15, 0.14, 0.13, 0.6), (0.32, 0.31, 0.3, 0.3), (0.5, 0.5, 0.5, 0.0)),
)
BURSTS = ((SMOKE, 60), (FIREBALL, 90), (SPARKS, 160))
"""What comes out, and how many, at the usual radius."""
SHELLS = ((1.0, 1.0), (0.72, 0.8), (0.45, 0.6))
"""Balls within one another: parts of its radius, and how far each is on in its colours."""


class Explosion(CompositeObject):
    """Goes off when it comes into a World, and leaves it when it is over.

    Args:
        position: of its middle, metres in the world.
        radius: that it grows to, metres.
        pressure: in its middle, Pa.
        duration: seconds.
        name: for messages and paths.
    """

    def __init__(
        self,
        position: oo.Vec3Like = (0.0, 0.0, 0.0),
        *,
        radius: float = RADIUS,
        pressure: float = PRESSURE,
        duration: float = DURATION,
        name: str = "explosion",
    ) -> None:
        super().__init__(name=name)
        self.pressure = pressure
        self.full_radius = radius
        self.duration = duration
        self.pushed: dict[oo.Body, float] = {}
        """What it has pushed so far, and the sum of the impulses, N s."""
        self._age = 0
        body = self.attach(oo.Body(name=f"{name} middle", position=position, gravity=False))
        self._shells = [body.attach(oo.PositionAttitudeTransform()) for _ in SHELLS]
        self._leaves: list[oo.Leaf] = []
        self._show()

    @property
    def age(self) -> float:
        """How much of its time is over, 0 to 1."""
        world = self.world
        return 0.0 if world is None else min(self._age * world.step_size / self.duration, 1.0)

    @property
    def radius(self) -> float:
        """Now, metres: it grows fast at first and slower and slower."""
        return FIRST_RADIUS + (self.full_radius - FIRST_RADIUS) * (1.0 - (1.0 - self.age) ** 2)

    def entered(self) -> None:
        """Begin."""
        self.schedule(_grow)
        if self.space is not None:
            share = (self.full_radius / RADIUS) ** 2
            for number, (spray, count) in enumerate(BURSTS):
                burst(self.space, self.main_body.position, spray, round(count * share), seed=number)

    def grow(self) -> bool:
        """A step of it: push, grow, change colour; and be gone when its time is over.

        Returns:
            Whether it goes on.
        """
        self._push()
        self._age += 1
        if self.age >= 1.0:
            self.leave()
            return False
        self._show()
        return True

    def impulse_at(self, distance: float, area: float) -> float:
        """The impulse of one step on something as large as that so far from the middle, N s.

        Args:
            distance: metres.
            area: square metres.
        """
        near = max(1.0 - max(distance, CORE) / self.full_radius, 0.0)
        step_size = 0.0 if self.world is None else self.world.step_size
        return self.pressure * near * area * step_size

    def _push(self) -> None:
        space = self.space
        if space is None:
            return
        middle = self.main_body.position
        # A body of several parts is named once for each of them: it is pushed once, for all of its size.
        found = dict.fromkeys(
            hit.body for hit in space.overlaps(oo.Sphere(self.radius), middle, exclude=[self]) if hit.body is not None
        )
        for body in found:
            way = body.world_centre_of_mass - middle
            outward = way.normalized() if way.length > 1e-6 else oo.Vec3(0.0, 1.0, 0.0)
            impulse = self.impulse_at(way.length, area_of(body))
            if impulse > 0.0 and not body.kinematic:
                body.apply_impulse((outward + oo.Vec3(0.0, LIFT, 0.0)).normalized() * impulse)
                self.pushed[body] = self.pushed.get(body, 0.0) + impulse

    def _show(self) -> None:
        for place, leaf in zip(self._shells, self._leaves, strict=False):
            place.detach(leaf)
        self._leaves = []
        for place, (part, ahead) in zip(self._shells, SHELLS, strict=True):
            look = oo.Appearance(colour_at(self.age * ahead), unlit=True)
            self._leaves.append(place.attach(oo.Leaf([oo.Drawable(BALL, look)])))
            place.scale = self.radius * part


def _grow(explosion: Explosion) -> bool:
    return explosion.grow()


def colour_at(age: float) -> tuple[float, float, float, float]:
    """Red, green, blue and opacity after a part of its time, between the rows of `COLOURS`."""
    for (start, before), (end, after) in itertools.pairwise(COLOURS):
        if age <= end:
            part = (age - start) / (end - start)
            red, green, blue, opacity = (a + (b - a) * part for a, b in zip(before, after, strict=True))
            return red, green, blue, opacity
    return COLOURS[-1][1]


def area_of(body: oo.Body) -> float:
    """About how large a body looks from any side, square metres: of its geoms' boxes the volume to the power 2/3."""
    volume = 0.0
    for geom in body.geoms:
        low, high = geom.bounds
        volume += math.prod(b - a for a, b in zip(low, high, strict=True) if math.isfinite(b - a))
    return float(volume ** (2.0 / 3.0))
