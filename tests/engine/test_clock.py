"""Time of frames and of the simulation, with a time that is moved by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.engine import Accumulator, AppConfig, Clock, ClockConfig, HandTime, RealTime, Scene, SceneConfig
from osgode.errors import FieldError
from osgode.testing import Play
from tests.engine.games import Tumble, state

STEP = 1 / 120
FRAMES = st.lists(st.floats(0.0, 0.2), min_size=1, max_size=60)


class Stopwatch:
    """A time that each wait overshoots, as sleep does."""

    def __init__(self, late=0.0):
        self.time, self.late, self.waits = 100.0, late, []

    def now(self):
        return self.time

    def wait(self, seconds):
        self.waits.append(seconds)
        self.time += seconds + self.late


def started(timer, **settings):
    clock = Clock(ClockConfig(**settings), timer)
    clock.start()
    return clock


def test_the_frame_limit_waits_for_the_rest_of_a_frame():
    """What a frame has taken already is not waited for; one that took too long isn't made up for."""
    timer = Stopwatch()
    clock = started(timer, frame_limit=50.0)
    for busy, waited, delta in ((0.005, 0.015, 0.02), (0.0, 0.02, 0.02), (0.03, None, 0.03), (0.01, 0.01, 0.02)):
        timer.time += busy
        timer.waits.clear()
        clock.cycle()
        assert timer.waits == ([] if waited is None else [pytest.approx(waited)])
        assert clock.delta == pytest.approx(delta)
    assert clock.elapsed == pytest.approx(0.09)
    assert clock.frames == 4


def test_without_a_limit_nothing_is_waited_for():
    timer = Stopwatch()
    clock = started(timer, frame_limit=None)
    timer.time += 0.25
    clock.cycle()
    assert timer.waits == []
    assert clock.delta == pytest.approx(0.25)
    clock.frame_limit = 2.0
    clock.cycle()
    assert timer.waits == [pytest.approx(0.5)]


def test_a_time_that_goes_back():
    """A frame never takes less than no time."""
    timer = Stopwatch()
    clock = started(timer, frame_limit=None)
    timer.time -= 3.0
    clock.cycle()
    assert clock.delta == 0.0
    timer.time += 0.5
    clock.cycle()
    assert clock.delta == pytest.approx(0.5)


@given(FRAMES, st.lists(st.sampled_from([0.0, 0.1, 1.0, 10.0]), min_size=1, max_size=5))
def test_simulation_time_is_frames_times_speed(frames, speeds):
    """Elapsed is the sum of all frames, simulated that of each by the speed it had."""
    timer = Stopwatch()
    clock = started(timer, frame_limit=None)
    simulated = []
    for number, seconds in enumerate(frames):
        clock.speed = speeds[number % len(speeds)]
        timer.time += seconds
        clock.cycle()
        assert clock.simulation_delta == clock.delta * clock.speed
        simulated.append(clock.simulation_delta)
    assert clock.elapsed == pytest.approx(sum(frames), abs=1e-9)
    assert clock.simulated == pytest.approx(math.fsum(simulated), abs=1e-9)


def test_pause_stops_the_simulation_and_not_the_frames():
    timer = Stopwatch()
    clock = started(timer, frame_limit=None, paused=True)
    timer.time += 1.0
    clock.cycle()
    assert (clock.delta, clock.simulation_delta, clock.simulated, clock.elapsed) == (1.0, 0.0, 0.0, 1.0)
    clock.paused = False
    timer.time += 1.0
    clock.cycle()
    assert (clock.simulation_delta, clock.simulated, clock.elapsed) == (1.0, 1.0, 2.0)


def test_single_steps_are_counted_and_pause():
    clock = Clock()
    assert not clock.paused
    clock.single_step()
    clock.single_step()
    assert clock.paused
    assert clock.take_single_steps() == 2
    assert clock.take_single_steps() == 0


def test_the_frame_rate_is_an_average_of_half_a_second():
    """After a change of pace, half a second later only the new one counts; before the first frame it is 0."""
    timer = Stopwatch()
    clock = started(timer, frame_limit=None)
    assert clock.frame_rate == 0.0
    for _ in range(100):
        timer.time += 0.01
        clock.cycle()
    assert clock.frame_rate == pytest.approx(100.0)
    for _ in range(11):
        timer.time += 0.05
        clock.cycle()
    assert clock.frame_rate == pytest.approx(20.0)
    timer.time += 5.0
    clock.cycle()
    assert clock.frame_rate == pytest.approx(0.2)


def test_frames_of_no_length_are_not_kept_for_ever():
    clock = started(HandTime(), frame_limit=None)
    for _ in range(3000):
        clock.cycle()
    assert clock.frame_rate == 0.0
    assert len(clock._recent) <= 1000


def test_real_time_passes():
    """The time on the wall goes on while one waits."""
    timer = RealTime()
    before = timer.now()
    timer.wait(0.002)
    assert timer.now() - before >= 0.002


def test_hand_time_moves_only_when_told():
    timer = HandTime()
    assert timer.now() == timer.now() == 0.0
    timer.wait(1.5)
    timer.advance(0.25)
    assert timer.now() == 1.75
    for wrong in (-1.0, math.nan, "1"):
        with pytest.raises(FieldError, match="seconds"):
            timer.advance(wrong)
    assert timer.now() == 1.75


@pytest.mark.parametrize(
    ("setting", "wrong"),
    [
        ("frame_limit", 0.0),
        ("frame_limit", -60),
        ("frame_limit", math.nan),
        ("frame_limit", "60"),
        ("speed", -1.0),
        ("speed", math.inf),
        ("speed", 1001.0),
        ("speed", None),
        ("paused", "no"),
    ],
)
def test_bad_clock_settings(setting, wrong):
    """Refused in the config, and by the clock, with the name of what is wrong."""
    with pytest.raises(FieldError, match=f"ClockConfig.{setting}"):
        ClockConfig(**{setting: wrong})
    if setting != "paused":
        clock = Clock()
        before = getattr(clock, setting)
        with pytest.raises(FieldError, match=f"Clock.{setting}"):
            setattr(clock, setting, wrong)
        assert getattr(clock, setting) == before


# -- the accumulator


@given(FRAMES, st.sampled_from([1 / 60, STEP, 1 / 1000, 0.013]), st.integers(1, 20))
def test_no_time_is_made_or_lost_unseen(frames, step, most):
    """Steps, the rest and the reported loss add up to what came in; the rest is less than a step."""
    accumulator = Accumulator(most)
    done = 0
    for number, seconds in enumerate(frames):
        steps = accumulator.take(seconds, step)
        assert 0 <= steps <= most
        assert 0.0 <= accumulator.rest < step
        assert 0.0 <= accumulator.interpolation(step) <= 1.0
        done += steps
        total = done * step + accumulator.rest + accumulator.lost
        assert total == pytest.approx(math.fsum(frames[: number + 1]), abs=1e-6 * step * (number + 2))


@given(FRAMES)
def test_the_number_of_steps_follows_from_the_time(frames):
    """Without a cap it is the whole number of steps in all that has passed, however the frames fall."""
    accumulator = Accumulator(10**6)
    done = sum(accumulator.take(seconds, STEP) for seconds in frames)
    assert done == pytest.approx(math.fsum(frames) / STEP, abs=1.0 + 1e-6 * (len(frames) + 1))
    assert done <= math.fsum(frames) / STEP + 1e-6 * (len(frames) + 1)


@pytest.mark.parametrize(("rate", "step", "each"), [(60, STEP, 2), (120, STEP, 1), (30, 1 / 60, 2), (50, 0.01, 2)])
def test_even_frames_take_even_steps(rate, step, each):
    """Where a frame is a whole number of steps, rounding doesn't make it one less and then one more."""
    accumulator, timer = Accumulator(100), HandTime()
    clock = started(timer, frame_limit=float(rate))
    counts = set()
    for _ in range(5000):
        clock.cycle()
        counts.add(accumulator.take(clock.simulation_delta, step))
    assert counts == {each}


def test_a_stall_is_capped_and_reported():
    """Five seconds at once are as many steps as allowed; the rest is lost, and told."""
    accumulator = Accumulator(12)
    assert accumulator.take(5.0, STEP) == 12
    assert accumulator.lost == pytest.approx(5.0 - 12 * STEP)
    assert accumulator.rest == pytest.approx(0.0, abs=1e-12)
    assert accumulator.take(STEP, STEP) == 1
    assert accumulator.lost == pytest.approx(5.0 - 12 * STEP)


def test_interpolation_is_the_rest():
    accumulator = Accumulator(10)
    assert accumulator.interpolation(STEP) == 0.0
    accumulator.take(2.25 * STEP, STEP)
    assert accumulator.interpolation(STEP) == pytest.approx(0.25)
    assert accumulator.interpolation(STEP / 8) == 1.0, "after the step size has become smaller"


# -- both, in a scene


def played(frames, steps, **clock):
    """A tumbling scene after so many steps, with frames that take what is given, again and again."""
    config = AppConfig(clock=ClockConfig(frame_limit=None, **clock), scene=SceneConfig(max_steps=10**6))
    with Play(Tumble, config) as play:
        play.app.clock.frame_limit = None
        number = 0
        while play.scene.world.steps < steps:
            before = play.scene.world.steps
            seconds = frames[number % len(frames)]
            play.app.clock.timer.advance(min(seconds, (steps - before) * STEP / play.app.clock.speed))
            play.app.cycle()
            number += 1
        assert play.scene.world.steps == steps
        return state(play.scene)


@pytest.fixture(scope="module")
def tumbled():
    """The tumbling scene after 240 steps that were done by hand."""
    scene = Tumble()
    scene.populate_world()
    scene.world.step(240)
    return state(scene)


@pytest.mark.parametrize("frames", [[1 / 60], [0.001, 0.031, 0.0, 0.017, 0.009], [5.0], [0.4, 1 / 240, 0.003]])
@pytest.mark.parametrize("speed", [0.1, 1.0, 10.0])
def test_the_same_bits_however_the_frames_fall(tumbled, frames, speed):
    """Jittery frames, stalls, slow and fast motion: the same steps give the same bits."""
    assert played(frames, 240, speed=speed) == tumbled


def test_speed_changes_pause_and_single_steps_change_no_bit(tumbled):
    """On the way the clock is paused, stepped singly, slowed down and sped up."""
    with Play(Tumble) as play:
        clock, world = play.app.clock, play.scene.world
        play.frames(10)
        clock.paused = True
        play.frames(5)
        assert world.steps == 20
        for wanted in (1, 3):
            before = world.steps
            for _ in range(wanted):
                clock.single_step()
            play.frames(1)
            assert world.steps == before + wanted
            assert play.scene.interpolation == 1.0
        play.frames(3)
        assert world.steps == 24
        assert play.scene.interpolation == 1.0, "the picture stays at the step that was wished for"
        clock.paused = False
        clock.speed = 0.1
        play.frames(30)
        assert world.steps == pytest.approx(24 + 30 * 2 * 0.1, abs=1)
        clock.speed = 0.0
        before = world.steps
        play.frames(10)
        assert world.steps == before
        clock.speed = 2.5
        play.frames(20)
        assert world.steps == pytest.approx(before + 100, abs=1)
        clock.speed = 1.0
        play.steps(240 - world.steps)
        assert state(play.scene) == tumbled


def test_a_stall_does_not_spiral():
    """Five seconds in one frame: the steps of that frame are capped, and the loss is told; then all is as before."""
    with Play(Tumble, AppConfig(scene=SceneConfig(max_steps=12))) as play:
        play.frames(3)
        assert play.scene.world.steps == 6
        assert play.scene.lost == 0.0
        play.app.clock.timer.advance(5.0)
        play.frames(1)
        assert play.scene.world.steps == 18
        assert play.scene.lost == pytest.approx(5.0 - 12 * STEP, abs=1e-6)
        assert play.app.clock.elapsed == pytest.approx(3 / 60 + 5.0)
        play.frames(3)
        assert play.scene.world.steps == 24
        assert play.scene.lost == pytest.approx(5.0 - 12 * STEP, abs=1e-6)


def test_ten_times_is_too_fast_for_twelve_steps():
    """Fast motion beyond what a frame may do runs at the cap, and says what it left out."""
    with Play(Tumble, AppConfig(clock=ClockConfig(speed=10.0), scene=SceneConfig(max_steps=12))) as play:
        play.frames(30)
        assert play.scene.world.steps == 30 * 12
        assert play.scene.lost == pytest.approx(30 * (10 / 60 - 12 * STEP), abs=1e-6)


def test_another_step_size_on_the_way():
    """The rest is kept in seconds, so a new step size begins with it."""
    with Play(Scene, AppConfig(clock=ClockConfig(speed=0.7))) as play:
        play.frames(7)
        scene = play.scene
        simulated = play.app.clock.simulated
        assert scene.world.time + scene.accumulator.rest == pytest.approx(simulated)
        scene.world.step_size = 1 / 500
        play.frames(7)
        assert scene.world.time + scene.accumulator.rest == pytest.approx(2 * simulated)
        assert scene.accumulator.rest < 1 / 500


def test_a_single_step_is_shown_as_it_is():
    """The picture is that of the step itself, and what was left of a frame before is not added later."""
    with Play(Tumble, AppConfig(clock=ClockConfig(speed=0.7))) as play:
        scene, clock = play.scene, play.app.clock
        play.frames(3)
        assert scene.accumulator.rest > 0.1 * STEP
        assert scene.interpolation == pytest.approx(scene.accumulator.rest / STEP)
        clock.single_step()
        play.frames(1)
        assert (scene.accumulator.rest, scene.interpolation) == (0.0, 1.0)
        clock.paused = False
        play.frames(1)
        assert scene.accumulator.rest == pytest.approx(0.7 / 60 - STEP)
