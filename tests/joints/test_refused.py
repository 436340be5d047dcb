"""What joints of every kind refuse: bodies, anchors, axes, fields, and the parameters of other kinds."""

import math

import pytest

import osgode as oo
from tests.joints.held import FIXED, KINDS, PAIRS, PLANE2D, SLIDER, Held, each_kind, each_pair
from tests.strategies import Case, refused


def stand(world: bool):
    first, second = oo.Body(name="first"), oo.Body(name="second")
    top = oo.World() if world else None
    if top is not None:
        top.attach(first)
        top.attach(second)
    return top, first, second


def unchanged(first, second, joints=0):
    assert first.joints == second.joints == ()
    assert oo.live_natives().joints == joints


@each_pair
@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize(
    ("pick", "words"),
    [
        (lambda a, b: (None, b), "body1 is None"),
        (lambda a, b: (None, None), "body1 is None"),
        (lambda a, b: (a, a), "body1 and body2 are both Body 'first'"),
        (lambda a, b: ("first", b), "body1 is 'first'"),
        (lambda a, b: (a, oo.Group()), "body2 is .*; it must be a Body"),
        (lambda a, b: (a, 0), "body2 is 0; it must be a Body"),
        (lambda a, b: (oo.World(), b), "body1 is "),
        (lambda a, b: (oo.Body, b), "body1 is "),
    ],
)
def test_bad_bodies_are_refused(kind, inside, pick, words):
    top, first, second = stand(inside)
    with pytest.raises(oo.TreeError, match=rf"{kind.title}: {words}"):
        kind.make(*pick(first, second))
    unchanged(first, second)
    del top


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize("kind", [kind for kind in PAIRS if False not in kind.attached], ids=str)
def test_what_needs_two_bodies_is_refused_with_one(kind, inside):
    top, first, second = stand(inside)
    with pytest.raises(oo.TreeError, match=rf"{kind.title}: body2 is None; it must be a Body$"):
        kind.make(first, None)
    with pytest.raises(TypeError):
        kind.cls(first)
    unchanged(first, second)
    del top


@pytest.mark.parametrize("bad", [None, "first", 5, oo.Body, oo.Placeable()], ids=repr)
def test_a_plane_takes_one_body(bad):
    _, first, second = stand(world=False)
    with pytest.raises(oo.TreeError, match=r"Plane2D 'it': body1 is .*; it must be a Body$"):
        PLANE2D.make(bad)
    with pytest.raises(TypeError):
        oo.Plane2D(first, second)
    with pytest.raises(TypeError):
        oo.Plane2D(first, body2=second)
    for cls in (oo.Plane2D, oo.LinearMotor, oo.Ball):
        with pytest.raises(TypeError):
            cls(first, spots={})
    unchanged(first, second)


NO_VECTOR = [(math.nan, 0, 0), (math.inf, 0, 0), (1, 2), (1, 2, 3, 4), 5.0, "abc", {1, 2, 3}, (True, False, "x")]
BAD = {
    "anchor": [*NO_VECTOR, (2e8, 0, 0)],
    "axis": [*NO_VECTOR, (0, 0, 0), (1e-13, 0, 0)],
}
BAD_WHERE = [(kind, name, value) for kind in KINDS for name in kind.spots for value in BAD[name.rstrip("123")]]
each_bad_spot = pytest.mark.parametrize(("kind", "name", "value"), BAD_WHERE, ids=str)


@each_bad_spot
def test_bad_anchors_and_axes_are_refused(kind, name, value):
    top, first, second = stand(world=True)
    with pytest.raises(oo.FieldError, match=rf"{kind.title}\.{name} is "):
        kind.make(first, second, **{name: value})
    unchanged(first, second)
    del top


@each_bad_spot
def test_bad_anchors_and_axes_are_refused_later_too(kind, name, value):
    """Nothing changes: none of the others, nor the rest that coordinates count from."""
    held = Held(kind, kind.attached[0])
    for inside in (True, False):
        if not inside:
            held.world.detach(held.space)
        native = held.joint._id
        with pytest.raises(oo.FieldError, match=rf"{kind.title}\.{name} is "):
            setattr(held.joint, name, value)
        with pytest.raises(oo.FieldError, match=rf"{kind.title}\.{name} is "):
            held.joint.anchor_anew(**{name: value})
        assert held.joint._id == native
        held.check()


@each_kind
def test_no_axis_may_be_left_out_by_none(kind):
    _, first, second = stand(world=False)
    for name in kind.spots:
        if name.startswith("axis") and name != "axis2":
            with pytest.raises(oo.FieldError, match=rf"{kind.title}\.{name} is None"):
                kind.make(first, second, **{name: None})
    unchanged(first, second)


@each_kind
def test_anchoring_anew_takes_only_what_the_kind_has(kind):
    held = Held(kind, kind.attached[0])
    with pytest.raises(oo.ParameterError, match=rf"{kind.title} has no 'axis7'"):
        held.joint.anchor_anew(axis7=(1, 0, 0))
    held.check()


FIELDS = [(kind, name) for kind in KINDS for name in kind.cls.FIELDS]


@pytest.mark.parametrize(("kind", "name"), FIELDS, ids=str)
def test_a_bad_field_leaves_no_joint_behind(kind, name):
    top, first, second = stand(world=True)
    for value in refused(Case(kind.cls, name))[-3:]:
        with pytest.raises(oo.FieldError, match=rf"{kind.title}\.{name} is "):
            kind.make(first, second, **{name: value})
    unchanged(first, second)
    del top


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind in KINDS for name in kind.lacks], ids=str)
@pytest.mark.parametrize("inside", [True, False])
def test_a_field_that_a_mode_lacks_is_refused(kind, name, inside):
    """At the start and later, and nothing changes."""
    top, first, second = stand(inside)
    with pytest.raises(oo.FieldError, match=kind.title):
        kind.make(first, second, **{name: 0.5})
    unchanged(first, second)
    held = Held(kind, kind.attached[0])
    before = held.own()
    with pytest.raises(oo.FieldError, match=kind.title):
        setattr(held.joint, name, 0.5)
    assert held.own() == before
    held.check()
    del top


@each_kind
def test_unknown_fields_are_type_errors(kind):
    top, first, second = stand(world=True)
    with pytest.raises(TypeError, match=rf"{kind.cls.__name__} has no field 'enabeld'; did you mean 'enabled'"):
        kind.make(first, second, enabeld=True)
    with pytest.raises(TypeError, match="has no field 'zzz'; it has enabled"):
        kind.make(first, second, zzz=1)
    unchanged(first, second)
    del top


@each_kind
def test_what_comes_after_the_bodies_is_named(kind):
    first, second = oo.Body(), oo.Body()
    with pytest.raises(TypeError):
        kind.cls(first, second, (0, 0, 0))
    unchanged(first, second)


# -- a parameter that a kind lacks


@each_kind
def test_a_parameter_of_another_kind_is_an_error_that_names_it(kind):
    """Read, set, or given as a keyword; hasattr says no."""
    top, first, second = stand(world=True)
    joint = kind.make(first, second)
    lacking = sorted(name for name in oo.Joint.PARAMETERS if not hasattr(kind.cls, name))
    assert "no_such" not in lacking
    assert len(lacking) > 20
    for name in lacking:
        assert not hasattr(joint, name)
        with pytest.raises(oo.ParameterError, match=rf"^{kind.title} has no '{name}'.*; it has enabled, "):
            getattr(joint, name)
        with pytest.raises(oo.ParameterError, match=rf"^{kind.title} has no '{name}'"):
            setattr(joint, name, 1.0)
        assert name not in vars(joint)
        with pytest.raises(TypeError, match=rf"{kind.cls.__name__} has no field '{name}'"):
            kind.make(first, second, **{name: 1.0})
        with pytest.raises(oo.ParameterError, match=rf"^{kind.title} has no '{name}'"):
            joint.anchor_anew(**{name: (1, 0, 0)})
    assert oo.live_natives().joints == 1
    del top


def test_every_parameter_of_every_kind_is_known():
    """The fields, anchors, axes, coordinates, verbs and properties that the table of kinds has between them."""
    for kind in KINDS:
        assert {*kind.cls.FIELDS, *kind.cls.SPOTS} - set(oo.Joint.FIELDS) <= oo.Joint.PARAMETERS
        read = {name for pair in kind.case.coordinates for name in pair}
        assert read <= oo.Joint.PARAMETERS
    assert {"motor", "fix", "straighten", "add_torques", "length", "mode", "radii"} <= oo.Joint.PARAMETERS


def test_the_error_is_of_each_sort_that_a_caller_may_expect():
    """An attribute is missing, a value is wrong, and osgode says so; the nearest name is told."""
    slider = SLIDER.make(oo.Body())
    for sort in (oo.ParameterError, oo.FieldError, AttributeError, ValueError, oo.OsgodeError):
        with pytest.raises(sort, match=r"Slider 'it' has no 'stops1'; did you mean 'stops'"):
            _ = slider.stops1
    fixed = FIXED.make(oo.Body())
    with pytest.raises(oo.ParameterError, match=r"Fixed 'it' has no 'angle'; it has enabled"):
        _ = fixed.angle


def test_a_name_of_the_user_is_no_parameter():
    """He may keep what he likes on a joint, and asks for what is not there with the usual error."""
    joint = oo.Ball(oo.Body())
    joint.colour = "red"
    assert joint.colour == "red"
    with pytest.raises(AttributeError, match="'Ball' object has no attribute 'flavour'"):
        _ = joint.flavour
