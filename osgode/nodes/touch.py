"""What a listener is told about two geoms that touch."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from osgode.errors import FieldError, shown
from osgode.native import ffi, lib, row_dtype
from osgode.nodes.base import PhysicsNode, physics_nodes

if TYPE_CHECKING:
    from collections.abc import Callable

    from osgode.maths import FloatArray
    from osgode.nodes.body import Body
    from osgode.nodes.feedback import CollisionFeedback
    from osgode.nodes.geom import Geom
    from osgode.nodes.realm import Realm

    Ear = tuple[weakref.ref["Listening"], Callable[[Any], object]]

CONTACT_ROW = row_dtype("oo_contact")
TOUCH_ROW = row_dtype("oo_touch")
STATES = ("begin", "stay", "end")


class Touch:
    """Two geoms that began, go on, or ended touching in the step that was just done."""

    # No dataclass: thousands are made in a step where everybody listens, and a frozen one takes four times as long.
    __slots__ = ("_rows", "_slot", "geom", "impulse", "other", "state")

    geom: Geom
    """The listener's own geom."""
    other: Geom
    """The geom that it touches."""
    state: str
    """"begin", "stay" or "end"."""
    impulse: float
    """Sum of the sizes of the contact forces times the step size, N s; 0 at the end."""

    def __init__(  # noqa: PLR0917
        self, geom: Geom, other: Geom, state: str, impulse: float, slot: int, rows: bytes
    ) -> None:
        self.geom = geom
        self.other = other
        self.state = state
        self.impulse = impulse
        self._slot = slot
        self._rows = rows  # as C wrote them: numpy is slow for so little, and few listeners ask

    def __repr__(self) -> str:
        return f"Touch({self.geom!r}, {self.other!r}, {self.state!r}, impulse={self.impulse!r})"

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
        return np.frombuffer(bytearray(self._rows), CONTACT_ROW) if self._rows else np.empty(0, CONTACT_ROW)

    @property
    def body(self) -> Body | None:
        """The listener's own body."""
        return self.geom.body

    @property
    def other_body(self) -> Body | None:
        """The body that is touched, or None for static geometry."""
        return self.other.body


class Ears:
    """Who is to be told of each geom, by slot: as it is now, and as it was in the last step.

    Both are one dict until something changes. It belongs to the World, since it holds on to listeners: geoms must not,
    nor the Realm. Nodes are referred to weakly, for the World is one.
    """

    __slots__ = ("now", "then")

    def __init__(self) -> None:
        self.now: dict[int, tuple[Ear, ...]] = {}
        self.then = self.now

    def set(self, slot: int, ears: tuple[Ear, ...]) -> None:
        """Note who listens to the geom of a slot."""
        if ears == self.now.get(slot, ()):
            return
        if self.now is self.then:
            self.now = dict(self.now)
        if ears:
            self.now[slot] = ears
        else:
            del self.now[slot]

    def knew(self, ear: Ear, slot1: int, slot2: int) -> bool:
        """Whether somebody listened to one of two geoms in the last step already."""
        then = self.then
        return self.now is then or ear in then.get(slot1, ()) or ear in then.get(slot2, ())

    def settle(self) -> None:
        """A step is done: those who listen now have heard of it."""
        self.then = self.now

    def calls(self, slots: tuple[int, int], state: int) -> list[tuple[int, Ear, int]]:
        """Whom to tell of two geoms, where something has changed: which of them is his, who, and the state for him.

        Who wasn't told of them in the last step hears that they begin; who was, and has no part in them any more,
        that they have ended.
        """
        now = [(side, ear) for side in (0, 1) for ear in self.now.get(slots[side], ())]
        then = [(side, ear) for side in (0, 1) for ear in self.then.get(slots[side], ())]
        was, still = [ear for _, ear in then], [ear for _, ear in now]
        told: list[Ear] = []
        out: list[tuple[int, Ear, int]] = []
        for side, ear in now + then:
            node, listener = ear
            if ear in told:
                continue
            told.append(ear)
            if ear not in still:
                if state != lib.OO_BEGIN and (who := node()) is not None and listener in who._touch_listeners:
                    out.append((side, ear, lib.OO_END))
            elif ear in was:
                out.append((side, ear, state))
            elif state != lib.OO_END:
                out.append((side, ear, lib.OO_BEGIN))
        return out


class Listening(PhysicsNode):
    """A node whose collisions can be listened to: a geom its own, all others those of the geoms below them."""

    _touch_listeners: tuple[Callable[[Touch], object], ...] = ()
    _collide_listeners: tuple[Callable[[CollisionFeedback], object], ...] = ()

    def on_touch(self, listener: Callable[[Touch], object]) -> Callable[[Touch], object]:
        """Have ``listener`` called after each step in which a geom here touches, or ceases to touch, another.

        Usable as a decorator. It may change anything, the geoms included. What touches already begins for it; what is
        taken away from here ends for it. Two geoms below the same node are told once; so is a listener that is
        registered twice.
        """
        with self._changing("on_touch"):
            self._touch_listeners = _with(self._touch_listeners, self._checked("on_touch", listener))
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
            self._collide_listeners = _with(self._collide_listeners, self._checked("on_collide", listener))
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


def _with(listeners: tuple[Any, ...], new: object) -> tuple[Any, ...]:
    return listeners if new in listeners else (*listeners, new)


def _without(listeners: tuple[Any, ...], gone: object) -> tuple[Any, ...]:
    left = list(listeners)
    left.remove(gone)
    return tuple(left)


def listening_above(node: PhysicsNode) -> list[Listening]:
    """A node and those above it that can be listened to."""
    return [each for each in (node, *node.ancestors) if isinstance(each, Listening)]


def contact_rows(realm: Realm) -> np.ndarray[Any, np.dtype[Any]]:
    """The last step's contact rows, as they lie in C: good until the next step."""
    return c_rows(realm.ptr.contacts, realm.ptr.contact_count, CONTACT_ROW)


def c_rows(first: Any, count: int, kind: np.dtype[Any]) -> np.ndarray[Any, np.dtype[Any]]:
    """Rows of a table in C."""
    return np.frombuffer(ffi.buffer(first, count * kind.itemsize), kind) if count else np.empty(0, kind)


def tell_touches(realm: Realm, ears: Ears) -> list[Exception]:
    """Call the listeners of what touched in the last step; all are told, and their errors returned."""
    errors: list[Exception] = []
    for listener, touch in _calls(realm, ears):
        try:
            listener(touch)
        except Exception as error:  # noqa: BLE001 - every listener is heard before the errors are raised
            error.add_note(f"raised by a touch listener of {touch.geom.describe()} ({touch.state})")
            errors.append(error)
    return errors


def _calls(realm: Realm, ears: Ears) -> list[tuple[Callable[[Touch], object], Touch]]:
    """Who is to be called with what. A loop that is run thousands of times in a step, so it is all in one place."""
    calls: list[tuple[Callable[[Touch], object], Touch]] = []
    now, then, size, nodes = ears.now, ears.then, CONTACT_ROW.itemsize, realm.nodes_by_slot
    changed = now is not then
    count = realm.ptr.contact_count
    raw = ffi.buffer(realm.ptr.contacts, count * size) if count else b""
    events = c_rows(realm.ptr.events, realm.ptr.event_count, TOUCH_ROW).tolist()
    for slot1, slot2, first, number, state, impulse in events:
        ears1, ears2 = now.get(slot1, ()), now.get(slot2, ())
        odd = changed and (ears1 != then.get(slot1, ()) or ears2 != then.get(slot2, ()))
        if not (ears1 or ears2 or odd):
            continue
        geom1, geom2 = nodes[slot1](), nodes[slot2]()
        rows = raw[first * size : (first + number) * size]
        if odd:
            for side, (_, listener), its_state in ears.calls((slot1, slot2), state):
                name = STATES[its_state]
                if side:
                    calls.append((listener, Touch(geom2, geom1, name, impulse, slot2, rows)))
                else:
                    calls.append((listener, Touch(geom1, geom2, name, impulse, slot1, rows)))
            continue
        name = STATES[state]
        if ears1:
            touch = Touch(geom1, geom2, name, impulse, slot1, rows)
            calls += [(ear[1], touch) for ear in ears1]
        if ears2:
            touch = Touch(geom2, geom1, name, impulse, slot2, rows)
            calls += [(ear[1], touch) for ear in ears2 if ear not in ears1]
    ears.settle()  # before any of them is called: what they change counts from the next step on
    return calls
