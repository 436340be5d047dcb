"""Whether the back faces of a draw can be left out, because nobody could see them.

Drawing front faces only nearly halves the work. But terrain, sheets and many models are open surfaces, seen
from both sides, so it is done only where it can't be noticed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

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


def spheres(meshes: Sequence[Mesh], counts: Sequence[int], matrices: Float32Array) -> tuple[FloatArray, FloatArray]:
    """The bounding spheres of instances: (n, 3) centres and (n,) radii in the world.

    ``counts`` says how many of ``matrices`` belong to each mesh.
    """
    centres = np.repeat([(*mesh.centre, 1.0) for mesh in meshes], counts, axis=0)
    radii = np.repeat([mesh.radius for mesh in meshes], counts)
    stretch = np.sqrt((matrices[:, :3, :3].astype(np.float64) ** 2).sum(axis=1).max(axis=1))
    return np.einsum("nij,nj->ni", matrices[:, :3], centres), radii * stretch


def mirrored(matrices: Float32Array) -> npt.NDArray[np.bool_]:
    """Which of (n, 4, 4) matrices turn a right hand into a left one, and so the outside in."""
    return np.asarray(np.linalg.det(matrices[:, :3, :3]) < 0)


def plain(bins: Sequence[Bin], eye: Sequence[float], near: float) -> list[bool]:
    """For each bin whether no instance is mirrored and none may hold the eye or be cut open by the near plane."""
    if not bins:
        return []
    counts = [len(one.matrices) for one in bins]
    owners = np.repeat(np.arange(len(bins)), counts)
    matrices = np.concatenate([one.matrices for one in bins])
    centres, radii = spheres([one.mesh for one in bins], counts, matrices)
    # The corners of the near plane are farther away than its middle; thrice is enough for any usual lens.
    margin = 3.0 * near
    close = np.flatnonzero(((centres - eye) ** 2).sum(axis=1) < (radii + margin) ** 2)
    odd = set(owners[mirrored(matrices)].tolist())
    odd.update(owners[k] for k in close.tolist() if _in_box(bins[owners[k]].mesh, matrices[k], eye, margin))
    return [number not in odd for number in range(len(bins))]


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
