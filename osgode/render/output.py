"""Pictures and videos as files."""

from __future__ import annotations

from collections.abc import Generator
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Self

import numpy as np

from osgode.errors import FieldError, StateError
from osgode.graph.appearance import Image
from osgode.render.extras import require


def save_png(image: Image, path: str | PathLike[str]) -> None:
    """Write ``image``, (height, width, 3 or 4) bytes with the first row at the top, as a PNG file.

    Raises:
        MissingExtraError: if Pillow is not installed.
        FieldError: if ``image`` is not such an array.
        OSError: if the file can't be written.
    """
    pixels = _checked(image, (3, 4))
    require("PIL.Image").fromarray(pixels).save(fspath(path), format="PNG")


class VideoWriter:
    """Writes pictures one after another into a video file (H.264 if the name ends in .mp4).

    A context manager: the file is whole when the block has been left. No file is made without a picture.

    Args:
        path: of the file; its ending chooses the container.
        fps: pictures a second.
        size: width and height of the pictures, pixels; both even, which the coding demands.

    Raises:
        MissingExtraError: if imageio-ffmpeg is not installed.
        FieldError: if ``fps`` or ``size`` can't be.
        FileNotFoundError: if there is no such folder.
    """

    def __init__(self, path: str | PathLike[str], fps: float, size: tuple[int, int]) -> None:
        width, height = size
        if width < 2 or height < 2 or width % 2 or height % 2:
            raise FieldError(f"VideoWriter.size is {size!r}; both must be even and at least 2")
        if not fps > 0:
            raise FieldError(f"VideoWriter.fps is {fps!r}; it must be above 0")
        folder = Path(path).parent
        if not folder.is_dir():  # the encoder would only say that its pipe broke
            raise FileNotFoundError(f"the video {fspath(path)!r} can't be written: there is no folder {folder}")
        self.size = (width, height)
        self._closed = False
        self._encoder: Generator[None, Any, None] | None = None
        self._ffmpeg = require("imageio_ffmpeg", "video")
        self._path, self._fps = fspath(path), fps

    def write(self, image: Image) -> None:
        """Append one picture, (height, width, 3) bytes with the first row at the top.

        Raises:
            FieldError: if it has another size than the video.
            StateError: if the video is closed.
            OSError: if the file can't be written.
        """
        if self._closed:
            raise StateError(f"the video {self._path!r} is closed")
        pixels = _checked(image, (3,))
        if pixels.shape[1::-1] != self.size:
            raise FieldError(f"the picture is {pixels.shape[1::-1]} pixels; the video {self._path!r} is {self.size}")
        if self._encoder is None:
            self._encoder = self._ffmpeg.write_frames(
                self._path, self.size, fps=self._fps, quality=7, macro_block_size=2, ffmpeg_log_level="error"
            )
            self._encoder.send(None)
        self._encoder.send(pixels)

    def close(self) -> None:
        """Finish the file; closing twice does nothing."""
        self._closed = True
        if self._encoder is not None:
            self._encoder.close()
            self._encoder = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _checked(image: Image, channels: tuple[int, ...]) -> Image:
    pixels = np.ascontiguousarray(image)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] not in channels:
        raise FieldError(
            f"the picture has shape {pixels.shape} and type {pixels.dtype}; "
            f"it must be (height, width, {' or '.join(map(str, channels))}) of uint8"
        )
    return pixels
