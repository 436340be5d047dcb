"""What a listener is told, and may decide, before two geoms that touch push each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from osgode.errors import FieldError, StateError, shown
from osgode.materials import Surface
from osgode.native import ffi, lib
from osgode.nodes.touch import CONTACT_ROW, sides

if TYPE_CHECKING:
    from osgode.maths import FloatArray
    from osgode.nodes.body import Body
    from osgode.nodes.geom import Geom
    from osgode.nodes.realm import Realm


class CollisionFeedback:
    """Two geoms that touch in the step that is being done, before contact forces act.

    It is good for as long as the listener runs.
    """

    __slots__ = ("_first", "_flip", "_pair", "_realm", "geom", "other")

    geom: Geom
    """The listener's own geom."""
    other: Geom
    """The geom that it touches."""

    def __init__(self, realm: Realm, pair: Any, geom: Geom, other: Geom, *, flip: bool) -> None:
        self._realm: Realm | None = realm
        self._pair = pair
        self._first = realm.ptr.contacts + pair.first
        self._flip = flip
        self.geom = geom
        self.other = other

    @property
    def begin(self) -> bool:
        """Whether they didn't touch in the step before."""
        return bool(self._pair.state == lib.OO_BEGIN)

    @property
    def body(self) -> Body | None:
        """The listener's own body."""
        return self.geom.body

    @property
    def other_body(self) -> Body | None:
        """The body that is touched, or None for static geometry."""
        return self.other.body

    @property
    def _rows(self) -> np.ndarray[Any, np.dtype[Any]]:
        if self._realm is None:
            raise StateError("a CollisionFeedback is good for as long as its listener runs; keep what you need of it")
        raw = ffi.buffer(self._first, self._pair.count * CONTACT_ROW.itemsize)
        return np.frombuffer(bytearray(raw), CONTACT_ROW)

    @property
    def points(self) -> FloatArray:
        """Where they touch, (n, 3) metres in the world."""
        return cast("FloatArray", self._rows["geom"]["pos"][:, :3])

    @property
    def normals(self) -> FloatArray:
        """Unit vectors at these points, out of ``other`` towards ``geom``, (n, 3)."""
        rows = self._rows
        own = self._pair.slot2 if self._flip else self._pair.slot1
        return cast("FloatArray", rows["geom"]["normal"][:, :3] * np.where(rows["slot1"] == own, 1.0, -1.0)[:, None])

    @property
    def depths(self) -> FloatArray:
        """How far they overlap there, (n,) metres."""
        return cast("FloatArray", self._rows["geom"]["depth"])

    @property
    def closing_speeds(self) -> FloatArray:
        """How fast they approach each other along the normals at these points, (n,) m/s; negative: they part."""
        speeds = []
        for point, normal in zip(self.points.tolist(), self.normals.tolist(), strict=True):
            velocity = [0.0, 0.0, 0.0]
            for body, sign in ((self.body, -1.0), (self.other_body, 1.0)):
                if body is not None:
                    velocity = [v + sign * u for v, u in zip(velocity, body.velocity_at(point), strict=True)]
            speeds.append(sum(v * n for v, n in zip(velocity, normal, strict=True)))
        return np.array(speeds)

    @property
    def refused(self) -> bool:
        """Whether a listener has refused the contacts."""
        return bool(self._first[0].surface == lib.OO_REFUSED)

    def refuse(self) -> None:
        """Let them pass through each other in this step; they don't count as touching."""
        self._set_surface(lib.OO_REFUSED)

    def set_surface(self, surface: Surface) -> None:
        """Give these contacts another surface, for this step; a refusal stays one.

        Raises:
            FieldError: if it is no Surface.
        """
        if not isinstance(surface, Surface):
            raise FieldError(f"CollisionFeedback.set_surface(): {shown(surface)} is no Surface")
        if surface.direction is not None:
            raise FieldError("CollisionFeedback.set_surface(): a Surface with a direction must be a geom's own")
        realm = self._realm
        if realm is not None and not self.refused:
            self._set_surface(realm.lend_surface(surface.row(realm.ptr.step_size)))

    def _set_surface(self, index: int) -> None:
        if self._realm is None:
            raise StateError("a CollisionFeedback is good for as long as its listener runs")
        for i in range(self._pair.count):
            self._first[i].surface = index


def ask(realm: Realm) -> list[Exception]:
    """Call the listeners of what is about to collide; all are heard, and their errors returned."""
    errors: list[Exception] = []
    for pair in _asked(realm):
        geoms: Any = (realm.node_of_slot(pair.slot1), realm.node_of_slot(pair.slot2))
        if None in geoms:
            continue
        for side, _, listeners in list(sides(geoms, "_collide_listeners")):
            for listener in listeners:
                slots = realm.ptr.geoms[pair.slot1], realm.ptr.geoms[pair.slot2]
                if not slots[0].flags & slots[1].flags & lib.OO_ALIVE:
                    break  # another listener has taken one of them away
                feedback = CollisionFeedback(realm, pair, geoms[side], geoms[1 - side], flip=side == 1)
                try:
                    listener(feedback)
                except Exception as error:  # noqa: BLE001 - every listener is heard before the errors are raised
                    error.add_note(f"raised by a collide listener of {geoms[side].describe()}")
                    errors.append(error)
                finally:
                    feedback._realm = None
    return errors


def _asked(realm: Realm) -> list[Any]:
    touching, geoms = realm.ptr.touching, realm.ptr.geoms
    pairs = [touching[i] for i in range(realm.ptr.touching_count)]
    return [pair for pair in pairs if (geoms[pair.slot1].flags | geoms[pair.slot2].flags) & lib.OO_ASKED]
