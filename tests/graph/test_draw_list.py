"""The arithmetic of culling: frustum planes and bounds of matrices."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from osgode.graph.draw_list import frustum_planes, largest_scales, visible_sphere
from osgode.graph.frame import View
from osgode.maths import Pose, Quat, Vec3, look_at

angles = st.floats(-3, 3).map(lambda x: round(x, 6))
points = st.tuples(*[st.floats(-50, 50).map(lambda x: round(x, 6))] * 3)
poses = st.builds(Pose, st.builds(Vec3._make, points), st.builds(Quat.from_yaw_pitch_roll, angles, angles))


def test_planes_by_hand() -> None:
    """With 90 degrees both ways the side planes stand at 45 degrees, all facing inwards."""
    planes = frustum_planes(View(field_of_view=math.pi / 2, near=1, far=100), 1.0)
    h = math.sqrt(0.5)
    expected = {
        (h, 0, -h, 0): "left",
        (-h, 0, -h, 0): "right",
        (0, h, -h, 0): "bottom",
        (0, -h, -h, 0): "top",
        (0, 0, -1, -1): "near",
        (0, 0, 1, 100): "far",
    }
    for plane in planes:
        assert any(plane == pytest.approx(np.array(each), abs=1e-9) for each in expected)
    assert len({tuple(np.round(p, 6)) for p in planes}) == 6


@given(poses, points, st.floats(0.2, 2.5), st.floats(0.3, 3))
def test_planes_agree_with_the_camera(
    pose: Pose, point: tuple[float, float, float], field_of_view: float, aspect: float
) -> None:
    """A point is inside all planes exactly if the camera's own axes say so."""
    view = View(pose, field_of_view, near=0.5, far=60)
    x, y, z = pose.inverse().transform(point)
    tangent = math.tan(field_of_view / 2)
    margins = (-z - 0.5, 60 + z, -z * tangent - abs(y), -z * tangent * aspect - abs(x))
    distances = frustum_planes(view, aspect) @ (*point, 1.0)
    if min(map(abs, margins)) > 1e-6:
        assert (distances.min() > 0) == (min(margins) > 0)


def test_plane_distances_are_metres() -> None:
    """A point two metres before the near plane is two metres inside of it, wherever the camera is."""
    view = View(look_at((5, 6, 7), (1, 2, 3)), near=1.0)
    ahead = view.pose.transform((0, 0, -3))
    assert np.isclose(frustum_planes(view, 1.5) @ (*ahead, 1.0), 2.0).any()


matrices = arrays(np.float64, (3, 3), elements=st.floats(-10, 10).map(lambda x: round(x, 6)))


@given(matrices)
def test_largest_scale_is_a_bound(matrix: np.ndarray) -> None:
    """No matrix stretches more than said, and what is said is at most 1.32 times too much."""
    true = np.linalg.norm(matrix, ord=2)
    said = largest_scales(matrix[None])[0]
    assert true * (1 - 1e-9) - 1e-12 <= said <= true * 3**0.25 * (1 + 1e-9) + 1e-12


@given(angles, angles, angles, st.tuples(*[st.floats(0.01, 100)] * 3))
def test_largest_scale_is_exact_without_shear(
    yaw: float, pitch: float, roll: float, scale: tuple[float, float, float]
) -> None:
    """For a rotation of a scale it is the largest factor."""
    matrix = np.array(Quat.from_yaw_pitch_roll(yaw, pitch, roll).to_matrix()) * scale
    assert largest_scales(matrix[None])[0] == pytest.approx(max(scale))


@given(poses, st.floats(0.1, 2.8), st.floats(0.3, 3), st.floats(1, 200))
def test_visible_sphere_is_the_smallest(pose: Pose, field_of_view: float, aspect: float, reach: float) -> None:
    """The sphere holds the eye and the far corners, and touches all it could be made smaller for."""
    view = View(pose, field_of_view, far=100)
    centre, radius = visible_sphere(view, aspect, reach)
    depth = min(reach, 100)
    high = depth * math.tan(field_of_view / 2)
    corners = [view.pose.transform((x * high * aspect, y * high, -depth)) for x in (-1, 1) for y in (-1, 1)]
    distances = [centre.distance(corner) for corner in corners]
    assert distances == pytest.approx([radius] * 4)
    assert centre.distance(pose.position) <= radius * (1 + 1e-9)
    on_far_side = view.pose.inverse().transform(centre).z == pytest.approx(-depth)
    assert on_far_side or centre.distance(pose.position) == pytest.approx(radius)
