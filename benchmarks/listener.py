"""What one listener costs: the same pile in two Worlds, one with a listener on the body that touches most others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import osgode as oo
from benchmarks.scenes import boxes
from benchmarks.speed import one_core, osgode_steps
from benchmarks.timing import Spread, median_seconds, row
from osgode.nodes.touch import tell_touches

AIM = 0.02
"""Of the time of a step."""
EVERYBODY = 2.0
"""Times a step without, for a listener on each of 1000 bodies."""


def busiest(world: oo.World) -> int:
    """The number of the body that touches most geoms."""
    contacts = world.contacts
    pairs = np.unique(np.stack([contacts["slot1"], contacts["slot2"]], axis=1), axis=0)
    numbers = {body: number for number, body in enumerate(world.bodies)}
    for slot in np.argsort(-np.bincount(pairs.ravel())):
        geom = world.geom_of_slot(int(slot))
        if isinstance(geom, oo.Geom) and geom.body is not None:
            return numbers[geom.body]
    raise LookupError("nothing touches")


def heard_and_quiet(worlds: Sequence[oo.World], number: int, steps: int) -> float:
    """Time of steps with a listener on the body of that number, divided by that of steps without.

    The listener goes from the first World to the second, so that neither counts where its memory happens to be.
    """
    times = {True: 0.0, False: 0.0}
    for listening in worlds:
        body = listening.bodies[number]
        body.on_touch(_nothing)
        for world in worlds:
            times[world is listening] += osgode_steps(world, steps).clock
        body.remove_on_touch(_nothing)
    return times[True] / times[False]


def _nothing(touch: object) -> None:
    """Listen, and leave it at that."""


def run(turn_count: int) -> None:
    """Print the cost as part of a step, and what Python itself does after a step."""
    scene = boxes()
    worlds = scene.world(), scene.world()
    for world in worlds:
        world.step(scene.settle)
    world = worlds[0]
    number = busiest(world)
    print(f"One touch listener among {scene.name}: median and quartiles of {turn_count} turns")
    with one_core():
        ratio = Spread.of([heard_and_quiet(worlds, number, scene.turn) for _ in range(turn_count)])
        row("steps with it / steps without", ratio.text())
        if not np.array_equal(worlds[0].poses, worlds[1].poses):
            raise AssertionError("a listener that does nothing changed what happens")

        step = median_seconds(world.step, 20)
        touches: list[oo.Touch] = []
        realm, ears = world._realm, world._touch_ears
        assert realm is not None
        world.bodies[busiest(world)].on_touch(touches.append)
        world.step()
        count = len(touches)
        telling = median_seconds(lambda: tell_touches(realm, ears))
    text = f"{telling * 1e6:.0f} us for {count} touches, {telling / step:.2%} of a step"
    row("telling it", text, f"{AIM:.0%}", good=telling / step < AIM)
    everybody(worlds, turn_count)


def everybody(worlds: Sequence[oo.World], turn_count: int) -> None:
    """Print what a listener on every body costs, of touches and of collisions to come."""
    for name in ("on_touch", "on_collide"):
        ratios = []
        with one_core():
            for _ in range(max(2, turn_count // 6)):
                times = {True: 0.0, False: 0.0}
                for listening in worlds:
                    for body in listening.bodies:
                        getattr(body, name)(_nothing)
                    for world in worlds:
                        world.step(2)
                        times[world is listening] += osgode_steps(world, 20).processor
                    for body in listening.bodies:
                        getattr(body, f"remove_{name}")(_nothing)
                ratios.append(times[True] / times[False])
        ratio = Spread.of(ratios)
        row(f"{name} of every body / without", ratio.text(), f"{EVERYBODY:.0f}", good=ratio.median <= EVERYBODY)
