"""The scenes that are timed, as data: built from here in osgode, and told as text to the C program."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import osgode as oo
from osgode import Quat, Vec3
from osgode.maths import IDENTITY, ZERO
from osgode.springs import implicit

STEP_SIZE = 1 / 120
GRAVITY = Vec3(0.0, -9.81, 0.0)
CONTACTS_PER_PAIR = 16
"""osgode's default."""

STIFFNESS, DAMPING = 2e4, 1500.0
"""Of a cart's wheel, N/m and N s/m."""
SUSPENSION = implicit(STIFFNESS, DAMPING, STEP_SIZE)
"""The same as ODE wants it: ERP and CFM."""

Triangles = tuple[list[tuple[float, float, float]], list[tuple[int, int, int]]]

SHAPES: dict[str, Callable[..., oo.Geom]] = {
    "box": lambda *size, **fields: oo.Box(size, **fields),
    "sphere": oo.Sphere,
    "capsule": oo.Capsule,
    "cylinder": oo.Cylinder,
}


@dataclass(frozen=True)
class Part:
    """A shape and where it is: a body with a mass, or static without one."""

    shape: str
    size: tuple[float, ...]
    position: Vec3
    rotation: Quat = IDENTITY
    mass: float | None = None
    asleep: bool = False
    velocity: Vec3 = ZERO
    spin: Vec3 = ZERO


@dataclass(frozen=True)
class Link:
    """A ball joint, or the driven hinge-2 of a wheel (``other``); bodies by number, ``other`` -1: the static world."""

    kind: str
    body: int
    other: int
    anchor: Vec3
    axis: Vec3 = ZERO
    velocity: float = 0.0
    max_force: float = 0.0


@dataclass
class Scene:
    """Everything that both sides need to build the same thing by the same calls of ODE in the same order.

    Args:
        name: for the table.
        settle: steps that are done before the clock runs, so that things lie as they are meant to.
        turn: steps of one turn, some 60 ms.
        auto_disable: whether what comes to rest falls asleep.
    """

    name: str
    settle: int
    turn: int
    auto_disable: bool = False
    mesh: Triangles | None = None
    static: list[Part] = field(default_factory=list)
    bodies: list[Part] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)

    def text(self) -> str:
        """The scene as ``benchmarks/c/raw.c`` reads it; a repr of a float gives the same bits back."""
        lines = [_line("world", STEP_SIZE, *GRAVITY, CONTACTS_PER_PAIR)]
        if self.auto_disable:
            lines.append("auto_disable")
        if self.mesh is None:
            lines.append(_line("plane", 0, 1, 0, 0))
        else:
            vertices, triangles = self.mesh
            lines.append(_line("mesh", len(vertices), len(triangles)))
            lines += [_line(*row) for row in (*vertices, *triangles)]
        for part in self.static:
            lines.append(_line("place", *part.position, *part.rotation, part.shape, *part.size))
        for part in self.bodies:
            lines.append(_line("body", part.mass, *part.position, *part.rotation, part.shape, *part.size))
            if part.velocity != ZERO or part.spin != ZERO:
                lines.append(_line("velocity", *part.velocity, *part.spin))
            if part.asleep:
                lines.append("asleep")
        for link in self.links:
            extra = () if link.kind == "ball" else (*link.axis, link.velocity, link.max_force, *SUSPENSION)
            lines.append(_line(link.kind, link.body, link.other, *link.anchor, *extra))
        return "\n".join([*lines, "go", ""])

    def world(self, broad_phase: str = "own") -> oo.World:
        """The scene in osgode, with pairs found by its own broad phase or by ODE's spaces."""
        world = oo.World(
            gravity=GRAVITY,
            step_size=STEP_SIZE,
            contacts_per_pair=CONTACTS_PER_PAIR,
            auto_disable=self.auto_disable,
            broad_phase=broad_phase,
        )
        moving = world.attach(oo.HashSpace(name="moving"))
        fixed = world.attach(oo.SimpleSpace(name="fixed"))
        world.collide(moving)
        world.collide(moving, fixed)
        fixed.attach(oo.Plane() if self.mesh is None else oo.Trimesh(self.mesh))
        for part in self.static:
            place = fixed.attach(oo.Placeable(position=part.position, rotation=part.rotation))
            place.attach(SHAPES[part.shape](*part.size))
        bodies = []
        for part in self.bodies:
            body = moving.attach(oo.Body(position=part.position, rotation=part.rotation))
            body.attach(oo.Placeable()).attach(SHAPES[part.shape](*part.size, mass=part.mass))
            if part.velocity != ZERO or part.spin != ZERO:
                body.linear_velocity, body.angular_velocity = part.velocity, part.spin
            if part.asleep:
                body.enabled = False
            bodies.append(body)
        for link in self.links:
            other = None if link.other < 0 else bodies[link.other]
            if link.kind == "ball":
                oo.Ball(bodies[link.body], other, anchor=link.anchor)
            else:
                axle = oo.Hinge2(
                    bodies[link.body], bodies[link.other], anchor=link.anchor, axis2=link.axis, stops1=(0, 0)
                )
                axle.suspension_stiffness, axle.suspension_damping = STIFFNESS, DAMPING
                axle.motor(link.velocity, link.max_force, axis=2)
        return world


def _line(*words: object) -> str:
    return " ".join(map(str, words))


def _any_rotation(dice: random.Random) -> Quat:
    return Quat(*(dice.gauss(0, 1) for _ in range(4))).normalized()


def _lattice(dice: random.Random, count: int, columns: int, pitch: float, lowest: float) -> Iterable[Vec3]:
    """Places in layers of ``columns`` squared, each a little off, from ``lowest`` upwards."""
    for k in range(count):
        layer, place = divmod(k, columns * columns)
        row, column = divmod(place, columns)
        middle = (columns - 1) / 2
        yield Vec3(
            (column - middle) * pitch + dice.uniform(-0.1, 0.1) * pitch,
            lowest + layer * pitch,
            (row - middle) * pitch + dice.uniform(-0.1, 0.1) * pitch,
        )


def boxes(count: int = 1000) -> Scene:
    """Boxes dropped on a heap."""
    dice = random.Random(1)
    scene = Scene(f"{count} boxes", settle=360, turn=10)
    for place in _lattice(dice, count, 10, 1.0, 0.6):
        size = tuple(dice.uniform(0.4, 0.7) for _ in range(3))
        mass = 500 * math.prod(size)
        scene.bodies.append(Part("box", size, place, _any_rotation(dice), mass))
    return scene


def spheres(count: int = 1000) -> Scene:
    """Spheres in a bin with four walls."""
    dice = random.Random(2)
    scene = Scene(f"{count} spheres", settle=360, turn=12)
    for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        scene.static.append(Part("box", (1 + 8 * abs(z), 6.0, 1 + 8 * abs(x)), Vec3(4.5 * x, 3.0, 4.5 * z)))
    for place in _lattice(dice, count, 10, 0.75, 0.5):
        radius = dice.uniform(0.2, 0.32)
        scene.bodies.append(Part("sphere", (radius,), place, mass=2000 * radius**3))
    return scene


def chains(count: int = 50, links: int = 20) -> Scene:
    """Chains of capsules that hang from the sky, let go from the side: they swing into each other."""
    dice = random.Random(3)
    scene = Scene(f"{count} chains of {links}", settle=240, turn=40)
    radius, length = 0.06, 0.2
    pitch = length + 2 * radius
    for chain in range(count):
        row, column = divmod(chain, 10)
        start = Vec3(column * 0.8 + dice.uniform(-0.1, 0.1), 7.0, row * 0.8 + dice.uniform(-0.1, 0.1))
        heading, slope = dice.uniform(0, 2 * math.pi), dice.uniform(0.3, 1.2)
        along = Vec3(
            math.cos(heading) * math.cos(slope), -math.sin(slope), math.sin(heading) * math.cos(slope)
        ).normalized()
        turn = Quat.between((0, 0, 1), along)
        for k in range(links):
            number = len(scene.bodies)
            scene.bodies.append(Part("capsule", (radius, length), start + along * (pitch * (k + 0.5)), turn, 1.0))
            scene.links.append(Link("ball", number, number - 1 if k else -1, start + along * (pitch * k)))
    return scene


def on_mesh(count: int = 300, cells: int = 71) -> Scene:
    """Boxes, spheres and capsules in a bumpy bowl of some 10 000 triangles."""
    dice = random.Random(4)
    scene = Scene(f"{count} on a mesh", settle=300, turn=25)
    half = cells / 2

    def height(x: float, z: float) -> float:
        return 0.15 * math.hypot(x, z) + 0.25 * math.sin(1.1 * x) * math.cos(0.9 * z)

    vertices = [
        (0.6 * (i - half), height(0.6 * (i - half), 0.6 * (j - half)), 0.6 * (j - half))
        for j in range(cells + 1)
        for i in range(cells + 1)
    ]
    triangles = []
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i
            b, c, d = a + 1, a + cells + 1, a + cells + 2
            triangles += [(a, c, b), (b, c, d)]
    scene.mesh = vertices, triangles
    for k, place in enumerate(_lattice(dice, count, 10, 1.5, 2.0)):
        shape = ("box", "sphere", "capsule")[k % 3]
        size = {
            "box": tuple(dice.uniform(0.4, 0.8) for _ in range(3)),
            "sphere": (dice.uniform(0.25, 0.4),),
            "capsule": (dice.uniform(0.15, 0.25), dice.uniform(0.3, 0.6)),
        }[shape]
        scene.bodies.append(Part(shape, size, place, _any_rotation(dice), dice.uniform(50, 150)))
    return scene


def carts(count: int = 20) -> Scene:
    """Carts with four driven wheels on springs, on lanes with bumps.

    The lanes are so wide that no wheel meets another cart's: osgode hands two cylinders to ODE in a fixed
    order, plain C in the order that they come in.
    """
    dice = random.Random(5)
    scene = Scene(f"{count} carts", settle=120, turn=100)
    for lane in range(count):
        z, turn = 5.0 * lane, Quat.from_axis_angle((0, 1, 0), dice.uniform(-0.02, 0.02))
        for bump in range(1, 13):
            where = Vec3(4.0 * bump + dice.uniform(-1, 1), 0.0, z + dice.uniform(-0.4, 0.4))
            lift = Quat.from_axis_angle((0, 1, 0), dice.uniform(-0.5, 0.5))
            scene.static.append(Part("box", (0.4, 0.16, 1.0), where, lift))
        centre = Vec3(dice.uniform(-1, 1), 0.75, z)
        hull = len(scene.bodies)
        scene.bodies.append(Part("box", (2.0, 0.4, 0.9), centre, turn, 200.0))
        speed = -dice.uniform(6, 9)
        for x, side in ((0.7, 0.65), (0.7, -0.65), (-0.7, 0.65), (-0.7, -0.65)):
            anchor = centre + turn.rotate((x, -0.35, side))
            wheel = len(scene.bodies)
            scene.bodies.append(Part("cylinder", (0.35, 0.2), anchor, turn, 15.0))
            scene.links.append(Link("hinge2", hull, wheel, anchor, turn.rotate((0, 0, 1)), speed, 40.0))
    return scene


def sleeping(count: int = 5000, moving: int = 50) -> Scene:
    """Boxes that sleep on the ground in rows, and balls that roll in the lanes between them."""
    scene = Scene(f"{count} asleep and {moving} moving", settle=60, turn=15, auto_disable=True)
    columns, radius, speed = 71, 0.2, 2.0
    for k in range(count):
        row, column = divmod(k, columns)
        scene.bodies.append(Part("box", (0.5, 0.5, 0.5), Vec3(column, 0.25, row), mass=60.0, asleep=True))
    for k in range(moving):
        place = Vec3(columns + 0.1 * k, radius, k + 0.5)
        spin = Vec3(0, 0, speed / radius)
        scene.bodies.append(Part("sphere", (radius,), place, mass=5.0, velocity=Vec3(-speed, 0, 0), spin=spin))
    return scene


SCENES: dict[str, Callable[[], Scene]] = {
    "boxes": boxes,
    "spheres": spheres,
    "chains": chains,
    "mesh": on_mesh,
    "carts": carts,
    "sleeping": sleeping,
}
