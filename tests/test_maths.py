"""Vectors, quaternions, poses and matrices against their definitions and against numpy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import osgode as oo
from osgode.maths import finite, pose_matrices
from tests.strategies import directions, floats, poses, rotations, vectors

X, Y, Z = oo.Vec3(1, 0, 0), oo.Vec3(0, 1, 0), oo.Vec3(0, 0, 1)


def near(one, other, tolerance=1e-12):
    return one == pytest.approx(other, abs=tolerance)


@given(vectors(), vectors(), floats(-5, 5))
def test_vectors_compute_as_numpy_does(a, b, factor):
    assert tuple(a + b) == tuple(np.add(a, b))
    assert tuple(a - b) == tuple(np.subtract(a, b))
    assert tuple(a * factor) == tuple(factor * a) == tuple(np.multiply(a, factor))
    assert tuple(-a) == tuple(np.negative(a))
    assert near(a.dot(b), np.dot(a, b))
    assert near(tuple(a.cross(b)), tuple(np.cross(a, b)))
    assert near(a.length, np.linalg.norm(a))
    assert near(a.distance(b), np.linalg.norm(np.subtract(a, b)))


def test_vectors_take_tuples_on_both_sides():
    other = (1, 2, 3)
    assert X + other == other + X == (2, 2, 3)
    assert X - other == (0, -2, -3)
    assert other - X == (0, 2, 3)
    assert oo.Vec3(2, 4, 6) / 2 == (1, 2, 3)
    assert all(type(v) is oo.Vec3 for v in (X + other, other + X, other - X, 2 * X, X / 2, -X))


def test_axes_are_right_handed():
    assert X.cross(Y) == Z
    assert Y.cross(Z) == X
    assert Z.cross(X) == Y


@given(directions())
def test_a_normalized_vector_has_length_1_and_the_same_direction(v):
    assert near(v.normalized().length, 1.0)
    assert near(v.normalized().dot(v), v.length)


def test_a_vector_of_length_0_has_no_direction():
    with pytest.raises(ZeroDivisionError):
        oo.Vec3(0, 0, 0).normalized()


@pytest.mark.parametrize(("axis", "turned", "into"), [(X, Y, Z), (Y, Z, X), (Z, X, Y)])
def test_a_quarter_turn_follows_the_right_hand(axis, turned, into):
    assert near(tuple(oo.Quat.from_axis_angle(axis, math.pi / 2).rotate(turned)), tuple(into))


@given(directions(), floats(-math.pi, math.pi))
def test_a_rotation_about_an_axis_keeps_the_axis_and_has_the_angle(axis, angle):
    turn = oo.Quat.from_axis_angle(axis, angle)
    assert near(tuple(turn.rotate(axis)), tuple(axis))
    assert near(turn.angle, abs(angle))


@given(rotations(), vectors())
def test_a_rotation_is_its_matrix(turn, v):
    """``v_target = matrix @ v_source``, and the matrix is orthonormal with determinant 1."""
    matrix = np.array(turn.to_matrix())
    assert near(tuple(turn.rotate(v)), tuple(matrix @ v))
    assert near(matrix @ matrix.T, np.identity(3))
    assert near(np.linalg.det(matrix), 1.0)


@given(rotations(), rotations(), vectors())
def test_a_product_turns_by_the_right_factor_first(a, b, v):
    assert near(tuple((a * b).rotate(v)), tuple(a.rotate(b.rotate(v))))


@given(rotations(), vectors())
def test_the_conjugate_turns_back(turn, v):
    assert near(tuple(turn.conjugate().rotate(turn.rotate(v))), tuple(v))


@given(rotations())
def test_a_matrix_gives_its_rotation_back(turn):
    """For q and -q are one rotation."""
    back = oo.Quat.from_matrix(turn.to_matrix())
    assert near(abs(sum(a * b for a, b in zip(turn, back, strict=True))), 1.0)
    assert all(type(part) is float for part in oo.Quat.from_matrix(np.array(turn.to_matrix())))


@given(directions(), directions())
def test_between_is_the_shortest_turn(start, end):
    turn = oo.Quat.between(start, end)
    assert near(tuple(turn.rotate(start.normalized())), tuple(end.normalized()), 1e-7)
    cosine = max(-1.0, min(1.0, start.normalized().dot(end.normalized())))
    assert turn.angle == pytest.approx(math.acos(cosine), abs=1e-6)


@pytest.mark.parametrize("v", [X, Y, Z, oo.Vec3(1, 2, -3), oo.Vec3(-1, 1e-9, 0)])
def test_between_opposite_directions_is_half_a_turn(v):
    turn = oo.Quat.between(v, -v)
    assert near(turn.angle, math.pi)
    assert near(tuple(turn.rotate(v)), tuple(-v), 1e-9)


@given(floats(-3, 3), floats(-1.5, 1.5), floats(-3, 3))
def test_yaw_pitch_roll_turn_about_y_x_z_from_right_to_left(yaw, pitch, roll):
    """With R = Ry(yaw) Rx(pitch) Rz(roll), where it looks is R applied to -Z."""
    look = oo.Quat.from_yaw_pitch_roll(yaw, pitch, roll).rotate((0, 0, -1))
    assert near(
        tuple(look), (-math.sin(yaw) * math.cos(pitch), math.sin(pitch), -math.cos(yaw) * math.cos(pitch)), 1e-9
    )
    up = oo.Quat.from_yaw_pitch_roll(0, 0, roll).rotate((0, 1, 0))
    assert near(tuple(up), (-math.sin(roll), math.cos(roll), 0), 1e-9)


@given(poses(), poses(), vectors())
def test_poses_compose_as_their_matrices_do(a, b, point):
    assert near((a * b).matrix(), a.matrix() @ b.matrix(), 1e-9)
    assert near(tuple(a.transform(point)), tuple((a.matrix() @ [*point, 1])[:3]), 1e-9)


@given(poses(), vectors())
def test_the_inverse_of_a_pose_leads_back(pose, point):
    assert near(tuple(pose.inverse().transform(pose.transform(point))), tuple(point), 1e-9)
    assert near((pose * pose.inverse()).matrix(), np.identity(4), 1e-9)


@given(st.lists(poses(), max_size=5))
def test_many_matrices_are_the_matrices_of_each(some):
    """The numpy table and the plain floats give the same."""
    table = pose_matrices(
        np.array([p.position for p in some]).reshape(-1, 3), np.array([p.rotation for p in some]).reshape(-1, 4)
    )
    assert table.shape == (len(some), 4, 4)
    for matrix, pose in zip(table, some, strict=True):
        assert near(matrix, pose.matrix())


@given(vectors(), vectors())
def test_look_at_looks_there(eye, target):
    if eye.distance(target) < 1e-3:
        return
    pose = oo.look_at(eye, target)
    ahead = pose.rotation.rotate((0, 0, -1))
    assert near(tuple(ahead), tuple((target - eye).normalized()), 1e-6)
    assert pose.position == eye
    assert pose.rotation.rotate((0, 1, 0)).y > -1e-9
    assert near(pose.rotation.rotate((1, 0, 0)).y, 0.0, 1e-6)


def test_finite_says_whether_all_are():
    assert finite([1.0, -2.0])
    assert not finite([1.0, math.inf])
    assert not finite([math.nan, 1.0])
