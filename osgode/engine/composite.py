"""Several bodies as one thing: to hide, to take out of the simulation, to steer."""

from __future__ import annotations

from typing import ClassVar

from osgode.engine.controllable import Controllable
from osgode.errors import StateError, TreeError
from osgode.graph.node import Group
from osgode.joints.base import Joint
from osgode.maths import Pose, Vec3
from osgode.nodes.base import PhysicsNode, physics_nodes
from osgode.nodes.body import Body
from osgode.nodes.geom import Geom
from osgode.nodes.spaces import SimpleSpace


class CompositeObject(SimpleSpace):
    """A space whose bodies, joints and scheduled calls are one thing of a game: a car, a door, a weapon.

    Subclass it and build the parts in ``__init__``, or attach them. Its first body is what its place is told by.
    `visible` hides all of it. A new part may come at any time.
    """

    def _start(self) -> None:
        super()._start()
        self._home: Group | None = None
        self._muted: tuple[Geom, ...] | None = None

    # -- what it is made of

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies below it, in the order of the tree."""
        return tuple(node for node in physics_nodes(self) if isinstance(node, Body))

    @property
    def geoms(self) -> tuple[Geom, ...]:
        """All geoms below it, in the order of the tree."""
        return tuple(node for node in physics_nodes(self) if isinstance(node, Geom))

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
        body = next((node for node in physics_nodes(self) if isinstance(node, Body)), None)
        if body is None:
            raise StateError(f"{self.describe()} has no body yet; attach one")
        return body

    # -- all of it as one

    @property
    def collides(self) -> bool:
        """Whether its geoms meet others; switched off, each is disabled, and switched on, those are enabled again."""
        return self._muted is None

    @collides.setter
    def collides(self, value: bool) -> None:
        if bool(value) == self.collides:
            return
        if value:
            muted, self._muted = self._muted or (), None
            for geom in muted:
                geom.enabled = True
        else:
            self._muted = tuple(geom for geom in self.geoms if geom.enabled)
            for geom in self._muted:
                geom.enabled = False

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
            self._home = home

    def enter(self, parent: Group | None = None, pose: Pose | None = None) -> None:
        """Come back to where it left, or below ``parent``.

        Args:
            parent: what it is attached to; where it stood when it left if not given.
            pose: where its first body shall be; all of it is moved along, see `place`.

        Raises:
            TreeError: if it is in already, or there is no place to come back to.
        """
        home = self._home if parent is None else parent
        if home is None:
            raise TreeError(f"{self.describe()}.enter(): it has not stood anywhere yet; say which parent")
        if self.parent is not None:
            raise TreeError(f"{self.describe()}.enter(): it stands under {self.parent.describe()} already")
        before = [(body, body.pose, body.linear_velocity, body.angular_velocity) for body in self.bodies]
        if pose is not None:
            self.place(pose)
        try:
            home.attach(self)
        except BaseException:
            for body, old, linear, angular in before:
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
        others are strained. Nothing is looked at that stands in the way.
        """
        first = self.main_body.pose
        turn = pose.rotation * first.rotation.conjugate()
        motion = Pose(pose.position - turn.rotate(first.position), turn)
        for body in self.bodies:
            linear, angular = turn.rotate(body.linear_velocity), turn.rotate(body.angular_velocity)
            body.position, body.rotation = motion * body.pose
            still = Vec3(0.0, 0.0, 0.0)
            body.linear_velocity, body.angular_velocity = (still, still) if at_rest else (linear, angular)


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
        """Called when the camera leaves; nobody steers it then."""
        self.controls.stop()

    def _entered(self) -> None:
        super()._entered()
        self.schedule(_control, priority=self.CONTROL_PRIORITY)


def _control(thing: ControllableObject) -> bool:
    thing.control()
    return True


def carrier_of(node: PhysicsNode) -> ControllableObject | None:
    """The controllable object that a node is a part of, or None."""
    return next((each for each in (node, *node.ancestors) if isinstance(each, ControllableObject)), None)
