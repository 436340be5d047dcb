"""The constructor gun: it shoots iron balls and wooden cubes, the harder the longer it is charged.

Its shots are ordinary bodies that are swept along their way; half of what they get goes back into the hand.
"""

from __future__ import annotations

import math
from typing import ClassVar

import osgode as oo
from osgode.examples.game.shapes import ball, block, lathed, placed, rod
from osgode.examples.game.shots import Shots
from osgode.examples.game.weapon import Aim, Weapon
from osgode.examples.runner import look, painted

FULL_IMPULSE = 1000.0
"""Of a fully charged shot, N s."""
RECOIL = 0.5
"""The part of it that goes back into the hand."""
BALL_MASS, BALL_RADIUS = 10.0, 0.067
"""kg; metres, by the density of iron."""
CUBE_MASS, CUBE_EDGE = 5.0, 0.2
"""kg; metres, by that of beech."""
MASS = 4.0
"""Of the gun, kg."""
SIZE = (0.11, 0.16, 0.62)
"""Of the box that collides, metres."""
MUZZLE = oo.Vec3(0.0, 0.03, -0.46)
"""The middle of its mouth in its own axes, metres."""

IRON = oo.Appearance((0.27, 0.28, 0.3, 1.0), shininess=0.75)
DARK, PALE = painted(0.13, 0.14, 0.16, 0.5), painted(0.82, 0.83, 0.8, 0.5)
ORANGE = painted(0.95, 0.45, 0.06, 0.5)
GLOW = oo.Appearance((0.35, 0.85, 1.0, 1.0), unlit=True)


class ConstructorGun(Weapon):
    """A gun with two triggers: "left" shoots balls, "right" cubes.

    Args:
        position: of its middle, metres in the world.
        yaw: 0 has it point along -Z, radians.
        name: for messages and paths.
    """

    SLOT = 1
    TITLE = "constructor gun"
    GRIP: ClassVar[oo.Pose] = oo.Pose(oo.Vec3(0.0, -0.09, 0.06))
    FULL_CHARGE = 1.5

    def __init__(
        self, position: oo.Vec3Like = (0.0, 0.0, 0.0), yaw: float = 0.0, *, name: str = "constructor gun"
    ) -> None:
        super().__init__(name=name)
        body = self.attach(oo.Body(name=f"{name} body", position=position, rotation=oo.Quat.from_yaw_pitch_roll(yaw)))
        body.attach(oo.Placeable()).attach(oo.Box(SIZE, material="steel", kind="weapon", mass=MASS, shown=_model()))
        self.shots = Shots()
        """What it has shot, as long as that is there."""

    def fire(self, button: str, charge: float, aim: Aim) -> None:
        """Shoot a ball or a cube along the aiming ray, with `FULL_IMPULSE` times the charge."""
        space, hand = self.space, self.hand
        if space is None or hand is None:
            return
        iron = button == "left"
        mass, size = (BALL_MASS, BALL_RADIUS) if iron else (CUBE_MASS, CUBE_EDGE / 2 * math.sqrt(3.0))
        line = self.line_of_fire(aim, MUZZLE, size)
        forward = line.rotation.rotate((0.0, 0.0, -1.0))
        impulse = FULL_IMPULSE * charge
        # What is carried along flies on, but never aside: shots go where the camera looks, whoever runs.
        along = max(hand.linear_velocity.dot(forward), 0.0)
        shot = oo.Body(
            name="ball" if iron else "cube",
            position=line.position,
            rotation=line.rotation,
            linear_velocity=forward * (impulse / mass + along),
        )
        shape = (
            oo.Sphere(BALL_RADIUS, material="steel", kind="shot", mass=mass, appearance=IRON)
            if iron
            else oo.Box((CUBE_EDGE,) * 3, material="wood", kind="shot", mass=mass, appearance=look("crate"))
        )
        shot.attach(oo.Placeable()).attach(shape)
        self.shots.send(space, shot, self.own)
        self.recoil(forward * (-RECOIL * impulse))


def _model() -> list[oo.Drawable]:
    """A casing, a barrel between four rails, a grip with its guard, and a coil that glows."""
    top = MUZZLE.y
    parts = [
        block((0.085, 0.12, 0.3), (0.0, 0.01, 0.1), PALE),
        block((0.089, 0.035, 0.24), (0.0, 0.015, 0.1), ORANGE),
        block((0.05, 0.025, 0.2), (0.0, 0.08, 0.1), DARK),
        block((0.03, 0.02, 0.03), (0.0, 0.1, 0.18), DARK),
        block((0.045, 0.14, 0.06), (0.0, -0.1, 0.08), DARK, oo.Quat.from_axis_angle((1, 0, 0), -0.22)),
        block((0.04, 0.015, 0.11), (0.0, -0.105, -0.02), DARK),
        block((0.03, 0.04, 0.012), (0.0, -0.065, 0.0), ORANGE),
        block((0.06, 0.1, 0.16), (0.0, -0.005, 0.31), DARK),
        block((0.065, 0.13, 0.025), (0.0, -0.015, 0.4), PALE),
        placed(
            lathed(
                [(0.0, 0.0), (0.05, 0.0), (0.05, -0.24), (0.062, -0.25), (0.062, -0.3), (0.042, -0.3), (0.035, -0.2)],
                DARK,
            ),
            (0.0, top, -0.04),
        ),
    ]
    parts += [
        placed(lathed([(0.054, 0.006), (0.06, 0.006), (0.06, -0.006), (0.054, -0.006)], GLOW), (0.0, top, z))
        for z in (-0.12, -0.165, -0.21)
    ]
    for k in range(4):
        turn = oo.Quat.from_axis_angle((0.0, 0.0, 1.0), math.pi / 4 + k * math.pi / 2)
        side, wide, narrow = (turn.rotate((r, 0.0, 0.0)) for r in (0.066, 0.1, 0.085))
        middle = oo.Vec3(0.0, top, 0.0)
        parts += [
            rod(0.009, middle + side + (0.0, 0.0, -0.05), middle + wide + (0.0, 0.0, -0.36), ORANGE),
            rod(0.009, middle + wide + (0.0, 0.0, -0.36), middle + narrow + (0.0, 0.0, MUZZLE.z), ORANGE),
            ball(0.012, middle + wide + (0.0, 0.0, -0.36), DARK),
            ball(0.013, middle + narrow + (0.0, 0.0, MUZZLE.z), GLOW),
        ]
    return parts
