"""Draws frames into a window."""

from __future__ import annotations

import os
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Self

from osgode.errors import OsgodeError, StateError
from osgode.graph.frame import Frame
from osgode.render.canvas import Canvas, samples_of
from osgode.render.current import EGL_DRIVERS
from osgode.render.extras import require
from osgode.render.renderer import Counts, GLRenderer, Quality

if TYPE_CHECKING:
    import moderngl
    import pygame


NO_WINDOW = (
    "no window with OpenGL 3.3 could be opened ({reason}). It takes a screen, and on Debian and Ubuntu libgl1 and "
    "libgl1-mesa-dri; without a screen use OffscreenDrawer, or run under xvfb-run"
)


class Window:
    """A window that shows frames; there is one in a process.

    Args:
        size: width and height, pixels; the user may change it, see `size`.
        title: what its bar says.
        quality: what a picture may cost; None: as suits who draws, full on a graphics card (``Quality()``), on a
            software rasteriser such that it can be played.
        vsync: wait for the screen before showing a picture, where the driver can.

    Raises:
        MissingExtraError: if moderngl or pygame is not installed.
        OsgodeError: if there is no screen, or no OpenGL 3.3.
    """

    def __init__(
        self,
        size: tuple[int, int] = (1024, 640),
        title: str = "osgode",
        quality: Quality | None = None,
        vsync: bool = True,
    ) -> None:
        gl = require("moderngl")
        self._pygame = require("pygame")
        self.closed = False
        try:
            self._make(size, title, vsync)
            self._context: moderngl.Context = gl.create_context(require=330)
        except Exception as error:  # moderngl raises no better one
            self._pygame.display.quit()
            raise OsgodeError(NO_WINDOW.format(reason=error)) from error
        self._open = True
        self._current: AbstractContextManager[object] = self._context
        if self._pygame.display.get_driver() in EGL_DRIVERS:
            self._current = nullcontext()  # current since it was made: OffscreenDrawer puts it back
        with self._current:
            self._renderer = GLRenderer(self._context, quality)
            self._samples = samples_of(self._context, self._renderer.quality.samples)
        self._canvas: Canvas | None = None

    def _make(self, size: tuple[int, int], title: str, vsync: bool) -> None:
        """Open the window, or raise what pygame raises."""
        pg = self._pygame
        pg.display.init()
        if pg.display.get_driver() == "offscreen" and "SDL_VIDEODRIVER" not in os.environ:
            raise pg.error("there is no screen")  # SDL would open a window that nobody sees or can close
        for name, value in (
            (pg.GL_CONTEXT_MAJOR_VERSION, 3),
            (pg.GL_CONTEXT_MINOR_VERSION, 3),
            (pg.GL_CONTEXT_PROFILE_MASK, pg.GL_CONTEXT_PROFILE_CORE),
            (pg.GL_CONTEXT_FLAGS, pg.GL_CONTEXT_FORWARD_COMPATIBLE_FLAG),
            (pg.GL_DEPTH_SIZE, 24),
            # Who draws, and so how many samples are right, is only known when the window is there: see `_canvas`.
            (pg.GL_MULTISAMPLEBUFFERS, 0),
            (pg.GL_MULTISAMPLESAMPLES, 0),
        ):
            pg.display.gl_set_attribute(name, value)
        # What the driver may refuse is asked for first, and given up.
        for wait in (True, False) if vsync else (False,):
            pg.display.set_caption(title)  # forgotten when an attempt fails
            try:
                pg.display.set_mode(size, pg.OPENGL | pg.DOUBLEBUF | pg.RESIZABLE, vsync=int(wait))
            except pg.error:
                if not wait:
                    raise
            else:
                return

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the window's inside as it is now, pixels."""
        width, height = self._pygame.display.get_window_size()
        return max(width, 1), max(height, 1)  # some systems give one that is minimised no height

    @property
    def full_screen(self) -> bool:
        """Whether it takes the whole screen; set it to change that."""
        return self._open and bool(self._pygame.display.is_fullscreen())

    @full_screen.setter
    def full_screen(self, value: bool) -> None:
        if self._open and bool(value) != self.full_screen:
            self._pygame.display.toggle_fullscreen()

    @property
    def focused(self) -> bool:
        """Whether it has the keyboard."""
        return self._open and bool(self._pygame.key.get_focused())

    @property
    def minimised(self) -> bool:
        """Whether it can't be seen because the user put it away."""
        return self._open and not self._pygame.display.get_active()

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

    def pump(self) -> list[pygame.event.Event]:
        """The events since the last call, oldest first; sets `closed` if the user closed the window.

        To be called once a frame, or the window system takes the program for hung.
        """
        events: list[pygame.event.Event] = [] if self.closed else self._pygame.event.get()
        if any(event.type == self._pygame.QUIT for event in events):
            self.closed = True
        return events

    def draw(self, frame: Frame) -> None:
        """Draw one picture and show it; nothing while it is minimised.

        Raises:
            StateError: if `close` was called.
        """
        if not self._open:
            raise StateError("the Window is closed")
        if self.minimised:  # some systems let a program wait until its window is seen again
            return
        size = self.size
        with self._current:
            if self._samples:
                if self._canvas is None or self._canvas.size != size:
                    self._canvas = Canvas(self._context, size, self._samples)
                self._renderer.draw(frame, self._canvas.target, size)
                self._canvas.finish()
                self._context.copy_framebuffer(self._context.screen, self._canvas.picture)
            else:
                self._renderer.draw(frame, self._context.screen, size)
            self._pygame.display.flip()

    def close(self) -> None:
        """Close the window; it can't be used afterwards."""
        self.closed = True
        if self._open:
            self._open = False
            self._context.release()
            self._pygame.display.quit()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
