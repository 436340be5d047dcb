"""What listeners of a joint are told, and what a joint says of its forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from osgode.maths import Vec3

if TYPE_CHECKING:
    from osgode.joints.base import Joint


@dataclass(frozen=True, slots=True)
class LetGo:
    """A joint no longer holds its bodies.

    Args:
        joint: which.
        reason: "broke" (above its break_force or break_torque), "released" (`Joint.release` was called), or "left"
            (a body left the World; the joint waits for it to come back).
        force, torque: N and N m that it bore in the last step, torque about the anchor; 0 unless it broke.
    """

    joint: Joint
    reason: str
    force: float = 0.0
    torque: float = 0.0


class Reaction(NamedTuple):
    """What a joint did to its bodies in the last step, along the axes of the world.

    Args:
        force1, force2: N on ``body1`` and ``body2``.
        torque1, torque2: N m on each, about its own centre of mass.
        torque: N m on ``body1`` about the anchor: what the joint itself has to bear.
    """

    force1: Vec3
    torque1: Vec3
    force2: Vec3
    torque2: Vec3
    torque: Vec3
