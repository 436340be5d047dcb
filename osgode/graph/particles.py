"""Particles: smoke, sparks and the like, many small patches that face the camera."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Self
from weakref import ReferenceType

import numpy as np

from osgode.errors import FieldError, shown
from osgode.graph.frame import Sprites
from osgode.graph.lod import Gated
from osgode.graph.movers import Marks
from osgode.graph.node import Node
from osgode.graph.spray import SMOKE, Spray, checked_numbers
from osgode.graph.transforms import matrix_to_root
from osgode.maths import ZERO, Float32Array, FloatArray, Vec3

DRAWS = 8
"""Random numbers that each particle takes, so that how time is cut doesn't change which it gets."""
PLACE, VELOCITY, AGE, LIFE, SIZE = slice(0, 3), slice(3, 6), 6, 7, 8
COLUMNS = 9


class Particles(Node):
    """An emitter of particles: a fire, an exhaust, an explosion.

    Particles leave from where transforms and moving bodies have taken the node, steadily by `rate` or at once by
    `burst`, and stay in the axes of the root from then on. Nothing happens until time goes on for them: by `advance`,
    or by a clock that `follow` looks at in each update traversal. The same seed and the same calls give the same
    particles. A body that is copied has its emitters copied too; below a transform that several nodes share there is
    one, which follows the first of the ways. All are drawn by one call, after what is transparent, without shadows.

        smoke = chimney.attach(Particles(SMOKE, rate=25))
        smoke.follow(lambda: world.time)

    Args:
        spray: what comes out and what becomes of it; `SMOKE`, `FIRE`, `SPARKS` and `DUST` are there to begin with.
        rate: particles a second; 0 for bursts alone.
        capacity: how many there may be; then the oldest make room.
        seed: of the random numbers.
        name: for messages and paths.
        visible: whether they are drawn; they move on where they aren't.
        changes: fields of the spray that are to be others.

    Raises:
        FieldError: if the rate is below 0, the capacity below 1, or a number is not finite.
    """

    SHARED = False

    def __init__(
        self,
        spray: Spray = SMOKE,
        *,
        rate: float = 0.0,
        capacity: int = 2000,
        seed: int = 0,
        name: str = "",
        visible: bool = True,
        **changes: Any,
    ) -> None:
        super().__init__(name=name, visible=visible)
        if capacity < 1:
            raise FieldError(f"{self.describe()}.capacity is {capacity!r}; it must be 1 or more")
        if not isinstance(spray, Spray):
            raise FieldError(f"{self.describe()}.spray is {shown(spray)}; it must be a Spray")
        self.spray = replace(spray, **changes)
        self.rate = rate
        self.capacity = int(capacity)
        self.seed = seed
        self._clock: Callable[[], float] | None = None
        self._dice = np.random.default_rng(seed)
        self._rows = np.zeros((0, COLUMNS))
        self._due = 0.0
        self._matrix: FloatArray | None = None

    def __len__(self) -> int:
        """How many particles there are now."""
        return len(self._rows)

    def __bool__(self) -> bool:
        """A node is there, also while it has no particles."""
        return True

    @property
    def rate(self) -> float:
        """Particles a second."""
        return self._rate

    @rate.setter
    def rate(self, value: float) -> None:
        (self._rate,) = checked_numbers(f"{self.describe()}.rate", (value,), 1, least=0.0)

    @property
    def positions(self) -> FloatArray:
        """Where the particles are, in the axes of the root, the oldest first: an (n, 3) copy."""
        return self._rows[:, PLACE].copy()

    def burst(self, count: int) -> Self:
        """Let ``count`` particles out at once, from where the node is now.

        Raises:
            FieldError: if the count is below 0.
        """
        if count < 0:
            raise FieldError(f"{self.describe()}.burst() of {count!r}; it must be 0 or more")
        matrix = matrix_to_root(self)
        self._spawn(np.zeros(int(count)), matrix, matrix, ZERO)
        return self

    def copy(self) -> Self:
        """A new emitter of the same spray, rate, capacity and seed, that follows the same clock; without particles."""
        twin = type(self)(
            self.spray, rate=self.rate, capacity=self.capacity, seed=self.seed, name=self.name, visible=self.visible
        )
        if self._clock is not None:
            twin.follow(self._clock)
        return twin

    def _twin(self) -> Node:
        return self.copy()

    def clear(self) -> None:
        """Take all particles away."""
        self._rows = self._rows[:0]

    def advance(self, seconds: float) -> None:
        """Let time go on: particles move, age and vanish, and new ones come by `rate`.

        Between two calls the node is taken to have moved straight on, so that something fast leaves no gaps.

        Raises:
            FieldError: if ``seconds`` is below 0 or not finite.
        """
        (seconds,) = checked_numbers(f"{self.describe()}.advance()", (seconds,), 1, least=0.0)
        if seconds == 0.0:
            return
        self._move(self._rows, np.full(len(self._rows), seconds))
        self._rows = self._rows[self._rows[:, AGE] < self._rows[:, LIFE]]
        before, now = self._matrix, matrix_to_root(self)
        before = now if before is None else before
        due = self._due + self._rate * seconds
        count = math.floor(due)
        if count:
            ages = (due - np.arange(1.0, count + 1.0)[-self.capacity :]) / self._rate
            motion = Vec3(*((now[:3, 3] - before[:3, 3]) / seconds * self.spray.inherit).tolist())
            self._spawn(np.minimum(ages, seconds), now + (before - now) * (ages / seconds)[:, None, None], now, motion)
        self._due = due - count
        self._matrix = now

    def follow(self, clock: Callable[[], float]) -> Callable[[Node], None]:
        """In each update traversal, advance by how far ``clock()`` has gone on since the one before.

        A clock that goes back, as that of a World that is set back, lets nothing happen. Returns the callback, for
        `remove_on_update`.
        """
        last = clock()
        self._clock = clock

        def update(node: Node) -> None:
            nonlocal last
            del node
            now = clock()
            self.advance(max(now - last, 0.0))
            last = now

        self.on_update(update)
        return update

    def _spawn(self, ages: FloatArray, matrices: FloatArray, now: FloatArray, motion: Vec3) -> None:
        """New particles that came out of ``matrices``, (4, 4) or one each, so many seconds ago."""
        spray = self.spray
        count = len(ages)
        dice = self._dice.random((count, DRAWS))
        rows = np.empty((count, COLUMNS))
        vary = 1.0 + spray.jitter * (2.0 * dice[:, 2:5] - 1.0)
        # In a ball evenly: a direction, and the cube root of an even number for the radius.
        away = _directions(dice[:, 5], dice[:, 6], math.pi) * (spray.radius * np.cbrt(dice[:, 7]))[:, None]
        rows[:, PLACE] = (matrices[..., :3, :3] @ away[..., None])[..., 0] + matrices[..., :3, 3]
        speed = spray.velocity.length
        ways = _directions(dice[:, 0], dice[:, 1], spray.spread) @ _turning_up_to(spray.velocity).T
        rows[:, VELOCITY] = (ways * (speed * vary[:, 0])[:, None]) @ now[:3, :3].T + motion
        rows[:, AGE] = 0.0
        rows[:, LIFE] = np.maximum(spray.lifetime * vary[:, 1], 1e-3)
        rows[:, SIZE] = vary[:, 2]
        self._move(rows, ages)
        rows = rows[rows[:, AGE] < rows[:, LIFE]]
        self._rows = np.concatenate([self._rows, rows])[-self.capacity :]

    def _move(self, rows: FloatArray, seconds: FloatArray) -> None:
        """Move and age ``rows``, each for its own time: the exact solution of ``v' = gravity - drag * (v - wind)``."""
        spray, t = self.spray, seconds[:, None]
        gravity, velocity = np.array(spray.gravity), rows[:, VELOCITY]
        if spray.drag > 0.0:
            final = np.array(spray.wind) + gravity / spray.drag
            left = np.exp(-spray.drag * t)
            rows[:, PLACE] += final * t + (velocity - final) * ((1.0 - left) / spray.drag)
            rows[:, VELOCITY] = final + (velocity - final) * left
        else:
            rows[:, PLACE] += velocity * t + gravity * (0.5 * t * t)
            rows[:, VELOCITY] = velocity + gravity * t
        rows[:, AGE] += seconds

    def sprites(self) -> Sprites | None:
        """What is drawn now, in the axes of the root; None if there is nothing."""
        if not len(self._rows):
            return None
        spray, rows = self.spray, self._rows
        share = rows[:, AGE] / rows[:, LIFE]
        drawn: Float32Array = np.zeros((len(rows), 12), np.float32)
        drawn[:, :3] = rows[:, PLACE]
        drawn[:, 3] = rows[:, SIZE] * (spray.size[0] + (spray.size[1] - spray.size[0]) * share)
        stops = np.linspace(0.0, 1.0, len(spray.colours))
        for k in range(4):
            drawn[:, 4 + k] = np.interp(share, stops, [colour[k] for colour in spray.colours])
        drawn[:, 8:11] = rows[:, VELOCITY] * spray.streak
        return Sprites(drawn, spray.additive)


def _directions(even: FloatArray, around: FloatArray, spread: float) -> FloatArray:
    """Directions evenly within an angle from +Y, by two even random numbers each: (n, 3) of length 1."""
    cosine = 1.0 - even * (1.0 - math.cos(spread))
    sine = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
    angle = around * (2.0 * math.pi)
    return np.stack([sine * np.cos(angle), cosine, sine * np.sin(angle)], axis=-1)


def _turning_up_to(direction: Vec3) -> FloatArray:
    """A rotation that turns +Y into a direction; the identity for none."""
    if direction.length < 1e-12:
        return np.identity(3)
    up = direction.normalized()
    helper = Vec3(1.0, 0.0, 0.0) if abs(up.x) < 0.9 else Vec3(0.0, 0.0, 1.0)
    side = helper.cross(up).normalized()
    return np.array([up.cross(side), up, side]).T


class Cloud(NamedTuple):
    """Particles on the way from the root, which aren't kept alive, and the gates that must be open."""

    node: ReferenceType[Particles]
    gates: tuple[int, ...]


class Clouds:
    """All particles below a root.

    Args:
        clouds: in the order of the walk.
    """

    def __init__(self, clouds: Sequence[Cloud]) -> None:
        self._clouds = clouds
        self._gated = Gated([cloud.gates for cloud in clouds])

    def sprites(self, opened: Marks, planes: FloatArray, eye: Vec3) -> list[Sprites]:
        """What of them is in the picture, from far to near by their middles; those that hide each other, too."""
        found: list[tuple[float, Sprites]] = []
        passed = self._gated.passed(opened) if self._clouds else None
        for k, cloud in enumerate(self._clouds):
            node = cloud.node()
            shown = node.sprites() if node is not None and (passed is None or passed[k]) else None
            if shown is None:
                continue
            places = shown.rows[:, :3].astype(np.float64)
            reach = shown.rows[:, 3] + np.sqrt(np.einsum("ni,ni->n", shown.rows[:, 8:11], shown.rows[:, 8:11]))
            inside = ((planes[:, :3] @ places.T + planes[:, 3:]).min(axis=0) >= -reach).nonzero()[0]
            if not len(inside):
                continue
            away = ((places[inside] - eye) ** 2).sum(axis=1)
            order = inside if shown.additive else inside[np.argsort(-away, kind="stable")]
            found.append((float(away.mean()), Sprites(shown.rows[order], shown.additive)))
        found.sort(key=lambda pair: -pair[0])
        return [shown for _, shown in found]
