"""A robot's arm takes a crate from one table and puts it onto another.

Shows `Servo`: three hinges are driven to angles at a limited speed and with a limited torque, and hold them. And a
`Fixed` joint as a gripper: made when the hand is at the crate, released when the crate is where it belongs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import ALONG_Y, Example, Orbit, expect, look, painted, run

UPPER, LOWER, SHOULDER = 0.9, 0.9, 0.8
"""Lengths of the two parts of the arm, and how high the shoulder is, metres."""
EDGE, TABLE, REACH = 0.3, 0.6, 1.2
"""Of the crate; how high the tables are, and how far from the robot's middle."""
GRIP = TABLE + EDGE + 0.06
"""How high the wrist is when the hand holds a crate that stands on a table."""
SCRIPT = (
    (0.2, 0.0, GRIP),
    (1.6, "grip", 0.0),
    (1.7, 0.0, GRIP + 0.4),
    (2.8, 1.57, GRIP + 0.4),
    (4.6, 1.57, GRIP),
    (6.0, "let go", 0.0),
    (6.1, 1.57, GRIP + 0.4),
)
"""When to go where: seconds, angle of the column, height of the wrist; or what the hand does."""


class Arm(Example):
    """Robot, tables, crate."""

    SECONDS = 7.5
    MOMENTS = (3.4,)
    WORLD: ClassVar = {"iterations": 80}

    def build(self) -> None:
        """Column, upper arm, lower arm with the hand; the arm starts stretched out along x."""
        self.orbit = Orbit(oo.Vec3(0.3, 0.8, -0.3), 3.9, yaw=-0.35, pitch=0.3)
        self.ground()
        for way in ((REACH, 0.0), (0.0, -REACH)):
            top = oo.Box((0.6, TABLE, 0.6), material="wood", appearance=look("planks", scale=0.8))
            self.still(top, (way[0], TABLE / 2, way[1]))
        box = oo.Box((EDGE, EDGE, EDGE), mass=8.0, material="wood", appearance=look("crate"))
        self.crate = self.body(box, (REACH, TABLE + EDGE / 2 + 0.001, 0.0), name="crate")

        steel, orange = painted(0.25, 0.28, 0.32), painted(0.9, 0.4, 0.04)
        column = self.body(oo.Cylinder(0.16, SHOULDER, mass=40.0, appearance=steel), (0, SHOULDER / 2, 0), ALONG_Y)
        ends = [oo.Vec3(0.0, SHOULDER, 0.0), oo.Vec3(UPPER, SHOULDER, 0.0), oo.Vec3(UPPER + LOWER, SHOULDER, 0.0)]
        self.arms = [self.part(start, end, orange) for start, end in pairwise(ends)]
        hand = self.arms[1].attach(oo.Placeable(position=(0.0, 0.0, LOWER / 2)))
        hand.attach(oo.Sphere(0.07, mass=1.0, appearance=steel))
        self.joints = [
            oo.Hinge(column, anchor=(0, 0, 0), axis=(0, 1, 0), name="column"),
            oo.Hinge(self.arms[0], column, anchor=ends[0], axis=(0, 0, 1), name="shoulder"),
            oo.Hinge(self.arms[1], self.arms[0], anchor=ends[1], axis=(0, 0, 1), name="elbow"),
        ]
        for joint in self.joints:
            joint.servo = oo.Servo(max_speed=1.6, max_force=1500.0, frequency=12.0)
        self.go(0.0, GRIP + 0.4)
        self.gripper: oo.Fixed | None = None
        self.missed = math.inf
        self.show_joints(0.55)

    def part(self, start: oo.Vec3, end: oo.Vec3, look_of_it: oo.Appearance) -> oo.Body:
        """A part of the arm."""
        shape = oo.Capsule(0.07, start.distance(end), mass=6.0, appearance=look_of_it)
        return self.body(shape, (start + end) / 2, oo.Quat.between((0, 0, 1), end - start), name="arm", collides=False)

    def go(self, turn: float, height: float) -> None:
        """Tell the servos to bring the wrist above a table, by the law of cosines."""
        up = height - SHOULDER
        far = math.hypot(REACH, up)
        lift = math.acos((far**2 + UPPER**2 - LOWER**2) / (2 * far * UPPER))
        bend = math.acos((far**2 - UPPER**2 - LOWER**2) / (2 * UPPER * LOWER))
        for joint, angle in zip(self.joints, (turn, math.atan2(up, REACH) + lift, -bend), strict=True):
            if joint.servo is not None:
                joint.servo.target = angle

    def wrist(self) -> oo.Vec3:
        """Where the hand is."""
        return self.arms[1].local_to_world((0.0, 0.0, LOWER / 2))

    def before_step(self) -> None:
        """Follow the script."""
        for when, what, height in SCRIPT:
            if self.world.steps != round(when / self.world.step_size):
                continue
            if what == "grip":
                self.missed = self.wrist().distance((REACH, GRIP, 0.0))
                self.gripper = oo.Fixed(self.crate, self.arms[1], anchor=self.wrist(), name="gripper")
            elif what == "let go" and self.gripper is not None:
                self.gripper.release()
            elif not isinstance(what, str):
                self.go(what, height)

    def check(self) -> None:
        """The hand was where it was sent to, and the crate stands on the other table."""
        expect(self.missed < 0.01, "the servos bring the hand to the crate")
        expect(self.crate.position.distance((0.0, TABLE + EDGE / 2, -REACH)) < 0.03, "the crate is on the other table")
        expect(self.crate.linear_velocity.length < 0.01, "and stands there")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Arm, arguments)


if __name__ == "__main__":
    main()
