"""The settings of a World: its table of fields."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TypedDict

from osgode.fields import (
    FLAG,
    SMALLEST,
    Check,
    Field,
    FlagField,
    NumberField,
    VectorField,
    WholeField,
    choice,
    number,
    vector,
    whole,
)
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.base import PhysicsNode

if TYPE_CHECKING:
    from osgode.joints.base import Joint

DEFAULT_STEP = 1 / 120


def _gravity(world: WorldSettings) -> Vec3:
    out = ffi.new("dVector3")
    lib.dWorldGetGravity(world._id, out)
    return Vec3(out[0], out[1], out[2])


def _set_native(name: str) -> Any:
    return lambda world, value: setattr(world._live(name).ptr, name, value)


def _get_native(name: str) -> Any:
    return lambda world: getattr(world._live(name).ptr, name)


def _world_number(
    name: str, default: float, check: Check[float], *, after: str = "", unit: str = "", doc: str = ""
) -> NumberField:
    get, put = getattr(lib, f"dWorldGet{name}"), getattr(lib, f"dWorldSet{name}")
    return NumberField(
        default, check, lambda w: get(w._id), lambda w, v: put(w._id, v), after=after, unit=unit, doc=doc
    )


class BodyDefault(Field[Any, Any]):
    """What all bodies have that were given no value of their own (`Inherited`)."""

    def __init__(self, default: Any, check: Check[Any], *, unit: str = "", doc: str = "") -> None:
        super().__init__(
            default, check, lambda world: world._live(self.name).inherited[self.name], self._spread, unit=unit, doc=doc
        )

    def _spread(self, world: WorldSettings, value: Any) -> None:
        realm = world._live(self.name)
        realm.inherited[self.name] = value
        for body in realm.bodies:
            body.FIELDS[self.name].enter(body)


class WorldFields(TypedDict, total=False):
    """The keyword arguments of `World`."""

    gravity: Vec3Like
    step_size: float
    erp: float
    cfm: float
    solver: str
    iterations: int
    over_relaxation: float
    contact_surface_layer: float
    contact_max_correcting_velocity: float
    contacts_per_pair: int
    broad_phase: str
    refine_contacts: bool
    seed: int
    auto_disable: bool
    auto_disable_linear_threshold: float
    auto_disable_angular_threshold: float
    auto_disable_steps: int
    auto_disable_time: float
    auto_disable_samples: int
    linear_damping: float
    angular_damping: float
    linear_damping_threshold: float
    angular_damping_threshold: float
    max_angular_speed: float


class WorldSettings(PhysicsNode):
    """What a `World` can be told about its physics."""

    _id: Any

    gravity = VectorField(
        Vec3(0.0, -9.81, 0.0),
        vector(1e6),
        _gravity,
        lambda world, value: lib.dWorldSetGravity(world._id, *value),
        unit="m/s2",
    )
    step_size = NumberField(
        DEFAULT_STEP,
        number(1e-9, 10.0),
        _get_native("step_size"),
        _set_native("step_size"),
        after="_resized_step",
        unit="s",
        doc="Of one step; joints and surfaces with a stiffness follow it.",
    )
    erp = _world_number("ERP", 0.2, number(0, 1), after="_softened", doc="The part of an error corrected in one step.")
    cfm = _world_number("CFM", 1e-10, number(SMALLEST, 1e6), after="_softened", doc="How soft joints and contacts are.")
    solver: Field[str, str] = Field(
        "quick",
        choice("quick", "exact"),
        lambda world: "exact" if world._live("solver").ptr.exact else "quick",
        lambda world, value: setattr(world._live("solver").ptr, "exact", value == "exact"),
        doc="'quick' iterates; 'exact' factorises: precise, slow for many contacts, poor at stacks.",
    )
    iterations = WholeField(
        20,
        whole(1, 10_000),
        lambda world: lib.dWorldGetQuickStepNumIterations(world._id),
        lambda world, value: lib.dWorldSetQuickStepNumIterations(world._id, value),
        doc="Of the quick solver.",
    )
    over_relaxation = _world_number("QuickStepW", 1.3, number(1e-3, 1.999), doc="Of the quick solver.")
    contact_surface_layer = _world_number(
        "ContactSurfaceLayer", 0.0, number(0, 1e3), unit="m", doc="How deep resting things may sink in."
    )
    contact_max_correcting_velocity: Field[float, float] = Field(
        math.inf,
        number(0.0, math.inf, infinite=True),
        lambda world: lib.dWorldGetContactMaxCorrectingVel(world._id),
        lambda world, value: lib.dWorldSetContactMaxCorrectingVel(world._id, value),
        unit="m/s",
        doc="How fast overlapping things are pushed apart at most.",
    )
    contacts_per_pair = WholeField(
        16,
        whole(1, 1000),
        _get_native("max_contacts"),
        _set_native("max_contacts"),
        doc="Contact points of two geoms at most.",
    )
    broad_phase: Field[str, str] = Field(
        "own",
        choice("own", "ode"),
        lambda world: "ode" if world._live("broad_phase").ptr.ode_broad else "own",
        lambda world, value: setattr(world._live("broad_phase").ptr, "ode_broad", value == "ode"),
        doc="What finds the pairs that may touch: 'own' leaves out those in which nothing can move; 'ode' walks ODE's "
        "spaces, bit for bit as a C program does.",
    )
    refine_contacts = FlagField(
        True,
        FLAG,
        lambda world: bool(world._live("refine_contacts").ptr.refines),
        lambda world, value: setattr(world._live("refine_contacts").ptr, "refines", int(value)),
        doc="Whether what lies flat gets as many contacts as it needs, and nothing trips over the seams of a mesh; "
        "without effect where `broad_phase` is 'ode'.",
    )
    seed = WholeField(
        0, whole(0, 0xFFFFFFFF), _get_native("seed"), _set_native("seed"), doc="Of the quick solver's order of rows."
    )
    auto_disable = BodyDefault(False, FLAG, doc="Whether bodies at rest fall asleep.")
    auto_disable_linear_threshold = BodyDefault(0.01, number(0, 1e6), unit="m/s", doc="Slower is at rest.")
    auto_disable_angular_threshold = BodyDefault(0.01, number(0, 1e6), unit="rad/s", doc="Slower is at rest.")
    auto_disable_steps = BodyDefault(10, whole(0, 1_000_000), doc="Steps that a body rests before it sleeps.")
    auto_disable_time = BodyDefault(0.0, number(0, 1e6), unit="s", doc="Time that a body rests before it sleeps.")
    auto_disable_samples = BodyDefault(1, whole(1, 10_000), doc="Steps over which speeds are averaged.")
    linear_damping = BodyDefault(0.0, number(0, 1), doc="Part of the velocity lost in each step.")
    angular_damping = BodyDefault(0.0, number(0, 1), doc="Part of the angular velocity lost in each step.")
    linear_damping_threshold = BodyDefault(0.01, number(0, 1e6), unit="m/s", doc="No damping below this speed.")
    angular_damping_threshold = BodyDefault(0.01, number(0, 1e6), unit="rad/s", doc="No damping below this speed.")
    max_angular_speed = BodyDefault(
        math.inf, number(0, math.inf, infinite=True), unit="rad/s", doc="Faster turning is cut off."
    )

    @property
    @abstractmethod
    def joints(self) -> Iterable[Joint]:
        """All joints that are in effect."""

    def _softened(self) -> None:
        """ODE gives its ERP and CFM to a joint when it is made; here joints follow, and springs the step size too."""
        for joint in self.joints:
            joint._follow()

    @abstractmethod
    def _resized_step(self) -> None:
        """Called when the step size has changed: ERP and CFM of springs depend on it."""
