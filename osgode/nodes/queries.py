"""Questions to a World, or to one of its spaces, between steps: what a ray hits, what a shape overlaps."""

from __future__ import annotations

import weakref
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError, TreeError, shown
from osgode.fields import DIRECTION, POSITION_LIMIT, ROTATION, UNFIT, number, vector
from osgode.materials import KINDS, collide_bits
from osgode.maths import IDENTITY, ZERO, FloatArray, Quat, Vec3, Vec3Like, vec3
from osgode.native import checked, ffi, lib, row_dtype
from osgode.nodes.base import PhysicsNode, physics_nodes
from osgode.nodes.closest import is_geom, refuse_concave
from osgode.nodes.hit import Hit, Sweep

if TYPE_CHECKING:
    from osgode.maths import QuatLike
    from osgode.nodes.geom import Geom
    from osgode.nodes.realm import Realm

LONGEST = 1e6
"""Metres: ODE computes with the ends of rays."""
POINT, RAY_LENGTH = vector(POSITION_LIMIT), number(1e-6, LONGEST)

HIT_ROW = row_dtype("oo_hit")
Kinds = str | Iterable[str] | None


@dataclass(frozen=True)
class RayHits:
    """What many rays hit: tables with a row for each ray.

    Args:
        hit: (n,) whether it hit anything.
        distance: (n,) metres, infinite where nothing was hit.
        point: (n, 3) metres, NaN where nothing was hit.
        normal: (n, 3) unit vectors against the rays, NaN where nothing was hit.
        slot: (n,) the geom's slot, see `World.geom_of_slot`; -1 where nothing was hit.
    """

    hit: npt.NDArray[np.bool_]
    distance: FloatArray
    point: FloatArray
    normal: FloatArray
    slot: npt.NDArray[np.int32]
    _nodes: list[weakref.ref[PhysicsNode] | None]

    def __len__(self) -> int:
        return len(self.hit)

    @property
    def geoms(self) -> list[Geom | None]:
        """The geom that each ray hit, None where there is none (or it is freed)."""
        found: dict[int, Any] = {-1: None}
        for slot in np.unique(self.slot[self.hit]).tolist():
            ref = self._nodes[slot]
            found[slot] = None if ref is None else ref()
        return [found[slot] for slot in self.slot.tolist()]


class Queries(PhysicsNode):
    """What can be asked between steps; a World answers for everything in its spaces, a space for what is in it.

    Bodies directly under a World are in no space and are not found; nor are disabled geoms. What sleeps is.
    """

    @abstractmethod
    def _native_space(self) -> Any:
        """The space that is asked, NULL for all."""

    def cast_ray(
        self,
        origin: Vec3Like,
        direction: Vec3Like,
        length: float = 1000.0,
        *,
        kinds: Kinds = None,
        exclude: Iterable[PhysicsNode] = (),
    ) -> Hit | None:
        """The first geom that a ray meets, or None.

        A ray that begins inside a solid meets the far side of it; meshes are met from both sides. The normal points
        against the ray. Sensors are met like all others.

        Args:
            origin: a point of the world, metres.
            direction: any length but 0.
            length: metres, at most 1e6.
            kinds: the kinds of objects that it meets; None: all.
            exclude: bodies, geoms or spaces that it passes through: oneself, as a rule.

        Raises:
            FieldError: for a bad value.
            TreeError: if something excluded is no physics node.
            StateError: outside of a World, or from another thread inside a step.
        """
        realm = self._live("cast_ray")
        row = self._ray("cast_ray", origin, direction, length)
        query, _keep = self._query(realm, "cast_ray", kinds, exclude)
        out = ffi.new("oo_hit *")
        with realm.holding():
            status = lib.oo_cast_rays(realm.ptr, query, row, 1, out)
            if status < 0:
                checked(status, f"{self.describe()}.cast_ray()")
        return None if out.slot < 0 else _hit(realm, out)

    def cast_ray_through(
        self,
        origin: Vec3Like,
        direction: Vec3Like,
        length: float = 1000.0,
        *,
        kinds: Kinds = None,
        exclude: Iterable[PhysicsNode] = (),
    ) -> list[Hit]:
        """All geoms that a ray meets, each where it does so first, the nearest first; see `cast_ray`."""
        realm = self._live("cast_ray_through")
        row = self._ray("cast_ray_through", origin, direction, length)
        query, _keep = self._query(realm, "cast_ray_through", kinds, exclude)
        with realm.holding():
            count = lib.oo_cast_ray_through(realm.ptr, query, row)
            checked(count, f"{self.describe()}.cast_ray_through()")
            return [_hit(realm, hit) for hit in ffi.unpack(realm.ptr.hits, count)] if count else []

    def cast_rays(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        lengths: npt.ArrayLike = 1000.0,
        *,
        kinds: Kinds = None,
        exclude: Iterable[PhysicsNode] = (),
    ) -> RayHits:
        """The first geom that each of many rays meets, in one call.

        Args:
            origins: (n, 3), or one point for all, metres.
            directions: (n, 3), or one for all; any length but 0.
            lengths: (n,), or one for all, metres.
            kinds: as for `cast_ray`.
            exclude: as for `cast_ray`.

        Raises:
            FieldError: for tables of the wrong shape, and numbers that are not finite or out of range.
        """
        realm = self._live("cast_rays")
        rows = self._ray_rows(origins, directions, lengths)
        query, _keep = self._query(realm, "cast_rays", kinds, exclude)
        out = np.empty(len(rows), HIT_ROW)
        with realm.holding():
            status = lib.oo_cast_rays(
                realm.ptr,
                query,
                ffi.cast("double *", rows.ctypes.data),
                len(rows),
                ffi.cast("oo_hit *", out.ctypes.data),
            )
            checked(status, f"{self.describe()}.cast_rays()")
        hit = out["slot"] >= 0
        nothing = ~hit[:, None]
        return RayHits(
            hit,
            np.where(hit, out["distance"], np.inf),
            np.where(nothing, np.nan, out["point"]),
            np.where(nothing, np.nan, out["normal"]),
            out["slot"].copy(),
            list(realm._geoms),
        )

    def overlaps(
        self,
        shape: Geom,
        position: Vec3Like = ZERO,
        rotation: QuatLike = IDENTITY,
        *,
        kinds: Kinds = None,
        exclude: Iterable[PhysicsNode] = (),
    ) -> list[Hit]:
        """What a shape would overlap if it stood somewhere: a Hit at the deepest point of each, in no special order.

        ``normal`` points from the other geom towards the shape: moved along it by ``distance`` (the depth) the shape is
        about free. A mesh is a surface: what has its middle behind the triangles may be missed; so may, rarely, a
        cylinder deep in a box.

        Args:
            shape: a geom that is in no World; it isn't changed.
            position: of the shape, metres in the world.
            rotation: of the shape.
            kinds: as for `cast_ray`.
            exclude: as for `cast_ray`.

        Raises:
            TreeError: if the shape is no geom, or is in a World.
            FieldError: for a bad place; a Plane has none but its own.
        """
        realm = self._live("overlaps")
        name = f"{self.describe()}.overlaps()"
        point, turn = _placed(name, shape, position, rotation)
        query, _keep = self._query(realm, "overlaps", kinds, exclude)
        with realm.editing():
            with shape._visiting(realm, point, turn) as slot:
                count = lib.oo_find_overlaps(realm.ptr, query, slot)
            checked(count, name)
            return [_hit(realm, hit) for hit in ffi.unpack(realm.ptr.hits, count)] if count else []

    def sweep(
        self,
        shape: Geom,
        start: Vec3Like,
        motion: Vec3Like,
        rotation: QuatLike = IDENTITY,
        *,
        kinds: Kinds = None,
        exclude: Iterable[PhysicsNode] = (),
    ) -> Sweep | None:
        """What a shape would first touch if it went along a segment, without turning; None if nothing.

        Exact for spheres, boxes, capsules, cylinders and convex hulls against all geoms, which stand still meanwhile.

        Args:
            shape: a geom that is in no World; it isn't changed. Not a mesh, heightfield, plane or ray.
            start: of the shape, metres in the world.
            motion: from there to the end, metres.
            rotation: of the shape.
            kinds: as for `cast_ray`.
            exclude: as for `cast_ray`.

        Raises:
            TreeError: if the shape is no geom, or is in a World.
            FieldError: for a bad place or motion, or a shape that is not convex.
        """
        realm = self._live("sweep")
        name = f"{self.describe()}.sweep()"
        point, turn = _placed(name, shape, start, rotation)
        way = vector(LONGEST)(name, "motion", motion)
        query, _keep = self._query(realm, "sweep", kinds, exclude)
        out = ffi.new("oo_hit *")
        with realm.editing():
            with shape._visiting(realm, point, turn) as slot:
                found = lib.oo_sweep(realm.ptr, query, slot, tuple(way), out)
            refuse_concave(found, name, "shape", shape)
            if not checked(found, name):
                return None
            geom = cast("Geom", realm.node_of_slot(out.slot))
            return Sweep(out.distance, point + way * out.distance, Vec3(*out.normal), geom, geom.body)

    # -- what the C core is asked with

    def _ray(self, call: str, origin: Vec3Like, direction: Vec3Like, length: float) -> Any:
        try:
            return ffi.new(
                "double[7]", (*POINT.convert(origin), *DIRECTION.convert(direction), RAY_LENGTH.convert(length))
            )
        except UNFIT:  # said again, by what checks one after the other and says of what
            name = f"{self.describe()}.{call}()"
            start, way = POINT(name, "origin", origin), DIRECTION(name, "direction", direction)
            return ffi.new("double[7]", (*start, *way, RAY_LENGTH(name, "length", length)))

    def _ray_rows(self, origins: npt.ArrayLike, directions: npt.ArrayLike, lengths: npt.ArrayLike) -> FloatArray:
        name = f"{self.describe()}.cast_rays()"
        try:
            start, way, long = (np.asarray(table, dtype=np.float64) for table in (origins, directions, lengths))
            count = max(len(np.atleast_2d(start)), len(np.atleast_2d(way)), np.size(long))
            rows = np.empty((count, 7))
            rows[:, :3], rows[:, 3:6], rows[:, 6] = start, way, long
        except (TypeError, ValueError) as error:
            raise FieldError(
                f"{name}: origins and directions must be (n, 3) numbers, lengths (n,), or one for all: {error}"
            ) from error
        norms = np.linalg.norm(rows[:, 3:6], axis=1)
        bad = ~(np.isfinite(rows).all(axis=1) & (norms > 1e-12) & (rows[:, 6] >= 1e-6) & (rows[:, 6] <= LONGEST))
        bad |= np.abs(rows[:, :3]).max(axis=1, initial=0.0) > POSITION_LIMIT
        if bad.any():
            worst = int(bad.argmax())
            raise FieldError(
                f"{name}: ray {worst} is origin={rows[worst, :3].tolist()}, direction={rows[worst, 3:6].tolist()}, "
                f"length={rows[worst, 6]}; all must be finite, the direction not 0, the length from 1e-6 to {LONGEST:g}"
            )
        rows[:, 3:6] /= norms[:, None]
        return rows

    def _query(self, realm: Realm, call: str, kinds: Kinds, exclude: Iterable[PhysicsNode]) -> tuple[Any, Any]:
        try:
            bits = collide_bits(KINDS.convert(kinds))
        except UNFIT:
            bits = collide_bits(KINDS(f"{self.describe()}.{call}()", "kinds", kinds))
        slots: set[int] = set()
        nodes = (exclude,) if isinstance(exclude, PhysicsNode) else exclude
        if not isinstance(nodes, Iterable):
            raise TreeError(
                f"{self.describe()}.{call}(): exclude is {shown(exclude)}; it must be a list of bodies, geoms or spaces"
            )
        for node in nodes:
            if not isinstance(node, PhysicsNode):
                raise TreeError(
                    f"{self.describe()}.{call}(): exclude has {shown(node)}; "
                    "it must be a list of bodies, geoms or spaces"
                )
            slots.update(
                [each._slot for each in physics_nodes(node) if each._realm is realm and hasattr(each, "_slot")]
            )
        table = ffi.new("unsigned int[]", sorted(slots))
        return ffi.new("oo_query *", (bits, self._native_space(), table, len(slots))), table


def _placed(name: str, shape: Any, position: Vec3Like, rotation: QuatLike) -> tuple[Vec3, Quat]:
    """Where a shape is to stand that is asked about."""
    if not is_geom(shape) or shape.is_live:
        raise TreeError(f"{name}: shape is {shown(shape)}; it must be a geom that is in no World")
    point = POINT(name, "position", position)
    turn = ROTATION(name, "rotation", rotation)
    if not shape.PLACED and (point != ZERO or turn != IDENTITY):
        raise FieldError(f"{name}: {shape.describe()} can't be placed; leave position and rotation away")
    return point, turn


def _hit(realm: Realm, row: Any) -> Hit:
    geom = cast("Geom", realm.node_of_slot(row.slot))
    return Hit(vec3(row.point), vec3(row.normal), row.distance, geom, geom.body)
