"""What all assemblies have in common: bodies and joints that come and go together."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Generic, Self, TypedDict, TypeVar

from osgode.errors import FieldError, TreeError, shown
from osgode.fields import Check, number
from osgode.graph.appearance import Appearance
from osgode.graph.drawable import Drawable
from osgode.graph.node import Group
from osgode.joints.base import Joint
from osgode.materials import Surface
from osgode.maths import ZERO, Vec3
from osgode.nodes.body import Body
from osgode.nodes.spaces import Space
from osgode.nodes.world import World

MASS: Check[float] = number(1e-9, 1e12)


class CollisionFields(TypedDict, total=False):
    """The keyword arguments of builders that go on to every geom."""

    material: str
    kind: str
    collides_with: str | set[str] | frozenset[str] | tuple[str, ...] | list[str] | None
    surface: Surface | None


class PartFields(CollisionFields, total=False):
    """The same with how the geoms look."""

    appearance: Appearance | None
    shown: Sequence[Drawable] | Drawable | None


TopT = TypeVar("TopT", bound=Space | Body)


class Assembly(Generic[TopT]):
    """Bodies and joints that were built together.

    It is no node and owns nothing: its bodies stand in the tree as all others do, below `top`, and can be changed,
    taken away and added to there. `attach`, `detach` and `move_to` are those of `top`.

    Args:
        top: the node that all of it stands below: a space of its own, or its only body.
        bodies: in an order that its builder documents.
        joints: the same.
    """

    def __init__(self, top: TopT, bodies: Sequence[Body], joints: Sequence[Joint]) -> None:
        self._top = top
        self._bodies = tuple(bodies)
        self._joints = tuple(joints)

    def describe(self) -> str:
        """What messages call it."""
        return f"{type(self).__name__} {self._top.name!r}" if self._top.name else type(self).__name__

    def __repr__(self) -> str:
        return f"<{self.describe()}: {len(self._bodies)} bodies, {len(self._joints)} joints>"

    # -- what it is made of

    @property
    def top(self) -> TopT:
        """The node that all of it stands below."""
        return self._top

    @property
    def bodies(self) -> tuple[Body, ...]:
        """Its bodies."""
        return self._bodies

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Its joints, also those that have been released since."""
        return self._joints

    def body(self, name: str) -> Body:
        """The body of this name.

        Raises:
            FieldError: if there is none.
        """
        return _named(self, "body", self._bodies, name)

    def joint(self, name: str) -> Joint:
        """The joint of this name.

        Raises:
            FieldError: if there is none.
        """
        return _named(self, "joint", self._joints, name)

    @property
    def mass(self) -> float:
        """Of all its bodies, kg."""
        return sum(body.mass for body in self._bodies)

    @property
    def centre_of_mass(self) -> Vec3:
        """Of all its bodies, in the world, metres."""
        return sum((body.world_centre_of_mass * body.mass for body in self._bodies), ZERO) / self.mass

    @property
    def error(self) -> float:
        """How far apart the worst of its joints is where it should hold together, metres."""
        return max((joint.error for joint in self._joints if not joint.released), default=0.0)

    # -- where it stands

    @property
    def parent(self) -> Group | None:
        """What it stands under, or None."""
        return self._top.parent

    @property
    def is_live(self) -> bool:
        """Whether it is in a World."""
        return self._top.is_live

    def attach(self, parent: Group) -> Self:
        """Stand below ``parent``, with the state that it left with; returns self.

        Raises:
            TreeError: if a tree rule forbids it, or it stands somewhere already.
        """
        _group(self, "attach", parent).attach(self._top)
        return self

    def detach(self) -> Self:
        """Leave the tree with all its bodies, which keep their state; returns self. A second time does nothing."""
        if self._top.parent is not None:
            self._top.parent.detach(self._top)
        return self

    def move_to(self, parent: Group) -> Self:
        """Stand below ``parent`` instead, and return self.

        In the same World nothing is destroyed. To another World it goes with its state and its joints; a joint to a
        body that isn't part of it lets go until both are in one World again.

        Raises:
            TreeError: if a tree rule forbids it; nothing is changed then.
        """
        self._top.move_to(parent)
        return self

    def wake(self) -> None:
        """Let all of it move again if it has fallen asleep."""
        for body in self._bodies:
            body.wake()


PartT = TypeVar("PartT", Body, Joint)


def _named(owner: Assembly[TopT], what: str, parts: Sequence[PartT], name: object) -> PartT:
    for part in parts:
        if part.name == name:
            return part
    names = [part.name for part in parts]
    close = difflib.get_close_matches(str(name), names, 1)
    hint = f"; did you mean {close[0]!r}?" if close else f"; it has {', '.join(map(repr, names))}"
    raise FieldError(f"{owner.describe()} has no {what} {shown(name)}{hint}")


def _group(owner: Assembly[TopT], doing: str, parent: object) -> Group:
    if not isinstance(parent, Group):
        raise TreeError(f"{owner.describe()}.{doing}(): {shown(parent)} is no Group")
    return parent


JointT = TypeVar("JointT", bound=Joint)


class Joining:
    """Joints that are being made: all of them, or, if anything fails, none."""

    def __init__(self) -> None:
        self.joints: list[Joint] = []

    @classmethod
    @contextmanager
    def begin(cls) -> Iterator[Self]:
        """Release what has been added if the block raises."""
        joining = cls()
        try:
            yield joining
        except BaseException:
            for joint in joining.joints:
                joint.release()
            raise

    def add(self, joint: JointT) -> JointT:
        """Count a new joint in."""
        self.joints.append(joint)
        return joint


def check_parent(call: str, parent: object) -> Space | World:
    """What the space of an assembly may be built into; looked at before anything is made.

    Raises:
        TreeError: if it is no Space or World.
    """
    if not isinstance(parent, Space | World):
        raise TreeError(f"{call}.parent is {shown(parent)}; it must be a Space or a World")
    return parent
