"""What users test their games with."""

import math
import sys

import numpy as np
import pytest

import osgode as oo
from osgode.engine import (
    App,
    AppConfig,
    ClockConfig,
    EventsConfig,
    HudBox,
    HudText,
    Module,
    Press,
    Scene,
    VideoConfig,
    Wheel,
)
from osgode.errors import FieldError, MissingExtraError, OsgodeError, StateError
from osgode.render import OffscreenDrawer, Quality
from osgode.testing import Play
from tests.engine.games import Tumble, Yard

NO_LIMIT = AppConfig(clock=ClockConfig(frame_limit=None))


class Pushed(Tumble):
    """A tumbling scene that a player pushes about."""

    def populate_hud(self):
        self.counter = self.hud.attach(HudText("0", name="counter"))

    def each_frame(self):
        if self.events.pressed("attach"):
            self.world.find("thing3").add_force((0, 300, 0))
        self.counter.text = str(self.world.steps)


def script(play):
    """What a player does for a while; returns fingerprints on the way."""
    prints = []
    play.hold("forward", "left")
    play.seconds(0.5)
    prints.append(play.fingerprint())
    play.tap("attach", 3)
    play.look(0.4, 0.1)
    play.frames(2)
    play.release("forward", "left")
    play.turn_wheel(2)
    play.tap("slower")
    play.steps(30)
    prints.append(play.fingerprint())
    play.look_at(play.body("thing5").position)
    play.frames(7)
    prints.append(play.fingerprint())
    return prints


def test_one_script_gives_the_same_bits():
    """Played twice, all on the way is the same to the bit; another script gives something else."""
    runs = []
    for _ in range(2):
        with Play(Pushed) as play:
            runs.append(script(play))
    assert runs[0] == runs[1]
    assert len(set(runs[0])) == 3
    with Play(Pushed) as play:
        play.hold("forward", "left")
        play.seconds(0.5)
        assert play.fingerprint() == runs[0][0]
        play.frames(1)
        assert play.fingerprint() != runs[0][0]


def test_the_frame_rate_changes_no_physics():
    """Steps are the same at any frame rate: the bodies' part of it all has the same bits."""
    tables = set()
    for rate in (25.0, 60.0, 144.0, None):
        with Play(Tumble, AppConfig(clock=ClockConfig(frame_limit=rate))) as play:
            play.steps(100)
            assert play.scene.world.steps == 100
            tables.add(play.scene.world.poses.tobytes())
    assert len(tables) == 1


def test_fingerprints_see_every_bit():
    """A velocity, a joint's angle or the camera that differ by next to nothing show."""
    with Play(Yard) as play:
        cart, camera = play.scene.cart, play.scene.camera
        seen = {play.fingerprint()}
        cart.arm.linear_velocity = (0, 1e-300, 0)
        seen.add(play.fingerprint())
        camera.yaw += 1e-12
        seen.add(play.fingerprint())
        cart.hull.position = (0, 0, 5e-324)
        seen.add(play.fingerprint())
        assert len(seen) == 4
        assert play.fingerprint() in seen


# -- what the player does


def test_holding_and_letting_go():
    """Names are those of actions, keys or buttons; what is sent happens in the next frame."""
    with Play(Scene) as play:
        events = play.app.events
        play.hold("forward", "mouse_left")
        assert not events.held("forward")
        play.frames(1)
        assert events.held("forward")
        assert events.held("mouse_left")
        play.release("w")
        play.frames(1)
        assert not events.held("forward")
        assert events.held("mouse_left")


def test_tapping_lasts_as_many_frames_as_was_said():
    with Play(Scene) as play:
        held = []
        play.scene.each_frame = lambda: held.append(play.app.events.held("space"))
        play.tap("ascend", 3)
        assert held == [True, True, True, False]


def test_looking_and_the_wheel():
    with Play(Scene, AppConfig(events=EventsConfig(mouse_sensitivity=0.01))) as play:
        camera = play.scene.camera
        assert not play.app.events.captured
        play.look(0.25, -0.125)
        assert play.app.events.captured
        play.frames(1)
        assert (camera.yaw, camera.pitch) == pytest.approx((-0.25, 0.125))
        play.frames(1)
        assert (camera.yaw, camera.pitch) == pytest.approx((-0.25, 0.125))
        play.turn_wheel(-1.5)
        play.send(Wheel(1.0), Press("x"))
        play.frames(1)
        assert play.app.events.wheel == -0.5
        assert play.app.events.held("x")
        play.look_at((0, 1.7, 10))
        assert camera.forward == pytest.approx((0, 0, 1), abs=1e-12)


def test_a_mouse_that_can_turn_nothing():
    with (
        Play(Scene, AppConfig(events=EventsConfig(mouse_sensitivity=0.0))) as play,
        pytest.raises(StateError, match="sensitivity"),
    ):
        play.look(0.1)


@pytest.mark.parametrize("act", ["hold", "release", "tap"])
def test_unknown_names_are_not_pressed(act):
    """A name that means nothing is told, and nothing of that call is pressed."""
    with Play(Scene) as play:
        with pytest.raises(FieldError, match="did you mean 'forward'"):
            getattr(play, act)("foward")
        play.app.events.bind("fire", ())
        with pytest.raises(FieldError, match="bound to 'fire'"):
            getattr(play, act)("fire")
        with pytest.raises(FieldError):
            play.hold("w", "nothing")
        play.frames(1)
        assert not play.app.events.held("w")


# -- time


@pytest.mark.parametrize("config", [None, NO_LIMIT, AppConfig(clock=ClockConfig(frame_limit=30.0))])
def test_frames_and_seconds(config):
    """A frame takes what the frame limit says, a 60th of a second without one."""
    with Play(Scene, config) as play:
        rate = 30.0 if config is not None and config.clock.frame_limit else 60.0
        play.frames(6)
        assert play.app.clock.frames == 6
        assert play.app.clock.elapsed == pytest.approx(6 / rate)
        play.seconds(0.5)
        assert play.app.clock.elapsed == pytest.approx(6 / rate + 0.5)
        assert play.scene.world.steps == round(120 * (6 / rate + 0.5))
        play.frames(0)
        play.seconds(0)
        assert play.app.clock.frame_limit == (config.clock.frame_limit if config else 60.0)


@pytest.mark.parametrize("speed", [0.001, 0.3, 1.0, 16.0, 1000.0])
def test_steps_are_counted(speed):
    """One step a frame, at any speed; the frame limit stays as it was, and so does what was left of a step."""
    with Play(Scene, AppConfig(clock=ClockConfig(speed=speed, frame_limit=50.0))) as play:
        play.frames(1)
        before = play.scene.world.steps
        frames = play.app.clock.frames
        play.steps(25)
        assert play.scene.world.steps == before + 25
        assert play.app.clock.frames - frames == 25
        assert play.app.clock.frame_limit == 50.0
        play.steps(0)
        assert play.scene.world.steps == before + 25


@pytest.mark.parametrize("way", ["paused", "speed", "tapped"])
def test_steps_that_can_not_come(way):
    """While the simulation stands still there are no steps; that is told, and not waited for."""
    with Play(Scene) as play:
        if way == "paused":
            play.app.clock.paused = True
        elif way == "speed":
            play.app.clock.speed = 0.0
        else:
            play.hold("pause")
        with pytest.raises(StateError, match=r"Play\.steps\(\).*paused"):
            play.steps(10)
        assert play.app.clock.frame_limit == 60.0


@pytest.mark.parametrize("config", [None, NO_LIMIT])
def test_waiting_until(config):
    """It returns how long it took, at once if it is so already, and gives up in the end."""
    with Play(Tumble, config) as play:
        thing = play.body("thing0")
        took = play.until(lambda: thing.position.y < 0.4)
        assert took == pytest.approx(play.app.clock.elapsed)
        # Falling 0.2 m takes sqrt(2 * 0.2 / g) s.
        assert took == pytest.approx(math.sqrt(0.4 / 9.81), abs=2.5 / 60)
        assert play.until(lambda: True) == 0.0
        with pytest.raises(AssertionError, match=r"wasn't so after 0\.5"):
            play.until(lambda: thing.position.y > 100, 0.5)
        assert play.app.clock.elapsed == pytest.approx(took + 0.5, abs=1 / 59)


def test_quitting_ends_the_play():
    """After somebody has quit no frame is played, and what is waited for doesn't come."""
    with Play(Scene) as play:
        play.tap("quit", 5)
        assert play.app.quitting
        frames = play.app.clock.frames
        assert frames == 1
        play.frames(10)
        play.steps(10)
        play.seconds(1)
        assert play.app.clock.frames == frames
        with pytest.raises(AssertionError, match="quit"):
            play.until(lambda: False)


@pytest.mark.parametrize(
    "act",
    [
        lambda play: play.frames(-1),
        lambda play: play.frames(1.5),
        lambda play: play.seconds(-1),
        lambda play: play.seconds(math.nan),
        lambda play: play.steps(-3),
        lambda play: play.until(lambda: False, -1),
        lambda play: play.node("nobody"),
        lambda play: play.body("nobody"),
        lambda play: play.body("dynamic"),
        lambda play: play.look_at("there"),
        lambda play: play.picture(size=(0, 10)),
    ],
)
def test_bad_calls_of_a_play(act):
    """Wrong numbers and names are refused with the call's name, and no frame is played."""
    with Play(Tumble) as play:
        with pytest.raises(FieldError):
            act(play)
        assert play.app.clock.frames == 0


def test_bad_plays():
    with pytest.raises(FieldError, match=r"Play\.config"):
        Play(Scene, VideoConfig())
    with pytest.raises(FieldError, match=r"App\.scene"):
        Play(oo.World)
    play = Play(Scene)
    with pytest.raises(StateError, match="isn't open"):
        play.frames(1)


# -- what is there


def test_finding_nodes():
    with Play(Tumble) as play:
        assert play.node("dynamic") is play.scene.dynamic
        assert play.body("thing2").name == "thing2"
        with pytest.raises(FieldError, match=r"'thing9'; there are Tumble, dynamic, hud, static, thing0"):
            play.node("thing9")
        with pytest.raises(FieldError, match="no Body"):
            play.body("static")


def test_a_play_is_an_app():
    """What it plays is the App of this process; an error in the block closes it; modules go along."""

    class Sound(Module):
        NAME = "sound"
        played = 0

        def cycle(self):
            self.played += 1

    sound = Sound()
    with Play(Scene, modules=[sound]) as play:
        assert App.current() is play.app
        assert play.app.video.window is None
        play.frames(3)
    assert sound.played == 3

    def fail():
        with Play(Scene):
            raise RuntimeError("a test that fails")

    with pytest.raises(RuntimeError, match="a test that fails"):
        fail()
    with Play(Scene):
        pass


# -- pictures


class Red(Scene):
    """A red wall that fills the picture, and a green box of the overlay."""

    def populate_world(self):
        self.world.gravity = (0, 0, 0)
        red = oo.Appearance((1, 0, 0), unlit=True)
        self.wall = self.static.attach(oo.Placeable(position=(0, 1.7, -5)))
        self.wall.attach(oo.Box((100, 100, 1), appearance=red))

    def populate_hud(self):
        self.hud.attach(HudBox("top left", width=360, height=360, colour=(0, 1, 0, 1)))


def drawn(play, *arguments, **options):
    """A picture, where there is something to draw with."""
    try:
        return play.picture(*arguments, **options)
    except OsgodeError as error:
        pytest.skip(str(error))


def test_pictures(tmp_path):
    """Of any size, of now, with the overlay; written as a PNG; drawing changes nothing."""
    with Play(Red) as play:
        before = play.fingerprint()
        image = drawn(play, size=(160, 80))
        assert image.shape == (80, 160, 3)
        assert image.dtype == np.uint8
        assert (image[:38, :38] == [0, 255, 0]).all(), "half as high as the picture, and as wide"
        assert np.abs(image[60, 100].astype(int) - [255, 0, 0]).max() <= 3, "a little haze lies before it"
        path = tmp_path / "red.png"
        again = drawn(play, path, size=(160, 80))
        assert (again == image).all()
        pil = pytest.importorskip("PIL.Image")
        assert (np.asarray(pil.open(path)) == image).all()
        play.look_at((0, 1.7, 50))
        other = drawn(play, size=(160, 80))
        assert (other[60, 100] != image[60, 100]).any(), "the camera has turned at once"
        assert play.scene.world.steps == 0
        play.scene.camera.look_at((0, 1.7, -5))
        assert play.fingerprint() == before
        assert drawn(play).shape == (640, 1024, 3)


def test_a_picture_needs_what_draws(monkeypatch):
    """Without the extra it says what to install; the play goes on."""
    monkeypatch.setitem(sys.modules, "moderngl", None)
    with Play(Red) as play:
        with pytest.raises(MissingExtraError, match=r"pip install osgode\[render\]"):
            play.picture()
        play.frames(1)


def test_offscreen_frames_are_drawn():
    """In the mode "offscreen" every frame is drawn, with the same physics as without."""
    quality = Quality(samples=0, shadow_size=64)
    app = App(Red, AppConfig(video=VideoConfig(mode="offscreen", size=(64, 40), quality=quality)))
    try:
        app.open()
    except OsgodeError as error:
        pytest.skip(str(error))
    with app:
        for _ in range(3):
            app.cycle()
        image = app.video.drawer.image()
        assert image.shape == (40, 64, 3)
        assert (image[:18, :18] == [0, 255, 0]).all()
        assert (app.video.picture() == image).all()
        assert {"draw", "cull"} <= app.timings.keys()
        assert app.clock.elapsed == pytest.approx(3 / 60)
    assert app.video.drawer is None


@pytest.mark.parametrize("quality", [None, Quality(samples=0, shadow_size=64)])
def test_quality_of_pictures_for_files(monkeypatch, quality):
    """In full quality whoever draws, unless the settings say otherwise."""
    asked = []

    class Noting(OffscreenDrawer):
        def __init__(self, size, quality):
            asked.append((size, quality))
            super().__init__(size, quality)

    monkeypatch.setattr("osgode.engine.video.OffscreenDrawer", Noting)
    app = App(Red, AppConfig(video=VideoConfig(mode="none", size=(64, 40), quality=quality)))
    try:
        app.open()
        with app:
            app.video.picture()
    except OsgodeError as error:
        pytest.skip(str(error))
    assert asked == [((64, 40), quality or Quality())]
