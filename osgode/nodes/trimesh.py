"""Geoms made of triangles."""

from __future__ import annotations

import math
from abc import abstractmethod
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, Unpack, runtime_checkable

import numpy as np

from osgode.errors import ModelError
from osgode.fields import Check, Field
from osgode.graph.drawable import Drawable
from osgode.graph.mesh import Mesh
from osgode.native import ffi, lib
from osgode.nodes.geom import Geom, GeomFields
from osgode.nodes.meshdata import MeshData

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy.typing as npt

    from osgode.mass import Mass
    from osgode.maths import Quat, Vec3
    from osgode.nodes.realm import Realm


@runtime_checkable
class HasTriangles(Protocol):
    """A loaded model, or a Mesh: anything with vertices and triangles."""

    @property
    def vertices(self) -> npt.NDArray[Any]:
        """(n, 3), metres."""

    @property
    def triangles(self) -> npt.NDArray[Any]:
        """(m, 3) indices."""


Triangles: TypeAlias = HasTriangles | MeshData | tuple[Any, Any]
"""What triangles come from: a model, a Mesh, MeshData, or a pair (vertices, triangles)."""


def mesh_data(source: Triangles, label: str, name: str) -> MeshData:
    """The MeshData in what a user gave.

    Raises:
        ModelError: beginning with ``label``, if the triangles can't be used.
    """
    if isinstance(source, MeshData):
        return source
    if isinstance(source, tuple) and len(source) == 2:
        return MeshData(*source, name=name)
    if isinstance(source, HasTriangles):
        return MeshData(source.vertices, source.triangles, getattr(source, "name", name))
    raise ModelError(
        f"{label}: source is a {type(source).__name__}; it must be a model, a Mesh, MeshData, "
        "or a pair (vertices, triangles)"
    )


def checked_data(value: Any) -> MeshData:
    """The check of a field that holds MeshData."""
    if not isinstance(value, MeshData):
        raise TypeError
    return value


class SharedGeom(Geom):
    """Abstract: a geom made from data that all geoms of one World share."""

    data: Any
    """What it is made from."""

    @abstractmethod
    def _make_shared(self, world: Any) -> Any:
        """The native of the data; NULL if ODE refused."""

    def _enter(self, realm: Realm) -> None:
        shared = realm.take_shared(self.data, self._shape(), self._make_shared)
        if shared == ffi.NULL:
            self._made(lib.OO_ASSERT)
        self._shared = shared
        try:
            super()._enter(realm)
        except BaseException:
            if self._realm is None:
                realm.give_shared(self.data, self._shape())
            raise

    def _leave(self) -> None:
        realm = self._live("leaving it")
        super()._leave()
        realm.give_shared(self.data, self._shape())
        self._shared = ffi.NULL

    def _half_thickness(self) -> float:
        vertices = getattr(self.data, "vertices", None)
        return math.inf if vertices is None else float(np.ptp(vertices, axis=0).min()) / 2

    @contextmanager
    def _visiting(self, realm: Realm, position: Vec3, rotation: Quat) -> Iterator[int]:
        self._shared = realm.take_shared(self.data, self._shape(), self._make_shared)
        if self._shared == ffi.NULL:
            self._made(lib.OO_ASSERT)
        try:
            with super()._visiting(realm, position, rotation) as slot:
                yield slot
        finally:
            realm.give_shared(self.data, self._shape())
            self._shared = ffi.NULL


class Trimesh(SharedGeom):
    """A surface of triangles: terrain, houses, hulls.

    It is a surface and not a solid: what is wholly inside touches nothing. As a part of a body it must be closed,
    or be given ``mass=0``.

    Args:
        source: a loaded model, a Mesh, MeshData, or a pair (vertices, triangles). Share one MeshData (``geom.data``)
            between geoms to have it in memory once.

    Raises:
        ModelError: if the triangles can't be used.
    """

    SHAPE = lib.OO_TRIMESH

    data: Field[MeshData, MeshData] = Field(
        MeshData([(0, 0, 0), (0, 0, 1), (1, 0, 0)], [(0, 1, 2)]),
        Check("MeshData", checked_data),
        fixed=True,
        doc="Its vertices and triangles, given when it is made.",
    )

    def __init__(
        self,
        source: Triangles,
        *,
        name: str = "",
        visible: bool = True,
        **fields: Unpack[GeomFields],
    ) -> None:
        self._model_drawables: Sequence[Drawable] = tuple(getattr(source, "drawables", ()))
        data = mesh_data(source, f"Trimesh {name!r}", name)
        super().__init__(name=name, visible=visible, data=data, **fields)

    def _copy_from(self, other: Any) -> None:
        super()._copy_from(other)
        self._model_drawables = other._model_drawables

    def _dimensions(self) -> tuple[float, ...]:
        return ()

    def _shape_mass(self, *, mass: float | None = None, density: float | None = None) -> Mass:
        water = self.data.water
        return water.scaled(mass if mass is not None else water.mass * (density or 0.0) / 1000.0)

    def _shape_drawables(self) -> tuple[Drawable, ...]:
        if self._model_drawables and self.appearance is None:
            return tuple(self._model_drawables)
        if self._model_drawables:
            return tuple(Drawable(d.mesh, self._look(), d.matrix) for d in self._model_drawables)
        vertices = self.data.vertices.astype(np.float32)
        return (Drawable(Mesh(vertices, self.data.triangles, name=self.data.name), self._look()),)

    def _make_shared(self, world: Any) -> Any:
        return lib.oo_mesh_new(world, *self.data.arrays())
