"""What a frame costs, and what is kept and given back on the graphics card."""

import ctypes
import gc

import numpy as np
import pytest

from osgode.graph.appearance import Appearance, Texture
from osgode.graph.frame import Bin, Frame, Rectangle, Sun, Text, View
from osgode.graph.primitives import box_mesh
from osgode.maths import Vec3
from osgode.render import OffscreenDrawer
from osgode.render.shadows import CASCADES
from tests.render.scenes import CLEAR, GREEN, RED, SIZE, many, place, quad, unlit, yard

GREY = Appearance((0.5, 0.5, 0.5))


def frame(*parts):
    """A frame of opaque, transparent and casting bins, overlay and sun, seen from the origin in clear air."""
    return Frame(View(), SIZE, *parts, sky=CLEAR)


def texture():
    return Texture(np.full((4, 4, 3), 200, np.uint8))


def test_draw_calls_follow_bins_not_instances(drawer):
    """One call per bin, two if it is transparent, one per mesh and shadow map, the sky, and the overlay's runs."""
    boxes, sheets = (many(mesh, GREY, *(place((x, 0, -5)) for x in range(-50, 50))) for mesh in (box_mesh(), quad()))
    glass = many(quad(), Appearance((1, 1, 1, 0.5)), place((0, 0, -3)), place((0, 0, -2)))
    overlay = [Rectangle(0, 0, 5, 5), Rectangle(9, 0, 5, 5), Text(0, 20, "a"), Text(9, 20, "a"), Text(0, 40, "b")]
    sun = Sun(direction=Vec3(0, -1, 0))
    drawer.draw(frame([boxes, sheets], [glass], [boxes, sheets, boxes], overlay, sun))
    assert drawer.counts.draws == 2 + 2 * 1 + CASCADES * 2 + 1 + 3
    assert drawer.counts.instances >= 202
    drawer.draw(frame([boxes, sheets]))
    assert drawer.counts.draws == 2 + 1
    assert drawer.counts.instances == 200


def test_empty_frame(drawer):
    """Nothing to see is the sky."""
    drawer.draw(frame())
    assert drawer.counts.draws == 1
    assert drawer.image().std() > 0


def test_empty_bin(drawer):
    """A bin without instances draws nothing and harms nothing."""
    empty = Bin(quad(), unlit(RED), np.zeros((0, 4, 4), np.float32))
    drawer.draw(frame([empty, many(quad(), unlit(RED), place((0, 0, -5)))], [empty], [empty]))
    assert drawer.image()[50, 80].tolist() == [255, 0, 0]


def test_many_instances(drawer):
    """The buffer of matrices grows with the frame, and what was drawn before still can be."""
    mesh = quad(width=0.02, height=0.02)
    grid = [place((x / 50 - 2, y / 50 - 1, -4)) for x in range(200) for y in range(100)]
    few = many(quad(), unlit(RED), place((0, 0, -5)))
    for bins in ([few], [few, many(mesh, GREY, *grid)], [few]):
        drawer.draw(frame(bins))
        assert drawer.counts.instances == sum(len(one.matrices) for one in bins)
    assert drawer.image()[50, 80].tolist() == [255, 0, 0]


def test_double_precision_matrices(drawer):
    """Matrices in double precision are taken as well."""
    matrices = np.array([place((0, 0, -5))])
    drawer.draw(frame([Bin(quad(), unlit(RED), matrices)], [], [Bin(quad(), unlit(RED), matrices)]))
    assert drawer.image()[50, 80].tolist() == [255, 0, 0]


def test_shared_things_are_uploaded_once(drawer):
    """A mesh or texture in many bins and frames is one on the graphics card."""
    drawer.draw(frame())
    before = drawer.counts
    mesh, image = quad(), texture()
    bins = [many(mesh, Appearance((1, 1, level), image), place((0, 0, -5))) for level in (0.1, 0.5, 1)]
    for _ in range(3):
        drawer.draw(frame(bins, [], bins))
    assert drawer.counts.meshes == before.meshes + 1
    assert drawer.counts.textures == before.textures + 1


def alive(drawer, kind):
    """How many of the first thousand numbers name a buffer, a vertex array or a texture of this drawer's context."""
    library = ctypes.CDLL("libGL.so.1")
    with drawer._context:
        test = getattr(library, f"glIs{kind}")
        return sum(bool(test(number)) for number in range(1, 1000))


def test_dropped_meshes_and_textures_are_released(drawer):
    """What nobody holds any longer is gone from the graphics card with the next picture."""
    drawer.draw(yard())
    gc.collect()
    drawer.draw(frame())  # what other tests left is gone after this
    kinds = ("Buffer", "VertexArray", "Texture")
    try:
        before = [alive(drawer, kind) for kind in kinds]
    except OSError:
        pytest.skip("the driver has no libGL.so.1 to ask")
    counts = drawer.counts
    bins = [many(quad(), Appearance((1, 1, 1), texture()), place((0, 0, -5))) for _ in range(20)]
    drawer.draw(frame(bins, [], bins))
    during = [alive(drawer, kind) for kind in kinds]
    assert np.subtract(during, before).tolist() == [40, 40, 20]  # a mesh has two buffers and two programs
    del bins
    gc.collect()
    drawer.draw(frame())
    assert drawer.counts == counts
    assert [alive(drawer, kind) for kind in kinds] == before


def test_two_drawers_do_not_mix(drawer):
    """Each drawer has its own context, its own size and its own copy of what they both draw."""
    mesh = quad()
    with OffscreenDrawer((40, 30)) as other:
        for _ in range(2):
            drawer.draw(frame([many(mesh, unlit(RED), place((0, 0, -5)))]))
            other.draw(frame([many(mesh, unlit(GREEN), place((0, 0, -5)))]))
        assert drawer.image()[50, 80].tolist() == [255, 0, 0]
        assert other.image()[15, 20].tolist() == [0, 255, 0]
        assert other.image().shape == (30, 40, 3)
