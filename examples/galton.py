"""Balls fall through rows of pins into boxes: most of them into those in the middle.

Shows `Plane2D`, which keeps a body in the plane z = 0, free to move in it and to turn about z: physics in two
dimensions among things that have three. Axes are drawn for every sixth ball.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, painted, run

ROWS, APART, BALLS, RADIUS, PIN = 7, 0.3, 60, 0.05, 0.08
EVERY = 12
"""Steps between two balls."""
TOP, FLOOR = 3.0, 0.12
COLOURS = ((0.8, 0.1, 0.08), (0.9, 0.6, 0.05), (0.08, 0.35, 0.75))


class Galton(Example):
    """A board with pins and boxes, and the balls."""

    SECONDS = 9.0
    MOMENTS = (5.2,)
    WORLD: ClassVar = {"linear_damping": 0.008}

    def build(self) -> None:
        """Board, pins, boxes, and balls outside of the World until their turn comes."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.55, 0.0), 4.4, yaw=0.25, pitch=0.06)
        self.ground("concrete")
        back = oo.Box((2.9, 3.2, 0.06), appearance=look("plaster", (0.95, 0.9, 0.8), scale=1.5))
        back.enabled = False
        self.still(back, (0.0, 1.6, -0.12))
        for row in range(ROWS):
            across = ROWS + row % 2
            for k in range(across):
                pin = oo.Cylinder(PIN, 0.16, material="steel", appearance=look("steel", shine=0.7))
                self.still(pin, ((k - (across - 1) / 2) * APART, TOP - 0.45 - row * APART * 0.85, 0.0))
        for k in range(ROWS + 2):
            high = 2.6 if k in (0, ROWS + 1) else 0.75
            wall = oo.Box((0.03, high, 0.16), material="wood", appearance=look("planks", scale=0.5))
            self.still(wall, ((k - (ROWS + 1) / 2) * APART, FLOOR + high / 2, 0.0))
        self.still(oo.Box((2.9, FLOOR, 0.3), material="wood", appearance=look("planks", scale=0.8)), (0, FLOOR / 2, 0))
        chance = random.Random(3)  # noqa: S311  (the same balls every time)
        self.balls = []
        for k in range(BALLS):
            ball = oo.Body(name=f"ball {k}", position=(chance.uniform(-0.02, 0.02), TOP - 0.15, 0.0))
            shape = oo.Sphere(RADIUS, mass=0.05, appearance=painted(*COLOURS[k % 3]))
            shape.surface = oo.Surface(friction=0.0, bounce=0.1, bounce_velocity=0.1)
            ball.attach(oo.Placeable()).attach(shape)
            ball.angular_velocity = (chance.uniform(-3, 3), 0.0, 0.0)  # out of the plane: the joint stops it
            self.balls.append(ball)
        self.planes = [oo.Plane2D(ball) for ball in self.balls]
        self.world.attach(oo.joint_marks(self.planes[::6], size=0.2))

    def before_step(self) -> None:
        """The next ball."""
        k, rest = divmod(self.world.steps, EVERY)
        if rest == 0 and k < BALLS:
            self.moving.attach(self.balls[k])

    def counts(self) -> list[int]:
        """How many balls are in each box."""
        result = [0] * (ROWS + 1)
        for ball in self.balls:
            result[int(ball.position.x / APART + (ROWS + 1) / 2)] += 1
        return result

    def check(self) -> None:
        """All are down, none has left the plane, and the middle has most of them."""
        expect(max(ball.position.y for ball in self.balls) < 1.0, "all balls come down")
        expect(max(joint.error for joint in self.planes) < 1e-4, "no ball leaves the plane")
        counts = self.counts()
        expect(sum(counts[2:6]) > 2 * (sum(counts[:2]) + sum(counts[6:])), f"the middle boxes get most: {counts}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Galton, arguments)


if __name__ == "__main__":
    main()
