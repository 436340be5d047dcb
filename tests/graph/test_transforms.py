"""Transforms: their matrices and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.errors import FieldError
from osgode.graph.node import Group
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform, Transform
from osgode.maths import IDENTITY, Pose, Quat, Vec3

lengths = st.floats(-100, 100).map(lambda x: round(x, 6))
vectors = st.tuples(lengths, lengths, lengths)
quaternions = st.tuples(*[st.floats(-10, 10).map(lambda x: round(x, 6))] * 4).filter(lambda q: math.hypot(*q) > 1e-3)
factors = st.floats(0.01, 100)


def test_quarter_turn_by_hand() -> None:
    """A quarter turn about Y takes +X to -Z; scale comes before, position after."""
    node = PositionAttitudeTransform(
        position=(10, 20, 30), rotation=Quat.from_axis_angle((0, 1, 0), math.pi / 2), scale=(2, 3, 4)
    )
    expected = [[0, 0, 4, 10], [0, 3, 0, 20], [-2, 0, 0, 30], [0, 0, 0, 1]]
    assert node.local_matrix() == pytest.approx(np.array(expected), abs=1e-12)


@given(vectors, quaternions, st.tuples(factors, factors, factors), vectors)
def test_matrix_agrees_with_the_formula(
    position: tuple[float, ...],
    rotation: tuple[float, ...],
    scale: tuple[float, float, float],
    point: tuple[float, float, float],
) -> None:
    """The matrix does what ``position + rotation(scale * v)`` does, and a rotation of any length counts."""
    node = PositionAttitudeTransform(position=position, rotation=rotation, scale=scale)
    assert math.hypot(*node.rotation) == pytest.approx(1.0)
    scaled = [a * b for a, b in zip(scale, point, strict=True)]
    expected = node.pose.transform(scaled)
    assert (node.local_matrix() @ (*point, 1.0))[:3] == pytest.approx(np.array(expected), abs=1e-7)


def test_setting_replaces_the_matrix() -> None:
    """After each property is set, the matrix says the same."""
    node = PositionAttitudeTransform()
    assert np.array_equal(node.local_matrix(), np.identity(4))
    node.position = (1, 2, 3)
    assert node.local_matrix()[:3, 3].tolist() == [1, 2, 3]
    node.scale = 2
    assert node.local_matrix()[:3, :3].tolist() == [[2, 0, 0], [0, 2, 0], [0, 0, 2]]
    node.rotation = (0, 0, 0, 5)
    assert node.local_matrix()[:3, :3].tolist() == [[-2, 0, 0], [0, -2, 0], [0, 0, 2]]
    node.pose = Pose(Vec3(4, 5, 6))
    assert (node.position, node.rotation) == (Vec3(4, 5, 6), IDENTITY)
    assert node.local_matrix()[:3].tolist() == [[2, 0, 0, 4], [0, 2, 0, 5], [0, 0, 2, 6]]


def test_numpy_values_are_taken_and_given_back_as_plain_floats() -> None:
    """Arrays may be given; what comes back is a Vec3 or Quat of Python floats."""
    node = PositionAttitudeTransform(
        position=np.array([1, 2, 3], np.float32), rotation=np.array([1.0, 0, 0, 0]), scale=np.float32(2)
    )
    assert node.position == Vec3(1, 2, 3)
    assert node.scale == Vec3(2, 2, 2)
    assert {type(part) for part in (*node.position, *node.rotation, *node.scale)} == {float}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("position", (1, 2)),
        ("position", (1, 2, math.inf)),
        ("position", "abc"),
        ("position", None),
        ("rotation", (1, 0, 0)),
        ("rotation", (0, 0, 0, 0)),
        ("rotation", (math.nan, 0, 0, 1)),
        ("scale", 0),
        ("scale", (1, -1, 1)),
        ("scale", math.inf),
    ],
)
def test_bad_values_are_refused(name: str, value: object) -> None:
    """A bad value raises in the line that wrote it, names node and property, and changes nothing."""
    node = PositionAttitudeTransform(position=(1, 2, 3), name="lamp")
    before, revision = node.local_matrix().copy(), node._revision
    with pytest.raises(FieldError, match=rf"'lamp'\.{name}"):
        setattr(node, name, value)
    assert np.array_equal(node.local_matrix(), before)
    assert node._revision == revision
    with pytest.raises(FieldError, match=name):
        PositionAttitudeTransform(**{name: value})  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_extreme_quaternions_are_normalised(size: float) -> None:
    """A rotation whose length would underflow or overflow when squared still has a direction."""
    node = PositionAttitudeTransform(rotation=(size, size, size, size))
    assert node.rotation == pytest.approx((0.5, 0.5, 0.5, 0.5))


def test_changes_reach_the_root() -> None:
    """Every setter is noted above."""
    root = Group()
    node = root.attach(PositionAttitudeTransform())
    general = root.attach(MatrixTransform())
    seen = [root._revision]
    for change in (
        lambda: setattr(node, "position", (1, 0, 0)),
        lambda: setattr(node, "rotation", (1, 1, 0, 0)),
        lambda: setattr(node, "scale", 3),
        lambda: setattr(node, "pose", Pose()),
        lambda: setattr(general, "matrix", np.diag([2, 2, 2, 1])),
        lambda: setattr(general, "absolute", True),
    ):
        change()
        seen.append(root._revision)
    assert sorted(set(seen)) == seen


def test_matrices_are_read_only() -> None:
    """Nobody can change a matrix behind a transform's back."""
    for node in (PositionAttitudeTransform(), MatrixTransform()):
        with pytest.raises(ValueError, match="read-only"):
            node.local_matrix()[0, 0] = 2


def test_matrix_transform_checks_its_matrix() -> None:
    """A matrix transform refuses what is not affine and keeps what it had."""
    node = MatrixTransform(np.diag([2.0, 3.0, 4.0, 1.0]))
    with pytest.raises(FieldError, match=r"MatrixTransform\.matrix"):
        node.matrix = np.zeros((4, 4))
    assert np.diag(node.matrix).tolist() == [2, 3, 4, 1]


def test_transform_is_abstract() -> None:
    """A transform without a matrix can't be made."""
    with pytest.raises(TypeError, match="local_matrix"):
        Transform()  # type: ignore[abstract]


def test_plain_transforms_have_no_pose_row() -> None:
    """What isn't moved by physics has no row in a table, and is relative unless told otherwise."""
    assert PositionAttitudeTransform().pose_row() is None
    assert not PositionAttitudeTransform().absolute
    assert MatrixTransform(absolute=True).absolute
