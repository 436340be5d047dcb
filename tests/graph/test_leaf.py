"""Leaves and switches."""

from __future__ import annotations

import pytest

from osgode.errors import TreeError
from osgode.graph.drawable import Drawable
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.node import Group, Node
from osgode.graph.primitives import box_mesh


def test_a_plain_node_shows_nothing() -> None:
    """Nodes and groups have no drawables of their own."""
    assert list(Node().drawables()) == []
    assert list(Group().drawables()) == []


def test_leaf_keeps_the_order_of_its_drawables() -> None:
    """Drawables are listed as given, then as added."""
    a, b, c = (Drawable(box_mesh()) for _ in range(3))
    leaf = Leaf([b, a])
    assert leaf.add_drawable(c) is c
    assert leaf.drawables() == (b, a, c)


def test_removing_one_of_two_equal_drawables_leaves_one() -> None:
    """A drawable added twice is removed once at a time."""
    a, b = Drawable(box_mesh()), Drawable(box_mesh())
    leaf = Leaf([a, b, a])
    assert leaf.remove_drawable(a) is a
    assert leaf.drawables() == (b, a)


def test_removing_a_stranger_is_refused() -> None:
    """Removing what isn't shown raises, names the leaf, and changes nothing."""
    leaf = Leaf([Drawable(box_mesh())], name="crate")
    before, revision = leaf.drawables(), leaf._revision
    with pytest.raises(TreeError, match="crate"):
        leaf.remove_drawable(Drawable(box_mesh()))
    assert leaf.drawables() == before
    assert leaf._revision == revision


def test_changes_reach_the_root() -> None:
    """Adding, removing and switching are noted above, setting a switch to what it is already is not."""
    root = Group()
    switch = root.attach(Switch())
    leaf = switch.attach(Leaf())
    seen = [root._revision]
    drawable = leaf.add_drawable(Drawable(box_mesh()))
    seen.append(root._revision)
    leaf.remove_drawable(drawable)
    seen.append(root._revision)
    switch.on = False
    seen.append(root._revision)
    assert sorted(set(seen)) == seen
    switch.on = False
    assert root._revision == seen[-1]


def test_a_leaf_may_stand_under_several_groups() -> None:
    """One leaf can be shown in many places."""
    a, b = Group(), Group()
    leaf = Leaf()
    a.attach(leaf)
    b.attach(leaf)
    assert leaf.parents == (a, b)
