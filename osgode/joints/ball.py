"""The ball joint."""

from __future__ import annotations

from typing import Unpack

from osgode.joints.anchored import Anchored, origin_of
from osgode.joints.base import JointFields
from osgode.joints.limits import SpringFields, spring_fields
from osgode.maths import Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class BallFields(JointFields, SpringFields):
    """The keyword arguments of `Ball` beside its anchor."""


class Ball(Anchored):
    """Holds a point of one body to a point of the other; they turn freely about it.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor: a point of the world, metres; the origin of ``body1`` if not given.
    """

    KIND = lib.OO_BALL

    erp, cfm, stiffness, damping = spring_fields((lib.dParamERP, lib.dParamCFM), ("", ""), "the joint", turning=False)

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        name: str = "",
        **fields: Unpack[BallFields],
    ) -> None:
        spots = {"anchor": origin_of(body1) if anchor is None else anchor}
        super().__init__(body1, body2, name=name, spots=spots, **fields)
