"""The table of fields, for every field of every class: what is kept, where it goes, and what is refused."""

import itertools
import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import osgode as oo
from osgode.fields import Followed, choice, number, optional, vector, whole
from osgode.nodes.base import HasFields
from tests.strategies import CASES, MAKERS, ROUNDED, Case, Stand, accepted, refused, same

MOVABLE = [case for case in CASES if case.cls is not oo.World]


def is_exclusive(case):
    """Whether it can't be given beside others: beside ``mass``, beside ERP and CFM, beside a motor."""
    spring = issubclass(case.cls, oo.Joint) and ("stiffness" in case.name or "damping" in case.name)
    return spring or case.name in {"density", "servo"}


def each(cases, **more):
    """Run the test once for each class, with all of its cases, and all values of one more argument."""

    def decorate(test):
        def run(cls):
            for case in cases:
                if case.cls is cls:
                    for values in itertools.product(*more.values()):
                        arguments = dict(zip(more, values, strict=True))
                        try:
                            test(case, **arguments)
                        except BaseException as error:
                            error.add_note(f"with {case} {arguments or ''}")
                            raise

        run.__doc__ = test.__doc__
        return pytest.mark.parametrize("cls", dict.fromkeys(case.cls for case in cases))(run)

    return decorate


def of_world(case):
    """The World's field that this one follows."""
    if not issubclass(case.cls, oo.Joint):
        return case.name
    return "erp" if "erp" in case.name else "cfm"


def value_in_force(case, stand):
    """What a fresh native must show: the default, or what it follows."""
    if not isinstance(case.field, Followed):
        return case.field.default
    return getattr(stand.world, of_world(case))


def concrete(cls=HasFields):
    """The classes with fields of the package that can be made (no class of another test)."""
    for sub in cls.__subclasses__():
        yield from concrete(sub)
    if cls.__module__.startswith("osgode.") and cls.__name__ in oo.__all__:
        yield cls


ABSTRACT = {oo.PhysicsNode, oo.Space, oo.Geom, oo.Joint}


def test_every_class_with_fields_is_tested():
    """A new class has to be added to MAKERS in strategies.py."""
    assert set(concrete()) - ABSTRACT == set(MAKERS)


@pytest.mark.parametrize("cls", MAKERS)
def test_the_table_holds_each_field_once_with_its_words(cls):
    assert bool(cls.FIELDS) == (cls is not oo.SimpleSpace)
    for name, field in cls.FIELDS.items():
        assert getattr(cls, name) is field
        assert field.name == name
        assert field.check.expects


# -- what is kept


@each(CASES)
def test_a_new_node_has_the_default(case):
    stand = Stand(case.cls)
    assert same(getattr(stand.node, case.name), case.field.default) or case.name == "data"


@each(MOVABLE)
def test_a_fresh_native_has_the_default_too(case):
    """ODE's own values are those of the table, or those that the node follows; when it is back they are as before."""
    stand = Stand(case.cls)
    before = getattr(stand.node, case.name)
    stand.enter()
    wanted = before if case.name == "data" else value_in_force(case, stand)
    assert same(getattr(stand.node, case.name), wanted)
    stand.leave()
    assert same(getattr(stand.node, case.name), before)


@each(MOVABLE)
def test_a_value_goes_in_and_comes_out_again(case):
    """Set outside, entered, read, left, read, twice."""
    values = accepted(case)
    assert values, f"no value in the pool of strategies.py suits {case}"
    tolerance = ROUNDED.get(case.name, 0.0)
    for value in values:
        stand = Stand(case.cls)
        setattr(stand.node, case.name, value)
        assert same(getattr(stand.node, case.name), value, tolerance)
        for _ in range(2):
            stand.enter()
            assert same(getattr(stand.node, case.name), value, tolerance)
            stand.leave()
            assert same(getattr(stand.node, case.name), value, tolerance)


@each(MOVABLE)
def test_a_value_set_while_live_is_read_and_taken_out(case):
    for value in accepted(case):
        stand = Stand(case.cls)
        stand.enter()
        if case.field.fixed:
            before = getattr(stand.node, case.name)
            with pytest.raises(oo.StateError, match=rf"'it'.*{case.name}.*detach"):
                setattr(stand.node, case.name, value)
            assert same(getattr(stand.node, case.name), before)
            continue
        setattr(stand.node, case.name, value)
        assert same(getattr(stand.node, case.name), value, 1e-15)
        stand.leave()
        assert same(getattr(stand.node, case.name), value, 1e-15)


@each([case for case in CASES if case.cls is oo.World])
def test_a_world_keeps_what_it_is_given(case):
    """It has its native from the start, so its fields are read from ODE at once."""
    for value in accepted(case):
        world = Stand(oo.World).node
        setattr(world, case.name, value)
        assert same(getattr(world, case.name), value)
        assert same(getattr(oo.World(**{case.name: value}), case.name), value)


@each([case for case in MOVABLE if not case.field.fixed])
def test_the_default_can_be_put_back(case):
    """Also while live: then a field that follows the World follows it again."""
    for value in accepted(case):
        stand = Stand(case.cls)
        stand.enter()
        setattr(stand.node, case.name, value)
        setattr(stand.node, case.name, case.field.default)
        assert same(getattr(stand.node, case.name), value_in_force(case, stand), 1e-15)
        stand.leave()
        assert same(getattr(stand.node, case.name), case.field.default, 1e-15)


@each([case for case in MOVABLE if not issubclass(case.cls, oo.Joint | oo.Servo)], live=[False, True])
def test_a_copy_has_the_value_and_lets_go_of_it(case, live):
    """The copy is outside, equal, and independent of its original."""
    for value in accepted(case):
        stand = Stand(case.cls)
        setattr(stand.node, case.name, value)
        if live:
            stand.enter()
        twin = stand.node.copy()
        assert type(twin) is case.cls
        assert not twin.is_live
        assert twin.parent is None
        assert twin.name == "it"
        assert same(getattr(twin, case.name), value, 1e-15)
        setattr(twin, case.name, case.field.default)
        assert same(getattr(stand.node, case.name), value, 1e-15)
        assert same(getattr(twin, case.name), case.field.default)


@pytest.mark.parametrize("cls", [cls for cls in MAKERS if not issubclass(cls, oo.Joint | oo.Servo | oo.World)])
def test_a_copy_of_a_live_node_can_go_to_another_world(cls):
    stand, other = Stand(cls), Stand(cls)
    stand.enter()
    other.node = stand.node.copy()
    other.enter()
    for name in cls.FIELDS:
        assert same(getattr(other.node, name), getattr(stand.node, name), 1e-15), name


def filled(node):
    """Give every field that can be changed a value that isn't the default."""
    given = {}
    for name in node.FIELDS:
        case = Case(type(node), name)
        if case not in CASES or is_exclusive(case) or (node.is_live and case.field.fixed):
            continue
        given[name] = accepted(case)[0]
        setattr(node, name, given[name])
    if "enabled" in given:  # pushing a body has woken it
        node.enabled = given["enabled"]
    return given


def assert_holds(node, given, but=""):
    for name, value in given.items():
        assert name == but or same(getattr(node, name), value, 1e-14), name


@pytest.mark.parametrize("cls", MAKERS)
def test_all_fields_at_once_survive_coming_and_going(cls):
    """No field's way in or out spoils another's."""
    stand = Stand(cls)
    wanted = {case.name for case in CASES if case.cls is cls and not is_exclusive(case)}
    assert set(filled(Stand(cls).node)) == wanted
    given = filled(stand.node)
    assert_holds(stand.node, given)
    if cls is oo.World:
        return
    for _ in range(2):
        stand.enter()
        assert_holds(stand.node, given)
        stand.leave()
        assert_holds(stand.node, given)


WAKES = {"position", "rotation", "linear_velocity", "angular_velocity", "force", "torque", "kinematic"}
"""Setting these wakes a body that sleeps: it is asked to do something."""


@each([case for case in CASES if not is_exclusive(case)], live=[False, True])
def test_setting_one_field_changes_no_other(case, live):
    stand = Stand(case.cls)
    if case.cls is not oo.World and live:
        stand.enter()
    if live and case.field.fixed:
        return
    given = filled(stand.node)
    for value in (*accepted(case), case.field.default):
        setattr(stand.node, case.name, value)
        expected = dict(given)
        if live and case.name in WAKES:
            expected.pop("enabled", None)
        assert_holds(stand.node, expected, but=case.name)
        if "enabled" in given and case.name != "enabled":
            stand.node.enabled = given["enabled"]


# -- what is refused


def assert_refuses(case, node, value):
    before = {name: getattr(node, name) for name in node.FIELDS}
    with pytest.raises(oo.FieldError) as caught:
        setattr(node, case.name, value)
    message = str(caught.value)
    assert message.startswith(f"{node.describe()}.{case.name} is "), message
    assert "it must be " in message
    assert case.field.check.expects in message
    for name, old in before.items():
        assert same(getattr(node, name), old), f"{name} changed"


@each(CASES, live=[False, True])
def test_a_wrong_value_is_refused_and_changes_nothing(case, live):
    """Once with all fields at their defaults, and once with another value in the field itself."""
    stand = Stand(case.cls)
    if live and case.cls is not oo.World:
        stand.enter()
    for value in refused(case):
        assert_refuses(case, stand.node, value)
    if not (live and case.field.fixed):
        setattr(stand.node, case.name, accepted(case)[0])
        assert_refuses(case, stand.node, math.nan)


@each(CASES)
def test_the_message_shows_the_value_in_short(case):
    stand = Stand(case.cls)
    with pytest.raises(oo.FieldError) as caught:
        setattr(stand.node, case.name, ["x" * 10_000])
    assert "xxx" in str(caught.value)
    assert len(str(caught.value)) < 600


def test_a_value_that_can_not_be_shown_is_refused_all_the_same():
    class Odd:
        def __repr__(self):
            raise RuntimeError("no")

    with pytest.raises(oo.FieldError, match="Odd"):
        oo.Body(position=Odd())


def test_an_unknown_field_is_a_type_error_that_knows_better():
    with pytest.raises(TypeError, match=r"Body has no field 'postion'; did you mean 'position'"):
        oo.Body(postion=(1, 2, 3))
    with pytest.raises(TypeError, match=r"has no field 'zzz'; it has .*position"):
        oo.Body(zzz=1)


# -- checks on their own


def test_a_number_may_be_of_any_kind_that_is_one():
    check = number(0, 10)
    for value in (3, 3.0, np.float64(3), np.float32(3), np.int64(3), Fraction(3), Decimal(3)):
        result = check("it", "x", value)
        assert result == 3.0
        assert type(result) is float


def test_a_bool_is_no_number_and_a_number_no_bool():
    with pytest.raises(oo.FieldError):
        number(0, 10)("it", "x", True)
    with pytest.raises(oo.FieldError):
        oo.Body(gravity=1)
    assert oo.Body(gravity=np.bool_(False)).gravity is False


def test_a_vector_may_be_a_list_an_array_or_a_tuple():
    for value in ([1, 2, 3], (1, 2, 3), np.array([1, 2, 3]), np.float32([1, 2, 3]), oo.Vec3(1, 2, 3)):
        result = vector(10)("it", "x", value)
        assert result == (1.0, 2.0, 3.0)
        assert type(result) is oo.Vec3
        assert all(type(part) is float for part in result)


def test_bytes_are_no_vector():
    with pytest.raises(oo.FieldError):
        vector(1000)("it", "x", b"abc")


def test_limits_are_included():
    assert [number(0, 1)("it", "x", v) for v in (0, 1)] == [0.0, 1.0]
    assert [whole(1, 5)("it", "x", v) for v in (1, 5)] == [1, 5]
    assert vector(2)("it", "x", (2, -2, 2)) == (2, -2, 2)
    assert number(0, infinite=True)("it", "x", math.inf) == math.inf
    assert choice("a", "b")("it", "x", "b") == "b"
    assert optional(whole(1, 2))("it", "x", None) is None


def test_a_direction_and_a_rotation_are_normalised():
    plane = oo.Plane((0, 3, 4))
    assert plane.normal == (0, 0.6, 0.8)
    body = oo.Body(rotation=(2, 0, 0, 0))
    assert body.rotation == (1, 0, 0, 0)


def test_a_field_of_the_class_tells_what_it_is():
    """Asked on the class it is the field itself, with its words for the reference."""
    assert "m/s" in oo.Body.linear_velocity.__doc__
    assert oo.Body.linear_velocity is oo.Body.FIELDS["linear_velocity"]


# -- the value of the World, and a value of one's own


@each([case for case in CASES if case.cls is oo.Body and isinstance(case.field, Followed)])
def test_a_body_follows_its_world_until_it_has_a_value_of_its_own(case):
    flag = case.name == "auto_disable"
    first, second, third = (True, False, True) if flag else itertools.islice(itertools.cycle(accepted(case)), 3)
    stand = Stand(oo.Body)
    setattr(stand.world, case.name, first)
    stand.enter()
    assert same(getattr(stand.node, case.name), first)
    setattr(stand.world, case.name, second)
    assert same(getattr(stand.node, case.name), second)
    setattr(stand.node, case.name, third)
    setattr(stand.world, case.name, False if flag else oo.World.FIELDS[case.name].default)
    assert same(getattr(stand.node, case.name), third)
    setattr(stand.node, case.name, None)
    assert same(getattr(stand.node, case.name), getattr(stand.world, case.name))
    stand.leave()
    assert getattr(stand.node, case.name) is None


@each([case for case in CASES if issubclass(case.cls, oo.Joint) and isinstance(case.field, Followed)])
def test_a_joint_follows_its_world_until_it_has_a_value_of_its_own(case):
    stand = Stand(case.cls)
    stand.enter()
    name = of_world(case)
    setattr(stand.world, name, 0.5)
    assert getattr(stand.node, case.name) == 0.5
    setattr(stand.node, case.name, 0.25)
    setattr(stand.world, name, 0.75)
    assert getattr(stand.node, case.name) == 0.25
    setattr(stand.node, case.name, None)
    assert getattr(stand.node, case.name) == 0.75


def test_a_copy_of_a_live_body_follows_its_new_world():
    """The World's values are not written into the copy."""
    stand = Stand(oo.Body)
    stand.world.linear_damping = 0.5
    stand.enter()
    twin = stand.node.copy()
    assert twin.linear_damping is None
    other = oo.World(linear_damping=0.25)
    assert other.attach(twin).linear_damping == 0.25


# -- reprs


@pytest.mark.parametrize("cls", [cls for cls in MAKERS if not issubclass(cls, oo.Joint | oo.Servo)])
def test_a_repr_shows_what_is_not_the_default(cls):
    stand = Stand(cls)
    node = stand.node
    if "data" in cls.FIELDS:
        assert repr(node).startswith(f"{cls.__name__}('it', data=<{type(node.data).__name__}")
        return
    assert repr(node) == f"{cls.__name__}('it')"
    name = next(iter(cls.FIELDS), None)
    if name is None:
        return
    setattr(node, name, accepted(Case(cls, name))[0])
    assert f"{name}=" in repr(node)
    if cls is not oo.World:
        stand.enter()
        assert f"{name}=" in repr(node)
