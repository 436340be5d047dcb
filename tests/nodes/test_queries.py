"""Rays and overlaps: what is found, against closed formulas, and that asking changes nothing."""

import math
import random
import threading

import numpy as np
import pytest

import osgode as oo
from tests.strategies import CUBE

BROAD = pytest.mark.parametrize("broad", ["own", "ode"])
RADIUS, LENGTH = 0.4, 1.2
SIZE = (0.8, 1.2, 0.5)


def scene(*geoms, broad="own", **fields):
    """A World with a space that collides with itself, and static geoms at given places."""
    world = oo.World(broad_phase=broad, **fields)
    space = world.attach(oo.HashSpace())
    world.collide(space)
    for geom, position, rotation in geoms:
        if isinstance(geom, oo.Plane):
            space.attach(geom)
        else:
            space.attach(oo.Placeable(position=position, rotation=rotation)).attach(geom)
    return world, space


# -- closed formulas: the part of a line (start + t way) that is inside of a convex shape, as (from, to)


def _cut(*spans):
    low, high = max(a for a, _ in spans), min(b for _, b in spans)
    return (low, high) if low < high else None


def _slab(start, way, half):
    if abs(way) < 1e-14:
        return (-math.inf, math.inf) if abs(start) < half else (math.inf, -math.inf)
    a, b = (-half - start) / way, (half - start) / way
    return min(a, b), max(a, b)


def _round(start, way, radius):
    """Where |start + t way| < radius, in as many dimensions as they have."""
    a, b, c = way @ way, start @ way, start @ start - radius**2
    root = b * b - a * c
    if root <= 0 or a < 1e-14:
        return (-math.inf, math.inf) if a < 1e-14 and c < 0 else (math.inf, -math.inf)
    return (-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a


def _inside_box(start, way):
    return _cut(*(_slab(start[k], way[k], SIZE[k] / 2) for k in range(3)))


def _inside_sphere(start, way):
    return _cut(_round(start, way, RADIUS))


def _inside_cylinder(start, way):
    return _cut(_round(start[:2], way[:2], RADIUS), _slab(start[2], way[2], LENGTH / 2))


def _inside_capsule(start, way):
    ends = [np.array([0, 0, z]) for z in (-LENGTH / 2, LENGTH / 2)]
    spans = [_cut(_round(start - end, way, RADIUS)) for end in ends] + [_inside_cylinder(start, way)]
    spans = [span for span in spans if span]
    return (min(a for a, _ in spans), max(b for _, b in spans)) if spans else None  # it is convex


def _box_mesh():
    return [tuple(SIZE[k] * v[k] for k in range(3)) for v in CUBE[0]], CUBE[1]


KINDS = {
    "box": (lambda: oo.Box(SIZE), _inside_box),
    "sphere": (lambda: oo.Sphere(RADIUS), _inside_sphere),
    "capsule": (lambda: oo.Capsule(RADIUS, LENGTH), _inside_capsule),
    "cylinder": (lambda: oo.Cylinder(RADIUS, LENGTH), _inside_cylinder),
    "mesh": (lambda: oo.Trimesh(_box_mesh()), _inside_box),
}


def _random_pose(draw):
    return (
        oo.Vec3(*(draw.uniform(-5, 5) for _ in range(3))),
        oo.Quat(*(draw.gauss(0, 1) for _ in range(4))).normalized(),
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("inside", [False, True])
def test_rays_meet_every_shape_where_geometry_says(kind, inside):
    """400 rays at random against the closed formula, from outside and from within."""
    make, formula = KINDS[kind]
    draw = random.Random(f"{kind} {inside}")
    position, rotation = _random_pose(draw)
    geom = make()
    world, _ = scene((geom, position, rotation))
    pose = oo.Pose(position, rotation)
    hits = 0
    for _ in range(400):
        size = 0.15 if inside else 2.0
        start = np.array([draw.uniform(-size, size) for _ in range(3)])
        aim = np.array([draw.uniform(-0.7, 0.7) for _ in range(3)])
        way = np.array([draw.gauss(0, 1) for _ in range(3)]) if inside else aim - start
        way /= np.linalg.norm(way)
        length = draw.uniform(0.1, 4)
        span = formula(start, way)
        if inside:
            assert span is not None
        expected = None
        if span is not None:
            at = span[0] if span[0] > 0 else span[1] if span[1] > 0 else None
            if not inside and span[0] <= 0 < span[1] and abs(span[0]) < 1e-9:
                continue
            expected = at if at is not None and at <= length else None
            if (at is not None and abs(at - length) < 1e-6) or span[1] - span[0] < 1e-3:
                continue  # too near the edge of the one or the other to say
        hit = world.cast_ray(pose.transform(start), rotation.rotate(way), length)
        assert (hit is None) == (expected is None)
        if hit is None:
            continue
        hits += 1
        assert hit.geom is geom
        assert hit.body is None
        assert hit.distance == pytest.approx(expected, abs=1e-6)
        assert hit.point.distance(pose.transform(start + expected * way)) < 1e-6
        assert hit.normal.length == pytest.approx(1)
        assert hit.normal.dot(rotation.rotate(way)) <= 1e-9
        # a little before the hit the line is on the other side of the surface than a little behind
        out = np.array(rotation.conjugate().rotate(hit.normal)) * (-1 if inside or span[0] <= 0 else 1)
        outside = start + expected * way + 1e-5 * out
        tangent = np.cross(out, [0.3, 0.5, 0.8])
        graze = formula(outside, tangent / np.linalg.norm(tangent))
        assert graze is None or not graze[0] < 0 < graze[1]
    assert hits > 40


@pytest.mark.parametrize(("height", "way", "distance"), [(2, -1, 2), (-2, 1, 2), (2, 1, None), (-2, -1, None)])
def test_rays_meet_a_plane_from_both_sides(height, way, distance):
    plane = oo.Plane()
    world, _ = scene((plane, None, None))
    hit = world.cast_ray((3, height, -1), (0, way, 0), 10)
    assert (hit and hit.distance) == distance
    if hit:
        assert (hit.geom, hit.point, hit.normal) == (plane, (3, 0, -1), (0, -way, 0))


def test_directions_have_any_length_and_rays_end():
    world, _ = scene((oo.Sphere(1), (0, 0, 5), (1, 0, 0, 0)))
    for factor in (1e-3, 1, 1e5):
        assert world.cast_ray((0, 0, 0), (0, 0, factor), 10).distance == pytest.approx(4)
    assert world.cast_ray((0, 0, 0), (0, 0, 1), 3.999) is None
    assert world.cast_ray((0, 0, 0), (0, 0, 1), 4.001) is not None


def _crowd(broad="own", moving=60, static=60, seed=3):
    """A World full of all kinds of geoms, moving and not."""
    draw = random.Random(seed)
    world, space = scene((oo.Plane((0, 1, 0), -6), None, None), broad=broad, gravity=(0, 0, 0))
    for i in range(moving + static):
        make = list(KINDS.values())[i % len(KINDS)][0]
        position, rotation = _random_pose(draw)
        node = oo.Body(position=position, rotation=rotation) if i < moving else None
        if node is None:
            space.attach(oo.Placeable(position=position, rotation=rotation)).attach(make())
        else:
            space.attach(node).attach(oo.Placeable()).attach(make())
    return world, space


def _rays(count, seed=5):
    rng = np.random.default_rng(seed)
    return rng.uniform(-7, 7, (count, 3)), rng.normal(size=(count, 3))


@BROAD
def test_many_rays_are_those_one_by_one(broad):
    """To the bit; and `geoms`, and NaN and infinity where nothing is hit."""
    world, _ = _crowd(broad)
    world.step()
    origins, directions = _rays(300)
    lengths = np.linspace(0.5, 20, 300)
    many = world.cast_rays(origins, directions, lengths)
    assert len(many) == 300
    assert 50 < many.hit.sum() < 300
    for i, geom in enumerate(many.geoms):
        one = world.cast_ray(origins[i], directions[i], lengths[i])
        assert (one is not None) == many.hit[i]
        if one is None:
            assert geom is None
            assert many.slot[i] == -1
            assert math.isinf(many.distance[i])
            assert np.isnan(many.point[i]).all()
            assert np.isnan(many.normal[i]).all()
        else:
            assert one.geom is geom
            assert world.geom_of_slot(many.slot[i]) is geom
            assert one.distance == pytest.approx(many.distance[i], abs=1e-12)
            assert one.point == pytest.approx(tuple(many.point[i]), abs=1e-12)
            assert one.normal == pytest.approx(tuple(many.normal[i]), abs=1e-12)


def test_the_first_hit_is_the_nearest_of_all():
    """Against each geom asked alone; and `cast_ray_through` has them all in order."""
    world, space = _crowd()
    geoms = [node for node in space.walk() if isinstance(node, oo.Geom)]
    origins, directions = _rays(60)
    for origin, way in zip(origins, directions, strict=True):
        alone = {}
        for geom in geoms:
            hit = world.cast_ray(origin, way, 12, exclude=[g for g in geoms if g is not geom])
            if hit is not None:
                assert hit.geom is geom
                alone[geom] = hit.distance
        through = world.cast_ray_through(origin, way, 12)
        assert {hit.geom: hit.distance for hit in through} == alone
        assert [hit.distance for hit in through] == sorted(alone.values())
        first = world.cast_ray(origin, way, 12)
        assert (first and first.geom) == (through[0].geom if through else None)


def test_one_origin_or_one_direction_serves_for_all_rays():
    world, _ = _crowd()
    _, directions = _rays(50)
    fan = world.cast_rays((0, 0, 0), directions)
    same = world.cast_rays(np.zeros((50, 3)), directions, np.full(50, 1000.0))
    assert np.array_equal(fan.distance, same.distance)
    origins, _ = _rays(50)
    assert len(world.cast_rays(origins, (0, -1, 0), 20)) == 50
    assert len(world.cast_rays((0, 0, 0), (0, -1, 0), [1, 2, 3])) == 3
    assert len(world.cast_rays((0, 0, 0), (0, -1, 0))) == 1
    none = world.cast_rays(np.empty((0, 3)), np.empty((0, 3)), np.empty(0))
    assert (len(none), none.geoms) == (0, [])


# -- what is found and what is not


def test_kinds_and_exclude_say_what_a_ray_passes_through():
    oo.define_kind("tested")
    near = oo.Sphere(0.5, kind="tested")
    far = oo.Sphere(0.5)
    world, space = scene((near, (0, 0, 2), (1, 0, 0, 0)))
    body = space.attach(oo.Body(position=(0, 0, 4)))
    body.attach(oo.Placeable()).attach(far)

    def met(**filters):
        hit = world.cast_ray((0, 0, 0), (0, 0, 1), **filters)
        return hit and hit.geom

    assert met() is near
    assert met(kinds="default") is met(kinds=["default"]) is far
    assert met(kinds={"tested", "default"}) is near
    assert met(kinds=[]) is None
    assert met(exclude=[near]) is met(exclude=near) is far
    assert met(exclude=[near, body]) is None
    assert met(exclude=[space]) is None
    assert met(exclude=iter([near])) is far
    assert met(exclude=[oo.Sphere()]) is near
    assert world.cast_rays((0, 0, 0), (0, 0, 1), kinds="default", exclude=[body]).geoms == [None]
    assert [hit.geom for hit in world.cast_ray_through((0, 0, 0), (0, 0, 1), exclude=near)] == [far]
    assert world.cast_ray((0, 0, 0), (0, 0, 1), exclude=near).body is body


def test_a_space_answers_for_what_is_in_it():
    world = oo.World()
    outer = world.attach(oo.SimpleSpace())
    inner = outer.attach(oo.HashSpace())
    other = world.attach(oo.QuadTreeSpace())
    geoms = {}
    for z, space in ((2, outer), (4, inner), (6, other)):
        geoms[z] = space.attach(oo.Placeable(position=(0, 0, z))).attach(oo.Sphere(0.5))
    loose = world.attach(oo.Body(position=(0, 0, 1)))
    loose.attach(oo.Placeable()).attach(oo.Sphere(0.1))

    def met(where):
        return [hit.geom for hit in where.cast_ray_through((0, 0, 0), (0, 0, 1), 10)]

    assert met(world) == [geoms[2], geoms[4], geoms[6]]
    assert met(outer) == [geoms[2], geoms[4]]
    assert met(inner) == [geoms[4]]
    assert met(other) == [geoms[6]]
    assert inner.cast_rays((0, 0, 0), (0, 0, 1)).geoms == [geoms[4]]
    inner.move_to(other)
    assert met(outer) == [geoms[2]]
    assert met(other) == [geoms[4], geoms[6]]
    assert {hit.geom for hit in other.overlaps(oo.Sphere(5), (0, 0, 2))} == {geoms[4], geoms[6]}


@BROAD
def test_what_sleeps_moved_came_or_went_is_where_it_is_now(broad):
    world, space = scene(broad=broad, gravity=(0, 0, 0))
    body = oo.Body(position=(0, 0, 3))
    ball = body.attach(oo.Placeable()).attach(oo.Sphere(1))

    def distance():
        hit = world.cast_ray((0, 0, 0), (0, 0, 1), 50)
        return hit and hit.distance

    assert distance() is None
    space.attach(body)
    assert distance() == pytest.approx(2)
    world.step()
    body.position = (0, 0, 9)
    assert distance() == pytest.approx(8)
    body.enabled = False
    world.step(3)
    assert distance() == pytest.approx(8)
    assert not body.enabled
    body.position = (0, 0, 5)
    assert distance() == pytest.approx(4)
    ball.radius = 2
    assert distance() == pytest.approx(3)
    ball.enabled = False
    assert distance() is None
    ball.enabled = True
    ball.parent.position = (0, 0, 1)
    assert distance() == pytest.approx(4)
    space.detach(body)
    assert distance() is None


def test_sensors_and_what_collides_with_nothing_are_met():
    world, _ = scene((oo.Sphere(1, sensor=True, collides_with=[]), (0, 0, 3), (1, 0, 0, 0)))
    assert world.cast_ray((0, 0, 0), (0, 0, 1)).distance == pytest.approx(2)


def test_the_nearest_triangle_of_a_hundred_thousand_is_met():
    """A terrain of 224 by 224 squares, y = sin x cos z in its corners: the height between them by interpolation."""
    n = 225
    x, z = np.meshgrid(np.linspace(-10, 10, n), np.linspace(-10, 10, n), indexing="ij")
    y = np.sin(x) * np.cos(z)
    vertices = np.stack([x, y, z], axis=2).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a, b, c, d = (((i + p) * n + j + q).ravel() for p, q in ((0, 0), (0, 1), (1, 1), (1, 0)))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    assert len(triangles) > 100_000
    world, _ = scene((oo.Trimesh((vertices, triangles)), (0, 0, 0), (1, 0, 0, 0)))
    rng = np.random.default_rng(1)
    at = rng.uniform(-9.9, 9.9, (200, 2))
    origins = np.stack([at[:, 0], np.full(200, 5.0), at[:, 1]], axis=1)
    hits = world.cast_rays(origins, (0, -1, 0))
    assert hits.hit.all()
    cell = 20 / (n - 1)
    for (px, pz), point in zip(at, hits.point, strict=True):
        u, v = (px + 10) / cell, (pz + 10) / cell
        p, q = int(u), int(v)
        u, v = u - p, v - q
        corner = y[p, q]
        if v >= u:
            height = corner + v * (y[p, q + 1] - corner) + u * (y[p + 1, q + 1] - y[p, q + 1])
        else:
            height = corner + u * (y[p + 1, q] - corner) + v * (y[p + 1, q + 1] - y[p + 1, q])
        assert point[1] == pytest.approx(height, abs=1e-5)
    # along z = 0 a ray at height 0.5 crosses many waves: the first that it meets is where sin x = 0.5
    low = world.cast_ray((-9.0, 0.5, 0), (1, 0, 0), 30)
    assert low.point.x == pytest.approx(-2 * math.pi + math.pi / 6, abs=0.02)
    assert world.cast_ray((at[0, 0], -5, at[0, 1]), (0, 1, 0)).point.y == pytest.approx(hits.point[0, 1], abs=1e-5)


# -- overlaps


def _surface_points(kind, draw, count=400):
    """Points within a shape, in its own axes."""
    formula = KINDS[kind][1]
    points = []
    while len(points) < count:
        point = np.array([draw.uniform(-1.1, 1.1) for _ in range(3)])
        span = formula(point, np.array([0.0, 0.0, 1.0]))
        if span and span[0] < 0 < span[1]:
            points.append(point)
    return np.array(points)


@pytest.mark.parametrize("asked", [kind for kind in KINDS if kind != "mesh"])
@pytest.mark.parametrize("there", KINDS)
def test_overlaps_are_what_shares_points(asked, there):
    """Brute force: points of the one shape that are inside of the other. Of a mesh the surface counts."""
    draw = random.Random(f"{asked} {there}")
    points = _surface_points(asked, draw)
    formula = KINDS[there][1]
    shape = KINDS[asked][0]()
    geom = KINDS[there][0]()
    world, space = scene((geom, (0, 0, 0), (1, 0, 0, 0)))
    seen = {True: 0, False: 0}
    missed = 0
    for _ in range(60):
        position = oo.Vec3(*(draw.uniform(-1.0, 1.0) for _ in range(3)))
        rotation = _random_pose(draw)[1]
        moved = points @ np.array(rotation.to_matrix()).T + np.array(position)
        spans = [formula(point, np.array([0.0, 0.0, 1.0])) for point in moved]
        shared = sum(span is not None and span[0] < 0 < span[1] for span in spans)
        behind = there == "mesh" and asked != "box" and all(abs(position[k]) < SIZE[k] / 2 for k in range(3))
        if 0 < shared < 8 or behind:
            continue  # barely, or ODE takes it to be behind the surface
        hits = world.overlaps(shape, position, rotation)
        if shared:
            if not hits:
                missed += 1
                continue
            (hit,) = hits
            assert hit.geom is geom
            assert hit.distance > 0
            assert hit.normal.length == pytest.approx(1)
            seen[True] += 1
        else:
            assert not hits or hits[0].distance < 0.2  # a sliver between the points
            seen[False] += not hits
    assert min(seen.values()) > 3
    rough = there == "mesh" or (asked, there) == ("cylinder", "box")  # ODE loses some that are deep in each other
    assert missed <= (0.1 * seen[True] if rough else 0)
    assert shape.world is None
    assert space.overlaps(shape, (50, 0, 0)) == []


def test_a_mesh_can_be_asked_about():
    """A cube of triangles over the others: its surface overlaps what it cuts."""
    mesh = oo.Trimesh(CUBE)
    world, space = scene((oo.Plane(), None, None))
    ball = space.attach(oo.Placeable(position=(3, 5, 0))).attach(oo.Sphere(0.5))
    other = space.attach(oo.Placeable(position=(6, 5, 0))).attach(oo.Trimesh(CUBE))
    assert [hit.geom for hit in world.overlaps(mesh, (0, 0.4, 0))] == [space.children[0]]
    assert world.overlaps(mesh, (0, 0.6, 0)) == []
    assert [hit.geom for hit in world.overlaps(mesh, (3, 5.9, 0))] == [ball]
    assert [hit.geom for hit in world.overlaps(mesh, (6.3, 5.9, 0.2))] == [other]
    assert mesh.world is None


def test_the_normal_and_depth_of_an_overlap_say_how_to_leave():
    world, _ = scene((oo.Plane(), None, None))
    (hit,) = world.overlaps(oo.Sphere(0.5), (1, 0.3, 2))
    assert hit.normal == (0, 1, 0)
    assert hit.distance == pytest.approx(0.2)
    free = oo.Vec3(1, 0.3, 2) + hit.normal * (hit.distance + 1e-9)
    assert world.overlaps(oo.Sphere(0.5), free) == []


def test_overlaps_take_the_filters_of_rays():
    world, space = _crowd()
    everything = {hit.geom for hit in world.overlaps(oo.Sphere(30))}
    assert everything == {n for n in space.walk() if isinstance(n, oo.Geom) and not isinstance(n, oo.Trimesh)} | {
        hit.geom for hit in world.overlaps(oo.Sphere(30)) if isinstance(hit.geom, oo.Trimesh)
    }
    some = next(iter(everything))
    assert {hit.geom for hit in world.overlaps(oo.Sphere(30), exclude=[some])} == everything - {some}
    assert world.overlaps(oo.Sphere(30), kinds=[]) == []


# -- bad input


BAD_RAYS = [
    (("x", (0, 0, 1)), {}, r"cast_ray\(\)\.origin is 'x'"),
    (((0, 0, math.nan), (0, 0, 1)), {}, "origin"),
    (((0, 0, 0), (0, 0, 0)), {}, "direction"),
    (((0, 0, 0), (0, 0, math.inf)), {}, "direction"),
    (((0, 0, 0), (0, 0, 1), 0), {}, "length"),
    (((0, 0, 0), (0, 0, 1), -1), {}, "length"),
    (((0, 0, 0), (0, 0, 1), 1e7), {}, "length"),
    (((0, 0, 0), (0, 0, 1)), {"kinds": "no such"}, "kinds"),
]


@pytest.mark.parametrize(("arguments", "filters", "words"), BAD_RAYS)
def test_bad_rays_are_refused_by_name(arguments, filters, words):
    world, space = scene()
    world.name = "it"
    for node in (world, space):
        with pytest.raises(oo.FieldError, match=words):
            node.cast_ray(*arguments, **filters)
        with pytest.raises(oo.FieldError, match=words.replace("cast_ray", "cast_ray_through")):
            node.cast_ray_through(*arguments, **filters)


@pytest.mark.parametrize(
    ("origins", "directions", "lengths"),
    [
        ([(0, 0)], [(0, 0, 1)], 1),
        (np.zeros((2, 3)), np.ones((3, 3)), 1),
        ("x", (0, 0, 1), 1),
        ((0, 0, 0), (0, 0, 1), [1, -1]),
        ([(0, 0, 0), (0, 0, math.nan)], (0, 0, 1), 1),
        ([(0, 0, 0)], [(0, 0, 0)], 1),
        ([(0, 0, 2e8)], [(0, 0, 1)], 1),
        (None, (0, 0, 1), 1),
    ],
)
def test_bad_tables_of_rays_are_refused(origins, directions, lengths):
    world, _ = scene()
    with pytest.raises(oo.FieldError, match=r"cast_rays\(\)"):
        world.cast_rays(origins, directions, lengths)


def test_bad_shapes_and_filters_are_refused():
    world, space = scene()
    live = space.attach(oo.Placeable()).attach(oo.Sphere())
    for shape in (live, oo.Body(), None, "Sphere"):
        with pytest.raises(oo.TreeError, match=r"overlaps\(\): shape is .* it must be a geom that is in no World"):
            world.overlaps(shape)
    for exclude in (5, None, ["x"], [None]):
        with pytest.raises(oo.TreeError, match="exclude"):
            world.cast_ray((0, 0, 0), (0, 0, 1), exclude=exclude)
    with pytest.raises(oo.FieldError, match="position"):
        world.overlaps(oo.Sphere(), (0, 0, math.inf))
    with pytest.raises(oo.FieldError, match="rotation"):
        world.overlaps(oo.Sphere(), (0, 0, 0), (0, 0, 0, 0))
    with pytest.raises(oo.FieldError, match="can't be placed"):
        world.overlaps(oo.Plane(), (0, 1, 0))
    with pytest.raises(oo.StateError, match="needs a World"):
        oo.HashSpace().cast_ray((0, 0, 0), (0, 0, 1))


def test_nobody_asks_while_another_thread_steps():
    world, _ = _crowd()
    ground = threading.Event()
    caught = []
    asked = threading.Event()

    def listen(touch):
        ground.set()
        asked.wait(10)

    world.on_touch(listen)

    def ask():
        ground.wait(10)
        try:
            world.cast_ray((0, 0, 0), (0, 0, 1))
        except oo.StateError as error:
            caught.append(error)
        asked.set()

    thread = threading.Thread(target=ask)
    thread.start()
    world.step()
    thread.join()
    assert len(caught) == 1


# -- asking changes nothing


@BROAD
def test_asking_between_steps_does_not_change_the_bits(broad):
    """A heap that falls and goes to sleep, asked all the time, beside one that is left alone."""

    def heap():
        world, space = scene((oo.Plane(), None, None), broad=broad)
        world.auto_disable = True
        draw = random.Random(7)
        for i in range(40):
            make = list(KINDS.values())[i % 4][0]
            body = oo.Body(position=(draw.uniform(-1, 1), 1 + 0.5 * i, draw.uniform(-1, 1)))
            space.attach(body).attach(oo.Placeable()).attach(make())
        return world, space

    (asked, space), (alone, _) = heap(), heap()
    origins, directions = _rays(20)
    for i in range(400):
        asked.cast_rays(origins, directions)
        asked.cast_ray(origins[i % 20], directions[i % 20])
        space.overlaps(oo.Box((3, 3, 3)), (0, 1, 0))
        asked.overlaps(oo.Trimesh(CUBE), (0, 1, 0))
        asked.step()
        alone.step()
        assert asked.poses.tobytes() == alone.poses.tobytes()
    assert asked.velocities.tobytes() == alone.velocities.tobytes()


def test_listeners_may_ask_inside_a_step():
    world, space = scene((oo.Plane(), None, None))
    body = space.attach(oo.Body(position=(0, 0.49, 0)))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    heard = []
    body.on_collide(lambda feedback: heard.append(world.cast_ray((0, 5, 0), (0, -1, 0)).body))
    body.on_touch(lambda touch: heard.append(len(world.overlaps(oo.Sphere(1)))))
    world.step()
    assert heard == [body, 2]


def test_hits_keep_their_geoms_though_places_are_given_away():
    """A table of hits names the geoms that were hit, whatever has their slots now."""
    world, space = scene((oo.Sphere(1), (0, 0, 3), (1, 0, 0, 0)))
    (place,) = space.children
    hits = world.cast_rays((0, 0, 0), (0, 0, 1))
    space.detach(place)
    world.step(4)
    space.attach(oo.Placeable()).attach(oo.Box())
    assert hits.geoms == [place.children[0]]
