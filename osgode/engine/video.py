"""Video: the window, or what stands for one, and the pictures."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

from osgode.engine.inputs import WindowInput
from osgode.engine.module import Config, Module
from osgode.errors import FieldError, shown
from osgode.fields import FLAG, Check, whole
from osgode.graph.appearance import Image
from osgode.render import OffscreenDrawer, Quality, Window, save_png

if TYPE_CHECKING:
    from osgode.engine.scene import Scene

Mode = Literal["window", "offscreen", "none"]
MODES = ("window", "offscreen", "none")
SIDE = whole(1, 16384)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError
    return value


TITLE: Check[str] = Check("a text", _text)


@dataclass(frozen=True, kw_only=True)
class VideoConfig(Config):
    """Settings of Video.

    Args:
        mode: ``"window"``; ``"offscreen"``: each frame is drawn into memory; ``"none"``: nothing is drawn but what
            `Video.picture` is asked for.
        size: width and height, pixels.
        title: of the window.
        full_screen: whether the window begins so.
        vsync: wait for the screen before showing a picture, where the driver can.
        quality: what a picture may cost; None: as suits who draws, full on a graphics card, on a software rasteriser
            such that it can be played; what `Video.picture` makes is then always full.
    """

    CHECKS = {"title": TITLE, "full_screen": FLAG, "vsync": FLAG}  # noqa: RUF012 - Config has it as a ClassVar

    mode: Mode = "window"
    size: tuple[int, int] = (1024, 640)
    title: str = "osgode"
    full_screen: bool = False
    vsync: bool = True
    quality: Quality | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.mode not in MODES:
            raise FieldError(f"VideoConfig.mode is {self.mode!r}; it must be one of {', '.join(MODES)}")
        if not (self.quality is None or isinstance(self.quality, Quality)):
            raise FieldError(f"VideoConfig.quality is {shown(self.quality)}; it must be a Quality, or None")
        object.__setattr__(self, "size", _checked_size(self.size))


def _checked_size(value: Any) -> tuple[int, int]:
    try:
        width, height = (SIDE("VideoConfig", "size", part) for part in value)
    except (TypeError, ValueError) as error:  # FieldError is a ValueError
        raise FieldError(f"VideoConfig.size is {shown(value)}; it must be two whole numbers from 1 to 16384") from error
    return (width, height)


class Video(Module):
    """Draws the scene, in a window or without one.

    Args:
        config: its settings.

    Raises:
        MissingExtraError: from `start`, if a window is wanted and pygame or moderngl is not installed.
        OsgodeError: from `start`, if there is no screen.
    """

    NAME = "video"
    NEEDS = ("events",)

    def __init__(self, config: VideoConfig | None = None) -> None:
        self.config = VideoConfig.given(config, "Video")
        self.window: Window | None = None
        """The window, if there is one."""
        self.drawer: OffscreenDrawer | None = None
        """What draws into memory instead."""
        self.timings: dict[str, float] = {}
        """Seconds that drawing the last frame took."""
        self._full_screen = False
        self._painter: OffscreenDrawer | None = None
        self._input: WindowInput | None = None

    @property
    def scene(self) -> Scene:
        """What is drawn: the App's scene."""
        return self.app.scene

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture now, pixels."""
        return self.config.size if self.window is None else self.window.size

    @property
    def full_screen(self) -> bool:
        """Whether the window takes the whole screen; without a window it is noted and changes nothing."""
        return self._full_screen if self.window is None else self.window.full_screen

    @full_screen.setter
    def full_screen(self, value: bool) -> None:
        self._full_screen = bool(value)
        if self.window is not None:
            self.window.full_screen = self._full_screen

    def start(self) -> None:
        """Open the window."""
        config = self.config
        if config.mode == "window":
            self.window = Window(config.size, config.title, config.quality, config.vsync)
            self._input = WindowInput(self.window, self.app.events.source)
            self.app.events.source = self._input
            self.full_screen = config.full_screen
        elif config.mode == "offscreen":
            self.drawer = OffscreenDrawer(config.size, config.quality)

    def stop(self) -> None:
        """Close it."""
        made, self._input = self._input, None
        with ExitStack() as closing:  # all are closed, whatever fails
            for each in (self.window, self.drawer, self._painter):
                if each is not None:
                    closing.callback(each.close)
            self._painter = self.drawer = self.window = None
            if made is not None and made.beside is not None:
                self.app.events.source = made.beside

    def cycle(self) -> None:
        """Draw a frame."""
        drawer = self.drawer if self.window is None else self.window
        if drawer is None:
            return
        frame = self.scene.frame(self.size)
        before = time.perf_counter()
        drawer.draw(frame)
        self.timings = {"draw": time.perf_counter() - before}

    def picture(self, size: tuple[int, int] | None = None) -> Image:
        """A picture of the scene as it is now: (height, width, 3) bytes, first row at the top; in any mode.

        In full quality, unless the settings name one.

        Args:
            size: width and height, pixels; those of the window if not given.

        Raises:
            MissingExtraError: if moderngl is not installed.
            OsgodeError: if there is no OpenGL to draw with.
        """
        wanted = self.size if size is None else _checked_size(size)
        painter = self._painter
        if painter is None or painter.size != wanted:
            if painter is not None:
                painter.close()
            quality = Quality() if self.config.quality is None else self.config.quality
            painter = self._painter = OffscreenDrawer(wanted, quality)
        painter.draw(self.scene.frame(wanted))
        return painter.image()

    def save_picture(self, path: str | PathLike[str], size: tuple[int, int] | None = None) -> None:
        """Write such a picture as a PNG file.

        Raises:
            MissingExtraError: if moderngl or Pillow is not installed.
            OSError: if the file can't be written.
        """
        save_png(self.picture(size), path)
