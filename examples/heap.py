"""Five hundred things fall in a heap beside a house, until they sleep.

Shows a terrain and a house as triangle meshes, a vehicle that collides as two boxes and looks like its model, wheels
on hinges, composite bodies of several shapes, bodies that are attached while the simulation runs, and bodies
that fall asleep when they have come to rest.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ASSETS, Example, Orbit, expect, look, run

COUNT = 500
ACROSS, APART, HEIGHT = 7, 0.85, 4.8
"""Things are let go in layers of ACROSS by ACROSS, APART metres from each other, at this height, metres.

Not higher: at most 10 m/s is 8 cm a step, so that a thing 16 cm thick can't get through the ground between two steps.
"""
PAUSE = 0.45
"""Between the layers, seconds: enough for each to fall out of the way of the next."""
HEAP = oo.Vec3(3.6, 0.0, 2.2)
"""What they are dropped on."""
HOUSE = oo.Pose(oo.Vec3(-4.2, 0.0, -4.0))
VEHICLE = oo.Pose(oo.Vec3(-3.2, 0.36, 3.2), oo.Quat.from_yaw_pitch_roll(-1.2))
AXLES, TRACK, WHEEL, TYRE = (-1.3, 1.3), 0.76, 0.33, 0.2
"""Where the model's wheels belong: z of the axles, half the distance between wheels, radius, width."""


class Heap(Example):
    """Terrain, house, vehicle, and the things."""

    SECONDS = 10.0
    MOMENTS = (0.7, 1.6, 3.5, 9.9)
    WORLD: ClassVar = {
        "auto_disable": True,
        "auto_disable_linear_threshold": 0.1,
        "auto_disable_angular_threshold": 0.3,
        "auto_disable_samples": 15,  # what trembles on the spot is at rest, on average
        "contacts_per_pair": 8,
        "contact_max_correcting_velocity": 4.0,
    }

    def build(self) -> None:
        """Put it all up."""
        self.orbit = Orbit(oo.Vec3(0.6, 1.6, 0.6), 16.0, yaw=0.5, pitch=0.27, turn=-0.06)
        terrain = oo.load_model(ASSETS / "terrain.obj")
        self.fixed.attach(oo.Placeable()).attach(oo.Trimesh(terrain, material="earth", name="terrain"))
        house = oo.Trimesh(oo.load_model(ASSETS / "house.obj"), material="brick", name="house")
        self.fixed.attach(oo.Placeable(position=HOUSE.position, rotation=HOUSE.rotation)).attach(house)
        self.build_vehicle()
        self.build_things()

    def build_vehicle(self) -> None:
        """Two boxes that look like a hull, and four wheels on hinges."""
        model = oo.load_model(ASSETS / "hull.obj")
        self.vehicle = self.moving.attach(oo.Body(name="vehicle", position=VEHICLE.position, rotation=VEHICLE.rotation))
        chassis = self.vehicle.attach(oo.Placeable(position=(0.0, 0.22, 0.0)))
        chassis.attach(oo.Box((1.7, 0.76, 4.2), mass=700, material="steel", visible=False))
        cabin = self.vehicle.attach(oo.Placeable(position=(0.0, 0.86, 0.55)))
        cabin.attach(oo.Box((1.35, 0.6, 2.0), mass=200, material="steel", visible=False))
        self.vehicle.attach(model.to_leaf())
        for x in (-TRACK, TRACK):
            for z in AXLES:
                at = VEHICLE.transform((x, 0.0, z))
                wheel = self.moving.attach(oo.Body(name="wheel", position=at, rotation=VEHICLE.rotation))
                sideways = wheel.attach(oo.Placeable(rotation=oo.Quat.between((0, 0, 1), (1, 0, 0))))
                sideways.attach(
                    oo.Cylinder(WHEEL, TYRE, mass=18, material="rubber", appearance=look("rubber", shine=0.1))
                )
                sideways.attach(oo.Cylinder(0.19, TYRE + 0.02, mass=0, appearance=look("steel", shine=0.7)))
                oo.Hinge(wheel, self.vehicle, anchor=at, axis=VEHICLE.rotation.rotate((1, 0, 0)))

    def build_things(self) -> None:
        """Make them, out of the World for the time being."""
        chance = random.Random(11)  # noqa: S311  (the same heap every time)
        kinds = [kind for kind, share in KINDS.items() for _ in range(share)]
        middle = (ACROSS - 1) / 2
        self.things: list[oo.Body] = []
        for k in range(COUNT):
            row, column = divmod(k % (ACROSS * ACROSS), ACROSS)
            place = oo.Vec3((column - middle) * APART, HEIGHT, (row - middle) * APART)
            jitter = oo.Vec3(*(chance.uniform(-0.06, 0.06) for _ in range(3)))
            yaw, pitch, roll = (chance.uniform(-math.pi, math.pi) for _ in range(3))
            body = oo.Body(
                name=f"thing {k}",
                position=HEAP + place + jitter,
                rotation=oo.Quat.from_yaw_pitch_roll(yaw, pitch, roll),
                tunnelling="sweep",  # the ground is a surface, and a plank is thin
            )
            chance.choice(kinds)(body, chance)
            self.things.append(body)

    def before_step(self) -> None:
        """Let the next layer fall when it is time."""
        layer, rest = divmod(self.world.steps, round(PAUSE / self.world.step_size))
        if rest == 0:
            for body in self.things[layer * ACROSS**2 : (layer + 1) * ACROSS**2]:
                self.moving.attach(body)

    def check(self) -> None:
        """Nothing fell through the ground or was blown away, the heap is high, and nearly everything sleeps."""
        for body in self.things:
            x, y, z = body.position
            expect(y > -0.3, f"{body.describe()} stays above the ground")
            expect(math.hypot(x - HEAP.x, z - HEAP.z) < 25, f"{body.describe()} isn't blown away")
        expect(sum(body.position.y > 0.8 for body in self.things) > COUNT / 20, "they lie on each other")
        asleep = sum(not body.enabled for body in self.things)
        expect(asleep > 0.8 * COUNT, f"nearly all sleep in the end, not {asleep} of {COUNT}")
        expect(self.vehicle.position.distance(VEHICLE.position) < 4.0, "the vehicle is hardly moved")
        expect(self.vehicle.vector_to_world((0, 1, 0)).y > 0.9, "the vehicle stands on its wheels")


def crate(body: oo.Body, chance: random.Random) -> None:
    """A wooden box."""
    edge = chance.choice((0.4, 0.5, 0.6))
    body.attach(oo.Placeable()).attach(
        oo.Box((edge, edge, edge), material="wood", density=200, appearance=look("crate"))
    )


def beam(body: oo.Body, _: random.Random) -> None:
    """A beam."""
    body.attach(oo.Placeable()).attach(oo.Box((0.9, 0.16, 0.22), material="wood", appearance=look("planks", scale=0.9)))


def block(body: oo.Body, _: random.Random) -> None:
    """A piece of a brick wall."""
    body.attach(oo.Placeable()).attach(
        oo.Box((0.55, 0.3, 0.35), material="brick", density=900, appearance=look("brick", scale=0.8))
    )


def ball(body: oo.Body, chance: random.Random) -> None:
    """A painted rubber ball that bounces a little."""
    tint = chance.choice(((1.0, 0.9, 0.3), (0.3, 0.8, 1.0), (1.0, 0.55, 0.9)))
    body.attach(oo.Placeable()).attach(
        oo.Sphere(
            0.27,
            material="rubber",
            density=150,
            surface=oo.Surface(0.8, bounce=0.5, bounce_velocity=0.5, rolling_friction=0.01),
            appearance=oo.Appearance((*tint, 1.0), shininess=0.4),
        )
    )


def shot(body: oo.Body, _: random.Random) -> None:
    """An iron ball."""
    body.attach(oo.Placeable()).attach(
        oo.Sphere(
            0.17,
            mass=40,
            material="steel",
            surface=oo.Surface(0.6, rolling_friction=0.01),
            appearance=look("steel", shine=0.8),
        )
    )


def pill(body: oo.Body, chance: random.Random) -> None:
    """A capsule in one of three colours."""
    tint = chance.choice(((0.9, 0.35, 0.2), (0.25, 0.65, 0.35), (0.95, 0.95, 0.9)))
    body.attach(oo.Placeable()).attach(
        oo.Capsule(
            0.14,
            0.45,
            density=400,
            surface=oo.Surface(0.6, rolling_friction=0.01),
            appearance=oo.Appearance((*tint, 1.0), shininess=0.5),
        )
    )


def drum(body: oo.Body, chance: random.Random) -> None:
    """A cylinder of painted steel or of concrete."""
    if chance.random() < 0.7:
        material, appearance = "steel", oo.Appearance((0.10, 0.30, 0.55, 1.0), shininess=0.5)
    else:
        material, appearance = "concrete", look("concrete", shine=0.0)
    body.attach(oo.Placeable()).attach(oo.Cylinder(0.24, 0.6, density=300, material=material, appearance=appearance))


def mallet(body: oo.Body, _: random.Random) -> None:
    """A wooden handle with a steel head: the centre of mass is far up."""
    body.attach(oo.Placeable()).attach(oo.Box((0.1, 0.75, 0.1), material="wood", appearance=look("planks", scale=0.8)))
    body.attach(oo.Placeable(position=(0.0, 0.35, 0.0))).attach(
        oo.Box((0.36, 0.16, 0.16), mass=12, material="steel", appearance=look("steel", scale=0.5, shine=0.7))
    )


def dumbbell(body: oo.Body, _: random.Random) -> None:
    """A bar between two balls."""
    body.attach(oo.Placeable()).attach(
        oo.Capsule(0.05, 0.5, mass=2, material="steel", appearance=look("steel", shine=0.7))
    )
    for z in (-0.27, 0.27):
        body.attach(oo.Placeable(position=(0.0, 0.0, z))).attach(
            oo.Sphere(0.15, mass=8, material="rubber", appearance=look("rubber"))
        )


def jack(body: oo.Body, _: random.Random) -> None:
    """Three bars across each other."""
    for size in ((0.65, 0.16, 0.16), (0.16, 0.65, 0.16), (0.16, 0.16, 0.65)):
        body.attach(oo.Placeable()).attach(
            oo.Box(size, mass=6, material="aluminium", appearance=oo.Appearance((0.95, 0.72, 0.1, 1.0), shininess=0.5))
        )


Maker = Callable[[oo.Body, random.Random], None]
KINDS: dict[Maker, int] = {
    crate: 5,
    beam: 3,
    block: 3,
    ball: 3,
    shot: 2,
    pill: 3,
    drum: 3,
    mallet: 2,
    dumbbell: 2,
    jack: 2,
}
"""What falls, and how often."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Heap, arguments)


if __name__ == "__main__":
    main()
