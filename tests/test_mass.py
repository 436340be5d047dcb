"""Mass, centre and inertia: against ODE's formulas bit for bit, against numpy, and against brute force."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.native import ffi, lib
from tests.strategies import CUBE, floats, geoms, poses, rotations, sizes, vectors

UNIT = np.identity(3)


def tensor(mass):
    return np.array(mass.inertia)


def about(mass, point):
    """The inertia tensor about any point, by the parallel-axis theorem, written out anew."""
    r = np.array(mass.centre) - point
    return tensor(mass) + mass.mass * (r @ r * UNIT - np.outer(r, r))


def assert_same(one, other, tolerance=1e-9):
    scale = max(1.0, float(np.abs(tensor(one)).max()))
    assert one.mass == pytest.approx(other.mass, rel=tolerance)
    assert tuple(one.centre) == pytest.approx(tuple(other.centre), abs=tolerance * 10)
    assert tensor(one) == pytest.approx(tensor(other), abs=tolerance * scale)


def masses():
    """Of solids of all shapes, in any place."""
    return st.builds(lambda geom, pose: geom._shape_mass(mass=2.0).moved(pose), geoms(), poses())


# -- against ODE


def ode_mass(setter, *arguments):
    out = ffi.new("dMass *")
    setter(out, *arguments)
    return [out.mass, *(out.I[4 * row + column] for row in range(3) for column in range(3))]


def our_mass(mass):
    assert mass.centre == (0, 0, 0)
    return [mass.mass, *(value for row in mass.inertia for value in row)]


@given(floats(0.01, 1e4), sizes(), sizes(), sizes())
def test_shapes_are_those_of_ode_bit_for_bit(m, x, y, z):
    assert our_mass(oo.Mass.box((x, y, z), mass=m)) == ode_mass(lib.dMassSetBoxTotal, m, x, y, z)
    assert our_mass(oo.Mass.sphere(x, mass=m)) == ode_mass(lib.dMassSetSphereTotal, m, x)
    assert our_mass(oo.Mass.cylinder(x, y, mass=m)) == ode_mass(lib.dMassSetCylinderTotal, m, 3, x, y)
    assert our_mass(oo.Mass.capsule(x, y, mass=m)) == ode_mass(lib.dMassSetCapsuleTotal, m, 3, x, y)


# -- against brute force

SHAPES = [
    pytest.param(oo.Mass.box((1.2, 0.7, 2.0), density=50.0), lambda: trimesh.creation.box((1.2, 0.7, 2.0)), id="box"),
    pytest.param(oo.Mass.sphere(0.8, density=50.0), lambda: trimesh.creation.icosphere(5, 0.8), id="sphere"),
    pytest.param(
        oo.Mass.capsule(0.5, 1.5, density=50.0),
        # trimesh's capsule stands on the origin or about it, by version; here it is put about it.
        lambda: _centred(trimesh.creation.capsule(1.5, 0.5, count=[96, 96])),
        id="capsule",
    ),
    pytest.param(
        oo.Mass.cylinder(0.5, 1.5, density=50.0),
        lambda: trimesh.creation.cylinder(0.5, 1.5, sections=256),
        id="cylinder",
    ),
]


def _centred(mesh):
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    return mesh


@pytest.mark.parametrize(("mass", "make"), SHAPES)
def test_a_shape_is_what_its_mesh_is(mass, make):
    """Volume, centre and inertia of the primitive and of its triangles agree as far as the facets allow."""
    mesh = make()
    facets = 0.003
    assert_same(oo.Mass.mesh(mesh.vertices, mesh.faces, density=50.0), mass, facets)


def sampled(inside, half, density, count=60):
    """Mass properties of a solid about its own centre, from a grid of points in a box."""
    steps = [(np.arange(count) + 0.5) / count * 2 * h - h for h in half]
    points = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    cell = math.prod(2 * h / count for h in half)
    points = points[inside(points)]
    m = density * cell * len(points)
    centre = points.mean(axis=0)
    r = points - centre
    second = r.T @ r / len(points)
    return m, centre, m * (np.trace(second) * UNIT - second)


SOLIDS = [
    (oo.Mass.box((1.0, 2.0, 0.5), density=3.0), lambda p: np.ones(len(p), bool), (0.5, 1.0, 0.25)),
    (oo.Mass.sphere(0.7, density=3.0), lambda p: (p**2).sum(axis=1) <= 0.49, (0.7, 0.7, 0.7)),
    (
        oo.Mass.cylinder(0.6, 1.5, density=3.0),
        lambda p: (p[:, :2] ** 2).sum(axis=1) <= 0.36,
        (0.6, 0.6, 0.75),
    ),
    (
        oo.Mass.capsule(0.4, 1.0, density=3.0),
        lambda p: (p[:, :2] ** 2).sum(axis=1) + np.maximum(np.abs(p[:, 2]) - 0.5, 0) ** 2 <= 0.16,
        (0.4, 0.4, 0.9),
    ),
]


@pytest.mark.parametrize(("mass", "inside", "half"), SOLIDS, ids=["box", "sphere", "cylinder", "capsule"])
def test_a_shape_is_what_many_points_of_it_are(mass, inside, half):
    m, centre, inertia = sampled(inside, half, 3.0)
    assert mass.mass == pytest.approx(m, rel=5e-3)
    assert centre == pytest.approx((0, 0, 0), abs=1e-9)
    assert tensor(mass) == pytest.approx(inertia, abs=1e-2 * float(np.trace(inertia)))


def test_a_crooked_mesh_is_what_many_points_of_it_are():
    """A tetrahedron, whose centre and products of inertia are not 0."""
    vertices = np.array([(0.1, 0.2, -0.3), (2, 0.1, 0), (0.3, 1.5, 0.2), (0.2, 0.1, 1.8)])
    mass = oo.Mass.mesh(vertices, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], density=7.0)
    planes = np.linalg.inv(np.vstack([vertices.T, np.ones(4)]))
    m, centre, inertia = sampled(
        lambda p: (planes @ np.vstack([p.T, np.ones(len(p))]) >= 0).all(axis=0), (2, 2, 2), 7.0, 100
    )
    assert mass.mass == pytest.approx(m, rel=1e-2)
    assert tuple(mass.centre) == pytest.approx(centre, abs=1e-2)
    assert tensor(mass) == pytest.approx(inertia, abs=2e-2 * float(np.trace(inertia)))


@given(poses(50), floats(0.2, 3))
def test_a_mesh_far_from_the_origin_loses_no_digits(pose, size):
    """A cube of triangles anywhere is the cube of the formula, moved there."""
    vertices = [pose.transform(oo.Vec3(*v) * size) for v in CUBE[0]]
    mesh = oo.Mass.mesh(vertices, CUBE[1], density=10.0)
    assert_same(mesh, oo.Mass.box((size, size, size), density=10.0).moved(pose), 1e-8)


def test_a_vertex_told_twice_is_one():
    """Models repeat vertices where the texture has a seam; the surface is closed all the same."""
    corners = np.array(CUBE[0])[np.array(CUBE[1])].reshape(-1, 3)
    assert_same(
        oo.Mass.mesh(corners, np.arange(36).reshape(-1, 3), density=2.0), oo.Mass.box((1, 1, 1), density=2.0), 1e-12
    )


@pytest.mark.parametrize(
    ("triangles", "message"),
    [
        (CUBE[1][1:], "open"),
        ([(a, c, b) for a, b, c in CUBE[1]], "counter-clockwise from outside"),
        ([*CUBE[1][1:], CUBE[1][0][::-1]], "open"),
    ],
    ids=["a triangle is missing", "inside out", "a triangle is turned"],
)
def test_a_mesh_that_encloses_nothing_is_refused(triangles, message):
    with pytest.raises(oo.FieldError, match=message):
        oo.Mass.mesh(CUBE[0], triangles, density=1.0)


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [
        (CUBE[0], []),
        ([], [(0, 1, 2)]),
        (CUBE[0], [(0, 1, 8)]),
        (CUBE[0], [(-1, 0, 1)]),
        (CUBE[0], [(0, 1)]),
        ([(0, 0)], [(0, 0, 0)]),
        (CUBE[0], [(0.0, 1.0, 2.0)]),
        ([(math.nan,) * 3] * 8, CUBE[1]),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, triangles):
    with pytest.raises(oo.FieldError, match=r"must be|open"):
        oo.Mass.mesh(vertices, triangles, density=1.0)


# -- arithmetic


@given(masses(), masses())
def test_a_sum_is_both_together(a, b):
    """Total, weighted mean, and the parallel-axis theorem."""
    both = a + b
    assert both.mass == pytest.approx(a.mass + b.mass)
    centre = (a.mass * np.array(a.centre) + b.mass * np.array(b.centre)) / both.mass
    assert tuple(both.centre) == pytest.approx(centre, abs=1e-9)
    inertia = about(a, centre) + about(b, centre)
    assert tensor(both) == pytest.approx(inertia, abs=1e-9 * float(np.trace(inertia)))


@given(masses(), masses(), masses())
@settings(max_examples=50)
def test_the_order_of_a_sum_does_not_matter(a, b, c):
    assert_same((a + b) + c, a + (b + c))
    assert_same(a + b, b + a)


@given(masses(), vectors())
def test_a_translation_moves_the_centre_alone(mass, by):
    moved = mass.translated(by)
    assert moved.centre == mass.centre + by
    assert moved.inertia == mass.inertia
    assert moved.mass == mass.mass


@given(masses(), rotations())
def test_a_rotation_turns_centre_and_tensor(mass, by):
    """With R its matrix: centre -> R centre, inertia -> R I R^T."""
    turned = mass.rotated(by)
    matrix = np.array(by.to_matrix())
    assert tuple(turned.centre) == pytest.approx(matrix @ mass.centre, abs=1e-9)
    scale = float(np.trace(tensor(mass)))
    assert tensor(turned) == pytest.approx(matrix @ tensor(mass) @ matrix.T, abs=1e-9 * scale)
    assert np.array_equal(tensor(turned), tensor(turned).T)


@given(masses(), poses(), poses())
def test_moving_twice_is_moving_once(mass, a, b):
    assert_same(mass.moved(b).moved(a), mass.moved(a * b), 1e-8)


@given(masses(), floats(0.1, 100), vectors())
def test_scaling_changes_only_how_much(mass, total, point):
    scaled = mass.scaled(total)
    assert scaled.mass == total
    assert scaled.centre == mass.centre
    factor = total / mass.mass
    expected = factor * about(mass, point)
    assert scaled.inertia_about(point) == pytest.approx(expected, abs=1e-9 * float(np.abs(expected).max()))


# -- what is refused

DIAGONAL = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@pytest.mark.parametrize(
    "arguments",
    [
        {"mass": 0.0},
        {"mass": -1.0},
        {"mass": math.nan},
        {"mass": math.inf},
        {"mass": 1e-320},
        {"mass": 10**400},
        {"mass": None},
        {"mass": "heavy"},
        {"centre": (0, math.nan, 0)},
        {"centre": (0, math.inf, 0)},
        {"centre": (0, 0)},
        {"centre": 5},
        {"inertia": ((1, 0, 0), (0, 1, 0), (0, 0, math.nan))},
        {"inertia": ((math.inf, 0, 0), (0, math.inf, 0), (0, 0, math.inf))},
        {"inertia": ((0, 0, 0), (0, 0, 0), (0, 0, 0))},
        {"inertia": ((1, 0, 0), (0, -1, 0), (0, 0, 1))},
        {"inertia": ((1e-320, 0, 0), (0, 1e-320, 0), (0, 0, 1e-320))},
        {"inertia": ((1, 0, 0), (0, 1, 0), (0, 0, 2.5))},
        {"inertia": ((1e300, 1e299, 0), (1e299, 1e300, 0), (0, 0, 1e300))},
        {"inertia": ((1, 0.5, 0), (0, 1, 0), (0, 0, 1))},
        {"inertia": ((1, 2, 0), (2, 1, 0), (0, 0, 1))},
        {"inertia": ((1, 0), (0, 1))},
        {"inertia": 5},
        {"inertia": None},
    ],
    ids=lambda arguments: str(arguments)[:40],
)
def test_a_mass_that_nothing_has_is_refused(arguments):
    """Not positive, not finite, not symmetric, not positive definite, or against the triangle inequality."""
    with pytest.raises(oo.FieldError, match=r"Mass.*must"):
        oo.Mass(**{"mass": 1.0, "centre": (0, 0, 0), "inertia": DIAGONAL, **arguments})


@pytest.mark.parametrize(
    "bad", [0.0, -1.0, math.nan, math.inf, 1e200, 10**400, None, "wide"], ids=lambda bad: str(bad)[:9]
)
def test_a_size_that_nothing_has_is_refused(bad):
    for make in (
        lambda: oo.Mass.sphere(bad, mass=1.0),
        lambda: oo.Mass.box((1, bad, 1), mass=1.0),
        lambda: oo.Mass.capsule(bad, 1, mass=1.0),
        lambda: oo.Mass.capsule(1, bad, mass=1.0),
        lambda: oo.Mass.cylinder(bad, 1, mass=1.0),
        lambda: oo.Mass.cylinder(1, bad, mass=1.0),
        lambda: oo.Mass.sphere(bad, density=1.0),
    ):
        with pytest.raises(oo.FieldError, match="must be"):
            make()


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, 10**400, "heavy"], ids=lambda bad: str(bad)[:9])
def test_a_total_that_nothing_has_is_refused(bad):
    for arguments in ({"mass": bad}, {"density": bad}):
        with pytest.raises(oo.FieldError, match="must be"):
            oo.Mass.box((1, 1, 1), **arguments)
        with pytest.raises(oo.FieldError, match="must be"):
            oo.Mass.mesh(*CUBE, **arguments)
    with pytest.raises(oo.FieldError, match="must be"):
        oo.Mass(1.0).scaled(bad)


def test_either_mass_or_density_is_given():
    for arguments in ({}, {"mass": 1.0, "density": 1.0}):
        with pytest.raises(oo.FieldError, match=r"Mass\.sphere.*either mass or density"):
            oo.Mass.sphere(1.0, **arguments)


def test_a_mass_does_not_change():
    mass = oo.Mass(1.0)
    with pytest.raises(AttributeError):
        mass.mass = 2.0


# -- cutting out, and how many times


@given(masses(), masses())
def test_what_is_cut_out_again_leaves_the_rest(a, b):
    """(a + b) - b is a."""
    assert_same((a + b) - b, a, 1e-7)


def test_a_shell_is_a_ball_without_its_core():
    """Hollow sphere: I = 2/5 m (R^5 - r^5) / (R^3 - r^3)."""
    shell = oo.Mass.sphere(1.0, density=100.0) - oo.Mass.sphere(0.8, density=100.0)
    m = 100.0 * 4 / 3 * math.pi * (1 - 0.8**3)
    assert shell.mass == pytest.approx(m)
    assert tensor(shell) == pytest.approx(0.4 * m * (1 - 0.8**5) / (1 - 0.8**3) * UNIT)


def test_a_plate_with_a_hole_is_what_many_points_of_it_are():
    """The hole off its middle, so that centre and products of inertia are not 0."""
    plate = oo.Mass.box((2, 1, 0.5), density=10.0)
    hole = oo.Mass.cylinder(0.3, 0.5, density=10.0).translated((0.5, 0.15, 0))
    left = plate - hole
    m, centre, inertia = sampled(
        lambda p: (p[:, 0] - 0.5) ** 2 + (p[:, 1] - 0.15) ** 2 > 0.09, (1.0, 0.5, 0.25), 10.0, 120
    )
    assert left.mass == pytest.approx(m, rel=5e-3)
    assert tuple(left.centre) == pytest.approx(centre, abs=5e-3)
    assert tensor(left) == pytest.approx(inertia, abs=5e-3 * float(np.trace(inertia)))


@pytest.mark.parametrize(
    ("whole", "part", "words"),
    [
        (oo.Mass.sphere(1, mass=2), oo.Mass.sphere(1, mass=2), "nothing is left"),
        (oo.Mass.sphere(1, mass=2), oo.Mass.sphere(0.5, mass=3), "nothing is left"),
        (oo.Mass.sphere(1, mass=2), oo.Mass.sphere(1, mass=2 * (1 - 1e-15)), "nothing is left"),
        (oo.Mass.sphere(1, mass=2), oo.Mass.sphere(2, mass=1), "nothing real"),
        (oo.Mass.box((1, 1, 1), mass=2), oo.Mass.box((0.1, 0.1, 0.1), mass=1).translated((5, 0, 0)), "nothing real"),
    ],
    ids=["itself", "heavier", "itself but for rounding", "larger", "beside it"],
)
def test_what_is_no_part_cannot_be_cut_out(whole, part, words):
    with pytest.raises(oo.FieldError, match=words):
        whole - part


@given(masses(), floats(0.01, 100), vectors())
def test_a_multiple_is_of_another_density(mass, factor, point):
    """Mass and inertia about any point grow by the factor, the centre stays."""
    for many in (mass * factor, factor * mass, mass / (1 / factor)):
        assert many.mass == pytest.approx(factor * mass.mass)
        assert many.centre == mass.centre
        expected = factor * about(mass, np.array(point))
        assert many.inertia_about(point) == pytest.approx(expected, abs=1e-9 * float(np.abs(expected).max()))


@given(st.lists(masses(), min_size=1, max_size=5))
@settings(max_examples=30)
def test_sum_adds_them_up(some):
    total = some[0]
    for each in some[1:]:
        total = total + each
    assert sum(some) == total


@pytest.mark.parametrize("bad", [0, -1, math.nan, math.inf, 1e40, 1e-40])
def test_a_factor_that_makes_nothing_real_is_refused(bad):
    for make in (lambda: oo.Mass(1.0) * bad, lambda: bad * oo.Mass(1.0), lambda: oo.Mass(1.0) / bad):
        with pytest.raises(oo.FieldError, match="must be"):
            make()


@pytest.mark.parametrize("odd", [None, "2", [1, 2, 3], True, object()], ids=lambda odd: type(odd).__name__)
def test_a_mass_is_reckoned_with_masses_and_numbers_only(odd):
    for act in (
        lambda: oo.Mass(1.0) + odd,
        lambda: odd + oo.Mass(1.0),
        lambda: oo.Mass(1.0) - odd,
        lambda: oo.Mass(1.0) * odd,
        lambda: oo.Mass(1.0) / odd,
    ):
        with pytest.raises(TypeError):
            act()


# -- ODE's own arithmetic, as a check of ours


@given(masses(), poses(5.0), masses())
@settings(max_examples=50)
def test_ode_moves_turns_and_adds_the_same_way(mass, pose, other):
    """dMassTranslate, dMassRotate, dMassAdd; ODE keeps the inertia about the origin, not about the centre."""

    def native(given):
        out = ffi.new("dMass *")
        out.mass = given.mass
        out.c[0:3] = given.centre
        about_origin = about(given, np.zeros(3))
        for row in range(3):
            for column in range(3):
                out.I[4 * row + column] = about_origin[row, column]
        return out

    turn = ffi.new("dMatrix3")
    for row, values in enumerate(pose.rotation.to_matrix()):
        turn[4 * row : 4 * row + 3] = values
    theirs, second = native(mass), native(other)
    lib.dMassRotate(theirs, turn)
    lib.dMassTranslate(theirs, *pose.position)
    lib.dMassAdd(theirs, second)
    ours = mass.moved(pose) + other
    assert ours.mass == pytest.approx(theirs.mass)
    assert tuple(ours.centre) == pytest.approx(list(theirs.c)[:3], abs=1e-8)
    wanted = np.array(list(theirs.I)).reshape(3, 4)[:, :3]
    assert ours.inertia_about((0, 0, 0)) == pytest.approx(wanted, abs=1e-8 * float(np.abs(wanted).max()))
