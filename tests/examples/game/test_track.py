"""Closed lines, and the race track laid along one."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.examples.game.closed_line import ClosedLine, rounded
from osgode.examples.game.track import RAMP_ASIDE, RAMP_AT, Track
from osgode.examples.game.track_mesh import CLEAR, CORNERS, HILL_HEIGHT, RAMP, RISE, WIDTH
from tests.examples.game.roads import empty_world

CIRCLE = [(8 * math.cos(a), 0.5, -8 * math.sin(a)) for a in np.linspace(0, math.tau, 100, endpoint=False)]
"""Counter-clockwise seen from above: it bends to the left."""


# -- lines


def test_a_circle_has_the_length_and_the_bend_of_a_circle():
    line = ClosedLine(CIRCLE)
    assert len(line) == 100
    assert line.length == pytest.approx(math.tau * 8, rel=1e-3)
    for distance in (0.0, 3.3, 20.0, line.length - 0.01):
        assert line.bend(distance) == pytest.approx(1 / 8, rel=1e-6)
    assert ClosedLine(CIRCLE[::-1]).bend(5.0) == pytest.approx(-1 / 8, rel=1e-6)


def test_it_is_walked_round_and_round():
    line = ClosedLine([(0, 0, 0), (0, 0, -4), (3, 1, -4), (3, 0, 0)])
    assert line.length == 14
    assert tuple(line.at(5.5)) == (1.5, 0.5, -4)
    assert tuple(line.at(5.5 + 14)) == tuple(line.at(5.5 - 28)) == (1.5, 0.5, -4)
    assert tuple(line.ahead(5.5)) == (1, 0, 0)
    assert line.yaw(1.0) == 0.0
    assert line.yaw(5.0) == pytest.approx(-math.pi / 2)
    assert line.start_of(2) == line.start_of(6) == 7
    assert list(line) == list(line.points)


def test_it_tells_where_someone_is():
    line = ClosedLine([(0, 0, 0), (0, 0, -4), (3, 0, -4), (3, 0, 0)])
    assert line.nearest((-0.5, 7, -1)) == pytest.approx((1, -0.5))
    assert line.nearest((0.5, 7, -1)) == pytest.approx((1, 0.5))
    assert line.nearest((1, 0, -4.2)) == pytest.approx((5, -0.2))
    assert line.nearest((2.9, 0, -2.0), near=2.0, reach=1.0) == pytest.approx((2.0, 2.9))  # it is not looked farther
    assert line.nearest((1.9, 0, 0.1), near=0.5, reach=2.0) == pytest.approx((12.1, -0.1))  # back over the start


@pytest.mark.parametrize(
    ("points", "words"), [([(0, 0, 0), (1, 0, 0)], "at least 3"), ([(0, 0, 0), (0, 5, 0), (1, 0, 0)], "both at")]
)
def test_a_line_that_is_none_is_refused(points, words):
    with pytest.raises(oo.FieldError, match=words):
        ClosedLine(points)


def test_rounded_corners_are_arcs_of_their_radius_evenly_walked():
    """A square of 40 m whose corners are arcs of 10 m: 4 * 20 + 2 pi 10 long."""
    plan = rounded([(0, 0, 10), (0, -40, 10), (40, -40, 10), (40, 0, 10)], 0.5)
    line = ClosedLine([(x, 0, z) for x, z in plan])
    assert line.length == pytest.approx(80 + 20 * math.pi, rel=1e-3)
    steps = [line.start_of(k + 1) - line.start_of(k) for k in range(len(line) - 1)]
    assert min(steps) > 0.99 * max(steps)
    bends = np.array([line.bend(line.start_of(k)) for k in range(len(line))])
    assert bends.min() == pytest.approx(-1 / 10, rel=1e-3)  # to the right all the way
    assert bends.max() == pytest.approx(0, abs=1e-9)
    corner = min(line, key=lambda point: math.hypot(point.x, point.z))
    assert math.hypot(corner.x - 10, corner.z + 10) == pytest.approx(10)


def test_arcs_that_leave_no_room_are_refused():
    with pytest.raises(oo.FieldError, match="smaller radii"):
        rounded([(0, 0, 10), (0, -15, 10), (15, -15, 2), (15, 0, 2)], 0.5)


# -- the track


everywhere = pytest.mark.parametrize(
    "place", [((0.0, 0.0, 0.0), 0.0), ((40.0, 0.0, -25.0), 2.1)], ids=["at the origin", "elsewhere"]
)


def laid(place):
    """A World with the track there, and the track's axes in it."""
    position, yaw = place
    world, _, still = empty_world()
    return world, still.attach(Track(position, yaw)), oo.Pose(oo.Vec3(*position), oo.Quat.from_yaw_pitch_roll(yaw))


@everywhere
def test_it_begins_where_it_was_put_and_leads_that_way(place):
    _, track, frame = laid(place)
    assert tuple(track.line.at(0.0)) == pytest.approx(tuple(frame.transform((0.0, CLEAR, 0.0))), abs=1e-9)
    assert tuple(track.line.ahead(0.0)) == pytest.approx(tuple(frame.rotation.rotate((0, 0, -1))), abs=1e-9)
    at, yaw = track.spot(20.0, 2.0)
    assert tuple(at) == pytest.approx(tuple(frame.transform((2.0, CLEAR, -20.0))), abs=1e-6)
    assert math.remainder(yaw - math.atan2(*(-frame.rotation.rotate((0, 0, -1)))[::2]), math.tau) == pytest.approx(0)


@everywhere
def test_no_bend_is_sharper_than_its_corner_says(place):
    _, track, _ = laid(place)
    bends = [abs(track.line.bend(track.line.start_of(k))) for k in range(len(track.line))]
    assert max(bends) == pytest.approx(1 / min(radius for _, _, radius in CORNERS), rel=0.01)


@everywhere
def test_the_road_lies_under_its_line_and_over_the_ground_in_all_its_width(place):
    world, track, _ = laid(place)
    heights = set()
    for k in range(0, len(track.line), 5):
        distance = track.line.start_of(k) + 0.4  # on an edge of two triangles a ray may slip through
        for aside in (-0.9, -0.5, 0.03, 0.15, 0.98):
            at, _ = track.spot(distance, aside * WIDTH / 2)
            hit = world.cast_ray(at + oo.Vec3(0.0, 10.0, 0.0), (0, -1, 0), 20.0)
            if hit.geom is track.ramp:
                continue
            assert hit.geom is track.road
            assert hit.point.y == pytest.approx(at.y, abs=0.05)
            heights.add(round(hit.point.y, 1))
    assert max(heights) == pytest.approx(RISE + CLEAR, abs=0.1)


@everywhere
def test_walls_stand_on_the_ground_outside_of_the_bends_and_off_the_road(place):
    world, track, _ = laid(place)
    assert len(track.walls) > 40
    for wall in track.walls:
        middle = wall.pose.position
        distance, aside = track.line.nearest(middle)
        assert abs(aside) > WIDTH / 2 + 2.0
        around = [track.line.bend(distance + step) for step in np.arange(-12.0, 12.5, 1.5)]
        assert any(aside * bend > 0 for bend in around)  # outside of a bend to the left is right of it
        beside = middle + oo.Vec3(*(np.array(wall.pose.rotation.rotate((0.6, 0, 0)))))
        ground = world.cast_ray(beside + oo.Vec3(0, 3, 0), (0, -1, 0), 8.0, exclude=[wall])
        top = middle.y + wall.size[1] / 2
        assert 0.3 < top - ground.point.y < 1.4


@everywhere
def test_the_ramp_rises_along_the_road_on_its_right(place):
    world, track, _ = laid(place)
    width, length, height = RAMP
    for part, lowest, highest in ((0.02, 0.0, 0.1), (0.5, 0.2 * height, 0.5 * height), (0.99, 0.9 * height, height)):
        at, _ = track.spot(RAMP_AT + part * length, RAMP_ASIDE)
        hit = world.cast_ray(at + oo.Vec3(0, 5, 0), (0, -1, 0), 10.0)
        assert hit.geom is track.ramp
        assert lowest <= hit.point.y - CLEAR <= highest + 1e-6
    beside, _ = track.spot(RAMP_AT + length / 2, RAMP_ASIDE - width / 2 - 0.1)
    assert world.cast_ray(beside + oo.Vec3(0, 5, 0), (0, -1, 0), 10.0).geom is track.road
    assert RAMP_ASIDE - width / 2 > 1.2  # who drives on the line passes it


@everywhere
def test_the_hill_is_as_high_as_it_says_and_meets_the_ground(place):
    world, track, _ = laid(place)
    hit = world.cast_ray(track.hilltop + oo.Vec3(0, 5, 0), (0, -1, 0), 10.0)
    assert hit.geom is track.hill
    assert hit.point.y == pytest.approx(HILL_HEIGHT, abs=1e-3)
    foot, yaw = track.before_hill(25.0)
    assert foot.y == pytest.approx(0)
    ahead = oo.Quat.from_yaw_pitch_roll(yaw).rotate((0, 0, -25.0))
    assert tuple(foot + ahead) == pytest.approx((track.hilltop.x, 0.0, track.hilltop.z), abs=1e-6)
    around = world.cast_rays(foot + oo.Vec3(0, 1, 0), [tuple(ahead)], 30.0)
    assert around.distance[0] < 25.0  # level at one metre the way ends in the slope
