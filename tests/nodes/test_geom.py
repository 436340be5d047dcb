"""What all geoms have in common: what meets what, being switched off, how they look."""

import itertools

import numpy as np
import pytest

import osgode as oo
from osgode import materials
from osgode.graph.primitives import box_mesh
from tests.strategies import CUBE


@pytest.fixture
def kinds(monkeypatch):
    monkeypatch.setattr(materials, "_kinds", {"default": 0, "player": 1, "shot": 2, "wall": 3})


def pair(first, second, *, static=False):
    """Two geoms in one place, in bodies of their own (or the second static), and whether they touch."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Body()).attach(oo.Placeable()).attach(first)
    home = space if static else space.attach(oo.Body())
    home.attach(oo.Placeable(position=(0.1, 0, 0))).attach(second)
    return world


def touches(world):
    world.step()
    return len(world.contacts) > 0


KINDS = (None, (), ("player",), ("shot", "wall"))


@pytest.mark.parametrize(("kind", "other_kind"), list(itertools.product(["player", "shot"], repeat=2)))
def test_two_geoms_meet_if_each_is_what_the_other_meets(kinds, kind, other_kind):
    for mine, others in itertools.product(KINDS, repeat=2):
        world = pair(
            oo.Sphere(kind=kind, collides_with=mine, material="wood"),
            oo.Sphere(kind=other_kind, collides_with=others, material="steel"),
        )
        expected = (mine is None or other_kind in mine) and (others is None or kind in others)
        assert touches(world) == expected


def test_what_meets_what_can_change_while_simulated(kinds):
    ball = oo.Sphere(kind="player")
    world = pair(ball, oo.Sphere(kind="wall"))
    assert touches(world)
    ball.collides_with = "shot"
    assert not touches(world)
    ball.collides_with = None
    assert touches(world)
    ball.enabled = False
    assert not touches(world)
    ball.enabled = True
    assert touches(world)


def test_static_things_meet_no_static_things_and_parts_no_parts():
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    for _ in range(2):
        space.attach(oo.Placeable()).attach(oo.Box())
    assert not touches(world)
    body = space.attach(oo.Body(position=(10, 0, 0)))
    for _ in range(2):
        body.attach(oo.Placeable()).attach(oo.Box())
    assert not touches(world)
    body.position = (0, 0, 0)
    assert touches(world)


def test_bodies_that_a_joint_holds_do_not_meet():
    first, second = oo.Sphere(), oo.Sphere()
    world = pair(first, second)
    assert touches(world)
    joint = oo.Ball(first.body, second.body)
    assert not touches(world)
    joint.release()
    assert touches(world)


def test_contacts_per_pair_are_limited():
    for limit in (1, 2, 3, 4):
        world = pair(oo.Box((1, 1, 1)), oo.Box((4, 1, 4)), static=True)
        world.contacts_per_pair = limit
        world.bodies[0].position = (0, 0.9, 0)
        world.step()
        assert len(world.contacts) == limit


def test_two_cylinders_touch_alike_in_either_order():
    """ODE's depth depends on which of the two comes first (by 0.0002 m here); so they are always taken in one order."""

    def depths(swap):
        world = oo.World(gravity=(0, 0, 0))
        space, other = world.attach(oo.SimpleSpace()), world.attach(oo.SimpleSpace())
        world.collide(space)
        turn = oo.Quat.from_axis_angle((0.6, -0.17, -0.65), 1.646)
        bodies = [oo.Body(), oo.Body(position=(0.16, -0.838, -0.463), rotation=turn)]
        for body, size in zip(bodies, ((0.481, 0.94), (0.35, 0.751)), strict=True):
            body.attach(oo.Placeable()).attach(oo.Cylinder(*size))
            space.attach(body)
        if swap:
            bodies[0].move_to(other)
            bodies[0].move_to(space)
        world.step()
        return sorted(world.contacts["geom"]["depth"].tolist())

    assert depths(False) == depths(True)
    assert depths(False)


def test_contacts_that_are_no_numbers_are_dropped():
    """ODE gives a NaN normal for a sphere centred on a cylinder's axis, which would spread through the solver."""
    world = pair(oo.Sphere(0.5), oo.Cylinder(0.5, 1.0))
    for body in world.bodies:
        body.position = (0, 0, 0)
    world.bodies[1].children[0].position = (0, 0, 0)
    world.step(5)
    for body in world.bodies:
        assert all(abs(v) < 1e3 for v in body.position)


def test_bounds_need_a_world():
    geom = oo.Box(name="it")
    with pytest.raises(oo.StateError, match=r"Box 'it': bounds needs a World"):
        _ = geom.bounds


def test_a_geom_knows_its_body_and_its_space():
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    inner = space.attach(oo.HashSpace())
    body = inner.attach(oo.Body())
    place = body.attach(oo.Placeable())
    geom = place.attach(oo.Box())
    assert (geom.body, geom.space, place.body, place.space) == (body, inner, body, inner)
    loose = space.attach(oo.Placeable()).attach(oo.Box())
    assert (loose.body, loose.space) == (None, space)
    direct = world.attach(oo.Body()).attach(oo.Placeable()).attach(oo.Box())
    assert direct.space is None


# -- how they look


def test_a_geom_looks_like_its_material_unless_it_is_told_otherwise():
    box = oo.Box(material="wood")
    wood = box.drawables()[0].appearance
    box.material = "steel"
    assert box.drawables()[0].appearance != wood
    red = oo.Appearance((1, 0, 0, 1))
    box.appearance = red
    assert box.drawables()[0].appearance == red
    box.appearance = None
    box.material = "wood"
    assert box.drawables()[0].appearance == wood


def test_a_geom_can_show_something_else_than_its_shape():
    """A rocket collides as a capsule and looks like a rocket."""
    rocket = oo.Drawable(box_mesh((1, 2, 3)))
    capsule = oo.Capsule()
    own = capsule.drawables()[0].mesh.vertices
    for shown in (rocket, [rocket], (rocket,)):
        capsule.shown = shown
        assert capsule.drawables() == (rocket,)
    capsule.shown = ()
    assert capsule.drawables() == ()
    capsule.shown = None
    assert np.array_equal(capsule.drawables()[0].mesh.vertices, own)


@pytest.mark.parametrize(
    "geom",
    [
        *(oo.Box(), oo.Sphere(), oo.Capsule(), oo.Cylinder(), oo.Plane(), oo.Trimesh(CUBE)),
        *(oo.ConvexHull(CUBE), oo.Heightfield([[0, 1], [1, 0]]), oo.Ray()),
    ],
    ids=lambda geom: type(geom).__name__,
)
def test_every_change_of_looks_is_noted(geom):
    """What draws asks only what has changed since."""
    for name, value in (
        ("appearance", oo.Appearance((1, 0, 0, 1))),
        ("material", "ice"),
        ("shown", ()),
        ("visible", False),
    ):
        before = geom._revision
        setattr(geom, name, value)
        assert geom._revision > before, name
