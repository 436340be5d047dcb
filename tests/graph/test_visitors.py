"""Visitors: dispatch, walking up and down, the update traversal."""

from __future__ import annotations

import gc
import weakref

import pytest

from osgode.errors import FieldError
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.node import Group, Node
from osgode.graph.transforms import PositionAttitudeTransform
from osgode.graph.visitors import UpdateVisitor, Visitor, snake_case


class Lamp(Leaf):
    """A kind of node that no visitor of the library knows."""


class Recorder(Visitor):
    """Notes what is visited, by which method."""

    def __init__(self, direction: str = "down") -> None:
        super().__init__(direction)  # type: ignore[arg-type]
        self.log: list[str] = []

    def visit_node(self, node: Node) -> None:
        self.log.append(f"node {node.name}")
        self.traverse(node)

    def visit_transform(self, node: PositionAttitudeTransform) -> None:
        self.log.append(f"transform {node.name}")
        self.traverse(node)

    def visit_leaf(self, node: Leaf) -> None:
        self.log.append(f"leaf {node.name}")


def family() -> tuple[Group, PositionAttitudeTransform, Lamp]:
    root = Group(name="root")
    placed = root.attach(PositionAttitudeTransform(name="placed"))
    return root, placed, placed.attach(Lamp(name="lamp"))


@pytest.mark.parametrize(
    ("name", "snake"),
    [
        ("Node", "node"),
        ("QuadTreeSpace", "quad_tree_space"),
        ("PositionAttitudeTransform", "position_attitude_transform"),
        ("MyHTTPNode", "my_http_node"),
        ("Level2Boss", "level2_boss"),
    ],
)
def test_snake_case(name: str, snake: str) -> None:
    """Class names become method names in the usual way."""
    assert snake_case(name) == snake


def test_the_nearest_kind_decides() -> None:
    """A node goes to the method of its own class or of the nearest base that has one."""
    root, _, _ = family()
    recorder = Recorder()
    recorder.visit(root)
    assert recorder.log == ["node root", "transform placed", "leaf lamp"]


def test_a_subclass_with_its_own_method_is_not_misled_by_what_its_base_has_learnt() -> None:
    """Dispatch is remembered per visitor class."""

    class LampRecorder(Recorder):
        def visit_lamp(self, node: Lamp) -> None:
            self.log.append(f"lamp {node.name}")

    root, _, _ = family()
    Recorder().visit(root)
    recorder = LampRecorder()
    recorder.visit(root)
    assert recorder.log[-1] == "lamp lamp"


def test_upwards() -> None:
    """Upwards the walk goes to every parent."""
    _, placed, lamp = family()
    assert lamp.path == "root/placed/lamp"
    other = Group(name="other")
    shared = Node(name="shared")
    placed.attach(shared)
    other.attach(shared)
    recorder = Recorder("up")
    recorder.visit(shared)
    assert recorder.log == ["node shared", "transform placed", "node root", "node other"]


def test_a_method_that_does_not_traverse_keeps_the_walk_out() -> None:
    """What is below a node whose method doesn't go on isn't visited."""

    class Lazy(Recorder):
        def visit_transform(self, node: PositionAttitudeTransform) -> None:
            pass

    root, _, _ = family()
    lazy = Lazy()
    lazy.visit(root)
    assert lazy.log == ["node root"]


def test_a_plain_visitor_reaches_everything() -> None:
    """By default every kind of node is walked through, whether it is shown or not."""
    seen = []

    class Counter(Visitor):
        def visit_node(self, node: Node) -> None:
            seen.append(node)
            self.traverse(node)

    root = Group(visible=False)
    leaf = root.attach(Switch(on=False)).attach(Leaf())
    Counter().visit(root)
    assert len(seen) == 3
    assert seen[-1] is leaf


def test_the_tree_may_change_under_the_walk() -> None:
    """A child detached before its turn is left out, one attached meanwhile waits for the next walk."""

    class Meddler(Recorder):
        def visit_node(self, node: Node) -> None:
            super().visit_node(node)
            if node.name == "a":
                root.detach(b)
                root.attach(Node(name="d"))

    root = Group(name="root")
    for name in "abc":
        root.attach(Node(name=name))
    b = root.children[1]
    meddler = Meddler()
    meddler.visit(root)
    assert meddler.log == ["node root", "node a", "node c"]


def test_unknown_direction_is_refused() -> None:
    """Only up and down exist."""
    with pytest.raises(FieldError, match="sideways"):
        Visitor("sideways")  # type: ignore[arg-type]


# -- updating


def test_callbacks_run_parents_first_and_in_order_of_registration() -> None:
    """One update calls every callback once, also below hidden nodes."""
    log: list[str] = []
    root = Group(name="root", visible=False)
    low = root.attach(Switch(name="switch", on=False)).attach(Node(name="low"))
    low.on_update(lambda node: log.append(f"{node.name} 1"))
    low.on_update(lambda node: log.append(f"{node.name} 2"))
    root.on_update(lambda node: log.append(node.name))
    updater = UpdateVisitor(root)
    updater.update()
    assert log == ["root", "low 1", "low 2"]
    updater.update()
    assert log == ["root", "low 1", "low 2"] * 2


def test_a_shared_node_is_updated_once() -> None:
    """Several parents don't mean several updates."""
    calls: list[Node] = []
    root = Group()
    shared = Node()
    for _ in range(3):
        root.attach(Group()).attach(shared)
    shared.on_update(calls.append)
    UpdateVisitor(root).update()
    assert calls == [shared]


def test_registering_later_is_noticed() -> None:
    """Callbacks registered and removed after the first update count from the next."""
    calls: list[Node] = []
    root = Group()
    node = root.attach(Node())
    updater = UpdateVisitor(root)
    updater.update()
    callback = node.on_update(calls.append)
    updater.update()
    assert calls == [node]
    node.remove_on_update(callback)
    updater.update()
    assert calls == [node]


def test_a_quiet_tree_is_walked_once() -> None:
    """Without a change the tree isn't walked again."""
    walks = []

    class Watched(UpdateVisitor):
        def visit_node(self, node: Node) -> None:
            walks.append(node)
            super().visit_node(node)

    root = Group()
    updater = Watched(root)
    updater.update()
    updater.update()
    assert walks == [root]
    added = root.attach(Node())
    updater.update()
    assert walks == [root, root, added]


def test_callbacks_may_change_the_tree() -> None:
    """What a callback detaches, and what is below it, is not called any more; what it attaches is called next time."""
    log: list[str] = []
    root = Group(name="root")
    first = root.attach(Node(name="first"))
    doomed = root.attach(Group(name="doomed"))
    below = doomed.attach(Node(name="below"))
    last = root.attach(Node(name="last"))
    fresh = Node(name="fresh")
    for node in (first, doomed, below, last, fresh):
        node.on_update(lambda node: log.append(node.name))

    def meddle(_: Node) -> None:
        if doomed.parents:
            root.detach(doomed)
            root.attach(fresh)

    first.on_update(meddle)
    updater = UpdateVisitor(root)
    updater.update()
    assert log == ["first", "last"]
    log.clear()
    updater.update()
    assert log == ["first", "last", "fresh"]


def test_a_callback_may_remove_itself() -> None:
    """Removing a callback from within doesn't skip the one after it."""
    log: list[str] = []
    node = Node()

    def once(node: Node) -> None:
        log.append("once")
        node.remove_on_update(once)

    node.on_update(once)
    node.on_update(lambda _: log.append("always"))
    updater = UpdateVisitor(node)
    updater.update()
    updater.update()
    assert log == ["once", "always", "always"]


def test_an_error_names_the_node() -> None:
    """An error in a callback reaches the caller as it is, with the node's path noted; the next update works."""
    root = Group(name="root")
    node = root.attach(Node(name="bad"))
    calls: list[Node] = []

    @node.on_update
    def fail(_: Node) -> None:
        if not calls:
            calls.append(node)
            raise KeyError("oops")

    updater = UpdateVisitor(root)
    with pytest.raises(KeyError, match="oops") as caught:
        updater.update()
    assert caught.value.__notes__ == ["in the update callback of root/bad"]
    updater.update()


def test_nothing_detached_is_kept_alive() -> None:
    """After an update, a node that has left the tree can be collected."""
    root = Group()
    node = root.attach(Node())
    node.on_update(lambda _: None)
    updater = UpdateVisitor(root)
    updater.update()
    root.detach(node)
    updater.update()
    gone = weakref.ref(node)
    del node
    gc.collect()
    assert gone() is None
