"""Names of keys and mouse buttons, by where they are on the keyboard and not by what is printed on them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Final

from osgode.errors import FieldError, shown

_ROW = "abcdefghijklmnopqrstuvwxyz1234567890"
_FROM_40 = (
    "return escape backspace tab space minus equals left_bracket right_bracket backslash nonus_hash semicolon "
    "apostrophe grave comma period slash caps_lock f1 f2 f3 f4 f5 f6 f7 f8 f9 f10 f11 f12 print_screen "
    "scroll_lock pause_break insert home page_up delete end page_down arrow_right arrow_left arrow_down "
    "arrow_up num_lock keypad_divide keypad_multiply keypad_minus keypad_plus keypad_enter keypad_1 keypad_2 "
    "keypad_3 keypad_4 keypad_5 keypad_6 keypad_7 keypad_8 keypad_9 keypad_0 keypad_period nonus_backslash"
)
_FROM_224 = "left_ctrl left_shift left_alt left_gui right_ctrl right_shift right_alt right_gui"

SCANCODES: Final[dict[str, int]] = {
    **{name: 4 + k for k, name in enumerate(_ROW)},
    **{name: 40 + k for k, name in enumerate(_FROM_40.split())},
    **{name: 224 + k for k, name in enumerate(_FROM_224.split())},
}
"""The number of each key: the usages of page 7 of the USB HID Usage Tables, which are SDL's scancodes too."""

KEY_NAMES: Final[dict[int, str]] = {number: name for name, number in SCANCODES.items()}
"""The name of each number."""

BUTTONS: Final[dict[str, int]] = {"mouse_left": 1, "mouse_middle": 2, "mouse_right": 3, "mouse_4": 6, "mouse_5": 7}
"""The number of each mouse button, as pygame counts them; the wheel is none."""

BUTTON_NAMES: Final[dict[int, str]] = {number: name for name, number in BUTTONS.items()}
"""The name of each number."""

INPUTS: Final[frozenset[str]] = frozenset({*SCANCODES, *BUTTONS})
"""Everything that can be pressed."""


def check_input(call: str, name: object, actions: Iterable[str] = ()) -> None:
    """Raise FieldError unless ``name`` is that of a key or button; ``actions`` are what else may have been meant."""
    if isinstance(name, str) and name in INPUTS:
        return
    close = difflib.get_close_matches(str(name), [*actions, *sorted(INPUTS)], 1)
    hint = f"did you mean {close[0]!r}?" if close else "see osgode.engine.INPUTS"
    raise FieldError(f"{call}: {shown(name)} is no {'action, ' if actions else ''}key or mouse button; {hint}")
