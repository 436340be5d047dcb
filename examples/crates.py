"""Crates fall onto the ground, and a steel ball knocks down a stack that has stood still.

Shows a World with a moving and a static space, bodies with one part each, materials, a texture, a touch listener,
and a velocity given to a body while the simulation runs.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

EDGE = 0.8
SHOT = 3.0
"""When the ball is sent on its way, seconds."""


class Crates(Example):
    """A pyramid of crates, some more that fall beside it, and the ball."""

    SECONDS = 8.0
    MOMENTS = (0.6, 3.5, 4.1, 7.0)

    def build(self) -> None:
        """Ground, crates, ball."""
        self.orbit = Orbit(oo.Vec3(0.2, 1.4, 0.0), 10.5, yaw=0.5, pitch=0.28, turn=-0.05)
        self.fixed.attach(
            oo.Plane((0, 1, 0), material="concrete", appearance=look("concrete", (0.8, 0.8, 0.8), scale=4.0, shine=0.0))
        )
        self.stack: list[oo.Body] = []
        for row in range(5):
            count = 5 - row
            for k in range(count):
                x = (k - (count - 1) / 2) * (EDGE + 0.02)
                self.stack.append(self.crate((x, EDGE / 2 + row * EDGE, -1.0)))
        chance = random.Random(5)  # noqa: S311  (the same crates every time)
        self.falling = []
        for k in range(10):
            crate = self.crate((chance.uniform(-3.5, 3.5), 3.0 + 1.3 * k, chance.uniform(1.0, 2.4)))
            crate.rotation = oo.Quat.from_yaw_pitch_roll(*(chance.uniform(-1, 1) for _ in range(3)))
            self.falling.append(crate)
        self.ball = self.moving.attach(oo.Body(name="ball", position=(-6.5, 0.45, -0.6)))
        self.ball.attach(oo.Placeable()).attach(
            oo.Sphere(0.45, mass=400, material="steel", appearance=look("steel", shine=0.8))
        )
        self.hits: list[oo.Touch] = []
        self.ball.on_touch(self.hear)
        self.stood = [crate.position for crate in self.stack]
        self.swayed = math.inf

    def crate(self, position: tuple[float, float, float]) -> oo.Body:
        """A wooden crate, mostly air: 90 kg/m3."""
        body = self.moving.attach(oo.Body(name="crate", position=position))
        body.attach(oo.Placeable()).attach(
            oo.Box((EDGE, EDGE, EDGE), material="wood", density=90, appearance=look("crate"))
        )
        return body

    def hear(self, touch: oo.Touch) -> None:
        """Note what the ball hits hard."""
        if touch.begin and touch.other_body is not None and touch.impulse > 50:
            self.hits.append(touch)

    def before_step(self) -> None:
        """Send the ball when its time has come."""
        if self.world.steps == round(SHOT / self.world.step_size):
            self.swayed = max(
                crate.position.distance(start) for crate, start in zip(self.stack, self.stood, strict=True)
            )
            self.ball.linear_velocity = (14, 3.5, -1.0)

    def check(self) -> None:
        """The stack stood, the ball hit it, and in the end all crates rest on the ground or on each other."""
        expect(self.swayed < 0.02, "the stack stands still before it is hit")
        expect(bool(self.hits), "the ball hits crates, and is told so")
        expect(self.stack[-1].position.y < 3.5 * EDGE, "the top of the stack falls")
        for crate in self.stack + self.falling:
            expect(EDGE / 2 - 0.02 < crate.position.y < 5 * EDGE, "no crate sinks into the ground or flies away")
            expect(math.hypot(crate.position.x, crate.position.z) < 30, "no crate is thrown far")
        resting = [crate for crate in self.stack + self.falling if crate.linear_velocity.length < 0.05]
        expect(len(resting) >= 0.9 * len(self.stack + self.falling), "the crates come to rest")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Crates, arguments)


if __name__ == "__main__":
    main()
