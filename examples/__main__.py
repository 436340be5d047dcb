"""``python -m osgode.examples`` lists the examples, ``python -m osgode.examples heap`` runs one."""

from __future__ import annotations

import ast
import importlib
import sys
from pathlib import Path

HELPERS = ("__init__", "__main__", "runner")


def names() -> list[str]:
    """The examples, by the names of their modules."""
    return sorted(path.stem for path in Path(__file__).parent.glob("*.py") if path.stem not in HELPERS)


def about(name: str) -> str:
    """The first sentence of what an example says of itself; nothing of it is run."""
    tree = ast.parse((Path(__file__).parent / f"{name}.py").read_text(encoding="utf-8"))
    return (ast.get_docstring(tree) or "").partition("\n")[0]


def main(arguments: list[str] | None = None) -> None:
    """List the examples, or run the one that is named first with the rest of the arguments."""
    given = sys.argv[1:] if arguments is None else arguments
    known = names()
    if given and given[0] in known:
        importlib.import_module(f"osgode.examples.{given[0]}").main(given[1:])
        return
    asked = not given or given[0] in ("-h", "--help", "list")
    if not asked:
        print(f"there is no example {given[0]!r}", file=sys.stderr)
    width = max(map(len, known))
    for name in known:
        print(f"  {name:{width}}  {about(name)}")
    print(
        "\npython -m osgode.examples NAME [--headless] [--seconds S] [--frames N] [--picture out.png] [--video out.mp4]"
    )
    if not asked:
        sys.exit(2)


if __name__ == "__main__":
    main()
