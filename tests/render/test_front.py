"""What is drawn in front of everything, as marks on things are."""

import numpy as np

from osgode.graph.appearance import Appearance
from osgode.graph.frame import Frame, Rectangle, View
from osgode.maths import Quat
from tests.render.scenes import BLUE, CLEAR, GREEN, RED, SIZE, many, place, quad, unlit

WALL = many(quad(), unlit(GREEN), place((0, 0, -3)))


def mark(colour, z):
    """A small square at a depth, seen through everything."""
    return many(quad(width=0.5, height=0.5), Appearance(colour, unlit=True, in_front=True), place((0, 0, z)))


def shot(drawer, **parts):
    drawer.draw(Frame(View(), SIZE, sky=CLEAR, **parts))
    return drawer.image()


def test_it_is_seen_through_what_is_nearer(drawer):
    image = shot(drawer, opaque=[WALL], front=[mark(RED, -5)])
    assert image[50, 80].tolist() == [255, 0, 0]
    assert image[50, 100].tolist() == [0, 255, 0]


def test_it_is_seen_through_what_is_transparent(drawer):
    """Nothing of the glass before it is blended over it."""
    glass = many(quad(), unlit((0, 1, 0, 0.5)), place((0, 0, -3)))
    assert shot(drawer, transparent=[glass], front=[mark(RED, -5)])[50, 80].tolist() == [255, 0, 0]


def test_among_each_other_the_nearer_hides_the_farther(drawer):
    for bins in ([mark(RED, -4), mark(BLUE, -5)], [mark(BLUE, -5), mark(RED, -4)]):
        assert shot(drawer, opaque=[WALL], front=bins)[50, 80].tolist() == [255, 0, 0]


def test_a_transparent_one_is_blended_over_the_others(drawer):
    image = shot(drawer, opaque=[WALL], front=[mark(RED, -5), mark((0, 0, 1, 0.5), -4)])
    assert np.abs(image[50, 80].astype(int) - (128, 0, 128)).max() <= 1


def test_the_sky_and_what_comes_after_are_unharmed(drawer):
    """Its clearing of depths touches no colour, and colours are written again in this frame and the next."""
    plain = shot(drawer, opaque=[WALL])
    overlay = [Rectangle(0, 0, 20, 20, (0, 0, 1, 1))]
    with_marks = shot(drawer, opaque=[WALL], front=[mark(RED, -5)], overlay=overlay)
    assert with_marks[10, 10].tolist() == [0, 0, 255]
    assert np.array_equal(with_marks[30, 30:60], plain[30, 30:60])
    assert np.array_equal(shot(drawer, opaque=[WALL]), plain)


def test_it_lies_in_no_shadow(drawer):
    """Lit, but not through the shadow map: a roof over it makes no difference."""
    lit = many(quad(width=0.5, height=0.5), Appearance((0.8, 0.1, 0.1), in_front=True), place((0, 0, -5)))
    roof = many(quad(width=9, height=9), Appearance(), place((0, 3, -5), Quat.from_axis_angle((1, 0, 0), -np.pi / 2)))
    open_air = shot(drawer, front=[lit])[50, 80]
    assert np.array_equal(shot(drawer, front=[lit], casters=[roof])[50, 80], open_air)
