"""Lines: one rectangle each, a few pixels wide, that the graphics card spans between the two ends."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from osgode.graph.frame import Lines, View
from osgode.render import shaders
from osgode.render.resources import Resources

if TYPE_CHECKING:
    import moderngl

POINT_BYTES, COLOUR_BYTES = 24, 4
FRINGE = 1.0
"""Pixels by which the rectangle is wider than the line, over which it fades out."""
SLOPE = 3.0
"""How steeply a surface may go away from the eye and not hide half of the width of what lies on it."""


class LineDrawer:
    """Draws lines: one call for each Lines. Nothing is made before there are any."""

    def __init__(self, context: moderngl.Context, resources: Resources) -> None:
        self._context = context
        self._resources = resources
        self._capacity = 0
        self._made: tuple[moderngl.Buffer, moderngl.Buffer, moderngl.VertexArray] | None = None
        self._program: moderngl.Program | None = None

    def draw(self, several: Iterable[Lines], size: tuple[int, int], view: View) -> int:
        """Draw onto the present target of ``size`` pixels, blended, without writing depths. Returns the draws made.

        Whether the lines are hidden by what is before them is the caller's choice of depth test.

        Args:
            several: what is drawn.
            size: of the target, pixels.
            view: from where.
        """
        ahead = view.pose.rotation.rotate((0.0, 0.0, -1.0))
        near = (*ahead, -ahead.dot(view.pose.position) - view.near)  # above 0 beyond the near plane
        pixel = 2.0 * math.tan(view.field_of_view / 2) / size[1]  # at a distance of 1
        draws = 0
        for lines in several:
            if not len(lines):
                continue
            points, colours, array, program = self._room(len(lines))
            for buffer, data in ((points, lines.points), (colours, lines.colours)):
                buffer.orphan()  # the driver needn't wait until the last draw has read the old storage
                buffer.write(data)
            program["u_half"] = tuple(pixels / 2 for pixels in size)
            program["u_near"] = near
            program["u_nearer"] = min(SLOPE * pixel * (lines.width + FRINGE) / 2, 0.5)
            program["u_width"] = lines.width, FRINGE
            array.render(self._context.TRIANGLE_STRIP, vertices=4, instances=len(lines))
            draws += 1
        return draws

    def _room(self, count: int) -> tuple[moderngl.Buffer, moderngl.Buffer, moderngl.VertexArray, moderngl.Program]:
        if self._program is None:
            self._program = self._resources.program(shaders.LINE_VERTEX, shaders.LINE_FRAGMENT)
        if self._made is None or count > self._capacity:
            self._capacity = max(2 * count, 1024)
            points, colours = (
                self._context.buffer(reserve=self._capacity * width, dynamic=True)
                for width in (POINT_BYTES, COLOUR_BYTES)
            )
            content = [(points, "3f 3f /i", 0, 1), (colours, "4f1 /i", 2)]
            self._made = points, colours, self._context.vertex_array(self._program, content)
        return *self._made, self._program
