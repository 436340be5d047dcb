"""A cart on four sprung wheels drives over logs, and then round a corner.

Shows `Hinge2`: a wheel that rolls about one axis, is steered about another, and is sprung along it. The spring is given
in N/m and N s/m, so it is known beforehand how far the cart sinks: by its weight on each wheel, by the stiffness.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, painted, run

RADIUS, BASE, TRACK = 0.33, 0.8, 0.6
"""Of the wheels; half the distance of the axles, and of the wheels of an axle, metres."""
CHASSIS, WHEEL = 240.0, 15.0
"""kg"""
STIFFNESS, DAMPING = 9000.0, 900.0
"""Of one wheel's spring, N/m, and its damper, N s/m."""
ROLL = 10.0
"""How fast the driven wheels turn, rad/s."""


class Suspension(Example):
    """Cart and logs."""

    SECONDS = 5.0
    MOMENTS = (2.7,)
    WORLD: ClassVar = {"iterations": 50}

    def build(self) -> None:
        """Ground, logs, cart."""
        self.orbit = Orbit(oo.Vec3(2.6, 0.4, 0.0), 4.8, yaw=0.6, pitch=0.26)
        self.ground("grass", (0.9, 0.9, 0.9))
        for k, x in enumerate((1.6, 2.6, 3.4)):
            log = oo.Cylinder(0.16, 1.6, material="wood", appearance=look("planks", scale=0.5))
            self.still(log, (x, -0.02, 0.55 * (-1) ** k))
        self.build_cart()
        self.sunk = 0.0
        self.most, self.least = 0.0, 1.0
        self.show_joints(0.55)

    def build_cart(self) -> None:
        """A box on four wheels; wheels of rubber, driven at the back, steered at the front."""
        height = RADIUS + 0.05
        box = oo.Box((2.2, 0.16, 0.8), mass=CHASSIS, material="wood", appearance=look("planks", scale=0.8))
        self.cart = self.body(box, (-0.6, height + 0.22, 0.0), name="cart")
        load = self.cart.attach(oo.Placeable(position=(-0.4, 0.33, 0.0)))
        load.attach(oo.Box((0.5, 0.5, 0.5), mass=0.0, material="wood", appearance=look("crate")))
        self.wheels: list[oo.Hinge2] = []
        for x in (-BASE, BASE):
            for z in (-TRACK, TRACK):
                tyre = oo.Cylinder(RADIUS, 0.16, mass=WHEEL, material="rubber", appearance=look("rubber"))
                wheel = self.body(tyre, (x - 0.6, height, z), name="wheel")
                wheel.finite_rotation_axis = (0, 0, 0)
                for angle in (0.0, 1.5708):
                    spoke = oo.Box((0.5, 0.08, 0.17), mass=0.0, appearance=painted(0.8, 0.1, 0.08))
                    turned = wheel.attach(oo.Placeable(rotation=oo.Quat.from_axis_angle((0, 0, 1), angle)))
                    turned.attach(spoke)
                joint = oo.Hinge2(
                    self.cart,
                    wheel,
                    axis1=(0, 1, 0),
                    axis2=(0, 0, 1),
                    stops1=(0.0, 0.0),
                    suspension_stiffness=STIFFNESS,
                    suspension_damping=DAMPING,
                )
                self.wheels.append(joint)

    def before_step(self) -> None:
        """Stand, drive, steer: stops that are close to each other hold the steering angle."""
        step = self.world.steps
        if step == 100:
            self.sunk = sum(wheel.compression for wheel in self.wheels) / 4
            for wheel in self.wheels[:2]:
                wheel.motor(-ROLL, max_force=150.0, axis=2)  # about -z is towards +x
        elif step == 420:
            for wheel in self.wheels[2:]:
                wheel.stops1 = (0.35, 0.35)
        if step > 100:
            now = [wheel.compression for wheel in self.wheels]
            self.most, self.least = max(self.most, *now), min(self.least, *now)

    def check(self) -> None:
        """It sank as far as was foreseen, the springs worked, and the cart is over the logs and has turned left."""
        foreseen = CHASSIS * 9.81 / 4 / STIFFNESS
        expect(abs(self.sunk - foreseen) < 0.01 * foreseen, f"it sinks by m g / 4 k = {foreseen:.4f}, not {self.sunk}")
        expect(self.most - self.least > 0.1, "the wheels go up and down on the logs")
        expect(self.cart.position.x > 4.0, "the cart gets over them")
        expect(self.cart.vector_to_world((0, 1, 0)).y > 0.98, "it stays upright")
        heading = self.cart.vector_to_world((1, 0, 0))
        expect(heading.z < -0.2, "steered about +y it goes to the left")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Suspension, arguments)


if __name__ == "__main__":
    main()
