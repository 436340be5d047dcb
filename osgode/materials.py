"""Names of materials and of kinds of objects, and the table that says how two materials meet.

A geom has 32 category bits: the upper 16 name its material, the lower 16 the kind of object it belongs
to. User code uses names; the bits are given out here, for the whole process.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from osgode.errors import FieldError, shown
from osgode.fields import DIRECTION, Check, choice, number
from osgode.maths import Vec3Like
from osgode.native import ffi, lib
from osgode.springs import implicit

LIMIT = 16
ALL_BITS = 0xFFFFFFFF


@dataclass(frozen=True)
class Material:
    """What a geom is made of, by name.

    Args:
        index: 0 to 15; bit 16 + index of the category bits.
        density: kg/m3, for geoms that are given neither mass nor density.
        source: where the density comes from.
    """

    name: str
    index: int
    density: float
    source: str = ""


_materials: dict[str, Material] = {}
_kinds: dict[str, int] = {}


def define_material(name: str, density: float = 1000.0, source: str = "") -> Material:
    """Make a new material known; defining the same one again with the same density changes nothing.

    Args:
        name: as it is used in ``Box(..., material=name)``.
        density: kg/m3.
        source: where the density comes from.

    Raises:
        FieldError: if it exists with another density, or 16 exist already.
    """
    _check_name("material", name)
    density = number(1e-3, 1e6)(f"material {name!r}", "density", density)
    known = _materials.get(name)
    if known is not None and known.density == density:
        return known
    if known is not None:
        raise FieldError(f"material {name!r} exists already with {known.density:g} kg/m3; use another name")
    if len(_materials) >= LIMIT:
        raise FieldError(f"material {name!r} can't be defined: there may be {LIMIT}: {_names(_materials)}")
    _materials[name] = Material(name, len(_materials), density, source)
    return _materials[name]


def define_kind(name: str) -> None:
    """Make a new kind of object known ("player", "shot" ...), to say what collides with what.

    Raises:
        FieldError: if 16 exist already.
    """
    _check_name("kind", name)
    if name in _kinds:
        return
    if len(_kinds) >= LIMIT:
        raise FieldError(f"kind {name!r} can't be defined: there may be {LIMIT}: {_names(_kinds)}")
    _kinds[name] = len(_kinds)


def _check_name(what: str, name: object) -> None:
    if not isinstance(name, str) or not name:
        raise FieldError(f"the name of a {what} is {shown(name)}; it must be a str that is not empty")


def material(name: str) -> Material:
    """The material of that name.

    Raises:
        FieldError: if there is none.
    """
    try:
        return _materials[name]
    except (KeyError, TypeError, ValueError):
        raise FieldError(
            f"material is {shown(name)}; it must be one of {_names(_materials)}, "
            "or be made known with define_material()"
        ) from None


def category_bits(material_name: str, kind: str) -> int:
    """The 32 bits that say what a geom is."""
    return 1 << (LIMIT + _materials[material_name].index) | 1 << _kinds[kind]


def collide_bits(kinds: frozenset[str] | None) -> int:
    """The 32 bits that say what a geom meets: the named kinds, or everything for None."""
    return ALL_BITS if kinds is None else sum(1 << _kinds[kind] for kind in kinds)


def _names(table: Iterable[str]) -> str:
    return ", ".join(map(repr, table))


class _NameCheck(Check[Any]):
    """A check whose words list the names that exist when it fails."""

    def __init__(self, convert: Callable[[Any], Any], expects: Callable[[], str]) -> None:
        vars(self).update(convert=convert, _expects=expects)

    def __getattr__(self, name: str) -> Any:
        if name == "expects":  # never set: told anew each time
            return self._expects()
        raise AttributeError(name)


def _known_kinds(value: object) -> frozenset[str] | None:
    if value is None:
        return None
    kinds = frozenset([value]) if isinstance(value, str) else frozenset(value)  # type: ignore[call-overload]
    for kind in kinds:
        _kinds[kind]
    return kinds


MATERIAL: Check[str] = _NameCheck(
    lambda value: _materials[value].name,
    lambda: f"one of {_names(_materials)}, or be made known with define_material()",
)
KIND: Check[str] = _NameCheck(
    lambda value: value if _kinds[value] >= 0 else "",
    lambda: f"one of {_names(_kinds)}, or be made known with define_kind()",
)
KINDS: Check[frozenset[str] | None] = _NameCheck(
    _known_kinds, lambda: f"None (everything) or some of {_names(_kinds)}, or be made known with define_kind()"
)


@dataclass(frozen=True, slots=True)
class Surface:
    """What happens where two geoms touch.

    Args:
        friction: Coulomb's coefficient (or the force limit in N, see ``model``); may be infinite.
        bounce: part of the approach speed that comes back, 0 to 1.
        bounce_velocity: m/s below which nothing bounces, so that things come to rest.
        slip: speed of sliding per force, m/(s N): wet surfaces, tyres.
        direction: in the axes of the geom whose own surface it is: ``friction`` and ``slip`` act along it. A tyre's is
            its axle: what acts along it holds the lane. None: the same all round.
        friction_across, slip_across: the same across the direction; as along it where None.
        soft_erp, soft_cfm: softness of the contact, the World's where None.
        stiffness, damping: the same as a spring in N/m with a damper in N s/m at each contact point, instead of
            soft_erp and soft_cfm; the World's step size is taken into account.
        rolling_friction: metres: the arm of the torque that brakes rolling (per newton of load).
        model: "pyramid" (friction grows with the load, along ODE's two tangents) or "force limit".
        source: where the figures come from.

    Raises:
        FieldError: for a value out of range.
    """

    friction: float = 0.5
    bounce: float = 0.0
    bounce_velocity: float = 0.1
    slip: float = 0.0
    direction: Vec3Like | None = None
    friction_across: float | None = None
    slip_across: float | None = None
    soft_erp: float | None = None
    soft_cfm: float | None = None
    stiffness: float | None = None
    damping: float | None = None
    rolling_friction: float = 0.0
    model: str = "pyramid"
    source: str = ""

    def __post_init__(self) -> None:
        self._within("friction", 0.0, math.inf)
        self._within("bounce", 0.0, 1.0)
        self._within("bounce_velocity", 0.0, 1e6)
        self._within("slip", 0.0, 1e6)
        self._check_direction()
        self._within("rolling_friction", 0.0, 1e6)
        if self.soft_erp is not None:
            self._within("soft_erp", 0.0, 1.0)
        if self.soft_cfm is not None:
            self._within("soft_cfm", 1e-12, 1e6)
        self._check_spring()
        choice("pyramid", "force limit")("Surface", "model", self.model)

    def _check_spring(self) -> None:
        for name in ("stiffness", "damping"):
            if getattr(self, name) is not None:
                self._within(name, 0.0, 1e15)
        if self.spring is not None and not (self.soft_erp is self.soft_cfm is None):
            raise FieldError("Surface: give either stiffness and damping, or soft_erp and soft_cfm")
        if self.spring == (0.0, 0.0):
            raise FieldError("Surface: stiffness and damping are both 0; one of them must be above 0")

    def _check_direction(self) -> None:
        if self.direction is not None:
            object.__setattr__(self, "direction", DIRECTION("Surface", "direction", self.direction))
        for name, high in (("friction_across", math.inf), ("slip_across", 1e6)):
            if getattr(self, name) is not None:
                self._within(name, 0.0, high)
                if self.direction is None:
                    raise FieldError(f"Surface: {name} needs a direction that it acts across")

    def _within(self, name: str, low: float, high: float) -> None:
        value = number(low, high, infinite=True)("Surface", name, getattr(self, name))
        object.__setattr__(self, name, value)

    @property
    def spring(self) -> tuple[float, float] | None:
        """Stiffness and damping, None if it has neither."""
        given = self.stiffness is not None or self.damping is not None
        return (self.stiffness or 0.0, self.damping or 0.0) if given else None

    def row(self, step_size: float) -> Any:
        """The surface as ODE reads it, for a World of that step size."""
        mode = lib.dContactApprox1 if self.model == "pyramid" else lib.dContactApprox0
        row = ffi.new("dSurfaceParameters *")
        row.mu = self.friction
        if self.bounce > 0.0:
            mode |= lib.dContactBounce
            row.bounce, row.bounce_vel = self.bounce, self.bounce_velocity
        if self.friction_across is not None:
            mode |= lib.dContactMu2
            row.mu2 = self.friction_across
        across = self.slip if self.slip_across is None else self.slip_across
        if self.slip > 0.0 or across > 0.0:
            mode |= lib.dContactSlip1 | lib.dContactSlip2
            row.slip1, row.slip2 = self.slip, across
        erp, cfm = (self.soft_erp, self.soft_cfm) if self.spring is None else implicit(*self.spring, step_size)
        if erp is not None:
            mode |= lib.dContactSoftERP
            row.soft_erp = erp
        if cfm is not None:
            mode |= lib.dContactSoftCFM
            row.soft_cfm = cfm
        if self.rolling_friction > 0.0:
            mode |= lib.dContactRolling
            row.rho = row.rho2 = row.rhoN = self.rolling_friction
        row.mode = mode
        return row


class SurfaceTable:
    """How each pair of materials meets: ``table["wood", "steel"] = Surface(friction=0.4)``.

    A pair that isn't in the table has the ``fallback``.
    """

    def __init__(self, rows: dict[tuple[str, str], Surface] | None = None, fallback: Surface | None = None) -> None:
        self._rows: dict[tuple[str, str], Surface] = {}
        self._fallback = Surface() if fallback is None else _undirected(_surface(fallback))
        self._changed: weakref.WeakMethod[Callable[[], None]] | None = None
        for pair, surface in (rows or {}).items():
            self[pair] = surface

    @property
    def fallback(self) -> Surface:
        """What pairs have that are not in the table."""
        return self._fallback

    @fallback.setter
    def fallback(self, surface: Surface) -> None:
        old, self._fallback = self._fallback, _undirected(_surface(surface))
        try:
            self._notify()
        except BaseException:
            self._fallback = old
            raise

    def __getitem__(self, pair: tuple[str, str]) -> Surface:
        return self._rows.get(self._key(pair), self._fallback)

    def __setitem__(self, pair: tuple[str, str], surface: Surface) -> None:
        rows = self._rows
        _undirected(_surface(surface))
        self._rows = {**rows, self._key(pair): _surface(surface)}
        try:
            self._notify()
        except BaseException:
            self._rows = rows
            raise

    def __contains__(self, pair: tuple[str, str]) -> bool:
        return self._key(pair) in self._rows

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def copy(self) -> SurfaceTable:
        """A table with the same rows, to be changed on its own."""
        return SurfaceTable(dict(self._rows), self._fallback)

    def matrix(self) -> list[list[Surface]]:
        """16 rows of 16 surfaces, by the indices of the materials."""
        result = [[self._fallback] * LIMIT for _ in range(LIMIT)]
        for (a, b), surface in self._rows.items():
            i, j = material(a).index, material(b).index
            result[i][j] = result[j][i] = surface
        return result

    def _notify(self) -> None:
        changed = None if self._changed is None else self._changed()
        if changed is not None:
            changed()

    @staticmethod
    def _key(pair: tuple[str, str]) -> tuple[str, str]:
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise FieldError(f"a surface is looked up by the names of two materials, not by {shown(pair)}")
        a, b = sorted(material(name).name for name in pair)
        return a, b


def _surface(value: object) -> Surface:
    if not isinstance(value, Surface):
        raise FieldError(f"surface is {shown(value)}; it must be a Surface")
    return value


def _undirected(surface: Surface) -> Surface:
    if surface.direction is not None:
        raise FieldError("a Surface with a direction must be a geom's own: a pair of materials has no axes")
    return surface


define_kind("default")

_OPENSTAX = "OpenStax, University Physics 1 (2016), table 14.1"
_TOOLBOX = "The Engineering ToolBox, densities of materials"
for _name, _density, _source in (
    ("default", 1000.0, "water"),
    ("wood", 710.0, _OPENSTAX + " (oak)"),
    ("steel", 7860.0, _OPENSTAX + " (iron)"),
    ("aluminium", 2700.0, _OPENSTAX),
    ("concrete", 2300.0, _OPENSTAX),
    ("glass", 2600.0, _OPENSTAX),
    ("ice", 917.0, _OPENSTAX),
    ("brick", 1920.0, _TOOLBOX + " (common red brick)"),
    ("rubber", 1100.0, _TOOLBOX + " (tyre rubber)"),
    ("earth", 1520.0, _TOOLBOX + " (packed)"),
):
    define_material(_name, _density, _source)

_FRICTION = "OpenStax, University Physics 1 (2016), table 6.1, static"
_SERWAY = "Serway and Jewett, Physics for Scientists and Engineers, table of coefficients of friction, static"

PUBLISHED = SurfaceTable(
    {
        ("rubber", "concrete"): Surface(1.0, source=_FRICTION),
        ("wood", "wood"): Surface(0.5, source=_FRICTION),
        ("wood", "steel"): Surface(0.5, source=_FRICTION + " (metal on wood)"),
        ("wood", "aluminium"): Surface(0.5, source=_FRICTION + " (metal on wood)"),
        ("steel", "steel"): Surface(0.6, source=_FRICTION + " (dry)"),
        ("steel", "ice"): Surface(0.04, source=_FRICTION),
        ("ice", "ice"): Surface(0.1, source=_FRICTION),
        ("rubber", "ice"): Surface(0.1, source=_FRICTION + " (shoes on ice)"),
        ("rubber", "wood"): Surface(0.9, source=_FRICTION + " (shoes on wood)"),
        ("aluminium", "steel"): Surface(0.61, source=_SERWAY),
        ("glass", "glass"): Surface(0.94, source=_SERWAY),
        ("wood", "concrete"): Surface(
            0.62, source="The Engineering ToolBox, friction: a wooden crate on a concrete floor"
        ),
    }
)
"""What a new World starts with. ODE has one coefficient for sticking and sliding; these are the static
ones, so that what stands on a slope in life stands there here. Figures of bounce depend on shape and speed
more than on the material, so all are 0 until you set them. Pairs that aren't listed have friction 0.5."""
