"""The engine where nothing that draws is installed: all of it runs but pictures and windows."""

import subprocess
import sys
from pathlib import Path

import pytest

from osgode.engine import App, AppConfig, Scene, VideoConfig
from osgode.errors import MissingExtraError, StateError

ROOT = Path(__file__).parents[2]

BARE = """
import sys

HIDDEN = ("moderngl", "pygame", "PIL", "imageio", "imageio_ffmpeg", "tqdm")
for name in HIDDEN:
    sys.modules[name] = None

import osgode as oo
import osgode.engine
import osgode.testing
from osgode.engine import App, AppConfig, HudText, Scene, VideoConfig
from osgode.testing import Play

class Game(Scene):
    def populate_world(self):
        self.static.attach(oo.Plane())
        ball = self.dynamic.attach(oo.Body(name="ball", position=(0, 2, 0)))
        ball.attach(oo.Placeable()).attach(oo.Sphere(0.5))

    def populate_hud(self):
        self.hud.attach(HudText("hello"))

prints = []
for _ in range(2):
    with Play(Game) as play:
        play.hold("forward")
        play.until(lambda: play.body("ball").position.y < 0.6)
        prints.append(play.fingerprint())
assert prints[0] == prints[1]

App(Game, AppConfig(video=VideoConfig(mode="none"))).run(10)

for mode in ("window", "offscreen"):
    game = App(Game, AppConfig(video=VideoConfig(mode=mode)))
    try:
        game.run(1)
    except oo.MissingExtraError as error:
        assert "pip install osgode[render]" in str(error), error
        assert not game.is_open
    else:
        raise AssertionError("a picture was drawn with nothing to draw with")

try:
    with Play(Game) as play:
        play.picture()
except oo.MissingExtraError as error:
    assert "pip install osgode[render]" in str(error), error
else:
    raise AssertionError("a picture was drawn with nothing to draw with")

assert not [name for name in HIDDEN if sys.modules[name] is not None]
"""


def test_all_but_pictures_runs_without_the_extras():
    """Importing, playing and testing need none of them; a window and a picture name the extra, and nothing is left."""
    command = [sys.executable, "-W", "error", "-c", BARE]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_importing_the_engine_imports_nothing_that_draws():
    """Even where they are installed, they are loaded when something is drawn, not before."""
    names = "('moderngl', 'pygame', 'PIL', 'tqdm')"
    code = f"import sys, osgode.engine, osgode.testing; print([m for m in {names} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("module", ["pygame", "moderngl"])
def test_a_window_names_the_extra(monkeypatch, module):
    """And the App that could not open one leaves none open, with everything stopped."""
    monkeypatch.setitem(sys.modules, module, None)
    app = App(Scene, AppConfig(video=VideoConfig(mode="window")))
    with pytest.raises(MissingExtraError, match=r"pip install osgode\[render\]") as caught:
        app.run(1)
    assert any("Video" in note for note in caught.value.__notes__)
    assert not app.is_open
    with pytest.raises(StateError):
        App.current()
