"""Drawables of the collision primitives."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.errors import FieldError
from osgode.graph.appearance import Appearance, Texture
from osgode.graph.drawable import Drawable
from osgode.graph.shapes import (
    box_drawable,
    capsule_drawable,
    cylinder_drawable,
    heightfield_drawable,
    plane_drawable,
    ray_drawable,
    sphere_drawable,
)

CHECKS = Texture(np.zeros((2, 2, 3), np.uint8))
STRETCHED = Appearance(texture=CHECKS)
TILED = Appearance(texture=CHECKS, texture_scale=(0.5, 0.25))


def placed(drawable: Drawable) -> np.ndarray:
    """The vertices in the axes of the node."""
    vertices = drawable.mesh.vertices.astype(np.float64)
    if drawable.matrix is None:
        return vertices
    return vertices @ drawable.matrix[:3, :3].T + drawable.matrix[:3, 3]


def bounds(drawable: Drawable) -> list[list[float]]:
    at = placed(drawable)
    return [at.min(axis=0).tolist(), at.max(axis=0).tolist()]


@pytest.mark.parametrize("look", [Appearance(), STRETCHED, TILED], ids=["plain", "stretched", "tiled"])
@pytest.mark.parametrize(
    ("make", "half"),
    [
        (lambda look: box_drawable((2, 4, 6), look), (1, 2, 3)),
        (lambda look: sphere_drawable(3, look), (3, 3, 3)),
        (lambda look: cylinder_drawable(2, 3, look), (2, 2, 1.5)),
        (lambda look: capsule_drawable(2, 3, look), (2, 2, 3.5)),
    ],
    ids=["box", "sphere", "cylinder", "capsule"],
)
def test_sizes(make: Callable[[Appearance], Drawable], half: tuple[float, ...], look: Appearance) -> None:
    """Each shape fills its box about the origin, however it is textured."""
    drawable = make(look)
    assert drawable.appearance is look
    assert bounds(drawable) == [pytest.approx([-h for h in half]), pytest.approx(half)]


def test_sizes_share_a_mesh_unless_the_texture_counts_metres() -> None:
    """Boxes, spheres and cylinders of any size are one mesh; tiled ones share it only with their equals."""
    assert box_drawable((1, 2, 3)).mesh is box_drawable((4, 5, 6), STRETCHED).mesh
    assert sphere_drawable(1).mesh is sphere_drawable(2).mesh
    assert cylinder_drawable(1, 1).mesh is cylinder_drawable(2, 3).mesh
    assert box_drawable((1, 2, 3), TILED).mesh is box_drawable((1, 2, 3), TILED).mesh
    assert box_drawable((1, 2, 3), TILED).mesh is not box_drawable((3, 2, 1), TILED).mesh


def test_a_texture_scale_without_texture_makes_no_difference() -> None:
    """Where nothing is to be seen of it, the texture scale doesn't cost a mesh."""
    assert box_drawable((1, 2, 3), Appearance(texture_scale=(1, 1))).mesh is box_drawable((1, 1, 1)).mesh


def test_ray_starts_at_the_origin() -> None:
    """A ray is a thin rod from the origin along +Z."""
    assert bounds(ray_drawable(5, radius=0.1)) == [pytest.approx([-0.1, -0.1, 0]), pytest.approx([0.1, 0.1, 5])]


directions = st.tuples(*[st.floats(-10, 10).map(lambda x: round(x, 6))] * 3).filter(lambda v: math.hypot(*v) > 1e-3)


@given(directions, st.floats(-50, 50).map(lambda x: round(x, 6)))
def test_plane_lies_in_its_plane_and_faces_its_normal(normal: tuple[float, float, float], distance: float) -> None:
    """All corners fulfil ``p . normal = distance``, whatever the normal's length, and the front is outside."""
    drawable = plane_drawable(normal, distance, extent=10)
    corners = placed(drawable)
    length = math.hypot(*normal)
    assert corners @ normal / length == pytest.approx(np.full(4, distance / length), abs=1e-5 * (1 + abs(distance)))
    a, b, c = corners[drawable.mesh.triangles[0]]
    assert np.cross(b - a, c - a) / 100 == pytest.approx(np.array(normal) / length, abs=1e-5)
    assert corners.mean(axis=0) == pytest.approx(np.array(normal) * distance / length**2, abs=1e-5 * (1 + distance**2))


def test_ground_texture_lies_by_the_metre() -> None:
    """On level ground u counts metres along +X and v along -Z, scaled by the texture scale if there is one."""
    for look, scale in ((Appearance(), (1, 1)), (TILED, (0.5, 0.25))):
        drawable = plane_drawable((0, 1, 0), 2, look, extent=10)
        at = placed(drawable)
        assert at[:, 1] == pytest.approx(np.full(4, 2))
        assert drawable.mesh.uvs == pytest.approx(np.column_stack([at[:, 0], -at[:, 2]]) / scale, abs=1e-5)


def test_heightfield_by_hand() -> None:
    """Rows of samples run along +Z, columns along +X, centred, and the surface faces up."""
    heights = np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 9.0]])
    drawable = heightfield_drawable(heights, 4, 6)
    assert placed(drawable).tolist() == [[-2, 0, -3], [0, 1, -3], [2, 2, -3], [-2, 3, 3], [0, 4, 3], [2, 9, 3]]
    assert (drawable.mesh.normals[:, 1] > 0).all()
    a, b, c = (placed(drawable)[drawable.mesh.triangles[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)[:, 1] / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(4 * 6)


def test_heightfield_is_split_as_ode_splits_it() -> None:
    """Each cell's diagonal joins the next sample along X with the next along Z."""
    mesh = heightfield_drawable(np.zeros((2, 2)), 1, 1).mesh
    assert all({1, 2} <= set(triangle) for triangle in mesh.triangles.tolist())


def test_heightfield_texture() -> None:
    """A texture covers the field once with its top at -Z, or repeats by the metre."""
    once = heightfield_drawable(np.zeros((2, 3)), 4, 6).mesh
    assert once.uvs.tolist() == [[0, 1], [0.5, 1], [1, 1], [0, 0], [0.5, 0], [1, 0]]
    tiled = heightfield_drawable(np.zeros((2, 3)), 4, 6, TILED).mesh
    assert tiled.uvs.tolist() == (once.uvs * (8, 24)).tolist()


@pytest.mark.parametrize(
    "make",
    [
        lambda: box_drawable((1, 0, 1)),
        lambda: box_drawable((1, math.inf, 1)),
        lambda: sphere_drawable(-1),
        lambda: sphere_drawable(math.nan),
        lambda: cylinder_drawable(1, 0),
        lambda: capsule_drawable(0, 1),
        lambda: capsule_drawable(1, -0.1),
        lambda: capsule_drawable(1, math.nan),
        lambda: ray_drawable(0),
        lambda: plane_drawable((0, 0, 0), 1),
        lambda: plane_drawable((0, 1, 0), math.nan),
        lambda: plane_drawable((0, math.inf, 0), 1),
        lambda: plane_drawable((0, 1, 0), 1, extent=0),
        lambda: heightfield_drawable(np.zeros((1, 5)), 1, 1),
        lambda: heightfield_drawable(np.zeros((3, 3)), 0, 1),
        lambda: heightfield_drawable(np.full((3, 3), np.nan), 1, 1),
    ],
)
def test_bad_sizes_are_refused(make: Callable[[], Drawable]) -> None:
    """Sizes that ODE would not take are not drawn either."""
    with pytest.raises(FieldError):
        make()
