"""What happens at keyboard, mouse and window, as plain data, and where it comes from."""

from __future__ import annotations

import importlib
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from osgode.engine.keys import BUTTON_NAMES, KEY_NAMES, check_input
from osgode.errors import FieldError, shown

if TYPE_CHECKING:
    from osgode.render import Window


@dataclass(frozen=True, slots=True)
class Press:
    """A key or a mouse button went down; ``name`` is one of `osgode.engine.INPUTS`.

    Raises:
        FieldError: for any other name.
    """

    name: str

    def __post_init__(self) -> None:
        check_input(type(self).__name__, self.name)


@dataclass(frozen=True, slots=True)
class Release:
    """It came up again; as `Press`."""

    name: str

    def __post_init__(self) -> None:
        check_input(type(self).__name__, self.name)


@dataclass(frozen=True, slots=True)
class MouseMotion:
    """The mouse moved by (dx, dy) pixels, to the right and down; (x, y) is where the pointer is now."""

    dx: float
    dy: float
    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, slots=True)
class Wheel:
    """The mouse wheel turned by so many clicks, away from the user."""

    clicks: float


@dataclass(frozen=True, slots=True)
class Resize:
    """The window has another size now, pixels."""

    width: int
    height: int


@dataclass(frozen=True, slots=True)
class Focus:
    """The window got the keyboard, or lost it."""

    gained: bool


@dataclass(frozen=True, slots=True)
class Quit:
    """The user closed the window."""


InputEvent: TypeAlias = Press | Release | MouseMotion | Wheel | Resize | Focus | Quit


class InputSource(Protocol):
    """Where events come from."""

    def poll(self) -> Iterable[InputEvent]:
        """What has happened since the last call, in order."""

    def capture(self, wanted: bool) -> None:
        """Hold the pointer: it is hidden, can't leave the window, and only tells how far it moved."""


class ScriptedInput:
    """Events that a program makes up: for headless runs and tests."""

    def __init__(self) -> None:
        self._waiting: deque[InputEvent] = deque()
        self.captured = False
        """Whether the pointer would be held now."""

    def send(self, *events: InputEvent) -> None:
        """Let these happen in the next frame.

        Raises:
            FieldError: for what is no event; none of them happens then.
        """
        for event in events:
            if not isinstance(event, InputEvent):
                raise FieldError(f"ScriptedInput.send(): {shown(event)} is no event such as Press('w') or Wheel(1)")
        self._waiting.extend(events)

    def poll(self) -> list[InputEvent]:
        """What was sent since the last call."""
        events = list(self._waiting)
        self._waiting.clear()
        return events

    def capture(self, wanted: bool) -> None:
        """Note it."""
        self.captured = wanted


class WindowInput:
    """The events of a window.

    The first of all tells whether the window has the keyboard.

    Args:
        window: that is asked for them.
        beside: more events, which follow those of the window in each frame.
    """

    def __init__(self, window: Window, beside: InputSource | None = None) -> None:
        self._window = window
        self.beside = beside
        """Where the other events come from."""
        self._captured = False
        self._place = (0, 0)
        self._told_focus = False
        self._pygame = pg = importlib.import_module("pygame")
        pg.key.stop_text_input()  # an input method would keep keys for itself
        self._convert: dict[int, Callable[[Any], InputEvent | None]] = {
            pg.KEYDOWN: lambda raw: _named(Press, KEY_NAMES, raw.scancode),
            pg.KEYUP: lambda raw: _named(Release, KEY_NAMES, raw.scancode),
            pg.MOUSEBUTTONDOWN: lambda raw: _named(Press, BUTTON_NAMES, raw.button),
            pg.MOUSEBUTTONUP: lambda raw: _named(Release, BUTTON_NAMES, raw.button),
            pg.MOUSEMOTION: lambda raw: MouseMotion(*raw.rel, *raw.pos),
            pg.MOUSEWHEEL: lambda raw: Wheel(raw.precise_y) if raw.precise_y else None,  # sideways: no name for it
            pg.WINDOWSIZECHANGED: lambda raw: Resize(raw.x, raw.y),
            pg.WINDOWFOCUSGAINED: lambda _: Focus(gained=True),
            pg.WINDOWFOCUSLOST: lambda _: Focus(gained=False),
            pg.QUIT: lambda _: Quit(),
        }

    def poll(self) -> list[InputEvent]:
        """What has happened since the last call."""
        events: list[InputEvent | None] = []
        if not self._told_focus:
            self._told_focus = True
            events.append(Focus(gained=self._window.focused))
        known = ((self._convert.get(raw.type), raw) for raw in self._window.pump())
        events += (convert(raw) for convert, raw in known if convert is not None)
        if self.beside is not None:
            events += self.beside.poll()
        return [event for event in events if event is not None]

    def capture(self, wanted: bool) -> None:
        """Hold the pointer, or let it go where it was; in the middle if it wasn't in the window."""
        if self.beside is not None:
            self.beside.capture(wanted)
        if wanted == self._captured:
            return
        self._captured = wanted
        mouse = self._pygame.mouse
        if wanted:
            width, height = self._window.size
            middle = (width // 2, height // 2)
            self._place = mouse.get_pos() if mouse.get_focused() else middle
            mouse.set_relative_mode(True)
            mouse.set_pos(middle)  # else SDL may take the first motion for one to a first place, and no distance
        else:
            mouse.set_pos(self._place)
            mouse.set_relative_mode(False)


def _named(kind: type[Press | Release], names: dict[int, str], number: int) -> InputEvent | None:
    name = names.get(number)
    return None if name is None else kind(name)
