"""A drive shaft turns a mill whose bearing goes up and down.

Shows `Universal`, which passes turning on round a bend, though not evenly: between cos b and 1 / cos b times, twice a
turn; and `PU`, a universal joint that also slides, for a shaft whose length must change. With its crosses in one plane
the second joint undoes what the first does to the speed, and the mill turns as evenly as the motor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ALONG_X, Example, Orbit, expect, look, painted, run

LEFT, RIGHT = oo.Vec3(-0.75, 1.5, 0.0), oo.Vec3(0.75, 0.95, 0.0)
"""The middles of the two joints."""
SPEED = 5.0
"""Of the motor, rad/s."""
RISE, AT = 0.5, 3.0
"""How far the bearing rises, metres, and when, seconds."""


class Cardan(Example):
    """Motor, shaft, mill."""

    SECONDS = 6.0
    MOMENTS = (1.2,)
    WORLD: ClassVar = {"iterations": 100}

    def build(self) -> None:
        """From left to right."""
        self.orbit = Orbit(oo.Vec3(0.05, 1.1, 0.0), 3.5, yaw=0.3, pitch=0.22)
        self.ground()
        bend = RIGHT - LEFT
        along = bend.normalized()
        self.bend = math.acos(along.x)
        self.motor = self.shaft(LEFT - oo.Vec3(0.45, 0.0, 0.0), ALONG_X, 0.75, (0.75, 0.1, 0.08))
        self.middle = self.shaft(LEFT + bend / 2, oo.Quat.between((0, 0, 1), along), 1.3, (0.9, 0.6, 0.05))
        self.mill = self.shaft(RIGHT + oo.Vec3(0.45, 0.0, 0.0), ALONG_X, 0.75, (0.08, 0.35, 0.75))
        wheel = self.mill.attach(oo.Placeable(position=(0.0, 0.0, 0.3)))
        wheel.attach(oo.Cylinder(0.4, 0.08, mass=5.0, appearance=look("planks", scale=0.4)))

        house = oo.Box((0.5, 0.5, 0.5), material="steel", appearance=painted(0.25, 0.3, 0.35))
        self.still(house, LEFT - oo.Vec3(0.95, 0.0, 0.0))
        self.still(oo.Box((0.3, 1.3, 0.3), material="steel"), LEFT - oo.Vec3(0.95, 0.85, 0.0))
        bearing = oo.Box((0.12, 0.3, 0.3), mass=20.0, appearance=painted(0.25, 0.3, 0.35))
        self.bearing = self.body(bearing, RIGHT + oo.Vec3(0.4, 0.0, 0.0), name="bearing", collides=False)

        drive = oo.Hinge(self.motor, anchor=LEFT, axis=(1, 0, 0), name="motor")
        drive.motor(SPEED, max_force=500.0)
        oo.Universal(self.motor, self.middle, anchor=LEFT, axis1=(0, 1, 0), axis2=(0, 0, 1), name="universal")
        self.slides = oo.PU(
            self.middle, self.mill, anchor=RIGHT, axis1=(0, 0, 1), axis2=(0, 1, 0), axis3=along, name="sliding"
        )
        oo.Hinge(self.mill, self.bearing, anchor=self.bearing.position, axis=(1, 0, 0), name="mill")
        self.lift = oo.Slider(self.bearing, axis=(0, 1, 0), name="lift")
        self.lift.servo = oo.Servo(max_speed=0.5, max_force=5000.0)
        self.ratios: list[float] = []
        self.uneven = 0.0
        self.show_joints(0.5)

    def shaft(self, middle: oo.Vec3, rotation: oo.Quat, length: float, colour: tuple[float, float, float]) -> oo.Body:
        """A round shaft with a key along it, so that one sees it turn."""
        body = self.body(oo.Cylinder(0.06, length, mass=8.0), middle, rotation, name="shaft", collides=False)
        key = body.attach(oo.Placeable(position=(0.06, 0.0, 0.0)))
        key.attach(oo.Box((0.06, 0.04, length * 0.85), mass=0.0, appearance=painted(*colour)))
        return body

    def before_step(self) -> None:
        """Compare the speeds; then let the bearing rise."""
        if 0.5 < self.world.time < AT:
            along = self.middle.vector_to_world((0, 0, 1))
            first = self.motor.angular_velocity.x
            self.ratios.append(self.middle.angular_velocity.dot(along) / first)
            self.uneven = max(self.uneven, abs(self.mill.angular_velocity.x / first - 1.0))
        if self.world.steps == round(AT * 120) and self.lift.servo is not None:
            self.lift.servo.target = RISE

    def check(self) -> None:
        """The bend's cosine bounds the speed in the middle, and the mill turns evenly; the shaft became shorter."""
        expect(len(self.ratios) > 200, "it runs")
        bound = math.cos(self.bend)
        expect(abs(min(self.ratios) - bound) < 0.005, "the middle turns at least cos b times as fast")
        expect(abs(max(self.ratios) - 1.0 / bound) < 0.005, "and at most 1 / cos b times")
        expect(self.uneven < 0.005, "the second joint undoes it: the mill turns as the motor does")
        risen = RIGHT + oo.Vec3(0.0, RISE, 0.0)
        shorter = RIGHT.distance(LEFT) - risen.distance(LEFT)
        expect(abs(abs(self.slides.position) - shorter) < 0.01, "the shaft slides by what the way has become shorter")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Cardan, arguments)


if __name__ == "__main__":
    main()
