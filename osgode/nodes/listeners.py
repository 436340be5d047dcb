"""Calling listeners, so that one that fails keeps nobody from hearing."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

Call: TypeAlias = tuple[Callable[[Any], object], Any]
"""A listener and what it is told."""


def tell(calls: Iterable[Call], kind: str, note: Callable[[Any], str]) -> None:
    """Call all listeners; then raise the error of the one that failed, or those of several in an ExceptionGroup.

    Args:
        calls: all of them are known before the first is called.
        kind: of listeners, for the message.
        note: what is added to an error, from what the listener was told.
    """
    errors: list[Exception] = []
    for call, event in list(calls):
        try:
            call(event)
        except Exception as error:  # noqa: BLE001 - every listener is heard before the errors are raised
            error.add_note(f"raised by a {kind} listener of {note(event)}")
            errors.append(error)
    raise_all(kind, errors)


def raise_all(kind: str, errors: list[Exception]) -> None:
    """Raise what listeners raised, if any did: the one error, or all in an ExceptionGroup."""
    if len(errors) == 1:
        raise errors[0]
    if errors:
        raise ExceptionGroup(f"several {kind} listeners failed", errors)


def tell_let_go(calls: Iterable[Call]) -> None:
    """Call the listeners of joints that have let go."""
    tell(calls, "joint", lambda event: f"{event.joint.describe()}, which {event.reason}")
