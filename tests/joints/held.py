"""Two bodies and a joint of any kind between them, with where everything must be by geometry alone."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import osgode as oo

ANCHOR = oo.Vec3(0.3, -0.7, 1.1)
AXIS = oo.Vec3(1, 2, -2) / 3
REST1 = oo.Pose(oo.Vec3(1, 2, 3), oo.Quat.from_axis_angle((1, -1, 2), 0.8))
REST2 = oo.Pose(oo.Vec3(-2, 0.5, 1), oo.Quat.from_axis_angle((3, 1, 0.5), -1.3))
RIDE = oo.Pose(oo.Vec3(4, -1, 2), oo.Quat.from_axis_angle((0.2, 1, -0.7), 2.1))
"""How both bodies have moved together since the joint was anchored."""

SOFT = {"erp": 0.35, "cfm": 2e-7}
LIMOT = {
    "stops": (-2.5, 2.75),
    "stop_bounce": 0.25,
    "stop_erp": 0.45,
    "stop_cfm": 3e-7,
    "motor_velocity": 0.5,
    "motor_max_force": 7.5,
    "fudge_factor": 0.75,
    "cfm": 2e-7,
}


def turn(angle: float, about: oo.Vec3 = ANCHOR, axis: oo.Vec3Like = AXIS) -> oo.Pose:
    """The motion of the world that turns by ``angle`` about an axis through a point."""
    rotation = oo.Quat.from_axis_angle(axis, angle)
    return oo.Pose(about - rotation.rotate(about), rotation)


def shift(way: oo.Vec3Like) -> oo.Pose:
    return oo.Pose(oo.Vec3(*way), oo.Quat(1.0, 0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Kind:
    """A kind of joint, its arguments, its fields away from their defaults, and a motion that it lets ``body1`` make."""

    cls: Any
    where: dict[str, Any]
    fields: dict[str, Any]
    motion: Callable[[float], oo.Pose]
    coordinate: str = ""

    def __str__(self) -> str:
        return self.cls.__name__

    def make(self, body1: Any, body2: Any = None, **fields: Any) -> Any:
        return self.cls(body1, body2, **{"name": "it", **self.where, **fields})


BALL = Kind(oo.Ball, {"anchor": ANCHOR}, SOFT, lambda way: turn(way, axis=(0.5, -1, 0.25)))
HINGE = Kind(oo.Hinge, {"anchor": ANCHOR, "axis": AXIS}, LIMOT, turn, "angle")
SLIDER = Kind(oo.Slider, {"axis": AXIS}, LIMOT, lambda way: shift(AXIS * way), "position")
FIXED = Kind(oo.Fixed, {}, SOFT, lambda _: shift((0, 0, 0)))
KINDS = [BALL, HINGE, SLIDER, FIXED]
MOVING = [HINGE, SLIDER]

each_kind = pytest.mark.parametrize("kind", KINDS, ids=str)
each_moving = pytest.mark.parametrize("kind", MOVING, ids=str)
each_attachment = pytest.mark.parametrize("both", [True, False], ids=["both", "static"])


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
        self.joint = self.kind.make(self.body1, self.body2 if self.both else None, **self.fields)
        self.ride = RIDE if self.both else shift((0, 0, 0))
        self.moved = self.ride * self.kind.motion(self.way)
        put(self.body1, self.moved * REST1)
        if self.both:
            put(self.body2, self.ride * REST2)

    @property
    def bodies(self) -> tuple[oo.Body, ...]:
        return (self.body1, self.body2) if self.both else (self.body1,)

    def check(self, tolerance: float = 1e-9) -> None:
        """Anchors, axis and coordinate are what the motion of the bodies makes of them."""
        joint, near = self.joint, {"abs": tolerance}
        if "anchor" in self.kind.where:
            assert joint.anchor == pytest.approx(self.moved.transform(ANCHOR), **near)
            assert joint.anchor2 == pytest.approx(self.ride.transform(ANCHOR), **near)
            assert joint.error == pytest.approx(0.0, **near)
        if "axis" in self.kind.where:
            assert joint.axis == pytest.approx(self.ride.rotation.rotate(AXIS), **near)
        if self.kind.coordinate and joint.is_live:
            assert getattr(joint, self.kind.coordinate) == pytest.approx(self.way, **near)

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
