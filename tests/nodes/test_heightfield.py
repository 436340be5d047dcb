"""Heightfields: what lies on them lies at the height of the surface, rays meet it, and ODE's faults are kept away."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import osgode as oo
from tests.strategies import CUBE, directions, floats, poses, vectors

X, Z = np.meshgrid(np.linspace(-8, 8, 33), np.linspace(-6, 6, 25))
SIZE = (16.0, 12.0)
TILT = math.atan(0.15)
BUMPY = 0.25 * np.sin(1.1 * X) * np.cos(0.9 * Z)
SHAPES = {
    "sphere": lambda: oo.Sphere(0.4, density=300),
    "box": lambda: oo.Box((0.8, 0.8, 0.8), density=300),
    "capsule": lambda: oo.Capsule(0.4, 0.8, density=300),
    "cylinder": lambda: oo.Cylinder(0.4, 0.8, density=300),
    "mesh": lambda: oo.Trimesh((np.array(CUBE[0]) * 0.8, CUBE[1]), density=300),
    "hull": lambda: oo.ConvexHull((np.array(CUBE[0]) * 0.8, CUBE[1]), density=300),
    "solid hull": lambda: oo.ConvexHull((np.array(CUBE[0]) * 0.8, CUBE[1]), density=300, solid=True),
}
"""All have their lowest point 0.4 m below their middle, as they are put down."""


def scene(terrain, place=None, **fields):
    world = oo.World(**fields)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    space.attach(place or oo.Placeable()).attach(terrain)
    return world, space


def thing(space, geom, position=(0, 0, 0), **fields):
    body = space.attach(oo.Body(position=position, **fields))
    body.attach(oo.Placeable()).attach(geom)
    return body


def as_mesh(terrain):
    mesh = terrain.drawables()[0].mesh
    return oo.Trimesh((mesh.vertices.astype(float), mesh.triangles))


# -- what lies on it


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("slope", [0.0, 0.15], ids=["level", "tilted"])
def test_what_lies_on_a_plane_of_heights_is_that_far_above_it(shape, slope):
    """The middle is 0.4 m from the plane once it has come to rest, or while it rolls down."""
    terrain = oo.Heightfield(slope * X, SIZE)
    world, space = scene(terrain)
    world.surfaces.fallback = oo.Surface(1.0)
    turn = oo.Quat.from_axis_angle((0, 0, 1), math.atan(slope))
    body = thing(space, SHAPES[shape](), (1.2, 1.2 * slope + 0.45 / math.cos(math.atan(slope)), 0.7), rotation=turn)
    world.run(1.0)
    p = body.position
    assert (p.y - slope * p.x) * math.cos(math.atan(slope)) == pytest.approx(0.4, abs=0.012)


@pytest.mark.parametrize("shape", SHAPES)
def test_what_falls_on_bumps_comes_to_rest_where_it_does_on_the_same_triangles(shape):
    ends = []
    for make in (lambda t: t, as_mesh):
        terrain = oo.Heightfield(BUMPY, SIZE)
        world, space = scene(make(terrain), linear_damping=0.02, angular_damping=0.02)
        world.surfaces.fallback = oo.Surface(1.0)
        body = thing(space, SHAPES[shape](), (0.3, 1.0, 0.2))
        world.run(4)
        assert body.linear_velocity.length < 0.3
        ends.append(body.position)
        low = min(terrain.height_at(ends[-1].x + dx, ends[-1].z + dz) for dx in (-0.1, 0, 0.1) for dz in (-0.1, 0, 0.1))
        assert low + 0.25 < ends[-1].y < low + 0.85
    assert ends[0].distance(ends[1]) < 0.35


@pytest.mark.parametrize("shape", ["sphere", "capsule", "cylinder"])
def test_what_is_round_rolls_downhill(shape):
    """Rolling without slipping: a = g sin / (1 + I / (m r2)), by the moments of the shape itself."""
    slope = math.tan(0.1)
    wide = np.linspace(-40, 40, 81)
    world, space = scene(oo.Heightfield(np.tile(slope * wide, (9, 1)), (80, 8)))
    world.surfaces.fallback = oo.Surface(1.0)
    geom = SHAPES[shape]()
    start = oo.Vec3(0, 0.4 / math.cos(0.1), 0)
    body = thing(space, geom, start)
    world.run(2)
    ratio = body.inertia[2][2] / (body.mass * 0.16)
    way = 0.5 * 9.81 * math.sin(0.1) / (1 + ratio) * 4
    assert body.position.distance(start) == pytest.approx(way, rel=0.03)
    assert body.position.x < 0
    assert body.position.y - slope * body.position.x == pytest.approx(start.y, abs=0.01)


def test_what_got_below_the_surface_is_pushed_up_within_the_thickness():
    for depth, pushed in ((0.3, True), (1.5, True), (3.5, False)):
        world, space = scene(oo.Heightfield(BUMPY, SIZE, thickness=2.0), gravity=(0, 0, 0))
        body = thing(space, oo.Sphere(0.2), (0.5, -0.5 - depth, 0.5))
        world.step(5)
        assert (body.linear_velocity.y > 0) == pushed


def test_a_hull_meets_a_peak_that_none_of_its_corners_meets():
    """A pyramid 1 m high under the middle of a wide slab: the contact is its tip, as deep as the slab is below it."""
    heights = np.zeros((9, 9))
    heights[4, 4] = 1.0
    for swap in (False, True):
        slab = oo.ConvexHull((np.array(CUBE[0]) * (4, 0.5, 4), CUBE[1]), density=10)
        terrain = oo.Heightfield(heights, (8, 8), mass=0)
        world = oo.World(gravity=(0, 0, 0))
        space = world.attach(oo.SimpleSpace())
        world.collide(space)
        movers = [(slab, (0.3, 1.2, 0.2)), (terrain, (0, 0, 0))]
        for geom, position in movers[:: -1 if swap else 1]:
            thing(space, geom, position)
        world.step()
        (row,) = world.contacts
        assert tuple(row["geom"]["pos"][:3]) == pytest.approx((0, 1, 0), abs=1e-9)
        assert row["geom"]["depth"] == pytest.approx(0.05)
        sign = 1 if world.geom_of_slot(row["slot1"]) is slab else -1
        assert tuple(sign * row["geom"]["normal"][:3]) == pytest.approx((0, 1, 0), abs=1e-9)


def test_few_contacts_of_a_mesh_are_spread_over_all_of_it():
    """A plate of 400 corners lies in the ground; its 4 contacts hold up all sides."""
    edge = np.linspace(-1, 1, 20)
    points = [(x, y, z) for y in (-0.1, 0.1) for x in edge for z in edge]
    world, space = scene(oo.Heightfield(np.zeros((9, 9)) + 0.001 * np.eye(9), (8, 8)), contacts_per_pair=4)
    thing(space, oo.Trimesh(_plate(points), mass=0), (0.3, 0.09, 0.4))
    world.step()
    spots = world.contacts["geom"]["pos"][:, [0, 2]] - (0.3, 0.4)
    assert len(spots) == 4
    assert {tuple(np.sign(spot)) for spot in spots} == {(a, b) for a in (-1, 1) for b in (-1, 1)}
    assert np.abs(spots).min() > 0.5


def _plate(points):
    n = 20
    triangles = []
    for top in (0, 1):
        for i in range(n - 1):
            for j in range(n - 1):
                a = top * n * n + i * n + j
                quad = [(a, a + n, a + 1), (a + 1, a + n, a + n + 1)]
                triangles += [t if not top else t[::-1] for t in quad]
    return points, triangles


# -- rays


@given(
    heights=st.lists(st.lists(floats(-2, 2), min_size=4, max_size=4), min_size=3, max_size=3),
    place=poses(2),
    start=vectors(4),
    look=directions(),
    flat=st.booleans(),
)
@settings(max_examples=150)
def test_a_ray_meets_the_triangles_that_are_drawn(heights, place, start, look, flat):
    """Every triangle, tried by hand (T. Moeller, B. Trumbore, 1997)."""
    terrain = oo.Heightfield([[0.5] * 4] * 3 if flat else heights, (5.0, 3.0))
    world, space = scene(terrain, oo.Placeable(position=place.position, rotation=place.rotation))
    turn = oo.Quat.between((0, 0, -1), look)
    ray = space.attach(oo.Placeable(position=start, rotation=turn)).attach(oo.Ray(12, reports="all"))
    world.step()
    mesh = terrain.drawables()[0].mesh
    corners = mesh.vertices.astype(float)[mesh.triangles]
    origin, along = place.inverse().transform(start), place.rotation.conjugate().rotate(ray.direction)
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(np.array(along), e2)
    det = (e1 * p).sum(axis=1)
    assume(np.abs(det).min() > 1e-6)
    s = np.array(origin) - corners[:, 0]
    u, q = (s * p).sum(axis=1) / det, np.cross(s, e1)
    v, t = (q * np.array(along)).sum(axis=1) / det, (q * e2).sum(axis=1) / det
    edge = np.minimum(np.minimum(u, v), 1 - u - v)
    assume(np.abs(edge[(t > -0.1) & (t < 12.1)]).min(initial=1) > 1e-5)
    assume(np.abs(t).min() > 1e-4)
    assume(np.abs(t - 12).min() > 1e-4)
    expected = sorted(t[(edge > 0) & (t > 0) & (t < 12)])
    assert [hit.distance for hit in ray.hits] == pytest.approx(expected, abs=1e-4)
    for hit in ray.hits:
        assert hit.normal.dot(ray.direction) < 0
        local = place.inverse().transform(hit.point)
        assert local.y == pytest.approx(terrain.height_at(local.x, local.z), abs=1e-5)


def test_rays_straight_down_on_samples_edges_and_the_border_meet_once():
    terrain = oo.Heightfield(BUMPY, SIZE)
    world, space = scene(terrain)
    turn = oo.Quat.between((0, 0, -1), (0, -1, 0))
    spots = [(0, 0), (0.5, 0.5), (0.25, 0.25), (0.25, 0), (0, 0.25), (8, 6), (-8, -6), (8, -6), (-8, 6), (8, 0.1)]
    rays = [
        space.attach(oo.Placeable(position=(x, 5, z), rotation=turn)).attach(oo.Ray(9, reports="all")) for x, z in spots
    ]
    world.step()
    for (x, z), ray in zip(spots, rays, strict=True):
        assert [hit.distance for hit in ray.hits] == pytest.approx([5 - terrain.height_at(x, z)]), (x, z)


def test_a_very_long_ray_over_a_large_field_is_quick_and_right():
    """ODE would need gigabytes for it."""
    wide = np.linspace(0, 1, 1001)
    terrain = oo.Heightfield(np.tile(wide, (1001, 1)), (1000, 1000))
    world, space = scene(terrain)
    look = oo.Vec3(1, -0.0001, 0.7).normalized()
    start = oo.Vec3(-450, 0.5, -400)
    turn = oo.Quat.between((0, 0, -1), look)
    ray = space.attach(oo.Placeable(position=start, rotation=turn)).attach(oo.Ray(1e6))
    world.step()
    # 0.5 - 0.0001 s = (x + 500) / 1000 with x = -450 + s
    s = (0.5 - 0.05) / (0.0001 + 0.001)
    assert ray.hit.point.x == pytest.approx(-450 + s, abs=1e-3)


def test_any_hit_is_the_nearest_and_culled_ones_are_from_below():
    terrain = oo.Heightfield(BUMPY, SIZE)
    world, space = scene(terrain)
    up = space.attach(oo.Placeable(position=(1, -3, 1), rotation=oo.Quat.between((0, 0, -1), (0, 1, 0))))
    along = space.attach(oo.Placeable(position=(-7.9, 0.05, 0), rotation=oo.Quat.between((0, 0, -1), (1, 0, 0))))
    upward, level = up.attach(oo.Ray()), along.attach(oo.Ray(16, reports="all"))
    world.step()
    assert upward.hit.normal.y < 0
    crossings = level.hits
    assert len(crossings) > 3
    level.reports = "any"
    upward.backface_cull = True
    world.step()
    assert upward.hits == ()
    assert level.hits == crossings[:1]
    level.reports, level.backface_cull = "all", True
    world.step()
    assert [hit.distance for hit in level.hits] == pytest.approx([h.distance for h in crossings if h.normal.y > 0])


# -- turned, moved, resized


def test_a_turned_field_is_met_at_its_far_corners():
    """ODE's own box of a turned heightfield is too small by up to a factor of 1.4."""
    turn = oo.Quat.from_axis_angle((0, 1, 0), math.pi / 4)
    terrain = oo.Heightfield(np.zeros((5, 5)), (10, 10))
    world, space = scene(terrain, oo.Placeable(position=(1, 2, 3), rotation=turn))
    reach = 10 / math.sqrt(2)
    assert tuple(terrain.bounds[0]) == pytest.approx((1 - reach, 1.0, 3 - reach))
    assert tuple(terrain.bounds[1]) == pytest.approx((1 + reach, 2.0, 3 + reach))
    thing(space, oo.Sphere(0.2), (1 + reach - 0.4, 2.1, 3))
    world.step()
    assert len(world.contacts) == 1


def test_its_size_and_thickness_change_while_simulated():
    terrain = oo.Heightfield(np.zeros((5, 5)), (4, 4))
    world, space = scene(terrain, gravity=(0, 0, 0))
    ball = thing(space, oo.Sphere(0.5), (5, 0.4, 0))
    world.step()
    assert len(world.contacts) == 0
    terrain.size = (12, 6)
    terrain.thickness = 3.0
    assert tuple(terrain.bounds[0]) == pytest.approx((-6, -3, -3))
    world.step()
    assert len(world.contacts) == 1
    assert terrain.drawables()[0].mesh.bounds[1].x == pytest.approx(6)
    carrier = space.attach(oo.Body(position=(20, 0, 0)))
    carried = carrier.attach(oo.Placeable(position=(1, 0, 0))).attach(oo.Heightfield(np.ones((3, 3)), (2, 2), mass=0))
    carried.size = (6, 2)
    assert carried.bounds[1].x == pytest.approx(24)
    assert carrier.position.x == 20
    ball.enabled = False
    terrain.size = (1, 1)
    assert ball.enabled


def test_a_field_keeps_everything_on_its_way():
    data = oo.HeightData(BUMPY)
    terrain = oo.Heightfield(data, SIZE, thickness=0.5)
    place = oo.Placeable(position=(1, 0, 0))
    _world, space = scene(terrain, place)
    twin = space.attach(place.copy()).children[0]
    assert (twin.data, twin.size, twin.thickness) == (data, SIZE, 0.5)
    assert oo.live_natives().meshes == 1
    box = terrain.bounds
    other = oo.World()
    place.move_to(other.attach(oo.HashSpace()))
    assert terrain.bounds == box
    assert oo.live_natives().meshes == 2
    space.detach(twin.parent)
    assert oo.live_natives().meshes == 1


def test_the_heights_are_the_librarys_business():
    """The array it was made of may change and go."""
    heights = np.zeros((5, 5))
    terrain = oo.Heightfield(heights, (4, 4))
    heights[:] = math.nan
    del heights
    world, space = scene(terrain)
    body = thing(space, oo.Sphere(0.5), (0, 0.6, 0))
    world.run(1)
    assert body.position.y == pytest.approx(0.5, abs=0.01)
    with pytest.raises(ValueError, match="read-only"):
        terrain.data.heights[0, 0] = 1


# -- where ODE would assert or run out of memory


@pytest.mark.parametrize("edge", [0.7, 3.3, 1 / 3, 10.1, 1234.567])
@pytest.mark.parametrize("samples", [2, 4, 8, 50])
def test_what_just_touches_the_border_is_no_assert(edge, samples):
    """At the very edge ODE's rounding may find it beyond the last sample, and it ends the process."""
    heights = np.random.default_rng(1).random((samples, samples))
    world, space = scene(oo.Heightfield(heights, (edge, edge)), gravity=(0, 0, 0))
    for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1)):
        for rounding in (0, 1, -1):
            far = np.nextafter(edge / 2 + 0.25, rounding * math.inf) if rounding else edge / 2 + 0.25
            thing(space, oo.Box((0.5, 0.5, 0.5)), (x * far, 0.5, z * far))
    world.step(2)


@pytest.mark.parametrize("make", [lambda: oo.Box((40, 1, 30)), lambda: oo.ConvexHull(_slab()), lambda: oo.Sphere(20)])
def test_what_is_much_larger_than_a_cell_lies_on_the_highest_peaks(make):
    """Below it are 20 000 cells; ODE's own heightfield would need 10 gigabytes."""
    rough = np.random.default_rng(1).random((401, 401))
    world, space = scene(oo.Heightfield(rough, (100.0, 100.0)))
    geom = make()
    geom.density = 1.0
    bottom = 20.0 if isinstance(geom, oo.Sphere) else 0.5
    body = thing(space, geom, (0, 1.05 + bottom, 0))
    world.run(0.5)
    under = rough[140:261, 120:281].max()
    if not isinstance(geom, oo.Sphere):
        assert body.position.y - 0.5 == pytest.approx(under, abs=0.02)
    assert body.position.y - bottom > 0.8


def _slab():
    return np.array(CUBE[0]) * (40, 1, 30), CUBE[1]


def test_a_huge_geom_on_a_tiny_field_is_no_assert():
    """ODE counts samples in an int."""
    world, space = scene(oo.Heightfield(np.eye(3), (0.002, 0.002)), gravity=(0, 0, 0))
    thing(space, oo.Box((1e7, 1.0, 1e7), mass=1), (0, 0.2, 0))
    world.step()
    assert len(world.contacts) > 0


@pytest.mark.parametrize(
    ("shape", "where"),
    [
        (shape, where)
        for shape in SHAPES
        for where in ("hollow", "ridge", "peak")
        if shape != "mesh" or where == "hollow"  # a mesh meets the ground with its corners alone, as it is said
    ],
)
def test_nothing_sinks_into_hollows_and_over_ridges(shape, where):
    """In a valley of 45 degrees, on its opposite, and on a pyramid, off the samples and across the cells' diagonals."""
    steep = {"hollow": np.abs(X + Z), "ridge": -np.abs(X + Z) / 4, "peak": -np.maximum(np.abs(X), np.abs(Z)) / 4}[where]
    terrain = oo.Heightfield(steep, SIZE)
    world, space = scene(terrain, linear_damping=0.02, angular_damping=0.05)
    world.surfaces.fallback = oo.Surface(1.0)
    body = thing(space, SHAPES[shape](), (0.13, 1.0, -0.1))
    for _ in range(60):
        world.step(4)
        p = body.position
        assert p.y - terrain.height_at(p.x, p.z) > 0.3


def test_two_fields_and_a_field_and_a_plane_do_not_meet():
    world, space = scene(oo.Heightfield(BUMPY, SIZE))
    space.attach(oo.Plane())
    thing(space, oo.Heightfield(BUMPY, SIZE, mass=0))
    world.step()
    assert len(world.contacts) == 0


# -- as a node


def test_it_has_no_volume():
    terrain = oo.Heightfield(BUMPY, SIZE, name="it")
    world = oo.World()
    body = world.attach(oo.HashSpace()).attach(oo.Body())
    place = body.attach(oo.Placeable())
    with pytest.raises(oo.FieldError, match=r"Heightfield 'it' has no usable mass.*no volume; mass=0 makes it"):
        place.attach(terrain)
    terrain.mass = 0
    place.attach(terrain)
    assert body.mass == 1.0


def test_rows_run_along_z_and_columns_along_x():
    heights = np.arange(12.0).reshape(3, 4)
    terrain = oo.Heightfield(heights, (6, 4))
    for row in range(3):
        for column in range(4):
            x, z = -3 + 2 * column, -2 + 2 * row
            assert terrain.height_at(x, z) == heights[row, column]
            seen = terrain.drawables()[0].mesh.vertices
            assert (np.abs(seen - (x, heights[row, column], z)).max(axis=1) < 1e-6).any()
    for x, z, name in ((3.1, 0, "x"), (0, -2.1, "z"), (math.nan, 0, "x")):
        with pytest.raises(oo.FieldError, match=rf"height_at\(\)\.{name}"):
            terrain.height_at(x, z)


def test_terrain_from_an_image(tmp_path):
    """The top of the image is where z is lowest; 16 bits of grey are finer than 8."""
    images = pytest.importorskip("PIL.Image")
    grey = np.array([[0, 51, 255], [102, 0, 0]], np.uint8)
    images.fromarray(grey).save(tmp_path / "grey.png")
    fine = (np.array([[0, 1, 65535], [2, 0, 0]])).astype(np.uint16)
    images.fromarray(fine).save(tmp_path / "fine.png")
    for source in (tmp_path / "grey.png", str(tmp_path / "grey.png"), images.fromarray(grey)):
        terrain = oo.Heightfield.from_image(source, (4, 2), 5.0, material="earth")
        assert terrain.data.heights == pytest.approx(np.array([[0, 1, 5], [2, 0, 0]]))
        assert (terrain.size, terrain.material) == ((4, 2), "earth")
    assert terrain.height_at(2, -1) == pytest.approx(5)
    colour = images.fromarray(np.stack([grey] * 3, axis=-1))
    assert oo.Heightfield.from_image(colour, (4, 2), 5.0).data.heights[0, 2] == pytest.approx(5)
    finer = oo.Heightfield.from_image(tmp_path / "fine.png", (4, 2), 65.535).data.heights
    assert finer == pytest.approx(np.array([[0, 0.001, 65.535], [0.002, 0, 0]]))


def test_what_is_no_image_is_refused(tmp_path, monkeypatch):
    pytest.importorskip("PIL")
    (tmp_path / "text.png").write_text("no image")
    for source in (tmp_path / "none.png", tmp_path / "text.png", tmp_path):
        with pytest.raises(oo.ModelError, match="no heights can be read"):
            oo.Heightfield.from_image(source, (1, 1), 1)
    for bad in (5, None, b"x"):
        with pytest.raises(oo.FieldError, match=r"from_image\(\)\.source"):
            oo.Heightfield.from_image(bad, (1, 1), 1)
    with pytest.raises(oo.FieldError, match=r"from_image\(\)\.height"):
        oo.Heightfield.from_image(tmp_path / "text.png", (1, 1), math.nan)
    monkeypatch.setitem(__import__("sys").modules, "PIL", None)
    with pytest.raises(oo.MissingExtraError, match=r"osgode\[render\]"):
        oo.Heightfield.from_image(tmp_path / "text.png", (1, 1), 1)
