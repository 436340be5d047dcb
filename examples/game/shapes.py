"""Small parts that models are put together from by code: boxes, rods, balls, and what a lathe makes.

Each is an `osgode.Drawable` in the axes of the thing that it is a part of; a geom shows several in place of its
collision shape: ``Box(size, shown=[block(...), rod(...)])``.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

import osgode as oo

FACETS = 28
"""Corners of a full circle that a lathe turns."""


def placed(drawable: oo.Drawable, position: oo.Vec3Like, rotation: oo.QuatLike = (1.0, 0.0, 0.0, 0.0)) -> oo.Drawable:
    """The same thing somewhere else.

    Args:
        drawable: what is to be moved.
        position: where its origin shall be, metres.
        rotation: how it shall be turned.
    """
    matrix = oo.Pose(oo.Vec3(*position), oo.Quat(*rotation)).matrix()
    own = np.eye(4) if drawable.matrix is None else drawable.matrix
    return oo.Drawable(drawable.mesh, drawable.appearance, matrix @ own)


def block(
    size: oo.Vec3Like, at: oo.Vec3Like, look: oo.Appearance, turned: oo.QuatLike = (1.0, 0.0, 0.0, 0.0)
) -> oo.Drawable:
    """A box of that size (metres) about a point."""
    return placed(oo.box_drawable(oo.Vec3(*size), look), at, turned)


def ball(radius: float, at: oo.Vec3Like, look: oo.Appearance) -> oo.Drawable:
    """A sphere about a point."""
    return placed(oo.sphere_drawable(radius, look), at)


def rod(radius: float, start: oo.Vec3Like, end: oo.Vec3Like, look: oo.Appearance) -> oo.Drawable:
    """A cylinder from one point to another."""
    first, last = oo.Vec3(*start), oo.Vec3(*end)
    turned = oo.Quat.between((0.0, 0.0, 1.0), last - first)
    return placed(oo.cylinder_drawable(radius, first.distance(last), look), (first + last) / 2, turned)


def lathed(profile: Sequence[tuple[float, float]], look: oo.Appearance, facets: int = FACETS) -> oo.Drawable:
    """What a lathe makes: a profile that goes round the z axis, with sharp edges between its sections.

    Args:
        profile: points (distance from the axis, z) in metres, from the highest z to the lowest where the outside is
            seen; going back inside makes a bore.
        look: its appearance.
        facets: corners of a full circle.
    """
    angles = np.arange(facets + 1) * (math.tau / facets)
    round_it = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    vertices, normals, uvs, triangles = [], [], [], []
    for k, ((r0, z0), (r1, z1)) in enumerate(itertools.pairwise(profile)):
        slope = np.array([z0 - z1, r1 - r0])
        slope /= max(float(np.hypot(*slope)), 1e-9)
        for row, (r, z) in enumerate(((r0, z0), (r1, z1))):
            vertices.append(np.column_stack([round_it * r, np.full(facets + 1, z)]))
            normals.append(np.column_stack([round_it * slope[0], np.full(facets + 1, slope[1])]))
            uvs.append(np.column_stack([angles / math.tau, np.full(facets + 1, row)]))
        first = 2 * k * (facets + 1) + np.arange(facets)
        second = first + facets + 1
        triangles.append(np.column_stack([first, second, first + 1]))
        triangles.append(np.column_stack([first + 1, second, second + 1]))
    mesh = oo.Mesh(
        np.concatenate(vertices), np.concatenate(triangles), np.concatenate(normals), np.concatenate(uvs), "turned"
    )
    return oo.Drawable(mesh, look)


def plate(outline: Sequence[tuple[float, float]], thickness: float, look: oo.Appearance) -> oo.Drawable:
    """A flat plate in the yz plane, as thick along x as told: fins, blades.

    Args:
        outline: its corners (y, z) in metres, convex, in either sense.
        thickness: metres.
        look: its appearance.
    """
    corners = np.array(outline, dtype=float)
    y, z = corners.T
    if np.sum(y * np.roll(z, -1) - np.roll(y, -1) * z) < 0:
        corners = corners[::-1]
    count, half = len(corners), thickness / 2
    fan = np.array([(0, k, k + 1) for k in range(1, count - 1)])
    front = np.column_stack([np.full(count, half), corners])
    vertices, normals, triangles = [front, front * (-1, 1, 1)], [np.tile((1.0, 0.0, 0.0), (count, 1))], [fan]
    normals.append(-normals[0])
    triangles.append(fan[:, ::-1] + count)
    for k in range(count):
        a, b = corners[k], corners[(k + 1) % count]
        out = np.array([0.0, b[1] - a[1], a[0] - b[0]])
        triangles.append(np.array([(0, 1, 2), (0, 2, 3)]) + 2 * count + 4 * k)
        vertices.append(np.array([(half, *b), (half, *a), (-half, *a), (-half, *b)]))
        normals.append(np.tile(out / np.linalg.norm(out), (4, 1)))
    mesh = oo.Mesh(np.concatenate(vertices), np.concatenate(triangles), np.concatenate(normals), name="plate")
    return oo.Drawable(mesh, look)
