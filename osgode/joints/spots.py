"""What joints show of themselves: anchors and axes that bodies carry along, and coordinates that are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self, overload

from osgode.fields import DIRECTION, POSITION_LIMIT, Check, vector
from osgode.maths import Vec3, Vec3Like

if TYPE_CHECKING:
    from osgode.joints.base import Joint

POINT: Check[Vec3] = vector(POSITION_LIMIT)

BODY1, BODY2 = 0, 1


class Spot:
    """A point or direction of the world at rest, which one of the bodies carries along.

    Setting it anchors the joint anew, see `Joint.anchor_anew`.

    Args:
        side: `BODY1` or `BODY2`: whose it is.
        doc: one sentence for the reference.
    """

    check: Check[Vec3]
    is_point: bool

    def __init__(self, side: int, doc: str) -> None:
        self.side = side
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, joint: None, owner: type) -> Self: ...
    @overload
    def __get__(self, joint: Joint, owner: type) -> Vec3: ...
    def __get__(self, joint: Joint | None, owner: type) -> Vec3 | Self:
        return self if joint is None else joint._seen(self.name)

    def __set__(self, joint: Joint, value: Vec3Like) -> None:
        joint.anchor_anew(**{self.name: value})


class Anchor(Spot):
    """A point, metres in the world."""

    check = POINT
    is_point = True


class Axis(Spot):
    """A direction, a unit vector in the world."""

    check = DIRECTION
    is_point = False


class Seen:
    """The same spot, as the other side sees it; it can't be set.

    Args:
        spot: its name.
        side: who sees it.
        doc: one sentence for the reference.
    """

    def __init__(self, spot: str, side: int, doc: str) -> None:
        self.spot = spot
        self.side = side
        self.__doc__ = doc

    @overload
    def __get__(self, joint: None, owner: type) -> Self: ...
    @overload
    def __get__(self, joint: Joint, owner: type) -> Vec3: ...
    def __get__(self, joint: Joint | None, owner: type) -> Vec3 | Self:
        return self if joint is None else joint._seen(self.spot, self.side)

    def __set__(self, joint: Joint, value: object) -> None:
        raise AttributeError(f"{joint.describe()}: set {self.spot} instead: this is the same as its other side has it")


class Coordinate:
    """An angle, a position, or how fast one changes; raises StateError while the joint isn't live.

    Args:
        row: "position" or "rate" of the C core's row.
        index: in it.
        unit: for the reference.
        doc: one sentence for the reference.
    """

    def __init__(self, row: str, index: int, unit: str, doc: str) -> None:
        self.row = row
        self.index = index
        self.unit = unit
        self.__doc__ = f"{doc} [{unit}]"

    @classmethod
    def angle(cls, index: int, doc: str) -> Self:
        """An angle, radians within +-pi."""
        return cls("position", index, "rad", doc)

    @classmethod
    def angle_rate(cls, index: int, doc: str) -> Self:
        """How fast an angle grows."""
        return cls("rate", index, "rad/s", doc)

    @classmethod
    def position(cls, index: int, doc: str) -> Self:
        """A way along an axis, or a length."""
        return cls("position", index, "m", doc)

    @classmethod
    def position_rate(cls, index: int, doc: str) -> Self:
        """How fast a position grows."""
        return cls("rate", index, "m/s", doc)

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, joint: None, owner: type) -> Self: ...
    @overload
    def __get__(self, joint: Joint, owner: type) -> float: ...
    def __get__(self, joint: Joint | None, owner: type) -> float | Self:
        if joint is None:
            return self
        return float(getattr(joint._read(self.name), self.row)[self.index]) + 0.0  # never -0.0

    def __set__(self, joint: Joint, value: object) -> None:
        raise AttributeError(f"{joint.describe()}.{self.name} can't be set: it follows from how the bodies stand")
