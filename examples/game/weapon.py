"""What all weapons have in common: they lie about until somebody touches them, and are then held in a hand.

A weapon is held by a ball joint at its grip and an angular motor with a stop at 0 on each of the hand's three axes. The
stops are springs, so it follows the hand with a little give; put away, it is out of the simulation altogether.
"""

from __future__ import annotations

import math
from typing import ClassVar, Protocol, TypeAlias, runtime_checkable

import osgode as oo
from osgode.engine import CompositeObject, ControllableObject, carrier_of

TOUCH = 0.55
"""How near to its middle something of whoever picks it up must come, metres: about as far as an arm sinks."""
LOOK_EVERY = 6
"""Steps from one look for a taker to the next."""
PICKERS = ("player",)
"""The kinds of objects that pick weapons up."""
SOLID = ("default", "player", "vehicle", "weapon")
"""The kinds of objects that can be aimed at: not what is shot, and not explosions."""
AGAIN = 1.5
"""Seconds before a weapon that was dropped can be picked up again."""
STIFFNESS = 900.0
"""Of the springs that turn it as the hand is turned, N m/rad."""
DAMPING = 18.0
"""Of these springs, N m s/rad."""
HOLD_ERP, HOLD_CFM = 0.6, 1e-7
"""Of the ball joint that holds it: stiff, since the eye is near."""
RECOIL_TIME = 0.05
"""How long a recoil pushes, seconds."""
AIM_REACH = 1000.0
"""How far away something can be aimed at, metres."""
NEAREST = 0.5
"""How far beyond the muzzle a target must be to be aimed at itself, metres; nearer it is shot straight ahead."""

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO = oo.Vec3(0.0, 0.0, 0.0)
Aim: TypeAlias = tuple[oo.Vec3, oo.Vec3]
"""Where the aiming ray begins, metres in the world, and its direction."""


@runtime_checkable
class Picker(Protocol):
    """Something that takes weapons that it touches."""

    def pick_up(self, weapon: Weapon) -> object:
        """Take it, or leave it."""


class Weapon(CompositeObject):
    """A weapon: its first body is the one that is held, and looks along its own -Z.

    A subclass builds its parts in ``__init__``, says how they are held, and acts in `fire`.

    Args:
        name: for messages and paths.
    """

    SLOT: ClassVar[int] = 0
    """The key that takes it into the hand."""
    TITLE: ClassVar[str] = "weapon"
    """What the player calls it."""
    GRIP: ClassVar[oo.Pose] = oo.Pose()
    """Where it is taken hold of, and how the hand is turned there, in the axes of its first body."""
    FULL_CHARGE: ClassVar[float] = 1.5
    """Seconds of holding a button after which more makes no difference."""

    def __init__(self, *, name: str = "weapon") -> None:
        super().__init__(name=name)
        self._hand: oo.Body | None = None
        self._at = ZERO
        self._stowed = False
        self._held: oo.Ball | None = None
        self._motor: oo.AngularMotor | None = None
        self._pressed: dict[str, int] = {}
        self._recoil: list[oo.Vec3] = []
        self._ready = 0

    # -- where it is

    @property
    def hand(self) -> oo.Body | None:
        """The body that holds it, also while it is put away; None while it lies about."""
        return self._hand

    @property
    def held(self) -> bool:
        """Whether it is in a hand now."""
        return self._held is not None and self._held.is_live

    @property
    def stowed(self) -> bool:
        """Whether it is put away."""
        return self._stowed

    @property
    def carrier(self) -> ControllableObject | None:
        """Whom the hand belongs to."""
        return None if self._hand is None else carrier_of(self._hand)

    @property
    def own(self) -> list[oo.PhysicsNode]:
        """The weapon and whoever holds it: what its shots leave alone."""
        holder = self.carrier or self._hand
        return [self] if holder is None else [self, holder]

    def entered(self) -> None:
        """Look for a taker, or follow the hand, from now on."""
        self.schedule(_tick)

    # -- in the hand

    def hold(self, hand: oo.Body, grip: oo.Vec3Like = (0.0, 0.0, 0.0)) -> None:
        """Come into a hand.

        Args:
            hand: a body of the same World, which looks along its own -Z.
            grip: where in the hand's axes, metres.

        Raises:
            StateError: if somebody has it already, or the hand is not in its World.
        """
        if self._hand is not None:
            raise oo.StateError(f"{self.describe()}.hold(): {self._hand.describe()} has it already; drop it first")
        if hand.world is None or hand.world is not self.world:
            raise oo.StateError(f"{self.describe()}.hold(): {hand.describe()} is not in the same World")
        self._hand, self._at = hand, oo.Vec3(*grip)
        self._grasp(hand)

    def stow(self) -> None:
        """Put it away: out of the simulation, and out of sight; nothing happens if it is away.

        Raises:
            StateError: if nobody has it.
        """
        if self._hand is None:
            raise oo.StateError(f"{self.describe()}.stow(): nobody has it")
        if not self._stowed:
            self._let_loose()
            self.leave()
            self._stowed = True

    def draw(self) -> None:
        """Take it into the hand again; nothing happens if it is there.

        Raises:
            StateError: if nobody has it, or the hand is in no World.
        """
        if self._hand is None or not self._hand.is_live:
            raise oo.StateError(f"{self.describe()}.draw(): there is no hand that could take it")
        if self._stowed:
            self._join_up(self._hand)
            self.enter()
            self._stowed = False
            self._grasp(self._hand)

    def drop(self) -> None:
        """Let it fall where the hand is; it can be picked up again after a while. Nothing happens if nobody has it."""
        if self._hand is None:
            return
        if self._stowed:
            self._join_up(self._hand)
            self.enter()
            self._stowed = False
        self._let_loose()
        self._hand = None
        if self.world is not None:
            self._ready = self.world.steps + round(AGAIN / self.world.step_size)

    def _join_up(self, hand: oo.Body) -> None:
        """Come to the hand, and move as it does."""
        self.place(hand.pose * oo.Pose(self._at) * self.GRIP.inverse(), at_rest=True)
        for body in self.bodies:
            body.linear_velocity, body.angular_velocity = hand.velocity_at(body.position), hand.angular_velocity

    def _grasp(self, hand: oo.Body) -> None:
        body = self.main_body
        self._join_up(hand)
        self._held = oo.Ball(
            body, hand, anchor=hand.local_to_world(self._at), erp=HOLD_ERP, cfm=HOLD_CFM, name=f"{self.name} in hand"
        )
        self._motor = oo.AngularMotor(
            body,
            hand,
            axes=[hand.vector_to_world(axis) for axis in AXES],
            relative_to="body2",
            stops1=(0.0, 0.0),
            stops2=(0.0, 0.0),
            stops3=(0.0, 0.0),
            stop_stiffness1=STIFFNESS,
            stop_stiffness2=STIFFNESS,
            stop_stiffness3=STIFFNESS,
            stop_damping1=DAMPING,
            stop_damping2=DAMPING,
            stop_damping3=DAMPING,
            name=f"{self.name} as the hand",
        )
        self.on_collide(self._spare)

    def _let_loose(self) -> None:
        for joint in (self._held, self._motor):
            if joint is not None:
                joint.release()
        if self._held is not None:
            self.remove_on_collide(self._spare)
        self._held = self._motor = None
        self._pressed.clear()
        self._recoil.clear()

    def _spare(self, feedback: oo.CollisionFeedback) -> None:
        """It passes through whoever holds it."""
        if is_part_of(feedback.other, self.own):
            feedback.refuse()

    def _follow(self, hand: oo.Body, motor: oo.AngularMotor) -> None:
        """Tell the motor how far the weapon is turned against the hand: the vector of its rotation."""
        turn = hand.rotation.conjugate() * self.main_body.rotation * self.GRIP.rotation
        sine = oo.Vec3(turn.x, turn.y, turn.z)
        angle = math.remainder(2.0 * math.atan2(sine.length, turn.w), math.tau)
        vector = sine * (angle / sine.length) if sine.length > 1e-12 else ZERO
        motor.user_angle1, motor.user_angle2, motor.user_angle3 = vector

    # -- buttons

    def press(self, button: str) -> None:
        """A button, "left" or "right", goes down; nothing happens unless it is in a hand."""
        world = self.world
        if self.held and world is not None:
            self._pressed[button] = world.steps

    def release(self, button: str, aim: Aim) -> None:
        """The button comes up: `fire` with the charge that the time between was worth.

        Args:
            button: which one.
            aim: origin and direction of the camera's aiming ray.
        """
        charge = self.charge(button)
        if self._pressed.pop(button, None) is not None and self.held:
            self.fire(button, charge, aim)

    def charge(self, button: str) -> float:
        """How far it is charged, 0 to 1, by the steps since the button went down; a single one at least."""
        pressed, world = self._pressed.get(button), self.world
        if pressed is None or world is None:
            return 0.0
        return min(max(world.steps - pressed, 1) * world.step_size / self.FULL_CHARGE, 1.0)

    @property
    def charging(self) -> bool:
        """Whether a button is down."""
        return bool(self._pressed)

    def fire(self, button: str, charge: float, aim: Aim) -> None:
        """What it does. Nothing unless a subclass does something.

        Args:
            button: "left" or "right".
            charge: 0 to 1.
            aim: origin and direction of the aiming ray.
        """

    def recoil(self, impulse: oo.Vec3Like) -> None:
        """Be pushed by so many N s (world axes) at the grip, spread over `RECOIL_TIME`.

        Raises:
            StateError: outside of a World.
        """
        if self.world is None:
            raise oo.StateError(f"{self.describe()}.recoil(): it is in no World")
        count = max(round(RECOIL_TIME / self.world.step_size), 1)
        push = oo.Vec3(*impulse) / (count * self.world.step_size)
        pushes = self._recoil
        pushes.extend([ZERO] * (count - len(pushes)))
        for k in range(count):
            pushes[k] += push

    # -- aiming

    def target(self, aim: Aim) -> oo.Vec3:
        """The point that the aiming ray meets, or its far end; whoever holds the weapon is looked through."""
        origin, direction = oo.Vec3(*aim[0]), oo.Vec3(*aim[1]).normalized()
        world = self._world("target")
        hit = world.cast_ray(origin, direction, AIM_REACH, kinds=SOLID, exclude=self.own)
        return origin + direction * AIM_REACH if hit is None else hit.point

    def line_of_fire(self, aim: Aim, muzzle: oo.Vec3Like, radius: float) -> oo.Pose:
        """Where something as large as a ball is shot from, and how it must be turned to fly along its -Z to the target.

        It begins in front of the muzzle, but never behind what the muzzle itself has been put through.

        Args:
            aim: origin and direction of the aiming ray.
            muzzle: in the axes of its first body, metres.
            radius: of what is shot, metres.
        """
        origin, direction = oo.Vec3(*aim[0]), oo.Vec3(*aim[1]).normalized()
        body, world = self.main_body, self._world("line_of_fire")
        way = body.local_to_world(oo.Vec3(*muzzle) + oo.Vec3(0.0, 0.0, -radius)) - origin
        found = world.sweep(oo.Sphere(radius), origin, way, kinds=SOLID, exclude=self.own)
        start = origin + way * (1.0 if found is None else found.fraction)
        line = self.target(aim) - start
        line = line if line.dot(direction) > NEAREST else direction
        return oo.look_at(start, start + line) if abs(line.normalized().y) < 0.999 else _upright(start, line)

    def _world(self, doing: str) -> oo.World:
        if self.world is None:
            raise oo.StateError(f"{self.describe()}.{doing}(): it is in no World")
        return self.world

    # -- each step

    def tick(self) -> None:
        """Called after each step in a World; a subclass that overrides it calls this one too."""
        if self._hand is None:
            self._look_for_a_taker()
        elif self._motor is None or not self.held:  # the hand has left the World
            self.drop()
        else:
            self._follow(self._hand, self._motor)
            if self._recoil:
                self.main_body.add_force(self._recoil.pop(0), at=self.main_body.local_to_world(self.GRIP.position))

    def _look_for_a_taker(self) -> None:
        world, space = self._world("tick"), self.space
        if space is None or world.steps % LOOK_EVERY or world.steps < self._ready:
            return
        for hit in space.overlaps(oo.Sphere(TOUCH), self.main_body.position, kinds=PICKERS):
            taker = carrier_of(hit.geom)
            if isinstance(taker, Picker):
                taker.pick_up(self)
                if self._hand is not None:
                    return


def _tick(weapon: Weapon) -> bool:
    weapon.tick()
    return True


def _upright(start: oo.Vec3, line: oo.Vec3) -> oo.Pose:
    return oo.Pose(start, oo.Quat.between((0.0, 0.0, -1.0), line))


def is_part_of(node: oo.PhysicsNode, things: list[oo.PhysicsNode]) -> bool:
    """Whether a node is one of these things, or below one of them."""
    return any(each is thing for each in (node, *node.ancestors) for thing in things)
