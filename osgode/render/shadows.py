"""Shadows of the sun: two square maps side by side, a fine one near the eye and a coarse one behind it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from osgode.graph.frame import Bin, View
from osgode.graph.mesh import Mesh
from osgode.maths import Float32Array, FloatArray, Vec3
from osgode.render import shaders
from osgode.render.culling import mirrored, spheres
from osgode.render.resources import InstanceBuffer, Resources

if TYPE_CHECKING:
    import moderngl

DEPTH_CLAMP = 0x864F
CASCADES = 2


class Cascade(NamedTuple):
    """The cube of space that one map shows: its centre in light axes, and half its edge, metres."""

    centre: tuple[float, float, float]
    radius: float

    def uniform(self) -> tuple[float, float, float, float]:
        """The centre and the factor from metres to -1..1, as the shaders take it."""
        return (*self.centre, 1.0 / self.radius)


class Run(NamedTuple):
    """One draw of a cascade: some instances of one mesh, counted from the cascade's first."""

    mesh: Mesh
    first: int
    instances: int
    mirrored: bool


def light_axes(direction: Vec3) -> FloatArray:
    """The 3x3 matrix ``v_light = matrix @ v_world`` whose third axis points at the sun.

    It depends on the direction alone, so the maps don't turn with the camera.
    """
    back = -direction.normalized()
    helper = Vec3(0.0, 1.0, 0.0) if abs(back.y) < 0.99 else Vec3(1.0, 0.0, 0.0)
    side = helper.cross(back).normalized()
    return np.array([side, back.cross(side), back])


def fit(view: View, aspect: float, axes: FloatArray, distance: float, texels: int) -> Cascade:
    """The cube around what ``view`` sees up to ``distance`` metres.

    It holds a sphere about that part of the view, so its size doesn't change when the camera turns, and
    it moves by whole texels, so the edges of shadows don't crawl when the camera moves.
    """
    spread = math.tan(view.field_of_view / 2) * math.hypot(1.0, aspect)
    ahead = min(distance, distance * (1.0 + spread * spread) / 2)
    radius = max(ahead, math.hypot(distance - ahead, spread * distance))
    eye, rotation = view.pose
    middle = axes @ np.array(eye + rotation.rotate((0.0, 0.0, -ahead)))
    texel = 2.0 * radius / texels
    x, y, z = (np.round(middle / texel) * texel).tolist()
    return Cascade((x, y, z), radius)


def select(
    casters: Sequence[Bin], axes: FloatArray, cascades: Sequence[Cascade], texels: int
) -> list[tuple[Float32Array, list[Run]]]:
    """For each cascade the matrices of the instances that may throw a shadow into it, and how to draw them.

    Instances of the same mesh are drawn together, whatever they look like, and by a simpler mesh if that can't be told
    in a map with ``texels`` along its edge.
    """
    groups: dict[Mesh, list[Bin]] = {}
    for caster in casters:
        if len(caster.matrices):
            groups.setdefault(caster.mesh, []).append(caster)
    if not groups:
        return [(np.zeros((0, 4, 4), np.float32), []) for _ in cascades]
    bins = [one for same in groups.values() for one in same]
    matrices, around = np.concatenate([one.matrices for one in bins]), spheres(bins)
    counts = [sum(len(one.matrices) for one in same) for same in groups.values()]
    borders = np.cumsum([0, *counts])
    places, radii = around[:, :3] @ axes.T, around[:, 3]
    turned = [any(map(mirrored, same)) for same in groups.values()]
    scales = [
        max(float(radii[first:end].max()) / mesh.radius, 1e-30) if mesh.simpler else 1.0
        for mesh, (first, end) in zip(groups, pairwise(borders.tolist()), strict=True)
    ]

    result = []
    for cascade in cascades:
        away = places - cascade.centre
        reach = cascade.radius + radii
        # Nothing is too near the sun to throw a shadow.
        inside = (np.abs(away[:, 0]) <= reach) & (np.abs(away[:, 1]) <= reach) & (away[:, 2] >= -reach)
        chosen = np.flatnonzero(inside)
        ends = np.searchsorted(chosen, borders).tolist()
        texel = 2.0 * cascade.radius / texels
        runs = [
            Run(_simplest(mesh, texel / scale), first, end - first, odd)
            for mesh, (first, end), odd, scale in zip(groups, pairwise(ends), turned, scales, strict=True)
            if first < end
        ]
        result.append((matrices.take(chosen, axis=0), runs))
    return result


def _simplest(mesh: Mesh, allowed: float) -> Mesh:
    """The mesh with the fewest triangles whose outline is off by ``allowed`` metres at most."""
    return next((simpler for simpler, off in mesh.simpler if off <= allowed), mesh)


class ShadowMap:
    """The depths seen from the sun, for the cascades of one frame.

    Args:
        size: edge of each map in texels.
        distances: how far from the eye the fine and the coarse map reach, metres.
    """

    def __init__(
        self, context: moderngl.Context, resources: Resources, size: int, distances: tuple[float, float]
    ) -> None:
        self._context = context
        self._resources = resources
        self._program = resources.program(shaders.SHADOW_VERTEX, shaders.SHADOW_FRAGMENT)
        self.size = size
        self._distances = distances
        self.texture = context.depth_texture((CASCADES * size, size))
        self.texture.compare_func = "<="
        self.texture.filter = (context.LINEAR, context.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._target = context.framebuffer(depth_attachment=self.texture)

    def fit(self, view: View, aspect: float, axes: FloatArray) -> list[Cascade]:
        """The cascades for a view."""
        return [fit(view, aspect, axes, distance, self.size) for distance in self._distances]

    def draw(
        self, instances: InstanceBuffer, cascades: Sequence[Cascade], runs: Sequence[tuple[int, list[Run]]]
    ) -> int:
        """Draw the maps; ``runs`` gives per cascade its first instance and its draws. Returns the draws made."""
        context, target = self._context, self._target
        context.enable_only(context.DEPTH_TEST)
        # Casters before the cube, towards the sun, are flattened onto its face instead of cut off.
        context.enable_direct(DEPTH_CLAMP)
        target.use()
        target.viewport = (0, 0, CASCADES * self.size, self.size)
        target.clear(depth=1.0)
        draws = 0
        for number, (cascade, (start, wanted)) in enumerate(zip(cascades, runs, strict=True)):
            target.viewport = (number * self.size, 0, self.size, self.size)
            self._program["u_cascade"] = cascade.uniform()
            for run in wanted:
                mesh = self._resources.mesh(run.mesh)
                faces = "front" if mesh.solid and not run.mirrored else "both"
                if run.mesh.solid_behind and not run.mirrored:
                    faces = "back"  # nothing to do where the sun is before it, though it fills the whole map
                mesh.draw(self._program, instances, start + run.first, run.instances, faces)
            draws += len(wanted)
        context.disable_direct(DEPTH_CLAMP)
        return draws
