"""The car: what it is made of, how it drives, and what it bears."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import osgode as oo
from osgode.engine import Camera
from osgode.examples.game.car import (
    BRAKE_TORQUE,
    GRIP,
    HALF_BASE,
    HALF_TRACK,
    RADIUS,
    REVERSE_SPEED,
    ROLL_TORQUE,
    SAG,
    STEERING_FADE,
    STEERING_SPEED,
    SWAY,
    TOP_SPEED,
    WHEELS,
    Car,
)
from osgode.examples.game.driver import Driver
from osgode.examples.game.track_mesh import HILL_HEIGHT, RAMP
from tests.examples.game.roads import STEP, G, on_track, slope, up, with_car


def drive(world, car, seconds, **moves):
    """Hold these controls for so long; the speeds after each step."""
    car.controls.stop()
    car.controls.move(**moves)
    speeds = []
    for _ in range(round(seconds / STEP)):
        world.step()
        speeds.append(car.speed)
    return speeds


# -- what it is


def test_it_is_five_bodies_the_hull_of_two_boxes_on_four_hinge2_joints():
    _, car, _ = with_car()
    assert len(car.bodies) == 5
    assert car.main_body is car.hull
    assert [type(geom) for geom in car.hull.geoms] == [oo.Box, oo.Box]
    assert [type(joint) for joint in car.joints] == [oo.Hinge2] * 4
    for name, wheel in zip(WHEELS, car.wheels, strict=True):
        place = car.hull.world_to_local(wheel.hub.position)
        assert (place.x < 0) == ("left" in name)
        assert (place.z < 0) == ("front" in name)
        assert bool(wheel.max_steering) == ("front" in name)
    assert all(geom.kind == "vehicle" for geom in car.geoms)


def test_it_stands_where_it_was_put_sunk_into_its_springs_by_its_weight():
    world, car, _ = with_car((5.0, 0.0, -3.0), yaw=0.7)
    world.run(seconds=3)
    assert tuple(car.hull.position) == pytest.approx((5.0, RADIUS, -3.0), abs=0.01)
    ahead = car.hull.vector_to_world((0, 0, -1))
    assert math.atan2(-ahead.x, -ahead.z) == pytest.approx(0.7, abs=0.005)
    assert sum(wheel.compression for wheel in car.wheels) / 4 == pytest.approx(SAG, rel=0.03)


@pytest.mark.parametrize("across", [False, True])
def test_it_stands_on_a_slope_of_twenty_degrees_whichever_way_it_looks(across):
    world, car, _ = with_car()
    slope(world, 20.0, across=across)
    world.run(seconds=3)
    before = car.hull.position
    world.run(seconds=20)
    assert car.hull.position.distance(before) < 0.001
    assert car.hull.asleep


# -- speed


def test_it_reaches_20_m_s_within_5_percent_and_no_more():
    world, car, _ = with_car()
    speeds = drive(world, car, 15.0, forward=True)
    assert speeds[-1] >= 0.95 * 20.0
    assert max(speeds) <= 1.05 * 20.0
    assert abs(car.hull.position.x) < 1.0  # straight on, over 240 m


def test_it_is_no_faster_down_a_slope():
    world, car, _ = with_car()
    slope(world, -10.0)
    speeds = drive(world, car, 12.0, forward=True)
    assert speeds[-1] >= 0.95 * TOP_SPEED
    assert max(speeds) <= 1.05 * TOP_SPEED


def test_the_brakes_stop_it_as_fast_as_their_torque_and_the_tyres_allow():
    """All four at full torque slow it by 4 M / (r m), and no tyre by more than its grip times g."""
    world, car, _ = with_car()
    drive(world, car, 8.0, forward=True)
    begin, speed = car.hull.position.z, car.speed
    speeds = drive(world, car, 4.0, ascend=True)
    way = begin - car.hull.position.z
    mass = sum(body.mass for body in car.bodies)
    braked = min(4 * BRAKE_TORQUE / RADIUS / mass, GRIP * G)
    assert abs(speeds[-1]) < 0.05
    assert speed**2 / (2 * braked) < way < 1.3 * speed**2 / (2 * braked)


def test_backward_brakes_first_and_then_reverses():
    world, car, _ = with_car()
    drive(world, car, 4.0, forward=True)
    speeds = drive(world, car, 7.0, backward=True)
    assert all(b < a + 0.05 for a, b in pairwise(speeds[: speeds.index(min(speeds))]))
    assert speeds[-1] == pytest.approx(-REVERSE_SPEED, rel=0.05)
    speeds = drive(world, car, 4.0, forward=True)
    assert speeds[-1] > 5.0


def test_left_alone_it_rolls_on_slowly_to_a_stop_and_falls_asleep():
    """Its engine and bearings brake it by 4 M / (r m)."""
    world, car, _ = with_car()
    drive(world, car, 3.0, forward=True)
    speed = car.speed
    speeds = drive(world, car, 3.0)
    slowed = 4 * ROLL_TORQUE / RADIUS / sum(body.mass for body in car.bodies)
    assert speed - speeds[-1] == pytest.approx(3.0 * slowed, rel=0.1)
    drive(world, car, speed / slowed)
    assert car.speed == pytest.approx(0, abs=0.01)
    assert car.hull.asleep
    assert drive(world, car, 1.0, forward=True)[-1] > 2.0  # and wakes


# -- bends


def test_steering_is_slower_at_speed():
    for speed in (0.0, 15.0):
        world, car, _ = with_car()
        while car.speed < speed:
            drive(world, car, STEP, forward=True)
        drive(world, car, 0.1, left=True)
        assert car.steering == pytest.approx(0.1 * STEERING_SPEED / (1 + speed / STEERING_FADE), rel=0.08)


def test_all_wheels_stand_across_and_roll_by_the_way_to_the_middle_of_the_bend():
    """Of a bend to the left: the middle lies on the rear axle's line; outer wheels are driven faster."""
    world, car, _ = with_car()
    drive(world, car, 0.6, forward=True, left=True)
    middle = -2 * HALF_BASE / math.tan(car.steering)
    ways = {}
    for name, wheel in zip(WHEELS, car.wheels, strict=True):
        x = (-HALF_TRACK if "left" in name else HALF_TRACK) - middle
        ahead = 2 * HALF_BASE if "front" in name else 0.0
        ways[name] = math.hypot(x, ahead)
        assert wheel.steering == pytest.approx(math.atan2(ahead, x), abs=0.01)
    speeds = {name: wheel.hinge.motor_velocity2 * RADIUS for name, wheel in zip(WHEELS, car.wheels, strict=True)}
    for name, way in ways.items():
        assert speeds[name] / speeds["rear left"] == pytest.approx(way / ways["rear left"], rel=0.02)
    assert speeds["front right"] > speeds["front left"]
    assert speeds["rear right"] > 1.1 * speeds["rear left"]


@cache
def round_and_round(radius, speed, *, sway_bars):
    """Drive round a circle; then, for eight seconds: roll, angle of the way against the nose, aside, speed, upright."""
    world, car, _ = with_car((radius, 0.0, 0.0), sway_bars=sway_bars)
    points = [(radius * math.cos(a), 0.0, -radius * math.sin(a)) for a in np.linspace(0, math.tau, 120, endpoint=False)]
    driver = Driver(car, points, top_speed=speed, side_limit=100.0)
    driver.begin()
    world.run(seconds=8)
    rows = []
    for _ in range(round(8 / STEP)):
        world.step()
        velocity = car.hull.vector_to_local(car.hull.linear_velocity)
        rows.append((car.roll, math.atan2(velocity.x, -velocity.z), driver.aside, car.speed, up(car)))
    return np.array(rows)


@pytest.mark.parametrize("sway_bars", [True, False])
def test_it_turns_a_circle_of_20_m_at_10_m_s_without_rolling_over_or_skidding_off(sway_bars):
    rows = round_and_round(20.0, 10.0, sway_bars=sway_bars)
    rolls, skids, asides, speeds, uprights = rows.T
    assert speeds.min() > 9.5
    assert np.abs(asides).max() < 1.0
    assert np.abs(skids).max() < 0.1  # radians
    assert uprights.min() > 0.99
    assert rolls.min() > 0.0  # it leans outward, to the right


def test_sway_bars_keep_it_from_leaning():
    """The springs of both sides, 2 k b each axle, hold it from rolling by 4 k b^2; each bar by 4 s b^2 for s N/m."""
    leaning = [round_and_round(20.0, 10.0, sway_bars=bars)[:, 0].mean() for bars in (True, False)]
    spring = with_car()[1].wheels[0].hinge.suspension_stiffness
    springs, bars = 4 * spring * HALF_TRACK**2, 2 * 4 * SWAY * HALF_TRACK**2
    assert leaning[0] / leaning[1] == pytest.approx(springs / (springs + bars), rel=0.15)
    assert leaning[1] > math.radians(3.0)


def test_it_keeps_to_a_circle_of_20_m_across_at_10_m_s():
    """There the tyres must hold it with more than its weight: v^2 / r = 10 m/s2."""
    rows = round_and_round(10.0, 10.0, sway_bars=True)
    assert rows[:, 4].min() > 0.98
    assert np.abs(rows[:, 1]).max() < 0.15
    assert np.abs(rows[:, 2]).max() < 3.0


# -- hill and ramp


def test_it_climbs_the_hill():
    world, car, track = on_track(lambda track: track.before_hill(26.0))
    world.run(seconds=0.5)
    highest = 0.0
    for _ in range(round(6 / STEP)):
        car.controls.move(forward=True)
        world.step()
        highest = max(highest, car.hull.position.y)
        if car.hull.position.z < track.hilltop.z:
            break
    assert highest == pytest.approx(HILL_HEIGHT + RADIUS, abs=0.3)
    assert car.hull.position.distance(track.hilltop) < 1.0
    assert sum(car.wheel_damage) == 0


def test_it_jumps_the_ramp_and_lands_on_its_wheels():
    world, car, _ = on_track(lambda track: track.before_ramp(38.0))
    world.run(seconds=0.5)
    car.controls.move(forward=True)
    in_the_air, highest, uprights = 0, 0.0, []
    for _ in range(round(7 / STEP)):
        world.step()
        in_the_air += not any(geom.touching for geom in car.geoms)
        highest = max(highest, car.hull.position.y)
        uprights.append(up(car))
        if car.hull.position.z < -72.0:
            car.controls.stop()
            car.controls.move(ascend=True)
    assert in_the_air * STEP > 0.6
    assert highest > RAMP[2] + RADIUS + 0.5
    assert min(uprights) > math.cos(math.radians(30.0))
    assert up(car) > 0.999
    assert all(wheel.hub.geoms[0].touching for wheel in car.wheels) or car.hull.asleep
    assert car.on == (True,) * 4
    assert sum(car.wheel_damage) == 0


# -- damage


def against_a_wall(speed):
    """Drive straight into a wall at about that speed; the World and the car five seconds later."""
    world, car, still = with_car()
    world.run(seconds=0.5)
    while car.speed < 0.99 * speed:
        drive(world, car, STEP, forward=True)
    wall = oo.Placeable(position=(0.0, 1.0, car.hull.position.z - 10.0))
    still.attach(wall).attach(oo.Box((20.0, 2.0, 1.0), material="concrete"))
    heard = []
    for wheel in car.wheels:
        wheel.hinge.on_let_go(heard.append)
    while car.speed > 0.5 * speed:  # neither faster nor slower
        drive(world, car, STEP, forward=car.speed < speed)
    drive(world, car, 5.0)
    return world, car, heard


def test_it_loses_a_wheel_in_a_crash_at_full_speed():
    world, car, heard = against_a_wall(TOP_SPEED)
    lost = [k for k in range(4) if not car.on[k]]
    assert lost
    assert [event.joint for event in heard] == [car.wheels[k].hinge for k in lost]
    assert len(car.bodies) == 5 - len(lost)
    for k in lost:
        hub = car.wheels[k].hub
        assert car.wheel_damage[k] == 1.0
        assert hub.joints == ()
        assert hub.parent is car.parent
        assert type(hub.geoms[0]) is oo.Cylinder
    assert np.isfinite(world.poses).all()
    for body in world.bodies:
        assert body.position.z > car.hull.position.z - 12.0  # nothing is behind the wall
    drive(world, car, 2.0, forward=True)  # the others still do what they can
    drive(world, car, 2.0, left=True, backward=True)


def test_a_lost_wheel_rolls_away():
    world, car, _ = with_car()
    drive(world, car, 5.0, forward=True)
    car.lose(0)
    car.lose(0)  # there is but one
    hub = car.wheels[0].hub
    assert car.on == (False, True, True, True)
    assert car.wheel_damage == (1.0, 0.0, 0.0, 0.0)
    drive(world, car, 4.0, ascend=True)
    assert hub.position.distance(car.hull.position) > 3.0
    assert 0.0 < hub.position.y < 2.0 * RADIUS


def test_bumping_into_a_wall_does_no_harm():
    _, car, heard = against_a_wall(6.0)
    assert car.wheel_damage == (0.0,) * 4
    assert heard == []


# -- who is in it


def test_a_camera_rides_steers_and_looks_about():
    world, car, still = with_car(yaw=0.5)
    camera = Camera(world=world, obstacles=still)
    camera.ride(car, "delta")
    assert car.occupied
    camera.move(forward=True)
    camera.look(0.3, -0.1)
    camera.steer()
    world.run(seconds=1)
    camera.update(0.0)
    assert car.speed > 3.0
    looks = camera.forward
    assert math.atan2(-looks.x, -looks.z) == pytest.approx(0.5 - 0.3, abs=0.02)
    eye = car.hull.world_to_local(camera.pose.position)
    assert tuple(eye) == pytest.approx(tuple(Car.EYE.position), abs=1e-9)
    camera.dismount()
    assert not car.occupied
    assert not car.controls.moves


def test_one_gets_out_by_the_left_door_if_there_is_room_else_elsewhere():
    world, car, still = with_car()
    with pytest.raises(oo.StateError, match="way_out"):
        Car().way_out()
    world.run(seconds=1)
    places = []
    for wall in ((-1.5, 0.0), (1.5, 0.0), (0.0, 2.9), (0.0, -2.9)):
        feet = car.way_out()
        assert feet.y == pytest.approx(0.05, abs=0.01)
        places.append((round(feet.x, 1), round(feet.z, 1)))
        size = (0.4, 2.0, 5.0) if wall[0] else (5.0, 2.0, 0.4)
        still.attach(oo.Placeable(position=(wall[0], 1.0, wall[1]))).attach(oo.Box(size))
    assert places == [(-1.6, 0.2), (1.6, 0.2), (0.0, 3.0), (0.0, -3.0)]
    assert car.way_out().y > 1.3  # only the roof is left


def test_nobody_is_put_behind_a_thin_wall():
    world, car, still = with_car()
    still.attach(oo.Placeable(position=(-1.15, 1.0, 0.0))).attach(oo.Box((0.05, 2.0, 5.0)))
    world.run(seconds=0.1)
    assert car.way_out().x > 0


def test_it_is_set_on_its_wheels_again():
    world, car, _ = with_car((2.0, 0.0, 1.0))
    turned = oo.Quat.from_yaw_pitch_roll(0.8) * oo.Quat.from_axis_angle((0, 0, 1), math.pi)
    car.place(oo.Pose(oo.Vec3(2.0, 1.5, 1.0), turned))
    world.run(seconds=2)
    assert car.upset
    car.put_upright()
    world.run(seconds=2)
    assert not car.upset
    assert up(car) > 0.999
    assert car.hull.position.y == pytest.approx(RADIUS, abs=0.02)
    ahead = car.hull.vector_to_world((0, 0, -1))
    assert math.atan2(-ahead.x, -ahead.z) == pytest.approx(0.8, abs=0.2)


def test_it_goes_out_of_the_world_and_comes_back_as_it_was():
    world, car, _ = with_car()
    drive(world, car, 2.0, forward=True)
    speed = car.speed
    car.leave()
    world.run(seconds=1)
    car.enter()
    assert car.speed == pytest.approx(speed)
    assert drive(world, car, 1.0, forward=True)[-1] > speed


def test_two_runs_give_the_same_bits():
    ends = []
    for _ in range(2):
        world, car, track = on_track(lambda track: track.spot(60.0))
        Driver(car, track.line).begin()
        world.run(seconds=6)
        ends.append((world.poses.tobytes(), world.velocities.tobytes(), world.joint_states.tobytes()))
    assert ends[0] == ends[1]
