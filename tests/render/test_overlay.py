"""Rectangles and text over the picture."""

import numpy as np
import pytest

from osgode.graph.frame import Frame, Rectangle, Sky, Sun, Text, View
from osgode.render import measure_text
from osgode.render.text import rasterise
from tests.render.scenes import SIZE, blocks

NIGHT = {"sky": Sky((0, 0, 0), (0, 0, 0), None), "sun": Sun(colour=(0, 0, 0))}


def shot(drawer, *overlay, size=SIZE):
    drawer.draw(Frame(View(), size, overlay=list(overlay), **NIGHT))
    return drawer.image().astype(int)


def test_rectangle_covers_its_pixels(drawer):
    """Pixels are counted from the top left corner of the picture."""
    image = shot(drawer, Rectangle(10, 20, 30, 5, (1, 0, 0, 1)))
    expected = np.zeros((100, 160, 3), int)
    expected[20:25, 10:40, 0] = 255
    assert (image == expected).all()


def test_overlay_is_drawn_in_order(drawer):
    """The later item lies over the earlier one; opacity blends numbers, as in any paint program."""
    image = shot(drawer, Rectangle(0, 0, 20, 20, (1, 0, 0, 1)), Rectangle(10, 0, 20, 20, (0, 0, 1, 0.5)))
    assert np.abs(image[5, [5, 15, 25]] - [[255, 0, 0], [128, 0, 128], [0, 0, 128]]).max() <= 1


def test_order_holds_across_textures_and_text(drawer):
    """A rectangle after a text hides it, though both share no texture."""
    words, cover = Text(5, 5, "MMMM", 20), Rectangle(0, 0, 160, 100, (0, 1, 0, 1))
    assert (shot(drawer, words, cover) == (0, 255, 0)).all()
    assert (shot(drawer, cover, words)[..., 0] > 128).any()


def test_texture_of_a_rectangle_is_upright(drawer):
    """The first row of the image is at the top of the rectangle."""
    texture = blocks([(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)])
    seen = shot(drawer, Rectangle(0, 0, 100, 100, (1, 1, 1, 1), texture))
    corners = [seen[5, 5], seen[5, 95], seen[95, 5], seen[95, 95]]
    assert np.allclose(corners, [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]], atol=2)


def test_text_is_where_it_was_put(drawer):
    """Letters are in the rectangle that `measure_text` promises, and nowhere else."""
    image = shot(drawer, Text(30, 40, "Speed", 20, (1, 1, 0, 1)))
    rows, columns = np.nonzero(image.any(axis=2))
    width, height = measure_text("Speed", 20)
    assert 30 <= columns.min() <= 33
    assert 30 + width - 3 <= columns.max() < 30 + width
    assert rows.min() >= 40
    assert rows.max() < 40 + height
    assert (image[..., 2] == 0).all()
    assert (image.max(axis=2) == 255).any()


@pytest.mark.parametrize("align", [(0, 0), (0.5, 0.5), (1, 1), (1, 0), (0.5, 0)])
def test_text_is_aligned(drawer, align):
    """The same letters, with that part of their width and height to the left of and above the point."""
    mask = rasterise("Crisp", 18)
    height, width = mask.shape
    left, top = round(80 - align[0] * width), round(50 - align[1] * height)
    seen = shot(drawer, Text(80, 50, "Crisp", 18, align=align))[..., 0]
    assert np.abs(seen[top : top + height, left : left + width] - mask).max() <= 1
    assert (seen > 0).sum() == (mask > 0).sum()


def test_text_is_drawn_pixel_for_pixel(drawer):
    """The letters are those that the font drew, not a blurred copy."""
    mask = rasterise("Crisp", 18)
    height, width = mask.shape
    for x in (12, 12.4):
        seen = shot(drawer, Text(x, 30, "Crisp", 18))[30 : 30 + height, 12 : 12 + width, 0]
        assert np.abs(seen - mask).max() <= 1


def test_lines_of_text(drawer):
    """A line break starts again at the left, one line lower."""
    (one, step), (two, both) = measure_text("mm", 16), measure_text("mm\nm", 16)
    assert (one, 2 * step) == (two, both)
    image = shot(drawer, Text(10, 10, "mm\nm", 16)).any(axis=2)
    assert image[10 : 10 + step].any()
    assert image[10 + step : 10 + both].any()
    assert not image[10 + step : 10 + both, 10 + one // 2 + 1 :].any()


def test_text_that_is_longer_than_any_picture_is_cut(drawer):
    """A graphics card refuses pictures of more than some thousand pixels."""
    assert np.array_equal(shot(drawer, Text(0, 0, 20_000 * "m")), shot(drawer, Text(0, 0, 100 * "m")))
    assert np.array_equal(shot(drawer, Text(0, 0, 2000 * "m\n")), shot(drawer, Text(0, 0, 100 * "m\n")))


def test_a_null_character_in_a_text_is_left_out(drawer):
    """Names that come from files or a network may have one, and pygame refuses it."""
    assert np.array_equal(shot(drawer, Text(0, 0, "a\0b")), shot(drawer, Text(0, 0, "ab")))


@pytest.mark.parametrize("text", ["", "  ", "\n", "\0"])
def test_empty_text_draws_nothing(drawer, text):
    """Nothing to say is nothing to draw."""
    assert not shot(drawer, Text(0, 0, text)).any()


def test_overlay_is_stretched_to_the_picture(drawer):
    """A frame laid out for another size fills the picture all the same."""
    image = shot(drawer, Rectangle(0, 0, 40, 50, (1, 1, 1, 1)), size=(80, 100))
    assert image[:50, :80].all()
    assert not image[50:].any()
    assert not image[:, 80:].any()


def test_many_texts_are_not_kept_for_ever(drawer):
    """A counter that shows another text in every frame doesn't fill the graphics card."""
    overlay = drawer._renderer._overlay
    for number in range(300):
        shot(drawer, Text(0, 0, str(number)))
    assert len(overlay._texts) <= 256
