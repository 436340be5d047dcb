"""What stands somewhere in a scene graph, as flat tables that are moved in bulk."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from osgode.graph.transforms import PoseSource
from osgode.maths import FloatArray

Selection = npt.NDArray[np.intp]
Marks = npt.NDArray[np.bool_]
IDENTITY = np.identity(4)


class Anchor(NamedTuple):
    """A table of poses as one way through the graph reaches it.

    ``matrix`` is that from the table's axes to the root, None for the identity.
    """

    source: PoseSource
    matrix: FloatArray | None


class Place(NamedTuple):
    """The axes of a node on one way from the root: ``v_root = anchor.matrix @ pose @ matrix @ v_node``.

    ``anchor`` is an index into the list of anchors and ``row`` one into its table; where ``anchor`` is None nothing
    moves, and ``v_root = matrix @ v_node``. ``matrix`` is None for the identity.
    """

    matrix: FloatArray | None = None
    anchor: int | None = None
    row: int = 0

    def within(self, matrix: FloatArray | None) -> Place:
        """The same for axes that ``matrix`` leads out of, into these."""
        if matrix is None:
            return self
        return self._replace(matrix=matrix if self.matrix is None else self.matrix @ matrix)

    def fixed(self) -> FloatArray:
        """The matrix, also where it is the identity."""
        return IDENTITY if self.matrix is None else self.matrix


class Tables:
    """The poses of every source at one moment, each asked for once."""

    def __init__(self, interpolation: float) -> None:
        self._interpolation = interpolation
        self._known: dict[int, FloatArray] = {}

    def of(self, source: PoseSource) -> FloatArray:
        """The source's matrices."""
        table = self._known.get(id(source))
        if table is None:
            table = self._known[id(source)] = source.matrices(self._interpolation)
        return table


class Movers:
    """Columns that are carried by places: points, directions, whole matrices.

    They are kept in an order of their own, in which those of one anchor stand together: first what stands still,
    in `moved` as it is, then one slice per anchor.

    Args:
        places: what carries each.
        columns: (n, 4, k), in the axes of the places.
        anchors: what the places refer to.
    """

    def __init__(self, places: Sequence[Place], columns: FloatArray, anchors: Sequence[Anchor]) -> None:
        by_anchor = np.array([-1 if each.anchor is None else each.anchor for each in places], dtype=np.intp)
        order = np.argsort(by_anchor, kind="stable")
        self.slots: Selection = np.empty(len(order), dtype=np.intp)
        """Where each of the places given stands in the order kept."""
        self.slots[order] = np.arange(len(order))
        fixed = np.empty((len(order), 4, 4))
        if len(order):
            fixed[:] = [places[k].fixed() for k in order]
        self.start = fixed @ columns[order]
        """(n, 4, k) in the order kept: in the axes of the root what stands still, the rest in those of its poses."""
        borders = np.searchsorted(by_anchor[order], np.arange(len(anchors) + 1))
        self._parts: list[tuple[Anchor, slice, Selection]] = []
        for anchor, (first, end) in zip(anchors, pairwise(borders.tolist()), strict=True):
            if first < end:
                rows = np.array([places[k].row for k in order[first:end]], dtype=np.intp)
                self._parts.append((anchor, slice(first, end), rows))

    def parts(self) -> Iterator[tuple[Anchor, slice]]:
        """The anchors that carry something, and where that stands."""
        return ((anchor, part) for anchor, part, _ in self._parts)

    def moved(self, tables: Tables) -> Iterator[tuple[slice, FloatArray]]:
        """What moves, piece by piece, in the axes of the root."""
        for anchor, part, rows in self._parts:
            columns = tables.of(anchor.source).take(rows, axis=0) @ self.start[part]
            if anchor.matrix is not None:
                columns = anchor.matrix @ columns
            yield part, columns
