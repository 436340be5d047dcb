"""What the parts of an App have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

from osgode.errors import FieldError, StateError, shown
from osgode.fields import Check

if TYPE_CHECKING:
    from osgode.engine.app import App


@dataclass(frozen=True, kw_only=True)
class Config:
    """Settings of a module, which are checked when they are made; configs nest as modules do."""

    CHECKS: ClassVar[dict[str, Check[Any]]] = {}
    """What each setting may be; those that aren't named are checked by their module."""

    def __post_init__(self) -> None:
        for name, check in self.CHECKS.items():
            object.__setattr__(self, name, check(type(self).__name__, name, getattr(self, name)))
        for field in fields(self):
            value, kind = getattr(self, field.name), field.default_factory
            wanted = Mapping if kind is dict else kind
            if isinstance(wanted, type) and not isinstance(value, wanted):
                raise FieldError(
                    f"{type(self).__name__}.{field.name} is {shown(value)}; it must be a {wanted.__name__}"
                )

    @classmethod
    def given(cls, config: Self | None, owner: str) -> Self:
        """``config``, or the settings that all have at first if it is None.

        Raises:
            FieldError: if it is anything else.
        """
        if config is None:
            return cls()
        if not isinstance(config, cls):
            raise FieldError(f"{owner}.config is {shown(config)}; it must be of the class {cls.__name__}")
        return config


class Module:
    """A part of an `App`: it is started once, has its turn in each frame, and is stopped in the end.

    A subclass names itself and what it can't be without, and overrides what it needs of `start`, `cycle` and `stop`.
    """

    NAME: ClassVar[str] = ""
    """What the App knows it by; one module of each name."""
    NEEDS: ClassVar[tuple[str, ...]] = ()
    """Names of modules that must have been started before."""

    _app: App | None = None

    @property
    def app(self) -> App:
        """The App that it is a part of.

        Raises:
            StateError: before it was started, and after it was stopped.
        """
        if self._app is None:
            raise StateError(f"{self.describe()} is not started: it has no App yet, or no longer")
        return self._app

    def describe(self) -> str:
        """What messages call it."""
        return f"{type(self).__name__} (module {self.NAME!r})"

    def start(self) -> None:
        """Get ready; `app` and the modules in `NEEDS` are there. What it raises ends the App."""

    def cycle(self) -> None:
        """Do what is to be done in a frame."""

    def stop(self) -> None:
        """Give everything back. Called once if `start` was called, even if that failed or something else did."""
