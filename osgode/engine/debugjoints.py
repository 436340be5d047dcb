"""Joints as lines: anchors, axes, and what they hold together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from osgode.engine.stamps import HEAD, Batch, arrows, colour, scattered
from osgode.engine.wires import octahedron_wire
from osgode.joints.base import Joint
from osgode.joints.marks import _free_axes, _units
from osgode.joints.spots import BODY1, BODY2
from osgode.maths import ZERO, FloatArray, Pose, Vec3
from osgode.nodes.world import World

ANCHORS = (colour(255, 220, 40), colour(60, 225, 255))
"""As body 1 and as body 2, or the static world, has it."""
AXES = (colour(255, 70, 60), colour(60, 230, 70), colour(80, 130, 255))
"""The first, the second, the third."""
HOLDS = (colour(255, 220, 40, 120), colour(60, 225, 255, 120))
"""Lines from the anchor to the centres of mass."""
APART = colour(255, 255, 255)
MARK = 0.12
"""Size of the mark of an anchor, for an axis 1 long."""

Mask: TypeAlias = npt.NDArray[np.bool_]


class _Axis(NamedTuple):
    """An axis of a joint at rest; of a motor, whose axes may turn by themselves, only its number among them."""

    joint: int
    side: int
    direction: Vec3
    number: int
    of: int
    free: bool


class JointLines:
    """What is drawn of the joints of a World. Like `osgode.joint_marks`, but as lines, and all in bulk."""

    def __init__(self) -> None:
        self._state: list[tuple[Joint, tuple[Pose, ...], dict[str, Vec3]]] = []
        self._revision = -1

    def draw(self, batch: Batch, world: World, table: FloatArray, centres: FloatArray, sizes: FloatArray) -> None:
        """Add the lines of the joints that hold something.

        Args:
            batch: what they are added to.
            world: whose joints.
            table: (n, 4, 4), the matrices of its bodies.
            centres: (n, 3), their centres of mass, in the world.
            sizes: (n,), how long axes may be at each, metres.
        """
        joints = world.joints
        state = [(joint, joint._rest, joint._spots) for joint in joints]
        if state != self._state or world._revision != self._revision:  # bodies may have other rows
            self._state, self._revision = state, world._revision
            self._note(joints)
        if not joints:
            return
        on = world.joints_enabled
        table = np.concatenate([table, np.identity(4)[None]])
        middles = np.append(centres, [(0.0, 0.0, 0.0)], axis=0)[self._rows]
        carriers = table[self._rows] @ self._rests
        ends = (carriers @ self._points[..., None])[..., :3, 0]
        ends[self._free, BODY1] = middles[self._free, BODY1]
        sizes = np.append(sizes, np.inf)[self._rows].min(axis=1)
        held = on & ~self._free
        self._draw_holds(batch, ends, middles, held)
        self._draw_axes(batch, joints, on, carriers, (ends, sizes))
        wire = octahedron_wire()
        apart = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > 0.2 * MARK * sizes
        for side, shown, scale in ((BODY2, held & apart, 1.4 * MARK), (BODY1, held, MARK)):
            batch.add(scattered(wire, ends[shown, side], scale * sizes[shown]), ANCHORS[side])

    def _note(self, joints: Sequence[Joint]) -> None:
        """Keep what stays the same while the joints are anchored where they are."""
        count = len(joints)
        rows = [[body._index for body in joint._bodies] for joint in joints]
        self._rows = np.array([[*row, -1][:2] for row in rows], np.intp).reshape(-1, 2)
        self._rests = np.tile(np.identity(4), (count, 2, 1, 1))
        self._points = np.zeros((count, 2, 4))
        self._points[..., 3] = 1.0
        self._free = np.zeros(count, bool)
        """Those without a place of their own: motors, and what keeps a body in a plane."""
        axes: list[_Axis] = []
        for k, joint in enumerate(joints):
            for side, rest in enumerate(joint._rest):
                self._rests[k, side] = rest.inverse().matrix()
            points = [joint._spots[name] for name, spot in joint.SPOTS.items() if spot.is_point]
            points = points or [joint._load_point()]
            self._points[k, :, :3] = points[0], points[-1]
            own = [(joint._spots[name], spot.side) for name, spot in joint.SPOTS.items() if not spot.is_point]
            free = len(_free_axes(joint))
            self._free[k] = free > 0
            axes += [_Axis(k, side, axis, n, len(own), free=False) for n, (axis, side) in enumerate(own)]
            axes += [_Axis(k, BODY1, ZERO, n, free, free=True) for n in range(free)]
        self._axes = axes
        self._owners = np.array([axis.joint for axis in axes], np.intp)
        self._sides = np.array([axis.side for axis in axes], np.intp)
        self._directions = np.array([axis.direction for axis in axes]).reshape(-1, 3)
        self._looks = np.array([AXES[axis.number] for axis in axes], np.uint32)
        slides = ["m" in _units(type(joints[axis.joint]), axis.number, axis.of) for axis in axes]
        self._slides = np.array(slides, bool)

    def _draw_holds(self, batch: Batch, ends: FloatArray, centres: FloatArray, held: Mask) -> None:
        """Lines from each side of the anchor to the body that has it, and from one side to the other."""
        for side, bodies in ((BODY1, held), (BODY2, held & (self._rows[:, BODY2] >= 0))):
            batch.add(np.stack([centres[bodies, side], ends[bodies, side]], axis=1), HOLDS[side])
        batch.add(ends[held], APART)

    def _draw_axes(
        self,
        batch: Batch,
        joints: Sequence[Joint],
        on: Mask,
        carriers: FloatArray,
        places: tuple[FloatArray, FloatArray],
    ) -> None:
        if not self._axes:
            return
        ends, sizes = places
        ways = np.einsum("nij,nj->ni", carriers[self._owners, self._sides, :3, :3], self._directions)
        free = [(k, axis) for k, axis in enumerate(self._axes) if axis.free]
        for k, axis in free:  # few have motors, whose axes may turn by themselves
            ways[k] = _free_axes(joints[axis.joint])[axis.number]
        starts, ways = ends[self._owners, self._sides], ways * sizes[self._owners, None]
        for shown, length in ((on[self._owners], 1.0), (on[self._owners] & self._slides, 1.0 - 0.7 * HEAD)):
            batch.add(arrows(starts[shown], ways[shown], length), self._looks[shown].repeat(5))
