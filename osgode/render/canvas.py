"""Where a picture is drawn before it is seen or read."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl


def samples_of(context: moderngl.Context, wanted: int) -> int:
    """How many samples a pixel gets: ``wanted`` or the next lower number that there is, 0 for no smoothing."""
    possible = min(wanted, context.max_samples)
    return 1 << (possible.bit_length() - 1) if possible > 1 else 0


class Canvas:
    """A picture on the graphics card, and what it is drawn on.

    Args:
        context: which must be current, and is whenever something is drawn.
        size: width and height, pixels.
        samples: per pixel, as of `samples_of`.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], samples: int) -> None:
        self._context = context
        self.size = size
        colours = context.renderbuffer(size, 4, samples=samples)
        self.target = context.framebuffer([colours], context.depth_renderbuffer(size, samples=samples))
        """To be drawn on."""
        self.picture = self.target
        """What `finish` leaves, with one sample a pixel."""
        if samples:
            # Without depths, since copies would take them along, which windows refuse whose depths are of another kind.
            self.picture = context.framebuffer([context.renderbuffer(size, 4)])

    def finish(self) -> None:
        """Average the samples of each pixel."""
        if self.picture is not self.target:
            self._context.copy_framebuffer(self.picture, self.target)
