"""The player of the game: stands, walks, climbs, jumps, is carried, and never falls through anything."""

import math

import pytest

import osgode as oo
from osgode.engine import Scene
from osgode.examples.game.car import ROOF, Car
from osgode.examples.game.player import JUMP, LOWERED, MAX_SLOPE, SPEED, STEP_HEIGHT, Player
from osgode.testing import Play


class Place(Scene):
    """Level ground, and whatever a test adds."""

    def __init__(self, config=None):
        super().__init__(config)
        self.static.attach(oo.Plane(material="concrete"))

    def add(self, geom, position, rotation=(1, 0, 0, 0)):
        place = self.static.attach(oo.Placeable(position=position, rotation=rotation))
        return place.attach(geom)

    def player(self, feet=(0, 0, 0), **how):
        return self.dynamic.attach(Player(feet, **how))


def slope(angle, side=1.0):
    """A long slope upwards along -z that begins at z = -2, and how its middle is placed."""
    up = oo.Vec3(0.0, math.sin(angle), -math.cos(angle))
    below = oo.Vec3(0.0, -math.cos(angle), -math.sin(angle)) * 0.1
    return oo.Box((4, 0.2, 12)), oo.Vec3(0, 0, -2) + up * 6 * side + below, oo.Quat.from_axis_angle((1, 0, 0), angle)


def lean(player):
    return math.acos(min(player.torso.vector_to_world((0, 1, 0)).y, 1.0))


def test_it_stands_still_on_level_ground_and_on_a_slope_of_30_degrees():
    scene = Place()
    angle = math.radians(30)
    scene.add(*slope(angle))
    with Play(scene) as play:
        flat = scene.player((5, 0, 0))
        tilted = scene.player((0, 3 * math.tan(angle), -5))
        play.seconds(1)
        before = flat.feet, tilted.feet
        play.seconds(10)
        assert (flat.feet - before[0]).length < 0.02
        assert (tilted.feet - before[1]).length < 0.02
        assert tilted.feet.y == pytest.approx(3 * math.tan(angle), abs=0.02)
        assert max(lean(flat), lean(tilted)) < math.radians(1)


def test_it_walks_at_its_speed_and_stops():
    scene = Place()
    with Play(scene) as play:
        player = scene.player(yaw=0.5)
        scene.camera.ride(player)
        play.hold("forward")
        play.seconds(2)
        ahead = oo.Quat.from_yaw_pitch_roll(0.5).rotate((0, 0, -1))
        assert player.velocity.dot(ahead) == pytest.approx(SPEED, rel=0.02)
        play.release("forward")
        play.seconds(0.5)
        assert player.velocity.length < 0.05


def test_it_climbs_stairs_of_20_centimetres_by_going_forward():
    scene = Place()
    for k in range(10):
        scene.add(oo.Box((3, 0.2 * (k + 1), 0.32)), (0, 0.1 * (k + 1), -2 - 0.32 * k))
    scene.add(oo.Box((3, 2.0, 6)), (0, 1.0, -2 - 0.32 * 9.5 - 3))
    with Play(scene) as play:
        player = scene.player()
        scene.camera.ride(player)
        play.hold("forward")
        worst = 0.0
        while player.feet.z > -8 and play.app.clock.elapsed < 6:
            play.steps(1)
            worst = max(worst, lean(player))
        assert player.feet.y == pytest.approx(2.0, abs=0.03)
        assert worst < math.radians(1)


@pytest.mark.parametrize(("height", "climbs"), [(STEP_HEIGHT - 0.05, True), (STEP_HEIGHT + 0.1, False)])
def test_a_step_is_climbed_up_to_its_step_height(height, climbs):
    scene = Place()
    scene.add(oo.Box((3, height, 6)), (0, height / 2, -5))
    with Play(scene) as play:
        player = scene.player()
        scene.camera.ride(player)
        play.hold("forward")
        play.until(lambda: player.feet.z < -3 or play.app.clock.elapsed > 3)
        assert (player.feet.y > height - 0.05) == climbs
        assert (player.feet.z < -3) == climbs


@pytest.mark.parametrize(("beyond", "climbs"), [(math.radians(-5), True), (math.radians(5), False)])
def test_it_climbs_up_to_its_maximum_slope(beyond, climbs):
    scene = Place()
    scene.add(*slope(MAX_SLOPE + beyond))
    with Play(scene) as play:
        player = scene.player()
        scene.camera.ride(player)
        play.hold("forward")
        play.until(lambda: player.feet.y > 2 or play.app.clock.elapsed > 5)
        assert (player.feet.y > 2.0) == climbs
        assert player.feet.y < 0.4 or climbs


@pytest.mark.parametrize(("steps", "share"), [(60, 1.0), (200, 1.0), (30, 0.5), (15, 0.25)])
def test_a_jump_is_as_high_as_it_was_charged(steps, share):
    scene = Place()
    with Play(scene) as play:
        player = scene.player()
        play.seconds(0.5)
        start, top = player.feet.y, 0.0
        player.controls.move(ascend=True)
        play.steps(steps)
        player.controls.move(ascend=False)
        for _ in range(120):
            play.steps(1)
            top = max(top, player.feet.y - start)
        assert top == pytest.approx(share * JUMP, rel=0.05)
        play.seconds(1)
        assert player.on_ground


def test_in_the_air_it_has_half_the_push():
    scene = Place()
    with Play(scene) as play:
        player = scene.player()
        play.seconds(0.5)
        gained = []
        for height in (0.0, 30.0):
            player.place(oo.Pose(oo.Vec3(0, height + player.reach, 0)), at_rest=True)
            play.steps(30)
            player.controls.move(forward=True)
            play.steps(2)
            before = player.velocity.z
            play.steps(10)
            gained.append(before - player.velocity.z)
            player.controls.stop()
            play.seconds(1)
        assert gained[1] == pytest.approx(gained[0] / 2, rel=0.1)


def test_it_pushes_a_crate():
    scene = Place()
    with Play(scene) as play:
        player = scene.player()
        crate = scene.dynamic.attach(oo.Body(position=(0, 0.4, -2)))
        crate.attach(oo.Placeable()).attach(oo.Box((0.8, 0.8, 0.8), mass=15, material="wood"))
        scene.camera.ride(player)
        play.hold("forward")
        play.seconds(3)
        assert crate.position.z < -3
        assert lean(player) < math.radians(1)


def test_it_presses_what_it_stands_on_by_its_weight():
    """On a plate hung on a spring: it sinks as deep as the weight says."""
    scene = Place()
    with Play(scene) as play:
        plate = scene.dynamic.attach(oo.Body(position=(0, 2, 0), auto_disable=False))
        plate.attach(oo.Placeable()).attach(oo.Box((2, 0.2, 2), mass=20))
        hold = oo.Slider(plate, axis=(0, 1, 0), stops=(0, 0), stop_stiffness=20000, stop_damping=2000)
        play.seconds(1)
        empty = hold.position
        player = scene.player((0, 2.1, 0))
        play.seconds(2)
        assert player.on_ground
        assert empty - hold.position == pytest.approx(player.weight * 9.81 / 20000, rel=0.03)


def test_it_is_carried_by_what_it_stands_on():
    scene = Place()
    with Play(scene) as play:
        ferry = scene.dynamic.attach(oo.Body(position=(0, 0.5, 0), kinematic=True))
        ferry.attach(oo.Placeable()).attach(oo.Box((3, 0.2, 3)))
        player = scene.player((0.3, 0.6, 0.2))
        play.seconds(0.5)
        place = player.feet - ferry.position
        ferry.linear_velocity = (1.0, 0, 0)
        for _ in range(40):
            play.seconds(0.1)
            assert (player.feet - ferry.position - place).length < 0.05


def test_a_hard_landing_takes_away_its_pace_for_a_while():
    scene = Place()
    with Play(scene) as play:
        player = scene.player((0, 6, 0))
        play.until(lambda: player.on_ground)
        assert player.pace < 0.6
        play.seconds(1)
        assert player.pace > 0.95


def test_it_never_falls_through_a_terrain_mesh():
    """From 100 m onto a thin mesh, at several places, on triangles and on their seams."""
    n = 12
    vertices = [(2.0 * i - 11, 0.4 * math.sin(i) * math.cos(j), 2.0 * j - 11) for j in range(n) for i in range(n)]
    triangles = []
    for j in range(n - 1):
        for i in range(n - 1):
            a, b, c, d = j * n + i, j * n + i + 1, (j + 1) * n + i, (j + 1) * n + i + 1
            triangles += [(a, c, b), (b, c, d)]
    scene = Scene()
    scene.static.attach(oo.Trimesh(oo.MeshData(vertices, triangles)))
    with Play(scene) as play:
        players = [
            scene.dynamic.attach(Player((x, 100, z), name=f"p{k}"))
            for k, (x, z) in enumerate([(0, 0), (1, 1), (-3, 2.5), (5, -5), (-7, -7), (3.3, 7.1)])
        ]
        play.seconds(7)
        for player in players:
            assert -0.6 < player.feet.y < 1.0
            assert lean(player) < math.radians(1)


def test_it_is_upright_whatever_hits_it():
    """To within a degree: a car at full speed, a blow at the head, and a shot at the feet."""
    scene = Place()
    with Play(scene) as play:
        player = scene.player()
        car = scene.dynamic.attach(Car((0, 0, 30)))
        play.seconds(1)
        worst, fastest = 0.0, 0.0
        car.controls.move(forward=True)
        for step in range(480):
            if step == 30:
                player.torso.apply_impulse((400, 0, 0), at=player.torso.position + oo.Vec3(0, 0.7, 0))
            if step == 90:
                player.torso.apply_impulse((-400, 0, 0), at=player.torso.position - oo.Vec3(0, 0.7, 0))
            play.steps(1)
            worst, fastest = max(worst, lean(player)), max(fastest, -player.velocity.z)
        assert fastest > 10  # the car met it
        assert worst < math.radians(1)


def test_the_arms_follow_the_eyes():
    scene = Place()
    with Play(scene) as play:
        player = scene.player()
        scene.camera.ride(player)
        play.look(right=0.7, down=0.4)
        play.seconds(1)
        assert [shoulder.angle for shoulder in player.shoulders] == pytest.approx(2 * [LOWERED - 0.4], abs=0.02)
        ahead = player.torso.vector_to_world((0, 0, -1))
        assert math.atan2(-ahead.x, -ahead.z) == pytest.approx(-0.7, abs=0.02)


def test_it_is_steered_by_a_program_as_by_a_camera():
    """The same wishes, set by a camera's keys or by hand, lead to the same bits."""
    ends = []
    for by_camera in (True, False):
        scene = Place()
        with Play(scene) as play:
            player = scene.player()
            play.frames(1)
            if by_camera:
                scene.camera.ride(player)
                play.hold("forward", "left")
            else:
                player.controls.move(forward=True, left=True)
            play.seconds(1)
            ends.append(scene.world.poses.tobytes())
    assert ends[0] == ends[1]


def test_it_is_carried_by_the_roof_of_a_car():
    scene = Place()
    with Play(scene) as play:
        car = scene.dynamic.attach(Car((0, 0.0, 0)))
        play.seconds(1)
        player = scene.player(car.hull.local_to_world(ROOF))
        play.seconds(1)
        assert player.on_ground
        place = car.hull.world_to_local(player.feet)
        car.controls.move(forward=True)
        play.seconds(1.5)
        car.controls.move(forward=False)
        play.seconds(1)
        assert car.hull.position.z < -4
        assert player.on_ground
        assert (car.hull.world_to_local(player.feet) - place).length < 0.35
