"""The game plays itself: a tour of everything in it, filmed from all sides.

The script is one generator, which goes on by one step at each ``yield``. It steers the player as a user would, by
wishes and angles, and sets up each shot of the camera.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TypeAlias

import osgode as oo
from osgode.examples.game.car import Car
from osgode.examples.game.driver import Driver
from osgode.examples.game.pendulum import AMPLITUDE
from osgode.examples.game.scene import STACKS, Game

Shot: TypeAlias = Callable[[float], tuple[oo.Vec3, oo.Vec3]]
"""From seconds since it began to where the camera is, and what it looks at."""
Steps: TypeAlias = Iterator[None]
"""A part of the script: a step of the simulation at each ``yield``."""
SECONDS = 68.0
"""About how long it takes."""
NEAR = 0.25
"""How near to a place the player has to come, metres."""
TURNING, ASKEW = 4.5, 0.7
"""How fast the player turns, rad/s, and how far off he may look and walk on, radians."""


def flight(start: oo.Vec3Like, end: oo.Vec3Like, first: oo.Vec3Like, last: oo.Vec3Like, seconds: float) -> Shot:
    """From a place to another, gently, while the look goes from a first point to a last one."""
    a, b, c, d = (oo.Vec3(*point) for point in (start, end, first, last))

    def shot(time: float) -> tuple[oo.Vec3, oo.Vec3]:
        t = min(time / seconds, 1.0)
        t = t * t * (3.0 - 2.0 * t)
        return a + (b - a) * t, c + (d - c) * t

    return shot


def about(  # noqa: PLR0917 - two ways and two looks
    place: oo.Vec3, start: oo.Vec3Like, end: oo.Vec3Like, first: oo.Vec3Like, last: oo.Vec3Like, seconds: float
) -> Shot:
    """The same with everything given from a place."""
    a, b, c, d = (place + oo.Vec3(*point) for point in (start, end, first, last))
    return flight(a, b, c, d, seconds)


def beside(body: oo.Body, arm: oo.Vec3Like, up: float = 0.4) -> Shot:
    """Along with a body, at an arm's length in the world's axes."""
    way = oo.Vec3(*arm)
    return lambda _: (body.position + way, body.position + oo.Vec3(0.0, up, 0.0))


class Tour(Game):
    """Everything once, in little more than a minute."""

    def start(self) -> None:
        """Take the first shot."""
        super().start()
        self.camera.dismount()
        self.told: list[str] = []
        """What has been shown."""
        self.finished = False
        self._shot: Shot | None = None
        self._since = 0.0
        self._script = self.script()

    def steer(self) -> None:
        """No keys: the script does it; what is filmed from outside has no overlay."""
        self.camera.steer()
        self.hud.visible = self.camera.carrier is not None

    def before_step(self) -> None:
        """Go on in the script."""
        if not self.finished and next(self._script, self) is self:
            self.finished = True

    def move_camera(self) -> None:
        """Where the shot says, or where the ridden thing's eye is."""
        if self._shot is None:
            super().move_camera()
            return
        place, target = self._shot(self.world.time - self._since)
        self.camera.position = place
        self.camera.look_at(target)

    # -- what the script is made of

    def take(self, shot: Shot | None) -> None:
        """Begin a shot; None: from where the camera rides."""
        if shot is not None:
            self.camera.dismount()
        self._shot, self._since = shot, self.world.time

    def wait(self, seconds: float) -> Steps:
        """Let time pass."""
        for _ in range(round(seconds / self.world.step_size)):
            yield

    def walk(self, *points: oo.Vec3Like, near: float = NEAR, patience: float = 12.0) -> Steps:
        """Have the player walk from point to point."""
        controls = self.player.controls
        for point in points:
            target, end = oo.Vec3(*point), self.world.time + patience
            while self.world.time < end:
                way = target - self.player.feet
                if math.hypot(way.x, way.z) < near:
                    break
                missing = self._turn(math.atan2(-way.x, -way.z))
                controls.move(forward=abs(missing) < ASKEW)  # else he would walk in circles round it
                yield
            controls.move(forward=False)

    def _turn(self, yaw: float) -> float:
        """Turn towards a yaw; returns what was missing, radians."""
        controls, most = self.player.controls, TURNING * self.world.step_size
        missing = math.remainder(yaw - controls.yaw, math.tau)
        controls.yaw += min(max(missing, -most), most)
        return missing

    def put(self, feet: oo.Vec3Like, yaw: float = 0.0) -> None:
        """Have the player stand somewhere."""
        place = oo.Vec3(*feet) + oo.Vec3(0.0, self.player.reach, 0.0)
        self.player.controls.yaw = yaw
        self.player.place(oo.Pose(place, oo.Quat.from_yaw_pitch_roll(yaw)), at_rest=True)

    def shoot(self, target: oo.Vec3Like, seconds: float, button: str = "left") -> Steps:
        """Aim at a point by the player's eyes, hold a button, and let it go; the same at any rate of frames."""
        point = oo.Vec3(*target)
        self.player.arsenal.press(button)
        for _ in range(round(seconds / self.world.step_size)):
            self._aim(point)
            yield
        self.player.arsenal.release(button, self._aim(point))
        yield

    def _aim(self, point: oo.Vec3) -> tuple[oo.Vec3, oo.Vec3]:
        """Look at a point; returns where the look begins, and its direction."""
        eye = self.player.eye_pose().position
        way = (point - eye).normalized()
        for looking in (self.camera, self.player.controls):
            looking.yaw, looking.pitch = math.atan2(-way.x, -way.z), math.asin(way.y)
        return eye, way

    # -- the script

    def script(self) -> Steps:
        """The whole tour."""
        for part in (
            self.arrive,
            self.fetch_the_gun,
            self.shoot_crates,
            self.cross_the_beam,
            self.ride_the_platform,
            self.fire_a_rocket,
            self.cross_the_bridge,
            self.swing_the_flail,
            self.race,
            self.depart,
        ):
            yield from part()
            self.told.append(part.__name__)

    def arrive(self) -> Steps:
        """From high above down to the player."""
        self.take(flight((30.0, 16.0, 16.0), (3.5, 2.4, 8.0), (14.0, 0.0, -14.0), (-2.0, 1.6, -4.0), 6.0))
        yield from self.wait(6.2)

    def fetch_the_gun(self) -> Steps:
        """Through the door to the table."""
        house = self.parts.house
        door = house.hinges + oo.Vec3(0.5, 0.0, 0.0)
        self.put(door + oo.Vec3(0.0, 0.0, 4.6))
        self.take(about(door, (2.6, 1.7, 5.2), (1.9, 1.6, 3.4), (0.0, 1.1, 1.0), (0.0, 1.1, 0.0), 3.0))
        yield from self.walk(door + oo.Vec3(0.0, 0.0, -0.9))
        corner = house.place_on + oo.Vec3(-2.6, 1.95, 1.9)
        self.take(flight(corner, corner + oo.Vec3(0.2, 0, -0.4), house.table, house.table, 3.0))
        yield from self.walk(house.table + oo.Vec3(-0.4, 0.0, 1.0), near=0.5, patience=4.0)
        yield from self.wait(0.8)

    def shoot_crates(self) -> Steps:
        """Two balls and two cubes, through the player's eyes."""
        if self.player.arsenal.in_hand is None:
            self.player.pick_up(self.weapons[0])
        self.put((0.6, 0.0, -6.4))
        self.take(None)
        self.camera.distance = 0.0
        self.camera.ride(self.player)
        yield from self.wait(0.6)
        for crate, button, held in ((20, "left", 0.8), (5, "right", 0.7), (15, "left", 1.2), (2, "right", 0.9)):
            yield from self.shoot(self.crates[crate].position, held, button)
            yield from self.wait(0.45)
        self.camera.distance = 4.0
        yield from self.wait(1.2)

    def cross_the_beam(self) -> Steps:
        """Up the stairs, and over the beam between the pendulums."""
        self.camera.dismount()
        course = self.parts.course
        x = self.parts.button.cap.position.x
        self.put((x, 0.0, course.beam_from + 5.4))
        level = oo.Vec3(x, 1.6, course.beam_from)
        self.take(about(level, (7.5, 2.6, 5.5), (7.0, 2.4, -5.5), (0.0, 0.0, 2.0), (0.0, 1.2, -6.0), 7.5))
        for pendulum in self.parts.pendulums:
            yield from self.walk((x, 0.0, pendulum.hinge.anchor.z + 1.75))
            while not 0.3 * AMPLITUDE < pendulum.angle * pendulum.way < 0.6 * AMPLITUDE:
                yield
        yield from self.walk((x, 0.0, course.beam_to - 0.8))

    def ride_the_platform(self) -> Steps:
        """Over the button onto the platform, and across."""
        platform, course = self.parts.platform, self.parts.course
        button = self.parts.button.cap.position
        self.take(about(button, (4.6, 2.3, 3.2), (5.5, 2.0, -4.5), (0.0, 0.0, 0.0), (0.0, 0.4, -4.0), 5.0))
        start, end = course.platform
        if platform.running:
            platform.toggle()
        yield from self.walk((button.x, 0.0, button.z), near=0.3)
        yield from self.wait(0.35)
        yield from self.walk((start.x, 0.0, start.z + 0.2))
        while platform.position < platform.way - 0.1 and self.player.feet.y > 1.0:
            yield
        yield from self.walk((end.x, 0.0, end.z - 2.4))

    def fire_a_rocket(self) -> Steps:
        """Take the launcher, and see what a rocket does to the crates."""
        launcher = self.weapons[1]
        if self.player.feet.y < 1.0:  # he fell off the platform
            self.put(self.parts.course.platform[1] + oo.Vec3(0.0, 0.02, -2.4))
        if launcher.hand is None:
            yield from self.walk(launcher.main_body.position, near=0.45, patience=3.0)
        if launcher.hand is None:
            self.player.pick_up(launcher)
        self.player.arsenal.switch(2)
        stack = oo.Vec3(STACKS[2][0], 0.6, STACKS[2][1])
        yield from self.wait(0.3)
        self.take(None)
        self.camera.distance = 0.0
        self.camera.ride(self.player)
        yield from self.wait(0.5)
        yield from self.shoot(stack, 0.4)
        yield from self.wait(0.55)
        self.take(about(stack, (7.5, 3.0, -6.0), (8.5, 3.8, -5.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 3.4))
        yield from self.wait(3.6)

    def cross_the_bridge(self) -> Steps:
        """Over the planks that sway."""
        start, end = self.parts.course.bridge
        self.put(start + oo.Vec3(0.8, 0.02, 0.0), math.pi / 2)
        middle = (start + end) / 2
        self.take(about(middle, (4.5, 1.6, 5.2), (-5.5, 2.2, 4.6), (5.0, 0.0, 0.0), (-5.0, 1.0, 0.0), 4.0))
        yield from self.walk(end + oo.Vec3(-0.7, 0.0, 0.0))

    def swing_the_flail(self) -> Steps:
        """Take the flail, and turn round with it."""
        flail = self.weapons[2]
        if flail.hand is None:
            yield from self.walk(flail.main_body.position, near=0.45, patience=2.0)
        if flail.hand is None:
            self.player.pick_up(flail)
        self.player.arsenal.switch(3)
        self.take(beside(self.player.torso, (3.4, 1.3, 3.2)))
        for _ in range(round(3.4 / self.world.step_size)):
            self.player.controls.yaw += 5.0 * self.world.step_size
            yield

    def race(self) -> Steps:
        """The red car takes the ramp; then a ride along the bends against the blue one."""
        self.player.arsenal.put_away()
        self._set_car(self.car, *self.track.before_ramp(34.0))
        self.car.controls.move(forward=True)
        place, yaw = self.track.before_ramp(-16.0)
        side = oo.Quat.from_yaw_pitch_roll(yaw).rotate((7.0, 0.0, 0.0))
        self.take(lambda _: (place + side + oo.Vec3(0.0, 1.5, 0.0), self.car.hull.position))
        yield from self.wait(4.6)
        self.car.controls.stop()
        self._set_car(self.car, *self.track.spot(120.0, -2.0))
        self._set_car(self.rival, *self.track.spot(132.0, 2.0))
        chaser = Driver(self.car, self.track.line)
        chaser.begin()
        self.take(None)
        self.camera.distance = 6.0
        self.camera.ride(self.car, "delta")
        yield from self.wait(9.0)
        hull = self.rival.hull
        self.take(lambda _: (hull.local_to_world((-4.2, 1.6, -6.5)), hull.position + oo.Vec3(0.0, 0.4, 0.0)))
        yield from self.wait(5.0)

    @staticmethod
    def _set_car(car: Car, place: oo.Vec3, yaw: float) -> None:
        lifted = place + oo.Vec3(0.0, car.hull.position.y if car.hull.position.y < 1.0 else 0.5, 0.0)
        car.place(oo.Pose(lifted, oo.Quat.from_yaw_pitch_roll(yaw)), at_rest=True)

    def depart(self) -> Steps:
        """Up and away."""
        self.take(flight((12.0, 4.0, 4.0), (46.0, 30.0, 34.0), (2.0, 1.0, -16.0), (22.0, 0.0, -30.0), 6.0))
        yield from self.wait(6.0)
