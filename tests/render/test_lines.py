"""Lines in the picture: where they are, how wide, what hides them, and what they cost."""

import math

import numpy as np
import pytest

from osgode.errors import FieldError
from osgode.graph.frame import Frame, Lines, Sky, Sun, View
from osgode.maths import Pose, Quat, Vec3
from tests.render.scenes import BLUE, GREEN, SIZE, many, place, quad, unlit

NIGHT = {"sky": Sky((0, 0, 0), (0, 0, 0), None), "sun": Sun(colour=(0, 0, 0))}
RED, RED_TOO = np.array([255, 0, 0, 255], np.uint8), (1.0, 0.0, 0.0, 1.0)
HALF_HEIGHT = math.tan(0.5)
"""Of the default View at distance 1: its field of view is 1 radian."""


def shot(drawer, *lines, view=View(), **parts):  # noqa: B008 - never changed
    drawer.draw(Frame(view, SIZE, lines=list(lines), **NIGHT, **parts))
    return drawer.image().astype(int)


def level(z, *, y=0.0, x=(-50.0, 50.0), colour=RED, **fields):
    """A line from left to right."""
    return Lines([[(x[0], y, z), (x[1], y, z)]], colour, **fields)


@pytest.mark.parametrize("width", [1.0, 2.0, 5.0])
@pytest.mark.parametrize("z", [-2.0, -200.0])
def test_its_width_is_in_pixels_at_any_distance(drawer, z, width):
    """Down a column of the picture the light adds up to the width."""
    image = shot(drawer, level(z, x=(-1000.0, 1000.0), width=width))
    assert np.abs(image[:, 10:150, 0].sum(axis=0) / 255 - width).max() < 0.05
    assert (image[..., 1:] == 0).all()


def test_a_slanting_line_is_as_wide(drawer):
    """Its light is its length times its width, whichever way it runs."""
    ends = np.array([[(-0.5, -0.4, -2.0), (0.5, 0.4, -2.0)]])
    image = shot(drawer, Lines(ends, RED, width=2.0))
    pixels = 100 / (2 * 2.0 * HALF_HEIGHT)  # to a metre, at 2 m
    expected = (math.hypot(1.0, 0.8) * pixels + 2.0) * 2.0  # and half a width beyond each end
    assert image[..., 0].sum() / 255 == pytest.approx(expected, rel=0.05)


def test_it_is_where_its_ends_are(drawer):
    """A point at height y and depth z is seen y / (z tan(fov / 2)) half heights above the middle."""
    image = shot(drawer, level(-4.0, y=1.0, x=(-1.0, 0.0), width=1.0))
    rows, columns = np.nonzero(image[..., 0] > 60)
    assert rows.mean() + 0.5 == pytest.approx(50 - 50 / (4 * HALF_HEIGHT), abs=0.6)
    assert columns.min() == pytest.approx(80 - 50 / (4 * HALF_HEIGHT), abs=1.5)
    assert columns.max() == pytest.approx(80, abs=1.5)


def test_what_is_behind_the_eye_is_cut_off(drawer):
    """A line from behind the eye to before it goes from the edge of the picture to its end, and is not mirrored."""
    image = shot(drawer, Lines([[(0.0, -1.0, 5.0), (0.0, -1.0, -5.0)]], RED, width=2.0))
    end = 50 + 50 / (5 * HALF_HEIGHT)
    rows, columns = np.nonzero(image[..., 0] > 60)
    assert rows.max() == 99
    assert rows.min() == pytest.approx(end, abs=1.5)
    assert abs(columns - 79.5).max() <= 1.5
    assert not shot(drawer, Lines([[(0.0, -1.0, 5.0), (1.0, 1.0, 1.0)]], RED)).any()


def test_the_camera_moves_them(drawer):
    """Seen from behind and upside down, what was above on the left is above on the left again."""
    turned = View(Pose(Vec3(0, 0, -8), Quat.from_axis_angle((1, 0, 0), math.pi)))
    image = shot(drawer, Lines([[(-1.0, -1.0, -4.0), (-0.5, -1.0, -4.0)]], RED), view=turned)
    rows, columns = np.nonzero(image[..., 0] > 60)
    assert rows.max() < 50
    assert columns.max() < 80


def test_things_hide_them_unless_they_are_in_front(drawer):
    wall = many(quad(), unlit(GREEN), place((0, 0, -3)))
    assert shot(drawer, level(-5.0, width=3.0), opaque=[wall])[50, 80].tolist() == [0, 255, 0]
    assert shot(drawer, level(-2.5, width=3.0), opaque=[wall])[50, 80].tolist() == [255, 0, 0]
    assert shot(drawer, level(-5.0, width=3.0, in_front=True), opaque=[wall])[50, 80].tolist() == [255, 0, 0]


@pytest.mark.parametrize("turn", [0.0, 0.7, 1.3])
def test_a_line_on_a_surface_is_seen_whole(drawer, turn):
    """Nothing flickers between the two, however the surface slopes."""
    rotation = Quat.from_axis_angle((1, 0, 0), turn)
    floor = many(quad(width=40, height=40), unlit(GREEN), place((0, 0, -20), rotation))
    image = shot(drawer, level(-20.0, x=(-15.0, 15.0), width=3.0), opaque=[floor])
    assert (image[49:51, 60:100, 0] == 255).all()


def test_opacity_blends_numbers(drawer):
    half = np.array([255, 0, 0, 128], np.uint8)
    wall = many(quad(width=9, height=9), unlit(GREEN), place((0, 0, -3)))
    image = shot(drawer, level(-2.0, width=4.0, colour=half), opaque=[wall])
    assert np.abs(image[50, 80] - [128, 127, 0]).max() <= 1


def test_the_later_is_drawn_over_the_earlier(drawer):
    """Within one Lines and among several, whatever is nearer."""
    ends = [[(-5, 0, z), (5, 0, z)] for z in (-2.0, -4.0)]
    blue = (0, 0, 255, 255)
    assert shot(drawer, Lines(ends, np.array([RED, blue], np.uint8), width=3.0))[50, 80].tolist() == [0, 0, 255]
    both = [level(-4.0, width=3.0), level(-2.0, width=3.0, colour=np.array(blue, np.uint8))]
    assert shot(drawer, *both)[50, 80].tolist() == [0, 0, 255]
    assert shot(drawer, *both[::-1])[50, 80].tolist() == [255, 0, 0]


def test_each_lines_is_one_draw_and_none_is_free(drawer):
    shot(drawer)
    draws = drawer.counts.draws
    shot(drawer, Lines(np.zeros((0, 2, 3)), RED))
    assert drawer.counts.draws == draws
    many_lines = np.random.default_rng(1).normal(size=(5000, 2, 3))
    shot(drawer, Lines(many_lines, RED), level(-2.0, in_front=True))
    assert drawer.counts.draws == draws + 2


def test_what_comes_after_is_unharmed(drawer):
    """Depth is cleared and written for what is in front, and the next frame is as it was."""
    wall = many(quad(), unlit(GREEN), place((0, 0, -3)))
    near, far = (many(quad(width=0.3, height=0.3), unlit(c), place((0, 0, z))) for c, z in ((BLUE, -5), (RED_TOO, -6)))
    plain = shot(drawer, opaque=[wall])
    with_lines = shot(drawer, level(-2.0), level(-2.0, in_front=True), opaque=[wall], front=[near, far])
    assert with_lines[48, 80].tolist() == [0, 0, 255]
    assert np.array_equal(with_lines[:40], plain[:40])
    assert np.array_equal(shot(drawer, opaque=[wall]), plain)


def test_more_lines_than_before_find_room(drawer):
    """The buffers grow; a picture with few lines after one with many shows the few."""
    few = level(-3.0, width=3.0)
    first = shot(drawer, few)
    shot(drawer, Lines(np.tile(few.points, (9000, 1, 1)), RED))
    assert np.array_equal(shot(drawer, few), first)


@pytest.mark.parametrize(
    ("points", "colours", "words"),
    [
        (np.zeros((3, 3)), RED, "points has shape"),
        (np.full((1, 2, 3), np.nan), RED, "not finite"),
        (np.zeros((2, 2, 3)), np.zeros((3, 4)), "colours has shape"),
        (np.zeros((2, 2, 3)), np.full(4, 2.0), "0 to 1"),
        (np.zeros((2, 2, 3)), np.full(4, -1), "0 to 1"),
        (np.zeros((2, 2, 3)), np.full(4, np.nan), "0 to 1"),
        (np.zeros((2, 2, 3)), np.array(["red"] * 4), "has type"),
    ],
)
def test_lines_that_cannot_be(points, colours, words):
    with pytest.raises(FieldError, match=words):
        Lines(points, colours)


@pytest.mark.parametrize("width", [0.0, -1.0, math.nan, math.inf])
def test_widths_that_cannot_be(width):
    with pytest.raises(FieldError, match="width"):
        Lines(np.zeros((1, 2, 3)), RED, width=width)


def test_colours_may_be_numbers_from_0_to_1():
    lines = Lines(np.zeros((2, 2, 3)), (1.0, 0.5, 0.0, 1.0))
    assert lines.colours.tolist() == [[255, 128, 0, 255]] * 2
    assert len(lines) == 2
