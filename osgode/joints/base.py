"""What all joints have in common: when they exist in ODE, and how they survive being made again."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypedDict

from osgode.errors import FieldError, ParameterError, PhysicsError, StateError, TreeError, shown
from osgode.fields import FLAG, Field, FlagField, Followed, number, optional
from osgode.joints.events import LetGo, Reaction
from osgode.joints.rest import AtRest
from osgode.joints.spots import BODY1, BODY2, Spot
from osgode.maths import Pose, Vec3
from osgode.native import ffi, last_error, lib
from osgode.nodes.base import HasFields
from osgode.nodes.body import Body
from osgode.nodes.listeners import tell_let_go

if TYPE_CHECKING:
    from osgode.nodes.listeners import Call
    from osgode.nodes.realm import Realm

TWO_BODIES = (2,)
ONE_BODY = (1,)
ONE_OR_TWO = (1, 2)


class JointFields(TypedDict, total=False):
    """The keyword arguments of all joints."""

    enabled: bool
    feedback: bool
    break_force: float | None
    break_torque: float | None


class Joint(HasFields):
    """Abstract: holds ``body1`` to ``body2``, or to the static world.

    Joints are not in the tree: they belong to their bodies, and are live while these are in one World. A joint
    keeps the poses that its bodies had when it was anchored, with its anchors and axes in the world at that time.
    Whenever it is made in ODE, the bodies are put there for that moment, so anchors, axes and angles are the same
    as if it had never been away.
    """

    KIND: ClassVar[int]
    BODIES: ClassVar[tuple[int, ...]] = ONE_OR_TWO
    """How many bodies it may join."""
    SPOTS: ClassVar[dict[str, Spot]] = {}
    """Its anchors and axes by name, in the order in which the C core wants them."""
    PARAMETERS: ClassVar[set[str]] = set()
    """The names of the fields, anchors and axes of all kinds, to tell a user what this kind lacks."""

    name: str = ""

    enabled = FlagField(
        True,
        FLAG,
        lambda joint: bool(lib.dJointIsEnabled(joint._id)),
        lambda joint, value: lib.dJointEnable(joint._id) if value else lib.dJointDisable(joint._id),
        after="_wake",
        doc="Whether it holds anything.",
    )
    feedback = FlagField(False, FLAG, after="_watch", doc="Whether `reaction` is kept; it costs a little in each step.")
    break_force: Field[float | None, float | None] = Field(
        None,
        optional(number(0.0, 1e15)),
        after="_watch",
        unit="N",
        doc="Above which it breaks, that is releases its bodies; None: never.",
    )
    break_torque: Field[float | None, float | None] = Field(
        None,
        optional(number(0.0, 1e15)),
        after="_watch",
        unit="N m",
        doc="About the anchor, above which it breaks; None: never.",
    )

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.SPOTS = {
            name: value
            for base in reversed(cls.__mro__)
            for name, value in vars(base).items()
            if isinstance(value, Spot)
        }
        if cls.__module__.startswith("osgode."):
            Joint.PARAMETERS |= {*cls.FIELDS, *(name for name in vars(cls) if name.islower() and name[0] != "_")}

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        name: str = "",
        spots: dict[str, Any] | None = None,
        **fields: Any,
    ) -> None:
        self.name = name
        self._native: Any = None
        self._id: Any = None
        self._ready = False
        self._record = {}
        self._listeners: list[Callable[[LetGo], object]] = []
        self._check_bodies(body1, body2)
        self._body1: Body = body1
        self._body2: Body | None = body2
        self._released = self._broken = False
        self._spots = self._checked_spots(spots or {})
        self._rest = self._poses()
        self._set_fields(fields)
        self._complete()
        self._ready = True
        self._sprung()
        self._join()

    def _join(self) -> None:
        """Belong to the bodies, and be made in ODE if they are in a World."""
        for body in self._bodies:
            body._joints.append(self)
        try:
            self._sync()
        except BaseException:
            self._forget()
            raise

    def copy(self, body1: Body, body2: Body | None = None) -> Self:
        """The same joint between other bodies, which it holds as this one holds its own; listeners are not copied.

        Angles and positions are 0 where they are 0 here, so copies of the bodies begin as the bodies are.

        Raises:
            TreeError: for what can't be joined, and another number of bodies.
            StateError: if this joint has been released, or another thread is in a step of its World.
        """
        self._check_bodies(body1, body2)
        if (body2 is None) != (self._body2 is None):
            raise TreeError(f"{self.describe()}.copy(): it takes {len(self._bodies)} bodies, as it joins itself")
        if self._released:
            raise StateError(f"{self.describe()}.copy(): it has been released, and holds nothing")
        record = {name: field.own(self) for name, field in self.FIELDS.items()}
        twin = type(self).__new__(type(self))
        vars(twin).update(vars(self))
        vars(twin).update(_native=None, _id=None, _realm=None, _listeners=[], _body1=body1, _body2=body2)
        twin._record = {name: value for name, value in record.items() if value != self.FIELDS[name].default}
        twin._copied()
        twin._join()
        return twin

    def _copied(self) -> None:
        """Called for a new copy, before it is made in ODE: what may not be shared with the original is made anew."""

    def _complete(self) -> None:
        """Called when a new joint has all its fields; may raise to refuse."""

    def _check_bodies(self, body1: object, body2: object) -> None:
        for which, body in (("body1", body1), ("body2", body2)):
            needed = which == "body1" or ONE_OR_TWO[0] not in self.BODIES
            if not isinstance(body, Body) and (needed or body is not None):
                raise TreeError(
                    f"{self.describe()}: {which} is {shown(body)}; it must be a Body" + " or None" * (not needed)
                )
        if isinstance(body1, Body) and body1 is body2:
            raise TreeError(
                f"{self.describe()}: body1 and body2 are both {body1.describe()}; a joint needs two different bodies"
            )

    def describe(self) -> str:
        """What messages call it: its class and its name."""
        return f"{type(self).__name__} {self.name!r}" if self.name else type(self).__name__

    def __repr__(self) -> str:
        other = self._body2.describe() if self._body2 is not None else "the static world"
        state = ", broken" if self._broken else ", released" if self._released else "" if self.is_live else ", not live"
        return f"<{self.describe()}: {self._body1.describe()} and {other}{state}>"

    # -- a parameter of another kind is a mistake, not an attribute to be made up

    def __setattr__(self, name: str, value: object) -> None:
        if name in Joint.PARAMETERS and not hasattr(type(self), name):
            raise self._lacks(name)
        super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name in Joint.PARAMETERS:
            raise self._lacks(name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def _lacks(self, name: str) -> ParameterError:
        known = [*self.FIELDS, *self.SPOTS]
        close = difflib.get_close_matches(name, known, 1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        return ParameterError(f"{self.describe()} has no {name!r}{hint}; it has {', '.join(known)}")

    # -- what it joins

    @property
    def body1(self) -> Body:
        """The first body."""
        return self._body1

    @property
    def body2(self) -> Body | None:
        """The second body, or None for the static world."""
        return self._body2

    @property
    def _bodies(self) -> tuple[Body, ...]:
        return (self._body1,) if self._body2 is None else (self._body1, self._body2)

    @property
    def released(self) -> bool:
        """Whether it has let go for good: by `release`, or because it broke."""
        return self._released

    @property
    def broken(self) -> bool:
        """Whether it has let go because it had to bear more than `break_force` or `break_torque`."""
        return self._broken

    def release(self) -> None:
        """Let go of the bodies for good, and tell the listeners; a second time does nothing.

        Raises:
            StateError: while another thread is in a step of the World.
        """
        if self._realm is not None:
            with self._realm.editing():
                self._drop()
                self._wake()
        if not self._released:
            self._forget()
            tell_let_go(self._calls(LetGo(self, "released")))

    def _break(self) -> list[Call]:
        """Release the bodies because it had to bear too much; the listeners are then to be called."""
        row = self._read("breaking it")
        event = LetGo(self, "broke", Vec3(*row.force1).length, Vec3(*row.torque).length)
        with self._live("breaking it").editing():
            self._drop()
            self._wake()
        self._broken = True
        self._forget()
        return self._calls(event)

    def _lose(self) -> list[Call]:
        """A body has left; the listeners are to be called."""
        return self._calls(LetGo(self, "left"))

    def _calls(self, event: LetGo) -> list[Call]:
        return [(listener, event) for listener in self._listeners]

    def on_let_go(self, listener: Callable[[LetGo], object]) -> Callable[[LetGo], object]:
        """Have ``listener`` called when the joint breaks, is released, or loses a body; usable as a decorator.

        A body that leaves the World together with the other, into another World, is not lost. The listener is
        called when all is done, outside of ODE, and may change anything.
        """
        if not callable(listener):
            raise FieldError(f"{self.describe()}.on_let_go().listener is {shown(listener)}; it must be callable")
        self._listeners.append(listener)
        return listener

    def remove_on_let_go(self, listener: Callable[[LetGo], object]) -> None:
        """Take back what `on_let_go` registered.

        Raises:
            ValueError: if it isn't registered.
        """
        self._listeners.remove(listener)

    def _wake(self) -> None:
        realm = self._realm
        if realm is None:
            for body in self._bodies:
                body.wake()
        else:
            with realm.holding():
                self._rouse()

    def _rouse(self) -> None:
        """Wake the bodies of a live joint whose World is held."""
        lib.dBodyEnable(self._body1._id)
        if self._body2 is not None:
            lib.dBodyEnable(self._body2._id)

    def _forget(self) -> None:
        self._released = True
        for body in self._bodies:
            body._joints = [joint for joint in body._joints if joint is not self]

    # -- being made and unmade

    def _poses(self) -> tuple[Pose, ...]:
        return tuple(body.pose for body in self._bodies)

    def _sync(self) -> None:
        """Exist exactly while all bodies are in one World; does nothing if that is so already."""
        realms = {id(body._realm) for body in self._bodies}
        wanted = self._body1._realm if len(realms) == 1 and not self._released else None
        if wanted is self._realm:
            return
        self._drop()
        if wanted is not None:
            self._make(wanted)

    def _make(self, realm: Realm) -> None:
        with realm.editing():
            second = ffi.NULL if self._body2 is None else self._body2._id
            native = lib.oo_joint_new(realm.ptr, self.KIND, self._body1._id, second)
            if native == ffi.NULL:
                raise PhysicsError(f"{self.describe()} can't be made: {last_error() or 'out of memory'}")
            self._native, self._id = native, native.id
            self._realm = realm
            realm.add_joint(self)
            with AtRest(realm, self._bodies, self._rest):
                spots, how = self._layout()
                at = self._rest[0].inverse().transform(self._load_point()) - self._body1._com
                status = lib.oo_joint_place(native, spots, how, tuple(at))
            if status < 0:
                self._drop()
                raise PhysicsError(f"{self.describe()} can't be anchored: ODE refused: {last_error()}")
            self._enter_fields()
            self._watch()

    def _layout(self) -> tuple[list[float], list[int]]:
        """What the C core is told of where it is: anchors and axes at rest, and what else the kind needs."""
        return [value for spot in self._spots.values() for value in spot], []

    def _load_point(self) -> Vec3:
        """Where the torque is taken that can break it: a point of the world at rest."""
        name = next((name for name, spot in self.SPOTS.items() if spot.is_point), "")
        return self._spots[name] if name else self._rest[0].transform(self._body1._com)

    def _drop(self) -> None:
        if self._realm is not None:
            self._leave()

    def _leave(self) -> None:
        """Take the state into the record and free the native."""
        realm = self._live("leaving it")
        self._leave_fields()
        realm.remove_joint(self, self._native)
        self._realm = None
        self._native = self._id = None

    def _remake(self) -> None:
        """Be made again, where a body's reference point in ODE has moved."""
        realm = self._realm
        if realm is not None:
            self._drop()
            self._make(realm)

    # -- where it is

    def _shift_rest(self, body: Body, by: Vec3) -> None:
        """Move the pose of rest of ``body``, ``by`` along its axes, as its frame has moved against what is held."""
        self._rest = tuple(
            Pose(rest.transform(by), rest.rotation) if each is body else rest
            for each, rest in zip(self._bodies, self._rest, strict=True)
        )

    def anchor_anew(self, **spots: Any) -> None:
        """Give it other anchors and axes, in the world as the bodies stand now; all that aren't named stay.

        The present poses become those at which angles and positions are 0. Without arguments that is all.

        Raises:
            FieldError: for a bad value, or axes that can't go together; nothing is changed then.
        """
        for name in spots:
            if name not in self._spots:
                raise self._lacks(name)
        poses = self._poses()
        wanted = self._checked_spots({name: self._seen(name) for name in self._spots} | spots)
        with self._changing("anchoring it"):
            before = self._spots, self._rest
            self._spots, self._rest = wanted, poses
            try:
                self._remake()
            except BaseException:
                self._spots, self._rest = before
                self._sync()
                raise

    def _checked_spots(self, spots: dict[str, Any]) -> dict[str, Vec3]:
        return self._fit({name: spot.check(self.describe(), name, spots[name]) for name, spot in self.SPOTS.items()})

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        """The checked anchors and axes, if they go together; a kind with such a rule overrides this."""
        return spots

    def _seen(self, name: str, side: int | None = None) -> Vec3:
        """An anchor or axis in the world, carried along from rest by the body on one side."""
        spot = self.SPOTS[name]
        return self._carried(self._spots[name], spot.side if side is None else side, is_point=spot.is_point)

    def _carried(self, value: Vec3, side: int, *, is_point: bool) -> Vec3:
        if side == BODY2 and self._body2 is None:
            return value
        body, rest = self._bodies[side], self._rest[side]
        if is_point:
            return body.local_to_world(rest.inverse().transform(value))
        return body.vector_to_world(rest.rotation.conjugate().rotate(value))

    # -- how well it holds

    @property
    def error(self) -> float:
        """How far apart it is where it should hold together, metres."""
        return 0.0

    @property
    def angular_error(self) -> float:
        """By what angle the bodies are turned against each other in a way that it should prevent, radians."""
        return 0.0

    def _gap(self, name: str) -> Vec3:
        """From where body 1 has an anchor to where body 2 has it."""
        return self._seen(name, BODY2) - self._seen(name, BODY1)

    def _bend(self, name: str) -> float:
        """The angle between an axis as one body has it, and as the other has it."""
        one, other = self._seen(name, BODY1), self._seen(name, BODY2)
        return math.atan2(one.cross(other).length, one.dot(other))

    def _turned(self) -> float:
        """The angle by which the bodies are turned against each other since they were at rest."""
        first = self._body1.rotation * self._rest[0].rotation.conjugate()
        if self._body2 is None:
            return abs(first.angle)
        return abs((first * (self._body2.rotation * self._rest[1].rotation.conjugate()).conjugate()).angle)

    # -- what it reads

    def _read(self, what: str) -> Any:
        if self._realm is None:
            raise StateError(
                f"{self.describe()}.{what} needs the joint to be live: not released, and its bodies in one World"
            )
        realm = self._live(what)
        out = ffi.new("oo_joint_state *")
        lib.oo_joint_read(realm.ptr, self._native, out)
        return out

    @property
    def reaction(self) -> Reaction:
        """Forces and torques of the last step; needs `feedback`.

        Raises:
            StateError: without `feedback` or a break threshold, or while the joint isn't live.
        """
        if not self.feedback and self.break_force is None and self.break_torque is None:
            raise StateError(f"{self.describe()}.reaction needs feedback=True, set before the step")
        row = self._read("reaction")
        return Reaction(*(Vec3(*getattr(row, name)) for name in Reaction._fields))

    def _watch(self) -> None:
        if self._realm is not None:
            limits = [math.inf if limit is None else limit for limit in (self.break_force, self.break_torque)]
            lib.oo_joint_watch(self._realm.ptr, self._native, self.feedback, *limits)

    # -- parameters

    def _param(self, code: int) -> float:
        value: float = lib.oo_joint_get_param(self._native, code)
        return value

    def _set_param(self, code: int, value: float) -> None:
        lib.oo_joint_set_param(self._native, code, value)

    def _spring(self, before: str, after: str) -> tuple[float, float] | None:
        """Stiffness and damping of one of its springs, None if it is given neither."""
        stiffness = self._record.get(f"{before}stiffness{after}")
        damping = self._record.get(f"{before}damping{after}")
        return None if stiffness is None and damping is None else (stiffness or 0.0, damping or 0.0)

    def _sprung(self) -> None:
        """Called when a spring, or the ERP or CFM instead of it, has changed."""
        if not self._ready:
            return  # a new joint is given one after the other: only all of them together must be right
        for name, field in self.FIELDS.items():
            place = getattr(field, "spring", None)
            if place is None:
                continue
            spring, own = self._spring(*place), self._record.get(name)
            names = " and ".join(f"{place[0]}{part}{place[1]}" for part in ("stiffness", "damping"))
            if spring is not None and own is not None:
                raise FieldError(
                    f"{self.describe()}.{name} is {own:g} beside {names} of {spring}; give the spring or {name}, "
                    "the other None"
                )
            if spring == (0.0, 0.0):
                raise FieldError(f"{self.describe()}: {names} are both 0; one of them must be above 0")
            if self._realm is not None:
                field.enter(self)
        if self._realm is not None:
            self._wake()

    def _follow(self) -> None:
        """Take over what has changed in the World: ERP, CFM, or the step size that springs depend on."""
        for field in self.FIELDS.values():
            if isinstance(field, Followed):
                field.enter(self)

    # -- pushing

    def _push(self, doing: str, force: Vec3, at: Vec3) -> None:
        """Push body 1 at a point, and body 2 against it."""
        self._read(doing)
        with self._changing(doing):
            self._body1.add_force(force, at=at)
            if self._body2 is not None:
                self._body2.add_force(-force, at=at)

    def _twist(self, doing: str, torque: Vec3) -> None:
        self._read(doing)
        with self._changing(doing):
            self._body1.add_torque(torque)
            if self._body2 is not None:
                self._body2.add_torque(-torque)
