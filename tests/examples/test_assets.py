"""The textures and models that the examples use: what the program makes, and fit for use."""

import filecmp

import numpy as np
import pytest
import trimesh
from PIL import Image

from osgode.examples.make_assets import ASSETS, MODELS
from osgode.examples.make_assets.house import DOOR_WIDTH, HEAD, WIDTH
from osgode.examples.make_assets.terrain import BOWL, FLAT
from osgode.examples.make_assets.textures import TEXTURES, to_bytes

SOLIDS = ("house", "hull")


def load(name):
    """The model's parts as trimesh reads them, untouched."""
    return list(trimesh.load_scene(ASSETS / f"{name}.obj", process=False).geometry.values())


def corners(name):
    """The corners of all the model's triangles: (n, 3, 3)."""
    return np.concatenate([part.vertices[part.faces] for part in load(name)])


def volumes_of_solids(triangles):
    """The volume of each connected set of triangles, and whether every edge of it is walked once in each direction."""
    places, indices = np.unique(np.round(triangles.reshape(-1, 3), 4), axis=0, return_inverse=True)
    indices = indices.reshape(-1, 3)
    label = np.arange(len(places))
    while True:  # each place takes the smallest label of its triangles until none changes
        smallest = label.copy()
        np.minimum.at(smallest, indices.ravel(), np.repeat(label[indices].min(axis=1), 3))
        if (smallest == label).all():
            break
        label = smallest
    of_triangle = label[indices[:, 0]]
    result = []
    for solid in np.unique(of_triangle):
        own = indices[of_triangle == solid]
        edges = np.concatenate([own[:, [k, (k + 1) % 3]] for k in range(3)])
        walked = {tuple(edge) for edge in edges.tolist()}
        closed = len(walked) == len(edges) and walked == {(b, a) for a, b in walked}
        a, b, c = (places[own[:, k]] for k in range(3))
        result.append((float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6), closed))
    return result


def hits(triangles, start, end):
    """How many triangles a segment goes through, by Moeller and Trumbore's method."""
    way = np.subtract(end, start)
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(way, second)
    determinant = np.einsum("ij,ij->i", first, normal)
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel to the triangle: no hit
        origin = np.subtract(start, triangles[:, 0])
        u = np.einsum("ij,ij->i", origin, normal) / determinant
        across = np.cross(origin, first)
        v = across @ way / determinant
        t = np.einsum("ij,ij->i", second, across) / determinant
        return int(((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)).sum())


@pytest.mark.parametrize("name", TEXTURES)
def test_the_committed_texture_is_what_the_program_draws(name):
    committed = np.asarray(Image.open(ASSETS / f"{name}.png"))
    drawn = to_bytes(TEXTURES[name]())
    assert committed.shape == drawn.shape
    # Another processor's sine may differ in its last digit, and one pixel in a million end on the other side of a half.
    assert np.mean(committed != drawn) < 1e-4


@pytest.mark.parametrize("model", MODELS)
def test_the_committed_model_is_what_the_program_builds(model, tmp_path):
    name = model.__name__
    model().write(tmp_path / f"{name}.obj")
    for file in (f"{name}.obj", f"{name}.mtl"):
        assert filecmp.cmp(tmp_path / file, ASSETS / file, shallow=False), file


def test_the_folder_holds_what_the_program_makes_and_is_small():
    names = {f"{name}.png" for name in TEXTURES}
    names |= {f"{model.__name__}{ending}" for model in MODELS for ending in (".obj", ".mtl")}
    files = [file for file in ASSETS.iterdir() if file.is_file()]
    assert names <= {file.name for file in files}
    assert sum(file.stat().st_size for file in files if file.name in names) < 3e6


@pytest.mark.parametrize("name", [name for name in TEXTURES if name != "crate"])
def test_a_texture_shows_no_seam_where_it_repeats(name):
    """From the last row to the first there is no greater step than between some two rows within; so for columns."""
    picture = TEXTURES[name]()
    for axis in (0, 1):
        steps = np.abs(picture - np.roll(picture, 1, axis=axis)).mean(axis=(1 - axis, 2))
        assert steps[0] <= 1.1 * steps[1:].max()


@pytest.mark.parametrize("name", [model.__name__ for model in MODELS])
def test_every_part_has_texture_coordinates_and_finds_its_texture(name):
    parts = load(name)
    assert len(parts) >= 1
    for part in parts:
        assert part.visual.uv.shape == (len(part.vertices), 2)
        assert np.ptp(part.visual.uv, axis=0).min() > 0
        named = "map_kd" in part.visual.material.kwargs
        assert not named or part.visual.material.image is not None
    assert any(part.visual.material.image is not None for part in parts)


@pytest.mark.parametrize("name", SOLIDS)
def test_every_part_of_a_solid_is_closed_and_faces_outward(name):
    solids = volumes_of_solids(corners(name))
    assert len(solids) > 1
    for volume, closed in solids:
        assert closed
        assert volume > 0


def test_one_can_walk_into_the_house_but_not_through_its_walls():
    triangles = corners("house")
    ahead = WIDTH / 2 + 2
    side = DOOR_WIDTH / 2 - 0.02
    for x in (-side, 0.003, side):
        for y in (0.1, 1.0, HEAD - 0.02):
            assert hits(triangles, (x, y, ahead), (x, y, 0.0)) == 0
    assert hits(triangles, (DOOR_WIDTH, 1.01, ahead), (DOOR_WIDTH, 1.01, 0.0)) == 2
    assert hits(triangles, (0.003, 1.01, -ahead), (0.003, 1.01, 0.0)) == 2
    assert hits(triangles, (0.503, 9.0, 0.507), (0.503, 1.0, 0.507)) == 2


def test_the_hull_has_the_measures_of_a_car():
    low, high = corners("hull").reshape(-1, 3).min(axis=0), corners("hull").reshape(-1, 3).max(axis=0)
    assert high - low == pytest.approx((1.9, 1.35, 4.3), abs=0.06)
    assert low[0] == pytest.approx(-high[0])


def test_the_terrain_faces_up_is_level_in_the_middle_and_has_a_bowl():
    triangles = corners("terrain")
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert (normals[:, 1] > 0).all()
    assert 9_000 < len(triangles) < 11_000
    points = triangles.reshape(-1, 3)
    assert points[np.hypot(points[:, 0], points[:, 2]) < FLAT, 1] == pytest.approx(0)
    x, z, radius, depth = BOWL
    away = np.hypot(points[:, 0] - x, points[:, 2] - z)
    assert points[away < 0.1 * radius, 1] == pytest.approx(-depth, abs=1e-3)
    rim = points[(away > radius) & (away < radius + 2), 1]
    assert rim.min() > -0.5
