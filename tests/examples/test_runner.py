"""What the examples share."""

import math

import pytest

import osgode as oo
from osgode.engine import Camera, MouseMotion, Press, Release, Wheel, video
from osgode.examples import __main__ as everything
from osgode.examples import runner
from osgode.examples.crates import Crates
from osgode.examples.runner import Orbit
from osgode.render import RecordingDrawer


@pytest.mark.parametrize(("yaw", "pitch", "seconds"), [(0, 0, 0), (1.2, 0.4, 0), (-2.0, 1.2, 3.0)])
def test_the_camera_looks_at_its_target_from_its_distance(yaw, pitch, seconds):
    orbit = Orbit(oo.Vec3(1, 2, 3), 5.0, yaw, pitch, turn=0.3)
    camera = Camera()
    orbit.place(camera, seconds)
    eye = camera.view().pose
    assert tuple(eye.inverse().transform(orbit.target)) == pytest.approx((0, 0, -5), abs=1e-12)
    assert eye.rotation.rotate((1, 0, 0)).y == pytest.approx(0, abs=1e-12)  # its horizon is level
    assert eye.position.y == pytest.approx(2 + 5 * math.sin(pitch))


def test_dragging_turns_the_camera_and_stops_its_own_turning():
    orbit = Orbit(oo.Vec3(0, 0, 0), 5.0, turn=0.3)
    orbit.drag(0.5, 9.0)
    assert (orbit.yaw, orbit.turn) == (-0.5, 0)
    assert orbit.pitch < math.pi / 2


class FakeWindow(RecordingDrawer):
    """As the real one, but it only records; closed by the user after some frames."""

    focused = True

    def __init__(self, lasts):
        super().__init__()
        self.lasts, self.closed, self.size, self.focused = lasts, False, (64, 36), True

    def pump(self):
        import pygame

        return [pygame.event.Event(pygame.QUIT)] if self.drawn >= self.lasts else []

    def close(self):
        self.closed = True


@pytest.mark.parametrize(("frames", "lasts", "drawn"), [(4, 100, 4), (None, 3, 4)])
def test_a_window_is_drawn_until_it_is_closed_or_the_frames_are_up(frames, lasts, drawn, monkeypatch):
    pytest.importorskip("pygame")
    window, example = FakeWindow(lasts), Crates()
    monkeypatch.setattr(runner, "has_screen", lambda: True)
    monkeypatch.setattr(video, "Window", lambda *_: window)
    (told,) = runner.play(example, frames)
    assert window.drawn == drawn
    assert window.closed
    assert "steps per second" in told


def test_in_a_window_the_mouse_and_the_keys_go_round_and_the_wheel_nearer():
    with runner.without_window(Crates(), 60.0) as app:
        orbit, source = app.scene.orbit, app.events.source
        yaw, pitch, distance = orbit.yaw, orbit.pitch, orbit.distance
        source.send(Press("mouse_left"), MouseMotion(50, -10), Wheel(1))
        app.cycle()
        assert (orbit.yaw, orbit.pitch) == pytest.approx((yaw - 50 * runner.DRAG, pitch - 10 * runner.DRAG))
        assert orbit.distance == pytest.approx(distance * runner.ZOOM)
        source.send(Release("mouse_left"), MouseMotion(50, 0), Press("arrow_left"))
        app.cycle()
        assert orbit.yaw == pytest.approx(yaw - 50 * runner.DRAG - runner.STEP)


def test_without_a_display_no_window_is_tried(monkeypatch):
    monkeypatch.setattr(runner.sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert not runner.has_screen()
    assert runner.play(Crates(), None) is None


def test_without_pillow_things_have_plain_colours(monkeypatch):
    monkeypatch.setattr(runner, "is_installed", lambda *_: False)
    assert runner.texture.__wrapped__("crate") is None


@pytest.mark.parametrize(
    "arguments", [["--seconds", "0"], ["--seconds", "-3"], ["--seconds", "nan"], ["--frames", "0"]]
)
def test_nothing_to_do_is_said(arguments, capsys):
    with pytest.raises(SystemExit):
        runner.run(Crates, ["--headless", *arguments])
    assert "nothing to be done" in capsys.readouterr().err


def test_the_examples_are_listed_with_what_they_show(capsys):
    everything.main([])
    out = capsys.readouterr().out
    assert "crates" in out
    assert Crates.__module__.rpartition(".")[2] in everything.names()
    for name in everything.names():
        assert f"  {name} " in out
        assert everything.about(name)


def test_an_example_is_run_by_its_name(capsys):
    everything.main(["crates", "--headless", "--seconds", "0.1"])
    assert "12 steps" in capsys.readouterr().out


def test_an_unknown_example_is_refused_with_a_list(capsys):
    with pytest.raises(SystemExit):
        everything.main(["moonshot"])
    told = capsys.readouterr()
    assert "'moonshot'" in told.err
    assert "crates" in told.out


def test_where_no_window_can_be_opened_the_scene_is_filled_once(monkeypatch, capsys):
    """There may be a DISPLAY that nobody serves; the try to open it has filled a scene."""

    def refuse(*_):
        raise oo.OsgodeError("no window")

    monkeypatch.setattr(runner, "has_screen", lambda: True)
    monkeypatch.setattr(video, "Window", refuse)
    monkeypatch.setattr(runner, "is_installed", lambda *_: False)
    runner.run(Crates, ["--frames", "2"])
    told = capsys.readouterr().out
    with runner.without_window(Crates(), 60.0) as app:
        assert f"of {len(app.scene.world.bodies)} bodies" in told
