"""A shooting range: the constructor gun on a mount throws iron balls and wooden cubes at stacks of crates.

Shows a weapon held by a ball joint and a motor with three stops, charges counted in steps, shots that are swept along
their way, recoil, and the impact event, which tells how hard the crates and the wall are hit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.game.gun import ConstructorGun
from osgode.examples.game.impact import Impact, on_impact
from osgode.examples.game.mount import Mount
from osgode.examples.runner import Example, Orbit, expect, look, run

WALL_Z, WALL = -13.0, (15.0, 3.6, 0.2)
"""Where the wall stands, and its size, metres."""
CRATE = 0.55
"""Edge of a crate, metres."""
STACKS = ((-4.2, -9.0), (0.0, -10.0), (4.2, -9.0))
"""Where the stacks stand: x and z, metres."""
SHOTS = (
    (0.6, "left", 0.9, (-4.2, 0.7, -9.0)),
    (2.5, "right", 0.45, (-4.0, 1.2, -9.0)),
    (3.7, "left", 1.0, (0.0, 0.9, -10.0)),
    (5.8, "right", 0.8, (4.2, 0.6, -9.0)),
    (7.5, "left", 0.5, (4.3, 0.4, -9.0)),
)
"""When a button goes down (seconds), which, for how long (of a full charge), and where the camera looks then."""


class Guns(Example):
    """A mount with a gun, three stacks, and a wall behind."""

    SECONDS = 10.0
    MOMENTS = (5.45, 2.15, 7.4)
    WORLD: ClassVar = {"iterations": 30, "contact_surface_layer": 0.001}

    def build(self) -> None:
        """Ground, wall, stacks, gun."""
        self.orbit = Orbit(oo.Vec3(0.3, 1.35, -3.2), 5.4, yaw=0.3, pitch=0.12)
        self.fixed.attach(
            oo.Plane(material="concrete", appearance=look("concrete", (0.82, 0.8, 0.76), scale=4.0, shine=0.0))
        )
        brick = oo.Box(WALL, material="brick", appearance=look("brick", scale=1.6, shine=0.0))
        self.still(brick, (0.0, WALL[1] / 2, WALL_Z))
        cap = look("concrete", (0.7, 0.7, 0.7), scale=1.5)
        self.still(oo.Box((WALL[0] + 0.2, 0.12, 0.4), appearance=cap), (0.0, WALL[1] + 0.06, WALL_Z))
        self.crates = [self.crate(x, z, row, k) for x, z in STACKS for row in range(4) for k in range(4 - row)]
        self.stood = [crate.position for crate in self.crates]

        self.mount = self.moving.attach(Mount())
        self.gun = self.moving.attach(ConstructorGun((0.0, 1.3, 0.0)))
        self.mount.pick_up(self.gun)
        self.impacts: list[Impact] = []
        on_impact(brick, self.impacts.append, 50.0)
        self.pushed_back, self.passed, self.before = 0.0, 0, dict[oo.Body, oo.Vec3]()

    def crate(self, x: float, z: float, row: int, k: int) -> oo.Body:
        """One of a pyramid."""
        shape = oo.Box((CRATE,) * 3, material="wood", mass=9.0, appearance=look("crate"))
        place = (x + (k - (3 - row) / 2) * (CRATE + 0.03), CRATE / 2 + row * CRATE, z)
        crate = self.body(shape, place, oo.Quat.from_axis_angle((0, 1, 0), 0.04 * (k - row)), name=f"crate {row} {k}")
        crate.tunnelling = "sweep"  # a full shot makes it as fast as itself
        return crate

    def before_step(self) -> None:
        """Look, press, release as the script says."""
        now, step = self.world.steps, self.world.step_size
        for at, button, charge, target in SHOTS:
            pressed = round(at / step)
            if now == pressed - 50:
                self.mount.look_at(target)
            if now == pressed:
                self.mount.arsenal.press(button)
            if now == pressed + round(charge * self.gun.FULL_CHARGE / step) - 1:
                self.mount.arsenal.release(button, self.mount.aim)
        self.pushed_back = max(self.pushed_back, self.mount.slide.position)
        places = {body: body.position for body in (*self.crates, *self.gun.shots.alive)}
        for body, place in places.items():
            inside = abs(place.x) < WALL[0] / 2 and place.y < WALL[1]
            self.passed += inside and place.z < WALL_Z < self.before.get(body, place).z
        self.before = places

    def check(self) -> None:
        """The stacks are knocked over, the wall is hit and not passed, and the gun kicks."""
        moved = [crate.position.distance(old) for crate, old in zip(self.crates, self.stood, strict=True)]
        for k in range(len(STACKS)):
            expect(max(moved[10 * k : 10 * k + 10]) > 1.0, "every stack is hit")
        expect(len(self.gun.shots.alive) == len(SHOTS), "every shot is there")
        expect(self.passed == 0, "nothing passes through the wall")
        expect(bool(self.impacts), "the wall is hit")
        expect(max(impact.energy for impact in self.impacts) > 1000.0, "and hard")
        expect(0.05 < self.pushed_back < 0.5, "the gun kicks")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Guns, arguments)


if __name__ == "__main__":
    main()
