"""Nodes that show things and nodes that choose what is shown."""

from __future__ import annotations

from collections.abc import Iterable

from osgode.errors import TreeError
from osgode.graph.drawable import Drawable
from osgode.graph.node import Group, Node


class Leaf(Node):
    """A node that holds drawables and has no children.

    Args:
        drawables: what it shows, in its own axes.
        name: for messages and paths.
        visible: whether it is drawn.
    """

    def __init__(self, drawables: Iterable[Drawable] = (), *, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self._drawables = tuple(drawables)

    def drawables(self) -> tuple[Drawable, ...]:
        """What is drawn at this node, in the order in which it was added."""
        return self._drawables

    def add_drawable(self, drawable: Drawable) -> Drawable:
        """Show ``drawable`` too, and return it."""
        self._drawables = (*self._drawables, drawable)
        self._touch()
        return drawable

    def remove_drawable(self, drawable: Drawable) -> Drawable:
        """Show ``drawable`` no longer, and return it; if it was added twice, once is left.

        Raises:
            TreeError: if this leaf doesn't show it; nothing is changed then.
        """
        for i, shown in enumerate(self._drawables):
            if shown is drawable:
                self._drawables = self._drawables[:i] + self._drawables[i + 1 :]
                self._touch()
                return drawable
        raise TreeError(f"{self.describe()} can't let go of {drawable!r}: it is not one of its drawables")


class Switch(Group):
    """A group whose children are drawn only while it is on.

    Unlike `visible`, which anybody may use to hide any node for a reason of its own, `on` belongs to whoever
    put the switch there; both must agree for the children to be drawn.

    Args:
        on: whether the children are drawn.
        name: for messages and paths.
        visible: whether it, and what is below it, is drawn.
    """

    def __init__(self, *, on: bool = True, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self._on = bool(on)

    @property
    def on(self) -> bool:
        """Whether the children are drawn."""
        return self._on

    @on.setter
    def on(self, value: bool) -> None:
        if value != self._on:
            self._on = bool(value)
            self._touch()
