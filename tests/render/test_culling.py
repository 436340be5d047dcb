"""When the back faces of a draw may be left out."""

import numpy as np
import pytest

from osgode.graph.appearance import DEFAULT_APPEARANCE
from osgode.graph.mesh import Mesh
from osgode.graph.primitives import box_mesh, capsule_mesh, cylinder_mesh, sphere_mesh
from osgode.maths import Quat
from osgode.render.culling import encloses, mirrored, near_to_far, plain
from tests.render.scenes import many, place, quad

BOX = box_mesh()


@pytest.mark.parametrize("mesh", [BOX, sphere_mesh(), cylinder_mesh(), capsule_mesh(0.3, 1.0)])
def test_primitives_enclose(mesh):
    """Solids are recognised although their faces don't share vertices."""
    assert encloses(mesh)


def test_scale_and_place_of_a_mesh_do_not_matter():
    """Grains, mountains and things far from their origin are recognised too."""
    for scale, shift in ((0.02, 0), (1e4, 0), (1.0, 50.0)):
        assert encloses(Mesh(sphere_mesh().vertices * scale + shift, sphere_mesh().triangles))


def test_open_or_wrong_meshes_do_not_enclose():
    """A sheet, a box without a lid, one inside out, and one with a face twice."""
    lidless = Mesh(BOX.vertices, BOX.triangles[2:])
    inside_out = Mesh(BOX.vertices, BOX.triangles[:, ::-1])
    doubled = Mesh(BOX.vertices, np.vstack([BOX.triangles, BOX.triangles[:1]]))
    one_flipped = Mesh(BOX.vertices, np.vstack([BOX.triangles[:1, ::-1], BOX.triangles[1:]]))
    for mesh in (quad(), lidless, inside_out, doubled, one_flipped):
        assert not encloses(mesh)


def test_mesh_without_area_does_not_enclose():
    """Triangles that are lines bound nothing."""
    assert not encloses(Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]])))


def test_mirrored():
    """An odd number of negative scales makes a mirror image, turning doesn't."""
    turned = Quat.from_axis_angle((1, 2, 3), 2.0)
    scales = [(1, 1, 1), (-1, 1, 1), (-1, -2, 1), (-1, -1, -1)]
    bins = [many(BOX, DEFAULT_APPEARANCE, place(rotation=turned, scale=scale)) for scale in scales]
    assert [mirrored(one) for one in bins] == [False, True, False, True]
    assert mirrored(many(BOX, DEFAULT_APPEARANCE, place(), place(scale=(1, -1, 1)), place()))


@pytest.mark.parametrize(
    ("matrix", "expected"),
    [
        (place((0, 0, -5)), True),
        (place((0.4, 0, 0)), False),  # the eye is inside
        (place((0, 0, -0.7)), False),  # the near plane cuts it
        (place((0, 0, -1.0)), True),  # the bounding sphere holds the eye's surroundings, the box doesn't
        (place((0, -2, 0), scale=(100, 1, 100)), True),  # a floor
        (place((0, 0, -5), scale=(-1, 1, 1)), False),
        (place((0, 0, 0), scale=(1, 0, 1)), False),
    ],
)
def test_plain_draws(matrix, expected):
    """Back faces are needed by an eye inside, at a cut by the near plane, and for mirror images."""
    far = place((0, 0, -50))
    bins = [many(BOX, DEFAULT_APPEARANCE, far), many(BOX, DEFAULT_APPEARANCE, far, matrix)]
    assert plain(bins, (0, 0, 0), 0.1) == [True, expected]


def test_plain_of_nothing():
    """No bins are no answers."""
    assert plain([], (0, 0, 0), 0.1) == []


def test_what_reaches_far_comes_last():
    """What is near hides what is behind it before that is shaded; the ground, which is everywhere, comes last."""
    ground = many(BOX, DEFAULT_APPEARANCE, place((0, -2, 0), scale=(100, 1, 100)))
    near = many(BOX, DEFAULT_APPEARANCE, place((0, 0, -3)), place((1, 0, -4)))
    far = many(BOX, DEFAULT_APPEARANCE, place((0, 0, -2)), place((0, 0, -30)))
    assert near_to_far([ground, far, near], (0, 0, 0)) == [2, 1, 0]
    assert near_to_far([near, far, ground], (0, 0, -28)) == [0, 1, 2]
    assert near_to_far([near, near], (0, 0, 0)) == [0, 1]
    assert near_to_far([], (0, 0, 0)) == []
