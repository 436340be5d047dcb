"""Writes docs/reference.md from the field tables: ``python tools/reference.py``."""

import inspect
from pathlib import Path

import osgode as oo
from osgode.fields import Followed
from osgode.joints.spots import Anchor, Coordinate, Seen, Spot

PAGE = Path(__file__).parents[1] / "docs" / "reference.md"
HEAD = """# Fields

Made by `tools/reference.py` from the tables in the classes. Every field is a keyword argument of its class and an
attribute that can be read and set, in or out of a World; those marked *fixed* can't be set while in one.

Anchors and axes of joints are keyword arguments too, and setting one anchors the joint anew; what is only read follows
from how the bodies stand.
"""


def classes() -> list[type]:
    """Public classes with fields, abstract ones included."""
    found = [getattr(oo, name) for name in oo.__all__]
    return [cls for cls in found if inspect.isclass(cls) and getattr(cls, "FIELDS", None)]


def page() -> str:
    """The text of the page."""
    parts = [HEAD]
    for cls in classes():
        bases = [base for base in cls.__mro__[1:] if getattr(base, "FIELDS", None)]
        inherited = {name for base in bases if base in classes() for name in base.FIELDS}
        own = {name: field for name, field in cls.FIELDS.items() if name not in inherited}
        shown = [f"`{base.__name__}`" for base in bases if base in classes()]
        parts.append(f"\n## {cls.__name__}\n\n{inspect.cleandoc(cls.__doc__ or '').splitlines()[0]}")
        if shown:
            parts.append(f"\nAlso has the fields of {', '.join(shown)}.")
        if own:
            parts.append("\n| field | default | takes | |\n|---|---|---|---|")
        for name, field in own.items():
            default = "the World's" if isinstance(field, Followed) else _short(field.default)
            note = " *fixed*" if field.fixed else ""
            parts.append(f"| `{name}` | {default} | {field.check.expects} | {field.__doc__}{note} |")
        parts += spots(cls)
    return "\n".join(parts).replace("|  |", "| |") + "\n"


def spots(cls: type) -> list[str]:
    """The tables of a joint's anchors and axes, and of what it only reads."""
    found = {name: value for base in reversed(cls.__mro__) for name, value in vars(base).items()}
    places = {name: value for name, value in found.items() if isinstance(value, Spot | Seen)}
    read = {name: value for name, value in found.items() if isinstance(value, Coordinate)}
    parts = []
    if places:
        parts.append("\n| anchor or axis | carried by | |\n|---|---|---|")
    for name, value in places.items():
        kind = "point" if isinstance(value, Anchor | Seen) else "direction"
        note = " *only read*" if isinstance(value, Seen) else ""
        parts.append(f"| `{name}`, a {kind} | `body{value.side + 1}` | {value.__doc__}{note} |")
    if read:
        parts.append("\n| only read | |\n|---|---|")
    parts += [f"| `{name}` | {value.__doc__} |" for name, value in read.items()]
    return parts


def _short(value: object) -> str:
    if isinstance(value, tuple):
        return "(" + ", ".join(_short(v) for v in value) + ")"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    PAGE.write_text(page())
