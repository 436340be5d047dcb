"""A motor turns a row of wheels: gears, a chain, and bevel gears.

Shows `Transmission` in its three modes. It passes turning on and nothing else, so each wheel has its own hinge. How
fast each wheel turns follows from the radii: where two wheels meet, their rims have the same speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, painted, run

SPEED = -1.5
"""Of the first wheel, rad/s: so the chain turns the positive way about its axis, which ODE needs."""
BIG, SMALL, SPROCKET, DRIVEN, BEVEL = 0.5, 0.25, 0.2, 0.4, 0.3
"""Radii, metres."""
HIGH = 1.0
X, Z = oo.Vec3(1.0, 0.0, 0.0), oo.Vec3(0.0, 0.0, 1.0)


class Gears(Example):
    """Four wheels, the second and third of them double."""

    SECONDS = 5.0
    MOMENTS = (1.4,)
    WORLD: ClassVar = {"iterations": 60}

    def build(self) -> None:
        """From left to right."""
        self.orbit = Orbit(oo.Vec3(0.1, 0.85, 0.1), 3.2, yaw=0.3, pitch=0.22)
        self.ground()
        self.hinges: list[oo.Hinge] = []
        self.first = self.wheel(oo.Vec3(-1.25, HIGH, 0.0), Z, BIG, (0.7, 0.09, 0.07))
        self.second = self.wheel(oo.Vec3(-1.25 + BIG + SMALL, HIGH, 0.0), Z, SMALL, (0.9, 0.6, 0.05))
        self.third = self.wheel(oo.Vec3(0.85, HIGH, 0.14), Z, DRIVEN, (0.08, 0.35, 0.75))
        self.add_rim(self.second, SPROCKET, 0.14, (0.9, 0.6, 0.05))
        self.add_rim(self.third, BEVEL, 0.14, (0.08, 0.35, 0.75))
        corner = self.third.position + Z * 0.14
        self.fourth = self.wheel(corner + oo.Vec3(BEVEL + 0.02, 0.0, BEVEL + 0.02), X, BEVEL, (0.1, 0.45, 0.2))
        self.hinges[0].motor(SPEED, max_force=300.0)

        teeth = oo.Transmission(self.first, self.second, axis1=Z, ratio=BIG / SMALL, name="gears")
        chain = oo.Transmission(
            self.second,
            self.third,
            anchor1=self.second.position + Z * 0.14,
            axis1=Z,
            mode="chain",
            radius1=SPROCKET,
            radius2=DRIVEN,
            name="chain",
        )
        bevel = oo.Transmission(
            self.third, self.fourth, anchor1=corner, axis1=Z, axis2=X, mode="intersecting", name="bevel"
        )
        self.joints = [teeth, chain, bevel]
        self.bevel_radii = bevel.radii
        self.show_joints(0.5)

    def wheel(self, middle: oo.Vec3, axis: oo.Vec3, radius: float, colour: tuple[float, float, float]) -> oo.Body:
        """A wheel on a hinge, with a post."""
        body = self.world.attach(oo.Body(name="wheel", position=middle, rotation=oo.Quat.between(Z, axis)))
        self.add_rim(body, radius, 0.0, colour)
        self.hinges.append(oo.Hinge(body, anchor=middle, axis=axis))
        behind = middle - axis * 0.16
        post = oo.Box((0.1, HIGH + 0.05, 0.1), material="wood", appearance=look("planks", scale=0.6))
        self.still(post, (behind.x, HIGH / 2, behind.z))
        return body

    def add_rim(self, body: oo.Body, radius: float, along: float, colour: tuple[float, float, float]) -> None:
        """A disc with teeth."""
        disc = body.attach(oo.Placeable(position=(0.0, 0.0, along)))
        disc.attach(oo.Cylinder(radius - 0.025, 0.1, mass=20.0 * radius, appearance=painted(*colour)))
        count = round(radius * 50)
        for k in range(count):
            turned = oo.Quat.from_axis_angle(Z, k * math.tau / count)
            at = turned.rotate((radius - 0.005, 0.0, 0.0)) + Z * along
            tooth = body.attach(oo.Placeable(position=at, rotation=turned))
            tooth.attach(oo.Box((0.05, 0.05, 0.1), mass=0.0, appearance=painted(*colour)))

    def rates(self) -> list[float]:
        """How fast each wheel turns about its axis, rad/s."""
        return [hinge.angle_rate for hinge in self.hinges]

    def check(self) -> None:
        """Gears turn opposite ways, a chain the same way; and each pair by its radii."""
        first, second, third, fourth = self.rates()
        expect(abs(first - SPEED) < 0.01, "the motor turns the first wheel")
        expect(abs(second + first * BIG / SMALL) < 0.02, "the small gear turns twice as fast, the other way round")
        expect(abs(third - second * SPROCKET / DRIVEN) < 0.02, "the chain halves that, the same way round")
        one, other = self.bevel_radii
        expect(abs(abs(fourth) - abs(third) * one / other) < 0.02, "the bevel gears turn by their radii")
        expect(max(joint.error for joint in self.joints) < 0.005, "no tooth is skipped")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Gears, arguments)


if __name__ == "__main__":
    main()
