"""Runs the game: in a window, or as a film."""

from __future__ import annotations

from collections.abc import Sequence

from osgode.engine import App
from osgode.examples.game.scene import Game, config


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it."""
    App(Game, config()).run()
