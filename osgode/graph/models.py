"""Model files: read once, flattened to plain geometry, to be shown and to collide with."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from osgode.errors import ModelError
from osgode.graph.appearance import Appearance
from osgode.graph.drawable import Drawable
from osgode.graph.leaf import Leaf
from osgode.graph.mesh import Mesh
from osgode.graph.model_materials import Textures, appearance_of, warn_of_textures
from osgode.graph.smoothing import creased
from osgode.maths import FloatArray, Vec3

if TYPE_CHECKING:
    import trimesh

SUPPORTED = (".obj", ".glb", ".gltf", ".stl", ".ply")
"""Endings of the model files that can be read."""

LARGEST = 1e15
"""Coordinates must stay below this, so that no square of a length overflows in single precision."""
NO_AREA = 1e-12
"""Triangles whose doubled area is at most this share of a squared edge are left out."""

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Model:
    """What a model file holds, in one frame, metres.

    Args:
        name: the file's name.
        drawables: one per appearance, without matrix.
        vertices: (n, 3) of all parts together, equal ones merged, read-only.
        triangles: (m, 3) indices into ``vertices``, counter-clockwise seen from outside, none without area, read-only.
    """

    name: str
    drawables: tuple[Drawable, ...]
    vertices: FloatArray
    triangles: Indices

    @cached_property
    def bounds(self) -> tuple[Vec3, Vec3]:
        """The lowest and highest corner of the bounding box."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return Vec3(*map(float, low)), Vec3(*map(float, high))

    def to_leaf(self, *, name: str = "") -> Leaf:
        """A new leaf that shows the model; leaves of one model share its meshes and textures."""
        return Leaf(self.drawables, name=name or self.name)

    def __repr__(self) -> str:
        return f"<Model {self.name!r} of {len(self.vertices)} vertices, {len(self.triangles)} triangles>"


class _Part:
    """The geometry of one appearance, gathered piece by piece."""

    def __init__(self) -> None:
        self._count = 0
        self._vertices: list[FloatArray] = []
        self._triangles: list[Indices] = []
        self._normals: list[FloatArray] = []
        self._uvs: list[FloatArray] = []

    def add(self, vertices: FloatArray, triangles: Indices, normals: FloatArray, uvs: FloatArray | None) -> None:
        self._vertices.append(vertices)
        self._triangles.append(triangles + self._count)
        self._normals.append(normals)
        self._uvs.append(np.zeros((len(vertices), 2)) if uvs is None else uvs)
        self._count += len(vertices)

    def mesh(self, name: str) -> Mesh:
        arrays = (self._vertices, self._triangles, self._normals, self._uvs)
        vertices, triangles, normals, uvs = (np.vstack(pieces) for pieces in arrays)
        return Mesh(vertices, triangles, normals, uvs, name=name)


@np.errstate(under="ignore")  # some exporters write 1e-200 for 0, and its square is 0
def load_model(path: str | os.PathLike[str], *, scale: float = 1.0) -> Model:
    """Read a model file: .obj (with its .mtl and textures), .glb, .gltf, .stl or .ply.

    The file's hierarchy is flattened: every part is moved to where its nodes put it. Parts that look alike are merged.
    Normals and texture seams of the file are kept; where it has no normals, they are smooth over
    gentle bends and sharp at edges. Colour, opacity and texture become an `Appearance`. A texture that
    can't be read, or Pillow not being installed, costs a warning in the log and the texture.

    Args:
        path: the file.
        scale: metres per unit of the file, above 0.

    Raises:
        ModelError: naming the file, if it is missing, of another kind, broken, without triangles, or holds numbers
            that are not finite.
    """
    file = Path(path)
    if not (math.isfinite(scale) and scale > 0):
        raise ModelError(f"{file}: scale is {scale!r}; it must be above 0 and finite")
    if file.suffix.lower() not in SUPPORTED:
        raise ModelError(f"{file}: can't read {file.suffix or 'no ending'!r}; supported are {', '.join(SUPPORTED)}")
    if not file.is_file():
        raise ModelError(f"{file}: there is no such file (looked in {file.parent.resolve()})")
    scene = _read(file)
    warn_of_textures(file)

    parts: dict[Appearance, _Part] = {}
    textures: Textures = {}
    solid: list[tuple[FloatArray, Indices]] = []
    for geometry, matrix in _geometries(scene):
        vertices, triangles, normals = _placed(file, geometry, matrix, scale)
        if not len(triangles):
            continue
        solid.append((vertices, triangles))
        uvs = _uvs(file, geometry)
        if normals is None:
            vertices, triangles, normals, uvs = creased(vertices, triangles, uvs)
        part = parts.setdefault(appearance_of(file, geometry.visual, textures), _Part())
        part.add(vertices, triangles, normals, uvs)
    if not solid:
        raise ModelError(f"{file}: it holds no triangles")
    drawables = tuple(Drawable(part.mesh(file.name), appearance) for appearance, part in parts.items())
    return Model(file.name, drawables, *_merged(solid))


def _read(file: Path) -> trimesh.Scene:
    import trimesh  # here and not above: it takes longer to import than all of osgode

    try:
        # With process=True trimesh would merge vertices by rules of its own.
        return trimesh.load_scene(file, process=False)
    except Exception as error:
        raise ModelError(f"{file}: it can't be read as {file.suffix.lower()}: {error}") from error


def _geometries(scene: trimesh.Scene) -> Iterator[tuple[trimesh.Trimesh, FloatArray]]:
    """Each mesh at each place of the scene's hierarchy, with the matrix from its axes to the file's."""
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        geometry = scene.geometry[name]
        if getattr(geometry, "faces", None) is not None:  # points and lines have none
            yield geometry, np.asarray(matrix, dtype=np.float64)


def _placed(
    file: Path, geometry: trimesh.Trimesh, matrix: FloatArray, scale: float
) -> tuple[FloatArray, Indices, FloatArray | None]:
    """Vertices, triangles with area, and the file's normals (None if it has none), moved by ``matrix``, scaled."""
    linear = matrix[:3, :3]
    raw = np.asarray(geometry.vertices, dtype=np.float64)
    triangles = np.asarray(geometry.faces, dtype=np.int64)
    if len(triangles) and (triangles.min() < 0 or triangles.max() >= len(raw)):
        raise ModelError(
            f"{file}: triangles refer to vertices {triangles.min()} to {triangles.max()}; there are {len(raw)}"
        )
    with np.errstate(all="ignore"):
        vertices = (raw @ linear.T + matrix[:3, 3]) * scale
    if not (np.abs(vertices) < LARGEST).all():
        raise ModelError(f"{file}: vertices hold a number that is not finite, or not below {LARGEST:g}")
    first, second, third = (vertices[triangles[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(second - first, third - first), axis=1)
    edges = np.maximum(((second - first) ** 2).sum(axis=1), ((third - first) ** 2).sum(axis=1))
    triangles = triangles[areas > NO_AREA * edges]  # the others have no normal, which ODE takes badly
    if np.linalg.det(linear) < 0:
        triangles = triangles[:, ::-1]  # mirrored: what was counter-clockwise has become clockwise
    # trimesh computes normals when asked, so only its cache tells whether the file had any.
    if "vertex_normals" not in geometry._cache:
        return vertices, triangles, None
    # Normals stay perpendicular under the inverse transpose; its multiple, the cofactors, always exists.
    cofactors = np.stack([np.cross(linear[k - 2], linear[k - 1]) for k in range(3)])
    normals = np.asarray(geometry.vertex_normals, dtype=np.float64) @ cofactors.T * np.sign(np.linalg.det(linear))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    if not (np.isfinite(normals).all() and (lengths > 0).all()):
        return vertices, triangles, None
    return vertices, triangles, normals / lengths


def _uvs(file: Path, geometry: trimesh.Trimesh) -> FloatArray | None:
    """The texture coordinates, (n, 2), None if there aren't any or they don't fit."""
    uvs = getattr(geometry.visual, "uv", None)
    if uvs is None or len(uvs) != len(geometry.vertices):
        return None
    if not np.isfinite(uvs).all():
        raise ModelError(f"{file}: texture coordinates hold a number that is not finite")
    return np.asarray(uvs, dtype=np.float64)


def _merged(solid: Sequence[tuple[FloatArray, Indices]]) -> tuple[FloatArray, Indices]:
    """All parts as one, vertices at the same place merged, as collision wants it."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in solid[:-1])])
    every = np.vstack([vertices for vertices, _ in solid])
    triangles = np.vstack([part + start for (_, part), start in zip(solid, starts, strict=True)])
    used, triangles = np.unique(triangles, return_inverse=True)
    vertices, places = np.unique(every[used], axis=0, return_inverse=True)
    merged = places.reshape(-1)[triangles.reshape(-1, 3)]
    vertices.flags.writeable = merged.flags.writeable = False
    return vertices, merged
