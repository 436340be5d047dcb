"""Model files: geometry, hierarchy, normals, seams, and what is refused."""

from __future__ import annotations

import base64
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from osgode.errors import ModelError
from osgode.graph.appearance import Appearance
from osgode.graph.models import Model, load_model
from osgode.graph.primitives import box_mesh
from osgode.maths import FloatArray

# A cube of edge 2 about (0, 0, 0): quads, counter-clockwise seen from outside, no normals.
CUBE = """
v -1 -1 -1
v  1 -1 -1
v  1  1 -1
v -1  1 -1
v -1 -1  1
v  1 -1  1
v  1  1  1
v -1  1  1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
f 2 3 7 6
"""

POINT = """ply
format ascii 1.0
element vertex 1
property float x
property float y
property float z
end_header
0 0 0
"""

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def write(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def volume(vertices: FloatArray, triangles: FloatArray) -> float:
    return float(np.linalg.det(vertices.astype(np.float64)[triangles]).sum() / 6)


def drawn_volume(model: Model) -> float:
    return sum(volume(d.mesh.vertices, d.mesh.triangles) for d in model.drawables)


# -- every format


@pytest.mark.parametrize("ending", [".obj", ".glb", ".gltf", ".stl", ".ply", ".STL"])
def test_a_box_in_every_format(tmp_path: Path, ending: str) -> None:
    """The same box comes out of each format: size, volume, 8 corners and 12 triangles to collide with."""
    path = tmp_path / f"box{ending}"
    box = trimesh.creation.box((1, 2, 3))
    if ending == ".gltf":
        for name, data in trimesh.exchange.gltf.export_gltf(trimesh.Scene(box)).items():
            (tmp_path / (path.name if name == "model.gltf" else name)).write_bytes(data)
    else:
        box.export(path, file_type=ending[1:].lower())
    model = load_model(path)
    assert model.name == path.name
    assert model.bounds == ((-0.5, -1, -1.5), (0.5, 1, 1.5))
    assert (len(model.vertices), len(model.triangles)) == (8, 12)
    assert (model.vertices.dtype, model.triangles.dtype) == (np.float64, np.int64)
    assert volume(model.vertices, model.triangles) == pytest.approx(6)
    assert drawn_volume(model) == pytest.approx(6)
    assert [d.matrix for d in model.drawables] == [None]


def test_sharp_edges_without_normals(tmp_path: Path) -> None:
    """A cube whose file has no normals is drawn with flat faces, and collides with 8 shared corners."""
    model = load_model(write(tmp_path, "cube.obj", CUBE))
    mesh = model.drawables[0].mesh
    assert len(mesh.vertices) == 24
    assert np.abs(mesh.normals).max(axis=1) == pytest.approx(np.ones(24))
    assert np.einsum("ni,ni->n", mesh.normals, mesh.vertices) == pytest.approx(np.ones(24))
    assert len(model.vertices) == 8


def test_normals_of_the_file_are_kept(tmp_path: Path) -> None:
    """Where a file has normals they are used, though the geometry says otherwise, with length 1."""
    text = SQUARE + "vn 0 3 4\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n"
    mesh = load_model(write(tmp_path, "tilted.obj", text)).drawables[0].mesh
    assert mesh.normals == pytest.approx(np.tile([0, 0.6, 0.8], (len(mesh.normals), 1)))


def test_normals_that_are_nothing_are_computed(tmp_path: Path) -> None:
    """A normal of length 0 in the file is replaced."""
    text = SQUARE + "vn 0 0 0\nvn 0 1 0\nf 1//1 2//2 3//2\n"
    mesh = load_model(write(tmp_path, "bad.obj", text)).drawables[0].mesh
    assert mesh.normals == pytest.approx(np.tile([0, 0, 1], (3, 1)))


def test_texture_seams_are_kept(tmp_path: Path) -> None:
    """A vertex with two texture coordinates stays two vertices to draw, and is one to collide with."""
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.25 0.5\nf 1/1 2/2 3/3\nf 1/5 3/3 4/4\n"
    model = load_model(write(tmp_path, "seam.obj", text))
    mesh = model.drawables[0].mesh
    uv = {tuple(map(tuple, pair)) for pair in np.stack([mesh.vertices[:, :2], mesh.uvs], axis=1).tolist()}
    assert uv == {((0, 0), (0, 0)), ((1, 0), (1, 0)), ((1, 1), (1, 1)), ((0, 0), (0.25, 0.5)), ((0, 1), (0, 1))}
    assert len(model.vertices) == 4


def test_round_things_without_normals_are_smooth(tmp_path: Path) -> None:
    """A sphere in an .stl, which has no shared vertices, gets smooth normals."""
    trimesh.creation.icosphere(3, 2.0).export(tmp_path / "ball.stl")
    mesh = load_model(tmp_path / "ball.stl").drawables[0].mesh
    assert np.einsum("ni,ni->n", mesh.normals, mesh.vertices) == pytest.approx(np.full(len(mesh.normals), 2), rel=1e-3)
    assert len(mesh.vertices) == 642


# -- hierarchy


def test_a_hierarchy_is_flattened(tmp_path: Path) -> None:
    """Parts are moved to where the nodes of the file put them, and the same part may stand twice."""
    scene = trimesh.Scene()
    box = trimesh.creation.box((1, 1, 1))
    outer = trimesh.transformations.translation_matrix((10, 0, 0))
    turn = trimesh.transformations.rotation_matrix(math.pi / 2, (0, 0, 1))
    inner = turn @ trimesh.transformations.translation_matrix((0, 5, 0)) @ np.diag([1, 2, 1, 1])
    scene.graph.update(frame_from="world", frame_to="outer", matrix=outer)
    scene.add_geometry(box, node_name="a", geom_name="box", parent_node_name="outer", transform=inner)
    scene.graph.update(frame_from="world", frame_to="b", geometry="box", matrix=np.identity(4))
    scene.export(tmp_path / "two.glb")
    model = load_model(tmp_path / "two.glb", scale=0.5)
    assert len(model.vertices) == 16
    # The second: 5 along Y, stretched by 2, turned to -X, 10 along X; all halved.
    assert model.bounds[0] == pytest.approx((-0.25, -0.25, -0.25))
    assert model.bounds[1] == pytest.approx((3.0, 0.25, 0.25))
    assert volume(model.vertices, model.triangles) == pytest.approx((1 + 2) / 8)
    assert len(model.drawables) == 1
    assert drawn_volume(model) == pytest.approx((1 + 2) / 8)


def test_a_mirrored_part_stays_outside_out(tmp_path: Path) -> None:
    """A part mirrored by its node keeps a positive volume and normals that point outwards."""
    scene = trimesh.Scene()
    ball = trimesh.creation.icosphere(2)
    ball.vertex_normals  # noqa: B018  (asked for, so that they are exported)
    scene.add_geometry(ball, transform=np.diag([-1, 2, 3, 1]))
    scene.export(tmp_path / "mirrored.glb", include_normals=True)
    model = load_model(tmp_path / "mirrored.glb")
    mesh = model.drawables[0].mesh
    assert volume(model.vertices, model.triangles) == pytest.approx(6 * volume(ball.vertices, ball.faces))
    assert drawn_volume(model) == pytest.approx(6 * volume(ball.vertices, ball.faces), rel=1e-5)
    gradient = mesh.vertices / np.array([1, 4, 9])  # of the ellipsoid x^2 + y^2/4 + z^2/9
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    assert mesh.normals == pytest.approx(gradient, abs=0.02)
    lengths = np.linalg.norm(mesh.normals.astype(np.float64), axis=1)
    assert lengths == pytest.approx(np.ones(len(lengths)))


def test_parts_that_look_alike_are_drawn_together(tmp_path: Path) -> None:
    """One drawable per appearance, whatever the number of parts; collision has everything."""
    write(tmp_path, "two.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nnewmtl same\nKd 1 0 0\n")
    text = "mtllib two.mtl\n" + SQUARE + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl same\nf 2 3 4\n"
    model = load_model(write(tmp_path, "two.obj", text))
    found = {d.appearance.colour: len(d.mesh.triangles) for d in model.drawables}
    assert found == {(1, 0, 0, 1): 2, (0, 0, 1, 1): 1}
    assert len(model.triangles) == 3


# -- what else


def test_scale(tmp_path: Path) -> None:
    """The scale multiplies every coordinate."""
    path = write(tmp_path, "cube.obj", CUBE)
    assert load_model(path, scale=0.25).bounds == ((-0.25,) * 3, (0.25,) * 3)
    for scale in (0, -1, math.nan, math.inf):
        with pytest.raises(ModelError, match="scale"):
            load_model(path, scale=scale)


def test_leaves_share_what_they_show(tmp_path: Path) -> None:
    """Each leaf of a model is a new node with the same drawables."""
    model = load_model(str(write(tmp_path, "cube.obj", CUBE)))
    first, second = model.to_leaf(), model.to_leaf(name="other")
    assert first is not second
    assert (first.name, second.name) == ("cube.obj", "other")
    assert tuple(first.drawables()) == tuple(second.drawables()) == model.drawables


def test_collision_arrays_are_read_only(tmp_path: Path) -> None:
    """Nobody changes a shared model by accident."""
    model = load_model(write(tmp_path, "cube.obj", CUBE))
    for array in (model.vertices, model.triangles):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_triangles_without_area_are_left_out(tmp_path: Path) -> None:
    """Triangles that are a point or a line are neither drawn nor collided with."""
    # The last two vertices are in line with the first, though not to the last digit.
    text = SQUARE + "v 0.2 0.3 1\nv 1 1.5 5\nf 1 2 3\nf 1 1 2\nf 1 5 6\nf 4 4 4\n"
    model = load_model(write(tmp_path, "thin.obj", text))
    assert len(model.triangles) == 1
    assert len(model.vertices) == 3
    assert [len(d.mesh.triangles) for d in model.drawables] == [1]


def test_a_model_is_no_heavier_than_the_primitive(tmp_path: Path) -> None:
    """An exported box comes back with as many vertices as the one it was made from."""
    box = box_mesh()
    trimesh.Trimesh(box.vertices, box.triangles, vertex_normals=box.normals, process=False).export(tmp_path / "b.glb")
    assert len(load_model(tmp_path / "b.glb").drawables[0].mesh.vertices) == 24


# -- what is refused


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.obj", "", "empty.obj"),
        ("points.obj", "v 0 0 0\nv 1 0 0\n", "no triangles"),
        ("points.ply", POINT, "no triangles"),
        ("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangles"),
        ("wild.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "finite"),
        ("huge.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "below 1e"),
        ("uv.obj", SQUARE + "vt nan 0\nf 1/1 2/1 3/1\n", "texture coordinates"),
        ("short.obj", SQUARE + "f 1 2 9\n", "short.obj"),
        ("broken.glb", "not binary at all", "can't be read"),
        ("broken.gltf", "{", "can't be read"),
        ("broken.ply", "ply\n", "can't be read"),
        ("broken.stl", "so\x00lid", "broken.stl"),
    ],
)  # fmt: skip
def test_bad_files_are_refused(tmp_path: Path, name: str, content: str, words: str) -> None:
    """A file that can't be used raises an error with the file's name and what is wrong."""
    path = write(tmp_path, name, content)
    with pytest.raises(ModelError, match=words) as caught:
        load_model(path)
    assert str(path) in str(caught.value)


def test_indices_out_of_range_are_refused(tmp_path: Path) -> None:
    """Triangles that refer to vertices that aren't there are refused, also where trimesh takes them."""
    data = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32).tobytes() + np.array([0, 1, 7], np.uint32).tobytes()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "data:;base64," + base64.b64encode(data).decode(), "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    path = write(tmp_path, "out.gltf", json.dumps(document))
    with pytest.raises(ModelError, match=r"out\.gltf"):
        load_model(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    """A file that isn't there is named with where it was looked for."""
    with pytest.raises(ModelError, match=r"house\.obj.*no such file.*" + tmp_path.name):
        load_model(tmp_path / "house.obj")


@pytest.mark.parametrize("name", ["house.fbx", "house"])
def test_unknown_endings_are_refused_with_what_is_supported(tmp_path: Path, name: str) -> None:
    """Another kind of file is refused, and the message lists what can be read."""
    with pytest.raises(ModelError, match=r"\.obj, \.glb, \.gltf, \.stl, \.ply"):
        load_model(tmp_path / name)


def test_importing_models_does_not_import_trimesh() -> None:
    """Neither trimesh nor Pillow is imported before the first model is loaded."""
    code = "import sys, osgode.graph.models; print({'trimesh', 'PIL'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "set()\n"


def test_default_appearance(tmp_path: Path) -> None:
    """A file that says nothing of looks is drawn in the default appearance."""
    assert load_model(write(tmp_path, "cube.obj", CUBE)).drawables[0].appearance == Appearance()
