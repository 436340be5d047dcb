"""A footbridge carries a ball of wood, and breaks under one of steel.

Shows `Fixed`, which holds two bodies as they stand to each other; `break_torque`, above which a joint lets go; and the
event that tells of it. The torque is taken about the joint's anchor, so the anchor is where the seam is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

PLANKS, LONG, WIDE, THICK, HIGH = 6, 0.6, 1.2, 0.12, 1.6
MASS, LIGHT, HEAVY = 20.0, 25.0, 400.0
"""Of a plank and of the balls, kg."""
STRENGTH = 1500.0
"""Of a seam, N m."""
RADIUS, SPEED, SECOND = 0.3, 1.8, 1.5
"""Of the balls, metres and m/s; when the second one is sent, seconds."""


class Bridge(Example):
    """Two banks, planks between them, two balls."""

    SECONDS = 5.0
    MOMENTS = (2.72,)
    WORLD: ClassVar = {"iterations": 100}

    def build(self) -> None:
        """Banks, bridge, and the balls on the left bank."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.3, 0.0), 6.4, yaw=0.35, pitch=0.22)
        self.ground("dirt", (0.8, 0.8, 0.8))
        half = PLANKS * LONG / 2
        for side in (-1, 1):
            bank = oo.Box((1.6, HIGH, 2.0), material="concrete", appearance=look("brick", scale=1.6))
            self.still(bank, (side * (half + 0.81), HIGH / 2, 0.0))
        self.broken: list[oo.LetGo] = []
        before: oo.Body | None = None
        for k in range(PLANKS):
            x = -half + (k + 0.5) * LONG
            board = oo.Box((LONG - 0.02, THICK, WIDE), mass=MASS, material="wood", appearance=look("planks", scale=1.0))
            plank = self.body(board, (x, HIGH - THICK / 2, 0.0), name=f"plank {k}")
            self.seam(plank, before, x - LONG / 2)
            before = plank
        self.seam(plank, None, half)
        wood = oo.Sphere(RADIUS, mass=LIGHT, material="wood", appearance=look("planks"))
        steel = oo.Sphere(RADIUS, mass=HEAVY, material="steel", appearance=look("steel", (0.4, 0.4, 0.45), shine=0.7))
        self.light = self.body(wood, (-half - 0.4, HIGH + RADIUS, 0.0), name="light")
        self.heavy = self.body(steel, (-half - 1.1, HIGH + RADIUS, 0.0), name="heavy")
        self.roll(self.light)
        self.whole = False
        self.show_joints(0.6)

    def seam(self, one: oo.Body, other: oo.Body | None, x: float) -> None:
        """Hold a plank to the one before it, or to the bank."""
        joint = oo.Fixed(one, other, anchor=(x, HIGH - THICK / 2, 0.0), break_torque=STRENGTH, name=f"seam at {x:.1f}")
        joint.on_let_go(self.broken.append)

    def roll(self, ball: oo.Body) -> None:
        """Send a ball to the right."""
        ball.linear_velocity = (SPEED, 0.0, 0.0)
        ball.angular_velocity = (0.0, 0.0, -SPEED / RADIUS)

    def before_step(self) -> None:
        """Send the heavy ball when the light one is nearly over."""
        if self.world.steps == round(SECOND / self.world.step_size):
            self.whole = self.light.position.x > 0.4 and not self.broken
            self.roll(self.heavy)

    def check(self) -> None:
        """The light ball is over; under the heavy one seams broke, of more than they can bear, and it fell through."""
        expect(self.whole and self.light.position.x > PLANKS * LONG / 2, "the bridge bears the light ball")
        expect(bool(self.broken), "it breaks under the heavy one")
        expect(all(event.reason == "broke" and event.joint.broken for event in self.broken), "which is told")
        expect(all(event.torque > STRENGTH for event in self.broken), "of the torque that was too much")
        expect(self.heavy.position.y < HIGH - 0.5, "the heavy ball falls through")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Bridge, arguments)


if __name__ == "__main__":
    main()
