"""Preparing and submitting a frame, with the drawing itself left out; and how many whole frames a second there are."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from unittest.mock import patch

import moderngl

import osgode as oo
from benchmarks.scenes import Scene, boxes, on_mesh
from benchmarks.timing import median_seconds, row, seconds
from osgode.render import OffscreenDrawer, Quality

AIM = 0.2e-3
"""Seconds, for 300 bodies."""
SIZE = (1280, 720)
VIEW = oo.View(oo.look_at((0, 60, 160), (0, 5, 0)), far=3000)
"""From so far away that everything is in the picture."""

WHOLE_AIMS = {1000: 2e-3, 5000: 5e-3}
"""Seconds of Python in a frame, by the number of bodies."""
PLAYED = (1024, 640)
PLAYED_AIM = 10.0
"""Frames a second on a software rasteriser."""
LOOKS = [
    oo.Appearance(colour, shininess=shine)
    for colour, shine in (
        ((0.75, 0.25, 0.2), 0.2),
        ((0.25, 0.5, 0.75), 0.6),
        ((0.8, 0.7, 0.4), 0.1),
        ((0.6, 0.6, 0.65), 0.9),
    )
]


def frame(scene: Scene, aim: float | None = None) -> None:
    """Time the culling of a scene, halfway between two steps, as a game shows them."""
    world = scene.world()
    world.step(30)
    visitor = oo.CullVisitor(world)
    shown = visitor.cull(VIEW, SIZE, 0.5)
    drawn = sum(len(each.matrices) for each in shown.opaque)
    if drawn < len(scene.bodies):
        raise AssertionError(f"only {drawn} of {len(scene.bodies)} bodies are in the picture")
    for interpolation, what in ((0.5, "between two steps"), (1.0, "at a step")):
        took = median_seconds(partial(visitor.cull, VIEW, SIZE, interpolation))
        text = f"{took * 1e3:.3f} ms, {len(shown.opaque)} draws"
        row(f"{scene.name}, {what}", text, f"{aim * 1e3:g} ms" if aim else "", good=not aim or took < aim)


def field(count: int, pitch: float = 1.5) -> oo.World:
    """``count`` bodies in rows on the ground: boxes, balls, cylinders and capsules, each in four looks."""
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane(appearance=oo.Appearance((0.4, 0.5, 0.35))))
    columns = math.isqrt(count)
    for k in range(count):
        line, column = divmod(k, columns)
        x, z = pitch * (column - columns / 2), -pitch * line
        body = space.attach(oo.Body(position=(x, 0.4, z)))
        look = LOOKS[k // 4 % len(LOOKS)]
        shape = (
            oo.Box((0.8, 0.8, 0.8), mass=1, appearance=look),
            oo.Sphere(0.4, mass=1, appearance=look),
            oo.Cylinder(0.4, 0.8, mass=1, appearance=look),
            oo.Capsule(0.3, 0.4, mass=1, appearance=look),
        )[k % 4]
        body.attach(oo.Placeable()).attach(shape)
    return world


@contextmanager
def nothing_rasterised() -> Iterator[None]:
    """Every draw call is made, checked by moderngl and handed to the driver, but asks for no instance of anything."""
    render = moderngl.VertexArray.render

    def of_none(
        array: moderngl.VertexArray, mode: int | None = None, vertices: int = -1, first: int = 0, instances: int = -1
    ) -> None:
        render(array, mode, vertices, first, 0)

    with patch.object(moderngl.VertexArray, "render", of_none):
        yield


def whole(count: int) -> None:
    """Time everything that Python does for a frame: update, cull, and what the drawer does up to the driver.

    By the time of the processor, since other programs have none of this thread's.
    """
    world = field(count)
    world.on_update(lambda node: None)
    world.step()
    view = oo.View(oo.look_at((0, 0.5 * count**0.5, 1.5 * count**0.5), (0, 0, -0.7 * count**0.5)))
    update, cull = oo.UpdateVisitor(world), oo.CullVisitor(world)
    # A picture of 16 x 9 pixels without smoothing, and one texel of shadow: clearing them costs nothing.
    with OffscreenDrawer((16, 9), Quality(samples=0, shadow_size=1)) as drawer:

        def prepare() -> oo.Frame:
            update.update()
            return cull.cull(view, (16, 9), 0.5)

        shown = prepare()
        drawn = sum(len(each.matrices) for each in shown.opaque)
        if drawn < count:
            raise AssertionError(f"only {drawn} of {count} bodies are in the picture")
        drawer.draw(shown)
        with nothing_rasterised():
            parts = [median_seconds(call, 300, time.thread_time) for call in (prepare, partial(drawer.draw, shown))]
            took = median_seconds(lambda: drawer.draw(prepare()), 300, time.thread_time)
            counts = drawer.counts
    text = f"{took * 1e3:.2f} ms ({parts[0] * 1e3:.2f} update and cull, {parts[1] * 1e3:.2f} submit)"
    aim = WHOLE_AIMS[count]
    row(f"{count} bodies, {counts.draws} draws", text, f"{aim * 1e3:g} ms", good=took < aim)


def changing(count: int) -> None:
    """Time the culling of a frame in which one more body is there than in the one before."""
    world = field(count)
    world.step()
    view = oo.View(oo.look_at((0, 0.5 * count**0.5, 1.5 * count**0.5), (0, 0, -0.7 * count**0.5)))
    cull = oo.CullVisitor(world)
    first = seconds(partial(cull.cull, view, SIZE), time.thread_time)
    space = world.children[0]

    def one_more() -> float:
        body = oo.Body(position=(0, 5, 0))
        body.attach(oo.Placeable()).attach(oo.Sphere(0.4, mass=1, appearance=LOOKS[0]))
        space.attach(body)
        return seconds(partial(cull.cull, view, SIZE), time.thread_time)

    again = statistics.median(one_more() for _ in range(50))
    row(f"{count} bodies and one more each time", f"{again * 1e3:.1f} ms (the first picture: {first * 1e3:.0f} ms)")


def played(count: int = 300) -> None:
    """Frames a second of a scene with shadows, from the step to the pixels in memory."""
    world = field(count)
    view = oo.View(oo.look_at((0, 6, 10), (0, 0, -8)))
    cull = oo.CullVisitor(world)
    for quality, what in ((None, "default"), (Quality(), "full")):
        with OffscreenDrawer(PLAYED, quality) as drawer:

            def one() -> None:
                world.step(2)
                drawer.draw(cull.cull(view, PLAYED, 0.5))
                drawer.image()

            one()
            start = time.process_time()
            rate = 1.0 / median_seconds(one, 30)
            processor = (time.process_time() - start) / 30
            who = drawer.renderer
        name = f"{count} bodies, {PLAYED[0]}x{PLAYED[1]}, {what} quality"
        row(
            name,
            f"{rate:.1f} frames/s, {processor * 1e3:.0f} ms of processor each ({who})",
            f"{PLAYED_AIM:g}",
            good=rate >= PLAYED_AIM,
        )


def run() -> None:
    """Print the time of a frame for scenes of several sizes."""
    print("Frame: poses, matrices and culling (median)")
    frame(boxes(300), AIM)
    frame(on_mesh())
    frame(boxes(1000))
    print("Frame: update, cull and submit, without the rasteriser (median of processor time)")
    for count in WHOLE_AIMS:
        whole(count)
        changing(count)
    print("Frame: step, cull, draw with shadows and read back (median)")
    played()
