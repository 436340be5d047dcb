"""Meshes of arrows."""

import math

import numpy as np
import pytest

from osgode.graph.arrows import HEAD, HIGH, RING, SHAFT, TIP, arrow_mesh

ALL = [(slides, turns) for slides in (False, True) for turns in (False, True)]


@pytest.mark.parametrize(("slides", "turns"), ALL)
def test_it_points_along_z_from_the_origin(slides, turns):
    mesh = arrow_mesh(slides=slides, turns=turns)
    assert mesh.vertices[:, 2].min() == 0
    assert mesh.vertices[:, 2].max() == 1
    assert np.hypot(*mesh.vertices[:, :2].T)[mesh.vertices[:, 2] == 1] == pytest.approx(0)
    assert arrow_mesh(slides=slides, turns=turns) is mesh


@pytest.mark.parametrize(("slides", "turns"), ALL)
def test_its_faces_look_where_its_normals_point(slides, turns):
    mesh = arrow_mesh(slides=slides, turns=turns)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(float) for k in range(3))
    across = np.cross(b - a, c - a)
    real = np.linalg.norm(across, axis=1) > 1e-9
    inwards = np.einsum("ij,ij->i", across, mesh.normals[mesh.triangles].mean(axis=1))[real]
    assert inwards.min() > 0
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1, abs=1e-6)


def test_what_slides_has_a_second_head():
    def wide(mesh):
        """Where along the arrow its heads begin."""
        radii = np.hypot(*mesh.vertices[:, :2].T)
        return sorted({round(float(z), 5) for z in mesh.vertices[np.isclose(radii, HEAD, atol=1e-6), 2]})

    assert len(wide(arrow_mesh())) == 1
    assert len(wide(arrow_mesh(slides=True))) == 2


def test_the_ring_goes_round_by_the_right_hand_rule():
    """Three quarters round from +x over +y to -y, where its head points on towards +x."""
    vertices = arrow_mesh(turns=True).vertices
    ring = vertices[np.hypot(*vertices[:, :2].T) > RING / 2]
    assert ring[:, 2].mean() == pytest.approx(HIGH, abs=0.01)
    angles = np.degrees(np.arctan2(ring[:, 1], ring[:, 0])) % 360
    tube = ring[np.abs(np.hypot(*ring[:, :2].T) - RING) <= 1.01 * SHAFT]
    assert np.degrees(np.arctan2(tube[:, 1], tube[:, 0])).min() < -90 + math.degrees(TIP / RING)
    tip = ring[np.argmin(np.linalg.norm(ring - (TIP, -RING, HIGH), axis=1))]
    assert tip == pytest.approx((TIP, -RING, HIGH), abs=1e-6)
    free = (angles > 271 + math.degrees(TIP / RING)) & (angles < 354)
    assert not free.any()
