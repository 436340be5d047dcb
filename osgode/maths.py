"""Vectors, quaternions and matrices: plain floats for one, numpy for many.

Right-handed axes, Y up. Quaternions are (w, x, y, z), as in ODE. Matrices act on columns:
``v_target = matrix @ v_source``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
Float32Array: TypeAlias = npt.NDArray[np.float32]
IndexArray: TypeAlias = npt.NDArray[np.uint32]


class Vec3(NamedTuple):
    """Three floats with the arithmetic of vectors."""

    x: float
    y: float
    z: float

    def __add__(self, other: Vec3Like) -> Vec3:  # type: ignore[override]
        return vec3((self[0] + other[0], self[1] + other[1], self[2] + other[2]))

    def __radd__(self, other: Vec3Like) -> Vec3:
        return vec3((self[0] + other[0], self[1] + other[1], self[2] + other[2]))

    def __sub__(self, other: Vec3Like) -> Vec3:
        return vec3((self[0] - other[0], self[1] - other[1], self[2] - other[2]))

    def __rsub__(self, other: Vec3Like) -> Vec3:
        return vec3((other[0] - self[0], other[1] - self[1], other[2] - self[2]))

    def __mul__(self, factor: float) -> Vec3:  # type: ignore[override]
        return vec3((self[0] * factor, self[1] * factor, self[2] * factor))

    def __rmul__(self, factor: float) -> Vec3:  # type: ignore[override]
        return vec3((self[0] * factor, self[1] * factor, self[2] * factor))

    def __truediv__(self, divisor: float) -> Vec3:
        return vec3((self[0] / divisor, self[1] / divisor, self[2] / divisor))

    def __neg__(self) -> Vec3:
        return vec3((-self[0], -self[1], -self[2]))

    def dot(self, other: Vec3Like) -> float:
        """The scalar product with ``other``."""
        return self[0] * other[0] + self[1] * other[1] + self[2] * other[2]

    def cross(self, other: Vec3Like) -> Vec3:
        """The vector product ``self x other``."""
        ax, ay, az = self
        bx, by, bz = other
        return vec3((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))

    @property
    def length(self) -> float:
        """The Euclidean length."""
        return math.hypot(*self)

    def normalized(self) -> Vec3:
        """The vector of length 1 in the same direction.

        Raises:
            ZeroDivisionError: if the length is 0.
        """
        return self / self.length

    def distance(self, other: Vec3Like) -> float:
        """The Euclidean distance to ``other``."""
        return math.dist(self, other)


vec3: Callable[[Iterable[float]], Vec3] = partial(tuple.__new__, Vec3)
"""The same as ``Vec3(*numbers)``, but made by C alone: there must be three floats."""

ZERO = Vec3(0.0, 0.0, 0.0)


class Quat(NamedTuple):
    """A rotation as a quaternion (w, x, y, z) of length 1."""

    w: float
    x: float
    y: float
    z: float

    @classmethod
    def from_axis_angle(cls, axis: Vec3Like, angle: float) -> Quat:
        """The rotation by ``angle`` radians about ``axis`` (any length), by the right-hand rule."""
        x, y, z = axis
        length = math.hypot(x, y, z)
        s = math.sin(angle / 2) / length
        return cls(math.cos(angle / 2), x * s, y * s, z * s)

    @classmethod
    def from_yaw_pitch_roll(cls, yaw: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> Quat:
        """Roll about Z first, then pitch about X, then yaw about Y, in radians.

        With all three 0, the rotated object looks along -Z with Y up.
        """
        return (
            cls.from_axis_angle((0, 1, 0), yaw)
            * cls.from_axis_angle((1, 0, 0), pitch)
            * cls.from_axis_angle((0, 0, 1), roll)
        )

    @classmethod
    def between(cls, start: Vec3Like, end: Vec3Like) -> Quat:
        """The shortest rotation that turns the direction ``start`` into the direction ``end``."""
        a = Vec3(*start).normalized()
        b = Vec3(*end).normalized()
        w = 1.0 + a.dot(b)
        if w < 1e-12:  # opposite directions: half a turn about any perpendicular
            other = Vec3(1.0, 0.0, 0.0) if abs(a.x) < 0.9 else Vec3(0.0, 1.0, 0.0)
            return cls(0.0, *a.cross(other).normalized())
        return cls(w, *a.cross(b)).normalized()

    @classmethod
    def from_matrix(cls, matrix: Sequence[Sequence[float]] | FloatArray) -> Quat:
        """The rotation of a 3x3 orthonormal matrix of determinant 1."""
        m = matrix
        # The largest of the four components is taken from the diagonal, which keeps the root away from 0.
        t = (
            m[0][0] + m[1][1] + m[2][2],
            m[0][0] - m[1][1] - m[2][2],
            m[1][1] - m[0][0] - m[2][2],
            m[2][2] - m[0][0] - m[1][1],
        )
        k = max(range(4), key=t.__getitem__)
        r = math.sqrt(1.0 + t[k])
        s = 0.5 / r
        wx, wy, wz = m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]
        xy, xz, yz = m[0][1] + m[1][0], m[0][2] + m[2][0], m[1][2] + m[2][1]
        parts = (
            (r / 2, wx * s, wy * s, wz * s),
            (wx * s, r / 2, xy * s, xz * s),
            (wy * s, xy * s, r / 2, yz * s),
            (wz * s, xz * s, yz * s, r / 2),
        )[k]
        return cls(*(float(p) for p in parts)).normalized()

    def __mul__(self, other: Quat) -> Quat:  # type: ignore[override]
        """The rotation ``other`` first, then ``self``."""
        a, b, c, d = self
        e, f, g, h = other
        return quat(
            (
                a * e - b * f - c * g - d * h,
                a * f + b * e + c * h - d * g,
                a * g - b * h + c * e + d * f,
                a * h + b * g - c * f + d * e,
            )
        )

    def conjugate(self) -> Quat:
        """The opposite rotation."""
        return quat((self[0], -self[1], -self[2], -self[3]))

    def normalized(self) -> Quat:
        """The same rotation with length 1."""
        n = math.hypot(*self)
        return Quat(self[0] / n, self[1] / n, self[2] / n, self[3] / n)

    def rotate(self, vector: Vec3Like) -> Vec3:
        """``vector`` turned by this rotation."""
        w, x, y, z = self
        vx, vy, vz = vector
        tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
        return vec3(
            (
                vx + w * tx + y * tz - z * ty,
                vy + w * ty + z * tx - x * tz,
                vz + w * tz + x * ty - y * tx,
            )
        )

    def to_matrix(self) -> tuple[Vec3, Vec3, Vec3]:
        """The rows of the 3x3 rotation matrix."""
        w, x, y, z = self
        return (
            Vec3(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            Vec3(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            Vec3(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )

    @property
    def angle(self) -> float:
        """The angle of the rotation in radians, 0 to pi."""
        return 2 * math.atan2(math.hypot(*self[1:]), abs(self[0]))


quat: Callable[[Iterable[float]], Quat] = partial(tuple.__new__, Quat)
"""As `vec3`, for four floats."""

IDENTITY = Quat(1.0, 0.0, 0.0, 0.0)

Vec3Like: TypeAlias = Vec3 | Sequence[float] | FloatArray
QuatLike: TypeAlias = Quat | Sequence[float] | FloatArray


class Pose(NamedTuple):
    """A place in space: where the origin of a frame is, and how the frame is turned."""

    position: Vec3 = ZERO
    rotation: Quat = IDENTITY

    def __mul__(self, other: Pose) -> Pose:  # type: ignore[override]
        """The pose ``other``, given in this frame, seen from outside."""
        return Pose(self.position + self.rotation.rotate(other.position), self.rotation * other.rotation)

    def inverse(self) -> Pose:
        """The pose for which ``pose * pose.inverse()`` is the identity."""
        back = self.rotation.conjugate()
        return Pose(-back.rotate(self.position), back)

    def transform(self, point: Vec3Like) -> Vec3:
        """A point of this frame in the outer frame."""
        return self.position + self.rotation.rotate(point)

    def matrix(self) -> FloatArray:
        """The 4x4 matrix: ``v_outer = matrix @ v_inner``."""
        result = np.identity(4)
        result[:3, :3] = self.rotation.to_matrix()
        result[:3, 3] = self.position
        return result


def pose_matrices(positions: npt.ArrayLike, quaternions: npt.ArrayLike) -> FloatArray:
    """4x4 matrices for many poses: (n, 3) positions and (n, 4) unit quaternions give (n, 4, 4)."""
    w, x, y, z = q = np.ascontiguousarray(np.asarray(quaternions, dtype=np.float64).T)
    x2, y2, z2 = q[1:] * 2.0
    wx, wy, wz, xx, xy, xz = w * x2, w * y2, w * z2, x * x2, x * y2, x * z2
    yy, yz, zz = y * y2, y * z2, z * z2
    out = np.zeros((len(w), 4, 4))
    cells = out.reshape(-1, 16).T  # each cell for all poses
    np.subtract(1.0, yy + zz, out=cells[0])
    np.subtract(xy, wz, out=cells[1])
    np.add(xz, wy, out=cells[2])
    np.add(xy, wz, out=cells[4])
    np.subtract(1.0, xx + zz, out=cells[5])
    np.subtract(yz, wx, out=cells[6])
    np.subtract(xz, wy, out=cells[8])
    np.add(yz, wx, out=cells[9])
    np.subtract(1.0, xx + yy, out=cells[10])
    out[:, :3, 3] = positions
    cells[15] = 1.0
    return out


def look_at(eye: Vec3Like, target: Vec3Like, up: Vec3Like = (0, 1, 0)) -> Pose:
    """The pose of a camera at ``eye`` that looks (along its -Z) at ``target``."""
    back = (Vec3(*eye) - Vec3(*target)).normalized()
    side = Vec3(*up).cross(back)
    if side.length < 1e-9:  # looking straight up or down: any horizontal side will do
        side = Vec3(1.0, 0.0, 0.0)
    side = side.normalized()
    over = back.cross(side)
    rows = [[side.x, over.x, back.x], [side.y, over.y, back.y], [side.z, over.z, back.z]]
    return Pose(Vec3(*map(float, eye)), Quat.from_matrix(rows))


def finite(values: Iterable[float]) -> bool:
    """Whether every value is a finite number."""
    return all(map(math.isfinite, values))
