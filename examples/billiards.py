"""A billiard break: the cue ball scatters fifteen balls over a table with cushions.

Shows materials of one's own and how pairs of them meet (balls that bounce off each other, cushions, cloth), rolling
friction that brings the balls to rest, and sweeps of balls that are too fast for their size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, painted, run

RADIUS, MASS = 0.028575, 0.17
"""Of a ball of pool, metres and kg."""
LENGTH, WIDTH, RAIL = 2.54, 1.27, 0.09
"""Of the field between the cushions, and how wide those are, metres."""
TOP = 0.8
"""How high the cloth is, metres."""
SPEED = 9.0
"""Of the cue ball, m/s: 7.5 cm in a step, more than its size."""
HEAD, FOOT = -LENGTH / 4, LENGTH / 4
"""Where the cue ball starts, and where the first ball of the rack stands, along x."""
COLOURS = (
    (0.95, 0.75, 0.1),
    (0.1, 0.2, 0.7),
    (0.8, 0.12, 0.1),
    (0.4, 0.15, 0.55),
    (0.95, 0.42, 0.08),
    (0.08, 0.45, 0.2),
    (0.5, 0.1, 0.12),
    (0.06, 0.06, 0.07),
)


class Billiards(Example):
    """A table, fifteen balls in a rack, and the cue ball on its way."""

    SECONDS = 9.0
    MOMENTS = (0.75, 0.2, 8.5)
    WORLD: ClassVar = {"iterations": 40}

    def build(self) -> None:
        """Materials, table, balls."""
        self.orbit = Orbit(oo.Vec3(0.05, TOP - 0.2, 0.1), 2.75, yaw=0.4, pitch=0.8)
        oo.define_material("phenolic resin", density=1740)
        oo.define_material("cloth", density=300)
        oo.define_material("cushion", density=1100)
        pairs = self.world.surfaces
        pairs["phenolic resin", "phenolic resin"] = oo.Surface(0.06, bounce=0.93, bounce_velocity=0.02)
        pairs["phenolic resin", "cloth"] = oo.Surface(0.2, rolling_friction=0.01 * RADIUS)
        pairs["phenolic resin", "cushion"] = oo.Surface(0.15, bounce=0.75, bounce_velocity=0.05)
        self.ground("planks", (0.6, 0.5, 0.45))
        self.build_table()
        self.balls = [self.ball(k, place) for k, place in enumerate(self.rack())]
        self.cue = self.ball(-1, oo.Vec3(HEAD, 0, 0.004))
        self.cue.linear_velocity = (SPEED, 0, 0)
        self.cue.angular_velocity = (0, 0, -SPEED / RADIUS)  # it rolls
        self.starts = [ball.position for ball in self.balls]
        self.energy = self.most = self.motion()

    def build_table(self) -> None:
        """Cloth, cushions with wood behind them, legs."""
        green, wood = (
            look("plaster", (0.05, 0.42, 0.3), scale=0.6, shine=0.0),
            look("planks", (0.5, 0.3, 0.2), scale=0.5),
        )
        slab = oo.Box((LENGTH + 2 * RAIL, 0.1, WIDTH + 2 * RAIL), material="cloth", appearance=green)
        self.still(slab, (0, TOP - 0.05, 0))
        edge = oo.Appearance((0.04, 0.33, 0.23, 1.0), shininess=0.0)
        for side in (-1, 1):
            for size, place in (
                ((LENGTH + 2 * RAIL, 0.06, RAIL), (0, TOP + 0.03, side * (WIDTH + RAIL) / 2)),
                ((RAIL, 0.06, WIDTH), (side * (LENGTH + RAIL) / 2, TOP + 0.03, 0)),
            ):
                self.still(oo.Box(size, material="cushion", appearance=edge), place)
            out = RAIL + 0.05
            self.still(
                oo.Box((LENGTH + 2 * out + 0.1, 0.17, 0.1), appearance=wood), (0, TOP - 0.015, side * (WIDTH / 2 + out))
            )
            self.still(
                oo.Box((0.1, 0.17, WIDTH + 2 * RAIL), appearance=wood), (side * (LENGTH / 2 + out), TOP - 0.015, 0)
            )
            for end in (-1, 1):
                self.still(
                    oo.Box((0.16, TOP - 0.1, 0.16), appearance=wood),
                    (end * LENGTH / 2, TOP / 2 - 0.05, side * WIDTH / 2),
                )

    def rack(self) -> list[oo.Vec3]:
        """Five rows that nearly touch."""
        apart = 2.004 * RADIUS
        return [
            oo.Vec3(FOOT + row * apart * math.sqrt(0.75), 0, (k - row / 2) * apart)
            for row in range(5)
            for k in range(row + 1)
        ]

    def ball(self, number: int, place: oo.Vec3) -> oo.Body:
        """A ball on the cloth; the cue ball is white."""
        colour = (0.96, 0.95, 0.9) if number < 0 else COLOURS[number % len(COLOURS)]
        shape = oo.Sphere(RADIUS, material="phenolic resin", mass=MASS, appearance=painted(*colour, shine=0.9))
        name = "cue ball" if number < 0 else f"ball {number + 1}"
        ball = self.body(shape, place + oo.Vec3(0, TOP + RADIUS, 0), name=name)
        ball.tunnelling = "sweep"
        return ball

    def motion(self) -> float:
        """Energy of all balls, joules: m v^2 / 2 + 2/5 m r^2 w^2 / 2, and what height has made of it."""
        whole = 0.0
        for ball in (*self.balls, self.cue):
            v, w = ball.linear_velocity.length, ball.angular_velocity.length
            height = ball.position.y - TOP - RADIUS
            whole += MASS * (v * v / 2 + RADIUS * RADIUS * w * w / 5 + 9.81 * height)
        return whole

    def before_step(self) -> None:
        """Watch the energy."""
        self.energy = self.motion()
        self.most = max(self.most, self.energy)

    def check(self) -> None:
        """The rack is broken, no ball has left the table, energy only went, and all have come to rest."""
        first = MASS * SPEED * SPEED * 0.7
        moved = [(ball.position - at).length > 0.1 for ball, at in zip(self.balls, self.starts, strict=True)]
        expect(sum(moved) >= 12, "the break scatters the balls")
        for ball in (*self.balls, self.cue):
            x, y, z = ball.position
            inside = abs(x) < LENGTH / 2 and abs(z) < WIDTH / 2 and abs(y - TOP - RADIUS) < 0.004
            expect(inside, f"{ball.name} lies on the table")
        expect(self.most < 1.01 * first, "nothing makes energy")
        expect(self.energy < 0.01 * first, "rolling friction takes the energy")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Billiards, arguments)


if __name__ == "__main__":
    main()
