"""The shape in which a chain of equal links hangs at rest between two points."""

from __future__ import annotations

import math

import numpy as np

from osgode.maths import FloatArray

STRAIGHT = 1e-7
"""A chain that is longer than the straight way by less than this part of it is straight."""
HALVINGS = 52
CURVED = (-25.0, 14.0)
"""log(q), from the straightest to the most curved chain."""
STEEP = 40.0
"""asinh of the steepest mean slope."""
LEAST_SPAN = 1.01
"""How far the ends must be apart horizontally, in links: below one, some links would have to be pushed, not pulled."""


def hanging_angles(count: int, link: float, across: float, rise: float) -> FloatArray:
    """The slope of each link, radians: (count,), within +-pi/2.

    In each joint the same horizontal force ``H`` pulls, and the vertical one grows from link to link by the weight
    ``w`` of one. A rigid link is in balance if it points along the force at its middle, so

        ``tan(angle_k) = a + q (k - (count - 1) / 2)``,  ``q = w / H``,

    and ``a`` and ``q`` follow from where the ends are. For many links this is the catenary.

    Args:
        count: how many links.
        link: length of one.
        across: how far the ends are apart horizontally, at least `LEAST_SPAN` links.
        rise: how far the second end is above the first. All links together, two at least, must be longer than the
            way by more than `STRAIGHT` of it.
    """
    reach, height = across / link, rise / link
    place: FloatArray = np.arange(count, dtype=np.float64) - 0.5 * (count - 1)
    angles = np.zeros(count)
    low, high = CURVED  # the more curved, the nearer together the ends
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        angles = _at_height(place * np.float64(math.exp(middle)), height)
        if float(np.cos(angles).sum()) > reach:
            low = middle
        else:
            high = middle
    return angles


def _at_height(slopes: FloatArray, height: float) -> FloatArray:
    """The angles of links whose slopes are given but for a common number, such that they rise by ``height``."""
    low, high = -STEEP, STEEP  # of asinh of that number
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        angles = np.arctan(slopes + math.sinh(middle))
        if float(np.sin(angles).sum()) < height:
            low = middle
        else:
            high = middle
    return angles
