"""A buggy drives over a track of planks and humps, round a bend, and brakes.

Shows suspension wheels: springs in N/m with dampers, steering, driving and braking, a body of several parts with a
look of its own, and a camera that goes along.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

RADIUS, WIDTH = 0.36, 0.26
HUBS = {"front left": (-0.72, -0.05, -1.0), "front right": (0.72, -0.05, -1.0)} | {
    "rear left": (-0.72, -0.05, 1.0),
    "rear right": (0.72, -0.05, 1.0),
}
"""Where the wheels are in the chassis' frame while the springs are relaxed, metres."""
SPRING, DAMPER = 22e3, 1.6e3
"""N/m and N s/m of each wheel."""
SPEED, TORQUE, BRAKE = 7.0, 160.0, 220.0
PAINT = (oo.Appearance((0.88, 0.88, 0.85, 1.0)), oo.Appearance((0.78, 0.16, 0.12, 1.0)))
"""Of the tyres beside the track."""
BEND = (3.6, 6.2)
"""From when to when it is steered to the left, seconds."""
STOP = 7.5
"""When it brakes, seconds."""


class Buggy(Example):
    """A buggy and its track."""

    SECONDS = 9.5
    MOMENTS = (1.9, 2.6, 4.2, 5.4)
    WORLD: ClassVar = {"iterations": 50}

    def build(self) -> None:
        """Ground, track, buggy."""
        self.orbit = Orbit(oo.Vec3(0.0, 0.7, 11.0), 6.0, yaw=2.15, pitch=0.2)
        self.fixed.attach(oo.Plane(material="earth", appearance=look("grass", (0.95, 0.9, 0.75), scale=4.0, shine=0.0)))
        self.world.surfaces["rubber", "earth"] = oo.Surface(friction=0.9)
        self.world.surfaces["rubber", "wood"] = oo.Surface(friction=0.9)
        self.build_track()
        self.build_buggy()
        self.hardest, self.highest, self.leaned = 0.0, 0.0, 0.0

    def build_track(self) -> None:
        """Half-buried logs, each side for itself, then humps right across; old tyres to both sides."""
        bark, board = look("planks", (0.6, 0.5, 0.42), scale=0.8), look("planks", scale=1.0)
        lying = oo.Quat.from_axis_angle((0, 1, 0), math.pi / 2)
        for k in range(7):
            place = oo.Placeable(position=((-0.75, 0.75)[k % 2], -0.05, 4.6 - 1.1 * k), rotation=lying)
            self.fixed.attach(place).attach(oo.Cylinder(0.2, 1.1, material="wood", appearance=bark))
        for k in range(3):
            for tilt in (-1, 1):
                place = oo.Placeable(
                    position=(0.0, 0.11, -5.0 - 2.9 * k - 0.56 * tilt),
                    rotation=oo.Quat.from_axis_angle((1, 0, 0), -0.24 * tilt),
                )
                self.fixed.attach(place).attach(oo.Box((3.0, 0.06, 1.16), material="wood", appearance=board))

        upright = oo.Quat.from_axis_angle((1, 0, 0), math.pi / 2)
        for k in range(9):
            for side in (-2.6, 2.6):
                for level in range(1 + k % 2):
                    place = oo.Placeable(position=(side, 0.12 + 0.25 * level, 8.0 - 2.2 * k), rotation=upright)
                    tyre = oo.Cylinder(0.3, 0.24, material="rubber", appearance=PAINT[(k + level) % 2])
                    self.fixed.attach(place).attach(tyre)

    def build_buggy(self) -> None:
        """A chassis of boxes and bars, an engine behind, and four wheels, all in a space of its own."""
        own = self.moving.attach(oo.SimpleSpace(name="buggy"))
        start = oo.Vec3(0.0, RADIUS + 0.05, 11.0)
        self.chassis = own.attach(oo.Body(name="chassis", position=start))
        orange = oo.Appearance((0.95, 0.48, 0.08, 1.0), shininess=0.6)
        dark = oo.Appearance((0.16, 0.17, 0.19, 1.0), shininess=0.4)
        pipe = look("steel", (0.55, 0.56, 0.6), shine=0.7)
        for size, at, mass, paint in (
            ((0.95, 0.16, 2.5), (0.0, 0.05, 0.0), 180.0, dark),
            ((0.9, 0.26, 0.8), (0.0, 0.22, -0.85), 60.0, orange),
            ((0.14, 0.24, 1.0), (-0.42, 0.24, 0.1), 15.0, orange),
            ((0.14, 0.24, 1.0), (0.42, 0.24, 0.1), 15.0, orange),
            ((0.7, 0.34, 0.55), (0.0, 0.28, 0.95), 110.0, pipe),
        ):
            self.chassis.attach(oo.Placeable(position=at)).attach(oo.Box(size, mass=mass, appearance=paint))
        corners = [(x, y, z) for x in (-0.42, 0.42) for y, z in ((0.3, -0.45), (1.1, -0.05), (1.1, 0.55), (0.3, 0.85))]
        bars = [(corners[i], corners[i + 1]) for i in (0, 1, 2, 4, 5, 6)]
        bars += [(corners[i], corners[i + 4]) for i in (1, 2)]
        for first, last in bars:
            low, high = oo.Vec3(*first), oo.Vec3(*last)
            turned = oo.Quat.between((0, 0, 1), high - low)
            self.chassis.attach(oo.Placeable(position=(low + high) / 2, rotation=turned)).attach(
                oo.Capsule(0.035, low.distance(high), mass=3.0, appearance=pipe)
            )
        self.wheels = {
            name: oo.suspension_wheel(
                self.chassis, hub, radius=RADIUS, width=WIDTH, mass=18.0, stiffness=SPRING, damping=DAMPER,
                max_steering=0.5 if "front" in name else 0.0, name=name,
            )
            for name, hub in HUBS.items()
        }  # fmt: skip

    def before_step(self) -> None:
        """Drive, steer, brake; the camera goes along."""
        time = self.world.time
        for name, wheel in self.wheels.items():
            if time < STOP:
                wheel.drive(SPEED, TORQUE)
            else:
                wheel.brake(BRAKE)
            if "front" in name:
                wheel.steering = 0.22 if BEND[0] < time < BEND[1] else 0.0
        self.hardest = max(self.hardest, *(wheel.compression for wheel in self.wheels.values()))
        self.highest = max(self.highest, self.chassis.linear_velocity.length)
        self.leaned = max(self.leaned, math.acos(min(self.chassis.vector_to_world((0, 1, 0)).y, 1.0)))
        target = self.chassis.position + oo.Vec3(0.0, 0.35, 0.0)
        self.orbit.target += (target - self.orbit.target) * 0.08

    def check(self) -> None:
        """It has got through, round the bend, and stands."""
        ahead = self.chassis.vector_to_world((0, 0, -1))
        expect(self.chassis.position.z < -12.0, "it gets over logs and humps")
        expect(0.4 < math.atan2(-ahead.x, -ahead.z) < 2.5, "it goes round to the left")
        expect(self.highest > 0.8 * SPEED, "it reaches its speed")
        expect(0.06 < self.hardest < 0.3, "the springs are pressed together by the humps, and not through")
        expect(self.leaned < 0.6, "it stays on its wheels")
        expect(self.chassis.linear_velocity.length < 0.1, "it stands in the end")
        expect(max(wheel.error for wheel in self.wheels.values()) < 0.01, "the wheels stay where they belong")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Buggy, arguments)


if __name__ == "__main__":
    main()
