"""A button sets a platform going, which carries somebody over a gap, through a door, and waits at each end.

Shows the game's button, which a stop that it violates pushes out again, slowly, by a small ERP; its platform on a
motorised slider, which waits by scheduled calls; and its door.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.game.platform import BUTTON, SIZE, Button, Platform
from osgode.examples.game.player import Player
from osgode.examples.game.swing_door import SIZE as DOOR
from osgode.examples.game.swing_door import SwingDoor
from osgode.examples.runner import Example, Orbit, expect, look, run

HIGH = 1.2
"""Of both banks, metres."""
START, END = oo.Vec3(0.0, HIGH, -5.2), oo.Vec3(0.0, HIGH, -11.2)
"""The platform's ends."""
PLATE = oo.Vec3(0.0, HIGH + 0.18, -2.0)
WALL = -14.6
"""Where the wall with the door stands, along z."""


class Shuttle(Example):
    """Two banks, a button, a platform, a door."""

    SECONDS = 11.0
    MOMENTS = (3.5, 1.0, 6.9)
    WORLD: ClassVar = {"iterations": 30}

    def build(self) -> None:
        """The banks, the button, the platform, the wall with its door, and who goes there."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.9, -6.5), 12.0, yaw=0.85, pitch=0.27)
        self.ground("dirt", (0.8, 0.8, 0.8))
        stone = look("concrete", (0.85, 0.83, 0.8), scale=1.5)
        half = SIZE[2] / 2
        for near, far in ((2.0, START.z + half + 0.03), (END.z - half - 0.03, -20.0)):
            self.still(oo.Box((4.0, HIGH, near - far), appearance=stone), (0.0, HIGH / 2, (near + far) / 2))
        brick = look("brick", scale=1.5)
        side, top = DOOR[0] / 2 + 0.03, DOOR[1] + 0.05
        wide, high = 2.0 - side, top + 0.5
        for x in (-1.0, 1.0):
            middle = (x * (side + wide / 2), HIGH + high / 2, WALL)
            self.still(oo.Box((wide, high, 0.2), material="brick", appearance=brick), middle)
        self.still(oo.Box((2 * side, 0.5, 0.2), material="brick", appearance=brick), (0.0, HIGH + top + 0.25, WALL))
        self.platform = self.moving.attach(Platform(START, END))
        frame = oo.Box((BUTTON[0] + 0.3, 0.02, BUTTON[2] + 0.3), material="steel", appearance=look("steel", scale=1.0))
        self.still(frame, (PLATE.x, HIGH + 0.01, PLATE.z))
        self.button = self.moving.attach(Button(PLATE, self.platform.toggle))
        self.door = self.moving.attach(SwingDoor((-DOOR[0] / 2, HIGH, WALL)))
        self.player = self.moving.attach(Player((0.0, HIGH, 0.5)))
        self.seat: oo.Vec3 | None = None
        self.slipped, self.opened, self.crossed = 0.0, 0.0, False

    def before_step(self) -> None:
        """Over the button, onto the platform, off it at the other end, and through the door."""
        feet = self.player.feet
        there = self.platform.position > self.platform.way - 0.05
        aboard = feet.z < START.z + 0.5
        self.player.controls.move(forward=(not aboard or there or feet.z < END.z - 1.3) and feet.z > -17.5)
        seat = feet - self.platform.deck.position
        if aboard and not there and self.player.on_ground and self.platform.position > 1.0 and not self.crossed:
            self.seat = self.seat or seat
            self.slipped = max(self.slipped, (seat - self.seat).length)
        self.crossed = self.crossed or there
        self.opened = max(self.opened, abs(self.door.angle))

    def check(self) -> None:
        """One press, a safe crossing, an open door that is shut again, and somebody behind it."""
        feet = self.player.feet
        expect(self.button.presses == 1, f"the button was pressed once: {self.button.presses}")
        expect(
            self.crossed and self.slipped < 0.05, f"the platform carried its rider to within 5 cm: {self.slipped:.3f} m"
        )
        expect(self.opened > 0.6, f"the door was opened by {self.opened:.2f} rad")
        expect(abs(self.door.angle) < 0.15, f"and is shut again, to {self.door.angle:.2f} rad")
        expect(feet.z < WALL - 1.0 and abs(feet.y - HIGH) < 0.05, f"somebody went through: {feet}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Shuttle, arguments)


if __name__ == "__main__":
    main()
