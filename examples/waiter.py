"""A tray of glasses is carried round in a circle by nothing but two motors.

Shows `LinearMotor`, which governs how fast a body moves along axes of the world, and `AngularMotor` in the mode
"euler", which measures three angles: here the first is free to be driven round, and stops hold the other two at 0, so
that the tray turns but stays level.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import osgode as oo
from osgode.examples.runner import ALONG_Y, Example, Orbit, expect, look, painted, run

HIGH, RADIUS, THICK = 1.2, 0.7, 0.06
CIRCLE, LAP = 1.0, 6.0
"""Radius in metres, and seconds for once round."""
TURN = 0.8
"""How fast the tray turns, rad/s."""


class Waiter(Example):
    """Tray and glasses."""

    SECONDS = 6.0
    MOMENTS = (4.9,)

    def build(self) -> None:
        """Ground, tray, motors, glasses."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.05, 0.0), 3.9, yaw=0.2, pitch=0.3)
        self.ground("planks", (0.8, 0.8, 0.8))
        plate = oo.Cylinder(RADIUS, THICK, mass=6.0, material="wood", appearance=look("planks", scale=0.7))
        self.tray = self.moving.attach(oo.Body(name="tray", position=(CIRCLE, HIGH, 0.0)))
        self.tray.attach(oo.Placeable(rotation=ALONG_Y)).attach(plate)
        colours = ((0.8, 0.1, 0.08), (0.9, 0.6, 0.05), (0.08, 0.35, 0.75), (0.1, 0.5, 0.2), (0.85, 0.85, 0.85))
        self.glasses = []
        for k, colour in enumerate(colours):
            way = oo.Quat.from_axis_angle((0, 1, 0), k * math.tau / 5).rotate((0.42, 0.0, 0.0))
            glass = oo.Cylinder(0.1, 0.3, mass=0.3, material="wood", appearance=painted(*colour, shine=0.9))
            at = self.tray.position + way + oo.Vec3(0.0, THICK / 2 + 0.151, 0.0)
            self.glasses.append(self.body(glass, at, ALONG_Y, name="glass"))
        self.carried = oo.LinearMotor(
            self.tray, motor_max_force1=500.0, motor_max_force2=500.0, motor_max_force3=500.0, name="carrier"
        )
        # The first axis is the tray's own y, the third the world's x: angle1 turns it, angle2 and 3 would tilt it.
        self.upright = oo.AngularMotor(
            self.tray, mode="euler", axes=((0, 1, 0), (1, 0, 0)), stops2=(0.0, 0.0), stops3=(0.0, 0.0), name="upright"
        )
        self.upright.motor(TURN, max_force=100.0, axis=1)
        self.tilt = 0.0
        self.show_joints(0.6)

    def before_step(self) -> None:
        """Round the circle: the velocity along x and z; that along y is to stay 0, whatever the tray bears."""
        angle = math.tau * self.world.time / LAP
        speed = math.tau * CIRCLE / LAP * min(self.world.time, 1.0)
        self.carried.motor_velocity1 = -speed * math.sin(angle)
        self.carried.motor_velocity3 = -speed * math.cos(angle)
        self.tilt = max(self.tilt, math.acos(min(self.tray.vector_to_world((0, 1, 0)).y, 1.0)))

    def check(self) -> None:
        """It went round, level and turning, and no glass has moved on it."""
        expect(self.world.time > 5.0, "it is carried round")
        expect(self.tilt < 0.01, "the tray stays level")
        expect(abs(self.tray.position.y - HIGH) < 0.01, "and at its height")
        expect(abs(self.upright.angle_rate1 - TURN) < 0.01, "it turns as fast as the motor was told")
        for glass in self.glasses:
            way = glass.position - self.tray.position
            expect(abs(math.hypot(way.x, way.z) - 0.42) < 0.03, "no glass slides")
            expect(abs(way.y - THICK / 2 - 0.15) < 0.01, "no glass falls")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Waiter, arguments)


if __name__ == "__main__":
    main()
