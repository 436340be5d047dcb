"""Calling listeners, so that one that fails keeps nobody from hearing."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

Call: TypeAlias = tuple[Callable[[Any], object], Any]
"""A listener and what it is told."""


def errors_of(calls: Iterable[Call], kind: str, note: Callable[[Any], str]) -> list[Exception]:
    """Call all listeners, and return what they raised.

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
    return errors


def raise_all(words: str, errors: list[Exception]) -> None:
    """Raise what listeners raised, if any did: the one error, or all in an ExceptionGroup with these words."""
    if len(errors) == 1:
        raise errors[0]
    if errors:
        raise ExceptionGroup(words, errors)


def errors_of_let_go(calls: Iterable[Call]) -> list[Exception]:
    """Call the listeners of joints that have let go, and return what they raised."""
    return errors_of(calls, "joint", lambda event: f"{event.joint.describe()}, which {event.reason}")


def tell_let_go(calls: Iterable[Call]) -> None:
    """Call the listeners of joints that have let go; then raise what they raised."""
    raise_all("several joint listeners failed", errors_of_let_go(calls))
