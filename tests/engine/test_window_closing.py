"""How a real window ends: by the user, by an error, and what comes after it; and where there can't be one."""

import os
import signal
import subprocess
import sys

import pytest

from tests.desktop import until
from tests.engine.player import ROOT, Player

pytest.importorskip("pygame")
pytest.importorskip("moderngl")


@pytest.mark.parametrize("capture", [False, True])
def test_window_manager_closes_it(desktop, capture):
    with Player(desktop, capture=capture) as game:
        game.ready()
        desktop.xdotool("key", "alt+F4")
        assert game.hear("ended")
        assert ("Quit",) in game.seen
        assert game.ended() == (0, "")
        assert not desktop.windows(game.process)


def test_escape_quits(desktop, game):
    desktop.xdotool("key", "Escape")
    assert game.hear("ended")
    assert game.ended() == (0, "")


def test_interrupt_in_the_terminal_closes_it(desktop, game):
    game.process.send_signal(signal.SIGINT)
    code, errors = game.ended()
    assert code == -signal.SIGINT
    assert errors.rstrip().endswith("KeyboardInterrupt")
    assert not desktop.windows(game.process)


@pytest.mark.parametrize("kind", ["fails in the loop", "fails at the start", "plays twice"])
def test_another_app_after_the_first(desktop, kind):
    """Whether that failed or not: no window is left of it, and the next one in the process is as good as the first."""
    with Player(desktop, kind, capture=True) as game:
        if kind == "plays twice":
            game.ready()
            desktop.xdotool("keydown", "Escape")
        else:
            assert game.hear("failed") == "broken on purpose"
        assert game.hear("between") is False
        until(lambda: not desktop.windows(game.process), "the window is gone")
        assert game.process.poll() is None
        desktop.xdotool("keyup", "Escape")
        game.go_on()
        game.ready()
        game.until("pygame.mouse.get_relative_mode()")
        desktop.xdotool("mousemove_relative", 20, 40, "keydown", "w")
        game.until("scene.looked == [0.05, 0.1] and events.held('forward')")
        desktop.xdotool("keyup", "w", "key", "Escape")
        assert game.hear("ended")
        assert game.ended() == (0, "")


WITHOUT = """
from osgode.engine import App, Scene
from osgode.errors import OsgodeError
try:
    App(Scene).open()
except OsgodeError as error:
    print(error)
try:
    print(App.current())
except OsgodeError:
    print("closed")
"""


def test_without_a_screen_an_app_says_what_to_do():
    hidden = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
    environment = {key: value for key, value in os.environ.items() if key not in hidden}
    command = [sys.executable, "-W", "error", "-c", WITHOUT]
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=True)
    message, last = done.stdout.splitlines()
    assert "takes a screen" in message
    assert "xvfb-run" in message
    assert last == "closed"
