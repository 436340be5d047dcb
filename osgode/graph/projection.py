"""What is laid out flat over the picture: a projection, and the nodes that draw something below it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

from osgode.errors import FieldError, shown
from osgode.graph.frame import Rectangle, Text
from osgode.graph.leaf import Switch
from osgode.graph.node import Group, Node
from osgode.graph.visitors import Visitor

OverlayItem = Rectangle | Text


class Area(NamedTuple):
    """A rectangle of the overlay, in its units, from the top left."""

    x: float
    y: float
    width: float
    height: float


class Projection(Group):
    """An orthographic projection: what stands below it is drawn flat over the picture, last of all.

    Only `OverlayNode` and what groups and switches them counts below it. Wherever it stands, its axes are those of the
    picture: x to the right and y down from the top left.

    Args:
        height: how many units the picture is high, so that all of it grows with the window; None: the units are pixels.
        name: for messages and paths.
        visible: whether it, and what is below it, is drawn.

    Raises:
        FieldError: for a height that isn't above 0.
    """

    def __init__(self, height: float | None = 720.0, *, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self.height = height

    @property
    def height(self) -> float | None:
        """How many units the picture is high; None: pixels."""
        return self._height

    @height.setter
    def height(self, value: float | None) -> None:
        self._height = None if value is None else self._checked_height(value)

    def _checked_height(self, value: Any) -> float:
        try:
            height = -1.0 if isinstance(value, str) else float(value)
        except (TypeError, ValueError):
            height = -1.0
        if not 0.0 < height < 1e9:
            raise FieldError(f"{self.describe()}.height is {shown(value)}; it must be above 0, or None for pixels")
        return height

    def items(self, size: tuple[int, int]) -> list[OverlayItem]:
        """What is drawn over a picture of ``size`` pixels, in order, in pixels."""
        if min(size) < 1:  # a minimised window
            return []
        scale = self._scale(size)
        visitor = _OverlayVisitor(Area(0.0, 0.0, size[0] / scale, size[1] / scale))
        visitor.traverse(self)
        return visitor.items if scale == 1.0 else [_scaled(item, scale) for item in visitor.items]

    def from_pixels(self, place: tuple[float, float], size: tuple[int, int]) -> tuple[float, float]:
        """Where in its own units a pixel of a picture of ``size`` lies: what the mouse pointer is at.

        ``scene.hud.from_pixels(events.mouse_position, video.size)`` is (0, 0) at the top left.
        """
        scale = self._scale(size)
        return place[0] / scale, place[1] / scale

    def _scale(self, size: tuple[int, int]) -> float:
        """Pixels of a unit."""
        return 1.0 if self._height is None else max(size[1], 1) / self._height


class OverlayNode(Group):
    """Something that is drawn below a `Projection`; what stands below it is laid out within its `inner_area`."""

    PARENTS: ClassVar[tuple[str, ...]] = ("Group",)

    def area(self, outer: Area) -> Area:
        """Where it is, in the area of what it stands under; all of that unless a subclass says so."""
        return outer

    def inner_area(self, area: Area) -> Area:
        """Where what stands below it is laid out, given its own area; all of that unless a subclass says so."""
        return area

    def overlay_items(self, area: Area) -> Sequence[OverlayItem]:
        """What it draws itself, before what is below it; nothing unless a subclass says so."""
        del area
        return ()


class _OverlayVisitor(Visitor):
    def __init__(self, area: Area) -> None:
        super().__init__()
        self.items: list[OverlayItem] = []
        self._area = area

    def visit_node(self, node: Node) -> None:
        if node.visible:
            self.traverse(node)

    def visit_switch(self, node: Switch) -> None:
        if node.on:
            self.visit_node(node)

    def visit_overlay_node(self, node: OverlayNode) -> None:
        if not node.visible:
            return
        outer = self._area
        area = node.area(outer)
        self.items += node.overlay_items(area)
        self._area = node.inner_area(area)
        self.traverse(node)
        self._area = outer


def _scaled(item: OverlayItem, scale: float) -> OverlayItem:
    if isinstance(item, Rectangle):
        place = item.x * scale, item.y * scale, item.width * scale, item.height * scale
        return Rectangle(*place, item.colour, item.texture)
    size = max(round(item.size * scale), 1)
    return Text(item.x * scale, item.y * scale, item.text, size, item.colour, item.align)
