"""Six ragdolls are pushed down a flight of stairs, some of them limp, some stiff.

Shows the ragdoll builder: human proportions and masses, joints that bend as far as ours do, and `tone`, which says how
much they resist; thrown balls that push them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

STEPS, RISE, TREAD, WIDTH = 9, 0.22, 0.36, 6.4
"""Of the stairs: how many, and metres."""
TOP = STEPS * RISE
DOLLS = 6
SHIRTS = (
    (0.75, 0.2, 0.16),
    (0.2, 0.45, 0.7),
    (0.85, 0.65, 0.15),
    (0.25, 0.55, 0.25),
    (0.55, 0.25, 0.6),
    (0.9, 0.9, 0.88),
)


class Stairs(Example):
    """A flight of stairs and those who fall down it."""

    SECONDS = 8.0
    MOMENTS = (0.6, 1.3, 2.2, 7.0)
    WORLD: ClassVar = {"iterations": 50, "step_size": 1 / 240, "contact_surface_layer": 0.002}

    def build(self) -> None:
        """Stairs, ragdolls in two rows, and a ball for each."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.15, 1.2), 8.6, yaw=0.55, pitch=0.3, turn=-0.02)
        self.fixed.attach(oo.Plane(material="concrete", appearance=look("concrete", scale=3.0, shine=0.05)))
        for k in range(STEPS):
            height = TOP - k * RISE
            self.block((0.0, height / 2, TREAD * k), (WIDTH, height, TREAD))
        self.block((0.0, TOP / 2, -1.6), (WIDTH, TOP, 3.2 - TREAD))
        self.build_dolls()
        self.loosest = 0.0

    def block(self, at: Sequence[float], size: Sequence[float]) -> None:
        """A step of stone."""
        self.fixed.attach(oo.Placeable(position=at)).attach(
            oo.Box(size, material="concrete", appearance=look("plaster", (0.85, 0.82, 0.78), scale=1.5))
        )

    def build_dolls(self) -> None:
        """They stand at the top, face down the stairs, and are hit in the back."""
        around = oo.Quat.from_axis_angle((0, 1, 0), math.pi)
        self.dolls = []
        for k in range(DOLLS):
            place = oo.Vec3(1.0 * k - 2.5, TOP, -0.35 - 0.25 * (k % 2))
            doll = oo.ragdoll(
                self.moving,
                height=1.62 + 0.06 * k,
                mass=58.0 + 6.0 * k,
                position=place,
                rotation=oo.Quat.from_axis_angle((0, 1, 0), 0.25 * (k - 2.5)) * around,
                tone=(0.03, 0.25)[k % 2],
                looks={"shirt": oo.Appearance((*SHIRTS[k], 1.0), shininess=0.05)},
                name=f"doll {k}",
            )
            self.dolls.append(doll)
            ball = self.moving.attach(oo.Body(name=f"ball {k}", position=place + oo.Vec3(0.05, 1.25, -1.3)))
            ball.attach(oo.Placeable()).attach(
                oo.Sphere(
                    0.16, material="rubber", mass=12.0, appearance=oo.Appearance((0.93, 0.62, 0.2, 1.0), shininess=0.4)
                )
            )
            ball.linear_velocity = (0.0, 1.0, 7.0 + 0.4 * k)

    def before_step(self) -> None:
        """Watch."""
        if self.world.steps % 8 == 0:
            self.loosest = max(self.loosest, *(doll.error for doll in self.dolls))

    def check(self) -> None:
        """All have fallen and stay in one piece."""
        expect(self.loosest < 0.05, "no joint opens by five centimetres")
        bottom = STEPS * TREAD - TREAD / 2
        expect(sum(doll.centre_of_mass.z > bottom / 3 for doll in self.dolls) >= 4, "most fall down the stairs")
        for doll in self.dolls:
            lies = doll.body("head").position.y - doll.body("left foot").position.y
            expect(lies < 1.0, "nobody stands")
            for joint, movements in doll.angles.items():
                for movement, angle in movements.items():
                    low, high = doll.ranges[joint][movement]
                    expect(low - 0.1 < angle < high + 0.1, f"a {joint} is bent no farther than it can be")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Stairs, arguments)


if __name__ == "__main__":
    main()
