"""Geoms with a formula: box, sphere, capsule, cylinder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

from osgode.fields import LENGTH, SIZE, NumberField, VectorField
from osgode.graph.shapes import box_drawable, capsule_drawable, cylinder_drawable, sphere_drawable
from osgode.mass import Mass
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.geom import Geom, GeomFields, waking

if TYPE_CHECKING:
    from osgode.graph.drawable import Drawable


def _box_size(geom: Any) -> Vec3:
    out = ffi.new("dVector3")
    lib.dGeomBoxGetLengths(geom._id, out)
    return Vec3(out[0], out[1], out[2])


class Box(Geom):
    """A box centred on its origin.

    Args:
        size: lengths of the edges along x, y, z, metres.
    """

    SHAPE = lib.OO_BOX

    size = VectorField(
        Vec3(1.0, 1.0, 1.0),
        SIZE,
        _box_size,
        waking(lambda geom, value: lib.dGeomBoxSetLengths(geom._id, *value)),
        after="_resized",
        unit="m",
        doc="Lengths of the edges.",
    )

    def __init__(
        self, size: Vec3Like = (1.0, 1.0, 1.0), *, name: str = "", visible: bool = True, **fields: Unpack[GeomFields]
    ) -> None:
        super().__init__(name=name, visible=visible, size=size, **fields)

    def _dimensions(self) -> tuple[float, ...]:
        return self.size

    def _half_thickness(self) -> float:
        return min(self.size) / 2

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        return Mass.box(self.size, mass=mass, density=density)

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (box_drawable(self.size, self._look()),)


class Sphere(Geom):
    """A sphere about its origin.

    Args:
        radius: metres.
    """

    SHAPE = lib.OO_SPHERE

    radius = NumberField(
        0.5,
        LENGTH,
        lambda geom: lib.dGeomSphereGetRadius(geom._id),
        waking(lambda geom, value: lib.dGeomSphereSetRadius(geom._id, value)),
        after="_resized",
        unit="m",
    )

    def __init__(
        self, radius: float = 0.5, *, name: str = "", visible: bool = True, **fields: Unpack[GeomFields]
    ) -> None:
        super().__init__(name=name, visible=visible, radius=radius, **fields)

    def _dimensions(self) -> tuple[float, ...]:
        return (self.radius,)

    def _half_thickness(self) -> float:
        return self.radius

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        return Mass.sphere(self.radius, mass=mass, density=density)

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (sphere_drawable(self.radius, self._look()),)


class _Round(Geom):
    """What has a radius, and a length along its own z axis."""

    _READ: Any
    _WRITE: Any

    def _params(self) -> tuple[float, float]:
        out = ffi.new("dReal[2]")
        self._READ(self._id, out, out + 1)
        return out[0], out[1]

    radius = NumberField(
        0.5,
        LENGTH,
        lambda geom: geom._params()[0],
        waking(lambda geom, value: geom._WRITE(geom._id, value, geom._params()[1])),
        after="_resized",
        unit="m",
    )
    length = NumberField(
        1.0,
        LENGTH,
        lambda geom: geom._params()[1],
        waking(lambda geom, value: geom._WRITE(geom._id, geom._params()[0], value)),
        after="_resized",
        unit="m",
        doc="Along z; of a capsule the cylindrical part alone.",
    )

    def __init__(
        self,
        radius: float = 0.5,
        length: float = 1.0,
        *,
        name: str = "",
        visible: bool = True,
        **fields: Unpack[GeomFields],
    ) -> None:
        super().__init__(name=name, visible=visible, radius=radius, length=length, **fields)

    def _dimensions(self) -> tuple[float, ...]:
        return self.radius, self.length


class Capsule(_Round):
    """A cylinder along z with half a sphere on both ends, about its origin.

    Args:
        radius: metres.
        length: of the cylindrical part, metres: the whole is ``length + 2 * radius`` long.
    """

    SHAPE = lib.OO_CAPSULE
    _READ = staticmethod(lib.dGeomCapsuleGetParams)
    _WRITE = staticmethod(lib.dGeomCapsuleSetParams)

    def _half_thickness(self) -> float:
        return self.radius

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        return Mass.capsule(self.radius, self.length, mass=mass, density=density)

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (capsule_drawable(self.radius, self.length, self._look()),)


class Cylinder(_Round):
    """A cylinder along z about its origin.

    Args:
        radius: metres.
        length: metres.
    """

    SHAPE = lib.OO_CYLINDER
    _READ = staticmethod(lib.dGeomCylinderGetParams)
    _WRITE = staticmethod(lib.dGeomCylinderSetParams)

    def _half_thickness(self) -> float:
        return min(self.radius, self.length / 2)

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        return Mass.cylinder(self.radius, self.length, mass=mass, density=density)

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (cylinder_drawable(self.radius, self.length, self._look()),)
