"""Meshes of the primitives, checked by geometry."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.graph.mesh import Mesh
from osgode.graph.primitives import (
    RINGS,
    SEGMENTS,
    box_mesh,
    capsule_mesh,
    cylinder_mesh,
    rectangle_mesh,
    sphere_mesh,
)

POLYGON = SEGMENTS / (2 * math.pi) * math.sin(2 * math.pi / SEGMENTS)
"""The area of the regular polygon inscribed in a circle, as a share of the circle's."""

SOLIDS = {
    "box": box_mesh((1, 2, 3)),
    "unit box": box_mesh(),
    "sphere": sphere_mesh(2),
    "cylinder": cylinder_mesh(0.5, 3),
    "capsule": capsule_mesh(0.5, 2),
    "capsule without length": capsule_mesh(0.5, 0),
}
EVERY = {**SOLIDS, "rectangle": rectangle_mesh(2, 3)}
solids = pytest.mark.parametrize("mesh", SOLIDS.values(), ids=SOLIDS.keys())
every = pytest.mark.parametrize("mesh", EVERY.values(), ids=EVERY.keys())


def corners(mesh: Mesh) -> np.ndarray:
    return mesh.vertices.astype(np.float64)[mesh.triangles]


def volume(mesh: Mesh) -> float:
    """The sum of the signed volumes of the tetrahedra from the origin to each triangle."""
    return float(np.linalg.det(corners(mesh)).sum() / 6)


def inscribed_sphere_volume(radius: float) -> float:
    """The volume of the frustums between the rings of the sphere, with polygons for circles."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, RINGS + 1)
    r, z = radius * np.cos(angles), radius * np.sin(angles)
    frustums = math.pi / 3 * np.diff(z) * (r[:-1] ** 2 + r[:-1] * r[1:] + r[1:] ** 2)
    return float(POLYGON * frustums.sum())


@solids
def test_closed(mesh: Mesh) -> None:
    """Every edge is walked once in each direction: the surface is closed, exactly, and faces outwards."""
    _, places = np.unique(mesh.vertices, axis=0, return_inverse=True)
    triangles = places.reshape(-1)[mesh.triangles]
    edges = Counter(zip(triangles.ravel().tolist(), np.roll(triangles, -1, axis=1).ravel().tolist(), strict=True))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)


@every
def test_normals_are_of_length_1_and_on_the_side_of_the_triangles(mesh: Mesh) -> None:
    """Each vertex normal has length 1 and leans the same way as the triangles that use it."""
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(np.ones(len(mesh.normals)), abs=1e-6)
    at = corners(mesh)
    faces = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    assert (np.linalg.norm(faces, axis=1) > 1e-6).all()
    assert (np.einsum("mi,mki->mk", faces, mesh.normals[mesh.triangles]) > 0).all()


@every
def test_texture_coordinates_lie_between_0_and_1_and_reach_both(mesh: Mesh) -> None:
    """Without a texture scale the texture is stretched once over each face."""
    assert mesh.uvs.min(axis=0) == pytest.approx([0, 0], abs=1e-6)
    assert mesh.uvs.max(axis=0) == pytest.approx([1, 1], abs=1e-6)


@every
def test_texture_is_never_mirrored(mesh: Mesh) -> None:
    """Seen from outside, u and v turn counter-clockwise on every triangle."""
    uv = mesh.uvs.astype(np.float64)[mesh.triangles]
    first, second = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 1e-6).all()


@every
def test_every_triangle_of_a_face_has_its_own_piece_of_texture(mesh: Mesh) -> None:
    """No triangle spans the seam: none covers more than half of the texture along u unless its face is flat."""
    uv = mesh.uvs[mesh.triangles]
    widths = uv[:, :, 0].max(axis=1) - uv[:, :, 0].min(axis=1)
    round_ones = np.ptp(mesh.normals[mesh.triangles], axis=1).max(axis=1) > 1e-6
    assert (widths[round_ones] <= 1 / SEGMENTS + 1e-6).all()


def test_box_by_numbers() -> None:
    """A box has 24 vertices, 12 triangles, its size, and its volume."""
    mesh = SOLIDS["box"]
    assert (len(mesh.vertices), len(mesh.triangles)) == (24, 12)
    assert mesh.bounds == ((-0.5, -1, -1.5), (0.5, 1, 1.5))
    assert volume(mesh) == pytest.approx(6)


def test_box_side_faces_stand_upright() -> None:
    """On the four side faces v grows with Y, and on the top u grows with X."""
    mesh = box_mesh()
    side = np.abs(mesh.normals[:, 1]) < 0.5
    assert np.array_equal(mesh.uvs[side, 1] > 0.5, mesh.vertices[side, 1] > 0)
    top = mesh.normals[:, 1] > 0.5
    assert np.array_equal(mesh.uvs[top, 0] > 0.5, mesh.vertices[top, 0] > 0)


def test_box_texture_by_the_metre() -> None:
    """With a texture scale each face holds as many repeats as it has metres over that scale."""
    mesh = box_mesh((2, 6, 10), (2.0, 0.5))
    repeats = {tuple(np.round(n)): mesh.uvs[(mesh.normals == n).all(axis=1)].max(axis=0).tolist() for n in mesh.normals}
    assert repeats[1, 0, 0] == repeats[-1, 0, 0] == [5, 12]  # 10 wide (Z), 6 high (Y)
    assert repeats[0, 1, 0] == repeats[0, -1, 0] == [1, 20]  # 2 wide (X), 10 deep (Z)
    assert repeats[0, 0, 1] == repeats[0, 0, -1] == [1, 12]  # 2 wide (X), 6 high (Y)


def test_sphere_by_numbers() -> None:
    """All vertices and normals of a sphere lie on it, and the volume is that of the inscribed solid."""
    mesh = SOLIDS["sphere"]
    assert np.linalg.norm(mesh.vertices, axis=1) == pytest.approx(np.full(len(mesh.vertices), 2.0), abs=1e-6)
    assert mesh.normals == pytest.approx(mesh.vertices / 2, abs=1e-6)
    assert volume(mesh) == pytest.approx(inscribed_sphere_volume(2), rel=1e-5)
    assert volume(mesh) == pytest.approx(4 / 3 * math.pi * 8, rel=0.03)


def test_sphere_stands_on_its_south_pole() -> None:
    """The texture's bottom is at -Y and its top at +Y."""
    mesh = sphere_mesh()
    assert mesh.uvs[:, 1] == pytest.approx(0.5 + np.arcsin(mesh.vertices[:, 1].clip(-1, 1)) / math.pi, abs=1e-3)


def test_cylinder_by_numbers() -> None:
    """A cylinder lies along Z, with the volume of the prism over the inscribed polygon."""
    mesh = SOLIDS["cylinder"]
    assert mesh.bounds == ((-0.5, -0.5, -1.5), (0.5, 0.5, 1.5))
    assert volume(mesh) == pytest.approx(POLYGON * math.pi * 0.25 * 3, rel=1e-5)
    flat = np.abs(mesh.normals[:, 2]) > 0.5
    assert np.abs(mesh.vertices[flat, 2]) == pytest.approx(np.full(flat.sum(), 1.5))
    assert mesh.normals[~flat, :2] == pytest.approx(mesh.vertices[~flat, :2] / 0.5, abs=1e-6)


def test_capsule_by_numbers() -> None:
    """A capsule of radius r and length l reaches l/2 + r along Z and has the volume of its three parts."""
    mesh = SOLIDS["capsule"]
    assert mesh.bounds == ((-0.5, -0.5, -1.5), (0.5, 0.5, 1.5))
    expected = POLYGON * math.pi * 0.25 * 2 + inscribed_sphere_volume(0.5)
    assert volume(mesh) == pytest.approx(expected, rel=1e-5)


@given(st.floats(0.05, 20), st.floats(0, 20).map(lambda x: round(x, 6)))
def test_capsule_vertices_lie_on_the_capsule(radius: float, length: float) -> None:
    """Every vertex is one radius from the segment between the centres of the caps, straight along its normal."""
    mesh = capsule_mesh(radius, length)
    centres = mesh.vertices * (0, 0, 1)
    centres[:, 2] = centres[:, 2].clip(-length / 2, length / 2)
    assert mesh.vertices == pytest.approx(centres + radius * mesh.normals, abs=1e-5 * (1 + radius + length))


def test_capsule_texture_keeps_its_proportions() -> None:
    """Along the outline v is the share of the outline's length: the middle part takes l / (l + pi r)."""
    mesh = capsule_mesh(0.5, 2)
    outline = 2 + math.pi * 0.5
    waist = np.isclose(np.abs(mesh.vertices[:, 2]), 1)
    v = np.unique(np.round(mesh.uvs[waist, 1], 5))
    assert v == pytest.approx([math.pi * 0.25 / outline, 1 - math.pi * 0.25 / outline], abs=1e-5)


@pytest.mark.parametrize(
    ("mesh", "around", "along"),
    [
        (sphere_mesh(1, (0.5, 0.5)), 13, math.pi / 0.5),  # 2 pi / 0.5 = 12.57 is rounded to a whole number
        (capsule_mesh(1, 2, (1.0, 2.0)), 6, (math.pi + 2) / 2),
        (sphere_mesh(0.01, (5.0, 5.0)), 1, math.pi * 0.01 / 5),  # never less than once around
    ],
)
def test_round_textures_by_the_metre(mesh: Mesh, around: int, along: float) -> None:
    """Around a body of revolution a texture repeats a whole number of times, along it as the metres say."""
    assert mesh.uvs.max(axis=0) == pytest.approx([around, along], rel=1e-5)


def test_cylinder_ends_by_the_metre() -> None:
    """On the flat ends of a cylinder a repeat has the same metres as elsewhere."""
    mesh = cylinder_mesh(2, 3, (0.5, 0.25))
    flat = mesh.normals[:, 2] > 0.5
    assert mesh.uvs[flat] == pytest.approx(mesh.vertices[flat, :2] / (0.5, 0.25), abs=1e-5)


def test_rectangle_by_numbers() -> None:
    """A rectangle faces +Z; with a texture scale its repeats are counted from the middle."""
    mesh = rectangle_mesh(4, 2, (2.0, 0.5))
    assert mesh.bounds == ((-2, -1, 0), (2, 1, 0))
    assert mesh.normals.tolist() == [[0, 0, 1]] * 4
    assert mesh.uvs.tolist() == (mesh.vertices[:, :2] / (2.0, 0.5)).tolist()


def test_equal_arguments_share_one_mesh() -> None:
    """Meshes are compared by identity, so equal ones must be the same object."""
    assert box_mesh((1, 2, 3)) is box_mesh((1.0, 2.0, 3.0))
    assert capsule_mesh(1, 2) is capsule_mesh(1.0, 2.0)
    assert capsule_mesh(1, 2) is not capsule_mesh(1, 2.5)
    assert sphere_mesh() is sphere_mesh()


@pytest.mark.parametrize(
    "mesh",
    [sphere_mesh(), sphere_mesh(0.3), cylinder_mesh(0.5, 2.0), capsule_mesh(0.3, 0.8), capsule_mesh(0.4, 0.0)],
    ids=lambda mesh: f"{mesh.name}-{mesh.radius:.1f}",
)
def test_simpler_meshes(mesh: Mesh) -> None:
    """Fewer triangles within the same solid; seen from nowhere is their outline off by more than they say."""
    directions = np.random.default_rng(4).normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    outline = (directions @ mesh.vertices.T.astype(float)).max(axis=1)
    assert len(mesh.simpler) == 2
    before = 0
    for simpler, off in mesh.simpler:
        missing = outline - (directions @ simpler.vertices.T.astype(float)).max(axis=1)
        assert 0.1 * off < missing.max() <= off
        assert before < len(simpler.triangles) < len(mesh.triangles) / 1.5
        assert volume(simpler) > 0
        before = len(simpler.triangles)
