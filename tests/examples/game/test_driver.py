"""Programs at the controls: a car laps the track, a walker patrols."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.engine import ControllableObject
from osgode.examples.game.closed_line import ClosedLine
from osgode.examples.game.driver import Driver, Patrol, allowed_speeds
from osgode.examples.game.track_mesh import WIDTH
from tests.examples.game.roads import STEP, on_track, up, with_car


def test_it_laps_the_track_in_a_stable_time_without_losing_a_wheel():
    world, car, track = on_track(lambda track: track.spot(-6.0))
    driver = Driver(car, track.line)
    driver.begin()
    assert driver.running
    asides, uprights = [], []
    while len(driver.lap_times) < 3:
        assert world.time < 150.0
        world.step()
        asides.append(abs(driver.aside))
        uprights.append(up(car))
    first, second, third = driver.lap_times
    assert third == pytest.approx(second, rel=0.02)
    assert first == pytest.approx(second, rel=0.05)  # it had some metres to gather speed
    assert track.line.length / 20.0 < third < track.line.length / 8.0
    assert max(asides) < WIDTH / 2 - 1.0
    assert min(uprights) > 0.97
    assert car.wheel_damage == (0.0,) * 4
    driver.end()
    assert not driver.running
    world.run(seconds=25)
    assert abs(car.speed) < 0.01


def test_it_finds_its_way_from_anywhere_and_round_the_other_way():
    world, car, track = on_track(lambda track: (track.spot(200.0, 3.5)[0], track.spot(200.0)[1] + math.pi + 0.5))
    driver = Driver(car, ClosedLine(track.line.points[::-1]), top_speed=12.0)
    driver.begin()
    world.run(seconds=4)
    for _ in range(round(10 / STEP)):
        world.step()
        assert abs(driver.aside) < 1.2
    assert car.speed > 7.0


def test_a_wall_in_its_way_does_not_hold_it_for_ever():
    """It goes back and tries again: it never stands still for long."""
    world, car, still = with_car((0.0, 0.0, 6.0))
    still.attach(oo.Placeable(position=(0.4, 0.5, -8.0))).attach(oo.Box((2.4, 1.0, 0.5)))
    line = [(0.0, 0.0, 10.0 - 5.0 * k) for k in range(12)] + [(40.0, 0.0, -50.0 + 5.0 * k) for k in range(12)]
    driver = Driver(car, line, top_speed=5.0)
    driver.begin()
    backward = 0
    for _ in range(round(25 / STEP)):
        world.step()
        backward += car.speed < -0.5
    assert backward * STEP > 0.5


def test_what_it_dares_is_what_bends_and_brakes_allow():
    """On a straight before a bend of radius r: sqrt(v^2 + 2 b s), up to its top speed, with v = sqrt(a r)."""
    points = [(0.0, 0.0, -2.0 * k) for k in range(31)]
    points += [(10 - 10 * math.cos(a), 0.0, -60 - 10 * math.sin(a)) for a in np.linspace(0.2, math.pi, 15)]
    points += [(20.0, 0.0, -58.0 + 2.0 * k) for k in range(31)]
    line = ClosedLine(points)
    speeds = allowed_speeds(line, 15.0, 4.0, braking=5.0)
    assert speeds[38] == pytest.approx(math.sqrt(4.0 * 10.0), rel=0.02)
    assert max(speeds) == 15.0
    for k in range(15, 29):
        ahead = line.start_of(30) - line.start_of(k)
        assert speeds[k] == pytest.approx(min(15.0, math.sqrt(speeds[30] ** 2 + 10.0 * ahead)), rel=1e-9)


def test_a_car_that_does_not_tell_its_steering_is_driven_too():
    class Quiet(ControllableObject):
        """Turns by up to 1 rad/s and drives on at its speed, as told."""

        def __init__(self):
            super().__init__()
            self.hull = self.attach(oo.Body(gravity=False, position=(12.0, 0.0, 0.0)))
            self.hull.attach(oo.Placeable()).attach(oo.Sphere(0.5, mass=1))

        def control(self):
            moves = self.controls.moves
            turn = ("left" in moves) - ("right" in moves)
            self.hull.angular_velocity = (0.0, 1.0 * turn, 0.0)
            self.hull.linear_velocity = self.hull.vector_to_world((0.0, 0.0, -4.0 * ("forward" in moves)))

    world = oo.World(step_size=STEP)
    space = world.attach(oo.SimpleSpace())
    world.collide(space)
    thing = space.attach(Quiet())
    circle = [(12 * math.cos(a), 0.0, -12 * math.sin(a)) for a in np.linspace(0, math.tau, 60, endpoint=False)]
    driver = Driver(thing, circle, top_speed=5.0)
    driver.begin()
    for _ in range(round(25 / STEP)):
        world.step()
        assert abs(driver.aside) < 0.5
    assert driver.progress > 0


def test_a_program_waits_for_a_world_and_ends_with_it():
    _, car, still = with_car()
    driver = Driver(car, [(0, 0, 0), (0, 0, -50), (50, 0, -50)])
    driver.begin()
    driver.begin()  # once is enough
    car.leave()
    assert not driver.running
    with pytest.raises(oo.StateError):
        driver.begin()
    car.enter()
    driver.begin()
    assert driver.running
    assert still is not None


# -- walking


class Walker(ControllableObject):
    """Walks at 1.5 m/s where its controls say."""

    def __init__(self, position):
        super().__init__()
        self.torso = self.attach(oo.Body(position=position, gravity=False))
        self.torso.attach(oo.Placeable()).attach(oo.Sphere(0.3, mass=70))

    def control(self):
        self.torso.linear_velocity = self.controls.level_movement * 1.5


POINTS = [(0.0, 0.0, -4.0), (3.0, 0.0, -4.0), (0.0, 0.0, 0.0)]
ROUND = 4.0 + 3.0 + 5.0


def patrolled(seconds, **options):
    world = oo.World(step_size=STEP)
    space = world.attach(oo.SimpleSpace())
    world.collide(space)
    walker = space.attach(Walker((0.0, 0.0, 0.0)))
    patrol = Patrol(walker, POINTS, **options)
    patrol.begin()
    nearest = [math.inf] * len(POINTS)
    for _ in range(round(seconds / STEP)):
        world.step()
        nearest = [min(n, walker.torso.position.distance(p)) for n, p in zip(nearest, POINTS, strict=True)]
    return patrol, walker, nearest


def test_a_walker_patrols_its_points_again_and_again():
    patrol, walker, nearest = patrolled(3 * ROUND / 1.5)
    assert 7 <= patrol.visited <= 10
    assert max(nearest) < 0.45
    patrol.end()
    assert not walker.controls.moves


def test_a_walker_rests_at_each_point():
    without, _, _ = patrolled(24.0)
    rested, _, _ = patrolled(24.0, wait=3.0)
    assert rested.visited < without.visited - 2


def test_a_walker_with_one_point_stands_there():
    world = oo.World(step_size=STEP)
    space = world.attach(oo.SimpleSpace())
    world.collide(space)
    walker = space.attach(Walker((0.0, 0.0, 3.0)))
    patrol = Patrol(walker, [(0.0, 0.0, 0.0)])
    patrol.begin()
    world.run(seconds=4)
    before = walker.torso.position
    world.run(seconds=2)
    assert walker.torso.position.distance(before) < 0.02
    assert before.length < 0.45
    with pytest.raises(oo.FieldError, match="at least one"):
        Patrol(walker, [])
