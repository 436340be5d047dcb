"""The shape of hanging chains: where the ends are, balance in every knot, and the catenary for many links."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from osgode.assemblies.catenary import LEAST_SPAN, hanging_angles

spans = st.floats(0.01, 0.98)
slopes = st.floats(-1.3, 1.3)


def ends(angles, link):
    return link * np.cos(angles).sum(), link * np.sin(angles).sum()


@given(st.integers(2, 60), spans, slopes, st.floats(0.01, 100.0))
def test_the_last_link_ends_where_it_should(count, span, slope, link):
    """For ends apart by any part of the length, in any direction but straight up and down."""
    way = span * count * link
    across, rise = way * math.cos(slope), way * math.sin(slope)
    assume(across > LEAST_SPAN * link)
    angles = hanging_angles(count, link, across, rise)
    assert ends(angles, link) == pytest.approx((across, rise), abs=1e-9 * count * link)


@given(st.integers(3, 40), st.floats(0.1, 0.95), slopes)
def test_every_link_points_along_the_force_at_its_middle(count, span, slope):
    """The tangents of the angles grow evenly: by the weight of a link over the horizontal force."""
    way = span * count
    assume(way * math.cos(slope) > LEAST_SPAN)
    tangents = np.tan(hanging_angles(count, 1.0, way * math.cos(slope), way * math.sin(slope)))
    steps = np.diff(tangents)
    assert steps.min() > 0
    assert steps == pytest.approx(steps[0], rel=1e-6)


def test_two_links_make_a_v():
    """Legs 5 and 5 over a way of 8: a triangle of 3, 4, 5."""
    assert hanging_angles(2, 5.0, 8.0, 0.0) == pytest.approx([-math.asin(0.6), math.asin(0.6)])


@pytest.mark.parametrize("rise", [0.0, 1.5])
def test_many_links_make_a_catenary(rise):
    """Against ``y = a cosh((x - m) / a)``, whose ``a`` follows from ``sqrt(length^2 - rise^2) = 2 a sinh(w / 2a)``."""
    length, across, count = 6.0, 4.0, 600
    low, high = 0.01, 100.0
    for _ in range(200):
        a = (low + high) / 2
        low, high = (a, high) if 2 * a * math.sinh(across / (2 * a)) > math.sqrt(length**2 - rise**2) else (low, a)
    lowest = across / 2 - a * math.asinh(rise / (2 * a * math.sinh(across / (2 * a))))

    angles = hanging_angles(count, length / count, across, rise)
    x = np.concatenate([[0.0], np.cumsum(np.cos(angles))]) * length / count
    y = np.concatenate([[0.0], np.cumsum(np.sin(angles))]) * length / count
    expected = a * (np.cosh((x - lowest) / a) - math.cosh(lowest / a))
    assert np.abs(y - expected).max() < 1e-4  # as links get shorter it goes with their square
    assert y.min() < -1.0


def test_a_chain_that_is_hardly_longer_is_hardly_bent():
    angles = hanging_angles(10, 1.0, 10.0 * (1 - 1e-6), 0.0)
    assert np.abs(angles).max() < 0.01
    assert angles[0] < -1e-4
