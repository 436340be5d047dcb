"""Groups that show this child or that one by how far they are from the eye."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from osgode.errors import FieldError, TreeError, shown
from osgode.graph.movers import IDENTITY, Anchor, Marks, Movers, Place, Selection, Tables
from osgode.graph.node import ChildT, Group, Node
from osgode.graph.transforms import Transform
from osgode.maths import FloatArray, Vec3, Vec3Like, finite


class Range(NamedTuple):
    """Distances from the eye, metres: from ``near`` to just below ``far``."""

    near: float = 0.0
    far: float = math.inf


class LevelOfDetail(Group):
    """A group whose children are each drawn at some distances only: a fine model near by, a coarse one far off.

    The distance is that from the eye to `centre`, in metres of the root, wherever transforms and moving bodies have
    taken it. Ranges may overlap or leave gaps. Shadows are those of what is shown.

        house = LevelOfDetail()
        house.attach(fine, far=30)
        house.attach(coarse, near=30, far=400)  # beyond 400 m nothing

    Args:
        centre: in the node's own axes, metres; None for the middle of what is below, see `bounding_box`.
        name: for messages and paths.
        visible: whether it, and what is below it, is drawn.

    Raises:
        FieldError: if the centre is not three finite numbers.
    """

    def __init__(self, *, centre: Vec3Like | None = None, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self._ranges: list[Range] = []
        self._centre = self._checked_centre(centre)
        self._middle: tuple[int, Vec3] | None = None

    @property
    def centre(self) -> Vec3:
        """The point whose distance counts, in the node's own axes; set it to None for the middle of what is below."""
        if self._centre is not None:
            return self._centre
        if self._middle is None or self._middle[0] != self._revision:
            box = bounding_box(self)
            self._middle = self._revision, Vec3(0.0, 0.0, 0.0) if box is None else (box[0] + box[1]) / 2
        return self._middle[1]

    @centre.setter
    def centre(self, value: Vec3Like | None) -> None:
        self._centre = self._checked_centre(value)
        self._touch()

    @property
    def ranges(self) -> tuple[Range, ...]:
        """The distances at which each child is drawn, in the order of `children`."""
        return tuple(self._ranges)

    def attach(self, child: ChildT, near: float = 0.0, far: float = math.inf) -> ChildT:
        """Take ``child`` in as the last of the children, drawn from ``near`` to just below ``far``, and return it.

        Args:
            child: any node that may stand under a Group.
            near: metres, 0 or more.
            far: metres, more than ``near``; may be infinite.

        Raises:
            FieldError: if there is no distance between ``near`` and ``far``; nothing is changed then.
            TreeError: if a tree rule forbids it; nothing is changed then.
        """
        self._ranges.append(self._checked_range(near, far))
        try:
            return super().attach(child)
        except BaseException:
            del self._ranges[len(self._children) :]
            raise

    def set_range(self, child: Node, near: float = 0.0, far: float = math.inf) -> None:
        """Draw ``child`` from ``near`` to just below ``far`` metres; if it was attached twice, the last one.

        Raises:
            FieldError: if there is no distance between ``near`` and ``far``; nothing is changed then.
            TreeError: if it is no child of this node; nothing is changed then.
        """
        number = self._number(child)
        if number is None:
            raise TreeError(f"{shown(child)} has no range in {self.describe()}: it is not one of its children")
        self._ranges[number] = self._checked_range(near, far)
        self._touch()

    def _unlink(self, child: Node) -> None:
        number = self._number(child)
        super()._unlink(child)
        if number is not None:
            del self._ranges[number]

    def _number(self, child: Node) -> int | None:
        found = (k for k in range(len(self._children) - 1, -1, -1) if self._children[k] is child)
        return next(found, None)

    def _checked_range(self, near: float, far: float) -> Range:
        try:
            result = Range(float(near), float(far))
        except (TypeError, ValueError):
            result = Range(math.nan, math.nan)
        if not 0.0 <= result.near < result.far:
            raise FieldError(
                f"{self.describe()}: the range is from {near!r} to {far!r}; it must begin at 0 or more and end "
                "farther away"
            )
        return result

    def _checked_centre(self, value: Vec3Like | None) -> Vec3 | None:
        if value is None:
            return None
        try:
            centre = tuple(map(float, value))
        except (TypeError, ValueError):
            centre = ()
        if len(centre) != 3 or not finite(centre):
            raise FieldError(f"{self.describe()}.centre is {value!r}; it must be three finite numbers or None")
        return Vec3(*centre)


def bounding_box(node: Node) -> tuple[Vec3, Vec3] | None:
    """The lowest and the highest corner, in the node's own axes, of a box that holds all drawn at or below it.

    What is hidden counts as well, and moving bodies where they are now; what stands below an absolute transform does
    not. The box may be larger than need be: that of each drawable is turned with it. None if nothing is drawn.
    """
    corners = np.array([corner for box in _boxes(node, IDENTITY) for corner in box])
    if not len(corners):
        return None
    return Vec3(*corners.min(axis=0).tolist()), Vec3(*corners.max(axis=0).tolist())


def _boxes(node: Node, matrix: FloatArray) -> Iterator[FloatArray]:
    """The eight corners of each drawable's box, (8, 3), in the axes that ``matrix`` leads to."""
    for drawable in node.drawables():
        corners = np.array([(*corner, 1.0) for corner in product(*zip(*drawable.mesh.bounds, strict=True))])
        inner = matrix if drawable.matrix is None else matrix @ drawable.matrix
        yield corners @ inner[:3].T
    for child in node.children if isinstance(node, Group) else ():
        if not isinstance(child, Transform):
            yield from _boxes(child, matrix)
        elif not child.absolute:
            yield from _boxes(child, matrix @ child.local_matrix())


class Gate(NamedTuple):
    """One child of a LevelOfDetail on one way from the root: the number of its centre, and when it is drawn."""

    centre: int
    range: Range


class Gates:
    """All gates of a picture, opened and shut in bulk.

    Args:
        centres: where the centres stand, which are the origins of these places.
        gates: what refers to them.
        anchors: what the places refer to.
    """

    def __init__(self, centres: Sequence[Place], gates: Sequence[Gate], anchors: Sequence[Anchor]) -> None:
        origins = np.zeros((len(centres), 4, 1))
        origins[:, 3] = 1.0
        self._movers = Movers(centres, origins, anchors)
        self._points = self._movers.start[:, :3, 0].copy()
        self._which = self._movers.slots[np.array([gate.centre for gate in gates], dtype=np.intp)]
        limits = np.array([gate.range for gate in gates]).reshape(-1, 2)
        self._near, self._far = limits[:, 0], limits[:, 1]

    def open(self, tables: Tables, eye: Vec3) -> Marks:
        """For each gate whether what is behind it is drawn."""
        for part, moved in self._movers.moved(tables):
            self._points[part] = moved[:, :3, 0]
        distances = np.sqrt(((self._points - eye) ** 2).sum(axis=1))[self._which]
        return np.asarray((self._near <= distances) & (distances < self._far))


class Gated:
    """Which of many things stand behind which gates.

    Args:
        gates: the numbers of the gates before each thing.
    """

    def __init__(self, gates: Sequence[Sequence[int]]) -> None:
        self._count = len(gates)
        pairs = [(k, gate) for k, before in enumerate(gates) for gate in before]
        self._things: Selection = np.array([k for k, _ in pairs], dtype=np.intp)
        self._gates: Selection = np.array([gate for _, gate in pairs], dtype=np.intp)

    def passed(self, opened: Marks) -> Marks | None:
        """Which things have all their gates open; None if none has any, and so all pass."""
        if not len(self._things):
            return None
        result = np.ones(self._count, dtype=np.bool_)
        result[self._things[~opened[self._gates]]] = False
        return result
