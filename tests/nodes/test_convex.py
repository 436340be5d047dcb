"""Convex hulls as geoms, as meshes and solid: what they touch, where they rest, and what is refused."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import osgode as oo
from tests.strategies import CUBE, directions, poses, vectors

pytest.importorskip("scipy")
BOTH = pytest.mark.parametrize("solid", [False, True], ids=["mesh", "solid"])
ASIDE = np.add(CUBE[0], (7.0, -4.0, 2.0))
"""A cube far from the origin of its own axes."""


def scene(**fields):
    world = oo.World(**fields)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    return world, space


@BOTH
@given(place=poses(5), shift=vectors(3))
@settings(max_examples=30)
def test_a_hull_is_where_its_points_are(solid, place, shift):
    """Its box is that of its corners, in a body whose centre of mass is elsewhere, and wherever its own origin is."""
    _world, space = scene()
    points = np.array(CUBE[0]) + shift
    body = space.attach(oo.Body(position=place.position, rotation=place.rotation))
    body.attach(oo.Placeable(position=(0, 3, 0))).attach(oo.Sphere(0.1, mass=5))
    part = oo.Placeable(position=(1, 0, 0), rotation=place.rotation)
    hull = body.attach(part).attach(oo.ConvexHull((points, CUBE[1]), solid=solid, mass=1))
    matrix = body.pose.matrix() @ part.pose.matrix()
    corners = (matrix @ np.column_stack([points, np.ones(8)]).T)[:3].T
    low, high = hull.bounds
    assert tuple(low) == pytest.approx(tuple(corners.min(axis=0)), abs=1e-6)
    assert tuple(high) == pytest.approx(tuple(corners.max(axis=0)), abs=1e-6)
    assert tuple(hull.pose.position) == pytest.approx(tuple(body.local_to_world((1, 0, 0))))


@BOTH
@pytest.mark.parametrize("ground", ["plane", "box", "mesh", "heightfield", "sphere"])
def test_a_hull_falls_on_everything_and_stays_on_it(solid, ground):
    """Its bottom comes to rest at y = 0 within a millimetre or two; only the sphere it may roll off."""
    world, space = scene()
    floor = {
        "plane": oo.Plane,
        "box": lambda: oo.Box((6, 2, 6)),
        "mesh": lambda: oo.Trimesh(([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], [(0, 1, 2), (0, 2, 3)])),
        "heightfield": lambda: oo.Heightfield(np.zeros((9, 9)), (8, 8)),
        "sphere": lambda: oo.Sphere(4.0),
    }[ground]()
    if ground == "plane":
        space.attach(floor)
    else:
        drop = {"box": -1.0, "sphere": -4.0}.get(ground, 0.0)
        space.attach(oo.Placeable(position=(0, drop, 0))).attach(floor)
    body = space.attach(oo.Body(position=(-7.0, 4.0 + 0.7, -2.0)))
    body.attach(oo.Placeable()).attach(oo.ConvexHull(ASIDE, solid=solid, density=100))
    world.run(2)
    bottom = body.geoms[0].bounds[0].y if ground != "sphere" else body.world_centre_of_mass.y - 0.5
    assert bottom == pytest.approx(0, abs=0.02 if solid else 0.004)


@BOTH
def test_hulls_and_boxes_stack(solid):
    """ODE's convex geoms jitter on each other, and its meshes burst apart."""
    world, space = scene(iterations=50)
    space.attach(oo.Plane())
    bodies = []
    for k, box in enumerate((False, False, True, False)):
        body = space.attach(oo.Body(position=(0, 0.5 + k, 0)))
        body.attach(oo.Placeable()).attach(oo.Box() if box else oo.ConvexHull(CUBE, density=1000, solid=solid))
        bodies.append(body)
    world.run(3)
    for k, body in enumerate(bodies):
        assert body.position.y == pytest.approx(0.5 + k, abs=0.02)
        assert abs(body.position.x) + abs(body.position.z) < 0.05
        assert body.linear_velocity.length < 0.2


@BOTH
@pytest.mark.parametrize("other", ["hull", "box"])
@pytest.mark.parametrize("swap", [False, True])
def test_two_cubes_face_to_face_touch_at_the_corners_of_where_they_overlap(solid, other, swap):
    """One is turned by 45 degrees on the other: an octagon, of which eight corners at 0.1 m deep are told."""
    world, space = scene(gravity=(0, 0, 0))
    turn = oo.Quat.from_axis_angle((0, 1, 0), np.pi / 4)
    makes = [lambda: oo.ConvexHull(CUBE, solid=solid), lambda: oo.Box() if other == "box" else oo.ConvexHull(CUBE)]
    poses_of = [((0, 0.9, 0), turn), ((0, 0, 0), oo.Quat(1, 0, 0, 0))]
    for make, (position, rotation) in zip(makes[:: -1 if swap else 1], poses_of, strict=True):
        body = space.attach(oo.Body(position=position, rotation=rotation))
        body.attach(oo.Placeable()).attach(make())
    upper = world.bodies[0].geoms[0]
    world.step()
    rows = world.contacts
    assert rows["geom"]["depth"] == pytest.approx([0.1] * 8)
    r = 0.5 / np.cos(np.pi / 8)  # of the octagon's corners, its sides being 0.5 from the middle
    for row in rows:
        x, y, z = row["geom"]["pos"][:3]
        assert np.hypot(x, z) == pytest.approx(r, abs=1e-6)
        assert y == pytest.approx(0.45)
        sign = 1 if world.geom_of_slot(row["slot1"]) is upper else -1
        assert tuple(sign * row["geom"]["normal"][:3]) == pytest.approx((0, 1, 0), abs=1e-9)


@BOTH
@given(
    turn=st.floats(0.2, 1.3),
    aside=st.floats(0, 2 * np.pi),
    tilt=st.sampled_from([0.0, 1e-7, 1e-5, 1e-4, 1e-3, 1e-2]),
    other=st.sampled_from(["hull", "box"]),
    swap=st.booleans(),
)
@settings(max_examples=60)
def test_what_leans_a_little_keeps_all_its_corners(  # noqa: PLR0917
    solid, turn, aside, tilt, other, swap
):
    """The corners are those of the octagon that two unit squares have in common.

    Their sides are the lines n . x = 0.5 of eight directions n; neighbours meet at 0.5 / cos(a / 2) between them, if
    their directions are a apart. Leaning by t moves a side by less than t, so where two cross by less than
    t / sin(a); and 0.01 m deep in the middle no corner is out.
    """
    world, space = scene(gravity=(0, 0, 0))
    lean = oo.Quat.from_axis_angle((np.cos(aside), 0, np.sin(aside)), tilt)
    yaw = oo.Quat.from_axis_angle((0, 1, 0), turn)
    below = lambda: oo.Box() if other == "box" else oo.ConvexHull(CUBE)  # noqa: E731
    things = [(lambda: oo.ConvexHull(CUBE, solid=solid), (0, 0.99, 0), lean * yaw), (below, (0, 0, 0), None)]
    for make, position, rotation in things[:: -1 if swap else 1]:
        body = space.attach(oo.Body(position=position, rotation=rotation or oo.Quat(1, 0, 0, 0)))
        body.attach(oo.Placeable()).attach(make())
    world.step()
    ways = np.sort(np.concatenate([np.arange(4) * np.pi / 2, np.arange(4) * np.pi / 2 - turn]) % (2 * np.pi))
    gaps = np.diff(ways, append=ways[0] + 2 * np.pi)
    far = 0.5 / np.cos(gaps / 2)
    expected = np.column_stack([far * np.cos(ways + gaps / 2), far * np.sin(ways + gaps / 2)])
    found = world.contacts["geom"]["pos"][:, [0, 2]]
    assert len(found) == 8
    for corner in expected:
        assert np.hypot(*(found - corner).T).min() < tilt / np.sin(0.2) + 1e-6


@BOTH
@pytest.mark.parametrize("turn", [0.1, 0.3, 1.0])
def test_what_rests_on_a_hull_keeps_its_contacts(solid, turn):
    """The same in each step: where some are missing now and then, it hops."""
    world, space = scene(contact_surface_layer=1e-3, step_size=1 / 120)
    ground = oo.Placeable(position=(0, -0.5, 0))
    space.attach(ground).attach(oo.ConvexHull(CUBE, solid=solid))
    box = space.attach(oo.Body(position=(0.2, 0.5, 0), rotation=oo.Quat.from_axis_angle((0, 1, 0), turn)))
    box.attach(oo.Placeable()).attach(oo.Box(density=500))
    world.run(2)
    counts = set()
    for _ in range(480):
        world.step()
        counts.add(len(world.contacts))
        assert box.linear_velocity.length < 1e-3
    assert len(counts) == 1


@BOTH
@given(one=poses(0.8), other=poses(0.8), as_box=st.booleans())
@example(
    one=oo.Pose(oo.Vec3(0, 0, 0), oo.Quat(1, 0, 0, 0)),
    other=oo.Pose(oo.Vec3(0, 0, 0), oo.Quat.from_axis_angle((0, 1, 2), 2.5)),
    as_box=False,
)
@settings(max_examples=80)
def test_hulls_touch_if_and_only_if_they_overlap(solid, one, other, as_box):
    """As ODE's two boxes of the same size do: a separating axis is one for both. Contacts are within both."""

    def contacts(make1, make2):
        world, space = scene(gravity=(0, 0, 0))
        for pose, make in ((one, make1), (other, make2)):
            body = space.attach(oo.Body(position=pose.position, rotation=pose.rotation))
            body.attach(oo.Placeable()).attach(make())
        world.step()
        return world.contacts

    def hull():
        return oo.ConvexHull(CUBE, solid=solid)

    boxes = contacts(oo.Box, oo.Box)
    rows = contacts(hull, oo.Box if as_box else hull)
    if len(rows) == 0:
        # by an edge ODE's boxes may overlap where no corner and no crossing of the faces' edges does
        assert len(boxes) == 0 or boxes["geom"]["depth"].max() < 0.1
        return
    assert len(boxes) > 0
    for row in rows:
        for pose in (one, other):
            assert max(map(abs, pose.inverse().transform(row["geom"]["pos"][:3]))) < 0.5 + 1e-6
        assert 0 < row["geom"]["depth"] < (1 + 3**0.5) / 2 + 1e-9  # half a side and half a diagonal


@BOTH
def test_what_got_inside_a_hull_is_pushed_out_only_if_it_is_solid(solid):
    world, space = scene(gravity=(0, 0, 0))
    space.attach(oo.Placeable()).attach(oo.ConvexHull(np.array(CUBE[0]) * 4, solid=solid))
    ball = space.attach(oo.Body(position=(0.3, 0.2, 0.1)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.2))
    world.step()
    assert (len(world.contacts) > 0) == solid


@BOTH
@pytest.mark.parametrize("parts", [{"mass": 6.0}, {"density": 6.0}])
def test_a_hull_weighs_what_its_primitive_weighs(solid, parts):
    masses = []
    for geom in (oo.ConvexHull(ASIDE, solid=solid, **parts), oo.Box((1, 1, 1), **parts)):
        place = oo.Placeable(position=(1, 2, 3), rotation=oo.Quat.from_axis_angle((1, 2, 3), 1))
        if isinstance(geom, oo.Box):
            place.position = place.pose.transform((7, -4, 2))
        body = oo.Body()
        body.attach(place).attach(geom)
        masses.append(body.mass_properties)
    assert masses[0].mass == pytest.approx(masses[1].mass)
    assert tuple(masses[0].centre) == pytest.approx(tuple(masses[1].centre))
    assert np.array(masses[0].inertia) == pytest.approx(np.array(masses[1].inertia), abs=1e-9)
    assert oo.ConvexHull(ASIDE).volume == pytest.approx(1)


def test_one_data_serves_as_mesh_as_hull_and_as_solid():
    """Each kind has a native of its own, shared by all geoms of that kind in one World."""
    _world, space = scene()
    data = oo.ConvexHull(CUBE).data
    makes = [lambda: oo.Trimesh(data), lambda: oo.ConvexHull(data), lambda: oo.ConvexHull(data, solid=True)]
    geoms = [space.attach(make()) for make in makes for _ in range(2)]
    assert oo.live_natives().meshes == 3
    for left, geom in zip((3, 2, 2, 1, 1, 0), geoms, strict=True):
        space.detach(geom)
        assert oo.live_natives().meshes == left


@BOTH
def test_a_hull_keeps_everything_on_its_way(solid):
    """Copied, moved between spaces and Worlds, taken out and put back."""
    world, space = scene(gravity=(0, 0, 0))
    hull = oo.ConvexHull(ASIDE, solid=solid, mass=2)
    body = space.attach(oo.Body(position=(1, 0, 0)))
    body.attach(oo.Placeable()).attach(hull)
    box = hull.bounds
    other, home = scene(gravity=(0, 0, 0))
    body.move_to(world.attach(oo.SimpleSpace()))
    assert hull.bounds == box
    body.move_to(home)
    assert np.array(hull.bounds) == pytest.approx(np.array(box), abs=1e-9)
    twin = home.attach(body.copy()).geoms[0]
    assert (twin.data, twin.solid, twin.mass) == (hull.data, solid, 2)
    assert np.array(twin.bounds) == pytest.approx(np.array(box), abs=1e-9)
    assert body.world is other
    with pytest.raises(oo.StateError, match="detach it first"):
        hull.solid = not solid
    body.children[0].detach(hull)
    hull.solid = not solid
    body.children[0].attach(hull)
    assert np.array(hull.bounds) == pytest.approx(np.array(box), abs=1e-6)


def test_a_solid_hull_of_very_many_triangles_is_refused():
    rows = np.linspace(0.02, np.pi - 0.02, 40)
    turns = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    points = [(np.sin(a) * np.cos(b), np.cos(a), np.sin(a) * np.sin(b)) for a in rows for b in turns]
    hull = oo.ConvexHull(points, name="it")
    with pytest.raises(oo.FieldError, match=r"ConvexHull 'it'\.solid is True.*triangles"):
        hull.solid = True
    assert not hull.solid


@pytest.mark.parametrize("source", [None, 5, "cube", object(), (CUBE[0], "x"), oo.Body(), {"x": 1}])
def test_what_has_no_points_is_refused(source):
    with pytest.raises(oo.ModelError):
        oo.ConvexHull(source, name="it")


def test_a_mesh_that_is_not_convex_becomes_its_hull():
    dented = np.array(CUBE[0])
    dented[0] *= 0.2
    hull = oo.ConvexHull((dented, CUBE[1]))
    assert len(hull.data.vertices) == 7
    turned = oo.ConvexHull((CUBE[0], [t[::-1] for t in CUBE[1]]))
    assert turned.volume == pytest.approx(1)


def test_a_hull_is_drawn_with_its_edges():
    """The cube's normals are those of its faces: three at each corner, as of a box."""
    (drawn,) = oo.ConvexHull(CUBE, material="wood").drawables()
    assert sorted({tuple(np.round(n, 6) + 0.0) for n in drawn.mesh.normals.tolist()}) == sorted(
        tuple(s * float(i == k) + 0.0 for i in range(3)) for k in range(3) for s in (1, -1)
    )
    assert drawn.appearance == oo.Box(material="wood").drawables()[0].appearance


@BOTH
@given(st.data())
@settings(max_examples=40)
def test_a_solid_hull_is_met_by_rays_where_the_mesh_is(solid, data):
    """A ray against hulls of random points, compared with every triangle by hand."""
    points = data.draw(st.lists(vectors(1), min_size=6, max_size=12))
    try:
        hull = oo.ConvexHull(points, solid=solid)
    except oo.ModelError:
        return
    start = data.draw(directions()).normalized() * 4
    aim = (hull.data.water.centre - start).normalized()
    world, space = scene(gravity=(0, 0, 0))
    space.attach(oo.Placeable()).attach(hull)
    turn = oo.Quat.between((0, 0, -1), aim)
    ray = space.attach(oo.Placeable(position=start, rotation=turn)).attach(oo.Ray(20))
    world.step()
    a, b, c = np.moveaxis(hull.data.vertices[hull.data.triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    heights, rates = ((np.array(start) - a) * normals).sum(axis=1), normals @ np.array(aim)
    inside = heights.max() < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -heights / rates
    expected = t[rates > 1e-9].min() if inside else t[rates < -1e-9].max()
    assert ray.hit.distance == pytest.approx(expected, abs=1e-4)
