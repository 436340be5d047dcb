"""Stand-ins for physics, and short ways to make nodes, for the tests of pictures."""

from __future__ import annotations

import numpy as np

from osgode.graph.appearance import Appearance
from osgode.graph.frame import Bin
from osgode.graph.leaf import Leaf
from osgode.graph.node import Group
from osgode.graph.shapes import sphere_drawable
from osgode.graph.transforms import PoseSource, PositionAttitudeTransform, Transform
from osgode.maths import FloatArray, Pose

RED = Appearance((1, 0, 0))


class World(Group):
    """Stands in for a physics World: poses in a table, counted readings."""

    def __init__(self, poses: list[Pose]) -> None:
        super().__init__(name="world")
        self.poses = poses
        self.asked: list[float] = []

    def matrices(self, interpolation: float) -> FloatArray:
        self.asked.append(interpolation)
        return np.array([pose.matrix() for pose in self.poses])


class Body(Transform):
    """Stands in for a Body: a row of a World's table."""

    def __init__(self, source: PoseSource, row: int) -> None:
        super().__init__()
        self.source, self.row = source, row

    def local_matrix(self) -> FloatArray:
        raise AssertionError("a body in a World is drawn from the World's table")

    def pose_row(self) -> tuple[PoseSource, int]:
        return self.source, self.row


def at(x: float, y: float = 0.0, z: float = 0.0) -> PositionAttitudeTransform:
    return PositionAttitudeTransform(position=(x, y, z))


def ball(look: Appearance = RED, radius: float = 0.5) -> Leaf:
    return Leaf([sphere_drawable(radius, look)])


def places(bins: list[Bin]) -> list[tuple[float, ...]]:
    """Where the instances of the bins are, in order."""
    return [tuple(np.round(matrix[:3, 3].astype(np.float64), 4).tolist()) for each in bins for matrix in each.matrices]
