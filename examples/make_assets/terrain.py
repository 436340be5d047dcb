"""A hundred metres of meadow: level in the middle, a bowl, hills, and higher ground all around."""

from __future__ import annotations

import numpy as np

from osgode.examples.make_assets.modelling import Face, Material, Model
from osgode.examples.make_assets.textures import Field, fractal, smoothstep

MATERIALS = {"grass": Material(texture="grass", tile=3.0)}
SIDE, QUADS = 100.0, 71
BOWL: tuple[float, float, float, float] = (24.0, 20.0, 11.0, 4.0)
"""Where things roll together: x and z of its middle, radius, depth."""
FLAT = 12.0
"""The radius about the origin in which the ground is level at height 0."""


def heights() -> tuple[Field, Field, Field]:
    """The grid of the hills: x, z and height, each (QUADS + 1, QUADS + 1), z by row."""
    count = QUADS + 1
    line = np.linspace(-SIDE / 2, SIDE / 2, count)
    x, z = np.meshgrid(line, line)
    hills = 4.5 * fractal((count, count), (4, 4), 201, 3) + 1.6
    from_middle = np.hypot(x, z)
    bowl_x, bowl_z, radius, depth = BOWL
    from_bowl = np.hypot(x - bowl_x, z - bowl_z)
    hills = hills * smoothstep(FLAT, FLAT + 14, from_middle) * smoothstep(radius, radius + 9, from_bowl)
    hills += (
        6 * smoothstep(34, 50, np.maximum(np.abs(x), np.abs(z))) * (1 + 0.5 * fractal((count, count), (6, 6), 211, 2))
    )
    return x, z, hills - depth * (1 - smoothstep(0.15 * radius, radius, from_bowl))


def terrain() -> Model:
    """The hills as one open surface; the texture repeats every few metres."""
    model = Model(MATERIALS)
    x, z, y = heights()
    tile = MATERIALS["grass"].tile
    faces = model.faces.setdefault("grass", [])
    for i in range(QUADS):
        for j in range(QUADS):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            points = [(float(x[c]), float(y[c]), float(z[c])) for c in corners]
            uvs = [((p[0] + SIDE / 2) / tile, (SIDE / 2 - p[2]) / tile) for p in points]
            # The diagonal alternates, so that slopes show no grain.
            order = (0, 1, 2, 3) if (i + j) % 2 else (1, 2, 3, 0)
            faces.append(Face([points[k] for k in order], [uvs[k] for k in order]))
    return model
