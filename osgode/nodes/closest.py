"""How far two geoms are apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from osgode.errors import FieldError, TreeError, shown
from osgode.maths import Vec3
from osgode.native import checked, ffi, lib
from osgode.nodes.base import PhysicsNode
from osgode.nodes.hit import Closest

if TYPE_CHECKING:
    from osgode.nodes.geom import Geom


def is_geom(thing: object) -> bool:
    """Whether it is a collision shape; geoms import this module, so it can't import them."""
    return isinstance(thing, PhysicsNode) and hasattr(thing, "SHAPE")


def refuse_concave(status: int, name: str, argument: str, geom: Geom) -> None:
    """Raise FieldError if the C core says that a shape is not convex."""
    if status == lib.OO_BAD_BODY:
        raise FieldError(
            f"{name}: {argument} is {geom.describe()}; it must be a Sphere, Box, Capsule, Cylinder or ConvexHull"
        )


def closest(geom: Geom, other: Geom) -> Closest:
    """The nearest points of two geoms of one World; see `Geom.closest_to`."""
    name = f"{geom.describe()}.closest_to()"
    realm = geom._live("closest_to")
    if getattr(other, "_realm", None) is not realm or other is geom or not is_geom(other):
        raise TreeError(f"{name}: other is {shown(other)}; it must be another geom of the same World")
    out = ffi.new("double[7]")
    with realm.editing():
        status = lib.oo_closest(realm.ptr, geom._slot, other._slot, out)
    if status == lib.OO_BAD_BODY:  # the other way round, then
        with realm.editing():
            status = lib.oo_closest(realm.ptr, other._slot, geom._slot, out)
        refuse_concave(status, name, "one of the two", geom)
        checked(status, name)
        return Closest(out[6], Vec3(*out[3:6]), Vec3(*out[0:3]))
    checked(status, name)
    return Closest(out[6], Vec3(*out[0:3]), Vec3(*out[3:6]))
