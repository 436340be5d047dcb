"""Joints with an anchor, and rules that axes of several kinds have in common."""

from __future__ import annotations

import math

from osgode.errors import FieldError
from osgode.joints.base import Joint
from osgode.joints.spots import BODY1, BODY2, Anchor, Seen
from osgode.maths import ZERO, Vec3
from osgode.nodes.body import Body


class Anchored(Joint):
    """A joint with a point that it holds together."""

    anchor = Anchor(BODY1, "The point that is held, as body1 has it.")
    anchor2 = Seen("anchor", BODY2, "The same point as body2, or the static world, has it.")

    @property
    def error(self) -> float:
        """How far the two sides of the anchor are apart, metres."""
        return self._gap("anchor").length


def origin_of(body: object) -> Vec3:
    """Where a joint is anchored that is given no anchor: at the origin of body1."""
    return body.position if isinstance(body, Body) else ZERO


def right_angle(joint: Joint, spots: dict[str, Vec3], first: str, second: str) -> Vec3:
    """The second of two axes, made exactly perpendicular to the first.

    Raises:
        FieldError: if they are more than 0.01 rad off a right angle.
    """
    one, other = spots[first], spots[second]
    if abs(one.dot(other)) > 0.01:
        angle = math.degrees(math.acos(max(-1.0, min(1.0, one.dot(other)))))
        raise FieldError(
            f"{joint.describe()}.{second} is {tuple(other)}, at {angle:.1f} degrees to {first}={tuple(one)}; "
            "it must be at a right angle to it"
        )
    return (other - one * one.dot(other)).normalized()


def not_parallel(joint: Joint, spots: dict[str, Vec3], first: str, second: str) -> None:
    """Check that two axes are not parallel.

    Raises:
        FieldError: if their cross product is shorter than 1e-3.
    """
    if spots[first].cross(spots[second]).length < 1e-3:
        raise FieldError(
            f"{joint.describe()}.{second} is {tuple(spots[second])}, parallel to {first}; it must not be parallel to it"
        )
