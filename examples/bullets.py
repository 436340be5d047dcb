"""Three guns fire at three thin walls, thirty times slower than in life.

Nothing follows the red bullets; a ray follows the middles of the yellow ones; a sweep follows all of the green ones.
Shows what `Body.tunnelling` does against bullets that go a metre in a step: red ones fly through the wall, yellow ones
only where they graze its edge, green ones never. Each leaves a mark where it was after a step, until it
bounces.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ALONG_X, Example, Orbit, expect, look, painted, run

STEP, WAY = 0.25, 1.0
"""Seconds of the picture that a step takes: 1/120 s in life; and how far a bullet goes in it, metres."""
RADIUS, THICK, HEIGHT = 0.11, 0.03, 1.4
"""Of the bullets and of the walls, metres."""
MUZZLE, WALL, END = -3.0, 0.5, 4.0
"""Where along x bullets come from, where the walls stand, and where bullets are taken away, metres."""
SHOTS = ((0.35, -0.4), (0.75, 0.2), (1.15, -0.1), (0.5, 0.45), (HEIGHT + RADIUS / 3, 0.1), (0.95, 0.5))
"""How high, and how far beside the middle, the bullets of a gun fly, metres. One is over the wall, but for a third of
it."""
GRAZING = 4
"""Which one that is."""
EVERY = 3
"""Steps from one bullet to the next."""
LANES = ((None, -2.2, (0.9, 0.16, 0.12)), ("ray", 0.0, (0.98, 0.72, 0.1)), ("sweep", 2.2, (0.15, 0.66, 0.28)))
"""How its bullets are followed, where it is along z, and its colour."""


class Bullets(Example):
    """Guns, walls, bullets, and marks of their ways."""

    SECONDS = 8.0
    MOMENTS = (6.2, 2.2, 7.8)
    WORLD: ClassVar = {"step_size": STEP, "gravity": (0, 0, 0)}

    def build(self) -> None:
        """Ground, and for each lane a gun and a wall."""
        self.orbit = Orbit(oo.Vec3(0.0, 0.6, 0.5), 8.0, yaw=0.3, pitch=0.58)
        self.ground("concrete", (0.75, 0.76, 0.8))
        self.fired: dict[str | None, list[oo.Body]] = {mode: [] for mode, _z, _colour in LANES}
        self.through: dict[str | None, set[int]] = {mode: set() for mode in self.fired}
        self.back: dict[str | None, set[int]] = {mode: set() for mode in self.fired}
        self.marks = {
            mode: oo.Sphere(0.055, appearance=oo.Appearance((*colour, 1.0), shininess=0.2)).drawables()
            for mode, _z, colour in LANES
        }
        steel = look("steel", (0.8, 0.82, 0.85), scale=1.5, shine=0.5)
        for _mode, z, colour in LANES:
            self.still(
                oo.Box((THICK, HEIGHT, 1.7), surface=oo.Surface(0.2, bounce=0.4), appearance=steel),
                (WALL, HEIGHT / 2, z),
            )
            self.gun(z, colour)

    def gun(self, z: float, colour: tuple[float, float, float]) -> None:
        """A block with a barrel for each bullet, in the colour of the lane."""
        block = self.root.attach(oo.PositionAttitudeTransform(position=(MUZZLE - 0.75, 0.9, z)))
        block.attach(oo.Leaf(oo.Box((0.5, 1.8, 1.5), appearance=painted(*colour)).drawables()))
        barrel = oo.Cylinder(0.14, 0.5, appearance=painted(0.2, 0.21, 0.24)).drawables()
        for y, aside in SHOTS:
            place = oo.PositionAttitudeTransform(position=(MUZZLE - 0.3, y, z + aside), rotation=ALONG_X)
            self.root.attach(place).attach(oo.Leaf(barrel))

    def before_step(self) -> None:
        """Fire, mark where the bullets are, and see what has become of them."""
        shot, rest = divmod(self.world.steps, EVERY)
        for mode, z, colour in LANES:
            if rest == 0 and shot < len(SHOTS):
                y, aside = SHOTS[shot]
                bullet = oo.Body(position=(MUZZLE, y, z + aside), linear_velocity=(WAY / STEP, 0, 0))
                bullet.tunnelling = mode
                bullet.attach(oo.Placeable()).attach(oo.Sphere(RADIUS, mass=0.1, appearance=painted(*colour)))
                self.fired[mode].append(self.moving.attach(bullet))
            for number, bullet in enumerate(self.fired[mode]):
                x = bullet.position.x
                if x > WALL + RADIUS:
                    self.through[mode].add(number)
                if bullet.linear_velocity.x < 0 or bullet.linear_velocity.y > 0.1:
                    self.back[mode].add(number)
                flying = x > WALL or number not in self.back[mode] or number == GRAZING
                if flying and bullet.parent is not None and MUZZLE < x < END:
                    mark = oo.PositionAttitudeTransform(position=bullet.position)
                    self.root.attach(mark).attach(oo.Leaf(self.marks[mode]))
                if bullet.parent is not None and abs(x) > END:
                    self.moving.detach(bullet)

    def check(self) -> None:
        """Nothing follows: all get through; a ray: the one that grazes; a sweep: none, it is thrown up by the edge."""
        everyone = set(range(len(SHOTS)))
        expect(self.through[None] == everyone, "bullets that nothing follows fly through the wall")
        expect(self.through["ray"] == {GRAZING}, "a ray misses the bullet that grazes the edge, and no other")
        expect(self.back["sweep"] == everyone, "a sweep lets every bullet feel the wall")
        expect(not self.back[None], "nothing that flies through feels the wall")
        expect(self.through["sweep"] <= {GRAZING}, "nothing that is swept passes through the wall")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Bullets, arguments)


if __name__ == "__main__":
    main()
