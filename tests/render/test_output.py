"""Pictures and videos as files."""

import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from osgode.errors import FieldError, MissingExtraError, StateError
from osgode.render import VideoWriter, save_png

PICTURE = np.arange(6 * 8 * 3, dtype=np.uint8).reshape(6, 8, 3)


def test_png_holds_the_picture(tmp_path):
    """A PNG read again is the picture that was written, with or without opacity."""
    opaque = np.dstack([PICTURE, np.full((6, 8), 77, np.uint8)])
    for image in (PICTURE, opaque, PICTURE[::-1, ::2]):
        save_png(image, tmp_path / "a.png")
        assert (np.asarray(Image.open(tmp_path / "a.png")) == image).all()


@pytest.mark.parametrize("image", [PICTURE.astype(float), PICTURE[..., 0], PICTURE[..., :2]])
def test_png_of_something_else(tmp_path, image):
    """What isn't a picture is refused before a file is made."""
    with pytest.raises(FieldError, match="uint8"):
        save_png(image, tmp_path / "a.png")
    assert not list(tmp_path.iterdir())


def test_video_holds_the_pictures(tmp_path):
    """A video read again has as many pictures, of the size and about the colours written."""
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    path = tmp_path / "a.mp4"
    colours = [(200, 40, 40), (40, 200, 40), (40, 40, 200)]
    with VideoWriter(path, 10, (64, 48)) as video:
        for colour in colours:
            video.write(np.full((48, 64, 3), colour, np.uint8))
    read = [ffmpeg.get_ffmpeg_exe(), "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(read, capture_output=True, check=True)
    assert b"10 fps" in done.stderr
    frames = np.frombuffer(done.stdout, np.uint8).reshape(3, 48, 64, 3).astype(int)
    assert np.abs(frames - np.array(colours)[:, None, None]).max() < 12


def test_video_refuses_what_does_not_fit(tmp_path):
    """Pictures of another size, odd sizes, no rate, and writing after the end are errors."""
    pytest.importorskip("imageio_ffmpeg")
    path = tmp_path / "a.mp4"
    for size in ((63, 48), (64, 0)):
        with pytest.raises(FieldError, match="even"):
            VideoWriter(path, 10, size)
    with pytest.raises(FileNotFoundError, match="folder"):
        VideoWriter(tmp_path / "b" / "a.mp4", 10, (64, 48))
    with pytest.raises(FieldError, match="fps"):
        VideoWriter(path, 0, (64, 48))
    with VideoWriter(path, 10, (64, 48)) as video, pytest.raises(FieldError, match=r"\(8, 6\)"):
        video.write(PICTURE)
    with pytest.raises(StateError):
        video.write(np.zeros((48, 64, 3), np.uint8))
    assert not path.exists()


@pytest.mark.parametrize(
    ("module", "extra", "use"),
    [
        ("PIL.Image", "render", lambda path: save_png(PICTURE, path)),
        ("imageio_ffmpeg", "video", lambda path: VideoWriter(path, 10, (64, 48))),
    ],
)
def test_missing_package_is_named(monkeypatch, tmp_path, module, extra, use):
    """Without a package the message says what to install."""
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=rf"pip install osgode\[{extra}\]"):
        use(tmp_path / "a")
