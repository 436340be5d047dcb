"""What the game writes over the picture."""

from __future__ import annotations

from collections.abc import Sequence

from osgode import Group
from osgode.engine import HudBox, HudText, HudWindow

CONTROLS = (
    ("w a s d or arrows", "walk; throttle, brake, steer"),
    ("space", "hold to charge a jump, let go to jump"),
    ("mouse", "look around"),
    ("left, right button", "shoot: the longer you hold, the harder"),
    ("1 2 3", "gun, rocket launcher, flail"),
    ("e", "get into a car, get out"),
    ("v", "first or third person"),
    ("r", "set the car on its wheels"),
    ("p, period", "pause, single step"),
    ("minus, equals", "slower, faster"),
    ("f3, f4", "what the physics sees, what you look at"),
    ("tab, f11", "let the mouse go, full screen"),
    ("escape", "quit"),
)
"""Keys, and what they do."""
HINTS = """\
The constructor gun lies on the table in the house: go through the door.
The rocket launcher waits behind the platform: up the stairs, over the
beam between the pendulums, and press the red button.
The flail lies at the far end of the hanging bridge.
The red car beside the track is yours. The blue one knows its way."""
GOOD, BAD = (0.35, 0.85, 0.4), (0.95, 0.2, 0.12)
"""Colours of a wheel that is whole, and of one that is gone."""
BAR = 120.0
"""Width of the bar that shows a charge."""


class GameHud:
    """Its elements, below a node of the overlay.

    Args:
        parent: the overlay.
    """

    def __init__(self, parent: Group) -> None:
        self.rate = parent.attach(HudText("", "top right", x=-14.0, y=10.0, size=16))
        self.speed = parent.attach(HudText("", "bottom left", x=18.0, y=-14.0, size=26))
        self.weapon = parent.attach(HudText("", "bottom right", x=-18.0, y=-14.0, size=22))
        self.cross = parent.attach(HudText("+", "centre", size=24, colour=(1.0, 1.0, 1.0, 0.75)))
        self.charge = parent.attach(HudBox("centre", y=26.0, width=BAR, height=6.0, colour=(0.0, 0.0, 0.0, 0.45)))
        self.charged = self.charge.attach(HudBox("left", width=1.0, height=6.0, colour=(1.0, 0.75, 0.2, 0.95)))
        self.wheels = parent.attach(
            HudBox("bottom left", x=18.0, y=-56.0, width=64.0, height=92.0, colour=(0.0, 0.0, 0.0, 0.4))
        )
        self.each_wheel = [
            self.wheels.attach(HudBox(anchor, x=x, y=y, width=14.0, height=26.0))
            for anchor, x, y in (
                ("top left", 8.0, 8.0),
                ("top right", -8.0, 8.0),
                ("bottom left", 8.0, -8.0),
                ("bottom right", -8.0, -8.0),
            )
        ]
        self.pace = parent.attach(HudText("", "top", y=10.0, size=20, colour=(1.0, 0.9, 0.4, 1.0)))
        parent.attach(HudText("f1 controls   f2 hints", "top left", x=14.0, y=10.0, size=14))
        self.controls = parent.attach(HudWindow("Controls", width=560.0, height=304.0, visible=False, name="controls"))
        for column, x in enumerate((0.0, 190.0)):
            words = "\n".join(line[column] for line in CONTROLS)
            self.controls.attach(HudText(words, x=x, size=16, shadow=False))
        self.hints = parent.attach(HudWindow("Hints", HINTS, width=660.0, height=170.0, visible=False, name="hints"))

    def toggle(self, window: HudWindow) -> None:
        """Open or close one of the windows; there is room for one."""
        window.visible = not window.visible
        for other in (self.controls, self.hints):
            other.visible = other.visible and other is window

    def show(
        self,
        *,
        frame_rate: float,
        speed: float,
        pace: str,
        weapon: str = "",
        charge: float = 0.0,
        damage: Sequence[float] = (),
    ) -> None:
        """Say it all.

        Args:
            frame_rate: frames a second.
            speed: of what is controlled, m/s.
            pace: of the time, if that is unusual.
            weapon: in hand.
            charge: of its shot, 0 to 1.
            damage: of the wheels, 0 to 1, if it is a car.
        """
        self.rate.text = f"{frame_rate:.0f} fps"
        self.speed.text = f"{3.6 * speed:.0f} km/h" if damage else f"{speed:.1f} m/s"
        self.weapon.text, self.pace.text = weapon, pace
        self.charge.visible = charge > 0.0
        if charge > 0.0:
            self.charged.resize(BAR * min(charge, 1.0), 6.0)
        self.wheels.visible = bool(damage)
        for box, hurt in zip(self.each_wheel, damage, strict=False):
            share = min(max(hurt, 0.0), 1.0)
            red, green, blue = (a + (b - a) * share for a, b in zip(GOOD, BAD, strict=True))
            box.colour = (red, green, blue, 0.95)
