"""What stands still in the game, and the stations of its course: house, stairs, beam, banks, gallows, bridge."""

from __future__ import annotations

import math

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.game.pendulum import LENGTH, Pendulum
from osgode.examples.game.platform import BUTTON, SIZE, Button, Platform
from osgode.examples.game.swing_door import SIZE as DOOR
from osgode.examples.game.swing_door import SwingDoor
from osgode.examples.runner import ASSETS, look

HIGH = 1.6
"""Of the beam and of the banks, metres."""
HOUSE = oo.Vec3(-10.0, 0.0, -9.0)
"""Its middle on the ground; its door looks along +Z."""
FLOOR, DOORWAY = 0.05, oo.Vec3(0.0, 0.05, 2.9)
"""Height of its floor, and where its doorway is, metres."""
STAIRS, RISE, TREAD = 8, HIGH / 8, 0.36
"""Steps, and the height and depth of each, metres."""
COURSE = oo.Vec3(7.0, 0.0, -5.0)
"""The foot of the stairs; the course leads along -Z from there."""
WIDE, BEAM_WIDE = 3.0, 0.8
"""Of stairs and banks, and of the beam, metres."""
BEAM = 11.0
"""Length of the beam, metres."""
HUNG = (2.2, 5.4, 8.6)
"""How far along the beam the pendulums hang, metres."""
BANK = 4.4
"""How deep each bank is, metres."""
GAP = 8.0
"""Between the second bank and the third, over which the platform goes, metres."""
SPAN, LINKS, SLACK = 10.0, 20, 0.08
"""The gap that the bridge hangs over, metres, the links of its chains, and how much longer than it they are, metres."""
HALF = 0.75
"""Half of the bridge's width, metres."""
PLANK_MASS, CHAIN_MASS = 9.0, 90.0
"""Of a plank, and of a chain, kg."""
RAMP = math.radians(24.0)
"""How steep the way down at the end is, radians."""


class Still(CompositeObject):
    """Static boxes and meshes, to be attached to the space of what stands still."""

    def box(
        self, low: oo.Vec3Like, high: oo.Vec3Like, texture: str = "concrete", *, material: str = "concrete"
    ) -> oo.Box:
        """A box between two corners."""
        first, last = oo.Vec3(*low), oo.Vec3(*high)
        tint = {"concrete": (0.86, 0.84, 0.8), "planks": (0.72, 0.57, 0.43)}.get(texture, (1.0, 1.0, 1.0))
        geom = oo.Box(last - first, material=material, appearance=look(texture, tint, scale=1.6, shine=0.05))
        self.attach(oo.Placeable(position=(first + last) / 2)).attach(geom)
        return geom


class House(Still):
    """The cottage, with a table in it."""

    def __init__(self, position: oo.Vec3Like = HOUSE, *, name: str = "house") -> None:
        super().__init__(name=name)
        self.place_on = oo.Vec3(*position)
        walls = oo.Trimesh(oo.load_model(ASSETS / "house.obj"), material="brick", name=name)
        self.attach(oo.Placeable(position=position)).attach(walls)
        x, _, z = self.table = self.place_on + oo.Vec3(1.6, FLOOR + 0.8, -1.4)
        top = self.table.y
        self.box((x - 0.7, top - 0.06, z - 0.4), (x + 0.7, top, z + 0.4), "planks", material="wood")
        for side in (-0.6, 0.6):
            for along in (-0.32, 0.32):
                foot = (x + side - 0.04, FLOOR, z + along - 0.04)
                self.box(foot, (x + side + 0.04, top - 0.06, z + along + 0.04), "planks", material="wood")

    @property
    def hinges(self) -> oo.Vec3:
        """The foot of the hinges of its door."""
        return self.place_on + DOORWAY - (DOOR[0] / 2, 0.0, 0.0)


class Course(Still):
    """Stairs, beam, gallows, three banks and a way down: what the player walks on. Its parts are told by z."""

    def __init__(self, position: oo.Vec3Like = COURSE, *, name: str = "course") -> None:
        super().__init__(name=name)
        x, y, z = position
        half = WIDE / 2
        for k in range(STAIRS):
            self.box((x - half, y, z - (k + 1) * TREAD), (x + half, y + (k + 1) * RISE, z - k * TREAD))
        begin = z - STAIRS * TREAD
        self.box((x - half, y, begin - 1.2), (x + half, y + HIGH, begin))
        self.beam_from = begin - 1.2
        self.beam_to = self.beam_from - BEAM
        self.box((x - BEAM_WIDE / 2, y, self.beam_to), (x + BEAM_WIDE / 2, y + HIGH, self.beam_from))
        self.hinges = [oo.Vec3(x, y + HIGH + LENGTH + 0.95, self.beam_from - along) for along in HUNG]
        for hinge in self.hinges:
            self._gallows(hinge, y)
        edge = self.beam_to - BANK
        self.box((x - half, y, edge), (x + half, y + HIGH, self.beam_to))
        self.button = oo.Vec3(x, y + HIGH + 0.18, self.beam_to - BANK / 2)
        """The middle of the button's top."""
        plate = (BUTTON[0] / 2 + 0.15, BUTTON[2] / 2 + 0.15)
        low = (x - plate[0], y + HIGH, self.button.z - plate[1])
        self.box(low, (x + plate[0], y + HIGH + 0.02, self.button.z + plate[1]), "steel", material="steel")
        reach = SIZE[2] / 2 + 0.03
        self.platform = (oo.Vec3(x, y + HIGH, edge - reach), oo.Vec3(x, y + HIGH, edge - GAP + reach))
        """Where the middle of the platform's top begins and ends."""
        far = edge - GAP
        self.box((x - half, y, far - BANK), (x + half, y + HIGH, far))
        self.lookout = oo.Vec3(x + 0.6, y + HIGH, far - 1.4)
        """A place on the bank beyond the platform."""
        middle = far - BANK / 2
        self.bridge = (oo.Vec3(x - half, y + HIGH, middle), oo.Vec3(x - half - SPAN, y + HIGH, middle))
        """The edges that the bridge hangs from."""
        end = x - half - SPAN
        self.box((end - WIDE, y, far - BANK), (end, y + HIGH, far))
        self.island = oo.Vec3(end - WIDE / 2, y + HIGH, middle)
        """The bank beyond the bridge."""
        self._way_down(oo.Vec3(end - WIDE / 2, y, far))

    def _gallows(self, hinge: oo.Vec3, ground: float) -> None:
        x, top, z = hinge
        for side in (-3.1, 3.1):
            low = (x + side - 0.11, ground, z - 0.11)
            self.box(low, (x + side + 0.11, top + 0.25, z + 0.11), "planks", material="wood")
        self.box((x - 3.3, top + 0.02, z - 0.11), (x + 3.3, top + 0.24, z + 0.11), "planks", material="wood")

    def _way_down(self, edge: oo.Vec3) -> None:
        long, thick = HIGH / math.sin(RAMP), 0.16
        tilt = oo.Quat.from_axis_angle((1.0, 0.0, 0.0), RAMP)
        middle = edge + oo.Vec3(0.0, HIGH / 2, HIGH / math.tan(RAMP) / 2) - tilt.rotate((0.0, thick / 2, 0.0))
        board = oo.Box((1.8, thick, long), material="wood", appearance=look("planks", scale=1.3, shine=0.05))
        self.attach(oo.Placeable(position=middle, rotation=tilt)).attach(board)


class HangingBridge(CompositeObject):
    """Planks on two chains, which hang as chains hang; somebody can walk over it.

    Args:
        start, end: the edges that it hangs from, metres in the world, at one height.
        name: for messages and paths.
    """

    def __init__(self, start: oo.Vec3Like, end: oo.Vec3Like, *, name: str = "bridge") -> None:
        super().__init__(name=name)
        self._ends = oo.Vec3(*start), oo.Vec3(*end)
        self.planks: list[oo.Body] = []
        self.chains: list[oo.Chain] = []

    def build(self) -> None:
        """Hang it; it has to stand in a World, for whose gravity it hangs."""
        first, last = self._ends
        along = (last - first).normalized()
        side = along.cross((0.0, 1.0, 0.0)) * HALF
        steel = look("steel", (0.7, 0.7, 0.75), shine=0.6)
        down = oo.Vec3(0.0, -0.09, 0.0)
        for way in (side, -side):
            self.chains.append(
                oo.chain(
                    self,
                    first + way + down,
                    last + way + down,
                    length=(last - first).length + SLACK,
                    links=LINKS,
                    radius=0.05,
                    mass=CHAIN_MASS,
                    appearance=steel,
                    joint="universal",
                    name=f"{self.name} chain {len(self.chains) + 1}",
                )
            )
        near, far = self.chains
        wood = look("planks", scale=1.0, shine=0.0)
        long = (last - first).length / LINKS - 0.03
        for k, (link, other) in enumerate(zip(near.links, far.links, strict=True)):
            body = oo.Body(
                name=f"{self.name} plank {k}", position=(link.position + other.position) / 2, rotation=link.rotation
            )
            turned = oo.Placeable(rotation=oo.Quat.from_matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]]))
            plank = oo.Box((long, 0.06, 2 * HALF - 0.1), material="wood", mass=PLANK_MASS, appearance=wood)
            body.attach(turned).attach(plank)
            self.attach(body)
            oo.Fixed(body, link)
            oo.Ball(body, other, anchor=other.position)
            self.planks.append(body)


def furnish(dynamic: oo.Space, static: oo.Space) -> dict[str, CompositeObject]:
    """Put up the level and what moves in it by itself; returns everything by name.

    Args:
        dynamic: the space of what moves.
        static: the space of what stands still.
    """
    house, course = House(), Course()
    static.attach(house)
    static.attach(course)
    made: dict[str, CompositeObject] = {"house": house, "course": course}
    made["door"] = SwingDoor(house.hinges)
    for number, hinge in enumerate(course.hinges):
        made[f"pendulum {number + 1}"] = Pendulum(hinge, phase=0.3 * number, name=f"pendulum {number + 1}")
    platform = Platform(*course.platform)
    made["platform"], made["button"] = platform, Button(course.button, platform.toggle)
    bridge = HangingBridge(*course.bridge)
    made["bridge"] = bridge
    for name, thing in made.items():
        if name not in ("house", "course"):
            dynamic.attach(thing)
    bridge.build()
    return made
