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
