"""Every motor and every pair of stops of every kind of joint, at the centres of mass of balls of known inertia."""

from dataclasses import dataclass, field
from typing import Any

import osgode as oo
from tests.joints.moves import E1, E2, E3, OBLIQUE, POINT

MASS1, MASS2, RADIUS1, RADIUS2 = 3.0, 5.0, 0.5, 0.6
X, Y, Z = oo.Vec3(1, 0, 0), oo.Vec3(0, 1, 0), oo.Vec3(0, 0, 1)


@dataclass(frozen=True)
class Drive:
    """One axis of a kind of joint.

    Args:
        after: what stands after "motor_velocity" in the names of its fields.
        axis: along which it slides or about which it turns, in the world.
        turns: whether it turns.
        stops: whether it has stops.
        wheel: whether it is body 2 that it drives the positive way.
    """

    cls: Any
    after: str
    axis: oo.Vec3
    turns: bool
    coordinate: str
    rate: str
    where: dict[str, Any] = field(default_factory=dict)
    stops: bool = True
    bodies: tuple[int, ...] = (1, 2)
    wheel: bool = False
    note: str = ""

    def __str__(self) -> str:
        return f"{self.cls.__name__}{self.note}{self.after}"

    def named(self, **fields: Any) -> dict[str, Any]:
        """Fields of a joint with one axis as this axis has them."""
        return {name + self.after: value for name, value in fields.items()}


def several(cls, axes, turns, names, **rest):
    return [
        Drive(cls, str(i), axis, turn, *name, **rest)
        for i, (axis, turn, name) in enumerate(zip(axes, turns, names, strict=True), 1)
    ]


ANGLE, POSITION = ("angle", "angle_rate"), ("position", "position_rate")
ANGLES = [("angle1", "angle_rate1"), ("angle2", "angle_rate2"), ("angle3", "angle_rate3")]
UNIVERSAL = {"anchor": POINT, "axis1": E1, "axis2": E2}
HINGE2 = {"where": UNIVERSAL, "bodies": (2,), "wheel": True}

DRIVES = [
    Drive(oo.Hinge, "", E1, True, *ANGLE, {"anchor": POINT, "axis": E1 * 2}),
    Drive(oo.Slider, "", E1, False, *POSITION, {"axis": E1 * 2}),
    *several(oo.Universal, (E1, E2), (True, True), ANGLES[:2], where=UNIVERSAL),
    Drive(oo.Hinge2, "1", E1, True, *ANGLES[0], **HINGE2),
    Drive(oo.Hinge2, "2", E2, True, *ANGLES[1], **HINGE2, stops=False),
    *several(
        oo.AngularMotor,
        (E1, E3.cross(E1), E3),
        (True,) * 3,
        ANGLES,
        where={"axes": (E1, E3), "mode": "euler"},
        note=" euler ",
    ),
    *(
        drive
        for relative in ("world", "body1", "body2")
        for drive in several(
            oo.AngularMotor,
            (E1, OBLIQUE, X),
            (True,) * 3,
            [("", name) for _, name in ANGLES],
            where={"axes": (E1, OBLIQUE, X), "relative_to": relative},
            stops=False,
            note=f" {relative} ",
        )
    ),
    *several(
        oo.LinearMotor,
        (E1, OBLIQUE, X),
        (False,) * 3,
        [("", f"rate{i}") for i in (1, 2, 3)],
        where={"axes": (E1, OBLIQUE, X)},
        stops=False,
    ),
    *several(oo.PR, (E1, E2), (False, True), [POSITION, ANGLE], where=UNIVERSAL),
    *several(oo.PU, (E1, E2, E3), (True, True, False), [*ANGLES[:2], POSITION], where={**UNIVERSAL, "axis3": E3}),
    *several(oo.Piston, (E1, E1), (False, True), [POSITION, ANGLE], where={"anchor": POINT, "axis": E1}),
    *several(oo.Plane2D, (X, Y, Z), (False, False, True), [("", "")] * 3, stops=False, bodies=(1,)),
]
STOPPED = [drive for drive in DRIVES if drive.stops]


def cases(drives):
    """Each with one body and with two, as far as the kind takes them."""
    return [(drive, count) for drive in drives for count in drive.bodies]


class Rig:
    """A World without gravity, in which a joint holds one ball, or two about the same centre.

    So forces along an axis and torques about it turn nothing else, and what they do follows from the mass or the
    inertia of the ball; with two of them from their reduced one, 1 / (1 / a + 1 / b).
    """

    def __init__(self, drive: Drive, count: int, *, solver="exact", h=1 / 200, **fields: Any) -> None:
        self.drive = drive
        self.world = oo.World(gravity=(0, 0, 0), solver=solver, step_size=h)
        centre = oo.Vec3(1, 2, 0) if drive.cls is oo.Plane2D else POINT
        self.bodies = []
        for mass, radius, off in ((MASS1, RADIUS1, (0.1, 0.2, 0)), (MASS2, RADIUS2, (-0.3, 0, 0.2)))[:count]:
            body = self.world.attach(oo.Body(position=centre - off))
            body.fixed_mass = oo.Mass.sphere(radius, mass=mass).translated(off)
            self.bodies.append(body)
        self.joint = drive.cls(*self.bodies, **drive.where, **drive.named(**fields))

    def inertia(self) -> float:
        """Of what the motor has to speed up: kg, or kg m2."""
        of_balls = [MASS1, MASS2]
        if self.drive.turns:
            of_balls = [0.4 * MASS1 * RADIUS1**2, 0.4 * MASS2 * RADIUS2**2]
        return 1 / sum(1 / each for each in of_balls[: len(self.bodies)])

    @property
    def rate(self) -> float:
        """How fast the driven body goes along or about the axis, from the velocities of the bodies alone."""

        def speed(body):
            velocity = body.angular_velocity if self.drive.turns else body.velocity_at(body.world_centre_of_mass)
            return velocity.dot(self.drive.axis)

        result = speed(self.bodies[0]) - (speed(self.bodies[1]) if self.bodies[1:] else 0.0)
        return -result if self.drive.wheel else result

    @property
    def coordinate(self) -> float:
        return getattr(self.joint, self.drive.coordinate)

    def push(self, load: float) -> None:
        """Load the axis the positive way in the next step: N or N m."""
        for body, sign in zip(self.bodies, (1, -1), strict=False):
            load_here = self.drive.axis * (load * sign * (-1 if self.drive.wheel else 1))
            if self.drive.turns:
                body.add_torque(load_here)
            else:
                body.add_force(load_here, at=body.world_centre_of_mass)

    def kick(self, speed: float) -> None:
        """Give the axis a rate, without moving the common centre of mass or spin."""
        impulse = speed * self.inertia()
        for body, sign in zip(self.bodies, (1, -1), strict=False):
            kick = self.drive.axis * (impulse * sign * (-1 if self.drive.wheel else 1))
            if self.drive.turns:
                body.apply_angular_impulse(kick)
            else:
                body.apply_impulse(kick, at=body.world_centre_of_mass)

    def set(self, **fields: Any) -> None:
        for name, value in self.drive.named(**fields).items():
            setattr(self.joint, name, value)
