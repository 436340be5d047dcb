"""Whether the back faces of a draw can be left out, because nobody could see them.

Drawing front faces only nearly halves the work. But terrain, sheets and many models are open surfaces, seen
from both sides, so it is done only where it can't be noticed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from osgode.graph.draw_list import largest_scales
from osgode.graph.frame import Bin
from osgode.graph.mesh import Mesh
from osgode.maths import Float32Array, FloatArray


def encloses(mesh: Mesh) -> bool:
    """Whether the triangles of ``mesh`` bound a solid, without a gap and facing outwards."""
    # Vertices at one place are one corner, though they differ in normal, texture coordinate or rounding.
    places = np.round((mesh.vertices - np.array(mesh.centre, np.float32)) * (1e5 / max(mesh.radius, 1e-30)))
    corners, names = np.unique(places, axis=0, return_inverse=True)
    triangles = names.reshape(-1)[mesh.triangles].astype(np.int64)
    a, b, c = triangles.T
    real = (a != b) & (b != c) & (c != a)  # at the poles of a sphere some are lines
    a, b, c = a[real], b[real], c[real]
    starts, ends = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    edges = np.sort(starts * len(corners) + ends)
    back = np.sort(ends * len(corners) + starts)
    if not len(edges) or (edges[1:] == edges[:-1]).any() or (edges != back).any():
        return False
    p, q, r = corners[a], corners[b], corners[c]
    volume = np.einsum("ij,ij->", p, np.cross(q, r))
    return bool(volume > 0)


def spheres(bins: Sequence[Bin]) -> FloatArray:
    """The bounding spheres of all instances, one bin after another: (n, 4), centres and radii in the world."""
    return np.concatenate([_spheres(one) if one.spheres is None else one.spheres for one in bins])


def _spheres(one: Bin) -> FloatArray:
    linear = one.matrices[:, :3, :3].astype(np.float64)
    result = np.empty((len(linear), 4))
    result[:, :3] = linear @ np.array(one.mesh.centre) + one.matrices[:, :3, 3]
    result[:, 3] = one.mesh.radius * largest_scales(linear)
    return result


def mirrored(one: Bin) -> bool:
    """Whether some instance's matrix turns a right hand into a left one, and so the outside in."""
    if one.mirrored is None:
        return bool((np.linalg.det(one.matrices[:, :3, :3]) < 0).any())
    return one.mirrored


def plain(bins: Sequence[Bin], eye: Sequence[float], near: float) -> list[bool]:
    """For each bin whether no instance is mirrored and none may hold the eye or be cut open by the near plane."""
    if not bins:
        return []
    around = spheres(bins)
    # The corners of the near plane are farther away than its middle; thrice is enough for any usual lens.
    margin = 3.0 * near
    offsets, reach = around[:, :3] - eye, around[:, 3] + margin
    close = np.flatnonzero(np.einsum("ni,ni->n", offsets, offsets) < reach * reach)
    odd = {number for number, one in enumerate(bins) if mirrored(one)}
    ends = np.cumsum([len(one.matrices) for one in bins])
    for k, number in zip(close.tolist(), np.searchsorted(ends, close, side="right").tolist(), strict=True):
        one = bins[number]
        if _in_box(one.mesh, one.matrices[k - int(ends[number])], eye, margin):
            odd.add(number)
    return [number not in odd for number in range(len(bins))]


def near_to_far(bins: Sequence[Bin], eye: Sequence[float]) -> list[int]:
    """The numbers of the bins in the order in which they hide each other best: by how far each reaches from the eye.

    So the ground and the walls come last, of which then only what is seen has to be shaded.
    """
    if not bins:
        return []
    around = spheres(bins)
    offsets = around[:, :3] - eye
    reach = np.sqrt(np.einsum("ni,ni->n", offsets, offsets)) + around[:, 3]
    starts = np.cumsum([0, *(len(one.matrices) for one in bins[:-1])])
    order: list[int] = np.argsort(np.maximum.reduceat(reach, starts), kind="stable").tolist()
    return order


def _in_box(mesh: Mesh, matrix: Float32Array, point: Sequence[float], margin: float) -> bool:
    """Whether ``point`` is inside the transformed bounding box of ``mesh``, or less than ``margin`` from it."""
    try:
        inverse = np.linalg.inv(matrix.astype(np.float64))
    except np.linalg.LinAlgError:  # squeezed flat: it has no inside, and no outside either
        return True
    low, high = mesh.bounds
    place = inverse[:3, :3] @ point + inverse[:3, 3]
    # What a step of ``margin`` in the world can come to along each axis of the mesh.
    reach = margin * np.sqrt((inverse[:3, :3] ** 2).sum(axis=1))
    return bool(((place > low - reach) & (place < high + reach)).all())
