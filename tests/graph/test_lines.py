"""Nodes that show lines: what of them is in a Frame, and in whose axes."""

import numpy as np
import pytest

from osgode.errors import FieldError
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import Lines, View
from osgode.graph.leaf import Switch
from osgode.graph.lines import LineSet
from osgode.graph.node import Group
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform, Transform
from osgode.maths import Pose, Quat, Vec3

RED = (1.0, 0.0, 0.0, 1.0)
LINE = Lines([[(0, 0, 0), (1, 2, 3)]], RED)


class Moving(LineSet):
    """Its lines tell the interpolation that was asked for."""

    def lines(self, interpolation):
        return (Lines([[(0, 0, 0), (interpolation, 0, 0)]], RED),)


class Table(Group):
    """Stands in for a World."""

    def __init__(self, *poses):
        super().__init__()
        self.poses = poses

    def matrices(self, interpolation):
        return np.array([pose.matrix() for pose in self.poses]) * 1.0


class Row(Transform):
    """Stands in for a Body."""

    def __init__(self, source, row):
        super().__init__()
        self.source, self.row = source, row

    def local_matrix(self):
        return np.identity(4)

    def pose_row(self):
        return self.source, self.row


def lines_in(root, interpolation=1.0):
    return CullVisitor(root).cull(View(), (40, 30), interpolation).lines


def test_lines_come_as_they_are():
    """In the axes of the root nothing is copied."""
    root = Group()
    root.attach(LineSet(LINE))
    (found,) = lines_in(root)
    assert found is LINE


def test_they_are_asked_for_each_picture():
    root = Group()
    node = root.attach(Moving())
    visitor = CullVisitor(root)
    for interpolation in (0.25, 0.5):
        frame = visitor.cull(View(), (40, 30), interpolation)
        assert frame.lines[0].points[0, 1].tolist() == [interpolation, 0, 0]
    still = root.attach(LineSet())
    assert len(visitor.cull(View(), (40, 30)).lines) == 1
    still.show([LINE, LINE])  # without a change of the tree
    assert len(visitor.cull(View(), (40, 30)).lines) == 3
    node.visible = False
    assert visitor.cull(View(), (40, 30)).lines == [LINE, LINE]


def test_hidden_ones_are_not_asked():
    class Silent(LineSet):
        def lines(self, interpolation):
            raise AssertionError(interpolation)

    root = Group()
    root.attach(Switch(on=False)).attach(Silent())
    root.attach(Silent(visible=False))
    assert lines_in(root) == []


def test_transforms_above_move_them():
    """v_root = outer @ inner @ v, at each parent of its own."""
    root = Group()
    outer = root.attach(PositionAttitudeTransform(position=(10, 0, 0), scale=2.0))
    inner = outer.attach(PositionAttitudeTransform(rotation=Quat.from_axis_angle((0, 0, 1), np.pi / 2)))
    shared = LineSet(Lines(LINE.points, RED, in_front=True, width=3.0))
    inner.attach(shared)
    root.attach(shared)
    moved, plain = lines_in(root)
    assert np.allclose(moved.points, [[(10, 0, 0), (10 - 4, 2, 6)]])
    assert np.allclose(plain.points, LINE.points)
    assert moved.in_front
    assert moved.width == 3.0
    assert moved.colours.tolist() == [[255, 0, 0, 255]]


def test_bodies_above_move_them():
    """v_root = matrix of the table's axes @ pose @ matrix within the body @ v."""
    root = Group()
    table = root.attach(MatrixTransform(np.diag([2.0, 2.0, 2.0, 1.0]))).attach(Table(Pose(), Pose(Vec3(0, 5, 0))))
    body = table.attach(Row(table, 1))
    body.attach(PositionAttitudeTransform(position=(1, 0, 0))).attach(LineSet(LINE))
    (found,) = lines_in(root)
    assert np.allclose(found.points, [[(2, 10, 0), (4, 14, 6)]])


@pytest.mark.parametrize("given", [5, [LINE, 5], "lines", None])
def test_only_lines_can_be_shown(given):
    with pytest.raises(FieldError, match="is no Lines"):
        LineSet(given)
