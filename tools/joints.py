"""Writes the table of docs/joints.md from the classes: ``python tools/joints.py``."""

import inspect
from collections.abc import Iterable
from pathlib import Path

import osgode as oo
from osgode.joints.base import ONE_BODY, TWO_BODIES
from osgode.joints.spots import Coordinate

PAGE = Path(__file__).parents[1] / "docs" / "joints.md"
START, END = "<!-- made by tools/joints.py from here -->\n", "<!-- to here -->\n"
IN_ODE = {"AngularMotor": "AMotor", "LinearMotor": "LMotor", "DoubleBall": "DBall", "DoubleHinge": "DHinge"}
"""ODE's names, where they are others."""
HEAD = (
    "| kind | in ODE | bodies | anchors | axes | reads | stops, bounce | motors | springs | servo | feedback | breaks "
    "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n"
)


def kinds() -> list[type[oo.Joint]]:
    """Public joints that can be made, in ODE's order."""
    found = [getattr(oo, name) for name in oo.__all__]
    joints = [cls for cls in found if inspect.isclass(cls) and issubclass(cls, oo.Joint) and hasattr(cls, "KIND")]
    return sorted(joints, key=lambda kind: kind.KIND)


def table() -> str:
    """What each kind can do."""
    return HEAD + "".join(f"| {' | '.join(row(kind))} |\n" for kind in kinds()).replace("|  |", "| |").replace(
        "|  |", "| |"
    )


def row(kind: type[oo.Joint]) -> list[str]:
    """The line of one kind."""
    points = [name for name, spot in kind.SPOTS.items() if spot.is_point]
    axes = [name for name, spot in kind.SPOTS.items() if not spot.is_point]
    own = {name: value for base in kind.__mro__ for name, value in vars(base).items() if isinstance(value, Coordinate)}
    springs = {
        "the joint": {"stiffness"},
        "the stops": {"stop_stiffness", "stop_stiffness1"},
        "the suspension": {"suspension_stiffness"},
    }
    return [
        f"`{kind.__name__}`",
        IN_ODE.get(kind.__name__, kind.__name__),
        {TWO_BODIES: "2", ONE_BODY: "1"}.get(kind.BODIES, "1 or 2"),
        code(points),
        code(axes) or ("`axes`: up to 3" if hasattr(kind, "axes") else ""),
        code(sorted([name for name, value in own.items() if value.row == "position"] or own)),
        numbered(kind, "stops"),
        numbered(kind, "motor_velocity"),
        ", ".join(of for of, names in springs.items() if names & kind.FIELDS.keys()),
        *("yes" if field in kind.FIELDS else "" for field in ("servo", "feedback", "break_force")),
    ]


def numbered(kind: type[oo.Joint], name: str) -> str:
    """The numbers of the axes that have such a field, "yes" for an only one without a number."""
    found = sorted(field[len(name) :] for field in kind.FIELDS if field.rstrip("123") == name)
    return "yes" if found == [""] else ", ".join(found)


def code(names: Iterable[str]) -> str:
    """Names in a line of Markdown."""
    return ", ".join(f"`{name}`" for name in names)


def page(text: str) -> str:
    """The page with the table as it must be."""
    before, _, rest = text.partition(START)
    return f"{before}{START}\n{table()}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text()))
