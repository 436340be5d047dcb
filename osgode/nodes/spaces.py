"""Spaces: groups of geoms, each kind with its own way of finding which boxes overlap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from osgode.errors import TreeError
from osgode.fields import POSITION_LIMIT, Check, Field, VectorField, WholeField, choice, three, vector, whole
from osgode.graph.node import Group
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.base import PhysicsNode, refuse
from osgode.nodes.queries import Queries
from osgode.nodes.touch import Listening

if TYPE_CHECKING:
    from osgode.nodes.realm import Realm

MAX_DEPTH = 100
"""Spaces within spaces: ODE walks them by recursion."""
MAX_GEOMS = 131_072
"""In one space: above, ODE's hash space aborts."""


class Space(Listening, Queries, Group):
    """Abstract: a group of bodies, placeables, geoms and other spaces that are looked through together.

    A space adds no transform. What collides with what is told to the World: ``world.collide(space)``.
    """

    PARENTS = ("World", "Space")
    KIND: ClassVar[int]

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Any) -> None:
        super().__init__(name=name, visible=visible, **fields)

    def _start(self) -> None:
        self._id: Any = None
        self._slot = -1

    def _arguments(self) -> tuple[float, ...]:
        """What the C core makes it from."""
        return ()

    def _check_place(self, parent: Group) -> None:
        super()._check_place(parent)
        above = sum(isinstance(node, Space) for node in (parent, *parent.ancestors))
        below = _depth(self)
        if above + below > MAX_DEPTH:
            raise refuse(self, parent, f"spaces would be nested {above + below} deep; at most {MAX_DEPTH} are allowed")

    def _check_room(self, child: PhysicsNode) -> None:
        if lib.dSpaceGetNumGeoms(self._id) >= MAX_GEOMS:
            raise TreeError(
                f"{child.describe()} can't be put into {self.describe()}: it holds {MAX_GEOMS} geoms, ODE's limit"
            )

    def _take(self, child: Any) -> None:
        self._check_room(child)
        lib.dSpaceAdd(self._id, ffi.cast("dGeomID", child._id))

    def _native_space(self) -> Any:
        return self._id

    def _enter(self, realm: Realm) -> None:
        slot = self._made(lib.oo_space_new(realm.ptr, self.KIND, self._arguments()))
        self._slot = slot
        self._id = ffi.cast("dSpaceID", realm.ptr.geoms[slot].id)
        realm.add_slot(slot, self)
        realm.pairs_changed = True
        super()._enter(realm)
        above = self.space
        if above is not None:
            above._take(self)
        self._enter_fields()

    def _leave(self) -> None:
        realm = self._live("leaving it")
        self._leave_fields()
        super()._leave()
        realm.remove_slot(self._slot)
        realm.pairs_changed = True
        self._id = None
        self._slot = -1

    def _rehouse(self) -> None:
        geom = ffi.cast("dGeomID", self._id)
        above, old = self.space, lib.dGeomGetSpace(geom)
        if old == (ffi.NULL if above is None else above._id):
            return
        if above is not None:
            above._check_room(self)
        lib.oo_rehouse(old, ffi.NULL if above is None else above._id, geom)
        self._live("moving").pairs_changed = True


def _depth(node: Any) -> int:
    deepest = max((_depth(child) for child in node.children if isinstance(child, Space)), default=0)
    return 1 + deepest


class SimpleSpace(Space):
    """Tests every pair: right for about ten children."""

    KIND = lib.OO_SIMPLE_SPACE


def _levels(value: Any) -> tuple[int, int]:
    low, high = value
    pair = (whole(-3, 20).convert(low), whole(-3, 20).convert(high))
    if pair[0] > pair[1]:
        raise ValueError
    return pair


def _read_levels(space: Any) -> tuple[int, int]:
    out = ffi.new("int[2]")
    lib.dHashSpaceGetLevels(space._id, out, out + 1)
    return out[0], out[1]


class HashSpace(Space):
    """Sorts boxes into grids of cells of several sizes: right for uneven moving things."""

    KIND = lib.OO_HASH_SPACE

    levels: Field[tuple[int, int], tuple[int, int]] = Field(
        (-3, 10),
        # Below -3 the cells of a world of 1e8 m can't be counted in 31 bits, and ODE would abort.
        Check("two whole numbers from -3 to 20, the lower first", _levels),
        _read_levels,
        lambda space, value: lib.dHashSpaceSetLevels(space._id, *value),
        doc="The smallest and largest cells are 2**levels metres wide.",
    )


class QuadTreeSpace(Space):
    """Sorts boxes into a tree of squares: right for static terrain spread evenly.

    The tree divides x and z. What is outside of its extent still collides, less quickly.
    """

    KIND = lib.OO_QUADTREE_SPACE

    centre = VectorField(Vec3(0.0, 0.0, 0.0), vector(POSITION_LIMIT), fixed=True, unit="m", doc="Of the tree.")
    extent: Field[Vec3, Vec3Like] = Field(
        Vec3(100.0, 100.0, 100.0),
        Check(
            "three lengths from 0.001 to 1e7 m",
            lambda value: Vec3(*(_extent(v) for v in three(value))),
        ),
        fixed=True,
        unit="m",
        doc="From the centre to the sides of the tree.",
    )
    depth = WholeField(5, whole(0, 8), fixed=True, doc="How often it is divided.")

    def _arguments(self) -> tuple[float, ...]:
        return (*self.centre, *self.extent, self.depth)


def _extent(value: float) -> float:
    if not 1e-3 <= value <= 1e7:
        raise ValueError
    return value


class SweepAndPruneSpace(Space):
    """Sorts boxes along an axis: right for many moving things spread over the ground.

    The first axis should be one along which things are spread: with Y up, not y.
    """

    KIND = lib.OO_SAP_SPACE

    axes: Field[str, str] = Field(
        "xzy",
        choice("xyz", "xzy", "yxz", "yzx", "zxy", "zyx"),
        fixed=True,
        doc="The order in which the axes are used.",
    )

    def _arguments(self) -> tuple[float, ...]:
        first, second, third = ("xyz".index(axis) for axis in self.axes)
        return (first | second << 2 | third << 4,)
