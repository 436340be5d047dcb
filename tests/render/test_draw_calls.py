"""How many draw calls a picture of a whole scene takes: by what looks different, not by how much there is."""

import pytest

from osgode.graph.appearance import Appearance
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import Rectangle, Text, View
from osgode.graph.leaf import Leaf
from osgode.graph.node import Group
from osgode.graph.shapes import box_drawable, capsule_drawable, cylinder_drawable, sphere_drawable
from osgode.graph.transforms import PositionAttitudeTransform
from osgode.maths import look_at
from osgode.render.shadows import CASCADES

LOOKS = [Appearance((0.2 * k, 0.5, 0.5)) for k in range(5)]
SHAPES = [
    lambda look, k: box_drawable((0.2 + 0.01 * k, 0.3, 0.4), look),
    lambda look, k: sphere_drawable(0.2 + 0.01 * k, look),
    lambda look, k: cylinder_drawable(0.2, 0.2 + 0.01 * k, look),
    lambda look, k: capsule_drawable(0.2, 0.3, look),
]
MORE = 8
"""What is drawn beside the things: the sky, the overlay, what lies in front."""


def scene(count: int) -> Group:
    """Rows of shapes in every look, each a node, in a field that the nearer shadow map doesn't hold alone."""
    root = Group()
    for k in range(count):
        place = root.attach(PositionAttitudeTransform(position=(k % 20 - 10, 0, -(k // 20) * 3.0)))
        place.attach(Leaf([SHAPES[k % 4](LOOKS[k // 4 % 5], k % 7)]))
    return root


@pytest.mark.parametrize("count", [20, 400])
def test_draw_calls_follow_looks_and_not_nodes(drawer, count):
    """At most one call for each pair of a mesh and an appearance, two for its shadows, and 8."""
    view = View(look_at((0, 12, 20), (0, 0, -15)))
    overlay = [Rectangle(0, 0, 9, 9), Text(0, 0, "frame")]
    frame = CullVisitor(scene(count)).cull(view, (160, 100), overlay=overlay)
    assert sum(len(one.matrices) for one in frame.opaque) == count
    pairs = {(one.mesh, one.appearance) for one in frame.opaque}
    casting = {(one.mesh, one.appearance) for one in frame.casters}
    assert len(pairs) == len(casting) == 20
    drawer.draw(frame)
    assert drawer.counts.draws <= len(pairs) + CASCADES * len(casting) + MORE
    assert drawer.counts.draws >= len(pairs) + CASCADES  # the count counts
