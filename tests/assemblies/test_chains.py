"""Chains: where every link is, what holds it, how it hangs, and what is refused."""

import functools
import math

import numpy as np
import pytest

import osgode as oo
from tests.assemblies.scenes import DOWN, empty, fastest, snapshot

KINDS = {"ball": oo.Ball, "hinge": oo.Hinge, "universal": oo.Universal, "fixed": oo.Fixed}
each_kind = pytest.mark.parametrize("kind", KINDS)


def test_a_straight_chain_has_its_links_between_its_ends():
    _, space = empty()
    made = oo.chain(space, (0, 3, 0), (2, 3, 0), links=8, radius=0.05, mass=4.0)
    assert len(made.links) == 8
    assert made.length == pytest.approx(2.0)
    assert made.link_length == pytest.approx(0.25)
    for k, link in enumerate(made.links):
        assert link.position == pytest.approx((0.125 + 0.25 * k, 3, 0))
        assert link.vector_to_world((0, 0, 1)) == pytest.approx((1, 0, 0))
        assert link.mass == pytest.approx(0.5)
        (geom,) = link.geoms
        assert geom.radius == 0.05
        assert geom.length == pytest.approx(0.15)  # 0.05 from each knot to the middle of a cap
    assert made.mass == pytest.approx(4.0)
    assert [tuple(point) for point in made.points] == [pytest.approx((0.25 * k, 3, 0)) for k in range(9)]


def test_density_gives_the_mass_of_the_capsules():
    _, space = empty()
    made = oo.chain(space, (0, 0, 0), (1, 0, 0), links=2, radius=0.1, density=1000.0)
    volume = math.pi * 0.01 * 0.3 + 4 / 3 * math.pi * 0.001
    assert made.mass == pytest.approx(2 * 1000 * volume)


def test_steel_unless_said_otherwise():
    _, space = empty()
    steel = oo.chain(space, (0, 0, 0), (1, 0, 0), links=2, radius=0.1)
    wood = oo.chain(space, (0, 1, 0), (1, 1, 0), links=2, radius=0.1, material="wood")
    volume = math.pi * 0.01 * 0.3 + 4 / 3 * math.pi * 0.001
    ratio = oo.Mass.sphere(1, density=7860).mass / (4 / 3 * math.pi)
    assert steel.mass == pytest.approx(2 * ratio * volume, rel=0.02)
    assert wood.links[0].geoms[0].material == "wood"
    assert wood.mass < steel.mass / 5


def test_the_number_of_links_follows_from_their_length():
    """By ``link_length`` as near as it goes, or by 8 radii."""
    _, space = empty()
    assert len(oo.chain(space, (0, 0, 0), (1, 0, 0), link_length=0.3).links) == 3
    assert len(oo.chain(space, (0, 0, 0), (1, 0, 0), link_length=0.28).links) == 4
    assert len(oo.chain(space, (0, 0, 0), (1, 0, 0), radius=0.025).links) == 5
    assert len(oo.chain(space, (0, 0, 0), (0.01, 0, 0), radius=0.001, link_length=1.0).links) == 1


@each_kind
def test_the_knots_are_joints_of_the_chosen_kind(kind):
    """Each link is held to the one before it, at the knot; the ends to the static world."""
    _, space = empty()
    made = oo.chain(space, (0, 3, 0), (2, 3, 0), length=2.4, links=6, joint=kind)
    assert [type(knot) for knot in made.knots] == [KINDS[kind]] * 7
    assert made.joints == made.knots
    pairs = [(knot.body1, knot.body2) for knot in made.knots]
    links = made.links
    assert pairs == [(links[0], None), *zip(links[1:], links, strict=False), (links[-1], None)]
    if kind != "fixed":
        for knot, point in zip(made.knots, made.points, strict=True):
            assert knot.anchor == pytest.approx(point, abs=1e-9)
    assert all(knot.is_live for knot in made.knots)
    assert made.joint("knot 3") is made.knots[3]
    assert made.body("link 5") is links[5]


def test_hinges_bend_in_the_plane_of_the_chain():
    _, space = empty()
    made = oo.chain(space, (0, 3, 0), (2, 3, 2), length=3.5, links=6, joint="hinge")
    for knot in made.knots:
        assert abs(knot.axis.dot((math.sqrt(0.5), 0, -math.sqrt(0.5)))) == pytest.approx(1.0)


def test_universal_joints_pass_twisting_on():
    """Turned at its upper end, a hanging chain of universal joints turns at its lower end; one of balls doesn't."""
    turned = {}
    for kind in ("universal", "ball"):
        world, space = empty(solver="exact")
        top = space.attach(oo.Body(position=(0, 3, 0), kinematic=True))
        top.attach(oo.Placeable()).attach(oo.Sphere(0.1))
        made = oo.chain(space, (0, 3, 0), length=1.0, links=5, joint=kind, body1=top)
        top.angular_velocity = (0, 1, 0)
        world.run(seconds=1)
        turned[kind] = made.links[-1].rotation.angle, made.links[-1].angular_velocity.y
    assert turned["ball"][1] == pytest.approx(0.0, abs=1e-6)
    assert turned["universal"][1] == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(
    "make", [oo.Ball, functools.partial(oo.Ball, break_force=1e4), functools.partial(oo.Hinge, axis=(0, 0, 1))]
)
def test_a_class_of_joints_or_a_function_makes_the_knots(make):
    _, space = empty()
    made = oo.chain(space, (0, 3, 0), (2, 3, 0), links=5, joint=make)
    assert len(made.joints) == 6
    assert all(type(knot) is getattr(make, "func", make) for knot in made.joints)
    if getattr(make, "keywords", {}).get("break_force"):
        assert made.joints[0].break_force == 1e4


@each_kind
@pytest.mark.parametrize("end", [(3, 5.5, 1), (2.0, 4.0, -1.0), (0.5, 5.0, 0.0)])
def test_a_slack_chain_hangs_at_once_and_stays(kind, end):
    """Nothing moves by a millimetre in ten seconds, and the ends are held."""
    world, space = empty(solver="exact")
    made = oo.chain(space, (0, 5, 0), end, length=4.5, links=18, joint=kind)
    before = made.points
    assert before[0] == pytest.approx((0, 5, 0), abs=1e-9)
    assert before[-1] == pytest.approx(end, abs=1e-9)
    world.step()
    assert fastest(made) < 1e-4
    world.run(seconds=10)
    for point, was in zip(made.points, before, strict=True):
        assert point.distance(was) < 1e-3
    assert made.points[0].distance((0, 5, 0)) < 1e-3
    assert made.points[-1].distance(end) < 1e-3
    assert made.error < 1e-3


def test_the_quick_solver_holds_the_ends_within_a_millimetre():
    world, space = empty(iterations=100, erp=0.8)
    made = oo.chain(space, (0, 5, 0), (3, 5.5, 1), length=4.5, links=18, damping=0.002)
    before = made.points
    world.run(seconds=10)
    assert made.points[0].distance((0, 5, 0)) < 1e-3
    assert made.points[-1].distance((3, 5.5, 1)) < 1e-3
    assert max(a.distance(b) for a, b in zip(made.points, before, strict=True)) < 5e-3


def test_it_hangs_as_the_catenary_of_its_length():
    """The simulated chain, let go from another shape and damped, against the closed formula."""
    length, across, links = 3.0, 2.0, 30
    low, high = 0.01, 100.0
    for _ in range(200):
        a = (low + high) / 2
        low, high = (a, high) if 2 * a * math.sinh(across / (2 * a)) > length else (low, a)
    world, space = empty(solver="exact", linear_damping=0.02, angular_damping=0.02)
    made = oo.chain(space, (0, 4, 0), (across, 4, 0), length=length, links=links, radius=0.01)
    made.links[links // 2].apply_impulse((2.0, 1.0, 0.0))
    world.step(5)
    assert fastest(made) > 0.05
    world.run(seconds=15)
    for x, y, _ in made.points:
        expected = 4 + a * (math.cosh((x - across / 2) / a) - math.cosh(across / (2 * a)))
        assert y == pytest.approx(expected, abs=0.01)
    sag = a * (math.cosh(across / (2 * a)) - 1)
    assert 4 - min(point.y for point in made.points) == pytest.approx(sag, abs=0.01)


def test_the_ends_bear_the_weight_and_pull_inwards():
    """At rest both ends together hold the chain up, and each as the chain's slope there says."""
    world, space = empty(solver="exact")
    made = oo.chain(space, (0, 4, 0), (2, 4, 0), length=3.0, links=20, mass=6.0)
    for knot in made.ends:
        knot.feedback = True
    world.run(seconds=0.5)
    first, last = (knot.reaction.force1 for knot in made.ends)
    assert first.y == pytest.approx(3.0 * DOWN, rel=1e-3)
    assert last.y == pytest.approx(3.0 * DOWN, rel=1e-3)
    assert first.x == pytest.approx(-last.x, rel=1e-3)
    along = made.points[0] - made.points[1]
    # The force in the first knot points along the first link but for half of that link's weight.
    assert (first.y - 6.0 / 20 * DOWN / 2) / -first.x == pytest.approx(along.y / -along.x, rel=1e-3)


def test_up_is_against_the_worlds_gravity():
    world, space = empty(gravity=(0, 0, 4), solver="exact")
    made = oo.chain(space, (0, 0, 0), (2, 0, 0), length=3.0, links=12)
    assert min(point.z for point in made.points) > -1e-9
    assert max(point.z for point in made.points) > 0.8
    assert max(abs(point.y) for point in made.points) < 1e-9
    world.run(seconds=1)
    assert fastest(made) < 1e-3


def test_without_gravity_up_is_y():
    _, space = empty(gravity=(0, 0, 0))
    made = oo.chain(space, (0, 0, 0), (2, 0, 0), length=3.0, links=12)
    assert min(point.y for point in made.points) < -0.8


def test_outside_of_a_world_it_is_built_and_lives_later():
    space = oo.HashSpace()
    made = oo.chain(space, (0, 3, 0), (2, 3, 0), length=3.0, links=6)
    assert not made.is_live
    assert not made.joints[0].is_live
    world = oo.World(solver="exact")
    world.attach(space)
    assert made.is_live
    assert all(joint.is_live for joint in made.joints)
    world.run(seconds=1)
    assert fastest(made) < 1e-3


def test_without_an_end_it_hangs_down_and_is_free_there():
    world, space = empty(solver="exact")
    made = oo.chain(space, (0, 3, 0), length=1.0, links=4)
    assert made.points[-1] == pytest.approx((0, 2, 0))
    assert made.ends[1] is None
    assert len(made.joints) == 4
    world.run(seconds=1)
    assert made.points[-1] == pytest.approx((0, 2, 0), abs=1e-6)


@pytest.mark.parametrize(
    ("free", "held"), [("none", (True, True)), ("start", (False, True)), ("end", (True, False)), ("both", (False,) * 2)]
)
def test_a_free_end_is_held_by_nothing_and_falls(free, held):
    world, space = empty(solver="exact")
    made = oo.chain(space, (0, 3, 0), (2, 3, 0), links=6, free=free)
    assert tuple(knot is not None for knot in made.ends) == held
    world.run(seconds=0.3)
    for point, is_held in zip((made.points[0], made.points[-1]), held, strict=True):
        assert (point.y > 2.9) == is_held


def test_a_chain_thrown_free_falls_as_a_whole():
    """Its centre of mass falls by g t^2 / 2."""
    world, space = empty(step_size=1e-3)
    made = oo.chain(space, (0, 3, 0), (2, 3, 0), length=2.5, links=6, free="both")
    before = made.centre_of_mass
    world.run(seconds=0.5)
    assert made.centre_of_mass == pytest.approx(before - oo.Vec3(0, DOWN / 8, 0), abs=5e-3)


def test_it_joins_two_bodies():
    """A weight on a chain from a body that is held: the links' knots are at the bodies, which hang below each other."""
    world, space = empty(solver="exact")
    beam = space.attach(oo.Body(position=(0, 5, 0), kinematic=True))
    load = space.attach(oo.Body(position=(0, 2.7, 0)))
    load.attach(oo.Placeable()).attach(oo.Sphere(0.3, mass=50.0))
    made = oo.chain(space, (0, 5, 0), (0, 3, 0), links=10, body1=beam, body2=load)
    first, last = made.ends
    assert (first.body1, first.body2) == (made.links[0], beam)
    assert (last.body1, last.body2) == (made.links[-1], load)
    beam.linear_velocity = (0.5, 0, 0)
    world.run(seconds=2)
    assert beam.position == pytest.approx((1, 5, 0), abs=1e-6)
    assert made.error < 1e-3
    assert made.points[0].distance(beam.position) < 2e-3
    assert load.position.distance(beam.position) == pytest.approx(2.3, abs=0.02)


def test_a_body_below_without_an_end_point_is_held():
    _, space = empty()
    load = space.attach(oo.Body(position=(0, 2, 0)))
    made = oo.chain(space, (0, 3, 0), length=1.0, links=4, body2=load)
    assert made.ends[1].body2 is load


def test_neighbours_never_collide_but_others_do():
    world, space = empty(gravity=(0, 0, 0))
    oo.chain(space, (0, 3, 0), (1, 3, 0), links=5, radius=0.05)
    world.step()
    assert len(world.contacts) == 0
    ball = space.attach(oo.Body(position=(0.5, 3.08, 0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.05))
    world.step()
    assert len(world.contacts) >= 1


# -- cutting


def test_cut_in_two_both_halves_swing_down():
    world, space = empty(solver="exact")
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), links=12)
    made.cut(6)
    assert made.knots[6].released
    world.run(seconds=0.4)
    halves = made.links[5].position, made.links[6].position
    assert halves[0].distance(halves[1]) > 0.5
    assert made.points[0].distance((0, 5, 0)) < 1e-3
    assert made.points[-1].distance((3, 5, 0)) < 1e-3
    assert made.length == pytest.approx(3.0)
    assert made.error < 0.01  # of what still holds
    made.cut(6)  # a second time does nothing


@pytest.mark.parametrize("knot", [0, 12])
def test_cut_at_an_end_lets_go_of_it(knot):
    _, space = empty()
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), links=12)
    made.cut(knot)
    assert made.ends[knot // 12].released
    assert not made.ends[1 - knot // 12].released


@pytest.mark.parametrize("knot", [-1, 13, 2.5, "middle", None])
def test_a_cut_at_no_knot_is_refused(knot):
    _, space = empty()
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), links=12)
    with pytest.raises(
        oo.FieldError, match=r"Chain 'chain'.cut\(\).knot is .*; it must be a whole number from 0 to 12"
    ):
        made.cut(knot)


def test_a_cut_where_it_is_free_is_refused():
    _, space = empty()
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), links=12, free="end")
    with pytest.raises(oo.FieldError, match="knot is 12, where this chain is free"):
        made.cut(12)


# -- coming and going


def test_it_moves_to_another_world_with_its_joints():
    world, space = empty(solver="exact")
    other, elsewhere = empty(solver="exact")
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), length=4.0, links=12)
    world.run(seconds=0.5)
    before = made.points
    assert made.move_to(elsewhere) is made
    assert made.parent is elsewhere
    assert made.links[0].world is other
    assert all(joint.is_live for joint in made.joints)
    assert len(other.joints) == 13
    assert len(world.joints) == 0
    other.run(seconds=1)
    assert max(a.distance(b) for a, b in zip(before, made.points, strict=True)) < 1e-3


def test_a_held_end_lets_go_while_the_chain_is_away():
    world, space = empty()
    _, elsewhere = empty()
    beam = space.attach(oo.Body(position=(0, 5, 0), kinematic=True))
    made = oo.chain(space, (0, 5, 0), (0, 4, 0), links=4, body1=beam, free="end")
    lost = []
    made.ends[0].on_let_go(lambda event: lost.append(event.reason))
    made.move_to(elsewhere)
    assert lost == ["left"]
    assert [joint.is_live for joint in made.joints] == [False, True, True, True]
    made.move_to(space)
    assert all(joint.is_live for joint in made.joints)
    assert made.bodies[0].world is world


def test_detached_it_is_data_and_attached_it_goes_on():
    world, space = empty(solver="exact")
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), length=4.0, links=12, name="bridge")
    world.run(seconds=0.1)
    assert made.detach() is made
    assert made.parent is None
    assert not made.is_live
    assert space.children == ()
    assert len(world.bodies) == len(world.joints) == 0
    made.detach()  # a second time does nothing
    assert made.attach(world) is made
    assert made.top.parent is world
    assert len(world.joints) == 13
    world.run(seconds=0.5)
    assert fastest(made) < 1e-3
    with pytest.raises(oo.TreeError):
        made.attach(space)
    with pytest.raises(oo.TreeError, match=r"Chain 'bridge'.attach\(\): 5 is no Group"):
        made.attach(5)


def test_names_that_it_has_not_are_refused_with_a_hint():
    _, space = empty()
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), links=3)
    with pytest.raises(oo.FieldError, match="Chain 'chain' has no body 'lnk 1'; did you mean 'link 1'"):
        made.body("lnk 1")
    with pytest.raises(oo.FieldError, match="has no joint 7; it has 'knot 0', 'knot 1', 'knot 2', 'knot 3'"):
        made.joint(7)
    assert repr(made) == "<Chain 'chain': 3 bodies, 4 joints>"
    assert repr(oo.chain(space, (0, 5, 0), (3, 5, 0), links=3, name="")).startswith("<Chain: 3")


def test_it_wakes_up():
    world, space = empty(auto_disable=True, solver="exact")
    made = oo.chain(space, (0, 5, 0), (3, 5, 0), length=4.0, links=6)
    world.run(seconds=1)
    assert not any(link.enabled for link in made.links)
    made.wake()
    assert all(link.enabled for link in made.links)


def test_damping_is_the_links_own_or_the_worlds():
    world, space = empty(linear_damping=0.01)
    own = oo.chain(space, (0, 5, 0), (1, 5, 0), links=3, damping=0.25)
    follows = oo.chain(space, (0, 4, 0), (1, 4, 0), links=3)
    assert {(link.linear_damping, link.angular_damping) for link in own.links} == {(0.25, 0.25)}
    assert {(link.linear_damping, link.angular_damping) for link in follows.links} == {(0.01, 0.0)}
    world.linear_damping = 0.02
    assert own.links[0].linear_damping == 0.25


def test_it_is_drawn_up_to_its_knots():
    _, space = empty()
    look = oo.Appearance((1.0, 0.0, 0.0, 1.0))
    made = oo.chain(space, (0, 5, 0), (1, 5, 0), links=4, radius=0.05, appearance=look)
    (drawn,) = made.links[0].geoms[0].drawables()
    assert drawn.appearance is look
    assert np.ptp(np.asarray(drawn.mesh.vertices)[:, 2]) == pytest.approx(0.25 + 0.1, rel=1e-5)
    ring = oo.box_drawable((0.1, 0.1, 0.1))
    other = oo.chain(space, (0, 4, 0), (1, 4, 0), links=4, radius=0.05, shown=ring)
    assert other.links[0].geoms[0].drawables() == (ring,)


# -- what is refused

WRONG = [
    ({"start": (0, math.nan, 0)}, r"chain\(\).start is \(0, nan, 0\)"),
    ({"end": (0, 1)}, r"chain\(\).end is \(0, 1\)"),
    ({"end": (0, 5, 0)}, r"chain\(\).end is .*where it starts"),
    ({"end": None}, r"chain\(\).length is None"),
    ({"length": 2.9}, r"chain\(\).length is 2.9; it must be at least 3 m"),
    ({"length": -1.0}, r"chain\(\).length is -1.0"),
    ({"links": 0}, r"chain\(\).links is 0"),
    ({"links": 2.5}, r"chain\(\).links is 2.5"),
    ({"links": 10**9}, r"chain\(\).links is 1000000000"),
    ({"links": None, "link_length": 1e-5}, r"link_length is 1e-05, which makes 300000 links"),
    ({"links": None, "link_length": 0.0}, r"chain\(\).link_length is 0.0"),
    ({"link_length": 0.5}, "links=6 and link_length=0.5; give one"),
    ({"radius": 0.25}, r"chain\(\).radius is 0.25; it must be below 0.25 m"),
    ({"radius": "thick"}, r"chain\(\).radius is 'thick'"),
    ({"links": 1, "length": 4.0}, "needs at least 2"),
    ({"end": (0.5, 3, 0), "length": 4.0}, "would hang through itself"),
    ({"mass": 0.0}, r"chain\(\).mass is 0.0"),
    ({"mass": 1.0, "density": 500.0}, "mass=.* and density=500"),
    ({"density": -1.0}, "density is -1.0"),
    ({"joint": "rope"}, r"chain\(\).joint is 'rope'; it must be one of 'ball', 'hinge', 'universal', 'fixed'"),
    ({"joint": 5}, r"chain\(\).joint is 5"),
    ({"joint": lambda *_, **__: None}, r"chain\(\).joint has returned None"),
    ({"free": "top"}, r"chain\(\).free is 'top'"),
    ({"damping": 2.0}, r"chain\(\).damping is 2.0"),
    ({"material": "cheese"}, "material is 'cheese'"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG, ids=lambda value: value if isinstance(value, str) else "")
def test_bad_arguments_of_chains_are_refused_and_nothing_is_changed(arguments, message):
    _, space = empty()
    body = space.attach(oo.Body(name="beam", position=(0, 5, 0)))
    before = snapshot(space)
    rest = {"start": (0, 5, 0), "end": (3, 5, 0), "links": 6, "body1": body} | arguments
    with pytest.raises(oo.FieldError, match=message):
        oo.chain(space, **rest)
    assert snapshot(space) == before


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"parent": None}, r"chain\(\).parent is None; it must be a Space or a World"),
        ({"parent": oo.Group()}, r"chain\(\).parent is <Group>"),
        ({"body1": "beam"}, r"chain\(\).body1 is 'beam'; it must be a Body or None"),
    ],
)
def test_bad_parents_and_bodies_of_chains_are_refused(arguments, message):
    _, space = empty()
    rest = {"parent": space, "start": (0, 5, 0), "end": (3, 5, 0)} | arguments
    with pytest.raises(oo.TreeError, match=message):
        oo.chain(**rest)
    assert space.children == ()


def test_a_free_end_with_a_body_is_refused():
    _, space = empty()
    body = space.attach(oo.Body(name="beam"))
    with pytest.raises(oo.FieldError, match=r"chain\(\).body1 is Body 'beam' beside free='both'"):
        oo.chain(space, (0, 5, 0), (3, 5, 0), body1=body, free="both")


def test_a_joint_that_fails_half_way_leaves_nothing():
    """The first knots are on a body that stays: it has no joints afterwards."""
    _, space = empty()
    beam = space.attach(oo.Body(name="beam", position=(0, 5, 0)))

    def make(one, other, *, anchor):
        if one.name == "link 3":
            raise RuntimeError("out of joints")
        return oo.Ball(one, other, anchor=anchor)

    with pytest.raises(RuntimeError, match="out of joints"):
        oo.chain(space, (0, 5, 0), (3, 5, 0), links=6, body1=beam, joint=make)
    assert beam.joints == ()
    assert space.children == (beam,)


def test_unknown_settings_of_chains_are_refused():
    _, space = empty()
    with pytest.raises(TypeError, match="no field 'colour'"):
        oo.chain(space, (0, 5, 0), (3, 5, 0), colour="red")
    assert space.children == ()
