"""Bodies that touch nothing, against closed formulas.

ODE steps by the semi-implicit Euler method: ``v[k+1] = v[k] + a h`` and then ``x[k+1] = x[k] + v[k+1] h``. With a
constant acceleration this sums to ``x[n] = x[0] + v[0] n h + a h^2 n (n + 1) / 2``, which differs from the
continuous ``x + v t + a t^2 / 2`` by exactly ``a h t / 2``.
"""

import math

import numpy as np
import pytest

import osgode as oo

GRAVITY = 9.81


@pytest.fixture(params=["quick", "exact"])
def solver(request):
    return request.param


def after(start, velocity, acceleration, h, n):
    """Where the sum above says that a body is after n steps."""
    return np.array(start) + np.array(velocity) * n * h + np.array(acceleration) * h * h * n * (n + 1) / 2


def inertia_of_box(m, x, y, z):
    """Of a solid box about its centre: m / 12 times the sums of the squares of the other two edges."""
    return m / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])


def shifted(inertia, m, r):
    """Steiner's theorem: the inertia about a point that is r away from the centre of mass."""
    r = np.array(r)
    return inertia + m * (r @ r * np.identity(3) - np.outer(r, r))


def test_free_fall_is_the_semi_implicit_sum_to_rounding(solver):
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=1 / 120, solver=solver)
    body = world.attach(oo.Body(position=(0, 100, 0)))
    for n in (1, 2, 10, 120, 480):
        world.step(n - world.steps)
        assert body.position.y == pytest.approx(after(100, 0, -GRAVITY, 1 / 120, n), rel=1e-12)
        assert body.linear_velocity.y == pytest.approx(-GRAVITY * n / 120, rel=1e-12)


def test_a_projectile_flies_its_parabola():
    """The discrete path to rounding; height and length of the throw within the method's a h t / 2.

    Apex v_y^2 / (2 g), reached at v_y / g; the range on level ground is 2 v_x v_y / g.
    """
    h, vx, vy = 1 / 500, 7.0, 12.0
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=h)
    body = world.attach(oo.Body(linear_velocity=(vx, vy, 0)))
    path = []
    while not path or body.position.y > 0:
        world.step()
        path.append(body.position)
    for n in (1, len(path) // 2, len(path)):
        assert tuple(path[n - 1]) == pytest.approx(
            tuple(after((0, 0, 0), (vx, vy, 0), (0, -GRAVITY, 0), h, n)), rel=1e-12, abs=1e-12
        )
    rise = vy / GRAVITY
    assert max(p.y for p in path) == pytest.approx(vy * vy / (2 * GRAVITY), abs=GRAVITY * h * rise / 2 * 1.01)
    assert path[-1].x == pytest.approx(2 * vx * vy / GRAVITY, abs=2 * vx * h)  # lands within two steps of the formula


def test_forces_at_the_centre_accelerate_by_their_ratio_to_the_mass():
    """The sum for a = F / m - g: a 2 kg ball that is pushed with 50 N upwards and 8 N sideways in every step."""
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=1 / 100)
    body = world.attach(oo.Body())
    body.attach(oo.Placeable()).attach(oo.Sphere(0.3, mass=2))
    for _ in range(50):
        body.add_force((8, 50, 0))
        world.step()
    expected = after((0, 0, 0), (0, 0, 0), (8 / 2, 50 / 2 - GRAVITY, 0), 1 / 100, 50)
    assert tuple(body.position) == pytest.approx(tuple(expected), rel=1e-12)


def test_damping_takes_the_same_share_of_the_velocity_in_each_step():
    """v[n] = v[0] (1 - d)^n, as long as it is above the threshold."""
    world = oo.World(gravity=(0, 0, 0), linear_damping=0.01, angular_damping=0.02)
    body = world.attach(oo.Body(linear_velocity=(10, 0, 0), angular_velocity=(0, 5, 0)))
    world.step(100)
    assert body.linear_velocity.x == pytest.approx(10 * 0.99**100, rel=1e-12)
    assert body.angular_velocity.y == pytest.approx(5 * 0.98**100, rel=1e-12)


def test_a_kinematic_body_keeps_its_velocity_whatever_it_meets():
    """It is at x = v t to rounding, though it pushes a crate and gravity pulls."""
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    pusher = space.attach(oo.Body(kinematic=True, linear_velocity=(1.5, 0, 0)))
    pusher.attach(oo.Placeable()).attach(oo.Box((1, 1, 1)))
    crate = space.attach(oo.Body(position=(1.5, 0, 0), gravity=False))
    crate.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=1e4))
    world.run(1)
    assert pusher.linear_velocity == (1.5, 0, 0)
    assert tuple(pusher.position) == pytest.approx((1.5, 0, 0), rel=1e-12, abs=1e-15)
    assert crate.position.x == pytest.approx(pusher.position.x + 1.0, abs=0.01)
    assert crate.linear_velocity.x == pytest.approx(1.5, rel=1e-3)


# -- turning


def test_a_torque_about_a_principal_axis_spins_a_composite_by_its_inertia(solver):
    """A dumb-bell, I_y = 2 (2/5 m r^2 + m a^2) about the middle by Steiner's theorem; w = torque t / I, to 1e-9."""
    m, r, a, torque, h = 3.0, 0.2, 0.7, 4.0, 1 / 200
    world = oo.World(gravity=(0, 0, 0), step_size=h, solver=solver)
    body = world.attach(oo.Body())
    for x in (-a, a):
        body.attach(oo.Placeable(position=(x, 0, 0))).attach(oo.Sphere(r, mass=m))
    inertia = 2 * (0.4 * m * r * r + m * a * a)
    for n in range(1, 101):
        body.add_torque((0, torque, 0))
        world.step()
        assert body.angular_velocity.y == pytest.approx(torque * n * h / inertia, rel=1e-9)
    assert tuple(body.position) == pytest.approx((0, 0, 0), abs=1e-12)


CAP = 0.3  # radius of the round ones below; both are 0.8 m long between the caps or the ends
BARREL, BALL = math.pi * CAP**2 * 0.8, 4 / 3 * math.pi * CAP**3


@pytest.mark.parametrize(
    ("geom", "along", "across"),
    [
        (oo.Sphere(CAP, density=500), 2 / 5 * BALL * CAP**2, 2 / 5 * BALL * CAP**2),
        (oo.Cylinder(CAP, 0.8, density=500), BARREL * CAP**2 / 2, BARREL * (CAP**2 / 4 + 0.8**2 / 12)),
        (
            oo.Capsule(CAP, 0.8, density=500),
            BARREL * CAP**2 / 2 + BALL * 2 / 5 * CAP**2,
            BARREL * (CAP**2 / 4 + 0.8**2 / 12) + BALL * (2 / 5 * CAP**2 + 0.4**2 + 2 * 0.4 * 3 / 8 * CAP),
        ),
    ],
    ids=["sphere", "cylinder", "capsule"],
)
def test_round_shapes_turn_by_the_textbook_inertia_of_their_density(geom, along, across):
    """From rest dw = h torque / I, about their own axis z and across it, to 1e-9.

    Moments are given for 1 kg/m3. Half a ball has its centre 3/8 r from the flat side, so Steiner's theorem there and
    back gives 2/5 r^2 + a^2 + 2 a 3/8 r for a cap whose flat side is a away from the middle.
    """
    for axis, inertia in ((2, along * 500), (0, across * 500)):
        world = oo.World(gravity=(0, 0, 0), step_size=1 / 100)
        body = world.attach(oo.Body())
        body.attach(oo.Placeable()).attach(geom.copy())
        body.add_torque(np.identity(3)[axis] * 10)
        world.step()
        assert body.angular_velocity[axis] == pytest.approx(10 / 100 / inertia, rel=1e-9)


def test_the_first_turn_of_a_crooked_composite_follows_its_whole_inertia_tensor(solver):
    """Two boxes that form an L: from rest dw = h I^-1 torque, I summed about the common centre of mass, to 1e-9.

    From rest there is no gyroscopic torque yet, so a single step shows all nine numbers of the tensor.
    """
    boxes = [(4.0, (2.0, 0.4, 0.6), (0.0, 0.0, 0.0)), (1.5, (0.4, 1.6, 0.3), (0.8, 1.0, 0.2))]
    total = sum(m for m, _, _ in boxes)
    centre = sum(m * np.array(at) for m, _, at in boxes) / total
    inertia = sum(shifted(inertia_of_box(m, *size), m, np.array(at) - centre) for m, size, at in boxes)
    h = 1 / 100
    for axis in np.identity(3):
        torque = 6.0 * axis
        world = oo.World(gravity=(0, 0, 0), step_size=h, solver=solver)
        body = world.attach(oo.Body())
        for m, size, at in boxes:
            body.attach(oo.Placeable(position=at)).attach(oo.Box(size, mass=m))
        body.add_torque(torque)
        world.step()
        expected = h * np.linalg.solve(inertia, torque)
        assert np.allclose(body.angular_velocity, expected, rtol=1e-9, atol=1e-12)
        assert tuple(body.centre_of_mass) == pytest.approx(tuple(centre), rel=1e-12)


def test_a_force_off_centre_both_pushes_and_turns(solver):
    """In one step dv = h F / m and dw = h I^-1 (r x F), r from the centre of mass to where the force acts, to 1e-9."""
    m, size, h = 5.0, (1.0, 2.0, 0.5), 1 / 100
    at, force = np.array([0.5, 1.0, 0.0]), np.array([0.0, 0.0, 30.0])
    world = oo.World(gravity=(0, 0, 0), step_size=h, solver=solver)
    body = world.attach(oo.Body())
    body.attach(oo.Placeable()).attach(oo.Box(size, mass=m))
    body.add_force(force, at=at)
    world.step()
    assert np.allclose(body.linear_velocity, h * force / m, rtol=1e-9, atol=1e-12)
    turning = h * np.linalg.solve(inertia_of_box(m, *size), np.cross(at, force))
    assert np.allclose(body.angular_velocity, turning, rtol=1e-9, atol=1e-12)


def test_a_thrown_hammer_spins_about_a_centre_of_mass_that_follows_the_parabola(solver):
    """No force but gravity acts, so the centre of mass is a projectile, to 1e-9 m; no other point of the hammer is.

    A 1 kg handle and a 4 kg head 0.6 m up it: the centre is at 4 * 0.6 / 5 = 0.48 m. It is thrown so
    that the centre has the velocity (4, 9, 0): for w about z the frame's is (4, 9, 0) - w x (0, 0.48, 0) =
    (4 + 0.48 w, 9, 0).
    """
    h, spin = 1 / 250, -8.0
    world = oo.World(gravity=(0, -GRAVITY, 0), step_size=h, solver=solver)
    hammer = world.attach(oo.Body())
    hammer.attach(oo.Placeable()).attach(oo.Box((0.08, 1.2, 0.08), mass=1))
    hammer.attach(oo.Placeable(position=(0, 0.6, 0))).attach(oo.Box((0.5, 0.2, 0.2), mass=4))
    hammer.angular_velocity = (0, 0, spin)
    hammer.linear_velocity = (4 + 0.48 * spin, 9, 0)
    strayed = 0.0
    for n in range(1, 376):
        world.step()
        expected = after((0, 0.48, 0), (4, 9, 0), (0, -GRAVITY, 0), h, n)
        centre = hammer.world_centre_of_mass
        assert math.dist(centre, expected) < 1e-9
        assert tuple(hammer.velocity_at(centre)) == pytest.approx((4, 9 - GRAVITY * n * h, 0), rel=1e-9, abs=1e-9)
        handle = hammer.local_to_world((0, -0.6, 0))
        strayed = max(strayed, abs(math.dist(handle, expected) - 1.08), abs(handle.x - expected[0]))
    assert strayed == pytest.approx(1.08, abs=0.01)  # the handle's end circles the centre at 1.08 m
    assert hammer.angular_velocity.z == pytest.approx(spin, rel=1e-9)  # about a principal axis nothing brakes it


def test_a_tilted_spinning_disc_precesses_about_its_angular_momentum():
    """Free symmetric top: the figure axis circles L at |L| / I_across, at a constant angle. Angles within 1 %.

    A cylinder of 2 kg, radius 0.5, length 0.1: I_along = m r^2 / 2, I_across = m (r^2 / 4 + l^2 / 12).
    """
    m, r, length, h = 2.0, 0.5, 0.1, 1 / 2000
    along, across = m * r * r / 2, m * (r * r / 4 + length * length / 12)
    world = oo.World(gravity=(0, 0, 0), step_size=h)
    disc = world.attach(oo.Body(angular_velocity=(0.5, 0, 5.0)))
    disc.attach(oo.Placeable()).attach(oo.Cylinder(r, length, mass=m))
    momentum = np.array([across * 0.5, 0.0, along * 5.0])
    assert np.allclose(disc.angular_momentum, momentum, rtol=1e-12)
    pole = momentum / np.linalg.norm(momentum)
    side = np.cross(pole, (0, 1, 0))
    other = np.cross(pole, side)

    def phase():
        axis = disc.vector_to_world((0, 0, 1))
        return math.atan2(np.dot(axis, other), np.dot(axis, side))

    start, seconds = phase(), 0.5
    lean = math.acos(np.dot(disc.vector_to_world((0, 0, 1)), pole))
    turned, last = 0.0, start
    for _ in range(round(seconds / h)):
        world.step()
        turned += (phase() - last + math.pi) % (2 * math.pi) - math.pi
        last = phase()
    assert turned == pytest.approx(np.linalg.norm(momentum) / across * seconds, rel=0.01)
    assert math.acos(np.dot(disc.vector_to_world((0, 0, 1)), pole)) == pytest.approx(lean, rel=0.01)
    assert np.allclose(disc.angular_momentum, momentum, rtol=0.01, atol=0.01 * np.linalg.norm(momentum))
