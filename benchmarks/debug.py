"""What the debug overlay costs, without the drawing of its lines."""

from __future__ import annotations

from functools import partial

from benchmarks.scenes import boxes, chains, spheres
from benchmarks.timing import median_seconds, row
from osgode.engine import DebugOverlay

AIM = 5e-3
"""Seconds, for 1000 bodies."""


def run() -> None:
    """Print the time for the lines of a picture, and for finding them anew when the tree has changed."""
    print("Debug overlay: shapes, joints, contacts (median)")
    for scene in (boxes(), spheres(), chains()):
        world = scene.world()
        world.step(scene.settle)
        overlay = DebugOverlay(world)
        count = sum(map(len, overlay.lines(0.5)))
        time = median_seconds(partial(overlay.lines, 0.5), 200)
        anew = median_seconds(partial(overlay._rebuild, world), 20)
        text = f"{time * 1e3:.2f} ms, {count} lines; {anew * 1e3:.0f} ms after a change of the tree"
        row(scene.name, text, f"{AIM * 1e3:g} ms", good=time < AIM)
