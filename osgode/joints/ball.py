"""The ball joint."""

from __future__ import annotations

from typing import TypedDict, Unpack

from osgode.joints.base import Anchored
from osgode.joints.limits import CFM, ERP, softness
from osgode.maths import Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class BallFields(TypedDict, total=False):
    """The keyword arguments of `Ball` beside its anchor."""

    enabled: bool
    erp: float | None
    cfm: float | None


class Ball(Anchored):
    """Holds a point of one body to a point of the other; they turn freely about it."""

    KIND = lib.OO_BALL
    _GET_ANCHOR = staticmethod(lib.dJointGetBallAnchor)
    _GET_ANCHOR2 = staticmethod(lib.dJointGetBallAnchor2)
    _GET_PARAM = staticmethod(lib.dJointGetBallParam)
    _SET_PARAM = staticmethod(lib.dJointSetBallParam)

    erp = softness(lib.dParamERP, lib.dWorldGetERP, ERP, doc="The part of the error that is corrected in one step.")
    cfm = softness(lib.dParamCFM, lib.dWorldGetCFM, CFM, doc="How soft the joint is.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        name: str = "",
        **fields: Unpack[BallFields],
    ) -> None:
        super().__init__(body1, body2, anchor=anchor, name=name, **fields)

    def _anchor_native(self) -> None:
        lib.dJointSetBallAnchor(self._id, *self._anchor)
