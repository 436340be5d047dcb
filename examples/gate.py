"""A portcullis is raised, lets a boulder through, and is let down again.

Shows `Slider`, which lets a body move along one line without turning; stops at both ends of its way; and a `Servo`,
which drives it to a position at a limited speed and with a limited force, whatever the portcullis weighs.
"""

from __future__ import annotations

from collections.abc import Sequence

import osgode as oo
from osgode.examples.runner import ALONG_X, ALONG_Y, Example, Orbit, expect, look, run

WIDTH, HEIGHT, RAISED = 2.0, 2.4, 2.0
"""Of the portcullis, and how high it is raised, metres."""
WEIGHT = 240.0
"""kg"""
UP, DOWN = 0.4, 5.0
"""When it is raised and let down, seconds."""


class Gate(Example):
    """Two towers, the portcullis, the boulder."""

    SECONDS = 8.0
    MOMENTS = (3.4,)

    def build(self) -> None:
        """Ground, towers, portcullis, boulder."""
        self.orbit = Orbit(oo.Vec3(0.0, 2.0, 0.0), 7.9, yaw=0.55, pitch=0.2)
        self.ground("dirt", (0.9, 0.9, 0.9))
        brick = look("brick", scale=1.6)
        for side in (-1, 1):
            tower = oo.Box((1.1, 4.6, 1.2), material="brick", appearance=brick)
            self.still(tower, (side * (WIDTH / 2 + 0.62), 2.3, 0.0))
        self.still(oo.Box((WIDTH + 0.14, 1.0, 0.5), material="brick", appearance=brick), (0.0, 4.1, -0.35))
        self.portcullis = self.moving.attach(oo.Body(name="portcullis", position=(0.0, HEIGHT / 2 + 0.05, 0.1)))
        for k in range(7):
            self.bar((-WIDTH / 2 + 0.1 + k * 0.3, 0.0, 0.0), ALONG_Y, HEIGHT - 0.1)
        for k in range(4):
            self.bar((0.0, -HEIGHT / 2 + 0.45 + k * 0.6, 0.05), ALONG_X, WIDTH - 0.1)
        self.slider = oo.Slider(self.portcullis, axis=(0, 1, 0), stops=(0.0, RAISED + 0.1), name="portcullis")
        self.slider.servo = oo.Servo(target=0.0, max_speed=1.0, max_force=2 * WEIGHT * 9.81)
        stone = oo.Sphere(0.55, mass=300.0, material="concrete", appearance=look("plaster", (0.55, 0.52, 0.5)))
        self.boulder = self.body(stone, (0.1, 0.56, -5.0), name="boulder")
        self.boulder.linear_velocity = (0.0, 0.0, 1.6)
        self.boulder.angular_velocity = (1.6 / 0.55, 0.0, 0.0)
        self.show_joints(0.9)

    def bar(self, position: oo.Vec3Like, rotation: oo.Quat, length: float) -> None:
        """One bar of the portcullis."""
        iron = oo.Capsule(
            0.045, length - 0.09, mass=WEIGHT / 11, material="steel", appearance=look("steel", (0.4, 0.4, 0.45))
        )
        self.portcullis.attach(oo.Placeable(position=position, rotation=rotation)).attach(iron)

    def before_step(self) -> None:
        """Tell the servo where to go; it is left alone between."""
        servo = self.slider.servo
        if servo is not None and self.world.steps in (round(UP * 120), round(DOWN * 120)):
            servo.target = RAISED if self.world.time < DOWN - 0.1 else 0.0
        if self.world.steps == round((DOWN - 0.1) * 120):
            self.open = self.slider.position

    def check(self) -> None:
        """It was opened as far as asked for, the boulder is through, and the gate is shut again."""
        expect(self.world.time > DOWN, "the gate is raised and let down")
        expect(abs(self.open - RAISED) < 0.005, "the servo raises the portcullis to where it was told to")
        expect(self.boulder.position.z > 1.5, "the boulder rolls through the open gate")
        expect(abs(self.slider.position) < 0.005, "the portcullis is down again")
        expect(self.slider.error < 0.002, "it keeps to its line")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Gate, arguments)


if __name__ == "__main__":
    main()
