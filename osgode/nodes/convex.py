"""Convex hulls as geoms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError, ModelError
from osgode.fields import FLAG, Check, Field, FlagField
from osgode.graph.drawable import Drawable
from osgode.graph.mesh import Mesh
from osgode.graph.smoothing import creased
from osgode.maths import ZERO, Pose, Vec3
from osgode.native import lib
from osgode.nodes.geom import GeomFields
from osgode.nodes.hulls import hull_of, is_convex, merged
from osgode.nodes.meshdata import MeshData
from osgode.nodes.trimesh import HasTriangles, SharedGeom, checked_data, mesh_data

if TYPE_CHECKING:
    from osgode.mass import Mass

MOST_TRIANGLES = 2000
"""Of a solid hull: ODE goes through all for each contact, and finds their edges by the square of their number."""


def _hull_data(value: Any) -> MeshData:
    data = checked_data(value)
    if not is_convex(data):
        raise ValueError
    return data


class HullFields(GeomFields, total=False):
    """The keyword arguments of `ConvexHull`."""

    solid: bool


class ConvexHull(SharedGeom):
    """The convex hull of points or of a mesh.

    A closed mesh that is convex already is taken as it is. For all else the hull is computed, which needs the extra
    ``convex``.

    With planes, boxes, heightfields and other hulls it has as many contacts as it takes to rest quietly. For the
    rest ODE has two ways to collide it. As a mesh, which is the default, it has full contacts with capsules and
    cylinders too, but is a surface to them and to spheres: a small one that gets wholly inside is not pushed out. With
    ``solid=True`` it is ODE's convex: nothing stays inside, but a capsule or cylinder has one contact with it at a
    time, so that one that lies on a face of it jitters.

    Args:
        source: (n, 3) points, metres; or a loaded model, a Mesh, MeshData, or a pair (vertices, triangles). Share one
            MeshData (``geom.data``) between geoms to have it in memory once.

    Raises:
        ModelError: if the points can't be used, or lie in a plane.
        MissingExtraError: if the hull has to be computed, and scipy is not installed.
    """

    SHAPE = lib.OO_HULL

    data: Field[MeshData, MeshData] = Field(
        MeshData([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]),
        Check("MeshData that is closed, convex, and counter-clockwise from outside", _hull_data),
        fixed=True,
        doc="Vertices and triangles of the hull, computed when it is made.",
    )
    solid = FlagField(
        False,
        FLAG,
        fixed=True,
        after="_check_solid",
        doc="Whether ODE collides it as a solid with few contacts, or as a mesh with many.",
    )

    def __init__(
        self,
        source: npt.ArrayLike | HasTriangles | MeshData | tuple[npt.ArrayLike, npt.ArrayLike],
        *,
        name: str = "",
        visible: bool = True,
        **fields: Unpack[HullFields],
    ) -> None:
        data = _hull(source, f"ConvexHull {name!r}", name)
        super().__init__(name=name, visible=visible, data=data, **fields)

    def _check_solid(self) -> None:
        if self.solid and len(self.data.triangles) > MOST_TRIANGLES:
            raise FieldError(
                f"{self.describe()}.solid is True; a hull of {len(self.data.triangles)} triangles must not be solid: "
                f"ODE is too slow above {MOST_TRIANGLES}"
            )

    def _shape(self) -> int:
        return lib.OO_CONVEX if self.solid else lib.OO_HULL  # type: ignore[no-any-return]

    @property
    def _origin(self) -> Vec3:
        """ODE wants the origin of its convex inside: there it is the centre of mass, and the geom is moved by it."""
        return self.data.water.centre if self.solid else ZERO

    def _native_pose(self) -> Pose:
        return super()._native_pose() * Pose(self._origin)

    def _make_shared(self, world: Any) -> Any:
        return lib.oo_hull_new(world, *self.data.arrays(origin=self._origin), self.solid)

    def _dimensions(self) -> tuple[float, ...]:
        return ()

    @property
    def volume(self) -> float:
        """What it encloses, m3."""
        return self.data.water.mass / 1000.0

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        water = self.data.water
        return water.scaled(mass if mass is not None else water.mass * (density or 0.0) / 1000.0)

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        return (Drawable(drawn_mesh(self.data), self._look()),)


def drawn_mesh(data: MeshData) -> Mesh:
    """Triangles to draw, with sharp edges where there are edges."""
    vertices, triangles, normals, _ = creased(data.vertices, data.triangles.astype(np.int64))
    return Mesh(vertices, triangles, normals, name=data.name)


def _hull(source: Any, label: str, name: str) -> MeshData:
    """The closed convex MeshData in what a user gave, or the hull of it."""
    is_pair = isinstance(source, tuple) and len(source) == 2
    if not is_pair and not isinstance(source, MeshData | HasTriangles):
        if not isinstance(source, list | tuple | np.ndarray):
            raise ModelError(
                f"{label}: source is a {type(source).__name__}; it must be (n, 3) points, a model, a Mesh, MeshData, "
                "or a pair (vertices, triangles)"
            )
        return hull_of(source, label, name)
    data = mesh_data(source, label, name)
    if is_convex(data):
        return data
    data = merged(data)
    return data if is_convex(data) else hull_of(data.vertices, label, data.name)
