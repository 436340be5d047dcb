"""Textures from image files."""

import builtins

import numpy as np
import pytest

import osgode as oo

PIL_Image = pytest.importorskip("PIL.Image")


def test_pixels_come_as_they_are(tmp_path):
    """The first row of the file is the first row of the texture, with or without opacity."""
    pixels = np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4)
    for channels in (3, 4):
        PIL_Image.fromarray(pixels[..., :channels]).save(tmp_path / "a.png")
        assert np.array_equal(oo.load_texture(tmp_path / "a.png").image, pixels[..., :channels])


def test_what_is_no_image_is_named(tmp_path):
    (tmp_path / "b.png").write_text("no image")
    for name in ("b.png", "missing.png"):
        with pytest.raises(oo.ModelError, match=name):
            oo.load_texture(tmp_path / name)


def test_without_pillow_the_extra_is_named(monkeypatch):
    real = builtins.__import__

    def without(name, *rest):
        if name.startswith("PIL"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(oo.MissingExtraError, match=r"osgode\[render\]"):
        oo.load_texture("a.png")
