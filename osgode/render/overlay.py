"""The overlay: rectangles and text over the picture, in the order given."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from osgode.graph.frame import Rectangle, Text
from osgode.render import shaders
from osgode.render.resources import TEXTURE_UNIT, Resources
from osgode.render.text import rasterise

if TYPE_CHECKING:
    import moderngl

FLOATS = 8
VERTICES = 6
KEPT_TEXTS = 256


class Overlay:
    """Draws the overlay of a frame: one draw per run of items that share a texture.

    Strings are drawn into textures that are kept while they are used.
    """

    def __init__(self, context: moderngl.Context, resources: Resources) -> None:
        self._context = context
        self._resources = resources
        self._program = resources.program(shaders.OVERLAY_VERTEX, shaders.OVERLAY_FRAGMENT)
        self._buffer = context.buffer(reserve=64 * VERTICES * FLOATS * 4, dynamic=True)
        self._array = self._make_array()
        self._texts: OrderedDict[tuple[str, int], moderngl.Texture] = OrderedDict()

    def _make_array(self) -> moderngl.VertexArray:
        return self._context.vertex_array(self._program, [(self._buffer, "2f 2f 4f", 0, 1, 2)])

    def draw(self, items: Sequence[Rectangle | Text], size: tuple[int, int]) -> int:
        """Draw ``items`` over a picture laid out as ``size`` pixels. Returns the draws made."""
        runs: list[tuple[moderngl.Texture, int]] = []
        corners = []
        for item in items:
            texture = self._texture(item)
            if texture is None:
                continue
            corners.append(_corners(item, texture))
            if runs and runs[-1][0] is texture:
                runs[-1] = (texture, runs[-1][1] + VERTICES)
            else:
                runs.append((texture, VERTICES))
        if not runs:
            return 0
        data = np.array(corners, np.float32)
        if data.nbytes > self._buffer.size:
            self._buffer = self._context.buffer(reserve=2 * data.nbytes, dynamic=True)
            self._array = self._make_array()
        else:
            self._buffer.orphan()
        self._buffer.write(data)

        context = self._context
        context.enable_only(context.BLEND)
        context.blend_func = context.SRC_ALPHA, context.ONE_MINUS_SRC_ALPHA
        self._program["u_size"] = size
        first = 0
        for texture, count in runs:
            texture.use(TEXTURE_UNIT)
            self._array.render(vertices=count, first=first)
            first += count
        return len(runs)

    def _texture(self, item: Rectangle | Text) -> moderngl.Texture | None:
        if isinstance(item, Rectangle):
            return self._resources.white if item.texture is None else self._resources.texture(item.texture)
        if not item.text.strip():
            return None
        key = item.text, item.size
        found = self._texts.get(key)
        if found is None:
            found = self._texts[key] = self._resources.mask(rasterise(*key))
            if len(self._texts) > KEPT_TEXTS:
                self._texts.popitem(last=False)
        self._texts.move_to_end(key)
        return found


def _corners(item: Rectangle | Text, texture: moderngl.Texture) -> list[tuple[float, ...]]:
    if isinstance(item, Rectangle):
        x, y, width, height = item.x, item.y, item.width, item.height
    else:
        # On whole pixels, or the letters blur.
        width, height = texture.size
        x, y = round(item.x - item.align[0] * width), round(item.y - item.align[1] * height)
    right, bottom = x + width, y + height
    top_left = (x, y, 0.0, 1.0, *item.colour)
    top_right = (right, y, 1.0, 1.0, *item.colour)
    bottom_left = (x, bottom, 0.0, 0.0, *item.colour)
    bottom_right = (right, bottom, 1.0, 0.0, *item.colour)
    return [top_left, bottom_left, top_right, top_right, bottom_left, bottom_right]
