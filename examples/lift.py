"""A lift takes crates up, a turntable turns them round, a trolley draws a plumb along, and a ram pushes.

Shows kinematic bodies that glide to where they are told, in a given time: they carry what stands on them by friction,
push what is in their way, and pull along what hangs on them by a joint. Also shows the centre of mass of a body of two
parts, marked in black and yellow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

EDGE = 0.5
UP = 2.4
"""How high the lift goes, metres."""
DECK = 0.2
"""How thick platforms are."""
LIFTED = (-2.6, UP + DECK / 2, -1.2)
"""Where the lift ends."""
ROUND = 2.6
"""How far the turntable turns, radians."""
START, MOVE = 0.5, 3.0
"""When everything begins to move, and how long it takes, seconds."""
HIGH, BACK, ROPE = 3.6, -3.6, 1.7
"""Where the trolley runs, and how long the rod of its plumb is, metres."""
STRAIGHT = oo.Quat(1.0, 0.0, 0.0, 0.0)
YELLOW, GREY = (0.95, 0.75, 0.2), (0.5, 0.5, 0.55)


class Lift(Example):
    """Four machines side by side."""

    SECONDS = 8.0
    MOMENTS = (0.5, 1.8, 3.4, 7.5)
    WORLD: ClassVar = {"iterations": 60}

    def build(self) -> None:
        """Ground, and the machines with what they move."""
        self.orbit = Orbit(oo.Vec3(0.15, 1.45, -1.0), 8.6, yaw=0.3, pitch=0.3, turn=-0.02)
        self.fixed.attach(
            oo.Plane(material="concrete", appearance=look("concrete", (0.85, 0.82, 0.78), scale=4.0, shine=0.0))
        )
        self.build_lift()
        self.build_turntable()
        self.build_trolley()
        self.build_ram()
        self.away = self.loosest = 0.0
        self.stood = [self.table.world_to_local(crate.position) for crate in self.turned]

    def machine(self, name: str, position: oo.Vec3, geom: oo.Geom, turn: oo.Quat = STRAIGHT) -> oo.Body:
        """A kinematic body of one part, which is turned in it."""
        body = self.moving.attach(oo.Body(name=name, position=position, kinematic=True))
        body.attach(oo.Placeable(rotation=turn)).attach(geom)
        return body

    def crate(self, x: float, y: float, z: float, turn: float = 0.0) -> oo.Body:
        """A wooden crate that stands on height ``y``."""
        body = self.moving.attach(oo.Body(name="crate", position=(x, y + EDGE / 2, z)))
        body.rotation = oo.Quat.from_yaw_pitch_roll(turn)
        body.attach(oo.Placeable()).attach(oo.Box((EDGE,) * 3, material="wood", density=120, appearance=look("crate")))
        return body

    def build_lift(self) -> None:
        """A platform between two posts, with three crates on it."""
        deck = oo.Box((1.8, DECK, 1.8), material="steel", appearance=look("steel", YELLOW, scale=0.9))
        self.lift = self.machine("lift", oo.Vec3(-2.6, DECK / 2, -1.2), deck)
        for x in (-3.6, -1.6):
            post = self.fixed.attach(oo.Placeable(position=(x, 1.9, -1.2)))
            post.attach(oo.Box((0.12, 3.8, 0.3), material="steel", appearance=look("steel", GREY, scale=0.9)))
        self.lifted = [self.crate(-2.9, DECK, -1.2), self.crate(-2.3, DECK, -1.0, 0.3)]
        self.lifted.append(self.crate(-2.65, DECK + EDGE, -1.15, 0.15))

    def build_turntable(self) -> None:
        """A disc with crates on it, one of them at its edge."""
        upright = oo.Quat.from_axis_angle((1, 0, 0), math.pi / 2)
        disc = oo.Cylinder(1.4, DECK, material="wood", appearance=look("planks", scale=1.0))
        self.table = self.machine("turntable", oo.Vec3(1.3, DECK / 2 + 0.01, -1.7), disc, upright)
        self.turned = [self.crate(1.3 + math.cos(a), DECK + 0.01, -1.7 + math.sin(a), -a) for a in (0.3, 2.4, 4.5)]

    def build_trolley(self) -> None:
        """A trolley high on two rails, with a plumb hanging from it: a rod and a weight as one body."""
        for z in (-0.35, 0.35):
            rail = self.fixed.attach(oo.Placeable(position=(0.5, HIGH - 0.2, BACK + z)))
            rail.attach(oo.Box((8.4, 0.08, 0.08), material="steel", appearance=look("steel", GREY, scale=0.9)))
        for x in (-3.6, 4.6):
            post = self.fixed.attach(oo.Placeable(position=(x, HIGH / 2 - 0.12, BACK)))
            post.attach(oo.Box((0.12, HIGH - 0.24, 0.8), material="steel", appearance=look("steel", GREY, scale=0.9)))
        box = oo.Box((0.7, 0.3, 0.9), material="steel", appearance=look("paint", (0.9, 0.25, 0.2)))
        self.trolley = self.machine("trolley", oo.Vec3(-2.2, HIGH, BACK), box)
        self.plumb = self.moving.attach(oo.Body(name="plumb", position=(-2.2, HIGH, BACK)))
        upright = oo.Quat.from_axis_angle((1, 0, 0), math.pi / 2)
        rod = self.plumb.attach(oo.Placeable(position=(0.0, -ROPE / 2, 0.0), rotation=upright))
        rod.attach(oo.Capsule(0.04, ROPE, mass=14, material="steel", appearance=look("steel", GREY)))
        weight = self.plumb.attach(oo.Placeable(position=(0.0, -ROPE, 0.0)))
        weight.attach(oo.Sphere(0.24, mass=10, material="steel", appearance=look("steel", shine=0.8)))
        self.plumb.attach(oo.CentreOfMass(radius=0.14))
        self.rope = oo.Hinge(self.plumb, self.trolley, anchor=self.trolley.position, axis=(0, 0, 1))

    def build_ram(self) -> None:
        """A wall on the ground that pushes crates along."""
        blade = oo.Box((0.15, 0.7, 2.0), material="steel", appearance=look("steel", YELLOW, scale=0.9))
        self.ram = self.machine("ram", oo.Vec3(-3.0, 0.36, 1.3), blade)
        self.pushed = [
            self.crate(-2.3, 0.0, 0.8, 0.2),
            self.crate(-1.9, 0.0, 1.7, -0.1),
            self.crate(-1.2, 0.0, 1.1, 0.5),
        ]

    def before_step(self) -> None:
        """Send everything on its way, and watch the crates on the lift."""
        if self.world.steps == round(START / self.world.step_size):
            self.lift.glide_to(LIFTED, seconds=MOVE)
            self.table.glide_to(rotation=oo.Quat.from_axis_angle((0, 1, 0), ROUND), seconds=MOVE)
            self.trolley.glide_to((3.2, HIGH, BACK), seconds=2 * MOVE)
            self.ram.glide_to((-0.4, 0.36, 1.3), seconds=MOVE)
        top = self.lift.position.y + DECK / 2
        self.away = max(self.away, *(abs(crate.position.y - EDGE / 2 - top) for crate in self.lifted[:2]))
        self.loosest = max(self.loosest, self.rope.error)

    def check(self) -> None:
        """Everything was carried and pushed to where it belongs."""
        expect(self.lift.position == oo.Vec3(*LIFTED), "the lift is where it was sent, to the last bit")
        expect(self.away < 0.05, "the crates stay on the lift")
        expect(abs(self.lifted[2].position.y - UP - DECK - 1.5 * EDGE) < 0.05, "also the one on top of the others")
        expect(abs(self.table.rotation.angle - ROUND) < 1e-9, "the turntable has turned as far as it should")
        for crate, stood in zip(self.turned, self.stood, strict=True):
            slipped = self.table.world_to_local(crate.position).distance(stood)
            expect(slipped < 0.15, "what stands on the turntable has turned with it")
        expect(self.loosest < 0.005, "the plumb hangs on the trolley")
        expect(self.plumb.world_centre_of_mass.x > 2.5, "and has come along")
        front = self.ram.position.x + 0.075
        expect(all(crate.position.x > front for crate in self.pushed), "the crates have been pushed along")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Lift, arguments)


if __name__ == "__main__":
    main()
