"""Fuzz tests: nasty values and hostile listeners must never crash the process.

This file is also the program that the tests start, so that an abort in C is seen as a bad exit code:
``python tests/test_fuzz.py SEED [CALLS]``. ``OSGODE_FUZZ_TRACE=1`` prints each call before it is made, and
``OSGODE_FUZZ_SEEDS=200`` has the tests run more seeds.
"""

import gc
import itertools
import os
import random
import subprocess
import sys
import warnings
from collections import deque
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import osgode as oo
from osgode.native import last_error
from tests.strategies import CUBE, JOINED, NEEDS_TWO
from tests.strategies import join as joined
from tests.trees import is_consistent

SEEDS = int(os.environ.get("OSGODE_FUZZ_SEEDS", "4"))
CALLS = 1500
TRACE = bool(os.environ.get("OSGODE_FUZZ_TRACE"))
NAN, INF = float("nan"), float("inf")


class Unshowable:
    def __repr__(self):
        msg = "a repr that fails"
        raise ValueError(msg)


NUMBERS = [
    *(NAN, INF, -INF, 1e300, -1e300, 1e308, 1e-320, 5e-324, 1e-12, 1e-6, -1e-6, -1, -1.0, 0, 0.0, -0.0, 0.5, 1, 1.0),
    *(2, 3, 1e4 + 0.5, 1e6, 1e7, 1e8, 1e9, 1e15, 1e16, -1e8, 2**31, 2**32, 2**63, 2**64, 10**20, 10**400, 10**5000),
    *(True, False, np.float32(NAN), np.float64(1e300), np.int64(-1), np.int8(3), np.bool_(True), np.uint64(2**63)),
    *(Decimal("NaN"), Decimal("sNaN"), Decimal(2), Decimal("1e999"), Fraction(1, 3), 1 + 2j, np.array(3.0)),
    np.float64("nan"),
]
OTHERS = [
    *(None, "", "nan", "1", "wood", "xyz", "exact", "default", "\udc80", "\0", "a" * 10_000, b"", b"abc", bytearray(3)),
    *((), (0,), (1, 2), (0, 0, 0), (1, 2, 3), (0, 1, 0, 0), (1, 0, 0, 0), (0, 0, 0, 0), (1,) * 7, [], [1, 2, 3]),
    *([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[[]]], {1, 2, 3}, {"x": 1}, {}, frozenset({"default"}), range(3), range(0)),
    *(np.zeros(0), np.zeros(3), np.zeros((3, 3)), np.arange(3), np.array(["a", "b", "c"]), np.array([1, 2, 3j])),
    *(
        np.array([None] * 3),
        np.array([True, False, True]),
        np.array([1, 2, 3], "M8[s]"),
        np.full(3, NAN),
        np.full(4, INF),
    ),
    *(np.eye(3), memoryview(b"abc"), memoryview(np.ones(3)), np.float16([1, 2, 3])),
    *(object(), object, len, NotImplemented, ..., iter([1, 2, 3]), Unshowable(), Exception("x"), oo.Vec3, oo.Body),
    *(oo.Vec3(1, 2, 3), oo.Quat(1, 0, 0, 0), oo.Pose(), oo.Surface(), oo.Mass(1.0), oo.SurfaceTable(), oo.Group()),
    *(
        oo.Mass.box((1, 2, 3), mass=2),
        oo.MeshData(*CUBE),
        oo.Surface(INF, bounce=1, slip=1e6, soft_cfm=1e-12),
        oo.Node(),
    ),
    *(oo.Servo(), oo.Servo(target=1.0), (oo.Vec3(1, 0, 0), oo.Vec3(0, 0, 1)), "euler", "chain", "body1", "world"),
    *(oo.Drawable(oo.Mesh(np.array(CUBE[0], np.float32), np.array(CUBE[1], np.uint32))), CUBE),
]
SPACES = [oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace]
SOLIDS = [oo.Box, oo.Sphere, oo.Capsule, oo.Cylinder]
FROM_DATA = {oo.Trimesh: CUBE, oo.ConvexHull: CUBE, oo.Heightfield: [[0, 1, 0], [1, 0, 1]]}
JOINTS = list(dict.fromkeys(cls for cls, _, _ in JOINED.values()))
NODES = [*SPACES, *SOLIDS, oo.Body, oo.Placeable, oo.Plane, oo.Ray]

VERBS = [
    *((oo.Body, name, 1, ("at",)) for name in ("add_force", "add_local_force", "apply_impulse")),
    *((oo.Body, name, 1, ()) for name in ("add_torque", "add_local_torque", "apply_angular_impulse")),
    *((oo.Body, name, 0, ()) for name in ("wake", "copy", "describe", "__repr__")),
    (oo.PhysicsNode, "copy", 0, ()),
    (oo.PhysicsNode, "__repr__", 0, ()),
    (oo.PhysicsNode, "move_to", 1, ()),
    (oo.Group, "attach", 1, ()),
    (oo.Group, "attach", 1, ()),
    (oo.Group, "detach", 1, ()),
    (oo.World, "collide", 2, ()),
    (oo.World, "stop_colliding", 2, ()),
    (oo.World, "geom_of_slot", 1, ()),
    *((cls, "motor", 2, ()) for cls in (oo.Hinge, oo.Slider)),
    *((cls, "motor", 2, ("axis",)) for cls in (oo.Universal, oo.PU, oo.AngularMotor, oo.LinearMotor, oo.Plane2D)),
    *((cls, "add_torque", 1, ()) for cls in (oo.Hinge, oo.Piston, oo.PR)),
    *((cls, "add_force", 1, ()) for cls in (oo.Slider, oo.Piston)),
    *((cls, "add_torques", 2, ()) for cls in (oo.Universal, oo.Hinge2, oo.AngularMotor)),
    (oo.Plane2D, "straighten", 0, ()),
    (oo.Joint, "anchor_anew", 0, ("anchor", "axis1")),
    (oo.Joint, "on_let_go", 1, ()),
    (oo.Fixed, "fix", 0, ()),
    (oo.Joint, "release", 0, ()),
    (oo.Joint, "__repr__", 0, ()),
]
"""A class, the name of a method, how many arguments it takes, and what keywords."""

PROPERTIES = [
    (cls, name)
    for cls in (oo.World, oo.Body, oo.Placeable, oo.Plane, oo.Ray, oo.HashSpace, *FROM_DATA, *SOLIDS, *JOINTS)
    for name in dir(cls)
    if isinstance(getattr(cls, name), property) and not name.startswith("_")
]


class Fuzz:
    """A seeded random program."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.last = deque(maxlen=30)
        self.failures = []
        self.notes = []
        self.raised = self.passed = 0
        self.nodes = []
        self.joints = []
        self.worlds = []
        for _ in range(2):
            self.furnish()

    # -- what to do it with

    def furnish(self) -> None:
        """A World with something of everything in it."""
        world = oo.World()
        self.worlds.append(world)
        spaces = [world.attach(cls()) for cls in SPACES]
        inner = spaces[1].attach(oo.HashSpace())
        for space in (*spaces, inner):
            world.collide(space)
        world.collide(spaces[0], spaces[1])
        plane = spaces[0].attach(oo.Plane(offset=-1))
        bodies = []
        for i, space in enumerate((*spaces, inner, world)):
            body = space.attach(oo.Body(position=(0.8 * i, 0, 0)))
            parts = [oo.Box(), oo.Sphere(), oo.Capsule(), oo.Cylinder(), oo.Trimesh(CUBE), oo.Ray()]
            parts += [oo.ConvexHull(CUBE, solid=solid) for solid in (False, True)]
            parts.append(oo.Heightfield([[0, 1, 0], [1, 0, 1]], (2, 3), mass=0))
            for k, part in enumerate(self.random.sample(parts, 2)):
                place = body.attach(oo.Placeable(position=(0.2 * k, 0, 0)))
                self.nodes += [place, place.attach(part)]
            bodies.append(body)
        floor = spaces[2].attach(oo.Placeable(position=(0, -2, 0)))
        self.nodes += [*spaces, inner, plane, *bodies, floor, floor.attach(oo.Box((9, 1, 9)))]
        for kind in JOINED:
            one, two = self.random.sample(bodies, 2)
            self.joints.append(joined(kind, one, two if kind in NEEDS_TWO or self.random.random() < 0.5 else None))

    def value(self):
        r = self.random.random()
        if r < 0.35:
            return self.random.choice(NUMBERS)
        if r < 0.5:
            return tuple(self.random.choice(NUMBERS) for _ in range(self.random.choice((2, 3, 3, 3, 4))))
        if r < 0.9:
            return self.random.choice(OTHERS)
        return self.random.choice([*self.nodes, *self.joints, *self.worlds])

    def node_or_value(self):
        if self.random.random() < 0.3:
            return self.value()
        return self.random.choice([*self.nodes, *self.worlds])

    def field_value(self, cls, name):
        """Half of the time something that the field takes, so that the program gets anywhere."""
        field = cls.FIELDS[name]
        if self.random.random() < 0.5:
            return self.value()
        for _ in range(30):
            value = self.value()
            try:
                field.check.convert(value)
            except Exception:  # noqa: BLE001, S112
                continue
            return value
        return field.default

    # -- doing it

    def call(self, words, function, *args, **kwargs):
        """Make a call; only errors that osgode raises on purpose, or Python for wrong arguments, may come back."""
        text = f"{words}({', '.join([*map(_text, args), *(f'{k}={_text(v)}' for k, v in kwargs.items())])})"
        self.last.append(text)
        if TRACE:
            print(text, flush=True)  # noqa: T201
        try:
            result = function(*args, **kwargs)
        except (oo.OsgodeError, TypeError) as error:
            self.raised += 1
            if isinstance(error, oo.PhysicsError):
                self.notes.append(f"{text}: {error}")
        except Exception as error:  # noqa: BLE001
            self.failures.append(f"{text}: {type(error).__name__}: {str(error)[:300]} at {_place(error)}")
        else:
            self.passed += 1
            return result
        return None

    def set_field(self):
        servos = [joint.servo for joint in self.joints if getattr(joint, "servo", None) is not None]
        node = self.random.choice([*self.nodes, *self.nodes, *self.joints, *servos, *self.worlds])
        if not node.FIELDS:
            return
        name = self.random.choice(list(node.FIELDS))
        value = self.field_value(type(node), name)
        self.call(f"{self.label(node)}.{name} = ", setattr, node, name, value)
        self.call(f"{self.label(node)}.{name}", getattr, node, name)

    def construct(self):
        cls = self.random.choice([*NODES, oo.World, *FROM_DATA])
        names = self.random.sample(list(cls.FIELDS), min(len(cls.FIELDS), self.random.choice((0, 1, 1, 2, 3))))
        kwargs = {name: self.field_value(cls, name) for name in names if name != "data"}
        args = (self.random.choice((FROM_DATA[cls], self.value())),) if cls in FROM_DATA else ()
        node = self.call(cls.__name__, cls, *args, **kwargs)
        if isinstance(node, oo.World):
            node.attach(oo.Body())
        elif node is not None:
            if len(self.nodes) > 120:
                self.nodes.pop(self.random.randrange(len(self.nodes)))
            self.nodes.append(node)

    def join(self):
        cls = self.random.choice(JOINTS)
        bodies = [node for node in self.nodes if isinstance(node, oo.Body)]
        names = self.random.sample(list(cls.FIELDS), self.random.choice((0, 1, 2)))
        kwargs = {name: self.field_value(cls, name) for name in names}
        if self.random.random() < 0.5:
            wanted = [
                *cls.SPOTS,
                *{oo.AngularMotor: ("axes", "relative_to", "mode"), oo.Transmission: ("mode",)}.get(cls, ()),
            ]
            kwargs |= {name: self.value() for name in wanted if self.random.random() < 0.5}
        pair = [self.random.choice(bodies) if self.random.random() < 0.9 else self.value() for _ in range(2)]
        joint = self.call(cls.__name__, cls, *pair[: self.random.choice((1, 2, 2))], **kwargs)
        if joint is not None:
            if len(self.joints) > 50:
                self.call("release", self.joints.pop(0).release)
            self.joints.append(joint)

    def verb(self):
        cls, name, count, keywords = self.random.choice(VERBS)
        things = [*self.nodes, *self.joints, *self.worlds]
        thing = self.random.choice([thing for thing in things if isinstance(thing, cls)] or self.worlds)
        if not isinstance(thing, cls):
            return
        tree = name in ("attach", "detach", "move_to", "collide", "stop_colliding")
        args = [self.node_or_value() if tree else self.value() for _ in range(count)]
        if name == "detach" and self.random.random() < 0.5 and thing.children:
            args = [self.random.choice(thing.children)]
        if any(isinstance(a, oo.Mass | oo.Drawable) for a in args) and tree:
            return
        kwargs = {keyword: self.value() for keyword in keywords if self.random.random() < 0.5}
        made = self.call(f"{self.label(thing)}.{name}", getattr(thing, name), *args, **kwargs)
        if name == "on_let_go" and made is not None:
            thing.remove_on_let_go(made)  # what else is callable here would raise wherever the joint lets go
        if name == "copy" and made is not None and len(self.nodes) < 120:
            self.nodes += [node for node in made.walk() if isinstance(node, oo.PhysicsNode)]

    def read(self):
        cls, name = self.random.choice(PROPERTIES)
        things = [thing for thing in (*self.nodes, *self.joints, *self.worlds) if isinstance(thing, cls)]
        if things:
            thing = self.random.choice(things)
            self.call(f"{self.label(thing)}.{name}", getattr, thing, name)

    def write_property(self):
        choices = [(cls, name) for cls in JOINTS for name in cls.SPOTS] + [(oo.World, "surfaces")]
        choices += [(oo.AngularMotor, "axes"), (oo.LinearMotor, "axes")]
        cls, name = self.random.choice(choices)
        things = [thing for thing in (*self.joints, *self.worlds) if isinstance(thing, cls)]
        if things:
            thing = self.random.choice(things)
            self.call(f"{self.label(thing)}.{name} = ", setattr, thing, name, self.value())

    def values(self):
        """Things that are no nodes: masses, surfaces, tables, meshes, materials."""
        table = oo.SurfaceTable()
        mass = oo.Mass.box((1, 2, 3), mass=1.0)
        which = {self.random.choice(("mass", "density")): self.value()}
        function, args, kwargs = self.random.choice(
            [
                (oo.Mass, [self.value()], {}),
                (oo.Mass, [self.value(), self.value(), self.value()], {}),
                (oo.Mass, [1.0], {"inertia": [(self.value(), 0, 0), (0, self.value(), 0), (0, 0, 1)]}),
                (oo.Mass.sphere, [self.value()], which),
                (oo.Mass.box, [self.value()], which),
                (oo.Mass.capsule, [self.value(), self.value()], which),
                (oo.Mass.cylinder, [self.value(), 1.0], which),
                (oo.Mass.mesh, [self.value(), self.value()], which),
                (oo.Mass.mesh, [CUBE[0], self.value()], which),
                (oo.Mass.mesh, [CUBE[0], CUBE[1]], which),
                (mass.scaled, [self.value()], {}),
                (mass.translated, [self.value()], {}),
                (mass.__add__, [self.value()], {}),
                (oo.MeshData, [self.value(), self.value()], {}),
                (oo.MeshData, [self.value(), CUBE[1]], {}),
                (oo.MeshData, [CUBE[0], self.value()], {}),
                (oo.MeshData, [[[self.value()] * 3] * 3, [[0, 1, 2]]], {}),
                (oo.MeshData, [CUBE[0], [[self.value(), 1, 2]]], {}),
                (oo.HeightData, [self.value()], {}),
                (oo.HeightData, [[[self.value(), 1], [2, self.value()]]], {}),
                (oo.ConvexHull, [[[self.value()] * 3, [1, 0, 0], [0, 1, 0], [0, 0, 1]]], {}),
                (oo.colliders, [CUBE, self.value()], {}),
                (oo.colliders, [self.value(), self.random.choice(("hull", "mesh"))], which),
                (oo.colliders, [CUBE, "hull"], {**which, "most_hulls": self.value()}),
                (oo.Surface, [self.value()], {}),
                (oo.Surface, [], {self.random.choice(list(oo.Surface.__dataclass_fields__)): self.value()}),
                (oo.SurfaceTable, [{}, self.value()], {}),
                (oo.SurfaceTable, [{("wood", "wood"): self.value()}], {}),
                (table.__setitem__, [self.value(), oo.Surface()], {}),
                (table.__setitem__, [("wood", "ice"), self.value()], {}),
                (table.__getitem__, [self.value()], {}),
                (table.__getitem__, [(self.value(), "wood")], {}),
                (table.__contains__, [self.value()], {}),
                (oo.define_material, [self.value()], {}),
                (oo.define_material, ["wood", self.value()], {}),
                (oo.define_kind, [self.value()], {}),
                (self.random.choice(self.worlds).surfaces.__setitem__, [("wood", "ice"), self.value()], {}),
                (self.random.choice(self.worlds).step, [self.bad_count()], {}),
                (self.random.choice(self.worlds).run, [self.bad_count()], {}),
                (self.random.choice(self.worlds).run, [], {"steps": self.bad_count()}),
                (self.random.choice(self.worlds).run, [self.bad_count()], {"steps": self.bad_count()}),
            ]
        )
        self.call(getattr(function, "__qualname__", str(function)), function, *args, **kwargs)

    def bad_count(self):
        """Not a number of steps that would take for ever."""
        value = self.value()
        try:
            return -1 if float(value) > 2 else value
        except Exception:  # noqa: BLE001
            return value

    def listen(self):
        node = self.random.choice([node for node in self.nodes if hasattr(node, "on_touch")])
        value = self.random.choice((self.value(), self.disturb, self.disturb))
        if self.call(f"{self.label(node)}.on_touch", node.on_touch, value) is not None and value != self.disturb:
            node.remove_on_touch(value)

    def disturb(self, touch):
        """A listener that does anything to anything."""
        self.random.choice((self.set_field, self.verb, self.read, self.construct, self.join))()
        self.call("Touch", lambda: (touch.points, touch.normals, touch.depths, touch.body, touch.other_body))

    def step(self):
        world = self.random.choice(self.worlds)
        fields = {"step_size": 1 / 120, "iterations": 20, "solver": "quick"}
        if self.random.random() < 0.7:
            for name, value in fields.items():
                setattr(world, name, value)
        if len(world.joints) + 3 * len(world.contacts) > 500 and world.solver == "exact":
            world.solver = "quick"
        before = len(self.notes)
        self.call(f"{self.label(world)}.step", world.step, self.random.choice((1, 1, 2)))
        if len(self.notes) > before:
            self.repair(world)

    def repair(self, world):
        """After a step that failed: put all bodies back to where a step works."""
        for body in world.bodies:
            body.parent.detach(body)
            for name in ("position", "rotation", "linear_velocity", "angular_velocity", "force", "torque"):
                setattr(body, name, body.FIELDS[name].default)
        if "unusable" in self.notes[-1]:
            self.failures.append(self.notes[-1])
            self.worlds.remove(world)
            self.furnish()

    def drop(self):
        """Let a World go, keep some of what was in it, and furnish another."""
        self.worlds.pop(self.random.randrange(len(self.worlds)))
        keep = self.random.random()
        self.nodes = [node for node in self.nodes if self.random.random() < keep]
        self.joints = [joint for joint in self.joints if self.random.random() < keep]
        gc.collect()
        self.furnish()

    def label(self, thing):
        for letter, list_ in (("n", self.nodes), ("j", self.joints), ("w", self.worlds)):
            for i, each in enumerate(list_):
                if each is thing:
                    return f"{type(thing).__name__}:{letter}{i}"
        return type(thing).__name__

    def run(self, calls: int) -> None:
        actions = [self.set_field] * 12 + [self.verb] * 8 + [self.values] * 5 + [self.construct] * 3
        actions += [self.join] * 2 + [self.read] * 2 + [self.write_property, self.listen] + [self.step] * 3
        for done in range(calls):
            self.random.choice(actions)()
            if done % 400 == 399:
                self.drop()
            if done % 100 == 99:
                for world in self.worlds:
                    is_consistent(world)


def _place(error):
    trace = error.__traceback__
    while trace.tb_next is not None:
        trace = trace.tb_next
    return f"{trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}"


def _text(value):
    try:
        text = repr(value)
    except Exception:  # noqa: BLE001
        text = f"<{type(value).__name__}>"
    return text if len(text) < 100 else text[:97] + "..."


def main(seed: int, calls: int) -> int:
    """Run one seed and return the exit code."""
    warnings.simplefilter("error")
    fuzz = Fuzz(seed)
    fuzz.run(calls)
    failures, notes, raised, passed = fuzz.failures, fuzz.notes, fuzz.raised, fuzz.passed
    for world in fuzz.worlds:
        is_consistent(world)
    for group in (value for value in OTHERS if isinstance(value, oo.Group)):
        for child in group.children:
            group.detach(child)
    del world, fuzz
    gc.collect()
    left = oo.live_natives()._replace(bytes=0)
    if last_error():  # after an assert in a step, C leaks ODE's threading on purpose
        left = left._replace(blocks=0)
    if any(left):
        failures.append(f"left in ODE: {left}")
    print(f"seed {seed}: {passed} calls passed, {raised} raised; {last_error() or 'no assert'}")  # noqa: T201
    if os.environ.get("OSGODE_FUZZ_NOTES"):
        print("\n".join(note[:300] for note in notes if "ODE refused" in note or "unusable" in note))  # noqa: T201
    print("\n".join(dict.fromkeys(failures)))  # noqa: T201
    return bool(failures)


def run_apart(*arguments):
    """Run this file in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", __file__, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        capture_output=True,
        text=True,
        errors="replace",
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, (
        f"{arguments}: exit code {done.returncode}\n{done.stdout[-5000:]}\n{done.stderr[-5000:]}"
    )
    return done.stdout


@pytest.mark.parametrize("seed", range(SEEDS))
def test_nasty_values_neither_crash_nor_leak(seed):
    """Random calls with nasty values raise OsgodeError or TypeError, and nothing is left in ODE at the end."""
    assert "calls passed" in run_apart(seed, CALLS)


def chaos(seed, steps):  # noqa: C901, PLR0912, PLR0915 - one rig and many small moves on it
    """Listeners that detach, destroy, attach again, add and move in steps; returns how often they were told."""
    dice = random.Random(seed)
    worlds = [oo.World(), oo.World()]
    homes, bodies, counts = [], [], {"told": 0}
    for world in worlds:
        spaces = [world.attach(cls()) for cls in SPACES]
        for one, other in itertools.combinations(spaces, 2):
            world.collide(one, other)
        for space in spaces:
            world.collide(space)
        spaces[0].attach(oo.Plane())
        homes += spaces

    def add():
        if len(bodies) > 60:
            return
        body = oo.Body(position=(dice.uniform(-2, 2), dice.uniform(1, 3), dice.uniform(-2, 2)))
        for _ in range(dice.choice((1, 1, 2))):
            shapes = [oo.Box((0.5, 0.5, 0.5)), oo.Sphere(0.3), oo.Capsule(0.2, 0.4), oo.Trimesh(CUBE), oo.Ray(2)]
            shapes += [oo.ConvexHull(CUBE, solid=solid) for solid in (False, True)]
            shape = dice.choice(shapes)
            body.attach(oo.Placeable(position=(dice.uniform(-0.3, 0.3), 0, 0))).attach(shape)
        dice.choice((body, body.geoms[0])).on_touch(listener)
        dice.choice(homes).attach(body)
        bodies.append(body)

    def detach(body):
        if body.parent is not None:
            body.parent.detach(body)

    def attach(body):
        if body.parent is None:
            body.position, body.linear_velocity = (dice.uniform(-2, 2), 2, 0), (0, 0, 0)
            dice.choice(homes).attach(body)

    def destroy(body):
        detach(body)
        bodies[:] = [other for other in bodies if other is not body]
        for joint in body.joints:
            joint.release()

    def strip(body):
        if len(body.children) > 1:
            body.detach(body.children[-1])

    def join(body):
        if len(body.joints) < 2 and len(bodies) > 1:
            other = dice.choice([other for other in bodies if other is not body])
            joined(dice.choice(list(JOINED)), body, other)

    def listener(touch):
        counts["told"] += 1
        assert touch.state in {"begin", "stay", "end"}
        assert len(touch.points) == len(touch.normals) == len(touch.depths)
        assert np.isfinite(touch.points).all()
        assert (len(touch.points) == 0) == touch.end
        body = dice.choice([b for b in (touch.body, touch.other_body) if b is not None] or bodies or [None])
        if body is None or dice.random() < 0.8:
            return
        dice.choice((detach, destroy, attach, strip, join, lambda b: b.move_to(dice.choice(homes)), lambda _: add()))(
            body
        )

    for _ in range(15):
        add()
    for done in range(steps):
        world = worlds[done % 2]
        try:
            world.step()
        except oo.PhysicsError:  # joined across half a room, and torn at
            for body in list(world.bodies):
                destroy(body)
        for row in world.contacts[["slot1", "slot2"]]:
            for slot in row:
                geom = world.geom_of_slot(int(slot))
                assert geom is None or isinstance(geom, oo.Geom)
        if done % 20 == 0:
            for body in [*bodies]:
                dice.choice((attach, attach, lambda b: b.wake()))(body)
            add()
        if done % 50 == 0:
            for world in worlds:
                is_consistent(world)
                for body in world.bodies:
                    if body.linear_velocity.length > 50 or body.position.length > 50:
                        destroy(body)
    return counts["told"]


def chaos_main(seed: int, steps: int) -> int:
    """Run `chaos` and return the exit code."""
    told = chaos(seed, steps)
    gc.collect()
    left = oo.live_natives()._replace(bytes=0)
    if last_error():
        left = left._replace(blocks=0)
    print(f"chaos {seed}: told {told} times, left {left}; {last_error() or 'no assert'}")  # noqa: T201
    return bool(any(left) or told < steps / 10)


@pytest.mark.parametrize("seed", range(2))
def test_listeners_that_do_anything_neither_crash_nor_leak(seed):
    """Thousands of steps in which what touches may detach, destroy, add, join or move anything."""
    assert "told" in run_apart(seed, 3000, "chaos")


if __name__ == "__main__":
    program = chaos_main if "chaos" in sys.argv else main
    sys.exit(program(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else CALLS))
