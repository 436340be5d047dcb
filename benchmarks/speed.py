"""Steps of osgode against the same steps in plain C, by turns, and the states that both arrive at."""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

import osgode as oo
from benchmarks.raw import Raw
from benchmarks.scenes import SCENES, Scene
from benchmarks.timing import Spread, Times, fresh, row, turns

AIM = 1.05
"""Times what the C program takes, with its way of finding pairs: each of them, in the same order."""
OWN_AIMS = {"spheres": 0.85, "sleeping": 0.10}
"""The same of osgode's own way, where it is not 1."""
PLACEMENTS = 6
"""Processes for one scene, each with its heap filled to another degree before the scene is built."""


class DifferentBitsError(Exception):
    """The same scene went different ways in osgode and in C."""


@contextmanager
def one_core() -> Iterator[None]:
    """Keep this process, and those that it starts, on one core: what else runs there then slows both sides alike."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


def osgode_steps(world: oo.World, count: int) -> Times:
    """Do some steps, fetching the table of poses after each; the time that they took."""
    start, used = time.perf_counter(), time.thread_time()
    for _ in range(count):
        world.step()
        _ = world.poses
    used = time.thread_time() - used
    return Times(time.perf_counter() - start, used)


def check_finite(scene: Scene, world: oo.World) -> None:
    """Make sure that nothing went astray.

    Raises:
        DifferentBitsError: if something did.
    """
    if not np.isfinite(np.hstack([world.poses, world.velocities])).all():
        raise DifferentBitsError(f"{scene.name}: after {world.steps} steps not all numbers are finite")


def compare(scene: Scene, world: oo.World, raw: Raw) -> None:
    """Make sure that both sides have the same bits.

    Raises:
        DifferentBitsError: if they have not, or are not finite.
    """
    check_finite(scene, world)
    ours, theirs = np.hstack([world.poses, world.velocities]), raw.state()
    different = (ours.view(np.uint64) != theirs.view(np.uint64)).any(axis=1)
    if different.any():
        first = int(different.argmax())
        raise DifferentBitsError(
            f"{scene.name}: after {world.steps} steps {different.sum()} of {len(ours)} bodies differ, "
            f"by up to {np.abs(ours - theirs).max():g}; body {first} is\n{ours[first]} in osgode,\n{theirs[first]} in C"
        )


def measure(name: str, broad_phase: str, turn_count: int, placement: int) -> None:
    """Time both sides in turns, compare where they arrive, and print the times of a turn as JSON.

    With osgode's own broad phase contacts come in another order, and so the bits can't be those of C.
    """
    check = compare if broad_phase == "ode" else lambda scene, world, _: check_finite(scene, world)
    filling = [bytearray(700) for _ in range(37 * placement)]  # above what Python takes from pools of its own
    scene = SCENES[name]()
    world = scene.world(broad_phase)
    with one_core(), Raw(scene) as raw:
        world.step(scene.settle)
        raw.step(scene.settle)
        check(scene, world, raw)
        times = turns(turn_count, lambda: osgode_steps(world, scene.turn), lambda: raw.step(scene.turn))
        check(scene, world, raw)
    del filling
    print(json.dumps(times))


def run(turn_count: int, names: list[str]) -> None:
    """All scenes, or those named, each in several processes: where memory happens to lie makes some percent."""
    each = math.ceil(turn_count / PLACEMENTS)
    print(f"Step: time of osgode / time of C, median and quartiles of {PLACEMENTS} times {each} turns; the same of the")
    print("processor's time, which leaves out when other programs had it")
    print("ode: pairs found by ODE's spaces; the same bits as C. own: by osgode's own broad phase, the default")
    for name in names or SCENES:
        for broad_phase in ("ode", "own"):
            compare_times(name, broad_phase, each)


def compare_times(name: str, broad_phase: str, turn_count: int) -> None:
    """Print the line of one scene and one way of finding pairs."""
    calls = [f"speed.measure({name!r}, {broad_phase!r}, {turn_count}, {placement})" for placement in range(PLACEMENTS)]
    results = [fresh(f"from benchmarks import speed; {call}") for call in calls]
    pairs = [(Times(*ours), Times(*theirs)) for result in results for ours, theirs in result]
    scene = SCENES[name]()
    ratio = Spread.of([ours.clock / theirs.clock for ours, theirs in pairs])
    used = Spread.of([ours.processor / theirs.processor for ours, theirs in pairs])
    in_c = Spread.of([theirs.clock / scene.turn for _, theirs in pairs]).median
    text = f"{broad_phase} {ratio.text()}; processor {used.text()}; {in_c * 1e3:.2f} ms a step in C"
    aim = AIM if broad_phase == "ode" else OWN_AIMS.get(name, 1.0)
    row(scene.name, text, f"{aim:.2f}", good=ratio.median <= aim)
