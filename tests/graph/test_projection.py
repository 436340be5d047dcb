"""What is laid flat over the picture: order, areas, scale, and what is drawn anew for it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import osgode as oo
from osgode.errors import FieldError
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import Rectangle, Text, View
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.node import Group
from osgode.graph.projection import Area, OverlayNode, Projection


class Label(OverlayNode):
    """Draws its name in its area's corner; its area is inset by some units, and what is below it by some more."""

    def __init__(self, name, inset=0.0, padding=0.0):
        super().__init__(name=name)
        self.inset, self.padding = inset, padding

    def area(self, outer):
        d = self.inset
        return Area(outer.x + d, outer.y + d, outer.width - 2 * d, outer.height - 2 * d)

    def inner_area(self, area):
        d = self.padding
        return Area(area.x + d, area.y + d, area.width - 2 * d, area.height - 2 * d)

    def overlay_items(self, area):
        return (Rectangle(*area, (1, 1, 1, 1)), Text(area.x, area.y, self.name, 20))


def names(items):
    return [item.text for item in items if isinstance(item, Text)]


def boxes(items):
    return [(item.x, item.y, item.width, item.height) for item in items if isinstance(item, Rectangle)]


def test_order_and_nesting():
    """Parents before children, in the order of the tree; each within the inner area of what is above it."""
    flat = Projection(None)
    outer = flat.attach(Label("outer", 10, 5))
    outer.attach(Group()).attach(Label("inner", 1))
    flat.attach(Label("second", 2))
    items = flat.items((200, 100))
    assert names(items) == ["outer", "inner", "second"]
    assert boxes(items) == [(10, 10, 180, 80), (16, 16, 168, 68), (2, 2, 196, 96)]


def test_plain_overlay_nodes_draw_nothing():
    """The base class fills what is above it, and so does a group."""
    flat = Projection(None)
    assert flat.items((20, 10)) == []
    flat.attach(OverlayNode()).attach(Label("a"))
    assert boxes(flat.items((20, 10))) == [(0, 0, 20, 10)]


def test_hidden_and_switched_off():
    """What is invisible, or below a switch that is off, is left out with all below it."""
    flat = Projection(None)
    switch = flat.attach(Switch())
    label = switch.attach(Label("a"))
    label.attach(Label("b"))
    assert names(flat.items((10, 10))) == ["a", "b"]
    label.visible = False
    assert flat.items((10, 10)) == []
    label.visible = True
    switch.on = False
    assert flat.items((10, 10)) == []
    switch.on = True
    switch.visible = False
    assert flat.items((10, 10)) == []


def test_other_nodes_count_for_nothing():
    """Transforms and leaves below a projection draw nothing and move nothing."""
    flat = Projection(None)
    place = flat.attach(oo.PositionAttitudeTransform(position=(5, 5, 5)))
    place.attach(Leaf([oo.box_drawable((1, 1, 1))]))
    place.attach(Label("a"))
    assert boxes(flat.items((30, 20))) == [(0, 0, 30, 20)]
    frame = CullVisitor(flat).cull(View(), (30, 20))
    assert frame.opaque == []
    assert names(frame.overlay) == ["a"]


@given(st.integers(1, 4000), st.integers(1, 3000), st.floats(1.0, 5000.0))
def test_all_of_it_grows_with_the_window(width, height, units):
    """A picture is as many units high as was said; text keeps its part of that height, one pixel at least."""
    flat = Projection(units)
    flat.attach(Label("a", units / 10))
    rectangle, text = flat.items((width, height))
    scale = height / units
    assert (rectangle.x, rectangle.y) == pytest.approx((height / 10, height / 10))
    assert rectangle.width == pytest.approx(width - height / 5)
    assert rectangle.height == pytest.approx(0.8 * height)
    assert text.size == max(round(20 * scale), 1)
    assert (text.x, text.y) == pytest.approx((height / 10, height / 10))


def test_scaling_keeps_the_rest():
    """Colours, textures, alignment and text are as they were."""

    class Both(OverlayNode):
        def overlay_items(self, area):
            return (
                Rectangle(1, 2, 3, 4, (0.1, 0.2, 0.3, 0.4), texture),
                Text(1, 2, "x", 10, (0.5, 0.6, 0.7, 0.8), (0.5, 1)),
            )

    texture = oo.Texture(np.full((1, 1, 3), 255, np.uint8))
    flat = Projection(100)
    flat.attach(Both())
    assert flat.items((400, 200)) == [
        Rectangle(2, 4, 6, 8, (0.1, 0.2, 0.3, 0.4), texture),
        Text(2, 4, "x", 20, (0.5, 0.6, 0.7, 0.8), (0.5, 1)),
    ]


def test_pixels():
    flat = Projection(None)
    flat.attach(Label("a", 3))
    assert boxes(flat.items((100, 50))) == [(3, 3, 94, 44)]
    assert flat.height is None


@pytest.mark.parametrize("size", [(0, 0), (100, 0), (0, 100)])
def test_a_minimised_window(size):
    """A picture without pixels has no overlay, and is no error."""
    flat = Projection(720)
    flat.attach(Label("a"))
    assert flat.items(size) == []
    assert CullVisitor(flat).cull(View(), size).overlay == []


@pytest.mark.parametrize("wrong", [0, -1.0, math.nan, math.inf, "abc", "720", [720], 1e9])
def test_bad_heights(wrong):
    """Refused with the value that was given; the old one stays."""
    flat = Projection(100, name="hud")
    with pytest.raises(FieldError, match=r"Projection 'hud'\.height is") as caught:
        flat.height = wrong
    assert repr(wrong)[:4] in str(caught.value)
    assert flat.height == 100.0
    with pytest.raises(FieldError):
        Projection(wrong)


# -- in the cull


class Counting(CullVisitor):
    """Counts how often the tree is walked."""

    walks = 0

    def _flatten(self):
        self.walks += 1
        super()._flatten()


def test_a_pixel_in_the_overlays_units():
    """Twice as many pixels as units, pixels themselves, and a minimised window, in which nothing is pointed at."""
    assert Projection(720.0).from_pixels((300, 1440), (2560, 1440)) == (150, 720)
    assert Projection(None).from_pixels((300, 1440), (2560, 1440)) == (300, 1440)
    assert Projection(720.0).from_pixels((0, 0), (1, 0)) == (0, 0)


def test_projections_go_into_the_frame():
    """Wherever they stand, in the order of the tree, before what the caller lays over all."""
    root = Group()
    first = root.attach(Projection(None))
    deep = root.attach(oo.PositionAttitudeTransform(position=(9, 9, 9))).attach(Projection(10))
    world = root.attach(oo.World())
    third = world.attach(Projection(None))
    for number, flat in enumerate((first, deep, third)):
        flat.attach(Label(str(number)))
    cull = Counting(root)
    last = Text(0, 0, "last")
    frame = cull.cull(View(), (40, 20), overlay=[last])
    assert names(frame.overlay) == ["0", "1", "2", "last"]
    assert boxes(frame.overlay) == 3 * [(0, 0, 40, 20)]
    deep.visible = False
    assert names(cull.cull(View(), (40, 20)).overlay) == ["0", "2"]
    world.visible = False
    assert names(cull.cull(View(), (40, 20)).overlay) == ["0"]
    root.detach(first)
    assert cull.cull(View(), (40, 20)).overlay == []


def test_a_switch_above_a_projection():
    root = Group()
    switch = root.attach(Switch(on=False))
    switch.attach(Projection(None)).attach(Label("a"))
    cull = CullVisitor(root)
    assert cull.cull(View(), (4, 4)).overlay == []
    switch.on = True
    assert names(cull.cull(View(), (4, 4)).overlay) == ["a"]


def test_what_an_overlay_says_is_asked_for_each_picture():
    """Its items may change in each frame without the tree being walked anew; so may the size of the picture."""
    root = Group()
    label = root.attach(Projection(None)).attach(Label("a"))
    cull = Counting(root)
    for text, size in (("one", (10, 20)), ("two", (20, 10)), ("three", (30, 30))):
        label.name = text
        label.inset += 1
        frame = cull.cull(View(), size)
        assert names(frame.overlay) == [text]
        d = label.inset
        assert boxes(frame.overlay) == [(d, d, size[0] - 2 * d, size[1] - 2 * d)]
    assert cull.walks == 1


def test_an_overlay_may_be_shown_twice():
    """Overlay nodes are visual: they may have several parents."""
    one, two = Projection(None), Projection(10)
    label = one.attach(Label("a"))
    two.attach(label)
    assert names(one.items((10, 20)) + two.items((10, 20))) == ["a", "a"]
