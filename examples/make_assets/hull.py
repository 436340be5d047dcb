"""The hull of a small car without its wheels, nose to -Z, about 4.2 by 1.8 by 1.3 metres.

The origin is midway between the axles, on their level; `AXLES`, `TRACK` and `ARCH` say where wheels fit. The body is a
grid of stations, from front to back, and rows, from the middle of the belly to the middle of the
bonnet, for one side; the other side is its mirror image. The cabin stands on it as a solid of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from osgode.examples.make_assets.modelling import Material, Model, Point, mirrored, rounded

MATERIALS = {
    "paint": Material(texture="paint", tile=0.6, shine=60.0),
    "glass": Material((0.05, 0.07, 0.09), shine=400.0),
    "headlight": Material((0.96, 0.96, 0.9), shine=100.0),
    "taillight": Material((0.5, 0.02, 0.03), shine=60.0),
    "indicator": Material((0.95, 0.5, 0.1), shine=60.0),
    "plate": Material((0.93, 0.92, 0.86)),
    "trim": Material((0.07, 0.07, 0.075), shine=4.0),
    "steel": Material(texture="steel", tile=0.5, shine=60.0),
    "underside": Material((0.1, 0.1, 0.1)),
}
AXLES = (-1.3, 1.3)
"""The Z of both axles."""
TRACK = 0.76
"""Half the distance between the middles of two wheels of an axle."""
ARCH = 0.4
"""The radius of a wheel's arch; wheels of 0.33 have room to move."""
LIP = 0.055
BELLY, WELL = -0.16, 0.56
CROWN = 0.035
ROWS = ("underside", "underside", "underside", "trim", "paint", "paint", "paint", "paint", "paint")
"""The material between each row and the next."""

STATIONS = (-2.12, -1.9, -1.2, -0.7, 0.4, 1.5, 1.95, 2.1)
"""Where along the hull `OUTLINE` is given; between them it is straight."""
OUTLINE = {
    "sill": (0.74, 0.84, 0.87, 0.87, 0.87, 0.87, 0.84, 0.80),
    "waist": (0.76, 0.86, 0.90, 0.90, 0.90, 0.90, 0.87, 0.83),
    "shoulder": (0.72, 0.81, 0.86, 0.87, 0.87, 0.86, 0.84, 0.80),
    "bonnet": (0.64, 0.69, 0.74, 0.76, 0.76, 0.74, 0.72, 0.70),
    "y_waist": (0.20, 0.36, 0.47, 0.47, 0.47, 0.47, 0.42, 0.26),
    "y_shoulder": (0.40, 0.49, 0.55, 0.58, 0.60, 0.62, 0.60, 0.56),
    "y_bonnet": (0.44, 0.53, 0.60, 0.64, 0.64, 0.67, 0.68, 0.64),
}
"""Half widths and heights of the rows, one for each of `STATIONS`."""
BUMPER = {-2.12: 0.0, 2.1: 0.0}
"""The height that the black bumpers reach at the ends; elsewhere the black strip is 9 cm high."""


def _station(z: float) -> list[Point]:
    """The rows of the hull's outline at ``z``."""
    at = {name: float(np.interp(z, STATIONS, values)) for name, values in OUTLINE.items()}
    strip = BUMPER.get(z, BELLY + 0.09)
    return [
        (0.0, BELLY, z),
        (WELL, BELLY, z),
        (WELL, BELLY, z),  # the top of the wheel's well, where there is one
        (at["sill"], BELLY, z),
        (at["sill"] + 0.01, strip, z),
        (at["waist"], at["y_waist"], z),
        (at["shoulder"], at["y_shoulder"], z),
        (at["bonnet"], at["y_bonnet"], z),
        (0.62 * at["bonnet"], at["y_bonnet"] + 0.012, z),
        (0.0, at["y_bonnet"] + 0.02, z),
    ]


def _arch(axle: float) -> list[list[Point]]:
    """The stations about one wheel: the lower rows follow a circle, the upper ones spread evenly over it."""
    turns = [0.0, *np.linspace(0, math.pi, 9), math.pi]  # the first and last are still outside of the arch
    stations = []
    for k, turn in enumerate(turns):
        outside = k in (0, len(turns) - 1)
        rows = _station(axle + (ARCH + LIP + 0.08) * (2 * k / (len(turns) - 1) - 1))
        far, up = -math.cos(turn), 0.0 if outside else math.sin(turn)
        flare = 0.0 if outside else 0.03
        z, top = axle + ARCH * far, BELLY if outside else ARCH * up
        rows[:3] = (0.0, BELLY, z), (WELL, BELLY, z), (WELL, top, z)
        rows[3] = (rows[3][0] + flare, top, z)
        rows[4] = (rows[4][0] + flare, rows[4][1] if outside else (ARCH + LIP) * up, axle + (ARCH + LIP) * far)
        stations.append([rounded(p) for p in rows])
    return stations


def _leaning(z: float, *lean: float) -> list[Point]:
    """An end station whose rows, from the sill upwards, stand ``lean`` metres before or behind ``z``."""
    rows = [rounded((x, y, z + add)) for (x, y, z), add in zip(_station(z)[3:], lean, strict=True)]
    return [*((x, y, rows[0][2]) for x, y, _ in _station(z)[:3]), *rows]


def _both(model: Model, material: str, *points: Point) -> None:
    model.face(material, *points)
    model.face(material, *mirrored(points))


def _end(model: Model, station: Sequence[Point], strips: Sequence[tuple[str, str]], *, front: bool) -> None:
    """Close the nose or the tail with four strips from the bumper up, each of an inner and an outer material."""
    rows = station[3:8]
    shares = (WELL / rows[0][0], 0.62, 0.62, 0.62, station[8][0] / station[7][0])
    columns = [[(0.0, y, z), (x * share, y, z), (x, y, z)] for (x, y, z), share in zip(rows, shares, strict=True)]
    columns[-1] = [station[9], station[8], station[7]]
    for (low, high), materials in zip(pairwise(columns), strips, strict=True):
        for k, material in enumerate(materials):
            points = [low[k], low[k + 1], high[k + 1], high[k]]
            if front:
                points.reverse()
            if material.endswith("light"):
                for side in (points, mirrored(points)):
                    model.panel("trim", material, side, 0.014, 0.02)
            else:
                _both(model, material, *points)


def _body(model: Model) -> None:
    seams = (-0.5, 0.38)  # the gaps about the front doors
    doors = [_station(seam + half) for seam in seams for half in (-0.006, 0.006)]
    stations = [
        _leaning(-2.12, 0.05, 0.0, -0.03, 0.02, 0.06, 0.06, 0.06),
        _station(-1.9),
        *_arch(AXLES[0]),
        *doors,
        *_arch(AXLES[1]),
        _station(1.95),
        _leaning(2.1, -0.04, 0.0, 0.02, -0.03, -0.08, -0.08, -0.08),
    ]
    for near, far in pairwise(stations):
        at_gap = near in (doors[0], doors[2])
        for row, material in enumerate(ROWS):
            gap = at_gap and row in (4, 5)
            _both(model, "trim" if gap else material, near[row], near[row + 1], far[row + 1], far[row])
    _end(model, stations[0], [("trim",) * 2, ("paint",) * 2, ("trim", "headlight"), ("paint",) * 2], front=True)
    _end(model, stations[-1], [("trim",) * 2, ("paint",) * 2, ("paint", "taillight"), ("paint",) * 2], front=False)


def _cabin(model: Model) -> None:
    """Roof, pillars and windows; the floor is hidden in the body."""
    base, top = 0.56, 1.12
    foot = [(0.79, base, -0.86), (0.80, base, 0.40), (0.78, base, 1.30), (0.72, base, 1.98)]
    roof = [(0.58, top - 0.03, -0.10), (0.60, top, 0.46), (0.59, top - 0.01, 1.12), (0.55, top - 0.06, 1.62)]
    for k in range(3):
        points = [foot[k + 1], foot[k], roof[k], roof[k + 1]]
        for side in (points, mirrored(points)):
            model.panel("paint", "glass", side, 0.05, 0.014)
        crown = [(0.0, y + CROWN, z) for _, y, z in (roof[k], roof[k + 1])]
        _both(model, "paint", roof[k + 1], roof[k], *crown)
        model.face("underside", *mirrored([foot[k], foot[k + 1]]), foot[k], foot[k + 1])
    for low, high, way in ((foot[0], roof[0], 1), (foot[3], roof[3], -1)):
        model.panel("paint", "glass", [low, *mirrored([high, low]), high][::way], 0.06, 0.014)
        model.face("paint", *[high, *mirrored([high]), (0.0, high[1] + CROWN, high[2])][::way])


def _fittings(model: Model) -> None:
    """Mirrors, door handles, number plates, indicators, the exhaust."""
    for side in (-1, 1):

        def box(material: str, low: Point, high: Point, side: int = side) -> None:
            near, far = sorted((side * low[0], side * high[0]))
            model.box(material, (near, *low[1:]), (far, *high[1:]))

        box("trim", (0.80, 0.62, -0.62), (0.97, 0.74, -0.54))
        box("trim", (0.87, 0.50, 0.16), (0.915, 0.53, 0.31))
        box("trim", (0.87, 0.51, 0.56), (0.915, 0.54, 0.71))
        box("indicator", (0.44, 0.04, -2.17), (0.62, 0.1, -2.1))
    model.box("plate", (-0.26, 0.02, -2.165), (0.26, 0.13, -2.1))
    model.box("plate", (-0.26, 0.30, 2.05), (0.26, 0.42, 2.125))
    model.box("trim", (-0.29, 0.27, 2.04), (0.29, 0.45, 2.115))
    model.box("steel", (0.42, -0.2, 1.9), (0.5, -0.13, 2.13), along=(0, 0, 1))


def hull() -> Model:
    """The whole hull."""
    model = Model(MATERIALS)
    _body(model)
    _cabin(model)
    _fittings(model)
    return model
