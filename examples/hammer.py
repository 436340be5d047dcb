"""A hammer with a wooden handle and a steel head is thrown and spins about its centre of mass.

Shows a composite body: two parts with masses of their own, from which the centre of mass follows. The ball in black
and yellow marks it, and the yellow beads the parabola on which it flies; the red ones are the way of the handle's
end. Also shows visual nodes beside physics nodes, and an update callback.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

HANDLE, HEAD = (0.11, 1.7, 0.11), (0.7, 0.28, 0.28)
START = oo.Vec3(-3.4, 1.6, 0.0)
VELOCITY = oo.Vec3(3.6, 7.4, 0.0)
"""Of the centre of mass when it is thrown, m/s."""
SPIN = oo.Vec3(0.0, 0.0, -8.0)
YELLOW, RED = (1.0, 0.75, 0.05), (0.8, 0.05, 0.1)


class Hammer(Example):
    """One throw, and what is left of it on the grass."""

    SECONDS = 5.0
    MOMENTS = (0.5, 1.1, 1.7, 4.5)

    def build(self) -> None:
        """Ground, hammer, beads."""
        self.orbit = Orbit(oo.Vec3(0.4, 2.3, 0.0), 8.2, yaw=-0.15, pitch=0.08, turn=0.06)
        self.fixed.attach(oo.Plane(material="earth", appearance=look("grass", scale=3.0, shine=0.0)))
        self.hammer = self.moving.attach(oo.Body(name="hammer"))
        self.hammer.attach(oo.Placeable()).attach(
            oo.Box(HANDLE, mass=6, material="wood", appearance=look("planks", scale=0.8))
        )
        self.hammer.attach(oo.Placeable(position=(0.0, HANDLE[1] / 2, 0.0))).attach(
            oo.Box(HEAD, mass=10, material="steel", appearance=look("steel", scale=0.6, shine=0.7))
        )
        self.throw()

        self.hammer.attach(oo.CentreOfMass(radius=0.13))
        self.centres = self.root.attach(Beads(0.035, YELLOW))
        self.ends = self.root.attach(Beads(0.03, RED))
        self.root.on_update(self.leave_beads)
        self.farthest, self.landed = 0.0, math.inf
        self.hammer.on_touch(self.land)

    def throw(self) -> None:
        """Place the frame and give it its velocity so that the centre of mass has what was asked for."""
        self.hammer.position = START - self.hammer.centre_of_mass
        self.hammer.angular_velocity = SPIN
        self.hammer.linear_velocity = VELOCITY - SPIN.cross(self.hammer.centre_of_mass)

    def land(self, _: oo.Touch) -> None:
        """Note when it touches the ground: the parabola is over."""
        self.landed = min(self.landed, self.world.time)

    def leave_beads(self, _: oo.Node) -> None:
        """Leave one where the centre of mass is, and one where the handle ends."""
        if self.landed == math.inf:
            self.centres.leave(self.hammer.world_centre_of_mass)
            self.ends.leave(self.hammer.local_to_world((0.0, -HANDLE[1] / 2, 0.0)))

    def before_step(self) -> None:
        """Compare with the parabola, as the semi-implicit Euler method steps it: p + v t + g t (t + step) / 2."""
        if self.landed == math.inf:
            t, gravity = self.world.time, self.world.gravity
            planned = START + VELOCITY * t + gravity * (t * (t + self.world.step_size) / 2)
            self.farthest = max(self.farthest, self.hammer.world_centre_of_mass.distance(planned))

    def check(self) -> None:
        """The centre of mass is near the head, flew the parabola, and the hammer has come to lie on the ground."""
        middle = HANDLE[1] / 2 * 10 / 16
        expect(
            abs(self.hammer.centre_of_mass.y - middle) < 1e-12, "the heavy head draws the centre of mass up the handle"
        )
        expect(self.farthest < 1e-9, "the centre of mass flies a parabola, however the hammer spins")
        expect(1.0 < self.landed < 3.0, "it flies for more than a second, and comes down")
        expect(0.0 < self.hammer.world_centre_of_mass.y < 0.4, "it ends on the ground")
        expect(self.hammer.position.x > START.x + 5.0, "it has been thrown some way")


class Beads(oo.Group):
    """A trail of beads."""

    def __init__(self, radius: float, colour: tuple[float, float, float]) -> None:
        super().__init__()
        self._bead = oo.Leaf([oo.sphere_drawable(radius, oo.Appearance((*colour, 1.0), unlit=True))])

    def leave(self, position: oo.Vec3) -> None:
        """One more bead; all show the same leaf."""
        self.attach(oo.PositionAttitudeTransform(position=position)).attach(self._bead)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Hammer, arguments)


if __name__ == "__main__":
    main()
