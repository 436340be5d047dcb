"""What lies on something lies still, and what rolls over the triangles of a mesh doesn't notice them."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.graph.primitives import box_mesh

G = 9.81
LYING = oo.Quat.from_axis_angle((1, 0, 0), math.pi / 2)  # from z to the vertical, for what has its axis along z
TURN = oo.Quat.from_axis_angle((0, 1, 0), 0.3)


def empty(**fields):
    world = oo.World(contact_surface_layer=1e-3, **fields)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    return world, space


def stand(space, geom, position=(0, 0, 0), rotation=None):
    if isinstance(geom, oo.Plane):
        return space.attach(geom)
    place = space.attach(oo.Placeable(position=position, rotation=rotation or oo.Quat(1, 0, 0, 0)))
    return place.attach(geom)


def put(space, geom, position, rotation=None, **fields):
    body = space.attach(oo.Body(position=position, rotation=rotation or oo.Quat(1, 0, 0, 0), **fields))
    body.attach(oo.Placeable()).attach(geom)
    return body


def sheet(along, across, wobble=0.0, height=lambda x, z: 0 * x):
    """A mesh from x = -1 to 13 and z = -1 to 1, whose triangles differ by ``wobble`` of their size."""
    x, z = np.meshgrid(np.linspace(-1, 13, along + 1), np.linspace(-1, 1, across + 1))
    random = np.random.default_rng(7)
    x[1:-1, 1:-1] += random.uniform(-wobble, wobble, x[1:-1, 1:-1].shape) * 14 / along
    z[1:-1, 1:-1] += random.uniform(-wobble, wobble, z[1:-1, 1:-1].shape) * 2 / across
    triangles = []
    for j, i in itertools.product(range(across), range(along)):
        a, b = j * (along + 1) + i, j * (along + 1) + i + 1
        c, d = a + along + 1, b + along + 1
        triangles += [(a, c, b), (b, c, d)] if (i + j) % 2 else [(a, c, d), (a, d, b)]
    return oo.MeshData(np.stack([x.ravel(), height(x, z).ravel(), z.ravel()], axis=1), triangles)


def cube_corners(size):
    return [
        tuple(s * c / 2 for s, c in zip(size, corner, strict=True)) for corner in itertools.product((-1, 1), repeat=3)
    ]


def rows(world):
    """Positions, normals away from the static geom (upwards here), and depths of the contacts."""
    geom = world.contacts["geom"]
    normals = geom["normal"][:, :3] * np.where(geom["normal"][:, 1] < 0, -1, 1)[:, None]
    return geom["pos"][:, :3], normals, geom["depth"]


# -- where the contacts are


@pytest.mark.parametrize("make", [oo.Capsule, oo.Cylinder])
@pytest.mark.parametrize(("width", "end"), [(3.0, 0.5), (0.6, 0.3)])
@pytest.mark.parametrize("ground", ["box", "hull", "solid hull"])
def test_what_lies_on_a_face_has_a_contact_at_each_end_of_the_face_or_of_itself(make, width, end, ground):
    if ground != "box":
        pytest.importorskip("scipy")
    world, space = empty(gravity=(0, 0, 0))
    size = (3, 1, width)
    floor = oo.Box(size) if ground == "box" else oo.ConvexHull(cube_corners(size), solid=ground == "solid hull")
    stand(space, floor, (0, -0.5, 0))
    put(space, make(0.2, 1, mass=1), (0.1, 0.199, 0))
    world.step()
    points, normals, depths = rows(world)
    order = np.argsort(points[:, 2])
    assert points[order] == pytest.approx(np.array([(0.1, -0.0005, -end), (0.1, -0.0005, end)]), abs=1e-9)
    assert normals == pytest.approx(np.array([(0, 1, 0)] * 2), abs=1e-9)
    assert depths == pytest.approx(0.001, abs=1e-9)


@pytest.mark.parametrize(("below", "above"), list(itertools.product([oo.Capsule, oo.Cylinder], repeat=2)))
def test_parallel_ones_touch_at_the_ends_of_what_they_have_in_common(below, above):
    """Lengths 1 and 0.8, shifted by 0.3: in common is z = -0.1 to 0.5."""
    world, space = empty(gravity=(0, 0, 0))
    stand(space, below(0.2, 1))
    put(space, above(0.3, 0.8, mass=1), (0, 0.498, 0.3))
    world.step()
    points, normals, depths = rows(world)
    assert sorted(points[:, 2]) == pytest.approx([-0.1, 0.5])
    assert points[:, 1] == pytest.approx(0.199)
    assert normals == pytest.approx(np.array([(0, 1, 0)] * 2), abs=1e-9)
    assert depths == pytest.approx(0.002)


def test_an_upright_cylinder_stands_on_its_rim():
    world, space = empty(gravity=(0, 0, 0))
    stand(space, oo.Box((3, 1, 3)), (0, -0.5, 0))
    put(space, oo.Cylinder(0.3, 0.4, mass=1), (0, 0.199, 0), LYING)
    world.step()
    points, _, depths = rows(world)
    assert np.hypot(points[:, 0], points[:, 2]) == pytest.approx(0.3)
    assert depths == pytest.approx(0.001)
    assert len(points) >= 6


def box_distance(point, half):
    q = np.abs(point) - half
    return float(np.linalg.norm(np.maximum(q, 0)) + min(q.max(), 0))


def capsule_distance(point, radius, length):
    z = np.clip(point[2], -length / 2, length / 2)
    return float(np.linalg.norm(point - [0, 0, z]) - radius)


def cylinder_distance(point, radius, length):
    return box_distance([np.hypot(point[0], point[1]), point[2]], np.array([radius, length / 2]))


@given(
    st.sampled_from(["capsule", "cylinder", "upright"]),
    st.sampled_from(["box", "cylinder"]),
    st.floats(0, 6),
    st.floats(-0.6, 0.6),
    st.floats(-0.6, 0.6),
    st.floats(-0.05, 0.05),
    st.floats(1e-4, 5e-3),
)
@settings(max_examples=150)
def test_contacts_of_what_lies_nearly_flat_lie_on_both_surfaces(  # noqa: PLR0917
    kind, ground, turn, x, z, tilt, sunk
):
    """A contact is half its depth from each surface, along the normal; no surface is farther from it than that.

    The deepest point of a line that is tilted by t against a normal is off by r t^2 / 2 at most.
    """
    world, space = empty(gravity=(0, 0, 0))
    if ground == "box":
        stand(space, oo.Box((2, 1, 2)), (0, -0.5, 0))
    else:
        stand(space, oo.Cylinder(1.2, 1), (0, -0.5, 0), LYING)
    rotation = oo.Quat.from_axis_angle((0, 1, 0), turn) * oo.Quat.from_axis_angle((1, 0, 0), tilt)
    rotation = rotation * LYING if kind == "upright" else rotation
    geom = oo.Capsule(0.2, 1, mass=1) if kind == "capsule" else oo.Cylinder(0.2, 0.4, mass=1)
    body = put(space, geom, (x, 0.2 - sunk, z), rotation)
    found = []
    body.on_collide(lambda feedback: found.append((feedback.points, feedback.depths)))
    pose = np.array(body.position), np.array(rotation.to_matrix())[:3, :3]
    world.step()
    assert found
    for point, depth in zip(np.asarray(found[0][0]), found[0][1], strict=True):
        local = pose[1].T @ (np.asarray(point) - pose[0])
        if ground == "box":
            below = box_distance(np.asarray(point) - [0, -0.5, 0], np.array([1, 0.5, 1]))
        else:
            below = cylinder_distance(np.array([point[0], point[2], point[1] + 0.5]), 1.2, 1)
        above = capsule_distance(local, 0.2, 1) if kind == "capsule" else cylinder_distance(local, 0.2, 0.4)
        slack = depth / 2 + 0.2 * tilt**2 / 2 + 1e-9
        assert abs(above) <= slack
        assert abs(below) <= slack


# -- fewer, by what they span


@pytest.mark.parametrize("cells", [(56, 8), (140, 20)])
@pytest.mark.parametrize("most", [4, 8, 1000])
def test_on_a_flat_mesh_a_box_has_the_contacts_of_a_plane(most, cells):
    """Dozens or hundreds of triangles below it, and a contact for each of its corners, to a thousandth of its size."""
    world, space = empty(gravity=(0, 0, 0), contacts_per_pair=most)
    stand(space, oo.Trimesh(sheet(*cells, 0.2)))
    put(space, oo.Box((1, 0.5, 1), mass=1), (3.03, 0.249, 0.02))
    world.step()
    points, normals, depths = rows(world)
    corners = sorted(itertools.product((2.53, 3.53), (-0.48, 0.52)))
    assert np.array(sorted(points[:, [0, 2]].round(2).tolist())) == pytest.approx(np.array(corners))
    assert normals == pytest.approx(np.array([(0, 1, 0)] * 4), abs=1e-9)
    assert depths == pytest.approx(0.001)


def dome(x, z):
    """A sphere's top of radius 20, hollow, below (3, 0)."""
    return 20 - np.sqrt(400 - (x - 3) ** 2 - z**2)


@pytest.mark.parametrize("most", [3, 4, 6])
def test_of_too_many_contacts_those_stay_that_span_the_most(most):
    """In a hollow a box stands on its edges all around: what is kept encloses its middle."""
    world, space = empty(gravity=(0, 0, 0), contacts_per_pair=1000)
    stand(space, oo.Trimesh(sheet(140, 20, height=dome)))
    put(space, oo.Box((1, 0.5, 1), mass=1), (3, 0.26, 0), kinematic=True)
    world.step()
    all_points, _, all_depths = rows(world)
    assert len(all_points) > most
    world.contacts_per_pair = most
    world.step()
    points, _, depths = rows(world)
    assert len(points) == most
    assert depths.max() == pytest.approx(all_depths.max())  # the deepest is among them
    for point in points.tolist():
        assert min(math.dist(point, p) for p in all_points.tolist()) < 1e-6  # none is made up
    assert np.ptp(points[:, 0]) > 0.9
    assert np.ptp(points[:, 2]) > 0.9


def test_no_two_contacts_are_one():
    world, space = empty(gravity=(0, 0, 0), contacts_per_pair=1000)
    stand(space, oo.Trimesh(sheet(140, 20, height=dome)))
    put(space, oo.Box((1, 0.5, 1), mass=1), (3, 0.26, 0), kinematic=True)
    world.step()
    geom = world.contacts["geom"]
    table = np.concatenate([geom["pos"][:, :3], geom["normal"][:, :3]], axis=1).tolist()
    assert len(table) > 4
    assert min(math.dist(p, q) for p, q in itertools.combinations(table, 2)) > 1e-3


# -- at rest

THINGS = {
    "capsule": (lambda: oo.Capsule(0.2, 1, mass=1), 0.2, TURN),
    "cylinder": (lambda: oo.Cylinder(0.2, 1, mass=1), 0.2, TURN),
    "upright cylinder": (lambda: oo.Cylinder(0.3, 0.4, mass=1), 0.2, TURN * LYING),
    "box": (lambda: oo.Box((0.6, 0.4, 1), mass=1), 0.2, TURN),
    "sphere": (lambda: oo.Sphere(0.2, mass=1), 0.2, TURN),
}
GROUNDS = {
    "plane": lambda space: stand(space, oo.Plane()),
    "box": lambda space: stand(space, oo.Box((3, 1, 3)), (0, -0.5, 0)),
    "cylinder": lambda space: stand(space, oo.Cylinder(1.5, 1), (0, -0.5, 0), LYING),
    "mesh": lambda space: stand(space, oo.Trimesh(sheet(40, 5, 0.2))),
}


@pytest.mark.parametrize("thing", THINGS)
@pytest.mark.parametrize("ground", GROUNDS)
def test_what_lies_on_something_lies_still(thing, ground):
    """10 s without sleep: it moves less than 0.1 mm, and turns less than 0.1 mrad."""
    world, space = empty(auto_disable=False)
    GROUNDS[ground](space)
    make, height, rotation = THINGS[thing]
    body = put(space, make(), (0.05, height, 0.03), rotation)
    world.run(0.5)
    before, turned = np.array(body.position), np.array(body.rotation)
    world.run(10)
    assert np.array(body.position) == pytest.approx(before, abs=1e-4)
    assert 2 * math.acos(min(1, abs(turned @ np.array(body.rotation)))) < 1e-4
    assert abs(body.position.y - height) < 2e-3


@pytest.mark.parametrize("ground", ["box", "mesh"])
def test_a_stack_of_ten_boxes_stays(ground):
    world, space = empty(iterations=50)
    GROUNDS[ground](space)
    boxes = [put(space, oo.Box((0.5, 0.5, 0.5), mass=1), (0.3, 0.25 + 0.5 * i, 0)) for i in range(10)]
    world.run(5)
    for i, box in enumerate(boxes):
        assert tuple(box.position) == pytest.approx((0.3, 0.25 + 0.5 * i, 0), abs=0.02)


def energy(body, inertia):
    spin = np.array(body.rotation.to_matrix())[:3, :3].T @ np.array(body.angular_velocity)
    v = np.array(body.linear_velocity)
    return 0.5 * v @ v + 0.5 * spin @ np.array(inertia) @ spin + G * body.position.y


@given(st.sampled_from(sorted(THINGS)), st.sampled_from(sorted(GROUNDS)), st.integers(0, 2**31))
@settings(max_examples=40)
def test_nothing_gains_energy_from_contacts(thing, ground, seed):
    """Dropped from 0.5 m above in any pose, 1 kg never has more than it began with, but for what a step can add.

    Pushing apart what has sunk in by v dt gives at most erp times its speed.
    """
    random = np.random.default_rng(seed)
    world, space = empty(step_size=1 / 240)
    GROUNDS[ground](space)
    q = random.normal(size=4)
    body = put(space, THINGS[thing][0](), (0, 1.2, 0), oo.Quat(*(q / np.linalg.norm(q))))
    inertia = body.mass_properties.inertia
    start = energy(body, inertia)
    for _ in range(240):
        world.step()
        assert energy(body, inertia) <= start * 1.02


def test_two_runs_are_the_same_to_the_bit():
    def heap():
        world, space = empty()
        GROUNDS["mesh"](space)
        bodies = [
            put(space, make(), (0.1 * i, 0.5 + 0.45 * i, 0.02 * i), rotation)
            for i, (make, _, rotation) in enumerate(THINGS.values())
        ]
        world.run(3)
        return np.array([(*b.position, *b.rotation) for b in bodies]).tobytes()

    assert heap() == heap()


# -- rolling and sliding over meshes

SHEETS = {
    "squares": lambda: sheet(56, 8),
    "uneven": lambda: sheet(56, 8, 0.3),
    "slivers across": lambda: sheet(700, 1),
    "slivers along": lambda: sheet(4, 80),
}


@pytest.mark.parametrize("name", SHEETS)
@pytest.mark.parametrize("thing", ["sphere", "capsule", "cylinder"])
def test_what_rolls_over_a_flat_mesh_keeps_its_line_and_speed(name, thing):
    world, space = empty(step_size=1 / 200)
    stand(space, oo.Trimesh(SHEETS[name]()))
    geom = {"sphere": oo.Sphere(0.2, mass=1), "capsule": oo.Capsule(0.2, 0.6, mass=1)}.get(
        thing, oo.Cylinder(0.2, 0.6, mass=1)
    )
    ball = put(space, geom, (0, 0.2, 0.013), linear_velocity=(4, 0, 0), angular_velocity=(0, 0, -20))
    heights = []
    for _ in range(500):
        world.step()
        heights.append(ball.position.y)
    assert ball.position.x == pytest.approx(10, abs=2e-3)
    assert ball.position.z == pytest.approx(0.013, abs=1e-3 if thing == "sphere" else 5e-3)
    assert ball.linear_velocity.x == pytest.approx(4, abs=1e-3)
    layer = world.contact_surface_layer
    assert -layer - 1e-4 < min(heights) - 0.2
    assert max(heights) - 0.2 < 1e-4
    settled = np.array(heights[250:])
    assert np.abs(np.diff(settled)).max() < 1e-4


@pytest.mark.parametrize("name", SHEETS)
def test_a_box_slides_over_a_flat_mesh_without_tripping(name):
    world, space = empty(step_size=1 / 200)
    stand(space, oo.Trimesh(SHEETS[name]()))
    box = put(space, oo.Box((0.4, 0.4, 0.4), mass=1, surface=oo.Surface(0)), (0, 0.2, 0.013), linear_velocity=(4, 0, 0))
    world.run(2.5)
    assert box.position.x == pytest.approx(10, abs=1e-2)
    assert box.position.z == pytest.approx(0.013, abs=1e-2)
    assert box.linear_velocity.x == pytest.approx(4, abs=1e-2)


def test_a_ball_rolls_along_a_gutter():
    """Its lowest line is the edge between two facets, which lean by z / R against each other.

    The quick solver takes the two contacts one after the other, and drifts by 6 mm in 10 m.
    """
    world, space = empty(step_size=1 / 200, solver="exact")
    mesh = sheet(56, 16, height=lambda x, z: 0.5 * z**2 + 0 * x)
    stand(space, oo.Trimesh(mesh))
    ball = put(space, oo.Sphere(0.2, mass=1), (0, 0.2, 0), linear_velocity=(4, 0, 0), angular_velocity=(0, 0, -20))
    world.run(2.5)
    assert ball.position.x == pytest.approx(10, abs=0.02)
    assert abs(ball.position.z) < 1e-3
    assert abs(ball.position.y - 0.2) < 2e-3


def test_a_ball_meets_a_real_edge_of_a_mesh_as_that_of_a_box():
    """Its middle stands off the edge at 45 degrees: one contact, on the edge, along that line."""
    found = {}
    for make in ("box", "mesh"):
        world, space = empty(gravity=(0, 0, 0))
        cube = box_mesh((1, 1, 1))
        stand(space, oo.Box((1, 1, 1)) if make == "box" else oo.Trimesh(oo.MeshData(cube.vertices, cube.triangles)))
        away = 0.19 / math.sqrt(2)
        put(space, oo.Sphere(0.2, mass=1), (0.5 + away, 0.5 + away, 0.1))
        world.step()
        found[make] = rows(world)
        points, normals, depths = found[make]
        assert normals == pytest.approx(np.array([(math.sqrt(0.5), math.sqrt(0.5), 0)]), abs=1e-6)
        assert depths == pytest.approx(0.01, abs=1e-6)
        assert math.dist(points[0], (0.5, 0.5, 0.1)) < 0.011


@pytest.mark.parametrize("thing", ["box", "sphere", "capsule", "cylinder"])
def test_walls_of_the_same_mesh_stop_what_slides_into_them(thing):
    """A floor and a wall at x = 2 that share their edge."""
    floor = [(-2, 0, -1), (2, 0, -1), (2, 0, 1), (-2, 0, 1), (2, 2, -1), (2, 2, 1)]
    mesh = oo.MeshData(floor, [(0, 2, 1), (0, 3, 2), (1, 2, 5), (1, 5, 4)])
    world, space = empty()
    stand(space, oo.Trimesh(mesh))
    smooth = {"mass": 1, "surface": oo.Surface(0)}
    geom = {
        "box": oo.Box((0.4, 0.4, 0.4), **smooth),
        "sphere": oo.Sphere(0.2, **smooth),
        "capsule": oo.Capsule(0.2, 0.6, **smooth),
    }.get(thing, oo.Cylinder(0.2, 0.6, **smooth))
    body = put(space, geom, (0, 0.2, 0.05), linear_velocity=(1.5, 0, 0))
    world.run(3)
    assert body.position.x == pytest.approx(1.8, abs=0.02) or body.linear_velocity.x <= 0
    assert body.position.x < 1.82
    assert body.position.y == pytest.approx(0.2, abs=0.02)


# -- the switch


def test_odes_own_contacts_can_be_had():
    """ODE has one contact for a capsule on a box; by its own broad phase always."""
    for fields, expected in (
        ({}, 2),
        ({"refine_contacts": False}, 1),
        ({"broad_phase": "ode"}, 1),
        ({"broad_phase": "ode", "refine_contacts": True}, 1),
    ):
        world, space = empty(gravity=(0, 0, 0), **fields)
        stand(space, oo.Box((3, 1, 3)), (0, -0.5, 0))
        put(space, oo.Capsule(0.2, 1, mass=1), (0, 0.199, 0))
        world.step()
        assert len(world.contacts) == expected
