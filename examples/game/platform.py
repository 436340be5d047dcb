"""A button, and a platform that it sets going."""

from __future__ import annotations

import math
from collections.abc import Callable

import osgode as oo
from osgode.engine import CompositeObject
from osgode.examples.runner import look, painted

BUTTON = (0.9, 0.08, 0.9)
"""Size of the button, metres."""
DEEP, PRESSED = 0.07, 0.05
"""How far it can be pressed, and from where on that counts, metres."""
HOLD = 220.0
"""The force that holds it up, N: a crate doesn't press it, a grown man does."""
RETURN_ERP = 0.02
"""How much of its way back it is pushed out in a step, of what is left."""
UNLOADED = 30
"""Steps that it must stay out before it can be pressed again: nothing lies on it then."""

SIZE = (2.4, 0.25, 2.4)
"""Of the platform, metres."""
MASS, FORCE = 500.0, 60_000.0
"""Its mass, kg, and the force that it may use, N."""
SPEED, ACCELERATION = 1.6, 1.2
"""How fast it goes, m/s, and how it gets there, m/s2: gently enough for who stands on it."""
SETTLING = 5.0
"""How fast it closes the last millimetres: m/s for each metre that is left."""
WAIT = 2.5
"""How long it waits at each end, seconds."""


class Button(CompositeObject):
    """A box on a slider that is pressed by weight or by what falls on it, and comes out again by itself.

    It is pushed out by a stop: its lower limit is set to the top, which the pressed button violates, and a small ERP
    lets the solver correct that slowly. Only when it stays out by itself, with nothing on it, can it be pressed again.

    Args:
        position: of the middle of its top when it is out, metres in the world; below that it needs room for its own
            height and for being pressed, 15 cm in all.
        on_press: what is called, once for each press.
        name: for messages and paths.
    """

    def __init__(
        self, position: oo.Vec3Like, on_press: Callable[[], object] | None = None, *, name: str = "button"
    ) -> None:
        super().__init__(name=name)
        self.on_press = on_press
        self.presses = 0
        """How often it was pressed."""
        top = oo.Vec3(*position)
        self.cap = self.attach(
            oo.Body(name=f"{name} cap", position=top - (0.0, BUTTON[1] / 2, 0.0), auto_disable=False)
        )
        self.geom = self.cap.attach(oo.Placeable()).attach(
            oo.Box(BUTTON, material="rubber", mass=15.0, appearance=painted(0.85, 0.14, 0.1, 0.5))
        )
        self.slider = oo.Slider(self.cap, axis=(0.0, 1.0, 0.0), name=name)
        self.armed = True
        """Whether it can be pressed."""
        self._coming_out = False
        self._out_since = 0
        self._release()

    @property
    def depth(self) -> float:
        """How far it is pressed, metres."""
        return -self.slider.position

    def entered(self) -> None:
        """Begin to watch."""
        self.schedule(_watch)

    def _release(self) -> None:
        """Let it be held up by its motor alone."""
        self._coming_out = False
        self._out_since = 0
        self.slider.stop_erp = 0.8
        self.slider.stops = (-DEEP, 0.0)
        self.slider.motor(0.4, HOLD)

    def _push_out(self) -> None:
        """Set both stops to the top: the error that this makes is corrected little by little."""
        self._coming_out = True
        self.slider.stop_erp = RETURN_ERP
        self.slider.stops = (0.0, 0.0)

    def watch(self) -> None:
        """What it does after each step."""
        out = self.depth < 0.1 * PRESSED
        if self._coming_out:
            if out:
                self._release()
        elif self.armed:
            if self.depth > PRESSED:
                self.armed = False
                self.presses += 1
                self._push_out()
                if self.on_press is not None:
                    self.on_press()
        else:
            self._out_since = self._out_since + 1 if out else 0
            self.armed = self._out_since >= UNLOADED


class Platform(CompositeObject):
    """A box on a slider that goes to and fro between two places while it is switched on, and carries what is on it.

    Switched off, it goes on to the end that it is heading for, and stays there.

    Args:
        start, end: of the middle of its top, metres in the world.
        name: for messages and paths.
    """

    def __init__(self, start: oo.Vec3Like, end: oo.Vec3Like, *, name: str = "platform") -> None:
        super().__init__(name=name)
        first, last = oo.Vec3(*start), oo.Vec3(*end)
        self.way = (last - first).length
        """From end to end, metres."""
        self.deck = self.attach(
            oo.Body(name=f"{name} deck", position=first - (0.0, SIZE[1] / 2, 0.0), auto_disable=False)
        )
        steel = look("steel", (0.9, 0.8, 0.5), scale=1.2, shine=0.3)
        self.deck.attach(oo.Placeable()).attach(oo.Box(SIZE, material="steel", mass=MASS, appearance=steel))
        self.slider = oo.Slider(self.deck, axis=(last - first) / self.way, stops=(-0.05, self.way + 0.05), name=name)
        self.slider.motor(0.0, FORCE)
        self.running = False
        """Whether it is switched on."""
        self.heading = 0.0
        """Where it goes: the position at the end that it is going to, metres."""
        self._waiting: oo.ScheduledCall | None = None

    @property
    def position(self) -> float:
        """How far it is from its start, metres."""
        return self.slider.position

    @property
    def arrived(self) -> bool:
        """Whether it stands at the end that it was going to."""
        return abs(self.heading - self.position) < 0.005

    @property
    def waiting(self) -> bool:
        """Whether it waits at an end to go back."""
        return self._waiting is not None and self._waiting.pending

    def toggle(self) -> None:
        """Switch it on or off: what a button does."""
        self.running = not self.running
        if self._waiting is not None:
            self._waiting.cancel()
        if self.running and self.arrived:
            self.go_back()

    def entered(self) -> None:
        """Begin to be driven."""
        self.schedule(_drive)

    def go_back(self) -> None:
        """Head for the other end."""
        self.heading = 0.0 if self.heading > 0.0 else self.way

    def drive(self) -> None:
        """Set the motor: gently up to its speed, and gently down before the end."""
        world = self.world
        if world is None:
            return
        left = self.heading - self.position
        speed = max(self.slider.position_rate * math.copysign(1.0, left), 0.0) + ACCELERATION * world.step_size
        speed = min(speed, SPEED, math.sqrt(2.0 * ACCELERATION * abs(left)), SETTLING * abs(left))
        self.slider.motor(math.copysign(speed, left), FORCE)
        if self.arrived and self.running and not self.waiting:
            self._waiting = self.schedule(_wait_is_over, seconds=WAIT)


def _watch(button: Button) -> bool:
    button.watch()
    return True


def _drive(platform: Platform) -> bool:
    platform.drive()
    return True


def _wait_is_over(platform: Platform) -> None:
    platform.go_back()
