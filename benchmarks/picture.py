"""Preparing a frame: moving and culling what is seen, without drawing it."""

from __future__ import annotations

from functools import partial

import osgode as oo
from benchmarks.scenes import Scene, boxes, on_mesh
from benchmarks.timing import median_seconds, row

AIM = 0.2e-3
"""Seconds, for 300 bodies."""
SIZE = (1280, 720)
VIEW = oo.View(oo.look_at((0, 60, 160), (0, 5, 0)), far=3000)
"""From so far away that everything is in the picture."""


def frame(scene: Scene, aim: float | None = None) -> None:
    """Time the frames of a scene, halfway between two steps, as a game shows them."""
    world = scene.world()
    world.step(30)
    visitor = oo.CullVisitor(world)
    shown = visitor.cull(VIEW, SIZE, 0.5)
    drawn = sum(len(each.matrices) for each in shown.opaque)
    if drawn < len(scene.bodies):
        raise AssertionError(f"only {drawn} of {len(scene.bodies)} bodies are in the picture")
    for interpolation, what in ((0.5, "between two steps"), (1.0, "at a step")):
        time = median_seconds(partial(visitor.cull, VIEW, SIZE, interpolation))
        text = f"{time * 1e3:.3f} ms, {len(shown.opaque)} draws"
        row(f"{scene.name}, {what}", text, f"{aim * 1e3:g} ms" if aim else "", good=not aim or time < aim)


def run() -> None:
    """Print the time of a frame for scenes of several sizes."""
    print("Frame: poses, matrices and culling (median)")
    frame(boxes(300), AIM)
    frame(on_mesh())
    frame(boxes(1000))
