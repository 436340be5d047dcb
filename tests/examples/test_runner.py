"""What the examples share."""

import math

import pytest

import osgode as oo
from osgode.examples import runner
from osgode.examples.crates import Crates
from osgode.examples.runner import Orbit, Pacemaker
from osgode.render import RecordingDrawer

STEP = 1 / 120


def test_steps_follow_the_clock_without_drifting():
    """After many frames of uneven length there are as many steps as fit into the time, give or take one."""
    pace = Pacemaker(STEP)
    frames = [0.003 + 0.0007 * (k * 37 % 50) for k in range(1000)]
    steps = [pace.take(seconds) for seconds in frames]
    assert abs(sum(steps) - sum(frames) / STEP) <= 1
    assert pace.lost == 0


@pytest.mark.parametrize("fps", [24, 30, 60, 120])
def test_at_an_even_rate_each_frame_has_the_same_steps(fps):
    pace = Pacemaker(STEP)
    assert {pace.take(1 / fps) for _ in range(1000)} == {120 // fps}


def test_the_rest_says_how_far_the_picture_is_between_two_steps():
    pace = Pacemaker(STEP)
    assert pace.take(1.25 * STEP) == 1
    assert pace.interpolation == pytest.approx(0.25)
    assert pace.take(0.25 * STEP) == 0
    assert pace.interpolation == pytest.approx(0.5)


def test_a_machine_that_is_too_slow_does_not_fall_behind_for_ever():
    """A frame that took two seconds asks for as many steps as the longest allowed one; the loss is counted."""
    pace = Pacemaker(STEP, longest=0.1)
    assert pace.take(2.0) == 12
    assert pace.lost == pytest.approx(1.9)
    assert pace.take(STEP) == 1


@pytest.mark.parametrize(("yaw", "pitch", "seconds"), [(0, 0, 0), (1.2, 0.4, 0), (-2.0, 1.2, 3.0)])
def test_the_camera_looks_at_its_target_from_its_distance(yaw, pitch, seconds):
    orbit = Orbit(oo.Vec3(1, 2, 3), 5.0, yaw, pitch, turn=0.3)
    eye = orbit.view(seconds).pose
    assert tuple(eye.inverse().transform(orbit.target)) == pytest.approx((0, 0, -5), abs=1e-12)
    assert eye.rotation.rotate((1, 0, 0)).y == pytest.approx(0, abs=1e-12)  # its horizon is level
    assert eye.position.y == pytest.approx(2 + 5 * math.sin(pitch))


def test_dragging_turns_the_camera_and_stops_its_own_turning():
    orbit = Orbit(oo.Vec3(0, 0, 0), 5.0, turn=0.3)
    orbit.drag(0.5, 9.0)
    assert (orbit.yaw, orbit.turn) == (-0.5, 0)
    assert orbit.pitch < math.pi / 2


class FakeWindow(RecordingDrawer):
    """As the real one, but it only records; closed after some frames."""

    def __init__(self, lasts):
        super().__init__()
        self.lasts, self.closed, self.size = lasts, False, (64, 36)

    def pump(self):
        self.closed = self.drawn >= self.lasts

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.closed = True


@pytest.mark.parametrize(("frames", "lasts", "drawn"), [(4, 100, 4), (None, 3, 4)])
def test_a_window_is_drawn_until_it_is_closed_or_the_frames_are_up(frames, lasts, drawn, monkeypatch):
    monkeypatch.setattr(runner, "steer", lambda window, camera: None)
    window, example = FakeWindow(lasts), Crates()
    (told,) = runner.play(example, window, frames)
    assert window.drawn == drawn
    assert window.closed
    assert "steps per second" in told


def test_without_a_display_no_window_is_tried(monkeypatch):
    monkeypatch.setattr(runner.sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert not runner.has_screen()
    assert runner.open_window(Crates()) is None


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
