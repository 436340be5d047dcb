"""A car: five bodies, springs, sway bars, tyres that hold the road, wheels that come off.

The hull is a body of two boxes, chassis and cabin; each wheel is a body on a hinge-2 joint. All four wheels are driven,
the front ones are steered. It does what its `controls` say: forward and backward drive and brake, left and right steer,
ascend brakes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

import osgode as oo
from osgode.engine import ControllableObject
from osgode.examples.game.car_look import hull_drawables, wheel_drawables

CHASSIS = ((1.2, 0.5, 3.96), (0.0, 0.2, 0.0), 1060.0)
"""Size and middle in the hull's frame, metres, and mass, kg: it is as wide as there is room between the wheels."""
CABIN = ((1.4, 0.62, 2.5), (0.0, 0.81, 0.55), 100.0)
"""The same of the box above it."""
LOW = -0.18
"""How far the middle of the chassis' mass is above that of its box, metres: engine and floor lie low."""
HALF_BASE = 1.3
"""From the middle of the car to each axle, metres."""
HALF_TRACK = 0.76
"""From the middle of the car to the middle of each wheel, metres."""
RADIUS, WIDTH, WHEEL_MASS = 0.33, 0.2, 20.0
"""Of a wheel: metres, metres, kg."""
GRAVITY = 9.81
"""m/s2 that its springs are made for."""
SAG = 0.1
"""How far the springs are pressed together by the hull's weight, metres."""
DAMPING_RATIO = 0.45
"""Of the springs with a quarter of the hull on each: 1 would be critical."""
SWAY = 26e3
"""Of each axle's sway bar: N on either side for each metre by which one spring is pressed further than the other."""
SLIGHTEST = 5.0
"""N: less is not worth the trouble."""

TOP_SPEED, REVERSE_SPEED = 20.0, 6.0
"""Forward and backward, m/s."""
DRIVE_TORQUE, BRAKE_TORQUE, ROLL_TORQUE = 650.0, 1000.0, 90.0
"""Of each wheel: driving, braking, and what slows it when neither is wanted, N m."""
CRAWL = 0.4
"""m/s: slower, it is held by its brakes when nobody drives, and may go the other way."""

PARKED_SPEED, PARKED_SPIN, PARKING_TIME = 0.06, 0.1, 0.5
"""Slower (m/s, rad/s) for so long (s), with nothing wanted, it falls asleep, and so stands on any slope."""

MAX_STEERING = 0.6
"""Radians, of one wheel in the middle that would do what both front wheels do."""
INNER_STEERING = 0.8
"""Radians, what the inner wheel may need of it."""
STEERING_SPEED, STEERING_FADE = 1.8, 9.0
"""How fast it is steered while standing, rad/s; when the wheels roll at this speed, m/s, it is half of that."""
SIDE_LIMIT = 11.5
"""m/s2: it can't be steered into a bend that would ask for more."""
FINEST = 0.004
"""Radians: by less the wheels aren't steered anew, nor their speeds divided anew."""

GRIP = 1.3
"""Coefficient of friction of the tyres along and across."""
CORNERING, TRACTION = 90e3, 120e3
"""N for each radian between a tyre's way and its plane, and for slipping along at its own speed."""
STILL_SLIP = 0.1
"""m/s: tyres slip at least as they do at this speed."""
AXLE = (0.0, 0.0, 1.0)
"""In a wheel's own axes."""
SLIP_STEP = 0.05
"""By what part its speed must have changed for the tyres to be given another slip."""

DAMAGE_FORCE = 38e3
"""What a wheel's joint bears without harm, N: more than a landing from 4 m asks for."""
TOUGHNESS = {"front": 85.0, "rear": 300.0}
"""How much a wheel bears beyond that in all, N s; those that are steered hang on by less."""

WHEELS = ("front left", "front right", "rear left", "rear right")
"""The order of the wheels everywhere."""
AXLES = ((0, 1), (2, 3))
"""Which of them belong together."""

DOORS = ((-1.6, 0.2), (1.6, 0.2), (0.0, 3.0), (0.0, -3.0))
"""x and z in the hull's frame where someone who gets out may stand, best first, metres."""
ROOF = (0.0, 1.12, 0.5)
"""Where else, in the hull's frame."""
LOOK_UP, LOOK_DOWN = 0.6, 4.0
"""From how far above the hull, and how far below, ground is looked for there, metres."""
SEAT = (0.0, 0.6, 0.2)
"""In the hull's frame: from here nothing may be in the way to where one stands, metres."""
CLEARANCE = 0.05
"""Metres between the ground and whoever is put there."""
LIFT = 0.6
"""How high it is lifted to be set on its wheels, metres."""


def wheel_place(name: str) -> oo.Vec3:
    """Where a wheel is in the hull's frame while the car stands."""
    x = -HALF_TRACK if "left" in name else HALF_TRACK
    return oo.Vec3(x, 0.0, -HALF_BASE if "front" in name else HALF_BASE)


class Car(ControllableObject):
    """A car that a camera can ride on and a program can drive.

    A rider looks about by yaw and pitch of the controls, which don't steer.

    Args:
        position: of the ground under its middle, metres in the world.
        yaw: 0 has it look along -Z, radians, positive to the left.
        colour: red, green and blue of its paint, 0 to 1; None for the red that it comes in.
        sway_bars: whether it has them.
        name: for messages and paths.
    """

    EYE: ClassVar[oo.Pose] = oo.Pose(oo.Vec3(-0.34, 0.9, 0.2))
    """Where the driver's eyes are."""
    PITCH: ClassVar[float] = -0.15
    """How a rider looks at first, radians: a little down."""

    def __init__(
        self,
        position: oo.Vec3Like = (0.0, 0.0, 0.0),
        yaw: float = 0.0,
        *,
        colour: tuple[float, float, float] | None = None,
        sway_bars: bool = True,
        name: str = "car",
    ) -> None:
        super().__init__(name=name)
        self.sway_bars = sway_bars
        self.occupied = False
        """Whether a camera rides on it."""
        middle = oo.Vec3(*position) + oo.Vec3(0.0, RADIUS, 0.0)
        turn = oo.Quat.from_yaw_pitch_roll(yaw)
        self.hull = self.attach(oo.Body(name=f"{name} hull", position=middle, rotation=turn))
        for (size, at, mass), part in ((CHASSIS, "chassis"), (CABIN, "cabin")):
            box = oo.Box(size, mass=mass, material="steel", kind="vehicle", visible=False, name=f"{name} {part}")
            self.hull.attach(oo.Placeable(position=at)).attach(box)
        chassis, cabin = (oo.Mass.box(size, mass=mass).translated(at) for size, at, mass in (CHASSIS, CABIN))
        self.hull.fixed_mass = chassis.translated((0.0, LOW, 0.0)) + cabin
        self.hull.attach(oo.Leaf(hull_drawables(colour), name=f"{name} shell"))
        self.wheels = tuple(self._wheel(each) for each in WHEELS)
        self._damage = [0.0] * len(WHEELS)
        self._steering = 0.0
        self._steered = self._divided = math.inf  # the angle at which wheels were last steered, and speeds divided
        self._driven = (math.nan, math.nan)
        self._slips_at = self._stood = 0.0
        self._rows = [0] * len(WHEELS)

    def _wheel(self, which: str) -> oo.Wheel:
        quarter = self.hull.mass / 4
        stiffness = quarter * GRAVITY / SAG
        wheel = oo.suspension_wheel(
            self.hull,
            wheel_place(which) - (0.0, SAG, 0.0),
            radius=RADIUS,
            width=WIDTH,
            mass=WHEEL_MASS,
            stiffness=stiffness,
            damping=DAMPING_RATIO * 2.0 * math.sqrt(stiffness * quarter),
            max_steering=INNER_STEERING if "front" in which else 0.0,
            kind="vehicle",
            shown=wheel_drawables(RADIUS, WIDTH),
            name=f"{self.name} {which}",
        )
        wheel.hinge.feedback = True
        return wheel

    # -- what it tells

    @property
    def speed(self) -> float:
        """m/s, positive forward."""
        return self.hull.linear_velocity.dot(self.hull.vector_to_world((0.0, 0.0, -1.0)))

    @property
    def steering(self) -> float:
        """Where it is steered to at the moment, radians, positive to the left: of one wheel in the middle."""
        return self._steering

    @property
    def wheel_damage(self) -> tuple[float, ...]:
        """Of each of `WHEELS`: 0 is as new, at 1 it is lost."""
        return tuple(min(damage, 1.0) for damage in self._damage)

    @property
    def on(self) -> tuple[bool, ...]:
        """Whether each wheel is on the car."""
        return tuple(not wheel.hinge.released for wheel in self.wheels)

    @property
    def roll(self) -> float:
        """How far it leans to the right, radians."""
        return -math.asin(min(max(self.hull.vector_to_world((1.0, 0.0, 0.0)).y, -1.0), 1.0))

    @property
    def upset(self) -> bool:
        """Whether it lies on its side or its roof."""
        return self.hull.vector_to_world((0.0, 1.0, 0.0)).y < 0.5

    @property
    def _step_size(self) -> float:
        world = self.hull.world
        return 0.0 if world is None else world.step_size

    # -- each step

    def control(self) -> None:
        """Steer, drive, let the sway bars work, count damage."""
        if self.hull.asleep:
            if not self.controls.moves:
                return
            for body in self.bodies:
                body.wake()
        on = self.on
        if not any(on):
            return
        states = self._states(on)
        rims = [rate * RADIUS for rate in states["rate"][:, 1].tolist()]
        rolling = [rim for rim, is_on in zip(rims, on, strict=True) if is_on]
        rim = sum(rolling) / len(rolling)
        self._steer(rim, on)
        self._drive(rim, on)
        self._hold_the_road(rim, on)
        if self.sway_bars:
            self._sway(states["position"][:, 2].tolist(), on)
        forces = [math.hypot(*force) for force in states["force1"].tolist()]
        if max(forces) > DAMAGE_FORCE:
            self._wear(forces, on)
        self._park(rim)

    def _states(self, on: Sequence[bool]) -> np.ndarray[Any, np.dtype[Any]]:
        """The rows of its wheels among the states of all joints; those of wheels that are off say nothing."""
        world = self.hull.world
        if world is None:
            raise oo.StateError(f"{self.describe()}.control() needs it to be in a World")
        joints = world.joints
        for k, wheel in enumerate(self.wheels):
            if not on[k]:
                self._rows[k] = 0
            elif self._rows[k] >= len(joints) or joints[self._rows[k]] is not wheel.hinge:
                self._rows[k] = joints.index(wheel.hinge)
        return world.joint_states[self._rows]

    def _steer(self, rim: float, on: Sequence[bool]) -> None:
        """Turn the front wheels towards where they are wanted; each stands across the way to the middle of the bend."""
        moves, speed = self.controls.moves, abs(rim)
        most = min(MAX_STEERING, math.atan(2 * HALF_BASE * SIDE_LIMIT / max(speed * speed, 1e-3)))
        wanted = most * (("left" in moves) - ("right" in moves))
        step = STEERING_SPEED / (1.0 + speed / STEERING_FADE) * self._step_size
        self._steering += min(max(wanted - self._steering, -step), step)
        if abs(self._steering - self._steered) < FINEST and (self._steering or not self._steered):
            return
        self._steered = self._steering
        bend = self._bend
        for name, wheel, is_on in zip(WHEELS, self.wheels, on, strict=True):
            if is_on and wheel.max_steering:
                wheel.steering = math.atan(2 * HALF_BASE * bend / (1.0 + wheel_place(name).x * bend))

    @property
    def _bend(self) -> float:
        """The curvature, 1/m, of the way that the middle of the rear axle takes by the steering."""
        return math.tan(self._steered) / (2 * HALF_BASE)

    def _drive(self, rim: float, on: Sequence[bool]) -> None:
        """Give the wheels' motors what is wanted, each the speed that its way about the middle of the bend asks for."""
        moves = self.controls.moves
        ahead = ("forward" in moves) - ("backward" in moves)
        speed, torque = 0.0, ROLL_TORQUE
        if "ascend" in moves or ahead * rim < -CRAWL or (not ahead and abs(rim) < CRAWL):
            torque = BRAKE_TORQUE
        elif ahead:
            speed, torque = (TOP_SPEED if ahead > 0 else -REVERSE_SPEED), DRIVE_TORQUE
        if (speed, torque) == self._driven and (not speed or self._steered == self._divided):
            return
        self._driven, self._divided = (speed, torque), self._steered
        bend = self._bend
        middle = math.hypot(1.0, HALF_BASE * bend)
        for name, wheel, is_on in zip(WHEELS, self.wheels, on, strict=True):
            if is_on:
                place = wheel_place(name)
                way = math.hypot(1.0 + place.x * bend, (HALF_BASE - place.z) * bend)
                wheel.drive(speed * way / middle, torque)

    def _hold_the_road(self, rim: float, on: Sequence[bool]) -> None:
        """Let the tyres slip as tyres do: in proportion to the force and to the speed, up to what friction bears."""
        speed = max(abs(rim), STILL_SLIP)
        if abs(speed - self._slips_at) <= SLIP_STEP * self._slips_at:
            return
        self._slips_at = speed
        tyre = oo.Surface(
            friction=GRIP, direction=AXLE, slip=speed / CORNERING, slip_across=speed / TRACTION, source="car tyre"
        )
        for wheel, is_on in zip(self.wheels, on, strict=True):
            if is_on:
                wheel.hub.geoms[0].surface = tyre

    def _sway(self, pressed: Sequence[float], on: Sequence[bool]) -> None:
        """Press hull and wheel apart where the spring is pressed further, and together on the other side."""
        up: oo.Vec3 | None = None
        for left, right in AXLES:
            force = SWAY * (pressed[left] - pressed[right]) if on[left] and on[right] else 0.0
            if abs(force) < SLIGHTEST:
                continue
            if up is None:
                up = self.hull.vector_to_world((0.0, 1.0, 0.0))
            self.wheels[left].hub.add_force(up * -force)
            self.wheels[right].hub.add_force(up * force)
            # Both forces on the hull are a couple, whatever its middle.
            across = self.wheels[left].hub.position - self.wheels[right].hub.position
            self.hull.add_torque(across.cross(up * force))

    def _park(self, rim: float) -> None:
        """Fall asleep after having stood for a while; whatever pushes it wakes it."""
        hull = self.hull
        still = not self.controls.moves and abs(rim) < CRAWL
        still = still and hull.linear_velocity.length < PARKED_SPEED and hull.angular_velocity.length < PARKED_SPIN
        self._stood = self._stood + self._step_size if still else 0.0
        if self._stood >= PARKING_TIME:
            self._stood = 0.0
            for body in self.bodies:
                body.enabled = False

    def _wear(self, forces: Sequence[float], on: Sequence[bool]) -> None:
        for k, force in enumerate(forces):
            if on[k] and force > DAMAGE_FORCE:
                bears = TOUGHNESS["front" if "front" in WHEELS[k] else "rear"]
                self._damage[k] += (force - DAMAGE_FORCE) * self._step_size / bears
                if self._damage[k] >= 1.0:
                    self.lose(k)

    def lose(self, wheel: int) -> None:
        """Let a wheel go, by its number in `WHEELS`; it rolls away as a body of its own beside the car.

        Who wants to hear of it registers with `Joint.on_let_go` of ``wheels[k].hinge``.

        Raises:
            FieldError: for a number that no wheel has.
        """
        if wheel not in range(len(WHEELS)):
            raise oo.FieldError(f"{self.describe()}.lose(): wheel is {wheel!r}; it must be 0 to {len(WHEELS) - 1}")
        lost = self.wheels[wheel]
        if lost.hinge.released:
            return
        self._damage[wheel] = max(self._damage[wheel], 1.0)
        if self.parent is not None:
            lost.hub.move_to(self.parent)
        lost.hinge.release()

    # -- who is in it

    def eye_pose(self, interpolation: float = 1.0) -> oo.Pose:
        """Where a rider looks from: the driver's eyes, turned by yaw and pitch of the controls."""
        return super().eye_pose(interpolation) * oo.Pose(oo.Vec3(0.0, 0.0, 0.0), self.controls.rotation)

    def boarded(self) -> None:
        """A rider looks ahead at first."""
        self.occupied = True
        self.controls.yaw, self.controls.pitch = 0.0, self.PITCH

    def left(self) -> None:
        """It rolls to a stop, and then holds itself by its brakes."""
        super().left()
        self.occupied = False

    def way_out(self, height: float = 1.8, radius: float = 0.3) -> oo.Vec3:
        """Where the feet of someone who gets out may be: beside a door, else behind, before or on top of the car.

        Args:
            height: of the upright capsule that must have room there, metres.
            radius: of it, metres.

        Raises:
            StateError: if it is in no World.
        """
        world = self.hull.world
        if world is None:
            raise oo.StateError(f"{self.describe()}.way_out() needs it to be in a World")
        capsule = oo.Capsule(radius, height - 2 * radius)
        upright = oo.Quat.between((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
        for x, z in DOORS:
            beside = self.hull.local_to_world((x, 0.0, z))
            above = beside + oo.Vec3(0.0, LOOK_UP, 0.0)
            ground = world.cast_ray(above, (0.0, -1.0, 0.0), LOOK_UP + LOOK_DOWN, exclude=[self])
            if ground is None:
                continue
            feet = ground.point + oo.Vec3(0.0, CLEARANCE, 0.0)
            middle, seat = feet + oo.Vec3(0.0, height / 2, 0.0), self.hull.local_to_world(SEAT)
            barred = world.cast_ray(seat, middle - seat, seat.distance(middle), exclude=[self])
            if barred is None and not world.overlaps(capsule, middle, upright):
                return feet
        return self.hull.local_to_world(ROOF) + oo.Vec3(0.0, CLEARANCE, 0.0)

    def put_upright(self) -> None:
        """Set it on its wheels where it is, at rest, a little above the ground."""
        ahead = self.hull.vector_to_world((0.0, 0.0, -1.0))
        yaw = math.atan2(-ahead.x, -ahead.z)
        place = self.hull.position + oo.Vec3(0.0, LIFT, 0.0)
        self.place(oo.Pose(place, oo.Quat.from_yaw_pitch_roll(yaw)), at_rest=True)
