"""Bodies that are too fast: where they are stopped, what becomes of their speed, and what doesn't stop them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from tests.nodes.shots import H, ball, scene, shot, still, wall
from tests.strategies import floats

MESH = oo.MeshData([(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], [(0, 1, 2), (0, 2, 3)])


# -- where it is stopped


@given(floats(0.02, 0.5), floats(5, 100), floats(-1.2, 1.2), floats(0.05, 0.95))
@settings(max_examples=60)
def test_a_ball_is_stopped_where_it_touches_a_wall(radius, way, angle, part):
    """At part of its way of one step its middle is r from the wall; it is put at most 1 mm and 2 % of r into it."""
    world, moving, fixed = scene()
    wall(fixed)
    step = np.array([math.sin(angle), 0, -math.cos(angle)]) * way * radius
    there = np.array([0.3, -0.2, radius])
    body = ball(moving, there - part * step, step / H, radius=radius)
    world.step()
    into = there[2] - body.position.z
    assert 0 < into <= 2 * min(0.01 * radius, 1e-3)
    late = 2 * min(0.01 * radius, 1e-3) / math.cos(angle) * math.sin(abs(angle))  # it is noticed that little before
    assert body.position.x == pytest.approx(there[0], abs=late + 1e-9)
    assert body.position.y == pytest.approx(there[1], abs=1e-9)
    assert np.allclose(body.linear_velocity, step / H, rtol=1e-12)  # the next step's contact sees all of it


SOLIDS = {
    "box": (lambda: oo.Box((0.4, 0.3, 0.2)), lambda n: 0.2 * abs(n[0]) + 0.15 * abs(n[1]) + 0.1 * abs(n[2]), 0.1),
    "capsule": (lambda: oo.Capsule(0.1, 0.6), lambda n: 0.1 + 0.3 * abs(n[2]), 0.1),
    "cylinder": (lambda: oo.Cylinder(0.2, 0.5), lambda n: 0.2 * math.hypot(n[0], n[1]) + 0.25 * abs(n[2]), 0.2),
    "hull": (
        lambda: oo.ConvexHull([(x, y, z) for x in (-0.2, 0.2) for y in (-0.15, 0.15) for z in (-0.1, 0.1)]),
        lambda n: 0.2 * abs(n[0]) + 0.15 * abs(n[1]) + 0.1 * abs(n[2]),
        0.1,
    ),
}


@pytest.mark.parametrize("kind", SOLIDS)
@pytest.mark.parametrize("target", ["box", "plane", "mesh", "heights"])
@pytest.mark.parametrize("seed", range(4))
def test_other_shapes_are_stopped_by_what_reaches_farthest(kind, target, seed):
    """Its support along the wall's normal, in closed form.

    Corners may be rounded by a tenth of its half thickness, and a hull be a tenth smaller.
    """
    make, reach_of, thin = SOLIDS[kind]
    world, moving, fixed = scene()
    if target == "box":
        wall(fixed)
    elif target == "plane":
        fixed.attach(oo.Plane((0, 0, 1)))
    elif target == "mesh":
        still(fixed, oo.Trimesh(MESH))
    else:
        still(fixed, oo.Heightfield(np.zeros((9, 9)), (40, 40)), rotation=oo.Quat.between((0, 1, 0), (0, 0, 1)))
    random = np.random.default_rng([seed, len(kind), len(target)])
    turn = oo.Quat(*random.normal(size=4)).normalized()
    reach = reach_of(np.array(turn.to_matrix()).T @ (0, 0, 1))
    body = shot(moving, make(), (0.3, 0.2, reach + 2.0), (0, 0, -5.0 / H), rotation=turn)
    world.step()
    rounded = 0.1 * reach if kind == "hull" else (math.sqrt(3) - 1) * 0.1 * thin
    assert -1e-9 < reach - body.position.z <= rounded + 2 * 0.01 * thin
    world.step(10)
    assert body.position.z > -1e-3
    assert body.linear_velocity.z > -5.0


def test_a_fast_mesh_is_followed_by_its_hull():
    world, moving, fixed = scene()
    wall(fixed)
    corners = [(0, 0, 0), (0.4, 0, 0), (0, 0.4, 0), (0, 0, 0.4)]
    body = shot(moving, oo.Trimesh((corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])), (0, 0, 3), (0, 0, -600))
    world.step()
    assert body.position.z == pytest.approx(0, abs=2e-3)
    world.step(20)
    assert body.world_centre_of_mass.z > 0


def test_two_balls_that_fly_at_each_other_meet():
    """Their middles are 2 r apart afterwards, and the one that came first has stopped where they touched."""
    world, moving, _ = scene()
    one = ball(moving, (-1, 0, 0), (3 / H, 0, 0))
    other = ball(moving, (1, 0, 0), (-3 / H, 0, 0))
    world.step()
    assert other.position.x - one.position.x == pytest.approx(0.2, abs=0.005)
    world.step(3)
    assert one.position.x < other.position.x


@pytest.mark.parametrize("speed", [-40.0, -3.0, 3.0, 40.0])
@pytest.mark.parametrize("spinning", [0.0, 15.0])
def test_a_moving_wall_is_hit_where_both_are_and_takes_the_ball_along(speed, spinning):
    world, moving, _ = scene()
    plate = moving.attach(oo.Body(kinematic=True, linear_velocity=(0, 0, speed)))
    plate.attach(oo.Placeable()).attach(oo.Box((80, 80, 0.01)))
    body = ball(moving, (0, 0, 2), (0, 0, -150), angular_velocity=(0, spinning, 0))
    for _ in range(10):
        world.step()
        assert body.position.z > plate.position.z


@pytest.mark.parametrize("thick", [0.01, 0.2, 1.0])
@pytest.mark.parametrize("speed", [10.0, 40.0])
def test_what_is_hit_from_behind_is_not_carried_through_a_wall(thick, speed):
    """A ball flies along a wall, touching it; within the step a faster one hits it and pushes it towards the wall."""
    world, moving, fixed = scene()
    still(fixed, oo.Box((thick, 50, 50)), (thick / 2, 0, 0))
    victim = ball(moving, (-0.1, 0, 0), (0, 0, -speed), radius=0.1)
    hitter = ball(moving, (-0.9, 0, 0), (150, 0, -speed), radius=0.1)
    for _ in range(3):
        world.step()
        assert victim.position.x < 0
        assert hitter.position.x < 0


@pytest.mark.parametrize("damping", [0.0, 0.3, 0.9])
def test_damping_that_slows_it_down_after_the_step_hides_no_wall(damping):
    world, moving, fixed = scene()
    wall(fixed)
    body = ball(moving, (0, 0, 0.5), (0, 0, -120), linear_damping=damping)
    world.step(3)
    assert body.position.z > 0


def test_a_gliding_door_is_hit_in_the_step_in_which_it_arrives():
    """Then it has no velocity any more; it comes towards the ball, which stands in its way."""
    world, moving, _ = scene()
    door = moving.attach(oo.Body(kinematic=True, position=(0, 0, -1)))
    door.attach(oo.Placeable()).attach(oo.Box((80, 80, 0.01)))
    body = ball(moving, (0, 0, 0.0), (0, 0, -0.06 / H))
    door.glide_to((0, 0, 1))
    world.step()
    assert body.position.z > door.position.z


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_parts_off_the_centre_and_several_of_them_are_followed(seed):
    """A dumbbell: the part that is in front hits."""
    random = np.random.default_rng(seed)
    world, moving, fixed = scene()
    wall(fixed)
    turn = oo.Quat(*random.normal(size=4)).normalized()
    arms = [oo.Vec3(*random.uniform(-0.5, 0.5, 3)) for _ in range(3)]
    body = moving.attach(oo.Body(position=(0, 0, 3), rotation=turn, linear_velocity=(0, 0, -600), tunnelling="sweep"))
    for arm in arms:
        body.attach(oo.Placeable(position=arm)).attach(oo.Sphere(0.1))
    world.step()
    lowest = min(body.local_to_world(arm).z for arm in arms)
    assert lowest == pytest.approx(0.1, abs=2.1e-3)


# -- what becomes of its speed


@pytest.mark.parametrize("bounce", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("times", [2, 20])
def test_it_bounces_as_its_surface_says(bounce, times):
    """Speed after = e times speed before, and never more."""
    world, moving, fixed = scene()
    wall(fixed, oo.Surface(0.0, bounce=bounce))
    speed = times * 0.2 / H
    body = ball(moving, (0, 0, 0.35), (0, 0, -speed), linear_damping=0.0)
    most = speed
    for _ in range(6):
        world.step()
        assert body.linear_velocity.length <= most * (1 + 1e-9)
        most = max(body.linear_velocity.length, 1e-3)
    assert body.linear_velocity.z == pytest.approx(bounce * speed, rel=0.02, abs=1.0)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_an_oblique_shot_keeps_what_friction_leaves_of_its_speed_along_the_wall(friction):
    """Coulomb: the push along the wall is at most mu times the push against it, so dv_t <= mu v_n.

    Without spin before and with so little friction it slides all the time, and dv_t = mu v_n.
    """
    world, moving, fixed = scene()
    wall(fixed, oo.Surface(friction))
    across, along = 60.0, 90.0  # m/s
    body = ball(moving, (0, 0, 0.6), (along, 0, -across))
    world.step(4)
    assert body.linear_velocity.x == pytest.approx(along - friction * across, rel=0.03)
    assert abs(body.linear_velocity.z) < 1.0


def test_a_ball_that_rolls_fast_over_tiles_and_triangles_is_not_held_up():
    """The next tile is touched all the time; it goes as far as one that isn't followed."""
    ends = []
    for mode in (None, "sweep"):
        world, moving, fixed = scene()
        world.gravity = (0, 0, -9.81)
        side = np.linspace(-20, 20, 41)
        x, y = np.meshgrid(side, side)
        first = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
        faces = np.concatenate(
            [np.stack([first, first + 1, first + 42], 1), np.stack([first, first + 42, first + 41], 1)]
        )
        still(fixed, oo.Trimesh((np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), faces), surface=oo.Surface(0.0)))
        body = ball(moving, (-15, 0.3, 0.1), (0, 0, 0), mode)
        world.step(60)
        body.linear_velocity = (60.0, 0, 0)
        world.step(50)
        ends.append(body.position.x)
    assert ends[1] == pytest.approx(ends[0], abs=0.01)
    assert ends[0] == pytest.approx(-15 + 60 * 50 * H, abs=0.1)


# -- what doesn't stop it


def test_sensors_other_categories_and_undeclared_spaces_do_not_stop_it():
    oo.define_kind("tunnel ghost")
    world, moving, fixed = scene()
    still(fixed, oo.Box((9, 9, 0.1), sensor=True))
    still(fixed, oo.Box((9, 9, 0.1), kind="tunnel ghost", collides_with=["tunnel ghost"]), (0, 0, -1))
    apart = world.attach(oo.SimpleSpace())
    still(apart, oo.Box((9, 9, 0.1)), (0, 0, -2))
    body = ball(moving, (0, 0, 1), (0, 0, -4 / H))
    world.step()
    assert body.position.z == pytest.approx(-3)


def test_what_a_listener_refuses_does_not_hold_it():
    """It is stopped for a step, since nobody is asked before they touch; then it flies on, and out on the far side."""
    world, moving, fixed = scene()
    ghost = still(fixed, oo.Box((9, 9, 2)))
    asked = []

    def refuse(meeting):
        asked.append(meeting)
        meeting.refuse()

    ghost.on_collide(refuse)
    body = ball(moving, (0, 0, 3), (0, 0, -0.5 / H))
    world.step(20)
    assert asked
    assert body.linear_velocity.z == pytest.approx(-0.5 / H)
    assert body.position.z == pytest.approx(3 - 20 * 0.5, abs=1.0)


def test_a_body_joined_to_it_does_not_stop_it():
    world, moving, _ = scene()
    body = ball(moving, (0, 0, 0), (0, 0, -60))
    other = ball(moving, (0, 0, -0.25), (0, 0, -60), None)
    oo.Fixed(body, other)
    world.step()
    assert body.position.z == pytest.approx(-60 * H, abs=1e-3)


def test_the_wrong_side_of_a_mesh_does_not_hold_it_for_ever():
    world, moving, fixed = scene()
    still(fixed, oo.Trimesh(MESH))
    body = ball(moving, (0, 0, -1), (0, 0, 60))
    world.step(40)
    assert body.position.z > 1


@pytest.mark.parametrize("count", [3, 70])
@pytest.mark.parametrize("broad", ["own", "ode"])
def test_only_declared_pairs_stop_it_however_many_there_are(count, broad):
    """Above 64 pairs osgode's own broad phase has no bits left."""
    world, moving, fixed = scene(broad_phase=broad)
    for k in range(count):
        one, other = world.attach(oo.SimpleSpace()), world.attach(oo.SimpleSpace())
        world.collide(one, other)
        still(one, oo.Box((0.1, 0.1, 0.1)), (50 + k, 0, 0))
    apart = world.attach(oo.SimpleSpace())
    still(apart, oo.Box((9, 9, 0.02)), (0, 0, 1))
    inner = fixed.attach(oo.SimpleSpace())
    still(inner, oo.Box((9, 9, 0.02)), (0, 0, -1))
    body = ball(moving, (0, 0, 2), (0, 0, -4 / H))
    world.step()
    assert body.position.z == pytest.approx(-0.89, abs=5e-3)


def test_a_kinematic_body_and_one_without_geoms_go_their_way():
    world, moving, fixed = scene()
    wall(fixed)
    driven = ball(moving, (0, 0, 1), (0, 0, -2 / H), kinematic=True)
    bare = moving.attach(oo.Body(position=(3, 0, 1), linear_velocity=(0, 0, -2 / H), tunnelling="sweep"))
    loose = ball(world, (0, 3, 1), (0, 0, -2 / H))
    world.step()
    for body in (driven, bare, loose):
        assert body.position.z == pytest.approx(-1)


# -- rays


def test_a_ray_follows_the_middle_and_misses_an_edge_that_the_sweep_catches():
    ends = {}
    for mode in (None, "ray", "sweep"):
        world, moving, fixed = scene()
        still(fixed, oo.Box((10, 10, 0.01)), (-5, 0, 0))
        body = ball(moving, (0.05, 0, 1.5), (0, 0, -3 / H), mode)  # half of its radius is over the wall
        world.step(3)
        ends[mode] = body.position.z, body.linear_velocity
    assert ends[None] == ends["ray"]
    assert ends["ray"][1] == oo.Vec3(0, 0, -3 / H)
    assert ends["sweep"][1].x > 1.0  # pushed off the edge


def test_a_ray_stops_the_middle_before_the_wall_so_that_the_body_touches_it():
    world, moving, fixed = scene()
    wall(fixed)
    body = ball(moving, (0, 0, 1.5), (0, 0, -3 / H), "ray")
    world.step()
    assert 0 < body.position.z < 0.1
    world.step(5)
    assert body.position.z > 0


# -- the field


def test_the_mode_goes_with_the_body():
    _world, moving, _ = scene()
    body = oo.Body(tunnelling="ray")
    assert body.tunnelling == "ray"
    assert oo.Body().tunnelling is None
    moving.attach(body)
    body.tunnelling = "sweep"
    twin = body.copy()
    assert twin.tunnelling == "sweep"
    moving.detach(body)
    assert body.tunnelling == "sweep"
    _other, space, _ = scene()
    space.attach(body)
    assert body.tunnelling == "sweep"
    body.tunnelling = None
    assert body.tunnelling is None
    assert twin.tunnelling == "sweep"


@pytest.mark.parametrize("value", ["swept", "", 1, True, ["ray"], "Ray"])
def test_another_mode_is_an_error_that_names_them(value):
    _world, moving, _ = scene()
    body = moving.attach(oo.Body(name="bullet", tunnelling="ray"))
    with pytest.raises(oo.FieldError, match=r"bullet.*tunnelling.*'ray', 'sweep'"):
        body.tunnelling = value
    assert body.tunnelling == "ray"


def test_who_leaves_while_others_are_followed_confuses_nothing():
    world, moving, fixed = scene()
    wall(fixed)
    bodies = [ball(moving, (k, 0, 2), (0, 0, -3 / H)) for k in range(6)]
    world.step()
    for body in bodies[::2]:
        moving.detach(body)
    world.step(5)
    assert all(body.position.z > 0 for body in bodies[1::2])


# -- the same every time


def crowd():
    world, moving, fixed = scene()
    wall(fixed, oo.Surface(0.4, bounce=0.6))
    random = np.random.default_rng(11)
    for _ in range(25):
        body = ball(moving, random.uniform((-2, -2, 0.5), (2, 2, 4)), random.normal(size=3) * 60, "sweep")
        body.angular_velocity = random.normal(size=3) * 5
    return world


def test_steps_one_by_one_and_twice_over_give_the_same_bits():
    ends = []
    for _ in range(2):
        world = crowd()
        world.step(40)
        ends.append(world.poses.copy())
    world = crowd()
    for _ in range(40):
        world.step()
    ends.append(world.poses.copy())
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], ends[2])


def test_a_flag_changes_nothing_for_who_is_slow():
    ends = []
    for mode in (None, "ray", "sweep"):
        world, moving, fixed = scene()
        world.gravity = (0, 0, -9.81)
        wall(fixed, oo.Surface(0.4, bounce=0.5))
        ball(moving, (0, 0, 1), (1, 0, 0), mode)
        world.step(300)
        ends.append(world.poses.copy())
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], ends[2])
