"""The cull traversal: from a scene graph and a camera to the description of one picture."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple
from weakref import WeakKeyDictionary, ref

import numpy as np

from osgode.errors import TreeError
from osgode.graph.draw_list import DrawList, Instance, Trail, frustum_planes, visible_sphere
from osgode.graph.frame import Frame, Lines, Rectangle, Sky, Sun, Text, View
from osgode.graph.leaf import Switch
from osgode.graph.lights import Lamp, Lamps, PointLight
from osgode.graph.lines import LineSet
from osgode.graph.lod import Gate, Gates, LevelOfDetail
from osgode.graph.movers import Anchor, Marks, Place, Tables
from osgode.graph.node import Node
from osgode.graph.particles import Cloud, Clouds, Particles
from osgode.graph.picking import Line, Pick
from osgode.graph.projection import Projection
from osgode.graph.transforms import PoseSource, Transform
from osgode.graph.visitors import Visitor
from osgode.maths import Pose

SHADOW_REACH = 90.0
"""Metres of depth up to which shadows are wanted: as far as the renderer's coarser shadow map reaches."""


_ROOT = Place()


class _Branch(NamedTuple):
    """What stands below a moving transform, as the walk has found it at a revision, at a place, on its way there."""

    revision: int
    place: Place
    gates: tuple[int, ...]
    trail: Trail | None
    shown: list[Instance]


class _Drawn(NamedTuple):
    """Lines on one way from the root, in which axes they are, and behind which gates."""

    node: LineSet
    place: Place
    anchor: Anchor | None
    gates: tuple[int, ...]

    def now(self, tables: Tables, opened: Marks, interpolation: float) -> list[Lines]:
        """What is shown, in the axes of the root."""
        if not all(opened[gate] for gate in self.gates):
            return []
        lines = [each for each in self.node.lines(interpolation) if len(each)]
        matrix = self.place.matrix
        if self.anchor is not None:
            matrix = tables.of(self.anchor.source)[self.place.row] @ self.place.fixed()
            if self.anchor.matrix is not None:
                matrix = self.anchor.matrix @ matrix
        return lines if matrix is None else [each.moved(matrix) for each in lines]


class CullVisitor(Visitor):
    """Turns what is below a root into Frames.

    The walk through the nodes writes everything visible into a flat list, and is done again only when the tree
    below the root has changed; what stands below moving bodies that haven't changed is then taken over. For each
    picture the list is moved by the poses in bulk and culled in bulk: no Python runs per node. Bounding spheres are
    tested against the frustum, so nothing that can be seen is left out; a few things close outside of it stay in.

    A subclass may override ``visit_<kind>`` to leave out what is below some nodes.

    Args:
        root: what is drawn, in whose axes the camera is given; held by the visitor.
        shadow_reach: metres of depth up to which shadows are wanted; what can throw none there is no caster.
    """

    def __init__(self, root: Node, *, shadow_reach: float = SHADOW_REACH) -> None:
        super().__init__()
        self.root = root
        self.shadow_reach = shadow_reach
        self._revision = -1
        self._list = DrawList((), ())
        self._place = _ROOT
        self._trail: Trail | None = None
        self._instances: list[Instance] = []
        self._projections: tuple[Projection, ...] = ()
        self._found_projections: list[Projection] = []
        self._anchors: list[Anchor] = []
        self._line_sets: list[_Drawn] = []
        self._anchor_of: dict[int, int] = {}
        self._gates = Gates((), (), ())
        self._before: tuple[int, ...] = ()
        """The gates that the walk has passed."""
        self._gate_list: list[Gate] = []
        self._gate_places: list[Place] = []
        self._lamps = Lamps((), ())
        self._lamp_list: list[Lamp] = []
        self._clouds = Clouds(())
        self._keeps = type(self) is CullVisitor  # a subclass may list what it likes
        self._kept: WeakKeyDictionary[Transform, _Branch] = WeakKeyDictionary()
        self._cloud_list: list[Cloud] = []

    def cull(
        self,
        view: View,
        size: tuple[int, int],
        interpolation: float = 1.0,
        *,
        sun: Sun | None = None,
        sky: Sky | None = None,
        overlay: Iterable[Rectangle | Text] = (),
    ) -> Frame:
        """The picture that ``view`` takes of everything below the root.

        Args:
            view: the camera, in the axes of the root.
            size: of the picture, pixels (width, height).
            interpolation: 1 for the poses after the last step, 0 for those before it.
            sun: the light; the default Sun if not given.
            sky: the default Sky if not given.
            overlay: what is drawn over the picture, in order, after what stands below a `Projection`.

        Raises:
            TreeError: if moving poses stand below other moving poses (a World below a Body of another World).
        """
        sun = Sun() if sun is None else sun
        tables, opened = self._prepare(view, interpolation)
        shown = self._list
        aspect = max(size[0], 1) / max(size[1], 1)  # a minimised window may have no height
        planes = frustum_planes(view, aspect)
        inside = shown.inside(planes)
        return Frame(
            view=view,
            size=size,
            opaque=shown.opaque_bins(inside),
            transparent=shown.transparent_bins(inside, view.pose.position),
            casters=shown.caster_bins(sun, *visible_sphere(view, aspect, self.shadow_reach)),
            overlay=[*(item for flat in self._projections for item in flat.items(size)), *overlay],
            sun=sun,
            sky=Sky() if sky is None else sky,
            front=shown.front_bins(inside),
            lines=[lines for drawn in self._line_sets for lines in drawn.now(tables, opened, interpolation)],
            lights=self._lamps.lights(tables, opened, planes, view.pose.position),
            particles=self._clouds.sprites(opened, planes, view.pose.position),
        )

    def pick(self, view: View, size: tuple[int, int], x: float, y: float, interpolation: float = 1.0) -> Pick | None:
        """What is seen at a point of the picture that `cull` would give, or None where that is the sky.

        Triangles are met exactly where they are drawn, but a hole in a texture counts as surface, and so does what is
        transparent. What is drawn in front of everything is met first.

        Args:
            view: the camera, in the axes of the root.
            size: of the picture, pixels (width, height).
            x: pixels from the left of the picture, see `View.ray`.
            y: pixels from its top.
            interpolation: 1 for the poses after the last step, 0 for those before it.

        Raises:
            FieldError: if the point or the size is not one.
            TreeError: as `cull`.
        """
        origin, direction = view.ray(x, y, size)
        ahead = direction.dot(view.pose.rotation.rotate((0.0, 0.0, -1.0)))  # metres of depth per metre
        line = Line(np.array(origin), np.array(direction), view.near / ahead, view.far / ahead)
        self._prepare(view, interpolation)
        return self._list.first_met(line)

    def _prepare(self, view: View, interpolation: float) -> tuple[Tables, Marks]:
        """Bring the list up to date: as the tree is now, moved, and chosen from by which gates are open."""
        if self.root._revision != self._revision:
            self._flatten()
        tables = Tables(interpolation)
        self._list.move(tables)
        opened = self._gates.open(tables, view.pose.position)
        self._list.choose(opened)
        return tables, opened

    # -- the walk

    def visit(self, node: Node) -> None:
        """Call this visitor's method for ``node``, and keep the way to it."""
        above = self._trail
        self._trail = Trail(above, ref(node))
        super().visit(node)
        self._trail = above

    def visit_node(self, node: Node) -> None:
        """List what the node shows and go on, unless it is hidden."""
        if node.visible:
            self._show(node)
            self.traverse(node)

    def visit_line_set(self, node: LineSet) -> None:
        """List the lines, unless they are hidden."""
        if node.visible:
            anchor = None if self._place.anchor is None else self._anchors[self._place.anchor]
            self._line_sets.append(_Drawn(node, self._place, anchor, self._before))
        self.visit_node(node)

    def visit_transform(self, node: Transform) -> None:
        """Go on in the node's axes."""
        outer = self._place
        posed = node.pose_row()
        if posed is not None:
            source, row = posed
            self._place = Place(None, self._anchor(source), row)
            if self._reuse(node):
                self._place = outer
                return
        elif node.absolute:
            self._place = Place(node.local_matrix())
        else:
            self._place = outer.within(node.local_matrix())
        before = self._collected()
        self.visit_node(node)
        if posed is not None:
            self._keep(node, before)
        self._place = outer

    def visit_projection(self, node: Projection) -> None:
        """Note it: what is below it is asked for each picture, and stands in no space."""
        if node.visible:
            self._found_projections.append(node)

    def _collected(self) -> tuple[int, int]:
        """How much the walk has listed: drawables, and all the rest."""
        rest = len(self._gate_list) + len(self._gate_places) + len(self._lamp_list) + len(self._cloud_list)
        rest += len(self._line_sets) + len(self._found_projections)
        return len(self._instances), rest + len(self._anchors)

    def _keep(self, node: Transform, before: tuple[int, int]) -> None:
        """Remember what a moving branch has listed, unless it was more than drawables."""
        now = self._collected()
        if self._keeps and now[1] == before[1]:
            shown = self._instances[before[0] :]
            self._kept[node] = _Branch(node._revision, self._place, self._before, self._trail, shown)

    def _reuse(self, node: Transform) -> bool:
        """List what a moving branch has listed the last time, if nothing of it has changed since."""
        kept = self._kept.get(node) if self._keeps else None
        if kept is None or kept[:4] != (node._revision, self._place, self._before, self._trail):
            return False
        self._instances += kept.shown
        return True

    def visit_switch(self, node: Switch) -> None:
        """Go on if the switch is on."""
        if node.on:
            self.visit_node(node)

    def visit_level_of_detail(self, node: LevelOfDetail) -> None:
        """Go on to each child behind a gate of its own."""
        if not node.visible:
            return
        self._show(node)
        number = len(self._gate_places)
        self._gate_places.append(self._place.within(Pose(node.centre).matrix()))
        before = self._before
        for child, distances in zip(node.children, node.ranges, strict=True):
            self._before = (*before, len(self._gate_list))
            self._gate_list.append(Gate(number, distances))
            self.visit(child)
        self._before = before

    def visit_point_light(self, node: PointLight) -> None:
        """List the lamp, unless it is hidden."""
        if node.visible:
            self._lamp_list.append(Lamp(ref(node), self._place, self._before))
        self.visit_node(node)

    def visit_particles(self, node: Particles) -> None:
        """List the particles, unless they are hidden or have been listed on another way."""
        if node.visible and not any(cloud.node() is node for cloud in self._cloud_list):
            self._cloud_list.append(Cloud(ref(node), self._before))
        self.visit_node(node)

    def _show(self, node: Node) -> None:
        place, trail = self._place, self._trail or Trail(None, ref(node))
        if hasattr(node, "matrices"):  # a PoseSource: poses below it are in the axes that the walk is in now
            self._enter(node)
        for shown in node.drawables():
            self._instances.append(Instance(shown, place.within(shown.matrix), trail, self._before))

    def _flatten(self) -> None:
        self._line_sets = []
        try:
            self.visit(self.root)
            self._list = DrawList(self._instances, self._anchors)
            self._projections = tuple(self._found_projections)
            self._lamps = Lamps(self._lamp_list, self._anchors)
            self._clouds = Clouds(self._cloud_list)
            self._gates = Gates(self._gate_places, self._gate_list, self._anchors)
            self._revision = self.root._revision
        finally:
            self._place, self._trail, self._before = _ROOT, None, ()
            self._gate_list, self._gate_places, self._lamp_list, self._cloud_list = [], [], [], []
            self._instances, self._anchors, self._anchor_of = [], [], {}
            self._found_projections = []

    def _enter(self, source: PoseSource) -> None:
        place = self._place
        if place.anchor is not None:
            raise TreeError(f"{source!r} can't be drawn: it stands below a transform that is moved by poses itself")
        self._anchor_of[id(source)] = len(self._anchors)
        self._anchors.append(Anchor(source, place.matrix))

    def _anchor(self, source: PoseSource) -> int:
        if id(source) not in self._anchor_of:  # not a node on the way here: its poses are in the root's axes
            self._anchor_of[id(source)] = len(self._anchors)
            self._anchors.append(Anchor(source, None))
        return self._anchor_of[id(source)]
