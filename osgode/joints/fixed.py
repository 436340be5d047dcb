"""The fixed joint."""

from __future__ import annotations

from typing import Unpack

from osgode.joints.anchored import Anchored, origin_of
from osgode.joints.base import JointFields
from osgode.joints.limits import SpringFields, spring_fields
from osgode.maths import Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class FixedFields(JointFields, SpringFields):
    """The keyword arguments of `Fixed`."""


class Fixed(Anchored):
    """Holds two bodies as they stand to each other.

    One body with several parts is stiffer and faster than several bodies fixed together; use this for what may
    come apart.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: where the seam is, a point of the world in metres: the torque that breaks it is taken there; the origin
            of ``body1`` if not given.
    """

    KIND = lib.OO_FIXED

    erp, cfm, stiffness, damping = spring_fields((lib.dParamERP, lib.dParamCFM), ("", ""), "the joint", turning=False)

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        name: str = "",
        **fields: Unpack[FixedFields],
    ) -> None:
        spots = {"anchor": origin_of(body1) if anchor is None else anchor}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    def fix(self) -> None:
        """Hold the bodies as they stand to each other now."""
        self.anchor_anew()

    @property
    def angular_error(self) -> float:
        """By what angle the bodies are turned against each other since they were fixed, radians."""
        return self._turned()
