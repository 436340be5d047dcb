"""The camera: free flight, riding, third person, aiming."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import osgode as oo
from osgode.engine import Camera, ControllableObject
from osgode.errors import FieldError, StateError
from osgode.maths import Pose, Quat, Vec3
from osgode.testing import Play
from tests.engine.games import Cart, Narrow, Yard

POINTS = st.builds(Vec3, *3 * [st.floats(-100, 100)])


def near(one, other, within=1e-9):
    return Vec3(*one).distance(other) < within


def ring(camera, position):
    """A cart in a World, and a camera that rides it."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    walls = world.attach(oo.SimpleSpace())
    cart = space.attach(Cart())
    cart.place(Pose(Vec3(*position), Quat(1, 0, 0, 0)))
    camera.world, camera.obstacles = world, walls
    return world, space, walls, cart


# -- free


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(0, 2), st.floats(0.1, 20))
def test_free_flight_is_straight_and_of_constant_speed(yaw, pitch, seconds, speed):
    """However often it is told, it goes speed times time where it looks; diagonally no faster."""
    ends = []
    for parts in (1, 7):
        camera = Camera((1, 2, 3), speed=speed)
        camera.yaw, camera.pitch = yaw, pitch
        camera.move(forward=True, right=True)
        for _ in range(parts):
            camera.update(seconds / parts)
        ends.append(camera.position)
    forward = Vec3(-math.sin(yaw) * math.cos(pitch), math.sin(pitch), -math.cos(yaw) * math.cos(pitch))
    right = Vec3(math.cos(yaw), 0, -math.sin(yaw))
    way = (forward + right) * (math.sqrt(0.5) * speed * seconds)
    assert near(ends[0], Vec3(1, 2, 3) + way, 1e-8)
    assert near(ends[0], ends[1], 1e-8)


def test_looking_by_the_mouse():
    """To the right and down are minus yaw and minus pitch, within a quarter turn up and down."""
    camera = Camera()
    camera.look(0.3, 0.1)
    assert (camera.yaw, camera.pitch) == pytest.approx((-0.3, -0.1))
    camera.look(0.0, -7.0)
    assert camera.pitch == math.pi / 2
    camera.look(math.pi, 9.0)
    assert camera.pitch == -math.pi / 2
    assert camera.yaw == pytest.approx(math.pi - 0.3)


@given(POINTS, POINTS)
def test_look_at_and_back(eye, target):
    """What is looked at is just in front, at its distance, upright."""
    camera = Camera(eye)
    distance = eye.distance(target)
    if distance < 1e-3:
        return
    camera.roll = 0.5
    camera.look_at(target)
    assert near(camera.position + camera.forward * distance, target, 1e-9 * distance + 1e-9)
    seen = camera.pose.inverse().transform(target)
    assert near(seen, (0, 0, -distance), 1e-9 * distance + 1e-9)
    assert camera.roll == 0.0


@pytest.mark.parametrize(("target", "pitch"), [((1, 9, 1), math.pi / 2), ((1, -9, 1), -math.pi / 2)])
def test_straight_up_and_down_the_yaw_stays(target, pitch):
    camera = Camera((1, 0, 1))
    camera.yaw = 1.25
    camera.look_at(target)
    assert (camera.yaw, camera.pitch) == (1.25, pitch)


def test_the_pose_is_that_of_now():
    """In free flight what is set shows at once, in the view too, with no frame between."""
    camera = Camera((0, 0, 0), near=0.5, far=50, field_of_view=0.9)
    camera.position = (1, 2, 3)
    camera.yaw = math.pi / 2
    assert near(camera.forward, (-1, 0, 0))
    view = camera.view()
    assert view.pose == camera.pose == Pose(Vec3(1, 2, 3), camera.rotation)
    assert (view.field_of_view, view.near, view.far) == (0.9, 0.5, 50)


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (lambda c: Camera((0, 0)), "Camera.position"),
        (lambda c: Camera(speed=-1), "Camera.speed"),
        (lambda c: Camera(field_of_view=0), "Camera.field_of_view"),
        (lambda c: Camera(field_of_view=3.2), "Camera.field_of_view"),
        (lambda c: Camera(near=1, far=1), "near must be less"),
        (lambda c: Camera(near=0), "Camera.near"),
        (lambda c: Camera(distance=-1), "Camera.distance"),
        (lambda c: setattr(c, "position", (0, math.nan, 0)), "Camera.position"),
        (lambda c: setattr(c, "distance", math.inf), "Camera.distance"),
        (lambda c: c.set_clipping(5, 2), "near must be less"),
        (lambda c: c.look_at(c.position), "where the camera is"),
        (lambda c: c.look_at("there"), "target"),
        (lambda c: c.ride(None), "carrier is None"),
        (lambda c: c.ride(oo.SimpleSpace()), "must be a ControllableObject"),
        (lambda c: c.ride(Cart(), "relative"), "matching is 'relative'"),
    ],
)
def test_bad_cameras(act, words):
    """Wrong values are named, and nothing is changed."""
    camera = Camera((1, 2, 3))
    before = camera.view(), camera.position, camera.distance
    with pytest.raises(FieldError, match=words):
        act(camera)
    assert (camera.view(), camera.position, camera.distance) == before


# -- riding


def test_what_can_not_be_ridden():
    """One out of a World, and one without a body: the camera stays where it was, on what it rode."""
    camera = Camera()
    _world, space, _, cart = ring(camera, (0, 0, 0))
    camera.ride(cart)
    bare = space.attach(ControllableObject(name="bare"))
    for wrong in (Cart("far"), bare):
        with pytest.raises(StateError, match=wrong.name):
            camera.ride(wrong)
    assert camera.carrier is cart
    assert cart.riders == ["boarded"]
    with pytest.raises(StateError, match="no world"):
        Camera().aim()


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), POINTS, st.floats(0, 1))
def test_the_eye_carries_the_camera(yaw, pitch, place, interpolation):
    """On a carrier the camera is at its eye, between the last two steps as the picture is."""
    camera = Camera()
    world, _, _, cart = ring(camera, place)
    cart.hull.linear_velocity = cart.arm.linear_velocity = (3, -2, 1)
    world.step(2)
    camera.ride(cart)
    camera.yaw, camera.pitch = yaw, pitch
    camera.update(0.5, interpolation)
    before, after = world.previous_poses[cart.hull._index][:3], world.poses[cart.hull._index][:3]
    eye = Vec3(*(before + (after - before) * interpolation)) + Vec3(0, 1, 0)
    assert near(camera.pose.position, eye, 1e-8)
    assert near(camera.position, eye, 1e-8)
    assert camera.pose.rotation == camera.rotation
    camera.dismount()


def test_absolute_matching():
    """The carrier is told the camera's angles and wishes; the camera begins with those of the carrier."""
    camera = Camera()
    _world, _, _, cart = ring(camera, (0, 0, 0))
    cart.controls.yaw, cart.controls.pitch = 0.4, -0.1
    camera.ride(cart)
    assert camera.matching == "absolute"
    assert (camera.yaw, camera.pitch) == (0.4, -0.1)
    camera.look(0.1, 0.2)
    camera.move(forward=True, left=True)
    camera.steer()
    assert (cart.controls.yaw, cart.controls.pitch) == pytest.approx((0.3, -0.3))
    assert cart.controls.moves == {"forward", "left"}
    camera.move(forward=False)
    camera.steer()
    assert cart.controls.moves == {"left"}
    camera.update(0.1)
    assert camera.forward == camera.rotation.rotate((0, 0, -1))
    camera.dismount()
    assert cart.controls.moves == frozenset()
    assert cart.riders == ["boarded", "left"]
    assert (camera.yaw, camera.pitch) == pytest.approx((0.3, -0.3))


def test_delta_matching():
    """The carrier is told by how much the mouse moved, and the camera looks where the carrier's eye does."""
    camera = Camera()
    world, _, _, cart = ring(camera, (0, 0, 0))
    camera.yaw = 2.0
    cart.controls.yaw = 0.4
    camera.ride(cart, "delta")
    assert cart.controls.yaw == 0.4
    camera.look(0.1, 0.05)
    camera.look(0.1, 0.0)
    camera.steer()
    assert (cart.controls.yaw, cart.controls.pitch) == pytest.approx((0.2, -0.05))
    turned = Quat.from_yaw_pitch_roll(0.7, 0.2, 0.4)
    cart.place(Pose(Vec3(5, 0, 0), turned))
    world.step()
    camera.update(0.1)
    assert near(camera.forward, turned.rotate((0, 0, -1)))
    assert near(camera.pose.position, Vec3(5, 0, 0) + turned.rotate((0, 1, 0)))
    camera.dismount()
    assert near(camera.forward, turned.rotate((0, 0, -1)))
    assert (camera.yaw, camera.pitch, camera.roll) == pytest.approx((0.7, 0.2, 0.0))


def test_looking_at_a_point_by_delta():
    """The carrier's controls are turned by what is missing, the short way round."""
    camera = Camera()
    _world, _, _, cart = ring(camera, (0, 0, 0))
    cart.place(Pose(Vec3(0, 0, 0), Quat.from_yaw_pitch_roll(3.0)))
    cart.controls.yaw = 0.25
    camera.ride(cart, "delta")
    camera.look_at((math.sin(3.0), 1, -math.cos(3.0)))
    # Looking along -Z turned by -3: from 3 that is 2 pi - 6 farther.
    assert cart.controls.yaw == pytest.approx(0.25 + (math.tau - 6.0))
    assert cart.controls.pitch == pytest.approx(0.0)


def test_the_short_way_round_for_a_carrier_with_limits():
    """From a yaw of 3 to one of -3 it is 0.28 to the left, and not 6 to the right, where its limit is."""
    camera = Camera()
    _world, space, _, _cart = ring(camera, (0, 0, 9))
    cart = space.attach(Narrow("narrow"))
    cart.place(Pose(Vec3(0, 0, 0), Quat.from_yaw_pitch_roll(3.0)))
    camera.ride(cart, "delta")
    camera.look_at((math.sin(3.0), 1, -math.cos(3.0)))
    assert cart.controls.yaw == pytest.approx(math.tau - 6.0)


def test_carriers_with_limits():
    """A carrier that can't turn as far as the camera stays at its limit."""
    camera = Camera()
    _world, space, _, _cart = ring(camera, (0, 0, 9))
    cart = space.attach(Narrow("narrow"))
    camera.ride(cart)
    camera.yaw, camera.pitch = 2.0, -1.0
    camera.steer()
    assert (cart.controls.yaw, cart.controls.pitch) == (0.5, -0.2)
    camera.dismount()


def test_another_carrier_at_once():
    """Who boards another has left the first."""
    camera = Camera()
    _world, space, _, cart = ring(camera, (0, 0, 0))
    other = space.attach(
        Cart(
            "other",
        )
    )
    other.place(Pose(Vec3(9, 0, 0), Quat(1, 0, 0, 0)))
    camera.ride(cart)
    camera.move(forward=True)
    camera.steer()
    camera.ride(other)
    assert cart.riders == ["boarded", "left"]
    assert other.riders == ["boarded"]
    assert cart.controls.moves == frozenset()
    camera.dismount()
    camera.dismount()
    assert other.riders == ["boarded", "left"]


@pytest.mark.parametrize("way", ["leave", "bodies"])
@pytest.mark.parametrize("when", ["steer", "update"])
@pytest.mark.parametrize("matching", ["absolute", "delta"])
def test_a_carrier_that_is_destroyed(way, when, matching):
    """The camera flies on from where it was, looking the same way."""
    camera = Camera()
    world, space, _, cart = ring(camera, (4, 0, 0))
    camera.ride(cart, matching)
    camera.update(0.1)
    pose = camera.pose
    if way == "leave":
        space.detach(cart)
    else:
        for body in cart.bodies:
            body.parent.detach(body)
    camera.steer() if when == "steer" else camera.update(0.1)
    assert camera.carrier is None
    assert near(camera.position, pose.position)
    assert near(camera.forward, pose.rotation.rotate((0, 0, -1)))
    camera.move(forward=True)
    camera.update(0.5)
    assert near(camera.position, pose.position + Vec3(0, 0, -4))
    world.step()


# -- third person


def third(distance=5.0, walls=()):
    """A camera in third person behind a cart at the origin that looks along -Z, and walls at some z."""
    camera = Camera(distance=distance)
    world, space, fixed, cart = ring(camera, (0, 0, 0))
    for z in walls:
        fixed.attach(oo.Placeable(position=(0, 0, z))).attach(oo.Box((20, 20, 1)))
    camera.ride(cart)
    return camera, world, space, fixed, cart


def test_third_person_stands_behind():
    """At its distance against the way that it looks; turning goes round the eye."""
    camera, *_ = third()
    assert near(camera.pose.position, (0, 1, 5))
    camera.yaw = math.pi / 2
    camera.update(0.1)
    assert near(camera.pose.position, (5, 1, 0))
    camera.pitch = -math.pi / 4
    camera.update(0.1)
    assert near(camera.pose.position, (5 * math.sqrt(0.5), 1 + 5 * math.sqrt(0.5), 0))
    camera.distance = 0.0
    camera.update(0.1)
    assert near(camera.pose.position, (0, 1, 0))


@pytest.mark.parametrize(("wall", "behind"), [(3.5, 3.0 - 0.25), (9.0, 5.0), (0.6, 0.0)])
def test_walls_shorten_the_way_back(wall, behind):
    """The camera keeps its clearance from a wall behind it; where there is no room it is at the eye."""
    camera, *_ = third(walls=[wall])
    assert camera.pose.position.distance((0, 1, 0)) == pytest.approx(behind, abs=1e-4)


def test_moving_things_and_sensors_are_no_walls():
    """What moves may come between, and so may sensors, which nobody sees; a wall behind them counts."""
    camera, _world, space, fixed, _cart = third()
    crate = space.attach(oo.Body(position=(0, 1, 3)))
    crate.attach(oo.Placeable()).attach(oo.Box((2, 2, 0.5)))
    for z in (1.5, 2.5):
        fixed.attach(oo.Placeable(position=(0, 0, z))).attach(oo.Box((20, 20, 0.5), sensor=True))
    camera.update(0.1)
    assert near(camera.pose.position, (0, 1, 5))
    fixed.attach(oo.Placeable(position=(0, 0, 4.5))).attach(oo.Box((20, 20, 1)))
    camera.update(0.1)
    assert camera.pose.position.z == pytest.approx(3.75, abs=1e-4)


def test_third_person_looks_at_points():
    """The point is in the middle of the picture at once, though the camera swings round the eye."""
    camera, *_ = third()
    for target in ((7, 3, -2), (-4, 1, 6), (0, -8, 0.5)):
        camera.look_at(target)
        seen = camera.pose.inverse().transform(target)
        assert near((seen.x, seen.y, 0), (0, 0, 0), 1e-9)
        assert seen.z == pytest.approx(-5 - Vec3(*target).distance((0, 1, 0)))


# -- aiming


def test_aiming():
    """The first thing in front within reach, at its distance from the eye."""
    camera = Camera((0, 1, 10))
    _world, space, fixed, cart = ring(camera, (0, 0.9, 0))
    hit = camera.aim()
    assert hit.body is cart.hull or hit.body is cart.arm
    assert camera.aim(reach=2.0) is None
    fence = fixed.attach(oo.Placeable(position=(0, 1, 8))).attach(oo.Box((2, 2, 0.2), sensor=True))
    assert camera.aim().body is hit.body, "sensors are looked through"
    fence.sensor = False
    assert camera.aim().geom is fence
    assert camera.aim().distance == pytest.approx(1.9)
    assert camera.aim(exclude=[fence]).body is hit.body
    assert camera.aim(exclude=fence).body is hit.body
    camera.yaw = math.pi
    assert camera.aim() is None
    space.detach(cart)


@pytest.mark.parametrize("distance", [0.0, 5.0])
def test_the_carrier_is_not_aimed_at(distance):
    """Nor, in third person, is what stands between the camera and the eye."""
    camera, _world, space, _, _cart = third(distance)
    between = space.attach(oo.Body(position=(0, 1, 3)))
    between.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    assert camera.aim() is None
    target = space.attach(oo.Body(position=(0, 1, -8)))
    target.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    hit = camera.aim()
    assert hit.body is target
    assert hit.distance == pytest.approx(7.5)


def test_riding_by_aiming():
    """What is aimed at is ridden if it can be; nothing, or what can't, is not."""
    camera = Camera((0, 0, 10))
    _world, space, _, cart = ring(camera, (0, 0, 0))
    camera.yaw = math.pi
    assert camera.ride_what_is_aimed_at() is None
    camera.yaw = 0.0
    assert camera.ride_what_is_aimed_at(reach=2.0) is None
    assert camera.ride_what_is_aimed_at(matching="delta") is cart
    assert (camera.carrier, camera.matching) == (cart, "delta")
    camera.dismount()
    stone = space.attach(oo.Body(position=(0, 0, 5)))
    stone.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    camera.position, camera.yaw = (0, 0, 10), 0.0
    assert camera.ride_what_is_aimed_at() is None
    assert camera.carrier is None


# -- by keys and mouse


def test_playing_with_the_camera():
    """Keys fly it, the mouse turns it, keys attach and take to third person."""
    with Play(Yard) as play:
        camera, cart = play.scene.camera, play.scene.cart
        start = camera.position
        play.hold("forward")
        play.seconds(0.25)
        play.release("forward")
        play.frames(2)
        assert camera.position.distance(start) == pytest.approx(8.0 * 0.25, rel=0.1)
        stood = camera.position
        play.frames(5)
        assert camera.position == stood
        play.tap("attach")
        assert camera.carrier is cart
        assert near(camera.position, (0, 1, 0))
        yaw = camera.yaw
        play.look(right=0.2)
        play.frames(1)
        assert camera.yaw == pytest.approx(yaw - 0.2)
        assert cart.controls.yaw == pytest.approx(yaw - 0.2)
        play.hold("w", "d")
        play.frames(2)
        assert cart.controls.moves == {"forward", "right"}
        assert cart.controlled[-1][1] == {"forward", "right"}
        play.release("w", "d")
        play.tap("third_person")
        assert camera.distance == 5.0
        assert camera.pose.position.distance((0, 1, 0)) == pytest.approx(5.0, abs=1e-6)
        play.tap("third_person")
        assert camera.distance == 0.0
        play.tap("attach")
        assert camera.carrier is None


def test_a_program_may_steer_the_camera():
    """Wishes of a program stay from frame to frame; a key that comes up ends that way only."""
    with Play(Yard) as play:
        camera = play.scene.camera
        camera.move(forward=True, ascend=True)
        play.frames(3)
        assert camera.moves == {"forward", "ascend"}
        play.hold("forward")
        play.frames(2)
        play.release("forward")
        play.frames(1)
        assert camera.moves == {"ascend"}
        play.hold("left")
        play.frames(1)
        play.app.events.bind("left", "j")
        play.frames(1)
        assert camera.moves == {"ascend"}, "its key is no longer one"


def test_the_camera_flies_while_the_simulation_stands_still():
    with Play(Yard) as play:
        camera = play.scene.camera
        play.tap("pause")
        steps, start = play.scene.world.steps, camera.position
        play.hold("backward")
        play.frames(30)
        assert play.scene.world.steps == steps
        assert camera.position.distance(start) == pytest.approx(4.0, rel=0.05)


def test_closing_the_app_leaves_the_carrier():
    with Play(Yard) as play:
        cart = play.scene.cart
        play.scene.camera.ride(cart)
        play.frames(2)
    assert cart.riders == ["boarded", "left"]


@pytest.mark.parametrize(
    ("speed", "slower", "faster"),
    [
        (1.0, 0.5, 2.0),
        (1 / 64, 1 / 64, 1 / 32),
        (16.0, 8.0, 16.0),
        (0.0, 0.0, 1 / 64),
        (100.0, 50.0, 100.0),
        (12, 6, 16),
    ],
)
def test_keys_for_slow_motion(speed, slower, faster):
    """Slower is never faster, and the other way round, wherever the speed was."""
    with Play(Yard) as play:
        clock = play.app.clock
        for key, wanted in (("slower", slower), ("faster", faster)):
            clock.speed = speed
            play.tap(key)
            assert clock.speed == wanted


def test_keys_for_pause_steps_pointer_and_end():
    with Play(Yard) as play:
        clock, world = play.app.clock, play.scene.world
        play.tap("single_step")
        assert clock.paused
        steps = world.steps
        play.tap("single_step")
        assert world.steps == steps + 1
        play.tap("pause")
        assert not clock.paused
        play.tap("release_mouse")
        assert play.app.events.captured
        assert play.input.captured
        play.tap("full_screen")
        assert play.app.video.full_screen
        play.tap("quit")
        assert play.app.quitting


@pytest.mark.parametrize("hook", ["boarded", "eye_pose"])
def test_a_carrier_that_fails_at_boarding_is_not_ridden(hook):
    """The camera flies on; it would else fail in every frame to come."""

    class Failing(Cart):
        pass

    def fail(self, *_):
        raise ValueError("no rider")

    setattr(Failing, hook, fail)
    camera = Camera((1, 2, 3))
    _, space, _, _ = ring(camera, (0, 0, 0))
    carrier = space.attach(Failing())
    with pytest.raises(ValueError, match="no rider"):
        camera.ride(carrier)
    assert camera.carrier is None
    camera.update(0.1)
    assert camera.pose.position == Vec3(1, 2, 3)
