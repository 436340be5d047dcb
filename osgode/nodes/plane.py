"""The endless plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Unpack

from osgode.errors import FieldError
from osgode.fields import DIRECTION, POSITION_LIMIT, NumberField, VectorField, number
from osgode.graph.shapes import plane_drawable
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.geom import Geom, GeomFields, waking

if TYPE_CHECKING:
    from osgode.graph.drawable import Drawable
    from osgode.mass import Mass


def _params(geom: Any) -> tuple[float, float, float, float]:
    out = ffi.new("dVector4")
    lib.dGeomPlaneGetParams(geom._id, out)
    return out[0], out[1], out[2], out[3]


class Plane(Geom):
    """A half space: everything on the far side of the plane ``normal . p = offset`` is inside.

    Static, and in world axes: it may stand under a space only.

    Args:
        normal: out of the ground, any length but 0.
        offset: metres from the origin along the normal.
    """

    PARENTS: ClassVar[tuple[str, ...]] = ("Space",)
    SHAPE = lib.OO_PLANE
    PLACED = False

    normal = VectorField(
        Vec3(0.0, 1.0, 0.0),
        DIRECTION,
        lambda geom: Vec3(*_params(geom)[:3]),
        waking(lambda geom, value: lib.dGeomPlaneSetParams(geom._id, *value, _params(geom)[3])),
        after="_relooked",
        doc="Unit vector out of the ground.",
    )
    offset = NumberField(
        0.0,
        number(-POSITION_LIMIT, POSITION_LIMIT),
        lambda geom: _params(geom)[3],
        waking(lambda geom, value: lib.dGeomPlaneSetParams(geom._id, *_params(geom)[:3], value)),
        after="_relooked",
        unit="m",
        doc="Of the plane from the origin along the normal.",
    )

    def __init__(
        self,
        normal: Vec3Like = (0.0, 1.0, 0.0),
        offset: float = 0.0,
        *,
        name: str = "",
        visible: bool = True,
        **fields: Unpack[GeomFields],
    ) -> None:
        super().__init__(name=name, visible=visible, normal=normal, offset=offset, **fields)

    def _dimensions(self) -> tuple[float, ...]:
        return (*self.normal, self.offset)

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:  # noqa: ARG002
        raise FieldError("a plane has no volume")

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (plane_drawable(self.normal, self.offset, self._look(), solid_behind=True),)

    def _place(self) -> None:
        """Nothing: it stands in world axes."""
