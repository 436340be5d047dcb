"""The game of the tests of the real window."""

import pytest

from tests.engine.player import Player


@pytest.fixture
def game(desktop):
    """It is shown and has the keyboard."""
    with Player(desktop) as player:
        player.number = player.ready()
        yield player
