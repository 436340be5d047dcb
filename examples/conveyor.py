"""Two belts carry crates through a gate, which a sensor opens for them, into a bin.

Shows belts (`surface_velocity`), a sensor whose listener is told what begins and ends to touch it, a slider with a
servo that lifts the gate, and surfaces that slide.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

SPEED = 1.1
"""Of the belts, m/s."""
TOP, WIDTH = 1.0, 1.1
"""How high the belts are, and how wide, metres."""
CRATES, PAUSE, EDGE = 5, 2.0, 0.5
"""How many crates come, after how many seconds each, and how big they are, metres."""
GATE_X, LIFT = 0.6, 0.85
"""Where the gate is, and how far it is lifted."""
CORNER = 3.4
"""Where the second belt begins, along x."""


class Conveyor(Example):
    """A belt with a gate, a second one across, and a bin."""

    SECONDS = 21.0
    MOMENTS = (4.8, 8.0, 12.4, 20.0)
    WORLD: ClassVar = {"iterations": 40}

    def build(self) -> None:
        """Ground, belts, gate, sensor, bin."""
        self.orbit = Orbit(oo.Vec3(1.3, 0.8, 1.9), 9.6, yaw=0.35, pitch=0.5, turn=-0.006)
        self.fixed.attach(oo.Plane(material="concrete", appearance=look("concrete", scale=3.0, shine=0.0)))
        self.belt((-0.75, 0.0), 8.3, (SPEED, 0, 0))
        self.belt((CORNER + WIDTH / 2, 1.2), 3.5, (0, 0, SPEED), across=True)
        self.block((CORNER + WIDTH + 0.05, TOP + 0.2, 0.0), (0.1, 0.6, WIDTH), "steel")  # the first belt ends here
        self.build_gate()
        self.build_bin()
        self.crates: list[oo.Body] = []
        self.inside: set[oo.Geom] = set()
        self.opened, self.fastest, self.highest = 0, 0.0, 0.0

    def block(self, place: tuple[float, float, float], size: tuple[float, float, float], texture: str) -> None:
        """A static box."""
        self.fixed.attach(oo.Placeable(position=place)).attach(
            oo.Box(size, material="steel", surface=oo.Surface(0.05), appearance=look(texture, scale=1.0, shine=0.4))
        )

    def belt(
        self, at: tuple[float, float], length: float, velocity: tuple[float, float, float], *, across: bool = False
    ) -> None:
        """A belt of rubber between rails, on legs."""
        x, z = at
        size = (WIDTH, 0.2, length) if across else (length, 0.2, WIDTH)
        rubber = look("rubber", (0.5, 0.5, 0.52), scale=0.8, shine=0.2)
        self.fixed.attach(oo.Placeable(position=(x, TOP - 0.1, z))).attach(
            oo.Box(size, material="rubber", surface=oo.Surface(0.7), surface_velocity=velocity, appearance=rubber)
        )
        for side in (-1, 1):
            if across:
                free = WIDTH + 0.2 if side < 0 else 0.0  # where the first belt comes in
                rail = (0.08, 0.26, length - free)
                self.block((x + side * (WIDTH / 2 + 0.05), TOP - 0.1, z + free / 2), rail, "paint")
            else:
                self.block((x, TOP - 0.1, z + side * (WIDTH / 2 + 0.05)), (length, 0.26, 0.08), "paint")
            for end in (-0.4, 0.4):
                leg = (side * 0.4, end * length) if across else (end * length, side * 0.4)
                self.block((x + leg[0], TOP / 2 - 0.1, z + leg[1]), (0.1, TOP - 0.2, 0.1), "steel")

    def build_gate(self) -> None:
        """A leaf that a servo lifts between two posts, and the sensor before it."""
        for side in (-1, 1):
            self.block((GATE_X, 1.4, side * (WIDTH / 2 + 0.17)), (0.16, 2.8, 0.12), "paint")
        self.block((GATE_X, 2.86, 0.0), (0.2, 0.12, WIDTH + 0.5), "paint")
        self.gate = self.moving.attach(oo.Body(name="gate", position=(GATE_X, TOP + 0.36, 0)))
        self.gate.attach(oo.Placeable()).attach(
            oo.Box((0.06, 0.66, WIDTH), mass=6.0, surface=oo.Surface(0.0), appearance=look("steel", (1.0, 0.55, 0.2)))
        )
        self.slider = oo.Slider(self.gate, axis=(0, 1, 0), stops=(0.0, LIFT + 0.05))
        self.slider.servo = oo.Servo(target=0.0, max_force=600.0, max_speed=2.5, frequency=8.0)
        self.sensor = self.fixed.attach(oo.Placeable(position=(GATE_X - 0.15, TOP + 0.35, 0))).attach(
            oo.Box((1.3, 0.6, WIDTH), sensor=True, appearance=oo.Appearance((0.2, 0.9, 0.4, 0.16)))
        )
        self.sensor.on_touch(self.watch)

    def watch(self, touch: oo.Touch) -> None:
        """Open the gate while crates are before it or under it."""
        if touch.other_body is self.gate:
            return
        if touch.begin:
            self.opened += not self.inside
            self.inside.add(touch.other)
        elif touch.end:
            self.inside.discard(touch.other)
        servo = self.slider.servo
        if servo is not None:
            servo.target = LIFT if self.inside else 0.0

    def build_bin(self) -> None:
        """Four walls of planks where the second belt ends."""
        x, z = CORNER + WIDTH / 2, 4.2
        for dx, dz, size in (
            (-1.1, 0.0, (0.08, 0.7, 2.3)),
            (1.1, 0.0, (0.08, 0.7, 2.3)),
            (0.0, 1.15, (2.2, 0.7, 0.08)),
            (0.0, -1.15, (2.2, 0.7, 0.08)),
        ):
            self.fixed.attach(oo.Placeable(position=(x + dx, 0.35, z + dz))).attach(
                oo.Box(size, material="wood", appearance=look("planks", scale=1.0))
            )

    def before_step(self) -> None:
        """Drop the next crate, and watch."""
        due = len(self.crates) * PAUSE
        if len(self.crates) < CRATES and self.world.time >= due:
            turn = oo.Quat.from_axis_angle((0, 1, 0), 0.25 * (len(self.crates) % 3 - 1))
            crate = oo.Body(name=f"crate {len(self.crates)}", position=(-4.2, TOP + 0.5, 0.0), rotation=turn)
            crate.attach(oo.Placeable()).attach(
                oo.Box((EDGE, EDGE, EDGE), material="wood", mass=8.0, appearance=look("crate"))
            )
            self.crates.append(self.moving.attach(crate))
        first = self.crates[0]
        if -2.5 < first.position.x < GATE_X:
            self.fastest = max(self.fastest, first.linear_velocity.x)
        self.highest = max(self.highest, self.slider.position)

    def check(self) -> None:
        """All crates went the whole way, at the speed of the belt, and the gate is shut behind them."""
        expect(len(self.crates) == CRATES, "all crates have come")
        for crate in self.crates:
            expect(crate.position.z > 2.9 and crate.position.y < 2.2, f"{crate.name} lies in the bin")
        expect(abs(self.fastest - SPEED) < 0.05, "crates go as fast as the belt")
        expect(self.opened >= 3, "the gate opens for them, and shuts in between")
        expect(self.highest > LIFT - 0.02, "the servo lifts the gate")
        expect(abs(self.slider.position) < 0.02, "the gate is shut in the end")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Conveyor, arguments)


if __name__ == "__main__":
    main()
