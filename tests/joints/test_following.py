"""Softness follows the World, or the spring that it belongs to, whatever the step size becomes."""

import pytest

import osgode as oo
from osgode.fields import Followed
from tests.joints.held import KINDS, Held

SOFT = [(kind, name) for kind in KINDS for name, field in kind.cls.FIELDS.items() if isinstance(field, Followed)]
SPRINGS = [(kind, *name.split("stiffness")) for kind in KINDS for name in kind.cls.FIELDS if "stiffness" in name]
each_soft = pytest.mark.parametrize(("kind", "name"), SOFT, ids=str)
each_spring = pytest.mark.parametrize(("kind", "before", "after"), SPRINGS, ids=str)


def changes(held):
    """Be made again in each way that there is."""
    held.body1.attach(oo.Placeable(position=(2, -1, 0.5))).attach(oo.Box((0.2, 0.3, 0.4), mass=5))
    held.space.detach(held.body1)
    held.space.attach(held.body1)


@each_soft
def test_softness_follows_the_world_until_it_is_given(kind, name):
    of_world = "erp" if "erp" in name else "cfm"
    held = Held(kind, kind.attached[0])
    joint, world = held.joint, held.world
    assert getattr(joint, name) == getattr(world, of_world)
    setattr(world, of_world, 0.625)
    assert getattr(joint, name) == 0.625
    setattr(joint, name, 0.375)
    setattr(world, of_world, 0.75)
    assert getattr(joint, name) == 0.375
    changes(held)
    assert getattr(joint, name) == 0.375
    setattr(joint, name, None)
    assert getattr(joint, name) == 0.75
    held.other = oo.World(**{of_world: 0.875})
    held.space.move_to(held.other)
    assert getattr(joint, name) == 0.875
    held.other.detach(held.space)
    assert getattr(joint, name) is None


@pytest.mark.parametrize(("stiffness", "damping"), [(1500.0, 25.0), (1500.0, None), (None, 25.0), (0.0, 3.0)])
@each_spring
def test_a_spring_is_derived_again_for_every_step_size(kind, before, after, stiffness, damping):
    """ERP = h k / (h k + d) and CFM = 1 / (h k + d), at the start, after a change, and in another World."""
    given = {f"{before}stiffness{after}": stiffness, f"{before}damping{after}": damping}
    k, d = stiffness or 0.0, damping or 0.0
    held = Held(kind, kind.attached[0], fields=given)
    joint = held.joint

    def check(h):
        assert joint.world.step_size == h
        found = getattr(joint, f"{before}erp{after}"), getattr(joint, f"{before}cfm{after}")
        assert found == pytest.approx((h * k / (h * k + d), 1 / (h * k + d)), rel=1e-14)
        own = held.own()
        assert own[f"{before}erp{after}"] is None
        assert own[f"{before}cfm{after}"] is None
        assert {name: own[name] for name in given} == given

    check(held.world.step_size)
    for h in (0.002, 0.02):
        held.world.step_size = h
        check(h)
    held.world.erp, held.world.cfm = 0.75, 0.001  # which it no longer follows
    check(0.02)
    changes(held)
    check(0.02)
    held.other = oo.World(step_size=0.005)
    held.space.move_to(held.other)
    check(0.005)
    held.other.detach(held.space)
    held.world.attach(held.space)
    check(0.02)


@each_spring
def test_a_spring_that_is_taken_away_leaves_the_worlds_softness(kind, before, after):
    held = Held(kind, kind.attached[0], fields={f"{before}stiffness{after}": 100.0})
    setattr(held.joint, f"{before}stiffness{after}", None)
    assert getattr(held.joint, f"{before}erp{after}") == held.world.erp
    assert getattr(held.joint, f"{before}cfm{after}") == held.world.cfm


@pytest.mark.parametrize("live", [True, False])
@each_spring
def test_a_spring_excludes_erp_and_cfm(kind, before, after, live):
    """Whichever comes second is refused, and nothing changes; a spring of nothing is none."""
    soft = [f"{before}{name}{after}" for name in ("erp", "cfm")]
    spring = [f"{before}{name}{after}" for name in ("stiffness", "damping")]
    for first, second in ((soft, spring), (spring, soft)):
        for one in first:
            held = Held(kind, kind.attached[0], fields={one: 0.5})
            if not live:
                held.world.detach(held.space)
            own = held.own()
            for other in second:
                with pytest.raises(oo.FieldError, match=rf"{kind.title}\..*give the spring or"):
                    setattr(held.joint, other, 0.25)
                assert held.own() == own
                with pytest.raises(oo.FieldError, match=rf"{kind.title}\..*give the spring or"):
                    Held(kind, kind.attached[0], fields={one: 0.5, other: 0.25})
    held = Held(kind, kind.attached[0])
    if not live:
        held.world.detach(held.space)
    own = held.own()
    for name in spring:
        with pytest.raises(oo.FieldError, match=rf"{kind.title}: .* are both 0"):
            setattr(held.joint, name, 0.0)
        assert held.own() == own


def test_every_softness_but_that_of_motors_has_a_spring():
    for kind, name in SOFT:
        assert (kind.cls.FIELDS[name].spring is None) == (name.startswith("cfm") and "erp" not in kind.cls.FIELDS), (
            kind,
            name,
        )
