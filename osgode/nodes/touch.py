"""What a listener is told about two geoms that touch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from osgode.errors import OsgodeError
from osgode.native import ffi, lib, row_dtype

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from osgode.maths import FloatArray
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
        points: where they touch, (n, 3) metres in the world; none at the end.
        normals: at these points, out of ``other`` towards ``geom``, (n, 3).
        depths: how far they overlap there, (n,) metres.
    """

    geom: Geom
    other: Geom
    state: str
    impulse: float
    points: FloatArray
    normals: FloatArray
    depths: FloatArray

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
    def body(self) -> Body | None:
        """The listener's own body."""
        return self.geom.body

    @property
    def other_body(self) -> Body | None:
        """The body that is touched, or None for static geometry."""
        return self.other.body


def contact_rows(realm: Realm, first: int, count: int) -> np.ndarray[Any, np.dtype[Any]]:
    """A copy of some of the last step's contact rows."""
    if not count:
        return np.empty(0, CONTACT_ROW)
    size = CONTACT_ROW.itemsize
    return np.frombuffer(ffi.buffer(realm.ptr.contacts + first, count * size), CONTACT_ROW).copy()


def tell_touches(realm: Realm) -> None:
    """Call the listeners of what touched in the last step.

    All are told even if one raises; the error is raised afterwards (several in an ExceptionGroup), with a
    note that names the node.
    """
    events = ffi.unpack(realm.ptr.events, realm.ptr.event_count)
    errors: list[Exception] = []
    for call, touch in [pair for event in events for pair in _calls(realm, event)]:
        try:
            call(touch)
        except Exception as error:  # noqa: BLE001 - every listener is heard before the errors are raised
            error.add_note(f"raised by a touch listener of {touch.geom.describe()} ({touch.state})")
            errors.append(error)
    if len(errors) == 1:
        raise errors[0]
    if errors:
        raise ExceptionGroup("several touch listeners failed", errors)


def _calls(realm: Realm, event: Any) -> Iterator[tuple[Callable[[Touch], object], Touch]]:
    geoms: Any = (realm.geoms[event.slot1], realm.geoms[event.slot2])
    if None in geoms:
        raise OsgodeError(f"a touch names slots {event.slot1} and {event.slot2}, which no geom has: a fault in osgode")
    rows = contact_rows(realm, event.first, event.count)
    for geom, other in (geoms, geoms[::-1]):
        listeners = [*geom._touch_listeners, *(geom.body._touch_listeners if geom.body is not None else ())]
        if not listeners:
            continue
        own = event.slot1 if geom is geoms[0] else event.slot2
        # ODE's normal points into the body of its first geom
        sign = np.where(rows["slot1"] == own, 1.0, -1.0)[:, None]
        touch = Touch(
            geom,
            other,
            Touch.STATES[event.state],
            event.impulse,
            rows["geom"]["pos"][:, :3],
            rows["geom"]["normal"][:, :3] * sign,
            rows["geom"]["depth"],
        )
        for listener in listeners:
            yield listener, touch
