"""The App: modules that are started in order, have their turns in each frame, and are stopped in reverse."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self, TypeVar, cast

from osgode.engine.clock import Clock, ClockConfig, HandTime, RealTime, Timer
from osgode.engine.events import Events, EventsConfig
from osgode.engine.inputs import InputSource
from osgode.engine.module import Config, Module
from osgode.engine.scene import Scene, SceneConfig
from osgode.engine.video import Video, VideoConfig
from osgode.errors import FieldError, StateError, shown
from osgode.fields import optional, whole

EXPECTED = ("clock", "events", "scene", "video")
"""The modules that an App can't do without."""
FRAMES = optional(whole(0, 10**12))
HEADLESS_RATE = 60.0
"""Frames a second of `HandTime` if there is no frame limit: time must pass with them."""

ModuleT = TypeVar("ModuleT", bound=Module)


@dataclass(frozen=True, kw_only=True)
class AppConfig(Config):
    """Settings of an App: those of its core modules."""

    clock: ClockConfig = field(default_factory=ClockConfig)
    events: EventsConfig = field(default_factory=EventsConfig)
    scene: SceneConfig = field(default_factory=SceneConfig)
    video: VideoConfig = field(default_factory=VideoConfig)


class App:
    """A program that shows a scene: one at a time in a process, reached by `App.current` from anywhere.

    ::

        class Game(Scene):
            def populate_world(self): ...

        App(Game).run()

    With a video mode of ``"offscreen"`` or ``"none"`` time is `HandTime` and input a `ScriptedInput`, unless others are
    given: it runs as fast as it can, and every run of one script gives the same bits. Each frame then takes what the
    frame limit says, 1/60 s if there is none.

    Args:
        scene: the class of the scene, or one that is made already.
        config: settings.
        modules: more modules; they have their turn after the events and before the scene. One that is called as a core
            module takes that one's place.
        timer: where the time comes from.
        source: where events come from; with a window, besides those that it has.

    Raises:
        FieldError: for what is no Scene, Module, AppConfig, Timer or InputSource, and two modules of one name.
    """

    _current: ClassVar[App | None] = None

    def __init__(
        self,
        scene: type[Scene] | Scene = Scene,
        config: AppConfig | None = None,
        *,
        modules: Iterable[Module] = (),
        timer: Timer | None = None,
        source: InputSource | None = None,
    ) -> None:
        config = AppConfig.given(config, "App")
        _check_has("timer", timer, "now", "wait")
        _check_has("source", source, "poll", "capture")
        if timer is None:
            timer = RealTime() if config.video.mode == "window" else HandTime()
            if config.video.mode != "window" and config.clock.frame_limit is None:
                config = replace(config, clock=replace(config.clock, frame_limit=HEADLESS_RATE))
        self.config = config
        if isinstance(scene, type) and issubclass(scene, Scene):
            made = scene(config.scene)
        elif isinstance(scene, Scene):
            made = scene
        else:
            raise FieldError(f"App.scene is {shown(scene)}; it must be a Scene or a subclass of it")
        core: list[Module] = [Clock(config.clock, timer), Events(config.events, source), made, Video(config.video)]
        self._modules = _in_order(core, modules)
        self._started: list[Module] = []
        self._open = self._used = False
        self._quit = False
        self._in_turn = self._closing = False
        self.timings: dict[str, float] = {}
        """Seconds that each module took in the last frame, and the parts of the scene and the video."""

    # -- what it is made of

    @classmethod
    def current(cls) -> App:
        """The App that is open in this process.

        Raises:
            StateError: if none is.
        """
        if cls._current is None:
            raise StateError("App.current(): no App is open in this process")
        return cls._current

    @property
    def modules(self) -> tuple[Module, ...]:
        """All modules, in the order of their turns."""
        return tuple(self._modules)

    def module(self, name: str) -> Module:
        """The module of that name.

        Raises:
            FieldError: if there is none.
        """
        for module in self._modules:
            if name == module.NAME:
                return module
        raise FieldError(
            f"App.module(): there is no {shown(name)}; there are {', '.join(m.NAME for m in self._modules)}"
        )

    @property
    def clock(self) -> Clock:
        """Time."""
        return cast("Clock", self.module("clock"))

    @property
    def events(self) -> Events:
        """Keyboard, mouse and window."""
        return cast("Events", self.module("events"))

    @property
    def scene(self) -> Scene:
        """What is simulated and shown."""
        return cast("Scene", self.module("scene"))

    @property
    def video(self) -> Video:
        """What shows it."""
        return cast("Video", self.module("video"))

    # -- its life

    @property
    def is_open(self) -> bool:
        """Whether its modules are started."""
        return self._open

    def open(self) -> Self:
        """Start all modules, and return self. If one fails, those before it are stopped again, and it too.

        Raises:
            StateError: if an App is open in this process, this one has been opened before, or a module lacks one that
                it needs.
        """
        if App._current is not None:
            raise StateError("App.open(): another App is open in this process; close it first")
        if self._used:
            raise StateError("App.open(): this App has been opened before, and its scene is filled; make a new one")
        self._check_needs()
        App._current = self
        self._open = self._used = True
        try:
            for module in self._modules:
                self._started.append(module)
                module._app = self
                with self._turn(module, "being started"):
                    module.start()
                if self._closing:
                    break
        except BaseException as error:
            self._stop(error)
            raise
        if self._closing:
            self._stop(None)
        return self

    def _check_needs(self) -> None:
        for number, module in enumerate(self._modules):
            before = {each.NAME for each in self._modules[:number]}
            for name in module.NEEDS:
                if name not in before:
                    there = "has its turn later" if any(name == m.NAME for m in self._modules) else "isn't there"
                    raise StateError(f"{module.describe()} needs the module {name!r} before it, which {there}")

    def cycle(self) -> None:
        """Do one frame: each module has its turn.

        Raises:
            StateError: if it isn't open, or a module has its turn already.
        """
        if not self._open:
            raise StateError("App.cycle(): the App isn't open; use run(), open(), or a with block")
        if self._in_turn:
            raise StateError("App.cycle() was called from within a frame, or while the App was opened")
        timings = {}
        try:
            for module in self._modules:
                before = time.perf_counter()
                with self._turn(module, "having its turn"):
                    module.cycle()
                timings[module.NAME] = time.perf_counter() - before
                if self._closing:
                    break
        except BaseException as error:
            if self._closing:
                self._stop(error)
            raise
        if self._closing:
            self._stop(None)
        self.timings = {**timings, **self.scene.timings, **self.video.timings}
        self.scene.aids.note(self.timings)

    def quit(self) -> None:
        """Let `run` end after this frame."""
        self._quit = True

    @property
    def quitting(self) -> bool:
        """Whether `quit` was called: by the user who closed the window, or by the game."""
        return self._quit

    def run(self, frames: int | None = None) -> None:
        """Open it unless it is open, do frames until somebody quits, and close it.

        Args:
            frames: how many to do at most; None: no limit.

        What a module raises leaves this call when all have been stopped.

        Raises:
            FieldError: if frames is not a whole number of at least 0.
            StateError: as `open`.
        """
        left = FRAMES("App.run()", "frames", frames)
        with self:
            while not self._quit and left != 0:
                self.cycle()
                if left is not None:
                    left -= 1

    def close(self) -> None:
        """Stop all modules in reverse order; closing twice does nothing. All are stopped even if one fails.

        From within a frame, or while it is opened: as soon as the module that has its turn is done, and no other has
        one then.
        """
        self._quit = True
        self._stop(None)

    @contextmanager
    def _turn(self, module: Module, doing: str) -> Iterator[None]:
        """Within it nothing is stopped: the module, and what it has called, may still need all of them."""
        self._in_turn = True
        try:
            with _noting(module, doing):
                yield
        finally:
            self._in_turn = False

    def _stop(self, cause: BaseException | None) -> None:
        if self._in_turn:
            self._closing = self._quit = True
            return
        self._closing = False
        errors: list[BaseException] = []
        while self._started:
            module = self._started.pop()
            try:
                with _noting(module, "being stopped"):
                    module.stop()
            except BaseException as error:  # noqa: BLE001 - the others have to be stopped too
                errors.append(error)
            finally:
                module._app = None
        self._open = False
        if App._current is self:
            App._current = None
        if cause is not None:
            for other in errors:
                cause.add_note(f"and then, in stopping: {other!r}")
        elif len(errors) == 1:
            raise errors[0]
        elif errors:
            raise BaseExceptionGroup("several modules failed to stop", errors)

    def __enter__(self) -> Self:
        return self if self._open else self.open()

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._stop(error)


@contextmanager
def _noting(module: Module, doing: str) -> Iterator[None]:
    """Note on an error which module raised it, and when."""
    try:
        yield
    except Exception as error:
        error.add_note(f"while {module.describe()} was {doing}")
        raise


def _check_has(name: str, value: object, *methods: str) -> None:
    if value is not None and not all(callable(getattr(value, method, None)) for method in methods):
        raise FieldError(f"App.{name} is {shown(value)}; it must have {' and '.join(m + '()' for m in methods)}")


def _in_order(core: list[Module], more: Iterable[Module]) -> list[Module]:
    """The core modules with the others between events and scene, or in place of those of their names."""
    result = list(core)
    place = EXPECTED.index("scene")
    names: set[str] = set()
    if not isinstance(more, Iterable):
        raise FieldError(f"App.modules is {shown(more)}; it must be a list of Modules")
    for module in more:
        if not isinstance(module, Module):
            raise FieldError(f"App.modules has {shown(module)}; it must be Modules only")
        if not module.NAME or module.NAME in names:
            raise FieldError(f"App.modules: {module.describe()} needs a NAME that no other has")
        names.add(module.NAME)
        if module.NAME in EXPECTED:
            wanted = type(core[EXPECTED.index(module.NAME)])
            base = Scene if module.NAME == "scene" else wanted
            if not isinstance(module, base):
                raise FieldError(
                    f"App.modules: {module.describe()} takes the place of the {base.__name__}, and must be one"
                )
            result[[each.NAME for each in result].index(module.NAME)] = module
        else:
            result.insert(place, module)
            place += 1
    return result
