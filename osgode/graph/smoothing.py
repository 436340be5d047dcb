"""Normals for meshes that come without: smooth over gentle bends, sharp at edges."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from osgode.maths import FloatArray

CREASE_ANGLE = math.radians(35.0)
"""Faces that meet at a greater angle (radians) meet in a visible edge."""

Indices = npt.NDArray[np.int64]


def creased(
    vertices: FloatArray, triangles: Indices, uvs: FloatArray | None = None, crease_angle: float = CREASE_ANGLE
) -> tuple[FloatArray, Indices, FloatArray, FloatArray | None]:
    """The same triangles with a normal per vertex; vertices are doubled where normals differ and merged where not.

    At each corner of a triangle the normal is the mean of the triangles that have a corner at the same place and
    whose plane is turned by less than ``crease_angle``. Each counts by its angle there, so that it makes no
    difference how a flat face was cut into triangles (G. Thürmer and C. Wüthrich, "Computing Vertex Normals from
    Polygonal Facets", 1998). Vertices at the same place are taken for one, whatever their texture coordinates; those
    stay as they are, and where they differ so do the vertices that come out.

    Args:
        vertices: (n, 3).
        triangles: (m, 3), none of them without area.
        uvs: (n, 2) or None.
        crease_angle: radians.

    Returns:
        Vertices (k, 3), triangles (m, 3) in the same order, normals (k, 3), and texture coordinates (k, 2) or None.
    """
    corners = triangles.ravel()
    at = vertices[triangles]
    ahead, behind = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    areas = np.cross(ahead, behind)  # for each corner; those of one triangle are equal
    doubled = np.linalg.norm(areas, axis=2)
    angles = np.arctan2(doubled, np.einsum("mki,mki->mk", ahead, behind)).ravel()
    units = np.repeat(areas[:, 0] / doubled[:, :1], 3, axis=0)
    normals = _corner_sums(_equal_rows(vertices)[corners], units, angles, math.cos(crease_angle))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)

    # Corners that agree in everything become one vertex; sums in another order differ in the last digits.
    vertex = _equal_rows(vertices if uvs is None else np.hstack([vertices, uvs]))[corners]
    keys = np.column_stack([vertex, np.round(normals * 1e4).astype(np.int64)])
    _, chosen, new = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    old = corners[chosen]
    return vertices[old], new.reshape(-1, 3), normals[chosen], None if uvs is None else uvs[old]


def _equal_rows(table: FloatArray) -> Indices:
    """A number per row, equal for equal rows."""
    _, numbers = np.unique(table, axis=0, return_inverse=True)
    return numbers.reshape(-1)


def _corner_sums(places: Indices, units: FloatArray, weights: FloatArray, least_cosine: float) -> FloatArray:
    """For each corner the weighted sum of the normals at its place that are near enough to its own."""
    order = np.argsort(places, kind="stable")
    units, weights = units[order], weights[order]
    starts = np.flatnonzero(np.diff(places[order], prepend=-1))
    sizes = np.diff(starts, append=len(order))
    start, size = np.repeat(starts, sizes), np.repeat(sizes, sizes)
    own = np.arange(len(order))
    weighted = units * weights[:, None]
    sums = weighted.copy()
    # Each corner meets the others of its place one after the other: at turn k the k-th after it, cyclically.
    for k in range(1, int(sizes.max(initial=0))):
        here = own[size > k]
        other = start[here] + (here - start[here] + k) % size[here]
        near = np.einsum("ni,ni->n", units[here], units[other]) >= least_cosine
        sums[here[near]] += weighted[other[near]]  # each corner is in ``here`` once, so nothing is lost
    result = np.empty_like(sums)
    result[order] = sums
    return result
