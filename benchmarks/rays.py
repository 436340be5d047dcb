"""Many rays in one call, against a loop in plain C: a terrain of 10 082 triangles and 1000 bodies."""

from __future__ import annotations

import subprocess
import time

import numpy as np

import osgode as oo
from benchmarks.raw import compiled
from benchmarks.speed import one_core
from benchmarks.timing import ROOT, Spread, row
from osgode.maths import FloatArray

AIM = 1.1
SIDE = 72
BODIES = 1000


def terrain() -> tuple[FloatArray, FloatArray]:
    """Vertices and triangles of waves 60 m across."""
    x, z = np.meshgrid(np.linspace(-30, 30, SIDE), np.linspace(-30, 30, SIDE), indexing="ij")
    vertices = np.stack([x, np.sin(x / 3) * np.cos(z / 4), z], axis=2).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(SIDE - 1), np.arange(SIDE - 1), indexing="ij")
    a, b, c, d = (((i + p) * SIDE + j + q).ravel() for p, q in ((0, 0), (0, 1), (1, 1), (1, 0)))
    return vertices, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def rays(count: int, rng: np.random.Generator) -> FloatArray:
    """Rows of origin, unit direction, length: from above the middle, downwards and to all sides."""
    ways = rng.normal(size=(count, 3)) * (1, 0.4, 1) - (0, 0.3, 0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    starts = rng.uniform((-25, 2, -25), (25, 8, 25), (count, 3))
    return np.hstack([starts, ways, np.full((count, 1), 40.0)])


def run(turn_count: int, count: int = 100_000) -> None:
    """Print the ratio of both, and check that they meet the same."""
    rng = np.random.default_rng(1)
    vertices, triangles = terrain()
    places = rng.uniform((-28, 1.5, -28), (28, 6, 28), (BODIES, 3))
    table = rays(count, rng)
    world = oo.World()
    still, moving = world.attach(oo.SimpleSpace()), world.attach(oo.HashSpace())
    world.collide(moving, still)
    still.attach(oo.Placeable()).attach(oo.Trimesh((vertices, triangles)))
    for i, place in enumerate(places.tolist()):
        body = moving.attach(oo.Body(position=tuple(place)))
        body.attach(oo.Placeable()).attach(oo.Box((0.6, 0.6, 0.6)) if i % 2 else oo.Sphere(0.35))
    parts = [vertices, triangles, places, table]
    sizes = [f"{len(vertices)} {triangles.size}", "", str(len(places)), str(len(table))]
    text = "\n".join(
        f"{size} " + " ".join(map(repr, part.ravel().tolist())) for size, part in zip(sizes, parts, strict=True)
    )
    print(f"{count} rays, {len(triangles)} triangles, {BODIES} bodies: median and quartiles of {turn_count} turns")
    program = compiled(ROOT / "benchmarks" / "c" / "rays.c")
    with subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as raw, one_core():
        assert raw.stdin is not None
        assert raw.stdout is not None
        raw.stdin.write(text + "\n")
        raw.stdin.flush()
        assert raw.stdout.readline() == "ready\n"
        ratios, ours = [], 0.0
        for _ in range(turn_count):
            raw.stdin.write("cast\n")
            raw.stdin.flush()
            nanoseconds, total = raw.stdout.readline().split()
            start = time.process_time()
            hits = world.cast_rays(table[:, :3], table[:, 3:6], table[:, 6])
            ours = time.process_time() - start
            ratios.append(ours / (int(nanoseconds) / 1e9))
            if abs(float(hits.distance[hits.hit].sum()) - float(total)) > 1e-6 * float(total):
                raise AssertionError("osgode and C meet different things")
        raw.stdin.close()
    ratio = Spread.of(ratios)
    row("cast_rays / C", ratio.text(), f"{AIM}", good=ratio.median <= AIM)
    row("a ray", f"{ours / count * 1e6:.2f} us; {hits.hit.mean():.0%} hit")
