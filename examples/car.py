"""A car on a race track: it takes the ramp, and drives on by itself until somebody presses a key.

Shows the demo game's car, its track and the program that drives: hinge-2 wheels with sway bars, tyres that hold the
road, a jump, pure pursuit of the middle of the road, and a camera that rides along. Drive with w, a, s and d; space
brakes, u sets the car on its wheels.
"""

from __future__ import annotations

from collections.abc import Sequence

import osgode as oo
from osgode.examples.game.car import RADIUS, TOP_SPEED, Car
from osgode.examples.game.driver import Driver
from osgode.examples.game.track import RAMP_AT, Track
from osgode.examples.game.track_mesh import RAMP
from osgode.examples.runner import Example, expect, look, run

RUN_UP = 38.0
"""How far before the ramp it starts, metres."""
LANDED = 28.0
"""So far behind the ramp's foot the driver takes the wheel, metres."""
BEHIND = 7.0
"""Of the camera, metres."""
MOVES = ("forward", "backward", "left", "right", "ascend")


class Drive(Example):
    """The track, and a car that goes over the ramp and drives itself round the bends."""

    SECONDS = 22.0
    MOMENTS = (1.5, 4.3, 8.0, 15.0, 21.5)

    def build(self) -> None:
        """Ground, track, car."""
        grass = look("grass", (0.8, 0.92, 0.72), scale=4.0, shine=0.0)
        self.fixed.attach(oo.Plane(material="earth", appearance=grass))
        self.track = self.fixed.attach(Track())
        position, yaw = self.track.before_ramp(RUN_UP)
        self.car = self.moving.attach(Car(position, yaw))
        self.driver = Driver(self.car, self.track.line)
        self.fastest, self.highest, self.leaned = 0.0, 0.0, 0.0
        self.camera.ride(self.car, "delta")
        self.camera.distance = BEHIND

    def before_step(self) -> None:
        """At the end of the jump the driver takes the wheel."""
        car = self.car
        if not self.driver.running and not self.by_hand:
            car.controls.move(forward=True)
            if -car.hull.position.z > RAMP_AT + LANDED:
                self.driver.begin()
        self.fastest = max(self.fastest, car.speed)
        self.highest = max(self.highest, car.hull.position.y)
        self.leaned = max(self.leaned, abs(car.roll))

    by_hand = False
    """Whether somebody has pressed a key, and drives."""

    def steer(self) -> None:
        """The mouse looks about; the first key to be pressed takes the wheel."""
        right, down = self.events.look
        self.camera.look(right, down)
        riding = self.camera.carrier is self.car
        if riding and not self.by_hand and any(self.events.held(name) for name in MOVES):
            self.by_hand = True
            self.driver.end()
        if self.by_hand or not riding:
            self.camera.move(**{name: self.events.held(name) for name in MOVES})
            self.camera.steer()

    def bind_actions(self) -> None:
        """Those of every scene, and u to set the car upright."""
        super().bind_actions()
        self.events.on_press("u")(self.car.put_upright)

    def move_camera(self) -> None:
        """It rides along, or flies if somebody has got out."""
        flying = self.camera.carrier is None
        self.camera.update(self.clock.delta if flying else 0.0, self.interpolation)

    def check(self) -> None:
        """It has jumped, has landed on its wheels, and is well on its way round, with all of them."""
        expect(self.fastest > 0.95 * TOP_SPEED, "it reaches its top speed")
        expect(self.fastest < 1.05 * TOP_SPEED, "it is no faster")
        expect(self.highest > RADIUS + RAMP[2] + 0.5, "it flies")
        expect(self.leaned < 0.35, "it doesn't roll over")
        expect(sum(self.car.wheel_damage) == 0.0, "a jump does it no harm")
        expect(self.driver.progress > 0.6 * self.track.line.length, "the driver takes it round the bends")
        expect(abs(self.driver.aside) < self.track.width / 2, "and stays on the road")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Drive, arguments)


if __name__ == "__main__":
    main()
