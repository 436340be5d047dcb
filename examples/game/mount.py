"""A post that holds weapons: to try them without anybody who walks about. A camera or a program can ride it and shoot.

A kinematic fork turns to where it is told to look; the cradle that holds the weapon slides on it against a spring.
"""

from __future__ import annotations

import math
from typing import ClassVar

import osgode as oo
from osgode.engine import ControllableObject
from osgode.examples.game.arsenal import Arsenal
from osgode.examples.game.shapes import ball, block, rod
from osgode.examples.game.weapon import Aim, Weapon
from osgode.examples.runner import painted

HEIGHT = 1.25
"""Of the fork's axis above the ground, metres."""
TURN_SPEED = 2.5
"""How fast it turns unless somebody says otherwise, rad/s."""
CRADLE_MASS = 16.0
"""kg."""
SPRING, DAMPER = 1.0e5, 2.2e3
"""Of the cradle, N/m and N s/m: a full recoil pushes it back by a hand's breadth or two."""

IRON, RED = painted(0.18, 0.19, 0.21, 0.5), painted(0.62, 0.12, 0.1, 0.5)


class Mount(ControllableObject):
    """A post with a fork, and an arsenal in the fork.

    Args:
        position: of its foot, metres in the world.
        yaw: 0 has it look along -Z, radians.
        turn_speed: how fast it turns, rad/s.
        name: for messages and paths.
    """

    EYE: ClassVar[oo.Pose] = oo.Pose(oo.Vec3(0.0, 0.42, 0.55))

    def __init__(
        self,
        position: oo.Vec3Like = (0.0, 0.0, 0.0),
        yaw: float = 0.0,
        *,
        turn_speed: float = TURN_SPEED,
        name: str = "mount",
    ) -> None:
        super().__init__(name=name)
        self.turn_speed = turn_speed
        turn, foot = oo.Quat.from_yaw_pitch_roll(yaw), oo.Vec3(*position)
        middle = foot + oo.Vec3(0.0, HEIGHT, 0.0)
        self.controls.yaw = yaw
        self.fork = self.attach(oo.Body(name=f"{name} fork", position=middle, rotation=turn, kinematic=True))
        self.fork.attach(oo.Leaf(_fork()))
        self.cradle = self.attach(oo.Body(name=f"{name} cradle", position=middle, rotation=turn))
        self.cradle.attach(oo.Placeable(position=(0.0, -0.06, 0.05))).attach(
            oo.Box((0.07, 0.03, 0.5), kind="player", mass=CRADLE_MASS, appearance=RED)
        )
        self.slide = oo.Slider(
            self.cradle,
            self.fork,
            axis=turn.rotate((0.0, 0.0, 1.0)),
            stops=(0.0, 0.0),
            stop_stiffness=SPRING,
            stop_damping=DAMPER,
            name=f"{name} slide",
        )
        self.arsenal = Arsenal(self.cradle)
        self._angles = [yaw, 0.0]
        post = self.attach(oo.PositionAttitudeTransform(position=foot))
        post.attach(oo.Leaf(_post()))

    def pick_up(self, weapon: Weapon) -> None:
        """Take a weapon."""
        self.arsenal.pick_up(weapon)

    def look_at(self, target: oo.Vec3Like) -> None:
        """Turn towards a point of the world from now on."""
        way = oo.Vec3(*target) - self.eye_pose().position
        self.controls.yaw = math.atan2(-way.x, -way.z)
        self.controls.pitch = math.asin(way.y / way.length)

    @property
    def aim(self) -> Aim:
        """Where it looks from, and the direction."""
        eye = self.eye_pose()
        return eye.position, eye.rotation.rotate((0.0, 0.0, -1.0))

    def control(self) -> None:
        """Turn, as fast as it can, to where it is told."""
        most = self.turn_speed * (0.0 if self.world is None else self.world.step_size)
        wanted = (self.controls.yaw, self.controls.pitch)
        self._angles = [
            old + min(max(math.remainder(new - old, math.tau), -most), most)
            for old, new in zip(self._angles, wanted, strict=True)
        ]
        self.fork.glide_to(self.fork.position, oo.Quat.from_yaw_pitch_roll(*self._angles))


def _fork() -> list[oo.Drawable]:
    return [
        rod(0.03, (-0.13, 0.0, 0.0), (-0.13, -0.2, 0.0), IRON),
        rod(0.03, (0.13, 0.0, 0.0), (0.13, -0.2, 0.0), IRON),
        rod(0.03, (-0.13, -0.2, 0.0), (0.13, -0.2, 0.0), IRON),
        ball(0.045, (-0.13, 0.0, 0.0), RED),
        ball(0.045, (0.13, 0.0, 0.0), RED),
        block((0.26, 0.02, 0.3), (0.0, -0.1, 0.05), IRON),
    ]


def _post() -> list[oo.Drawable]:
    legs = [(0.38 * math.sin(a), 0.0, 0.38 * math.cos(a)) for a in (0.0, math.tau / 3, 2 * math.tau / 3)]
    return [
        rod(0.045, (0.0, 0.35, 0.0), (0.0, HEIGHT - 0.2, 0.0), IRON),
        ball(0.07, (0.0, HEIGHT - 0.2, 0.0), IRON),
        *(rod(0.025, (0.0, 0.45, 0.0), leg, IRON) for leg in legs),
        *(ball(0.04, leg, RED) for leg in legs),
    ]
