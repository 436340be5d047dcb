"""Putting bodies to where they were when a joint was anchored."""

from __future__ import annotations

from typing import TYPE_CHECKING

from osgode.maths import Pose
from osgode.native import ffi, lib

if TYPE_CHECKING:
    from osgode.nodes.body import Body
    from osgode.nodes.realm import Realm


class AtRest:
    """Puts bodies at their poses of rest for a moment, and back to the very bits that they had."""

    def __init__(self, realm: Realm, bodies: tuple[Body, ...], rest: tuple[Pose, ...]) -> None:
        self._realm = realm
        moved = [(body, pose) for body, pose in zip(bodies, rest, strict=True) if body.pose != pose]
        # Where no body has moved nothing is touched: a move would change the order of ODE's lists of geoms.
        self._moved = moved
        self._raw = [(body, ffi.new("double[19]")) for body, _ in moved]

    def __enter__(self) -> None:
        for body, raw in self._raw:
            lib.oo_body_read_raw(self._realm.ptr, body._index, raw)
        for body, pose in self._moved:
            centre = pose.transform(body._com)
            lib.dBodySetQuaternion(body._id, pose.rotation)
            lib.dBodySetPosition(body._id, *centre)

    def __exit__(self, *error: object) -> None:
        for body, raw in self._raw:
            lib.oo_body_write_raw(self._realm.ptr, body._index, raw)
