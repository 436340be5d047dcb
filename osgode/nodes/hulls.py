"""Convex hulls: which meshes are one, and the hull of points."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError, MissingExtraError, ModelError
from osgode.fields import SIZE_LIMITS
from osgode.mass import is_closed, refuse_complex
from osgode.maths import FloatArray
from osgode.nodes.meshdata import MeshData

FLAT = 2e-6
"""A point this part of the size beyond a face is still on it: models are in single precision."""
MERGED = (1e-9, 1e-7, 1e-5)
"""Points this part of the size apart are one. The larger ones are tried where slivers had to be dropped."""


def extra(module: str) -> Any:
    """A package of the extra ``convex``.

    Raises:
        MissingExtraError: if it is not installed.
    """
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"this needs the package {module.partition('.')[0]!r}: pip install 'osgode[convex]'"
        ) from error


def merged(data: MeshData) -> MeshData:
    """The same triangles, with vertices at the same place made one: models repeat them for texture seams."""
    vertices, places = np.unique(data.vertices, axis=0, return_inverse=True)
    if len(vertices) == len(data.vertices):
        return data
    return MeshData(vertices, places.reshape(-1)[data.triangles], data.name)


def is_convex(data: MeshData) -> bool:
    """Whether it is closed, its triangles counter-clockwise from outside, and no vertex beyond any of them."""
    if not is_closed(data.triangles):
        return False
    a, b, c = np.moveaxis(data.vertices[data.triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    allowed = FLAT * _size(data.vertices)
    faces_at_once = max(1, 4_000_000 // len(data.vertices))
    for start in range(0, len(a), faces_at_once):
        part = slice(start, start + faces_at_once)
        beyond = normals[part] @ data.vertices.T - np.einsum("ij,ij->i", normals[part], a[part])[:, None]
        if float(beyond.max()) > allowed:
            return False
    return _volume(data) > 0.0


def hull_of(points: npt.ArrayLike, label: str, name: str = "") -> MeshData:
    """The convex hull of (n, 3) points, closed, counter-clockwise from outside, without slivers.

    Raises:
        ModelError: beginning with ``label``, if there are fewer than four points, they lie in a plane, or they
            can't be used as numbers.
        MissingExtraError: without scipy.
    """
    table = _points(points, label)
    spatial = extra("scipy.spatial")
    size = _size(table)
    for part in MERGED:
        _, chosen = np.unique(np.round(table / (part * size)), axis=0, return_index=True)
        try:
            hull = spatial.ConvexHull(table[np.sort(chosen)])
            data = _outward(hull, name)
        except (spatial.QhullError, ModelError):
            continue
        if is_closed(data.triangles) and _volume(data) > 1e-12 * size**3:
            return data
    raise ModelError(f"{label}: the {len(table)} points enclose no volume; a hull needs four that are not in one plane")


def _points(points: npt.ArrayLike, label: str) -> FloatArray:
    try:
        refuse_complex(points)
        table = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ModelError(f"{label}: points must be a table of numbers: {error}") from error
    if table.ndim != 2 or table.shape[1] != 3 or len(table) < 4:
        raise ModelError(f"{label}: points has shape {table.shape}; it must be (n, 3) with n at least 4")
    if not np.isfinite(table).all():
        raise ModelError(f"{label}: a point is not finite")
    if float(np.abs(table).max()) > SIZE_LIMITS[1]:
        raise ModelError(f"{label}: a point is farther than {SIZE_LIMITS[1]:g} m from the origin")
    if not _size(table) > SIZE_LIMITS[0]:
        raise ModelError(f"{label}: all points are at the same place")
    return table


def _outward(hull: Any, name: str) -> MeshData:
    """Qhull's triangles point either way; its plane equations point outwards."""
    triangles = hull.simplices.copy()
    a, b, c = np.moveaxis(hull.points[triangles], 1, 0)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return MeshData(hull.points, triangles, name)


def _size(points: FloatArray) -> float:
    return float(np.ptp(points, axis=0).max())


def _volume(data: MeshData) -> float:
    try:
        return data.water.mass / 1000.0
    except FieldError:  # inside out, or nothing at all
        return 0.0
