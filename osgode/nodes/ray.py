"""Rays: geoms that report what is along a line, and never respond."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from osgode.errors import FieldError
from osgode.fields import FLAG, Check, Field, FlagField, NumberField, choice, number
from osgode.graph.appearance import Appearance
from osgode.graph.drawable import Drawable
from osgode.graph.shapes import ray_drawable
from osgode.maths import Pose, Quat, Vec3
from osgode.native import lib
from osgode.nodes.geom import Geom, GeomFields
from osgode.nodes.hit import Hit
from osgode.nodes.touch import contact_rows

if TYPE_CHECKING:
    from osgode.mass import Mass
    from osgode.nodes.realm import Realm

BACKWARDS = Pose(rotation=Quat(0.0, 0.0, 1.0, 0.0))
"""Half a turn about Y: ODE's rays look along +Z of their geom, and here they look along -Z, as cameras do."""
LONGEST = 1e6
"""Metres."""
LOOK = Appearance((1.0, 0.15, 0.1, 1.0), shininess=0.0, unlit=True)
REPORTS = {"closest": (False, True), "any": (True, False), "all": (False, False)}
"""ODE's flags "first contact" and "closest hit"."""


def _read_reports(ray: Any) -> str:
    flags = bool(lib.dGeomRayGetFirstContact(ray._id)), bool(lib.dGeomRayGetClosestHit(ray._id))
    return next(word for word, value in REPORTS.items() if value == flags)


def _write_reports(ray: Any, value: str) -> None:
    first, closest = REPORTS[value]
    lib.dGeomRaySetFirstContact(ray._id, first)
    lib.dGeomRaySetClosestHit(ray._id, closest)


def _nothing(value: object) -> None:
    if value is not None:
        raise ValueError


def _no_mass(value: Any) -> float | None:
    return None if value is None else number(0.0, 0.0).convert(value)


class RayFields(GeomFields, total=False):
    """The keyword arguments of `Ray`."""

    reports: str
    backface_cull: bool


class Ray(Geom):
    """A line from its origin along its own -Z, as a camera looks; it reports what it meets, and pushes nothing.

    In each step it is tested against what its space is collided with (`World.collide`), and tells in `hits` what it
    met, before the bodies moved. It sees static geometry and sleeping bodies too, also where it is static itself, and
    wakes nobody. It does not see other rays, the parts of its own body, and bodies that are joined to that.
    What has the kinds that it collides with, and it theirs, is met.

    Args:
        length: how far it reaches, metres.
    """

    SHAPE = lib.OO_RAY

    length = NumberField(
        10.0,
        number(1e-6, LONGEST),
        lambda ray: lib.dGeomRayGetLength(ray._id),
        lambda ray, value: lib.dGeomRaySetLength(ray._id, value),
        after="_relooked",
        unit="m",
        doc="How far it reaches.",
    )
    reports: Field[str, str] = Field(
        "closest",
        choice(*REPORTS),
        _read_reports,
        _write_reports,
        doc="Of each mesh, hull and heightfield 'closest': its nearest hit; 'any': the first one found, which is "
        "quicker; 'all': every one, as many as `World.contacts_per_pair`. Other shapes have one hit.",
    )
    backface_cull = FlagField(
        False,
        FLAG,
        lambda ray: bool(lib.dGeomRayGetBackfaceCull(ray._id)),
        lambda ray, value: lib.dGeomRaySetBackfaceCull(ray._id, value),
        doc="Whether it passes through meshes, hulls and heightfields from behind.",
    )
    mass: Field[float | None, float | None] = Field(None, Check("None or 0: a ray has no mass", _no_mass))
    density: Field[float | None, float | None] = Field(None, Check("None: a ray has no mass", _nothing))

    def __init__(
        self, length: float = 10.0, *, name: str = "", visible: bool = True, **fields: Unpack[RayFields]
    ) -> None:
        super().__init__(name=name, visible=visible, length=length, **fields)

    # -- what it meets

    @property
    def hits(self) -> tuple[Hit, ...]:
        """What it met in the last step, the nearest first; nothing outside of a World, and before the first step."""
        if self._realm is None:
            return ()
        rows = _rows_of_rays(self._live("hits")).get(self._slot, ())
        return tuple(hit for hit in map(self._hit, rows) if hit is not None)

    @property
    def hit(self) -> Hit | None:
        """The nearest of `hits`, or None."""
        hits = self.hits
        return hits[0] if hits else None

    def _hit(self, row: Any) -> Hit | None:
        geom: Any = None if self._realm is None else self._realm.node_of_slot(int(row["slot2"]))
        if geom is None:  # it is gone, and nobody has kept it
            return None
        contact = row["geom"]
        return Hit(_vec3(contact["pos"]), _vec3(contact["normal"]), float(contact["depth"]), geom, geom.body)

    @property
    def origin(self) -> Vec3:
        """Where it begins, in the world, metres."""
        return self.pose.position

    @property
    def direction(self) -> Vec3:
        """Where it looks, in the world, a vector of length 1."""
        return self.pose.rotation.rotate((0.0, 0.0, -1.0))

    # -- what a geom is

    @property
    def part_mass(self) -> Mass | None:
        """None: it has no mass."""
        return None

    def _native_pose(self) -> Pose:
        return super()._native_pose() * BACKWARDS

    def _dimensions(self) -> tuple[float, ...]:
        return (self.length,)

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:  # noqa: ARG002
        raise FieldError("a ray has no volume")

    def _look(self) -> Appearance:
        return self.appearance or LOOK

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        rod = ray_drawable(self.length, self._look())
        return (Drawable(rod.mesh, rod.appearance, BACKWARDS.matrix() @ np.asarray(rod.matrix)),)


def _rows_of_rays(realm: Realm) -> dict[int, Any]:
    """The last step's contact rows of each ray by its slot, the nearest first; sorted once a step for all rays."""
    if realm.ray_hits is None:
        rows = contact_rows(realm)
        rows = rows[rows["surface"] == lib.OO_NO_RESPONSE]
        rows = rows[np.lexsort((rows["geom"]["depth"], rows["slot1"]))]
        slots, starts = np.unique(rows["slot1"], return_index=True)
        realm.ray_hits = dict(zip(slots.tolist(), np.split(rows, starts[1:]), strict=True)) if len(rows) else {}
    return realm.ray_hits


def _vec3(row: Any) -> Vec3:
    x, y, z = row[:3].tolist()
    return Vec3(x, y, z)
