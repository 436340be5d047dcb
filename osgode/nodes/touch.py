"""What a listener is told about two geoms that touch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from osgode.errors import FieldError, OsgodeError, shown
from osgode.native import ffi, lib, row_dtype
from osgode.nodes.listeners import tell

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from osgode.maths import FloatArray
    from osgode.nodes.base import PhysicsNode
    from osgode.nodes.body import Body
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


def checked_listener(node: PhysicsNode, listener: Callable[[Touch], object]) -> Callable[[Touch], object]:
    """The listener, if it can be called.

    Raises:
        FieldError: if not.
    """
    if not callable(listener):
        raise FieldError(f"{node.describe()}.on_touch().listener is {shown(listener)}; it must be callable")
    return listener


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
    for geom, other in (geoms, geoms[::-1]):
        body = geom.body
        listeners = [*geom._touch_listeners, *(body._touch_listeners if body is not None else ())]
        if not listeners:
            continue
        own = event.slot1 if geom is geoms[0] else event.slot2
        touch = Touch(geom, other, Touch.STATES[event.state], event.impulse, own, rows)
        for listener in listeners:
            yield listener, touch
