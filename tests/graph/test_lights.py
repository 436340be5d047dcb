"""Lamps as nodes: which of them shine into a picture, from where, and how."""

from __future__ import annotations

import math

import pytest

from osgode.errors import FieldError
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import MAX_LIGHTS, Light, View
from osgode.graph.leaf import Switch
from osgode.graph.lights import PointLight, SpotLight
from osgode.graph.lod import LevelOfDetail
from osgode.graph.node import Group, Node
from osgode.graph.transforms import PositionAttitudeTransform
from osgode.maths import Pose, Quat, Vec3
from tests.graph.graphs import Body, World, at

SIZE = (100, 100)
RIGHT = View(field_of_view=math.pi / 2, near=1, far=100)
"""From the origin along -Z, 45 degrees to every side."""


def lights(root: Node, view: View = RIGHT) -> list[Light]:
    return CullVisitor(root).cull(view, SIZE).lights


def test_a_lamp_stands_where_its_axes_are() -> None:
    """Transforms move it and turn its cone, but don't scale its reach."""
    root = PositionAttitudeTransform(position=(1, 2, -10), rotation=Quat.from_axis_angle((0, 1, 0), math.pi / 2))
    root.attach(at(0, 0, 3)).attach(PointLight((1, 0.5, 0.25), 5.0, intensity=2.0))
    root.scale = (2, 2, 2)
    spot = root.attach(SpotLight(reach=7, angle=0.5, softness=0.25))
    point, cone = lights(root)[::-1] if lights(root)[0].direction is not None else lights(root)
    assert point.position == pytest.approx((7, 2, -10))  # Z is turned into X
    assert (point.colour, point.reach, point.direction) == ((2, 1, 0.5), 5, None)
    assert cone.position == pytest.approx((1, 2, -10))
    assert cone.direction == pytest.approx((-1, 0, 0))
    assert (cone.colour, cone.reach, cone.outer, cone.inner) == ((1, 1, 1), spot.reach, 0.5, 0.375)


def test_a_lamp_on_a_body_moves_with_it() -> None:
    """Also between two pictures of a tree that doesn't change."""
    root = Group()
    world = root.attach(at(0, 0, -20)).attach(World([Pose(Vec3(1, 0, 0)), Pose(Vec3(3, 0, 0), Quat(0, 0, 1, 0))]))
    world.attach(Body(world, 1)).attach(at(0, 1)).attach(SpotLight())
    visitor = CullVisitor(root)
    (light,) = visitor.cull(RIGHT, SIZE).lights
    assert light.position == pytest.approx((3, 1, -20))
    assert light.direction == pytest.approx((0, 0, 1))
    world.poses[1] = Pose(Vec3(5, 0, 0))
    (light,) = visitor.cull(RIGHT, SIZE).lights
    assert light.position == pytest.approx((5, 1, -20))
    assert light.direction == pytest.approx((0, 0, -1))


@pytest.mark.parametrize(
    ("position", "reach", "shines"),
    [
        ((0, 0, 5), 5.9, False),  # behind the camera, whose near plane is a metre ahead
        ((0, 0, 5), 6.1, True),
        ((20, 0, -10), 7.0, False),  # 10 m beside the edge, which stands at 45 degrees
        ((20, 0, -10), 7.2, True),
        ((0, 0, -105), 4.9, False),
        ((0, 0, -105), 5.1, True),
    ],
)
def test_what_reaches_into_the_picture_shines(position: tuple[float, ...], reach: float, shines: bool) -> None:
    root = at(*position)
    root.attach(PointLight(reach=reach))
    assert len(lights(root)) == shines


def test_the_nearest_shine() -> None:
    """Of many at most as many as the shaders take, the nearest first; dark and hidden ones take no place."""
    root = Group()
    lamps = [root.attach(at(0, 0, -float(5 + (k * 7) % 20))).attach(PointLight((k + 1, 0, 0))) for k in range(20)]
    order = sorted(range(20), key=lambda k: (k * 7) % 20)
    assert [light.colour[0] - 1 for light in lights(root)] == order[:MAX_LIGHTS]
    lamps[order[0]].visible = False
    lamps[order[1]].intensity = 0.0
    lamps[order[2]].colour = (0, 0, 0)
    assert [light.colour[0] - 1 for light in lights(root)] == order[3 : 3 + MAX_LIGHTS]


def test_switches_and_levels_of_detail_put_lamps_out() -> None:
    root = Group()
    switch, lod = root.attach(Switch()), root.attach(LevelOfDetail(centre=(0, 0, -10)))
    switch.attach(at(0, 0, -5)).attach(PointLight())
    lod.attach(PointLight(), 0, 20)
    assert len(lights(root)) == 2
    switch.on = False
    assert len(lights(root)) == 1
    lod.set_range(lod.children[0], 20)
    assert lights(root) == []


def test_flickering_needs_no_walk() -> None:
    """Colour and intensity are taken anew for each picture; only the reach is a change of the tree."""
    root = at(0, 0, -5)
    lamp = root.attach(PointLight())
    visitor = CullVisitor(root)
    visitor.cull(RIGHT, SIZE)
    revision = root._revision
    lamp.intensity, lamp.colour = 0.5, (4, 2, 0)
    assert root._revision == revision
    (light,) = visitor.cull(RIGHT, SIZE).lights
    assert light.colour == (2, 1, 0)
    lamp.reach = 3
    assert root._revision > revision
    assert visitor.cull(RIGHT, SIZE).lights[0].reach == 3


NAN = float("nan")


@pytest.mark.parametrize(
    ("field", "wrong"),
    [
        *[("colour", value) for value in ((1, 1), (1, 1, -0.1), (1, NAN, 1), (1, math.inf, 1), 3, "red", None)],
        *[("intensity", value) for value in (-1, NAN, math.inf, None)],
        *[("reach", value) for value in (0, -1, NAN, math.inf, "far")],
        *[("angle", value) for value in (0, 1.6, NAN, None)],
        *[("softness", value) for value in (0, 1.01, NAN)],
    ],
)
def test_wrong_values_are_refused(field: str, wrong: object) -> None:
    """In the line that gives them, naming lamp and field; nothing changes."""
    lamp = SpotLight(name="lamp")
    before = getattr(lamp, field)
    with pytest.raises(FieldError, match=rf"SpotLight 'lamp'\.{field} is"):
        setattr(lamp, field, wrong)
    assert getattr(lamp, field) == before
    with pytest.raises(FieldError, match=field):
        SpotLight(**{field: wrong})  # type: ignore[arg-type]


@pytest.mark.parametrize("reach", [0.0, -1.0, NAN])
def test_a_light_without_reach_is_refused(reach: float) -> None:
    with pytest.raises(FieldError, match=r"Light\.reach is"):
        Light(Vec3(0, 0, 0), (1, 1, 1), reach)
