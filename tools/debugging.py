"""Draws the pictures of docs/debugging.md: ``python tools/debugging.py``; needs ``osgode[convex,render]``."""

import random
import time
from pathlib import Path

import numpy as np
from gallery import palette
from PIL import Image

import osgode as oo
from osgode.engine import DebugOverlay, FrameTimings, inspect
from osgode.render import OffscreenDrawer, Quality, measure_text

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
SIZE = (960, 540)
VIEW = oo.View(oo.look_at((4.3, 3.4, 7.6), (0.1, 0.95, -0.4)), field_of_view=0.68)
PAPER = (0.03, 0.04, 0.06, 0.72)


def scene() -> oo.World:
    """A little of everything that the overlay knows."""
    world = oo.World(iterations=40)
    moving, fixed = world.attach(oo.HashSpace(name="moving")), world.attach(oo.SimpleSpace(name="fixed"))
    world.collide(moving)
    world.collide(moving, fixed)
    fixed.attach(oo.Plane(material="concrete", name="ground"))
    x, z = np.meshgrid(np.linspace(-2, 2, 15), np.linspace(-2, 2, 15))
    hill = oo.Heightfield(1.1 * np.exp(-(x**2) - z**2) - 0.05, (5, 5), material="earth", name="hill")
    fixed.attach(oo.Placeable(position=(-3.6, 0, -2.6))).attach(hill)
    fixed.attach(oo.Placeable(position=(3.0, 1.6, -3.0))).attach(oo.Box((0.3, 3.2, 0.3), material="brick", name="mast"))

    def add(geom: oo.Geom, position: oo.Vec3Like, name: str, **fields: object) -> oo.Body:
        body = moving.attach(oo.Body(name=name, position=position, **fields))
        body.attach(oo.Placeable()).attach(geom)
        return body

    for row in range(3):
        for k in range(3 - row):
            at = (1.3 + 0.72 * (k - (2 - row) / 2), 0.35 + 0.7 * row, 0.6)
            add(oo.Box((0.7, 0.7, 0.7), material="wood", density=90), at, "crate").enabled = False
    add(oo.Capsule(0.2, 0.8, material="steel", mass=5), (-3.6, 2.0, -2.5), "pill")
    add(oo.Sphere(0.35, material="rubber", mass=3), (-3.0, 1.8, -2.9), "ball")
    add(oo.Cylinder(0.3, 0.7, material="aluminium", mass=3), (3.0, 2.2, 1.4), "tin")
    knobs = [(a, b, c) for a in (-0.35, 0.35) for b in (-0.3, 0.3) for c in (-0.35, 0.35)] + [(0, 0.75, 0)]
    add(oo.ConvexHull(knobs, material="concrete", density=500), (2.5, 0.9, 2.6), "stone")
    lift = add(oo.Box((1.3, 0.12, 1.3), material="steel"), (-2.8, 0.5, 1.0), "lift", kinematic=True)
    lift.linear_velocity = (0, 0.15, 0)
    add(oo.Sphere(0.25, material="rubber", mass=1), (-2.7, 0.83, 0.9), "rider")
    doll = oo.ragdoll(moving, position=(-0.3, 0.02, 2.0), height=1.7)
    doll.body("torso").linear_velocity = (0.4, 0, 0.3)
    boom = moving.attach(oo.Body(name="boom", position=(2.2, 3.0, -3.0)))
    boom.attach(oo.Placeable()).attach(oo.Box((1.9, 0.12, 0.12), mass=4, material="wood"))
    oo.Hinge(boom, anchor=(3.0, 3.0, -3.0), axis=(0, 1, 0), name="boom")
    oo.chain(moving, (1.4, 2.94, -3.0), (1.4, 1.4, -3.0), links=6, body1=boom, radius=0.05, mass=1.0)
    gate = fixed.attach(oo.Placeable(position=(1.3, 0.9, -1.2)))
    gate.attach(oo.Box((1.6, 1.8, 0.5), sensor=True, visible=False, name="gate"))
    down = oo.Quat.between((0, 0, -1), (-0.25, -1, 0))
    fixed.attach(oo.Placeable(position=(2.1, 3.2, 0.6), rotation=down)).attach(oo.Ray(4.0, visible=False))
    add(oo.Sphere(0.3, material="rubber", mass=2), (0.9, 1.2, -1.2), "visitor").linear_velocity = (0, 1.0, 0)
    off = fixed.attach(oo.Placeable(position=(4.2, 0.4, -0.6)))
    off.attach(oo.Box((0.8, 0.8, 0.8), enabled=False, material="glass"))
    return world


def save(image: np.ndarray, name: str) -> None:
    """As a picture of 256 colours, which takes a third of the room."""
    full = Image.fromarray(image)
    # The colours of the legend take little room, and must stay apart.
    weighed = Image.fromarray(np.concatenate([image, *[image[-160:, -432:].repeat(3, axis=1)[:, : SIZE[0]]] * 4]))
    full.quantize(palette=palette(weighed), dither=Image.Dither.FLOYDSTEINBERG).save(
        PICTURES / f"{name}.png", optimize=True
    )


def main() -> None:
    """Both pictures."""
    root = oo.Group()
    world = root.attach(scene())
    overlay = root.attach(DebugOverlay(world))
    cull, drawer, timings = oo.CullVisitor(root), OffscreenDrawer(SIZE, Quality()), FrameTimings()
    chance = random.Random(4)  # noqa: S311 - the same bars every time
    for _ in range(100):  # by the processor's time: on a busy machine the clock would draw other bars
        start = time.thread_time()
        world.step()
        middle = time.thread_time()
        frame = cull.cull(VIEW, SIZE, 0.5)
        culled = time.thread_time() - middle
        draw = chance.uniform(0.003, 0.005)  # a picture a frame would take half a minute on a processor
        timings.add({"steps": middle - start, "cull": culled, "draw": draw, "events": 1e-4}, world.timings)
    drawer.draw(frame)
    save(drawer.image(), "debugging")

    overlay.visible = False
    doll = next(body for body in world.bodies if body.name == "torso")
    eye = VIEW.pose.position
    hit = world.cast_ray(eye, doll.world_centre_of_mass - eye, 50.0)
    text = inspect(world if hit is None else hit, width=64)
    frame = cull.cull(VIEW, SIZE, 0.5)
    width, height = measure_text(text, 14)
    words = [oo.Rectangle(12, 12, width + 16, height + 16, PAPER), oo.Text(20, 20, text, 14)]
    frame.overlay[:] = [*words, *timings.overlay(528, 378)]
    drawer.draw(frame)
    save(drawer.image(), "inspector")
    print(text)


if __name__ == "__main__":
    main()
