"""Elements of an overlay: boxes, text, and windows with a border."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from osgode.errors import FieldError, shown
from osgode.fields import FLAG, Check, number, optional, whole
from osgode.graph.appearance import Texture
from osgode.graph.frame import Rectangle, Text
from osgode.graph.projection import Area, OverlayItem, OverlayNode

Colour = tuple[float, float, float, float]

ANCHORS: dict[str, tuple[float, float]] = {
    "top left": (0.0, 0.0),
    "top": (0.5, 0.0),
    "top right": (1.0, 0.0),
    "left": (0.0, 0.5),
    "centre": (0.5, 0.5),
    "right": (1.0, 0.5),
    "bottom left": (0.0, 1.0),
    "bottom": (0.5, 1.0),
    "bottom right": (1.0, 1.0),
}
"""Names of points of an area, in parts of its width and height."""

OFFSET = number(-1e6, 1e6)
LENGTH = optional(number(0.0, 1e6))
TEXT_SIZE = whole(1, 1000)


def _colour(value: Any) -> Colour:
    if isinstance(value, str | bytes):
        raise TypeError
    red, green, blue, *rest = map(float, value)
    (alpha,) = rest or (1.0,)
    if not all(0.0 <= part <= 1.0 for part in (red, green, blue, alpha)):
        raise ValueError
    return (red, green, blue, alpha)


COLOUR: Check[Colour] = Check("3 or 4 numbers from 0 to 1", _colour)


class HudElement(OverlayNode):
    """Something in the overlay; its units are those of the `Projection` above it.

    Args:
        anchor: the point of the area above it that it is fixed to, and the point of itself that lies there: one of
            `ANCHORS`.
        x, y: how far from there it is moved to the right and down.
        width, height: its size; None for all of the area above it.
        name: for messages and paths.
        visible: whether it, and what is below it, is drawn.

    Raises:
        FieldError: for bad numbers and unknown anchors.
    """

    def __init__(
        self,
        anchor: str = "top left",
        *,
        x: float = 0.0,
        y: float = 0.0,
        width: float | None = None,
        height: float | None = None,
        name: str = "",
        visible: bool = True,
    ) -> None:
        super().__init__(name=name, visible=visible)
        self.anchor = anchor
        self.move_to_offset(x, y)
        self.resize(width, height)

    @property
    def anchor(self) -> str:
        """What it is fixed to, one of `ANCHORS`."""
        return self._anchor

    @anchor.setter
    def anchor(self, value: str) -> None:
        if not isinstance(value, str) or value not in ANCHORS:
            raise FieldError(f"{self.describe()}.anchor is {shown(value)}; it must be one of {', '.join(ANCHORS)}")
        self._anchor = value

    @property
    def offset(self) -> tuple[float, float]:
        """How far from its anchor it is, to the right and down."""
        return self._offset

    def move_to_offset(self, x: float, y: float) -> None:
        """Put it so far from its anchor, to the right and down.

        Raises:
            FieldError: for numbers that aren't finite; nothing is changed then.
        """
        name = self.describe()
        self._offset = OFFSET(name, "x", x), OFFSET(name, "y", y)

    @property
    def size(self) -> tuple[float | None, float | None]:
        """Width and height; None for all of the area above it."""
        return self._size

    def resize(self, width: float | None, height: float | None) -> None:
        """Give it another size; None for all of the area above it.

        Raises:
            FieldError: for numbers below 0; nothing is changed then.
        """
        name = self.describe()
        self._size = LENGTH(name, "width", width), LENGTH(name, "height", height)

    def area(self, outer: Area) -> Area:
        """Where it is."""
        across, down = ANCHORS[self._anchor]
        width = outer.width if self._size[0] is None else self._size[0]
        height = outer.height if self._size[1] is None else self._size[1]
        x = outer.x + across * (outer.width - width) + self._offset[0]
        return Area(x, outer.y + down * (outer.height - height) + self._offset[1], width, height)


class _Coloured(HudElement):
    """One with a colour."""

    @property
    def colour(self) -> Colour:
        """Red, green, blue and opacity, 0 to 1."""
        return self._colour

    @colour.setter
    def colour(self, value: Sequence[float]) -> None:
        self._colour = COLOUR(self.describe(), "colour", value)


class _Worded(_Coloured):
    """One with a text."""

    @property
    def text(self) -> str:
        """What it says."""
        return self._text

    @text.setter
    def text(self, value: str) -> None:
        self._text = str(value)


class HudBox(_Coloured):
    """A filled rectangle, or an image.

    Args:
        anchor: as for `HudElement`.
        colour: red, green, blue and opacity, 0 to 1.
        texture: an image, multiplied with the colour.
        **place: as for `HudElement`.
    """

    def __init__(
        self,
        anchor: str = "top left",
        *,
        colour: Sequence[float] = (0.0, 0.0, 0.0, 0.5),
        texture: Texture | None = None,
        **place: Any,
    ) -> None:
        super().__init__(anchor, **place)
        self.colour = colour
        self.texture = texture

    @property
    def texture(self) -> Texture | None:
        """An image, multiplied with the colour; None for none."""
        return self._texture

    @texture.setter
    def texture(self, value: Texture | None) -> None:
        if value is not None and not isinstance(value, Texture):
            raise FieldError(f"{self.describe()}.texture is {shown(value)}; it must be a Texture or None")
        self._texture = value

    def overlay_items(self, area: Area) -> Sequence[OverlayItem]:
        """The rectangle."""
        return (Rectangle(*area, self._colour, self.texture),)


class HudText(_Worded):
    """Text of one line or several; set `text` as often as you like.

    Args:
        text: what it says.
        anchor: which point of the text lies on that point of the area above it.
        size: height of the em, in units of the projection.
        colour: red, green, blue and opacity, 0 to 1.
        shadow: whether it has a dark copy behind it, so that it can be read on any ground.
        **place: as for `HudElement`, but for the width and height, which the text has by itself.
    """

    def __init__(
        self,
        text: str = "",
        anchor: str = "top left",
        *,
        size: int = 18,
        colour: Sequence[float] = (1.0, 1.0, 1.0, 1.0),
        shadow: bool = True,
        **place: Any,
    ) -> None:
        super().__init__(anchor, **place)
        self.text = text
        self.text_size = size
        self.colour = colour
        self.shadow = FLAG(self.describe(), "shadow", shadow)

    @property
    def text_size(self) -> int:
        """Height of the em, in units of the projection."""
        return self._text_size

    @text_size.setter
    def text_size(self, value: int) -> None:
        self._text_size = TEXT_SIZE(self.describe(), "size", value)

    def overlay_items(self, area: Area) -> Sequence[OverlayItem]:
        """The text, and its shadow."""
        across, down = align = ANCHORS[self.anchor]
        x, y = area.x + across * area.width, area.y + down * area.height
        shown = Text(x, y, self._text, self._text_size, self._colour, align)
        if not self.shadow:
            return (shown,)
        off = max(self._text_size / 16, 1.0)
        dark = (0.0, 0.0, 0.0, 0.7 * self._colour[3])
        return (Text(x + off, y + off, self._text, self._text_size, dark, align), shown)


class HudWindow(_Worded):
    """A window in the picture: a half transparent box with a border, a title, and a body of text.

    What is attached to it is laid out within its border and margin, below the title.

    Args:
        title: of its bar; without one it has no bar.
        text: what stands in it.
        anchor: as for `HudElement`.
        text_size: height of the em of its text.
        colour: of its ground.
        border: colour of its border and bar.
        **place: as for `HudElement`.
    """

    MARGIN = 10.0
    EDGE = 2.0

    def __init__(
        self,
        title: str = "",
        text: str = "",
        anchor: str = "centre",
        *,
        text_size: int = 16,
        colour: Sequence[float] = (0.05, 0.07, 0.1, 0.75),
        border: Sequence[float] = (0.75, 0.8, 0.9, 0.9),
        width: float = 480.0,
        height: float = 320.0,
        **place: Any,
    ) -> None:
        super().__init__(anchor, width=width, height=height, **place)
        self.title = title
        self.text = text
        name = self.describe()
        self._text_size = TEXT_SIZE(name, "text_size", text_size)
        self.colour = colour
        self._border = COLOUR(name, "border", border)

    @property
    def title(self) -> str:
        """What its bar says; without a title it has no bar."""
        return self._title

    @title.setter
    def title(self, value: str) -> None:
        self._title = str(value)

    @property
    def _bar(self) -> float:
        return 1.7 * self._text_size if self.title else 0.0

    def inner_area(self, area: Area) -> Area:
        """Within the border and the margin, below the title."""
        margin, bar = self.MARGIN, self._bar
        width, height = area.width - 2 * margin, area.height - bar - 2 * margin
        return Area(area.x + margin, area.y + bar + margin, max(width, 0.0), max(height, 0.0))

    def overlay_items(self, area: Area) -> Sequence[OverlayItem]:
        """Ground, border, title and text."""
        x, y, width, height = area
        bar, edge = self._bar, self.EDGE
        items: list[OverlayItem] = [Rectangle(x, y, width, height, self._colour)]
        sides = (
            (x, y, width, edge),
            (x, y + height - edge, width, edge),
            (x, y + edge, edge, height - 2 * edge),
            (x + width - edge, y + edge, edge, height - 2 * edge),
        )
        items += [Rectangle(*side, self._border) for side in sides]
        if self.title:
            red, green, blue, alpha = self._border
            dim = (0.35 * red, 0.35 * green, 0.35 * blue, alpha)
            items.append(Rectangle(x + edge, y + edge, width - 2 * edge, bar - edge, dim))
            white = (1.0, 1.0, 1.0, 1.0)
            items.append(Text(x + self.MARGIN, y + (edge + bar) / 2, self.title, self._text_size, white, (0.0, 0.5)))
        if self.text:
            items.append(Text(x + self.MARGIN, y + bar + self.MARGIN, self.text, self._text_size))
        return items
