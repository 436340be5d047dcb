"""Levels of detail: which child is drawn at which distance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.errors import FieldError, TreeError
from osgode.graph.appearance import Appearance
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import View
from osgode.graph.leaf import Leaf
from osgode.graph.lod import LevelOfDetail, bounding_box
from osgode.graph.node import Group, Node
from osgode.graph.shapes import box_drawable, sphere_drawable
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform
from osgode.maths import Pose, Quat, Vec3, look_at
from tests.graph.graphs import Body, World, at, places

SIZE = (800, 600)
FINE, COARSE, FAR = (Appearance((0.1 * k, 0, 0)) for k in range(3))


def model(look: Appearance) -> Leaf:
    return Leaf([sphere_drawable(0.5, look)], name=f"look {look.colour[0]}")


def levels(**settings: Vec3) -> LevelOfDetail:
    """Fine up to 10 m, coarse from there to 50 m, nothing beyond."""
    lod = LevelOfDetail(name="tree", **settings)
    lod.attach(model(FINE), far=10)
    lod.attach(model(COARSE), 10, 50)
    return lod


def looks(root: Node, eye: tuple[float, float, float], *, casters: bool = False) -> list[Appearance]:
    """What a camera shows that looks at the origin."""
    frame = CullVisitor(root).cull(View(look_at(eye, (0, 0, 0))), SIZE)
    return [each.appearance for each in (frame.casters if casters else frame.opaque)]


@pytest.mark.parametrize("casters", [False, True])
@pytest.mark.parametrize(
    ("distance", "expected"), [(2, [FINE]), (9.999, [FINE]), (10, [COARSE]), (49.999, [COARSE]), (50, []), (80, [])]
)
def test_the_distance_chooses(distance: float, expected: list[Appearance], casters: bool) -> None:
    """A range begins at its near end and stops before its far one, for the picture and for the shadows."""
    assert looks(levels(), (0, 0, distance), casters=casters) == expected


def test_ranges_may_overlap_and_be_endless() -> None:
    """Each child has a range of its own; without one it is always drawn."""
    lod = levels()
    lod.attach(model(FAR))
    assert looks(lod, (0, 0, 5)) == [FINE, FAR]
    lod.set_range(lod.children[0], 3, 20)
    assert looks(lod, (0, 0, 2)) == [FAR]
    assert looks(lod, (0, 0, 15)) == [FINE, COARSE, FAR]
    assert looks(lod, (0, 0, 900)) == [FAR]
    assert lod.ranges == ((3, 20), (10, 50), (0, math.inf))


def test_a_quiet_tree_is_chosen_from_without_a_walk() -> None:
    """The camera may move to and fro over the border, the nodes aren't asked again."""
    asked = []

    class Watched(Leaf):
        def drawables(self):  # type: ignore[no-untyped-def]
            asked.append(self)
            return super().drawables()

    lod = LevelOfDetail(centre=Vec3(0, 0, 0))
    lod.attach(Watched([sphere_drawable(1)]), far=10)
    visitor = CullVisitor(lod)
    seen = [len(visitor.cull(View(Pose(Vec3(0, 0, z))), SIZE).opaque) for z in (5, 15, 5, 15)]
    assert seen == [1, 0, 1, 0]
    assert len(asked) == 1


def test_distances_are_metres_of_the_root() -> None:
    """Transforms above the node move and stretch where its centre is, not what a metre is."""
    root = PositionAttitudeTransform(position=(0, 0, -4), scale=3)
    root.attach(levels(centre=Vec3(0, 0, -2)))  # so the centre is at z = -10
    assert looks(root, (0, 9, -10)) == [FINE]
    assert looks(root, (0, 11, -10)) == [COARSE]


def test_moving_bodies_carry_their_levels() -> None:
    """The distance to what moves is that of this very picture."""
    root = Group()
    world = root.attach(at(0, 0, -1)).attach(World([Pose(), Pose()]))
    for row in (0, 1):
        world.attach(Body(world, row)).attach(at(0, 1)).attach(levels())
    visitor = CullVisitor(root)
    for first, second in ((-5.0, -20.0), (-20.0, -5.0), (-60.0, -20.0)):
        world.poses = [Pose(Vec3(0, 0, first)), Pose(Vec3(0, 0, second), Quat(0, 0, 1, 0))]
        frame = visitor.cull(View(), SIZE)
        found = {each.appearance: places([each]) for each in frame.opaque}
        wanted: dict[Appearance, list[tuple[float, ...]]] = {}
        for z in (first, second):
            distance = math.hypot(1, z - 1)
            if distance < 50:
                wanted.setdefault(FINE if distance < 10 else COARSE, []).append((0, 1, z - 1))
        assert found == wanted


def test_levels_in_levels() -> None:
    """What stands in two of them is drawn where both let it."""
    outer = LevelOfDetail(centre=Vec3(0, 0, 0))
    inner = outer.attach(levels(centre=Vec3(0, 0, 20)), 5, 40)
    inner.attach(model(FAR))
    assert looks(outer, (0, 0, 4)) == []
    assert looks(outer, (0, 0, 6)) == [COARSE, FAR]
    assert looks(outer, (0, 0, 15)) == [FINE, FAR]
    assert looks(outer, (0, 0, 39)) == [COARSE, FAR]
    assert looks(outer, (0, 0, 41)) == []


def test_one_shown_in_two_places_has_two_distances() -> None:
    root = Group()
    lod = levels()
    for z in (0, -30):
        root.attach(at(0, 0, z)).attach(lod)
    frame = CullVisitor(root).cull(View(Pose(Vec3(0, 0, 5))), SIZE)
    assert {each.appearance: places([each]) for each in frame.opaque} == {FINE: [(0, 0, 0)], COARSE: [(0, 0, -30)]}


def test_hidden_ones_are_hidden() -> None:
    lod = levels()
    lod.visible = False
    assert looks(lod, (0, 0, 5)) == []
    lod.visible = True
    lod.children[0].visible = False
    assert looks(lod, (0, 0, 5)) == []


@given(
    st.lists(st.tuples(st.floats(0, 20), st.floats(0.5, 30), st.integers(0, 40)), min_size=1, max_size=6),
    st.integers(-20, 20),
)
def test_as_plain_reckoning_says(rows: list[tuple[float, float, int]], eye: int) -> None:
    """Of many nodes along a line those are seen that their own distances let through."""
    root, expected = Group(), []
    for near, width, x in rows:
        lod = root.attach(at(x)).attach(LevelOfDetail())
        lod.attach(Leaf([box_drawable((0.1, 0.1, 0.1))]), near, near + width)
        if near <= math.dist((x, 0, 0), (eye, 0, 30)) < near + width:
            expected.append((float(x), 0.0, 0.0))
    frame = CullVisitor(root).cull(View(Pose(Vec3(eye, 0, 30)), field_of_view=2.9), SIZE)
    assert sorted(places(frame.opaque)) == sorted(expected)


# -- the tree


@pytest.mark.parametrize("wrong", [(-1, 5), (5, 5), (6, 5), (0, float("nan")), (float("nan"), 1), ("a", 1), (None, 1)])
def test_a_range_without_a_distance_is_refused(wrong: tuple[float, float]) -> None:
    """The message names the node and the range; nothing is attached, nothing is changed."""
    lod, child = levels(), model(FAR)
    before, revision = lod.ranges, lod._revision
    with pytest.raises(FieldError, match="LevelOfDetail 'tree': the range is from"):
        lod.attach(child, *wrong)
    with pytest.raises(FieldError, match="it must begin at 0 or more"):
        lod.set_range(lod.children[0], *wrong)
    assert lod.ranges == before
    assert (lod._revision, len(lod.children), child.parents) == (revision, 2, ())


@pytest.mark.parametrize("wrong", [(1, 2), (1, 2, float("inf")), "up", 3])
def test_a_centre_is_three_numbers(wrong: object) -> None:
    lod = levels()
    with pytest.raises(FieldError, match=r"LevelOfDetail 'tree'\.centre"):
        lod.centre = wrong  # type: ignore[assignment]
    assert lod.centre == (0, 0, 0)


def test_ranges_follow_the_children() -> None:
    """Whichever child leaves takes its range along; what the tree refuses leaves none behind."""
    lod = LevelOfDetail()
    a, b = model(FINE), model(COARSE)
    lod.attach(a, 0, 1)
    lod.attach(b, 1, 2)
    lod.attach(a, 2, 3)
    with pytest.raises(TreeError):
        lod.attach(lod, 3, 4)
    with pytest.raises(TreeError, match="not one of its children"):
        lod.set_range(model(FAR), 1, 2)
    lod.set_range(a, 5, 6)
    assert lod.ranges == ((0, 1), (1, 2), (5, 6))
    lod.detach(a)
    assert (lod.children, lod.ranges) == ((a, b), ((0, 1), (1, 2)))
    lod.detach(a)
    assert (lod.children, lod.ranges) == ((b,), ((1, 2),))


def test_setting_a_range_or_centre_is_noted_above() -> None:
    root = Group()
    lod = root.attach(levels())
    revision = root._revision
    lod.set_range(lod.children[0], 1, 2)
    assert root._revision > revision
    revision = root._revision
    lod.centre = Vec3(1, 2, 3)
    assert root._revision > revision


# -- the middle of what is below


def test_the_centre_is_the_middle_of_what_is_below() -> None:
    """Unless it is given; it follows when something is attached."""
    lod = LevelOfDetail()
    assert lod.centre == (0, 0, 0)
    lod.attach(at(10, 0, 0)).attach(Leaf([box_drawable((2, 4, 6))]))
    assert lod.centre == (10, 0, 0)
    lod.attach(at(20, 3, 0)).attach(Leaf([box_drawable((2, 4, 6))]))
    assert lod.centre == (15, 1.5, 0)
    lod.centre = Vec3(1, 2, 3)
    assert lod.centre == (1, 2, 3)
    lod.centre = None  # type: ignore[assignment]
    assert lod.centre == (15, 1.5, 0)


def test_bounding_box_of_turned_and_stretched_things() -> None:
    """A box turned by a quarter about Z swaps width and height; absolute transforms lead elsewhere."""
    root = Group()
    turned = root.attach(
        PositionAttitudeTransform(
            position=(5, 0, 0), rotation=Quat.from_axis_angle((0, 0, 1), math.pi / 2), scale=(2, 1, 1)
        )
    )
    turned.attach(Leaf([box_drawable((2, 4, 6))]))  # 4 x 4 x 6 when stretched
    turned.attach(MatrixTransform(np.diag([9.0, 9.0, 9.0, 1.0]), absolute=True)).attach(model(FINE))
    low, high = bounding_box(root) or (None, None)
    assert low == pytest.approx((3, -2, -3))
    assert high == pytest.approx((7, 2, 3))
    assert bounding_box(Group()) is None
