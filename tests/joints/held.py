"""Two bodies and a joint of any kind between them, with where everything must be by geometry alone."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import osgode as oo
from tests.joints.moves import CASES, E1, E2, E3, END, IN_PLANE, POINT, STILL, Case, shifting, turning

ANCHOR = POINT
AXIS = E1
REST1 = oo.Pose(oo.Vec3(1, 2, 3), oo.Quat.from_axis_angle((1, -1, 2), 0.8))
REST2 = oo.Pose(oo.Vec3(-2, 0.5, 1), oo.Quat.from_axis_angle((3, 1, 0.5), -1.3))
RIDE = oo.Pose(oo.Vec3(4, -1, 2), oo.Quat.from_axis_angle((0.2, 1, -0.7), 2.1))
"""How both bodies have moved together since the joint was anchored."""

ALL = {"feedback": True, "break_force": 1e12, "break_torque": 2e12}
SOFT = {"erp": 0.35, "cfm": 2e-7}


def motor(n: int | str = "") -> dict[str, Any]:
    return {f"motor_velocity{n}": 0.5, f"motor_max_force{n}": 7.5, f"cfm{n}": 2e-7}


def limot(n: int | str = "") -> dict[str, Any]:
    """A motor and stops, away from their defaults."""
    stops = {"stops": (-2.5, 2.75), "stop_bounce": 0.25, "stop_erp": 0.45, "stop_cfm": 3e-7, "fudge_factor": 0.75}
    return motor(n) | {f"{name}{n}": value for name, value in stops.items()}


def turn(angle: float, about: oo.Vec3 = ANCHOR, axis: oo.Vec3Like = AXIS) -> oo.Pose:
    """The motion of the world that turns by ``angle`` about an axis through a point."""
    return turning(angle, axis, about)


shift = shifting


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of joint, or a mode of one, its fields away from their defaults, and what it lets the bodies do.

    Args:
        case: its anchors and axes, and the motion of the one body against the other.
        fields: all of them but ``enabled``, and but those whose place `sprung` takes.
        second: how body 2 moves while body 1 makes the motion of the case.
        lacks: the fields that this mode can't be given.
        attached: whether it takes two bodies, and whether it takes one.
        holds: whether it holds the bodies in a way that `error` and `angular_error` measure.
        free: how far it goes along each of its coordinates.
    """

    case: Case
    fields: dict[str, Any]
    second: Any = lambda *_: STILL
    lacks: tuple[str, ...] = ()
    attached: tuple[bool, ...] = (True, False)
    holds: bool = True
    free: tuple[float, ...] = (1.0, -0.5, 0.4)
    phase: bool = False

    def __str__(self) -> str:
        return self.case.name

    @property
    def cls(self) -> Any:
        return self.case.cls

    @property
    def title(self) -> str:
        """What messages call it."""
        return f"{self.cls.__name__} 'it'"

    @property
    def where(self) -> dict[str, Any]:
        return self.case.where

    @property
    def spots(self) -> list[str]:
        """The names of its anchors and axes."""
        return [name for name in self.where if name.startswith(("anchor", "axis"))]

    def ways(self, way: float) -> tuple[float, ...]:
        return tuple(way * factor for factor in self.free)

    def motion(self, way: float) -> oo.Pose:
        return self.case.allowed(*self.ways(way))

    def make(self, body1: Any, body2: Any = None, **fields: Any) -> Any:
        bodies = (body1, body2) if self.attached != (False,) else (body1,)
        return self.cls(*bodies, **{"name": "it", **self.where, **fields})

    def given(self, variant: str = "soft") -> dict[str, Any]:
        """Fields away from their defaults: all that go together, or with springs and a servo for the others."""
        if variant == "soft":
            return dict(self.fields)
        result = {}
        for name, value in self.fields.items():
            before, soft, after = name.partition("erp" if "erp" in name else "cfm")
            if soft and f"{before}stiffness{after}" in self.cls.FIELDS:
                result |= {f"{before}stiffness{after}": 1500.0, f"{before}damping{after}": 25.0}
            elif not ("servo" in self.cls.FIELDS and name.startswith("motor_")):
                result[name] = value
        if "servo" in self.cls.FIELDS:
            result["servo"] = oo.Servo(target=0.5, max_speed=2.0, max_force=30.0, frequency=5.0, damping_ratio=0.8)
        return result


def case(name: str) -> Case:
    return next(each for each in CASES if each.name == name)


def free(a: float, b: float, c: float) -> oo.Pose:
    """Anything goes."""
    return shift((a, -b, 2 * c)) * turn(a, axis=E2) * turn(b, END, E3)


BALL = Kind(case("Ball"), ALL | SOFT)
HINGE = Kind(case("Hinge"), ALL | limot())
SLIDER = Kind(case("Slider"), ALL | limot())
FIXED = Kind(case("Fixed"), ALL | SOFT)
UNIVERSAL = Kind(case("Universal"), ALL | limot(1) | limot(2))
HINGE2 = Kind(
    case("Hinge2 oblique"),
    ALL | limot(1) | motor(2) | {"suspension_erp": 0.55, "suspension_cfm": 4e-7},
    attached=(True,),
    free=(1.0, -0.5, 0.0),  # compressed it would be pressed back
)
USER = Kind(
    Case(
        "AngularMotor user",
        oo.AngularMotor,
        {"axes": (E1, E2 * 2, (1, 0, 1)), "relative_to": ("world", "body1", "body2"), "mode": "user"},
        free,
    ),
    ALL | limot(1) | limot(2) | limot(3) | {"user_angle1": 0.5, "user_angle2": -0.25, "user_angle3": 0.75},
    holds=False,
)
EULER = Kind(
    case("AngularMotor euler"),
    ALL | limot(1) | limot(2) | limot(3),
    lacks=("user_angle1", "user_angle2", "user_angle3"),
    holds=False,
)
LINEAR = Kind(
    Case(
        "LinearMotor",
        oo.LinearMotor,
        {"axes": (E1, E2 * 2, (1, 0, 1)), "relative_to": ("world", "body1", "body2")},
        free,
    ),
    ALL | motor(1) | motor(2) | motor(3),
    holds=False,
)
PISTON = Kind(case("Piston"), ALL | limot(1) | limot(2))
PR = Kind(case("PR"), ALL | limot(1) | limot(2))
PU = Kind(case("PU oblique"), ALL | limot(1) | limot(2) | limot(3))
PLANE2D = Kind(
    Case("Plane2D", oo.Plane2D, {}, lambda a, b, c: shift((a, b, 0)) * turn(c, axis=(0, 0, 1))),
    ALL | motor(1) | motor(2) | motor(3),
    attached=(False,),
)
DOUBLE_BALL = Kind(case("DoubleBall"), ALL | SOFT | {"distance": 2.5})
DOUBLE_HINGE = Kind(case("DoubleHinge"), ALL | SOFT | {"distance": 2.5})

RATIO = 2.5
CORNER = POINT + E2 * 0.8 - E1 * 0.32
"""The middle of a bevel gear of 0.32 m whose teeth meet those of one of 0.8 m about POINT, on a line along E3."""


def wheels(mode: str, second: dict[str, Any], turned: float, fields: dict[str, Any], lacks: tuple[str, ...]) -> Kind:
    """A transmission: while body 1 turns about its axis by an angle, body 2 turns ``turned`` times as far."""
    where = {"anchor1": POINT, "axis1": E1, "mode": mode, **second}
    axis1 = where["axis1"]
    return Kind(
        Case(
            f"Transmission {mode}",
            oo.Transmission,
            where,
            lambda a, b, c: turn(a, POINT, axis1),
            carried={"anchor1": 1, "axis1": 1, "anchor2": 2, "axis2": 2},
        ),
        ALL | SOFT | {"backlash": 0.002} | fields,
        second=lambda a, b, c: turn(turned * a, where["anchor2"], where.get("axis2", axis1)),
        lacks=lacks,
        attached=(True,),
        holds=False,
        phase=True,
    )


PARALLEL = wheels("parallel", {"anchor2": IN_PLANE, "ratio": RATIO}, -RATIO, {"ratio": RATIO}, ("radius1", "radius2"))
BEVEL = wheels("intersecting", {"anchor2": CORNER, "axis2": E2}, -RATIO, {}, ("ratio", "radius1", "radius2"))
CHAIN = wheels(
    "chain",
    {"axis1": (0, 2, 0), "anchor2": POINT + oo.Vec3(1.2, 0, -0.5), "radius1": 0.5, "radius2": 0.2},
    RATIO,
    {"radius1": 0.5, "radius2": 0.2},
    ("ratio",),
)

KINDS = [BALL, HINGE, SLIDER, FIXED, UNIVERSAL, HINGE2, USER, EULER, LINEAR, PISTON, PR, PU, PLANE2D]
KINDS += [DOUBLE_BALL, DOUBLE_HINGE, PARALLEL, BEVEL, CHAIN]
MOVING = [HINGE, SLIDER]
PAIRS = [kind for kind in KINDS if True in kind.attached]

each_kind = pytest.mark.parametrize("kind", KINDS, ids=str)
each_pair = pytest.mark.parametrize("kind", PAIRS, ids=str)
each_moving = pytest.mark.parametrize("kind", MOVING, ids=str)
each_attachment = pytest.mark.parametrize("both", [True, False], ids=["both", "static"])
each_held = pytest.mark.parametrize(
    ("kind", "both"),
    [pytest.param(kind, both, id=f"{kind}-{'both' if both else 'static'}") for kind in KINDS for both in kind.attached],
)


def solid(pose: oo.Pose, name: str) -> oo.Body:
    """A body of two parts, whose centre of mass is beside its origin."""
    body = oo.Body(name=name, position=pose.position, rotation=pose.rotation)
    body.attach(oo.Placeable(name=f"{name} a", position=(0.3, 0.1, -0.2))).attach(oo.Box((1, 0.5, 0.7), mass=2))
    body.attach(oo.Placeable(name=f"{name} b", position=(-0.2, 0.6, 0.1))).attach(oo.Sphere(0.3, mass=1))
    return body


@dataclass
class Held:
    """A World without gravity in which one body, or two, are held by a joint and have moved since."""

    kind: Kind
    both: bool
    way: float = 0.6
    fields: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.world = oo.World(gravity=(0, 0, 0), name="world")
        self.space = self.world.attach(oo.HashSpace(name="space"))
        self.inner = self.space.attach(oo.SimpleSpace(name="inner"))
        self.sap = self.world.attach(oo.SweepAndPruneSpace(name="sap"))
        self.body1 = self.space.attach(solid(REST1, "first"))
        self.body2 = self.space.attach(solid(REST2, "second"))
        if self.kind is PLANE2D:
            self.body1.position -= (0, 0, self.body1.world_centre_of_mass.z)
        self.rest1, self.rest2 = self.body1.pose, self.body2.pose
        self.joint = self.kind.make(self.body1, self.body2 if self.both else None, **self.fields)
        self.ride = RIDE if self.both else STILL
        ways, allowed = self.kind.ways(self.way), self.kind.motion(self.way)
        wheel = self.kind.case.wheel
        self.moved = self.ride if wheel else self.ride * allowed
        self.moved2 = self.ride * (allowed if wheel else self.kind.second(*ways))
        put(self.body1, self.moved * self.rest1)
        if self.both:
            put(self.body2, self.moved2 * self.rest2)

    @property
    def bodies(self) -> tuple[oo.Body, ...]:
        return (self.body1, self.body2) if self.both else (self.body1,)

    def check(self, tolerance: float = 1e-9) -> None:
        """Anchors, axes and coordinates are what the motion of the bodies makes of them."""
        joint, near = self.joint, {"abs": tolerance}
        self.check_spots(tolerance)
        if self.kind.holds and joint.FIELDS.keys().isdisjoint(["distance"]):
            if self.kind is not PLANE2D:  # it holds the centre of mass, not a point of the frame
                assert joint.error == pytest.approx(0.0, **near)
            assert joint.angular_error == pytest.approx(0.0, abs=1e-7)
        if not joint.is_live:
            return
        for (name, _), way in zip(self.kind.case.coordinates, self.kind.ways(self.way), strict=False):
            assert getattr(joint, name) == pytest.approx(way, **near), name
        if "distance" in joint.FIELDS:
            apart = self.kind.where["anchor1"].distance(self.kind.where["anchor2"])
            assert joint.length == pytest.approx(apart, **near)
        if self.kind is USER:
            for name in ("angle1", "angle2", "angle3"):
                assert getattr(joint, name) == getattr(joint, f"user_{name}")

    def check_spots(self, tolerance: float = 1e-9) -> None:
        """Anchors and axes are where those that carry them have taken them."""
        joint, near = self.joint, {"abs": tolerance}
        for name, side in self.kind.case.carried.items():
            motion = self.moved if side == 1 else self.moved2
            spot = self.spot(name)
            expected = motion.transform(spot) if name.startswith("anchor") else motion.rotation.rotate(spot)
            assert getattr(joint, name) == pytest.approx(expected, **near), name
        if "axes" in self.kind.where:
            for seen, axis in zip(joint.axes, self.axes(), strict=True):
                assert seen == pytest.approx(axis, **near)

    def spot(self, name: str) -> oo.Vec3:
        """An anchor or axis at rest: as given, or the one that is the same on the other side."""
        where = self.kind.where
        given = where.get(name, where.get(name.rstrip("2")) if name == "anchor2" else where.get("axis1"))
        return oo.Vec3(*given) if name.startswith("anchor") else oo.Vec3(*given).normalized()

    def axes(self) -> list[oo.Vec3]:
        """The axes of a motor as their carriers have taken them along."""
        if self.kind is EULER:
            first, third = self.moved.rotation.rotate(E1), self.moved2.rotation.rotate(E3)
            return [first, third.cross(first).normalized(), third]
        given = [E1, E2, oo.Vec3(1, 0, 1).normalized()]
        carriers = [STILL, self.moved, self.moved2]
        return [carrier.rotation.rotate(axis) for carrier, axis in zip(carriers, given, strict=True)]

    def check_it_holds(self) -> None:
        """The bodies stand as the joint wants them, so it has nothing to correct: steps move nothing."""
        before = [body.pose for body in self.bodies]
        assert self.joint.is_live
        self.joint.body1.world.step(5)
        assert_poses(self.bodies, before, 1e-9)

    def own(self) -> dict[str, Any]:
        """The joint's fields as a copy would be given them."""
        return {name: f.own(self.joint) for name, f in self.joint.FIELDS.items()}


def put(body: oo.Body, pose: oo.Pose) -> None:
    body.rotation = pose.rotation
    body.position = pose.position


def assert_poses(bodies: Any, expected: Any, tolerance: float) -> None:
    for body, pose in zip(bodies, expected, strict=True):
        assert body.position == pytest.approx(pose.position, abs=tolerance)
        assert np.allclose(body.rotation.to_matrix(), pose.rotation.to_matrix(), rtol=0, atol=tolerance)


def twist(rotation: oo.Quat, axis: oo.Vec3) -> float:
    """The angle of a rotation about an axis, within +-pi, by turning a vector across it and looking where it went."""
    across = axis.cross((1, 0, 0) if abs(axis.x) < 0.7 else (0, 1, 0)).normalized()
    turned = rotation.rotate(across)
    return math.atan2(axis.dot(across.cross(turned)), across.dot(turned))
