"""What a scene graph shows, as flat arrays: made when the tree changes, moved and culled in bulk for each picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple
from weakref import ReferenceType

import numpy as np

from osgode.graph.appearance import Appearance
from osgode.graph.drawable import Drawable
from osgode.graph.frame import Bin, Sun, View
from osgode.graph.lod import Gated
from osgode.graph.mesh import Mesh
from osgode.graph.movers import Anchor, Marks, Movers, Place, Selection, Tables
from osgode.graph.node import Node
from osgode.graph.picking import Line, Pick, cross, entries
from osgode.maths import FloatArray, Vec3


class Trail(NamedTuple):
    """The way from the root to a node: what is above it, and the node itself, which isn't kept alive."""

    above: Trail | None
    node: ReferenceType[Node]

    def nodes(self) -> tuple[Node, ...]:
        """The nodes, the root first; those that are gone are left out."""
        trail: Trail | None = self
        found = []
        while trail is not None:
            found.append(trail.node())
            trail = trail.above
        return tuple(node for node in reversed(found) if node is not None)


class Instance(NamedTuple):
    """One drawable on one way from the root, the axes of its mesh there, and the gates that must be open."""

    drawable: Drawable
    place: Place
    trail: Trail
    gates: tuple[int, ...] = ()


class DrawList:
    """Instances in an order in which those that can be drawn together stand together.

    First come the opaque ones that cast shadows, then the other opaque ones (unlit: what shines throws no shadow),
    then the transparent ones, and at last those that are drawn in front of everything, the opaque ones first.
    The arrays have the order of a `Movers`, in which nothing has to be put anywhere one by one when it moves.

    Args:
        instances: in any order, which is kept among equals.
        anchors: what the instances' places refer to.
    """

    def __init__(self, instances: Sequence[Instance], anchors: Sequence[Anchor]) -> None:
        self._keys: list[tuple[Mesh, Appearance]] = []
        ordered, self._bin_of = self._sorted(instances)
        self._ordered = ordered
        count = len(ordered)
        self._starts: Selection = np.searchsorted(self._bin_of, np.arange(len(self._keys) + 1))
        looks = [self._keys[k][1] for k in self._bin_of]
        behind = [look for look in looks if not look.in_front]
        self._casters = sum(not (look.transparent or look.unlit) for look in behind)
        self._opaque = sum(not look.transparent for look in behind)
        self._behind = len(behind)

        # Each instance's matrix, and as a fifth column the centre of its mesh, to be moved in the same product.
        columns = np.zeros((count, 4, 5))
        columns[:, :, :4] = np.identity(4)
        if count:
            columns[:, :, 4] = [(*each.drawable.mesh.centre, 1.0) for each in ordered]
        self._movers = Movers([each.place for each in ordered], columns, anchors)
        self._slots = self._movers.slots
        start = self._movers.start
        self._spheres = np.empty((count, 4))
        self._spheres[:, :3] = start[:, :3, 4]
        self._spheres[self._slots, 3] = [each.drawable.mesh.radius for each in ordered]
        self._spheres[:, 3] *= largest_scales(start[:, :3, :3])
        self._matrices = start[:, :, :4].astype(np.float32)
        turned = np.linalg.det(start[:, :3, :3]) < 0
        for anchor, part in self._movers.parts():
            if anchor.matrix is not None:
                self._spheres[part, 3] *= largest_scales(anchor.matrix[None, :3, :3])
                turned[part] ^= bool(np.linalg.det(anchor.matrix[:3, :3]) < 0)
        borders = pairwise(self._starts.tolist())
        self._gated = Gated([each.gates for each in ordered])
        self._chosen: Marks | None = None
        self._mirrored = [bool(turned[self._slots[first:end]].any()) for first, end in borders]

    def __len__(self) -> int:
        return len(self._bin_of)

    def _sorted(self, instances: Sequence[Instance]) -> tuple[list[Instance], Selection]:
        """The instances in drawing order and the number of each one's bin; fills ``_keys``."""
        by_look: dict[tuple[int, Appearance], list[Instance]] = {}
        # Hashing an Appearance is slow, and most instances share one: look it up by identity first.
        by_identity: dict[tuple[int, int], list[Instance]] = {}
        for each in instances:
            mesh, look = each.drawable.mesh, each.drawable.appearance
            identity = (id(mesh), id(look))
            same = by_identity.get(identity)
            if same is None:
                same = by_identity[identity] = by_look.setdefault((id(mesh), look), [])
            same.append(each)
        bins = sorted(by_look.values(), key=lambda same: _rank(same[0].drawable.appearance))
        self._keys = [(same[0].drawable.mesh, same[0].drawable.appearance) for same in bins]
        numbers = np.repeat(np.arange(len(bins)), [len(same) for same in bins])
        return [each for same in bins for each in same], numbers

    def move(self, tables: Tables) -> None:
        """Take the poses of everything that moves."""
        for part, moved in self._movers.moved(tables):
            self._matrices[part] = moved[:, :, :4]
            self._spheres[part, :3] = moved[:, :3, 4]

    def choose(self, opened: Marks) -> None:
        """Leave out what stands behind a gate that isn't marked; before `inside` and `caster_bins`."""
        self._chosen = self._gated.passed(opened)

    def inside(self, planes: FloatArray) -> Marks:
        """Which of those chosen reach to the inner side of every plane, (k, 4) as of `frustum_planes`."""
        weights = np.ones((len(planes), 4))  # the radius counts as much as a metre inwards
        weights[:, :3] = planes[:, :3]
        distances = weights @ self._spheres.T
        distances += planes[:, 3:]
        inside: Marks = np.asarray(distances.min(axis=0) >= 0)[self._slots]
        return inside if self._chosen is None else inside & self._chosen

    def opaque_bins(self, inside: Marks) -> list[Bin]:
        """The opaque instances among those marked."""
        return self._bins(np.flatnonzero(inside[: self._opaque]))

    def transparent_bins(self, inside: Marks, eye: Vec3) -> list[Bin]:
        """The transparent instances among those marked, far to near, neighbours of one kind in one Bin."""
        if self._opaque == self._behind:
            return []
        chosen = np.flatnonzero(inside[self._opaque : self._behind]) + self._opaque
        distances = ((self._spheres[self._slots[chosen], :3] - eye) ** 2).sum(axis=1)
        chosen = chosen[np.argsort(-distances, kind="stable")]
        kinds = self._bin_of[chosen]
        borders = np.flatnonzero(np.diff(kinds, prepend=-1, append=-1))
        return self._cut(chosen, kinds[borders[:-1]].tolist(), borders.tolist())

    def front_bins(self, inside: Marks) -> list[Bin]:
        """The instances among those marked that are drawn in front of everything."""
        if self._behind == len(self):
            return []
        return self._bins(np.flatnonzero(inside[self._behind :]) + self._behind)

    def caster_bins(self, sun: Sun, centre: Vec3, radius: float) -> list[Bin]:
        """Those chosen whose shadow can fall into the sphere, wherever they are themselves."""
        if not sun.shadows:
            return []
        offsets = self._spheres[:, :3] - centre
        along = offsets @ np.array(sun.direction.normalized())
        limits = self._spheres[:, 3] + radius
        # Seen along the light, the two spheres must overlap, and the caster must not lie behind.
        aside = np.einsum("ni,ni->n", offsets, offsets) - along * along
        reaching = ((aside <= limits * limits) & (along <= limits))[self._slots[: self._casters]]
        if self._chosen is not None:
            reaching &= self._chosen[: self._casters]
        return self._bins(np.flatnonzero(reaching))

    def first_met(self, line: Line) -> Pick | None:
        """What of those chosen a ray meets first; what is drawn in front of everything comes before all else."""
        begins = entries(line, self._spheres)[self._slots]
        if self._chosen is not None:
            begins[~self._chosen] = np.inf
        return self._first(line, begins, self._behind, len(self)) or self._first(line, begins, 0, self._behind)

    def _first(self, line: Line, begins: FloatArray, start: int, end: int) -> Pick | None:
        nearest, found = line.far, None
        order = np.argsort(begins[start:end], kind="stable") + start
        for k in order[: np.isfinite(begins[start:end]).sum()].tolist():
            if begins[k] > nearest:
                break
            instance, matrix = self._ordered[k], self._matrices[self._slots[k]].astype(np.float64)
            met = cross(line._replace(far=nearest), instance.drawable.mesh, matrix)
            if met is not None and (found is None or met.t < nearest):
                nearest, found = met.t, (instance, met)
        if found is None:
            return None
        instance, met = found
        normal = Vec3(*met.normal.tolist()).normalized()
        if normal.dot(line.direction) > 0.0:
            normal = -normal
        point = Vec3(*(line.origin + met.t * line.direction).tolist())
        return Pick(instance.trail.nodes(), instance.drawable, met.triangle, point, normal, met.t)

    def _bins(self, chosen: Selection) -> list[Bin]:
        """The instances at the given positions, which must ascend, one Bin per kind."""
        return self._cut(chosen, range(len(self._keys)), np.searchsorted(chosen, self._starts).tolist())

    def _cut(self, chosen: Selection, kinds: Sequence[int], borders: Sequence[int]) -> list[Bin]:
        """Bins of the instances at the given positions: one for each kind, between two of the borders."""
        slots = self._slots[chosen]
        matrices, spheres = self._matrices.take(slots, axis=0), self._spheres.take(slots, axis=0)
        return [
            Bin(*self._keys[kind], matrices[first:end], spheres[first:end], self._mirrored[kind])
            for kind, (first, end) in zip(kinds, pairwise(borders), strict=True)
            if first < end
        ]


def _rank(look: Appearance) -> tuple[bool, bool, bool]:
    return look.in_front, look.transparent, look.unlit


def largest_scales(linear: FloatArray) -> FloatArray:
    """By how much each 3x3 matrix stretches lengths at the most: (n, 3, 3) gives (n,).

    Exact where the columns are perpendicular (a rotation of an uneven scale), else up to 1.32 times too large: the
    greatest row sum of ``A.T @ A`` is at least its greatest eigenvalue, the square of the stretch (Gershgorin), and
    at most sqrt(3) times that.
    """
    gram = np.abs(np.einsum("nki,nkj->nij", linear, linear))
    return np.asarray(np.sqrt(gram.sum(axis=2).max(axis=1, initial=0.0)))


def frustum_planes(view: View, aspect: float) -> FloatArray:
    """The six planes about what a camera sees: (6, 4) with ``plane . (x, y, z, 1)`` metres inwards of each.

    The rows of the clip matrix combine to them: a point is inside where ``-w <= x, y, z <= w``
    (G. Gribb and K. Hartmann, "Fast Extraction of Viewing Frustum Planes", 2001).
    """
    clip = view.projection_matrix(aspect) @ view.view_matrix()
    planes = np.concatenate([clip[3] + clip[:3], clip[3] - clip[:3]])
    return np.asarray(planes / np.sqrt((planes[:, :3] ** 2).sum(axis=1, keepdims=True)))


def visible_sphere(view: View, aspect: float, distance: float) -> tuple[Vec3, float]:
    """The smallest sphere about what a camera sees up to ``distance`` metres of depth: its centre and its radius."""
    distance = min(distance, view.far)
    spread = math.tan(view.field_of_view / 2) * math.hypot(1.0, aspect)
    # Through the eye and the far corners; where the view is so wide that this lies past them, about the far side alone.
    ahead = min(distance * (1.0 + spread * spread) / 2, distance)
    radius = max(ahead, spread * distance)
    return view.pose.transform((0.0, 0.0, -ahead)), radius
