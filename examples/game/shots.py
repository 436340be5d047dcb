"""What a gun has shot: things that fly, lie about for a while, and are taken away when they are old or too many."""

from __future__ import annotations

from collections.abc import Sequence

import osgode as oo
from osgode.examples.game.weapon import is_part_of

LIFETIME = 20.0
"""Seconds after which a shot is taken away."""
MOST = 250
"""Shots of one gun at a time; the oldest goes when there are more."""
SPARED_FOR = 0.25
"""Seconds in which a shot passes through whoever shot it."""


class Shots:
    """The shots of one gun, the oldest first.

    Args:
        lifetime: of each, seconds.
        most: how many there may be.
    """

    def __init__(self, lifetime: float = LIFETIME, most: int = MOST) -> None:
        self.lifetime = lifetime
        self.most = most
        self._alive: dict[oo.Body, None] = {}

    @property
    def alive(self) -> tuple[oo.Body, ...]:
        """Those that are there, the oldest first; what somebody else has taken away is not."""
        for body in [body for body in self._alive if not body.is_live]:
            del self._alive[body]
        return tuple(self._alive)

    def send(self, space: oo.Space, body: oo.Body, spares: Sequence[oo.PhysicsNode] = ()) -> oo.Body:
        """Let a body fly, with the velocity that it has, and return it.

        Args:
            space: that it comes into.
            body: it is followed on its way, so that it passes through nothing.
            spares: bodies and spaces that it passes through at first.
        """
        body.tunnelling = "sweep"
        spared = list(spares)

        def spare(feedback: oo.CollisionFeedback) -> None:
            if is_part_of(feedback.other, spared):
                feedback.refuse()

        space.attach(body)
        if spared:
            body.on_collide(spare)
            body.schedule(lambda shot: shot.remove_on_collide(spare), seconds=SPARED_FOR)
        body.schedule(self.take_away, seconds=self.lifetime)
        self._alive[body] = None
        for old in self.alive[: -self.most]:
            self.take_away(old)
        return body

    def take_away(self, body: oo.Body) -> None:
        """Remove one of them; nothing happens if it is gone."""
        self._alive.pop(body, None)
        if body.parent is not None:
            body.parent.detach(body)

    def clear(self) -> None:
        """Remove all."""
        for body in self.alive:
            self.take_away(body)
