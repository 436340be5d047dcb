"""A race track: a closed road with bends, kerbs, walls, a bank over which part of it leads, a ramp, and a hill beside.

Road, verges and hill are meshes made here; they lie on level ground that the scene has. `Track.line` is the middle of
the road, for drivers and for whoever counts laps.
"""

from __future__ import annotations

import math

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.game.closed_line import ClosedLine
from osgode.examples.game.track_mesh import (
    BENT,
    HILL_HEIGHT,
    WIDTH,
    Sections,
    hill,
    own_line,
    ramp,
    road,
    wide,
)
from osgode.examples.runner import look, painted

WALL = (0.3, 0.75)
"""Thickness and height of a wall, metres."""
WALL_LENGTH, WALL_DISTANCE = 2.6, 4.0
"""Of each piece of it, and from the road's edge, metres."""

RAMP_AT, RAMP_ASIDE = 44.0, 3.2
"""How far along the line it begins, and how far to the right of it its middle is, metres."""

HILL = (25.0, -52.0)
"""x and z of the hill's middle, metres."""


class Track(CompositeObject):
    """Road, walls, ramp and hill, all of it static: attach it to the space of what stands still.

    Args:
        position: of the start line's middle, metres in the world; level ground must be at its height all about.
        yaw: 0 has it lead along -Z from there, radians.
        name: for messages and paths.
    """

    def __init__(self, position: oo.Vec3Like = (0.0, 0.0, 0.0), yaw: float = 0.0, *, name: str = "track") -> None:
        super().__init__(name=name)
        self.frame = oo.Pose(oo.Vec3(*position), oo.Quat.from_yaw_pitch_roll(yaw))
        """The track's own axes in the world."""
        self.line = ClosedLine([self.frame.transform(oo.Vec3(*map(float, point))) for point in own_line()])
        """The middle of the road; it begins at the start line, and cars go round it clockwise."""
        self.width = WIDTH
        """Of the road, metres."""
        self.road = self._still(oo.Trimesh(road(), material="concrete", name=f"{name} road"))
        grassy = look("grass", (0.82, 0.95, 0.75), scale=4.0, shine=0.0)
        self.hill = self._still(
            oo.Trimesh(hill(), material="earth", name=f"{name} hill", shown=oo.Drawable(hill(), grassy)),
            (HILL[0], 0.0, HILL[1]),
        )
        wood = look("planks", (0.9, 0.78, 0.6), scale=1.2)
        place, turn = self._own_ramp()
        self.ramp = self._still(
            oo.Trimesh(ramp(), material="wood", name=f"{name} ramp", shown=oo.Drawable(ramp(), wood)), place, turn
        )
        self.walls = tuple(self._walls())

    def _still(
        self, geom: oo.Geom, position: oo.Vec3Like = (0.0, 0.0, 0.0), rotation: oo.Quat | None = None
    ) -> oo.Geom:
        """A part at a place of the track's own axes."""
        own = oo.Pose(oo.Vec3(*position), rotation or oo.Quat(1.0, 0.0, 0.0, 0.0))
        spot = self.frame * own
        self.attach(oo.Placeable(position=spot.position, rotation=spot.rotation)).attach(geom)
        return geom

    def _own_ramp(self) -> tuple[oo.Vec3, oo.Quat]:
        line = ClosedLine([tuple(map(float, point)) for point in own_line()])
        at, yaw = line.at(RAMP_AT), line.yaw(RAMP_AT)
        turn = oo.Quat.from_yaw_pitch_roll(yaw)
        return at + turn.rotate((RAMP_ASIDE, 0.0, 0.0)), turn

    def _walls(self) -> list[oo.Geom]:
        """Pieces of wall outside of the bends, red and white in turn."""
        sections = Sections(own_line())
        bends = sections.bends()
        made: list[oo.Geom] = []
        paints = (painted(0.85, 0.84, 0.8, 0.2), painted(0.78, 0.12, 0.1, 0.2))
        for side in (-1, 1):  # a bend to the left has its wall on the right
            walled = wide(side * bends > BENT, 5)
            post: oo.Vec3 | None = None
            for k in range(len(walled)):
                if not walled[k]:
                    post = None
                    continue
                point = oo.Vec3(*sections.ground_beside(k, side * (WIDTH / 2 + WALL_DISTANCE)))
                if post is None:
                    post = point
                elif post.distance(point) >= WALL_LENGTH:
                    made.append(self._wall(post, point, paints[len(made) % 2]))
                    post = point
        return made

    def _wall(self, first: oo.Vec3, last: oo.Vec3, paint: oo.Appearance) -> oo.Geom:
        thick, high = WALL
        way = last - first
        turn = oo.Quat.from_yaw_pitch_roll(math.atan2(-way.x, -way.z), math.asin(way.y / way.length))
        size = (thick, high + 0.5, way.length + 0.08)
        middle = (first + last) / 2 + (0.0, (high - 0.5) / 2, 0.0)
        return self._still(oo.Box(size, material="concrete", appearance=paint), middle, turn)

    # -- places

    def spot(self, distance: float, aside: float = 0.0) -> tuple[oo.Vec3, float]:
        """A place on the road, and the yaw of what drives on from there: what a car is made with.

        Args:
            distance: along the line from the start, metres.
            aside: of the line, to the right, metres.
        """
        yaw = self.line.yaw(distance)
        return self.line.at(distance) + oo.Quat.from_yaw_pitch_roll(yaw).rotate((aside, 0.0, 0.0)), yaw

    def before_ramp(self, distance: float) -> tuple[oo.Vec3, float]:
        """A place so many metres before the ramp, and the yaw that leads straight over it."""
        return self.spot(RAMP_AT - distance, RAMP_ASIDE)

    @property
    def hilltop(self) -> oo.Vec3:
        """The top of the hill, in the world."""
        return self.frame.transform((HILL[0], HILL_HEIGHT, HILL[1]))

    def before_hill(self, distance: float) -> tuple[oo.Vec3, float]:
        """A place on the ground so many metres from the hill's middle, and the yaw that leads straight up."""
        at = self.frame.transform((HILL[0], 0.0, HILL[1] + distance))
        ahead = self.frame.rotation.rotate((0.0, 0.0, -1.0))
        return at, math.atan2(-ahead.x, -ahead.z)
