"""Reading joints: all in one call against one by one, and what feedback costs in a step."""

from __future__ import annotations

import osgode as oo
from benchmarks.speed import one_core, osgode_steps
from benchmarks.timing import Spread, median_seconds, row

COUNT = 1000


def hinges(*, feedback: bool) -> oo.World:
    """Chains of ten bars on hinges, swinging."""
    world = oo.World()
    for chain in range(COUNT // 10):
        last: oo.Body | None = None
        for link in range(10):
            bar = world.attach(
                oo.Body(position=(link + 0.5, 0.0, chain), fixed_mass=oo.Mass.box((1, 0.1, 0.1), mass=1))
            )
            oo.Hinge(bar, last, anchor=(link, 0.0, chain), axis=(0, 0, 1), feedback=feedback)
            last = bar
    return world


def run(turn_count: int) -> None:
    """Print both."""
    plain, watched = hinges(feedback=False), hinges(feedback=True)
    for world in (plain, watched):
        world.step(20)
    joints = watched.joints
    print(f"Joints: {COUNT} hinges in chains of ten")
    with one_core():
        together = median_seconds(lambda: watched.joint_states, 200)
        one_by_one = median_seconds(lambda: [(joint.angle, joint.reaction) for joint in joints], 20)  # type: ignore[attr-defined]
        ratio = Spread.of(
            [osgode_steps(watched, 5).clock / osgode_steps(plain, 5).clock for _ in range(max(turn_count, 4))]
        )
    row("angles and forces in one call", f"{together * 1e6:.0f} us, {together / one_by_one:.3f} of one by one")
    row("steps with feedback / steps without", ratio.text())
