"""The weapons that somebody carries: one in the hand, the others put away."""

from __future__ import annotations

import osgode as oo
from osgode.examples.game.weapon import Aim, Weapon


class Arsenal:
    """What a hand has picked up. At most one weapon of each slot, and one in the hand.

    Whoever owns it lets it decide in ``pick_up(weapon)``, and forwards keys and buttons.

    Args:
        hand: the body that holds weapons; it looks along its own -Z.
        grip: where in its axes, metres.
    """

    def __init__(self, hand: oo.Body, grip: oo.Vec3Like = (0.0, 0.0, 0.0)) -> None:
        self.hand = hand
        self.grip = oo.Vec3(*grip)
        self._weapons: dict[int, Weapon] = {}
        self._last: Weapon | None = None

    @property
    def weapons(self) -> dict[int, Weapon]:
        """The weapons by their slots, in the order of these, but for what was dropped, or lost with the hand."""
        return {slot: self._weapons[slot] for slot in sorted(self._weapons) if self._weapons[slot].hand is self.hand}

    @property
    def in_hand(self) -> Weapon | None:
        """The weapon in the hand."""
        return next((weapon for weapon in self.weapons.values() if weapon.held), None)

    def pick_up(self, weapon: Weapon) -> bool:
        """Take a weapon into the hand, and put away the one that is there, unless a button is down.

        Returns:
            Whether it was taken: not if there is one of its slot already.
        """
        if weapon.SLOT in self.weapons or weapon.hand is not None:
            return False
        busy = self.in_hand
        if busy is not None and not busy.charging:
            busy.stow()
        weapon.hold(self.hand, self.grip)
        if busy is not None and busy.held:
            weapon.stow()
        self._weapons[weapon.SLOT] = weapon
        return True

    def switch(self, slot: int) -> bool:
        """Take the weapon of a slot into the hand and put away the one that is there.

        Returns:
            Whether there is such a weapon, and a hand for it; if not, nothing changes.
        """
        wanted = self.weapons.get(slot)
        if wanted is None or not self.hand.is_live:  # whoever sits in a car has no hand to spare
            return False
        if not wanted.held:
            self.put_away()
            wanted.draw()
        return True

    def next(self, step: int = 1) -> bool:
        """Take the next weapon, or one so many farther on; after the last comes the first.

        Returns:
            Whether there is any.
        """
        slots = list(self.weapons)
        if not slots:
            return False
        current = self.in_hand
        place = slots.index(current.SLOT) + step if current is not None else 0
        return self.switch(slots[place % len(slots)])

    def put_away(self) -> None:
        """Have nothing in the hand: to be called before whoever it belongs to leaves the World."""
        self._last = self.in_hand
        if self._last is not None:
            self._last.stow()

    def take_out(self) -> None:
        """Have the weapon in the hand that was put away last, if none is there."""
        if self.in_hand is None and self._last is not None and self._last.hand is self.hand:
            self._last.draw()

    def drop(self) -> Weapon | None:
        """Let the weapon in the hand fall, and return it; None if there is none."""
        weapon = self.in_hand
        if weapon is not None:
            weapon.drop()
            del self._weapons[weapon.SLOT]
        return weapon

    def press(self, button: str) -> None:
        """A button, "left" or "right", goes down."""
        if (weapon := self.in_hand) is not None:
            weapon.press(button)

    def release(self, button: str, aim: Aim) -> None:
        """It comes up; ``aim``: origin and direction of the camera's aiming ray."""
        if (weapon := self.in_hand) is not None:
            weapon.release(button, aim)
