"""Particles in pictures."""

import math

import numpy as np
import pytest

from osgode.graph.appearance import Appearance
from osgode.graph.frame import Frame, Sky, Sprites, Sun, View
from osgode.maths import Pose, Quat, Vec3
from osgode.render.renderer import linear
from tests.render.scenes import CLEAR, SIZE, many, place, quad, unlit

NIGHT = {"sun": Sun(colour=(0, 0, 0), ambient=(0, 0, 0)), "sky": Sky((0, 0, 0), (0, 0, 0), None)}
VIEW = View(Pose(), field_of_view=math.pi / 2)
"""At 4 m, 12.5 pixels are a metre."""


def patch(position=(0, 0, -4), radius=1.0, colour=(1.0, 0.5, 0.25, 0.8), streak=(0, 0, 0), *, additive=True):
    return Sprites(np.array([[*position, radius, *colour, *streak, 0]], np.float32), additive)


def shot(drawer, *particles, **parts):
    drawer.draw(Frame(VIEW, SIZE, particles=list(particles), **(NIGHT | parts)))
    return drawer.image().astype(int)


def at(image, x, y, depth=4.0):
    return image[int(50 - y * 50 / depth), int(80 + x * 50 / depth)]


def test_a_patch_is_soft_and_round(drawer):
    """Its opacity falls from the middle to nothing at the radius, as (1 - r^2)^2."""
    image = shot(drawer, patch())
    for x, y in ((0.0, 0.0), (0.3, 0.2), (-0.5, 0.1), (0.0, -0.7), (0.6, 0.6)):
        px, py = int(80 + x * 12.5), int(50 - y * 12.5)
        square = ((px + 0.5 - 80) ** 2 + (py + 0.5 - 50) ** 2) / 12.5**2
        share = 0.8 * max(0.0, 1 - square) ** 2
        assert image[py, px] == pytest.approx([share * 255, share * 127.5, share * 63.75], abs=4)
    assert not at(image, 1.05, 0).any()
    assert not at(image, 0.8, 0.8).any()


def test_what_shines_adds_and_what_hides_hides(drawer):
    """Over a green wall red light gives yellow; red smoke, lit fully, covers it by its opacity."""
    wall = [many(quad(width=9, height=9), unlit((0, 0.6, 0, 1)), place((0, 0, -5)))]
    colour = (1, 0, 0, 0.75)
    bright = Sun(colour=(0, 0, 0), ambient=(1 / 0.85, 1 / 0.85, 1 / 0.85))
    middle = 0.75 * (1 - 2 * (0.5 / 12.5) ** 2) ** 2
    added = at(shot(drawer, patch(colour=colour), opaque=wall), 0, 0)
    assert added == pytest.approx([255 * middle, 153, 0], abs=3)
    hidden = at(shot(drawer, patch(colour=colour, additive=False), opaque=wall, sun=bright), 0, 0)
    assert hidden == pytest.approx([255 * middle, 153 * (1 - middle), 0], abs=3)


def test_what_hides_is_lit(drawer):
    """By the ambient light, and by the sun, more on the side that it comes from."""
    smoke = patch(colour=(0.5, 0.5, 0.5, 1), additive=False)
    assert not shot(drawer, smoke).any()
    day = Sun(direction=Vec3(-1, 0, 0), colour=(1, 1, 1), ambient=(0, 0, 0))
    image = shot(drawer, smoke, sun=day)
    assert (at(image, 0.4, 0) > at(image, -0.4, 0) + 10).all()
    grey = at(shot(drawer, smoke, sun=Sun(colour=(0, 0, 0), ambient=(1, 1, 1))), 0, 0)
    expected = 0.85 * linear((0.5, 0.5, 0.5))[0]
    assert linear(tuple(grey / 255)) == pytest.approx((expected,) * 3, abs=0.02)


def test_nearer_things_hide_them_and_they_hide_nothing_after(drawer):
    """They are compared with the depths and leave none."""
    wall = [many(quad(width=1, height=1), unlit((0, 0, 1, 1)), place((0, 0, -3)))]
    image = shot(drawer, patch(), opaque=wall)
    assert at(image, 0, 0).tolist() == [0, 0, 255]
    assert at(image, 0.75, 0)[0] > 20
    both = shot(drawer, patch((0, 0, -3), colour=(0.3, 0, 0, 1)), patch((0, 0, -4), colour=(0, 0.3, 0, 1)))
    assert at(both, 0, 0) == pytest.approx([76, 76, 0], abs=3)
    mark = [many(quad(), Appearance((0, 0, 1, 1), unlit=True, in_front=True), place((0, 0, -9)))]
    assert at(shot(drawer, patch(), front=mark), 0, 0).tolist() == [0, 0, 255]
    glass = [many(quad(), Appearance((0, 0, 1, 0.5), unlit=True, in_front=True), place((0, 0, -9)))]
    assert at(shot(drawer, patch(colour=(0, 0, 0, 1)), front=glass), 0, 0) == pytest.approx([0, 0, 128], abs=2)
    again = shot(drawer, opaque=[many(quad(), unlit((0, 1, 0, 1)), place((0, 0, -5)))])
    assert at(again, 0, 0).tolist() == [0, 255, 0]


def test_a_streak_is_drawn_out_along_its_way(drawer):
    """As far as it is seen: one that flies at the eye stays round."""
    for streak, wide, high in (
        ((1, 0, 0), 0.7, 0.2),
        ((0, 1, 0), 0.2, 0.7),
        ((0, 0, 3), 0.2, 0.2),
        ((0, 0, 0), 0.2, 0.2),
    ):
        image = shot(drawer, patch(radius=0.2, colour=(1, 1, 1, 1), streak=streak))
        rows, columns = np.nonzero(image[..., 0] > 3)
        assert (columns.max() - columns.min() + 1) / 25 == pytest.approx(wide, abs=0.09)
        assert (rows.max() - rows.min() + 1) / 25 == pytest.approx(high, abs=0.09)


def test_they_face_the_camera_wherever_it_looks(drawer):
    """A patch seen from above, below or aside is as wide as high."""
    for rotation in (None, (1, 0, 0, 1.57), (1, 0, 0, -1.57), (0, 1, 0, 2.0)):
        turn = Quat(1, 0, 0, 0) if rotation is None else Quat.from_axis_angle(rotation[:3], rotation[3])
        spot = patch(turn.rotate((0, 0, -4)), colour=(1, 1, 1, 1))
        drawer.draw(Frame(View(Pose(rotation=turn), math.pi / 2), SIZE, particles=[spot], **NIGHT))
        rows, columns = np.nonzero(drawer.image()[..., 0] > 3)
        assert abs((np.ptp(rows) + 1) - (np.ptp(columns) + 1)) <= 1
        assert np.ptp(rows) + 1 == pytest.approx(24, abs=2)


def test_haze_takes_them(drawer):
    """In the distance what hides turns to the horizon's colour, and what shines goes out."""
    hazy = Sky((0.2, 0.2, 0.2), (0.2, 0.2, 0.2), 10.0)
    far = {"position": (0, 0, -40), "radius": 12.0, "colour": (1.0, 0.0, 0.0, 1.0)}
    for additive in (True, False):
        image = shot(drawer, patch(**far, additive=additive), sky=hazy)
        assert image[50, 80] == pytest.approx(image[5, 5], abs=3)


def test_close_to_the_eye_they_fade(drawer):
    image = shot(drawer, patch((0, 0, -0.3), radius=1.0))
    assert not image.any()


def test_one_call_for_each_emitter(drawer):
    """However many particles; empty ones take none, and more than ever before find room."""
    few = patch()
    crowd = Sprites(np.tile(few.rows, (3000, 1)) * np.float32(0.01), False)
    empty = Sprites(few.rows[:0])
    for particles, calls in (([few], 1), ([few, crowd, few], 3), ([few, empty], 1), ([empty], 0), ([], 0)):
        drawer.draw(Frame(VIEW, SIZE, particles=particles, sky=CLEAR))
        assert drawer.counts.draws == 1 + calls
    assert at(shot(drawer, crowd, few), 0.2, 0.2)[0] > 100
