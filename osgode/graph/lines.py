"""A node that shows lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from osgode.errors import FieldError, shown
from osgode.graph.frame import Lines
from osgode.graph.node import Node


class LineSet(Node):
    """Lines in the axes of the group above: marks, paths, measures.

    A subclass whose lines change by themselves overrides `lines`, which is asked for each picture in which the node
    is not hidden.

    Args:
        lines: what is shown.
        name: for messages and paths.
        visible: whether it is drawn.

    Raises:
        FieldError: for anything but Lines.
    """

    def __init__(self, lines: Iterable[Lines] | Lines = (), *, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self.show(lines)

    def show(self, lines: Iterable[Lines] | Lines) -> None:
        """Show these from now on, instead of those before.

        Raises:
            FieldError: for anything but Lines.
        """
        several = (lines,) if isinstance(lines, Lines) else tuple(lines) if isinstance(lines, Iterable) else (lines,)
        for each in several:
            if not isinstance(each, Lines):
                raise FieldError(f"{self.describe()}.show(): {shown(each)} is no Lines")
        self._lines: Sequence[Lines] = several

    def lines(self, interpolation: float) -> Sequence[Lines]:  # noqa: ARG002 - for subclasses that move
        """What is drawn now, in the node's axes; ``interpolation`` as in `PoseSource.matrices`."""
        return self._lines
