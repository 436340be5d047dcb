"""Geoms made of triangles: where they come from, what they share, and what they weigh."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.graph.primitives import box_mesh
from tests.strategies import CUBE


def live_meshes():
    return oo.live_natives().meshes


def test_triangles_come_from_anything_that_has_them():
    data = oo.MeshData(*CUBE)
    mesh = oo.Mesh(np.array(CUBE[0], np.float32), np.array(CUBE[1], np.uint32), name="cube")
    model = oo.Model("cube", (oo.Drawable(mesh),), data.vertices, data.triangles)
    for source in (data, mesh, CUBE, box_mesh((1, 1, 1)), model):
        geom = oo.Trimesh(source)
        assert len(geom.data.triangles) == 12
        assert geom._shape_mass(density=3.0).mass == pytest.approx(3.0, rel=1e-6)
    assert oo.Trimesh(data).data is data
    assert oo.Trimesh(model).drawables() == model.drawables
    assert oo.Trimesh(model, appearance=oo.Appearance((1, 0, 0, 1))).drawables()[0].appearance.colour == (1, 0, 0, 1)


@pytest.mark.parametrize("source", [None, 5, "cube", (1, 2, 3), [], object(), ((), ())])
def test_what_has_no_triangles_is_refused(source):
    with pytest.raises(oo.ModelError):
        oo.Trimesh(source, name="it")


def test_geoms_share_one_native_mesh():
    """In one World; it goes with the last of them. Another World has its own."""
    world, other = oo.World(), oo.World()
    space = world.attach(oo.SimpleSpace())
    data = oo.MeshData(*CUBE)
    geoms = [space.attach(oo.Trimesh(data)) for _ in range(3)]
    assert live_meshes() == 1
    alien = other.attach(oo.SimpleSpace()).attach(oo.Trimesh(data))
    assert live_meshes() == 2
    for left, geom in zip((2, 2, 1), geoms, strict=True):
        space.detach(geom)
        assert live_meshes() == left
    space.attach(geoms[0])
    assert live_meshes() == 2
    alien.parent.detach(alien)
    assert live_meshes() == 1


def test_a_copy_shares_the_data():
    geom = oo.Trimesh(CUBE, mass=3.0)
    assert geom.copy().data is geom.data
    assert geom.copy().mass == 3.0


def test_the_data_is_the_librarys_business():
    """The arrays it was made of may go; so may every reference to the data."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)

    def build():
        vertices, triangles = np.array(CUBE[0]) * 2, np.array(CUBE[1])
        space.attach(oo.Trimesh((vertices, triangles)))
        vertices[:] = math.nan
        triangles[:] = 99

    build()
    ball = space.attach(oo.Body(position=(0, 1.2, 0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    world.step()
    assert len(world.contacts)
    assert world.contacts["geom"]["depth"].max() == pytest.approx(0.3)


@pytest.mark.parametrize("parts", [{"mass": 6.0}, {"density": 6.0}])
def test_a_mesh_weighs_what_its_primitive_weighs(parts):
    """The cube as a mesh and the cube as a box are the same body."""
    masses = []
    for geom in (oo.Trimesh(CUBE, **parts), oo.Box((1, 1, 1), **parts)):
        body = oo.Body()
        body.attach(oo.Placeable(position=(1, 2, 3), rotation=oo.Quat.from_axis_angle((1, 2, 3), 1))).attach(geom)
        masses.append(body.mass_properties)
    assert masses[0].mass == pytest.approx(masses[1].mass)
    assert tuple(masses[0].centre) == pytest.approx(tuple(masses[1].centre))
    assert np.array(masses[0].inertia) == pytest.approx(np.array(masses[1].inertia), abs=1e-9)


@pytest.mark.parametrize("triangles", [CUBE[1][1:], [(a, c, b) for a, b, c in CUBE[1]]], ids=["open", "inside out"])
def test_what_encloses_nothing_has_no_mass_but_may_be_static(triangles):
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    geom = space.attach(oo.Trimesh((CUBE[0], triangles), name="it"))
    assert geom.is_live
    space.detach(geom)
    body = space.attach(oo.Body())
    place = body.attach(oo.Placeable())
    with pytest.raises(oo.FieldError, match=r"Trimesh 'it' has no usable mass.*mass=0 makes it weightless"):
        place.attach(geom)
    assert body.geoms == ()
    geom.mass = 0
    place.attach(geom)
    assert body.mass == 1.0


def test_two_triangles_in_one_world_may_be_of_one_data_in_two_spaces_of_any_kind():
    world = oo.World()
    data = oo.MeshData(*CUBE)
    for cls in (oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace):
        space = world.attach(cls())
        world.collide(space)
        space.attach(oo.Placeable()).attach(oo.Trimesh(data))
        body = space.attach(oo.Body(position=(0, 0.9, 0)))
        body.attach(oo.Placeable()).attach(oo.Trimesh(data, density=10.0))
    world.step(20)
    assert live_meshes() == 1
