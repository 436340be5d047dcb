"""How many shots pass through a wall: ``python tools/tunnelling.py [shots]`` prints the table of docs/tunnelling.md.

Each body flies at a wall with the speed that the cell asks for, counted in safe speeds: its thinnest side per step. It
has passed through if its centre of mass went from before the wall's middle to behind it at a place where there is wall,
and stayed there. A wall is so large that nothing slides round it meanwhile.
"""

from __future__ import annotations

import logging
import math
import sys
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

import osgode as oo

MODES = (None, "ray", "sweep")
SPEEDS = (1, 2, 5, 10, 50)
HALF = 40.0
"""Half of the side of a wall, metres."""
STEP = 1 / 120
AFTER = 25
"""Steps that are watched."""
BATCH = 10
"""Shots in one World, which meet the wall but not each other."""


class Shape(NamedTuple):
    """What is shot: how it is made, its thinnest side and the radius of a ball around it, metres."""

    make: Callable[[], oo.Geom]
    thin: float
    reach: float


SHAPES = {
    "sphere": Shape(lambda: oo.Sphere(0.1), 0.2, 0.1),
    "box": Shape(lambda: oo.Box((0.2, 0.3, 0.1)), 0.1, math.hypot(0.1, 0.15, 0.05)),
    "capsule": Shape(lambda: oo.Capsule(0.05, 0.3), 0.1, 0.2),
}


class Wall(NamedTuple):
    """What is shot at: how thick it is, metres, and how."""

    thick: float
    how: str


WALLS = {
    "1 cm, head on": Wall(0.01, "head on"),
    "10 cm, head on": Wall(0.1, "head on"),
    "1 m, head on": Wall(1.0, "head on"),
    "1 cm, oblique": Wall(0.01, "oblique"),
    "10 cm, oblique": Wall(0.1, "oblique"),
    "1 m, oblique": Wall(1.0, "oblique"),
    "1 cm, moving": Wall(0.01, "moving"),
    "mesh": Wall(0.0, "mesh"),
}


def sheet(half: float, cells: int = 8) -> oo.MeshData:
    """A flat square of triangles that look along +Z."""
    at = np.linspace(-half, half, cells + 1)
    x, y = np.meshgrid(at, at)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    right, up = first + 1, first + cells + 1
    faces = np.concatenate([np.stack([first, right, up + 1], axis=1), np.stack([first, up + 1, up], axis=1)])
    return oo.MeshData(vertices, faces)


SHEET = sheet(HALF)


def gravity_free() -> tuple[oo.World, oo.HashSpace, oo.SimpleSpace]:
    """A World without gravity, a space for what moves, and one for what stands."""
    world = oo.World(gravity=(0, 0, 0), step_size=STEP)
    moving, fixed = world.attach(oo.HashSpace()), world.attach(oo.SimpleSpace())
    world.collide(moving, fixed)
    return world, moving, fixed


def build_wall(
    wall: Wall, world: oo.World, moving: oo.HashSpace, fixed: oo.SimpleSpace, speed: float
) -> oo.Body | None:
    """A wall across the z axis; the body of one that moves."""
    if wall.how == "mesh":
        fixed.attach(oo.Placeable()).attach(oo.Trimesh(SHEET))
        return None
    box = oo.Box((2 * HALF, 2 * HALF, wall.thick))
    if wall.how != "moving":
        fixed.attach(oo.Placeable()).attach(box)
        return None
    space = world.attach(oo.SimpleSpace())
    world.collide(moving, space)
    start = -2.5 * STEP * speed  # about when it is reached it is in the middle
    body = space.attach(oo.Body(kinematic=True, position=(0, 0, start), linear_velocity=(0, 0, speed)))
    body.attach(oo.Placeable()).attach(box)
    return body


def direction(how: str, random: np.random.Generator) -> oo.Vec3:
    """Straight at the wall, or from 30 to 75 degrees away from that."""
    turn = random.uniform(0, 2 * math.pi)
    tilt = 0.0 if how in ("head on", "moving") else math.radians(random.uniform(30, 75))
    return oo.Vec3(math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), -math.cos(tilt))


def shoot(moving: oo.HashSpace, shape: Shape, mode: str | None, random: np.random.Generator) -> oo.Body:
    """A body that is turned anyhow."""
    turn = oo.Quat(*random.normal(size=4)).normalized()
    shot = moving.attach(oo.Body(rotation=turn, tunnelling=mode))
    shot.attach(oo.Placeable()).attach(shape.make())
    return shot


def passes(mode: str | None, shape: Shape, wall: Wall, times: float, random: np.random.Generator) -> int:
    """Shoot `BATCH` times, through one another: how many pass."""
    world, moving, fixed = gravity_free()
    speed = times * shape.thin / STEP
    plate = build_wall(wall, world, moving, fixed, speed * random.uniform(-0.5, 0.5))
    shots = []
    for _ in range(BATCH):
        way = direction(wall.how, random)
        aim = oo.Vec3(float(random.uniform(-3, 3)), float(random.uniform(-3, 3)), 0)
        distance = (wall.thick / 2 + shape.reach) / -way.z + random.uniform(2, 3) * speed * STEP
        shot = shoot(moving, shape, mode, random)
        shot.position, shot.linear_velocity = aim - way * distance, way * speed
        shots.append(shot)
    row = [world.bodies.index(body) for body in shots]
    passed = np.zeros(BATCH, bool)
    for _ in range(AFTER):
        old, place = world.poses[row, :3].copy(), 0.0 if plate is None else plate.position.z
        world.step()
        new, there = world.poses[row, :3], 0.0 if plate is None else plate.position.z
        before, after = old[:, 2] - place, new[:, 2] - there
        part = before / np.where(before == after, 1, before - after)
        spot = old + (new - old) * part[:, None]
        passed |= (before > 0) & (after < 0) & (np.abs(spot[:, :2]).max(axis=1) < HALF)
        passed &= (after < 0) | (np.abs(new[:, :2]).max(axis=1) > HALF)  # the response has brought it back
    return int(np.count_nonzero(passed))


def misses(mode: str | None, shape: Shape, times: float, random: np.random.Generator) -> int:
    """Shoot `BATCH` times past the edge of a wall 1 cm thick: how many fly on as if nothing had been there.

    The centre of mass passes beside the wall, which ends at x = 0. What is nearest to the wall passes behind that edge,
    by a tenth of its thinnest side at least.
    """
    world, moving, fixed = gravity_free()
    fixed.attach(oo.Placeable(position=(-HALF, 0, 0))).attach(oo.Box((2 * HALF, 2 * HALF, 0.01)))
    speed = times * shape.thin / STEP
    shots = []
    for _ in range(BATCH):
        shot = shoot(moving, shape, mode, random)
        low = shot.geoms[0].bounds[0].x  # its side towards the wall, as it stands now with its middle over the edge
        over = float(random.uniform(0.1 * shape.thin, -0.95 * low))
        shot.position = (-low - over, 0, shape.reach + 0.005 + random.uniform(1, 2) * speed * STEP)
        shot.linear_velocity = (0, 0, -speed)
        shots.append(shot)
    world.step(AFTER)
    return sum(
        shot.linear_velocity == oo.Vec3(0, 0, -speed) and shot.angular_velocity == oo.Vec3(0, 0, 0) for shot in shots
    )


def count(mode: str | None, shape: str, wall: str, times: float, shots: int, *, seed: int = 7) -> int:
    """How many of so many shots (a multiple of `BATCH`) pass; the same shots for all modes."""
    random = np.random.default_rng([seed, list(SHAPES).index(shape), int(times)])
    if wall == "edge":
        return sum(misses(mode, SHAPES[shape], times, random) for _ in range(shots // BATCH))
    return sum(passes(mode, SHAPES[shape], WALLS[wall], times, random) for _ in range(shots // BATCH))


def main(arguments: Sequence[str]) -> None:
    """Print the table in Markdown: none / ray / sweep."""
    logging.disable(logging.WARNING)
    shots = int(arguments[0]) if arguments else 1000
    print("| shot | wall | " + " | ".join(f"{times} x" for times in SPEEDS) + " |")
    print("|---|---|" + "---|" * len(SPEEDS))
    for shape in SHAPES:
        for wall in (*WALLS, "edge"):
            cells = (" / ".join(str(count(mode, shape, wall, times, shots)) for mode in MODES) for times in SPEEDS)
            print(f"| {shape} | {wall} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
