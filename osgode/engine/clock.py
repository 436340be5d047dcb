"""Time: of frames, of the simulation, and how many steps a frame is worth."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import Protocol

from osgode.engine.module import Config, Module
from osgode.fields import FLAG, number, optional

SPEED = number(0.0, 1000.0)
FRAME_RATE = optional(number(0.1, 10000.0))
SECONDS = number(0.0, 1e9)
SMOOTHED = 0.5
"""Seconds over which the frame rate is averaged."""
MOST_FRAMES = 1000
"""That are averaged at most."""
ALMOST = 1e-6
"""Of a step: what may be missing to a whole one, for rounding."""


class Timer(Protocol):
    """What tells the time and lets it pass."""

    def now(self) -> float:
        """Seconds since any moment."""

    def wait(self, seconds: float) -> None:
        """Come back when they have passed."""


class RealTime:
    """The time on the wall."""

    def now(self) -> float:
        """Seconds."""
        return time.perf_counter()

    def wait(self, seconds: float) -> None:
        """Sleep."""
        time.sleep(seconds)


class HandTime:
    """A time that stands still until somebody waits, or moves it on: a run by it is always the same."""

    def __init__(self) -> None:
        self._now = 0.0

    def now(self) -> float:
        """Seconds."""
        return self._now

    def wait(self, seconds: float) -> None:
        """Move it on at once."""
        self.advance(seconds)

    def advance(self, seconds: float) -> None:
        """Move it on: what a frame took.

        Raises:
            FieldError: for less than 0.
        """
        self._now += SECONDS("HandTime.advance()", "seconds", seconds)


@dataclass(frozen=True, kw_only=True)
class ClockConfig(Config):
    """Settings of the Clock.

    Args:
        frame_limit: frames a second at most, None for as many as there can be.
        speed: of the simulation: 1 real time, 0.1 slow motion, 0 none.
        paused: whether it begins standing still.
    """

    CHECKS = {"frame_limit": FRAME_RATE, "speed": SPEED, "paused": FLAG}  # noqa: RUF012 - Config has it as a ClassVar

    frame_limit: float | None = 60.0
    speed: float = 1.0
    paused: bool = False


class Clock(Module):
    """Measures frames and makes simulation time of them.

    Args:
        config: its settings.
        timer: where the time comes from; that of the wall if not given.
    """

    NAME = "clock"

    def __init__(self, config: ClockConfig | None = None, timer: Timer | None = None) -> None:
        self.config = config = ClockConfig.given(config, "Clock")
        self.timer: Timer = RealTime() if timer is None else timer
        self._limit = config.frame_limit
        self._speed = config.speed
        self.paused = config.paused
        """Whether the simulation stands still."""
        self.delta = 0.0
        """Seconds that the last frame took."""
        self.elapsed = 0.0
        """Seconds since the start."""
        self.simulated = 0.0
        """Seconds of simulation that were asked for since the start."""
        self.frames = 0
        """Frames since the start."""
        self._wanted_steps = 0
        self._last = 0.0
        self._recent: deque[float] = deque(maxlen=MOST_FRAMES)

    @property
    def frame_limit(self) -> float | None:
        """Frames a second at most; None for as many as there can be."""
        return self._limit

    @frame_limit.setter
    def frame_limit(self, value: float | None) -> None:
        self._limit = FRAME_RATE("Clock", "frame_limit", value)

    @property
    def speed(self) -> float:
        """How fast simulation time passes: 1 as real time, 0 not at all, at most 1000."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._speed = SPEED("Clock", "speed", value)

    def single_step(self) -> None:
        """Pause, and let the simulation do one step in the next frame."""
        self.paused = True
        self._wanted_steps += 1

    def take_single_steps(self) -> int:
        """How many single steps were wanted since the last call."""
        wanted, self._wanted_steps = self._wanted_steps, 0
        return wanted

    @property
    def simulation_delta(self) -> float:
        """Seconds of simulation that the last frame is worth."""
        return 0.0 if self.paused else self.delta * self._speed

    @property
    def frame_rate(self) -> float:
        """Frames a second, averaged over the last half second; 0 before the first."""
        total = sum(self._recent)
        return len(self._recent) / total if total > 0.0 else 0.0

    def start(self) -> None:
        """Begin to count."""
        self._last = self.timer.now()

    def cycle(self) -> None:
        """Wait until a frame may begin, and measure the last one."""
        if self._limit is not None:
            left = self._last + 1.0 / self._limit - self.timer.now()
            if left > 0.0:
                self.timer.wait(left)
        now = self.timer.now()
        self.delta = max(now - self._last, 0.0)
        self._last = now
        self.frames += 1
        self.elapsed += self.delta
        self.simulated += self.simulation_delta
        self._recent.append(self.delta)
        while len(self._recent) > 1 and sum(self._recent) > SMOOTHED:
            self._recent.popleft()


class Accumulator:
    """Turns seconds into whole steps, and keeps the rest for the next time.

    Args:
        max_steps: that are done for one frame. What is above is lost: a machine too slow for its scene would else fall
            behind more and more with each frame.
    """

    def __init__(self, max_steps: int) -> None:
        self.max_steps = max_steps
        self.rest = 0.0
        """Seconds that were not enough for a step."""
        self.lost = 0.0
        """Seconds that were left out in all."""

    def take(self, seconds: float, step_size: float) -> int:
        """How many steps of ``step_size`` to do for so many seconds more."""
        self.rest += seconds
        steps = int(self.rest / step_size + ALMOST)
        if steps > self.max_steps:
            over = self.rest - self.max_steps * step_size
            self.lost += over
            self.rest -= over
            steps = self.max_steps
        self.rest = max(self.rest - steps * step_size, 0.0)
        return steps

    def interpolation(self, step_size: float) -> float:
        """How far the picture is between the step before the last and the last, 0 to 1."""
        return min(self.rest / step_size, 1.0)
