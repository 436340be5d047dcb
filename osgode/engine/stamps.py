"""Many copies of templates of lines, moved by tables of poses: in bulk, for each picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from osgode.engine.wires import Wire
from osgode.graph.frame import Lines
from osgode.maths import Float32Array, FloatArray

Colours: TypeAlias = npt.NDArray[np.uint32]
"""Red, green, blue and opacity as the four bytes of one number, so that they are copied at once."""
DENSE, FAINTEST = 150, 0.3
"""Lines of a template from which on they are drawn fainter, and how much fainter at the most."""
HEAD, WIDE, CROSS = 0.22, 0.08, 0.2
"""Length and half width of an arrow's head, and of the arms of a contact's cross, for an arrow 1 long."""
Numbers: TypeAlias = npt.NDArray[np.intp]


def colour(red: int, green: int, blue: int, opacity: int = 255) -> int:
    """Bytes as one of `Colours`."""
    return int(np.array([red, green, blue, opacity], np.uint8).view(np.uint32)[0])


class _Same(NamedTuple):
    """Stamps of one template."""

    wire: Float32Array
    """Its points with a 1 behind each, (2k, 4)."""
    matrices: FloatArray
    rows: Numbers
    owners: Numbers


class Stamps:
    """Copies of templates, those of one template together: each at ``table[row] @ matrix``.

    Args:
        wires: the template of each.
        matrices: (n, 4, 4).
        rows: (n,), in the table of poses.
        owners: (n,), whose colour each has.
    """

    def __init__(self, wires: Sequence[Wire], matrices: FloatArray, rows: npt.ArrayLike, owners: npt.ArrayLike) -> None:
        of_wire: dict[int, list[int]] = {}
        for k, wire in enumerate(wires):
            of_wire.setdefault(id(wire), []).append(k)
        self._groups: list[_Same] = []
        numbers = np.array([rows, owners], np.intp)
        for same in of_wire.values():
            points = wires[same[0]].reshape(-1, 3)
            padded = np.ones((len(points), 4), np.float32)
            padded[:, :3] = points
            self._groups.append(_Same(padded, matrices[same], *numbers[:, same]))
        self.count = sum(len(same.rows) * (len(same.wire) // 2) for same in self._groups)
        """How many lines there are."""

    def points(self, table: FloatArray) -> Float32Array:
        """All lines, (count, 2, 3), where ``table``, (n, 4, 4), puts them."""
        out = np.empty((self.count * 2, 3), np.float32)
        start = 0
        for wire, matrices, rows, _ in self._groups:
            moved = (table.take(rows, axis=0) @ matrices)[:, :3].astype(np.float32).transpose(0, 2, 1)
            end = start + len(rows) * len(wire)
            np.matmul(wire, moved, out=out[start:end].reshape(len(rows), len(wire), 3))
            start = end
        return out.reshape(-1, 2, 3)

    def colours(self, of_owners: Colours, *, fading: bool = False) -> Colours:
        """Those of all lines, (count,), by what each owner has; with ``fading`` dense templates are fainter."""
        if not self._groups:
            return np.empty(0, np.uint32)
        several = []
        for same in self._groups:
            count = len(same.wire) // 2
            own = of_owners[same.owners]
            if fading and count > DENSE:
                opacity = own.view(np.uint8)[3::4]
                opacity[:] = opacity * max(math.sqrt(DENSE / count), FAINTEST)
            several.append(own.repeat(count))
        return np.concatenate(several)


class Batch:
    """Lines that are drawn together."""

    def __init__(self) -> None:
        self._points: list[Float32Array] = []
        self._colours: list[Colours] = []

    def add(self, points: Float32Array | FloatArray, colours: Colours | int) -> None:
        """Add (n, 2, 3) lines in (n,) colours, or all in one."""
        self._points.append(np.asarray(points, np.float32))
        self._colours.append(np.broadcast_to(np.asarray(colours, np.uint32), len(points)))

    def lines(self, *, in_front: bool) -> list[Lines]:
        """All together, if there are any."""
        if not any(map(len, self._points)):
            return []
        colours = np.concatenate(self._colours).view(np.uint8).reshape(-1, 4)
        return [Lines(np.concatenate(self._points), colours, in_front)]


def scattered(wire: Wire, at: FloatArray, sizes: npt.ArrayLike) -> Float32Array:
    """A template at each of some points, along the axes of the world.

    Args:
        wire: k lines.
        at: (n, 3), metres.
        sizes: by what each is scaled: one number, (n,), or (n, 3) for sizes along x, y, z.

    Returns:
        (n * k, 2, 3), those of one point together.
    """
    scale = np.asarray(sizes, np.float64)
    scale = scale.reshape(-1, 1, 1, scale.shape[-1] if scale.ndim == 2 else 1)
    return np.asarray(at[:, None, None] + scale * wire, np.float32).reshape(-1, 2, 3)


def arrows(starts: FloatArray, ways: FloatArray, length: float = 1.0) -> Float32Array:
    """An arrow of five lines along each way, ``length`` times as long: (n, 3) and (n, 3) give (n * 5, 2, 3)."""
    sizes = np.linalg.norm(ways, axis=1, keepdims=True)
    aside, over = across(ways / np.maximum(sizes, 1e-300))
    ends = starts + length * ways
    lines = np.empty((len(ways), 5, 2, 3), np.float32)
    lines[:, 0, 0], lines[:, :, 1] = starts, ends[:, None]
    foot, wide = ends - HEAD * ways, WIDE * sizes
    for k, side in enumerate((aside, -aside, over, -over), 1):
        lines[:, k, 0] = foot + wide * side
    return lines.reshape(-1, 2, 3)


def touches(points: FloatArray, normals: FloatArray, sizes: FloatArray) -> Float32Array:
    """A mark of five lines for each contact: a cross on the surface, and an arrow along the normal.

    Args:
        points: (n, 3), metres.
        normals: (n, 3), of length 1.
        sizes: (n,), of the arrows, metres.
    """
    size = sizes[:, None]
    aside, over = across(normals)
    ends = points + size * normals
    foot, wide = ends - HEAD * size * normals, WIDE * size * aside
    lines = np.empty((len(points), 5, 2, 3), np.float32)
    lines[:, 0, 0], lines[:, 0, 1] = points, ends
    lines[:, 1, 0], lines[:, 2, 0], lines[:, 1:3, 1] = foot + wide, foot - wide, ends[:, None]
    for k, way in enumerate((aside, over), 3):
        arm = CROSS * size * way
        lines[:, k, 0], lines[:, k, 1] = points - arm, points + arm
    return lines.reshape(-1, 2, 3)


def across(normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two directions square to each of (n, 3) unit vectors and to each other.

    T. Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
    """
    x, y, z = normals.T
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    one = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=1)
    return one, np.stack([b, sign + y * y * a, -y], axis=1)
