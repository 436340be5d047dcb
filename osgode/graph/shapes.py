"""Drawables of the shapes that things collide with, in the axes of ODE's geoms.

Boxes, spheres and cylinders of every size share one mesh and differ in their matrix, so that a renderer draws them
together. Only a texture that repeats by the metre needs a mesh of its own per size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from osgode.errors import FieldError
from osgode.graph.appearance import DEFAULT_APPEARANCE, Appearance, Texture
from osgode.graph.drawable import Drawable
from osgode.graph.mesh import Mesh
from osgode.graph.primitives import (
    TextureScale,
    box_mesh,
    capsule_mesh,
    cylinder_mesh,
    rectangle_mesh,
    sphere_mesh,
)
from osgode.maths import FloatArray, Pose, Quat, Vec3, finite

PLANE_EXTENT = 2000.0
"""Edge in metres of the square that stands for an endless plane: past the far plane of a usual camera."""


def box_drawable(size: Sequence[float], appearance: Appearance = DEFAULT_APPEARANCE) -> Drawable:
    """A box centred on the origin.

    Args:
        size: edges along X, Y, Z, metres.
        appearance: how it looks.

    Raises:
        FieldError: if an edge is not above 0 and finite.
    """
    x, y, z = _sizes("box size", *size)
    repeat = _repeat(appearance)
    if repeat is None:
        return Drawable(box_mesh(), appearance, _scaling(x, y, z))
    return Drawable(box_mesh((x, y, z), repeat), appearance)


def sphere_drawable(radius: float, appearance: Appearance = DEFAULT_APPEARANCE) -> Drawable:
    """A sphere about the origin, ``radius`` in metres, its texture's poles on the Y axis.

    Raises:
        FieldError: if the radius is not above 0 and finite.
    """
    (r,) = _sizes("sphere radius", radius)
    repeat = _repeat(appearance)
    if repeat is None:
        return Drawable(sphere_mesh(), appearance, _scaling(r, r, r))
    return Drawable(sphere_mesh(r, repeat), appearance)


def cylinder_drawable(radius: float, length: float, appearance: Appearance = DEFAULT_APPEARANCE) -> Drawable:
    """A cylinder along Z centred on the origin, ``radius`` and ``length`` in metres.

    Raises:
        FieldError: if the radius or the length is not above 0 and finite.
    """
    r, along = _sizes("cylinder radius and length", radius, length)
    repeat = _repeat(appearance)
    if repeat is None:
        return Drawable(cylinder_mesh(), appearance, _scaling(r, r, along))
    return Drawable(cylinder_mesh(r, along, repeat), appearance)


def capsule_drawable(radius: float, length: float, appearance: Appearance = DEFAULT_APPEARANCE) -> Drawable:
    """A capsule along Z centred on the origin.

    Args:
        radius: of the caps and of the cylindrical part, metres.
        length: of the cylindrical part alone, metres; the whole is ``length + 2 * radius`` long.
        appearance: how it looks.

    Raises:
        FieldError: if the radius is not above 0, the length is below 0, or one is not finite.
    """
    (r,) = _sizes("capsule radius", radius)
    if not (math.isfinite(length) and length >= 0):
        raise FieldError(f"capsule length is {length!r}; it must be finite and not below 0")
    return Drawable(capsule_mesh(r, float(length), _repeat(appearance)), appearance)


def centre_of_mass_drawable(radius: float = 0.1) -> Drawable:
    """The mark of a centre of mass, as on crash test dummies: a ball about the origin, quartered in black and yellow.

    Args:
        radius: metres.

    Raises:
        FieldError: if the radius is not above 0 and finite.
    """
    return sphere_drawable(radius, _mark())


def ray_drawable(length: float, appearance: Appearance = DEFAULT_APPEARANCE, *, radius: float = 0.01) -> Drawable:
    """A ray from the origin along +Z, as a rod ``length`` metres long and ``radius`` metres thick.

    Raises:
        FieldError: if the length or the radius is not above 0 and finite.
    """
    r, along = _sizes("ray radius and length", radius, length)
    matrix = _scaling(r, r, along)
    matrix[2, 3] = along / 2
    return Drawable(cylinder_mesh(), appearance, matrix)


def plane_drawable(
    normal: Sequence[float],
    distance: float,
    appearance: Appearance = DEFAULT_APPEARANCE,
    *,
    extent: float = PLANE_EXTENT,
    solid_behind: bool = False,
) -> Drawable:
    """The points ``p`` with ``p . normal = distance``, as a square seen from the side that the normal points to.

    The square is centred on the plane's point nearest to the origin. The texture repeats every metre, or as
    ``appearance.texture_scale`` says; on level ground u runs along +X and v along -Z.

    Args:
        normal: of any length but 0; ``distance`` counts in that length.
        distance: metres from the origin along a normal of length 1.
        appearance: how it looks.
        extent: edge of the square, metres.
        solid_behind: whether all behind it is solid, as of a `Plane`; then it throws no shadow from its front.

    Raises:
        FieldError: if the normal is 0, the extent is not above 0, or a number is not finite.
    """
    direction = Vec3(*map(float, normal))
    length = direction.length
    if not finite((*direction, length, distance)) or length < 1e-150:
        raise FieldError(f"plane is {tuple(direction)}, {distance!r}; it must be finite, and the normal not 0")
    (edge,) = _sizes("plane extent", extent)
    unit = direction / length
    mesh = rectangle_mesh(edge, edge, appearance.texture_scale or (1.0, 1.0), solid_behind)
    return Drawable(mesh, appearance, Pose(unit * (distance / length), Quat.between((0, 0, 1), unit)).matrix())


def heightfield_drawable(
    heights: FloatArray, width: float, depth: float, appearance: Appearance = DEFAULT_APPEARANCE
) -> Drawable:
    """A terrain over the XZ plane, centred on the origin, with the triangles that a heightfield collides with.

    Args:
        heights: (rows along +Z, columns along +X), metres, at least 2 of each.
        width: along X, metres.
        depth: along Z, metres.
        appearance: how it looks; the texture is stretched once over the whole, or repeats by ``texture_scale``.

    Raises:
        FieldError: if a size is not above 0, there are too few samples, or a number is not finite.
    """
    w, d = _sizes("heightfield width and depth", width, depth)
    y = np.asarray(heights, dtype=np.float64)
    if y.ndim != 2 or min(y.shape) < 2 or not np.isfinite(y).all():
        raise FieldError(f"heightfield heights has shape {y.shape}; it must be at least (2, 2) finite numbers")
    rows, columns = y.shape
    across, along = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    vertices = np.stack([(across - 0.5) * w, y, (along - 0.5) * d], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    b, c = a + 1, a + columns
    # Cells are divided from the next sample along X to the next along Z, as in ODE and in our C core.
    triangles = np.vstack([np.column_stack([a, c, b]), np.column_stack([b, c, c + 1])])
    repeats = (1.0, 1.0) if appearance.texture_scale is None else np.divide((w, d), appearance.texture_scale)
    uvs = np.stack([across, 1 - along], axis=-1).reshape(-1, 2) * repeats
    return Drawable(Mesh(vertices, triangles, uvs=uvs, name="heightfield"), appearance)


@cache
def _mark() -> Appearance:
    """Eight fields that alternate, four round the poles' axis; shared, so that all marks are drawn together."""
    edge = 32
    rows, columns = np.indices((2 * edge, 4 * edge)) // edge
    dark = (rows + columns) % 2 == 0
    image = np.where(dark[..., None], np.array([18, 18, 20], np.uint8), np.array([250, 205, 20], np.uint8))
    return Appearance(texture=Texture(image, "centre of mass"), colour=(1.0, 1.0, 1.0, 1.0), shininess=0.4)


def _repeat(appearance: Appearance) -> TextureScale:
    """The metres of one repeat, or None where they make no difference and the shared mesh will do."""
    return None if appearance.texture is None else appearance.texture_scale


def _scaling(x: float, y: float, z: float) -> FloatArray:
    return np.diag([x, y, z, 1.0])


def _sizes(what: str, *values: float) -> tuple[float, ...]:
    if not finite(values) or min(values) <= 0:
        raise FieldError(f"{what} is {values}; it must be above 0 and finite")
    return tuple(map(float, values))
