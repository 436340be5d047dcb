"""Groups that place what is below them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Protocol

import numpy as np

from osgode.errors import FieldError
from osgode.graph.drawable import affine_matrix
from osgode.graph.node import Group, Node
from osgode.maths import IDENTITY, ZERO, FloatArray, Pose, Quat, QuatLike, Vec3, Vec3Like, finite

ONE = Vec3(1.0, 1.0, 1.0)


class PoseSource(Protocol):
    """What knows the poses of many moving transforms as one table: a physics World."""

    def matrices(self, interpolation: float) -> FloatArray:
        """The poses at the last step (1.0), at the one before (0.0), or between.

        Returns:
            (n, 4, 4) rigid motions, ``v_source = matrix @ v_transform``; they may make things smaller, but never
            larger, since what is out of the picture is known by sizes at scale 1. Rows that no transform refers to
            may hold anything.
        """


class Transform(Group, ABC):
    """A group with axes of its own."""

    @abstractmethod
    def local_matrix(self) -> FloatArray:
        """The (4, 4) matrix from these axes to those above: ``v_above = matrix @ v_here``."""

    def pose_row(self) -> tuple[PoseSource, int] | None:
        """Where the moving pose is found: a table and its row, in the axes of the `PoseSource`.

        None if nothing but `local_matrix` moves this transform. A subclass whose answer changes calls `_touch()`.
        """
        return None

    @property
    def absolute(self) -> bool:
        """Whether `local_matrix` leads straight to the axes of the root, whatever stands between."""
        return False


def matrix_to_root(node: Node) -> FloatArray:
    """The (4, 4) matrix from the axes that ``node`` stands in, or that it makes, to those of the root, as it is now.

    Where nodes have several parents, along the first of them.
    """
    matrix = np.identity(4)
    for each in (node, *node.ancestors):
        if isinstance(each, Transform):
            matrix = each.local_matrix() @ matrix
            if each.absolute:
                break
    return matrix


class MatrixTransform(Transform):
    """A transform by any affine matrix.

    Args:
        matrix: (4, 4), ``v_above = matrix @ v_here``; the identity if not given.
        absolute: whether it leads straight to the axes of the root instead of to those above.
        name: for messages and paths.
        visible: whether it, and what is below it, is drawn.

    Raises:
        FieldError: if the matrix is not a finite (4, 4) with (0, 0, 0, 1) as its last row.
    """

    def __init__(self, matrix: object = None, *, absolute: bool = False, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self._matrix = affine_matrix("MatrixTransform.matrix", np.identity(4) if matrix is None else matrix)
        self._absolute = bool(absolute)

    def local_matrix(self) -> FloatArray:
        """The (4, 4) matrix, read-only: ``v_above = matrix @ v_here``."""
        return self._matrix

    @property
    def matrix(self) -> FloatArray:
        """The (4, 4) matrix, read-only; set it whole to change it."""
        return self._matrix

    @matrix.setter
    def matrix(self, value: object) -> None:
        self._matrix = affine_matrix("MatrixTransform.matrix", value)
        self._touch()

    @property
    def absolute(self) -> bool:
        """Whether the matrix leads straight to the axes of the root, whatever stands between."""
        return self._absolute

    @absolute.setter
    def absolute(self, value: bool) -> None:
        self._absolute = bool(value)
        self._touch()


class PositionAttitudeTransform(Transform):
    """A transform by a position, a rotation and a scale: ``v_above = position + rotation(scale * v_here)``.

    Args:
        position: of the origin of these axes, metres.
        rotation: quaternion (w, x, y, z) of any length but 0.
        scale: three factors above 0, or one for all axes.
        name: for messages and paths.
        visible: whether it, and what is below it, is drawn.

    Raises:
        FieldError: if a number is not finite, the rotation is 0, or a factor is not above 0.
    """

    def __init__(
        self,
        *,
        position: Vec3Like = ZERO,
        rotation: QuatLike = IDENTITY,
        scale: Vec3Like | float = ONE,
        name: str = "",
        visible: bool = True,
    ) -> None:
        super().__init__(name=name, visible=visible)
        self._pose = Pose(self._checked_position(position), self._checked_rotation(rotation))
        self._scale = self._checked_scale(scale)
        self._matrix: FloatArray | None = None

    @property
    def position(self) -> Vec3:
        """Where the origin of these axes is, in those above, metres."""
        return self._pose.position

    @position.setter
    def position(self, value: Vec3Like) -> None:
        self.pose = Pose(self._checked_position(value), self._pose.rotation)

    @property
    def rotation(self) -> Quat:
        """How these axes are turned against those above; set it with any length but 0."""
        return self._pose.rotation

    @rotation.setter
    def rotation(self, value: QuatLike) -> None:
        self.pose = Pose(self._pose.position, self._checked_rotation(value))

    @property
    def pose(self) -> Pose:
        """Position and rotation together."""
        return self._pose

    @pose.setter
    def pose(self, value: Pose) -> None:
        position, rotation = value
        self._pose = Pose(self._checked_position(position), self._checked_rotation(rotation))
        self._changed()

    @property
    def scale(self) -> Vec3:
        """The factors along these axes; set it with three numbers above 0 or one."""
        return self._scale

    @scale.setter
    def scale(self, value: Vec3Like | float) -> None:
        self._scale = self._checked_scale(value)
        self._changed()

    def local_matrix(self) -> FloatArray:
        """The (4, 4) matrix, read-only: ``v_above = matrix @ v_here``."""
        if self._matrix is None:
            matrix = self._pose.matrix()
            matrix[:3, :3] *= self._scale
            matrix.flags.writeable = False
            self._matrix = matrix
        return self._matrix

    def _changed(self) -> None:
        self._matrix = None
        self._touch()

    def _checked_position(self, value: Vec3Like) -> Vec3:
        return Vec3(*_numbers(f"{self.describe()}.position", value, 3))

    def _checked_rotation(self, value: QuatLike) -> Quat:
        rotation = Quat(*_numbers(f"{self.describe()}.rotation", value, 4))
        largest = max(map(abs, rotation))
        if largest < 1e-300:  # anything less has too few digits left to make a direction of it
            raise FieldError(f"{self.describe()}.rotation is {value!r}; its length must not be 0")
        return Quat(*(part / largest for part in rotation)).normalized()  # divided first: the length may overflow

    def _checked_scale(self, value: Vec3Like | float) -> Vec3:
        factors = (value,) * 3 if np.ndim(value) == 0 else value
        scale = Vec3(*_numbers(f"{self.describe()}.scale", factors, 3))
        if min(scale) <= 0.0:
            raise FieldError(f"{self.describe()}.scale is {value!r}; every factor must be above 0")
        return scale


def _numbers(name: str, value: Any, count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(map(float, value))
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) != count or not finite(numbers):
        raise FieldError(f"{name} is {value!r}; it must be {count} finite numbers")
    return numbers
