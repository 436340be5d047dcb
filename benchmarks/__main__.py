"""``python -m benchmarks``: what osgode costs; see the README beside this file."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from benchmarks import debug, game, joints, listener, memory, picture, raw, rays, speed, startup
from benchmarks.scenes import SCENES

KINDS = ("step", "listener", "rays", "joints", "game", "frame", "overlay", "memory", "import")


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"some of {', '.join(KINDS)}; all if none is named")
    parser.add_argument("--scene", action="append", default=[], choices=SCENES, help="for step: this scene alone")
    parser.add_argument("--turns", type=int, default=48, help="of osgode and C (48)")
    parser.add_argument("--install", action="store_true", help="also time pip install . in a copy (slow, downloads)")
    chosen = parser.parse_args()
    if unknown := set(chosen.kinds).difference(KINDS):
        parser.error(f"there is no {', '.join(unknown)}")
    kinds = chosen.kinds or KINDS
    raw.build()
    calls: dict[str, Callable[[], object]] = {
        "step": lambda: speed.run(chosen.turns, chosen.scene),
        "listener": lambda: listener.run(chosen.turns),
        "rays": lambda: rays.run(max(2, chosen.turns // 6)),
        "joints": lambda: joints.run(chosen.turns),
        "game": lambda: game.run(chosen.turns),
        "frame": picture.run,
        "overlay": debug.run,
        "memory": memory.run,
        "import": startup.run_import,
    }
    for kind in KINDS:
        if kind in kinds:
            calls[kind]()
    if chosen.install:
        startup.run_install()


if __name__ == "__main__":
    main()
