"""The player: an upright capsule borne by a ray, with two arms that follow the eyes.

There are no legs to stumble over. A ray from the middle of the torso looks for the ground; a spring as soft as a knee
holds the torso above what it finds, so steps and bumps are climbed smoothly, and what is under the feet is pressed by
as much. Walking pushes torso and ground apart along the ground.
"""

from __future__ import annotations

import math

import numpy as np

import osgode as oo
from osgode.engine import Controllable, ControllableObject
from osgode.examples.game.arsenal import Arsenal
from osgode.examples.game.weapon import Weapon
from osgode.examples.runner import painted

RADIUS, HEIGHT = 0.3, 1.5
"""Of the torso's capsule, metres, its round ends included."""
STEP_HEIGHT = 0.35
"""How high a step may be that is climbed, metres."""
ROUND = 0.15
"""How much of that the torso's round end slides over; for the rest there is room under it, metres."""
EYES, FACE = 0.64, 0.16
"""How far above the middle of the torso the eyes are, and how far before it: nobody sees his own head, metres."""
MASS, ARM_MASS = 72.0, 4.0
"""Of the torso, and of each arm, kg."""
MAX_SLOPE = math.radians(42.0)
"""The steepest ground that bears, radians."""
SPEED = 4.5
"""On foot, m/s."""
PUSH = 14.0
"""The most that walking accelerates, m/s2; half of it in the air."""
GRIP = 0.04
"""In about so many seconds an unwanted motion is gone, if `PUSH` allows it."""
JUMP = 1.2
"""How high the highest jump goes, metres."""
CHARGE = 0.5
"""How long it takes to charge for that, seconds."""
KNEE = 20.0
"""How stiff the spring under the torso is: its frequency without damping, rad/s; it is damped critically."""
STRONGEST = 4.0
"""The most that the spring bears, in weights of the player."""
HARD_LANDING = 4.0
"""The speed of landing from which it takes away the player's pace, m/s."""
DAZED, RECOVERY = 0.25, 0.8
"""What is left of the pace after a very hard landing, and the seconds until it is all back."""
TWIST = 2500.0
"""The torque with which it does so, N m: a recoil of hundreds of N s must not turn it away."""
TURNING = 12.0
"""How fast the torso follows the eyes: rad/s for each radian that is missing."""
LOWERED = -1.0
"""How far below the eyes' pitch arms are held that hold nothing, radians."""
SHOULDER = oo.Vec3(0.3, 0.42, 0.0)
"""Where the right arm hangs, from the torso's middle, metres."""
ARM = 0.62
"""Length of an arm, metres."""
GROUND_KINDS = ("default", "vehicle")
"""What can be stood on."""


class Player(ControllableObject):
    """Somebody to be.

    Args:
        position: of the feet, metres in the world.
        yaw: where it looks, radians.
        step_height: the highest step that it climbs, metres.
        max_slope: the steepest ground that bears it, radians.
        jump_height: of the highest jump, metres.
        name: for messages and paths.
    """

    def __init__(
        self,
        position: oo.Vec3Like = (0.0, 0.0, 0.0),
        yaw: float = 0.0,
        *,
        step_height: float = STEP_HEIGHT,
        max_slope: float = MAX_SLOPE,
        jump_height: float = JUMP,
        name: str = "player",
    ) -> None:
        super().__init__(name=name)
        self.step_height, self.max_slope, self.jump_height = step_height, max_slope, jump_height
        self.reach = step_height - ROUND + HEIGHT / 2
        """How high the torso's middle is above level ground, metres."""
        feet, turn = oo.Vec3(*position), oo.Quat.from_yaw_pitch_roll(yaw)
        middle = feet + oo.Vec3(0.0, self.reach, 0.0)
        self.torso = self.attach(
            oo.Body(name=f"{name} torso", position=middle, rotation=turn, auto_disable=False, tunnelling="sweep")
        )
        upright = oo.Quat.between((0, 0, 1), (0, 1, 0))
        trunk = oo.Capsule(
            RADIUS,
            HEIGHT - 2 * RADIUS,
            mass=MASS,
            kind="player",
            surface=oo.Surface(0.0),
            shown=_figure(self.reach),
        )
        self.torso.attach(oo.Placeable(rotation=upright)).attach(trunk)
        self.torso.max_angular_speed = 20.0
        self.balance = oo.AngularMotor(
            self.torso,
            axes=(turn.rotate((0, 0, 1)), (0, 1, 0)),
            mode="euler",
            stops1=(0.0, 0.0),
            stops2=(0.0, 0.0),
            stop_erp1=0.8,
            stop_erp2=0.8,
            name=f"{name} balance",
        )
        self.balance.motor(0.0, TWIST, axis=3)
        self.arms: list[oo.Body] = []
        """The right and the left one."""
        self.shoulders: list[oo.Hinge] = []
        for side, label in ((1.0, "right"), (-1.0, "left")):
            self._build_arm(side, label, middle, turn)
        self.arsenal = Arsenal(self.arms[0], (0.0, 0.0, -ARM / 2))
        """Its weapons."""
        self.controls.yaw = yaw
        self.ground: oo.Hit | None = None
        """What bears it now."""
        self.pace = 1.0
        """What is left of its pace: less after a hard landing, or while it climbs."""
        self._charged = 0.0
        self._jumping = False
        self._falling = 0.0
        self._base = oo.Vec3(0.0, 0.0, 0.0)

    def make_controls(self) -> Controllable:
        """A neck can't turn over backwards."""
        return Controllable(pitch_limits=(-1.5, 1.5))

    def _build_arm(self, side: float, label: str, middle: oo.Vec3, turn: oo.Quat) -> None:
        at = middle + turn.rotate((side * SHOULDER.x, SHOULDER.y, SHOULDER.z - ARM / 2))
        arm = self.attach(oo.Body(name=f"{self.name} {label} arm", position=at, rotation=turn, auto_disable=False))
        arm.attach(oo.Placeable()).attach(
            oo.Capsule(0.065, ARM - 0.13, mass=ARM_MASS, kind="player", collides_with=(), appearance=SLEEVE)
        )
        hand = oo.Sphere(0.07, mass=0.0, kind="player", collides_with=(), appearance=SKIN)
        arm.attach(oo.Placeable(position=(0.0, 0.0, -ARM / 2))).attach(hand)
        shoulder = oo.Hinge(
            arm,
            self.torso,
            anchor=middle + turn.rotate((side * SHOULDER.x, SHOULDER.y, SHOULDER.z)),
            axis=turn.rotate((1, 0, 0)),
            name=f"{self.name} {label} shoulder",
        )
        shoulder.servo = oo.Servo(target=0.0, max_speed=15.0, max_force=300.0, frequency=30.0)
        self.arms.append(arm)
        self.shoulders.append(shoulder)

    def eye_pose(self, interpolation: float = 1.0) -> oo.Pose:
        """Before the face, whichever way that is turned just now; a rider looks where he wants to."""
        middle, rotation = self.torso.interpolated_pose(interpolation)
        ahead = oo.Quat.from_yaw_pitch_roll(self.controls.yaw).rotate((0.0, 0.0, -FACE))
        return oo.Pose(middle + oo.Vec3(0.0, EYES, 0.0) + ahead, rotation)

    # -- what is seen of it

    @property
    def velocity(self) -> oo.Vec3:
        """Of the torso, m/s."""
        return self.torso.linear_velocity

    @property
    def feet(self) -> oo.Vec3:
        """Where they are on level ground, metres in the world."""
        return self.torso.position - (0.0, self.reach, 0.0)

    @property
    def on_ground(self) -> bool:
        """Whether something bears it."""
        return self.ground is not None

    @property
    def charge(self) -> float:
        """How far the next jump is charged, 0 to 1."""
        return min(self._charged / CHARGE, 1.0)

    @property
    def weight(self) -> float:
        """Its mass, kg, with its arms and what it holds."""
        held = self.arsenal.in_hand
        holding = 0.0 if held is None else sum(body.mass for body in held.bodies)
        return sum(body.mass for body in self.bodies) + holding

    def pick_up(self, weapon: Weapon) -> bool:
        """Take a weapon that it came near to; tells whether it did."""
        return self.arsenal.pick_up(weapon)

    def place(self, pose: oo.Pose, *, at_rest: bool = False) -> None:
        """Be somewhere else, and what is in the hand too."""
        holding = self.in_simulation and self.arsenal.in_hand is not None
        if holding:
            self.arsenal.put_away()
        super().place(pose, at_rest=at_rest)
        if holding:
            self.arsenal.take_out()

    def leave(self) -> None:
        """Leave the tree with its weapons put away."""
        if self.in_simulation:
            self.arsenal.put_away()
        super().leave()

    def enter(self, parent: oo.Group | None = None, pose: oo.Pose | None = None) -> None:
        """Come back with the weapon in the hand that was there."""
        super().enter(parent, pose)
        self.arsenal.take_out()

    # -- what it does in each step

    def control(self) -> None:
        """Look, stand, jump, walk."""
        world = self.world
        if world is None:
            return
        step = world.step_size
        self._look()
        hit, normal = self._find_ground(world)
        base = oo.Vec3(0.0, 0.0, 0.0)
        if hit is not None and hit.body is not None:
            base = hit.body.velocity_at(hit.point)
        moving = self.velocity - base
        carried = hit is not None and self.ground is not None and hit.body is self.ground.body
        swept = (base - self._base) / step if carried else oo.Vec3(0.0, 0.0, 0.0)
        self._base = base
        landed = self.ground is None and hit is not None
        self.ground = hit
        if landed and -self._falling > HARD_LANDING:
            self.pace = max(DAZED, self.pace * HARD_LANDING / -self._falling)
        self._falling = moving.y
        self.pace = min(self.pace + step / RECOVERY, 1.0)
        mass, gravity = self.weight, world.gravity.length
        push = oo.Vec3(0.0, 0.0, 0.0)
        if hit is not None:
            push += self._stand(hit, normal, moving, mass, gravity)
            push += self._jump(moving, mass, gravity, step)
        else:
            self._jumping = self._jumping and moving.y > 0.0
            self._charged = 0.0
        push += self._walk(moving, swept, mass, step, normal.y)
        if push.length > 0.0:
            self.torso.add_force(push)
            if hit is not None and hit.body is not None:
                hit.body.add_force(-push, at=hit.point)

    def _look(self) -> None:
        ahead = self.torso.vector_to_world((0.0, 0.0, -1.0))
        yaw = math.atan2(-ahead.x, -ahead.z)
        missing = math.remainder(self.controls.yaw - yaw, math.tau)
        self.balance.motor(TURNING * missing, TWIST, axis=3)
        pitch = self.controls.pitch
        right = pitch if self.arsenal.in_hand is not None else pitch + LOWERED
        for shoulder, target in zip(self.shoulders, (right, pitch + LOWERED), strict=True):
            if shoulder.servo is not None and shoulder.servo.target != target:
                shoulder.servo.target = target

    def _find_ground(self, world: oo.World) -> tuple[oo.Hit | None, oo.Vec3]:
        """What bears the player, and which way it faces; nothing while a jump goes up, and nothing too steep."""
        up = oo.Vec3(0.0, 1.0, 0.0)
        if self._jumping:
            if self.velocity.y > 0.0:
                return None, up
            self._jumping = False
        slack = 0.08 if self.ground is not None else 0.0  # going down a step is no fall
        hit = world.cast_ray(self.torso.position, (0, -1, 0), self.reach + slack, kinds=GROUND_KINDS, exclude=(self,))
        if hit is None or hit.normal.y < math.cos(self.max_slope):
            return None, up
        return hit, hit.normal

    def _stand(self, hit: oo.Hit, normal: oo.Vec3, moving: oo.Vec3, mass: float, gravity: float) -> oo.Vec3:
        """The spring under the torso, which carries the weight and is damped against the slope of the ground."""
        sunk = self.reach - hit.distance
        leaving = moving.dot(normal) / normal.y
        climbing = max(sunk, 0.0) / STEP_HEIGHT
        self.pace = min(self.pace, 1.0 - 0.5 * min(climbing, 1.0))
        force = mass * (gravity + KNEE * KNEE * sunk - 2.0 * KNEE * leaving)
        return oo.Vec3(0.0, min(max(force, 0.0), STRONGEST * mass * gravity), 0.0)

    def _jump(self, moving: oo.Vec3, mass: float, gravity: float, step: float) -> oo.Vec3:
        """Charge while the key is held; once it is let go, the force for one step that gives the speed."""
        if "ascend" in self.controls.moves:
            self._charged += step
            return oo.Vec3(0.0, 0.0, 0.0)
        if self._charged == 0.0:
            return oo.Vec3(0.0, 0.0, 0.0)
        height = self.charge * self.jump_height
        self._charged, self._jumping, self.ground = 0.0, True, None
        # With the speed v after the jump's own step the steps lead v (v + g h) / 2 g upwards.
        speed = math.sqrt(2.0 * gravity * height + (gravity * step / 2) ** 2) - gravity * step / 2
        return oo.Vec3(0.0, mass * (speed - moving.y) / step, 0.0)

    def _walk(self, moving: oo.Vec3, swept: oo.Vec3, mass: float, step: float, level: float) -> oo.Vec3:
        """Towards the wished motion and against any other, along with how the ground speeds up, as hard as feet can."""
        wanted = self.controls.level_movement * (SPEED * self.pace * level)
        if not self.on_ground and wanted.length == 0.0:
            return wanted  # in the air there is nothing to brake against
        missing = wanted - (moving.x, 0.0, moving.z)
        push = missing / max(GRIP, step) + oo.Vec3(swept.x, 0.0, swept.z)
        most = PUSH if self.on_ground else PUSH / 2
        if push.length > most:
            push = push * (most / push.length)
        return push * mass


SLEEVE = painted(0.16, 0.2, 0.32, 0.15)
SKIN = painted(0.85, 0.66, 0.52, 0.2)


def _figure(reach: float) -> list[oo.Drawable]:
    """A jacket, a head and legs, in the axes of the capsule (its length along z)."""
    jacket, trousers, boots = painted(0.2, 0.26, 0.42, 0.1), painted(0.24, 0.22, 0.2, 0.05), painted(0.1, 0.1, 0.1, 0.3)
    parts: list[oo.Drawable] = []

    def add(geom: oo.Geom, x: float, y: float, z: float) -> None:
        matrix = np.identity(4)
        matrix[:3, 3] = (x, y, z)
        for drawable in geom.drawables():
            own = np.identity(4) if drawable.matrix is None else drawable.matrix
            parts.append(oo.Drawable(drawable.mesh, drawable.appearance, matrix @ own))

    add(oo.Capsule(0.2, 0.34, appearance=jacket), 0.0, 0.0, 0.16)
    for side in (-1.0, 1.0):
        add(oo.Sphere(0.115, appearance=jacket), side * 0.21, 0.0, SHOULDER.y)
    add(oo.Sphere(0.13, appearance=SKIN), 0.0, 0.0, EYES)
    add(oo.Sphere(0.137, appearance=painted(0.22, 0.15, 0.1, 0.1)), 0.0, -0.02, EYES + 0.03)
    leg = reach - 0.1
    for side in (-0.11, 0.11):
        add(oo.Capsule(0.09, leg - 0.3, appearance=trousers), side, 0.0, -0.1 - leg / 2 + 0.06)
        add(oo.Sphere(0.1, appearance=boots), side, 0.0, 0.1 - reach)
    return parts
