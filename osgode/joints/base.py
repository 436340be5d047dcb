"""What all joints have in common: when they exist in ODE, and how they survive being made again."""

from __future__ import annotations

from abc import abstractmethod
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, ClassVar

from osgode.errors import PhysicsError, StateError, TreeError, shown
from osgode.fields import FLAG, POSITION_LIMIT, FlagField, vector
from osgode.maths import Pose, Vec3, Vec3Like
from osgode.native import ffi, last_error, lib
from osgode.nodes.base import HasFields
from osgode.nodes.body import Body

if TYPE_CHECKING:
    from osgode.nodes.realm import Realm


class Joint(HasFields):
    """Abstract: holds ``body1`` to ``body2``, or to the static world.

    Joints are not in the tree: they belong to their bodies, and are live while these are in one World. A joint
    keeps the poses that its bodies had when it was anchored, with its anchor and axis in the world at that time.
    Whenever it is made in ODE, the bodies are put there for that moment, so anchors, axes and angles are the same
    as if it had never been away.
    """

    KIND: ClassVar[int]
    _GET_PARAM: ClassVar[Any]
    _SET_PARAM: ClassVar[Any]

    enabled = FlagField(
        True,
        FLAG,
        lambda joint: bool(lib.dJointIsEnabled(joint._id)),
        lambda joint, value: lib.dJointEnable(joint._id) if value else lib.dJointDisable(joint._id),
        after="_wake",
        doc="Whether it holds anything.",
    )

    def __init__(self, body1: Body, body2: Body | None = None, *, name: str = "", **fields: Any) -> None:
        self.name = name
        self._id: Any = None
        self._record = {}
        for which, body in (("body1", body1), ("body2", body2)):
            if not isinstance(body, Body) and (which == "body1" or body is not None):
                raise TreeError(
                    f"{self.describe()}: {which} is {shown(body)}; it must be a Body" + " or None" * (which == "body2")
                )
        if body1 is body2:
            raise TreeError(
                f"{self.describe()}: body1 and body2 are both {body1.describe()}; a joint needs two bodies, or one"
            )
        self._body1: Body = body1
        self._body2: Body | None = body2
        self._released = False
        self._rest = self._poses()
        self._set_fields(fields)
        for body in self._bodies:
            body._joints.append(self)
        try:
            self._sync()
        except BaseException:
            self._forget()
            raise

    def describe(self) -> str:
        """What messages call it: its class and its name."""
        return f"{type(self).__name__} {self.name!r}" if getattr(self, "name", "") else type(self).__name__

    def __repr__(self) -> str:
        other = self._body2.describe() if self._body2 is not None else "the static world"
        state = "" if self.is_live else ", not live"
        return f"<{self.describe()}: {self._body1.describe()} and {other}{state}>"

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
        """Whether `release` has been called."""
        return self._released

    def release(self) -> None:
        """Let go of the bodies for good; a second time does nothing.

        Raises:
            StateError: while another thread is in a step of the World.
        """
        if self._realm is not None:
            with self._realm.editing():
                self._drop()
                self._wake()
        if not self._released:
            self._forget()

    def _wake(self) -> None:
        for body in self._bodies:
            body.wake()

    def _forget(self) -> None:
        self._released = True
        for body in self._bodies:
            body._joints = [joint for joint in body._joints if joint is not self]

    # -- being made and unmade

    @abstractmethod
    def _anchor_native(self) -> None:
        """Give anchor and axis to the native; its bodies are at their poses of rest."""

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
            native = lib.oo_joint_new(realm.ptr, self.KIND)
            if native == ffi.NULL:
                raise PhysicsError(f"{self.describe()} can't be made: {last_error() or 'out of memory'}")
            self._id = native
            self._realm = realm
            realm.members[self] = None
            with _AtRest(realm, self._bodies, self._rest):
                second = ffi.NULL if self._body2 is None else self._body2._id
                lib.dJointAttach(native, self._body1._id, second)
                self._anchor_native()
            self._enter_fields()

    def _drop(self) -> None:
        if self._realm is not None:
            self._leave()

    def _leave(self) -> None:
        """Take the state into the record and free the native."""
        realm = self._live("leaving it")
        self._leave_fields()
        del realm.members[self]
        self._realm = None
        lib.oo_joint_free(realm.ptr, self._id)
        self._id = None

    def _remake(self) -> None:
        """Be made again, where a body's reference point in ODE has moved."""
        realm = self._realm
        if realm is not None:
            self._drop()
            self._make(realm)

    def _anchoring(self) -> AbstractContextManager[object]:
        """Hold the World while the joint is anchored anew; an error comes before anything has changed."""
        self._poses()
        return self._changing("anchoring it")

    def _shift_rest(self, body: Body, by: Vec3) -> None:
        """Move the pose of rest of ``body``, ``by`` along its axes, as its frame has moved against what is held."""
        self._rest = tuple(
            Pose(rest.transform(by), rest.rotation) if each is body else rest
            for each, rest in zip(self._bodies, self._rest, strict=True)
        )

    def _rest_anew(self) -> None:
        """Take the present poses as those of rest."""
        self._rest = self._poses()
        self._remake()

    def _needs_live(self, what: str) -> None:
        if self._realm is None:
            raise StateError(
                f"{self.describe()}.{what} needs the joint to be live: not released, and its bodies in one World"
            )
        self._live(what)

    def _carried(self, point: Vec3, body: Body, rest: Pose) -> Vec3:
        """A point of the world at rest, carried along by a body to where it is now."""
        return body.local_to_world(rest.inverse().transform(point))

    def _turned(self, axis: Vec3, body: Body, rest: Pose) -> Vec3:
        return body.vector_to_world(rest.rotation.conjugate().rotate(axis))


class _AtRest:
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


class Anchored(Joint):
    """A joint with a point that it holds together.

    Args:
        anchor: a point of the world, metres; the origin of ``body1`` if not given.
    """

    _GET_ANCHOR: ClassVar[Any]
    _GET_ANCHOR2: ClassVar[Any]

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor: Vec3Like | None = None,
        name: str = "",
        **fields: Any,
    ) -> None:
        self.name = name
        if anchor is None:
            anchor = body1.position if isinstance(body1, Body) else (0, 0, 0)
        self._anchor = vector(POSITION_LIMIT)(self.describe(), "anchor", anchor)
        super().__init__(body1, body2, name=name, **fields)

    @property
    def anchor(self) -> Vec3:
        """The point that is held, as ``body1`` sees it, in the world, metres.

        Setting it anchors the joint anew: the present poses become those of angle (or position) 0.
        """
        if self._realm is not None:
            self._live("anchor")
            out = ffi.new("dVector3")
            self._GET_ANCHOR(self._id, out)
            return Vec3(out[0], out[1], out[2])
        return self._carried(self._anchor, self._body1, self._rest[0])

    @anchor.setter
    def anchor(self, value: Vec3Like) -> None:
        wanted = vector(POSITION_LIMIT)(self.describe(), "anchor", value)
        with self._anchoring():
            self._reanchor(wanted)

    def _reanchor(self, anchor: Vec3) -> None:
        self._anchor = anchor
        self._rest_anew()

    @property
    def anchor2(self) -> Vec3:
        """The same point as ``body2`` (or the static world) sees it."""
        if self._realm is not None:
            self._live("anchor2")
            out = ffi.new("dVector3")
            self._GET_ANCHOR2(self._id, out)
            return Vec3(out[0], out[1], out[2])
        return self._anchor if self._body2 is None else self._carried(self._anchor, self._body2, self._rest[1])

    @property
    def error(self) -> float:
        """How far the two sides of the anchor are apart, metres."""
        return self.anchor.distance(self.anchor2)
