"""Gears, bevel gears and chains: how fast and which way round, wherever they stand, and how far they count."""

import math

import pytest

import osgode as oo

H = 1 / 500
PLACES = [(0, 0, 0), (-40, 7, -13)]
each_place = pytest.mark.parametrize("at", PLACES, ids=str)
each_way = pytest.mark.parametrize("way", [1, -1], ids=["forwards", "backwards"])


class Gears:
    """Two wheels on axles in the static world, the first of them driven."""

    def __init__(self, at, apart, axis1, axis2, *, turn=oo.maths.IDENTITY, h=H, loaded=0.0, **fields):
        self.world = oo.World(gravity=(0, 0, 0), solver="exact", step_size=h)
        self.axes = [turn.rotate(axis1), turn.rotate(axis2)]
        self.at = [oo.Vec3(*at), oo.Vec3(*at) + turn.rotate(apart)]
        self.wheels, self.axles = [], []
        for middle, axis in zip(self.at, self.axes, strict=True):
            wheel = self.world.attach(oo.Body(position=middle))
            wheel.fixed_mass = oo.Mass.sphere(0.3, mass=2)
            self.wheels.append(wheel)
            self.axles.append(oo.Hinge(wheel, axis=axis))
        self.gear = oo.Transmission(*self.wheels, axis1=self.axes[0], axis2=self.axes[1], **fields)
        self.loaded = loaded

    def drive(self, speed, seconds):
        self.axles[0].motor(speed, 1e4)
        self.turned = [0.0, 0.0]
        for _ in range(round(seconds / self.world.step_size)):
            self.axles[1].add_torque(self.loaded)
            self.world.step()
            for i, axle in enumerate(self.axles):
                self.turned[i] += axle.angle_rate * self.world.step_size

    def check(self, speed, ratio, near=1e-3):
        """The second wheel has turned by ``ratio`` times the first, and turns so; as the joint reads it too."""
        assert self.turned[1] == pytest.approx(ratio * self.turned[0], rel=near)
        assert self.axles[1].angle_rate == pytest.approx(ratio * speed, rel=10 * near)
        gear = self.gear
        assert (gear.angle_rate1, gear.angle_rate2) == pytest.approx([axle.angle_rate for axle in self.axles], rel=1e-4)
        assert (gear.angle1, gear.angle2) == pytest.approx(self.turned, rel=1e-3)


TURNS = [oo.maths.IDENTITY, oo.Quat.from_axis_angle((1, 2, -1), 0.9), oo.Quat.from_axis_angle((0, 0, 1), math.pi / 2)]
each_turn = pytest.mark.parametrize("turn", TURNS, ids=["straight", "oblique", "right"])


@each_turn
@each_place
@each_way
@pytest.mark.parametrize("ratio", [1.0, 2.0, 0.4])
def test_spur_gears_turn_the_other_way_round_by_their_ratio(at, way, ratio, turn):
    """At the teeth both go the same way: w2 = -(radius1 / radius2) w1."""
    gears = Gears(at, (1, 0, 0), (0, 0, 1), (0, 0, 1), ratio=ratio, turn=turn)
    gears.drive(way * 2.0, 0.6)
    gears.check(way * 2.0, -ratio)
    assert gears.gear.radii == pytest.approx((ratio / (1 + ratio), 1 / (1 + ratio)))
    assert gears.gear.error < 1e-5
    teeth = gears.at[0] + (gears.at[1] - gears.at[0]) * (ratio / (1 + ratio))
    for point in gears.gear.contact_points:
        assert point == pytest.approx(teeth, abs=1e-4)


BEVELS = [(x, z, first, second) for x in (1, -2) for z in (1, -0.5) for first in (1, -1) for second in (1, -1)]


@each_turn
@each_place
@pytest.mark.parametrize(("x", "z", "first", "second"), BEVELS)
def test_bevel_gears_turn_so_that_their_teeth_move_together(at, turn, x, z, first, second):  # noqa: PLR0917
    """However the axes point, and wherever the second wheel is: the teeth touch where both planes meet.

    Wheel 1 lies at 0 across z, wheel 2 at (x, 0, z) across x. They meet at (x, 0, 0), at arms of (x, 0, 0) and
    (0, 0, -z), where wheel 1 moves at w1 first x along y, and wheel 2 at w2 second z along y.
    """
    gears = Gears(at, (x, 0, z), (0, 0, first), (second, 0, 0), mode="intersecting", turn=turn)
    gears.drive(2.0, 0.3)
    gears.check(2.0, (first * x) / (second * z))
    assert gears.gear.error < 1e-3
    assert gears.gear.radii == pytest.approx((abs(x), abs(z)))
    for point in gears.gear.contact_points:
        assert point == pytest.approx(gears.at[0] + turn.rotate((x, 0, 0)), abs=1e-4)


@each_place
@each_way
@pytest.mark.parametrize("loaded", [0.0, 0.5, -0.5])
@pytest.mark.parametrize(("radius1", "radius2"), [(0.2, 0.1), (0.1, 0.1), (0.15, 0.3)])
@pytest.mark.parametrize(
    ("apart", "axis"), [((1, 0, 0), (0, 1, 0)), ((0.6, 0, 0.8), (0, 1, 0)), ((0, 1, 0), (1, 0, 0))], ids=str
)
def test_chains_turn_the_same_way_round_by_their_radii(at, way, loaded, radius1, radius2, apart, axis):  # noqa: PLR0917
    """w2 = (radius1 / radius2) w1, whichever side of the chain pulls, also far from the origin of the world."""
    gears = Gears(at, apart, axis, axis, mode="chain", radius1=radius1, radius2=radius2, loaded=loaded)
    gears.drive(way * 2.0, 0.6)
    gears.check(way * 2.0, radius1 / radius2, near=5e-3)


def test_a_chain_where_odes_does_not_pull_is_refused():
    with pytest.raises(oo.FieldError, match=r"Transmission\.axis1 is .*ODE's chain can't pull; it must be another"):
        Gears((0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 0, 0), mode="chain", radius1=0.1, radius2=0.1)


@pytest.mark.parametrize("angle", [1.2, 2.0])
def test_bevel_gears_at_another_angle_are_refused(angle):
    axis2 = (math.sin(angle), 0, math.cos(angle))
    with pytest.raises(oo.FieldError, match=r"Transmission\.axis2 is .*degrees to axis1.*right angle"):
        Gears((0, 0, 0), (1, 0, 1), (0, 0, 1), axis2, mode="intersecting")


def test_a_gear_on_a_turning_frame_counts_against_the_frame():
    """Sun and planet on an arm that turns with everything at 1 rad/s: nothing turns against the arm."""
    world = oo.World(gravity=(0, 0, 0), solver="exact", step_size=H)
    arm = world.attach(oo.Body(kinematic=True))
    wheels = [world.attach(oo.Body(position=(x, 0, 0))) for x in (0, 1)]
    for wheel in wheels:
        wheel.fixed_mass = oo.Mass.sphere(0.3, mass=2)
        oo.Hinge(wheel, arm, axis=(0, 0, 1))
    gear = oo.Transmission(*wheels, ratio=1.0)
    world.step()
    arm.angular_velocity = (0, 0, 1)
    for wheel in wheels:
        wheel.angular_velocity = (0, 0, 1)
    wheels[1].linear_velocity = (0, 1, 0)
    world.run(1.0)
    assert (gear.angle1, gear.angle2) == pytest.approx((0, 0), abs=2e-3)
    assert (gear.angle_rate1, gear.angle_rate2) == pytest.approx((0, 0), abs=2e-3)
    assert gear.error < 1e-3


@pytest.mark.parametrize("speed", [30.0, 180.0])
def test_fast_gears_turn_as_they_should(speed):
    """Up to a quarter of a turn (1.5 rad) in a step of 1/120 s."""
    gears = Gears((2, 1, 0), (1, 0, 0), (0, 0, 1), (0, 0, 1), ratio=0.5, h=1 / 120)
    for wheel in gears.wheels:
        wheel.max_angular_speed = math.inf
    gears.drive(speed, 1.0)
    assert gears.axles[0].angle_rate == pytest.approx(speed, rel=1e-3)
    chord = 2 * math.atan(speed / 120 / 2)  # by which ODE turns a body in a step
    assert gears.gear.angle1 == pytest.approx(120 * chord, rel=1e-2)
    assert gears.gear.angle2 == pytest.approx(-0.5 * gears.gear.angle1, rel=1e-2)


def test_backlash_is_played_through_before_the_second_wheel_is_pushed():
    """0.05 m at the teeth of wheels of 0.5 m: 0.1 rad, in which the second stands, and later may run free."""
    gears = Gears((0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 0, 1), backlash=0.05)
    gears.axles[0].motor(0.5, 1e4)
    while gears.axles[0].angle < 0.095:
        gears.world.step()
        assert gears.axles[1].angle_rate == 0.0
    gears.world.run(2.0)
    assert gears.axles[1].angle < -0.5
    assert abs(gears.axles[1].angle + gears.axles[0].angle) <= 0.1 + 1e-3


def test_angles_are_0_before_the_first_step_and_go_on_beyond_pi():
    gears = Gears((0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 0, 1))
    assert (gears.gear.angle1, gears.gear.angle2) == (0.0, 0.0)
    gears.drive(6.0, 2.0)
    assert gears.gear.angle1 == pytest.approx(12.0, rel=0.01)
    assert gears.gear.angle2 == pytest.approx(-12.0, rel=0.01)


def test_switched_off_it_lets_the_wheels_run_and_takes_them_up_where_they_stand():
    """A clutch: no jerk on what was turned meanwhile."""
    gears = Gears((0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 0, 1))
    gears.drive(2.0, 0.5)
    gears.gear.enabled = False
    gears.axles[1].motor(5.0, 1e4)
    gears.world.run(0.7)
    assert gears.axles[1].angle_rate == pytest.approx(5.0, rel=1e-3)
    gears.axles[1].motor(0.0, 0.0)
    gears.gear.enabled = True
    gears.drive(2.0, 0.5)
    assert gears.axles[1].angle_rate == pytest.approx(-2.0, rel=1e-3)
