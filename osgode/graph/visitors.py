"""Walks over the scene graph that do something at each node."""

from __future__ import annotations

import re
from typing import ClassVar, Literal

from osgode.errors import FieldError
from osgode.graph.node import Group, Node

Direction = Literal["down", "up"]


class Visitor:
    """A walk that calls one method per kind of node.

    `visit` calls ``visit_<kind>``, where the kind is the node's class in snake case (``visit_hash_space`` for a
    HashSpace), or the nearest base class for which this visitor has a method; in the end `visit_node`. To write
    a visitor, override one method per kind that matters. A method that wants the walk to go on calls
    `traverse`; one that doesn't call it keeps the walk out of what is below (or above).

    Args:
        direction: ``"down"`` to the children or ``"up"`` to the parents. A node that is reached on several ways is
            visited as often.

    Raises:
        FieldError: if the direction is another word.
    """

    _methods: ClassVar[dict[type[Node], str]] = {}

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls._methods = {}

    def __init__(self, direction: Direction = "down") -> None:
        if direction not in ("down", "up"):
            raise FieldError(f"Visitor direction is {direction!r}; it must be 'down' or 'up'")
        self.direction = direction

    def visit(self, node: Node) -> None:
        """Call this visitor's method for ``node``."""
        kind = type(node)
        name = self._methods.get(kind)
        if name is None:
            name = self._methods[kind] = self._method_for(kind)
        getattr(self, name)(node)

    def visit_node(self, node: Node) -> None:
        """What is done at a node for whose kind there is no other method: only go on."""
        self.traverse(node)

    def traverse(self, node: Node) -> None:
        """Visit the children of ``node``, or its parents, by the direction.

        The tree may change meanwhile: a child that has left before its turn is not visited, one that has come is
        visited on the next walk.
        """
        if self.direction == "up":
            for parent in node.parents:
                self.visit(parent)
        elif isinstance(node, Group):
            revision = node._revision
            for child in node.children:
                if node._revision == revision or node in child.parents:
                    self.visit(child)

    @classmethod
    def _method_for(cls, kind: type[Node]) -> str:
        names = (f"visit_{snake_case(base.__name__)}" for base in kind.__mro__)
        return next((name for name in names if hasattr(cls, name)), "visit_node")


def snake_case(name: str) -> str:
    """A class name as part of a method name: ``"QuadTreeSpace"`` gives ``"quad_tree_space"``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


class UpdateVisitor(Visitor):
    """The update traversal: calls what nodes registered with `Node.on_update`, once per `update`.

    Hidden nodes are updated too, and a node with several parents once. The tree is walked only when it has changed
    since the last update, so a tree at rest costs nothing but its callbacks. Poses need no callback: they
    come from the physics in one piece (`PoseSource.matrices`) when the tree is drawn.

    A subclass may override ``visit_<kind>`` to leave out what is below some nodes.

    Args:
        root: the node at and below which callbacks are called; held by the visitor.
    """

    def __init__(self, root: Node) -> None:
        super().__init__()
        self.root = root
        self._revision = -1
        self._due: list[Node] = []
        self._seen: set[Node] = set()

    def update(self) -> None:
        """Call every callback once, parents before children, each node's in the order of registration.

        Callbacks may change the tree: a node that has left it before its turn is not called, one that has come
        is called on the next update. An error leaves `update` at once, with a note that names the node.
        """
        if self.root._revision != self._revision:
            self._due = []
            self.visit(self.root)
            self._seen = set()
            self._revision = self.root._revision
        revision = self._revision
        for node in self._due:
            if self.root._revision != revision and not self._is_below_root(node):
                continue
            for callback in tuple(node._update_callbacks or ()):
                try:
                    callback(node)
                except Exception as error:
                    error.add_note(f"in the update callback of {node.path}")
                    raise

    def visit_node(self, node: Node) -> None:
        """Note the node if it has callbacks, and go on."""
        if node in self._seen:
            return
        self._seen.add(node)
        if node._update_callbacks:
            self._due.append(node)
        self.traverse(node)

    def _is_below_root(self, node: Node) -> bool:
        return node is self.root or any(self._is_below_root(parent) for parent in node.parents)
