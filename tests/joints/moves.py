"""Motions that each kind of joint allows, from which its readings follow by geometry alone.

A motion carries the world at rest to where it is now. Body 2 rides along with ``ride``, body 1 with ``ride * allowed``
(for a `Hinge2`, whose angles are those of body 2, the other way round). Both are functions of the time.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import osgode as oo

Motion = Callable[[float], oo.Pose]
STILL = oo.Pose()
POINT = oo.Vec3(0.3, -0.7, 1.1)
E1 = oo.Vec3(1, 2, -2) / 3
E2 = oo.Vec3(2, 1, 2) / 3
E3 = oo.Vec3(-2, 2, 1) / 3
OBLIQUE = (E1 * 0.4 + E2).normalized()
"""No right angle to E1."""
END = oo.Vec3(-1.2, 0.4, 0.9)
IN_PLANE = POINT + E2 * 1.5 - E3 * 0.4
"""Beside POINT in the plane across E1."""
TICK = 1e-5


def turning(angle: float, axis: oo.Vec3Like, about: oo.Vec3 = POINT) -> oo.Pose:
    rotation = oo.Quat.from_axis_angle(axis, angle)
    return oo.Pose(about - rotation.rotate(about), rotation)


def shifting(way: oo.Vec3Like) -> oo.Pose:
    return oo.Pose(oo.Vec3(*way), oo.Quat(1.0, 0.0, 0.0, 0.0))


def ride(t: float) -> oo.Pose:
    """Moving and turning all the time, far from where everything was at rest."""
    turn = oo.Quat.from_axis_angle((1, 0.3, -0.5), 0.7 * t) * oo.Quat.from_axis_angle((0.2, 1, -0.7), 2.1 - 1.3 * t)
    return oo.Pose(oo.Vec3(4 - 2 * t, -1 + t, 2 + 0.5 * t * t), turn)


def velocity(motion: Motion, pose: oo.Pose, t: float = 0.0) -> tuple[oo.Vec3, oo.Vec3]:
    """Linear velocity of the origin, and angular velocity, of what had ``pose`` at rest, by central differences."""
    before, after = motion(t - TICK) * pose, motion(t + TICK) * pose
    step = after.rotation * before.rotation.conjugate()
    sign = 1.0 if step.w > 0 else -1.0
    return (after.position - before.position) / (2 * TICK), oo.Vec3(*step[1:]) * (sign * 2 / (2 * TICK))


def move(body: oo.Body, rest: oo.Pose, motion: Motion, t: float = 0.0) -> None:
    """Put a body where the motion has it at a time, with the velocities that it has there."""
    pose = motion(t) * rest
    body.rotation = pose.rotation
    body.position = pose.position
    body.linear_velocity, body.angular_velocity = velocity(motion, rest, t)


@dataclass(frozen=True)
class Case:
    """A kind of joint, its arguments, and what it lets the bodies do.

    Args:
        cls: the kind.
        where: its anchors and axes.
        allowed: the motion of the one body against the other, from the coordinates.
        coordinates: the names of what it reads, as "angle", and of their rates.
        wheel: whether it is body 2 that makes the motion.
        two: whether it needs two bodies.
        points, axes: who carries each anchor and axis: 1, 2, or 0 for the world.
    """

    name: str
    cls: Any
    where: dict[str, Any]
    allowed: Callable[..., oo.Pose]
    coordinates: Sequence[tuple[str, str]] = ()
    wheel: bool = False
    two: bool = False
    carried: dict[str, int] = field(default_factory=dict)
    limits: tuple[float, ...] = (3.0, 3.0, 3.0)

    def __str__(self) -> str:
        return self.name

    def make(self, body1: oo.Body, body2: oo.Body | None, **fields: Any) -> Any:
        return self.cls(body1, body2, **self.where, **fields)


ANGLE = ("angle", "angle_rate")
POSITION = ("position", "position_rate")
ANGLES = [("angle1", "angle_rate1"), ("angle2", "angle_rate2"), ("angle3", "angle_rate3")]
HALF = math.pi / 2 - 0.2

CASES = [
    Case(
        "Ball",
        oo.Ball,
        {"anchor": POINT},
        lambda a, b, c: turning(a, (0.5, -1, 0.25)) * turning(b, E2) * turning(c, E1),
        carried={"anchor": 1, "anchor2": 2},
    ),
    Case(
        "Hinge",
        oo.Hinge,
        {"anchor": POINT, "axis": E1 * 3},
        lambda a, b, c: turning(a, E1),
        [ANGLE],
        carried={"anchor": 1, "anchor2": 2, "axis": 1},
    ),
    Case("Slider", oo.Slider, {"axis": E1 * 0.1}, lambda a, b, c: shifting(E1 * a), [POSITION], carried={"axis": 1}),
    Case("Fixed", oo.Fixed, {"anchor": POINT}, lambda a, b, c: STILL, carried={"anchor": 1, "anchor2": 2}),
    Case(
        "Universal",
        oo.Universal,
        {"anchor": POINT, "axis1": E1, "axis2": E2},
        lambda a, b, c: turning(b, E2) * turning(a, E1),
        ANGLES[:2],
        carried={"anchor": 1, "anchor2": 2, "axis1": 1, "axis2": 2},
    ),
    *(
        Case(
            name,
            oo.Hinge2,
            {"anchor": POINT, "axis1": E1, "axis2": second},
            lambda a, b, c, second=second: shifting(E1 * c) * turning(a, E1) * turning(b, second),
            [*ANGLES[:2], ("compression", "compression_rate")],
            wheel=True,
            two=True,
            carried={"anchor": 1, "anchor2": 2, "axis1": 1, "axis2": 2},
        )
        for name, second in (("Hinge2", E2), ("Hinge2 oblique", OBLIQUE))
    ),
    Case(
        "AngularMotor euler",
        oo.AngularMotor,
        {"axes": (E1, E3), "mode": "euler"},
        lambda a, b, c: (
            shifting((a, -b, c)) * turning(c, E3, END) * turning(b, E3.cross(E1), END) * turning(a, E1, END)
        ),
        ANGLES,
        limits=(3.0, HALF, 3.0),
    ),
    Case(
        "PR",
        oo.PR,
        {"anchor": POINT, "axis1": E1, "axis2": E2},
        lambda a, b, c: turning(b, E2) * shifting(E1 * a),
        [POSITION, ANGLE],
        carried={"anchor": 1, "anchor2": 2, "axis1": 1, "axis2": 1},
    ),
    Case(
        "PU",
        oo.PU,
        {"anchor": POINT, "axis1": E1, "axis2": E2, "axis3": E3},
        lambda a, b, c: turning(b, E2) * turning(a, E1) * shifting(E3 * c),
        [*ANGLES[:2], POSITION],
        carried={"anchor": 1, "anchor2": 2, "axis1": 1, "axis2": 2, "axis3": 1},
    ),
    Case(
        "PU oblique",
        oo.PU,
        {"anchor": POINT, "axis1": E1, "axis2": E2, "axis3": OBLIQUE},
        lambda a, b, c: turning(b, E2) * turning(a, E1) * shifting(OBLIQUE * c),
        [*ANGLES[:2], POSITION],
        carried={"anchor": 1, "anchor2": 2, "axis1": 1, "axis2": 2, "axis3": 1},
    ),
    Case(
        "Piston",
        oo.Piston,
        {"anchor": POINT, "axis": E1},
        lambda a, b, c: turning(b, E1) * shifting(E1 * a),
        [POSITION, ANGLE],
        carried={"anchor": 1, "anchor2": 2, "axis": 1},
    ),
    Case(
        "DoubleBall",
        oo.DoubleBall,
        {"anchor1": POINT, "anchor2": END},
        lambda a, b, c: turning(a, E1, END) * turning(b, E2, END) * turning(c, E3),
        carried={"anchor1": 1, "anchor2": 2},
    ),
    Case(
        "DoubleHinge",
        oo.DoubleHinge,
        {"anchor1": POINT, "anchor2": IN_PLANE, "axis": E1},
        lambda a, b, c: turning(a, E1, IN_PLANE) * turning(b, E1),
        carried={"anchor1": 1, "anchor2": 2, "axis": 1},
    ),
]
