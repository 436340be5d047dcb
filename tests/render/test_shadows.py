"""Shadows: that they are cast, where, and that surfaces don't shadow themselves."""

import math

import numpy as np
import pytest

from osgode.graph.appearance import Appearance
from osgode.graph.frame import Bin, Frame, Sun, View
from osgode.graph.mesh import Mesh
from osgode.graph.primitives import box_mesh, rectangle_mesh, sphere_mesh
from osgode.maths import Pose, Quat, Vec3, look_at
from osgode.render.shadows import Cascade, fit, light_axes, select
from tests.render.scenes import CLEAR, SIZE, many, place, quad

WHITE = Appearance((0.7, 0.7, 0.7), shininess=0.0)
FLAT = Quat.from_axis_angle((1, 0, 0), -math.pi / 2)
GROUND = many(quad(), WHITE, place(rotation=FLAT, scale=(100, 100, 1)))
NOON, SLANTED, LOW = Vec3(0, -1, 0), Vec3(-0.45, -0.8, -0.4), Vec3(-0.9, -0.25, 0.2)
ABOVE = View(look_at((0, 12, 0.01), (0, 0, 0)))


def shot(drawer, things, casters, direction, view=ABOVE, **sun):
    drawer.draw(Frame(view, SIZE, [GROUND, *things], [], casters, sun=Sun(direction, **sun), sky=CLEAR))
    return drawer.image().astype(int)


def test_shadow_lies_where_the_light_is_kept_off(drawer):
    """A plate 2 m over the ground, under a sun at 45 degrees, shades the ground 2 m farther on."""
    plate = many(box_mesh(), WHITE, place((0, 2, 0), scale=(2, 0.1, 2)))
    # From above: a metre of the ground is so many pixels, +X to the right.
    metre = 50 / (12 * math.tan(0.5))
    bright = shot(drawer, [], [], Vec3(1, -1, 0))[..., 0]
    dark = shot(drawer, [], [plate], Vec3(1, -1, 0))[..., 0] < 0.8 * bright
    rows, columns = np.nonzero(dark)
    assert columns.mean() - 80 == pytest.approx(2 * metre, abs=1.5)
    assert rows.mean() - 50 == pytest.approx(0, abs=1.5)
    assert np.count_nonzero(dark) == pytest.approx((2 * metre) ** 2, rel=0.12)


@pytest.mark.parametrize(("height", "expected"), [(5, True), (60, True), (400, False)])
def test_shadows_near_far_and_beyond(drawer, height, expected):
    """The fine map serves near the eye, the coarse one farther on, and where both end there is just sunlight."""
    view = View(look_at((0, height, 0.01), (0, 0, 0)))
    edge = max(height / 4, 2.5)
    plate = many(box_mesh(), WHITE, place((0, 0.5 * edge, 0), scale=(edge, 0.1, edge)))
    bright, dark = (shot(drawer, [], casters, Vec3(1, -1, 0), view)[..., 0] for casters in ([], [plate]))
    metre = 50 / (height * math.tan(0.5))
    area = (edge * metre) ** 2 if expected else 0
    assert np.count_nonzero(dark < 0.8 * bright) == pytest.approx(area, rel=0.12)
    columns = np.nonzero(dark < 0.8 * bright)[1]
    assert not expected or columns.mean() - 80 == pytest.approx(edge / 2 * metre, abs=3)
    assert (dark <= bright + 1).all()


def test_shadows_fade_out_in_the_distance(drawer):
    """Under a roof without end the ground is dark near the eye, sunlit far away, and nowhere is there an edge."""
    roof = many(box_mesh(), WHITE, place((0, 30, 0), scale=(5000, 1, 5000)))
    view = View(Pose(Vec3(0, 28, 0), Quat.from_yaw_pitch_roll(pitch=-0.2)), field_of_view=0.4)
    endless = many(quad(), WHITE, place(rotation=FLAT, scale=(3000, 3000, 1)))
    pictures = []
    for casters in ([], [roof]):
        drawer.draw(Frame(view, SIZE, [endless], [], casters, sun=Sun(NOON), sky=CLEAR))
        pictures.append(drawer.image()[2:, 80, 0].astype(int))
    share = pictures[1] / pictures[0]  # from below the horizon down
    assert share[-1] < 0.7
    assert share[0] == 1.0
    assert (np.diff(share) <= 0).all()
    assert np.diff(share).min() > -0.25


def test_sheets_cast_whichever_way_they_face(drawer):
    """An open surface keeps the light off from both sides."""
    areas = []
    for angle in (0.5, -0.5):
        sheet = many(quad(), WHITE, place((0, 2, 0), Quat.from_axis_angle((1, 0, 0), angle * math.pi)))
        bright, dark = (shot(drawer, [], casters, NOON)[..., 0] for casters in ([], [sheet]))
        areas.append(np.count_nonzero(dark < 0.8 * bright))
    assert areas[0] > 100
    assert areas[0] == pytest.approx(areas[1], rel=0.02)


def test_only_casters_cast(drawer):
    """What isn't among the casters throws no shadow, and `Sun.shadows` turns all of them off."""
    box = many(box_mesh(), WHITE, place((0, 2, 0)))
    none = shot(drawer, [], [], SLANTED)
    assert (shot(drawer, [], [box], SLANTED, shadows=False) == none).all()
    assert (shot(drawer, [], [box], SLANTED) != none).any()


def test_caster_out_of_sight(drawer):
    """A thing high above, outside the picture, still throws its shadow into it."""
    roof = many(box_mesh(), WHITE, place((-300, 300, 0), scale=(4, 1, 4)))
    bright = shot(drawer, [], [], Vec3(1, -1, 0))
    dark = shot(drawer, [], [roof], Vec3(1, -1, 0))
    assert (dark[50, 80] < 0.8 * bright[50, 80]).all()


@pytest.mark.parametrize("direction", [NOON, SLANTED, LOW])
def test_no_surface_shadows_itself(drawer, direction):
    """Ground, boxes and balls that cast shadows have no stripes or specks on what the sun meets."""
    ball = many(sphere_mesh(), WHITE, place((0, 3, 0), scale=(2, 2, 2)))
    view = View(look_at(-direction.normalized() * 14 + (0, 3, 0), (0, 3, 0), (0, 0, 1)))
    lone = Frame(view, SIZE, [ball], [], [], sun=Sun(direction), sky=CLEAR)
    drawer.draw(lone)
    free = drawer.image().astype(int)
    drawer.draw(Frame(view, SIZE, [ball], [], [ball], sun=Sun(direction), sky=CLEAR))
    assert np.abs(drawer.image() - free).max() <= 6  # from the sun's side nothing of it is in shadow
    alone = shot(drawer, [], [], direction)
    assert np.abs(shot(drawer, [], [GROUND], direction) - alone).max() <= 3


@pytest.mark.parametrize("direction", [SLANTED, LOW])
def test_shadow_begins_at_the_foot(drawer, direction):
    """Right beside the foot of a thing, on the side away from the sun, the ground is dark: nothing floats."""
    away = Vec3(direction.x, 0, direction.z).normalized()
    turned = Quat.from_axis_angle((0, 1, 0), math.atan2(away.x, away.z))
    post = many(box_mesh(), WHITE, place((0, 1, 0), turned, (0.6, 2, 0.6)))
    # So close that a gap of two centimetres would be a pixel.
    view = View(look_at((0, 1.2, 0) + away * 2.2, (0, 0, 0) + away * 0.4), near=0.05)
    bright, dark = (shot(drawer, [post], casters, direction, view)[..., 0] for casters in ([], [post]))
    # Along the middle column: the post, its foot, the ground towards the camera.
    column = (dark < 0.8 * bright)[:, 80]
    assert column[-1]
    first = int(np.flatnonzero(column)[0])
    assert column[first:].all()
    foot = int(project(view, away * 0.3)[1])
    assert first <= foot + 1


def project(view, point):
    """Where a point of the world is in the picture, pixels."""
    x, y, _, w = view.projection_matrix(SIZE[0] / SIZE[1]) @ view.view_matrix() @ (*point, 1.0)
    return (x / w + 1) / 2 * SIZE[0], (1 - y / w) / 2 * SIZE[1]


def test_light_axes_point_at_the_sun():
    """The axes are right-handed, of length 1, and the third points against the light."""
    for direction in (NOON, -NOON, SLANTED, LOW):
        axes = light_axes(direction)
        assert np.allclose(axes @ axes.T, np.identity(3))
        assert np.linalg.det(axes) == pytest.approx(1)
        assert np.allclose(axes[2], -direction.normalized())


@pytest.mark.parametrize("field_of_view", [0.3, 1.0, 2.0])
def test_cascade_holds_what_the_view_sees(field_of_view):
    """Every corner of the view up to the distance is within the cube, less the texel that it was moved by."""
    view = View(Pose(Vec3(5, 2, -3), Quat.from_yaw_pitch_roll(0.7, -0.4, 0.2)), field_of_view)
    axes = light_axes(SLANTED)
    cascade = fit(view, 1.6, axes, 30.0, 512)
    high = math.tan(field_of_view / 2)
    texel = 2 * cascade.radius / 512
    for depth in (0.0, 30.0):
        for x, y in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
            corner = view.pose.transform((1.6 * high * x * depth, high * y * depth, -depth))
            assert np.abs(axes @ corner - cascade.centre).max() <= cascade.radius + texel


def test_cascade_moves_by_whole_texels():
    """A camera that moves and turns leaves the size alone and shifts the grid onto itself."""
    axes = light_axes(SLANTED)
    first = fit(View(), 1.6, axes, 30.0, 512)
    texel = 2 * first.radius / 512
    for step in range(1, 20):
        moved = View(Pose(Vec3(0.013 * step, 0.1, -0.07 * step), Quat.from_yaw_pitch_roll(0.05 * step)))
        other = fit(moved, 1.6, axes, 30.0, 512)
        assert other.radius == first.radius
        texels = (np.array(other.centre) - first.centre) / texel
        assert np.allclose(texels, np.round(texels), atol=1e-6)


def test_select_keeps_what_can_reach_the_cube():
    """Kept is what overlaps the cube or lies between it and the sun; not what is beside or behind it."""
    axes, cube = light_axes(NOON), Cascade((0.0, 0.0, 0.0), 10.0)
    places = {"inside": (0, 0, 0), "sunwards": (0, 500, 0), "beside": (30, 0, 0), "behind": (0, -30, 0)}
    for name, position in places.items():
        ((matrices, runs),) = select([many(box_mesh(), WHITE, place(position))], axes, [cube], 512)
        assert len(matrices) == sum(run.instances for run in runs) == (name in ("inside", "sunwards")), name
    ((matrices, _),) = select([many(box_mesh(), WHITE, place((30, 0, 0), scale=(50, 1, 1)))], axes, [cube], 512)
    assert len(matrices) == 1  # large enough to reach in from beside


def test_select_joins_bins_of_one_mesh():
    """Looks don't matter to a shadow: two bins of a mesh are one draw, with the right instances."""
    box, ball = box_mesh(), sphere_mesh()
    bins = [
        many(box, WHITE, place((1, 0, 0)), place((99, 0, 0))),
        many(ball, WHITE, place((2, 0, 0))),
        many(box, Appearance((1, 0, 0)), place((3, 0, 0))),
    ]
    ((matrices, runs),) = select(bins, light_axes(NOON), [Cascade((0.0, 0.0, 0.0), 10.0)], 2048)
    assert [(run.mesh, run.first, run.instances) for run in runs] == [(box, 0, 2), (ball, 2, 1)]
    assert matrices[:, 0, 3].tolist() == [1, 3, 2]


def test_select_of_nothing():
    """No casters, or empty bins of them, are no draws."""
    axes, cubes = light_axes(NOON), [Cascade((0.0, 0.0, 0.0), 10.0)] * 2
    empty = Bin(box_mesh(), WHITE, np.zeros((0, 4, 4), np.float32))
    for casters in ([], [empty]):
        assert [(len(matrices), runs) for matrices, runs in select(casters, axes, cubes, 512)] == [(0, []), (0, [])]


@pytest.mark.parametrize(
    ("texel", "scales", "corners"),
    [
        (0.16, (1.0,), 8),
        (0.16, (0.1, 1.0), 8),
        (0.16, (1.0, 1.5), 12),  # the largest decides
        (0.14, (1.0,), 12),
        (0.07, (1.0,), 12),
        (0.06, (1.0,), 24),
        (0.06, (0.2,), 8),
    ],
)
def test_simpler_meshes_cast_shadows(texel, scales, corners):
    """If what their outline lacks is no larger than a texel: of a ball of 1 m 15 cm by 8 corners, 7 cm by 12."""
    ball, texels = sphere_mesh(), round(20.0 / texel)
    places = [place((k, 0, 0), scale=(scale,) * 3) for k, scale in enumerate(scales)]
    ((_, (run,)),) = select([many(ball, WHITE, *places)], light_axes(NOON), [Cascade((0.0, 0.0, 0.0), 10.0)], texels)
    assert len(run.mesh.triangles) == corners * (corners - 2)
    assert run.instances == len(scales)


def test_shadow_by_a_simpler_mesh_is_the_same(drawer):
    """In the picture nobody can tell."""
    ball = sphere_mesh()
    plain = Mesh(ball.vertices, ball.triangles, ball.normals)
    pictures = []
    for mesh in (ball, plain):
        shown = many(mesh, WHITE, *(place((x, 0.05, -4), scale=(0.05,) * 3) for x in np.arange(-2, 2, 0.2)))
        floor = many(box_mesh(), WHITE, place((0, -0.5, -4), scale=(20, 1, 20)))
        view = View(look_at((0, 1.5, 0), (0, 0, -4)))
        drawer.draw(Frame(view, (160, 100), [floor, shown], casters=[floor, shown], sun=Sun(Vec3(0.3, -1, 0.2))))
        pictures.append(drawer.image().astype(int))
    assert np.abs(pictures[0] - pictures[1]).max() < 24


def test_half_space_throws_no_shadow_from_its_front(drawer):
    """A mere sheet does, on what is below it. A sun below the ground shines on nothing above it in either case."""
    box, cellar = many(box_mesh(), WHITE, place((0, 1, 0))), many(box_mesh(), WHITE, place((0, -2, 0)))
    pictures = {}
    for solid in (False, True):
        floor = many(rectangle_mesh(100, 100, None, solid), WHITE, place(rotation=FLAT))
        for name, seen, sun in (("day", [floor, box], SLANTED), ("night", [floor, box], -SLANTED)):
            drawer.draw(Frame(ABOVE, SIZE, seen, [], [floor, box], sun=Sun(sun), sky=CLEAR))
            pictures[name, solid] = drawer.image().astype(int)
        drawer.draw(Frame(ABOVE, SIZE, [cellar], [], [floor, cellar], sun=Sun(SLANTED), sky=CLEAR))
        pictures["cellar", solid] = drawer.image().astype(int)
    assert np.abs(pictures["day", True] - pictures["day", False]).mean() < 0.02
    assert np.array_equal(pictures["night", True], pictures["night", False])
    middle = np.s_[SIZE[1] // 2, SIZE[0] // 2]
    assert (pictures["cellar", True][middle] > pictures["cellar", False][middle] + 40).all()
