"""One thing to draw: a mesh, how it looks, and where it is in its node."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from osgode.errors import FieldError
from osgode.graph.appearance import DEFAULT_APPEARANCE, Appearance
from osgode.graph.mesh import Mesh
from osgode.maths import FloatArray


@dataclass(frozen=True, eq=False)
class Drawable:
    """A mesh with an appearance, placed in the axes of the node that shows it.

    Compared by identity; may be shown by several nodes.

    Args:
        mesh: what is drawn.
        appearance: how it looks.
        matrix: (4, 4), ``v_node = matrix @ v_mesh``, may scale unevenly; None for the identity.

    Raises:
        FieldError: if the matrix is not a finite (4, 4) with (0, 0, 0, 1) as its last row.
    """

    mesh: Mesh
    appearance: Appearance = DEFAULT_APPEARANCE
    matrix: FloatArray | None = None

    def __post_init__(self) -> None:
        if self.matrix is not None:
            object.__setattr__(self, "matrix", affine_matrix("Drawable.matrix", self.matrix))


def affine_matrix(name: str, value: object) -> FloatArray:
    """A read-only (4, 4) float64 copy of ``value``.

    Raises:
        FieldError: naming ``name``, if ``value`` is not a finite (4, 4) with (0, 0, 0, 1) as its last row.
    """
    try:
        matrix = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise FieldError(f"{name} is {value!r}; it must be (4, 4) numbers") from None
    if matrix.shape != (4, 4):
        raise FieldError(f"{name} has shape {matrix.shape}; it must be (4, 4)")
    if not np.isfinite(matrix).all():
        raise FieldError(f"{name} holds a number that is not finite")
    if tuple(matrix[3]) != (0.0, 0.0, 0.0, 1.0):
        raise FieldError(f"{name} has the last row {matrix[3].tolist()}; it must be [0, 0, 0, 1]")
    matrix.flags.writeable = False
    return matrix
