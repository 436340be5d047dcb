"""A flywheel drives a piston on its one side, and on the other an arm that goes fast one way and slowly the other.

Shows `Piston`, which slides along an axis and may turn about it, in a crank drive; and `PR`, which slides along one
axis and turns about another: the pin of the wheel in the slot of the arm (a quick-return drive, as in a shaper).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ALONG_Y, Example, Orbit, expect, look, painted, run

AXLE = oo.Vec3(0.0, 1.3, 0.0)
CRANK, ROD, PIVOT = 0.3, 0.9, 0.75
"""From the axle to the pins, length of the connecting rod, how far the arm's pivot is below the axle, metres."""
SPEED = 4.0
"""rad/s"""
Z = (0, 0, 1)


class Engine(Example):
    """Flywheel, rod and piston before it, slotted arm behind it."""

    SECONDS = 4.0
    MOMENTS = (1.25,)
    WORLD: ClassVar = {"iterations": 100}

    def build(self) -> None:
        """Both pins are above the axle at the start."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.45, 0.0), 3.5, yaw=0.45, pitch=0.12)
        self.ground()
        disc = oo.Cylinder(0.45, 0.1, mass=60.0, appearance=painted(0.7, 0.09, 0.07))
        self.wheel = self.body(disc, AXLE, name="wheel", collides=False)
        top = AXLE + oo.Vec3(0.0, CRANK, 0.0)
        for z in (-0.12, 0.12):
            pin = self.wheel.attach(oo.Placeable(position=(0.0, CRANK, z)))
            pin.attach(oo.Cylinder(0.04, 0.24, mass=0.0, material="steel"))
        oo.Hinge(self.wheel, anchor=AXLE, axis=Z, name="axle").motor(SPEED, max_force=2000.0)

        front, back = oo.Vec3(0.0, 0.0, 0.2), oo.Vec3(0.0, 0.0, -0.2)
        rod = self.bar(top + oo.Vec3(0.0, ROD / 2, 0.0) + front, ROD, "rod", (0.9, 0.6, 0.05))
        wrist = top + oo.Vec3(0.0, ROD, 0.0) + front
        head = oo.Cylinder(0.17, 0.3, mass=4.0, appearance=look("steel", shine=0.7))
        self.piston = self.body(head, wrist, ALONG_Y, name="piston", collides=False)
        oo.Hinge(rod, self.wheel, anchor=top + front, axis=Z, name="crank pin")
        oo.Ball(rod, self.piston, anchor=wrist, name="wrist")
        self.cylinder = oo.Piston(self.piston, axis=(0, 1, 0), name="cylinder")
        self.cylinder.motor(2.0, max_force=5.0, axis=2)  # it may be turned as well, so that it wears evenly
        for side in (-1, 1):
            wall = oo.Box((0.05, 1.0, 0.36), material="steel", appearance=painted(0.25, 0.3, 0.35))
            self.still(wall, (side * 0.22, wrist.y - CRANK, front.z))

        foot = AXLE - oo.Vec3(0.0, PIVOT, 0.0) + back
        arm = self.bar(foot + oo.Vec3(0.0, 0.75, 0.0), 1.5, "arm", (0.08, 0.35, 0.75))
        self.pivot = oo.Hinge(arm, anchor=foot, axis=Z, name="pivot")
        self.slot = oo.PR(arm, self.wheel, anchor=top + back, axis1=(0, 1, 0), axis2=Z, name="slot")
        self.still(oo.Box((0.4, foot.y, 0.2), material="concrete"), (0.0, foot.y / 2, back.z - 0.15))
        self.off_piston = self.off_arm = 0.0
        self.show_joints(0.45)

    def bar(self, middle: oo.Vec3, length: float, name: str, colour: tuple[float, float, float]) -> oo.Body:
        """A flat bar that stands upright."""
        shape = oo.Box((0.1, length + 0.1, 0.05), mass=3.0, appearance=painted(*colour))
        return self.body(shape, middle, name=name, collides=False)

    def before_step(self) -> None:
        """Compare piston and arm with where the geometry of the drive has them."""
        up = self.wheel.vector_to_world((0, 1, 0))
        angle = math.atan2(-up.x, up.y)
        height = CRANK * math.cos(angle) + math.sqrt(ROD**2 - (CRANK * math.sin(angle)) ** 2)
        self.off_piston = max(self.off_piston, abs(self.cylinder.position - (height - CRANK - ROD)))
        lean = math.atan2(CRANK * math.sin(angle), PIVOT + CRANK * math.cos(angle))
        self.off_arm = max(self.off_arm, abs(self.pivot.angle - lean))

    def check(self) -> None:
        """Both follow their formulas, and the piston turns."""
        expect(self.world.time > 3.0, "it runs")
        expect(self.off_piston < 0.003, "the piston is at r cos a + sqrt(l^2 - (r sin a)^2)")
        expect(self.off_arm < 0.005, "the arm leans by atan(r sin a / (d + r cos a))")
        expect(abs(self.cylinder.angle_rate - 2.0) < 0.02, "the piston turns as its own motor wants")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Engine, arguments)


if __name__ == "__main__":
    main()
