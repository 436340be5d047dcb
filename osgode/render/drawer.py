"""Draws frames into memory, without a window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self
from weakref import finalize

import numpy as np

from osgode.errors import FieldError, OsgodeError, StateError
from osgode.graph.appearance import Image
from osgode.graph.frame import Frame
from osgode.render.canvas import Canvas, samples_of
from osgode.render.current import kept_current
from osgode.render.extras import require
from osgode.render.renderer import Counts, GLRenderer, Quality

if TYPE_CHECKING:
    import moderngl

NO_CONTEXT = (
    "no OpenGL 3.3 context without a window could be made ({reason}). On Debian and Ubuntu, "
    "apt-get install libegl1 libgl1 libgl1-mesa-dri brings a driver that needs no graphics card"
)


class OffscreenDrawer:
    """Draws pictures without a window or a screen, also on a machine without a graphics card.

    Args:
        size: width and height of the pictures, pixels.
        quality: what a picture may cost; None: as suits who draws, full on a graphics card (``Quality()``), on a
            software rasteriser such that it can be played.

    Raises:
        MissingExtraError: if moderngl is not installed.
        OsgodeError: if there is no OpenGL to draw with.
    """

    def __init__(self, size: tuple[int, int], quality: Quality | None = None) -> None:
        width, height = size
        if width < 1 or height < 1:
            raise FieldError(f"OffscreenDrawer.size is {size!r}; it must be at least (1, 1)")
        self.size = (int(width), int(height))
        module = require("moderngl")
        with kept_current():
            self._context = _make_context(module)
            # The context owns all there is on the graphics card, so releasing it is all there is to do.
            self._release = finalize(self, self._context.release)
            with self._context as context:
                self._renderer = GLRenderer(context, quality)
                self._canvas = Canvas(context, self.size, samples_of(context, self._renderer.quality.samples))

    @property
    def renderer(self) -> str:
        """Who draws, in the driver's own words: a graphics card or a software rasteriser such as llvmpipe."""
        return str(self._context.info["GL_RENDERER"])

    @property
    def quality(self) -> Quality:
        """What a picture may cost: as it was given, or chosen."""
        return self._renderer.quality

    @property
    def counts(self) -> Counts:
        """What the last picture took."""
        return self._renderer.counts

    def draw(self, frame: Frame) -> None:
        """Draw one picture; `image` reads it.

        Raises:
            StateError: if the drawer is closed.
        """
        if not self._release.alive:
            raise StateError("the OffscreenDrawer is closed")
        with kept_current(), self._context:
            self._renderer.draw(frame, self._canvas.target, self.size)
            self._canvas.finish()

    def image(self) -> Image:
        """The picture drawn last: (height, width, 3) bytes, first row at the top."""
        width, height = self.size
        with kept_current(), self._context:
            data = self._canvas.picture.read(components=3, alignment=1)
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)[::-1].copy()

    def close(self) -> None:
        """Give everything back to the driver; the drawer can't be used afterwards."""
        self._release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _make_context(module: Any) -> moderngl.Context:
    reasons = []
    # EGL needs no display. Where there is none (Windows, macOS) the platform's own way is tried.
    for settings in ({"backend": "egl"}, {}):
        try:
            return module.create_context(standalone=True, require=330, **settings)  # type: ignore[no-any-return]
        except Exception as error:  # noqa: BLE001 - the backends raise bare Exception
            reasons.append(str(error))
    raise OsgodeError(NO_CONTEXT.format(reason="; ".join(dict.fromkeys(reasons))))
