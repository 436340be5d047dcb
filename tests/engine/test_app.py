"""The life of an App: modules are started in order, have their turns, and are stopped in reverse, whatever fails."""

import gc
import weakref
from dataclasses import dataclass

import pytest

import osgode as oo
from osgode.engine import (
    App,
    AppConfig,
    Clock,
    ClockConfig,
    Config,
    Events,
    EventsConfig,
    HandTime,
    Module,
    Press,
    Quit,
    RealTime,
    Scene,
    SceneConfig,
    ScriptedInput,
    Video,
    VideoConfig,
)
from osgode.errors import FieldError, StateError
from osgode.fields import number

BARE = AppConfig(video=VideoConfig(mode="none"))


class Noting(Module):
    """Writes down what is done with it, and fails when it is told to."""

    NAME = "noting"
    LOG: list[str]

    def __init__(self, log, fail="", error=ValueError):
        self.log, self.fail, self.error = log, fail, error

    def _note(self, what):
        self.log.append(f"{self.NAME} {what}")
        if self.fail == what:
            raise self.error(f"{self.NAME} can't {what}")

    def start(self):
        assert self.app.is_open
        self._note("start")

    def cycle(self):
        self._note("cycle")

    def stop(self):
        assert self.app is not None
        self._note("stop")


class Second(Noting):
    NAME = "second"
    NEEDS = ("noting", "clock")


class NotingScene(Scene):
    """The same for a scene."""

    log: list[str]

    def populate_world(self):
        self.log.append("world")

    def populate_hud(self):
        self.log.append("hud")

    def cycle(self):
        super().cycle()
        self.log.append("scene cycle")

    def stop(self):
        super().stop()
        self.log.append("scene stop")


def scene_with(log):
    return type("Logged", (NotingScene,), {"log": log})


def test_order_of_turns():
    """Core modules first, then the game's, then the scene and the picture; stopped in reverse."""
    log = []
    app = App(scene_with(log), BARE, modules=[Noting(log), Second(log)])
    assert [module.NAME for module in app.modules] == ["clock", "events", "noting", "second", "scene", "video"]
    app.run(2)
    turn = ["noting cycle", "second cycle", "scene cycle"]
    start = ["noting start", "second start", "world", "hud"]
    assert log == [*start, *turn, *turn, "scene stop", "second stop", "noting stop"]
    assert not app.is_open
    assert set(app.timings) >= {"clock", "events", "noting", "second", "scene", "video", "steps", "update"}


@pytest.mark.parametrize("moment", ["start", "cycle"])
@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_what_fails_is_torn_down_in_reverse(moment, error):
    """Whichever module fails, all that were started are stopped, it too; the error comes out with its name."""
    log = []
    app = App(scene_with(log), BARE, modules=[Noting(log), Second(log, moment, error)])
    with pytest.raises(error, match=f"second can't {moment}") as caught:
        app.run(3)
    assert log[-2:] == ["second stop", "noting stop"]
    assert log.count("scene stop") == (moment == "cycle")
    assert not app.is_open
    assert all(module._app is None for module in app.modules)
    if error is ValueError:
        assert "Second (module 'second')" in caught.value.__notes__[0]
    with pytest.raises(StateError, match="no App is open"):
        App.current()
    App(Scene, BARE).run(1)


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_failures_to_stop_stop_nobody_else(error):
    """All modules are stopped; one error comes out as itself, with the module's name."""
    log = []
    app = App(scene_with(log), BARE, modules=[Noting(log), Second(log, "stop", error)])
    with pytest.raises(error, match="second can't stop"):
        app.run(1)
    assert log[-3:] == ["scene stop", "second stop", "noting stop"]
    assert App._current is None


def test_several_failures_to_stop_come_as_a_group():
    log = []
    app = App(Scene, BARE, modules=[Noting(log, "stop"), Second(log, "stop")])
    with pytest.raises(ExceptionGroup, match="failed to stop") as caught:
        app.run(1)
    assert [str(error) for error in caught.value.exceptions] == ["second can't stop", "noting can't stop"]
    assert "being stopped" in caught.value.exceptions[0].__notes__[0]
    assert not app.is_open


@pytest.mark.parametrize("moment", ["start", "cycle"])
def test_the_first_error_is_the_one_that_counts(moment):
    """What fails in stopping after an error is noted on that error."""
    log = []
    app = App(Scene, BARE, modules=[Noting(log, "stop"), Second(log, moment)])
    with pytest.raises(ValueError, match=f"second can't {moment}") as caught:
        app.run(1)
    assert any("noting can't stop" in note for note in caught.value.__notes__)


def test_a_scene_that_fails_to_fill():
    """An error in `populate_world` leaves no open App, and what it made is freed."""

    class Broken(Scene):
        def populate_world(self):
            self.dynamic.attach(oo.Body())
            raise RuntimeError("no level")

    with pytest.raises(RuntimeError, match="no level"):
        App(Broken, BARE).run()
    App(Scene, BARE).run(1)


def test_a_with_block_that_fails():
    """An error in the block of the user is what comes out."""
    log = []

    def play():
        with App(Scene, BARE, modules=[Noting(log)]) as app:
            app.cycle()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        play()
    assert log == ["noting start", "noting cycle", "noting stop"]


def test_one_app_at_a_time():
    """A second App is refused while one is open, and fine when that is gone; the first isn't disturbed."""
    with App(Scene, BARE) as app:
        assert App.current() is app
        with pytest.raises(StateError, match="another App is open"):
            App(Scene, BARE).open()
        assert App.current() is app
        app.cycle()
    with pytest.raises(StateError):
        App.current()
    with App(Scene, BARE) as other:
        assert App.current() is other


def test_an_app_is_opened_once():
    """A scene is filled once: opening an App again is refused, and leaves no App open."""
    app = App(Scene, BARE)
    app.run(1)
    with pytest.raises(StateError, match="opened before"):
        app.run(1)
    with pytest.raises(StateError, match="isn't open"):
        app.cycle()
    assert App._current is None
    app.close()


def test_an_app_that_was_opened_by_hand():
    """`run` closes it in the end; closing again does nothing."""
    log = []
    app = App(Scene, BARE, modules=[Noting(log)]).open()
    app.cycle()
    app.run(2)
    app.close()
    assert log == ["noting start", *3 * ["noting cycle"], "noting stop"]


def test_modules_reach_the_app_and_one_another():
    class Reaching(Module):
        NAME = "reaching"

        def start(self):
            assert self.app is App.current()
            self.seen = [self.app.clock, self.app.events, self.app.scene, self.app.module("reaching")]

    module = Reaching()
    with pytest.raises(StateError, match="Reaching"):
        _ = module.app
    app = App(Scene, BARE, modules=[module])
    with pytest.raises(FieldError, match=r"'sound'.*reaching"):
        app.module("sound")
    app.run(1)
    assert module.seen == [app.clock, app.events, app.scene, module]
    with pytest.raises(StateError, match="not started"):
        _ = module.app


@pytest.mark.parametrize(("needs", "words"), [("sound", "isn't there"), ("video", "has its turn later")])
def test_missing_modules_are_named(needs, words):
    """A module that lacks another is told of before anything is started."""
    log = []
    module = type("Needy", (Noting,), {"NEEDS": (needs,)})(log)
    with pytest.raises(StateError, match=f"Needy.*'{needs}'.*{words}"):
        App(Scene, BARE, modules=[module]).run()
    assert log == []
    assert App._current is None


def test_core_modules_can_be_replaced():
    """A module of a core module's name takes its place and turn, if it is one of that kind."""

    class SlowClock(Clock):
        def cycle(self):
            super().cycle()
            self.delta /= 2

    clock = SlowClock(timer=HandTime())
    app = App(Scene, BARE, modules=[clock])
    assert app.clock is clock
    assert [module.NAME for module in app.modules] == ["clock", "events", "scene", "video"]
    app.run(10)
    assert clock.frames == 10
    assert app.scene.world.steps == 10
    mine = Scene()
    assert App(Scene, BARE, modules=[mine]).scene is mine
    assert App(mine, BARE).scene is mine

    class Impostor(Module):
        NAME = "clock"

    with pytest.raises(FieldError, match=r"Impostor.*place of the Clock"):
        App(Scene, BARE, modules=[Impostor()])


class Nameless(Module):
    """A module that forgot its name."""


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: App(Module), "App.scene"),
        (lambda: App("scene"), "App.scene is 'scene'"),
        (lambda: App(Scene, BARE, modules=[Nameless()]), "Nameless.*NAME"),
        (lambda: App(Scene, BARE, modules=[Noting([]), Noting([])]), "noting.*no other"),
        (lambda: App(Scene, BARE, modules=["sound"]), "'sound'"),
        (lambda: App(Scene, ClockConfig()), "App.config.*AppConfig"),
        (lambda: AppConfig(clock=EventsConfig()), "AppConfig.clock.*ClockConfig"),
        (lambda: AppConfig(scene={"step_size": 0.1}), "AppConfig.scene.*SceneConfig"),
        (lambda: AppConfig(video=None), "AppConfig.video.*VideoConfig"),
        (lambda: SceneConfig(step_size=0.0), "SceneConfig.step_size"),
        (lambda: SceneConfig(gravity=9.81), "SceneConfig.gravity"),
        (lambda: SceneConfig(max_steps=0), "SceneConfig.max_steps"),
        (lambda: SceneConfig(max_steps=2.5), "SceneConfig.max_steps"),
        (lambda: SceneConfig(sun=3), "SceneConfig.sun.*Sun"),
        (lambda: SceneConfig(hud_height=0), "SceneConfig.hud_height"),
        (lambda: EventsConfig(bindings=[("jump", "j")]), "EventsConfig.bindings.*Mapping"),
        (lambda: EventsConfig(mouse_sensitivity=-1), "EventsConfig.mouse_sensitivity"),
        (lambda: EventsConfig(capture="yes"), "EventsConfig.capture"),
        (lambda: VideoConfig(mode="screen"), "VideoConfig.mode.*window, offscreen, none"),
        (lambda: VideoConfig(size=(0, 10)), "VideoConfig.size"),
        (lambda: VideoConfig(size=100), "VideoConfig.size"),
        (lambda: VideoConfig(size=(640.5, 480)), "VideoConfig.size.*whole"),
        (lambda: VideoConfig(size="99"), "VideoConfig.size"),
        (lambda: VideoConfig(title=3), "VideoConfig.title is 3; it must be a text"),
        (lambda: VideoConfig(vsync="no"), "VideoConfig.vsync.*True or False"),
        (lambda: VideoConfig(full_screen=2), "VideoConfig.full_screen.*True or False"),
        (lambda: EventsConfig(bindings={"jump": "spce"}), "EventsConfig.bindings.*jump.*did you mean 'space'"),
        (lambda: Scene(3), "Scene.config is 3; it must be of the class SceneConfig"),
        (lambda: Clock(3), "Clock.config is 3; it must be of the class ClockConfig"),
        (lambda: Events(3), "Events.config is 3; it must be of the class EventsConfig"),
        (lambda: Video(3), "Video.config is 3; it must be of the class VideoConfig"),
        (lambda: App(timer=3), "App.timer is 3; it must have now"),
        (lambda: App(source=3), "App.source is 3; it must have poll"),
        (lambda: App(modules=3), "App.modules is 3; it must be a list of Modules"),
        (lambda: VideoConfig(quality="full"), "VideoConfig.quality is 'full'.*Quality"),
    ],
)
def test_bad_arguments_of_apps(make, words):
    """Wrong parts and settings are refused where they are given, by name."""
    with pytest.raises(FieldError, match=words):
        make()


def test_configs_of_ones_own():
    """A game's config nests and is checked as the core's are."""

    @dataclass(frozen=True, kw_only=True)
    class SoundConfig(Config):
        CHECKS = {"volume": number(0.0, 1.0)}  # noqa: RUF012 - as in the engine
        volume: float = 0.5

    assert SoundConfig(volume=1).volume == 1.0
    with pytest.raises(FieldError, match=r"SoundConfig.volume"):
        SoundConfig(volume=2)


@pytest.mark.parametrize("wrong", [-1, 1.5, "10", True])
def test_bad_numbers_of_frames(wrong):
    """A run of -1 frames would never end."""
    app = App(Scene, BARE)
    with pytest.raises(FieldError, match="frames"):
        app.run(wrong)
    assert not app.is_open
    app.run(0)
    assert app.clock.frames == 0


def test_quitting_ends_after_the_frame():
    """By the game, by the user who closes the window, by a key; the frame is finished."""

    class Quitter(Module):
        NAME = "quitter"

        def cycle(self):
            if self.app.clock.frames == 3:
                self.app.quit()

    log = []
    app = App(scene_with(log), BARE, modules=[Quitter()])
    app.run()
    assert app.quitting
    assert log.count("scene cycle") == 3

    source = ScriptedInput()
    source.send(Quit())
    app = App(Scene, BARE, source=source)
    app.run()
    assert app.clock.frames == 1


def test_quitting_before_the_first_frame():
    class Never(Scene):
        def populate_world(self):
            self.app.quit()

    app = App(Never, BARE)
    app.run()
    assert app.clock.frames == 0


def test_closing_from_within():
    """An App that is closed in a turn does no more turns, and `run` ends."""
    log = []

    class Closer(Module):
        NAME = "closer"

        def cycle(self):
            self.app.close()

    app = App(scene_with(log), BARE, modules=[Closer(), Noting(log)])
    app.run()
    assert log == ["noting start", "world", "hud", "scene stop", "noting stop"]


def test_where_time_comes_from():
    """A window goes by the wall, all else by hand; what is given is taken."""
    assert isinstance(App(Scene).clock.timer, RealTime)
    assert isinstance(App(Scene, BARE).clock.timer, HandTime)
    assert isinstance(App(Scene, AppConfig(video=VideoConfig(mode="offscreen"))).clock.timer, HandTime)
    timer = RealTime()
    assert App(Scene, BARE, timer=timer).clock.timer is timer


def test_headless_time_passes_without_a_frame_limit():
    """A frame then takes a 60th of a second, or a headless run would stand still."""
    app = App(Scene, AppConfig(video=VideoConfig(mode="none"), clock=ClockConfig(frame_limit=None)))
    app.run(60)
    assert app.clock.elapsed == pytest.approx(1.0)
    assert app.scene.world.steps == 120


def test_a_dropped_app_is_freed():
    """When it is closed and nobody holds it, scene and World go."""
    app = App(Scene, BARE)
    app.run(3)
    refs = [weakref.ref(each) for each in (app, app.scene, app.scene.world)]
    del app
    gc.collect()
    assert not any(ref() for ref in refs)


def test_the_world_lives_on_after_the_app():
    """What was played can be looked at afterwards."""
    app = App(Scene, BARE)
    app.run(6)
    assert app.scene.world.steps == 12
    app.scene.world.step()
    with pytest.raises(StateError, match="not started"):
        _ = app.scene.clock


def test_the_core_modules_by_themselves():
    """Each core module is what its name says."""
    app = App(Scene, BARE)
    kinds = {"clock": Clock, "events": Events, "scene": Scene, "video": Video}
    for name, kind in kinds.items():
        assert type(app.module(name)) is kind
        assert getattr(app, name) is app.module(name)


@pytest.mark.parametrize(
    "hook", ["populate_world", "populate_hud", "bind_actions", "steer", "each_frame", "before_step", "move_camera"]
)
def test_closing_in_any_hook_of_a_scene(hook):
    """The scene ends its turn with all modules there, the inspector too, and only then the App is closed."""

    class Closing(Scene):
        def populate_world(self):
            self.aids.inspecting = True

    def close(self):
        getattr(super(Closing, self), hook)()
        self.app.close()
        assert self.app.is_open

    setattr(Closing, hook, close)
    app = App(Closing, BARE)
    app.run(5)
    assert not app.is_open
    assert app._started == []
    assert App._current is None


def test_closing_in_a_listener_in_a_scheduled_call_and_in_an_update():
    def pressed(scene):
        scene.events.on_press("j")(scene.app.close)

    def scheduled(scene):
        scene.world.schedule(lambda _: scene.app.close())

    def updated(scene):
        scene.dynamic.on_update(lambda _: scene.app.close())

    for prepare in (pressed, scheduled, updated):

        class Closing(Scene):
            def populate_world(self, prepare=prepare):
                self.aids.inspecting = True
                prepare(self)

        source = ScriptedInput()
        source.send(Press("j"))
        app = App(Closing, BARE, source=source)
        app.run(5)
        assert not app.is_open
        assert app.clock.frames == 1


def test_closing_while_it_is_opened_starts_no_more():
    log = []

    class Closer(Module):
        NAME = "closer"

        def start(self):
            self.app.close()

    app = App(scene_with(log), BARE, modules=[Closer(), Noting(log)]).open()
    assert not app.is_open
    assert log == []


def test_an_error_after_closing_from_within():
    """The App is closed all the same, also for who has opened it by hand."""

    class Failing(Module):
        NAME = "failing"

        def cycle(self):
            self.app.close()
            raise ValueError("after closing")

    app = App(Scene, BARE, modules=[Failing()]).open()
    with pytest.raises(ValueError, match="after closing"):
        app.cycle()
    assert not app.is_open
    assert App._current is None


@pytest.mark.parametrize("call", [lambda app: app.cycle(), lambda app: app.run(1)])
def test_a_frame_within_a_frame_is_refused(call):
    class Nested(Module):
        NAME = "nested"

        def cycle(self):
            with pytest.raises(StateError, match="from within a frame"):
                call(self.app)

    App(Scene, BARE, modules=[Nested()]).run(1)


def test_a_scene_is_filled_once():
    """In a second App it would have everything twice."""
    log = []
    scene = scene_with(log)()
    App(scene, BARE).run(1)
    before = list(log)
    with pytest.raises(StateError, match="filled before, for another App"):
        App(scene, BARE).run(1)
    assert [each for each in log if each != "scene stop"] == [each for each in before if each != "scene stop"]
