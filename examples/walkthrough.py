"""A walk through what every scene can do: fly, ride on a ball, look from behind, pause, slow motion, see the physics.

Shows the engine: a camera that flies freely and attaches to what it aims at, the third person, keys for time, the debug
overlay, the inspector and the timings. In a window it is all yours (w a s d, mouse after tab, e, v, p, minus, f3, f4);
without one a script presses the keys.
"""

from __future__ import annotations

from collections.abc import Sequence

import osgode as oo
from osgode.engine import ControllableObject, MouseMotion, Press, Release, Scene, ScriptedInput
from osgode.examples.runner import Example, expect, look, painted, run

RADIUS, MASS, TORQUE = 0.5, 20.0, 90.0
"""Of the ball that can be ridden, metres and kg; what rolls it, N m."""
TAPS = (
    (2.2, "e"),
    (2.6, "v"),
    (5.2, "p"),
    (5.6, "period"),
    (5.8, "period"),
    (6.0, "period"),
    (6.2, "p"),
    (6.4, "minus"),
    (6.6, "minus"),
    (7.0, "f3"),
    (7.2, "f4"),
    (9.2, "equals"),
    (9.4, "equals"),
    (9.6, "e"),
)
"""Seconds, and the key that is tapped then."""
HELD = ((0.3, 1.2, "w"), (0.3, 0.9, "d"), (2.9, 5.0, "w"), (6.4, 9.2, "w"), (9.8, 11.0, "space"))
"""From when, until when, and which key."""


class Marble(ControllableObject):
    """A ball that rolls where its rider wants to go."""

    def __init__(self, position: oo.Vec3Like) -> None:
        super().__init__(name="marble")
        self.ball = self.attach(oo.Body(name="ball", position=position, rotation=(0.9, 0.3, 0.2, 0.1)))
        shiny = look("paint", (0.9, 0.35, 0.2), shine=0.6)
        self.ball.attach(oo.Placeable()).attach(oo.Sphere(RADIUS, mass=MASS, material="rubber", appearance=shiny))

    def control(self) -> None:
        """Roll: forward is turning about the axis to the left."""
        way = self.controls.level_movement
        if way.length > 0.0:
            self.ball.add_torque(oo.Vec3(0.0, 1.0, 0.0).cross(way) * TORQUE)

    def eye_pose(self, interpolation: float = 1.0) -> oo.Pose:
        """Above the ball, which turns over and over below."""
        return oo.Pose(self.ball.interpolated_pose(interpolation).position + oo.Vec3(0.0, 0.9, 0.0))


class WalkThrough(Example):
    """A marble, a wall of crates, and whoever looks at them."""

    SECONDS = 11.0
    MOMENTS = (1.5, 4.0, 8.6)

    def build(self) -> None:
        """The marble, the crates, the camera."""
        self.ground("planks", (0.8, 0.75, 0.7))
        self.marble = self.moving.attach(Marble((0.0, RADIUS, 0.0)))
        self.crates = []
        for k in range(15):
            row, column = divmod(k, 5)
            crate = oo.Box((0.7, 0.7, 0.7), mass=5.0, material="wood", appearance=look("crate"))
            place = ((column - 2) * 0.72, 0.35 + 0.7 * row, -7.0)
            self.crates.append(self.body(crate, place, name=f"crate {k}"))
        for x in (-3.2, 3.2):
            self.still(
                oo.Box((0.4, 1.4, 9.0), material="concrete", appearance=painted(0.7, 0.7, 0.72, 0.1)), (x, 0.7, -3)
            )
        self.camera.position = (-2.2, 2.4, 6.5)
        self.camera.look_at((0.0, 0.4, -2.5))
        self.camera.update(0.0)
        self.flown, self.ridden, self.paused, self.slow, self.steps_paused = 0.0, 0, 0, 0, 0
        self.playing = False

    def steer(self) -> None:
        """By keys and mouse, as every scene; the script has its say first."""
        if isinstance(self.events.source, ScriptedInput):
            self._play(self.events.source)
        Scene.steer(self)

    def move_camera(self) -> None:
        """The camera flies, or rides."""
        Scene.move_camera(self)

    def _play(self, source: ScriptedInput) -> None:
        """Press what the script says for this frame, which comes about in the next."""
        now, before = self.clock.elapsed, self.clock.elapsed - self.clock.delta
        for at, key in TAPS:
            if before < at <= now:
                source.send(Press(key), Release(key))
        for start, end, key in HELD:
            if before < start <= now:
                source.send(Press(key))
            if before < end <= now:
                source.send(Release(key))
        if 1.3 < now < 2.1:  # towards the marble
            yaw, pitch = self.camera.yaw, self.camera.pitch
            self.camera.look_at(self.marble.ball.position)
            wanted = self.camera.yaw, self.camera.pitch
            self.camera.yaw, self.camera.pitch = yaw, pitch
            self.events.captured = True
            pixel = self.events.config.mouse_sensitivity
            source.send(MouseMotion(0.15 * (yaw - wanted[0]) / pixel, 0.15 * (pitch - wanted[1]) / pixel))

    def each_frame(self) -> None:
        """Note what comes of it."""
        self.playing = True
        self.flown = max(self.flown, self.camera.position.distance((-2.2, 2.4, 6.5)))
        self.ridden += self.camera.carrier is self.marble
        self.paused += self.clock.paused
        self.slow += self.clock.speed < 0.5

    def before_step(self) -> None:
        """Count what is stepped by hand."""
        self.steps_paused += self.playing and self.clock.paused

    def check(self) -> None:
        """Everything was tried, and did what it should."""
        expect(self.flown > 3.0, f"the camera flew {self.flown:.1f} m")
        expect(self.ridden > 150, f"it rode on the marble for {self.ridden} frames")
        expect(self.paused > 15, f"time stood still for {self.paused} frames")
        expect(self.steps_paused == 3, f"and was moved by hand, by {self.steps_paused} steps")
        expect(self.slow > 50, f"it went slowly for {self.slow} frames")
        expect(self.aids.debugging and self.aids.inspecting, "the physics is shown")
        expect(self.marble.ball.position.z < -3.0, f"the marble rolled to z = {self.marble.ball.position.z:.1f}")
        moved = sum(abs(crate.position.z + 7.0) > 0.3 for crate in self.crates)
        expect(moved >= 3, f"it ran into the crates: {moved} were moved")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(WalkThrough, arguments)


if __name__ == "__main__":
    main()
