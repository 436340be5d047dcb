"""A fuse burns down beside a stack of crates at dusk, and what it leads to goes off.

Shows particles that ride on a body and stay behind it, bursts of fire, smoke, sparks and dust, lamps that flicker and
flash, and an explosion as impulses by distance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, painted, run

EDGE = 0.7
BANG = 2.5
"""When it goes off, seconds."""
POWER = 950.0
"""N s on what is a metre away; by the square of the distance less farther off."""
REACH = 5.0


class Bomb(Example):
    """Crates on three sides of a barrel with a burning fuse."""

    SECONDS = 8.0
    MOMENTS = (2.7, 3.1, 4.5)

    def build(self) -> None:
        """Ground, crates, the barrel with its fuse, and what is seen when it goes off."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.3, 0.0), 10.0, yaw=0.55, pitch=0.22, turn=0.03)
        self.sun = oo.Sun(oo.Vec3(-0.8, -0.3, -0.5), (0.75, 0.45, 0.28), (0.2, 0.22, 0.32))
        self.sky = oo.Sky((0.12, 0.18, 0.42), (0.72, 0.5, 0.42), 250.0)
        self.ground(tint=(0.7, 0.68, 0.62))
        self.crates = [
            self.crate((x, EDGE / 2 + row * (EDGE + 0.002), z))
            for x, z in ((-1.3, -0.7), (-0.55, -1.3), (0.25, -1.4), (1.05, -1.1), (-1.6, 0.2))
            for row in range(3)
        ]
        barrel = oo.Cylinder(0.28, 0.7, mass=40, material="steel", appearance=painted(0.45, 0.08, 0.05, 0.4))
        self.barrel = self.body(barrel, (0, 0.35, 0), oo.Quat.between((0, 0, 1), (0, 1, 0)), name="barrel")
        self.fuse = self.barrel.attach(oo.PositionAttitudeTransform(position=(0, 0, 0.4)))
        self.hiss = self.fuse.attach(oo.Particles(oo.SPARKS, rate=120, velocity=(0, 0, 1.6), spread=1.0, seed=1))
        self.glow = self.fuse.attach(oo.PointLight((1.6, 0.9, 0.35), reach=4))

        place = self.root.attach(oo.PositionAttitudeTransform(position=(0, 0.4, 0)))
        ball: dict[str, Any] = {"velocity": (0, 6, 0), "spread": math.pi}
        self.bursts = [
            (place.attach(oo.Particles(oo.SMOKE, **ball, drag=3.5, size=(0.4, 1.5), lifetime=4, seed=2)), 70),
            (place.attach(oo.Particles(oo.FIRE, **ball, drag=5, size=(0.6, 0.3), radius=0.4, seed=3)), 50),
            (place.attach(oo.Particles(oo.SPARKS, velocity=(0, 11, 0), spread=1.7, lifetime=1.4, seed=4)), 180),
            (place.attach(oo.Particles(oo.DUST, velocity=(0, 6, 0), spread=1.6, size=(0.3, 1.2), seed=5)), 90),
        ]
        self.flash = place.attach(oo.PointLight((3.0, 1.9, 0.9), reach=14, intensity=0.0))
        for emitter in (self.hiss, *(emitter for emitter, _ in self.bursts)):
            emitter.follow(lambda: self.world.time)
        self.root.on_update(self.shine)
        self.struck = 0.0

    def crate(self, position: tuple[float, float, float]) -> oo.Body:
        """A wooden crate."""
        shape = oo.Box((EDGE, EDGE, EDGE), material="wood", density=90, appearance=look("crate"))
        return self.body(shape, position, name="crate")

    def shine(self, node: oo.Node) -> None:
        """Flicker before, flash and die down after."""
        del node
        after = self.world.time - BANG
        self.glow.intensity = 0.75 + 0.25 * math.sin(41 * self.world.time) * math.sin(17 * self.world.time)
        self.flash.intensity = math.exp(-3.0 * after) if after > 0 else 0.0

    def before_step(self) -> None:
        """Let it go off when its time has come."""
        if self.world.steps != round(BANG / self.world.step_size):
            return
        middle = self.barrel.position
        self.barrel.parent.detach(self.barrel)  # type: ignore[union-attr]
        for emitter, count in self.bursts:
            emitter.burst(count)
        for crate in self.crates:
            way = crate.position - middle + oo.Vec3(0, 0.35, 0)
            if way.length < REACH:
                impulse = way.normalized() * (POWER / max(way.length, 1.0) ** 2)
                crate.add_force(impulse / self.world.step_size)
                self.struck = max(self.struck, impulse.length)

    def check(self) -> None:
        """It has gone off, thrown the crates, and all that flew about has burnt out."""
        expect(self.struck > 100, "it goes off, and strikes the crates")
        away = [math.hypot(crate.position.x, crate.position.z) for crate in self.crates]
        expect(sum(distance > 3 for distance in away) >= 10, "most crates are thrown away from it")
        for crate in self.crates:
            expect(-0.05 < crate.position.y < 4, "no crate sinks into the ground or goes on flying")
        expect(all(len(emitter) == 0 for emitter, _ in self.bursts), "fire, smoke, sparks and dust are gone in the end")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Bomb, arguments)


if __name__ == "__main__":
    main()
