"""Particles as patches that face the camera, one instanced draw for each emitter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from osgode.graph.frame import Sprites
from osgode.render import shaders
from osgode.render.resources import Resources

if TYPE_CHECKING:
    import moderngl

ROW_BYTES = 48


class SpriteDrawer:
    """Draws the particles of a frame."""

    def __init__(self, context: moderngl.Context, resources: Resources) -> None:
        self._context = context
        self._programs = [resources.program(shaders.SPRITE_VERTEX, fragment) for fragment in shaders.SPRITE_FRAGMENTS]
        self._make(1024)

    def _make(self, capacity: int) -> None:
        self._buffer = self._context.buffer(reserve=capacity * ROW_BYTES, dynamic=True)
        self._arrays = [self._context.vertex_array(program, []) for program in self._programs]

    def draw(self, particles: Sequence[Sprites], target: moderngl.Framebuffer) -> int:
        """Draw each over what is there, hidden by what is nearer. Returns the draws made."""
        shown = [each for each in particles if len(each.rows)]
        if not shown:
            return 0
        context = self._context
        data = np.concatenate([each.rows for each in shown], dtype=np.float32)
        if data.nbytes > self._buffer.size:
            self._make(2 * len(data))
        else:
            self._buffer.orphan()
        self._buffer.write(data)
        context.enable_only(context.DEPTH_TEST | context.BLEND)
        # Colours come multiplied with their opacity; what shines leaves all of what is behind.
        context.blend_func = context.ONE, context.ONE_MINUS_SRC_ALPHA
        target.depth_mask = False
        first = 0
        for each in shown:
            array = self._arrays[each.additive]
            for place in range(3):
                offset = first * ROW_BYTES + place * 16
                array.bind(place, "f", self._buffer, "4f", offset, ROW_BYTES, 1, False)
            array.render(context.TRIANGLE_STRIP, vertices=4, instances=len(each.rows))
            first += len(each.rows)
        target.depth_mask = True
        context.blend_func = context.SRC_ALPHA, context.ONE_MINUS_SRC_ALPHA  # as all others have it
        return len(shown)
