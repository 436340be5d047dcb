"""Picking: which node, and which point of it, is seen at a point of the picture."""

from __future__ import annotations

import gc
import math
import weakref

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from osgode.errors import FieldError
from osgode.graph.appearance import Appearance
from osgode.graph.cull import CullVisitor
from osgode.graph.drawable import Drawable
from osgode.graph.frame import View
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.lod import LevelOfDetail
from osgode.graph.mesh import Mesh
from osgode.graph.node import Group, Node
from osgode.graph.picking import Line, Pick, cross, entries
from osgode.graph.primitives import box_mesh, rectangle_mesh
from osgode.graph.shapes import box_drawable, sphere_drawable
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform
from osgode.maths import Pose, Quat, Vec3, look_at
from tests.graph.graphs import Body, World, at, ball

SIZE = (640, 360)
MIDDLE = (320.0, 180.0)
small = st.floats(-5, 5).map(lambda x: round(x, 3))
poses = st.builds(Pose, st.builds(Vec3, small, small, small), st.builds(Quat.from_yaw_pitch_roll, small, small, small))


def seen(root: Node, view: View = View(), x: float = MIDDLE[0], y: float = MIDDLE[1]) -> Pick | None:  # noqa: B008
    return CullVisitor(root).pick(view, SIZE, x, y)


def sheet(z: float, look: Appearance = Appearance(), edge: float = 2.0) -> Leaf:  # noqa: B008
    """A square that faces +Z, on the Z axis."""
    return Leaf([Drawable(rectangle_mesh(edge, edge), look, Pose(Vec3(0, 0, z)).matrix())], name=f"sheet {z:g}")


# -- rays of a camera


@given(poses, st.floats(0.1, 2.9), st.floats(0, 640), st.floats(0, 360), st.floats(0.5, 50))
def test_a_ray_goes_through_its_pixel(pose: Pose, field_of_view: float, x: float, y: float, along: float) -> None:
    """Any point of the ray is drawn where the ray was asked for: by the matrices that the drawer uses."""
    view = View(pose, field_of_view, near=0.1, far=100)
    origin, direction = view.ray(x, y, SIZE)
    assert origin == pose.position
    assert direction.length == pytest.approx(1)
    clip = view.projection_matrix(SIZE[0] / SIZE[1]) @ view.view_matrix() @ (*(origin + direction * along), 1)
    assert clip[3] > 0
    assert (clip[0] / clip[3] + 1) / 2 * SIZE[0] == pytest.approx(x, abs=1e-6)
    assert (1 - clip[1] / clip[3]) / 2 * SIZE[1] == pytest.approx(y, abs=1e-6)


@pytest.mark.parametrize(
    ("x", "y", "size", "wrong"),
    [(1, 1, (0, 5), "size"), (1, 1, (5, -1), "size"), (math.nan, 1, (5, 5), "point"), (1, math.inf, (5, 5), "point")],
)
def test_a_ray_needs_a_point_and_a_picture(x: float, y: float, size: tuple[int, int], wrong: str) -> None:
    with pytest.raises(FieldError, match=rf"View.ray: (the )?{wrong} is"):
        View().ray(x, y, size)
    with pytest.raises(FieldError, match=wrong):
        CullVisitor(Group()).pick(View(), size, x, y)


# -- what is met


def test_a_sheet_straight_ahead() -> None:
    """Node, drawable, way from the root, place, side and distance."""
    root = Group(name="root")
    place = root.attach(at(0, 0, -4))
    leaf = place.attach(sheet(-1))
    found = seen(root)
    assert found is not None
    assert found.path == (root, place, leaf)
    assert found.node is leaf
    assert found.drawable is leaf.drawables()[0]
    assert found.point == pytest.approx((0, 0, -5))
    assert found.normal == pytest.approx((0, 0, 1))
    assert found.distance == pytest.approx(5)
    assert found.triangle in (0, 1)


def test_the_sky_is_nothing() -> None:
    assert seen(Group()) is None
    assert seen(sheet(-5), x=600) is None
    assert seen(sheet(5)) is None  # behind the camera


@given(
    st.lists(st.tuples(st.builds(Vec3, small, small, small), st.floats(0.3, 3)), min_size=1, max_size=8),
    st.floats(0, 640),
    st.floats(0, 360),
)
def test_the_nearest_of_many_boxes(boxes: list[tuple[Vec3, float]], x: float, y: float) -> None:
    """Against the slabs of each box, whatever the order."""
    view = View(look_at((0, 1, 20), (0, 0, 0)), near=1)
    origin, direction = view.ray(x, y, SIZE)
    root, expected = Group(), []
    for centre, edge in boxes:
        place = root.attach(at(*centre))
        leaf = place.attach(Leaf([box_drawable((edge, edge, edge))]))
        enters, leaves = -math.inf, math.inf
        for k in range(3):
            a, b = sorted((centre[k] + side * edge / 2 - origin[k]) / direction[k] for side in (-1, 1))
            enters, leaves = max(enters, a), min(leaves, b)
        assume(abs(leaves - enters) > 1e-4)
        if enters < leaves:
            expected.append((enters, leaf))
    found = seen(root, view, x, y)
    if not expected:
        assert found is None
        return
    distance, leaf = min(expected, key=lambda pair: pair[0])
    ties = [other for other_distance, other in expected if other_distance < distance + 1e-4]
    assert found is not None
    assert found.distance == pytest.approx(distance, abs=1e-4)
    assert found.node in ties
    assert found.point == pytest.approx(origin + direction * found.distance, abs=1e-6)
    assert max(map(abs, found.normal)) == pytest.approx(1)
    assert found.normal.dot(direction) < 0


@given(poses, st.sampled_from([(1, 1, 1), (2, 1, 0.5), (-1, 1, 3)]))
def test_normals_of_turned_and_stretched_things(pose: Pose, scale: tuple[float, float, float]) -> None:
    """The normal stands on the surface where it is drawn, also under an uneven scale and a mirror."""
    matrix = pose.matrix()
    matrix[:3, :3] *= scale
    root = MatrixTransform(matrix)
    leaf = root.attach(sheet(0, edge=4.0))
    across, along = matrix[:3, 0], matrix[:3, 1]
    normal = Vec3(*np.cross(across, along).tolist()).normalized()
    for side in (1, -1):
        eye = pose.position + normal * (7.0 * side)
        found = seen(root, View(look_at(eye, pose.position)))
        assert found is not None
        assert found.node is leaf
        assert found.normal == pytest.approx(normal * side, abs=1e-4)
        assert found.distance == pytest.approx(7, abs=1e-3)


def test_spheres_around_are_not_enough() -> None:
    """A ray through the bounding sphere that misses the triangles goes on to what is behind."""
    root = Group()
    ring = root.attach(at(0, 0, -3))
    ring.attach(Leaf([box_drawable((0.2, 2, 0.2)), Drawable(box_mesh(), matrix=Pose(Vec3(1.5, 0, 0)).matrix())]))
    behind = root.attach(sheet(-9, edge=9.0))
    found = seen(root, x=400)
    assert found is not None
    assert found.node is behind


def test_no_ray_slips_through_a_seam() -> None:
    """Many rays at the inner edges of a finely cut sheet all meet it."""
    grid = np.linspace(-1, 1, 41)
    x, y = np.meshgrid(grid, grid)
    vertices = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    a = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    mesh = Mesh(vertices, np.vstack([np.stack([a, a + 1, a + 42], 1), np.stack([a, a + 42, a + 41], 1)]))
    for point in vertices[42:-42:7].astype(np.float32).astype(float):
        if max(abs(point[:2])) < 0.99:
            for eye in (np.array([0.3, 0.1, 5.0]), np.array([2.0, -3.0, 2.0])):
                direction = point - eye
                line = Line(eye, direction / np.linalg.norm(direction), 0.0, 100.0)
                assert cross(line, mesh, np.identity(4)) is not None


def test_only_what_the_camera_can_show() -> None:
    """Before the near plane and behind the far one nothing is met, measured in depth as the picture is cut."""
    view = View(near=4, far=8)
    x = 500.0
    _, direction = view.ray(x, 180, SIZE)
    for depth, met in ((3.99, False), (4.01, True), (7.99, True), (8.01, False)):
        found = seen(sheet(-depth, edge=40.0), view, x)
        assert (found is not None) == met
        if found is not None:
            assert found.distance == pytest.approx(depth / -direction.z)


def test_squeezed_flat_things_are_not_met() -> None:
    """Marks that are shrunk to nothing, and sheets by a matrix without an inverse, raise no error."""
    for scale in ((0, 0, 0), (1, 1, 0)):
        root = MatrixTransform(np.diag([*map(float, scale), 1.0]))
        root.attach(at(0, 0, -5)).attach(ball())
        assert seen(root, View(Pose(Vec3(0, 0, 5)))) is None


# -- what counts


def test_hidden_things_are_looked_through() -> None:
    """Invisible nodes, switches that are off, and levels of detail for other distances."""
    root = Group()
    back = root.attach(sheet(-9, edge=9.0))
    switch = root.attach(Switch())
    switched = switch.attach(sheet(-2))
    hidden = root.attach(sheet(-3))
    lod = root.attach(LevelOfDetail())
    level = lod.attach(sheet(-4), far=10)

    def node() -> Node:
        found = seen(root)
        assert found is not None
        return found.node

    assert node() is switched
    switch.on = False
    assert node() is hidden
    hidden.visible = False
    assert node() is level
    lod.set_range(level, 10)
    assert node() is back


def test_what_is_in_front_comes_first() -> None:
    """As it is drawn: over everything, the nearer one over the farther one."""
    root = Group()
    root.attach(sheet(-2))
    marks = [root.attach(sheet(z, Appearance(in_front=True))) for z in (-8.0, -6.0)]
    found = seen(root)
    assert found is not None
    assert found.node is marks[1]


def test_transparent_things_are_met() -> None:
    root = Group()
    root.attach(sheet(-5))
    glass = root.attach(sheet(-3, Appearance((1, 1, 1, 0.3))))
    found = seen(root)
    assert found is not None
    assert found.node is glass


def test_shared_nodes_tell_the_way() -> None:
    """A model that stands in two places: the path says through which of them it is seen."""
    root, model = Group(), ball()
    shown = [root.attach(at(x, 0, -10)) for x in (-2, 2)]
    for place in shown:
        place.attach(model)
    view = View(look_at((0, 0, 0), (2, 0, -10)))
    found = seen(root, view)
    assert found is not None
    assert found.path == (root, shown[1], model)


def test_moving_things_are_met_where_they_are_drawn() -> None:
    """By the same interpolation as the picture; the tree isn't walked again."""
    world = World([Pose(Vec3(0, 0, -5))])
    body = world.attach(Body(world, 0))
    leaf = body.attach(ball())
    visitor = CullVisitor(world)
    found = visitor.pick(View(), SIZE, *MIDDLE, interpolation=0.25)
    assert found is not None
    assert found.path == (world, body, leaf)
    assert found.distance == pytest.approx(4.5, abs=0.01)
    world.poses = [Pose(Vec3(3, 0, -5))]
    assert visitor.pick(View(), SIZE, *MIDDLE) is None
    assert visitor.cull(View(), SIZE).opaque
    assert world.asked == [0.25, 1.0, 1.0]


def test_picking_keeps_nothing_alive() -> None:
    """Not the node in a tree that has changed, and no mesh that was looked at."""
    root = Group()
    leaf = root.attach(sheet(-5))
    visitor = CullVisitor(root)
    found = visitor.pick(View(), SIZE, *MIDDLE)
    gone = weakref.ref(leaf), weakref.ref(leaf.drawables()[0])
    root.detach(leaf)
    assert visitor.pick(View(), SIZE, *MIDDLE) is None
    del leaf, found
    gc.collect()
    assert [each() for each in gone] == [None, None]


# -- the arithmetic


@given(st.lists(st.tuples(small, small, small, st.floats(0.1, 4)), min_size=1, max_size=6), small, small)
def test_entries_of_spheres(spheres: list[tuple[float, ...]], x: float, y: float) -> None:
    """By the quadratic formula, one after another."""
    line = Line(np.array([x, y, 9.0]), np.array([0.0, 0.0, -1.0]), 1.0, 12.0)
    for (cx, cy, cz, radius), begin in zip(spheres, entries(line, np.array(spheres)), strict=True):
        half = radius**2 - (cx - x) ** 2 - (cy - y) ** 2
        if abs(half) < 1e-9:
            continue
        first, last = (9 - cz - math.sqrt(half), 9 - cz + math.sqrt(half)) if half > 0 else (99.0, -99.0)
        met = first <= 12 and last >= 1
        assert begin == (pytest.approx(max(first, 1.0)) if met else math.inf)


def test_picked_where_scaled_balls_are() -> None:
    """A ball stretched to an egg is met at its end."""
    egg = PositionAttitudeTransform(position=(0, 0, -10), scale=(1, 1, 4))
    egg.attach(Leaf([sphere_drawable(1.0)]))
    found = seen(egg)
    assert found is not None
    assert found.distance == pytest.approx(6, abs=0.03)
