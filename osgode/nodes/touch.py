"""What a listener is told about two geoms that touch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from osgode.errors import FieldError, OsgodeError, shown
from osgode.native import ffi, lib, row_dtype
from osgode.nodes.base import PhysicsNode, physics_nodes
from osgode.nodes.listeners import tell

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from osgode.maths import FloatArray
    from osgode.nodes.body import Body
    from osgode.nodes.feedback import CollisionFeedback
    from osgode.nodes.geom import Geom
    from osgode.nodes.realm import Realm

CONTACT_ROW = row_dtype("oo_contact")


@dataclass(frozen=True, eq=False, slots=True)
class Touch:
    """Two geoms that began, go on, or ended touching in the step that was just done.

    Args:
        geom: the listener's own geom.
        other: the geom that it touches.
        state: "begin", "stay" or "end".
        impulse: sum of the sizes of the contact forces times the step size, N s; 0 at the end.
    """

    geom: Geom
    other: Geom
    state: str
    impulse: float
    _slot: int = field(repr=False)
    _rows: bytes = field(repr=False)  # as C wrote them: numpy is slow for so little, and few listeners ask

    STATES: ClassVar[dict[int, str]] = {lib.OO_BEGIN: "begin", lib.OO_STAY: "stay", lib.OO_END: "end"}

    @property
    def begin(self) -> bool:
        """Whether they didn't touch in the step before."""
        return self.state == "begin"

    @property
    def stay(self) -> bool:
        """Whether they touched in the step before too."""
        return self.state == "stay"

    @property
    def end(self) -> bool:
        """Whether they no longer touch."""
        return self.state == "end"

    @property
    def points(self) -> FloatArray:
        """Where they touch, (n, 3) metres in the world; none at the end."""
        return self._contacts["geom"]["pos"][:, :3]

    @property
    def normals(self) -> FloatArray:
        """Unit vectors at these points, out of ``other`` towards ``geom``, (n, 3)."""
        rows = self._contacts
        # ODE's normal points into the body of its first geom
        return rows["geom"]["normal"][:, :3] * np.where(rows["slot1"] == self._slot, 1.0, -1.0)[:, None]

    @property
    def depths(self) -> FloatArray:
        """How far they overlap there, (n,) metres."""
        return self._contacts["geom"]["depth"]

    @property
    def _contacts(self) -> np.ndarray[Any, np.dtype[Any]]:
        return _as_rows(self._rows)

    @property
    def body(self) -> Body | None:
        """The listener's own body."""
        return self.geom.body

    @property
    def other_body(self) -> Body | None:
        """The body that is touched, or None for static geometry."""
        return self.other.body


class Listening(PhysicsNode):
    """A node whose collisions can be listened to: a geom its own, all others those of the geoms below them."""

    _touch_listeners: tuple[Callable[[Touch], object], ...] = ()
    _collide_listeners: tuple[Callable[[CollisionFeedback], object], ...] = ()

    def on_touch(self, listener: Callable[[Touch], object]) -> Callable[[Touch], object]:
        """Have ``listener`` called after each step in which a geom here touches, or ceases to touch, another.

        Usable as a decorator. It may change anything, the geoms included. Two geoms below the same node are told once.
        """
        with self._changing("on_touch"):
            self._touch_listeners = (*self._touch_listeners, self._checked("on_touch", listener))
            self._mark_listened()
        return listener

    def remove_on_touch(self, listener: Callable[[Touch], object]) -> None:
        """Take back what `on_touch` registered.

        Raises:
            ValueError: if it isn't registered.
        """
        with self._changing("remove_on_touch"):
            self._touch_listeners = _without(self._touch_listeners, listener)
            self._mark_listened()

    def on_collide(self, listener: Callable[[CollisionFeedback], object]) -> Callable[[CollisionFeedback], object]:
        """Have ``listener`` called in each step in which a geom here touches another, before anything comes of it.

        It gets a `CollisionFeedback` and may refuse the contacts, or give them another surface. It may also change
        anything else, the geoms included: contacts of what is gone, or no longer apart, are dropped. Usable as a
        decorator. Two geoms below the same node are told once.
        """
        with self._changing("on_collide"):
            self._collide_listeners = (*self._collide_listeners, self._checked("on_collide", listener))
            self._mark_listened()
        return listener

    def remove_on_collide(self, listener: Callable[[CollisionFeedback], object]) -> None:
        """Take back what `on_collide` registered.

        Raises:
            ValueError: if it isn't registered.
        """
        with self._changing("remove_on_collide"):
            self._collide_listeners = _without(self._collide_listeners, listener)
            self._mark_listened()

    def _checked(self, call: str, listener: Any) -> Any:
        if not callable(listener):
            raise FieldError(f"{self.describe()}.{call}().listener is {shown(listener)}; it must be callable")
        return listener

    def _mark_listened(self) -> None:
        for node in physics_nodes(self)[1:]:
            if isinstance(node, Listening) and node.SHAPED:
                node._mark_listened()

    SHAPED: ClassVar[bool] = False
    """Whether it is a geom."""


def _without(listeners: tuple[Any, ...], gone: object) -> tuple[Any, ...]:
    left = list(listeners)
    left.remove(gone)
    return tuple(left)


def listening_above(node: PhysicsNode) -> list[Listening]:
    """A node and those above it that can be listened to."""
    return [each for each in (node, *node.ancestors) if isinstance(each, Listening)]


def contact_rows(realm: Realm, first: int, count: int) -> np.ndarray[Any, np.dtype[Any]]:
    """A copy of some of the last step's contact rows."""
    return _as_rows(bytearray(_raw_rows(realm, first, count)))


def _raw_rows(realm: Realm, first: int, count: int) -> Any:
    return ffi.buffer(realm.ptr.contacts + first, count * CONTACT_ROW.itemsize)


def _as_rows(raw: bytes | bytearray) -> np.ndarray[Any, np.dtype[Any]]:
    return np.frombuffer(raw, CONTACT_ROW) if raw else np.empty(0, CONTACT_ROW)


def tell_touches(realm: Realm) -> None:
    """Call the listeners of what touched in the last step.

    All are told even if one raises; the error is raised afterwards (several in an ExceptionGroup), with a
    note that names the node.
    """
    events = ffi.unpack(realm.ptr.events, realm.ptr.event_count)
    calls = (pair for event in events for pair in _calls(realm, event))
    tell(calls, "touch", lambda touch: f"{touch.geom.describe()} ({touch.state})")


def _calls(realm: Realm, event: Any) -> Iterator[tuple[Callable[[Touch], object], Touch]]:
    geoms: Any = (realm.node_of_slot(event.slot1), realm.node_of_slot(event.slot2))
    if None in geoms:
        raise OsgodeError(f"a touch names slots {event.slot1} and {event.slot2}, which no geom has: a fault in osgode")
    rows = bytes(_raw_rows(realm, event.first, event.count))
    for side, _, listeners in sides(geoms, "_touch_listeners"):
        own = event.slot1 if side == 0 else event.slot2
        touch = Touch(geoms[side], geoms[1 - side], Touch.STATES[event.state], event.impulse, own, rows)
        for listener in listeners:
            yield listener, touch


def sides(geoms: Any, name: str) -> Iterator[tuple[int, PhysicsNode, tuple[Any, ...]]]:
    """Who is to be told of a pair: which of the geoms is his, he, and his listeners; nobody twice."""
    told: set[int] = set()
    for side in (0, 1):
        for node in listening_above(geoms[side]):
            listeners = getattr(node, name)
            if listeners and id(node) not in told:
                told.add(id(node))
                yield side, node, listeners
