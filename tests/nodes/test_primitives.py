"""Boxes, spheres, capsules and cylinders: how big they are, in ODE, in mass and in the picture."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

import osgode as oo
from tests.strategies import rotations, sizes

EXTENT = {
    oo.Box: lambda geom: geom.size / 2,
    oo.Sphere: lambda geom: (geom.radius,) * 3,
    oo.Capsule: lambda geom: (geom.radius, geom.radius, geom.length / 2 + geom.radius),
    oo.Cylinder: lambda geom: (geom.radius, geom.radius, geom.length / 2),
}
VOLUME = {
    oo.Box: lambda geom: math.prod(geom.size),
    oo.Sphere: lambda geom: 4 / 3 * math.pi * geom.radius**3,
    oo.Capsule: lambda geom: math.pi * geom.radius**2 * (geom.length + 4 / 3 * geom.radius),
    oo.Cylinder: lambda geom: math.pi * geom.radius**2 * geom.length,
}
SHAPES = list(EXTENT)


def made(cls, a, b, c):
    return {
        oo.Box: lambda: oo.Box((a, b, c)),
        oo.Sphere: lambda: oo.Sphere(a),
        oo.Capsule: lambda: oo.Capsule(a, b),
        oo.Cylinder: lambda: oo.Cylinder(a, b),
    }[cls]()


@pytest.mark.parametrize("cls", SHAPES)
@given(a=sizes(), b=sizes(), c=sizes(), d=sizes())
@settings(max_examples=25)
def test_a_shape_is_as_big_as_it_says(cls, a, b, c, d):
    """Its box in ODE, when made and after each size has been changed, with the long axis along z."""
    world = oo.World()
    geom = world.attach(oo.SimpleSpace()).attach(made(cls, a, b, c))
    for _ in range(2):
        low, high = geom.bounds
        assert tuple(high) == pytest.approx(tuple(EXTENT[cls](geom)))
        assert tuple(low) == pytest.approx(tuple(-v for v in EXTENT[cls](geom)))
        for name, value in (("radius", c), ("length", d), ("size", (d, a, c))):
            if name in cls.FIELDS:
                setattr(geom, name, value)
                assert getattr(geom, name) == value


@pytest.mark.parametrize("cls", SHAPES)
@given(a=sizes(), b=sizes(), c=sizes(), turn=rotations())
@settings(max_examples=25)
def test_bounds_hold_the_turned_shape(cls, a, b, c, turn):
    world = oo.World()
    place = world.attach(oo.SimpleSpace()).attach(oo.Placeable(position=(1, 2, 3), rotation=turn))
    geom = place.attach(made(cls, a, b, c))
    low, high = geom.bounds
    assert tuple((low + high) / 2) == pytest.approx((1, 2, 3))
    reach = oo.Vec3(*EXTENT[cls](geom)).length
    assert all(extent <= 2 * reach + 1e-9 for extent in high - low)
    for sign in (-1, 1):
        tip = place.pose.transform((0, 0, sign * EXTENT[cls](geom)[2]))
        assert all(a - 1e-9 <= p <= b + 1e-9 for a, p, b in zip(low, tip, high, strict=True))


@pytest.mark.parametrize("cls", SHAPES)
def test_the_mass_follows_the_size(cls):
    world = oo.World()
    body = world.attach(oo.Body())
    geom = body.attach(oo.Placeable()).attach(made(cls, 0.5, 1.5, 0.75))
    geom.density = 7.0
    assert body.mass == pytest.approx(7.0 * VOLUME[cls](geom))
    name = "size" if cls is oo.Box else "radius"
    setattr(geom, name, (1, 2, 3) if cls is oo.Box else 1.25)
    assert body.mass == pytest.approx(7.0 * VOLUME[cls](geom))
    geom.density = None
    geom.mass = 2.0
    before = body.inertia
    setattr(geom, name, (2, 4, 6) if cls is oo.Box else 2.5)
    assert body.mass == 2.0
    assert body.inertia[0, 0] > before[0, 0]


@pytest.mark.parametrize("cls", SHAPES)
def test_the_picture_follows_the_size(cls):
    """The drawable is made anew, and what is above is told that it has changed."""
    world = oo.World()
    geom = world.attach(oo.SimpleSpace()).attach(made(cls, 0.5, 1.5, 0.75))
    before = geom.drawables()
    assert geom.drawables() is before
    revision = world._revision
    name = "size" if cls is oo.Box else "radius"
    setattr(geom, name, (1, 2, 3) if cls is oo.Box else 1.25)
    assert world._revision > revision
    (drawable,) = geom.drawables()
    assert drawable is not before[0]
    matrix = np.identity(4) if drawable.matrix is None else drawable.matrix
    corners = drawable.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    assert tuple(corners.max(axis=0)) == pytest.approx(tuple(EXTENT[cls](geom)), rel=0.02)


@pytest.mark.parametrize("cls", SHAPES)
@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, 1e-320, 1e300, None, "big", (1, 2, 3, 4)], ids=str)
def test_a_size_that_ode_aborts_at_is_refused(cls, bad):
    """When it is made, and while it is simulated."""
    with pytest.raises(oo.FieldError, match=rf"{cls.__name__}\.\w+ is .*must be"):
        made(cls, bad, 1, 1)
    if cls is not oo.Sphere:
        with pytest.raises(oo.FieldError, match=rf"{cls.__name__}\.\w+ is .*must be"):
            made(cls, 1, bad, 1)
    world = oo.World()
    geom = world.attach(oo.SimpleSpace()).attach(made(cls, 1, 2, 3))
    before = geom.bounds
    for name in ("radius", "length", "size"):
        if name in cls.FIELDS:
            with pytest.raises(oo.FieldError, match=rf"{cls.__name__}\.{name} is"):
                setattr(geom, name, bad)
    assert geom.bounds == before


@pytest.mark.parametrize("cls", SHAPES)
@pytest.mark.parametrize("other", SHAPES)
def test_every_shape_meets_every_other(cls, other):
    """At the smallest and the largest size that are allowed nothing aborts."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    for i, (a, b) in enumerate([(1, 1), (1e-6, 1), (1e-6, 1e-6), (1e7, 1), (1e7, 1e7), (1e7, 1e-6)]):
        for shape, size in ((cls, a), (other, b)):
            body = space.attach(oo.Body(position=(i * 0.3, 0.1, 0)))
            geom = made(shape, size, size, size)
            geom.mass = 0.0
            body.attach(oo.Placeable()).attach(geom)
    world.step(2)
    for body in world.bodies:
        assert all(map(math.isfinite, body.position))
