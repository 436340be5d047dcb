"""Boxes, text and windows of the overlay."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import osgode as oo
from osgode.engine import HudBox, HudElement, HudText, HudWindow
from osgode.engine.hud import ANCHORS
from osgode.errors import FieldError
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import Rectangle, Text, View
from osgode.graph.node import Group
from osgode.graph.projection import Area, Projection

SIZES = st.floats(0, 500)
OFFSETS = st.floats(-300, 300)


def items(*elements, size=(800, 400)):
    """What is drawn of these, in pixels."""
    flat = Projection(None)
    for element in elements:
        flat.attach(element)
    return flat.items(size)


def box(item):
    return (item.x, item.y, item.width, item.height)


@given(st.sampled_from(sorted(ANCHORS)), SIZES, SIZES, OFFSETS, OFFSETS)
def test_anchors_lie_on_one_another(anchor, width, height, x, y):
    """The point of the element that the anchor names lies on that of the area above it, moved by the offset."""
    element = HudElement(anchor, x=x, y=y, width=width, height=height)
    outer = Area(10, 20, 640, 480)
    area = element.area(outer)
    assert (area.width, area.height) == (width, height)
    right = 0.0 if "left" in anchor else 1.0 if "right" in anchor else 0.5
    down = 0.0 if "top" in anchor else 1.0 if "bottom" in anchor else 0.5
    assert area.x + right * width == pytest.approx(outer.x + right * outer.width + x)
    assert area.y + down * height == pytest.approx(outer.y + down * outer.height + y)


def test_nested_areas():
    """An element is laid out in the area of the one above it; without a size it fills that."""
    outer = HudBox("bottom right", width=200, height=100)
    outer.attach(HudBox("bottom right", x=-10, y=-10, width=50, height=20))
    outer.attach(HudBox(height=5))
    drawn = items(outer)
    assert [box(item) for item in drawn] == [(600, 300, 200, 100), (740, 370, 50, 20), (600, 300, 200, 5)]


def test_an_empty_bar_is_empty():
    """A width of 0 is 0, not all there is: a bar of health that has run out."""
    bar = HudBox(width=100, height=10)
    bar.resize(0, 10)
    assert bar.size == (0, 10)
    assert box(items(bar)[0]) == (0, 0, 0, 10)
    other = HudBox(width=100, height=10)
    other.resize(None, None)
    assert other.size == (None, None)
    assert box(items(other)[0]) == (0, 0, 800, 400)


def test_boxes():
    texture = oo.Texture(np.full((1, 1, 3), 255, np.uint8))
    (plain,) = items(HudBox("centre", width=10, height=10))
    assert plain == Rectangle(395, 195, 10, 10, (0.0, 0.0, 0.0, 0.5))
    (other,) = items(HudBox("centre", width=10, height=10, colour=(1, 0.5, 0), texture=texture))
    assert other == Rectangle(395, 195, 10, 10, (1.0, 0.5, 0.0, 1.0), texture)


@pytest.mark.parametrize("anchor", sorted(ANCHORS))
def test_text_is_aligned_by_its_anchor(anchor):
    """The text's point lies on the picture's; what size the text has is the renderer's business."""
    (shown,) = items(HudText("hello\nyou", anchor, x=3, y=-4, size=30, colour=(1, 0, 0), shadow=False))
    across, down = ANCHORS[anchor]
    assert shown == Text(800 * across + 3, 400 * down - 4, "hello\nyou", 30, (1.0, 0.0, 0.0, 1.0), (across, down))


def test_text_has_a_shadow_behind():
    """A dark copy, drawn first, a little to the right and down, as opaque as the text lets it."""
    dark, shown = items(HudText("a", size=32, colour=(1, 1, 1, 0.5)))
    assert (dark.x - shown.x, dark.y - shown.y) == (2, 2)
    assert dark.colour == (0.0, 0.0, 0.0, pytest.approx(0.35))
    assert (dark.text, dark.size, dark.align) == (shown.text, shown.size, shown.align)


def test_text_is_made_of_anything():
    text = HudText(3)
    assert text.text == "3"
    text.text = 4.5
    assert text.text == "4.5"
    assert [item.text for item in items(text)] == ["4.5", "4.5"]


def test_windows():
    """Ground, four sides of a border, a bar with the title, text; all within its area."""
    window = HudWindow("Title", "Text", "top left", x=100, y=50, text_size=20, width=300, height=200)
    drawn = items(window)
    ground, *sides, bar, title, text = drawn
    assert box(ground) == (100, 50, 300, 200)
    assert ground.colour[3] < 1, "half transparent"
    assert [box(side) for side in sides] == [
        (100, 50, 300, 2),
        (100, 248, 300, 2),
        (100, 52, 2, 196),
        (398, 52, 2, 196),
    ]
    assert bar.y == 52
    assert bar.y + bar.height <= text.y
    assert bar.y < title.y < bar.y + bar.height
    assert (title.text, title.align, text.text) == ("Title", (0.0, 0.5), "Text")
    window.title = ""
    window.text = ""
    assert len(items(HudWindow("", "", width=10, height=10))) == 5
    assert len(Projection(None).items((1, 1))) == 0


def test_windows_hold_their_children_within_the_border():
    """What is attached is laid out within border and margin, below the title; never with a size below 0."""
    for title, bar in (("", 0.0), ("Title", 1.7 * 20)):
        window = HudWindow(title, anchor="top left", text_size=20, width=300, height=200)
        window.attach(HudBox())
        *_, child = [item for item in items(window) if isinstance(item, Rectangle)]
        assert box(child) == pytest.approx((10, 10 + bar, 280, 180 - bar))
    tiny = HudWindow("Title", width=5, height=5)
    tiny.attach(HudBox())
    assert all(item.width >= 0 and item.height >= 0 for item in items(tiny)[5:] if isinstance(item, Rectangle))


def test_titles_and_text_of_windows_can_change():
    """They are words whatever is set."""
    window = HudWindow(1, 2)
    assert (window.title, window.text) == ("1", "2")
    window.title, window.text = 3, 4
    assert [item.text for item in items(window) if isinstance(item, Text)] == ["3", "4"]


def test_scaling_with_the_window():
    """An overlay of 720 units grows with the height of the picture, and keeps to its corners."""
    hud = Projection(720)
    hud.attach(HudBox("bottom right", x=-20, y=-20, width=100, height=50))
    hud.attach(HudText("a", "bottom left", size=24, shadow=False))
    for width, height in ((1280, 720), (640, 360), (2000, 1440)):
        scale = height / 720
        rectangle, text = hud.items((width, height))
        assert box(rectangle) == pytest.approx(
            (width - 120 * scale, height - 70 * scale, 100 * scale, 50 * scale), abs=1e-9
        )
        assert (text.x, text.y, text.size) == (0, height, 24 * scale)


def test_what_changes_often_does_not_rebuild_the_picture():
    """Texts, colours, sizes and places change without the scene being flattened anew; visibility does it once."""

    class Counting(CullVisitor):
        walks = 0

        def _flatten(self):
            self.walks += 1
            super()._flatten()

    root = Group()
    hud = root.attach(Projection(720))
    text, bar, window = hud.attach(HudText("a")), hud.attach(HudBox()), hud.attach(HudWindow("b"))
    cull = Counting(root)
    for number in range(5):
        text.text = window.text = window.title = str(number)
        text.text_size = 10 + number
        bar.colour = (0, 0, 0, number / 5)
        bar.resize(number, 10)
        bar.move_to_offset(number, 0)
        bar.anchor = "centre"
        shown = cull.cull(View(), (1280, 720)).overlay
        assert str(number) in [item.text for item in shown if isinstance(item, Text)]
    assert cull.walks == 1
    text.visible = False
    shown = cull.cull(View(), (1280, 720)).overlay
    assert [item.text for item in shown if isinstance(item, Text)] == ["4", "4"]
    assert cull.walks == 2


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: HudElement("middle", name="it"), r"HudElement 'it'\.anchor is 'middle'.*top left"),
        (lambda: HudElement(["top"], name="it"), r"it'\.anchor"),
        (lambda: HudElement(x=math.nan, name="it"), r"it'\.x"),
        (lambda: HudElement(y="3", name="it"), r"it'\.y"),
        (lambda: HudElement(width=-1, name="it"), r"it'\.width"),
        (lambda: HudElement(height=math.inf, name="it"), r"it'\.height"),
        (lambda: HudBox(colour=(1, 0), name="it"), r"it'\.colour"),
        (lambda: HudBox(colour=(1, 0, 2), name="it"), r"it'\.colour"),
        (lambda: HudBox(colour="111", name="it"), r"it'\.colour"),
        (lambda: HudBox(colour=(0, 0, 0, math.nan), name="it"), r"it'\.colour"),
        (lambda: HudBox(texture="brick.png", name="it"), r"it'\.texture"),
        (lambda: HudText("a", size=0, name="it"), r"it'\.size"),
        (lambda: HudText("a", size=12.5, name="it"), r"it'\.size"),
        (lambda: HudText("a", shadow="no", name="it"), r"it'\.shadow"),
        (lambda: HudWindow(text_size=-3, name="it"), r"it'\.text_size"),
        (lambda: HudWindow(border=None, name="it"), r"it'\.border"),
        (lambda: HudWindow(anchor="here", name="it"), r"it'\.anchor"),
    ],
)
def test_bad_elements(make, words):
    with pytest.raises(FieldError, match=words):
        make()


def test_bad_changes_change_nothing():
    bar = HudBox(x=1, y=2, width=3, height=4, colour=(0, 0, 0, 1), name="bar")
    for act in (
        lambda: bar.resize(5, -1),
        lambda: bar.move_to_offset(9, math.nan),
        lambda: setattr(bar, "anchor", "nowhere"),
        lambda: setattr(bar, "colour", (1, 1)),
    ):
        with pytest.raises(FieldError, match="bar"):
            act()
    assert (bar.size, bar.offset, bar.anchor, bar.colour) == ((3, 4), (1, 2), "top left", (0, 0, 0, 1))
