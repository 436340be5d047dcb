"""Placing parts in a body, and geometry in the static world."""

import pytest
from hypothesis import given, settings

import osgode as oo
from osgode.native import ffi, lib
from tests.strategies import CUBE, poses


def native_pose(geom):
    out = ffi.new("dQuaternion")
    lib.dGeomGetQuaternion(geom._id, out)
    return tuple(ffi.unpack(lib.dGeomGetPosition(geom._id), 3)), tuple(out)


def assert_at(geom, pose):
    position, rotation = native_pose(geom)
    assert position == pytest.approx(tuple(pose.position), abs=1e-9)
    assert abs(sum(a * b for a, b in zip(rotation, pose.rotation, strict=True))) == pytest.approx(1.0)


@given(poses(), poses(), poses())
@settings(max_examples=60)
def test_a_part_is_placed_relative_to_its_body(body_pose, first, second):
    """In ODE it stands at body * placeable, whether that was set before, while, or after it is live."""
    world = oo.World()
    body = oo.Body(position=body_pose.position, rotation=body_pose.rotation)
    place = body.attach(oo.Placeable(position=first.position, rotation=first.rotation))
    geom = place.attach(oo.Box((1, 2, 3), mass=1.0))
    other = body.attach(oo.Placeable()).attach(oo.Sphere(mass=2.0))
    world.attach(body)
    assert_at(geom, body_pose * first)
    place.position, place.rotation = second
    assert_at(geom, body_pose * second)
    assert_at(other, body_pose)
    body.position, body.rotation = first
    assert_at(geom, first * second)
    assert geom.pose.position == pytest.approx(tuple((first * second).position), abs=1e-9)


@given(poses(), poses())
@settings(max_examples=30)
def test_static_geometry_is_placed_in_the_world(first, second):
    world = oo.World()
    space = world.attach(oo.HashSpace())
    place = space.attach(oo.Placeable(position=first.position, rotation=first.rotation))
    geoms = [place.attach(oo.Box((1, 2, 3))), place.attach(oo.Trimesh(CUBE))]
    for pose in (first, second):
        place.position, place.rotation = pose
        for geom in geoms:
            assert_at(geom, pose)
            assert geom.pose == pose or geom.pose.position == pose.position
            assert geom.body is None


def test_a_geom_straight_under_a_space_stands_at_the_origin():
    world = oo.World()
    geom = world.attach(oo.SimpleSpace()).attach(oo.Sphere(0.5))
    assert native_pose(geom)[0] == (0, 0, 0)
    assert geom.pose == oo.Pose()


def test_a_place_in_the_middle_needs_no_offset_and_one_that_went_away_comes_back():
    """With the centre of mass at the geom, ODE is spared the offset; and gets it again."""
    world = oo.World()
    body = world.attach(oo.Body(position=(1, 2, 3)))
    place = body.attach(oo.Placeable(position=(0.5, 0, 0)))
    geom = place.attach(oo.Sphere(mass=1.0))
    assert not lib.dGeomIsOffset(geom._id)
    assert native_pose(geom)[0] == (1.5, 2, 3)
    other = body.attach(oo.Placeable(position=(-1.5, 0, 0))).attach(oo.Sphere(mass=1.0))
    assert lib.dGeomIsOffset(geom._id)
    assert native_pose(geom)[0] == (1.5, 2, 3)
    other.parent.detach(other)
    assert not lib.dGeomIsOffset(geom._id)
    place.rotation = oo.Quat.from_axis_angle((0, 0, 1), 1.0)
    assert lib.dGeomIsOffset(geom._id)


def test_moving_a_static_thing_wakes_what_lies_on_it():
    """Else what sleeps on it would stay in the air."""
    world = oo.World(auto_disable=True)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    place = space.attach(oo.Placeable())
    place.attach(oo.Box((4, 1, 4)))
    body = space.attach(oo.Body(position=(0, 1, 0)))
    body.attach(oo.Placeable()).attach(oo.Box())
    world.run(2.0)
    assert not body.enabled
    place.position = (0, -1, 0)
    assert body.enabled
    world.run(1.0)
    assert body.position.y < 0.1


def test_a_place_can_be_set_while_its_body_is_elsewhere():
    """Outside of a World nothing but the record changes, and entering uses it."""
    body = oo.Body()
    place = body.attach(oo.Placeable())
    geom = place.attach(oo.Box(mass=1.0))
    place.position = (1, 0, 0)
    assert body.centre_of_mass == (1, 0, 0)
    world = oo.World()
    world.attach(body)
    assert_at(geom, oo.Pose(oo.Vec3(1, 0, 0)))
    world.detach(body)
    place.position = (0, 2, 0)
    world.attach(body)
    assert_at(geom, oo.Pose(oo.Vec3(0, 2, 0)))
    assert body.world_centre_of_mass == (0, 2, 0)
