"""The debug overlay against what each node says of itself."""

import gc
import itertools
import math
import sys
import weakref

import numpy as np
import pytest

import osgode as oo
from osgode.engine import DebugOverlay
from osgode.engine import debug as looks
from osgode.errors import FieldError
from osgode.render import OffscreenDrawer, Quality

PARTS = ("shapes", "axes", "centres", "joints", "contacts", "boxes", "spaces")


def new_world():
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    return world, space


def overlay_of(world, *parts, **fields):
    """An overlay that shows these parts alone."""
    return DebugOverlay(world, **{part: part in parts for part in PARTS}, **fields)


def shown(overlay, interpolation=1.0):
    """Points and colours of what is hidden by things, and of what isn't."""
    found = overlay.lines(interpolation)
    assert len(found) <= 2
    result = []
    for in_front in (False, True):
        lines = [each for each in found if each.in_front == in_front]
        assert len(lines) <= 1
        points = lines[0].points if lines else np.zeros((0, 2, 3))
        result += [points, [int(c) for c in lines[0].colours.view(np.uint32).ravel()] if lines else []]
    return result


def add(space, shape, position=(0, 0, 0), rotation=(1, 0, 0, 0), at=(0, 0, 0), **fields):
    body = space.attach(oo.Body(position=position, rotation=rotation, **fields))
    body.attach(oo.Placeable(position=at, rotation=oo.Quat.from_axis_angle((1, 0, 0), 0.3))).attach(shape)
    return body


TETRAHEDRON = ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
SHAPES = [
    lambda: oo.Box((1, 2, 3)),
    lambda: oo.Sphere(0.7),
    lambda: oo.Capsule(0.3, 1.5),
    lambda: oo.Cylinder(0.4, 1.2),
    lambda: oo.Trimesh(TETRAHEDRON),
    lambda: oo.ConvexHull(TETRAHEDRON),
    lambda: oo.ConvexHull(TETRAHEDRON, solid=True),
    lambda: oo.Heightfield([(0.0, 1.0, 0.5), (0.2, 0.3, 0.9)], (2, 3), mass=0),
    lambda: oo.Ray(4.0),
]


@pytest.mark.parametrize("static", [False, True])
@pytest.mark.parametrize("number", range(len(SHAPES)))
def test_shapes_are_where_the_physics_has_them(number, static):
    """The lines fit the box that ODE gives: all of it for what has corners, within a tenth for what is round."""
    world, space = new_world()
    turn, at = oo.Quat.from_axis_angle((1, 2, 3), 0.8), (5, 1, -2)
    geom = SHAPES[number]()
    if static:
        space.attach(oo.Placeable(position=at, rotation=turn)).attach(geom)
    else:
        add(space, geom, at, turn, at=(0.5, 0.2, -0.1))
    points = shown(overlay_of(world, "shapes"))[0].reshape(-1, 3)
    low, high = map(np.array, geom.bounds)
    if isinstance(geom, oo.Trimesh | oo.ConvexHull):  # its box is that of its own box, turned
        corners = [geom.pose.transform(corner) for corner in TETRAHEDRON[0]]
        assert all(np.linalg.norm(points - corner, axis=1).min() < 1e-5 for corner in corners)
        assert len(points) == 12
        return
    if isinstance(geom, oo.Heightfield):  # its box goes down to the foot of what is solid
        assert (points > low - 1e-5).all()
        assert (points < high + 1e-5).all()
        ends = [geom.pose.transform((x, geom.height_at(x, z), z)) for x in (-1, 0, 1) for z in (-1.5, 1.5)]
        assert all(np.linalg.norm(points - end, axis=1).min() < 1e-5 for end in ends)
        return
    slack = 0.1 * (high - low).max() if isinstance(geom, oo.Sphere | oo.Capsule | oo.Cylinder) else 1e-5
    assert (points.min(axis=0) > low - 1e-5).all()
    assert (points.max(axis=0) < high + 1e-5).all()
    assert np.allclose(points.min(axis=0), low, atol=slack)
    assert np.allclose(points.max(axis=0), high, atol=slack)


def test_what_is_drawn_instead_makes_no_difference():
    """Nor what is hidden: it is the physics that is shown."""
    world, space = new_world()
    add(space, oo.Box((1, 1, 1), shown=oo.sphere_drawable(9.0), visible=False))
    assert np.abs(shown(overlay_of(world, "shapes"))[0]).max() < 1


def test_planes_are_a_patch_about_the_bodies():
    world, space = new_world()
    space.attach(oo.Plane((0, 1, 0), 1.0))
    add(space, oo.Sphere(0.1), (70, 3, 40))
    overlay = overlay_of(world, "shapes")
    points = shown(overlay)[0][: 2 * 21].reshape(-1, 3)
    assert (points[:, 1] == 1.0).all()
    assert np.allclose(points.mean(axis=0), (70, 1, 40))
    assert np.ptp(points[:, 0]) == 20.0


def test_colours_tell_what_things_are():
    """By the state of this moment: most of it changes without the tree."""
    world, space = new_world()
    body = add(space, oo.Box())
    still = space.attach(oo.Placeable(position=(5, 0, 0))).attach(oo.Box())
    overlay = overlay_of(world, "shapes")
    geom = body.children[0].children[0]

    def colours():
        _, found, _, _ = shown(overlay)
        assert len(found) == 24
        assert len(set(found[:12])) == len(set(found[12:])) == 1
        return found[0], found[-1]

    assert colours() == (looks.STATIC, looks.AWAKE)
    body.enabled = False
    assert colours()[1] == looks.ASLEEP
    body.wake()
    body.kinematic = True
    assert colours()[1] == looks.KINEMATIC
    geom.sensor = True
    assert colours()[1] == looks.FEELS
    geom.enabled = still.enabled = False
    assert colours() == (looks.OFF, looks.OFF)
    world.step()
    geom.enabled, geom.sensor, body.kinematic = True, False, False
    assert colours() == (looks.OFF, looks.AWAKE)


def test_between_two_steps_shapes_are_between():
    """As what is drawn of the body itself."""
    world, space = new_world()
    body = add(space, oo.Box((1, 1, 1)), linear_velocity=(60, 0, 0), angular_velocity=(0, 1, 0), gravity=False)
    overlay = overlay_of(world, "shapes", "axes")
    world.step()
    poses = [world.interpolated_poses(t)[0] for t in (0.0, 0.25, 1.0)]
    for t, pose in zip((0.0, 0.25, 1.0), poses, strict=True):
        points, _, axes, _ = shown(overlay, t)
        assert np.allclose(points.reshape(-1, 3).mean(axis=0), pose[:3], atol=1e-5)
        assert np.allclose(axes[:, 0], pose[:3], atol=1e-5)
    assert body.position.x > 0.2


def test_changes_of_the_tree_are_followed():
    """Sizes, places, comings and goings, also of the body whose row another one takes."""
    world, space = new_world()
    bodies = [add(space, oo.Box((0.1, 0.1, 0.1)), (k, 0, 0)) for k in range(3)]
    overlay = overlay_of(world, "shapes")

    def middles():
        points = shown(overlay)[0].reshape(-1, 24, 3)
        return sorted(points.mean(axis=1).round(4).tolist())

    assert middles() == [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    space.detach(bodies[0])
    bodies[2].position = (7, 0, 0)
    assert middles() == [[1, 0, 0], [7, 0, 0]]
    place = bodies[1].children[0]
    place.children[0].size = (2, 2, 2)
    place.rotation = (1, 0, 0, 0)
    points = shown(overlay)[0].reshape(-1, 3)
    assert points.min() == -1.0
    place.position = (0, 4, 0)
    assert [1, 4, 0] in middles()
    add(space, oo.Box((0.1, 0.1, 0.1)), (9, 0, 0))
    assert len(middles()) == 3
    world.detach(space)
    assert shown(overlay)[1] == []
    world.attach(space)
    assert len(middles()) == 3


def test_axes_are_those_of_the_frame_and_no_longer_than_the_body():
    world, space = new_world()
    turn = oo.Quat.from_axis_angle((0, 0, 1), 0.5)
    add(space, oo.Sphere(0.1), (1, 2, 3), turn)
    add(space, oo.Sphere(9.0), (50, 0, 0))
    _, _, axes, colours = shown(overlay_of(world, "axes", size=0.4))
    assert np.allclose(axes[0], [(1, 2, 3), oo.Pose(oo.Vec3(1, 2, 3), turn).transform((0.1 * math.sqrt(3), 0, 0))])
    assert np.allclose(axes[5], [(50, 0, 0), (50, 0, 0.4)])
    assert colours == [looks.AXES[k // 2] for k in range(6)]


def test_centres_of_mass_are_marked():
    """Also where the centre moves without a change of the tree."""
    world, space = new_world()
    body = add(space, oo.Box(mass=1), (1, 0, 0), oo.Quat.from_axis_angle((0, 1, 0), 1.0))
    other = oo.Placeable(position=(3, 0, 0))
    other.attach(oo.Box(mass=3))
    overlay = overlay_of(world, "centres")
    assert np.allclose(shown(overlay)[2].reshape(-1, 3).mean(axis=0), body.world_centre_of_mass)
    body.attach(other)
    assert np.allclose(shown(overlay)[2].reshape(-1, 3).mean(axis=0), body.world_centre_of_mass, atol=1e-5)
    body.fixed_mass = oo.Mass.box((1, 1, 1), mass=2).translated((0, 5, 0))
    assert body.centre_of_mass == pytest.approx((0, 5, 0))
    assert np.allclose(shown(overlay)[2].reshape(-1, 3).mean(axis=0), body.world_centre_of_mass, atol=1e-5)
    assert set(shown(overlay)[3]) == {looks.CENTRE}
    body.enabled = False
    assert set(shown(overlay)[3]) == {looks.DIM_CENTRE}


def test_contacts_point_at_what_is_pushed():
    """A box on the ground: upwards from where it touches, on static geometry of every kind."""
    for ground in (oo.Plane(), oo.Box((9, 2, 9)), oo.Heightfield([(0.0, 0.0), (0.0, 0.0)], (9, 9))):
        world, space = new_world()
        top = 1.0 if isinstance(ground, oo.Box) else 0.0
        (space if isinstance(ground, oo.Plane) else space.attach(oo.Placeable())).attach(ground)
        body = space.attach(oo.Body(position=(0, top + 0.199, 0)))
        body.attach(oo.Placeable()).attach(oo.Box((0.4, 0.4, 0.4)))
        overlay = overlay_of(world, "contacts", size=10.0)
        assert shown(overlay)[3] == []
        world.step()
        _, _, lines, colours = shown(overlay)
        rows = world.contacts
        assert len(lines) == len(colours) == 5 * len(rows) > 0
        shafts = lines[::5]
        assert np.allclose(shafts[:, 0], rows["geom"]["pos"][:, :3], atol=1e-6)
        reach = 0.2 * math.sqrt(3)  # of the box: marks are no larger
        assert np.allclose(shafts[:, 1] - shafts[:, 0], (0, 0.7 * reach, 0), atol=1e-6)
        shallow = looks._between(looks.TOUCH, looks.DEEP, rows["geom"]["depth"] / looks.DEEPEST)
        assert colours == np.repeat(shallow, 5).tolist()


def test_deep_contacts_are_red_and_their_depth_is_shown():
    world, space = new_world()
    space.attach(oo.Plane())
    space.attach(oo.Body(position=(0, 0.4, 0))).attach(oo.Placeable()).attach(oo.Sphere(0.5))
    world.step()
    _, _, lines, colours = shown(overlay_of(world, "contacts"))
    assert set(colours) == {looks.DEEP}
    start, end = lines[0]
    assert np.allclose(start - end, (0, world.contacts["geom"]["depth"][0], 0), atol=1e-6)
    assert len(lines) == 6


def test_sensors_and_rays_have_colours_of_their_own():
    world, space = new_world()
    add(space, oo.Sphere(0.5, sensor=True, mass=1), (0, 0, 0))
    add(space, oo.Sphere(0.5), (0.5, 0, 0))
    down = oo.Quat.between((0, 0, -1), (0, -1, 0))
    space.attach(oo.Placeable(position=(0.5, 5, 0), rotation=down)).attach(oo.Ray(9.0))
    overlay = overlay_of(world, "contacts")
    world.step()
    _, _, lines, colours = shown(overlay)
    assert set(colours) == {looks.FELT, looks.SEEN}
    hit = lines[[c == looks.SEEN for c in colours]][0]
    assert np.allclose(hit[0], (0.5, 0.5, 0), atol=1e-3)
    assert hit[1, 1] > hit[0, 1]


def test_boxes_are_those_of_the_broad_phase():
    world, space = new_world()
    space.attach(oo.Plane())
    bodies = [add(space, oo.Capsule(0.2, 1.0), (2 * k, 1, 0), angular_velocity=(1, 2, 3)) for k in range(3)]
    inner = space.attach(oo.SimpleSpace())
    add(inner, oo.Sphere(0.5), (0, 9, 0))
    overlay = overlay_of(world, "boxes")
    world.step(5)
    found, colours, _, _ = shown(overlay)
    boxes = found.reshape(-1, 24, 3)
    geoms = [body.children[0].children[0] for body in (*bodies, inner.children[0])]
    assert len(boxes) == len(geoms)
    assert set(colours) == {looks.BOXES}
    expected = sorted(np.float32(geom.bounds).ravel().tolist() for geom in geoms)
    lows_and_highs = np.concatenate([boxes.min(axis=1), boxes.max(axis=1)], axis=1)
    assert np.allclose(sorted(lows_and_highs.tolist()), expected, atol=1e-6)


def test_boxes_of_spaces_hold_what_is_below_them():
    """Planes, which are endless, left out; a space within a space has a box of its own; an empty one has none."""
    world, space = new_world()
    space.attach(oo.Plane())
    add(space, oo.Sphere(0.5), (0, 1, 0))
    inner = space.attach(oo.SimpleSpace())
    add(inner, oo.Sphere(0.5), (4, 2, 0))
    add(inner, oo.Sphere(0.5), (4, 2, 7))
    inner.attach(oo.SimpleSpace())
    found, colours, _, _ = shown(overlay_of(world, "spaces"))
    boxes = found.reshape(-1, 24, 3)
    corners = [[*box.min(axis=0), *box.max(axis=0)] for box in boxes]
    assert np.allclose(sorted(corners), [[-0.5, 0.5, -0.5, 4.5, 2.5, 7.5], [3.5, 1.5, -0.5, 4.5, 2.5, 7.5]], atol=1e-6)
    assert set(colours) == {looks.SPACES}


def test_calls_do_not_grow_with_the_number_of_bodies():
    """What is done for a picture is done in bulk."""
    counts = []
    for number in (3, 40):
        world, space = new_world()
        space.attach(oo.Plane())
        bodies = [add(space, oo.Box(), (1.5 * k, 0.6, 0)) for k in range(number)]
        joints = [oo.Hinge(a, b) for a, b in itertools.pairwise(bodies)]
        overlay = overlay_of(world, *PARTS)
        world.step()
        overlay.lines(0.5)
        calls = 0

        def count(frame, event, argument):
            nonlocal calls
            calls += event == "call" and frame.f_code.co_name not in ("<genexpr>", "<listcomp>")

        sys.setprofile(count)
        overlay.lines(0.5)
        sys.setprofile(None)
        counts.append(calls)
        assert len(joints) == number - 1
    assert counts[0] == counts[1] > 0


def test_it_is_drawn_in_two_calls():
    """In a picture of everything; none while it is hidden, and one where nothing is in front."""
    world, space = new_world()
    space.attach(oo.Plane())
    bodies = [add(space, SHAPES[k](), (1.5 * k, 0.6, 0)) for k in range(4)]
    oo.Hinge(bodies[0], bodies[1])
    world.step()
    overlay = world.attach(overlay_of(world, *PARTS))
    visitor = oo.CullVisitor(world)
    view = oo.View(oo.look_at((3, 5, 9), (3, 0, 0)))
    try:
        drawer = OffscreenDrawer((160, 100), Quality(samples=0, shadow_size=256))
    except oo.OsgodeError as error:
        pytest.skip(str(error))
    with drawer:
        draws = {}
        for visible, several in ((False, True), (True, True), (True, False)):
            overlay.visible = visible
            for part in PARTS[1:]:
                setattr(overlay, part, several)
            drawer.draw(visitor.cull(view, (160, 100)))
            draws[visible, several] = drawer.counts.draws
    assert draws[True, True] == draws[False, True] + 2
    assert draws[True, False] == draws[False, True] + 1


def test_an_empty_world_shows_nothing():
    world = oo.World()
    overlay = overlay_of(world, *PARTS)
    assert list(overlay.lines(0.5)) == []
    world.step()
    assert list(overlay.lines(0.5)) == []
    body = world.attach(oo.Body())
    assert len(shown(overlay)[2]) == 3 + 12  # axes and centre of a body without geoms
    world.detach(body)
    assert list(overlay.lines(0.5)) == []


def test_it_does_not_keep_the_world():
    """And shows nothing once that is gone."""
    world, space = new_world()
    body = add(space, oo.Box())
    oo.Ball(body)
    kept = weakref.ref(body)
    overlay = overlay_of(world, *PARTS)
    assert len(overlay.lines(1.0)) == 2
    del world, space, body
    gc.collect()
    assert oo.live_natives().worlds == 0
    assert list(overlay.lines(1.0)) == []
    gc.collect()
    assert kept() is None


@pytest.mark.parametrize("given", [None, 5, oo.Group()])
def test_only_a_world_can_be_looked_into(given):
    with pytest.raises(FieldError, match=r"DebugOverlay\(\)\.world is"):
        DebugOverlay(given)


@pytest.mark.parametrize("size", [0, -1, math.nan, "big"])
def test_sizes_of_marks_that_cannot_be(size):
    with pytest.raises(FieldError, match="size"):
        DebugOverlay(oo.World(), size=size)
