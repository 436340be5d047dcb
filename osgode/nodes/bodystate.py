"""The state of a body: its table of fields, and how each is read from ODE and written to it.

ODE's reference point is the centre of mass. What users see is the frame that they placed, so position and
velocities go through the offset between the two, kept in ``_com``.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, TypedDict

from osgode.fields import (
    DIRECTION,
    FLAG,
    POSITION_LIMIT,
    ROTATION,
    VELOCITY_LIMIT,
    Check,
    Field,
    FlagField,
    RotationField,
    VectorField,
    number,
    optional,
    three,
    vector,
    whole,
)
from osgode.mass import Mass
from osgode.maths import IDENTITY, ZERO, Quat, QuatLike, Vec3, Vec3Like, quat, vec3
from osgode.native import ffi, lib
from osgode.nodes.base import PhysicsNode
from osgode.nodes.inherited import AutoDisable, Countdown, Inherited

unpack = ffi.unpack

FORCE_LIMIT = 1e15
"""Newtons, newton metres, and their seconds."""


def _three(call: Callable[[Any], Any]) -> Callable[[BodyState], Vec3]:
    return lambda body: vec3(unpack(call(body._id), 3))


def _rotated_com(body: BodyState) -> Vec3:
    """The centre of mass as seen from the frame, along the axes of the world."""
    r = unpack(lib.dBodyGetRotation(body._id), 12)
    x, y, z = body._com
    return vec3((r[0] * x + r[1] * y + r[2] * z, r[4] * x + r[5] * y + r[6] * z, r[8] * x + r[9] * y + r[10] * z))


def read_position(body: BodyState) -> Vec3:
    """The position of the frame, from ODE."""
    centre = vec3(unpack(lib.dBodyGetPosition(body._id), 3))
    return centre if body._com == ZERO else centre - _rotated_com(body)


def write_position(body: BodyState, value: Vec3) -> None:
    """Put the frame at ``value`` in ODE."""
    if body._com != ZERO:
        value = value + _rotated_com(body)
    lib.dBodySetPosition(body._id, *value)
    body._snap()


def _read_rotation(body: BodyState) -> Quat:
    return quat(unpack(lib.dBodyGetQuaternion(body._id), 4))


def _write_rotation(body: BodyState, value: Quat) -> None:
    if body._com == ZERO:
        lib.dBodySetQuaternion(body._id, value)
    else:
        position, velocity = read_position(body), read_linear(body)
        lib.dBodySetQuaternion(body._id, value)
        write_position(body, position)
        write_linear(body, velocity)
    body._snap()


def read_linear(body: BodyState) -> Vec3:
    """The velocity of the frame's origin, from ODE."""
    velocity = vec3(unpack(lib.dBodyGetLinearVel(body._id), 3))
    if body._com == ZERO:
        return velocity
    return velocity - _read_angular(body).cross(_rotated_com(body))


def write_linear(body: BodyState, value: Vec3) -> None:
    """Give the frame's origin a velocity in ODE, at the angular velocity that the body has."""
    if body._com != ZERO:
        value = value + _read_angular(body).cross(_rotated_com(body))
    lib.dBodySetLinearVel(body._id, *value)


_read_angular = _three(lib.dBodyGetAngularVel)


def _write_angular(body: BodyState, value: Vec3) -> None:
    if body._com == ZERO:
        lib.dBodySetAngularVel(body._id, *value)
    else:
        velocity = read_linear(body)
        lib.dBodySetAngularVel(body._id, *value)
        write_linear(body, velocity)


def _waking(write: Callable[[BodyState, Any], object]) -> Callable[[BodyState, Any], None]:
    """The same for users: what is moved or pushed wakes, or it would hang asleep in the air."""

    def write_and_wake(body: BodyState, value: Any) -> None:
        write(body, value)
        lib.dBodyEnable(body._id)

    return write_and_wake


def _by_hand(write: Callable[[BodyState, Any], object]) -> Callable[[BodyState, Any], None]:
    """The same, for what ends a glide too."""
    waking = _waking(write)

    def stop_and_write(body: BodyState, value: Any) -> None:
        body._halt()
        waking(body, value)

    return stop_and_write


def _moved_by_hand(write: Callable[[BodyState, Any], None]) -> Callable[[BodyState, Any], None]:
    """`_by_hand`, and what slept on it wakes too: it may have lost its support."""
    put = _by_hand(write)

    def write_and_wake_all(body: BodyState, value: Any) -> None:
        lib.oo_wake_touching_body(body._live("moving").ptr, body._index)
        put(body, value)

    return write_and_wake_all


def _write_kinematic(body: BodyState, value: bool) -> None:
    if value:
        lib.dBodySetKinematic(body._id)
    else:
        body._halt(halt=False)  # what was carried along flies on
        lib.dBodySetDynamic(body._id)


def _write_enabled(body: BodyState, value: bool) -> None:
    if value:
        lib.dBodyEnable(body._id)
    else:
        body._halt()
        lib.dBodyDisable(body._id)


def _read_finite_axis(body: BodyState) -> Vec3 | None:
    if not lib.dBodyGetFiniteRotationMode(body._id):
        return None
    out = ffi.new("dVector3")
    lib.dBodyGetFiniteRotationAxis(body._id, out)
    axis = Vec3(out[0], out[1], out[2])
    return ZERO if axis == ZERO else axis


def _write_finite_axis(body: BodyState, value: Vec3 | None) -> None:
    lib.dBodySetFiniteRotationMode(body._id, value is not None)
    lib.dBodySetFiniteRotationAxis(body._id, *(value or ZERO))


def _finite_axis(value: Any) -> Vec3:
    return ZERO if three(value) == ZERO else DIRECTION.convert(value)


def _mass_check(value: Any) -> Mass:
    if not isinstance(value, Mass):
        raise TypeError
    return value


class BodyFields(TypedDict, total=False):
    """The keyword arguments of `Body`."""

    position: Vec3Like
    rotation: QuatLike
    linear_velocity: Vec3Like
    angular_velocity: Vec3Like
    force: Vec3Like
    torque: Vec3Like
    fixed_mass: Mass | None
    auto_recentre: bool
    enabled: bool
    kinematic: bool
    gravity: bool
    gyroscopic: bool
    finite_rotation_axis: Vec3Like | None
    auto_disable: bool | None
    auto_disable_linear_threshold: float | None
    auto_disable_angular_threshold: float | None
    auto_disable_steps: int | None
    auto_disable_time: float | None
    auto_disable_samples: int | None
    linear_damping: float | None
    angular_damping: float | None
    linear_damping_threshold: float | None
    angular_damping_threshold: float | None
    max_angular_speed: float | None
    tunnelling: str | None


class BodyState(PhysicsNode):
    """What a `Body` is: pose, velocities, mass, how it sleeps and how it is damped."""

    _id: Any
    _com: Vec3

    fixed_mass: Field[Mass | None, Mass | None] = Field(
        None,
        optional(Check("a Mass", _mass_check)),
        after="_mass_given",
        doc="Mass, centre and inertia in the body's frame, instead of the sum of the parts; None for that sum.",
    )
    auto_recentre = FlagField(
        True,
        FLAG,
        after="_switched",
        doc="Whether mass, centre and inertia follow the parts at once; if not, only when told by recentre().",
    )
    rotation = RotationField(
        IDENTITY,
        ROTATION,
        _read_rotation,
        _moved_by_hand(_write_rotation),
        doc="Quaternion (w, x, y, z) from body axes to world axes.",
    )
    position = VectorField(
        ZERO,
        vector(POSITION_LIMIT),
        read_position,
        _moved_by_hand(write_position),
        unit="m",
        doc="Of the body's frame, in the world.",
    )
    angular_velocity = VectorField(
        ZERO, vector(VELOCITY_LIMIT), _read_angular, _by_hand(_write_angular), unit="rad/s", doc="Along world axes."
    )
    linear_velocity = VectorField(
        ZERO,
        vector(VELOCITY_LIMIT),
        read_linear,
        _by_hand(write_linear),
        unit="m/s",
        doc="Of the origin of the body's frame.",
    )
    force = VectorField(
        ZERO,
        vector(FORCE_LIMIT),
        _three(lib.dBodyGetForce),
        _waking(lambda body, value: lib.dBodySetForce(body._id, *value)),
        unit="N",
        doc="What acts at the centre of mass in the next step; each step clears it.",
    )
    torque = VectorField(
        ZERO,
        vector(FORCE_LIMIT),
        _three(lib.dBodyGetTorque),
        _waking(lambda body, value: lib.dBodySetTorque(body._id, *value)),
        unit="N m",
        doc="What acts in the next step; each step clears it.",
    )
    kinematic = FlagField(
        False,
        FLAG,
        lambda body: bool(lib.dBodyIsKinematic(body._id)),
        _write_kinematic,
        doc="Whether it moves by its velocities alone and nothing can push it.",
    )
    gravity = FlagField(
        True,
        FLAG,
        lambda body: bool(lib.dBodyGetGravityMode(body._id)),
        lambda body, value: lib.dBodySetGravityMode(body._id, value),
        doc="Whether the World's gravity acts on it.",
    )
    gyroscopic = FlagField(
        True,
        FLAG,
        lambda body: bool(lib.dBodyGetGyroscopicMode(body._id)),
        lambda body, value: lib.dBodySetGyroscopicMode(body._id, value),
        doc="Whether gyroscopic torque is computed.",
    )
    finite_rotation_axis: Field[Vec3 | None, Vec3Like | None] = Field(
        None,
        optional(Check("three finite numbers (all 0: every axis)", _finite_axis)),
        _read_finite_axis,
        _write_finite_axis,
        doc="Rotation is integrated exactly about this world axis (0: any), for fast wheels; None: infinitesimally.",
    )
    auto_disable = AutoDisable(doc="Whether it falls asleep when it rests.")
    auto_disable_linear_threshold = Inherited(
        "dBodyGetAutoDisableLinearThreshold",
        "dBodySetAutoDisableLinearThreshold",
        number(0, 1e6),
        unit="m/s",
        doc="Speed below which it counts as resting.",
    )
    auto_disable_angular_threshold = Inherited(
        "dBodyGetAutoDisableAngularThreshold",
        "dBodySetAutoDisableAngularThreshold",
        number(0, 1e6),
        unit="rad/s",
        doc="Angular speed below which it counts as resting.",
    )
    auto_disable_steps = Countdown(
        "dBodyGetAutoDisableSteps",
        "dBodySetAutoDisableSteps",
        whole(0, 1_000_000),
        doc="Steps that it must rest before it sleeps.",
    )
    auto_disable_time = Countdown(
        "dBodyGetAutoDisableTime", "dBodySetAutoDisableTime", number(0, 1e6), unit="s", doc="Time that it must rest."
    )
    auto_disable_samples = Inherited(
        "dBodyGetAutoDisableAverageSamplesCount",
        "dBodySetAutoDisableAverageSamplesCount",
        whole(1, 10_000),
        doc="Steps over which its speeds are averaged.",
    )
    linear_damping = Inherited(
        "dBodyGetLinearDamping", "dBodySetLinearDamping", number(0, 1), doc="Part of the velocity lost in each step."
    )
    angular_damping = Inherited(
        "dBodyGetAngularDamping",
        "dBodySetAngularDamping",
        number(0, 1),
        doc="Part of the angular velocity lost in each step.",
    )
    linear_damping_threshold = Inherited(
        "dBodyGetLinearDampingThreshold",
        "dBodySetLinearDampingThreshold",
        number(0, 1e6),
        unit="m/s",
        doc="Speed below which there is no damping.",
    )
    angular_damping_threshold = Inherited(
        "dBodyGetAngularDampingThreshold",
        "dBodySetAngularDampingThreshold",
        number(0, 1e6),
        unit="rad/s",
        doc="Angular speed below which there is no damping.",
    )
    max_angular_speed = Inherited(
        "dBodyGetMaxAngularSpeed",
        "dBodySetMaxAngularSpeed",
        number(0, math.inf, infinite=True),
        unit="rad/s",
        doc="Faster turning is cut off.",
    )
    enabled = FlagField(
        True,
        FLAG,
        lambda body: bool(lib.dBodyIsEnabled(body._id)),
        _write_enabled,
        doc="Whether it is awake: a sleeping body stands still until something awake touches it.",
    )

    def _snap(self) -> None:
        """Show the pose at once, with nothing to interpolate from."""
        lib.oo_body_snap(self._live("showing").ptr, self._index)

    def _halt(self, *, halt: bool = True) -> None:
        """Glide no more, and stand still unless told otherwise; nothing if it doesn't glide."""
        lib.oo_glide_stop(self._live("stopping it").ptr, self._index, halt)

    _index: int

    @abstractmethod
    def _mass_given(self) -> None:
        """Called when the mass was given by hand, or is no longer so."""

    @abstractmethod
    def _switched(self) -> None:
        """Called when `auto_recentre` was switched."""
