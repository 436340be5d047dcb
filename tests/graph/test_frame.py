"""The parts of a picture's description that people write themselves: sun and sky."""

import math

import pytest

from osgode.errors import FieldError
from osgode.graph.appearance import Appearance
from osgode.graph.frame import Sky, Sun
from osgode.graph.particles import Particles
from osgode.maths import Vec3


def test_the_sun_shines_along_any_three_numbers():
    """As everywhere else a tuple will do, of any length."""
    sun = Sun(direction=(0, -3, -4), colour=[2, 1, 0])
    assert sun.direction.distance(Vec3(0, -0.6, -0.8)) < 1e-15
    assert sun.colour == (2.0, 1.0, 0.0)
    assert Sun(direction=Vec3(0, -2, 0)) == Sun(direction=(0, -1, 0))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sun(direction=(0, 0, 0)), "Sun.direction is .*not all 0"),
        (lambda: Sun(direction=(math.nan, 0, 0)), "Sun.direction"),
        (lambda: Sun(direction=3), "Sun.direction is 3"),
        (lambda: Sun(colour="red"), "Sun.colour is 'red'; it must be three finite numbers, 0 or more"),
        (lambda: Sun(ambient=(1, -1, 0)), "Sun.ambient"),
        (lambda: Sun(shadows="no"), "Sun.shadows.*True or False"),
        (lambda: Sky(zenith=(1, 1)), "Sky.zenith"),
        (lambda: Sky(horizon=(math.inf, 0, 0)), "Sky.horizon"),
        (lambda: Sky(haze=0), "Sky.haze"),
        (lambda: Appearance(colour=3), "Appearance.colour is 3; it must be 3 or 4 numbers"),
        (lambda: Appearance(colour="red"), "Appearance.colour is 'red'"),
        (lambda: Particles(3), "Particles.spray is 3; it must be a Spray"),
    ],
)
def test_what_can_not_be_drawn_is_refused_when_it_is_made(make, message):
    with pytest.raises(FieldError, match=message):
        make()
