"""A drawer that draws nothing: it keeps the frames it was given, for tests and headless runs."""

from __future__ import annotations

from collections import deque

from osgode.graph.frame import Bin, Frame


class RecordingDrawer:
    """Keeps frames instead of drawing them; needs no graphics library.

    Args:
        keep: how many of the last frames to keep; None for all.
    """

    def __init__(self, keep: int | None = None) -> None:
        self.frames: deque[Frame] = deque(maxlen=keep)
        self.drawn = 0
        """How many frames were drawn, kept or not."""

    def draw(self, frame: Frame) -> None:
        """Keep one frame."""
        self.frames.append(frame)
        self.drawn += 1

    @property
    def last(self) -> Frame:
        """The frame drawn last.

        Raises:
            IndexError: if none is kept.
        """
        return self.frames[-1]

    @property
    def bins(self) -> int:
        """How many bins the camera sees in the last frame: its draw calls."""
        return len(_seen(self.last))

    @property
    def instances(self) -> int:
        """How many instances the camera sees in the last frame."""
        return sum(len(one.matrices) for one in _seen(self.last))


def _seen(frame: Frame) -> list[Bin]:
    return [*frame.opaque, *frame.transparent, *frame.front]
