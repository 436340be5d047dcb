"""What the tests draw: numbers, poses, masses, and for every field of every class values that it takes and refuses."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from hypothesis import strategies as st

import osgode as oo

oo.define_kind("tested")

CUBE = (
    [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)],
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)),
        *((0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)),
        *((0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ],
)
"""A closed cube of edge 1 about the origin, counter-clockwise seen from outside."""


HEIGHTS = oo.HeightData([[0, 1, 0], [0.5, 0, 1]])


def floats(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers from ``low`` to ``high``; next to 0 they are 0, since rounding is compared with 1e-9."""
    drawn = st.floats(low, high, allow_nan=False, allow_infinity=False, allow_subnormal=False)
    return drawn.map(lambda value: value if abs(value) > 1e-6 or low > 0 else 0.0)


def vectors(size: float = 10.0) -> st.SearchStrategy[oo.Vec3]:
    """Vectors with round and odd numbers in them."""
    part = st.one_of(st.integers(-int(size), int(size)).map(float), floats(-size, size))
    return st.builds(oo.Vec3, part, part, part)


def directions() -> st.SearchStrategy[oo.Vec3]:
    return vectors(3).filter(lambda v: v.length > 1e-3)


def rotations() -> st.SearchStrategy[oo.Quat]:
    turns = st.builds(oo.Quat.from_axis_angle, directions(), floats(-math.pi, math.pi))
    return st.one_of(st.just(oo.Quat(1.0, 0.0, 0.0, 0.0)), turns)


def poses(size: float = 10.0) -> st.SearchStrategy[oo.Pose]:
    return st.builds(oo.Pose, vectors(size), rotations())


def sizes(low: float = 0.1, high: float = 2.0) -> st.SearchStrategy[float]:
    return floats(low, high)


@st.composite
def geoms(draw: st.DrawFn) -> oo.Geom:
    """A solid with mass, of any shape that a body may have."""
    weight = draw(st.sampled_from([{}, {"density": 50.0}, {"mass": 0.5}, {"mass": 3.0}, {"material": "wood"}]))
    shape = draw(st.sampled_from(["box", "sphere", "capsule", "cylinder", "mesh", "hull", "solid hull"]))
    if shape == "box":
        return oo.Box((draw(sizes()), draw(sizes()), draw(sizes())), **weight)
    if shape == "sphere":
        return oo.Sphere(draw(sizes()), **weight)
    if shape == "mesh":
        return oo.Trimesh(CUBE, **weight)
    if "hull" in shape:
        return oo.ConvexHull(CUBE, solid=shape == "solid hull", **weight)
    return {"capsule": oo.Capsule, "cylinder": oo.Cylinder}[shape](draw(sizes()), draw(sizes()), **weight)


# -- one stand for each class that has fields


class Stand:
    """A node outside of any World, and the way for it in and out again."""

    def __init__(self, cls: type) -> None:
        self.world = oo.World()
        self.space = self.world.attach(oo.HashSpace())
        self.other = oo.Body(position=(1, 2, 3))
        self.home = self.space.attach(oo.Body(name="home")).attach(oo.Placeable())
        self.node: Any = MAKERS[cls](self)

    def enter(self) -> None:
        if isinstance(self.node, oo.Servo):
            oo.Hinge(self.space.attach(self.other)).servo = self.node
            return
        if isinstance(self.node, oo.Joint):
            self.space.attach(self.node.body1)
            self.space.attach(self.other)
        elif isinstance(self.node, oo.CentreOfMass):
            self.home.parent.attach(self.node)
        elif isinstance(self.node, oo.Heightfield):  # static: it has no volume
            self.space.attach(oo.Placeable()).attach(self.node)
        elif isinstance(self.node, oo.Geom) and not isinstance(self.node, oo.Plane):
            self.home.attach(self.node)
        else:
            self.space.attach(self.node)
        assert self.node.is_live

    def leave(self) -> None:
        if isinstance(self.node, oo.Servo):
            joint = self.node.joint
            joint.servo = None
            joint.release()
            self.space.detach(self.other)
            return
        if isinstance(self.node, oo.Joint):
            self.space.detach(self.other)
            self.space.detach(self.node.body1)
        else:
            self.node.parent.detach(self.node)
        assert not self.node.is_live


def _join(cls: Any, stand: Stand) -> Any:
    where: dict[str, Any] = {"anchor2": (1, 2, 0)} if cls is oo.DoubleHinge else {}
    return cls(oo.Body(), stand.other, name="it", **where)


MAKERS: dict[type, Callable[[Stand], Any]] = {
    oo.World: lambda _: oo.World(name="it"),
    oo.SimpleSpace: lambda _: oo.SimpleSpace(name="it"),
    oo.HashSpace: lambda _: oo.HashSpace(name="it"),
    oo.QuadTreeSpace: lambda _: oo.QuadTreeSpace(name="it"),
    oo.SweepAndPruneSpace: lambda _: oo.SweepAndPruneSpace(name="it"),
    oo.Body: lambda _: oo.Body(name="it"),
    oo.CentreOfMass: lambda _: oo.CentreOfMass(name="it"),
    oo.Placeable: lambda _: oo.Placeable(name="it"),
    oo.Box: lambda _: oo.Box(name="it"),
    oo.Sphere: lambda _: oo.Sphere(name="it"),
    oo.Capsule: lambda _: oo.Capsule(name="it"),
    oo.Cylinder: lambda _: oo.Cylinder(name="it"),
    oo.Plane: lambda _: oo.Plane(name="it"),
    oo.Trimesh: lambda _: oo.Trimesh(oo.MeshData(*CUBE), name="it"),
    oo.ConvexHull: lambda _: oo.ConvexHull(oo.MeshData(*CUBE), name="it"),
    oo.Heightfield: lambda _: oo.Heightfield([[0, 1, 0], [0.5, 0, 1]], name="it"),
    oo.Ray: lambda _: oo.Ray(name="it"),
    **{cls: partial(_join, cls) for cls in (oo.Ball, oo.Hinge, oo.Slider, oo.Fixed, oo.Universal, oo.Hinge2)},
    **{cls: partial(_join, cls) for cls in (oo.AngularMotor, oo.LinearMotor, oo.PR, oo.PU, oo.Piston)},
    **{cls: partial(_join, cls) for cls in (oo.DoubleBall, oo.DoubleHinge)},
    oo.Plane2D: lambda _: oo.Plane2D(oo.Body(), name="it"),
    oo.Transmission: lambda stand: oo.Transmission(
        oo.Body(), stand.other, anchor1=(0, 0, 0), anchor2=(2, 0, 0), name="it"
    ),
    oo.Servo: lambda _: oo.Servo(),
}
"""How a node of each class is made that has fields."""


def join(kind: str, one: Any, two: Any) -> Any:
    """A joint of any kind and mode between bodies anywhere; ``two`` may be None where the kind takes one."""
    cls, where, moded = JOINED[kind]
    if cls is oo.Plane2D:
        return cls(one)
    places = {name: one.position + offset for name, offset in where.items()}
    return cls(one, two, **places, **moded)


_X, _Z = oo.Vec3(1, 0, 0), oo.Vec3(0, 0, 1)
_SIDE = {"anchor1": oo.Vec3(0, 0, 0), "anchor2": _X}
JOINED: dict[str, tuple[Any, dict[str, oo.Vec3], dict[str, Any]]] = {
    **{cls.__name__: (cls, {}, {}) for cls in (oo.Ball, oo.Hinge, oo.Slider, oo.Fixed, oo.Universal, oo.Hinge2)},
    **{cls.__name__: (cls, {}, {}) for cls in (oo.AngularMotor, oo.LinearMotor, oo.PR, oo.PU, oo.Piston, oo.Plane2D)},
    "euler": (oo.AngularMotor, {}, {"mode": "euler", "axes": (_X, _Z)}),
    "DoubleBall": (oo.DoubleBall, _SIDE, {}),
    "DoubleHinge": (oo.DoubleHinge, _SIDE, {}),
    "parallel": (oo.Transmission, _SIDE, {}),
    "chain": (oo.Transmission, _SIDE, {"mode": "chain", "radius1": 0.3, "radius2": 0.2}),
    "intersecting": (
        oo.Transmission,
        {"anchor1": oo.Vec3(0, 0, 0), "anchor2": oo.Vec3(0.8, 0, 0.4)},
        {"mode": "intersecting", "axis1": _Z, "axis2": _X},
    ),
}
"""For each kind and mode of joint: its class, where its anchors are from its first body, and other arguments."""
NEEDS_TWO = {kind for kind, (cls, _, _) in JOINED.items() if cls.BODIES == (2,)}


# -- values of fields


@dataclass(frozen=True)
class Case:
    """One field of one class."""

    cls: type
    name: str

    @property
    def field(self) -> Any:
        return self.cls.FIELDS[self.name]

    def __str__(self) -> str:
        return f"{self.cls.__name__}.{self.name}"


OF_ANOTHER_MODE = {Case(oo.Transmission, "radius1"), Case(oo.Transmission, "radius2"), Case(oo.Ray, "density")}
"""Only a chain has radii; see `tests.joints.held`. The density of a ray can be None only."""

CASES = [case for cls in MAKERS for name in cls.FIELDS if (case := Case(cls, name)) not in OF_ANOTHER_MODE]

_HALF_TURN = oo.Quat.from_axis_angle((1, 2, 3), 2.0)

_POOL: list[Any] = [
    False,
    True,
    0.125,
    0.7,
    1.75,
    3,
    42.5,
    oo.Vec3(0.25, -0.5, 0.75),
    oo.Vec3(0.5, 1.25, 2.0),
    oo.Vec3(0.0, 0.0, -1.0),
    oo.Vec3(1.0, 2.0, 3.0).normalized(),
    _HALF_TURN,
    _HALF_TURN.conjugate(),
    (-1, 4),
    (-0.5, 1.25),
    "exact",
    "ode",
    "own",
    "ray",
    "sweep",
    "zyx",
    "wood",
    "tested",
    frozenset({"tested"}),
    frozenset(),
    oo.Mass(2.5, oo.Vec3(0.1, 0.2, 0.3), ((1, 0.1, 0), (0.1, 2, 0), (0, 0, 2.5))),
    oo.Mass.sphere(0.25, mass=4),
    oo.Surface(0.25, bounce=0.5),
    oo.Appearance((0.25, 0.5, 0.75, 1.0)),
    (oo.Drawable(oo.Mesh(np.array(CUBE[0], np.float32), np.array(CUBE[1], np.uint32))),),
    oo.MeshData([(x * 2, y, z) for x, y, z in CUBE[0]], CUBE[1]),
    oo.HeightData([[0, 0.25, 0.5], [0, 0.25, 0.5]]),
    (4.0, 6.5),
    "all",
]


def accepted(case: Case) -> list[Any]:
    """What the field takes of a pool of very different things, as it is kept; no default among them."""
    if case.name == "servo":  # each drives one joint
        return [oo.Servo(target=0.5, max_force=20.0), oo.Servo(frequency=3.0)]
    found = []
    if case.cls is oo.Ray and case.name == "mass":
        return [0.0]
    for value in _POOL:
        try:
            kept = case.field.check.convert(value)
        except (TypeError, ValueError, OverflowError, KeyError):
            continue
        if kept != case.field.default and kept is not None:
            found.append(kept)
    return found


NAN = math.nan
INF = math.inf

WRONG_KIND: list[Any] = [
    NAN,
    complex(1, 2),
    object(),
    "no such thing",
    b"abc",
    [NAN, 0.0, 0.0],
    (0.0, INF, 0.0),
    ("a", "b", "c"),
    (1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
    {"x": 1},
    10**400,
    10**5000,
    -(10**400),
    [None, None, None],
    np.array([[1.0, 2.0], [3.0, 4.0]]),
    float,
]
"""What no field at all takes."""

OUTSIDE: dict[str, list[Any]] = {
    # World
    "gravity": [(0, 1e7, 0), (0, -1e300, 0), (1, 2), 9.81],
    "step_size": [0.0, -0.01, 1e-320, 1e-10, 10.5, INF],
    "erp": [-0.1, 1.1, INF, -INF],
    "cfm": [0.0, -1e-9, 1e-320, 1e-13, INF],
    "solver": ["Quick", "", 1],
    "broad_phase": ["Own", "hash", 0],
    "refine_contacts": [0, 1, "yes", 0.5],
    "iterations": [0, -1, 10_001, 2_000_000_000, 2.5, INF],
    "over_relaxation": [0.0, -1.0, 2.0, 50.0, INF],
    "contact_surface_layer": [-1e-9, 2e3, INF],
    "contact_max_correcting_velocity": [-1.0, -INF],
    "contacts_per_pair": [0, -1, 1001, 65536, 1.5],
    "seed": [-1, 1 << 32, 0.5],
    "auto_disable_linear_threshold": [-1e-9, 1e7, INF],
    "auto_disable_angular_threshold": [-1e-9, 1e7, INF],
    "auto_disable_steps": [-1, 1_000_001, 0.5],
    "auto_disable_time": [-1e-9, 1e7, INF],
    "auto_disable_samples": [0, -1, 10_001, (1 << 32) - 1],
    "linear_damping": [-1e-9, 1.0000001, INF],
    "angular_damping": [-1e-9, 1.0000001, INF],
    "linear_damping_threshold": [-1e-9, 1e7, INF],
    "angular_damping_threshold": [-1e-9, 1e7, INF],
    "max_angular_speed": [-1e-9, -INF],
    # spaces
    "levels": [(3, 1), (-40, 3), (0, 40), (-4, 10), (1,), (1, 2, 3), (0.5, 2), 7],
    "centre": [(1e9, 0, 0), (0, 0)],
    "extent": [(0, 1, 1), (-1, 1, 1), (1, 1e8, 1), (INF, 1, 1), 5.0],
    "depth": [-1, 9, 16, 1.5],
    "axes": ["xyy", "xxx", "yz", "", ("x", "y", "z")],
    # bodies and places
    "position": [(2e8, 0, 0), (0, 0, -1e300), (1, 2), (1, 2, 3, 4), 5.0],
    "rotation": [(0, 0, 0, 0), (1e-170, 0, 0, 0), (1e200, 0, 0, 0), (NAN, 0, 0, 1), (1, 0, 0), 1.0],
    "linear_velocity": [(2e9, 0, 0), (0, 0, -1e300), (1, 2)],
    "angular_velocity": [(2e9, 0, 0), (0, 0, 1e160), (1, 2)],
    "force": [(1e16, 0, 0), (0, 0, -1e300), (1, 2)],
    "torque": [(1e16, 0, 0), (0, 0, -1e300), (1, 2)],
    "fixed_mass": [5.0, (1, 2, 3)],
    "finite_rotation_axis": [(1e-300, 0, 0), (0, 0), 1.0],
    # geoms
    "kind": ["", 5],
    "material": ["", 5],
    "collides_with": [["nobody"], 5],
    "sensor": [0, 1, "yes", 0.5],
    "surface_velocity": [(0, 1e7, 0), (0, 0, 1e300), (1, 2), 1.0],
    "mass": [-1e-9, -5.0, 1e16, INF],
    "density": [0.0, -1.0, 1e10, INF],
    "size": [(0, 1, 1), (1, -1, 1), (1, 1, 1e8), (1, 1), (1, 1, INF), 3.0],
    "radius": [0.0, -0.5, 1e-320, 1e8, INF],
    "length": [0.0, -0.5, 1e-320, 1e8, INF],
    "normal": [(0, 0, 0), (1e-320, 0, 0), (0, 1)],
    "offset": [1e9, INF, -INF],
    "surface": [0.5, "wood"],
    "appearance": [(1, 0, 0), "red"],
    "shown": [5, [5], "mesh"],
    "data": [([], []), CUBE],
    # joints
    "stops": [(1.0, 0.0), (0.0,), (0.0, 1.0, 2.0), (-INF, INF), (0.0, 1e9), (-1e9, 0.0), 1.0],
    "stop_bounce": [-0.1, 1.1, INF],
    "stop_erp": [-0.1, 1.1, INF],
    "stop_cfm": [0.0, -1e-9, INF],
    "fudge_factor": [-0.1, 1.1],
    "motor_velocity": [INF, -INF, 1e10],
    "motor_max_force": [-1.0, -INF],
    "reports": ["nearest", "", 1],
    "thickness": [-1e-9, 1e7, INF],
    "feedback": [0, 1, "yes", 0.5],
    "break_force": [-1.0, 1e16, INF],
    "break_torque": [-1.0, 1e16, INF],
    **{f"{of}stiffness": [-1.0, 1e16, INF] for of in ("", "stop_", "suspension_")},
    **{f"{of}damping": [-1.0, 1e16, INF] for of in ("", "stop_", "suspension_")},
    "suspension_erp": [-0.1, 1.1, INF],
    "suspension_cfm": [0.0, -1e-9, INF],
    "servo": [5, 0.5, oo.Servo, "Servo"],
    "user_angle": [1e7, INF, -INF],
    "distance": [-0.1, 2e8, INF],
    "ratio": [0.0, -1.0, 1e4, INF],
    "backlash": [-0.1, 1e7, INF],
    # servos
    "target": [2e8, INF, -INF],
    "max_speed": [-0.1, 2e9, INF],
    "max_force": [-0.1, 2e9, INF],
    "frequency": [0.0, -1.0, 1e7, INF],
    "damping_ratio": [-0.1, 1e7, INF],
    # flags
    "auto_disable": [0, 1, "yes", 0.5],
    "enabled": [0, 1, "yes", 0.5],
    "kinematic": [0, 1, "yes"],
    "tunnelling": ["fast", "", True],
    "auto_recentre": [0, 1, "yes"],
    "solid": [0, 1, "yes"],
    "backface_cull": [0, 1, "yes"],
    "gyroscopic": [0, 1, "yes"],
}
"""What a field of this name refuses beside that: the ranges that ODE computes safely in."""

OF_CLASS: dict[tuple[type, str], list[Any]] = {
    (oo.Body, "gravity"): [0, 1, "yes", (0, 1, 0)],
    (oo.Heightfield, "size"): [(0, 1), (1, -1), (1, 1e8), (1, INF), (1,), (1, 1, 1), 3.0],
    (oo.Heightfield, "data"): [oo.MeshData(*CUBE), [[0, 1], [1, 0]]],
    (oo.ConvexHull, "data"): [
        CUBE,
        oo.MeshData(CUBE[0], CUBE[1][1:]),
        oo.MeshData(CUBE[0], [t[::-1] for t in CUBE[1]]),
    ],
    (oo.Ray, "length"): [0.0, -0.5, 1e-320, 1.1e6, INF],
    (oo.Ray, "mass"): [1.0, -1.0],
}
"""The same where a class takes other values than the others do under that name."""


def refused(case: Case) -> list[Any]:
    """What the field must not take."""
    own = OF_CLASS.get((case.cls, case.name)) or OUTSIDE[case.name.rstrip("123")]
    optional = case.field.default is None or case.name == "data"
    return [*WRONG_KIND, *own, *([] if optional else [None])]


def same(one: Any, other: Any, tolerance: float = 0.0) -> bool:
    """Equal, numbers within ``tolerance``."""
    if isinstance(one, tuple) and isinstance(other, tuple) and one and isinstance(one[0], float):
        return len(one) == len(other) and all(same(a, b, tolerance) for a, b in zip(one, other, strict=True))
    if isinstance(one, float) and isinstance(other, float) and tolerance:
        return one == other or abs(one - other) <= tolerance * max(1.0, abs(one))
    return type(one) is type(other) and bool(one == other)


ROUNDED = {"rotation": 1e-15, "normal": 1e-15, "offset": 1e-15, "finite_rotation_axis": 1e-15}
"""Fields that ODE normalises, so that the last bit may change."""
