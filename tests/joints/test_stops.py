"""Stops of every axis of every kind that has them: holding, bouncing, taken away and set, and motors at them."""

import math

import pytest

import osgode as oo
from tests.joints.drives import STOPPED, Rig, cases
from tests.joints.moves import E1, turning

each_stopped = pytest.mark.parametrize(("drive", "count"), cases(STOPPED), ids=str)
each_solver = pytest.mark.parametrize("solver", ["quick", "exact"])
each_way = pytest.mark.parametrize("way", [1, -1], ids=["high", "low"])

FORCE = 2.0
LOW, HIGH = -0.3, 0.2


def end(way):
    return HIGH if way > 0 else LOW


@each_solver
@each_way
@each_stopped
def test_a_motor_runs_into_each_stop_and_is_held_there(drive, count, way, solver):
    """The other axes stay where they are, and nothing creeps, though the motor pushes on."""
    rig = Rig(drive, count, solver=solver, stops=(LOW, HIGH), motor_velocity=1.5 * way, motor_max_force=FORCE)
    rig.world.run(1.5)
    assert rig.coordinate == pytest.approx(end(way), abs=1e-4)
    rig.world.run(0.5)
    assert rig.coordinate == pytest.approx(end(way), abs=1e-6)
    assert rig.rate == pytest.approx(0.0, abs=1e-5)
    rig.set(motor_velocity=-1.5 * way)
    rig.world.run(2.0)
    assert rig.coordinate == pytest.approx(end(-way), abs=1e-4)


@each_way
@each_stopped
def test_a_stop_holds_against_a_load_but_not_the_other_way(drive, count, way):
    rig = Rig(drive, count, stops=(LOW, HIGH))
    for _ in range(300):
        rig.push(way * 3.0)
        rig.world.step()
    assert rig.coordinate == pytest.approx(end(way), abs=1e-6)
    rig.push(-way * 3.0)
    rig.world.step()
    assert rig.rate == pytest.approx(-way * 3.0 * rig.world.step_size / rig.inertia(), rel=1e-4)


@each_solver
@each_way
@each_stopped
@pytest.mark.parametrize("bounce", [0.25, 1.0])
def test_a_stop_gives_back_its_share_of_the_speed(drive, count, way, bounce, solver):
    """Having met it at v it leaves at e v, to 1e-5, as fast as before where e is 1."""
    rig = Rig(drive, count, solver=solver, stops=(LOW, HIGH), stop_bounce=bounce)
    rig.kick(0.8 * way)
    while way * rig.rate > 0:
        assert rig.rate == pytest.approx(0.8 * way, rel=1e-6)
        rig.world.step()
        assert rig.world.steps < 200
    assert rig.rate == pytest.approx(-bounce * 0.8 * way, rel=1e-5)


@each_solver
@each_way
@each_stopped
def test_without_bounce_no_more_comes_back_than_the_error_that_is_corrected(drive, count, way, solver):
    """It meets the stop up to one step too late, v h behind it; ERP of that comes back in a step, so up to ERP v."""
    rig = Rig(drive, count, solver=solver, stops=(LOW, HIGH), stop_erp=0.2)
    rig.kick(0.8 * way)
    rig.world.run(0.5)
    assert -0.2 * 0.8 - 1e-6 <= rig.rate * way <= 1e-6
    soft = Rig(drive, count, solver=solver, stops=(LOW, HIGH), stop_erp=0.0)
    soft.kick(0.8 * way)
    soft.world.run(0.5)
    assert soft.rate == pytest.approx(0.0, abs=1e-5)
    assert 0 <= (soft.coordinate - end(way)) * way <= 0.8 * soft.world.step_size + 1e-6


@each_way
@each_stopped
def test_stops_taken_away_while_it_is_at_them_let_it_go_on(drive, count, way):
    rig = Rig(drive, count, stops=(LOW, HIGH))
    for _ in range(400):
        rig.push(way * FORCE)
        rig.world.step()
    rig.set(stops=None)
    for _ in range(10):
        rig.push(way * FORCE)
        rig.world.step()
    assert rig.rate == pytest.approx(way * FORCE * 10 * rig.world.step_size / rig.inertia(), rel=1e-3)


@each_way
@each_stopped
def test_stops_set_behind_it_pull_it_back_in(drive, count, way):
    """By ERP of the way in the first step, towards the nearer stop; to 0.3 %, as ODE turns by a chord in a step."""
    rig = Rig(drive, count, stop_erp=0.5)
    rig.kick(way)
    rig.world.run(0.5)
    rig.kick(-way)
    before = rig.coordinate
    assert before == pytest.approx(way * 0.5, abs=1e-5)
    rig.set(stops=(LOW, HIGH))
    rig.world.step()
    assert rig.coordinate - end(way) == pytest.approx(0.5 * (before - end(way)), rel=3e-3)


@each_way
@each_stopped
def test_equal_stops_hold_it_fast_both_ways(drive, count, way):
    """A motor has no effect there, and no load moves it; ODE ignores motors between equal stops."""
    rig = Rig(drive, count, stops=(0.1, 0.1), motor_velocity=way, motor_max_force=FORCE)
    rig.world.step(100)
    for load in (5.0, -5.0):
        for _ in range(20):
            rig.push(load)
            rig.world.step()
        assert rig.coordinate == pytest.approx(0.1, abs=1e-6)


@each_way
@each_stopped
@pytest.mark.parametrize("fudge", [1.0, 0.25, 0.0])
def test_leaving_a_stop_a_motor_has_the_fudge_factor_of_its_force(drive, count, way, fudge):
    """The first step away from the stop: fudge force h / inertia."""
    rig = Rig(drive, count, stops=(LOW, HIGH), fudge_factor=fudge, motor_velocity=2.0 * way, motor_max_force=FORCE)
    rig.world.run(1.5)
    assert rig.coordinate == pytest.approx(end(way), abs=1e-9)
    here = rig.coordinate - 1e-9 * way  # at it, and not a rounding inside
    rig.set(stops=(LOW, here) if way > 0 else (here, HIGH))
    rig.set(motor_velocity=-2.0 * way)
    rig.world.step()
    expected = -way * fudge * FORCE * rig.world.step_size / rig.inertia()
    assert rig.rate == pytest.approx(expected, rel=1e-5, abs=1e-6)


@each_stopped
def test_stop_erp_and_cfm_are_used_at_the_stop_only(drive, count):
    """A soft stop yields by what ODE's equation says: (1 / h) ERP x + CFM f = 0 in rest, so x = f h CFM / ERP."""
    rig = Rig(drive, count, stops=(LOW, HIGH), stop_erp=0.4, stop_cfm=0.01)
    for _ in range(2000):
        rig.push(FORCE)
        rig.world.step()
    assert rig.coordinate - HIGH == pytest.approx(FORCE * rig.world.step_size * 0.01 / 0.4, rel=1e-4)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)], ids=["a, b", "b, a"])
@each_way
def test_stops_are_of_body1_whichever_is_first(order, way):
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    bodies = [world.attach(oo.Body()) for _ in range(2)]
    for body in bodies:
        body.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    first, second = (bodies[i] for i in order)
    hinge = oo.Hinge(first, second, axis=E1, stops=(LOW, HIGH))
    for _ in range(300):
        hinge.add_torque(0.2 * way)
        world.step()
    assert hinge.angle == pytest.approx(end(way), abs=1e-6)
    turned = first.rotation * second.rotation.conjugate()
    assert oo.Vec3(*turned[1:]).dot(E1) == pytest.approx(math.sin(end(way) / 2), abs=1e-6)


def test_a_user_motor_stops_at_the_angles_that_it_is_told():
    """The mode "user" knows no angles: told them before each step, its stops hold as a hinge's do."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    body = world.attach(oo.Body())
    body.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    joint = oo.AngularMotor(body, axes=[E1], stops1=(-1.0, 0.5))
    for torque, stop in ((0.3, 0.5), (-0.3, -1.0)):
        for _ in range(400):
            turned = 2 * math.atan2(oo.Vec3(*body.rotation[1:]).dot(E1), body.rotation.w)
            joint.user_angle1 = turned
            assert joint.angle1 == turned
            joint.add_torques(torque)
            world.step()
        assert turned == pytest.approx(stop, abs=1e-6)


@pytest.mark.parametrize("cls", [oo.Universal, oo.PU])
def test_stops_of_one_arm_of_a_cross_hold_while_the_other_is_turned(cls):
    """axis2 is turned by 0.6 first, so that body1's axis1 has turned with it."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    body = world.attach(oo.Body())
    body.fixed_mass = oo.Mass.sphere(0.5, mass=2)
    joint = cls(body, axis1=(1, 0, 0), axis2=(0, 1, 0), stops1=(LOW, HIGH), stops2=(0.0, 0.6))
    body.rotation = turning(0.6, (0, 1, 0)).rotation
    body.position = (0, 0, 0)
    assert joint.angle2 == pytest.approx(0.6, abs=1e-9)
    joint.motor(1.0, 5.0, axis=1)
    joint.motor(1.0, 5.0, axis=2)
    world.run(1.0)
    assert (joint.angle1, joint.angle2) == pytest.approx((HIGH, 0.6), abs=1e-4)
    joint.motor_velocity1 = -1.0
    world.run(1.0)
    assert (joint.angle1, joint.angle2) == pytest.approx((LOW, 0.6), abs=1e-4)
