"""The demo game with 200 loose crates and two cars: how fast it goes, and where a step's time is spent.

Then what controllers call in each step, one call at a time.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import cast

import osgode as oo
from benchmarks.timing import Spread, row
from osgode.examples.game.scene import Game, config
from osgode.nodes.exports import StepTimings
from osgode.testing import Play

LOOSE = 200
"""Crates, those of the game included."""
AIM_SPEED, AIM_SHARE = 4.0, 0.80
"""Times real time; of the physics in a step, ODE itself."""
FIELD = (-16.0, 14.0)
"""x and z of the first of the additional stacks, metres: on the grass behind the player."""
TURN = 120
"""Steps of one measurement: a second."""
CALLS = 2000
"""Of one measurement of a single call."""


class CrowdedGame(Game):
    """The game, and so many more stacks that there are `LOOSE` crates."""

    def populate_world(self) -> None:
        """All of the game, then the stacks; the red car is driven round the track behind the blue one."""
        super().populate_world()
        for k in range((LOOSE - len(self.crates)) // 10):
            self._stack(FIELD[0] - 4.0 * (k % 5), FIELD[1] + 3.0 * (k // 5))

    spent = StepTimings()
    """Where the time of its steps went."""

    def advance(self, steps: int) -> None:
        """Note where the time of each step went."""
        for _ in range(steps):
            super().advance(1)
            self.spent += self.world.timings

    def keep_awake(self) -> None:
        """Let no crate fall asleep."""
        for crate in self.crates:
            crate.auto_disable = False
            crate.wake()

    def throw(self) -> None:
        """Throw every crate up, as an explosion does: each lands about a second later."""
        for number, crate in enumerate(self.crates):
            crate.linear_velocity = (0.5 * (number % 7 - 3), 5.0, 0.5 * (number % 5 - 2))
            crate.angular_velocity = (number % 3 - 1.0, 0.0, number % 4 - 1.5)


def shares(play: Play, count: int) -> dict[str, float] | None:
    """Part of the samples that `perf` took in libode, in osgode's C core and elsewhere; None without `perf`."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "perf.data"
        command = ["perf", "record", "-q", "-e", "cpu-clock", "-F", "1999", "-o", str(data), "-p", str(os.getpid())]
        try:
            perf = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        except FileNotFoundError:
            return None
        time.sleep(0.5)
        play.seconds(count * play.scene.world.step_size)
        perf.terminate()
        perf.wait()
        command = ["perf", "report", "-i", str(data), "--stdio", "-q", "--sort", "dso"]
        report = subprocess.run(command, check=False, capture_output=True, text=True)
    found = {"ode": 0.0, "core": 0.0, "rest": 0.0}
    for line in report.stdout.splitlines():
        words = line.split()
        if len(words) >= 2 and words[0].endswith("%"):
            part = "ode" if "libode" in words[1] else "core" if words[1].startswith("_core") else "rest"
            found[part] += float(words[0][:-1]) / 100
    return found if report.returncode == 0 and sum(found.values()) > 0.9 else None


def run(turn_count: int) -> None:
    """Print how fast the game is at rest, in an uproar and with nothing asleep, and what single calls take."""
    print(
        f"The game: player, walker, two cars, {LOOSE} crates; steps of 1/120 s, two a frame; processor's time of a step"
    )
    with Play(CrowdedGame, config()) as play:
        game = cast(CrowdedGame, play.scene)
        play.seconds(3)
        play.seconds(3)
        _situation(play, "crates at rest", turn_count)
        _situation(play, "all crates thrown, falling, and piled", turn_count, game.throw)
        game.keep_awake()
        _situation(play, "every crate kept awake", turn_count)
    single_calls()


def _situation(play: Play, name: str, turn_count: int, prepare: Callable[[], object] | None = None) -> None:
    times, game = [], cast(CrowdedGame, play.scene)
    game.spent = StepTimings()
    for _ in range(max(2, turn_count // 12)):
        if prepare is not None:
            prepare()
        used = time.thread_time()
        play.seconds(TURN * game.world.step_size)
        times.append((time.thread_time() - used) / TURN)
    total = game.spent
    step = Spread.of(times)
    world = game.world
    speed = world.step_size / step.median
    awake = sum(body.enabled for body in world.bodies)
    text = f"{speed:.1f} times real time; {step.median * 1e3:.2f} ms ({step.low * 1e3:.2f} to {step.high * 1e3:.2f})"
    row(name, f"{text}; {awake} of {len(world.bodies)} bodies awake", f"{AIM_SPEED:g}", good=speed >= AIM_SPEED)
    physics = total.collide + total.respond + total.solve + total.report
    parts = f"C {physics / total.total:.0%} (colliding {total.collide / total.total:.0%}, solving"
    row("", f"of World.step: {parts} {total.solve / total.total:.0%}), Python {total.listeners / total.total:.0%}")
    if prepare is not None:
        prepare()
    samples = shares(play, 3 * TURN)
    if samples is not None:
        share = samples["ode"] / (samples["ode"] + samples["core"])
        text = (
            f"ODE {samples['ode']:.0%}, osgode's core {samples['core']:.0%}, Python and the rest {samples['rest']:.0%}"
        )
        row("", f"by perf: {text}; ODE of the physics {share:.0%}", f"{AIM_SHARE:.0%}", good=share >= AIM_SHARE)


def single_calls() -> None:
    """Print what each of the calls takes that controllers make."""
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(oo.Plane())
    body = space.attach(oo.Body(position=(0, 3, 0), auto_disable=False))
    body.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=1))
    hinge = oo.Hinge(body, axis=(0, 0, 1))
    served = oo.Hinge(body, axis=(0, 0, 1), servo=oo.Servo())
    space.attach(oo.Body(position=(3, 3, 0))).attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=1))
    numbers = iter(range(10**9))
    servo = served.servo
    assert servo is not None

    def drive() -> None:
        hinge.motor(1.0 + 1e-6 * next(numbers), 5.0)

    def drive_servo() -> None:
        servo.target = 1e-9 * next(numbers)

    calls: dict[str, Callable[[], object]] = {
        "hinge.motor(), another speed": drive,
        "hinge.motor(), the same": lambda: hinge.motor(1.0, 5.0),
        "servo.target = another": drive_servo,
        "hinge.angle": lambda: hinge.angle,
        "body.position": lambda: body.position,
        "body.rotation": lambda: body.rotation,
        "body.vector_to_world()": lambda: body.vector_to_world((0.0, 0.0, -1.0)),
        "body.velocity_at()": lambda: body.velocity_at((0.0, 3.0, 1.0)),
        "body.add_force()": lambda: body.add_force((1.0, 0.0, 0.0)),
        "world.cast_ray()": lambda: world.cast_ray((-5.0, 3.0, 0.0), (1.0, 0.0, 0.0), 10.0, exclude=(body,)),
        "the same of two kinds": lambda: world.cast_ray((-5, 3, 0), (1, 0, 0), 10, kinds=("default", "vehicle")),
    }
    print("Single calls: processor's time, median and quartiles")
    for name, call in calls.items():
        row(name, f"{_each(call).text()} us")
    plain = world.step
    before = _each(plain, 200)
    for k in range(20):
        body.schedule(lambda _: True, priority=k)
    after = _each(plain, 200)
    row("a call scheduled again in each step", f"{(after.median - before.median) / 20:.3f} us")


def _each(call: Callable[[], object], count: int = CALLS) -> Spread:
    """Microseconds of one call."""
    times = []
    for _ in range(15):
        begin = time.thread_time()
        for _ in range(count):
            call()
        times.append((time.thread_time() - begin) / count * 1e6)
    return Spread.of(times)
