"""The debug overlay: what the physics sees, drawn over what the player sees."""

from __future__ import annotations

import weakref
from collections.abc import Sequence

import numpy as np

from osgode.engine.debugjoints import JointLines
from osgode.engine.stamps import Batch, Colours, Numbers, Stamps, colour, scattered, touches
from osgode.engine.wires import COARSE, FINE, Wire, box_wire, grid_wire, octahedron_wire, pieces_of, plane_matrix
from osgode.errors import FieldError, shown
from osgode.fields import number
from osgode.graph.frame import Lines
from osgode.graph.lines import LineSet
from osgode.graph.node import Group
from osgode.maths import Float32Array, FloatArray, Pose, Vec3, pose_matrices
from osgode.nodes.base import nearest_body
from osgode.nodes.geom import Geom
from osgode.nodes.placeable import Placeable
from osgode.nodes.plane import Plane
from osgode.nodes.ray import Ray
from osgode.nodes.spaces import Space
from osgode.nodes.world import World

ALIVE, RAY, SENSOR = 1, 32, 256
"""Flags of `World.geom_states`."""
NO_RESPONSE = 0x7FFFFFFF
"""As the ``surface`` of a row of `World.contacts`: the hit of a ray."""

AWAKE, ASLEEP = colour(70, 255, 90, 220), colour(45, 125, 80, 150)
KINEMATIC, STATIC = colour(255, 165, 40, 235), colour(90, 150, 255, 130)
FEELS, OFF, LOOKS = colour(255, 70, 225, 235), colour(95, 95, 105, 200), colour(255, 80, 60, 220)
"""Sensors, what is disabled, rays."""
AXES = (colour(255, 60, 50), colour(60, 230, 70), colour(70, 120, 255))
DIM_AXES = (colour(255, 60, 50, 90), colour(60, 230, 70, 90), colour(70, 120, 255, 90))
CENTRE, DIM_CENTRE = colour(255, 230, 40), colour(255, 230, 40, 90)
BOXES, SPACES = colour(255, 140, 40, 110), colour(255, 255, 255, 150)
TOUCH, DEEP, FELT, SEEN = colour(255, 245, 120), colour(255, 30, 20), FEELS, LOOKS
"""Contacts, from barely to deep; those of sensors; hits of rays."""
DEEPEST = 0.01
"""Metres of depth from which on a contact is as red as it gets."""
VISIBLE = 0.002
"""Metres of depth from which on it is shown in its length."""
MANY = 300
"""Geoms above which circles have fewer segments."""
AXIS_WIRES = [np.array([[(0, 0, 0), row]], np.float32) for row in np.identity(3)]
FAR = 100.0
"""Metres: the patch of a plane reaches about as far as the bodies, but no farther than this."""


class DebugOverlay(LineSet):
    """Draws what ODE has of a World as lines, in two draw calls. Attach it to the World, or beside it.

    Nothing runs per body for a picture: what the lines are made of is found when the tree has changed, and moved in
    bulk. Each part can be switched at any time; ``visible`` hides all, and then it costs nothing.

    - ``shapes``: collision shapes, whatever is drawn for them: green what moves, dimmed while it sleeps; orange
      kinematic bodies; blue static geometry; pink sensors, red rays, grey what is disabled.
    - ``axes``: those of each body's frame, red, green, blue for x, y, z; ``centres``: of mass, yellow.
    - ``joints``: the anchors as both bodies have them (yellow, light blue) with a line to each body's centre of mass,
      and one between them where they are apart; the axes, red, green, blue, with two heads where they slide.
    - ``contacts``: of the last step, with normals towards the body that is pushed; yellow to red, which is 1 cm deep or
      more; those of sensors pink, the hits of rays red. A red line shows a large depth in its true length.
    - ``boxes``: of geoms, as the broad phase has them after the last step; ``spaces``: about all that is in a space.

    Args:
        world: what is shown.
        shapes, axes, centres, joints, contacts, boxes, spaces: whether they are shown.
        size: of arrows and marks on large bodies, metres; on small ones they are smaller.

    Raises:
        FieldError: if it isn't a World, or the size not above 0.
    """

    def __init__(
        self,
        world: World,
        *,
        shapes: bool = True,
        axes: bool = False,
        centres: bool = False,
        joints: bool = True,
        contacts: bool = True,
        boxes: bool = False,
        spaces: bool = False,
        size: float = 0.3,
        name: str = "debug overlay",
        visible: bool = True,
    ) -> None:
        if not isinstance(world, World):
            raise FieldError(f"DebugOverlay().world is {shown(world)}; it must be a World")
        super().__init__(name=name, visible=visible)
        self._world = weakref.ref(world)
        self.shapes, self.axes, self.centres = shapes, axes, centres
        self.joints, self.contacts = joints, contacts
        self.boxes, self.spaces = boxes, spaces
        self._size = number(1e-6, 1e6)("DebugOverlay()", "size", size)
        self._revision = -1
        self._joint_lines = JointLines()

    @property
    def size(self) -> float:
        """Of arrows and marks on large bodies, metres."""
        return self._size

    def lines(self, interpolation: float) -> Sequence[Lines]:
        """What is shown: one Lines that things hide, one that they don't."""
        world = self._world()
        if world is None:
            self._joint_lines = JointLines()  # which knows joints, and they their bodies
            return ()
        if world._revision != self._revision:
            self._rebuild(world)
            self._revision = world._revision
        picture = _Picture(world, interpolation)
        if self.shapes:
            self._draw_shapes(picture)
        if self.boxes or self.spaces:
            self._draw_boxes(picture, world)
        if self.axes or self.centres:
            self._draw_bodies(picture)
        if self.joints:
            self._joint_lines.draw(picture.front, world, picture.table, picture.centres, self._sizes)
        if self.contacts:
            self._draw_contacts(picture, world)
        return picture.lines()

    # -- what there is

    def _rebuild(self, world: World) -> None:
        """Take note of every geom, by slot, and of what is known to stay."""
        nodes = [ref() if ref is not None else None for ref in world._live("lines").nodes_by_slot]
        # A slot is remembered for some steps after its geom has left, or has come back with another one.
        nodes = [node if node is not None and node._slot == slot else None for slot, node in enumerate(nodes)]
        geoms = [node for node in nodes if isinstance(node, Geom)]
        placed = [geom for geom in geoms if not isinstance(geom, Plane)]
        parents = [geom.parent for geom in placed]
        bodies = [nearest_body(parent) for parent in parents]
        rows = [-1 if body is None else body._index for body in bodies]
        segments = FINE if len(placed) <= MANY else COARSE
        pieces = [(k, piece) for k, geom in enumerate(placed) for piece in pieces_of(geom, segments)]
        owners = np.array([k for k, _ in pieces], np.intp)
        wires = [piece.wire for _, piece in pieces]
        scales = np.array([piece.scale for _, piece in pieces]).reshape(-1, 3)
        lifts = np.array([piece.lift for _, piece in pieces])
        poses = np.array([(*pose.position, *pose.rotation) for pose in map(_pose_of, parents)])
        poses = poses.reshape(-1, 7)
        matrices = pose_matrices(poses[:, :3], poses[:, 3:])[owners]
        matrices[:, :3, 3] += matrices[:, :3, 2] * lifts[:, None]
        matrices[:, :3, :3] *= scales[:, None]

        slots = np.array([geom._slot for geom in placed], np.intp)
        self._bodies_of = np.full(len(nodes), -1, np.intp)  # by slot; -1: static
        self._bodies_of[slots] = rows
        self._measure(world, placed, (owners, wires, scales, lifts), np.array(rows, np.intp), poses)

        of_body = np.array(rows, np.intp)[owners]
        moving, still = np.flatnonzero(of_body >= 0), np.flatnonzero(of_body < 0)
        self._moving = Stamps([wires[k] for k in moving], matrices[moving], of_body[moving], slots[owners[moving]])
        planes = [geom for geom in geoms if isinstance(geom, Plane)]
        self._still = Stamps(
            [wires[k] for k in still] + [grid_wire()] * len(planes),
            np.concatenate([matrices[still], self._patches(world, planes)]),
            [-1] * (len(still) + len(planes)),
            [*slots[owners[still]], *(plane._slot for plane in planes)],
        )
        self._still_points = self._still.points(np.identity(4)[None])
        self._insides: list[Numbers] | None = None
        self._axes = self._axes_of_bodies()

    def _measure(
        self,
        world: World,
        placed: list[Geom],
        pieces: tuple[Numbers, list[Wire], FloatArray, FloatArray],
        rows: Numbers,
        poses: FloatArray,
    ) -> None:
        """How large geoms and bodies are, so that marks are no larger."""
        owners, wires, scales, lifts = pieces
        corners = {key: np.abs(wire).max(axis=(0, 1)) for key, wire in {id(wire): wire for wire in wires}.items()}
        reach = np.abs(scales) * np.array([corners[id(wire)] for wire in wires]).reshape(-1, 3)
        reach[:, 2] += np.abs(lifts)
        radii = np.zeros(len(placed))
        np.maximum.at(radii, owners, np.linalg.norm(reach, axis=1))
        radii[[isinstance(geom, Ray) for geom in placed]] = 0.0
        moves = (rows >= 0) & (radii > 0.0)
        self._reaches = np.full(len(self._bodies_of), np.inf)
        self._reaches[[placed[k]._slot for k in np.flatnonzero(moves)]] = radii[moves]
        sizes = np.zeros(len(world.poses))
        np.maximum.at(sizes, rows[moves], (radii + np.linalg.norm(poses[:, :3], axis=1))[moves])
        self._sizes = np.where(sizes > 0.0, np.minimum(sizes, self._size), self._size)

    def _patches(self, world: World, planes: list[Plane]) -> FloatArray:
        """Where the patches of planes are: about the bodies."""
        places = world.poses[:, :3] if len(world.poses) else np.zeros((1, 3))
        low, high = np.quantile(places, (0.1, 0.9), axis=0)  # not what has fallen off the edge of the world
        middle = Vec3(*((low + high) / 2).tolist())
        reach = min(max(float((high - low).max()), 10.0), FAR)
        return np.array([plane_matrix(plane, middle, reach) for plane in planes]).reshape(-1, 4, 4)

    def _axes_of_bodies(self) -> Stamps:
        count = len(self._sizes)
        matrices = np.zeros((3, count, 4, 4))
        matrices[..., [0, 1, 2], [0, 1, 2]] = self._sizes[:, None]
        matrices[..., 3, 3] = 1.0
        rows = np.arange(count)
        return Stamps(
            [wire for wire in AXIS_WIRES for _ in range(count)],
            matrices.reshape(-1, 4, 4),
            np.tile(rows, 3),
            np.concatenate([3 * rows + k for k in range(3)]),
        )

    # -- where it is now

    def _draw_shapes(self, picture: _Picture) -> None:
        body = self._bodies_of
        flags, enabled = (picture.geoms[name][: len(body)] for name in ("flags", "enabled"))
        asleep, kinematic = (np.append(picture.bodies[name], 0)[body] != 0 for name in ("asleep", "kinematic"))
        looks = np.where(body < 0, STATIC, np.where(kinematic, KINEMATIC, np.where(asleep, ASLEEP, AWAKE)))
        looks = np.where(flags & SENSOR, FEELS, np.where(flags & RAY, LOOKS, looks))
        looks = np.where(enabled != 0, looks, OFF).astype(np.uint32)
        picture.hidden.add(self._still_points, self._still.colours(looks))
        picture.hidden.add(self._moving.points(picture.table), self._moving.colours(looks, fading=True))

    def _draw_boxes(self, picture: _Picture, world: World) -> None:
        low, high = picture.geoms["low"], picture.geoms["high"]
        finite = np.isfinite(low).all(axis=1) & np.isfinite(high).all(axis=1)
        if self.boxes:
            alive = finite & (picture.geoms["flags"] & ALIVE != 0) & (high > low).any(axis=1)
            picture.hidden.add(_boxes(low[alive], high[alive]), BOXES)
        if self.spaces:
            if self._insides is None:
                self._insides = _insides(world)
            inside = [slots[finite[slots]] for slots in self._insides]
            inside = [slots for slots in inside if len(slots)]
            if inside:
                low, high = (
                    edge.reduceat(ends[np.concatenate(inside)], np.cumsum([0, *map(len, inside[:-1])]), axis=0)
                    for edge, ends in ((np.minimum, low), (np.maximum, high))
                )
                picture.hidden.add(_boxes(low, high), SPACES)

    def _draw_bodies(self, picture: _Picture) -> None:
        dim = picture.bodies["asleep"] != 0
        if self.axes:
            looks = np.where(dim[:, None], DIM_AXES, AXES).astype(np.uint32).reshape(-1)
            picture.front.add(self._axes.points(picture.table), self._axes.colours(looks))
        if self.centres:
            wire = octahedron_wire()
            looks = np.where(dim, DIM_CENTRE, CENTRE).astype(np.uint32)
            picture.front.add(scattered(wire, picture.centres, 0.3 * self._sizes), looks.repeat(len(wire)))

    def _draw_contacts(self, picture: _Picture, world: World) -> None:
        rows = world.contacts
        if not len(rows):
            return
        at, normals = rows["geom"]["pos"][:, :3], rows["geom"]["normal"][:, :3]
        slots = rows["slot1"], rows["slot2"]
        rays = rows["surface"] == NO_RESPONSE
        # ODE's normals point into the first geom, also where that is the one that stands still.
        turned = (self._bodies_of[slots[0]] < 0) & (self._bodies_of[slots[1]] >= 0) & ~rays
        normals = np.where(turned[:, None], -normals, normals)
        flags = picture.geoms["flags"]
        felt = ((flags[slots[0]] | flags[slots[1]]) & SENSOR) != 0
        depth = np.where(rays | felt, 0.0, rows["geom"]["depth"])
        looks = np.where(rays, SEEN, np.where(felt, FELT, _between(TOUCH, DEEP, depth / DEEPEST))).astype(np.uint32)
        sizes = np.minimum(np.minimum(self._reaches[slots[0]], self._reaches[slots[1]]), self._size)
        deep = depth > VISIBLE
        picture.front.add(np.stack([at, at - normals * depth[:, None]], axis=1)[deep], DEEP)
        picture.front.add(touches(at, normals, 0.7 * sizes), looks.repeat(5))


class _Picture:
    """What is known of a World for one picture, and what is drawn of it."""

    def __init__(self, world: World, interpolation: float) -> None:
        self.table = world.matrices(interpolation)
        self.bodies = world.body_states
        self.geoms = world.geom_states
        self.hidden, self.front = Batch(), Batch()

    @property
    def centres(self) -> FloatArray:
        """Of mass, (n, 3)."""
        turned = np.einsum("nij,nj->ni", self.table[:, :3, :3], self.bodies["com"])
        return np.asarray(turned + self.table[:, :3, 3])

    def lines(self) -> list[Lines]:
        """The result."""
        return [*self.hidden.lines(in_front=False), *self.front.lines(in_front=True)]


def _pose_of(parent: Group | None) -> Pose:
    """Where a geom below ``parent`` is in its body, or in the static world."""
    return parent.pose if isinstance(parent, Placeable) else Pose()


def _insides(world: World) -> list[Numbers]:
    """The slots of the geoms in each space, those in spaces within it included."""
    spaces = [node for node in world.walk() if isinstance(node, Space)]
    return [np.array([node._slot for node in space.walk() if isinstance(node, Geom)], np.intp) for space in spaces]


def _boxes(low: FloatArray, high: FloatArray) -> Float32Array:
    return scattered(box_wire(), (low + high) / 2, high - low)


def _between(one: int, other: int, parts: FloatArray) -> Colours:
    """Colours from one (0) to another (1 and above)."""
    ends = np.array([one, other], np.uint32).view(np.uint8).reshape(2, 4).astype(np.float64)
    mixed = ends[0] + np.clip(parts, 0.0, 1.0)[:, None] * (ends[1] - ends[0])
    return np.ascontiguousarray(mixed.round().astype(np.uint8)).view(np.uint32).reshape(-1)
