"""What is kept on the graphics card: programs, meshes, textures and the data of one frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from osgode.graph.appearance import Image, Texture
from osgode.graph.mesh import Mesh
from osgode.maths import Float32Array
from osgode.render import shaders
from osgode.render.culling import encloses

if TYPE_CHECKING:
    import moderngl

ROW_BYTES = 16
MATRIX_BYTES = 4 * ROW_BYTES
TEXTURE_UNIT, SHADOW_UNIT = 0, 1

SRGB8, SRGB8_ALPHA8 = 0x8C41, 0x8C43

SOFTWARE = ("llvmpipe", "softpipe", "SwiftShader")
"""Renderers that run on the processor, as they name themselves."""


def is_software(context: moderngl.Context) -> bool:
    """Whether a context draws on the processor."""
    return any(name in context.info["GL_RENDERER"] for name in SOFTWARE)


class InstanceBuffer:
    """The matrices of every instance of a frame, one after another, written at once.

    Three buffers take turns, so that none is written while the driver may still read it; a driver that is handed
    fresh memory for each frame instead has to find it first, which for a software rasteriser is half of the work.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._buffers = [context.buffer(reserve=1024 * MATRIX_BYTES, dynamic=True) for _ in range(3)]

    @property
    def buffer(self) -> moderngl.Buffer:
        """The buffer of this frame."""
        return self._buffers[0]

    def write(self, blocks: Sequence[Float32Array]) -> list[int]:
        """Replace the contents by ``blocks``, each (n, 4, 4); returns the number of each block's first instance."""
        self._buffers.append(self._buffers.pop(0))
        ends: list[int] = np.cumsum([0, *map(len, blocks)]).tolist()
        needed = ends[-1] * MATRIX_BYTES
        if needed > self._buffers[0].size:
            self._buffers[0] = self._context.buffer(reserve=2 * needed, dynamic=True)
        if needed:
            self._buffers[0].write(np.concatenate(blocks, dtype=np.float32))
        return ends[:-1]


class FrameBlock:
    """The uniform block of what is the same for everything in a frame, see `shaders.FRAME_FIELDS`."""

    def __init__(self, context: moderngl.Context) -> None:
        self._data = np.zeros((sum(shaders.FRAME_FIELDS.values()), 4), np.float32)
        starts = np.cumsum([0, *shaders.FRAME_FIELDS.values()]).tolist()
        self._fields = {
            name: self._data[start : start + rows]
            for (name, rows), start in zip(shaders.FRAME_FIELDS.items(), starts, strict=False)
        }
        self._buffer = context.buffer(reserve=self._data.nbytes, dynamic=True)

    def write(self, **values: npt.ArrayLike) -> None:
        """Set the named fields, each to one row or rows of 3 or 4 numbers, and upload them all."""
        for name, value in values.items():
            array = np.atleast_2d(value)
            self._fields[name][:, : array.shape[1]] = array
        self._buffer.orphan()
        self._buffer.write(self._data)
        self._buffer.bind_to_uniform_block(0)


class GpuMesh:
    """A mesh on the graphics card, and the vertex arrays of the programs that have drawn it."""

    def __init__(self, context: moderngl.Context, mesh: Mesh) -> None:
        data = np.hstack([mesh.vertices, mesh.normals, mesh.uvs], dtype=np.float32)
        self._context = context
        self.solid = encloses(mesh)
        """Whether its back faces are hidden from everybody outside."""
        self._vertices = context.buffer(data)
        self._indices = context.buffer(mesh.triangles)
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def draw(self, program: moderngl.Program, instances: InstanceBuffer, first: int, count: int, faces: str) -> None:
        """Draw ``count`` instances with the matrices from number ``first`` on.

        ``faces`` is "front", "back" or "both"; front faces are those whose corners run counter-clockwise.
        """
        if faces == "both":
            self._context.disable(self._context.CULL_FACE)
        else:
            self._context.enable(self._context.CULL_FACE)
            self._context.cull_face = "back" if faces == "front" else "front"
        array = self._arrays.get(program)
        if array is None:
            array = self._arrays[program] = self._make_array(program)
        # OpenGL 3.3 has no "first instance", so the attributes are pointed at the right place instead.
        for row in range(3):
            offset = first * MATRIX_BYTES + row * ROW_BYTES
            array.bind(shaders.ROWS + row, "f", instances.buffer, "4f", offset, MATRIX_BYTES, 1, False)
        array.render(instances=count)

    def _make_array(self, program: moderngl.Program) -> moderngl.VertexArray:
        content = (self._vertices, "3f 3f 2f", shaders.POSITION, shaders.NORMAL, shaders.UV)
        # Programs that don't read the normal or the texture coordinate skip them.
        return self._context.vertex_array(program, [content], self._indices, skip_errors=True)


class Resources:
    """Programs, meshes and textures, made when first drawn.

    The tables hold meshes and textures weakly. The context is in a mode in which moderngl queues what was
    dropped, wherever garbage collection happened, and `collect` releases it while the context is current.
    """

    def __init__(self, context: moderngl.Context, anisotropy: float) -> None:
        self._context = context
        self._anisotropy = 1.0 if is_software(context) else min(anisotropy, context.max_anisotropy)
        self._meshes: WeakKeyDictionary[Mesh, GpuMesh] = WeakKeyDictionary()
        self._textures: WeakKeyDictionary[Texture, moderngl.Texture] = WeakKeyDictionary()
        self._surfaces: dict[tuple[str, ...], moderngl.Program] = {}
        self.white = context.texture((1, 1), 4, b"\xff" * 4)

    @property
    def mesh_count(self) -> int:
        """How many meshes are on the graphics card."""
        return len(self._meshes)

    @property
    def texture_count(self) -> int:
        """How many textures of surfaces and overlay rectangles are on the graphics card."""
        return len(self._textures)

    def collect(self) -> None:
        """Release what was dropped since the last call; the context must be current."""
        self._context.gc()

    def program(self, vertex: str, fragment: str) -> moderngl.Program:
        """A program that finds the frame's block and the textures where they are bound."""
        result = self._context.program(vertex, fragment)
        for name, value in (("u_texture", TEXTURE_UNIT), ("u_shadow_map", SHADOW_UNIT)):
            if name in result:
                result[name] = value
        return result

    def surface(self, *features: str) -> moderngl.Program:
        """The program for surfaces with ``features``, see `shaders.surface`."""
        found = self._surfaces.get(features)
        if found is None:
            found = self._surfaces[features] = self.program(*shaders.surface(*features))
        return found

    def mesh(self, mesh: Mesh) -> GpuMesh:
        """The uploaded form of ``mesh``."""
        found = self._meshes.get(mesh)
        if found is None:
            found = self._meshes[mesh] = GpuMesh(self._context, mesh)
        return found

    def texture(self, texture: Texture) -> moderngl.Texture:
        """The uploaded form of ``texture``, with mipmaps."""
        found = self._textures.get(texture)
        if found is None:
            found = self._textures[texture] = self._upload(texture)
        return found

    def _upload(self, texture: Texture) -> moderngl.Texture:
        height, width, channels = texture.image.shape
        kind = SRGB8 if channels == 3 else SRGB8_ALPHA8
        # OpenGL's first row is the bottom one.
        rows = np.ascontiguousarray(texture.image[::-1])
        result = self._context.texture((width, height), channels, rows, internal_format=kind)
        result.build_mipmaps()
        result.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        result.repeat_x = result.repeat_y = texture.repeat
        if self._anisotropy > 1.0:
            result.anisotropy = self._anisotropy
        return result

    def mask(self, alpha: Image) -> moderngl.Texture:
        """A texture that is white everywhere and as opaque as ``alpha``, (height, width) bytes, says."""
        height, width = alpha.shape
        result = self._context.texture((width, height), 1, np.ascontiguousarray(alpha[::-1]))
        result.swizzle = "111R"
        result.repeat_x = result.repeat_y = False
        return result
