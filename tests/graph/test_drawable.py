"""Drawables: what they hold and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

from osgode.errors import FieldError
from osgode.graph.appearance import DEFAULT_APPEARANCE
from osgode.graph.drawable import Drawable
from osgode.graph.primitives import box_mesh


def test_defaults() -> None:
    """A drawable needs no more than a mesh."""
    drawable = Drawable(box_mesh())
    assert drawable.appearance is DEFAULT_APPEARANCE
    assert drawable.matrix is None


def test_matrix_is_a_read_only_copy() -> None:
    """Changing the array that was given changes nothing, and the drawable's own can't be written."""
    given = np.identity(4)
    drawable = Drawable(box_mesh(), matrix=given)
    given[0, 3] = 7
    assert drawable.matrix is not None
    assert drawable.matrix[0, 3] == 0
    with pytest.raises(ValueError, match="read-only"):
        drawable.matrix[0, 3] = 1


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.identity(3), "shape"),
        (np.full((4, 4), np.nan), "finite"),
        (np.diag([1.0, 1.0, 1.0, 2.0]), "last row"),
        ("no matrix", "numbers"),
    ],
)
def test_bad_matrix_is_refused(matrix: object, words: str) -> None:
    """A matrix that is not an affine one is refused with the reason."""
    with pytest.raises(FieldError, match=words):
        Drawable(box_mesh(), matrix=matrix)  # type: ignore[arg-type]


def test_equality_is_identity() -> None:
    """Two drawables of the same parts are two drawables, and can be kept in sets."""
    a, b = Drawable(box_mesh()), Drawable(box_mesh())
    assert a != b
    assert len({a, b}) == 2
