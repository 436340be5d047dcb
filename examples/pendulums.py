"""Three pendulums swing over a beam that somebody crosses; one of them sweeps a block of half a ton away.

Shows the game's pendulum: two capsules as one body on a motorised hinge, whose motor turns back at the highest angle
on either side and lets nobody stop it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.game.pendulum import AMPLITUDE, LENGTH, PERIOD, Pendulum
from osgode.examples.game.player import Player
from osgode.examples.runner import Example, Orbit, expect, look, run

BEAM, HIGH, FAR = 0.7, 1.6, 15.0
"""Width, height and length of the beam, metres."""
PLACES = (-4.0, -7.5, -11.0)
"""Where the pendulums hang along z, metres."""
STOPS = (-2.3, -5.75, -9.25)
"""Where the walker waits for its moment."""
BLOCK = 500.0


class Pendulums(Example):
    """Beam, pendulums, a walker, a block."""

    SECONDS = 14.0
    MOMENTS = (3.9, 1.0, 9.0)
    WORLD: ClassVar = {"iterations": 30}

    def build(self) -> None:
        """The beam, the gallows with the pendulums, the walker, the block."""
        self.orbit = Orbit(oo.Vec3(0.0, 2.4, -6.0), 13.5, yaw=0.75, pitch=0.2)
        self.ground("grass", (0.9, 0.95, 0.85))
        stone = look("concrete", (0.85, 0.83, 0.8), scale=1.5)
        self.still(oo.Box((BEAM, HIGH, FAR), appearance=stone), (0.0, HIGH / 2, -FAR / 2 + 1.0))
        wood = look("planks", (0.7, 0.55, 0.42), scale=1.4)
        top = HIGH + LENGTH + 0.95
        self.pendulums = []
        for number, z in enumerate(PLACES):
            for x in (-3.1, 3.1):
                self.still(oo.Box((0.22, top + 0.2, 0.22), material="wood", appearance=wood), (x, top / 2 + 0.1, z))
            self.still(oo.Box((6.6, 0.22, 0.22), material="wood", appearance=wood), (0.0, top + 0.1, z))
            hung = Pendulum((0.0, top, z), phase=0.3 * number, name=f"pendulum {number + 1}")
            self.pendulums.append(self.moving.attach(hung))
        self.walker = self.moving.attach(Player((0.0, HIGH, 0.0), name="walker"))
        block = oo.Box((1.0, 1.0, 1.0), mass=BLOCK, material="concrete", appearance=look("brick", scale=1.0))
        self.block = self.body(block, (0.0, HIGH + 0.5, PLACES[2]), name="block")
        self.rhythm: list[float] = []
        self.turned, self.last, self.passed = 0, 0.0, 0

    def before_step(self) -> None:
        """The walker waits before each pendulum until it has just gone by; the rhythm of the last one is noted."""
        swings = self.pendulums[2]
        if swings.turns != self.turned:
            self.turned = swings.turns
            if self.last:
                self.rhythm.append(self.world.time - self.last)
            self.last = self.world.time
        forward = True
        if self.passed < len(STOPS) and self.walker.feet.z < STOPS[self.passed]:
            pendulum = self.pendulums[self.passed]
            forward = 0.3 * AMPLITUDE < pendulum.angle * pendulum.way < 0.6 * AMPLITUDE
            self.passed += forward
        self.walker.controls.move(forward=forward and self.walker.feet.z > -12.8)

    def check(self) -> None:
        """The walker is over, the block is not on the beam any more, and the rhythm was kept."""
        feet = self.walker.feet
        expect(feet.z < -12.0 and feet.y > HIGH - 0.05, f"the walker is over: {feet}")
        expect(abs(self.block.position.x) > 1.0, f"the block was swept away, to x = {self.block.position.x:.2f}")
        even = max(abs(time - PERIOD / 2) for time in self.rhythm[1:]) if len(self.rhythm) > 1 else math.inf
        expect(even < 0.05 * PERIOD, f"each swing took half a period of {PERIOD} s to within {even:.3f} s")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Pendulums, arguments)


if __name__ == "__main__":
    main()
