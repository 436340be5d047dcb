"""Balls roll down a valley, rings that collide in three ways lie in it, and a beacon's ray sweeps over it all.

Shows a heightfield made from an array, hulls and meshes that `colliders` makes of one model by each policy, and a ray
that reports what it meets without touching it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, is_installed, look, run

SIZE, SAMPLES = 44.0, 89
"""Of the valley: edge in metres, heights along it."""
RING, TUBE = 1.0, 0.38
"""Of a ring: radius of its middle line, and of the tube."""
POLICIES = {"hull": (-3.4, (0.95, 0.55, 0.3)), "decompose": (0.0, (0.45, 0.75, 0.95)), "mesh": (3.4, (0.6, 0.9, 0.5))}
"""Where each ring lies (x), and its tint."""
BEACON = oo.Vec3(0.0, 3.6, -5.0)
SLANT = 0.42
"""How far the beacon's ray looks down, radians."""


def heights() -> npt.NDArray[np.float64]:
    """A valley along z with knolls, level where the rings lie."""
    x, z = np.meshgrid(*(2 * [np.linspace(-SIZE / 2, SIZE / 2, SAMPLES)]))
    slopes = 0.014 * x**2 + 0.004 * z**2
    knolls = 0.55 * np.sin(0.55 * x + 0.4) * np.cos(0.5 * z) + 0.25 * np.sin(1.3 * x) * np.sin(1.1 * z + 1)
    near = np.exp(-((((x / 6.0) ** 2) + (((z - 1.0) / 3.0) ** 2)) ** 2))  # 1 in the middle, 0 outside
    return np.asarray((slopes + knolls) * (1 - near))


def ring(tint: tuple[float, float, float]) -> oo.Model:
    """A torus about the y axis, as a model that might have come from a file."""
    around, across = 36, 16
    a, b = np.meshgrid(np.arange(around) * (2 * math.pi / around), np.arange(across) * (2 * math.pi / across))
    a, b = a.T.ravel(), b.T.ravel()
    out = RING + TUBE * np.cos(b)
    vertices = np.column_stack([out * np.sin(a), TUBE * np.sin(b), out * np.cos(a)])
    normals = np.column_stack([np.cos(b) * np.sin(a), np.sin(b), np.cos(b) * np.cos(a)])
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    one, two = i * across + j, (i + 1) % around * across + j
    three, four = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    triangles = np.vstack([np.column_stack([one, two, three]), np.column_stack([one, three, four])])
    drawable = oo.Drawable(oo.Mesh(vertices, triangles, normals), oo.Appearance((*tint, 1.0), shininess=0.5))
    return oo.Model("ring", (drawable,), vertices, triangles)


class Terrain(Example):
    """Valley, rings with balls, balls that roll, and the beacon."""

    SECONDS = 8.0
    MOMENTS = (0.6, 2.0, 4.0, 7.5)

    def build(self) -> None:
        """Put it all up."""
        self.orbit = Orbit(oo.Vec3(0.0, 1.3, -1.5), 13.6, yaw=0.35, pitch=0.4, turn=-0.03)
        self.terrain = oo.Heightfield(
            heights(), (SIZE, SIZE), material="earth", appearance=look("grass", scale=5.0, shine=0.0), name="valley"
        )
        self.fixed.attach(oo.Placeable()).attach(self.terrain)
        self.world.surfaces.fallback = oo.Surface(0.6, rolling_friction=0.004)
        with_hulls = is_installed("scipy", "vhacdx")
        self.rings = {policy: self.lay_ring(policy) for policy in POLICIES if with_hulls or policy == "mesh"}
        self.lids = {policy: self.drop_ball((POLICIES[policy][0], 2.4, 1.0), 0.42) for policy in self.rings}
        chance = random.Random(4)  # noqa: S311  (the same balls every time)
        self.rolling = []
        for k in range(36):
            x, z = chance.choice((-1, 1)) * chance.uniform(9, 14), chance.uniform(-8, 6)
            radius = chance.uniform(0.2, 0.42)
            self.rolling.append(self.drop_ball((x, self.terrain.height_at(x, z) + radius + 0.05, z), radius, k))
        self.starts = [ball.position for ball in self.rolling]
        self.build_beacon()

    def lay_ring(self, policy: str) -> oo.Body:
        """A ring of 60 kg, with one or several geoms that look like one ring."""
        x, tint = POLICIES[policy]
        body = self.moving.attach(oo.Body(name=f"ring, {policy}", position=(x, TUBE + 0.05, 1.0)))
        place = body.attach(oo.Placeable())
        for geom in oo.colliders(ring(tint), policy, mass=60, material="rubber", name=policy):
            place.attach(geom)
        return body

    def drop_ball(self, position: tuple[float, float, float], radius: float, k: int = 0) -> oo.Body:
        """A ball that nothing holds."""
        ball = self.moving.attach(oo.Body(name="ball", position=position, linear_damping=0.0005))
        looks = (look("steel", shine=0.8), look("paint", (0.9, 0.35, 0.25), shine=0.5), look("rubber", shine=0.2))
        ball.attach(oo.Placeable()).attach(oo.Sphere(radius, material="steel", density=900, appearance=looks[k % 3]))
        return ball

    def build_beacon(self) -> None:
        """A head that a motor turns on a mast, with the ray in it, and the spot where the ray ends."""
        foot = self.terrain.height_at(BEACON.x, BEACON.z)
        mast = self.fixed.attach(
            oo.Placeable(
                position=(BEACON.x, (BEACON.y + foot) / 2, BEACON.z), rotation=oo.Quat.between((0, 0, 1), (0, 1, 0))
            )
        )
        mast.attach(oo.Cylinder(0.09, BEACON.y - foot, material="steel", appearance=look("steel", shine=0.6)))
        head = self.moving.attach(oo.Body(name="beacon", position=BEACON + oo.Vec3(0.0, 0.25, 0.0)))
        head.attach(oo.Placeable()).attach(
            oo.Box((0.5, 0.34, 0.5), material="steel", appearance=look("paint", (0.95, 0.8, 0.2)))
        )
        self.ray = oo.Ray(40.0, visible=False)
        turn = oo.Quat.from_yaw_pitch_roll(math.pi - 0.9, -SLANT)  # begins aside of the rings
        head.attach(oo.Placeable(rotation=turn)).attach(self.ray)
        motor = oo.Hinge(head, anchor=BEACON, axis=(0, 1, 0))
        motor.motor(velocity=0.45, max_force=400.0)
        self.head = head
        self.beam = self.root.attach(oo.PositionAttitudeTransform(name="beam"))
        self.spot = self.root.attach(oo.PositionAttitudeTransform(name="spot"))
        glow = oo.Appearance((1.0, 0.25, 0.15, 1.0), unlit=True)
        self.spot.attach(oo.Leaf([oo.sphere_drawable(0.11, glow)]))
        self.glow = oo.Appearance((1.0, 0.3, 0.2, 0.55), unlit=True)
        self.seen: set[str] = set()
        self.error = 0.0
        self.lowest = math.inf

    def update(self) -> None:
        """Draw the beam up to what it meets."""
        super().update()
        hit = self.ray.hit
        self.spot.visible = self.beam.visible = hit is not None
        if hit is None:
            return
        self.spot.position = hit.point
        middle = (self.ray.origin + hit.point) / 2
        self.beam.position, self.beam.rotation = middle, oo.Quat.between((0, 0, 1), self.ray.direction)
        for leaf in self.beam.children:
            self.beam.detach(leaf)
        self.beam.attach(oo.Leaf([oo.cylinder_drawable(0.025, hit.distance, self.glow)]))

    def before_step(self) -> None:
        """Note what the ray saw, and how near to the ground its hits on the ground are."""
        hit = self.ray.hit
        if hit is None:
            return
        self.seen.add(hit.geom.name if hit.body is None else hit.body.name)
        if hit.geom is self.terrain:
            self.error = max(self.error, abs(hit.point.y - self.terrain.height_at(hit.point.x, hit.point.z)))
        for ball in (*self.rolling, *self.rings.values()):
            x, y, z = ball.position
            if max(abs(x), abs(z)) < SIZE / 2:
                self.lowest = min(self.lowest, y - self.terrain.height_at(x, z))

    def check(self) -> None:
        """The hull is closed and the other rings are open; balls rolled down; the ray saw ground and things."""
        expect(self.lowest > 0.1, "nothing sinks into the ground")
        for policy, ball in self.lids.items():
            over = ball.position.y - self.rings[policy].position.y
            expect(over > 0.5 if policy == "hull" else over < 0.25, f"the ball lies on the {policy} ring or in it")
        lower = sum(a.y - b.position.y > 0.5 for a, b in zip(self.starts, self.rolling, strict=True))
        expect(lower > 0.6 * len(self.rolling), "the balls roll down")
        expect("valley" in self.seen, "the ray meets the ground")
        expect(any(name.startswith("ring") for name in self.seen), "the ray meets the rings")
        expect(self.error < 1e-6, "the ray meets the ground at its height")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Terrain, arguments)


if __name__ == "__main__":
    main()
