"""A pendulum that nobody can stop, over a beam that somebody has to cross.

Rod and bob are two capsules of one body, on a motorised hinge to the static world. The motor goes as fast as a real
pendulum would at each angle, and turns back at the highest angle on either side.
"""

from __future__ import annotations

import math

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.runner import painted

LENGTH = 3.0
"""From the hinge to the middle of the bob, metres."""
ROD, BOB, WIDE = 0.05, 0.28, 0.5
"""Radii of rod and bob, and the length of the bob between its round ends, metres."""
MASS = 60.0
"""Of the bob, kg; the rod has a tenth of it."""
AMPLITUDE = math.radians(50.0)
"""The angle at which it turns back, radians."""
PERIOD = 3.2
"""Of a swing to and fro, seconds."""
STRENGTH = 1e6
"""The torque that it may use, N m: no body withstands it."""
TURNING = 0.12
"""The part of its top speed that it has left where it turns back."""


class Pendulum(CompositeObject):
    """Swings across the axis that it is given.

    Args:
        position: of its hinge, metres in the world.
        yaw: 0 lets it swing along X, radians.
        phase: where it begins: 0 hanging straight and going to +X, 1 a whole period later.
        name: for messages and paths.
    """

    def __init__(
        self, position: oo.Vec3Like = (0.0, 0.0, 0.0), yaw: float = 0.0, *, phase: float = 0.0, name: str = "pendulum"
    ) -> None:
        super().__init__(name=name)
        angle = AMPLITUDE * math.sin(math.tau * phase)
        self.way = 1.0 if math.cos(math.tau * phase) >= 0.0 else -1.0
        """Where it goes: 1 to positive angles, -1 back."""
        self.turns = 0
        """How often it has turned back."""
        turn = oo.Quat.from_yaw_pitch_roll(yaw)
        hinge = oo.Vec3(*position)
        straight = hinge - (0.0, LENGTH, 0.0)
        self.arm = self.attach(oo.Body(name=f"{name} arm", position=straight, rotation=turn, auto_disable=False))
        upright = oo.Quat.between((0, 0, 1), (0, 1, 0))
        steel, red = painted(0.5, 0.52, 0.56, 0.6), painted(0.72, 0.12, 0.1, 0.4)
        rod = oo.Capsule(ROD, LENGTH - BOB, material="steel", mass=MASS / 10, appearance=steel)
        self.arm.attach(oo.Placeable(position=(0.0, (LENGTH + BOB) / 2 - ROD, 0.0), rotation=upright)).attach(rod)
        bob = oo.Capsule(BOB, WIDE, material="steel", mass=MASS, appearance=red)
        self.arm.attach(oo.Placeable()).attach(bob)
        self.hinge = oo.Hinge(self.arm, anchor=hinge, axis=turn.rotate((0, 0, 1)), name=name)
        begin = oo.Quat.from_axis_angle(turn.rotate((0, 0, 1)), angle)
        self.place(oo.Pose(hinge + begin.rotate((0.0, -LENGTH, 0.0)), begin * turn))

    @property
    def angle(self) -> float:
        """From hanging straight, positive to where +X is turned by its yaw, radians."""
        return self.hinge.angle

    def entered(self) -> None:
        """Begin to swing."""
        self.drive()
        self.schedule(_drive)

    def drive(self) -> None:
        """Set the motor for the present angle."""
        angle = self.angle
        if angle * self.way >= AMPLITUDE:
            self.way = -self.way
            self.turns += 1
        top = math.tau / PERIOD * AMPLITUDE
        share = math.sqrt(max(1.0 - (angle / AMPLITUDE) ** 2, 0.0))
        self.hinge.motor(self.way * top * max(share, TURNING), STRENGTH)


def _drive(pendulum: Pendulum) -> bool:
    pendulum.drive()
    return True
