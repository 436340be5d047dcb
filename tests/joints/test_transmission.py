"""Transmissions: how fast the second wheel turns, by where the teeth meet, whichever way the axes are given."""

import itertools
import math

import pytest

import osgode as oo

X, Y, Z = oo.Vec3(1, 0, 0), oo.Vec3(0, 1, 0), oo.Vec3(0, 0, 1)


def drive(anchor1, anchor2, axis1, axis2, **fields):
    """Two wheels on hinges, the first of which is driven at 1 rad/s for 2 s."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    first, second = world.attach(oo.Body(position=anchor1)), world.attach(oo.Body(position=anchor2))
    hinge = oo.Hinge(first, axis=axis1, motor_velocity=1.0, motor_max_force=1e3)
    other = oo.Hinge(second, axis=axis2)
    gear = oo.Transmission(first, second, axis1=axis1, axis2=axis2, name="it", **fields)
    world.run(2.0)
    assert hinge.angle_rate == pytest.approx(1.0, abs=1e-6)
    return world, gear, other


def bevel(cone1, cone2, slant=1.0):
    """Anchors and outward axes of two bevel gears, whose cones of these half angles touch at the world's origin."""
    apex = -Y * slant
    axes = Y * math.cos(cone1) + X * math.sin(cone1), Y * math.cos(cone2) - X * math.sin(cone2)
    return [apex + axis * (slant * math.cos(cone)) for axis, cone in zip(axes, (cone1, cone2), strict=True)], axes


@pytest.mark.parametrize(("d1", "d2"), list(itertools.product((1, -1), repeat=2)))
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("cones", [(math.atan(2), math.atan(0.5)), (math.pi / 4, math.pi / 4), (0.6, 0.3), (0.3, 0.9)])
def test_bevel_gears_move_as_one_where_their_teeth_meet(cones, side, d1, d2):
    """There the velocities of both are the same, and stay so, to 1e-3; radii are slant * sin(half angle)."""
    anchors, axes = bevel(*(side * cone for cone in cones))
    world, gear, other = drive(*anchors, axes[0] * d1, axes[1] * d2, mode="intersecting")
    radii = [math.sin(cone) for cone in cones]
    assert gear.radii == pytest.approx(radii, rel=1e-9)
    for _ in range(3):
        teeth = [body.velocity_at((0, 0, 0)) for body in (gear.body1, gear.body2)]
        assert teeth[0].length == pytest.approx(radii[0], rel=1e-3)
        assert teeth[0] == pytest.approx(teeth[1], abs=1e-3)
        assert gear.angle_rate1 == pytest.approx(1.0, abs=1e-5)
        assert gear.angle_rate2 == pytest.approx(other.angle_rate, abs=1e-5)
        assert gear.error < 1e-3
        world.run(5.0)


GEARS = [({"mode": "parallel", "ratio": 2.0}, -2.0), ({"mode": "parallel", "ratio": 0.25}, -0.25)]
SPROCKETS = [
    ({"mode": "chain", "radius1": 0.4, "radius2": 0.1}, 4.0),
    ({"mode": "chain", "radius1": 0.1, "radius2": 0.2}, 0.5),
    ({"mode": "chain", "radius1": 0.2, "radius2": 0.2}, 1.0),
]
ANYWHERE = [(X, Z), (-X, Z), (Y * 0.7, Z), (oo.Vec3(0.6, 0.8, 0), Z), (oo.Vec3(2, 1, -2), oo.Vec3(1, 2, 2) / 3)]
WHERE_ODE_DOES_CHAINS = [(X, Z), (-X, Z), (X, Y), (-Z, Y), (oo.Vec3(0.6, 0, 0.8), Y), (Y, X), (-Y, X)]


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(
    ("fields", "times", "second", "axis"),
    [
        *((*gear, *place) for gear, place in itertools.product(GEARS, ANYWHERE)),
        *((*chain, *place) for chain, place in itertools.product(SPROCKETS, WHERE_ODE_DOES_CHAINS)),
    ],
    ids=str,
)
def test_gears_turn_the_other_way_and_sprockets_the_same(fields, times, second, axis, way):
    world, gear, other = drive((0, 0, 0), second, axis * way, axis * way, **fields)
    for _ in range(2):
        assert other.angle_rate == pytest.approx(times, rel=1e-4)
        assert gear.angle_rate1 == pytest.approx(1.0, abs=1e-6)
        assert gear.angle_rate2 == pytest.approx(other.angle_rate, abs=1e-6)
        assert gear.error < 1e-4
        world.run(3.0)


@pytest.mark.parametrize("live", [True, False])
def test_a_chain_where_ode_gets_the_ratio_wrong_is_refused(live):
    """At once, when it is anchored anew, and when its radii change; nothing changes then."""
    world, first, second = oo.World(), oo.Body(), oo.Body(position=(0, 0.7, 0))
    if live:
        world.attach(first)
        world.attach(second)
    chain = {"mode": "chain", "radius1": 0.4, "radius2": 0.1, "name": "it"}
    with pytest.raises(
        oo.FieldError, match=r"Transmission 'it'\.axis1 is \(0.0, 0.0, 1.0\).*; ODE does chains about y"
    ):
        oo.Transmission(first, second, axis1=Z, **chain)
    assert first.joints == ()
    joint = oo.Transmission(first, second, axis1=X, **chain)
    with pytest.raises(oo.FieldError, match="ODE does chains"):
        joint.anchor_anew(axis1=Z, axis2=Z)
    assert joint.axis1 == X
    even = oo.Transmission(first, second, axis1=Z, mode="chain", radius1=0.2, radius2=0.2)
    with pytest.raises(oo.FieldError, match="ODE does chains"):
        even.radius1 = 0.3
    assert even.radius1 == 0.2


@pytest.mark.parametrize(
    "fields",
    [
        {"mode": "parallel", "ratio": 2.0},
        {"mode": "chain", "radius1": 0.4, "radius2": 0.1},
        {"mode": "intersecting", "axis2": X},
    ],
    ids=lambda fields: fields["mode"],
)
def test_angles_grow_at_their_rates_beyond_half_a_turn(fields):
    """By rate times time, between two moments at constant speed."""
    fields = dict(fields)
    axis2 = fields.pop("axis2", Z)
    second = oo.Vec3(1, 0, 0) if axis2 is Z else oo.Vec3(0.8, 0, 0.4)
    world, gear, _ = drive((0, 0, 0), second, Z, axis2, **fields)
    before = gear.angle1, gear.angle2
    world.run(6.0)
    assert gear.angle1 - before[0] == pytest.approx(6.0, rel=1e-3)
    assert gear.angle2 - before[1] == pytest.approx(6.0 * gear.angle_rate2, rel=1e-3)
    assert gear.angle1 > 2 * math.pi


def test_bevel_gears_at_more_than_a_right_angle_are_refused():
    """ODE would turn one of the axes round and correct the error of the teeth the wrong way."""
    first, second = oo.Body(), oo.Body(position=(0.8, 0, 0.4))
    for axis2 in ((1, 0, 0.01), (-1, 0, -0.01)):
        with pytest.raises(oo.FieldError, match=r"Transmission 'it'\.axis2 is .* degrees to axis1"):
            oo.Transmission(first, second, axis1=Z, axis2=axis2, mode="intersecting", name="it")
    assert first.joints == ()
    oo.Transmission(first, second, axis1=Z, axis2=(1, 0, -0.01), mode="intersecting")


def test_contact_points_are_where_the_teeth_meet():
    """On the line between the anchors, in the relation of the radii; they are known after the first step."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    first, second = world.attach(oo.Body()), world.attach(oo.Body(position=(3, 0, 0)))
    gear = oo.Transmission(first, second, axis1=Z, ratio=2.0, name="it")
    with pytest.raises(oo.StateError, match=r"Transmission 'it'\.contact_points"):
        _ = gear.contact_points
    assert (gear.angle1, gear.angle2, gear.error) == (0.0, 0.0, 0.0)
    world.step()
    for point in gear.contact_points:
        assert point == pytest.approx((2, 0, 0), abs=1e-9)
    assert gear.radii == pytest.approx((2.0, 1.0), rel=1e-12)


def test_backlash_lets_the_first_wheel_turn_alone():
    """By backlash / radius, within which the second wheel stays where it is."""
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    first, second = world.attach(oo.Body()), world.attach(oo.Body(position=(2, 0, 0)))
    hinge, other = oo.Hinge(first, axis=Z, motor_velocity=0.5, motor_max_force=1e3), oo.Hinge(second, axis=Z)
    gear = oo.Transmission(first, second, axis1=Z, backlash=0.1)
    while hinge.angle < 0.09:
        assert other.angle == pytest.approx(0.0, abs=1e-9)
        world.step()
    for _ in range(4):
        world.run(0.5)
        assert abs(hinge.angle + other.angle) <= 0.1 + 1e-3
        assert gear.error < 1e-3
    assert other.angle < -0.8
