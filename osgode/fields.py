"""The field table: what state a node has, who owns it, and what values it may take.

A field is declared once, in its class. Outside a World the node's record holds the value; inside, ODE
does, and the field's ``read`` and ``write`` reach it there. The same table makes copies, reprs, the
round-trip tests and the reference.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Generic, Protocol, Self, TypeVar, overload

import numpy as np

from osgode.errors import FieldError, StateError, shown
from osgode.maths import Quat, QuatLike, Vec3, Vec3Like, vec3

ValueT = TypeVar("ValueT")
InputT = TypeVar("InputT")

POSITION_LIMIT = 1e8
"""Metres: farther out ODE's hash space can't count its cells in 31 bits."""
OFFSET_LIMIT = 2.5e7
"""Metres of a part, or of the centre of mass, from its frame: so no geom of a body within bounds is out of them."""
VELOCITY_LIMIT = 1e9
SIZE_LIMITS = (1e-6, 1e7)
SMALLEST = 1e-12
"""The smallest mass (kg), inertia (kg m2) and CFM that ODE computes with safely."""


class Home(Protocol):
    """What a live node's natives live in (`osgode.nodes.realm.Realm`)."""

    busy: bool

    def editing(self) -> AbstractContextManager[object]:
        """Hold the World for a change, or raise StateError."""

    def holding(self) -> AbstractContextManager[object]:
        """The same for a change that moves nothing."""


class Owner(Protocol):
    """What has fields."""

    _realm: Any
    _record: dict[str, Any]

    def describe(self) -> str:
        """What messages call it."""


UNFIT = (TypeError, ValueError, OverflowError, KeyError)
"""What a conversion raises for a value that is not accepted."""


@dataclass(frozen=True)
class Check(Generic[ValueT]):
    """What an attribute accepts: a conversion that raises for anything else, and the words for it."""

    expects: str
    convert: Callable[[Any], ValueT]

    def __call__(self, owner: str, name: str, value: object) -> ValueT:
        """The value as it is kept.

        Raises:
            FieldError: naming the owner, the attribute, the value and what would be right.
        """
        try:
            return self.convert(value)
        except UNFIT as error:
            raise FieldError(f"{owner}.{name} is {shown(value)}; it must be {self.expects}") from error


class Field(Generic[ValueT, InputT]):
    """A descriptor for one datum of a node.

    Args:
        default: the value of a new node.
        check: what it accepts.
        read: gets it from the native of a live node.
        write: gives it to the native of a live node.
        fixed: whether it can't be changed while the node is in a World.
        after: name of a method to call when it has changed; if that raises, the old value comes back.
        quiet: whether a change moves nothing: then the next step need not look at everything anew.
        unit: for the reference.
        doc: one sentence for the reference.
    """

    def __init__(
        self,
        default: ValueT,
        check: Check[ValueT],
        read: Callable[[Any], ValueT] | None = None,
        write: Callable[[Any, ValueT], object] | None = None,
        *,
        after: str = "",
        fixed: bool = False,
        quiet: bool = False,
        unit: str = "",
        doc: str = "",
    ) -> None:
        self.default = default
        self.check = check
        self.read = read
        self.write = write
        self.after = after
        self.fixed = fixed
        self.quiet = quiet
        self.unit = unit
        self.__doc__ = doc + (f" [{unit}]" if unit else "")

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, node: None, owner: type) -> Self: ...
    @overload
    def __get__(self, node: Owner, owner: type) -> ValueT: ...
    def __get__(self, node: Owner | None, owner: type) -> ValueT | Self:
        if node is None:
            return self
        realm = node._realm
        if realm is None or self.read is None:
            return node._record.get(self.name, self.default)  # type: ignore[no-any-return]
        if realm.busy:
            raise busy_error(node, self.name)
        return self.read(node)

    def __set__(self, node: Owner, value: InputT) -> None:
        checked = self.checked(node, value)
        realm = node._realm
        if realm is None:
            self._change(node, checked)
        else:
            if self.fixed:
                raise StateError(
                    f"{node.describe()}.{self.name} can't be changed while it is in a World; "
                    "detach it first, or make a new one"
                )
            with realm.holding() if self.quiet else realm.editing():
                self._change(node, checked)

    def checked(self, node: Owner, value: object) -> ValueT:
        """The value as ``node`` would keep it.

        Raises:
            FieldError: if it isn't accepted.
        """
        try:
            return self.check.convert(value)
        except UNFIT as error:  # only now: putting the words together takes longer than most conversions
            raise FieldError(
                f"{node.describe()}.{self.name} is {shown(value)}; it must be {self.check.expects}"
            ) from error

    def _change(self, node: Owner, value: ValueT) -> None:
        if not self.after:
            self._put(node, value)
            return
        old = self.own(node)
        self._put(node, value)
        try:
            getattr(node, self.after)()
        except BaseException:
            self._put(node, old)
            getattr(node, self.after)()
            raise

    def _put(self, node: Owner, value: ValueT) -> None:
        if node._realm is not None and self.write is not None:
            self.write(node, value)
        else:
            node._record[self.name] = value

    def own(self, node: Owner) -> ValueT:
        """The value that the node itself has, as a copy of it is given."""
        return self.__get__(node, type(node))

    def enter(self, node: Owner) -> None:
        """Give the recorded value to the native that was just made."""
        if self.write is not None:
            # Checked again: what a node took along from a World that went wrong may be NaN.
            value = node._record.get(self.name, self.default)
            self.write(node, self.checked(node, value))

    def leave(self, node: Owner) -> None:
        """Take the value from the native that is about to go."""
        if self.read is not None:
            value = self.read(node)
            if value != self.default:
                node._record[self.name] = value
            else:
                node._record.pop(self.name, None)


class Followed(Field[Any, Any]):
    """A field that follows the World until the node is given a value of its own; None makes it follow again.

    Args:
        check: what an own value may be.
        read: gets the value in force from the native of a live node.
        put: gives a value to that native.
        follow: the World's value for a live node.
    """

    def __init__(
        self,
        check: Check[Any],
        read: Callable[[Any], Any],
        put: Callable[[Any, Any], object],
        follow: Callable[[Any, str], Any],
        *,
        unit: str = "",
        doc: str = "",
    ) -> None:
        super().__init__(None, optional(check), read, put, unit=unit, doc=doc + " None: the World's.")
        self.put = put
        self.follow = follow

    def _put(self, node: Owner, value: Any) -> None:
        if value is None:
            node._record.pop(self.name, None)
        else:
            node._record[self.name] = value
        if node._realm is not None:
            self.enter(node)

    def own(self, node: Owner) -> Any:
        """The node's own value, None while it follows the World."""
        return node._record.get(self.name)

    def enter(self, node: Owner) -> None:
        """Give the native its own value, or the World's."""
        own = node._record.get(self.name)
        self.put(node, self.follow(node, self.name) if own is None else own)

    def leave(self, node: Owner) -> None:
        """Nothing: the node's own value is in its record all the time."""


def busy_error(node: Owner, name: str) -> StateError:
    """The error for touching a World from a second thread."""
    return StateError(
        f"{node.describe()}.{name} was asked for while another thread is inside a step of its World; "
        "use one thread per World, or wait for the step to return"
    )


def fields_of(cls: type) -> dict[str, Field[Any, Any]]:
    """The fields of a class in the order of their declaration, base classes first."""
    table: dict[str, Field[Any, Any]] = {}
    for base in reversed(cls.__mro__):
        table.update({name: value for name, value in vars(base).items() if isinstance(value, Field)})
    return table


# -- checks


NO_NUMBERS = (str, bytes, bool, np.bool_, np.complexfloating)
"""What ``float`` takes, but is none: numpy drops the imaginary part with a warning."""


def _float(value: Any) -> float:
    if value.__class__ is float:
        return value
    if isinstance(value, NO_NUMBERS):
        raise TypeError
    return float(value)


def number(low: float = -math.inf, high: float = math.inf, *, infinite: bool = False) -> Check[float]:
    """A float from ``low`` to ``high``; finite unless ``infinite``."""
    least, most = (low, high) if infinite else (max(low, -sys.float_info.max), min(high, sys.float_info.max))

    def convert(value: object) -> float:
        result = value if value.__class__ is float else _float(value)
        if not least <= result <= most:
            raise ValueError
        return result

    kind = "a number" if infinite else "a finite number"
    if math.isfinite(low) and math.isfinite(high):
        return Check(f"a number from {low:g} to {high:g}", convert)
    if math.isfinite(low):
        return Check(f"{kind} of at least {low:g}", convert)
    return Check(kind, convert)


def whole(low: int, high: int) -> Check[int]:
    """A whole number from ``low`` to ``high``."""

    def convert(value: object) -> int:
        result = int(_float(value))
        if result != value or not low <= result <= high:
            raise ValueError
        return result

    return Check(f"a whole number from {low} to {high}", convert)


def _flag(value: object) -> bool:
    if value is True or value is False:
        return value
    if type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    raise TypeError


FLAG: Check[bool] = Check("True or False", _flag)


def _unpackable(value: Any) -> Any:
    if isinstance(value, bytes | bytearray | set | frozenset | dict):  # of numbers perhaps, but not in an order
        raise TypeError
    return value


def three(value: Sequence[Any]) -> Vec3:
    """Three finite floats of any sequence.

    Raises:
        ValueError: for another length or a number that is not finite.
    """
    x, y, z = value if value.__class__ is Vec3 or value.__class__ is tuple else _unpackable(value)
    x, y, z = numbers = _float(x), _float(y), _float(z)
    if not math.isfinite(x + y + z):
        raise ValueError
    return vec3(numbers)


def vector(limit: float) -> Check[Vec3]:
    """Three floats, each within +-``limit``."""

    def convert(value: Any) -> Vec3:
        x, y, z = result = three(value)
        if not (-limit <= x <= limit and -limit <= y <= limit and -limit <= z <= limit):
            raise ValueError
        return result

    return Check(f"three finite numbers within +-{limit:g}", convert)


def _direction(value: Any) -> Vec3:
    result = three(value)
    length = result.length
    if not SMALLEST < length < math.inf:
        raise ValueError
    return result / length


DIRECTION: Check[Vec3] = Check("a direction: three finite numbers, not all 0", _direction)


def _rotation(value: Any) -> Quat:
    w, x, y, z = _unpackable(value)
    result = Quat(_float(w), _float(x), _float(y), _float(z))
    norm = math.hypot(*result)
    if not 1e-6 < norm < 1e6:
        raise ValueError
    # A quaternion that came from ODE must go back as the same bits.
    return result if abs(norm - 1.0) < 1e-15 else result.normalized()


ROTATION: Check[Quat] = Check("a quaternion (w, x, y, z) that is not 0", _rotation)


def _size(value: Any) -> Vec3:
    result = three(value)
    if not all(SIZE_LIMITS[0] <= s <= SIZE_LIMITS[1] for s in result):
        raise ValueError
    return result


SIZE: Check[Vec3] = Check(f"three lengths from {SIZE_LIMITS[0]:g} to {SIZE_LIMITS[1]:g} m", _size)
LENGTH: Check[float] = number(*SIZE_LIMITS)


def choice(*names: str) -> Check[str]:
    """One of some words."""

    def convert(value: object) -> str:
        if value not in names:
            raise ValueError
        return str(value)

    return Check("one of " + ", ".join(map(repr, names)), convert)


def optional(check: Check[ValueT]) -> Check[ValueT | None]:
    """What ``check`` takes, or None."""
    return Check(f"{check.expects}, or None", lambda value: None if value is None else check.convert(value))


VectorField = Field[Vec3, Vec3Like]
RotationField = Field[Quat, QuatLike]
NumberField = Field[float, float]
FlagField = Field[bool, bool]
WholeField = Field[int, int]
