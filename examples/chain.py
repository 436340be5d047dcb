"""A hanging bridge of planks on two chains bears what rolls and falls on it, until it is cut at one end.

Shows the chain builder: chains that hang at once in the shape in which they rest, bodies joined to their links,
thin ropes as handrails, and chains that are cut while they bear a load.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

SPAN, DECK, HALF = 4.6, 4.8, 0.75
"""Half of the gap between the cliffs, the height of its edges, and half of the bridge's width, metres."""
LINKS, LENGTH, RAIL = 18, 10.1, 10.8
"""Links of a chain, its length, and that of a handrail, metres."""
PLANK = (0.44, 0.06, 2 * HALF - 0.16)
CUT = 6.0
"""When the bridge is cut, seconds."""
LOOSE = 0.05
"""How far a joint may open, metres."""


class Bridge(Example):
    """Two cliffs, a bridge, and crates."""

    SECONDS = 10.0
    MOMENTS = (0.1, 4.0, 6.7, 9.5)
    WORLD: ClassVar = {"iterations": 80, "contact_surface_layer": 0.002}

    def build(self) -> None:
        """Cliffs, chains, planks, ropes, and what falls."""
        self.orbit = Orbit(oo.Vec3(0.3, 3.0, 0.0), 13.2, yaw=0.42, pitch=0.33, turn=-0.02)
        self.fixed.attach(oo.Plane(material="earth", appearance=look("grass", scale=3.0, shine=0.0)))
        for side in (-1.0, 1.0):
            self.block((side * (SPAN + 1.6), DECK / 2, 0.0), (3.0, DECK, 5.0), "brick", (0.9, 0.85, 0.8))
            for z in (-HALF - 0.1, HALF + 0.1):
                self.block((side * (SPAN + 0.45), DECK + 0.6, z), (0.18, 1.2, 0.18), "planks", (0.8, 0.7, 0.6))
        self.build_bridge()
        self.build_load()
        self.loosest, self.lowest = 0.0, DECK

    def block(self, at: Sequence[float], size: Sequence[float], texture: str, tint: tuple[float, float, float]) -> None:
        """A static box."""
        material = {"brick": "brick", "planks": "wood"}[texture]
        self.fixed.attach(oo.Placeable(position=at)).attach(
            oo.Box(size, material=material, appearance=look(texture, tint, scale=1.5))
        )

    def build_bridge(self) -> None:
        """Two chains that bear planks, and two ropes to hold on to."""
        steel = look("steel", (0.7, 0.7, 0.75), shine=0.6)
        hemp = oo.Appearance((0.72, 0.6, 0.4, 1.0), shininess=0.0)
        self.chains, self.rails = [], []
        for side in (-1.0, 1.0):
            z = side * HALF
            left, right = (-SPAN, DECK, z), (SPAN, DECK, z)
            self.chains.append(
                oo.chain(
                    self.moving, left, right, length=LENGTH, links=LINKS, radius=0.05, mass=90.0, appearance=steel,
                    joint="universal", name=f"chain {side:+.0f}",
                )
            )  # fmt: skip
            first, last = (oo.Vec3(end * (SPAN + 0.33), DECK + 1.15, 1.13 * z) for end in (-1.0, 1.0))
            self.rails.append(
                oo.chain(
                    self.moving, first, last, length=RAIL, links=30, radius=0.025, mass=6.0, damping=0.003,
                    appearance=hemp, name=f"rail {side:+.0f}",
                )
            )  # fmt: skip
        near, far = self.chains
        self.planks = []
        for k, (link, other) in enumerate(zip(near.links, far.links, strict=True)):
            middle = (link.position + other.position) / 2
            plank = self.moving.attach(oo.Body(name=f"plank {k}", position=middle, rotation=link.rotation))
            # A link's z axis points along the chain, its y axis to the side.
            turned = oo.Placeable(rotation=oo.Quat.from_matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]]))
            plank.attach(turned).attach(
                oo.Box(PLANK, material="wood", mass=9.0, appearance=look("planks", scale=1.0, shine=0.0))
            )
            oo.Fixed(plank, link)
            oo.Ball(plank, other, anchor=other.position)
            self.planks.append(plank)

    def build_load(self) -> None:
        """Crates that fall onto the bridge, and a ball that rolls along it from the left."""
        self.crates = []
        for k in range(3):
            crate = self.moving.attach(oo.Body(name=f"crate {k}", position=(0.9 * k - 0.6, DECK + 0.6 + 0.9 * k, 0.0)))
            crate.rotation = oo.Quat.from_axis_angle((0, 1, 0), 0.4 * k)
            crate.attach(oo.Placeable()).attach(
                oo.Box((0.6, 0.6, 0.6), material="wood", mass=18.0, appearance=look("crate"))
            )
            self.crates.append(crate)
        self.ball = self.moving.attach(oo.Body(name="ball", position=(-SPAN - 0.9, DECK + 0.3, 0.0)))
        self.ball.linear_velocity = (2.2, 0, 0)
        self.ball.attach(oo.Placeable()).attach(
            oo.Sphere(0.3, material="rubber", mass=12.0, appearance=look("paint", (0.85, 0.25, 0.15), shine=0.5))
        )

    def before_step(self) -> None:
        """Cut the bridge at its right end, and watch."""
        if self.world.steps == round(CUT / self.world.step_size):
            self.borne = min(thing.position.y for thing in (*self.crates, self.ball))
            for chain in self.chains:
                chain.cut(LINKS)
        self.loosest = max(self.loosest, *(chain.error for chain in self.chains))
        self.lowest = min(self.lowest, *(plank.position.y for plank in self.planks))

    def check(self) -> None:
        """It has borne its load until it was cut, and hangs down from the left cliff since."""
        expect(self.world.time > CUT, "it is cut")
        expect(self.borne > 1.0, "the bridge bears crates and ball until it is cut")
        expect(self.loosest < LOOSE, "no joint of the chains opens by five centimetres")
        expect(all(thing.position.y < 1.0 for thing in self.crates), "the crates lie on the ground")
        for chain in self.chains:
            expect(chain.points[0].distance((-SPAN, DECK, chain.points[0].z)) < LOOSE, "it is held at the left")
            expect(chain.points[-1].y < 0.5, "its right end lies on the ground")
            expect(max(chain.points[k].x for k in range(6)) < -SPAN + 2.5, "it hangs down at the left")
        for rail in self.rails:
            expect(abs(rail.points[15].x) < 0.2 and rail.error < 0.01, "the ropes hang as before")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Bridge, arguments)


if __name__ == "__main__":
    main()
