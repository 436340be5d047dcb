"""What the benchmarks share: medians, turns, and lines of a table."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parent.parent


class Spread(NamedTuple):
    """The middle of many measurements, and the quarters below and above it."""

    low: float
    median: float
    high: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """The quartiles of some values."""
        low, median, high = statistics.quantiles(values, n=4, method="inclusive")
        return cls(low, median, high)

    def text(self) -> str:
        """``median (low to high)``."""
        return f"{self.median:.3f} ({self.low:.3f} to {self.high:.3f})"


class Times(NamedTuple):
    """Seconds of some work by the clock, and those of them in which a processor did it."""

    clock: float
    processor: float


def seconds(call: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """How long one call takes."""
    start = clock()
    call()
    return clock() - start


def median_seconds(
    call: Callable[[], object], count: int = 1000, clock: Callable[[], float] = time.perf_counter
) -> float:
    """The median time of many calls."""
    return statistics.median(seconds(call, clock) for _ in range(count))


def turns(count: int, one: Callable[[], Times], other: Callable[[], Times]) -> list[tuple[Times, Times]]:
    """Times of both by turns; each begins every second one, so that no drift of the machine favours either."""
    times = []
    for turn in range(count):
        if turn % 2:
            second = other()
            times.append((one(), second))
        else:
            times.append((one(), other()))
    return times


def fresh(code: str) -> Any:
    """What some code prints, as JSON, in a process of its own.

    Raises:
        CalledProcessError: if the code raises.
    """
    out = subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.PIPE, cwd=ROOT).stdout
    return json.loads(out)


def row(name: str, value: str, aim: str = "", *, good: bool = True) -> None:
    """Print one line of the results."""
    mark = f"; aim {aim}{'' if good else ': MISSED'}" if aim else ""
    print(f"  {name:<42} {value}{mark}", flush=True)
