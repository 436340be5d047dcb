"""The flail: a handle, a chain of capsules joined by universal joints, and a ball full of spikes.

A chain that swings a ball is hard for a solver that iterates, and for one whose bodies go straight on within a step: it
stretches. What keeps it together here, each measured:

- The ball weighs less than the chain, and turns about its own middle, where the last joint is.
- Links have more inertia than their shapes say, so that none whirls: what turns at w for a step of dt leaves its joint
  by half its length times (w dt)^2 / 2.
- The joints bend with friction, and what is faster than any arm swings it is braked.
- The links don't touch one another.

The World wants `ITERATIONS` of its quick solver.
"""

from __future__ import annotations

from typing import ClassVar

import osgode as oo
from osgode.examples.game.shapes import ball, lathed, placed, rod
from osgode.examples.game.weapon import Aim, Weapon
from osgode.examples.runner import look, painted

ITERATIONS = 30
"""Of the World's solver, for a chain that stretches by less than 5 mm."""
LINKS = 6
"""Of the chain."""
LINK_LENGTH, LINK_RADIUS, LINK_MASS = 0.1, 0.016, 0.5
"""From joint to joint and thick, metres; kg."""
BALL_RADIUS, BALL_MASS = 0.1, 1.6
"""Metres; kg."""
HANDLE_LENGTH, HANDLE_RADIUS, HANDLE_MASS = 0.56, 0.02, 2.0
"""Metres; kg."""
GYRATION = 0.25
"""The moment of inertia of a link about every axis is that of its mass at this distance, metres."""
JOINT_FRICTION, JOINT_GRIP = 1.4, 100.0
"""Of the bending of each joint: N m s/rad, and at most so many N m."""
TURN_DAMPING = 0.15
"""The part of its turning that a link or the ball loses in each step."""
FASTEST, BRAKE = 8.0, 0.05
"""What is faster, m/s, loses this part of its speed in each step."""
OTHERS = ("default", "player", "vehicle", "shot")
"""The kinds of objects that it hits: everything but itself."""
THRUST = 14.0
"""The impulse between hand and ball of a fully charged thrust, N s."""


class Flail(Weapon):
    """A handle with a ball on a chain; it hits by being swung. A button thrusts the ball forward.

    Args:
        position: of the handle's middle, metres in the world.
        yaw: 0 has it point along -Z, radians.
        name: for messages and paths.
    """

    SLOT = 3
    TITLE = "flail"
    GRIP: ClassVar[oo.Pose] = oo.Pose(oo.Vec3(0.0, 0.0, 0.14))
    FULL_CHARGE = 1.0

    def __init__(self, position: oo.Vec3Like = (0.0, 0.0, 0.0), yaw: float = 0.0, *, name: str = "flail") -> None:
        super().__init__(name=name)
        turn = oo.Quat.from_yaw_pitch_roll(yaw)
        start, ahead = oo.Vec3(*position), turn.rotate((0.0, 0.0, -1.0))
        steel = look("steel", (0.6, 0.6, 0.64), shine=0.7)
        handle = self.attach(oo.Body(name=f"{name} handle", position=start, rotation=turn))
        handle.attach(oo.Placeable()).attach(
            oo.Capsule(
                HANDLE_RADIUS,
                HANDLE_LENGTH - 2 * HANDLE_RADIUS,
                material="wood",
                kind="weapon",
                collides_with=OTHERS,
                mass=HANDLE_MASS,
                shown=_handle(),
            )
        )
        self.links: list[oo.Body] = []
        self.knots: list[oo.Universal] = []
        """The joints from the handle to the ball."""
        before, knot = handle, start + ahead * (HANDLE_LENGTH / 2)
        for k in range(LINKS):
            link = oo.Body(name=f"{name} link {k}", position=knot + ahead * (LINK_LENGTH / 2), rotation=turn)
            link.attach(oo.Placeable()).attach(
                oo.Capsule(
                    LINK_RADIUS,
                    LINK_LENGTH - 2 * LINK_RADIUS,
                    material="steel",
                    kind="weapon",
                    collides_with=OTHERS,
                    shown=_link(steel, k),
                )
            )
            link.fixed_mass = oo.Mass(LINK_MASS, oo.Vec3(0.0, 0.0, 0.0), _round(LINK_MASS * GYRATION**2))
            self._join(self.attach(link), before, knot, turn, k)
            self.links.append(link)
            before, knot = link, knot + ahead * LINK_LENGTH
        self.ball = oo.Body(name=f"{name} ball", position=knot, rotation=turn)
        self.ball.attach(oo.Placeable()).attach(
            oo.Sphere(
                BALL_RADIUS, material="steel", kind="weapon", collides_with=OTHERS, mass=BALL_MASS, shown=_spiked(steel)
            )
        )
        self._join(self.attach(self.ball), before, knot, turn, LINKS)

    def _join(self, body: oo.Body, before: oo.Body, knot: oo.Vec3, turn: oo.Quat, number: int) -> None:
        body.angular_damping = TURN_DAMPING
        body.linear_damping, body.linear_damping_threshold = BRAKE, FASTEST
        joint = oo.Universal(
            body,
            before,
            anchor=knot,
            axis1=turn.rotate((1.0, 0.0, 0.0)),
            axis2=turn.rotate((0.0, 1.0, 0.0)),
            name=f"knot {number}",
        )
        # A motor that wants no motion, and is as soft as this, is a damper: its torque is the speed divided by its CFM.
        joint.motor_max_force1 = joint.motor_max_force2 = JOINT_GRIP
        joint.cfm1 = joint.cfm2 = 1.0 / JOINT_FRICTION
        self.knots.append(joint)

    @property
    def stretch(self) -> float:
        """By how much the joint that is off most is off, metres."""
        return max(knot.error for knot in self.knots)

    def fire(self, button: str, charge: float, aim: Aim) -> None:  # noqa: ARG002 - all buttons do the same
        """Thrust the ball to where the camera looks; the hand is pushed back as much."""
        line = (self.target(aim) - self.ball.position).normalized() * (THRUST * charge)
        self.ball.apply_impulse(line)
        self.recoil(-line)


def _round(moment: float) -> tuple[oo.Vec3, oo.Vec3, oo.Vec3]:
    return (oo.Vec3(moment, 0.0, 0.0), oo.Vec3(0.0, moment, 0.0), oo.Vec3(0.0, 0.0, moment))


def _handle() -> list[oo.Drawable]:
    """A staff that is bound with leather where it is held, between two ferrules."""
    wood = look("planks", (0.75, 0.55, 0.4), scale=0.4, shine=0.2)
    leather, iron = painted(0.24, 0.13, 0.08, 0.15), painted(0.3, 0.31, 0.34, 0.7)
    half, r = HANDLE_LENGTH / 2, HANDLE_RADIUS
    rings = [rod(r * 1.22, (0.0, 0.0, z), (0.0, 0.0, z - 0.012), leather) for z in (0.22, 0.195, 0.17, 0.145, 0.12)]
    return [
        rod(r, (0.0, 0.0, half - 0.03), (0.0, 0.0, -half + 0.05), wood),
        rod(r * 1.15, (0.0, 0.0, 0.235), (0.0, 0.0, 0.09), leather),
        *rings,
        placed(
            lathed([(0.0, 0.03), (0.018, 0.026), (0.03, 0.01), (0.03, -0.01), (0.018, -0.025)], iron),
            (0, 0, half - 0.03),
        ),
        placed(
            lathed([(0.0, 0.06), (0.027, 0.06), (0.029, 0.0), (0.016, -0.02), (0.0, -0.02)], iron), (0, 0, 0.01 - half)
        ),
    ]


def _link(steel: oo.Appearance, number: int) -> list[oo.Drawable]:
    """An oblong ring of four rods with round corners; every other one stands across."""
    wide, half, r = 0.021, LINK_LENGTH / 2, 0.0085
    side = oo.Vec3(wide, 0.0, 0.0) if number % 2 else oo.Vec3(0.0, wide, 0.0)
    back, front = oo.Vec3(0.0, 0.0, half - 0.008), oo.Vec3(0.0, 0.0, 0.008 - half)
    end = oo.Vec3(0.0, 0.0, 0.02)
    corners = [back, back - end + side, front + end + side, front, front + end - side, back - end - side]
    return [rod(r, a, b, steel) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)] + [
        ball(r, corner, steel) for corner in corners
    ]


def _spiked(steel: oo.Appearance) -> list[oo.Drawable]:
    """A ball with spikes along the axes and to the corners of a cube; the chain comes out of it behind."""
    core = 0.078
    iron = painted(0.2, 0.2, 0.23, 0.6)
    spike = lathed([(0.0, 0.055), (0.024, 0.0), (0.0, -0.002)], steel, 12)
    parts = [ball(core, (0.0, 0.0, 0.0), iron)]
    ways = [
        oo.Vec3(x, y, z)
        for x in (-1, 0, 1)
        for y in (-1, 0, 1)
        for z in (-1, 0, 1)
        if abs(x) + abs(y) + abs(z) in (1, 3)
    ]
    for way in ways:
        out = way.normalized()
        if out.z < 0.9:
            parts.append(placed(spike, out * (core - 0.006), oo.Quat.between((0.0, 0.0, 1.0), out)))
    return parts
