"""What all collision shapes have in common."""

from __future__ import annotations

import math
import weakref
from abc import abstractmethod
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, ClassVar, TypedDict

import numpy as np

from osgode.errors import FieldError
from osgode.fields import FLAG, Check, Field, FlagField, VectorField, number, optional, vector
from osgode.graph.appearance import Appearance
from osgode.graph.drawable import Drawable
from osgode.materials import (
    KIND,
    KINDS,
    MATERIAL,
    Surface,
    category_bits,
    collide_bits,
    material,
)
from osgode.maths import IDENTITY, ZERO, Pose, Quat, Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.base import nearest_body
from osgode.nodes.closest import closest
from osgode.nodes.placeable import Placeable
from osgode.nodes.touch import Listening, contact_rows, listening_above

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from osgode.graph.node import Group
    from osgode.mass import Mass
    from osgode.nodes.body import Body
    from osgode.nodes.hit import Closest
    from osgode.nodes.realm import Realm

LOOKS: dict[str, Appearance] = {
    "default": Appearance((0.75, 0.75, 0.78, 1.0)),
    "wood": Appearance((0.72, 0.53, 0.33, 1.0), shininess=0.1),
    "steel": Appearance((0.56, 0.58, 0.62, 1.0), shininess=0.8),
    "aluminium": Appearance((0.80, 0.81, 0.83, 1.0), shininess=0.7),
    "concrete": Appearance((0.62, 0.61, 0.58, 1.0), shininess=0.05),
    "glass": Appearance((0.72, 0.86, 0.88, 0.45), shininess=0.95),
    "ice": Appearance((0.80, 0.92, 0.98, 0.8), shininess=0.8),
    "brick": Appearance((0.66, 0.32, 0.24, 1.0), shininess=0.05),
    "rubber": Appearance((0.16, 0.16, 0.17, 1.0), shininess=0.15),
    "earth": Appearance((0.45, 0.42, 0.26, 1.0), shininess=0.0),
}
"""How a geom looks that was given no appearance: by its material."""


def _instance_check(kind: type, words: str) -> Check[Any]:
    def convert(value: object) -> object:
        if not isinstance(value, kind):
            raise TypeError
        return value

    return optional(Check(words, convert))


def _drawables(value: Any) -> tuple[Drawable, ...]:
    drawables = (value,) if isinstance(value, Drawable) else tuple(value)
    if not all(isinstance(d, Drawable) for d in drawables):
        raise TypeError
    return drawables


def waking(write: Callable[[Any, Any], object]) -> Callable[[Any, Any], None]:
    """Wake what touches a geom before it is changed: what slept on it may lose its support."""

    def wake_and_write(geom: Any, value: Any) -> None:
        lib.oo_wake_touching(geom._realm.ptr, geom._slot)
        write(geom, value)

    return wake_and_write


class GeomFields(TypedDict, total=False):
    """The keyword arguments that all geoms have."""

    material: str
    kind: str
    collides_with: str | set[str] | frozenset[str] | tuple[str, ...] | list[str] | None
    enabled: bool
    sensor: bool
    mass: float | None
    density: float | None
    surface: Surface | None
    surface_velocity: Vec3Like
    appearance: Appearance | None
    shown: Sequence[Drawable] | Drawable | None


class Geom(Listening):
    """A collision shape, and what is seen of it.

    Two geoms meet if each has the other's kind among what it collides with, unless both are static, belong to
    one body, or their bodies are joined by a joint.
    """

    PARENTS: ClassVar[tuple[str, ...]] = ("Placeable", "Space")
    SHAPED = True
    SHAPE: ClassVar[int]
    """Which shape of the C core it is."""
    PLACED: ClassVar[bool] = True
    """Whether it has a position."""

    material: Field[str, str] = Field("default", MATERIAL, after="_remade", doc="The name of what it is made of.")
    kind: Field[str, str] = Field("default", KIND, after="_marked", doc="The name of the kind of object it belongs to.")
    collides_with: Field[frozenset[str] | None, Any] = Field(
        None, KINDS, after="_marked", doc="The kinds of objects that it meets; None: all."
    )
    enabled = FlagField(
        True,
        FLAG,
        lambda geom: bool(lib.dGeomIsEnabled(geom._id)),
        waking(lambda geom, value: lib.dGeomEnable(geom._id) if value else lib.dGeomDisable(geom._id)),
        doc="Whether it collides.",
    )
    sensor = FlagField(
        False,
        FLAG,
        after="_sensed",
        doc="Whether it only reports what touches it, and pushes nothing.",
    )
    mass: Field[float | None, float | None] = Field(
        None,
        optional(number(0.0, 1e15)),
        after="_remassed",
        unit="kg",
        doc="Its part of the body's mass; 0: none; None: by density.",
    )
    density: Field[float | None, float | None] = Field(
        None,
        optional(number(1e-6, 1e9)),
        after="_remassed",
        unit="kg/m3",
        doc="Used where no mass is given; the material's if None.",
    )
    surface: Field[Surface | None, Surface | None] = Field(
        None,
        _instance_check(Surface, "a Surface"),
        after="_resurfaced",
        doc="Its own surface instead of the table's; where both geoms have one, that of lower friction counts.",
    )
    surface_velocity = VectorField(
        ZERO,
        vector(1e6),
        after="_belted",
        unit="m/s",
        doc="Of its surface against itself, along its own axes: a conveyor belt's. It adds to what the surfaces say.",
    )
    appearance: Field[Appearance | None, Appearance | None] = Field(
        None,
        _instance_check(Appearance, "an Appearance"),
        after="_relooked",
        doc="How it looks; by its material if None.",
    )
    shown: Field[tuple[Drawable, ...] | None, Any] = Field(
        None,
        optional(Check("a Drawable or several", _drawables)),
        after="_relooked",
        doc="What is drawn instead of the collision shape, in the geom's axes.",
    )

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Any) -> None:
        super().__init__(name=name, visible=visible, **fields)

    def _start(self) -> None:
        self._id: Any = None
        self._slot = -1
        self._shared: Any = ffi.NULL
        self._placed = Pose()
        self._own_drawables: tuple[Drawable, ...] | None = None

    # -- what a kind of geom provides

    def _shape(self) -> int:
        """Which shape of the C core it is to be made as."""
        return self.SHAPE

    def _native_pose(self) -> Pose:
        """Where ODE's geom stands in the body, or in the world for static geometry."""
        return self._placement

    @abstractmethod
    def _dimensions(self) -> tuple[float, ...]:
        """What the C core makes it from."""

    @abstractmethod
    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        """The mass of the shape in its own axes."""

    @abstractmethod
    def _shape_drawables(self) -> tuple[Drawable, ...]:
        """The collision shape as it looks."""

    def _half_thickness(self) -> float:
        """Half of its thinnest side, metres; infinite for what is never thin."""
        return math.inf

    # -- what it is

    @property
    def body(self) -> Body | None:
        """The Body that it is a part of, or None for static geometry."""
        return nearest_body(self.parent)

    @property
    def pose(self) -> Pose:
        """Where it is in the world (below a World or not)."""
        local = self._placement
        return self.body.pose * local if self.body is not None else local

    @property
    def _placement(self) -> Pose:
        """Where it is in the body, or in the static world."""
        parent = self.parent
        return parent.pose if isinstance(parent, Placeable) else Pose()

    @property
    def bounds(self) -> tuple[Vec3, Vec3]:
        """The lowest and the highest corner of its box along the world's axes, metres.

        Raises:
            StateError: outside of a World.
        """
        self._live("bounds")
        box = ffi.new("dReal[6]")
        lib.dGeomGetAABB(self._id, box)
        return Vec3(box[0], box[2], box[4]), Vec3(box[1], box[3], box[5])

    @property
    def part_mass(self) -> Mass | None:
        """Its mass in the frame of the body (or of the world, for static geometry), None if it has none.

        Raises:
            FieldError: if its shape encloses no volume.
        """
        if self.mass == 0.0:
            return None
        density = None if self.mass is not None else self.density or material(self.material).density
        try:
            own = self._shape_mass(mass=self.mass, density=density)
        except FieldError as error:
            raise FieldError(f"{self.describe()} has no usable mass: {error}; mass=0 makes it weightless") from error
        parent = self.parent
        return own.moved(parent.pose) if isinstance(parent, Placeable) else own

    def drawables(self) -> tuple[Drawable, ...]:
        """What is drawn: `shown`, or the collision shape."""
        if self.shown is not None:
            return self.shown
        if self._own_drawables is None:
            self._own_drawables = self._shape_drawables()
        return self._own_drawables

    def _look(self) -> Appearance:
        return self.appearance or LOOKS.get(self.material, LOOKS["default"])

    # -- touching

    @property
    def touching(self) -> tuple[Geom, ...]:
        """The geoms that it touched in the last step.

        What sleeps is looked at only where a sensor or a listener is, so two sleepers that touch may not be named.

        Raises:
            StateError: outside of a World.
        """
        realm = self._live("touching")
        rows = contact_rows(realm)
        rows = rows[rows["surface"] != lib.OO_REFUSED]
        others = np.concatenate(
            [rows["slot2"][rows["slot1"] == self._slot], rows["slot1"][rows["slot2"] == self._slot]]
        )
        geoms = (realm.node_of_slot(int(slot)) for slot in np.unique(others))
        return tuple(geom for geom in geoms if isinstance(geom, Geom) and geom.is_live)

    def closest_to(self, other: Geom) -> Closest:
        """How far this geom is from another one of the same World, and where they are nearest.

        One of the two must be convex (a sphere, box, capsule, cylinder or hull). Against a mesh or heightfield all
        its triangles are looked at.

        Raises:
            StateError: outside of a World.
            TreeError: if the other is no geom of the same World.
            FieldError: if neither is convex.
        """
        return closest(self, other)

    def _mark_listened(self) -> None:
        if self._realm is None:
            return
        above = listening_above(self)
        touch = tuple((weakref.ref(node), listener) for node in above for listener in node._touch_listeners)
        collide = tuple((weakref.ref(node), listener) for node in above for listener in node._collide_listeners)
        self._flag(lib.OO_LISTENED, on=bool(touch))
        self._flag(lib.OO_ASKED, on=bool(collide))
        if (world := self.world) is not None:
            world._touch_ears.set(self._slot, touch)
            world._collide_ears.set(self._slot, collide)

    def _flag(self, flag: int, *, on: bool) -> None:
        if self._realm is not None:
            self._realm.ptr.edited = 1
            row = self._realm.ptr.geoms[self._slot]
            row.flags = row.flags | flag if on else row.flags & ~flag

    # -- after changes

    def _sensed(self) -> None:
        if self._realm is not None:
            lib.oo_wake_touching(self._realm.ptr, self._slot)  # what a solid thing bears, it bears no longer
            self._flag(lib.OO_SENSOR, on=self.sensor)
            lib.oo_wake_touching(self._realm.ptr, self._slot)  # what is in a thing that becomes solid is in its way
            if (body := self.body) is not None:
                body._measure()

    def _marked(self) -> None:
        if self._realm is not None:
            lib.oo_wake_touching(self._realm.ptr, self._slot)
            lib.oo_geom_set_bits(
                self._realm.ptr,
                self._slot,
                category_bits(self.material, self.kind),
                collide_bits(self.collides_with),
                material(self.material).index,
            )

    def _remade(self) -> None:
        self._marked()
        self._remassed()
        self._relooked()

    def _remassed(self) -> None:
        if self.mass is not None and self.density is not None:
            raise FieldError(
                f"{self.describe()} has mass={self.mass} and density={self.density}; give one, the other None"
            )
        if (body := self.body) is not None:
            body._parts_changed()

    def _resized(self) -> None:
        self._remassed()
        self._relooked()

    def _relooked(self) -> None:
        self._own_drawables = None
        self._touch()

    def _resurfaced(self) -> None:
        if self._realm is None:
            return
        row = self._realm.ptr.geoms[self._slot]
        if row.surface:
            self._realm.give_surface(row.surface)
            row.surface = 0
        self._take_surface()
        lib.oo_wake_touching(self._realm.ptr, self._slot)

    def _take_surface(self) -> None:
        if self._realm is not None and self.surface is not None:
            row = self._realm.ptr.geoms[self._slot]
            own = self.surface.row(self._realm.ptr.step_size)
            row.surface = self._realm.take_surface(own, self.surface.direction or ZERO)

    def _belted(self) -> None:
        if self._realm is not None:
            lib.oo_geom_set_velocity(self._realm.ptr, self._slot, tuple(self.surface_velocity))
            lib.oo_wake_touching(self._realm.ptr, self._slot)

    def _surface_again(self) -> None:
        if self.surface is not None and self.surface.spring is not None:
            self._resurfaced()

    @contextmanager
    def _visiting(self, realm: Realm, position: Vec3, rotation: Quat) -> Iterator[int]:
        """Have a native for one question, in no space and unknown to everybody: its slot."""
        slot = self._made(lib.oo_geom_new(realm.ptr, self._shape(), self._dimensions(), self._shared))
        try:
            native = realm.ptr.geoms[slot].id
            if self.PLACED:
                pose = Pose(position, rotation) * self._placement.inverse() * self._native_pose()
                lib.dGeomSetPosition(native, *pose.position)
                lib.dGeomSetQuaternion(native, pose.rotation)
            yield slot
        finally:
            lib.oo_geom_discard(realm.ptr, slot)

    # -- entering and leaving

    def _enter(self, realm: Realm) -> None:
        slot = self._made(lib.oo_geom_new(realm.ptr, self._shape(), self._dimensions(), self._shared))
        self._slot = slot
        self._id = realm.ptr.geoms[slot].id
        realm.add_slot(slot, self)
        super()._enter(realm)
        space = self.space
        if space is not None:
            space._take(self)
        body = self.body
        if body is not None:
            lib.dGeomSetBody(self._id, body._id)
        self._place()
        self._enter_fields()
        self._marked()
        self._flag(lib.OO_SENSOR, on=self.sensor)
        self._take_surface()
        if self.surface_velocity != ZERO:
            self._belted()
        self._mark_listened()

    def _leave(self) -> None:
        realm = self._live("leaving it")
        self._leave_fields()
        lib.oo_wake_touching(realm.ptr, self._slot)
        if (own := realm.ptr.geoms[self._slot].surface) != 0:
            realm.give_surface(own)
        super()._leave()
        realm.remove_slot(self._slot)
        self._id = None
        self._slot = -1

    def _rehouse(self) -> None:
        space, old = self.space, lib.dGeomGetSpace(self._id)
        if old != (ffi.NULL if space is None else space._id):
            if space is not None:
                space._check_room(self)
            lib.oo_rehouse(old, ffi.NULL if space is None else space._id, self._id)
        body = self.body
        native = ffi.NULL if body is None else body._id
        if lib.dGeomGetBody(self._id) != native:
            if lib.dGeomIsOffset(self._id):  # ODE forgets to free it with the old body
                lib.dGeomClearOffset(self._id)
            lib.dGeomSetBody(self._id, native)
            self._place()
        elif self._placement != self._placed:  # to another place in the same body, or in the static world
            self._place()
        self._mark_listened()

    def _place(self) -> None:
        if self._realm is None:
            return
        self._placed = self._placement
        pose = self._native_pose()
        body = self.body
        if body is None:
            lib.oo_wake_touching(self._realm.ptr, self._slot)
            lib.dGeomSetPosition(self._id, *pose.position)
            lib.dGeomSetQuaternion(self._id, pose.rotation)
            return
        offset = pose.position - body._com
        if offset == ZERO and pose.rotation == IDENTITY:
            if lib.dGeomIsOffset(self._id):
                lib.dGeomClearOffset(self._id)
        else:
            lib.dGeomSetOffsetPosition(self._id, *offset)
            lib.dGeomSetOffsetQuaternion(self._id, pose.rotation)

    def _arrived(self, parent: Group) -> None:
        if (body := nearest_body(parent)) is not None:
            body._parts_changed()

    def _departed(self, parent: Group) -> None:
        if (body := nearest_body(parent)) is not None:
            body._parts_changed()
