"""Calls at steps to come: a queue ordered by step, then by priority, then by the order of scheduling."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from typing import Any, TypeAlias

Callback: TypeAlias = Callable[[Any], object]


class ScheduledCall:
    """A call that a node will get; made by ``node.schedule()``."""

    __slots__ = ("_agenda", "_callback", "_node", "_number", "delay", "due", "priority")

    def __init__(self, agenda: Agenda, node: Any, callback: Callback, delay: int, priority: int) -> None:
        self._agenda = agenda
        self._node = node
        self._callback = callback
        self._number = 0
        self.delay = delay
        """Steps from scheduling to the call, and between calls if it is repeated."""
        self.priority = priority
        """Of two calls due in one step the one with the higher priority comes first."""
        self.due = 0
        """The number of the step (`World.steps`) after which it is made."""

    @property
    def pending(self) -> bool:
        """Whether it is still going to be made."""
        return self._agenda.knows(self)

    def cancel(self) -> None:
        """Don't make it, or not again; nothing happens if it was made or cancelled before."""
        self._agenda.cancel(self)

    def __lt__(self, other: ScheduledCall) -> bool:
        return (self.due, -self.priority, self._number) < (other.due, -other.priority, other._number)

    def __repr__(self) -> str:
        state = f"after step {self.due}" if self.pending else "done"
        return f"<ScheduledCall of {self._node!r} {state}, priority {self.priority}>"


class Agenda:
    """The calls that one World's nodes wait for."""

    def __init__(self) -> None:
        self._queue: list[ScheduledCall] = []
        self._of: dict[Any, dict[ScheduledCall, None]] = {}
        self._number = 0

    def __len__(self) -> int:
        return sum(map(len, self._of.values()))

    def add(self, node: Any, callback: Callback, delay: int, priority: int, now: int) -> ScheduledCall:
        """Queue a call ``delay`` steps after step ``now``."""
        call = ScheduledCall(self, node, callback, delay, priority)
        self._queue_up(call, now)
        return call

    def _queue_up(self, call: ScheduledCall, now: int) -> None:
        self._number += 1
        call.due, call._number = now + call.delay, self._number
        self._of.setdefault(call._node, {})[call] = None
        heapq.heappush(self._queue, call)

    def knows(self, call: ScheduledCall) -> bool:
        """Whether it is still waited for."""
        return call in self._of.get(call._node, ())

    def cancel(self, call: ScheduledCall) -> None:
        """Forget a call."""
        calls = self._of.get(call._node, {})
        calls.pop(call, None)
        if not calls:
            self._of.pop(call._node, None)

    def drop(self, node: Any) -> None:
        """Forget all calls of a node."""
        self._of.pop(node, None)

    def steps_until_due(self, now: int) -> int | None:
        """How many steps may pass before something is due; None if nothing is."""
        queue = self._queue
        while queue and not self.knows(queue[0]):
            heapq.heappop(queue)
        return max(queue[0].due - now, 1) if queue else None

    def make_due(self, now: int) -> list[Exception]:
        """Make the calls that are due after step ``now``; returns what they raised. All of them are made."""
        errors: list[Exception] = []
        queue = self._queue
        while queue and queue[0].due <= now:
            call = heapq.heappop(queue)
            if not self.knows(call):
                continue
            again = False
            try:
                again = call._callback(call._node) is True
            except Exception as error:  # noqa: BLE001 - the others' turn comes first, then it is raised
                error.add_note(f"raised by a scheduled call of {call._node.describe()} ({call._node.path})")
                errors.append(error)
            except BaseException:
                self.cancel(call)
                raise
            if self.knows(call):  # it may have been cancelled by what it did
                if again:
                    self._queue_up(call, now)
                else:
                    self.cancel(call)
        return errors
