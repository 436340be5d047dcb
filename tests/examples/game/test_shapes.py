"""Parts that models are made of: closed, outward, of the right size."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.examples.game.shapes import ball, block, lathed, placed, plate, rod

LOOK = oo.Appearance()


def corners(drawable):
    matrix = np.eye(4) if drawable.matrix is None else drawable.matrix
    points = drawable.mesh.vertices.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    return points[drawable.mesh.triangles]


def volume(drawable):
    """Of a closed surface whose triangles face outwards, by the divergence theorem."""
    a, b, c = np.moveaxis(corners(drawable), 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


CONE = [(0.0, 1.0), (0.5, 0.0), (0.0, 0.0)]
PIPE = [(0.3, -0.5), (0.3, 0.5), (0.5, 0.5), (0.5, -0.5), (0.3, -0.5)]


@pytest.mark.parametrize(
    ("drawable", "size"),
    [
        (lathed(CONE, LOOK, 200), math.pi * 0.25 / 3),
        (lathed(PIPE, LOOK, 200), math.pi * (0.25 - 0.09)),
        (plate([(0, 0), (2, 0), (2, 1), (0, 1)], 0.1, LOOK), 0.2),
        (plate([(0, 0), (0, 1), (2, 1), (2, 0)], 0.1, LOOK), 0.2),
        (block((1, 2, 3), (5, 5, 5), LOOK), 6.0),
    ],
    ids=["cone", "pipe", "plate", "plate the other way round", "block"],
)
def test_it_encloses_its_volume(drawable, size):
    assert volume(drawable) == pytest.approx(size, rel=2e-3)


@pytest.mark.parametrize("profile", [CONE, PIPE])
def test_normals_look_out_of_the_surface(profile):
    mesh = lathed(profile, LOOK).mesh
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles].astype(float), 1, 0)
    faces = np.cross(b - a, c - a)
    mean = mesh.normals[mesh.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", faces, mean) > -1e-9).all()


def test_parts_are_where_they_are_wanted():
    points = corners(rod(0.1, (1, 0, 0), (1, 4, 0), LOOK)).reshape(-1, 3)
    assert points.min(axis=0) == pytest.approx((0.9, 0.0, -0.1), abs=1e-6)
    assert points.max(axis=0) == pytest.approx((1.1, 4.0, 0.1), abs=1e-6)
    points = corners(ball(0.5, (1, 2, 3), LOOK)).reshape(-1, 3)
    assert (points.min(axis=0) + points.max(axis=0)) / 2 == pytest.approx((1, 2, 3), abs=1e-6)
    quarter = oo.Quat.from_axis_angle((0, 0, 1), math.pi / 2)
    moved = placed(placed(block((2, 1, 1), (0, 0, 0), LOOK), (3, 0, 0)), (0, 0, 1), quarter)
    points = corners(moved).reshape(-1, 3)
    assert points.min(axis=0) == pytest.approx((-0.5, 2.0, 0.5), abs=1e-6)
    assert points.max(axis=0) == pytest.approx((0.5, 4.0, 1.5), abs=1e-6)
