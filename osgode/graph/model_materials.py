"""How the parts of a model file look: its materials as appearances, its images as textures."""

from __future__ import annotations

import logging
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from osgode.graph.appearance import DEFAULT_APPEARANCE, Appearance, Texture
from osgode.maths import FloatArray

Textures: TypeAlias = dict[tuple[tuple[int, ...], bytes], Texture]
"""Textures by the shape and the bytes of their images."""

_log = logging.getLogger(__name__)


def appearance_of(file: Path, visual: Any, textures: Textures) -> Appearance:
    """The appearance that comes nearest to what trimesh read.

    Args:
        file: the model file, for messages.
        visual: a TextureVisuals or ColorVisuals of trimesh.
        textures: the model's textures so far; added to.
    """
    material = getattr(visual, "material", None)
    if material is None:  # colours per vertex or face, of which an Appearance holds one
        colour = np.asarray(visual.main_color) / 255 if visual.defined else None
        return DEFAULT_APPEARANCE if colour is None else _look(colour)
    if hasattr(material, "baseColorFactor"):
        return _gltf_appearance(file, material, textures)
    texture = _texture(file, material.image, textures)
    properties = material.kwargs
    if "kd" in properties:
        colour = np.asarray(material.diffuse) / 255
    else:  # trimesh would say dark grey
        colour = np.ones(4) if texture else np.array(DEFAULT_APPEARANCE.colour)
    colour[3] = _opacity(properties)
    # The specular exponent as a roughness, by the formula of trimesh's SimpleMaterial.to_pbr.
    shininess = 1 - (2 / (max(material.glossiness, 0.0) + 2)) ** 0.25 if "ns" in properties else None
    return _look(colour, texture, shininess)


def _gltf_appearance(file: Path, material: Any, textures: Textures) -> Appearance:
    factor = material.baseColorFactor
    colour = np.ones(4) if factor is None else np.asarray(factor) / 255
    # glTF gives factors in linear light and an Appearance has the screen's (the sRGB curve, IEC 61966-2-1).
    linear = colour[:3]
    screen = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    colour[:3] = np.round(screen, 6)  # so that 1 stays 1
    if material.alphaMode != "BLEND":
        colour[3] = 1.0
    roughness = material.roughnessFactor
    shininess = 0.0 if roughness is None else 1.0 - float(roughness)
    return _look(colour, _texture(file, material.baseColorTexture, textures), shininess)


def _look(colour: FloatArray, texture: Texture | None = None, shininess: float | None = None) -> Appearance:
    r, g, b, a = (float(c) for c in np.clip(colour, 0, 1))
    if shininess is None:
        return Appearance((r, g, b, a), texture)
    return Appearance((r, g, b, a), texture, shininess=min(max(shininess, 0.0), 1.0))


def _opacity(properties: dict[str, Any]) -> float:
    """The opacity of an .mtl material: ``d``, or 1 less ``Tr``; trimesh hands on both as it found them."""
    try:
        if "d" in properties:
            return float(properties["d"][-1])  # the last word: "d -halo 0.5" is allowed
        return 1.0 - float(properties["tr"][-1]) if "tr" in properties else 1.0
    except ValueError:
        return 1.0


def _texture(file: Path, image: Any, textures: Textures) -> Texture | None:
    """The texture of a PIL image, one and the same for equal images: materials that share one each open it anew."""
    if image is None or find_spec("PIL") is None:
        return None
    if image.format is None:  # not from a file: trimesh's plain grey, put where there is no material
        return None
    try:
        with_alpha = "A" in image.getbands() or "transparency" in image.info
        pixels = np.asarray(image.convert("RGBA" if with_alpha else "RGB"))
        texture = Texture(pixels, name=str(image.info.get("file_path", file.name)))
    except Exception as error:  # noqa: BLE001  (what a broken image raises depends on its format)
        _log.warning("%s: a texture can't be read and is left out: %s", file, error)
        return None
    return textures.setdefault((pixels.shape, pixels.tobytes()), texture)


def warn_of_textures(file: Path) -> None:
    """Say which textures trimesh has left out; it does so without a word."""
    if file.suffix.lower() == ".obj":
        named = [file.parent / name for name in _obj_textures(file)]
    else:
        named = [file] if b'"images"' in file.read_bytes() else []
    if named and find_spec("PIL") is None:
        _log.warning("%s: loaded without textures, because Pillow is missing; install osgode[render]", file)
        return
    for texture in named:
        if not texture.is_file():
            _log.warning("%s: there is no texture %s; it is left out", file, texture)


def _obj_textures(file: Path) -> list[str]:
    """The names of the textures in the material files of an .obj."""
    found = []
    for library in _words_after("mtllib", file)[:1]:  # trimesh reads no more than the first
        material = file.parent / library
        if material.is_file():
            found += _words_after("map_kd", material)
        else:
            _log.warning("%s: there is no material file %s; default colours are used", file, material)
    return found


def _words_after(keyword: str, file: Path) -> list[str]:
    lines = (line.strip() for line in file.read_text(encoding="utf-8", errors="replace").splitlines())
    pairs = (line.split(None, 1) for line in lines)
    return [pair[1] for pair in pairs if len(pair) > 1 and pair[0].lower() == keyword]
