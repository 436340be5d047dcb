"""How a surface looks: colour, texture, transparency."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError, MissingExtraError, ModelError

Image = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Texture:
    """An image on a surface: (height, width, 3 or 4) bytes, first row at the top.

    Compared by identity: share one object to share one upload.
    """

    image: Image
    name: str = ""
    repeat: bool = True

    def __post_init__(self) -> None:
        image = np.ascontiguousarray(self.image)
        if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] not in (3, 4) or 0 in image.shape:
            raise FieldError(
                f"Texture {self.name!r}: image has shape {image.shape} and type {image.dtype}; "
                "it must be (height, width, 3 or 4) of uint8"
            )
        object.__setattr__(self, "image", image)


def load_texture(path: str | os.PathLike[str]) -> Texture:
    """The texture in an image file of any format that Pillow reads.

    Raises:
        ModelError: if there is no such file, or no image in it.
        MissingExtraError: if Pillow is not installed.
    """
    try:
        from PIL import Image as images  # noqa: N813 - Pillow's class of that name is not needed here
    except ImportError as error:
        raise MissingExtraError("reading an image needs Pillow: pip install 'osgode[render]'") from error
    try:
        with images.open(path) as image:
            return Texture(np.asarray(image.convert("RGBA" if "A" in image.getbands() else "RGB")), os.fspath(path))
    except OSError as error:
        raise ModelError(f"no texture can be read from {os.fspath(path)!r}: {error}") from error


@dataclass(frozen=True)
class Appearance:
    """Colour, texture and shine of a drawable.

    Args:
        colour: red, green, blue and opacity, 0 to 1, multiplied with the texture.
        texture: an image, or None.
        texture_scale: metres that one repeat of the texture covers on the primitives, (u, v);
            None stretches it once over each face.
        shininess: 0 (matt) to 1 (polished).
        unlit: drawn in its own colour, whatever the light.
        in_front: drawn over everything that isn't in front itself, and without a shadow: for marks on things.
    """

    colour: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    texture: Texture | None = None
    texture_scale: tuple[float, float] | None = None
    shininess: float = 0.2
    unlit: bool = field(default=False)
    in_front: bool = field(default=False)

    def __post_init__(self) -> None:
        try:
            colour = tuple(float(c) for c in self.colour)
        except (TypeError, ValueError):
            colour = ()
        if len(colour) == 3:
            colour = (*colour, 1.0)
        if len(colour) != 4 or not all(0.0 <= c <= 1.0 for c in colour):
            raise FieldError(f"Appearance.colour is {self.colour!r}; it must be 3 or 4 numbers from 0 to 1")
        object.__setattr__(self, "colour", colour)
        if not 0.0 <= self.shininess <= 1.0:
            raise FieldError(f"Appearance.shininess is {self.shininess!r}; it must be from 0 to 1")

    @property
    def transparent(self) -> bool:
        """Whether it must be blended over what is behind it."""
        return self.colour[3] < 1.0


DEFAULT_APPEARANCE = Appearance()
