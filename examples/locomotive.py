"""Three axles of a locomotive are coupled by rods, and only the one in the middle is driven.

Shows `DoubleHinge`: two points kept at a distance, with a hinge at each end, about the same axis. A single rod could
let an axle turn back where rod and crank are in line; those on the other side are a quarter of a turn ahead and don't
let it. The rods have no mass and no shape; what is seen of them are the lines of the marks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ALONG_X, Example, Orbit, expect, look, painted, run

RADIUS, CRANK, APART, TRACK = 0.5, 0.3, 1.15, 0.55
"""Of a wheel, from its middle to the pin, between axles, half the distance of the wheels of an axle, metres."""
SPEED = 4.0
"""rad/s"""
Z = (0, 0, 1)


class Locomotive(Example):
    """Jacked up, so that the wheels turn on the spot."""

    SECONDS = 5.0
    MOMENTS = (1.1,)
    WORLD: ClassVar = {"iterations": 60}

    def build(self) -> None:
        """Frame, axles, rods."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.0, 0.3), 4.0, yaw=0.35, pitch=0.16)
        self.ground("dirt", (0.8, 0.8, 0.8))
        self.still(oo.Box((3.6, 0.35, 0.8), material="steel", appearance=painted(0.13, 0.2, 0.16)), (0.0, 1.15, 0.0))
        boiler = oo.Cylinder(0.45, 3.2, material="steel", appearance=painted(0.1, 0.3, 0.2))
        self.still(boiler, (0.1, 1.7, 0.0), ALONG_X)
        for x in (-1.7, 1.7):
            self.still(oo.Box((0.15, 1.0, 0.7), material="wood", appearance=look("planks", scale=0.8)), (x, 0.5, 0.0))
        self.axles = [self.axle((k - 1) * APART) for k in range(3)]
        hinges = [oo.Hinge(axle, anchor=axle.position, axis=Z) for axle in self.axles]
        hinges[1].motor(SPEED, max_force=500.0)
        self.rods = [
            oo.DoubleHinge(one, other, anchor1=self.pin(one, side), anchor2=self.pin(other, side), axis=Z)
            for one, other in ((self.axles[1], self.axles[0]), (self.axles[1], self.axles[2]))
            for side in (-1, 1)
        ]
        self.off = 0.0
        self.world.attach(oo.joint_marks(self.rods, size=0.55))

    def axle(self, x: float) -> oo.Body:
        """Two wheels with cranks, a quarter of a turn apart."""
        body = self.world.attach(oo.Body(name="axle", position=(x, 0.75, 0.0)))
        body.attach(oo.Placeable()).attach(oo.Cylinder(0.07, 2 * TRACK, mass=20.0, material="steel"))
        for side in (-1, 1):
            wheel = body.attach(oo.Placeable(position=(0.0, 0.0, side * TRACK)))
            wheel.attach(oo.Cylinder(RADIUS, 0.1, mass=40.0, appearance=painted(0.65, 0.08, 0.06)))
            wheel.attach(oo.Cylinder(RADIUS - 0.07, 0.11, mass=0.0, appearance=painted(0.15, 0.15, 0.16)))
            for k in range(4):
                turned = oo.Quat.from_axis_angle(Z, k * math.pi / 4)
                spoke = body.attach(oo.Placeable(position=(0.0, 0.0, side * TRACK), rotation=turned))
                spoke.attach(oo.Box((2 * RADIUS - 0.08, 0.05, 0.13), mass=0.0, appearance=painted(0.65, 0.08, 0.06)))
            pin = body.attach(oo.Placeable(position=body.world_to_local(self.pin(body, side))))
            pin.attach(oo.Cylinder(0.06, 0.14, mass=2.0, material="steel", appearance=look("steel", shine=0.8)))
        return body

    def pin(self, axle: oo.Body, side: int) -> oo.Vec3:
        """Where a rod is hinged: on the left to the right of the middle, on the right above it."""
        out = oo.Vec3(CRANK, 0.0, 0.0) if side < 0 else oo.Vec3(0.0, CRANK, 0.0)
        return axle.position + out + oo.Vec3(0.0, 0.0, side * (TRACK + 0.1))

    def before_step(self) -> None:
        """Watch how far the other axles are behind the driven one."""
        ways = [axle.vector_to_world((1, 0, 0)) for axle in self.axles]
        self.off = max(self.off, *(math.acos(min(ways[1].dot(way), 1.0)) for way in (ways[0], ways[2])))

    def check(self) -> None:
        """All axles have turned as one, through all dead points."""
        for axle in self.axles:
            expect(abs(axle.angular_velocity.z - SPEED) < 0.02, "all axles turn as fast as the driven one")
        expect(self.off < 0.01, "none falls behind, nor turns back")
        expect(max(rod.error for rod in self.rods) < 0.002, "the rods keep their lengths")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Locomotive, arguments)


if __name__ == "__main__":
    main()
