"""A flail on a mount is swung to and fro and all around, through towers of crates.

Shows a chain of capsules on universal joints that swings a ball without stretching, joints that bend with friction, and
what a World needs for that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.game.flail import ITERATIONS, Flail
from osgode.examples.game.mount import HEIGHT, Mount
from osgode.examples.runner import Example, Orbit, expect, look, run

CRATE = 0.4
"""Edge of a crate, metres."""
AROUND = 1.0
"""How far from the post the towers stand, metres."""
TOWERS = (-2.2, 2.2, math.pi)
"""In which directions, radians to the left of straight ahead."""
LOOSE = 0.005
"""How far a link may stretch while it is swung, metres."""


class Swinging(Example):
    """A mount with a flail among three towers."""

    SECONDS = 9.0
    MOMENTS = (4.8, 6.8, 1.35)
    WORLD: ClassVar = {"iterations": ITERATIONS, "contact_surface_layer": 0.001}

    def build(self) -> None:
        """Ground, towers, flail."""
        self.orbit = Orbit(oo.Vec3(0.0, 0.98, 0.1), 3.2, yaw=-2.45, pitch=0.2)
        self.fixed.attach(oo.Plane(material="earth", appearance=look("dirt", (0.9, 0.86, 0.8), scale=3.0, shine=0.0)))
        self.crates = [self.crate(angle, row) for angle in TOWERS for row in range(4)]
        self.stood = [crate.position for crate in self.crates]
        self.mount = self.moving.attach(Mount(turn_speed=8.0))
        self.flail = self.moving.attach(Flail((0.0, HEIGHT, 0.0)))
        self.mount.pick_up(self.flail)
        self.stretched, self.shaken, self.fastest = 0.0, 0.0, 0.0

    def crate(self, angle: float, row: int) -> oo.Body:
        """One of a tower."""
        shape = oo.Box((CRATE,) * 3, material="wood", mass=4.0, appearance=look("crate"))
        place = (-AROUND * math.sin(angle), CRATE * (row + 0.5), -AROUND * math.cos(angle))
        return self.body(shape, place, oo.Quat.from_axis_angle((0, 1, 0), angle + 0.1 * row), name=f"crate {row}")

    def before_step(self) -> None:
        """Swing it to and fro in front for three seconds, then all around."""
        time = self.world.time
        if time < 3.0:
            self.mount.controls.yaw = 1.2 * math.sin(4.4 * max(time - 0.8, 0.0))
            self.mount.controls.pitch = 0.25 * math.sin(1.7 * time)
            self.stretched = max(self.stretched, self.flail.stretch)
        elif time < 8.0:
            self.mount.controls.yaw += 7.2 * self.world.step_size
            self.mount.controls.pitch = 0.1
        self.shaken = max(self.shaken, self.flail.stretch)
        self.fastest = max(self.fastest, self.flail.ball.linear_velocity.length)

    def check(self) -> None:
        """It holds together, and the towers don't."""
        expect(self.fastest > 4.0, "the ball is swung")
        expect(self.stretched < LOOSE, "no link stretches by five millimetres while it is swung")
        expect(self.shaken < 0.03, "nor much where it hits")
        expect(self.flail.held and self.flail.stretch < LOOSE, "it is in one piece in the end")
        moved = [crate.position.distance(old) for crate, old in zip(self.crates, self.stood, strict=True)]
        expect(sum(far > 0.3 for far in moved) >= 4, "it knocks crates over")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Swinging, arguments)


if __name__ == "__main__":
    main()
