"""Where a ray, or a shape, meets a geom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from osgode.maths import Vec3
    from osgode.nodes.body import Body
    from osgode.nodes.geom import Geom


@dataclass(frozen=True, slots=True)
class Hit:
    """Where a ray met a geom, or a shape overlaps one.

    Args:
        point: in the world, metres.
        normal: of length 1, towards the side that the ray came from; of an overlap out of the geom.
        distance: from the ray's origin, metres; of an overlap its depth.
        geom: what was hit.
        body: that it is a part of, None for static geometry.
    """

    point: Vec3
    normal: Vec3
    distance: float
    geom: Geom
    body: Body | None


@dataclass(frozen=True, slots=True)
class Sweep:
    """Where a shape that is moved first touches something.

    Args:
        fraction: of its motion, 0 (it touches or overlaps already) to 1.
        position: of the shape there, metres in the world.
        normal: of length 1, from what it touches towards the shape; 0 if it overlaps that too deep to tell.
        geom: what it touches.
        body: that it is a part of, None for static geometry.
    """

    fraction: float
    position: Vec3
    normal: Vec3
    geom: Geom
    body: Body | None


@dataclass(frozen=True, slots=True)
class Closest:
    """How far two geoms are apart.

    Args:
        distance: metres; 0 or less where they overlap: how deep is told for rounded shapes only.
        point: of the first that is nearest to the second, in the world, metres.
        other_point: of the second.
    """

    distance: float
    point: Vec3
    other_point: Vec3
