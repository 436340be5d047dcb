"""The meshes of a race track: road with kerbs and verges, ramp, hill. All figures of their shapes are here."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import numpy.typing as npt

import osgode as oo
from osgode.examples.game.closed_line import ClosedLine, rounded
from osgode.examples.runner import look, painted

CORNERS = (
    (0.0, -95.0, 16.0),
    (60.0, -105.0, 18.0),
    (75.0, -50.0, 22.0),
    (45.0, -25.0, 15.0),
    (78.0, 5.0, 15.0),
    (60.0, 38.0, 16.0),
    (0.0, 32.0, 16.0),
)
"""Where straights would meet, and the radius of the bend there: x, z, radius, metres, in the order of driving."""
SPACING = 1.5
"""Between two points of the line, about, metres."""
WIDTH = 10.0
"""Of the road without its kerbs, metres."""
CLEAR = 0.03
"""How far the road lies above the ground, metres."""
RISE, RISE_FROM, RISE_TO = 2.2, 18.0, 52.0
"""The road leads over a bank so many metres high; it climbs between these x."""
KERB_WIDTH, KERB_HEIGHT = 0.9, 0.05
"""Of the kerbs, which slope up from the road, metres."""
STRIPE = 2.0
"""A red and a white stripe of a kerb together, metres."""
LINE_WIDTH, LINE_INSET = 0.15, 0.25
"""Of the white lines along the road, and how far they are from its edge, metres."""
VERGE, BANK_SLOPE = 1.5, 2.4
"""The verge is so wide on level ground, metres, and so much wider for each metre of the bank's height."""
BELOW = 0.15
"""How deep the edges of meshes reach into the ground, metres."""
BENT = 0.02
"""Where the line bends more than this (1/m) there are kerbs, and walls outside."""

RAMP = (3.6, 8.0, 1.15)
"""Width, length and height of the ramp, metres."""
RAMP_PIECES = 16

HILL_RADIUS, HILL_HEIGHT = 17.0, 4.6
"""Metres; it is steepest half-way up: ``pi height / (2 radius)`` = 0.425, 23 degrees."""
HILL_RINGS, HILL_SECTORS = 14, 40

Table = npt.NDArray[np.float64]


def height_of_bank(x: Table) -> Table:
    """How high above the ground the road is at ``x`` of the track's own axes: smooth at both ends."""
    part = np.clip((x - RISE_FROM) / (RISE_TO - RISE_FROM), 0.0, 1.0)
    return np.asarray(RISE * part**2 * (3 - 2 * part))


def height_of_hill(distance: Table) -> Table:
    """How high the hill is at a distance from its middle."""
    return np.asarray(HILL_HEIGHT / 2 * (1 + np.cos(math.pi * np.minimum(distance / HILL_RADIUS, 1.0))))


@cache
def own_line() -> Table:
    """The middle of the road in the track's own axes, (n, 3): it begins at the origin and leads along -Z."""
    plan = np.array(rounded(CORNERS, SPACING))
    first = int(np.argmin(np.hypot(*plan.T)))
    plan = np.roll(plan, -first, axis=0) - (0.0, plan[first, 1])
    return np.column_stack([plan[:, 0], CLEAR + height_of_bank(plan[:, 0]), plan[:, 1]])


class Sections:
    """The road's cross sections at the points of its line: what its meshes are made of.

    Args:
        line: (n, 3), the middle of the road.
    """

    def __init__(self, line: Table) -> None:
        self.line = line
        ways = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
        ways[:, 1] = 0.0
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        self.right = np.column_stack([-ways[:, 2], np.zeros(len(line)), ways[:, 0]])
        steps = np.linalg.norm(np.diff(line[:, ::2], axis=0, append=line[:1, ::2]), axis=1)
        self.along = np.concatenate([[0.0], np.cumsum(steps)])
        self.verge = KERB_WIDTH + VERGE + BANK_SLOPE * (line[:, 1] - CLEAR)

    def column(self, aside: float | Table, height: float | Table) -> Table:
        """Points beside the line, positive to the right, above the road: (n, 3)."""
        place = self.line + self.right * np.reshape(aside, (-1, 1))
        place[:, 1] += height
        return np.asarray(place)

    def columns(self, lines: Sequence[float]) -> list[Table]:
        """From left to right: ground, top of the kerb, what is named of the road, top of the kerb, ground."""
        half = WIDTH / 2
        ground = -self.line[:, 1] - BELOW
        road = [self.column(x, 0.0) for x in (-half, *lines, half)]
        kerbs = [self.column(side * (half + KERB_WIDTH), KERB_HEIGHT) for side in (-1, 1)]
        feet = [self.column(side * (half + self.verge), ground) for side in (-1, 1)]
        return [feet[0], kerbs[0], *road, kerbs[1], feet[1]]

    def ground_beside(self, point: int, aside: float) -> tuple[float, float, float]:
        """Where the ground is beside a point of the line, beyond the kerb: on the verge, or on the level behind it."""
        x, y, z = self.line[point] + self.right[point] * aside
        beyond = abs(aside) - WIDTH / 2 - KERB_WIDTH
        fall = (self.line[point, 1] + BELOW) * beyond / (self.verge[point] - KERB_WIDTH)
        return float(x), max(float(y - fall), 0.0), float(z)

    def strip(self, left: Table, right: Table, tile: float, where: npt.NDArray[np.bool_] | None = None) -> oo.Mesh:
        """The strip between two columns, textured by the metre; only the pieces ``where`` that is so."""
        around = np.arange(len(self.line) + 1)
        left, right = left[around % len(left)], right[around % len(right)]
        across = np.linalg.norm(right - left, axis=1)
        zero = np.zeros_like(across)
        uvs = np.concatenate([np.column_stack([zero, self.along]), np.column_stack([across, self.along])]) / tile
        near = around[:-1] if where is None else around[:-1][where]
        far, other = near + 1, len(around)
        triangles = np.concatenate(
            [np.column_stack([near, other + near, other + far]), np.column_stack([near, other + far, far])]
        )
        return oo.Mesh(np.concatenate([left, right]), triangles, uvs=uvs)

    def bends(self) -> Table:
        """How strongly the line bends at each point, 1/m, positive to the left."""
        closed = ClosedLine([tuple(point) for point in self.line])
        return np.array([closed.bend(start + 1e-6) for start in self.along[:-1]])


def wide(flags: npt.NDArray[np.bool_], by: int) -> npt.NDArray[np.bool_]:
    """The same with so many more at both ends of each run."""
    return np.asarray(np.any([np.roll(flags, k) for k in range(-by, by + 1)], axis=0))


def road() -> oo.Model:
    """Road, kerbs and verges: what is drawn, and the coarser mesh that wheels roll on."""
    sections = Sections(own_line())
    paint = WIDTH / 2 - LINE_INSET
    foot, kerb, edge, outer, inner, *rest = sections.columns((-paint, LINE_WIDTH - paint, paint - LINE_WIDTH, paint))
    inner_right, outer_right, edge_right, kerb_right, foot_right = rest
    striped = wide(np.abs(sections.bends()) > BENT, 3)
    start = np.zeros(len(sections.line), bool)
    start[0] = True
    asphalt, white = look("asphalt", (0.95, 0.95, 1.0), scale=3.0, shine=0.05), painted(0.92, 0.92, 0.9, 0.2)
    grass, stripes = (
        look("grass", (0.9, 1.0, 0.85), scale=4.0, shine=0.0),
        oo.Appearance((1.0, 1.0, 1.0, 1.0), red_white()),
    )
    drawables = [
        oo.Drawable(sections.strip(foot, kerb, 4.0), grass),
        oo.Drawable(sections.strip(kerb_right, foot_right, 4.0), grass),
    ]
    for left, right in ((kerb, edge), (edge_right, kerb_right)):
        drawables.append(oo.Drawable(sections.strip(left, right, STRIPE, striped), stripes))
        drawables.append(oo.Drawable(sections.strip(left, right, 4.0, ~striped), grass))
    for left, right in ((edge, outer), (outer_right, edge_right)):
        drawables.append(oo.Drawable(sections.strip(left, right, 3.0), asphalt))
    for left, right in ((outer, inner), (inner_right, outer_right)):
        drawables.append(oo.Drawable(sections.strip(left, right, 1.0), white))
    drawables.append(oo.Drawable(sections.strip(inner, inner_right, 3.0, ~start), asphalt))
    drawables.append(
        oo.Drawable(sections.strip(inner, inner_right, 1.5, start), oo.Appearance((1.0, 1.0, 1.0, 1.0), chequers()))
    )
    columns = sections.columns((0.0,))
    count, wide_ = len(sections.line), len(columns)
    vertices = np.stack(columns, axis=1).reshape(-1, 3)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(count), np.arange(wide_ - 1), indexing="ij"))
    near, far = i * wide_ + j, (i + 1) % count * wide_ + j
    triangles = np.concatenate([np.column_stack([near, near + 1, far + 1]), np.column_stack([near, far + 1, far])])
    return oo.Model("road", tuple(drawables), vertices, triangles)


@cache
def red_white() -> oo.Texture:
    """Stripes across the kerbs."""
    image = np.zeros((64, 64, 3), np.uint8)
    image[:32], image[32:] = (205, 32, 28), (238, 238, 232)
    return oo.Texture(image, "kerb")


@cache
def chequers() -> oo.Texture:
    """The start line: two rows of squares."""
    rows, columns = np.indices((64, 64)) // 32
    image = np.where(
        ((rows + columns) % 2 == 0)[..., None], np.array([20, 20, 22], np.uint8), np.array([240, 240, 238], np.uint8)
    )
    return oo.Texture(image, "chequers")


def ramp() -> oo.Mesh:
    """A closed wedge about its foot's middle, along -Z, that grows steeper to its end, textured by the metre."""
    width, length, height = RAMP
    z = np.linspace(0.0, length, RAMP_PIECES + 1)
    y = height * (0.35 * z / length + 0.65 * (z / length) ** 2)
    upper = np.column_stack([y, -z])
    lower = np.column_stack([np.full_like(z, -BELOW), -z])
    vertices: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    uvs: list[tuple[float, float]] = []

    def face(*corners: tuple[float, float, float], at: Sequence[tuple[float, float]]) -> None:
        first = len(vertices)
        vertices.extend(corners)
        uvs.extend((u / 1.2, v / 1.2) for u, v in at)
        triangles.extend((first, first + k, first + k + 1) for k in range(1, len(corners) - 1))

    half = width / 2
    for k in range(RAMP_PIECES):
        (y0, z0), (y1, z1) = upper[k], upper[k + 1]
        b0, b1 = lower[k][0], lower[k + 1][0]
        face(
            (-half, y0, z0),
            (half, y0, z0),
            (half, y1, z1),
            (-half, y1, z1),
            at=[(-z0, 0), (-z0, width), (-z1, width), (-z1, 0)],
        )
        face(
            (half, b0, z0),
            (half, b1, z1),
            (half, y1, z1),
            (half, y0, z0),
            at=[(b0, -z0), (b1, -z1), (y1, -z1), (y0, -z0)],
        )
        face(
            (-half, b1, z1),
            (-half, b0, z0),
            (-half, y0, z0),
            (-half, y1, z1),
            at=[(b1, -z1), (b0, -z0), (y0, -z0), (y1, -z1)],
        )
    bottom, end, top = -BELOW, -length, height
    face(
        (-half, bottom, end),
        (-half, top, end),
        (half, top, end),
        (half, bottom, end),
        at=[(0, 0), (0, 1), (width, 1), (width, 0)],
    )
    face(
        (-half, bottom, 0),
        (half, bottom, 0),
        (half, 0, 0),
        (-half, 0, 0),
        at=[(0, 0), (width, 0), (width, 0.1), (0, 0.1)],
    )
    face(
        (-half, bottom, 0),
        (-half, bottom, end),
        (half, bottom, end),
        (half, bottom, 0),
        at=[(0, 0), (length, 0), (length, width), (0, width)],
    )
    return oo.Mesh(vertices, triangles, uvs=uvs, name="ramp")


def hill() -> oo.Mesh:
    """A round hill about the origin, whose edge reaches into the ground, textured by the metre."""
    reach = np.linspace(0.0, HILL_RADIUS, HILL_RINGS + 1)[1:]
    turns = np.arange(HILL_SECTORS) * (math.tau / HILL_SECTORS)
    r, a = np.meshgrid(reach, turns, indexing="ij")
    y = height_of_hill(r)
    y[-1] = -BELOW
    vertices = np.concatenate(
        [[[0.0, HILL_HEIGHT, 0.0]], np.stack([r * np.sin(a), y, r * np.cos(a)], axis=-1).reshape(-1, 3)]
    )
    turn = np.arange(HILL_SECTORS)
    following = (turn + 1) % HILL_SECTORS
    triangles = [np.column_stack([np.zeros_like(turn), 1 + turn, 1 + following])]
    for ring in range(HILL_RINGS - 1):
        near, far = 1 + ring * HILL_SECTORS, 1 + (ring + 1) * HILL_SECTORS
        triangles.append(np.column_stack([near + turn, far + turn, far + following]))
        triangles.append(np.column_stack([near + turn, far + following, near + following]))
    return oo.Mesh(vertices, np.concatenate(triangles), uvs=vertices[:, ::2] / (4.0, -4.0), name="hill")
