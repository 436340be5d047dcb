"""Five equal weights on five springs: each sinks by its weight divided by the stiffness.

Shows ``stiffness`` and ``damping`` in N/m and N s/m, which are the same wherever something gives way: in a joint
(`Ball`), in a rod (`DoubleBall`), at a stop (`Slider`), in a suspension (`Hinge2`), and where two things touch
(`Surface`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, painted, run

MASS, STIFFNESS, DAMPING = 10.0, 400.0, 25.0
"""kg, N/m, N s/m"""
START, APART, RADIUS = 1.2, 0.75, 0.2
"""How high the weights start, how far they are from each other, and their radius, metres."""
COLOURS = ((0.75, 0.1, 0.08), (0.9, 0.6, 0.05), (0.1, 0.45, 0.2), (0.08, 0.35, 0.75), (0.45, 0.15, 0.5))


class Springs(Example):
    """Weights, and what holds each."""

    SECONDS = 5.0
    MOMENTS = (4.0,)
    WORLD: ClassVar = {"iterations": 60}

    def build(self) -> None:
        """One weight after the other; the white mark behind each is where it starts."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.2, 0.0), 4.0, yaw=0.12, pitch=0.1)
        self.ground("planks", (0.8, 0.8, 0.8))
        self.still(oo.Box((4.4, 2.4, 0.1), material="wood", appearance=look("plaster", scale=2.0)), (0.0, 1.2, -0.45))
        for side in (0.0, -MASS * 9.81 / STIFFNESS):
            line = oo.Box((4.0, 0.012, 0.01), appearance=painted(0.1, 0.1, 0.1))
            self.still(line, (0.0, START + side, -0.395))
        self.weights = [self.weight(k) for k in range(5)]
        first, second, third, fourth, fifth = self.weights
        oo.Ball(first, stiffness=STIFFNESS, damping=DAMPING, name="ball")
        top = second.position + oo.Vec3(0.0, 0.9, 0.0)
        oo.DoubleBall(second, anchor2=top, stiffness=STIFFNESS, damping=DAMPING, name="rod")
        oo.Slider(
            third,
            axis=(0, 1, 0),
            stops=(0.0, 1.0),
            stop_stiffness=STIFFNESS,
            stop_damping=DAMPING,
            name="stop",
        )
        hub = self.world.attach(oo.Body(name="hub", position=fourth.position, kinematic=True))
        oo.Hinge2(
            fourth,
            hub,
            stops1=(0.0, 0.0),
            suspension_stiffness=STIFFNESS,
            suspension_damping=DAMPING,
            name="suspension",
        )
        self.cushion(fifth)
        self.lowest = [weight.position.y for weight in self.weights]
        self.show_joints(0.4)

    def weight(self, k: int) -> oo.Body:
        """A ball of steel."""
        shape = oo.Sphere(RADIUS, mass=MASS, material="steel", appearance=painted(*COLOURS[k]))
        return self.body(shape, ((k - 2) * APART, START, 0.0), name=f"weight {k}")

    def cushion(self, weight: oo.Body) -> None:
        """A block whose surface gives way where it is touched."""
        high = START - RADIUS
        soft = oo.Box((0.5, high, 0.5), appearance=painted(0.75, 0.7, 0.6, shine=0.0))
        soft.surface = oo.Surface(friction=0.5, stiffness=STIFFNESS, damping=DAMPING)
        self.still(soft, (weight.position.x, high / 2, 0.0))

    def before_step(self) -> None:
        """Watch how far they swing."""
        self.lowest = [min(low, w.position.y) for low, w in zip(self.lowest, self.weights, strict=True)]

    def check(self) -> None:
        """All hang at the same height in the end, and swung below it before."""
        sunk = MASS * 9.81 / STIFFNESS
        for weight, low in zip(self.weights, self.lowest, strict=True):
            off = START - weight.position.y - sunk
            expect(abs(off) < 0.01 * sunk, f"{weight.describe()} sinks by m g / k = {sunk:.4f} m, off by {off:.4f}")
            expect(low < START - 1.2 * sunk, "it swings first")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Springs, arguments)


if __name__ == "__main__":
    main()
