"""Nodes and groups: the tree, its rules, and how children come and go.

Parents are referred to weakly: who holds the root holds everything below it, and when the root is
dropped nothing above a node keeps it alive.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterator, Sequence
from typing import ClassVar, TypeVar

from osgode.errors import TreeError, shown
from osgode.graph.drawable import Drawable

UpdateCallback = Callable[["Node"], object]


class Node:
    """A thing in the scene graph: it has a name, parents, and can be hidden.

    Args:
        name: for messages, paths and `Group.find`; need not be unique.
        visible: whether it, and what is below it, is drawn.
    """

    PARENTS: ClassVar[tuple[str, ...]] = ("Group",)
    """Names of the classes that a parent must be an instance of (one of them)."""
    SHARED: ClassVar[bool] = True
    """Whether the node may have several parents (purely visual nodes only)."""

    def __init__(self, *, name: str = "", visible: bool = True) -> None:
        self.name = name
        self._visible = visible
        self._parents: list[weakref.ref[Group]] = []
        self._update_callbacks: list[UpdateCallback] | None = None
        self._revision = 0

    # -- the tree upwards

    @property
    def parents(self) -> tuple[Group, ...]:
        """The groups that this node was attached to, in that order."""
        return tuple(p for ref in self._parents if (p := ref()) is not None)

    @property
    def parent(self) -> Group | None:
        """The only parent, or None.

        Raises:
            TreeError: if there are several.
        """
        refs = self._parents
        if len(refs) == 1:
            return refs[0]()
        found = self.parents
        if len(found) > 1:
            raise TreeError(f"{self.describe()} has {len(found)} parents; ask for .parents")
        return found[0] if found else None

    @property
    def ancestors(self) -> Iterator[Group]:
        """The first parent, its first parent, and so on up to a root."""
        node: Group | None = self._first_parent
        while node is not None:
            yield node
            node = node._first_parent

    @property
    def _first_parent(self) -> Group | None:
        for ref in self._parents:
            parent = ref()
            if parent is not None:
                return parent
        return None

    def walk(self) -> Iterator[Node]:
        """This node and everything below it, each parent before its children."""
        yield self

    def describe(self) -> str:
        """What messages call this node: its class and its name."""
        return f"{type(self).__name__} {self.name!r}" if self.name else type(self).__name__

    @property
    def path(self) -> str:
        """The names from the root down to this node, joined by slashes."""
        parts = [self, *self.ancestors]
        return "/".join(p.name or type(p).__name__ for p in reversed(parts))

    def __repr__(self) -> str:
        return f"<{self.describe()}>"

    # -- state

    @property
    def visible(self) -> bool:
        """Whether this node and what is below it is drawn."""
        return self._visible

    @visible.setter
    def visible(self, value: bool) -> None:
        if value != self._visible:
            self._visible = bool(value)
            self._touch()

    def on_update(self, callback: UpdateCallback) -> UpdateCallback:
        """Have ``callback(node)`` called on every update traversal; usable as a decorator."""
        if self._update_callbacks is None:
            self._update_callbacks = []
        self._update_callbacks.append(callback)
        self._touch()  # an UpdateVisitor looks for callbacks only in a tree that has changed
        return callback

    def remove_on_update(self, callback: UpdateCallback) -> None:
        """Take back what `on_update` registered.

        Raises:
            ValueError: if it isn't registered.
        """
        (self._update_callbacks or []).remove(callback)

    def drawables(self) -> Sequence[Drawable]:
        """What is drawn at this node itself, in the node's own axes; nothing unless a subclass says so.

        A subclass whose answer changes calls `_touch()`.
        """
        return ()

    def _touch(self) -> None:
        """Note that what is drawn below here has changed, for this node and everything above."""
        self._revision += 1
        for ref in self._parents:
            parent = ref()
            if parent is not None:
                parent._touch()

    # -- hooks of the nodes that can't be shared

    def _twin(self) -> Node:
        """What a copy of the parent has in place of this node: the node itself, where it may have several parents."""
        return self

    def _check_parent(self, parent: Group) -> None:
        """Raise TreeError unless this node may be attached to ``parent`` now."""
        self._check_place(parent)
        if not self.SHARED and self.parents:
            raise TreeError(
                f"{self.describe()} can't be attached to {parent.describe()}: it already stands under "
                f"{self.parents[0].describe()} and may have one parent only; detach it or use move_to()"
            )

    def _check_place(self, parent: Group) -> None:
        """Raise TreeError unless this node may ever stand under ``parent``."""
        allowed = {cls.__name__ for cls in type(parent).__mro__}
        if not allowed.intersection(self.PARENTS):
            raise TreeError(
                f"{self.describe()} can't be attached to {parent.describe()}: "
                f"{_article(type(self).__name__)} may stand under {' or '.join(self.PARENTS)}"
            )
        if self is parent or any(node is self for node in _everything_above(parent)):
            raise TreeError(
                f"{self.describe()} can't be attached to {parent.describe()}: it would stand below itself; "
                "attach it to a node outside of its own subtree"
            )

    def _linked(self, parent: Group) -> None:
        """Called when ``parent`` has just taken this node in."""

    def _unlinking(self, parent: Group) -> None:
        """Called when ``parent`` is about to let this node go; if it raises, nothing is changed."""

    def _unlinked(self, parent: Group) -> None:
        """Called when ``parent`` has just let this node go."""


ChildT = TypeVar("ChildT", bound=Node)


class Group(Node):
    """A node with children."""

    def __init__(self, *, name: str = "", visible: bool = True) -> None:
        super().__init__(name=name, visible=visible)
        self._children: list[Node] = []

    @property
    def children(self) -> tuple[Node, ...]:
        """What is attached here, in order."""
        return tuple(self._children)

    def walk(self) -> Iterator[Node]:
        """This node and everything below it, each parent before its children."""
        yield self
        for child in self.children:
            yield from child.walk()

    def find(self, name: str) -> Node | None:
        """The first node called ``name`` at or below this one, or None."""
        return next((node for node in self.walk() if node.name == name), None)

    def attach(self, child: ChildT) -> ChildT:
        """Take ``child`` in as the last of the children and return it.

        Raises:
            TreeError: if a tree rule forbids it; nothing is changed then.
        """
        if not isinstance(child, Node):
            raise TreeError(f"{shown(child)} can't be attached to {self.describe()}: it is no Node")
        child._check_parent(self)
        self._children.append(child)
        child._parents.append(weakref.ref(self))
        self._forget_parts()
        try:
            child._linked(self)
        except BaseException:
            self._unlink(child)
            raise
        self._touch()
        return child

    def detach(self, child: ChildT) -> ChildT:
        """Let ``child`` go and return it.

        Raises:
            TreeError: if it is not a child of this node; nothing is changed then.
        """
        if not any(c is child for c in self._children):
            raise TreeError(
                f"{shown(child)} can't be detached from {self.describe()}: it is not one of its "
                f"{len(self._children)} children"
            )
        child._unlinking(self)
        self._unlink(child)
        child._unlinked(self)
        self._touch()
        return child

    def _unlink(self, child: Node) -> None:
        for i in range(len(self._children) - 1, -1, -1):
            if self._children[i] is child:
                del self._children[i]
                break
        for i in range(len(child._parents) - 1, -1, -1):
            if child._parents[i]() is self:
                del child._parents[i]
                break
        self._forget_parts()

    def _forget_parts(self) -> None:
        """Called before anybody is told that something below has come or gone, for this group and everything above."""
        for parent in self.parents:
            parent._forget_parts()


def _everything_above(node: Node) -> Iterator[Node]:
    for parent in node.parents:
        yield parent
        yield from _everything_above(parent)


def _article(word: str) -> str:
    return f"{'an' if word[0] in 'AEIOU' else 'a'} {word}"
