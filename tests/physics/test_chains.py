"""Chains, shafts and rods that move for a while: what must be held is held, what must be passed on is passed on."""

import math

import pytest

import osgode as oo

G = 9.81


def link(world, position, size, mass):
    body = world.attach(oo.Body(position=position))
    body.fixed_mass = oo.Mass.box(size, mass=mass)
    return body


@pytest.mark.parametrize("kind", [oo.Ball, oo.Hinge])
@pytest.mark.parametrize("solver", ["quick", "exact"])
def test_a_double_pendulum_keeps_its_anchors_and_its_energy(kind, solver):
    """From level, 10 s at 1/1000 s: anchors within 1 mm, energy within 1 % of what turns into motion at most.

    The quick solver has 50 iterations; two joints need no more.
    """
    world = oo.World(gravity=(0, -G, 0), solver=solver, step_size=1 / 1000, iterations=50)
    joints, last = [], None
    for i in range(2):
        body = link(world, (i + 0.5, 0, 0), (1, 0.1, 0.1), 1.0)
        joints.append(kind(body, last, anchor=(i, 0, 0), **({"axis": (0, 0, 1)} if kind is oo.Hinge else {})))
        last = body
    most = (1 * 0.5 + 1 * 1.5) * G  # from level to hanging straight down
    for _ in range(1000):
        world.step(10)
        energy = sum(body.kinetic_energy + body.mass * G * body.position.y for body in world.bodies)
        assert abs(energy) < 0.01 * most
        assert max(joint.error for joint in joints) < 1e-3


@pytest.mark.parametrize("kind", [oo.Ball, oo.Universal, oo.Hinge])
def test_a_chain_of_20_links_keeps_its_anchors(kind):
    """2 m of links of 0.1 m, let go at 45 degrees, swing for 10 s: within 1 mm.

    With the quick solver at 50 iterations, 1/240 s and ERP 0.8. The error that a step makes grows with the square of
    how far the links turn in it; what has grown is corrected by ERP. (Let go level, the tip whips at more than
    30 rad/s, and 1/1000 s still leaves 2 mm.)
    """
    world = oo.World(gravity=(0, -G, 0), step_size=1 / 240, iterations=50, erp=0.8)
    turn = oo.Quat.from_axis_angle((0, 0, 1), -math.pi / 4)
    axes = {oo.Hinge: {"axis": (0, 0, 1)}, oo.Universal: {"axis1": (0, 0, 1), "axis2": turn.rotate((0, 1, 0))}}
    joints, last, size = [], None, 0.1
    for i in range(20):
        body = link(world, turn.rotate(((i + 0.5) * size, 0, 0)), (size, 0.03, 0.03), 0.2)
        body.rotation = turn
        joints.append(kind(body, last, anchor=turn.rotate((i * size, 0, 0)), **axes.get(kind, {})))
        last = body
    lowest = farthest = 0.0
    for _ in range(2400):
        world.step()
        assert max(joint.error for joint in joints) < 1e-3
        lowest, farthest = min(lowest, last.position.y), min(farthest, last.position.x)
    assert lowest < -1.8
    assert farthest < -1.2


@pytest.mark.parametrize("bend", [0.0, 0.3, 0.7, 1.1])
@pytest.mark.parametrize("order", [(0, 1), (1, 0)], ids=["driver first", "driver second"])
def test_a_universal_joint_passes_speed_on_between_cos_and_its_inverse(bend, order):
    """Over a whole turn: w2 / w1 = cos b / (cos^2 a + cos^2 b sin^2 a), and tan a2 = cos b tan a.

    a is how far the driven shaft has turned from where its arm of the cross is square to the plane of both shafts.
    Arm 1 is cos a n + sin a (s1 x n), arm 2 is cos a2 (s2 x n) - sin a2 n; that they are perpendicular gives the second
    formula, its derivative the first.
    """
    world = oo.World(gravity=(0, 0, 0), solver="exact", step_size=1 / 1000)
    s1, s2, n = oo.Vec3(1, 0, 0), oo.Vec3(math.cos(bend), 0, math.sin(bend)), oo.Vec3(0, 1, 0)
    shafts = [link(world, (-1, 0, 0), (0.2, 0.2, 0.2), 2.0), link(world, s2, (0.2, 0.2, 0.2), 2.0)]
    axles = [oo.Hinge(shaft, anchor=(0, 0, 0), axis=s) for shaft, s in zip(shafts, (s1, s2), strict=True)]
    arms = [n, s2.cross(n)]
    first, second = (shafts[i] for i in order)
    cross = oo.Universal(first, second, anchor=(0, 0, 0), axis1=arms[order[0]], axis2=arms[order[1]])
    axles[0].motor(2.0, math.inf)
    ratios = []
    for _ in range(round(2 * math.pi / 2.0 * 1000)):
        before = axles[0].angle
        world.step()
        a = (before + 2.0 / 1000 / 2) if before > -3.13 else math.pi  # in the middle of the step
        ratio = axles[1].angle_rate / axles[0].angle_rate
        expected = math.cos(bend) / (math.cos(a) ** 2 + math.cos(bend) ** 2 * math.sin(a) ** 2)
        assert ratio == pytest.approx(expected, rel=5e-3)
        a = axles[0].angle
        a2 = math.atan2(math.sin(a) * math.cos(bend), math.cos(a))
        assert math.remainder(axles[1].angle - a2, 2 * math.pi) == pytest.approx(0.0, abs=1e-3)
        ratios.append(ratio)
        assert cross.error < 1e-6
        assert cross.angular_error < 1e-3
    assert min(ratios) == pytest.approx(math.cos(bend), rel=1e-3)
    assert max(ratios) == pytest.approx(1 / math.cos(bend), rel=1e-3)


@pytest.mark.parametrize("off", [(0, 0, 0), (0.1, -0.2, 0)])
def test_plane_2d_keeps_a_crowd_in_its_plane(off):
    """Boxes flung against each other and the ground for 5 s: never off by more than 1 mm, nor tilted by 0.01 rad."""
    world = oo.World(gravity=(0, -G, 0))
    space = world.attach(oo.SimpleSpace())
    space.attach(oo.Plane())
    world.collide(space)
    joints = []
    for i in range(6):
        body = space.attach(oo.Body(position=(0.3 * i, 1.0 + 1.2 * i, 0)))
        body.attach(oo.Placeable()).attach(oo.Box((1, 0.8, 0.6), mass=2))
        body.fixed_mass = oo.Mass.box((1, 0.8, 0.6), mass=2).translated(off)
        body.linear_velocity, body.angular_velocity = (2 - i, 0, 0), (0, 0, i - 3.0)
        joints.append(oo.Plane2D(body))
    for _ in range(600):
        world.step()
        for joint in joints:
            assert joint.error < 1e-3
            assert joint.angular_error < 1e-2
    assert min(body.position.y for body in world.bodies) > 0.2
    assert len({round(body.position.x, 2) for body in world.bodies}) > 3


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.parametrize("kind", [oo.DoubleBall, oo.DoubleHinge])
def test_a_rod_keeps_its_length(kind, both):
    """Swinging 5 s at 1/500 s, exact solver: within 1 mm."""
    world = oo.World(gravity=(0, -G, 0), solver="exact", step_size=1 / 500)
    bob = link(world, (1.5, 0, 0), (0.3, 0.3, 0.3), 2.0)
    other = link(world, (0, 0, 0), (0.3, 0.3, 0.3), 30.0) if both else None
    if both:
        oo.Slider(other, axis=(1, 0, 0))
    joint = kind(bob, other, anchor1=(1.4, 0.1, 0), anchor2=(0, 0, 0))
    length = math.hypot(1.4, 0.1)
    lowest = 0.0
    for _ in range(2500):
        world.step()
        assert joint.length == pytest.approx(length, abs=1e-3)
        lowest = min(lowest, bob.position.y)
    assert lowest < -1.2


def test_an_euler_motor_with_stops_keeps_a_body_upright():
    """Two stops of 0.02 rad on tilting, none on turning about the vertical: pushed about, it only sways and spins."""
    world = oo.World(gravity=(0, -G, 0), solver="exact")
    body = link(world, (0, 1, 0), (0.4, 1.8, 0.3), 70.0)
    oo.Ball(body, anchor=(0, 0.1, 0))
    upright = oo.AngularMotor(
        body, axes=[(0, 1, 0), (1, 0, 0)], mode="euler", stops2=(-0.02, 0.02), stops3=(-0.02, 0.02)
    )
    for step in range(960):
        if step < 240:
            body.add_force(
                (80 * math.cos(step / 30), 0, 80 * math.sin(step / 50)), at=body.local_to_world((0, 0.5, 0.1))
            )
            body.add_torque((0, 5, 0))
        world.step()
        assert body.vector_to_world((0, 1, 0)).y > math.cos(0.05)
    assert abs(upright.angle2) <= 0.021
    assert abs(upright.angle3) <= 0.021
    assert abs(body.angular_velocity.y) > 1.0
