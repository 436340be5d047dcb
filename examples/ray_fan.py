"""A lidar turns on its post and measures what stands and moves around it with a fan of rays.

Shows many rays in one call (`cast_rays`), what they exclude, the geoms that they hit, and purely visual nodes that are
moved for each picture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, look, run

RAYS, SPREAD, REACH = 91, 2.1, 6.0
"""How many, over how many radians, and how far they see, metres."""
HEIGHT, RATE = 0.75, 0.5
"""Of the lidar, metres, and how fast it turns, rad/s."""
BEAM = oo.Appearance((1.0, 0.22, 0.16, 1.0), unlit=True)
FREE = oo.Appearance((0.45, 0.2, 0.22, 1.0), unlit=True)
SPOT = oo.Appearance((1.0, 0.9, 0.2, 1.0), unlit=True)


class RayFan(Example):
    """Columns, walls, crates, a ball that rolls through, and the lidar in the middle."""

    SECONDS = 8.0
    MOMENTS = (0.5, 2.0, 4.5)

    def build(self) -> None:
        """The yard, the lidar and what is drawn of its rays."""
        self.orbit = Orbit(oo.Vec3(0.2, 0.3, -0.6), 10.2, yaw=0.5, pitch=0.62)
        self.fixed.attach(oo.Plane(material="concrete", appearance=look("concrete", scale=3.0, shine=0.0)))
        self.build_yard()
        self.lidar = self.moving.attach(oo.Body(name="lidar", position=(0, HEIGHT, 0), kinematic=True))
        dark = look("steel", (0.3, 0.3, 0.35), shine=0.6)
        upright = oo.Quat.between((0, 0, 1), (0, 1, 0))
        self.lidar.attach(oo.Placeable(rotation=upright)).attach(oo.Cylinder(0.2, 0.22, appearance=dark))
        self.lidar.attach(oo.Placeable(position=(0, 0, -0.17))).attach(oo.Box((0.12, 0.12, 0.12), appearance=dark))
        self.lidar.angular_velocity = (0, RATE, 0)
        post = self.fixed.attach(oo.Placeable(position=(0, HEIGHT / 2 - 0.08, 0), rotation=upright))
        post.attach(oo.Cylinder(0.07, HEIGHT - 0.16, appearance=look("steel", shine=0.5)))
        met, free = (oo.Cylinder(1.0, 1.0, appearance=way).drawables() for way in (BEAM, FREE))
        end = oo.Sphere(0.05, appearance=SPOT).drawables()
        self.beams: list[oo.PositionAttitudeTransform] = []
        self.lit: list[oo.Switch] = []
        self.dim: list[oo.Switch] = []
        self.spots: list[oo.PositionAttitudeTransform] = []
        for _ in range(RAYS):
            beam = self.root.attach(oo.PositionAttitudeTransform())
            for switches, drawables in ((self.lit, met), (self.dim, free)):
                switches.append(beam.attach(oo.Switch()))
                switches[-1].attach(oo.Leaf(drawables))
            self.beams.append(beam)
            self.spots.append(self.root.attach(oo.PositionAttitudeTransform()))
            self.spots[-1].attach(oo.Leaf(end))
        self.seen: set[oo.Geom] = set()
        self.nearest = math.inf
        self.scan()
        self.seen.clear()

    def build_yard(self) -> None:
        """What is to be seen."""
        self.columns = []
        upright = oo.Quat.between((0, 0, 1), (0, 1, 0))
        for i in range(5):
            angle = 2 * math.pi * i / 5 + 0.3
            place = oo.Placeable(position=(3.4 * math.sin(angle), 0.9, 3.4 * math.cos(angle)), rotation=upright)
            column = oo.Cylinder(0.32, 1.8, material="concrete", appearance=look("plaster", scale=1.0))
            self.fixed.attach(place).attach(column)
            self.columns.append(column)
        for position, size in (((-1.0, 0.5, -5.2), (6.0, 1.0, 0.3)), ((5.2, 0.5, -1.0), (0.3, 1.0, 5.0))):
            self.fixed.attach(oo.Placeable(position=position)).attach(
                oo.Box(size, material="brick", appearance=look("brick", scale=1.2))
            )
        for k, (x, z) in enumerate(((-2.6, -2.9), (-2.2, -2.3), (2.3, -2.6), (-3.6, 1.6), (1.8, 2.6))):
            turn = oo.Quat.from_axis_angle((0, 1, 0), 0.5 * k)
            for level in range(2 if k % 2 == 0 else 1):
                crate = self.moving.attach(oo.Body(position=(x, 0.35 + 0.7 * level, z), rotation=turn))
                crate.attach(oo.Placeable()).attach(
                    oo.Box((0.7, 0.7, 0.7), material="wood", mass=10.0, appearance=look("crate"))
                )
        self.ball = self.moving.attach(
            oo.Body(name="ball", position=(-1.9, 0.5, -4.0), linear_velocity=(0.85, 0, 0.35))
        )
        self.ball.attach(oo.Placeable()).attach(
            oo.Sphere(0.5, material="rubber", mass=5.0, appearance=look("plaster", (0.25, 0.5, 1.0), shine=0.6))
        )

    def scan(self) -> oo.RayHits:
        """Send the rays out, each in its own direction of the lidar's front."""
        angles = np.linspace(-SPREAD / 2, SPREAD / 2, RAYS)
        own = np.stack([np.sin(angles), np.zeros(RAYS), -np.cos(angles)], axis=1)
        self.ways = own @ np.array(self.lidar.rotation.to_matrix()).T
        self.hits = self.world.cast_rays(self.lidar.position, self.ways, REACH, exclude=[self.lidar])
        return self.hits

    def before_step(self) -> None:
        """Scan, and note what was seen."""
        hits = self.scan()
        self.seen.update(geom for geom in hits.geoms if geom is not None)
        self.nearest = min(self.nearest, float(hits.distance.min()))

    def update(self) -> None:
        """Lay a beam along each ray as far as it goes, and a spot where it ends."""
        super().update()
        hits = self.scan()
        start = self.lidar.position
        for i, (beam, spot) in enumerate(zip(self.beams, self.spots, strict=True)):
            way = oo.Vec3(*self.ways[i].tolist())
            length = float(hits.distance[i]) if hits.hit[i] else REACH
            beam.pose = oo.Pose(start + way * (length / 2), oo.Quat.between((0, 0, 1), way))
            beam.scale = (0.007, 0.007, length)
            self.lit[i].on, self.dim[i].on = bool(hits.hit[i]), not hits.hit[i]
            spot.visible = bool(hits.hit[i])
            spot.position = start + way * length

    def check(self) -> None:
        """It has seen the columns that its fan passed over, the ball, and never itself."""
        expect(sum(column in self.seen for column in self.columns) >= 4, "the fan passes over most columns")
        expect(any(geom.body is self.ball for geom in self.seen), "it sees the ball")
        expect(all(geom.body is not self.lidar for geom in self.seen), "it does not see itself")
        expect(0.3 < self.nearest < 3.4, "the nearest thing is not beyond the columns")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(RayFan, arguments)


if __name__ == "__main__":
    main()
