"""The constructor gun: how hard it shoots, where to, what it does to the hand, and what becomes of the shots."""

import logging
import math
import random

import numpy as np
import pytest

import osgode as oo
from osgode.examples.game.gun import BALL_MASS, BALL_RADIUS, CUBE_EDGE, CUBE_MASS, FULL_IMPULSE, RECOIL, ConstructorGun
from osgode.examples.game.level import House
from osgode.examples.game.shots import LIFETIME, MOST, SPARED_FOR
from osgode.examples.game.weapon import RECOIL_TIME
from tests.examples.game.bearer import AHEAD, EYE, Range

DEGREE = math.radians(1.0)
WALL_THICK = 0.2
MASSES = {"left": BALL_MASS, "right": CUBE_MASS}


def armed(**settings):
    scene = Range(**settings)
    return scene, scene.give(ConstructorGun((0.0, 0.5, 2.0)))


@pytest.mark.parametrize("button", MASSES)
@pytest.mark.parametrize("charge", [0.1, 0.5, 1.0, 1.5])
def test_the_impulse_is_as_long_as_the_button_was_held(button, charge):
    scene, gun = armed(gravity=(0, 0, 0))
    scene.shoot(gun, button, charge)
    (shot,) = gun.shots.alive
    assert shot.mass == MASSES[button]
    assert shot.momentum.length == pytest.approx(FULL_IMPULSE * min(charge, 1.0), rel=0.01)
    assert shot.tunnelling == "sweep"


def test_balls_are_of_iron_and_cubes_of_wood():
    scene, gun = armed()
    for button in MASSES:
        scene.shoot(gun, button, 0.3)
    (ball,), (cube,) = (shot.geoms for shot in gun.shots.alive)
    assert isinstance(ball, oo.Sphere)
    assert ball.material == "steel"
    assert BALL_MASS / (4 / 3 * math.pi * BALL_RADIUS**3) == pytest.approx(7870, rel=0.02)  # iron, kg/m3
    assert isinstance(cube, oo.Box)
    assert cube.material == "wood"
    assert pytest.approx(640, rel=0.05) == CUBE_MASS / CUBE_EDGE**3


@pytest.mark.parametrize("yaw", [0.0, 0.9, -2.5])
@pytest.mark.parametrize("pitch", [-0.4, 0.0, 0.6])
@pytest.mark.parametrize("button", MASSES)
def test_shots_go_where_the_camera_looks(yaw, pitch, button):
    """After 60 m of flight a shot is, seen from the eye, within a degree of the middle of the picture."""
    scene, gun = armed(ground=False, gravity=(0, 0, 0))
    turn = oo.Quat.from_yaw_pitch_roll(yaw, pitch)
    scene.bearer.hand.glide_to(EYE + turn.rotate((0.25, -0.2, -0.4)), turn, seconds=0.2)
    scene.world.run(seconds=0.3)
    direction = turn.rotate(AHEAD)
    scene.shoot(gun, button, aim=(EYE, direction))
    (shot,) = gun.shots.alive
    scene.world.run(seconds=60.0 / shot.linear_velocity.length)
    seen = (shot.position - EYE).normalized()
    assert math.acos(min(seen.dot(direction), 1.0)) < DEGREE


@pytest.mark.parametrize("distance", [2.0, 5.0, 20.0, 60.0])
def test_a_shot_hits_the_point_that_is_looked_at(distance):
    """Though the muzzle is beside the eye; and with gravity it falls by less than a degree on 20 m."""
    scene, gun = armed()
    wall = scene.fixed.attach(oo.Placeable(position=(0, 2, -distance - 0.5)))
    hits = []
    wall.attach(oo.Box((20, 4, 1))).on_touch(lambda touch: hits.append(touch.points[0]) if touch.begin else None)
    scene.shoot(gun)
    scene.world.run(seconds=1.2)
    seen = (oo.Vec3(*hits[0]) - EYE).normalized()
    fall = 0.5 * 9.81 * (distance / (FULL_IMPULSE / BALL_MASS)) ** 2 / distance  # the angle, by the law of free fall
    assert math.acos(min(seen.dot(AHEAD), 1.0)) < DEGREE + fall


def test_half_of_the_impulse_goes_into_the_hand():
    scene, gun = armed(ground=False, kinematic=False, gravity=(0, 0, 0))
    scene.shoot(gun)
    scene.world.run(seconds=RECOIL_TIME + 2 * scene.world.step_size)
    total = scene.bearer.hand.momentum + gun.main_body.momentum
    way = gun.shots.alive[0].linear_velocity.normalized()
    assert total.length == pytest.approx(RECOIL * FULL_IMPULSE, rel=0.01)
    assert total.normalized().dot(way) == pytest.approx(-1.0, abs=1e-3)
    assert scene.bearer.hand.linear_velocity.z > 0.25 * RECOIL * FULL_IMPULSE / scene.bearer.hand.mass


@pytest.mark.parametrize("button", MASSES)
@pytest.mark.parametrize("charge", [0.01, 0.2, 1.0])
def test_a_shot_leaves_the_weapon_and_the_hand_alone(button, charge):
    """A hand that floats isn't moved by what is born before it, but by the recoil; and the shot flies on unhindered."""
    scene, gun = armed(ground=False, gravity=(0, 0, 0))
    scene.shoot(gun, button, charge)
    (shot,) = gun.shots.alive
    velocity = shot.linear_velocity
    scene.world.run(seconds=SPARED_FOR)
    assert shot.linear_velocity.distance(velocity) < 1e-9


def test_a_shot_takes_along_the_speed_ahead_but_not_aside():
    scene, gun = armed(ground=False, gravity=(0, 0, 0))
    hand = scene.bearer.hand
    hand.linear_velocity = (3.0, 0.0, -6.0)
    scene.world.run(seconds=0.1)
    gun.press("left")
    scene.world.step(18)
    gun.release("left", (hand.position, AHEAD))
    (shot,) = gun.shots.alive
    forward = shot.linear_velocity.normalized()
    assert forward.dot(AHEAD) == pytest.approx(1.0, abs=1e-4)
    assert shot.linear_velocity.length == pytest.approx(FULL_IMPULSE * 18 / 180 / BALL_MASS + 6.0, rel=0.01)


def test_a_muzzle_in_a_wall_shoots_in_front_of_it():
    scene, gun = armed()
    wall = oo.Box((4, 4, WALL_THICK))
    scene.fixed.attach(oo.Placeable(position=(0, 1, -0.6))).attach(wall)
    assert gun.main_body.local_to_world((0.0, 0.03, -0.46)).z < -0.6 - WALL_THICK / 2
    for button in MASSES:
        scene.shoot(gun, button)
    scene.world.run(seconds=0.5)
    assert all(shot.position.z > -0.6 for shot in gun.shots.alive)


class Watch:
    """Counts the shots that get through the middle of a wall across z, and not round it."""

    def __init__(self, z, x=9.5, y=(-2.5, 6.5)):
        self.z, self.x, self.y = z, x, y
        self.before = {}
        self.passed = []

    def look(self, shots):
        now = {shot: np.array(shot.position) for shot in shots}
        for shot, place in now.items():
            old = self.before.get(shot, place)
            if place[2] < self.z < old[2]:
                x, y, _ = old + (place - old) * (self.z - old[2]) / (place[2] - old[2])
                if abs(x) < self.x and self.y[0] < y < self.y[1]:
                    self.passed.append(shot)
        self.before = now


def shots_that_pass(wall, seed):
    """Of 1000 shots of both kinds with all charges at a wall at z = -6, aimed anyhow: how many pass, how many hit."""
    scene = Range(ground=False)
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    scene.fixed.attach(oo.Placeable(position=(0, 2, -6))).attach(wall)
    chance = random.Random(seed)
    hit, watch, touched = 0, Watch(-6.0), set()
    wall.on_touch(lambda touch: touched.add(touch.other_body))
    hand = scene.bearer.hand
    for _ in range(20):
        for _ in range(50):
            target = oo.Vec3(chance.uniform(-8, 8), chance.uniform(-1, 5), -6.0)
            gun.stow()
            hand.position = (chance.uniform(-2, 2), chance.uniform(1, 3), chance.uniform(-3, 2))
            gun.draw()
            # Those that are charged less fall before they get there.
            charge = chance.uniform(0.15, 1.0)
            gun.fire(chance.choice(["left", "right"]), charge, (hand.position, target - hand.position))
            scene.world.step()
            watch.look(gun.shots.alive)
        for _ in range(60):
            scene.world.step()
            watch.look(gun.shots.alive)
        hit += len(touched)
        touched.clear()
        gun.shots.clear()
    return len(watch.passed), hit


def box_wall():
    return oo.Box((20, 10, WALL_THICK))


def mesh_wall():
    """The same of triangles, 48 on each face."""
    nx, ny = 6, 4
    x, y = np.meshgrid(np.linspace(-10, 10, nx + 1), np.linspace(-5, 5, ny + 1))
    sheet = np.column_stack([x.ravel(), y.ravel()])
    rows, columns = np.meshgrid(np.arange(ny), np.arange(nx), indexing="ij")
    a = (rows * (nx + 1) + columns).ravel()
    faces = np.concatenate([np.column_stack([a, a + 1, a + nx + 2]), np.column_stack([a, a + nx + 2, a + nx + 1])])
    front = np.column_stack([sheet, np.full(len(sheet), WALL_THICK / 2)])
    back = front * (1, 1, -1)
    return oo.Trimesh(oo.MeshData(np.concatenate([front, back]), np.concatenate([faces, faces[:, ::-1] + len(front)])))


@pytest.mark.parametrize(("wall", "seed"), [(box_wall, 1), (mesh_wall, 2)], ids=["box", "mesh"])
def test_of_a_thousand_shots_none_passes_through_a_wall(wall, seed):
    passed, hit = shots_that_pass(wall(), seed)
    assert hit > 900
    assert passed == 0


def test_no_shot_passes_through_the_wall_of_the_house():
    """A thousand, one by one, at the closed parts of its side wall (a mesh), some of them at full impulse."""
    scene = Range(gravity=(0, 0, 0))
    house = scene.fixed.attach(House((0, 0, 0)))
    walls = next(geom for geom in house.geoms if isinstance(geom, oo.Trimesh))
    scene.bearer.hand.position = (-9, 1.4, 0)
    scene.bearer.hand.rotation = oo.Quat.from_yaw_pitch_roll(-math.pi / 2)
    gun = scene.give(ConstructorGun((-9, 1, 0)))
    chance, hit = random.Random(4), set()
    walls.on_touch(lambda touch: hit.add(touch.other_body))
    eye, outside, reached = oo.Vec3(-9.0, 1.6, 0.0), -4.0, 0
    for k in range(1000):
        aim = oo.Vec3(outside, chance.uniform(0.5, 2.3), chance.choice((-1, 1)) * chance.uniform(1.5, 2.6)) - eye
        gun.fire(("left", "right")[k % 2], 1.0 if k % 3 == 0 else chance.uniform(0.3, 1.0), (eye, aim.normalized()))
        (shot,) = gun.shots.alive
        for _ in range(25):
            scene.world.step()
            x, _, z = shot.position
            assert x < outside + 0.1 or abs(z) > 3.0  # not into the wall's inner half; past its corner it may fly
        reached += shot in hit
        gun.shots.clear()
        hit.clear()
    assert reached == 1000


def test_old_shots_expire():
    scene, gun = armed(auto_disable=True)
    before = oo.live_natives()
    scene.shoot(gun, "right", 0.02)
    scene.shoot(gun, "left", 0.02)
    assert len(gun.shots.alive) == 2
    scene.world.run(seconds=LIFETIME - 0.5)
    assert len(gun.shots.alive) == 2
    scene.world.run(seconds=0.6)
    assert gun.shots.alive == ()
    after = oo.live_natives()
    assert (after.bodies, after.geoms, after.spaces) == (before.bodies, before.geoms, before.spaces)


def test_the_oldest_goes_when_there_are_too_many():
    scene, gun = armed(ground=False, gravity=(0, 0, 0))
    gun.shots.most = 5
    born = []
    for _ in range(8):
        gun.fire("left", 0.2, (EYE, AHEAD))
        born.append(gun.shots.alive[-1])
        scene.world.step(20)
    assert gun.shots.alive == tuple(born[3:])
    assert [shot.is_live for shot in born] == [False] * 3 + [True] * 5
    scene.moving.detach(born[3])  # by somebody else
    assert gun.shots.alive == tuple(born[4:])
    gun.shots.take_away(born[0])  # which is gone
    gun.shots.clear()
    assert not any(shot.is_live for shot in born)


def test_two_hundred_shots_are_alive_and_stay_in_the_world(caplog):
    """A heap of them in front of a wall; benchmarks say what that costs."""
    caplog.set_level(logging.ERROR)
    scene, gun = armed(auto_disable=True)
    scene.fixed.attach(oo.Placeable(position=(0, 2, -8))).attach(box_wall())
    watch = Watch(-8.0)
    for k in range(200):
        gun.fire(("left", "right")[k % 2], 0.1 + 0.1 * (k % 5), (EYE, (0.3 * math.sin(k), 0.2 * math.cos(2 * k), -1.0)))
        for _ in range(3):
            scene.world.step()
            watch.look(gun.shots.alive)
    assert len(gun.shots.alive) == 200 <= MOST
    scene.world.run(seconds=1.0)
    assert len(gun.shots.alive) == 200
    places = np.array([shot.position for shot in gun.shots.alive])
    assert np.isfinite(places).all()
    assert places[:, 1].min() > -0.02
    assert watch.passed == []


def test_shooting_is_the_same_every_time():
    ends = []
    for _ in range(2):
        scene, gun = armed()
        for k in range(12):
            scene.crate((0.3 * (k % 3), 0.25 + 0.5 * (k // 3), -6.0))
        for button in ("left", "right", "left"):
            scene.shoot(gun, button, 0.4)
        scene.world.run(seconds=1.0)
        ends.append(scene.world.poses.copy())
    assert np.array_equal(*ends)
