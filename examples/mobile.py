"""A mobile of three beams hangs by ball joints and turns in a draught.

Shows `Ball`: a point of one body held to a point of another, about which they turn freely. Each beam hangs by the point
at which what it carries is in balance (arm times weight is the same on both sides), so it stays level.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ALONG_X, ALONG_Y, Example, Orbit, expect, look, painted, run

BEAM, UNIT, DROP = 0.6, 0.8, 0.55
"""Mass of a beam and of the lightest ball, kg; length of the wires, metres."""
HOOK = oo.Vec3(-0.15, 3.5, 0.0)
LONGEST = 1.25
"""Half the length of the first beam; each is two thirds of the one above."""
COLOURS = ((0.8, 0.1, 0.08), (0.9, 0.6, 0.05), (0.08, 0.35, 0.75), (0.1, 0.5, 0.2))


class Mobile(Example):
    """A hook, three beams, four balls."""

    SECONDS = 6.0
    MOMENTS = (1.9,)
    WORLD: ClassVar = {"iterations": 60, "angular_damping": 0.001}

    def build(self) -> None:
        """From the hook downwards; on the left of each beam a ball, on the right all the rest."""
        self.orbit = Orbit(oo.Vec3(0.3, 2.45, 0.0), 3.9, yaw=0.25, pitch=0.14)
        self.ground("planks", (0.8, 0.8, 0.8))
        self.still(oo.Box((0.2, 0.3, 0.2), material="wood"), HOOK + oo.Vec3(0.0, 0.15, 0.0))
        self.beams: list[oo.Body] = []
        self.balls: list[oo.Body] = []
        above, point = None, HOOK
        for k, colour in enumerate(COLOURS[:3]):
            half, left = LONGEST * (2 / 3) ** k, UNIT * (4 - k)
            right = sum(UNIT * (4 - j) + BEAM for j in range(k + 1, 3)) + UNIT
            off = half * (right - left) / (right + left + BEAM)
            middle = point - oo.Vec3(off, DROP * 0.7, 0.0)
            rod = oo.Capsule(0.03, 2 * half, mass=BEAM, material="steel", appearance=look("steel", shine=0.7))
            beam = self.body(rod, middle, ALONG_X, name="beam", collides=False)
            self.wire(beam, point, DROP * 0.7)
            oo.Ball(beam, above, anchor=point)
            self.hang(beam, middle - oo.Vec3(half, 0.0, 0.0), left, colour)
            self.beams.append(beam)
            above, point = beam, middle + oo.Vec3(half, 0.0, 0.0)
        self.hang(self.beams[-1], point, UNIT, COLOURS[3])
        self.show_joints(0.6)

    def hang(self, beam: oo.Body, point: oo.Vec3, mass: float, colour: tuple[float, float, float]) -> None:
        """A ball below a point of a beam."""
        ball = oo.Sphere(0.13 * mass ** (1 / 3), mass=mass, appearance=painted(*colour))
        self.balls.append(self.body(ball, point - oo.Vec3(0.0, DROP, 0.0), name="ball", collides=False))
        self.wire(self.balls[-1], point, DROP)
        oo.Ball(self.balls[-1], beam, anchor=point)

    def wire(self, body: oo.Body, top: oo.Vec3, length: float) -> None:
        """A wire that is part of a body."""
        down = oo.Pose(top - oo.Vec3(0.0, length / 2, 0.0), ALONG_Y)
        inside = body.pose.inverse() * down
        place = body.attach(oo.Placeable(position=inside.position, rotation=inside.rotation))
        place.attach(oo.Cylinder(0.012, length, mass=0.0, material="steel"))

    def before_step(self) -> None:
        """The draught turns the beams for a while."""
        if self.world.time < 2.0:
            for beam, strength in zip(self.beams, (-0.5, 0.25, 0.2), strict=True):
                beam.add_torque((0.0, strength, 0.0))

    def check(self) -> None:
        """The beams have turned, are nearly level, and all hangs together."""
        along = [beam.vector_to_world((0, 0, 1)) for beam in self.beams]
        expect(max(abs(way.z) for way in along) > 0.3, "the draught turns the beams")
        expect(max(abs(math.asin(way.y)) for way in along) < 0.1, "what is in balance stays nearly level")
        expect(max(joint.error for joint in self.world.joints) < 1e-3, "no joint opens by a millimetre")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Mobile, arguments)


if __name__ == "__main__":
    main()
