"""Calls at steps to come: a queue ordered by step, then by priority, then by the order of scheduling."""

from __future__ import annotations

import heapq
import weakref
from collections.abc import Callable
from typing import Any, TypeAlias

Callback: TypeAlias = Callable[[Any], object]

STALE = 64
"""How many cancelled calls the queue may keep, if they are not more than those that are waited for."""

NO_CALLS: dict[ScheduledCall, Callback] = {}


class ScheduledCall:
    """A call that a node will get; made by ``node.schedule()``.

    It keeps neither its node nor the World, nor what it calls: these belong to the World's agenda.
    """

    __slots__ = ("_agenda", "_delay", "_due", "_node", "_priority")

    def __init__(self, agenda: Agenda, node: Any, delay: int, priority: int) -> None:
        self._agenda = weakref.ref(agenda)
        self._node = weakref.ref(node)
        self._delay = delay
        self._priority = priority
        self._due = 0

    @property
    def delay(self) -> int:
        """Steps from scheduling to the call, and between calls if it is repeated."""
        return self._delay

    @property
    def priority(self) -> int:
        """Of two calls due in one step the one with the higher priority comes first."""
        return self._priority

    @property
    def due(self) -> int:
        """The number of the step (`World.steps`) after which it is made."""
        return self._due

    @property
    def pending(self) -> bool:
        """Whether it is still going to be made."""
        agenda = self._agenda()
        return agenda is not None and agenda.knows(self)

    def cancel(self) -> None:
        """Don't make it, or not again; nothing happens if it was made or cancelled before."""
        agenda = self._agenda()
        if agenda is not None:
            agenda.cancel(self)

    def __repr__(self) -> str:
        state = f"after step {self._due}" if self.pending else "done"
        node = self._node()
        whose = "a node that is gone" if node is None else repr(node)
        return f"<ScheduledCall of {whose} {state}, priority {self._priority}>"


class Agenda:
    """The calls that one World's nodes wait for."""

    def __init__(self) -> None:
        self._queue: list[tuple[int, int, int, ScheduledCall]] = []
        """Each with what it is ordered by: its step, its priority the other way round, and a number of its own."""
        self._of: dict[Any, dict[ScheduledCall, Callback]] = {}
        self._count = 0
        self._number = 0

    def __len__(self) -> int:
        return self._count

    def add(self, node: Any, callback: Callback, delay: int, priority: int, now: int) -> ScheduledCall:
        """Queue a call ``delay`` steps after step ``now``."""
        call = ScheduledCall(self, node, delay, priority)
        self._of.setdefault(node, {})[call] = callback
        self._count += 1
        self._queue_up(call, now)
        return call

    def _queue_up(self, call: ScheduledCall, now: int) -> None:
        self._number += 1
        call._due = due = now + call._delay
        heapq.heappush(self._queue, (due, -call._priority, self._number, call))

    def knows(self, call: ScheduledCall) -> bool:
        """Whether it is still waited for."""
        return call in self._of.get(call._node(), ())

    def cancel(self, call: ScheduledCall) -> None:
        """Forget a call."""
        node = call._node()
        calls = self._of.get(node, {})
        if calls.pop(call, None) is not None:
            if not calls:
                del self._of[node]
            self._count -= 1
            self._tidy()

    def drop(self, node: Any) -> None:
        """Forget all calls of a node."""
        self._count -= len(self._of.pop(node, ()))
        self._tidy()

    def _tidy(self) -> None:
        """Take out what was cancelled, once that is most of the queue: it grows else with every call that is."""
        queue = self._queue
        if len(queue) - self._count > max(STALE, self._count):
            queue[:] = [entry for entry in queue if self.knows(entry[3])]
            heapq.heapify(queue)

    def steps_until_due(self, now: int) -> int | None:
        """How many steps may pass before something is due; None if nothing is."""
        queue = self._queue
        while queue and not self.knows(queue[0][3]):
            heapq.heappop(queue)
        return max(queue[0][0] - now, 1) if queue else None

    def make_due(self, now: int) -> list[Exception]:
        """Make the calls that are due after step ``now``; returns what they raised. All of them are made."""
        errors: list[Exception] = []
        queue, calls_of = self._queue, self._of
        while queue and queue[0][0] <= now:
            call = heapq.heappop(queue)[3]
            node = call._node()
            callback = calls_of.get(node, NO_CALLS).get(call)
            if node is None or callback is None:  # cancelled
                continue
            again = False
            try:
                again = callback(node) is True
            except Exception as error:  # noqa: BLE001 - the others' turn comes first, then it is raised
                error.add_note(f"raised by a scheduled call of {node.describe()} ({node.path})")
                errors.append(error)
            except BaseException:
                self.cancel(call)
                raise
            if call in calls_of.get(node, NO_CALLS):  # it may have been cancelled by what it did
                if again:
                    self._queue_up(call, now)
                else:
                    self.cancel(call)
        return errors
