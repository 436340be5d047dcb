"""Somebody walks over a course: stairs, a slope, a beam that moves, and crates in the way.

Shows the game's player: a capsule on a ray, which climbs by itself what isn't too steep, jumps as high as the jump
was charged, is carried by what it stands on, and pushes what it runs into.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.game.player import Player
from osgode.examples.runner import Example, Orbit, expect, look, run

STAIRS, RISE, TREAD = 6, 0.2, 0.34
"""How many steps, how high and how deep each is, metres."""
FERRY = oo.Vec3(0.0, STAIRS * RISE - 0.1, -9.0)
"""Where the ferry waits; it goes `ACROSS` to the right, and back."""
ACROSS, CROSSING = 4.0, 4.0
"""Metres, and seconds for them."""
SLOPE = math.radians(30.0)
GOAL = oo.Vec3(4.0, 0.0, -19.5)


class Course(Example):
    """Stairs, ferry, slope, crates."""

    SECONDS = 15.0
    MOMENTS = (6.5, 1.2, 13.5)
    WORLD: ClassVar = {"iterations": 30}

    def build(self) -> None:
        """The course and the player."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.2, -1.0), 6.5, yaw=0.55, pitch=0.22)
        self.ground("grass", (0.9, 0.95, 0.85))
        stone = look("concrete", (0.85, 0.83, 0.8), scale=1.5)
        for k in range(STAIRS):
            top = (k + 1) * RISE
            self.still(oo.Box((2.4, top, TREAD), appearance=stone), (0.0, top / 2, -3.0 - k * TREAD))
        top = STAIRS * RISE
        end = -3.0 - STAIRS * TREAD + TREAD / 2
        self.still(oo.Box((2.4, top, 7.6 + end), appearance=stone), (0.0, top / 2, (end - 7.6) / 2))
        self.ferry = self.body(
            oo.Box((2.4, 0.2, 2.6), mass=400.0, material="steel", appearance=look("steel", scale=1.0)),
            FERRY,
            name="ferry",
        )
        self.ferry.kinematic = True
        self.still(oo.Box((2.4, top, 2.0), appearance=stone), (ACROSS, top / 2, -11.4))
        long = top / math.sin(SLOPE)
        middle = oo.Vec3(ACROSS, top / 2, -12.4 - top / math.tan(SLOPE) / 2)
        tilt = oo.Quat.from_axis_angle((1, 0, 0), -SLOPE)
        down = oo.Vec3(0.0, -math.cos(SLOPE), -math.sin(SLOPE)) * 0.1
        self.still(oo.Box((2.4, 0.2, long), appearance=look("planks", scale=1.2)), middle + down, tilt)
        for x, y in ((-0.45, 0.3), (0.45, 0.3), (0.0, 0.9)):
            crate = oo.Box((0.6, 0.6, 0.6), mass=12.0, material="wood", appearance=look("crate"))
            self.body(crate, (ACROSS + x, y, -17.5), name="crate")
        self.player = self.moving.attach(Player((0.0, 0.0, 0.0)))
        self.leaned, self.highest = 0.0, 0.0

    def before_step(self) -> None:
        """The ferry comes and goes; the player follows its way."""
        time = self.world.time
        self.player.torso.wake()
        if abs(time - 5.0) < self.world.step_size / 2:
            self.ferry.glide_to(FERRY + oo.Vec3(ACROSS, 0.0, 0.0), seconds=CROSSING)
        controls, feet = self.player.controls, self.player.feet
        aboard = feet.z < FERRY.z + 0.2 and time < 5.0 + CROSSING + 0.2
        controls.move(forward=not aboard and feet.z > GOAL.z, ascend=12.4 < time < 13.1)
        up = self.player.torso.vector_to_world((0.0, 1.0, 0.0))
        self.leaned = max(self.leaned, math.acos(min(up.y, 1.0)))
        self.highest = max(self.highest, feet.y)

    def move_camera(self) -> None:
        """The picture follows the player."""
        self.orbit.target += (self.player.feet + oo.Vec3(0.0, 1.1, 0.0) - self.orbit.target) * 0.1
        super().move_camera()

    def check(self) -> None:
        """Up the stairs, over on the ferry, down the slope, through the crates, and upright all the time."""
        feet = self.player.feet
        expect(self.highest > STAIRS * RISE - 0.02, f"the stairs are climbed, to {self.highest:.2f} m")
        expect(abs(feet.x - ACROSS) < 0.6, f"the ferry has carried it across: x is {feet.x:.2f} m")
        expect(feet.z < GOAL.z + 0.5 and abs(feet.y) < 0.05, f"it stands behind the crates, at {feet}")
        expect(self.leaned < math.radians(1.0), f"it leaned {math.degrees(self.leaned):.2f} degrees at most")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Course, arguments)


if __name__ == "__main__":
    main()
