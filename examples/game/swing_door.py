"""A door that is pushed open by whoever walks into it, and falls shut behind.

It is a box on a hinge to the static world, with stops on both sides; a weak servo draws it shut.
"""

from __future__ import annotations

import math

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.runner import look

SIZE = (0.94, 2.04, 0.06)
"""Width, height and thickness, metres."""
MASS = 22.0
"""kg."""
OPEN = math.radians(105.0)
"""How far it goes to either side, radians."""
CLOSER = 14.0
"""The torque with which it is drawn shut, N m."""
SLOW = 1.2
"""How fast it falls shut, rad/s."""


class SwingDoor(CompositeObject):
    """A leaf on hinges.

    Args:
        position: of the foot of its hinges, metres in the world.
        yaw: 0 has it stretch from there along +X, radians.
        name: for messages and paths.
    """

    def __init__(self, position: oo.Vec3Like = (0.0, 0.0, 0.0), yaw: float = 0.0, *, name: str = "door") -> None:
        super().__init__(name=name)
        width, height, thick = SIZE
        turn = oo.Quat.from_yaw_pitch_roll(yaw)
        foot = oo.Vec3(*position)
        self.leaf = self.attach(
            oo.Body(
                name=f"{name} leaf",
                position=foot + turn.rotate((width / 2, height / 2 + 0.01, 0.0)),
                rotation=turn,
            )
        )
        wood = look("planks", (0.95, 0.8, 0.62), scale=1.1)
        self.leaf.attach(oo.Placeable()).attach(oo.Box(SIZE, material="wood", mass=MASS, appearance=wood))
        for side in (-1, 1):
            knob = oo.Placeable(position=(width / 2 - 0.09, -0.05, side * (thick / 2 + 0.035)))
            self.leaf.attach(knob).attach(oo.Sphere(0.035, material="steel", mass=0.2))
        self.hinge = oo.Hinge(
            self.leaf, anchor=foot, axis=(0.0, 1.0, 0.0), stops=(-OPEN, OPEN), stop_bounce=0.1, name=name
        )
        self.hinge.servo = oo.Servo(target=0.0, max_speed=SLOW, max_force=CLOSER, frequency=4.0)

    @property
    def angle(self) -> float:
        """How far it is open, radians; 0 is shut."""
        return self.hinge.angle
