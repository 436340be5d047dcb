"""Marks: joints drawn over the bodies that they hold."""

from __future__ import annotations

import weakref
from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

import numpy as np

from osgode.errors import FieldError, shown
from osgode.fields import number
from osgode.graph.appearance import Appearance
from osgode.graph.arrows import arrow_mesh
from osgode.graph.drawable import Drawable
from osgode.graph.node import Group, Node
from osgode.graph.primitives import cylinder_mesh, sphere_mesh
from osgode.graph.transforms import PoseSource, Transform
from osgode.joints.base import Joint
from osgode.joints.motors import _Motor
from osgode.joints.plane2d import Plane2D
from osgode.joints.spots import BODY1, BODY2, Coordinate
from osgode.maths import FloatArray, Quat, Vec3
from osgode.nodes.world import World

AXES = ((0.95, 0.12, 0.1, 1.0), (0.15, 0.75, 0.15, 1.0), (0.2, 0.4, 1.0, 1.0))
"""Colours of the first, second and third axis."""
SIDES = ((1.0, 0.85, 0.1, 1.0), (0.1, 0.9, 1.0, 0.4))
"""Colours of the anchor as body 1 has it, a ball, and as body 2 or the static world has it, a halo about that ball."""
LINE = (1.0, 1.0, 1.0, 1.0)
BALLS, THIN = (0.07, 0.13), 0.02
"""Radii of ball, halo and line, for marks of size 1."""
SHORTEST, LONGEST = 1e-6, 1e4
"""Metres: shorter lines aren't drawn; that of the mesh of a line, which is shrunk, see `PoseSource.matrices`."""

UNTURNED = 2
"""Beside BODY1 and BODY2 as a way to be carried: moved by body 1, but not turned."""
UNIT = (Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0))

State: TypeAlias = list[tuple[Joint, object, object, bool]]


def joint_marks(joints: World | Joint | Iterable[Joint], *, size: float = 0.3) -> Group:
    """A node that draws joints through the bodies, as they are in each picture: anchors, axes and rods.

    Attach it to the World, or to a group in whose axes the World stands. It takes note of joints that come, go, are
    anchored anew or are disabled when an `UpdateVisitor` comes by; those that hold nothing are left out.

    - a yellow ball: the anchor as ``body1`` has it, or ``body1``'s centre of mass where the kind has no anchor; a blue
      halo: the same as ``body2``, or the static world, has it. A white line joins them where they are apart: a rod,
      the way of a slider or of a suspension, an error.
    - an arrow, red, green or blue: the first, second or third axis, with a ring where it may turn (positive angles go
      the way of the ring's arrow), with a second head where it may slide.

    Args:
        joints: those of a World, all of them at any time; or one, or several.
        size: length of the arrows, metres.

    Raises:
        FieldError: for anything else, or a size that isn't above 0.
    """
    length = number(1e-6, 1e6)("joint_marks()", "size", size)
    given: weakref.ref[World] | tuple[Joint, ...]
    if isinstance(joints, World):
        given = weakref.ref(joints)
    else:
        given = (joints,) if isinstance(joints, Joint) else tuple(joints) if isinstance(joints, Iterable) else ()
        if not all(isinstance(joint, Joint) for joint in given) or (not given and not isinstance(joints, Iterable)):
            raise FieldError(f"joint_marks().joints is {shown(joints)}; it must be a World, a Joint, or several Joints")
    return _Marks(given, length)


class _Rider(NamedTuple):
    """A mark that a body carries: ``at`` is its place in the world at rest. A motor is asked for axis ``number``."""

    joint: int
    carrier: int
    at: FloatArray
    number: int = -1


class _Line(NamedTuple):
    """A mark between a point that body 1 carries and one that body 2 carries."""

    joint: int
    start: FloatArray
    end: FloatArray


class _Mark(Transform):
    """One thing to see, which a row of the table of the marks moves."""

    def __init__(self, row: int, drawable: Drawable) -> None:
        super().__init__()
        self._row = row
        self._shown = (drawable,)

    def local_matrix(self) -> FloatArray:
        return np.identity(4)

    def pose_row(self) -> tuple[PoseSource, int] | None:
        marks = self.parent
        return (marks, self._row) if isinstance(marks, _Marks) else None

    def drawables(self) -> tuple[Drawable, ...]:
        return self._shown


class _Marks(Group):
    """The marks, and the table of their poses.

    Nothing is done for a mark between two pictures, and for a picture little: what a mark rides on is known when it is
    made, as the matrix that it had while its joint was at rest.
    """

    def __init__(self, joints: weakref.ref[World] | tuple[Joint, ...], size: float) -> None:
        super().__init__(name="joint marks")
        self._given = joints
        self._size = size
        self._state: State = []
        self._rests: list[tuple[FloatArray, ...]] = []
        self._bases: list[Vec3] = []
        self._rows: list[_Rider | _Line] = []
        self.on_update(_refresh)
        self.refresh()

    # -- what there is to see

    def refresh(self) -> None:
        """Mark what is there now."""
        joints: Iterable[Joint] = ()
        if isinstance(self._given, tuple):
            joints = self._given
        elif (world := self._given()) is not None:
            joints = world.joints
        state: State = [(joint, joint._rest, joint._spots, joint.is_live and joint.enabled) for joint in joints]
        same = len(state) == len(self._state)
        if same and all(
            new is old for pair in zip(state, self._state, strict=True) for new, old in zip(*pair, strict=True)
        ):
            return
        self._state = state
        for child in self.children:
            self.detach(child)
        self._rows = []
        self._rests = [tuple(rest.inverse().matrix() for rest in joint._rest) for joint, *_ in self._state]
        self._bases = [joint._load_point() for joint, *_ in self._state]
        for k, (joint, _, _, shown_now) in enumerate(self._state):
            if shown_now:
                self._mark(k, joint)

    def _mark(self, k: int, joint: Joint) -> None:
        points = [joint._spots[name] for name, spot in joint.SPOTS.items() if spot.is_point] or [self._bases[k]]
        ends = points[0], points[-1]
        axes = [(joint._spots[name], spot.side) for name, spot in joint.SPOTS.items() if not spot.is_point]
        free = len(_free_axes(joint))
        for side in (BODY1,) if free else (BODY1, BODY2):  # without a place of its own nothing can be apart
            look = Appearance(SIDES[side], unlit=side == BODY2, in_front=True)
            ball = Drawable(sphere_mesh(), look, np.diag([BALLS[side] * self._size] * 3 + [1.0]))
            self._add(_Rider(k, side, _at(ends[side], UNIT[2])), ball)
        if not free:
            thin = THIN * self._size
            look = Appearance(LINE, unlit=True, in_front=True)
            line = Drawable(cylinder_mesh(), look, np.diag([thin, thin, LONGEST, 1.0]))
            self._add(_Line(k, *(np.array([*end, 1.0]) for end in ends)), line)
        for n, (axis, side) in enumerate(axes):
            self._add(_Rider(k, side, _at(ends[side], axis)), self._arrow(joint, n, len(axes)))
        for n in range(free):
            self._add(_Rider(k, UNTURNED, np.identity(4), n), self._arrow(joint, n, free))

    def _arrow(self, joint: Joint, n: int, count: int) -> Drawable:
        units = _units(type(joint), n, count)
        mesh = arrow_mesh(slides="m" in units, turns="rad" in units or not units)
        matrix = np.diag([self._size] * 3 + [1.0])
        return Drawable(mesh, Appearance(AXES[n], shininess=0.0, in_front=True), matrix)

    def _add(self, row: _Rider | _Line, drawable: Drawable) -> None:
        self.attach(_Mark(len(self._rows), drawable))
        self._rows.append(row)

    # -- where it is

    def matrices(self, interpolation: float) -> FloatArray:
        """The places of the marks in the axes of the World, as in `PoseSource`."""
        tables: dict[int, FloatArray] = {}
        carriers = np.zeros((len(self._state), 3, 4, 4))  # 0: shrunk to nothing, for a joint that isn't live just now
        for k, (joint, *_) in enumerate(self._state):
            world = joint.body1.world
            if not joint.is_live or world is None:
                continue
            if id(world) not in tables:
                tables[id(world)] = world.matrices(interpolation)
            carriers[k] = np.identity(4)
            for side, body in enumerate(joint._bodies):
                carriers[k, side] = tables[id(world)][body._index] @ self._rests[k][side]
            base = np.array([*self._bases[k], 1.0])
            carriers[k, UNTURNED, :, 3] += carriers[k, BODY1] @ base - base
        result = np.zeros((len(self._rows), 4, 4))
        riders = [(k, mark) for k, mark in enumerate(self._rows) if isinstance(mark, _Rider)]
        lines = [(k, mark) for k, mark in enumerate(self._rows) if isinstance(mark, _Line)]
        if riders:
            at = np.array([mark.at if mark.number < 0 else self._free(mark) for _, mark in riders])
            places = [mark.joint for _, mark in riders], [mark.carrier for _, mark in riders]
            result[[k for k, _ in riders]] = carriers[places] @ at
        if lines:
            joints = [mark.joint for _, mark in lines]
            starts = np.einsum("nij,nj->ni", carriers[joints, BODY1], np.array([mark.start for _, mark in lines]))
            ends = np.einsum("nij,nj->ni", carriers[joints, BODY2], np.array([mark.end for _, mark in lines]))
            for n in np.flatnonzero(np.abs(ends - starts).max(axis=1) > SHORTEST):
                result[lines[n][0]] = _between(starts[n], ends[n])
        result[:, 3] = (0.0, 0.0, 0.0, 1.0)
        return result

    def _free(self, mark: _Rider) -> FloatArray:
        return _at(self._bases[mark.joint], _free_axes(self._state[mark.joint][0])[mark.number])


def _refresh(node: Node) -> None:
    if isinstance(node, _Marks):
        node.refresh()


def _free_axes(joint: Joint) -> tuple[Vec3, ...]:
    """The axes of a joint that has no point to draw them at."""
    if isinstance(joint, _Motor):
        return joint.axes
    return UNIT if isinstance(joint, Plane2D) else ()


def _units(kind: type[Joint], n: int, count: int) -> set[str]:
    """What the motion along an axis is counted in: "rad", "m", both, or none where nothing is counted.

    Coordinates and motors have the number of their axis; those beyond the last axis are about or along the first.
    """
    found = [
        (value.index, value.unit)
        for base in kind.__mro__
        for name, value in vars(base).items()
        if isinstance(value, Coordinate) and not name.startswith("length")  # a rod's lies along no axis
    ]
    found += [
        (int(name[14:] or 1) - 1, field.unit)
        for name, field in kind.FIELDS.items()
        if name.startswith("motor_velocity")
    ]
    return {unit.partition("/")[0] for index, unit in found if (index if index < count else 0) == n}


def _at(point: Vec3, direction: Vec3) -> FloatArray:
    """The matrix that turns z into a direction, and moves the origin to a point."""
    length = direction.length
    matrix = np.identity(4)
    if length > 0.0:
        matrix[:3, :3] = Quat.between(UNIT[2], direction / length).to_matrix()
    matrix[:3, 3] = point
    return matrix


def _between(start: FloatArray, end: FloatArray) -> FloatArray:
    """The matrix that makes the mesh of a line one from a point to another."""
    first, last = Vec3(*map(float, start[:3])), Vec3(*map(float, end[:3]))
    way = last - first
    matrix = _at((first + last) / 2, way)
    matrix[:3, 2] *= way.length / LONGEST
    return matrix
