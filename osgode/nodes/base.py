"""What all physics nodes have in common: fields, entering and leaving a World, moving house."""

from __future__ import annotations

import difflib
import weakref
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, ClassVar, Self

from osgode.errors import FieldError, PhysicsError, StateError, TreeError, shown
from osgode.fields import Field, Followed, fields_of, number, whole
from osgode.graph.node import Group, Node
from osgode.native import forward_messages, last_error, lib
from osgode.nodes.listeners import tell_let_go
from osgode.scheduler import Callback, ScheduledCall

if TYPE_CHECKING:
    from collections.abc import Sequence

    from osgode.joints.base import Joint
    from osgode.nodes.body import Body
    from osgode.nodes.realm import Realm
    from osgode.nodes.spaces import Space
    from osgode.nodes.world import World


DELAY, PRIORITY, SECONDS = whole(1, 2**31), whole(-(2**31), 2**31), number(0.0, 1e9)


class HasFields:
    """State in a table of fields: in the record while out of a World, in ODE while in one."""

    FIELDS: ClassVar[dict[str, Field[Any, Any]]] = {}
    """Every field of the class by name."""
    _realm: Realm | None = None
    _record: dict[str, Any]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.FIELDS = fields_of(cls)

    if TYPE_CHECKING:

        def describe(self) -> str:
            """What messages call it."""

    def _set_fields(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            if name not in self.FIELDS:
                close = difflib.get_close_matches(name, self.FIELDS, 1)
                hint = f"; did you mean {close[0]!r}?" if close else f"; it has {', '.join(self.FIELDS)}"
                raise TypeError(f"{type(self).__name__} has no field {name!r}{hint}")
            setattr(self, name, value)

    def _enter_fields(self) -> None:
        """Give what was recorded to a new native, whose state is that of the defaults, and what follows the World."""
        for name, field in self.FIELDS.items():
            if name in self._record or isinstance(field, Followed):
                field.enter(self)

    def _leave_fields(self) -> None:
        for field in self.FIELDS.values():
            field.leave(self)

    @property
    def is_live(self) -> bool:
        """Whether it exists in ODE now."""
        return self._realm is not None

    @property
    def world(self) -> World | None:
        """The World that it is simulated in, or None."""
        return self._realm.world_ref() if self._realm is not None and self._realm.world_ref is not None else None

    def _live(self, doing: str) -> Realm:
        """The Realm.

        Raises:
            StateError: if there is none now, or another thread steps it.
        """
        realm = self._realm
        if realm is None:
            raise StateError(f"{self.describe()}: {doing} needs a World; attach it below one first")
        if realm.busy:
            raise StateError(f"{self.describe()}: {doing} while another thread is inside a step of its World")
        return realm

    def _changing(self, doing: str) -> AbstractContextManager[object]:
        """Hold the World for a change, if there is one; raises as `_live`."""
        return nullcontext() if self._realm is None else self._live(doing).editing()

    def _made(self, result: int) -> int:
        if result < 0:
            forward_messages()
            reason = last_error() if result == lib.OO_ASSERT else "out of memory"
            raise PhysicsError(f"{self.describe()} can't be made: {reason}")
        return result


class PhysicsNode(HasFields, Node):
    """A node that has a native while it stands below a World.

    Keyword arguments of every subclass are its fields.
    """

    SHARED = False
    _lost: Sequence[Joint] = ()
    """Joints that were live before this subtree left its World."""
    _moving = False
    """Whether it is between two Worlds."""

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Any) -> None:
        super().__init__(name=name, visible=visible)
        self._record = {}
        self._start()
        self._set_fields(fields)

    def _start(self) -> None:
        """Set what a new node has beside its fields; `copy` runs this, but not the ``__init__`` of a subclass."""

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={_short(getattr(self, name))}" for name in self.FIELDS if self._differs(name))
        name = f"{self.name!r}" if self.name else ""
        return f"{type(self).__name__}({', '.join(filter(None, (name, shown)))})"

    def _differs(self, name: str) -> bool:
        try:
            return bool(self.FIELDS[name].own(self) != self.FIELDS[name].default)
        except StateError:
            return False

    def copy(self) -> Self:
        """A new node with the same fields, outside of any World, and copies of the physics nodes below it.

        A subclass whose ``__init__`` builds its own children overrides this.
        """
        twin = type(self).__new__(type(self))
        PhysicsNode.__init__(twin, name=self.name, visible=self.visible)
        if isinstance(twin, Group):
            twin._children = []
        twin._copy_from(self)
        if isinstance(self, Group) and isinstance(twin, Group):
            for child in self.children:
                twin.attach(child._twin())
        return twin

    def _twin(self) -> Node:
        return self.copy()

    def _copy_from(self, other: Any) -> None:
        for name, field in other.FIELDS.items():
            value = field.own(other)
            if value != field.default:
                self._record[name] = value

    # -- where it stands

    @property
    def body(self) -> Body | None:
        """The Body that this node is a part of (itself, for a Body), or None."""
        return None

    @property
    def space(self) -> Space | None:
        """The nearest space above, or None."""
        from osgode.nodes.spaces import Space

        return next((node for node in self.ancestors if isinstance(node, Space)), None)

    def schedule(
        self, callback: Callback, delay: int = 1, priority: int = 0, *, seconds: float | None = None
    ) -> ScheduledCall:
        """Have ``callback(node)`` called at the end of a step to come, outside of ODE: it may change anything.

        If it returns True it is scheduled again with the same delay: a controller. Calls due in one step are made in
        the order of their priorities, the highest first, then in that of scheduling. What one raises leaves
        `World.step` when all have been made, and it isn't scheduled again. When the node leaves its World its calls are
        dropped.

        Args:
            callback: what is called with this node.
            delay: steps from now; 1 is the end of the next step (inside of a step: of the one after it).
            priority: any whole number.
            seconds: instead of ``delay``, rounded to whole steps of the World, at least one.

        Raises:
            StateError: outside of a World.
            FieldError: for a bad delay or priority, both of delay and seconds, or what can't be called.
        """
        name = f"{self.describe()}.schedule()"
        world = self._live("schedule").world_ref
        owner = world() if world is not None else None
        if owner is None:
            raise StateError(f"{name}: its World is gone")
        if not callable(callback):
            raise FieldError(f"{name}: callback is {shown(callback)}; it must be callable with the node")
        if seconds is not None:
            if delay != 1:
                raise FieldError(f"{name}: give either delay or seconds")
            delay = max(round(SECONDS(name, "seconds", seconds) / owner.step_size), 1)
        count, rank = DELAY(name, "delay", delay), PRIORITY(name, "priority", priority)
        return owner._agenda.add(self, callback, count, rank, owner.steps)

    # -- coming and going

    def _linked(self, parent: Group) -> None:
        realm = parent._realm if isinstance(parent, PhysicsNode) else None
        if realm is not None:
            with realm.editing():
                records = [(node, dict(node._record)) for node in physics_nodes(self)]
                try:
                    self._enter_subtree(realm)
                    try:
                        self._arrived(parent)
                    except BaseException:
                        self._leave_subtree()
                        raise
                except BaseException:
                    # Leaving has read natives that had not been given all of the state, or had rounded it.
                    for node, record in records:
                        node._record = record
                    raise
        else:
            self._arrived(parent)

    def _unlinking(self, parent: Group) -> None:  # noqa: ARG002 - a hook of Node
        if self._realm is not None:
            with self._realm.editing():
                self._lost = self._live_joints()
                self._leave_subtree()

    def _unlinked(self, parent: Group) -> None:
        self._departed(parent)
        if not self._moving:
            self._tell_lost()

    def _live_joints(self) -> list[Joint]:
        joints = (joint for node in physics_nodes(self) for joint in getattr(node, "_joints", ()))
        return [joint for joint in dict.fromkeys(joints) if joint.is_live]

    def _tell_lost(self) -> None:
        """Tell the listeners of joints that have lost a body."""
        lost, self._lost = self._lost, ()
        tell_let_go(call for joint in lost if not joint.is_live for call in joint._lose())

    def move_to(self, parent: Group) -> Self:
        """Stand below ``parent`` instead of where it stands now, and return self.

        In the same World nothing is destroyed: velocities, joints and contacts-to-be stay. To another World the
        whole subtree is moved with its state, and with the joints both of whose bodies move.

        Raises:
            TreeError: if a tree rule forbids it; nothing is changed then.
        """
        if not isinstance(parent, Group):
            raise TreeError(f"{self.describe()} can't be moved to {shown(parent)}: it is no Group")
        old = self.parent
        if old is None:
            return parent.attach(self)
        self._check_place(parent)
        new_realm = parent._realm if isinstance(parent, PhysicsNode) else None
        if self._realm is not None and new_realm is self._realm:
            with self._realm.editing():
                self._move_within(old, parent)
        else:
            index = _index(old, self)
            self._moving = True
            try:
                old.detach(self)
                try:
                    parent.attach(self)
                except BaseException:
                    old.attach(self)
                    old._children.insert(index, old._children.pop())
                    old._forget_parts()
                    raise
            finally:
                self._moving = False
            self._tell_lost()
        return self

    def _move_within(self, old: Group, new: Group) -> None:
        """Change the parent without leaving the World."""
        index = _index(old, self)
        self._relink(old, new)
        try:
            self._rehoused(old, new)
        except BaseException:
            self._relink(new, old)
            old._children.insert(index, old._children.pop())
            old._forget_parts()
            self._rehoused(new, old)
            raise

    def _relink(self, old: Group, new: Group) -> None:
        old._unlink(self)
        new._children.append(self)
        self._parents.append(weakref.ref(new))
        new._forget_parts()
        old._touch()
        new._touch()

    def _rehoused(self, old: Group, new: Group) -> None:
        for node in physics_nodes(self):
            node._rehouse()
        self._departed(old)
        self._arrived(new)

    def _enter_subtree(self, realm: Realm) -> None:
        entered: list[PhysicsNode] = []
        try:
            for node in physics_nodes(self):
                entered.append(node)
                node._enter(realm)
            for node in entered:
                node._settle()
            for node in entered:
                node._entered()
        except BaseException:
            for node in reversed(entered):
                if node._realm is not None:
                    node._leave()
            raise

    def _leave_subtree(self) -> None:
        nodes = physics_nodes(self)
        asleep = [node for node in nodes if not getattr(node, "enabled", True)]
        for node in reversed(nodes):
            node._leave()
        for node in asleep:  # what leaves wakes what it touched or held, but not what leaves along with it
            node._record["enabled"] = False

    def _parts(self) -> Sequence[PhysicsNode]:
        """The physics nodes at and below it, parents first."""
        return [node for node in self.walk() if isinstance(node, PhysicsNode)]

    # -- what a kind of node does on these occasions

    def _enter(self, realm: Realm) -> None:
        """Make the native. Sets ``_realm`` last, so that a failure leaves the node outside."""
        self._realm = realm
        realm.members[self] = None

    def _settle(self) -> None:
        """Called when the whole subtree has entered."""

    def _entered(self) -> None:
        """Called when all of it, joints too, is as it will be; may raise to refuse."""

    def _leave(self) -> None:
        """Take the state into the record and free the native."""
        realm = self._live("leaving it")
        del realm.members[self]
        world = self.world
        if world is not None:
            world._agenda.drop(self)
        self._realm = None

    def _place(self) -> None:
        """Give the native the pose that the tree says."""

    def _surface_again(self) -> None:
        """Called when the step size has changed, on which springs depend."""

    def _rehouse(self) -> None:
        """Called when the space or the body above may have changed within the same World."""

    def _recentred(self) -> None:
        """Called when the centre of mass of the body above has moved in its frame."""

    def _arrived(self, parent: Group) -> None:
        """Called when it stands below ``parent``, in or out of a World; may raise to refuse."""

    def _departed(self, parent: Group) -> None:
        """Called when it no longer stands below ``parent``."""


def physics_nodes(top: Node) -> Sequence[PhysicsNode]:
    """The physics nodes at and below ``top``, parents first."""
    if isinstance(top, PhysicsNode):
        return top._parts()
    return [node for node in top.walk() if isinstance(node, PhysicsNode)]


def _index(parent: Group, child: Node) -> int:
    return next(i for i, node in enumerate(parent._children) if node is child)


def nearest_body(node: Node | None) -> Body | None:
    """The body that ``node`` is or belongs to."""
    return node.body if isinstance(node, PhysicsNode) else None


def refuse(child: Node, parent: Node, rule: str) -> TreeError:
    """The error for a rule that the PARENTS table doesn't hold."""
    return TreeError(f"{child.describe()} can't be attached to {parent.describe()}: {rule}")


def _short(value: object) -> str:
    if isinstance(value, tuple):
        return "(" + ", ".join(_short(v) for v in value) + ")"
    text = f"{value:.6g}" if isinstance(value, float) else repr(value)
    return text if len(text) < 60 else text[:57] + "..."
