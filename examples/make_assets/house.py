"""A brick cottage of 8 by 6 metres about the origin that one can walk into.

The door is in the middle of the +Z side, the floor 5 cm above the ground, the foundation 30 cm below it. Every part
is a closed solid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from osgode.examples.make_assets.modelling import UP, Material, Model, Point

MATERIALS = {
    "brick": Material(texture="brick"),
    "plaster": Material(texture="plaster", tile=2.0),
    "roof": Material(texture="roof", tile=1.2, shine=2.0),
    "ridge": Material((0.52, 0.27, 0.19)),
    "planks": Material(texture="planks", shine=3.0),
    "beam": Material((0.75, 0.72, 0.7), texture="planks"),
    "concrete": Material(texture="concrete", tile=2.0),
    "white": Material((0.97, 0.97, 0.96), texture="plaster"),
    "shutter": Material((0.27, 0.47, 0.37), texture="plaster", tile=0.5),
}
LENGTH, WIDTH, THICK = 8.0, 6.0, 0.2
FLOOR, SILL, HEAD, EAVES = 0.05, 0.95, 2.15, 2.6
LEVELS = (-0.3, FLOOR, SILL, HEAD, EAVES)
"""Where the walls are cut across; the same all round, so that they meet corner to corner."""
SLOPE = 0.7
"""The roof's rise per metre."""
DOOR_WIDTH, WINDOW_WIDTH = 1.0, 1.2

Place: TypeAlias = Callable[[float, float, float], Point]
"""From metres along a wall (from its middle, to the right seen from outside), height, and depth into it."""


@dataclass(frozen=True)
class Hole:
    """A door or a window in a wall; ``middle`` is in metres along the wall."""

    middle: float
    door: bool = False

    @property
    def sides(self) -> tuple[float, float]:
        """Its left and right edge, in metres along the wall."""
        half = (DOOR_WIDTH if self.door else WINDOW_WIDTH) / 2
        return self.middle - half, self.middle + half

    @property
    def rows(self) -> tuple[int, ...]:
        """Which of the strips between `LEVELS` it opens."""
        return (1, 2) if self.door else (2,)


@dataclass(frozen=True)
class Wall:
    """One side of the ring of walls, closed but for its ends, where its neighbours join.

    Args:
        place: where it is.
        length: of its outside.
        holes: from left to right.
        gable: whether it rises to the ridge.
    """

    place: Place
    length: float
    holes: Sequence[Hole]
    gable: bool

    @property
    def cuts(self) -> list[float]:
        """Where the wall is cut upright: at its ends and at the sides of its holes."""
        half = self.length / 2
        return [-half, *(side for hole in self.holes for side in hole.sides), half]

    def outer(self, i: int, j: int) -> Point:
        """The corner of cut ``i`` and level ``j`` outside."""
        return self.place(self.cuts[i], LEVELS[j], 0.0)

    def inner(self, i: int, j: int) -> Point:
        """The corner inside: mitred at the ends, and at the top as high as the roof is there."""
        s = self.cuts[i] + (THICK if i == 0 else -THICK if i == len(self.cuts) - 1 else 0.0)
        return self.place(s, LEVELS[j] + (THICK * SLOPE if j == len(LEVELS) - 1 else 0.0), THICK)

    def build(self, model: Model) -> None:
        """Add the wall to the model."""
        opened = {(2 * k + 1, row) for k, hole in enumerate(self.holes) for row in hole.rows}
        for i in range(len(self.cuts) - 1):
            for j in range(len(LEVELS) - 1):
                if (i, j) in opened:
                    self._reveal(model, i, j, opened)
                    continue
                a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
                model.face("brick", self.outer(*a), self.outer(*b), self.outer(*c), self.outer(*d))
                model.face("plaster", self.inner(*b), self.inner(*a), self.inner(*d), self.inner(*c))
            model.face("brick", self.outer(i, 0), self.inner(i, 0), self.inner(i + 1, 0), self.outer(i + 1, 0))
        self._top(model)

    def _reveal(self, model: Model, i: int, j: int, opened: set[tuple[int, int]]) -> None:
        """The sides of a hole, through the wall's thickness."""
        a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
        model.face("brick", self.outer(*a), self.inner(*a), self.inner(*d), self.outer(*d))
        model.face("brick", self.outer(*b), self.outer(*c), self.inner(*c), self.inner(*b))
        if (i, j - 1) not in opened:
            model.face("concrete", self.outer(*a), self.outer(*b), self.inner(*b), self.inner(*a))
        if (i, j + 1) not in opened:
            model.face("brick", self.outer(*d), self.inner(*d), self.inner(*c), self.outer(*c))

    def _top(self, model: Model) -> None:
        top, last = len(LEVELS) - 1, len(self.cuts) - 1
        if not self.gable:
            for i in range(last):
                model.face(
                    "brick", *(self.outer(k, top) for k in (i, i + 1)), *(self.inner(k, top) for k in (i + 1, i))
                )
            return
        ridge = EAVES + SLOPE * self.length / 2
        outside, inside = self.place(0.0, ridge, 0.0), self.place(0.0, ridge, THICK)
        for i in range(last):
            model.face("brick", self.outer(i, top), self.outer(i + 1, top), outside)
            model.face("plaster", self.inner(i + 1, top), self.inner(i, top), inside)
        model.face("brick", self.outer(0, top), outside, inside, self.inner(0, top))
        model.face("brick", outside, self.outer(last, top), self.inner(last, top), inside)


def _bar(model: Model, place: Place, material: str, start: Point, end: Point, *, level: bool = False) -> None:
    """A box given in the measures of a wall; ``level`` for wood whose fibres run along it."""
    p, q = place(*start), place(*end)
    low = (min(p[0], q[0]), min(p[1], q[1]), min(p[2], q[2]))
    high = (max(p[0], q[0]), max(p[1], q[1]), max(p[2], q[2]))
    origin, right = place(0, 0, 0), place(1, 0, 0)
    along = (abs(right[0] - origin[0]), 0.0, abs(right[2] - origin[2]))
    model.box(material, low, high, along if level else UP)


def _door_boards(model: Model, place: Place, hole: Hole) -> None:
    """Boards about the doorway, on the outside so that it stays as wide as it is, and a step."""
    left, right = hole.sides
    bar = partial(_bar, model, place)
    bar("beam", (left - 0.12, FLOOR, -0.03), (left, HEAD, 0.01))
    bar("beam", (right, FLOOR, -0.03), (right + 0.12, HEAD, 0.01))
    bar("beam", (left - 0.16, HEAD, -0.04), (right + 0.16, HEAD + 0.15, 0.01), level=True)
    bar("concrete", (left - 0.25, -0.3, -0.7), (right + 0.25, 0.02, 0.02))


def _window_frame(model: Model, place: Place, hole: Hole) -> None:
    """A window without panes: frame, sill and shutters. Parts overlap a little, so that each stays closed."""
    left, right = hole.sides
    bar = partial(_bar, model, place)
    for s, wide in ((left, 0.06), (hole.middle, 0.025), (right, 0.06)):
        bar("white", (s - wide, SILL - 0.01, 0.07), (s + wide, HEAD + 0.01, 0.13))
    for y, high in ((SILL, 0.06), ((SILL + HEAD) / 2, 0.02), (HEAD, 0.06)):
        bar("white", (left - 0.01, y - high, 0.075), (right + 0.01, y + high, 0.125), level=True)
    bar("concrete", (left - 0.08, SILL - 0.07, -0.09), (right + 0.08, SILL + 0.005, 0.06))
    for s in (left - 0.62, right + 0.02):
        for k in range(4):  # boards with a gap between them, held by two ledges
            bar("shutter", (s + 0.15 * k, SILL - 0.02, -0.045), (s + 0.15 * k + 0.142, HEAD + 0.02, 0.01))
        for y in (SILL + 0.15, HEAD - 0.25):
            bar("shutter", (s + 0.03, y, -0.07), (s + 0.562, y + 0.1, -0.03), level=True)


def _roof(model: Model) -> None:
    half, end = WIDTH / 2 + 0.45, LENGTH / 2 + 0.4
    # Two centimetres below the walls' tops, so that no gap shows.
    ridge = EAVES + SLOPE * WIDTH / 2 - 0.02
    eave = ridge - SLOPE * half
    right = [(0.0, ridge), (half, eave), (half, eave + 0.2), (0.0, ridge + 0.2)]
    model.prism(
        ["planks", "planks", "beam", "roof", "roof", "beam"],
        [(-half, eave), *right, (-half, eave + 0.2)],
        (-end, end),
    )
    for x, way in ((-end, 1), (end, -1)):
        for side in (1, -1):
            points = [(x, y, side * z) for z, y in right]
            model.face("beam", *points[:: way * side], along=(0.0, -SLOPE, side))
    cap = [(0.14, ridge + 0.05), (0.12, ridge + 0.2), (0.06, ridge + 0.29)]
    cap += [(-z, y) for z, y in reversed(cap)]
    model.prism(["ridge"] * len(cap), cap, (-end - 0.03, end + 0.03))
    for x, way in ((-end - 0.03, 1), (end + 0.03, -1)):
        model.face("ridge", *[(x, y, z) for z, y in cap][::way])


def house() -> Model:
    """The whole cottage."""
    model = Model(MATERIALS)
    x, z = LENGTH / 2, WIDTH / 2
    walls = (
        Wall(lambda s, y, d: (s, y, z - d), LENGTH, (Hole(-2.3), Hole(0.0, door=True), Hole(2.3)), gable=False),
        Wall(lambda s, y, d: (-s, y, d - z), LENGTH, (Hole(-2.0), Hole(2.0)), gable=False),
        Wall(lambda s, y, d: (x - d, y, -s), WIDTH, (Hole(0.0),), gable=True),
        Wall(lambda s, y, d: (d - x, y, s), WIDTH, (Hole(0.0),), gable=True),
    )
    for wall in walls:
        wall.build(model)
        for hole in wall.holes:
            (_door_boards if hole.door else _window_frame)(model, wall.place, hole)
    model.box("planks", (THICK - x, -0.25, THICK - z), (x - THICK, FLOOR, z - THICK))
    within = z - THICK + 0.02
    for beam in (-2.0, 0.0, 2.0):
        model.box("beam", (beam - 0.08, EAVES - 0.2, -within), (beam + 0.08, EAVES, within), along=(0, 0, 1))
    _roof(model)
    model.box("brick", (2.0, 3.2, -1.4), (2.7, 5.3, -0.7))
    model.box("concrete", (1.93, 5.28, -1.47), (2.77, 5.38, -0.63))
    model.box("ridge", (2.2, 5.36, -1.2), (2.5, 5.6, -0.9))
    return model
