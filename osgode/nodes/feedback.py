"""What a listener is told, and may decide, before two geoms that touch push each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from osgode.errors import FieldError, StateError, shown
from osgode.materials import Surface
from osgode.native import lib
from osgode.nodes.touch import CONTACT_ROW, TOUCH_ROW, Ears, c_rows

if TYPE_CHECKING:
    from osgode.maths import FloatArray
    from osgode.nodes.body import Body
    from osgode.nodes.geom import Geom
    from osgode.nodes.realm import Realm


class CollisionFeedback:
    """Two geoms that touch in the step that is being done, before contact forces act.

    It is good for as long as the listener runs.
    """

    __slots__ = ("_flip", "_pair", "_realm", "begin", "geom", "other")

    geom: Geom
    """The listener's own geom."""
    other: Geom
    """The geom that it touches."""
    begin: bool
    """Whether they didn't touch in the step before, or this listener wasn't there yet."""

    def __init__(  # noqa: PLR0917
        self,
        realm: Realm,
        pair: tuple[int, int, int, int, int, float],
        geom: Geom,
        other: Geom,
        flip: bool,
        begin: bool,
    ) -> None:
        self._realm: Realm | None = realm
        self._pair = pair
        self._flip = flip
        self.geom = geom
        self.other = other
        self.begin = begin

    @property
    def body(self) -> Body | None:
        """The listener's own body."""
        return self.geom.body

    @property
    def other_body(self) -> Body | None:
        """The body that is touched, or None for static geometry."""
        return self.other.body

    @property
    def _first(self) -> Any:
        """The first of the rows in C."""
        if self._realm is None:
            raise StateError("a CollisionFeedback is good for as long as its listener runs; keep what you need of it")
        return self._realm.ptr.contacts + self._pair[2]

    @property
    def _rows(self) -> np.ndarray[Any, np.dtype[Any]]:
        return c_rows(self._first, self._pair[3], CONTACT_ROW).copy()

    @property
    def points(self) -> FloatArray:
        """Where they touch, (n, 3) metres in the world."""
        return cast("FloatArray", self._rows["geom"]["pos"][:, :3])

    @property
    def normals(self) -> FloatArray:
        """Unit vectors at these points, out of ``other`` towards ``geom``, (n, 3)."""
        rows = self._rows
        own = self._pair[1] if self._flip else self._pair[0]
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
        if not self.refused:
            self._set_surface(cast("Realm", self._realm).lend_surface(surface))

    def _set_surface(self, index: int) -> None:
        first = self._first
        for i in range(self._pair[3]):
            first[i].surface = index


def ask(realm: Realm, ears: Ears) -> list[Exception]:
    """Call the listeners of what is about to collide; all are heard, and their errors returned."""
    errors: list[Exception] = []
    ptr, nodes = realm.ptr, realm.nodes_by_slot
    removals = realm.removals
    for pair in c_rows(ptr.touching, ptr.touching_count, TOUCH_ROW).tolist():
        slot1, slot2, state = pair[0], pair[1], pair[4]
        if state == lib.OO_UNASKED:
            continue
        ears1, ears2 = ears.now.get(slot1, ()), ears.now.get(slot2, ())
        geom1, geom2 = nodes[slot1](), nodes[slot2]()
        told = [(geom1, geom2, False, ear) for ear in ears1]
        told += [(geom2, geom1, True, ear) for ear in ears2 if ear not in ears1]
        for own, other, flip, ear in told:
            if realm.removals != removals and not ptr.geoms[slot1].flags & ptr.geoms[slot2].flags & lib.OO_ALIVE:
                break  # another listener has taken one of them away
            begin = state == lib.OO_BEGIN or not ears.knew(ear, slot1, slot2)
            feedback = CollisionFeedback(realm, pair, own, other, flip, begin)
            try:
                ear[1](feedback)
            except Exception as error:  # noqa: BLE001 - every listener is heard before the errors are raised
                error.add_note(f"raised by a collide listener of {feedback.geom.describe()}")
                errors.append(error)
            finally:
                feedback._realm = None
    return errors
