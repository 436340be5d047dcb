"""Several bodies as one thing: hidden, muted, taken out and put back, placed, copied, steered."""

import gc
import math
import weakref

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import osgode as oo
from osgode.engine import CompositeObject, ControllableObject, carrier_of
from osgode.errors import FieldError, StateError, TreeError
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import View
from osgode.maths import Pose, Quat, Vec3
from tests.engine.games import Cart

PLACES = st.builds(
    lambda x, y, z, *turns: Pose(Vec3(x, y, z), Quat.from_yaw_pitch_roll(*turns)), *6 * [st.floats(-3, 3)]
)


def setting():
    """A World without gravity, and a space in it that collides with itself."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace(name="space"))
    world.collide(space)
    return world, space


def stone(space, position):
    body = space.attach(oo.Body(name="stone", position=position))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    return body


def snapshot(cart):
    """All that a cart's bodies are, and its joint."""
    return [(body.pose, body.linear_velocity, body.angular_velocity) for body in cart.bodies]


def close(one, other, within=1e-9):
    return all(abs(a - b) < within for a, b in zip(one, other, strict=True))


def test_what_it_is_made_of():
    """Bodies, geoms and joints in the order of the tree; its pose is that of its first body."""
    cart = Cart()
    assert cart.bodies == (cart.hull, cart.arm)
    assert [geom.body for geom in cart.geoms] == [cart.hull, cart.arm]
    assert cart.joints == (cart.hinge,)
    assert cart.main_body is cart.hull
    assert cart.pose == cart.hull.pose
    wheel = oo.Body(name="wheel")
    inner = cart.attach(oo.SimpleSpace())
    inner.attach(wheel)
    rope = oo.Ball(wheel, oo.Body())
    assert cart.bodies == (cart.hull, cart.arm, wheel)
    assert cart.joints == (cart.hinge, rope)
    assert not cart.in_simulation
    empty = CompositeObject(name="empty")
    with pytest.raises(StateError, match=r"empty.*no body"):
        _ = empty.pose
    assert carrier_of(cart.geoms[0]) is cart
    assert carrier_of(wheel) is cart
    assert carrier_of(cart) is cart
    assert carrier_of(oo.Body()) is None


def test_hiding():
    """All of it is drawn or not."""
    world, space = setting()
    cart = space.attach(Cart())
    cull = CullVisitor(world)
    view = View(Pose(Vec3(0, 1, 9), Quat(1, 0, 0, 0)))

    def drawn():
        return sum(len(one.matrices) for one in cull.cull(view, (64, 40)).opaque)

    assert drawn() == 2
    cart.visible = False
    assert drawn() == 0
    cart.visible = True
    assert drawn() == 2


# -- colliding


def touches(world, body):
    """Whether a body meets anything in the next step."""
    world.step()
    slots = {geom._slot for geom in body.geoms}
    return any(row["slot1"] in slots or row["slot2"] in slots for row in world.contacts)


def test_colliding_on_and_off():
    """Off, nothing meets it; on, all is as before, and what was disabled before stays so."""
    world, space = setting()
    cart = space.attach(Cart())
    ghost = cart.hull.attach(oo.Placeable(position=(0, 5, 0))).attach(oo.Sphere(0.5, enabled=False))
    ball = stone(space, (0, 0.6, 0))
    high = stone(space, (0, 5, 0))
    assert touches(world, ball)
    cart.collides = False
    assert not cart.collides
    assert not touches(world, ball)
    cart.collides = False
    cart.collides = True
    assert cart.collides
    assert touches(world, ball)
    assert not ghost.enabled
    assert not touches(world, high)


def test_geoms_that_come_and_go_while_it_is_off():
    """What comes is disabled, what goes is enabled again; however deep."""
    _world, space = setting()
    cart = space.attach(Cart())
    cart.collides = False
    new = cart.hull.attach(oo.Placeable()).attach(oo.Box((1, 1, 1)))
    dead = cart.hull.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), enabled=False))
    wheel = oo.Body()
    rim = wheel.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    cart.attach(wheel)
    assert not new.enabled
    assert not rim.enabled
    cart.detach(wheel)
    assert rim.enabled
    cart.attach(wheel)
    wheel.move_to(space)
    assert rim.enabled
    wheel.move_to(cart)
    assert not rim.enabled
    cart.collides = True
    assert new.enabled
    assert rim.enabled
    assert not dead.enabled


@settings(max_examples=60)
@given(st.lists(st.tuples(st.sampled_from(["outer", "inner", "world"]), st.booleans()), max_size=12))
def test_composites_within_composites(switches):
    """A geom collides if none of the things that it is a part of is off, in whatever order they were switched."""
    _world, space = setting()
    outer, inner = CompositeObject(name="outer"), Cart("inner")
    outer.attach(inner)
    own = outer.attach(oo.Body()).attach(oo.Placeable()).attach(oo.Sphere(1))
    now = {"outer": True, "inner": True}
    for which, value in switches:
        if which == "world":
            if value != outer.is_live:
                space.attach(outer) if value else space.detach(outer)
            continue
        {"outer": outer, "inner": inner}[which].collides = now[which] = value
        assert own.enabled == now["outer"]
        assert {geom.enabled for geom in inner.geoms} == {now["outer"] and now["inner"]}
    outer.collides = inner.collides = True
    assert all(geom.enabled for geom in outer.geoms)


@pytest.mark.parametrize("wrong", [None, 1, "off"])
def test_bad_switches(wrong):
    cart = Cart("cart")
    with pytest.raises(FieldError, match=r"cart.*collides"):
        cart.collides = wrong
    with pytest.raises(FieldError, match="auto_recentre"):
        cart.recentring = wrong
    assert cart.collides


# -- centre of mass


def test_recentring():
    """Switched off, no body follows its parts; `recentre` brings all to them at once."""
    _world, space = setting()
    cart = space.attach(Cart())
    assert cart.recentring
    cart.recentring = False
    assert not any(body.auto_recentre for body in cart.bodies)
    before = cart.hull.centre_of_mass
    cart.hull.attach(oo.Placeable(position=(2, 0, 0))).attach(oo.Sphere(0.5, mass=10.0))
    assert cart.hull.centre_of_mass == before
    cart.recentre()
    assert close(cart.hull.centre_of_mass, (1, 0, 0))
    cart.recentring = True
    assert cart.recentring


# -- leaving and entering


def test_leaving_and_coming_back():
    """Poses, velocities, the joint and its angle stay; out of the World nothing happens to it; scheduled calls go."""
    world, space = setting()
    cart = space.attach(Cart())
    cart.hull.linear_velocity = (1, 2, 3)
    cart.arm.angular_velocity = (0.8, 0, 0)
    calls = []
    call = cart.hull.schedule(calls.append, 30)
    world.step(20)
    angle, rate = cart.hinge.angle, cart.hinge.angle_rate
    assert abs(angle) > 0.01
    before = snapshot(cart)
    cart.leave()
    cart.leave()
    assert not cart.in_simulation
    assert cart.parent is None
    assert not call.pending
    assert not cart.hinge.is_live
    world.step(20)
    assert snapshot(cart) == before
    cart.enter()
    assert cart.parent is space
    assert cart.in_simulation
    assert snapshot(cart) == before
    assert cart.hinge.angle == pytest.approx(angle, abs=1e-12)
    assert cart.hinge.angle_rate == pytest.approx(rate, abs=1e-9)
    world.step(20)
    assert calls == []


def test_entering_elsewhere():
    """Below another parent, in another World, at another place."""
    world, space = setting()
    cart = space.attach(Cart())
    world.step(3)
    cart.leave()
    other = oo.World(gravity=(0, 0, 0))
    there = Pose(Vec3(5, 6, 7), Quat.from_yaw_pitch_roll(1.0))
    cart.enter(other, there)
    assert cart.world is other
    assert close(cart.pose.position, there.position)
    assert close(cart.pose.rotation, there.rotation)
    assert cart.hinge.is_live
    assert cart.hinge.angle == pytest.approx(0.0, abs=1e-9)
    assert cart.hinge.error < 1e-9
    cart.leave()
    cart.enter()
    assert cart.world is other


@pytest.mark.parametrize(
    ("way", "words"),
    [
        (lambda cart, space: cart.enter(), "not left anywhere yet"),
        (lambda cart, space: cart.enter(oo.Body()), "may stand under"),
        (lambda cart, space: cart.enter(oo.Body(), Pose(Vec3(9, 9, 9), Quat(1, 0, 0, 0))), "may stand under"),
        (lambda cart, space: cart.enter(7), "7 is no Group"),
        (lambda cart, space: cart.enter(space, 3), "pose is 3"),
        (lambda cart, space: cart.enter(space, ((0, math.nan, 0), (1, 0, 0, 0))), "pose.position"),
        (lambda cart, space: cart.enter(space, ((0, 0, 0), (0, 0, 0, 0))), "pose.rotation"),
        (lambda cart, space: cart.enter(space, ((0, 0, -1e8), (1, 0, 0, 0))), "position"),
    ],
)
def test_entering_that_fails_changes_nothing(way, words):
    """A wrong parent or pose: it stays out, where it was, with its velocities."""
    _world, space = setting()
    cart = Cart("cart")
    # Its arm is 1.5 m before it, so that at the very end of the world the arm would be beyond.
    cart.place(Pose(Vec3(1, 2, 3), Quat.from_yaw_pitch_roll(math.pi)))
    cart.hull.linear_velocity = (1, 0, 0)
    before = snapshot(cart)
    with pytest.raises((TreeError, FieldError), match=words):
        way(cart, space)
    assert snapshot(cart) == before
    assert cart.parent is None
    space.attach(cart)
    with pytest.raises(TreeError, match="stands under HashSpace 'space' already"):
        cart.enter(space, Pose())
    assert snapshot(cart) == before
    with pytest.raises(FieldError, match="pose is None"):
        cart.place(None)


def test_a_world_is_not_kept_by_what_left_it():
    """Who holds only what has left doesn't hold the World; it can enter another."""
    world, space = setting()
    cart = space.attach(Cart("cart"))
    cart.leave()
    del world, space
    gc.collect()
    assert oo.live_natives().bodies == 0
    with pytest.raises(TreeError, match="what it stood under is gone"):
        cart.enter()
    other = oo.World()
    cart.enter(other)
    assert cart.world is other


def test_leaving_within_a_step():
    """A scheduled call may take its own object out, and put it back later."""
    world, space = setting()
    cart = space.attach(Cart())
    cart.schedule(lambda node: node.leave())
    world.schedule(lambda node: cart.enter(), 5)
    world.step(10)
    assert cart.in_simulation
    assert [step for step, _ in cart.controlled] == [1, 6, 7, 8, 9, 10]


# -- placing


@given(PLACES, PLACES, st.booleans())
def test_placing(first, second, live):
    """All of it is moved as one: what its first body sees of the others stays, and velocities turn along."""
    world, space = setting()
    cart = Cart()
    if live:
        space.attach(cart)
    cart.place(first)
    cart.hull.linear_velocity, cart.arm.angular_velocity = (1, 2, 3), (0.1, 0.2, 0.3)
    if live:
        world.step(2)
    hull, arm = cart.hull, cart.arm
    seen = hull.pose.inverse() * arm.pose
    angle = cart.hinge.angle if live else 0.0
    felt = [hull.vector_to_local(v) for v in (hull.linear_velocity, hull.angular_velocity)]
    spin = arm.vector_to_local(arm.angular_velocity)
    cart.place(second)
    assert close(cart.pose.position, second.position, 1e-9)
    assert abs(abs(sum(a * b for a, b in zip(cart.pose.rotation, second.rotation, strict=True))) - 1) < 1e-9
    now = hull.pose.inverse() * arm.pose
    assert close(now.position, seen.position, 1e-9)
    assert abs(abs(sum(a * b for a, b in zip(now.rotation, seen.rotation, strict=True))) - 1) < 1e-9
    for old, new in zip(felt, (hull.linear_velocity, hull.angular_velocity), strict=True):
        assert close(hull.vector_to_local(new), old, 1e-9)
    assert close(arm.vector_to_local(arm.angular_velocity), spin, 1e-9)
    if live:
        assert cart.hinge.angle == pytest.approx(angle, abs=1e-9)
        assert cart.hinge.error < 1e-3
    cart.place(first, at_rest=True)
    assert all(v == (0, 0, 0) for body in cart.bodies for v in (body.linear_velocity, body.angular_velocity))


# -- copying


def test_copying():
    """A copy is outside of any World, has bodies, joints and state of its own, and moves to the same bits."""
    world, space = setting()
    cart = space.attach(
        Cart(
            "cart",
        )
    )
    cart.hull.linear_velocity = (1, 2, 3)
    cart.arm.angular_velocity = (0.8, 0, 0)
    cart.hinge.motor_max_force = 3.0
    twin = cart.copy()
    assert type(twin) is Cart
    assert not twin.is_live
    assert twin.parent is None
    assert snapshot(twin) == snapshot(cart)
    assert (twin.hull, twin.arm) == twin.bodies
    assert not {id(body) for body in twin.bodies} & {id(body) for body in cart.bodies}
    assert twin.joints == (twin.hinge,)
    assert twin.hinge is not cart.hinge
    assert (twin.hinge.body1, twin.hinge.body2) == twin.bodies
    assert twin.hinge.motor_max_force == 3.0
    assert twin.controls is not cart.controls
    assert twin.controlled == []
    other, there = setting()
    there.attach(twin)
    for each in (world, other):
        each.step(50)
    assert snapshot(twin) == snapshot(cart)
    assert twin.hinge.angle == cart.hinge.angle != 0.0
    assert len(twin.controlled) == len(cart.controlled) == 50
    assert twin.controlled is not cart.controlled


def test_copying_attributes():
    """Attributes that are parts, or lists of them, name the copy's parts; class attributes may be overlaid."""

    class Truck(Cart):
        speed = 1

        def __init__(self):
            super().__init__()
            self.speed = 2
            self._both = [self.hull, self.arm]
            self.named = {"arm": self.arm, "other": 3}
            self.pair = (self.hinge, self)
            self.shared = (1, 2)

    truck = Truck()
    space = setting()[1]
    space.attach(truck)
    truck.on_touch(lambda touch: None)
    twin = truck.copy()
    assert twin.speed == 2
    assert twin._both == [twin.hull, twin.arm]
    assert twin.named == {"arm": twin.arm, "other": 3}
    assert twin.pair == (twin.hinge, twin)
    assert twin.shared is not None
    assert not twin.is_live
    assert twin._touch_listeners == ()


def test_copying_what_is_muted():
    """A copy of what is off is off, and can be switched on by itself."""
    outer = CompositeObject()
    cart = outer.attach(Cart())
    cart.collides = False
    outer.collides = False
    twin = outer.copy()
    assert not twin.collides
    (inner,) = twin.children
    assert not inner.collides
    assert len(twin.joints) == 1, "the joint within the inner one is copied once"
    inner.collides = True
    assert not any(geom.enabled for geom in twin.geoms)
    twin.collides = True
    assert all(geom.enabled for geom in twin.geoms)
    assert not any(geom.enabled for geom in outer.geoms)


def test_joints_to_others_are_not_copied():
    """A joint to the static world is; one to a body that isn't a part is not."""
    _world, space = setting()
    cart = space.attach(Cart())
    oo.Ball(cart.hull, stone(space, (0, 3, 0)), anchor=(0, 2, 0))
    pin = oo.Slider(cart.arm, axis=(0, 1, 0))
    twin = cart.copy()
    assert [type(joint) for joint in twin.joints] == [oo.Hinge, oo.Slider]
    assert twin.joints[1].body2 is None
    assert twin.joints[1] is not pin


# -- steering


def test_control_is_called_in_each_step_of_a_world():
    """At the end of each step while it is in a World, and not otherwise; once, however often it came back."""
    world, space = setting()
    cart = Cart()
    world.step()
    space.attach(cart)
    assert cart.controlled == []
    world.step(3)
    assert [step for step, _ in cart.controlled] == [2, 3, 4]
    cart.leave()
    world.step(2)
    assert len(cart.controlled) == 3
    cart.enter()
    world.step(2)
    assert [step for step, _ in cart.controlled] == [2, 3, 4, 7, 8]
    cart.move_to(world.attach(oo.SimpleSpace()))
    world.step()
    assert [step for step, _ in cart.controlled] == [2, 3, 4, 7, 8, 9]


def test_control_comes_before_other_calls():
    """With its priority it is made before calls of the usual one."""
    world, space = setting()
    order = []

    class Ordered(Cart):
        def control(self):
            order.append("control")

    space.schedule(lambda node: order.append("other"))
    space.attach(Ordered())
    world.step()
    assert order == ["control", "other"]


def test_a_control_that_fails_is_reported():
    """The error leaves the step with the object's path; the World stays usable."""

    class Failing(ControllableObject):
        def control(self):
            raise ValueError("no fuel")

    world, space = setting()
    thing = space.attach(Failing(name="thing"))
    thing.attach(oo.Body())
    with pytest.raises(ValueError, match="no fuel") as caught:
        world.step()
    assert "thing" in caught.value.__notes__[0]
    world.step(2)


def test_what_it_is_made_of_is_asked_again_by_whoever_hears_of_a_change():
    """In `entered` of a new part, in listeners of what has gone, and after moves within the World."""
    _, space = setting()
    outer, other = space.attach(CompositeObject(name="outer")), space.attach(CompositeObject(name="other"))
    first = stone(outer, (0, 0, 0))
    assert outer.bodies == (first,)
    seen = []

    class Part(CompositeObject):
        def entered(self):
            seen.append((outer.bodies, outer.main_body, len(outer.geoms)))

    part = Part()
    second = stone(part, (3, 0, 0))
    outer.attach(part)
    assert seen == [((first, second), first, 2)]

    joint = oo.Ball(second, first)
    assert outer.joints == (joint,)
    joint.on_let_go(lambda _: seen.append((outer.bodies, outer.joints)))
    outer.detach(first)
    assert seen[1:] == [((second,), (joint,))]
    assert outer.main_body is second

    part.move_to(other)
    assert (outer.bodies, other.bodies) == ((), (second,))
    part.attach(first)
    assert other.bodies == (second, first)
    assert part.bodies == (second, first)
    other.detach(part)
    assert (other.bodies, other.geoms) == ((), ())


def test_a_part_that_is_refused_is_not_among_its_parts():
    _, space = setting()
    outer = space.attach(CompositeObject())
    seen = []

    class Unwilling(CompositeObject):
        def entered(self):
            seen.append(len(outer.bodies))
            raise RuntimeError("no")

    unwilling = Unwilling()
    stone(unwilling, (0, 0, 0))
    with pytest.raises(RuntimeError, match="no"):
        outer.attach(unwilling)
    assert seen == [1]
    assert outer.bodies == outer.geoms == ()


def test_parts_that_have_gone_are_not_kept_by_what_they_were_of():
    outer = CompositeObject()
    body = stone(outer, (0, 0, 0))
    assert outer.bodies == (body,)
    gone = weakref.ref(outer.detach(body))
    del body
    gc.collect()
    assert gone() is None


def test_a_controllable_object_may_leave_in_entered():
    """What it was to do is dropped with it, and taken up again when it stays."""

    class Shy(ControllableObject):
        shy = True
        count = 0

        def entered(self):
            if self.shy:
                self.leave()

        def control(self):
            self.count += 1

    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    thing = Shy()
    thing.attach(oo.Body())
    space.attach(thing)
    assert not thing.in_simulation
    assert thing.parent is None
    assert world.bodies == ()
    world.step(2)
    assert thing.count == 0
    thing.shy = False
    space.attach(thing)
    world.step(2)
    assert thing.count == 2
