"""A rocket launcher on a mount shoots at a heap of crates and at a tower, and once into the sky, where the fuel ends.

Shows rockets that are pushed along their flight in each step, what is removed in the step after it hit, explosions that
push outward what they reach, and calls scheduled for steps to come.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.game.mount import Mount
from osgode.examples.game.rocket import FUEL, Rocket, RocketLauncher
from osgode.examples.runner import Example, Orbit, expect, look, run

CRATE = 0.6
"""Edge of a crate, metres."""
HEAP, TOWER = oo.Vec3(-4.5, 0.0, -15.0), oo.Vec3(5.0, 0.0, -17.0)
"""Where they stand, metres."""
SHOTS = (
    (0.8, HEAP + oo.Vec3(0.3, 0.6, 0.0)),
    (3.2, TOWER + oo.Vec3(0.0, 1.6, 0.0)),
    (5.4, oo.Vec3(-8.0, 40.0, -60.0)),
)
"""When (seconds), and at what."""


class Rockets(Example):
    """A launcher, a heap, a tower."""

    SECONDS = 17.5
    MOMENTS = (2.1, 1.5, 4.5)
    WORLD: ClassVar = {"iterations": 30, "contact_surface_layer": 0.001}

    def build(self) -> None:
        """Ground, crates, launcher."""
        self.orbit = Orbit(oo.Vec3(0.1, 1.75, -4.4), 7.2, yaw=0.3, pitch=0.1)
        self.fixed.attach(
            oo.Plane(material="earth", appearance=look("grass", (0.95, 0.95, 0.85), scale=3.0, shine=0.0))
        )
        self.heap = [
            self.crate(
                HEAP + oo.Vec3((i - (3 - j) / 2) * 0.64, CRATE * (j + 0.5), (k - (3 - j) / 2) * 0.64),
                f"heap {i} {j} {k}",
            )
            for j in range(4)
            for i in range(4 - j)
            for k in range(4 - j)
        ]
        self.tower = [
            self.crate(TOWER + oo.Vec3(0.31 * side, CRATE * (j + 0.5), 0.31 * depth), f"tower {side} {j} {depth}")
            for j in range(6)
            for side in (-1, 1)
            for depth in (-1, 1)
        ]
        self.stood = {crate: crate.position for crate in (*self.heap, *self.tower)}
        self.mount = self.moving.attach(Mount())
        self.launcher = self.moving.attach(RocketLauncher((0.0, 1.3, 0.0)))
        self.mount.pick_up(self.launcher)
        self.rockets: list[Rocket] = []
        self.fastest, self.highest = 0.0, 0.0

    def crate(self, position: oo.Vec3, name: str) -> oo.Body:
        """A crate."""
        return self.body(
            oo.Box((CRATE,) * 3, material="wood", mass=12.0, appearance=look("crate")), position, name=name
        )

    def before_step(self) -> None:
        """Look and shoot as the script says, and watch."""
        now, step = self.world.steps, self.world.step_size
        for at, target in SHOTS:
            pressed = round(at / step)
            if now == pressed - 70:
                self.mount.look_at(target)
            if now == pressed:
                self.mount.arsenal.press("left")
                self.mount.arsenal.release("left", self.mount.aim)
                self.rockets += [node for node in self.moving.children if isinstance(node, Rocket)][-1:]
        for rocket in self.rockets[-1:]:
            if rocket.in_simulation:
                self.fastest = max(self.fastest, rocket.rocket.linear_velocity.length)
                self.highest = max(self.highest, rocket.rocket.position.y)

    def check(self) -> None:
        """The first two rockets have blown up heap and tower; the fuel of the last is gone, and it falls."""
        expect(len(self.rockets) == len(SHOTS), "every rocket has been shot")
        first, second, last = self.rockets
        for rocket, place, crates in ((first, HEAP, self.heap), (second, TOWER, self.tower)):
            expect(rocket.explosion is not None, "a rocket that hits explodes")
            expect(not rocket.in_simulation, "and is gone")
            far = [crate.position.distance(place) > self.stood[crate].distance(place) + 1.0 for crate in crates]
            expect(sum(far) > len(far) / 2, "an explosion throws crates outward")
        expect(all(crate.position.y > 0.0 for crate in self.stood), "and none into the ground")
        expect(last.explosion is None and not last.burning, f"after {FUEL:.0f} s there is no fuel left")
        expect(self.fastest > 150.0 and self.highest > 300.0, "until then it is accelerated")
        expect(last.rocket.gravity, "then it falls")
        velocity = last.rocket.linear_velocity.normalized()
        expect(last.rocket.vector_to_world((0.0, 0.0, -1.0)).dot(velocity) > 0.999, "with its nose ahead")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Rockets, arguments)


if __name__ == "__main__":
    main()
