"""Draws a Frame with OpenGL 3.3, onto whatever framebuffer it is given."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from osgode.errors import FieldError
from osgode.graph.appearance import Appearance
from osgode.graph.frame import MAX_LIGHTS, Bin, Frame, Light
from osgode.maths import FloatArray
from osgode.render import shaders
from osgode.render.culling import near_to_far, plain
from osgode.render.lines import LineDrawer
from osgode.render.overlay import Overlay
from osgode.render.resources import SHADOW_UNIT, TEXTURE_UNIT, FrameBlock, InstanceBuffer, Resources, is_software
from osgode.render.shadows import Cascade, ShadowMap, light_axes, select
from osgode.render.sprites import SpriteDrawer

if TYPE_CHECKING:
    import moderngl

POLISHED = 0.5
"""Above this shininess a surface mirrors the sky."""
HAZE_AT_DISTANCE = 3.0**0.5
"""At the haze's distance, exp(-3) = 5 % of a thing's own colour is left."""


@dataclass(frozen=True)
class Quality:
    """What a picture may cost.

    Args:
        samples: per pixel, to smooth edges; 0 or 1 for none. As many as the driver offers are used.
        shadow_size: edge of each of the two shadow maps, texels.
        shadow_distances: how far from the eye the fine and the coarse shadow map reach, metres.
        anisotropy: samples along the slope of a texture seen at a shallow angle. Not used on a software rasteriser,
            where it would cost seconds.

    On a software rasteriser four samples and maps of 2048 texels cost twice as much as none and 1024, which are chosen
    there if nobody says otherwise.
    """

    samples: int = 4
    shadow_size: int = 2048
    shadow_distances: tuple[float, float] = (14.0, 90.0)
    anisotropy: float = 8.0

    def __post_init__(self) -> None:
        near, far = self.shadow_distances
        if self.samples < 0 or self.shadow_size < 1 or not 0 < near < far:
            raise FieldError(f"{self}: samples, shadow_size and shadow_distances must be positive, the latter growing")


FULL, QUICK = Quality(), Quality(samples=0, shadow_size=1024)
"""What is chosen on a graphics card and on a software rasteriser."""


def quality_of(context: moderngl.Context, wanted: Quality | None) -> Quality:
    """``wanted``, or if that is None what suits who draws."""
    if wanted is not None:
        return wanted
    return QUICK if is_software(context) else FULL


@dataclass(frozen=True)
class Counts:
    """What the last picture took: draw calls, instances drawn in them, and what is on the graphics card."""

    draws: int = 0
    instances: int = 0
    meshes: int = 0
    textures: int = 0


def linear(colour: tuple[float, ...]) -> tuple[float, ...]:
    """An sRGB colour (0 to 1) as amounts of light; a fourth component, opacity, stays as it is."""
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour[:3]) + tuple(colour[3:])


def _has_holes(appearance: Appearance) -> bool:
    return appearance.texture is not None and appearance.texture.image.shape[2] == 4


class GLRenderer:
    """The drawing itself, shared by the window and the offscreen drawer.

    Args:
        context: an OpenGL context of version 3.3 or later, which is current, and which this takes over.
        quality: what a picture may cost; None: as suits who draws.
    """

    def __init__(self, context: moderngl.Context, quality: Quality | None) -> None:
        self.quality = quality = quality_of(context, quality)
        # Dropped objects are put aside and released at the next frame, see Resources.
        context.gc_mode = "context_gc"
        self._context = context
        self._resources = Resources(context, quality.anisotropy)
        self._frame = FrameBlock(context)
        self._instances = InstanceBuffer(context)
        self._shadow_map = ShadowMap(context, self._resources, quality.shadow_size, quality.shadow_distances)
        self._sky_program = self._resources.program(shaders.SKY_VERTEX, shaders.SKY_FRAGMENT)
        self._sky = context.vertex_array(self._sky_program, [])
        self._lines = LineDrawer(context, self._resources)
        self._overlay = Overlay(context, self._resources)
        self._sprites = SpriteDrawer(context, self._resources)
        self._lamps: list[str] = []
        """What surfaces must do for the lights of the frame, as features of their shader."""
        self.counts = Counts()

    def draw(self, frame: Frame, target: moderngl.Framebuffer, size: tuple[int, int]) -> None:
        """Draw ``frame`` onto ``target``, which has ``size`` pixels; the context must be current.

        The overlay, which is laid out for ``frame.size``, is stretched if the target has another size.
        """
        context = self._context
        self._resources.collect()
        aspect = size[0] / size[1]
        axes = light_axes(frame.sun.direction)
        cascades = self._shadow_map.fit(frame.view, aspect, axes)
        selected = select(frame.casters if frame.sun.shadows else [], axes, cascades, self._shadow_map.size)
        self._write_frame(frame, aspect, axes, cascades)

        bins = [*frame.opaque, *frame.transparent, *frame.front]
        blocks = [one.matrices for one in bins] + [matrices for matrices, _ in selected]
        firsts = self._instances.write(blocks)
        starts = firsts[len(bins) :]

        draws = 0
        shadowed = any(runs for _, runs in selected)
        if shadowed:
            runs = [(start, runs) for start, (_, runs) in zip(starts, selected, strict=True)]
            draws += self._shadow_map.draw(self._instances, cascades, runs)
            self._shadow_map.texture.use(SHADOW_UNIT)

        target.use()
        target.viewport = (0, 0, *size)
        target.depth_mask = True
        # Colours needn't be cleared for the picture's sake, the sky covers what nothing else does.
        target.clear(depth=1.0)
        context.enable_only(context.DEPTH_TEST)
        context.depth_func = "<="
        draws += self._draw_opaque(frame, firsts, shadowed)
        context.disable(context.CULL_FACE)
        self._sky.render(vertices=3)
        draws += 1 + self._draw_transparent(frame.transparent, firsts[len(frame.opaque) :], shadowed, target)
        draws += self._sprites.draw(frame.particles, target)
        draws += self._draw_lines(frame, size, target, in_front=False)
        draws += self._draw_front(frame.front, firsts[len(frame.opaque) + len(frame.transparent) :], target)
        draws += self._draw_lines(frame, size, target, in_front=True)
        draws += self._overlay.draw(frame.overlay, frame.size)
        self.counts = Counts(draws, sum(map(len, blocks)), self._resources.mesh_count, self._resources.texture_count)

    def _write_frame(self, frame: Frame, aspect: float, axes: FloatArray, cascades: Sequence[Cascade]) -> None:
        projection, view = frame.view.projection_matrix(aspect), frame.view.view_matrix()
        haze = HAZE_AT_DISTANCE / frame.sky.haze if frame.sky.haze else 0.0
        self._frame.write(
            view_projection=(projection @ view).T,  # OpenGL reads matrices by columns
            eye=(*frame.view.pose.position, haze),
            to_sun=(*-frame.sun.direction.normalized(), self._shadow_map.size),
            sun=frame.sun.colour,
            ambient=frame.sun.ambient,
            horizon=linear(frame.sky.horizon),
            zenith=linear(frame.sky.zenith),
            light_axes=axes,
            cascades=[cascade.uniform() for cascade in cascades],
            # From a corner of the picture (x, y, 1) to the direction seen there.
            corner_to_world=view[:3, :3].T @ np.diag([1 / projection[0, 0], 1 / projection[1, 1], -1.0]),
            **self._light_rows(frame.lights[:MAX_LIGHTS]),
        )

    def _light_rows(self, lights: Sequence[Light]) -> dict[str, FloatArray]:
        """The field of the lights, if there are any; dark ones fill up to a power of two, so that shaders are few."""
        if not lights:
            self._lamps = []
            return {}
        count = 1 << (len(lights) - 1).bit_length()
        self._lamps = [f"LIGHTS {count}"]
        rows = np.zeros((3 * MAX_LIGHTS, 4))
        for k, light in enumerate(lights):
            rows[3 * k] = (*light.position, light.reach**-2)
            rows[3 * k + 1, :3], rows[3 * k + 2] = light.colour, (0.0, 0.0, 0.0, 1.0)
            if light.direction is not None:
                # 0 at the outer angle, 1 at the inner one, straight over the cosine.
                steepness = 1.0 / max(math.cos(light.inner) - math.cos(light.outer), 1e-6)
                rows[3 * k + 1, 3] = steepness
                rows[3 * k + 2] = (*light.direction, -math.cos(light.outer) * steepness)
        return {"lights": rows}

    def _draw_opaque(self, frame: Frame, firsts: list[int], shadowed: bool) -> int:
        view = frame.view
        outside = plain(frame.opaque, view.pose.position, view.near)
        for number in near_to_far(frame.opaque, view.pose.position):
            one, first, seen_from_outside = frame.opaque[number], firsts[number], outside[number]
            program = self._set_appearance(one.appearance, shadowed, cutout=True)
            mesh = self._resources.mesh(one.mesh)
            # A texture may have holes, through which the back is seen.
            closed = mesh.solid and seen_from_outside and not _has_holes(one.appearance)
            mesh.draw(program, self._instances, first, len(one.matrices), "front" if closed else "both")
        return len(frame.opaque)

    def _draw_transparent(
        self, bins: list[Bin], firsts: list[int], shadowed: bool, target: moderngl.Framebuffer
    ) -> int:
        context = self._context
        context.enable(context.BLEND)
        context.blend_func = context.SRC_ALPHA, context.ONE_MINUS_SRC_ALPHA
        target.depth_mask = False
        for one, first in zip(bins, firsts, strict=False):
            program = self._set_appearance(one.appearance, shadowed, cutout=False)
            mesh = self._resources.mesh(one.mesh)
            # The far side of a thing is seen through its near side, so it comes first.
            for faces in ("back", "front"):
                mesh.draw(program, self._instances, first, len(one.matrices), faces)
        target.depth_mask = True
        return 2 * len(bins)

    def _draw_front(self, bins: list[Bin], firsts: list[int], target: moderngl.Framebuffer) -> int:
        if not bins:
            return 0
        target.color_mask = (False, False, False, False)
        target.clear(depth=1.0)
        target.color_mask = (True, True, True, True)
        target.use()  # a mask counts from then on
        for one, first in zip(bins, firsts, strict=False):
            program = self._set_appearance(one.appearance, shadowed=False, cutout=True)
            self._resources.mesh(one.mesh).draw(program, self._instances, first, len(one.matrices), "both")
        return len(bins)

    def _draw_lines(self, frame: Frame, size: tuple[int, int], target: moderngl.Framebuffer, *, in_front: bool) -> int:
        several = [lines for lines in frame.lines if lines.in_front == in_front]
        if not several:
            return 0
        context = self._context
        context.enable_only(context.BLEND if in_front else context.BLEND | context.DEPTH_TEST)
        context.blend_func = context.SRC_ALPHA, context.ONE_MINUS_SRC_ALPHA
        target.depth_mask = False
        draws = self._lines.draw(several, size, frame.view)
        target.depth_mask = True
        return draws

    def _set_appearance(self, appearance: Appearance, shadowed: bool, *, cutout: bool) -> moderngl.Program:
        texture, features = appearance.texture, []
        if texture is not None:
            features.append("TEXTURED")
            # Holes in a texture (leaves, a fence) are cut out of opaque things, which aren't sorted for blending.
            if cutout and _has_holes(appearance):
                features.append("CUTOUT")
            self._resources.texture(texture).use(TEXTURE_UNIT)
        if not appearance.unlit:
            features += ["LIT", "SHADOWED"] if shadowed else ["LIT"]
            features += self._lamps
            if appearance.shininess > POLISHED:
                features.append("POLISHED")
        program = self._resources.surface(*features)
        program["u_colour"] = linear(appearance.colour)
        if not appearance.unlit:
            program["u_shininess"] = appearance.shininess
        return program
