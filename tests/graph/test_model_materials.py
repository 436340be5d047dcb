"""How models look: colours, opacity, shine, textures, and what happens without them."""

from __future__ import annotations

import io
import logging
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from osgode.graph.appearance import Appearance
from osgode.graph.models import load_model

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
# First row at the top: red green / blue white.
PIXELS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)


def square(folder: Path, material: str) -> Path:
    """A textured square whose material is given in the words of an .mtl file."""
    (folder / "square.mtl").write_text(f"newmtl paint\n{material}\n")
    path = folder / "square.obj"
    path.write_text("mtllib square.mtl\nusemtl paint\n" + SQUARE)
    return path


def look(path: Path) -> Appearance:
    (drawable,) = load_model(path).drawables
    return drawable.appearance


def glb(folder: Path, **material: object) -> Path:
    mesh = trimesh.creation.box()
    uv = np.zeros((len(mesh.vertices), 2))
    mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=trimesh.visual.material.PBRMaterial(**material))
    mesh.export(folder / "box.glb")
    return folder / "box.glb"


@pytest.mark.parametrize(
    ("material", "colour"),
    [
        ("Kd 1 0.2 0", (1, 0.2, 0, 1)),
        ("Kd 0 0 0", (0, 0, 0, 1)),
        ("Kd 1 0.2 0\nd 0.25", (1, 0.2, 0, 0.25)),
        ("Kd 1 0.2 0\nd -halo 0.25", (1, 0.2, 0, 0.25)),
        ("Kd 1 0.2 0\nTr 0.25", (1, 0.2, 0, 0.75)),
        ("Kd 1 0.2 0\nd wrong", (1, 0.2, 0, 1)),
        ("Ka 1 1 1", (0.8, 0.8, 0.8, 1)),
    ],
)
def test_mtl_colours(tmp_path: Path, material: str, colour: tuple[float, ...]) -> None:
    """Diffuse colour and opacity of an .mtl become the colour."""
    assert look(square(tmp_path, material)).colour == pytest.approx(colour, abs=1 / 255)


def test_mtl_shine(tmp_path: Path) -> None:
    """A higher specular exponent is shinier; an exponent of 30 is a roughness of a half."""
    assert look(square(tmp_path, "Kd 1 1 1\nNs 30")).shininess == pytest.approx(0.5)
    assert look(square(tmp_path, "Kd 1 1 1\nNs 900")).shininess > 0.7
    assert look(square(tmp_path, "Kd 1 1 1")).shininess == Appearance().shininess


def test_mtl_texture(tmp_path: Path) -> None:
    """The texture named by an .mtl is loaded, first row at the top, white under it, uvs from the bottom left."""
    Image.fromarray(PIXELS).save(tmp_path / "checks.png")
    model = load_model(square(tmp_path, "map_Kd checks.png"))
    appearance, mesh = model.drawables[0].appearance, model.drawables[0].mesh
    assert appearance.texture is not None
    assert np.array_equal(appearance.texture.image, PIXELS)
    assert appearance.texture.name == "checks.png"
    assert appearance.colour == (1, 1, 1, 1)
    assert np.array_equal(mesh.uvs, mesh.vertices[:, :2])


def test_texture_with_alpha(tmp_path: Path) -> None:
    """An image with transparency keeps its fourth channel, whatever its mode."""
    image = Image.new("LA", (3, 2), (128, 64))
    image.save(tmp_path / "veil.png")
    texture = look(square(tmp_path, "map_Kd veil.png")).texture
    assert texture is not None
    assert texture.image.shape == (2, 3, 4)
    assert texture.image[0, 0].tolist() == [128, 128, 128, 64]


def test_missing_texture_is_logged(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A texture that isn't there costs a warning that names it, and the colour stays."""
    path = square(tmp_path, "Kd 1 0 0\nmap_Kd nowhere.png")
    with caplog.at_level(logging.WARNING, "osgode"):
        assert look(path).texture is None
    assert "nowhere.png" in caplog.text
    assert look(path).colour == (1, 0, 0, 1)


def test_broken_texture_is_logged(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A texture cut short costs a warning."""
    data = io.BytesIO()
    Image.fromarray(np.random.default_rng(1).integers(0, 255, (64, 64, 3), np.uint8)).save(data, "png")
    (tmp_path / "cut.png").write_bytes(data.getvalue()[:2000])
    with caplog.at_level(logging.WARNING, "osgode"):
        assert look(square(tmp_path, "map_Kd cut.png")).texture is None
    assert "left out" in caplog.text


def test_missing_material_file_is_logged(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A missing .mtl costs a warning that names it."""
    path = tmp_path / "alone.obj"
    path.write_text("mtllib gone.mtl\nusemtl paint\n" + SQUARE)
    with caplog.at_level(logging.WARNING, "osgode"):
        assert look(path) == Appearance()
    assert "gone.mtl" in caplog.text


def test_nothing_is_logged_when_all_is_well(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A complete model loads in silence."""
    Image.fromarray(PIXELS).save(tmp_path / "checks.png")
    with caplog.at_level(logging.WARNING):
        load_model(square(tmp_path, "Kd 1 1 1\nmap_Kd checks.png"))
    assert caplog.text == ""


def test_texture_coordinates_without_material(tmp_path: Path) -> None:
    """Texture coordinates alone don't make a texture."""
    path = tmp_path / "plain.obj"
    path.write_text(SQUARE)
    assert look(path) == Appearance()


def test_gltf_material(tmp_path: Path) -> None:
    """Colour factors are taken from linear light to the screen's curve, roughness becomes shine."""
    path = glb(tmp_path, baseColorFactor=[255, 128, 0, 128], roughnessFactor=0.3)
    appearance = look(path)
    # 128/255 of the light looks like 188/255 on the sRGB curve.
    assert appearance.colour == pytest.approx((1, 188 / 255, 0, 1), abs=0.005)
    assert appearance.shininess == pytest.approx(0.7)


def test_gltf_is_transparent_only_if_it_says_so(tmp_path: Path) -> None:
    """Opacity counts in the alpha mode BLEND alone, as glTF has it."""
    assert not look(glb(tmp_path, baseColorFactor=[255, 255, 255, 128])).transparent
    blended = look(glb(tmp_path, baseColorFactor=[255, 255, 255, 128], alphaMode="BLEND"))
    assert blended.colour[3] == pytest.approx(0.5, abs=0.01)


def test_gltf_texture(tmp_path: Path) -> None:
    """A texture inside of a .glb is loaded and shared by the parts that use it."""
    appearance = look(glb(tmp_path, baseColorTexture=Image.fromarray(PIXELS)))
    assert appearance.texture is not None
    assert np.array_equal(appearance.texture.image, PIXELS)


def test_materials_with_equal_images_share_a_texture(tmp_path: Path) -> None:
    """One image named by two materials is one Texture, so that it is uploaded once; another image is another."""
    for name, pixels in (("a.png", PIXELS), ("b.png", PIXELS[::-1])):
        Image.fromarray(pixels).save(tmp_path / name)
    named = ["a.png", "a.png", "b.png"]
    materials = (f"newmtl m{k}\nKd 1 {k / 2} 1\nmap_Kd {name}\n" for k, name in enumerate(named))
    (tmp_path / "m.mtl").write_text("".join(materials))
    vertices, faces = SQUARE.split("f", 1)
    parts = "".join(f"usemtl m{k}\nf {faces.splitlines()[0]}\n" for k in range(3))
    (tmp_path / "m.obj").write_text("mtllib m.mtl\n" + vertices + parts)
    textures = [each.appearance.texture for each in load_model(tmp_path / "m.obj").drawables]
    assert len(textures) == 3
    assert len(set(textures)) == 2


@pytest.mark.parametrize("ending", ["ply", "glb"])
def test_vertex_colours(tmp_path: Path, ending: str) -> None:
    """A mesh coloured by its vertices gets the colour that most of them have."""
    box = trimesh.creation.box()
    box.visual.vertex_colors = [[0, 255, 0, 255]] * 7 + [[255, 0, 0, 255]]
    box.export(tmp_path / f"box.{ending}")
    assert look(tmp_path / f"box.{ending}").colour == (0, 1, 0, 1)


def without_pillow(path: Path) -> subprocess.CompletedProcess[str]:
    """Load a model where Pillow can't be imported, and print how it looks."""
    code = (
        "import sys; sys.modules['PIL'] = None\n"
        "from osgode.graph.models import load_model\n"
        f"look = load_model({str(path)!r}).drawables[0].appearance\n"
        "print(look.colour, look.texture)"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_without_pillow(tmp_path: Path, kind: str) -> None:
    """Without Pillow a model loads without its textures, and one warning says what to install."""
    if kind == "obj":
        Image.fromarray(PIXELS).save(tmp_path / "checks.png")
        path = square(tmp_path, "Kd 1 0 0\nmap_Kd checks.png")
    else:
        path = glb(tmp_path, baseColorFactor=[255, 0, 0, 255], baseColorTexture=Image.fromarray(PIXELS))
    result = without_pillow(path)
    assert result.stdout == "(1.0, 0.0, 0.0, 1.0) None\n"
    assert result.stderr.count("osgode[render]") == 1


def test_without_pillow_and_without_textures(tmp_path: Path) -> None:
    """A model that needs no Pillow loads without it, and without a warning."""
    path = tmp_path / "plain.obj"
    path.write_text(SQUARE)
    result = without_pillow(path)
    assert result.stdout == "(0.8, 0.8, 0.8, 1.0) None\n"
    assert result.stderr == ""
