"""Several bodies as one thing: to hide, to take out of the simulation, to steer."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple, Self

from osgode.engine.controllable import Controllable
from osgode.errors import FieldError, StateError, TreeError, shown
from osgode.fields import FLAG, POSITION_LIMIT, ROTATION, vector
from osgode.graph.node import Group
from osgode.joints.base import Joint
from osgode.maths import ZERO, Pose
from osgode.nodes.base import PhysicsNode, physics_nodes
from osgode.nodes.body import Body
from osgode.nodes.geom import Geom
from osgode.nodes.spaces import SimpleSpace

POSITION = vector(POSITION_LIMIT)


class _Known(NamedTuple):
    """What is below a composite object, in the order of the tree."""

    nodes: tuple[PhysicsNode, ...]
    bodies: tuple[Body, ...]
    geoms: tuple[Geom, ...]


class CompositeObject(SimpleSpace):
    """A space whose bodies, joints and scheduled calls are one thing of a game: a car, a door, a weapon.

    Subclass it and build the parts in ``__init__``, or attach them. Its first body is what its place is told by.
    `visible` hides all of it. Parts may come and go at any time.
    """

    def _start(self) -> None:
        super()._start()
        self._home: weakref.ref[Group] | None = None
        self._off = False
        self._muted: dict[Geom, None] = {}

    _known: _Known | None = None
    """What was found below it since something last came or went: controllers ask in each step."""

    def _parts(self) -> Sequence[PhysicsNode]:
        return self._found.nodes

    @property
    def _found(self) -> _Known:
        known = self._known
        if known is None:
            nodes = tuple(super()._parts())
            bodies = tuple(node for node in nodes if isinstance(node, Body))
            known = self._known = _Known(nodes, bodies, tuple(node for node in nodes if isinstance(node, Geom)))
        return known

    def _forget_parts(self) -> None:
        self._known = None
        super()._forget_parts()

    def copy(self) -> Self:
        """A new one outside of any World, with copies of its parts and of their joints, but for those to other bodies.

        Attributes of a subclass are taken over: those that are a part, or a list, tuple or dict of parts, are the
        copy's own; ``__init__`` is not run.
        """
        twin = super().copy()
        parts: dict[int, Any] = {
            id(node): new for node, new in zip(physics_nodes(self), physics_nodes(twin), strict=True)
        }
        inner = [node for node in physics_nodes(self) if isinstance(node, CompositeObject) and node is not self]
        done = {joint for node in inner for joint in node._own_joints()}  # by their own `copy`
        for joint in self._own_joints():
            if joint not in done:
                parts[id(joint)] = joint.copy(*(parts[id(body)] for body in joint._bodies))
        twin._off = self._off
        twin._muted = {parts[id(geom)]: None for geom in self._muted}
        for name, value in vars(self).items():
            if name not in vars(twin) and not hasattr(CompositeObject, name):
                vars(twin)[name] = _translated(value, parts)
        return twin

    def _own_joints(self) -> list[Joint]:
        bodies = set(self.bodies)
        return [joint for joint in self.joints if bodies.issuperset(joint._bodies)]

    # -- what it is made of

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies below it, in the order of the tree."""
        return self._found.bodies

    @property
    def geoms(self) -> tuple[Geom, ...]:
        """All geoms below it, in the order of the tree."""
        return self._found.geoms

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The joints of its bodies, also those to others or to the static world."""
        return tuple(dict.fromkeys(joint for body in self.bodies for joint in body.joints))

    @property
    def main_body(self) -> Body:
        """Its first body.

        Raises:
            StateError: if it has none.
        """
        bodies = self._found.bodies
        if not bodies:
            raise StateError(f"{self.describe()} has no body yet; attach one")
        return bodies[0]

    # -- all of it as one

    @property
    def collides(self) -> bool:
        """Whether its geoms meet others.

        Switched off, each geom that is enabled is disabled, also one that comes later; switched on, or taken away from
        here, these are enabled again, unless another composite object around them is off.
        """
        return not self._off

    @collides.setter
    def collides(self, value: bool) -> None:
        self._off = not FLAG(self.describe(), "collides", value)
        self._mute()

    def _mute(self) -> None:
        """Disable the geoms that are to be, and enable those that need not be any more."""
        wanted = dict.fromkeys(self.geoms if self._off else ())
        for geom in [geom for geom in self._muted if geom not in wanted]:
            del self._muted[geom]
            above = (node for node in geom.ancestors if isinstance(node, CompositeObject) and node._off)
            other = next(above, None)
            if other is None:
                geom.enabled = True
            else:
                other._muted[geom] = None
        for geom in wanted:
            if geom.enabled:
                geom.enabled = False
                self._muted[geom] = None

    def _touch(self) -> None:
        super()._touch()
        if self._off:  # a part may have come or gone
            self._mute()

    @property
    def recentring(self) -> bool:
        """Whether every body follows its parts with its centre of mass by itself (`Body.auto_recentre`)."""
        return all(body.auto_recentre for body in self.bodies)

    @recentring.setter
    def recentring(self, value: bool) -> None:
        for body in self.bodies:
            body.auto_recentre = value

    def recentre(self) -> None:
        """Bring the centre of mass of every body to that of its parts."""
        for body in self.bodies:
            body.recentre()

    # -- in and out of the simulation

    def entered(self) -> None:
        """Called when all of it has come into a World: the place to `schedule` what it does there.

        Nothing unless a subclass does something. What it raises undoes the attaching.
        """

    def _entered(self) -> None:
        super()._entered()
        self.entered()

    @property
    def in_simulation(self) -> bool:
        """Whether it is in a World."""
        return self.is_live

    def leave(self) -> None:
        """Go out of the tree, and so out of the simulation and the picture; nothing happens if it is out already.

        All state stays, that of the joints within it too; its scheduled calls are dropped.
        """
        home = self.parent
        if home is not None:
            home.detach(self)
            self._home = weakref.ref(home)

    def enter(self, parent: Group | None = None, pose: Pose | None = None) -> None:
        """Come back to where it left, or below ``parent``.

        Args:
            parent: what it is attached to; where it stood when it left if not given.
            pose: where its first body shall be; all of it is moved along, see `place`.

        Raises:
            TreeError: if it is in already, or there is no place to come back to; nothing is changed then.
            FieldError: for a pose that is none; nothing is changed then.
        """
        name = f"{self.describe()}.enter()"
        home = parent
        if home is None:
            home = None if self._home is None else self._home()
        if home is None:
            gone = "it has not left anywhere yet" if self._home is None else "what it stood under is gone"
            raise TreeError(f"{name}: {gone}; say which parent")
        if not isinstance(home, Group):
            raise TreeError(f"{name}: {shown(home)} is no Group")
        if self.parent is not None:
            raise TreeError(f"{name}: it stands under {self.parent.describe()} already")
        before = [(body, body.pose, body.linear_velocity, body.angular_velocity) for body in self.bodies]
        if pose is not None:
            self.place(pose)
        try:
            home.attach(self)
        except BaseException:
            for body, old, linear, angular in before if pose is not None else ():
                body.position, body.rotation = old
                body.linear_velocity, body.angular_velocity = linear, angular
            raise
        self._home = None

    @property
    def pose(self) -> Pose:
        """Where its first body is."""
        return self.main_body.pose

    def place(self, pose: Pose, *, at_rest: bool = False) -> None:
        """Put its first body there, and all others where they then are as seen from it.

        Joints between its bodies keep their angles, and velocities are turned along, or are none ``at_rest``. Joints to
        others, and to the static world, are strained, and geometry that is in no body stays. Nothing is looked at that
        stands in the way.

        Raises:
            FieldError: for a pose that is none, or that puts a body out of bounds; nothing is changed then.
            StateError: if it has no body.
        """
        name = f"{self.describe()}.place()"
        try:
            position, rotation = pose
        except (TypeError, ValueError) as error:
            raise FieldError(f"{name}: pose is {shown(pose)}; it must be a Pose") from error
        wanted = Pose(POSITION(name, "pose.position", position), ROTATION(name, "pose.rotation", rotation))
        first = self.main_body.pose
        turn = wanted.rotation * first.rotation.conjugate()
        motion = Pose(wanted.position - turn.rotate(first.position), turn)
        moved = [(body, motion * body.pose) for body in self.bodies]
        for body, new in moved:
            POSITION(body.describe(), "position", new.position)
        for body, new in moved:
            linear, angular = turn.rotate(body.linear_velocity), turn.rotate(body.angular_velocity)
            body.position, body.rotation = new
            body.linear_velocity, body.angular_velocity = (ZERO, ZERO) if at_rest else (linear, angular)


class ControllableObject(CompositeObject):
    """One that a camera can ride, and that a player or a program steers.

    A subclass overrides `control`, which is called after each step, and reads `controls` there; whether they were set
    by a camera, by keys or by a program is no matter to it.
    """

    EYE: ClassVar[Pose] = Pose()
    """Where the eye of a rider is, in the axes of the first body."""
    CONTROL_PRIORITY: ClassVar[int] = 100
    """The priority of `control` among the scheduled calls."""

    def _start(self) -> None:
        super()._start()
        self.controls = self.make_controls()
        """What it shall do."""

    def make_controls(self) -> Controllable:
        """Its controls; a subclass may give them other limits."""
        return Controllable()

    def control(self) -> None:
        """Act on `controls`: set motors, add forces. Nothing unless a subclass does something."""

    def eye_pose(self, interpolation: float = 1.0) -> Pose:
        """Where a rider looks from, in the world; ``interpolation`` as in `World.interpolated_poses`."""
        return self.main_body.interpolated_pose(interpolation) * self.EYE

    def boarded(self) -> None:
        """Called when a camera begins to ride it."""

    def left(self) -> None:
        """Called when the camera leaves; nobody steers it then. It may be in no World any more, and without a body."""
        self.controls.stop()

    def _entered(self) -> None:
        self.schedule(_control, priority=self.CONTROL_PRIORITY)  # first: `entered` may take it out again
        super()._entered()


def _translated(value: Any, parts: dict[int, Any]) -> Any:
    """What a copy has as an attribute: its own part instead of that of the original, also in a list, tuple or dict."""
    if isinstance(value, dict):
        return {key: parts.get(id(part), part) for key, part in value.items()}
    if type(value) in (list, tuple, set):
        return type(value)(parts.get(id(part), part) for part in value)
    return parts.get(id(value), value)


def _control(thing: ControllableObject) -> bool:
    thing.control()
    return True


def carrier_of(node: PhysicsNode) -> ControllableObject | None:
    """The controllable object that a node is a part of, or None."""
    return next((each for each in (node, *node.ancestors) if isinstance(each, ControllableObject)), None)
