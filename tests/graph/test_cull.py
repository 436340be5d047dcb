"""The cull traversal: what a picture of a graph holds, against a plain walk and against geometry."""

from __future__ import annotations

import gc
import itertools
import math
import weakref
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.errors import TreeError
from osgode.graph.appearance import Appearance
from osgode.graph.cull import CullVisitor
from osgode.graph.drawable import Drawable
from osgode.graph.frame import Frame, Rectangle, Sky, Sun, Text, View
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.mesh import Mesh
from osgode.graph.node import Group, Node
from osgode.graph.primitives import box_mesh
from osgode.graph.shapes import box_drawable, sphere_drawable
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform, Transform
from osgode.maths import FloatArray, Pose, Quat, Vec3, look_at
from tests.graph.graphs import RED, Body, World, at, ball, places

SIZE = (800, 600)
BLUE = Appearance((0, 0, 1))
GLASS = Appearance((1, 1, 1, 0.5))
FAR_VIEW = View(Pose(Vec3(0, 0, 2000)), field_of_view=1.0, far=5000)
"""From so far away that everything near the origin is in the picture."""


def cull(root: Node, view: View = FAR_VIEW, **options: Sun) -> Frame:
    return CullVisitor(root).cull(view, SIZE, **options)  # type: ignore[arg-type]


# -- against a plain walk


def expected(node: Node, matrix: FloatArray, world: FloatArray) -> Iterator[tuple[Drawable, FloatArray]]:
    """Every drawable on every way from the root with its matrix, the slow way."""
    if not node.visible or (isinstance(node, Switch) and not node.on):
        return
    if isinstance(node, World):
        world = matrix
    if isinstance(node, Body):
        matrix = world @ node.source.poses[node.row].matrix()  # type: ignore[attr-defined]
    elif isinstance(node, Transform):
        matrix = node.local_matrix() if node.absolute else matrix @ node.local_matrix()
    for drawable in node.drawables():
        yield drawable, matrix if drawable.matrix is None else matrix @ drawable.matrix
    for child in node.children if isinstance(node, Group) else ():
        yield from expected(child, matrix, world)


small = st.floats(-5, 5).map(lambda x: round(x, 3))
turns = st.builds(Quat.from_yaw_pitch_roll, small, small)
poses = st.builds(Pose, st.builds(Vec3, small, small, small), turns)
DRAWABLES = (
    box_drawable((1, 2, 3), RED),
    box_drawable((3, 1, 1), Appearance((1, 0, 0))),  # an equal appearance, not the same
    sphere_drawable(0.5, RED),
    sphere_drawable(1, BLUE),
    sphere_drawable(1, GLASS),
    sphere_drawable(1, Appearance((1, 1, 0), unlit=True)),
)


@st.composite
def graphs(draw: st.DrawFn) -> Group:
    """A random tree with a World somewhere in it, shared nodes, hidden ones, and switches that are off."""
    root = Group()
    world = World(draw(st.lists(poses, min_size=3, max_size=3)))
    outside: list[Group] = [root]
    shared: list[Node] = []
    visible = st.sampled_from([True, True, True, False])
    for _ in range(draw(st.integers(0, 5))):
        outside.append(draw(st.sampled_from(outside)).attach(draw_group(draw, draw(visible))))
    draw(st.sampled_from(outside)).attach(world)
    inside: list[Group] = [world]
    for _ in range(draw(st.integers(1, 4))):
        body = draw(st.sampled_from(inside)).attach(Body(world, draw(st.integers(0, 2))))
        inside.append(body.attach(draw_group(draw, draw(visible))))
    for _ in range(draw(st.integers(1, 8))):
        leaf: Node = Leaf(draw(st.lists(st.sampled_from(DRAWABLES), max_size=3)), visible=draw(visible))
        if shared and draw(st.booleans()):
            leaf = draw(st.sampled_from(shared))
        shared.append(draw(st.sampled_from(outside + inside)).attach(leaf))
    return root


def draw_group(draw: st.DrawFn, visible: bool) -> Group:
    kind = draw(st.integers(0, 4))
    if kind == 0:
        return Switch(on=draw(st.booleans()), visible=visible)
    if kind == 1:
        pose = draw(poses)
        scale = draw(st.sampled_from([(1, 1, 1), (2, 1, 0.5)]))
        return PositionAttitudeTransform(position=pose.position, rotation=pose.rotation, scale=scale, visible=visible)
    if kind == 2:
        return MatrixTransform(draw(poses).matrix(), absolute=draw(st.booleans()), visible=visible)
    return Group(visible=visible)


@given(graphs())
def test_the_same_as_a_plain_walk(root: Group) -> None:
    """From far away, every drawable on every visible way is in the picture once, with the right matrix."""
    frame = cull(root)
    wanted = sorted(expected(root, np.identity(4), np.identity(4)), key=lambda pair: id(pair[0]))
    found = [(b.mesh, b.appearance, m) for b in frame.opaque + frame.transparent for m in b.matrices]
    assert len(found) == len(wanted)
    for drawable, matrix in wanted:
        hit = next(
            k
            for k, (mesh, look, other) in enumerate(found)
            if mesh is drawable.mesh and look == drawable.appearance and np.allclose(matrix, other, atol=1e-3)
        )
        del found[hit]
    assert not any(b.appearance.transparent for b in frame.opaque)
    assert all(b.appearance.transparent for b in frame.transparent)


@given(graphs())
def test_bins_are_as_few_as_can_be(root: Group) -> None:
    """Opaque things with the same mesh and equal appearance are in one bin, of (n, 4, 4) float32."""
    frame = cull(root)
    keys = [(id(each.mesh), each.appearance) for each in frame.opaque]
    assert len(set(keys)) == len(keys)
    for each in frame.opaque + frame.transparent + frame.casters:
        assert each.matrices.dtype == np.float32
        assert each.matrices.shape == (len(each.matrices), 4, 4)
        assert len(each.matrices) > 0
    for a, b in itertools.pairwise(frame.transparent):
        assert (a.mesh, a.appearance) != (b.mesh, b.appearance)


# -- what moves


def test_bodies_are_drawn_where_the_table_says() -> None:
    """Poses are read anew for every picture, in one call, without walking the tree again."""
    world = World([Pose(Vec3(1, 0, 0)), Pose(Vec3(2, 0, 0))])
    first = world.attach(Body(world, 1))
    first.attach(at(0, 5)).attach(ball())
    world.attach(Body(world, 0)).attach(ball())
    visitor = CullVisitor(world)
    assert places(visitor.cull(FAR_VIEW, SIZE).opaque) == [(2, 5, 0), (1, 0, 0)]
    world.poses = [Pose(Vec3(7, 0, 0)), Pose(Vec3(8, 0, 0), Quat(0, 0, 0, 1))]
    assert places(visitor.cull(FAR_VIEW, SIZE, 0.25).opaque) == [(8, -5, 0), (7, 0, 0)]
    assert world.asked == [1.0, 0.25]


def test_two_worlds_have_two_tables() -> None:
    """Each body is drawn from the table of its own World, and what stands above that World counts."""
    root = Group()
    worlds = [World([Pose(Vec3(1, 0, 0))]), World([Pose(Vec3(0, 1, 0))])]
    root.attach(at(10)).attach(worlds[0])
    root.attach(at(20)).attach(worlds[1])
    for world in worlds:
        world.attach(Body(world, 0)).attach(ball())
    assert places(cull(root).opaque) == [(11, 0, 0), (20, 1, 0)]


def test_a_world_shown_twice_is_read_once() -> None:
    """A World that is reached on two ways is drawn at two places from one reading of its poses."""
    world = World([Pose(Vec3(1, 0, 0))])
    world.attach(Body(world, 0)).attach(ball())
    shared, root = Group(), Group()
    shared.attach(world)
    for x in (10, 20):
        root.attach(at(x)).attach(shared)
    assert places(cull(root).opaque) == [(11, 0, 0), (21, 0, 0)]
    assert world.asked == [1.0]


def test_a_table_outside_of_the_graph() -> None:
    """Poses of a source that is no node are in the axes of the root."""
    source = World([Pose(Vec3(1, 2, 3))])
    root = Group()
    root.attach(at(100)).attach(Body(source, 0)).attach(ball())
    assert places(cull(root).opaque) == [(1, 2, 3)]


def test_a_world_below_a_body_is_refused() -> None:
    """Poses below poses raise an error; the visitor works again when that is mended."""
    outer, inner = World([Pose()]), World([Pose()])
    body = outer.attach(Body(outer, 0))
    body.attach(inner)
    inner.attach(Body(inner, 0)).attach(ball())
    visitor = CullVisitor(outer)
    for _ in range(2):
        with pytest.raises(TreeError, match="world"):
            visitor.cull(FAR_VIEW, SIZE)
    body.detach(inner)
    assert visitor.cull(FAR_VIEW, SIZE).opaque == []


def test_uneven_scales_above_a_world() -> None:
    """A World below a transform that stretches is drawn and bounded as stretched."""
    root = PositionAttitudeTransform(scale=(10, 1, 1))
    world = root.attach(World([Pose(Vec3(2, 0, 0))]))
    world.attach(Body(world, 0)).attach(ball())
    frame = cull(root)
    assert frame.opaque[0].matrices[0] == pytest.approx(
        np.array([[5, 0, 0, 20], [0, 0.5, 0, 0], [0, 0, 0.5, 0], [0, 0, 0, 1]])
    )
    # The ball reaches from 15 to 25: a camera at 24 that looks along +X sees its end, one at 26 doesn't.
    assert places(cull(root, View(look_at((24, 0, 0), (30, 0, 0)), 0.1)).opaque) == [(20, 0, 0)]
    assert cull(root, View(look_at((26, 0, 0), (30, 0, 0)), 0.1)).opaque == []


# -- when the tree changes


def test_every_change_is_seen_in_the_next_picture() -> None:
    """Attaching, hiding, switching, moving and detaching all show."""
    root = Group()
    switch = root.attach(Switch())
    placed = switch.attach(at(1))
    leaf = placed.attach(ball())
    visitor = CullVisitor(root)

    def seen() -> list[tuple[float, ...]]:
        return places(visitor.cull(FAR_VIEW, SIZE).opaque)

    assert seen() == [(1, 0, 0)]
    placed.position = (2, 0, 0)
    assert seen() == [(2, 0, 0)]
    leaf.visible = False
    assert seen() == []
    leaf.visible = True
    switch.on = False
    assert seen() == []
    switch.on = True
    leaf.add_drawable(sphere_drawable(1, RED))
    assert seen() == [(2, 0, 0)] * 2
    switch.detach(placed)
    assert seen() == []
    root.attach(placed)
    assert seen() == [(2, 0, 0)] * 2
    root.visible = False
    assert seen() == []


def test_a_quiet_tree_is_walked_once() -> None:
    """Pictures of an unchanged tree don't ask the nodes again."""
    asked = []

    class Watched(Leaf):
        def drawables(self) -> tuple[Drawable, ...]:
            asked.append(self)
            return super().drawables()

    root = Group()
    root.attach(Watched([sphere_drawable(1)]))
    visitor = CullVisitor(root)
    for _ in range(3):
        visitor.cull(FAR_VIEW, SIZE)
    assert len(asked) == 1


def test_only_what_has_changed_is_walked_again() -> None:
    """Bodies below which nothing is different are taken over, whatever happens beside them."""
    asked: list[int] = []

    class Watched(Leaf):
        number = 0

        def drawables(self) -> tuple[Drawable, ...]:
            asked.append(self.number)
            return super().drawables()

    world = World([Pose(Vec3(x, 0, 0)) for x in range(4)])
    bodies, leaves = [], []
    for row in range(3):
        body = world.attach(Body(world, row))
        leaf = body.attach(Watched([sphere_drawable(1)]))
        leaf.number = row
        bodies.append(body)
        leaves.append(leaf)
    visitor = CullVisitor(world)

    def cull_again() -> tuple[list[tuple[float, ...]], list[int]]:
        asked.clear()
        return places(visitor.cull(FAR_VIEW, SIZE).opaque), asked

    assert cull_again() == ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [0, 1, 2])
    world.attach(at(9)).attach(ball())
    assert cull_again()[1] == []
    leaves[1].add_drawable(sphere_drawable(1, BLUE))
    assert cull_again()[1] == [1]
    world.detach(bodies[0])
    assert cull_again()[1] == []
    bodies[2].row = 3  # as the last body's row, when another leaves
    bodies[2]._touch()
    found, again = cull_again()
    assert again == [2]
    assert sorted(found) == [(1, 0, 0), (1, 0, 0), (3, 0, 0), (9, 0, 0)]


@given(graphs(), st.data())
def test_a_visitor_that_has_seen_all_changes_sees_what_a_new_one_sees(root: Group, data: st.DataObject) -> None:
    """Hiding, moving house and adding, above, in and below what moves: nothing old is taken over wrongly."""
    visitor = CullVisitor(root)
    for _ in range(data.draw(st.integers(1, 5))):
        nodes = list(root.walk())
        node = data.draw(st.sampled_from(nodes))
        act = data.draw(st.sampled_from(["hide", "show", "add", "leave", "turn", "switch"]))
        if act in ("hide", "show"):
            node.visible = act == "show"
        elif act == "add" and isinstance(node, Group):
            node.attach(Leaf([data.draw(st.sampled_from(DRAWABLES))]))
        elif act == "leave" and node.parents:
            node.parents[-1].detach(node)
        elif act == "turn" and isinstance(node, PositionAttitudeTransform):
            node.position = data.draw(st.tuples(small, small, small))
        elif act == "switch":
            for each in nodes:
                if isinstance(each, Switch):
                    each.on = not each.on
        for one, other in zip(frame_parts(visitor.cull(FAR_VIEW, SIZE)), frame_parts(cull(root)), strict=True):
            assert one == other


def frame_parts(frame: Frame) -> list[list[tuple[Mesh, Appearance, bytes]]]:
    """All that there is to compare of a frame's bins."""
    lists = (frame.opaque, frame.transparent, frame.casters)
    return [[(each.mesh, each.appearance, each.matrices.tobytes()) for each in bins] for bins in lists]


def test_frames_keep_what_they_showed() -> None:
    """A Frame isn't changed by the pictures after it."""
    world = World([Pose(Vec3(1, 0, 0))])
    world.attach(Body(world, 0)).attach(ball())
    world.attach(ball(GLASS))
    visitor = CullVisitor(world)
    view = View(Pose(Vec3(0, 0, 40)))
    first = visitor.cull(view, SIZE)
    world.poses = [Pose(Vec3(9, 0, 0))]
    second = visitor.cull(view, SIZE)
    assert places(first.opaque) == places(first.casters) == [(1, 0, 0)]
    assert places(second.opaque) == places(second.casters) == [(9, 0, 0)]


def test_what_has_left_is_not_kept_alive() -> None:
    """After the next picture, a detached node can be collected."""
    root = Group()
    node = root.attach(ball())
    visitor = CullVisitor(root)
    visitor.cull(FAR_VIEW, SIZE)
    root.detach(node)
    visitor.cull(FAR_VIEW, SIZE)
    gone = weakref.ref(node)
    del node
    gc.collect()
    assert gone() is None


def test_a_subclass_can_leave_things_out() -> None:
    """Overriding one method changes what is drawn of one kind of node."""

    class Fog(Leaf):
        pass

    class WithoutFog(CullVisitor):
        def visit_fog(self, node: Fog) -> None:
            pass

    root = Group()
    root.attach(Fog([sphere_drawable(1)]))
    root.attach(at(1)).attach(ball())
    assert len(places(cull(root).opaque)) == 2
    assert places(WithoutFog(root).cull(FAR_VIEW, SIZE).opaque) == [(1, 0, 0)]


# -- what the camera sees


# Whole decimetres: no two balls are so near each other that the test could take one for the other.
grid_points = st.tuples(*[st.integers(-300, 300).map(lambda k: k / 10)] * 3)


@given(st.lists(grid_points, min_size=1, max_size=12), small, small, st.floats(0.05, 5))
def test_nothing_that_can_be_seen_is_left_out(
    positions: list[tuple[float, float, float]], yaw: float, pitch: float, radius: float
) -> None:
    """A ball of which some point is in the frustum is in the picture; one wholly beyond a plane is not."""
    root = Group()
    for position in positions:
        root.attach(at(*position)).attach(ball(radius=radius))
    view = View(Pose(Vec3(1, 2, 3), Quat.from_yaw_pitch_roll(yaw, pitch)), 0.9, near=0.5, far=20)
    seen = np.array(places(cull(root, view).opaque)).reshape(-1, 3)
    tangent = math.tan(0.45)
    for position in positions:
        x, y, z = view.pose.inverse().transform(position)
        slope, wide = math.hypot(1, tangent), math.hypot(1, tangent * 4 / 3)
        margin = min(
            -z - 0.5, z + 20, (-z * tangent - abs(y)) / slope, (-z * tangent * 4 / 3 - abs(x)) / wide
        )  # metres that the centre is inside of the nearest plane
        if abs(margin + radius) < 1e-3:
            continue
        assert np.isclose(seen, position, atol=1e-3).all(axis=1).any() == (margin > -radius)


def test_the_end_of_a_long_thing_is_enough() -> None:
    """A beam whose middle is far outside of the picture is drawn if its end reaches in."""
    root = Group()
    beam = root.attach(at(-40, 0, -5))
    beam.attach(Leaf([box_drawable((80, 0.1, 0.1))]))
    assert len(places(cull(root, View(field_of_view=0.5)).opaque)) == 1
    beam.position = (-140, 0, -5)
    assert cull(root, View(field_of_view=0.5)).opaque == []


def test_meshes_away_from_their_origin() -> None:
    """The bounding sphere is about the middle of the mesh, not about the node's origin."""
    unit = box_mesh()
    far_off = Mesh(unit.vertices + np.float32([50, 0, 0]), unit.triangles)
    world = World([Pose(Vec3(-50, 0, -10))])
    world.attach(Body(world, 0)).attach(Leaf([Drawable(far_off)]))
    world.attach(at(-50, 0, -10)).attach(Leaf([Drawable(far_off, BLUE)]))
    assert places(cull(world, View()).opaque) == [(-50, 0, -10)] * 2
    assert cull(world, View(look_at((-50, 0, 0), (-50, 0, -10)))).opaque == []


def test_absolute_transforms_start_from_the_root() -> None:
    """Below an absolute transform nothing of what stands above it counts, neither transforms nor poses."""
    world = World([Pose(Vec3(1, 0, 0))])
    for above in (world.attach(at(5)), world.attach(Body(world, 0))):
        absolute = above.attach(MatrixTransform(at(0, 3).local_matrix(), absolute=True))
        absolute.attach(at(0, 0, 2)).attach(ball())
    assert places(cull(world).opaque) == [(0, 3, 2)] * 2


@given(st.permutations(range(6)), st.lists(st.booleans(), min_size=6, max_size=6))
def test_transparent_things_come_far_to_near_in_runs(order: list[int], kinds: list[bool]) -> None:
    """Transparent bins are sorted by distance, and neighbours of one kind share a bin."""
    looks = {True: GLASS, False: Appearance((1, 0, 0, 0.3))}
    root = Group()
    for k in order:
        root.attach(at(0, 0, -float(k))).attach(ball(looks[kinds[k]]))
    frame = cull(root, View(Pose(Vec3(0, 0, 5)), far=100))
    assert places(frame.transparent) == [(0, 0, -float(k)) for k in reversed(range(6))]
    runs = [key for key, _ in itertools.groupby(looks[kinds[k]] for k in reversed(range(6)))]
    assert [each.appearance for each in frame.transparent] == runs
    assert frame.opaque == frame.casters == []


# -- shadows and the rest


def test_casters_are_what_throws_shadows_into_the_view() -> None:
    """Whatever lies towards the sun of the visible region casts, seen or not; what is past it or aside doesn't."""
    # A field of view of 90 degrees both ways spreads by sqrt(2): up to 30 m the sphere is about the far side.
    view, radius = View(field_of_view=math.pi / 2), 30 * math.sqrt(2)
    root = Group()
    casting = [(0, 0, 5), (0, 500, -30), (radius + 0.4, 300, -30), (0, -radius - 0.4, -30)]
    others = [(0, -500, -30), (200, 0, -30), (radius + 0.6, 300, -30), (0, -radius - 0.6, -30)]
    for position in casting + others:
        root.attach(at(*position)).attach(ball())
    near = CullVisitor(root, shadow_reach=30).cull(view, (600, 600), sun=Sun(direction=Vec3(0, -2, 0)))
    assert places(near.casters) == [pytest.approx(position, abs=1e-3) for position in casting]
    far = CullVisitor(root, shadow_reach=300).cull(view, (600, 600), sun=Sun(direction=Vec3(0, -2, 0)))
    assert len(places(far.casters)) == 7


def test_light_and_glass_cast_no_shadow() -> None:
    """Transparent things and things that shine by themselves are no casters."""
    root = Group()
    shining = Appearance(unlit=True)
    for look in (GLASS, shining, RED):
        root.attach(ball(look))
    frame = cull(root, View(Pose(Vec3(0, 0, 10))))
    assert [each.appearance for each in frame.casters] == [RED]
    assert [each.appearance for each in frame.opaque] == [RED, shining]


def test_without_shadows_there_are_no_casters() -> None:
    """A sun without shadows asks for no casters."""
    root = Group()
    root.attach(ball())
    assert len(cull(root, View()).casters) == 1
    assert cull(root, View(), sun=Sun(shadows=False)).casters == []


def test_the_rest_is_handed_on() -> None:
    """View, size, light, sky and overlay are in the Frame as given."""
    sun, sky = Sun(shadows=False), Sky(haze=None)
    overlay = [Rectangle(0, 0, 1, 1), Text(0, 0, "hello")]
    frame = CullVisitor(Group()).cull(FAR_VIEW, SIZE, sun=sun, sky=sky, overlay=iter(overlay))
    assert (frame.view, frame.size, frame.sun, frame.sky, frame.overlay) == (FAR_VIEW, SIZE, sun, sky, overlay)
    assert frame.opaque == frame.transparent == frame.casters == []


def test_a_window_without_height() -> None:
    """A minimised window is no error."""
    root = Group()
    root.attach(ball())
    assert CullVisitor(root).cull(FAR_VIEW, (0, 0)).size == (0, 0)


@given(graphs())
def test_bins_carry_their_bounds(root: Group) -> None:
    """Each copy comes with a sphere that holds its every vertex, and mirrored ones are announced."""
    mirror = MatrixTransform(np.diag([-1.0, 1.0, 1.0, 1.0]))
    mirror.attach(root)
    for top in (root, mirror):
        frame = cull(top)
        for each in frame.opaque + frame.transparent + frame.casters:
            assert each.spheres is not None
            assert each.spheres.shape == (len(each.matrices), 4)
            matrices = each.matrices.astype(float)
            for matrix, sphere in zip(matrices, each.spheres, strict=True):
                corners = each.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
                assert np.linalg.norm(corners - sphere[:3], axis=1).max() <= sphere[3] + 1e-4
            turned = bool((np.linalg.det(matrices[:, :3, :3]) < 0).any())
            assert each.mirrored or not turned
            assert turned or not each.mirrored or each not in frame.opaque
