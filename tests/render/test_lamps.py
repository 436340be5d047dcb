"""Lamps in pictures, against the formula of `Light`."""

import math

import numpy as np
import pytest

from osgode.graph.appearance import Appearance
from osgode.graph.frame import MAX_LIGHTS, Frame, Light, Sun, View
from osgode.maths import Pose, Vec3
from osgode.render.renderer import linear
from tests.render.scenes import CLEAR, SIZE, many, place, quad, unlit

DARK = Sun(colour=(0, 0, 0), ambient=(0, 0, 0))
MATT = Appearance((1, 1, 1), shininess=0.0)
WALL = many(quad(width=8, height=8), MATT, place((0, 0, -4)))
VIEW = View(Pose(), field_of_view=math.pi / 2)
"""Which sees 4 m up and down on the wall, and so 8 cm in a pixel of the picture."""


def shot(drawer, *lights, sun=DARK, bins=(WALL,)):
    drawer.draw(Frame(VIEW, SIZE, list(bins), sky=CLEAR, sun=sun, lights=list(lights)))
    return drawer.image()


def light_at(image, x, y):
    """The light that a point of the wall throws back, by the colour there, where it is below the bend at 0.8."""
    row, column = 50 - y / 0.08, 80 + x / 0.08
    return linear(tuple(image[int(row), int(column)] / 255.0))


def spot(x, y):
    """The point of the wall in the middle of the pixel that shows (x, y)."""
    return (math.floor(x / 0.08) + 0.5) * 0.08, (math.ceil(y / 0.08) - 0.5) * 0.08


@pytest.mark.parametrize(("x", "y"), [(0.0, 0.0), (1.0, 0.5), (-2.0, 1.0), (0.3, -2.5), (3.9, 3.9)])
def test_a_lamp_lights_by_distance_and_angle(drawer, x, y):
    """What arrives at the wall is the colour, times the fading by distance, times the cosine."""
    lamp = Light(Vec3(0.5, 0.25, -2.5), (0.7, 0.35, 0.1), 4.0)
    seen = light_at(shot(drawer, lamp), x, y)
    way = np.array(lamp.position) - (*spot(x, y), -4.0)
    distance = np.linalg.norm(way)
    share = max(0.0, 1 - (distance / lamp.reach) ** 2) ** 2 * way[2] / distance
    assert seen == pytest.approx([share * part for part in lamp.colour], abs=0.01)


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.2, 0.28, 0.35, 0.5])
def test_a_cone_ends_at_its_angle(drawer, angle):
    """Full inside of the inner angle, nothing outside of the outer one, between them straight over the cosine."""
    lamp = Light(Vec3(0, 0, 0), (0.7, 0.7, 0.7), 100.0, Vec3(0, 0, -1), outer=0.4, inner=0.2)
    x, y = spot(4 * math.tan(angle), 0)
    true = math.atan(math.hypot(x, y) / 4)
    cone = (math.cos(true) - math.cos(0.4)) / (math.cos(0.2) - math.cos(0.4))
    fade = (1 - (4 / math.cos(true) / 100) ** 2) ** 2
    expected = 0.7 * min(max(cone, 0.0), 1.0) * math.cos(true) * fade
    assert light_at(shot(drawer, lamp), 4 * math.tan(angle), 0)[0] == pytest.approx(expected, abs=0.012)


def test_lights_add_up_however_many(drawer):
    """Each number of lamps has a shader that counts them all, and no more than are there; those above 8 are left."""
    lamps = [Light(Vec3(0.02 * k, 0, -3), (0.06, 0, 0), 50.0) for k in range(MAX_LIGHTS + 2)]
    one = light_at(shot(drawer, lamps[0]), 0, 0)[0]
    for count in range(MAX_LIGHTS + 3):
        seen = light_at(shot(drawer, *lamps[:count]), 0, 0)[0]
        assert seen == pytest.approx(one * min(count, MAX_LIGHTS), abs=0.012)


def test_light_falls_on_one_side_only(drawer):
    """A lamp behind the wall doesn't shine through it."""
    assert not shot(drawer, Light(Vec3(0, 0, -5), (1, 1, 1), 10.0)).any(axis=2)[40:60, 60:100].any()


def test_polished_things_shine_back(drawer):
    """A highlight where the mirror image of the lamp is, none on matt things, and unlit ones stay as they are."""
    lamp = Light(Vec3(0, 0, -1), (0.3, 0.3, 0.3), 20.0)
    pictures = [
        shot(drawer, lamp, bins=[many(quad(width=8, height=8), look, place((0, 0, -4)))])
        for look in (MATT, Appearance((1, 1, 1), shininess=0.5), unlit((0.2, 0.4, 0.6, 1)))
    ]
    matt, shiny, plain = (image[50, 80].astype(int) for image in pictures)
    assert (shiny > matt + 20).all()
    assert (pictures[1][50, 140] <= pictures[0][50, 140] + 2).all()
    assert plain.tolist() == [51, 102, 153]


def test_no_lamps_no_change(drawer):
    """A frame after one with lamps is as it was before."""
    before = shot(drawer, sun=Sun())
    shot(drawer, Light(Vec3(0, 0, -3), (1, 0, 0), 5.0), sun=Sun())
    assert (shot(drawer, sun=Sun()) == before).all()
