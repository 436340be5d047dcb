"""A whole picture against the one kept in golden/.

After a change that is meant to show, look at the new picture and keep it:

    OSGODE_UPDATE_GOLDEN=1 pytest tests/render/test_picture.py
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from osgode.render import save_png
from osgode.render.resources import SOFTWARE
from tests.render.scenes import night, yard

GOLDEN = Path(__file__).parent / "golden"
SCENES = {"yard": yard, "night": night}
MEAN, FAR_OFF, SHARE = 0.6, 24, 0.01
"""The picture may differ by so many levels of 255 in the mean, and by more than FAR_OFF in this share of pixels.

Another version of the rasteriser moves edges by a fraction of a pixel; nothing else may change.
"""


def picture(drawer, frame):
    drawer.draw(frame)
    return drawer.image()


def differs(one, other):
    """What is too different, in words; empty if nothing is."""
    off = np.abs(one.astype(int) - other)
    share = (off.max(axis=2) > FAR_OFF).mean()
    return f"mean {off.mean():.2f}, far off {share:.2%}" if off.mean() > MEAN or share > SHARE else ""


@pytest.mark.parametrize("name", SCENES)
def test_picture_is_the_one_kept(fine_drawer, name, tmp_path):
    """The scene looks as it did when somebody last looked at it."""
    if not any(software in fine_drawer.renderer for software in SOFTWARE):
        pytest.skip(f"the picture kept is of a software rasteriser, this is {fine_drawer.renderer}")
    drawn, kept = picture(fine_drawer, SCENES[name]()), GOLDEN / f"{name}.png"
    if os.environ.get("OSGODE_UPDATE_GOLDEN"):
        save_png(drawn, kept)
        pytest.skip(f"{kept} was written anew")
    save_png(drawn, tmp_path / "drawn.png")
    assert not differs(drawn, np.asarray(Image.open(kept))), f"compare {tmp_path / 'drawn.png'} with {kept}"


def without_shadows(frame):
    return replace(frame, casters=[])


def without_textures(frame):
    return replace(
        frame, opaque=[replace(one, appearance=replace(one.appearance, texture=None)) for one in frame.opaque]
    )


def without_glass(frame):
    return replace(frame, transparent=[])


def without_overlay(frame):
    return replace(frame, overlay=[])


def without_text(frame):
    return replace(frame, overlay=frame.overlay[:1])


def without_haze(frame):
    return replace(frame, sky=replace(frame.sky, haze=None))


def without_sun(frame):
    return replace(frame, sun=replace(frame.sun, colour=(0, 0, 0)))


def without_ambient(frame):
    return replace(frame, sun=replace(frame.sun, ambient=(0, 0, 0)))


def without_shine(frame):
    dull = [replace(one, appearance=replace(one.appearance, shininess=0.0)) for one in frame.opaque]
    return replace(frame, opaque=dull)


@pytest.mark.parametrize(
    "lose",
    [
        without_shadows,
        without_textures,
        without_glass,
        without_overlay,
        without_text,
        without_haze,
        without_sun,
        without_ambient,
        without_shine,
    ],
)
def test_comparison_notices_a_loss(fine_drawer, lose):
    """The comparison is strict enough to notice if any one part of drawing were lost."""
    assert differs(picture(fine_drawer, lose(yard())), picture(fine_drawer, yard()))


def test_same_frame_gives_the_same_picture(fine_drawer):
    """Drawing leaves nothing behind that changes the next picture."""
    first = picture(fine_drawer, yard())
    picture(fine_drawer, without_shadows(without_overlay(yard())))
    assert (picture(fine_drawer, yard()) == first).all()


@pytest.mark.parametrize("lost", ["lights", "particles"])
def test_comparison_notices_a_loss_at_night(fine_drawer, lost):
    """Each of the lamps, the smoke and the sparks counts."""
    whole = night()
    for k in range(2):
        rest = [each for number, each in enumerate(getattr(whole, lost)) if number != k]
        assert differs(picture(fine_drawer, replace(whole, **{lost: rest})), picture(fine_drawer, whole))
