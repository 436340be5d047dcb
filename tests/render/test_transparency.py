"""Blending over what is behind."""

import numpy as np
import pytest

from osgode.graph.appearance import Appearance
from osgode.graph.frame import Frame, View
from osgode.graph.mesh import Mesh
from tests.render.scenes import CLEAR, RED, SIZE, blocks, many, place, quad, unlit

BLACK = unlit((0, 0, 0, 1))
HALF_RED, HALF_GREEN = unlit((1, 0, 0, 0.5)), unlit((0, 1, 0, 0.5))
WALL = many(quad(), BLACK, place((0, 0, -9), scale=(20, 20, 1)))


def middle(drawer, opaque, transparent):
    drawer.draw(Frame(View(), SIZE, opaque, transparent, sky=CLEAR))
    return drawer.image()[50, 80].astype(int)


@pytest.mark.parametrize("opacity", [0.25, 0.5, 0.75])
def test_opacity_is_a_share(drawer, opacity):
    """Over black, so much of the colour is left as it is opaque."""
    seen = middle(drawer, [WALL], [many(quad(), unlit((1, 1, 1, opacity)), place((0, 0, -5)))])
    assert np.abs(seen - 255 * opacity).max() <= 1


def test_order_given_is_the_order_drawn(drawer):
    """The later bin lies over the earlier one, and depth has no say among transparent things."""
    far, near = many(quad(), HALF_RED, place((0, 0, -6))), many(quad(), HALF_GREEN, place((0, 0, -4)))
    assert np.abs(middle(drawer, [WALL], [far, near]) - (64, 128, 0)).max() <= 1
    assert np.abs(middle(drawer, [WALL], [near, far]) - (128, 64, 0)).max() <= 1


def test_instances_of_a_bin_blend_in_their_order(drawer):
    """Two half-transparent copies let a quarter through."""
    seen = middle(drawer, [WALL], [many(quad(), HALF_RED, place((0, 0, -6)), place((0, 0, -4)))])
    assert np.abs(seen - (191, 0, 0)).max() <= 1


def test_hidden_behind_an_opaque_thing(drawer):
    """What stands behind something opaque is not blended over it."""
    wall = many(quad(), unlit(RED), place((0, 0, -5)))
    assert middle(drawer, [wall], [many(quad(), HALF_GREEN, place((0, 0, -6)))]).tolist() == [255, 0, 0]


def test_far_side_is_seen_through_the_near_side(drawer):
    """Of a closed thing the back faces come first, whatever the order of its triangles."""
    front, back = quad(), quad()
    turned = back.vertices * (-1, 1, 1) - (0, 0, 1)
    for order in (0, 1):
        triangles = [front.triangles, back.triangles + 4]
        both = Mesh(
            np.vstack([front.vertices, turned]),
            np.vstack(triangles[::-1] if order else triangles),
            np.vstack([front.normals, -front.normals]),
            np.vstack([np.zeros((4, 2)), np.ones((4, 2))]),
        )
        # The front shows the corner at the bottom left, the back that at the top right.
        glass = Appearance((1, 1, 1, 0.5), blocks([(0, 0, 0), (0, 255, 0)], [(255, 0, 0), (0, 0, 0)]), unlit=True)
        seen = middle(drawer, [WALL], [many(both, glass, place((0, 0, -5)))])
        assert np.abs(seen - (128, 64, 0)).max() <= 1, order


def test_later_opaque_frame_is_unharmed(drawer):
    """Depth is written again after transparent things were drawn."""
    middle(drawer, [WALL], [many(quad(), HALF_RED, place((0, 0, -6)))])
    near, far = many(quad(), unlit(RED), place((0, 0, -4))), WALL
    assert middle(drawer, [near, far], []).tolist() == [255, 0, 0]
