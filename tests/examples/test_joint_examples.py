"""What the examples of joints show, against figures of their own: the formulas that a reader would look for."""

import math
from itertools import pairwise

import pytest

import osgode as oo
from osgode.examples import (
    arm,
    bridge,
    cardan,
    engine,
    galton,
    gate,
    gears,
    locomotive,
    mobile,
    springs,
    suspension,
    tensegrity,
    waiter,
)

G = 9.81


def run(kind, seconds):
    example = kind()
    example.advance(round(seconds / example.world.step_size))
    return example


def test_the_mobile_is_hung_up_by_the_law_of_the_lever():
    """About the point where it hangs the weights of each beam have no torque, all wires being upright at the start."""
    example = mobile.Mobile()
    joints = {id(joint.body1): joint for joint in example.world.joints}

    def load(body):
        """Mass of a body with all that hangs from it."""
        return body.mass + sum(load(joint.body1) for joint in body.joints if joint.body2 is body)

    for beam in example.beams:
        hook = joints[id(beam)].anchor
        hung = [(joint.anchor, load(joint.body1)) for joint in beam.joints if joint.body2 is beam]
        torque = sum((at.x - hook.x) * mass for at, mass in [*hung, (beam.world_centre_of_mass, beam.mass)])
        assert len(hung) == 2
        assert torque == pytest.approx(0, abs=1e-9)


def test_the_portcullis_rises_no_faster_than_the_servo_may():
    example, way = gate.Gate(), []
    for _ in range(round((gate.UP + 2.5) * 120)):
        example.advance(1)
        way.append(example.slider.position)
    speeds = [120 * (b - a) for a, b in pairwise(way)]
    assert max(speeds) == pytest.approx(1.0, abs=0.01)
    assert way[-1] == pytest.approx(gate.RAISED, abs=0.002)


def test_the_bent_shaft_turns_as_the_formula_of_the_universal_joint_says():
    """w2 / w1 = cos b / (1 - sin^2 b cos^2 a), with a = 0 where the arm of the driving shaft lies in the bend's plane.

    For the difference of the spins w2 d2 - w1 d1 must lie in the plane of the cross: at a = 0 its normal is d1, so that
    w1 = w2 cos b, and a quarter of a turn later it is d2. The plane of the bend here is that of x and y.
    """
    example, off = cardan.Cardan(), []
    example.advance(60)
    for _ in range(240):
        example.advance(1)
        along = example.middle.vector_to_world((0, 0, 1))
        ratio = example.middle.angular_velocity.dot(along) / example.motor.angular_velocity.x
        arm_of_it = example.world.joints[1].axis1
        angle = math.atan2(arm_of_it.z, arm_of_it.y)
        off.append(ratio - math.cos(example.bend) / (1 - (math.sin(example.bend) * math.cos(angle)) ** 2))
    assert max(map(abs, off)) < 0.005


def test_the_cart_sinks_by_its_weight_over_its_springs():
    example = run(suspension.Suspension, 0.83)
    sunk = [wheel.compression for wheel in example.wheels]
    assert sum(sunk) / 4 == pytest.approx(suspension.CHASSIS * G / 4 / suspension.STIFFNESS, rel=0.01)


def test_the_bridge_bears_by_statics_what_a_beam_does_that_is_held_at_both_ends():
    """The banks carry its weight, and the torques at its ends, on average, and in its middle add up to w L / 8.

    How much of that is at the ends depends on how it gives way.
    """
    example = bridge.Bridge()
    for body in (example.light, example.heavy):
        example.moving.detach(body)
    example.world.iterations = 400
    example.world.run(seconds=0.5)
    left, *_, right = example.world.joints
    (middle,) = (joint for joint in example.world.joints if abs(joint.anchor.x) < 0.01)
    weight, length = bridge.PLANKS * bridge.MASS * G, bridge.PLANKS * bridge.LONG
    assert left.reaction.force1.y + right.reaction.force1.y == pytest.approx(weight, rel=0.01)
    ends = (abs(left.reaction.torque.z) + abs(right.reaction.torque.z)) / 2
    assert ends + abs(middle.reaction.torque.z) == pytest.approx(weight * length / 8, rel=0.01)


def test_the_tray_goes_round_in_its_circle():
    """After t seconds, of which the first is for speeding up, it has gone the way that its velocities add up to."""
    example = run(waiter.Waiter, 5.0)
    omega, h = math.tau / waiter.LAP, 1 / 120
    x, z = waiter.CIRCLE, 0.0
    for k in range(600):
        speed = omega * waiter.CIRCLE * min(k * h, 1.0)
        x, z = x - h * speed * math.sin(omega * k * h), z - h * speed * math.cos(omega * k * h)
    assert tuple(example.tray.position) == pytest.approx((x, waiter.HIGH, z), abs=0.01)
    turned = math.remainder(waiter.TURN * 5.0, math.tau)  # less one step, in which the motor had not yet acted
    assert example.upright.angle1 == pytest.approx(turned, abs=0.02)


def test_the_piston_goes_by_twice_the_crank():
    example, heights = engine.Engine(), []
    for _ in range(round(math.tau / engine.SPEED * 120) + 60):
        example.advance(1)
        heights.append(example.piston.position.y)
    assert max(heights) - min(heights) == pytest.approx(2 * engine.CRANK, abs=0.005)


def test_the_arm_returns_quickly():
    """Its turns back take (90 deg - b) / (90 deg + b) of the time of those forth, where sin b = crank / pivot."""
    example, rates = engine.Engine(), []
    for _ in range(round(2 * math.tau / engine.SPEED * 120)):
        example.advance(1)
        rates.append(example.pivot.angle_rate)
    rates = rates[-round(math.tau / engine.SPEED * 120) :]
    back = math.asin(engine.CRANK / engine.PIVOT)
    slow = sum(rate > 0 for rate in rates) / len(rates)
    assert slow == pytest.approx(0.5 + back / math.pi, abs=0.02)


def test_no_ball_leaves_the_plane_though_each_is_spun_out_of_it():
    example = run(galton.Galton, 2.0)
    for ball in example.balls[:10]:
        assert abs(ball.position.z) < 1e-9
        assert math.hypot(ball.angular_velocity.x, ball.angular_velocity.y) < 1e-6


def test_the_cables_carry_the_struts():
    """The forces of the cables on a strut that stands still add up to its weight, but for what the ground carries."""
    example = run(tensegrity.Tensegrity, 5.0)
    for joint in example.world.joints:
        joint.feedback = True
    example.advance(1)
    up = 0.0
    for strut in example.struts:
        for joint in strut.joints:
            up += joint.reaction.force1.y if joint.body1 is strut else joint.reaction.force2.y
    assert up == pytest.approx(0, abs=1e-6)  # between struts: what lifts one weighs on another
    for joint in example.world.joints:
        way = (joint.anchor2 - joint.anchor1).normalized()
        pull = joint.reaction.force1.dot(way)
        stretched = joint.length - joint.target_distance
        assert pull == pytest.approx(tensegrity.STIFFNESS * stretched, rel=0.02)
        assert pull > 0


def test_the_wheels_of_the_locomotive_turn_together_from_the_start():
    example = run(locomotive.Locomotive, 2.0)
    angles = [math.atan2(*axle.vector_to_world((1, 0, 0))[1::-1]) for axle in example.axles]
    assert angles[0] == pytest.approx(angles[1], abs=0.005)
    assert angles[2] == pytest.approx(angles[1], abs=0.005)


def test_the_gears_turn_by_the_speeds_of_their_rims():
    example = run(gears.Gears, 2.0)
    first, second, third, fourth = example.rates()
    assert first * gears.BIG == pytest.approx(-second * gears.SMALL, abs=0.005)
    assert second * gears.SPROCKET == pytest.approx(third * gears.DRIVEN, abs=0.005)
    assert abs(third) == pytest.approx(abs(fourth), abs=0.005)  # both wheels of the bevel gears are of one size
    # Where the bevel wheels meet, both rims move the same way.
    at = example.joints[2].contact_points[0]
    assert tuple(example.third.velocity_at(at)) == pytest.approx(tuple(example.fourth.velocity_at(at)), abs=0.01)


def test_five_springs_of_one_stiffness_sink_alike():
    example = run(springs.Springs, 5.0)
    for weight in example.weights:
        assert springs.START - weight.position.y == pytest.approx(springs.MASS * G / springs.STIFFNESS, rel=0.01)


def test_the_hand_is_where_its_servos_angles_have_it():
    """Forward from the joints' angles by two rotations in a plane that the column turns."""
    example = run(arm.Arm, 3.0)
    column, shoulder, elbow = (joint.angle for joint in example.joints)
    out = arm.UPPER * math.cos(shoulder) + arm.LOWER * math.cos(shoulder + elbow)
    up = arm.SHOULDER + arm.UPPER * math.sin(shoulder) + arm.LOWER * math.sin(shoulder + elbow)
    expected = oo.Vec3(out * math.cos(column), up, -out * math.sin(column))
    assert tuple(example.wrist()) == pytest.approx(tuple(expected), abs=0.005)
    assert example.gripper.is_live
