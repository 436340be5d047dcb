"""Springs and dampers in N/m and N s/m: ERP and CFM, and the motion, which is implicit Euler's.

One implicit step of a mass on a spring and a damper is ``v' = v + h / m (F - k x' - d v')``, ``x' = x + h v'``, so
``v' = (m v + h F - h k x) / (m + h d + h^2 k)``. ODE's constraint with ``ERP = h k / (h k + d)`` and
``CFM = 1 / (h k + d)`` (the ODE manual) has the same solution. With the exact solver the figures agree to 1e-6 of the
amplitude; the quick one iterates, but has one row to solve here, so it does too.
"""

import math

import pytest

import osgode as oo

GRAVITY = 9.81
MASS, STIFFNESS, DAMPING = 2.0, 400.0, 6.0
STEPS = [1 / 60, 1 / 120, 1 / 1000]
each_step = pytest.mark.parametrize("h", STEPS, ids=["60", "120", "1000"])
each_solver = pytest.mark.parametrize("solver", ["quick", "exact"])


def implicit_euler(x, v, *, force, h, mass=MASS, k=STIFFNESS, d=DAMPING):
    """Where the mass is after each step, for ever."""
    while True:
        v = (mass * v + h * force - h * k * x) / (mass + h * d + h * h * k)
        x += h * v
        yield x, v


def heavy(world, mass=MASS, **where):
    body = world.attach(oo.Body(**where))
    body.fixed_mass = oo.Mass.sphere(0.2, mass=mass)
    return body


def earth(h, solver="exact", **fields):
    return oo.World(gravity=(0, -GRAVITY, 0), step_size=h, solver=solver, **fields)


def spring_ball(world, body, k, d):
    return oo.Ball(body, stiffness=k, damping=d)


def spring_fixed(world, body, k, d):
    return oo.Fixed(body, stiffness=k, damping=d)


def spring_rod(world, body, k, d):
    """Two metres above, pulling."""
    top = body.position + oo.Vec3(0, 2, 0)
    return oo.DoubleBall(body, anchor2=top, stiffness=k, damping=d)


def spring_slider(world, body, k, d):
    return oo.Slider(body, axis=(0, 1, 0), stops=(0, 0), stop_stiffness=k, stop_damping=d)


def spring_piston(world, body, k, d):
    return oo.Piston(body, axis=(0, 1, 0), stops1=(0, 0), stop_stiffness1=k, stop_damping1=d)


def spring_pr(world, body, k, d):
    return oo.PR(body, axis1=(0, 1, 0), axis2=(1, 0, 0), stops1=(0, 0), stop_stiffness1=k, stop_damping1=d)


def spring_pu(world, body, k, d):
    axes = {"axis1": (1, 0, 0), "axis2": (0, 0, 1), "axis3": (0, 1, 0)}
    return oo.PU(body, **axes, stops3=(0, 0), stop_stiffness3=k, stop_damping3=d)


def spring_hinge2(world, body, k, d):
    """The body is the wheel; the chassis is held by nothing but being kinematic."""
    chassis = world.attach(oo.Body(kinematic=True))
    return oo.Hinge2(chassis, body, suspension_stiffness=k, suspension_damping=d)


def spring_double_hinge(world, body, k, d):
    top = body.position + oo.Vec3(0, 2, 0)
    return oo.DoubleHinge(body, anchor2=top, axis=(0, 0, 1), stiffness=k, damping=d)


SPRINGS = [
    spring_ball,
    spring_fixed,
    spring_rod,
    spring_slider,
    spring_piston,
    spring_pr,
    spring_pu,
    spring_hinge2,
    spring_double_hinge,
]
each_spring = pytest.mark.parametrize("spring", SPRINGS)


@each_step
@each_spring
@each_solver
def test_a_mass_on_a_spring_moves_as_implicit_euler_has_it(spring, h, solver):
    """Let go with the spring at its rest length, under gravity; for 2 s, to 1e-6 m."""
    world = earth(h, solver)
    body = heavy(world, position=(0, 5, 0))
    spring(world, body, STIFFNESS, DAMPING)
    expected = implicit_euler(0.0, 0.0, force=-MASS * GRAVITY, h=h)
    for _, (x, v) in zip(range(round(2 / h)), expected, strict=False):
        world.step()
        assert body.position == pytest.approx((0, 5 + x, 0), abs=1e-6)
        assert body.linear_velocity.y == pytest.approx(v, abs=1e-5)


@each_spring
def test_a_spring_sags_by_weight_over_stiffness_at_any_step_size(spring):
    """By m g / k within 1 % at 1/60, 1/120 and 1/1000 s, set while it hangs: ERP and CFM are derived anew."""
    world = earth(1 / 60)
    body = heavy(world, position=(0, 5, 0))
    spring(world, body, STIFFNESS, 40.0)
    for h in [*STEPS, 1 / 60]:
        world.step_size = h
        world.run(3.0)
        assert 5 - body.position.y == pytest.approx(MASS * GRAVITY / STIFFNESS, rel=0.01)
        world.step_size = 1e-3 if h > 1e-3 else 1 / 60
        world.step()


@each_step
@each_spring
def test_a_damper_alone_lets_go_slowly(spring, h):
    """Without stiffness it pulls back by nothing, and sinks at m g / d in the end, as implicit Euler has it."""
    world = earth(h)
    body = heavy(world, position=(0, 5, 0))
    spring(world, body, 0.0 if spring is spring_ball else None, 50.0)
    expected = implicit_euler(0.0, 0.0, force=-MASS * GRAVITY, h=h, k=0.0, d=50.0)
    for _, (x, v) in zip(range(round(1 / h)), expected, strict=False):
        world.step()
        assert body.position.y == pytest.approx(5 + x, abs=1e-6)
        assert body.linear_velocity.y == pytest.approx(v, abs=1e-6)
    assert body.linear_velocity.y == pytest.approx(-MASS * GRAVITY / 50, rel=1e-3)


@each_step
@pytest.mark.parametrize("after", ["", "1", "2"])
def test_a_turning_spring_moves_as_implicit_euler_has_it(h, after):
    """A stop in N m/rad of a hinge, of a universal joint and of a piston: I w' = -k a - d w, to 1e-5 rad.

    Given a push and let go, within 0.1 rad: ODE turns by chords (a = 2 atan(w h / 2) in a step), not by arcs.
    """
    world = oo.World(gravity=(0, 0, 0), step_size=h, solver="exact")
    body = heavy(world)
    inertia = 0.4 * MASS * 0.2**2
    k, d = 3.0, 0.02
    fields = {f"stops{after}": (0, 0), f"stop_stiffness{after}": k, f"stop_damping{after}": d}
    {"": oo.Hinge, "1": oo.Universal, "2": oo.Piston}[after](body, **fields)
    axis = {"": (0, 1, 0), "1": (1, 0, 0), "2": (1, 0, 0)}[after]
    body.angular_velocity = oo.Vec3(*axis) * 0.5
    expected = implicit_euler(0.0, 0.5, force=0.0, h=h, mass=inertia, k=k, d=d)
    for _, (x, _) in zip(range(round(0.5 / h)), expected, strict=False):
        world.step()
        turned = 2 * math.atan2(oo.Vec3(*body.rotation[1:]).dot(axis), body.rotation.w)
        assert turned == pytest.approx(x, abs=1e-5)


@each_step
@each_solver
def test_a_ball_rests_on_a_soft_contact_as_on_a_spring(h, solver):
    """One contact point, so one spring: while it presses it moves by implicit Euler, to 1e-6 m.

    It begins just touching. A contact only pushes, so the damping is high enough that it never leaves.
    """
    world = earth(h, solver)
    space = world.attach(oo.SimpleSpace())
    surface = oo.Surface(friction=0, stiffness=STIFFNESS, damping=60.0)
    space.attach(oo.Plane(surface=surface))
    body = space.attach(oo.Body(position=(0, 0.5 - 1e-9, 0)))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.5, mass=MASS, surface=surface))
    world.collide(space)
    expected = implicit_euler(-1e-9, 0.0, force=-MASS * GRAVITY, h=h, d=60.0)
    for _, (x, _) in zip(range(round(2 / h)), expected, strict=False):
        world.step()
        assert body.position.y - 0.5 == pytest.approx(x, abs=1e-6)
    assert 0.5 - body.position.y == pytest.approx(MASS * GRAVITY / STIFFNESS, rel=0.01)


def test_a_soft_contact_sags_the_same_at_any_step_size():
    world = earth(1 / 60)
    space = world.attach(oo.SimpleSpace())
    world.surfaces.fallback = oo.Surface(stiffness=STIFFNESS, damping=60.0)
    space.attach(oo.Plane())
    body = space.attach(oo.Body(position=(0, 0.5, 0)))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.5, mass=MASS))
    world.collide(space)
    for h in [*STEPS, 1 / 60]:
        world.step_size = h
        world.run(2.0)
        assert 0.5 - body.position.y == pytest.approx(MASS * GRAVITY / STIFFNESS, rel=0.01)


# -- the two numbers

PLACES = [
    (oo.Ball, {}, "", ""),
    (oo.Fixed, {}, "", ""),
    (oo.DoubleBall, {"anchor2": (0, 2, 0)}, "", ""),
    (oo.DoubleHinge, {"anchor2": (0, 2, 0)}, "", ""),
    (oo.Hinge, {}, "stop_", ""),
    (oo.Slider, {}, "stop_", ""),
    *((oo.Universal, {}, "stop_", n) for n in "12"),
    *((oo.PR, {}, "stop_", n) for n in "12"),
    *((oo.PU, {}, "stop_", n) for n in "123"),
    *((oo.Piston, {}, "stop_", n) for n in "12"),
    *((oo.AngularMotor, {}, "stop_", n) for n in "123"),
    (oo.Hinge2, {}, "stop_", "1"),
    (oo.Hinge2, {}, "suspension_", ""),
    (oo.Transmission, {}, "", ""),
]
each_place = pytest.mark.parametrize(("cls", "where", "before", "after"), PLACES)


def joined(cls, where, **fields):
    world = oo.World()
    bodies = [world.attach(oo.Body()), world.attach(oo.Body(position=(1, 0, 0)))]
    return world, cls(*bodies[: max(cls.BODIES)], **where, **fields)


@each_step
@each_place
@pytest.mark.parametrize("spring", [(400.0, 6.0), (400.0, None), (None, 6.0), (1e6, 0.0), (0.0, 1e-3)])
def test_erp_and_cfm_follow_from_stiffness_damping_and_step_size(cls, where, before, after, spring, h):  # noqa: PLR0917
    """ERP = h k / (h k + d), CFM = 1 / (h k + d); derived again for another step size."""
    k, d = spring
    names = {name: f"{before}{name}{after}" for name in ("stiffness", "damping", "erp", "cfm")}
    world, joint = joined(cls, where, **{names["stiffness"]: k, names["damping"]: d})
    world.step_size = h
    hardness = h * (k or 0.0) + (d or 0.0)
    assert getattr(joint, names["erp"]) == pytest.approx(h * (k or 0.0) / hardness, rel=1e-12)
    assert getattr(joint, names["cfm"]) == pytest.approx(1 / hardness, rel=1e-12)
    assert (getattr(joint, names["stiffness"]), getattr(joint, names["damping"])) == (k, d)


@each_place
def test_without_the_spring_the_worlds_values_are_back(cls, where, before, after):
    names = {name: f"{before}{name}{after}" for name in ("stiffness", "damping", "erp", "cfm")}
    world, joint = joined(cls, where, **{names["stiffness"]: 50.0})
    assert getattr(joint, names["erp"]) == 1.0
    setattr(joint, names["stiffness"], None)
    assert (getattr(joint, names["erp"]), getattr(joint, names["cfm"])) == (world.erp, world.cfm)
    world.erp = 0.55
    assert getattr(joint, names["erp"]) == 0.55


@each_place
def test_a_spring_beside_its_erp_or_cfm_is_refused(cls, where, before, after):
    """Whichever comes first, with both names in the message; nothing is changed."""
    names = {name: f"{before}{name}{after}" for name in ("stiffness", "damping", "erp", "cfm")}
    _, joint = joined(cls, where, **{names["erp"]: 0.3})
    with pytest.raises(oo.FieldError, match=rf"{names['erp']} is 0\.3 beside {names['stiffness']} and"):
        setattr(joint, names["stiffness"], 10.0)
    assert (getattr(joint, names["stiffness"]), getattr(joint, names["erp"])) == (None, 0.3)
    setattr(joint, names["erp"], None)
    setattr(joint, names["damping"], 10.0)
    with pytest.raises(oo.FieldError, match=rf"{names['cfm']} is 0\.01 beside"):
        setattr(joint, names["cfm"], 0.01)
    assert getattr(joint, names["cfm"]) == pytest.approx(0.1)
    with pytest.raises(oo.FieldError, match="both 0; one of them must be above 0"):
        setattr(joint, names["damping"], 0.0)
    assert getattr(joint, names["damping"]) == 10.0


def test_a_double_ball_spring_pushes_when_it_is_pressed_and_rests_at_its_distance():
    """Between two bodies: the reduced mass swings about ``distance``, by implicit Euler, to 1e-6 m."""
    h = 1 / 240
    world = oo.World(gravity=(0, 0, 0), step_size=h, solver="exact")
    a, b = heavy(world), heavy(world, mass=3.0, position=(1, 0, 0))
    joint = oo.DoubleBall(a, b, distance=1.3, stiffness=STIFFNESS, damping=DAMPING)
    assert (joint.length, joint.target_distance, joint.error) == pytest.approx((1.0, 1.3, 0.3))
    reduced = 1 / (1 / MASS + 1 / 3.0)
    expected = implicit_euler(-0.3, 0.0, force=0.0, h=h, mass=reduced)
    for _, (x, _) in zip(range(480), expected, strict=False):
        world.step()
        assert joint.length - 1.3 == pytest.approx(x, abs=1e-6)
    joint.distance = 0.8
    world.run(10.0)
    assert joint.length == pytest.approx(0.8, abs=1e-4)


def test_setting_a_spring_wakes_the_bodies():
    world = oo.World(gravity=(0, 0, 0), auto_disable=True)
    body = heavy(world)
    joint = oo.Ball(body, stiffness=10.0)
    world.run(3)
    assert not body.enabled
    joint.stiffness = 20.0
    assert body.enabled


@each_place
def test_a_spring_of_nothing_is_refused_from_the_start(cls, where, before, after):
    """Both 0 as arguments; the bodies have no joint then."""
    fields = {f"{before}stiffness{after}": 0.0, f"{before}damping{after}": 0.0}
    world = oo.World()
    bodies = [world.attach(oo.Body()), world.attach(oo.Body(position=(1, 0, 0)))]
    with pytest.raises(oo.FieldError, match="both 0; one of them must be above 0"):
        cls(*bodies[: max(cls.BODIES)], **where, **fields)
    assert not world.joints
    assert not bodies[0].joints
