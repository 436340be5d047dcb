"""Events: what is pressed, how far the mouse has moved, and what the user calls it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TypeAlias

from osgode.engine.inputs import (
    Focus,
    InputEvent,
    InputSource,
    MouseMotion,
    Press,
    Quit,
    Release,
    ScriptedInput,
    Wheel,
)
from osgode.engine.keys import INPUTS, check_input
from osgode.engine.module import Config, Module
from osgode.errors import FieldError, shown
from osgode.fields import FLAG, number
from osgode.nodes.listeners import raise_all

Bindings: TypeAlias = Mapping[str, str | Iterable[str]]

BINDINGS: dict[str, tuple[str, ...]] = {
    "forward": ("w", "arrow_up"),
    "backward": ("s", "arrow_down"),
    "left": ("a", "arrow_left"),
    "right": ("d", "arrow_right"),
    "ascend": ("space",),
    "descend": ("left_shift", "c"),
    "pause": ("p",),
    "single_step": ("period",),
    "slower": ("minus",),
    "faster": ("equals",),
    "attach": ("e",),
    "third_person": ("v",),
    "debug": ("f3",),
    "inspect": ("f4",),
    "full_screen": ("f11",),
    "release_mouse": ("tab",),
    "quit": ("escape",),
}
"""The names of actions and what brings them about, unless a game says otherwise."""


@dataclass(frozen=True, kw_only=True)
class EventsConfig(Config):
    """Settings of Events.

    Args:
        bindings: actions and the keys or mouse buttons of each, one or several; added to `BINDINGS`, whose actions of
            the same names they replace.
        mouse_sensitivity: radians for a pixel.
        capture: whether the pointer is held from the start, for looking around.
    """

    CHECKS = {"mouse_sensitivity": number(0.0, 10.0), "capture": FLAG}  # noqa: RUF012 - Config has it as a ClassVar

    bindings: Bindings = field(default_factory=dict)
    mouse_sensitivity: float = 0.0025
    capture: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        checked = {
            action: _checked_binding("EventsConfig.bindings", action, inputs)
            for action, inputs in self.bindings.items()
        }
        object.__setattr__(self, "bindings", checked)


class Events(Module):
    """Keyboard, mouse and window, frame by frame.

    What is asked is an action (``"forward"``, see `bindings`) or a key or button by its own name (``"w"``,
    ``"mouse_left"``, see `osgode.engine.INPUTS`). Keys are named by their place: ``"w"`` is the key above ``"s"`` on
    any keyboard.

    Args:
        config: its settings.
        source: where events come from; a `ScriptedInput` if not given. `Video` adds those of its window.
    """

    NAME = "events"

    def __init__(self, config: EventsConfig | None = None, source: InputSource | None = None) -> None:
        self.config = config = EventsConfig.given(config, "Events")
        self._source: InputSource = ScriptedInput() if source is None else source
        self._bindings: dict[str, tuple[str, ...]] = dict(BINDINGS)
        for action, inputs in config.bindings.items():
            self.bind(action, inputs)
        self._held: dict[str, None] = {}
        self._pressed: set[str] = set()
        self._released: set[str] = set()
        self._press_listeners: dict[str, list[Callable[[], object]]] = {}
        self._listeners: list[Callable[[InputEvent], object]] = []
        self._captured = False
        self._look = (0.0, 0.0)
        self.focused = True
        """Whether the window has the keyboard."""
        self.mouse_motion = (0.0, 0.0)
        """Pixels to the right and down that the mouse moved in the last frame."""
        self.mouse_position = (0.0, 0.0)
        """Where the pointer is, pixels from the top left; stands still while it is held."""
        self.wheel = 0.0
        """Clicks that the wheel turned in the last frame, away from the user."""

    # -- names

    @property
    def bindings(self) -> dict[str, tuple[str, ...]]:
        """A copy of all actions and their inputs."""
        return dict(self._bindings)

    def bind(self, action: str, inputs: str | Iterable[str]) -> None:
        """Let an action be brought about by these keys and buttons, and no others.

        Raises:
            FieldError: for a key or button that there isn't, or an action that is called like one.
        """
        self._bindings[action] = _checked_binding("Events.bind", action, inputs)

    def inputs(self, name: str) -> tuple[str, ...]:
        """The keys and buttons of an action; of a key or button itself.

        Raises:
            FieldError: for an unknown name.
        """
        found = self._bindings.get(name) if isinstance(name, str) else None
        if found is None:
            check_input("Events", name, self._bindings)
            found = (name,)
        return found

    # -- what is asked

    def held(self, name: str) -> bool:
        """Whether an action, key or button is held down now."""
        return any(each in self._held for each in self.inputs(name))

    def pressed(self, name: str) -> bool:
        """Whether it went down in this frame; also if it has come up again since."""
        return any(each in self._pressed for each in self.inputs(name))

    def released(self, name: str) -> bool:
        """Whether it came up in this frame."""
        return any(each in self._released for each in self.inputs(name))

    def axis(self, negative: str, positive: str) -> float:
        """-1, 0 or 1: which of two actions is held, 0 for both."""
        return float(self.held(positive)) - float(self.held(negative))

    @property
    def look(self) -> tuple[float, float]:
        """What the mouse means for a camera in this frame: radians to the right and down; 0 unless it is held."""
        dx, dy = self._look
        return (dx * self.config.mouse_sensitivity, dy * self.config.mouse_sensitivity)

    # -- the pointer

    @property
    def source(self) -> InputSource:
        """Where events come from; another one takes over the pointer if it is held."""
        return self._source

    @source.setter
    def source(self, value: InputSource) -> None:
        if value is not self._source:
            if self._captured:
                self._source.capture(wanted=False)
            self._source = value
            if self._captured:
                value.capture(self.focused)

    @property
    def captured(self) -> bool:
        """Whether the pointer is held: hidden, within the window, for looking around.

        While the window lacks the keyboard the pointer is free, and held again when that is back.
        """
        return self._captured

    @captured.setter
    def captured(self, value: bool) -> None:
        self._captured = FLAG("Events", "captured", value)
        self._source.capture(self._captured and self.focused)

    # -- who is told

    def on_press(self, name: str) -> Callable[[Callable[[], object]], Callable[[], object]]:
        """A decorator: have a function called when an action, key or button goes down.

        What a listener raises leaves `cycle` when everything has been taken in, and all others have heard.

        Raises:
            FieldError: for an unknown name, or what can't be called.
        """
        self.inputs(name)

        def register(listener: Callable[[], object]) -> Callable[[], object]:
            _check_callable(f"Events.on_press({name!r})", listener)
            self._press_listeners.setdefault(name, []).append(listener)
            return listener

        return register

    def on_event(self, listener: Callable[[InputEvent], object]) -> Callable[[InputEvent], object]:
        """Have ``listener(event)`` called with every event, after the event has been taken in; usable as a decorator.

        Raises:
            FieldError: for what can't be called.
        """
        _check_callable("Events.on_event()", listener)
        self._listeners.append(listener)
        return listener

    # -- frames

    def start(self) -> None:
        """Hold the pointer if that is wished."""
        if self.config.capture:
            self.captured = True

    def stop(self) -> None:
        """Let everything go."""
        if self._captured:
            self.captured = False
        self._held.clear()

    def cycle(self) -> None:
        """Take in what has happened since the last frame, and tell the listeners."""
        self._pressed, self._released = set(), set()
        self.mouse_motion, self.wheel = (0.0, 0.0), 0.0
        self._look = (0.0, 0.0)
        errors: list[Exception] = []
        for event in self._source.poll():
            if isinstance(event, Focus) and not event.gained:  # nobody will tell when the keys come up
                for name in tuple(self._held):
                    self._happen(Release(name), errors)
            self._happen(event, errors)
        raise_all("several listeners of events failed", errors)

    def _happen(self, event: InputEvent, errors: list[Exception]) -> None:
        calls = self._press(event.name) if isinstance(event, Press) else []
        calls += [partial(listener, event) for listener in self._listeners]
        self._take(event)
        for hear in calls:
            try:
                hear()
            except Exception as error:  # noqa: BLE001 - a release that isn't taken in would leave a key held
                error.add_note(f"raised by a listener of Events, which heard {event}")
                errors.append(error)

    def _take(self, event: InputEvent) -> None:
        if isinstance(event, Release):
            self._let_go(event.name)
        elif isinstance(event, MouseMotion):
            self.mouse_motion = (self.mouse_motion[0] + event.dx, self.mouse_motion[1] + event.dy)
            if self._captured and self.focused:
                self._look = (self._look[0] + event.dx, self._look[1] + event.dy)
            else:
                self.mouse_position = (event.x, event.y)
        elif isinstance(event, Wheel):
            self.wheel += event.clicks
        elif isinstance(event, Focus):
            self._take_focus(event.gained)
        elif isinstance(event, Quit) and self._app is not None:
            self._app.quit()

    def _press(self, name: str) -> list[Callable[[], object]]:
        """Note that it is down; who is to be told of that."""
        if name in self._held:  # a key that repeats, or that of a second keyboard
            return []
        self._held[name] = None
        self._pressed.add(name)
        told = (listeners for action, listeners in self._press_listeners.items() if name in self.inputs(action))
        return [listener for listeners in told for listener in listeners]

    def _take_focus(self, gained: bool) -> None:
        self.focused = gained
        if self._captured:
            self._source.capture(gained)

    def _let_go(self, name: str) -> None:
        if name in self._held:
            del self._held[name]
            self._released.add(name)


def _checked_binding(call: str, action: object, inputs: object) -> tuple[str, ...]:
    if not isinstance(action, str) or not action or action in INPUTS:
        raise FieldError(
            f"{call}(): {shown(action)} can't be an action; it must be a word that is no key's or button's"
        )
    if not isinstance(inputs, Iterable):
        raise FieldError(f"{call}({action!r}): {shown(inputs)} must be the name of a key or button, or several")
    names = (inputs,) if isinstance(inputs, str) else tuple(inputs)
    for name in names:
        check_input(f"{call}({action!r})", name)
    return names


def _check_callable(call: str, listener: object) -> None:
    if not callable(listener):
        raise FieldError(f"{call}: listener is {shown(listener)}; it must be callable")
