"""Bodies: their frame and their centre of mass, the masses of their parts, pushing them, and what they refuse."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

import osgode as oo
from osgode.native import ffi, lib
from tests.strategies import directions, floats, poses, rotations, vectors

UNIT = np.identity(3)


def near(expected, tolerance=1e-9):
    return pytest.approx(tuple(expected), abs=tolerance)


def lopsided(**fields):
    """A body whose centre of mass is away from its frame, in a World without gravity."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body(name="it", **fields))
    place = body.attach(oo.Placeable(position=(0.5, 0.25, -1.0), rotation=oo.Quat.from_axis_angle((1, 2, 3), 0.7)))
    place.attach(oo.Box((1, 2, 0.5), mass=3.0))
    body.attach(oo.Placeable(position=(-0.25, 0, 0))).attach(oo.Sphere(0.5, mass=1.0))
    return world, body


# -- the frame and the centre of mass


@given(vectors(), rotations(), vectors(5), vectors(5))
@settings(max_examples=50)
def test_the_frame_is_where_its_author_put_it(position, rotation, velocity, spin):
    """Wherever the centre of mass is, in whatever order the fields are set: position, rotation, velocities."""
    _, body = lopsided()
    wanted = {
        "position": position,
        "rotation": rotation,
        "linear_velocity": velocity,
        "angular_velocity": spin,
    }
    for names in (list(wanted), list(wanted)[::-1]):
        for name in names:
            setattr(body, name, wanted[name])
        for name, value in wanted.items():
            assert getattr(body, name) == near(value, 1e-12)


@given(poses(), vectors(3), vectors(3), vectors(2))
@settings(max_examples=50)
def test_the_centre_moves_as_a_point_of_the_body_does(pose, velocity, spin, point):
    """In ODE: p_centre = p + R c, v_centre = v + w x R c; so does every point of the body."""
    _, body = lopsided(position=pose.position, rotation=pose.rotation, linear_velocity=velocity, angular_velocity=spin)
    arm = pose.rotation.rotate(body.centre_of_mass)
    assert tuple(ffi.unpack(lib.dBodyGetPosition(body._id), 3)) == near(pose.position + arm)
    assert tuple(ffi.unpack(lib.dBodyGetLinearVel(body._id), 3)) == near(velocity + spin.cross(arm))
    assert body.world_centre_of_mass == near(pose.position + arm)
    there = body.local_to_world(point)
    assert there == near(pose.transform(point))
    assert body.velocity_at(there) == near(velocity + spin.cross(there - pose.position))
    assert body.world_to_local(there) == near(point)
    assert body.vector_to_local(body.vector_to_world(point)) == near(point)
    assert body.vector_to_world(point) == near(pose.rotation.rotate(point))
    assert np.array(body.local_matrix()) == pytest.approx(pose.matrix(), abs=1e-12)


def test_a_free_body_turns_about_its_centre():
    """Whatever its frame does: the centre goes straight on, and both momenta stay."""
    world, body = lopsided(angular_velocity=(0.5, 2.0, -1.0), linear_velocity=(1, 0, 0))
    start, velocity = body.world_centre_of_mass, body.velocity_at(body.world_centre_of_mass)
    momentum, angular = body.momentum, body.angular_momentum
    world.run(1.0)
    assert body.world_centre_of_mass == near(start + velocity * 1.0)
    assert body.momentum == near(momentum)
    assert body.angular_momentum == near(angular, 0.05)
    assert body.position.distance(start) > 0.1


def test_poses_and_velocities_of_the_table_are_those_of_the_frame():
    world, body = lopsided(position=(1, 2, 3), angular_velocity=(1, 2, 3), linear_velocity=(4, 5, 6))
    assert tuple(world.velocities[0]) == near((4, 5, 6, 1, 2, 3), 1e-12)
    world.step()
    assert tuple(world.poses[0]) == (*body.position, *body.rotation)
    assert tuple(world.velocities[0]) == near((*body.linear_velocity, *body.angular_velocity), 1e-12)


def test_a_body_that_was_put_somewhere_is_shown_there_at_once():
    """There is nothing to interpolate from."""
    world, body = lopsided()
    world.step(2)
    body.position = (10, 0, 0)
    body.rotation = (0, 1, 0, 0)
    for table in (world.poses, world.previous_poses):
        assert tuple(table[0]) == near((10, 0, 0, 0, 1, 0, 0), 1e-12)


# -- mass


def numpy_mass(parts):
    """Mass, centre and inertia of several geoms in the frame of their body, computed from scratch."""
    some = [(geom._shape_mass(**weight(geom)), geom.parent.pose) for geom in parts if geom.mass != 0.0]
    total = sum(mass.mass for mass, _ in some)
    points = [pose.matrix() @ [*mass.centre, 1] for mass, pose in some]
    centre = sum(mass.mass * point[:3] for (mass, _), point in zip(some, points, strict=True)) / total
    inertia = np.zeros((3, 3))
    for (mass, pose), point in zip(some, points, strict=True):
        turn, r = pose.matrix()[:3, :3], point[:3] - centre
        inertia += turn @ np.array(mass.inertia) @ turn.T + mass.mass * (r @ r * UNIT - np.outer(r, r))
    return total, centre, inertia


def weight(geom):
    from osgode.materials import material

    if geom.mass is not None:
        return {"mass": geom.mass}
    return {"density": geom.density if geom.density is not None else material(geom.material).density}


def native_mass(body):
    out = ffi.new("dMass *")
    lib.dBodyGetMass(body._id, out)
    return out.mass, list(out.c)[:3], [out.I[4 * row + column] for row in range(3) for column in range(3)]


def test_momentum_of_what_stays_is_not_touched_by_what_comes_and_goes():
    """Parts come with the velocity of the body they join: every material point goes on as it did."""
    _, body = lopsided(angular_velocity=(1, 2, 3), linear_velocity=(4, 5, 6))
    point = (0.3, 0.4, 0.5)
    before = body.velocity_at(point)
    part = body.attach(oo.Placeable(position=(5, 0, 0)))
    ball = part.attach(oo.Sphere(mass=100.0))
    assert body.velocity_at(point) == near(before)
    part.detach(ball)
    assert body.velocity_at(point) == near(before)


def test_a_fixed_mass_goes_before_the_parts():
    _, body = lopsided()
    mass = oo.Mass(7.0, oo.Vec3(0.1, 0.2, 0.3), ((1, 0, 0), (0, 2, 0), (0, 0, 2.5)))
    own = body.mass_properties
    body.fixed_mass = mass
    assert body.mass_properties is mass
    assert native_mass(body)[0] == 7.0
    assert body._com == (0.1, 0.2, 0.3)
    body.attach(oo.Placeable()).attach(oo.Sphere(mass=50.0))
    assert body.mass == 7.0
    body.fixed_mass = None
    assert body.mass == own.mass + 50.0


def test_a_body_without_mass_is_odes():
    """1 kg and unit inertia about its origin, as documented."""
    world = oo.World()
    body = world.attach(oo.Body())
    assert (body.mass, body.centre_of_mass) == (1.0, (0, 0, 0))
    assert np.array_equal(body.inertia, UNIT)
    assert native_mass(body) == (1.0, [0, 0, 0], [1, 0, 0, 0, 1, 0, 0, 0, 1])


def test_mass_is_by_density_of_the_material_unless_given():
    body = oo.Body()
    place = body.attach(oo.Placeable())
    box = place.attach(oo.Box((1, 2, 3), material="wood"))
    assert body.mass == pytest.approx(6 * 710)
    box.density = 100.0
    assert body.mass == pytest.approx(600)
    box.density = None
    box.mass = 5.0
    assert body.mass == 5.0
    with pytest.raises(oo.FieldError, match=r"mass=5\.0 and density=3\.0"):
        box.density = 3.0
    assert box.density is None


def test_a_kinematic_body_stays_so_when_its_parts_change():
    world, body = lopsided(kinematic=True, linear_velocity=(1, 0, 0))
    body.attach(oo.Placeable(position=(1, 1, 1))).attach(oo.Box())
    assert body.kinematic
    body.add_force((1e6, 0, 0))
    body.apply_impulse((1e6, 0, 0))
    world.gravity = (0, -9.81, 0)
    world.run(1.0)
    assert body.position == near((1, 0, 0))
    body.kinematic = False
    world.step()
    assert body.linear_velocity.y < 0


# -- pushing


@given(vectors(), vectors(3), rotations())
@settings(max_examples=40)
def test_forces_add_up_about_the_centre(force, point, rotation):
    """In ODE's accumulators: F, and (p - centre) x F."""
    _, body = lopsided(rotation=rotation, position=(1, 2, 3))
    body.add_force(force)
    assert body.force == near(force)
    assert body.torque == near((0, 0, 0))
    body.add_force(force, at=point)
    assert body.force == near(force * 2)
    torque = (point - body.world_centre_of_mass).cross(force)
    assert body.torque == near(torque)
    body.add_torque((1, 2, 3))
    assert body.torque == near(oo.Vec3(1, 2, 3) + torque)
    body.force = body.torque = (0, 0, 0)
    body.add_local_force(force, at=point)
    wanted = rotation.rotate(force)
    assert body.force == near(wanted)
    assert body.torque == near((body.local_to_world(point) - body.world_centre_of_mass).cross(wanted), 1e-8)
    body.torque = (0, 0, 0)
    body.add_local_torque(force)
    assert body.torque == near(wanted)
    body.torque = body.force = (0, 0, 0)
    body.add_local_force(force)
    assert body.force == near(wanted)
    assert body.torque == near((0, 0, 0))


@given(vectors(), vectors(3), rotations())
@settings(max_examples=40)
def test_an_impulse_is_what_the_momenta_gain(impulse, point, rotation):
    """They gain J, and r x J about the centre."""
    _, body = lopsided(rotation=rotation, linear_velocity=(1, 2, 3), angular_velocity=(0.5, 1, 0))
    linear, angular = np.array(body.momentum), np.array(body.angular_momentum)
    body.apply_impulse(impulse, at=point)
    arm = point - body.world_centre_of_mass
    assert np.array(body.momentum) - linear == near(impulse)
    assert np.array(body.angular_momentum) - angular == near(arm.cross(impulse), 1e-8)
    linear, angular = np.array(body.momentum), np.array(body.angular_momentum)
    body.apply_angular_impulse(impulse)
    assert np.array(body.momentum) - linear == near((0, 0, 0))
    assert np.array(body.angular_momentum) - angular == near(impulse, 1e-8)
    linear = np.array(body.momentum)
    body.apply_impulse(impulse)
    assert np.array(body.momentum) - linear == near(impulse)


def test_a_force_acts_for_one_step():
    world, body = lopsided()
    body.add_force((4, 0, 0))
    world.step()
    gained = body.momentum.x
    assert gained == pytest.approx(4 * world.step_size)
    assert body.force == (0, 0, 0)
    world.step()
    assert body.momentum.x == pytest.approx(gained)


NAN, INF = math.nan, math.inf
BAD_VECTORS = [
    (NAN, 0, 0),
    (0, INF, 0),
    (1, 2),
    "abc",
    None,
    5,
    (1e300, 0, 0),
    ("1", "2", "3"),
    b"abc",
    (10**400, 0, 0),
]


@pytest.mark.parametrize("bad", BAD_VECTORS, ids=lambda value: str(value)[:16])
def test_a_push_that_is_no_vector_is_refused_and_pushes_nothing(bad):
    """NaN in a force is taken silently by ODE, and ends the process some steps later."""
    world, body = lopsided()
    body.enabled = False
    for name, call in (
        ("add_force", lambda: body.add_force(bad)),
        ("add_local_force", lambda: body.add_local_force(bad)),
        ("add_torque", lambda: body.add_torque(bad)),
        ("add_local_torque", lambda: body.add_local_torque(bad)),
        ("apply_impulse", lambda: body.apply_impulse(bad)),
        ("apply_angular_impulse", lambda: body.apply_angular_impulse(bad)),
        *(
            ()
            if bad is None
            else (
                ("add_force", lambda: body.add_force((1, 0, 0), at=bad)),
                ("add_local_force", lambda: body.add_local_force((1, 0, 0), at=bad)),
                ("apply_impulse", lambda: body.apply_impulse((1, 0, 0), at=bad)),
            )
        ),
    ):
        with pytest.raises(oo.FieldError, match=rf"Body 'it'\.{name}\(\)\.\w+ is .*must be"):
            call()
    assert (body.force, body.torque) == ((0, 0, 0), (0, 0, 0))
    assert (body.linear_velocity, body.angular_velocity) == ((0, 0, 0), (0, 0, 0))
    assert not body.enabled
    world.step()


def test_an_impulse_that_would_make_it_too_fast_is_refused():
    _, body = lopsided(enabled=False)
    for call in (
        lambda: body.apply_impulse((1e15, 0, 0)),
        lambda: body.apply_impulse((1e5, 0, 0), at=(0, 1e8, 0)),
        lambda: body.apply_angular_impulse((0, 1e15, 0)),
    ):
        with pytest.raises(oo.FieldError, match=r"Body 'it'\.(linear|angular)_velocity is"):
            call()
    assert (body.linear_velocity, body.angular_velocity) == ((0, 0, 0), (0, 0, 0))
    assert not body.enabled


def test_a_push_needs_a_world():
    body = oo.Body(name="it")
    for call in (body.add_force, body.add_local_force, body.add_torque, body.add_local_torque, body.apply_impulse):
        with pytest.raises(oo.StateError, match=r"Body 'it'.*needs a World"):
            call((1, 0, 0))


def test_pushing_wakes():
    _, body = lopsided()
    for push in (
        lambda: body.add_force((1, 0, 0)),
        lambda: body.add_local_torque((1, 0, 0)),
        lambda: body.apply_impulse((1, 0, 0)),
        lambda: setattr(body, "linear_velocity", (1, 0, 0)),
        lambda: setattr(body, "angular_velocity", (1, 0, 0)),
        body.wake,
    ):
        body.enabled = False
        push()
        assert body.enabled


# -- falling asleep


def test_a_body_at_rest_falls_asleep_when_told_to():
    """From the first step on it counts to its own limit; ODE lets nothing sleep that no joint holds."""
    world = oo.World(gravity=(0, 0, 0), auto_disable=True, auto_disable_steps=5)
    still, moving = world.attach(oo.Body()), world.attach(oo.Body(linear_velocity=(1, 0, 0)))
    awake = world.attach(oo.Body(auto_disable=False))
    late = world.attach(oo.Body(auto_disable_steps=20))
    for body in (still, moving, awake, late):
        oo.Slider(body)
    world.step(4)
    assert still.enabled
    world.step(2)
    assert not still.enabled
    assert moving.enabled
    assert awake.enabled
    world.step(12)
    assert late.enabled
    late.auto_disable_steps = 30
    world.step(28)
    assert late.enabled
    world.step(4)
    assert not late.enabled
    late.auto_disable_steps = 5
    assert not late.enabled


def test_turning_sleep_off_and_on_keeps_its_limits():
    """ODE forgets them with the flag."""
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body(auto_disable_steps=7, auto_disable_time=0.5, auto_disable_samples=3))
    for on in (True, False, True):
        world.auto_disable = on
        assert body.auto_disable is on
        assert (body.auto_disable_steps, body.auto_disable_time, body.auto_disable_samples) == (7, 0.5, 3)


def test_samples_of_the_world_above_one_do_no_harm():
    """ODE writes past an array when the defaults of a World's sample count are raised; the count is set on bodies."""
    world = oo.World(auto_disable=True, auto_disable_samples=1000)
    bodies = [world.attach(oo.Body()) for _ in range(20)]
    world.step(5)
    world.auto_disable_samples = 1
    world.step(5)
    world.auto_disable_samples = 10_000
    world.step(5)
    assert all(body.auto_disable_samples == 10_000 for body in bodies)


# -- fast turning


@given(directions(), floats(1, 30))
@settings(max_examples=20)
def test_finite_rotation_turns_exactly(axis, speed):
    """About its own axis a wheel keeps the length of its spokes at any speed: angle = speed * time."""
    world = oo.World(gravity=(0, 0, 0), step_size=0.01)
    wheel = world.attach(oo.Body(angular_velocity=axis.normalized() * speed, finite_rotation_axis=(0, 0, 0)))
    world.step(10)
    wanted = oo.Quat.from_axis_angle(axis, speed * 0.1)
    assert abs(sum(a * b for a, b in zip(wheel.rotation, wanted, strict=True))) == pytest.approx(1.0, abs=1e-9)


def test_turning_is_cut_off_at_the_limit():
    world = oo.World(gravity=(0, 0, 0))
    body = world.attach(oo.Body(angular_velocity=(0, 100, 0), max_angular_speed=10.0))
    world.step(2)
    assert body.angular_velocity.length == pytest.approx(10.0)


@given(floats(0, 1), vectors(5), vectors(5))
def test_interpolated_pose_is_between_the_last_two_steps(interpolation, velocity, spin):
    """That of the body alone, with the numbers that the picture of all bodies has; the rotation of length 1."""
    world = oo.World(gravity=(0, 0, 0))
    other, body = (world.attach(oo.Body(position=(k, 2, 3))) for k in range(2))
    body.linear_velocity, body.angular_velocity = velocity, spin
    assert body.interpolated_pose(interpolation).position == (1, 2, 3)
    world.step(3)
    pose = body.interpolated_pose(interpolation)
    assert (*pose.position, *pose.rotation) == pytest.approx(world.interpolated_poses(interpolation)[1])
    h = world.step_size
    assert pose.position == pytest.approx(oo.Vec3(1, 2, 3) + oo.Vec3(*velocity) * (h * (2 + interpolation)), abs=1e-9)
    assert math.hypot(*pose.rotation) == pytest.approx(1.0)
    assert body.interpolated_pose(1.0) == body.pose
    world.detach(other)
    assert body.interpolated_pose(1.0) == body.pose, "though its row in the tables is another now"
    body.position = (7, 8, 9)
    assert body.interpolated_pose(interpolation).position == (7, 8, 9), "what is put somewhere doesn't streak there"
    world.detach(body)
    assert body.interpolated_pose(interpolation) == body.pose
