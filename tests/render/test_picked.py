"""Picking against pixels: what is picked at a point is what is drawn there."""

import numpy as np

from osgode.graph.appearance import Appearance
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import View
from osgode.graph.leaf import Leaf
from osgode.graph.node import Group
from osgode.graph.shapes import box_drawable, capsule_drawable, cylinder_drawable, sphere_drawable
from osgode.graph.transforms import PositionAttitudeTransform
from osgode.maths import Quat, look_at
from tests.render.scenes import CLEAR, SIZE

SHAPES = [
    lambda look: box_drawable((1.5, 0.8, 0.6), look),
    lambda look: sphere_drawable(0.7, look),
    lambda look: cylinder_drawable(0.4, 1.5, look),
    lambda look: capsule_drawable(0.3, 1.2, look),
]


def test_every_pixel_shows_what_is_picked_there(drawer):
    """A heap of overlapping shapes, each in a colour of its own, and one mark in front of all."""
    dice, root, colours = np.random.default_rng(5), Group(), {}
    for k in range(24):
        colour = (k * 10 + 5, 255 - 10 * k, 40 * (k % 5))
        look = Appearance(tuple(part / 255 for part in colour), unlit=True, in_front=k == 7)
        position, rotation = dice.uniform(-2, 2, 3), Quat(*dice.normal(size=4)).normalized()
        place = root.attach(PositionAttitudeTransform(position=position, rotation=rotation))
        colours[place.attach(Leaf([SHAPES[k % 4](look)]))] = colour
    view, visitor = View(look_at((1, 2, 6), (0, 0, 0)), near=4.5), CullVisitor(root)
    drawer.draw(visitor.cull(view, SIZE, sky=CLEAR))
    image = drawer.image().astype(int)
    wrong = count = 0
    for y in range(3, 100, 3):
        for x in range(3, 160, 3):
            found = visitor.pick(view, SIZE, x + 0.5, y + 0.5)
            same = found is not None and np.abs(image[y, x] - colours[found.node]).max() <= 2
            if found is None:  # the sky: no thing's colour
                same = min(np.abs(image[y, x] - colour).max() for colour in colours.values()) > 2
            wrong += not same
            count += found is not None
    assert count > 400
    assert wrong <= 2  # on an edge the rasteriser may round to the other side
