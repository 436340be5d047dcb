"""The mark at a body's centre of mass: where it is seen, and how it looks."""

import math

import numpy as np
import pytest

import osgode as oo
from tests.nodes.test_body_parts import dumbbell, near


def test_the_mark_follows_the_centre_of_mass():
    """Also in the picture, when it moves; what is attached to it goes along."""
    world, body, _left, right = dumbbell(position=(0, 5, 0))
    mark = body.attach(oo.CentreOfMass(radius=0.3))
    leaf = mark.attach(oo.Leaf([oo.box_drawable((0.1, 0.1, 0.1))]))
    assert leaf.parent is mark
    cull = oo.CullVisitor(world)

    def drawn():
        view = oo.View(oo.Pose(oo.Vec3(0, 5, 20)))
        frame = cull.cull(view, (100, 100))
        marked = [bin_ for bin_ in frame.opaque if bin_.appearance.texture is not None]
        assert len(marked) == 1
        return tuple(float(number) for number in marked[0].matrices[0][:3, 3])

    assert mark.pose.position == (1, 0, 0)
    assert drawn() == near((1, 5, 0), 1e-5)
    right.position = (4, 0, 0)
    assert drawn() == near((2, 5, 0), 1e-5)
    body.auto_recentre = False
    body.detach(right)
    assert drawn() == near((2, 5, 0), 1e-5)
    body.recentre()
    assert drawn() == near((0, 5, 0), 1e-5)
    body.fixed_mass = oo.Mass(1.0, (0, 3, 0))
    assert drawn() == near((0, 8, 0), 1e-5)
    body.position = (1, 5, 0)
    assert drawn() == near((1, 8, 0), 1e-5)
    world.detach(body)
    body.auto_recentre = True
    body.fixed_mass = None
    assert mark.pose.position == (0, 0, 0)
    assert body.mass == 1.0


def test_a_mark_has_no_mass_and_comes_along_in_copies():
    world, body, _, _ = dumbbell()
    before = body.mass_properties
    body.attach(oo.CentreOfMass(name="mark"))
    assert body.mass_properties == before
    copied = body.copy()
    twin = copied.find("mark")
    assert isinstance(twin, oo.CentreOfMass)
    assert twin.pose.position == (1, 0, 0)
    assert oo.CentreOfMass().pose.position == (0, 0, 0)
    with pytest.raises(oo.TreeError):
        world.attach(oo.CentreOfMass())


def test_the_mark_is_quartered_in_two_colours():
    """Next to each of its eight fields are the others' colour; all marks share one mesh and one texture."""
    mark = oo.centre_of_mass_drawable(0.2)
    image = mark.appearance.texture.image
    rows, columns = image.shape[:2]
    fields = [[tuple(image[rows * (2 * i + 1) // 4, columns * (2 * k + 1) // 8]) for k in range(4)] for i in range(2)]
    dark, light = sorted({colour for row in fields for colour in row})
    assert max(dark) < 40
    assert light[0] > 200
    for i in range(2):
        for k in range(4):
            assert fields[i][k] != fields[i][(k + 1) % 4]
            assert fields[0][k] != fields[1][k]
    assert np.diag(mark.matrix)[:3] == pytest.approx(0.2)
    other = oo.centre_of_mass_drawable()
    assert (other.mesh, other.appearance) == (mark.mesh, mark.appearance)
    for bad in (0.0, -1.0, math.nan):
        with pytest.raises(oo.FieldError):
            oo.centre_of_mass_drawable(bad)
