"""Wheels of cars: steered, sprung, driven, braked."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.assemblies.base import MASS, Assembly, Joining, PartFields
from osgode.errors import FieldError, TreeError, shown
from osgode.fields import DIRECTION, LENGTH, OFFSET_LIMIT, Check, choice, number, vector
from osgode.graph.appearance import Appearance
from osgode.graph.drawable import Drawable
from osgode.graph.shapes import box_drawable, cylinder_drawable
from osgode.joints.hinge2 import Hinge2, Hinge2Fields
from osgode.joints.limits import STRONGEST_AT_STOP
from osgode.mass import Mass
from osgode.maths import Pose, Quat, Vec3, Vec3Like
from osgode.nodes.body import Body
from osgode.nodes.placeable import Placeable
from osgode.nodes.primitives import Cylinder, Sphere

SHAPE = choice("cylinder", "sphere")
STIFFNESS: Check[float] = number(1e-3, 1e12)
DAMPING: Check[float] = number(0.0, 1e12)
TORQUE: Check[float] = number(0.0, STRONGEST_AT_STOP)
SPEED: Check[float] = number(-1e6, 1e6)
STEEPEST = math.radians(85.0)

TYRE = Appearance((0.14, 0.14, 0.15, 1.0), shininess=0.15)
RIM = Appearance((0.78, 0.79, 0.82, 1.0), shininess=0.7)
SPOKE = Appearance((0.25, 0.25, 0.28, 1.0), shininess=0.4)
"""A tyre with a rim and spokes, so that a wheel is seen to turn."""


class Wheel(Assembly[Body]):
    """A wheel on a chassis, made by `suspension_wheel`.

    Forward is the direction that was given to `suspension_wheel`; steering is positive to the left.
    """

    def __init__(self, body: Body, joint: Hinge2, radius: float, max_steering: float) -> None:
        super().__init__(body, [body], [joint])
        self._hinge = joint
        self._radius = radius
        self._max_steering = max_steering
        self._angle = number(0.0 - max_steering, max_steering)

    @property
    def chassis(self) -> Body:
        """What it is on."""
        return self._hinge.body1

    @property
    def hub(self) -> Body:
        """The wheel's body; its z axis is the axle, from right to left."""
        return self._top

    @property
    def hinge(self) -> Hinge2:
        """The joint: axis 1 steers and springs, axis 2 rolls."""
        return self._hinge

    @property
    def radius(self) -> float:
        """Metres."""
        return self._radius

    # -- steering

    @property
    def max_steering(self) -> float:
        """How far it can be steered to either side, radians."""
        return self._max_steering

    @property
    def steering(self) -> float:
        """Where it is steered to, radians, positive to the left; setting it turns the wheel there.

        It is held there by a spring, `Hinge2.stop_stiffness1` and `Hinge2.stop_damping1`, so it follows with the time
        constant ``damping / stiffness``. Where it stands at the moment tells ``hinge.angle1``.

        Raises:
            FieldError: for more than `max_steering` to either side.
        """
        stops = self._hinge.stops1
        return 0.0 if stops is None else stops[0]

    @steering.setter
    def steering(self, value: float) -> None:
        angle = self._angle(self.describe(), "steering", value)
        self._hinge.stops1 = (angle, angle)

    # -- driving

    @property
    def speed(self) -> float:
        """How fast the wheel rolls against the chassis: of its rim, m/s, positive forward."""
        return self._hinge.angle_rate2 * self._radius

    def drive(self, speed: float, max_torque: float) -> None:
        """Have it roll at ``speed`` (m/s of the rim, positive forward) with at most ``max_torque`` (N m).

        Raises:
            FieldError: for a bad number; nothing is changed then.
        """
        name = f"{self.describe()}.drive()"
        rate = SPEED(name, "speed", speed) / self._radius
        self._hinge.motor(rate, TORQUE(name, "max_torque", max_torque), axis=2)

    def brake(self, torque: float) -> None:
        """Hold it with at most ``torque`` (N m), so that it comes to a stop."""
        self._hinge.motor(0.0, TORQUE(f"{self.describe()}.brake()", "torque", torque), axis=2)

    def coast(self) -> None:
        """Let it roll freely: neither driven nor braked."""
        self._hinge.motor(0.0, 0.0, axis=2)

    # -- springing

    @property
    def compression(self) -> float:
        """How far the spring is pressed together, metres; negative where the wheel hangs."""
        return self._hinge.compression

    @property
    def load(self) -> float:
        """What spring and damper push the chassis up with, N: ``k x + d v`` of compression and its rate."""
        stiffness, damping = self._hinge.suspension_stiffness or 0.0, self._hinge.suspension_damping or 0.0
        return stiffness * self._hinge.compression + damping * self._hinge.compression_rate


def suspension_wheel(
    chassis: Body,
    hub: Vec3Like,
    *,
    radius: float,
    width: float,
    mass: float,
    stiffness: float,
    damping: float,
    max_steering: float = 0.0,
    steering_stiffness: float = 2e4,
    steering_damping: float = 1e3,
    forward: Vec3Like = (0.0, 0.0, -1.0),
    up: Vec3Like = (0.0, 1.0, 0.0),
    shape: str = "cylinder",
    name: str = "",
    **geom: Unpack[PartFields],
) -> Wheel:
    """Put a wheel on a chassis: a body beside it in the tree, and a `Hinge2` with a spring between them.

    A car of mass ``m`` on four such wheels sinks by ``(m / 4) g / stiffness`` (the wheels' own masses, which stand on
    the ground, don't count). ``damping = 2 sqrt(stiffness m / 4)`` damps it critically; cars have about a third of it.

    Args:
        chassis: a body that stands in the tree; the wheel moves along with it from the start.
        hub: the middle of the wheel while the spring is relaxed, in the chassis' frame, metres.
        radius: of the wheel, metres.
        width: of the wheel, metres.
        mass: of the wheel, kg; its inertia is that of a solid cylinder.
        stiffness: of the suspension, N/m.
        damping: of the suspension, N s/m.
        max_steering: how far it can be steered to either side, radians up to 85 degrees; 0 for a fixed axle.
        steering_stiffness: of what holds the steering, N m/rad.
        steering_damping: of the same, N m s/rad.
        forward: direction in the chassis' frame that it rolls in.
        up: direction in the chassis' frame: axis of steering and springing.
        shape: what it collides as: "cylinder", or "sphere", which rolls better over edges and meshes.
        name: of the wheel; the joint has it too.
        **geom: of its geom, such as ``material`` (rubber if not given), ``appearance``, ``shown``, ``surface``.

    Raises:
        FieldError: for a bad value.
        TreeError: if the chassis is no Body, or stands nowhere. In both cases nothing is changed.
    """
    call = "suspension_wheel()"
    if not isinstance(chassis, Body):
        raise TreeError(f"{call}.chassis is {shown(chassis)}; it must be a Body")
    if chassis.parent is None:
        raise TreeError(f"{call}.chassis is {chassis.describe()}, which stands nowhere; attach it to a space first")
    middle = vector(OFFSET_LIMIT)(call, "hub", hub)
    r, w, kg = LENGTH(call, "radius", radius), LENGTH(call, "width", width), MASS(call, "mass", mass)
    ahead, top = DIRECTION(call, "forward", forward), DIRECTION(call, "up", up)
    axle = top.cross(ahead)
    if axle.length < 1e-3:
        raise FieldError(f"{call}.forward is {tuple(ahead)}; it must not be parallel to up={tuple(top)}")
    axle = axle.normalized()
    limit = number(0.0, STEEPEST)(call, "max_steering", max_steering)
    springs: Hinge2Fields = {
        "stops1": (0.0, 0.0),
        "suspension_stiffness": STIFFNESS(call, "stiffness", stiffness),
        "suspension_damping": DAMPING(call, "damping", damping),
        "stop_stiffness1": STIFFNESS(call, "steering_stiffness", steering_stiffness),
        "stop_damping1": DAMPING(call, "steering_damping", steering_damping),
    }
    place = chassis.pose * Pose(middle, _turned(axle, top))
    body = Body(
        name=name,
        position=place.position,
        rotation=place.rotation,
        linear_velocity=chassis.velocity_at(place.position),
        angular_velocity=chassis.angular_velocity,
        fixed_mass=Mass.cylinder(r, w, mass=kg),
        finite_rotation_axis=(0.0, 0.0, 0.0),  # a wheel may well turn by a radian in one step
    )
    fields: PartFields = {"material": "rubber", "shown": _tyre(r, w, geom), **geom}
    kind = SHAPE(call, "shape", shape)
    body.attach(Placeable()).attach(
        Sphere(r, mass=kg, **fields) if kind == "sphere" else Cylinder(r, w, mass=kg, **fields)
    )
    with Joining.begin() as made:
        joint = made.add(
            Hinge2(
                chassis,
                body,
                anchor=place.position,
                axis1=chassis.vector_to_world(top),
                axis2=chassis.vector_to_world(axle),
                name=name,
                **springs,
            )
        )
        chassis.parent.attach(body)
    return Wheel(body, joint, r, limit)


def _turned(axle: Vec3, up: Vec3) -> Quat:
    """The rotation that turns z to the axle, and x as near to ``up`` as may be."""
    x = (up - axle * axle.dot(up)).normalized()
    return Quat.from_matrix(list(zip(x, axle.cross(x), axle, strict=True)))


def _tyre(radius: float, width: float, geom: PartFields) -> tuple[Drawable, ...] | None:
    """A tyre with a rim and spokes; None, that is the bare shape, for a wheel with a look of its own."""
    if geom.get("appearance") is not None:
        return None
    rim = cylinder_drawable(0.62 * radius, 1.03 * width, RIM)
    bars = ((1.1 * radius, 0.12 * radius, 1.06 * width), (0.12 * radius, 1.1 * radius, 1.06 * width))
    tyre = cylinder_drawable(radius, width, TYRE)
    return (tyre, rim, *(box_drawable(bar, SPOKE) for bar in bars))
