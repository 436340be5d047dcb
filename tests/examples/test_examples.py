"""Every example does what it promises, and can be run and drawn."""

import ast
import importlib
import inspect
import pkgutil
import re

import numpy as np
import pytest

import osgode as oo
import osgode.examples
from osgode.examples import runner
from osgode.examples.runner import BrokenPromiseError, Example
from osgode.render import OffscreenDrawer, RecordingDrawer

NAMES = [
    module.name
    for module in pkgutil.iter_modules(osgode.examples.__path__)
    if not module.ispkg and module.name not in ("__main__", "runner")
]


def load(name):
    return importlib.import_module(f"osgode.examples.{name}")


def kinds(module):
    """The examples that a module defines."""
    own = vars(module).values()
    return [v for v in own if inspect.isclass(v) and issubclass(v, Example) and v.__module__ == module.__name__]


@pytest.fixture(params=NAMES)
def module(request):
    return load(request.param)


@pytest.fixture
def kind(module):
    return kinds(module)[0]


@pytest.fixture
def screen():
    """Skips where nothing can be drawn."""
    pytest.importorskip("moderngl")
    pytest.importorskip("PIL")
    try:
        OffscreenDrawer((16, 16)).close()
    except oo.OsgodeError as error:
        pytest.skip(str(error))


def test_the_examples_are_found():
    assert {
        "crates",
        "hammer",
        "door",
        "heap",
        "lift",
        "terrain",
        "chain",
        "ragdoll",
        "buggy",
        "bullets",
        "billiards",
    } <= set(NAMES)


def test_a_module_is_one_example_that_says_what_it_shows_checks_itself_and_has_a_main(module):
    assert len(kinds(module)) == 1
    assert "Shows" in module.__doc__
    (kind,) = kinds(module)
    assert "check" in vars(kind)
    assert callable(module.main)
    assert 'if __name__ == "__main__":\n    main()\n' in inspect.getsource(module)


def test_it_is_built_from_public_names(module):
    """It imports nothing of osgode but the package, its drawing and the other examples, and takes no private name."""
    tree = ast.parse(inspect.getsource(module))
    imported = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    imported += [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    ours = {name for name in imported if name.startswith("osgode")}
    ours = {name for name in ours if not name.startswith("osgode.examples.game.")}
    assert ours <= {"osgode", "osgode.engine", "osgode.render", "osgode.examples.runner"}
    reached = [node for node in ast.walk(tree) if isinstance(node, ast.Attribute) and node.attr.startswith("_")]
    foreign = {node.attr for node in reached if not (isinstance(node.value, ast.Name) and node.value.id == "self")}
    assert foreign <= {"__init__"}


def test_it_does_what_it_promises(module, capsys):
    module.main(["--headless"])
    out = capsys.readouterr().out
    name = module.__name__.rpartition(".")[2]
    assert f"{name}: did what it promises" in out
    assert re.search(r"\d+ steps of \d+ bodies in [\d.]+ s: \d+ steps per second", out)


def test_a_script_that_was_not_run_keeps_no_promise(kind):
    """The check can fail: at the start nothing that it asks for has happened."""
    with pytest.raises(BrokenPromiseError):
        kind().check()


def test_it_runs_the_same_way_every_time(kind):
    ends = []
    for _ in range(2):
        example = kind()
        example.advance(60)
        ends.append(example.world.poses.copy())
    assert np.array_equal(*ends)


def test_everything_is_in_the_picture(kind):
    """The camera sees the ground, and most of the bodies after a second; what it sees changes as they move."""
    example = kind()
    drawer = RecordingDrawer()
    for _ in range(2):
        example.advance(round(0.5 / example.world.step_size))
        example.update()
        drawer.draw(example.frame((320, 180)))
    first, last = ([bin_ for bin_ in frame.opaque if bin_.matrices.any()] for frame in drawer.frames)
    assert drawer.instances > 0.8 * len(example.world.bodies)
    assert drawer.last.casters
    assert any(
        len(a.matrices) != len(b.matrices) or not np.array_equal(a.matrices, b.matrices)
        for a, b in zip(first, last, strict=False)
    )


def test_it_draws_a_picture(module, tmp_path, screen, capsys, monkeypatch):
    """Two frames into a PNG file of the right size that shows something."""
    monkeypatch.setattr(runner, "SIZE", (160, 90))
    path = tmp_path / "deep" / "picture.png"
    module.main(["--headless", "--picture", str(path), "--frames", "2"])
    from PIL import Image

    pixels = np.asarray(Image.open(path))
    assert pixels.shape == (90, 160, 3)
    assert pixels.std(axis=(0, 1)).min() > 10
    out = capsys.readouterr().out
    assert str(path) in out
    assert "promises" not in out  # the script hadn't run to its end


def test_it_films_a_video(tmp_path, screen, monkeypatch):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr(runner, "SIZE", (160, 90))
    path = tmp_path / "video.mp4"
    load("crates").main(["--video", str(path), "--frames", "5"])
    frames, _ = ffmpeg.count_frames_and_secs(str(path))
    assert frames == 5


def test_without_a_screen_pictures_and_a_video_go_into_a_folder(tmp_path, screen, monkeypatch, capsys):
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr(runner, "SIZE", (64, 36))
    monkeypatch.setattr(runner, "has_screen", lambda: False)
    monkeypatch.setattr(runner, "OUT", tmp_path)
    load("hammer").main(["--seconds", "0.6"])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["hammer-1.png", "hammer.mp4"]
    assert capsys.readouterr().out.count("written: ") == 2


def test_without_the_packages_for_drawing_it_is_simulated(monkeypatch, capsys):
    monkeypatch.setattr(runner, "has_screen", lambda: False)
    monkeypatch.setattr(runner, "is_installed", lambda *_: False)
    load("crates").main(["--seconds", "0.2"])
    told = capsys.readouterr()
    assert "pip install 'osgode[render,video]'" in told.out
    assert "24 steps" in told.out
    assert "[##############################] 6/6" in told.err


def test_a_broken_promise_is_an_error():
    class Empty(Example):
        SECONDS = 0.1

        def build(self):
            pass

        def check(self):
            runner.expect(False, "the moon is made of cheese")

    with pytest.raises(BrokenPromiseError, match="the moon"):
        runner.run(Empty, ["--headless"])
