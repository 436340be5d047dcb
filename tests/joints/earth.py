"""Worlds with gravity, and weights, for joints to bear."""

import pytest

import osgode as oo

G = 9.81
H = 1 / 120


def earth(**fields):
    return oo.World(**{"gravity": (0, -G, 0), "solver": "exact", "step_size": H} | fields)


def block(world, mass=2.0, at=(0, 0, 0), off=(0, 0, 0), name=""):
    """A cube whose origin is at a point and whose centre of mass is off it."""
    body = world.attach(oo.Body(position=at, name=name))
    body.fixed_mass = oo.Mass.box((0.5, 0.5, 0.5), mass=mass).translated(off)
    return body


def near(value, tolerance=1e-5):
    return pytest.approx(value, abs=tolerance)
