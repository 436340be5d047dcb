"""The endless plane."""

import math

import pytest
from hypothesis import given, settings

import osgode as oo
from tests.strategies import directions, floats, vectors


@given(directions(), floats(-5, 5), vectors(10))
@settings(max_examples=50)
def test_what_is_below_the_plane_is_in_it(normal, offset, point):
    """A small sphere touches iff normal . p - offset < radius, and the contact's normal is the plane's."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    plane = space.attach(oo.Plane(normal, offset))
    assert plane.normal == pytest.approx(tuple(normal.normalized()))
    body = space.attach(oo.Body(position=point))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.1))
    height = plane.normal.dot(point) - offset
    world.step()
    if abs(height - 0.1) < 1e-9:
        return
    assert len(world.contacts) == (height < 0.1)
    for row in world.contacts:
        sign = 1 if world.geom_of_slot(row["slot2"]) is plane else -1
        assert tuple(sign * row["geom"]["normal"][:3]) == pytest.approx(tuple(plane.normal), abs=1e-9)
        assert row["geom"]["depth"] == pytest.approx(0.1 - height, abs=1e-9)


def test_a_plane_has_no_volume_and_stands_in_no_body():
    plane = oo.Plane(name="it")
    with pytest.raises(oo.FieldError, match="no volume"):
        _ = plane.part_mass
    with pytest.raises(oo.TreeError, match=r"Plane 'it'.*may stand under Space"):
        oo.Placeable().attach(plane)
    plane.mass = 0
    assert plane.part_mass is None


def test_normal_and_offset_are_set_apart():
    world = oo.World()
    plane = world.attach(oo.HashSpace()).attach(oo.Plane((0, 1, 0), 2.5))
    plane.normal = (3, 0, 4)
    assert plane.normal == pytest.approx((0.6, 0, 0.8))
    assert plane.offset == pytest.approx(2.5)
    plane.offset = -1.0
    assert plane.normal == pytest.approx((0.6, 0, 0.8))
    assert plane.offset == -1.0


@pytest.mark.parametrize("normal", [(0, 0, 0), (math.nan, 0, 1), (1e-320, 0, 0), (0, 1), None, "up"])
def test_a_normal_that_points_nowhere_is_refused(normal):
    """ODE takes +x instead, silently."""
    with pytest.raises(oo.FieldError, match=r"Plane 'it'\.normal is .*must be a direction"):
        oo.Plane(normal, name="it")


def test_planes_meet_no_planes():
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane())
    space.attach(oo.Plane((1, 0, 0)))
    world.step()
    assert len(world.contacts) == 0
