"""Angles within limits, and wishes to move."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.engine import Controllable
from osgode.engine.controllable import MOVES
from osgode.errors import FieldError
from osgode.maths import Quat, Vec3

ANGLES = st.floats(-50, 50)
SIDES = st.sets(st.sampled_from(sorted(MOVES)))


def close(one, other, within=1e-9):
    return Vec3(*one).distance(other) < within


@given(ANGLES)
def test_free_angles_wrap(angle):
    """Without limits an angle is kept within half a turn to either side, and means the same."""
    thing = Controllable(pitch_limits=None)
    for name in ("yaw", "pitch", "roll"):
        setattr(thing, name, angle)
        kept = getattr(thing, name)
        assert -math.pi <= kept <= math.pi
        assert math.cos(kept) == pytest.approx(math.cos(angle), abs=1e-9)
        assert math.sin(kept) == pytest.approx(math.sin(angle), abs=1e-9)


@given(ANGLES, ANGLES, ANGLES)
def test_limits_hold(yaw, pitch, roll):
    """Set or turned beyond its limit an angle stays there."""
    for act in ("set", "turn"):
        thing = Controllable(yaw_limits=(-1.0, 2.0), pitch_limits=(-0.5, 0.5), roll_limits=(0.1, 0.1))
        if act == "set":
            thing.yaw, thing.pitch, thing.roll = yaw, pitch, roll
        else:
            thing.turn(yaw, pitch, roll)
        assert thing.yaw == min(max(yaw, -1.0), 2.0)
        assert thing.pitch == min(max(pitch, -0.5), 0.5)
        assert thing.roll == 0.1


def test_pitch_is_limited_to_straight_up_and_down():
    thing = Controllable()
    thing.pitch = 3.0
    assert thing.pitch == math.pi / 2
    thing.turn(pitch=-10.0)
    assert thing.pitch == -math.pi / 2


def test_limits_that_leave_zero_out():
    """A new one begins within its limits."""
    assert Controllable(yaw_limits=(0.5, 1.0)).yaw == 0.5
    assert Controllable(pitch_limits=(-1.0, -0.5)).pitch == -0.5


@pytest.mark.parametrize("name", ["yaw", "pitch", "roll"])
@pytest.mark.parametrize("limits", [(1.0, -1.0), (0.0,), 3, "ab", (math.nan, 1.0), (0, 1, 2), (None, 1)])
def test_bad_limits(name, limits):
    with pytest.raises(FieldError, match=f"Controllable.{name}_limits"):
        Controllable(**{f"{name}_limits": limits})


@pytest.mark.parametrize("wrong", [math.nan, math.inf, "1", None, (1,), 1e7])
def test_bad_angles(wrong):
    """What is no angle is refused; nothing has been turned then."""
    thing = Controllable()
    for name in ("yaw", "pitch", "roll"):
        with pytest.raises(FieldError, match=name):
            setattr(thing, name, wrong)
    with pytest.raises(FieldError, match=r"turn\(\).roll"):
        thing.turn(0.1, 0.2, wrong)
    assert (thing.yaw, thing.pitch, thing.roll) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("angles", "vector", "seen"),
    [
        ((math.pi / 2, 0, 0), (0, 0, -1), (-1, 0, 0)),  # to the left
        ((0, math.pi / 2, 0), (0, 0, -1), (0, 1, 0)),  # up
        ((0, 0, math.pi / 2), (0, 1, 0), (-1, 0, 0)),  # its head to the left
        ((math.pi / 2, math.pi / 4, 0), (0, 0, -1), (-math.sqrt(0.5), math.sqrt(0.5), 0)),
        ((math.pi, 0, 0), (1, 0, 0), (-1, 0, 0)),
    ],
)
def test_signs_of_angles(angles, vector, seen):
    """Yaw turns to the left, pitch up, roll to the left; yaw is outermost."""
    thing = Controllable()
    thing.yaw, thing.pitch, thing.roll = angles
    assert close(thing.rotation.rotate(vector), seen)


@given(SIDES, ANGLES, st.floats(-1.5, 1.5), ANGLES)
def test_the_movement_that_follows_from_wishes(wishes, yaw, pitch, roll):
    """The sum of the wishes at length 1, by all angles or by the yaw alone; opposite ones cancel."""
    thing = Controllable()
    thing.yaw, thing.pitch, thing.roll = yaw, pitch, roll
    thing.move(**dict.fromkeys(wishes, True))
    assert thing.moves == wishes
    x = ("right" in wishes) - ("left" in wishes)
    y = ("ascend" in wishes) - ("descend" in wishes)
    z = ("backward" in wishes) - ("forward" in wishes)
    length = math.hypot(x, y, z) or 1.0
    wanted = Vec3(x / length, y / length, z / length)
    assert close(thing.wish, wanted)
    assert close(thing.movement, Quat.from_yaw_pitch_roll(yaw, pitch, roll).rotate(wanted))
    along = math.hypot(x, z) or 1.0  # who jumps doesn't walk slower
    assert close(thing.level_movement, Quat.from_yaw_pitch_roll(yaw).rotate((x / along, 0.0, z / along)))
    thing.stop()
    assert thing.moves == frozenset()
    assert thing.wish == Vec3(0, 0, 0)


def test_wishes_stay_until_they_are_taken_back():
    thing = Controllable()
    thing.move(forward=True)
    thing.move(left=True)
    assert thing.moves == {"forward", "left"}
    thing.move(forward=False, right=False)
    assert thing.moves == {"left"}


def test_bad_ways():
    """An unknown way is named, and none of the call's wishes counts."""
    thing = Controllable()
    with pytest.raises(FieldError, match=r"'foward'.*forward, backward"):
        thing.move(left=True, foward=True)
    assert thing.moves == frozenset()
