"""A wrecking ball on a chain swings against a door and pushes it open as far as its stop lets it.

Shows joints: a hinge with stops and a bounce at them, a chain of capsules on ball joints, a fixed joint that is
released when its time has come; and static geometry put up by Placeables.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

DOOR = (1.2, 2.3, 0.09)
LINKS, LINK, WIRE, BALL = 9, 0.3, 0.05, 0.34
"""How many links, the length of one from joint to joint, the radius of its capsule, that of the ball, metres."""
BEAM = oo.Vec3(0.05, 4.3, 1.2)
"""Where the chain hangs."""
LEAN = 1.25
"""How far it is drawn back at the start, radians from the vertical."""
OPEN = 1.9
"""How far the door goes, radians."""
RELEASED = 0.8
"""When the ball is let go, seconds."""

Corner = tuple[float, float, float]


class Door(Example):
    """A wall with a door, and a gallows before it."""

    SECONDS = 8.0
    MOMENTS = (2.2, 0.5, 1.7, 6.0)
    WORLD: ClassVar = {"iterations": 60}  # a chain needs more than a heap

    def build(self) -> None:
        """Ground, wall, door, gallows, chain."""
        self.orbit = Orbit(oo.Vec3(0.0, 2.0, 0.8), 7.6, yaw=0.45, pitch=0.3, turn=-0.02)
        self.fixed.attach(oo.Plane(material="concrete", appearance=look("dirt", scale=3.0, shine=0.0)))
        self.build_wall()
        self.build_gallows()
        self.build_door()
        self.build_chain()
        self.widest, self.loosest = 0.0, 0.0
        self.show_joints(0.8)

    def block(self, material: str, texture: str, low: Corner, high: Corner) -> None:
        """A static box between two corners."""
        first, last = oo.Vec3(*low), oo.Vec3(*high)
        place = self.fixed.attach(oo.Placeable(position=(first + last) / 2))
        place.attach(oo.Box(last - first, material=material, appearance=look(texture, scale=1.5)))

    def build_wall(self) -> None:
        """Brick with a doorway, a little larger than the door so that nothing rubs."""
        side, top = DOOR[0] / 2 + 0.03, DOOR[1] + 0.06
        self.block("brick", "brick", (-3.0, 0.0, -0.15), (-side, 3.0, 0.15))
        self.block("brick", "brick", (side, 0.0, -0.15), (3.0, 3.0, 0.15))
        self.block("brick", "brick", (-side, top, -0.15), (side, 3.0, 0.15))

    def build_gallows(self) -> None:
        """Two posts and a beam of wood."""
        x, y, z = BEAM
        for side in (-2.8, 2.8):
            self.block("wood", "planks", (x + side - 0.1, 0.0, z - 0.1), (x + side + 0.1, y + 0.2, z + 0.1))
        self.block("wood", "planks", (x - 2.9, y, z - 0.1), (x + 2.9, y + 0.2, z + 0.1))

    def build_door(self) -> None:
        """A door leaf with knobs, hinged at the back of the wall, so that it opens inwards only."""
        self.door = self.moving.attach(oo.Body(name="door", position=(0.0, DOOR[1] / 2 + 0.03, -0.105)))
        self.door.attach(oo.Placeable()).attach(
            oo.Box(DOOR, material="wood", mass=25.0, appearance=look("planks", scale=1.2))
        )
        for z in (-0.1, 0.1):
            self.door.attach(oo.Placeable(position=(DOOR[0] / 2 - 0.12, -0.1, z))).attach(
                oo.Sphere(0.05, material="steel")
            )
        self.hinge = oo.Hinge(
            self.door,
            anchor=(-DOOR[0] / 2, 1.0, -0.15),
            axis=(0, 1, 0),
            stops=(0.0, OPEN),
            stop_bounce=0.3,
            name="door",
        )

    def build_chain(self) -> None:
        """The chain, drawn back from the door, and its ball, which is held to the static world."""
        above: oo.Body | None = None
        self.chain: list[oo.Ball] = []
        top = BEAM
        for k in range(LINKS):
            lean = LEAN + (0.2 if k % 2 else -0.2)  # a little folded, so that it isn't as tight as a string
            along = oo.Vec3(0.0, -math.cos(lean), math.sin(lean))
            turn = oo.Quat.between((0, 0, 1), along)
            link = self.moving.attach(oo.Body(name=f"link {k}", position=top + along * (LINK / 2), rotation=turn))
            link.attach(oo.Placeable()).attach(
                oo.Capsule(WIRE, LINK - 2 * WIRE, mass=3.0, material="steel", appearance=look("steel", shine=0.6))
            )
            self.chain.append(oo.Ball(link, above, anchor=top))
            above = link
            top += along * LINK
        self.ball = self.moving.attach(oo.Body(name="ball", position=top + along * BALL))
        self.ball.attach(oo.Placeable()).attach(
            oo.Sphere(BALL, mass=60.0, material="steel", appearance=look("steel", (0.35, 0.35, 0.4), shine=0.7))
        )
        self.chain.append(oo.Ball(self.ball, above, anchor=top))
        self.holder = oo.Fixed(self.ball)

    def before_step(self) -> None:
        """Let the ball go, and watch."""
        if self.world.steps == round(RELEASED / self.world.step_size):
            self.holder.release()
        self.widest = max(self.widest, self.hinge.angle)
        self.loosest = max(self.loosest, *(joint.error for joint in self.chain))

    def check(self) -> None:
        """The door was opened up to its stop and no farther, and the chain has held."""
        expect(self.widest > OPEN - 0.02, "the ball opens the door as far as it goes")
        expect(self.widest < OPEN + 0.05, "the stop holds the door")
        expect(self.hinge.error < 0.005, "the door stays on its hinge")
        expect(self.loosest < 0.02, "no joint of the chain opens by two centimetres")
        reach = LINKS * LINK + BALL
        expect(self.ball.position.distance(BEAM) < reach + 0.05, "the ball hangs on its chain")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Door, arguments)


if __name__ == "__main__":
    main()
