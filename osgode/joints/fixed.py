"""The fixed joint."""

from __future__ import annotations

from typing import TypedDict, Unpack

from osgode.joints.base import Joint
from osgode.joints.limits import CFM, ERP, softness
from osgode.native import lib
from osgode.nodes.body import Body


class FixedFields(TypedDict, total=False):
    """The keyword arguments of `Fixed`."""

    enabled: bool
    erp: float | None
    cfm: float | None


class Fixed(Joint):
    """Holds two bodies as they stand to each other.

    One body with several parts is stiffer and faster than several bodies fixed together; use this for what may
    come apart.
    """

    KIND = lib.OO_FIXED
    _GET_PARAM = staticmethod(lib.dJointGetFixedParam)
    _SET_PARAM = staticmethod(lib.dJointSetFixedParam)

    erp = softness(lib.dParamERP, lib.dWorldGetERP, ERP, doc="The part of the error that is corrected in one step.")
    cfm = softness(lib.dParamCFM, lib.dWorldGetCFM, CFM, doc="How soft the joint is.")

    def __init__(
        self, body1: Body, body2: Body | None = None, *, name: str = "", **fields: Unpack[FixedFields]
    ) -> None:
        super().__init__(body1, body2, name=name, **fields)

    def fix(self) -> None:
        """Hold the bodies as they stand to each other now."""
        with self._anchoring():
            self._rest_anew()

    def _anchor_native(self) -> None:
        lib.dJointSetFixed(self._id)
