"""The rocket launcher, and its rockets: slow at first, faster in each step, until they hit or their fuel is gone.

A rocket is a capsule that is swept along its way. While it burns it has no gravity and is pushed along its nose in each
step; its fins keep the nose where it flies to. Its listener hears when it hits; in the next step it is gone, and an
explosion is in its place.
"""

from __future__ import annotations

import math
from typing import ClassVar

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.game.effects import leave_behind, trail
from osgode.examples.game.explosion import Explosion
from osgode.examples.game.shapes import ball, block, lathed, placed, plate
from osgode.examples.game.weapon import Aim, Weapon, is_part_of
from osgode.examples.runner import painted

FUEL = 10.0
"""Seconds."""
START_SPEED = 8.0
"""m/s."""
ACCELERATION = 18.0
"""As long as there is fuel, m/s2."""
ROCKET_MASS, ROCKET_RADIUS, ROCKET_LENGTH = 8.0, 0.055, 0.6
"""kg; metres, the length with both ends."""
FINS = 0.25
"""How much of the angle between nose and flight is put right in a step."""
SPARED_FOR = 0.5
"""Seconds in which a rocket passes through whoever shot it."""
EXPIRES = 60.0
"""Seconds after which a rocket that has hit nothing is gone."""
RELOAD = 0.8
"""Seconds between shots."""
RECOIL = 60.0
"""Of a shot, N s."""
MASS = 7.0
"""Of the launcher, kg."""
TUBE_RADIUS, TUBE_LENGTH = 0.075, 0.95
"""Metres."""
MUZZLE = oo.Vec3(0.0, 0.06, -0.5)
"""The middle of the tube's mouth in its own axes, metres."""

GREEN, DARK = painted(0.25, 0.32, 0.2, 0.25), painted(0.12, 0.13, 0.13, 0.4)
WHITE, RED, STEEL = painted(0.9, 0.9, 0.87, 0.5), painted(0.82, 0.1, 0.07, 0.5), painted(0.5, 0.52, 0.55, 0.8)
YELLOW = painted(0.95, 0.75, 0.1, 0.4)
TRAIL = oo.Spray(
    velocity=oo.Vec3(0.0, 0.0, 1.2),
    spread=0.4,
    radius=0.03,
    lifetime=1.6,
    jitter=0.3,
    gravity=oo.Vec3(0.0, 0.25, 0.0),
    drag=1.2,
    size=(0.06, 0.34),
    colours=((1.0, 0.75, 0.35, 0.75), (0.75, 0.73, 0.7, 0.5), (0.8, 0.8, 0.8, 0.2), (0.85, 0.85, 0.85, 0.0)),
)
SMOKE_RATE = 140.0
"""Puffs of its trail a second."""
FLAME = oo.Appearance((1.0, 0.72, 0.2, 0.85), unlit=True)
CORE = oo.Appearance((1.0, 0.97, 0.8, 1.0), unlit=True)
GLASS = oo.Appearance((0.3, 0.75, 0.95, 1.0), shininess=1.0)


class Rocket(CompositeObject):
    """Flies along its -Z.

    Args:
        position: metres in the world.
        rotation: -Z is where it flies to.
        spares: bodies and spaces that it passes through at first: the launcher, and whoever holds it.
        name: for messages and paths.
    """

    def __init__(
        self,
        position: oo.Vec3Like,
        rotation: oo.QuatLike = (1.0, 0.0, 0.0, 0.0),
        spares: list[oo.PhysicsNode] | None = None,
        *,
        name: str = "rocket",
    ) -> None:
        super().__init__(name=name)
        turn = oo.Quat(*rotation)
        self._spares = [] if spares is None else list(spares)
        self._age = 0
        self._hit = False
        self.explosion: Explosion | None = None
        """What it has become."""
        self.rocket = self.attach(
            oo.Body(
                name=f"{name} body",
                position=position,
                rotation=turn,
                linear_velocity=turn.rotate((0.0, 0.0, -START_SPEED)),
                gravity=False,
                tunnelling="sweep",
            )
        )
        self.rocket.attach(oo.Placeable()).attach(
            oo.Capsule(
                ROCKET_RADIUS, ROCKET_LENGTH - 2 * ROCKET_RADIUS, material="steel", kind="shot", mass=ROCKET_MASS,
                shown=_rocket(),
            )
        )  # fmt: skip
        self._flame = self.rocket.attach(oo.Switch())
        self._flame.attach(oo.Leaf(_flame()))
        self._smoke: oo.Particles | None = None

    @property
    def burning(self) -> bool:
        """Whether there is fuel left."""
        world = self.world
        return world is not None and self._age * world.step_size < FUEL

    def entered(self) -> None:
        """Fly."""
        self.on_touch(self._touched)
        if self._spares:
            self.on_collide(self._spare)
        self.schedule(_fly)
        self.schedule(_burn_out, seconds=FUEL)
        self.schedule(lambda rocket: rocket.leave(), seconds=EXPIRES)
        self._smoke = trail(self.rocket, (0.0, 0.0, ROCKET_LENGTH / 2), TRAIL, SMOKE_RATE)

    def fly(self) -> None:
        """A step: push along the flight, and turn the nose to where it goes."""
        body = self.rocket
        self._age += 1
        velocity, nose = body.linear_velocity, body.vector_to_world((0.0, 0.0, -1.0))
        if velocity.length > 1.0:
            # The angular velocity that turns the nose by a part of the angle in the next step; the spin is lost.
            across = nose.cross(velocity)
            angle = math.atan2(across.length, nose.dot(velocity))
            if across.length > 1e-9:
                body.angular_velocity = across.normalized() * (angle * FINS / self._step_size)
            else:
                body.angular_velocity = (0.0, 0.0, 0.0)
        if self.burning:
            way = velocity.normalized() if velocity.length > 1.0 else nose
            body.add_force(way * (ROCKET_MASS * ACCELERATION))

    def burn_out(self) -> None:
        """There is no fuel left: it falls."""
        self.rocket.gravity = True
        self._flame.on = False
        if self._smoke is not None:
            self._smoke.rate = 0.0

    @property
    def _step_size(self) -> float:
        return 0.0 if self.world is None else self.world.step_size

    def _spare(self, feedback: oo.CollisionFeedback) -> None:
        if self._age * self._step_size < SPARED_FOR and is_part_of(feedback.other, self._spares):
            feedback.refuse()

    def _touched(self, touch: oo.Touch) -> None:
        if touch.begin and not self._hit and not touch.other.sensor:
            self._hit = True
            self.schedule(_explode)

    def explode(self) -> Explosion:
        """Be gone, and have an explosion in its place, which is returned.

        Raises:
            StateError: if it is in no World.
        """
        space = self.space
        if space is None:
            raise oo.StateError(f"{self.describe()}.explode(): it is in no World")
        self.explosion = Explosion(self.rocket.position, name=f"{self.name} explosion")
        if self._smoke is not None:
            leave_behind(self._smoke, space)
        self.leave()
        return space.attach(self.explosion)


def _fly(rocket: Rocket) -> bool:
    rocket.fly()
    return True


def _burn_out(rocket: Rocket) -> None:
    rocket.burn_out()


def _explode(rocket: Rocket) -> None:
    rocket.explode()


class RocketLauncher(Weapon):
    """A tube on the shoulder; any button shoots, as soon as it is loaded again.

    Args:
        position: of its middle, metres in the world.
        yaw: 0 has it point along -Z, radians.
        name: for messages and paths.
    """

    SLOT = 2
    TITLE = "rocket launcher"
    GRIP: ClassVar[oo.Pose] = oo.Pose(oo.Vec3(0.0, -0.1, -0.08))
    FULL_CHARGE = 1.0

    def __init__(
        self, position: oo.Vec3Like = (0.0, 0.0, 0.0), yaw: float = 0.0, *, name: str = "rocket launcher"
    ) -> None:
        super().__init__(name=name)
        body = self.attach(oo.Body(name=f"{name} body", position=position, rotation=oo.Quat.from_yaw_pitch_roll(yaw)))
        tube = oo.Placeable(position=(0.0, MUZZLE.y, 0.0))
        body.attach(tube).attach(
            oo.Cylinder(TUBE_RADIUS, TUBE_LENGTH, material="steel", kind="weapon", mass=MASS, shown=_launcher())
        )
        self._loaded_at = 0
        self.shown_rocket = body.attach(oo.Switch(on=True))
        self.shown_rocket.attach(oo.PositionAttitudeTransform(position=(0.0, MUZZLE.y, -0.26))).attach(
            oo.Leaf(_rocket(fins=0))
        )

    @property
    def loaded(self) -> bool:
        """Whether it can shoot."""
        world = self.world
        return world is not None and world.steps >= self._loaded_at

    def fire(self, button: str, charge: float, aim: Aim) -> None:  # noqa: ARG002 - a rocket is a rocket
        """Shoot a rocket along the aiming ray."""
        space, world = self.space, self.world
        if space is None or world is None or not self.loaded:
            return
        line = self.line_of_fire(aim, MUZZLE, ROCKET_LENGTH / 2)
        rocket = Rocket(line.position, line.rotation, self.own, name=f"{self.name} rocket")
        space.attach(rocket)
        self.recoil(line.rotation.rotate((0.0, 0.0, RECOIL)))
        self._loaded_at = world.steps + round(RELOAD / world.step_size)
        self.shown_rocket.on = False

    def tick(self) -> None:
        """Show when it is loaded again."""
        super().tick()
        if not self.shown_rocket.on and self.loaded:
            self.shown_rocket.on = True


def _rocket(fins: int = 4) -> list[oo.Drawable]:
    """A white body with a red nose, a yellow band, a nozzle, and fins that are folded away in the tube."""
    r, half = ROCKET_RADIUS, ROCKET_LENGTH / 2
    nose = [(0.0, 0.0), (0.016, 0.006), (0.032, 0.035), (0.045, 0.08), (r, 0.15)]
    parts = [
        lathed([(r, half - 0.06), (r, 0.15 - half)], WHITE),
        # A lathe's profile goes from the highest z to the lowest, and the nose is the lowest.
        placed(lathed([(x, z) for x, z in reversed(nose)], RED), (0.0, 0.0, -half)),
        lathed([(r * 1.03, -0.04), (r * 1.03, -0.075)], YELLOW),
        lathed([(r * 1.03, -0.1), (r * 1.03, -0.11)], RED),
        lathed([(0.0, half - 0.02), (0.036, half), (0.047, half), (0.034, half - 0.06), (r, half - 0.06)], DARK),
    ]
    fin = plate([(0.0, half - 0.22), (0.085, half - 0.08), (0.085, half), (0.0, half - 0.06)], 0.008, RED)
    for k in range(fins):
        turn = oo.Quat.from_axis_angle((0.0, 0.0, 1.0), math.pi / 4 + k * math.tau / fins)
        parts.append(placed(fin, turn.rotate((0.0, r * 0.95, 0.0)), turn))
    return parts


def _flame() -> list[oo.Drawable]:
    half = ROCKET_LENGTH / 2
    outer = [(0.0, 0.42), (0.025, 0.25), (0.042, 0.08), (0.034, 0.0)]
    inner = [(0.0, 0.2), (0.018, 0.09), (0.024, 0.0)]
    return [placed(lathed(inner, CORE), (0, 0, half)), placed(lathed(outer, FLAME), (0, 0, half))]


def _launcher() -> list[oo.Drawable]:
    """A green tube with a flared end, two grips, a shoulder rest and a sight; its middle is the tube's."""
    r, half = TUBE_RADIUS, TUBE_LENGTH / 2
    slope = oo.Quat.from_axis_angle((1.0, 0.0, 0.0), -0.25)
    bore = 0.062
    return [
        lathed([(r * 0.94, half - 0.05), (r * 0.94, 0.02 - half), (bore, 0.02 - half), (bore, half - 0.1)], GREEN),
        lathed([(r * 1.12, 0.06 - half), (r * 1.12, -half), (bore, -half), (bore, 0.05 - half)], DARK),
        lathed([(r * 0.94, 0.06 - half), (r * 1.12, 0.06 - half)], DARK),
        lathed([(bore, half - 0.1), (r * 1.3, half + 0.05), (r * 1.36, half + 0.05), (r * 0.94, half - 0.1)], DARK),
        lathed([(r * 1.0, -0.1), (r * 1.0, -0.13)], YELLOW),
        lathed([(r * 1.02, 0.24), (r * 1.02, 0.19)], DARK),
        block((0.04, 0.14, 0.05), (0.0, -0.14, -0.06), DARK, slope),
        block((0.04, 0.13, 0.05), (0.0, -0.13, -0.28), DARK, slope),
        block((0.03, 0.02, 0.3), (0.0, -0.08, -0.17), DARK),
        block((0.06, 0.05, 0.16), (0.0, -0.09, 0.2), DARK),
        block((0.035, 0.06, 0.14), (-0.085, 0.05, -0.12), DARK),
        block((0.05, 0.05, 0.12), (-0.115, 0.085, -0.12), DARK),
        ball(0.021, (-0.115, 0.085, -0.18), GLASS),
        ball(0.017, (-0.115, 0.085, -0.062), GLASS),
    ]
