"""What joints of every kind read after moves and turns: angles, positions, their rates, anchors and axes.

Each figure follows from the motion that was given to the bodies (`tests.joints.moves`). However the joint is attached
(first and second body, the other way round, or one of them to the static world), with centres of mass beside the
origins, and both bodies moving and turning through the world.
"""

import math

import pytest

import osgode as oo
from tests.joints.held import REST1, REST2, solid
from tests.joints.moves import (
    CASES,
    E1,
    E2,
    E3,
    END,
    POINT,
    STILL,
    Case,
    move,
    ride,
    shifting,
    turning,
    velocity,
)

ORDERS = ["a, b", "b, a", "a, None", "b, None"]
NEAR = 1e-9
NEAR_RATE = 1e-7
"""Of the velocities that the bodies are given, which are central differences."""

PLACES = [(0.0, 0.0, 0.0), (0.6, 0.4, 0.25), (-2.2, 1.1, -0.7), (1.4, -1.3, 2.5), (-0.3, -0.9, -2.8)]
RATES = (1.7, -0.6, 0.45)


class Stand:
    """A joint between two bodies, or a body and the static world, both moved by the motions of a case."""

    def __init__(self, case: Case, order: str, place=(0.0, 0.0, 0.0), rates=RATES, **fields):
        self.case, self.place, self.rates = case, place, rates
        self.world = oo.World(gravity=(0, 0, 0), solver="exact")
        self.space = self.world.attach(oo.SimpleSpace())
        a, b = self.space.attach(solid(REST1, "a")), self.space.attach(solid(REST2, "b"))
        self.body1, self.body2 = {"a, b": (a, b), "b, a": (b, a), "a, None": (a, None), "b, None": (b, None)}[order]
        self.rest1, self.rest2 = self.body1.pose, self.body2.pose if self.body2 else STILL
        self.joint = case.make(self.body1, self.body2, **fields)
        self.ride = ride if self.body2 else (lambda _t: STILL)
        self.go(0.0)

    def allowed(self, t):
        return self.case.allowed(*(q + rate * t for q, rate in zip(self.place, self.rates, strict=True)))

    def side1(self, t):
        return self.ride(t) if self.case.wheel else self.ride(t) * self.allowed(t)

    def side2(self, t):
        return self.ride(t) * self.allowed(t) if self.case.wheel else self.ride(t)

    def go(self, t):
        move(self.body1, self.rest1, self.side1, t)
        if self.body2:
            move(self.body2, self.rest2, self.side2, t)

    def check_spots(self):
        for name, side in self.case.carried.items():
            motion = (self.side1 if side == 1 else self.side2)(0.0)
            spot = self.case.where["anchor" if name == "anchor2" and "anchor" in self.case.where else name]
            if "anchor" in name:
                expected = motion.transform(spot)
            else:
                expected = motion.rotation.rotate(oo.Vec3(*spot).normalized())
            assert getattr(self.joint, name) == pytest.approx(expected, abs=NEAR), name

    def check(self):
        self.check_spots()
        assert self.joint.error == pytest.approx(0.0, abs=NEAR)
        assert self.joint.angular_error == pytest.approx(0.0, abs=1e-7)
        for (name, rate), q, speed in zip(self.case.coordinates, self.place, self.rates, strict=False):
            assert getattr(self.joint, name) == pytest.approx(q, abs=NEAR), name
            assert getattr(self.joint, rate) == pytest.approx(speed, abs=NEAR_RATE), rate


def everywhere(cases):
    return [(case, order) for case in cases for order in ORDERS if not (case.two and "None" in order)]


def within(case, place):
    """The same place, pulled in to where the coordinates tell it from others."""
    return tuple(math.copysign(min(abs(q), limit), q) for q, limit in zip(place, case.limits, strict=True))


each_attached = pytest.mark.parametrize(("case", "order"), everywhere(CASES), ids=str)
each_place = pytest.mark.parametrize("place", PLACES, ids=str)


@each_attached
@each_place
def test_every_kind_reads_where_its_bodies_are_and_how_fast_they_go(case, order, place):
    Stand(case, order, within(case, place)).check()


@each_attached
def test_a_rate_is_the_slope_of_its_coordinate(case, order):
    """Central differences of what the joint reads itself, at poses a millisecond before and after."""
    stand = Stand(case, order, within(case, PLACES[1]))
    h = 1e-4
    for name, rate in [*case.coordinates, *([("length", "length_rate")] if "Double" in case.name else [])]:
        stand.go(0.0)
        read = getattr(stand.joint, rate)
        stand.go(h)
        after = getattr(stand.joint, name)
        stand.go(-h)
        assert read == pytest.approx((after - getattr(stand.joint, name)) / (2 * h), abs=1e-5)


@each_attached
def test_it_reads_the_same_when_it_was_away(case, order):
    """Out of the World anchors and axes are still seen, coordinates are not; back in it all is as before."""
    stand = Stand(case, order, within(case, PLACES[1]))
    stand.world.detach(stand.space)
    assert not stand.joint.is_live
    stand.check_spots()
    for names in case.coordinates:
        for name in names:
            with pytest.raises(oo.StateError, match=rf"{name} needs the joint to be live"):
                getattr(stand.joint, name)
    stand.world.attach(stand.space)
    stand.check()


@each_attached
def test_it_reads_the_same_when_a_centre_of_mass_has_moved(case, order):
    stand = Stand(case, order, within(case, PLACES[1]))
    for body in (stand.body1, stand.body2):
        if body:
            body.attach(oo.Placeable(position=(0.5, 0.9, -1.5))).attach(oo.Sphere(0.4, mass=5))
    stand.check()
    stand.world.detach(stand.space)
    stand.check_spots()


@each_attached
@each_place
def test_made_out_of_the_world_and_moved_there_it_reads_the_same_inside(case, order, place):
    stand = Stand(case, order, within(case, place))
    stand.joint.release()
    stand.world.detach(stand.space)
    for body, rest in ((stand.body1, stand.rest1), (stand.body2, stand.rest2)):
        if body:
            body.rotation, body.position = rest.rotation, rest.position
    stand.joint = case.make(stand.body1, stand.body2)
    stand.go(0.0)
    stand.check_spots()
    stand.world.attach(stand.space)
    stand.check()


@each_attached
def test_anchored_anew_its_coordinates_count_from_there(case, order):
    """It is at 0 at once, with anchors and axes where they were; then it reads what is made from there."""
    place = (0.6, 0.0, 0.25) if case.cls is oo.AngularMotor else PLACES[1]  # its outer axes must be perpendicular
    stand = Stand(case, order, place)
    names = [name for name in case.carried if name != "anchor2" or "anchor" not in case.where]
    seen = {name: getattr(stand.joint, name) for name in names}
    stand.joint.anchor_anew()
    for name, value in seen.items():
        assert getattr(stand.joint, name) == pytest.approx(value, abs=NEAR)
    for name, _ in case.coordinates:
        assert getattr(stand.joint, name) == pytest.approx(0.0, abs=NEAR)


@each_attached
def test_what_it_allows_it_does_not_hinder(case, order):
    """After a short step of free motion along an allowed path the joint has changed the velocities by O(h) only.

    ODE's rows of the hinge-2 and the PU leave out that the sliding axis turns with body1, by the angular velocity times
    how far they have slid (see the documentation of `PU`): so these two start at 0.
    """
    free = {"suspension_damping": 1e-5} if case.cls is oo.Hinge2 else {}  # else it would be pressed back at once
    place = (0.6, 0.4, 0.0) if case.cls in (oo.PU, oo.Hinge2) else within(case, PLACES[1])
    stand = Stand(case, order, place, **free)
    stand.world.step_size = 1e-6
    bodies = [body for body in (stand.body1, stand.body2) if body]
    before = [(body.velocity_at(body.world_centre_of_mass), body.angular_velocity) for body in bodies]
    stand.world.step()
    for body, (v, w) in zip(bodies, before, strict=True):
        assert body.velocity_at(body.world_centre_of_mass) == pytest.approx(v, abs=3e-4)
        assert body.angular_velocity == pytest.approx(w, abs=3e-4)


# -- kinds whose readings are not coordinates of an allowed motion


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("relative", ["world", "body1", "body2"])
def test_an_angular_motor_reads_how_fast_body1_turns_about_each_axis(order, relative):
    """The difference of the angular velocities along the axes as they have been carried; angles are the user's."""
    case = Case("", oo.AngularMotor, {"axes": (E1, E2 * 2, (1, 0, 1)), "relative_to": relative}, free)
    stand = Stand(case, order, (0.6, 0.4, 0.25), user_angle1=0.5, user_angle3=-7.0)
    w = velocity(stand.side1, stand.rest1)[1] - velocity(stand.side2, stand.rest2)[1]
    carrier = {"world": STILL, "body1": stand.side1(0), "body2": stand.side2(0)}[relative].rotation
    axes = [carrier.rotate(axis) for axis in (E1, E2, oo.Vec3(1, 0, 1).normalized())]
    joint = stand.joint
    for seen, axis in zip(joint.axes, axes, strict=True):
        assert seen == pytest.approx(axis, abs=NEAR)
    rates = (joint.angle_rate1, joint.angle_rate2, joint.angle_rate3)
    assert rates == pytest.approx([w.dot(axis) for axis in axes], abs=NEAR_RATE)
    assert (joint.angle1, joint.angle2, joint.angle3) == (0.5, 0.0, -7.0)


def free(a, b, c):
    """Anything goes."""
    return shifting((a, -b, 2 * c)) * turning(a, E2) * turning(b, E3, END)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("relative", ["world", "body1", "body2"])
def test_a_linear_motor_reads_how_fast_the_centres_move_along_each_axis(order, relative):
    case = Case("", oo.LinearMotor, {"axes": (E1, E2 * 2, (1, 0, 1)), "relative_to": relative}, free)
    stand = Stand(case, order, (0.6, 0.4, 0.25))

    def of_centre(body, rest, motion):
        v, w = velocity(motion, rest)
        return v + w.cross(motion(0).rotation.rotate(rest.rotation.rotate(body.centre_of_mass)))

    v = of_centre(stand.body1, stand.rest1, stand.side1)
    if stand.body2:
        v -= of_centre(stand.body2, stand.rest2, stand.side2)
    carrier = {"world": STILL, "body1": stand.side1(0), "body2": stand.side2(0)}[relative].rotation
    axes = [carrier.rotate(axis) for axis in (E1, E2, oo.Vec3(1, 0, 1).normalized())]
    joint = stand.joint
    for seen, axis in zip(joint.axes, axes, strict=True):
        assert seen == pytest.approx(axis, abs=NEAR)
    assert (joint.rate1, joint.rate2, joint.rate3) == pytest.approx([v.dot(a) for a in axes], abs=NEAR_RATE)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("kind", [oo.DoubleBall, oo.DoubleHinge])
def test_a_rod_reads_its_length_when_it_is_stretched(order, kind):
    """How far the ends have come apart, and the slope of that."""
    where = {"anchor1": POINT, "anchor2": END} if kind is oo.DoubleBall else {"anchor1": END, "anchor2": END}
    where |= {} if kind is oo.DoubleBall else {"axis": E2}
    stand = Stand(Case("", kind, where, free), order, (0.6, 0.4, 0.25))

    def length(t):
        end1 = stand.side1(t).transform(where["anchor1"])
        return end1.distance(stand.side2(t).transform(where["anchor2"]))

    assert stand.joint.length == pytest.approx(length(0), abs=NEAR)
    assert stand.joint.length_rate == pytest.approx((length(1e-5) - length(-1e-5)) / 2e-5, abs=NEAR_RATE)
    assert stand.joint.error == pytest.approx(abs(length(0) - POINT.distance(END) * (kind is oo.DoubleBall)), abs=NEAR)


@pytest.mark.parametrize("order", ["a, b", "b, a"])
@pytest.mark.parametrize("where", [{"anchor": POINT}, {"anchor": POINT, "axis": E1}], ids=["Ball", "Hinge"])
def test_error_is_the_gap_between_the_two_sides_of_the_anchor(order, where):
    kind = oo.Hinge if "axis" in where else oo.Ball
    stand = Stand(Case("", kind, where, free), order, (0.6, 0.4, 0.25))
    one, other = stand.side1(0), stand.side2(0)
    assert stand.joint.error == pytest.approx(one.transform(POINT).distance(other.transform(POINT)), abs=NEAR)
    if kind is oo.Hinge:
        bend = math.acos(one.rotation.rotate(E1).dot(other.rotation.rotate(E1)))
        assert stand.joint.angular_error == pytest.approx(bend, abs=NEAR)


@pytest.mark.parametrize("order", ["a, b", "b, a"])
@pytest.mark.parametrize("kind", [oo.Slider, oo.Fixed])
def test_angular_error_is_the_angle_between_the_bodies(order, kind):
    turned = oo.Quat.from_axis_angle((1, 1, -3), 0.7)
    stand = Stand(Case("", kind, {}, lambda a, b, c: oo.Pose(oo.Vec3(0, 0, 0), turned)), order)
    assert stand.joint.angular_error == pytest.approx(0.7, abs=NEAR)


@pytest.mark.parametrize("order", ["a, b", "b, a"])
def test_a_slider_is_off_by_what_it_moved_across_its_axis(order):
    way = E1 * 3 + E2 * 0.4 - E3 * 0.3
    stand = Stand(Case("", oo.Slider, {"axis": E1}, lambda a, b, c: shifting(way)), order)
    assert stand.joint.error == pytest.approx(0.5, abs=NEAR)
    assert stand.joint.position == pytest.approx(3.0, abs=NEAR)


@pytest.mark.parametrize("com", [(0, 0, 0), (0.2, -0.1, 0)])
def test_plane_2d_reads_how_far_its_body_is_off_the_plane(com):
    world = oo.World()
    body = world.attach(oo.Body(position=(3, 4, 0)))
    body.fixed_mass = oo.Mass(2.0, oo.Vec3(*com))
    joint = oo.Plane2D(body)
    assert (joint.error, joint.angular_error) == (0.0, 0.0)
    body.rotation = oo.Quat.from_axis_angle((0, 0, 1), 2.0)
    assert (joint.error, joint.angular_error) == pytest.approx((0.0, 0.0), abs=NEAR)
    body.position = (1, -2, 0.25)
    assert joint.error == pytest.approx(0.25, abs=NEAR)
    body.rotation = oo.Quat.from_axis_angle((1, 1, 0), 0.3) * body.rotation
    assert joint.angular_error == pytest.approx(0.3, abs=NEAR)
    joint.straighten()
    assert (joint.error, joint.angular_error) == pytest.approx((0.0, 0.0), abs=NEAR)


@pytest.mark.parametrize("h", [1 / 120, 1 / 1000])
def test_a_pu_that_is_slid_out_and_turns_lags_as_documented(h):
    """By w x h / ERP, within a third: what ODE's equations leave out in each step, over what they correct of it."""
    world = oo.World(gravity=(0, 0, 0), solver="exact", step_size=h, erp=0.2)
    body = world.attach(oo.Body(position=(1, 0, 0)))
    body.fixed_mass = oo.Mass.box((1, 1, 1), mass=1)
    joint = oo.PU(body, anchor=(0, 0, 0), axis1=(0, 1, 0), axis2=(0, 0, 1), axis3=(1, 0, 0))
    body.position = (1.5, 0, 0)
    body.angular_velocity, body.linear_velocity = (0, 0, 1), (0, 1.5, 0)
    for _ in range(10):
        world.run(0.1)
        assert joint.error == pytest.approx(abs(joint.angle_rate2 * joint.position) * h / 0.2, rel=1 / 3)


def test_a_pressed_hinge2_on_a_turning_chassis_lags_as_documented():
    """By w x h / ERP, within a third, as a PU does; its suspension is free here."""
    world = oo.World(gravity=(0, 0, 0), solver="exact", step_size=1 / 240, erp=0.2)
    chassis, wheel = world.attach(oo.Body(kinematic=True)), world.attach(oo.Body())
    wheel.fixed_mass = oo.Mass.sphere(0.3, mass=5)
    joint = oo.Hinge2(chassis, wheel, suspension_damping=1e-5)
    wheel.position, wheel.linear_velocity = (0, 0.2, 0), (0, 0, 0.2)
    chassis.angular_velocity = wheel.angular_velocity = (1, 0, 0)
    for _ in range(5):
        world.run(0.1)
        assert joint.compression > 0.19
        assert joint.error == pytest.approx(joint.compression * 1.0 / 240 / 0.2, rel=1 / 3)
