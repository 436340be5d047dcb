"""Programs at the controls: one drives a car round a closed line, one walks a walker from point to point.

They set the same `controls` that a camera sets for a player, and know nothing else of how the thing moves.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import osgode as oo
from osgode.engine import ControllableObject
from osgode.examples.game.closed_line import ClosedLine

PRIORITY = 200
"""Of programs among the scheduled calls: before what acts on the controls."""

WHEELBASE = 2.6
"""Metres, of the car that pure pursuit thinks of: steering by angle a, it goes round by tan(a) / wheelbase."""
NEAREST_AIM, AIM_TIME = 4.0, 0.42
"""How far ahead it aims: metres, and seconds at its speed more than that."""
SIDE_LIMIT = 6.5
"""m/s2 across: how fast it dares to take a bend."""
BRAKING = 5.0
"""m/s2: how hard it plans to brake before a bend."""
TOO_FAST = 0.5
"""m/s above what it wants at which it brakes; below it lets it roll."""
STEERING_STEP = 0.008
"""Radians: nearer than this to what it wants it doesn't steer."""
TURN_MEMORY = 0.15
"""Seconds over which it averages how a car turns that doesn't tell its steering."""
NEAR, LOST = 4.0, 15.0
"""It looks for where it is on the line so far before and behind where it was, and everywhere if it is farther off it
than this, metres."""
STUCK_SPEED, STUCK_TIME, FREEING_TIME = 0.4, 1.5, 1.6
"""Slower (m/s) for so long (s) it is stuck, and goes backward for so long (s)."""


class Program(ABC):
    """Something that decides, before each step of what it controls, what that shall do.

    Args:
        thing: what it controls.
    """

    def __init__(self, thing: ControllableObject) -> None:
        self.thing = thing
        self._call: oo.ScheduledCall | None = None

    @property
    def running(self) -> bool:
        """Whether it is at the controls."""
        return self._call is not None and self._call.pending

    def begin(self) -> None:
        """Take the controls; nothing happens if it has them.

        Raises:
            StateError: if the thing is in no World.
        """
        if not self.running:
            self._call = self.thing.schedule(lambda _: self._decide(), priority=PRIORITY)

    def end(self) -> None:
        """Let go of the controls, and wish for nothing."""
        if self._call is not None:
            self._call.cancel()
        self._call = None
        self.thing.controls.stop()

    def _decide(self) -> bool:
        self.decide()
        return True

    @abstractmethod
    def decide(self) -> None:
        """Set the controls; called once in each step."""


class Driver(Program):
    """Drives a car along a closed line, and takes the time of each lap.

    It steers by pure pursuit (R. C. Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", CMU, 1992):
    along the circle that touches the car and leads through a point of the line ahead, curvature ``2 x / d^2`` for a
    point x aside and d away. Its speed is what the bends allow, with room to brake before them.

    Args:
        car: what it drives: looks along -Z of its first body; forward, backward, left and right are throttle, brake and
            steering. Where it has a ``steering`` (radians, positive to the left) that is what is steered to; otherwise
            it is told from how it turns.
        line: what it drives along; points, or a `ClosedLine`.
        top_speed: m/s.
        side_limit: m/s2 across, how fast it dares to take bends.
    """

    def __init__(
        self,
        car: ControllableObject,
        line: ClosedLine | Sequence[oo.Vec3Like],
        *,
        top_speed: float = 18.0,
        side_limit: float = SIDE_LIMIT,
    ) -> None:
        super().__init__(car)
        self.line = line if isinstance(line, ClosedLine) else ClosedLine(line)
        self.speeds = allowed_speeds(self.line, top_speed, side_limit)
        """What it dares at each point of the line, m/s."""
        self.lap_times: list[float] = []
        """Of the laps that it has driven whole, from the line's start to its start, seconds."""
        self.aside = 0.0
        """How far it is beside the line, metres, positive to the right."""
        self._at: float | None = None
        self._began: float | None = None
        self._turning = 0.0
        self._stuck = 0.0
        self._freeing = 0.0

    @property
    def progress(self) -> float:
        """How far along the line it is, metres."""
        return 0.0 if self._at is None else self._at

    def decide(self) -> None:
        """Look where it is, and steer, drive or brake."""
        body = self.thing.main_body
        world = self.thing.world
        if world is None:
            return
        pose, velocity = body.pose, body.linear_velocity
        speed = velocity.dot(pose.rotation.rotate((0.0, 0.0, -1.0)))
        before = self._at
        lost = before is None or abs(self.aside) > LOST
        self._at, self.aside = self.line.nearest(pose.position, None if lost else before, NEAR)
        self._count_laps(before, world.time, speed)
        if self._free_itself(speed, world.step_size):
            return
        wanted = self._wanted_steering(pose, speed)
        steering = getattr(self.thing, "steering", None)
        if steering is None:
            self._turning += (body.angular_velocity.y - self._turning) * world.step_size / TURN_MEMORY
            steering = math.atan(WHEELBASE * self._turning / max(speed, 1.0))
        allowed = self._allowed(self._at)
        self.thing.controls.move(
            left=wanted - steering > STEERING_STEP,
            right=steering - wanted > STEERING_STEP,
            forward=speed < allowed,
            backward=speed > allowed + TOO_FAST,
            ascend=False,
            descend=False,
        )

    def _wanted_steering(self, pose: oo.Pose, speed: float) -> float:
        ahead = NEAREST_AIM + AIM_TIME * max(speed, 0.0)
        aim = pose.inverse().transform(self.line.at(self.progress + ahead))
        curve = -2.0 * aim.x / (aim.x**2 + aim.z**2)
        return math.atan(WHEELBASE * curve)

    def _allowed(self, distance: float) -> float:
        count = len(self.line)
        return self.speeds[min(int(distance / self.line.length * count), count - 1)]

    def _count_laps(self, before: float | None, now: float, speed: float) -> None:
        if before is None or self._at is None:
            return
        half = self.line.length / 2
        if before - self._at > half:  # from the end of the line to its start
            crossed = now - self._at / max(speed, 0.1)
            if self._began is not None:
                self.lap_times.append(crossed - self._began)
            self._began = crossed
        elif self._at - before > half:  # back over the start: this lap doesn't count
            self._began = None

    def _free_itself(self, speed: float, step_size: float) -> bool:
        """Go backward for a while if something is in the way; whether that is so."""
        controls = self.thing.controls
        if self._freeing > 0.0:
            self._freeing -= step_size
            aside = self.aside > 0.0
            controls.move(forward=False, backward=True, left=not aside, right=aside)
            return True
        self._stuck = self._stuck + step_size if abs(speed) < STUCK_SPEED else 0.0
        if self._stuck > STUCK_TIME:
            self._stuck, self._freeing = 0.0, FREEING_TIME
        return False


def allowed_speeds(line: ClosedLine, top_speed: float, side_limit: float, braking: float = BRAKING) -> list[float]:
    """What speed a bend, and every bend still to come, allows at each point of a line.

    In a bend of curvature c it is ``sqrt(side_limit / c)``; before one, ``sqrt(v^2 + 2 braking s)`` at distance s.
    """
    count = len(line)
    bends = [abs(line.bend(line.start_of(k) + 1e-6)) for k in range(count)]
    speeds = [min(top_speed, math.sqrt(side_limit / max(bend, 1e-9))) for bend in bends]
    for k in reversed(range(2 * count)):  # twice, since the line has no end
        here, following = k % count, (k + 1) % count
        step = (line.start_of(following) - line.start_of(here)) % line.length
        speeds[here] = min(speeds[here], math.sqrt(speeds[following] ** 2 + 2 * braking * step))
    return speeds


class Patrol(Program):
    """Walks a walker from point to point and round again.

    Args:
        walker: what it controls: turns to the yaw of its controls, and walks forward.
        points: where it goes, metres in the world; heights are of no matter.
        near: how near a point counts as reached, metres.
        wait: how long it stands at each, seconds.
        turn_speed: how fast it turns, rad/s.
    """

    def __init__(
        self,
        walker: ControllableObject,
        points: Sequence[oo.Vec3Like],
        *,
        near: float = 0.4,
        wait: float = 0.0,
        turn_speed: float = 3.0,
    ) -> None:
        super().__init__(walker)
        self.points = tuple(oo.Vec3(*map(float, point)) for point in points)
        if not self.points:
            raise oo.FieldError("Patrol: points is empty; give at least one")
        self.near, self.wait, self.turn_speed = near, wait, turn_speed
        self.visited = 0
        """How many points it has reached."""
        self._resting = 0.0

    @property
    def target(self) -> oo.Vec3:
        """Where it is going."""
        return self.points[self.visited % len(self.points)]

    def decide(self) -> None:
        """Turn to the next point, and walk once it looks there."""
        world, controls = self.thing.world, self.thing.controls
        if world is None:
            return
        place = self.thing.main_body.position
        if self._resting > 0.0:
            self._resting -= world.step_size
            controls.move(forward=False)
            return
        way = self.target - place
        if math.hypot(way.x, way.z) < self.near:
            self.visited += 1
            self._resting = self.wait
            way = self.target - place
            if math.hypot(way.x, way.z) < self.near:  # there is but this one
                controls.move(forward=False)
                return
        off = math.remainder(math.atan2(-way.x, -way.z) - controls.yaw, math.tau)
        most = self.turn_speed * world.step_size
        controls.turn(yaw=min(max(off, -most), most))
        controls.move(forward=abs(off) < math.pi / 4)
