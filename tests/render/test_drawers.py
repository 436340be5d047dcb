"""Making and closing drawers and windows, and what is said when that can't be."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from osgode.errors import FieldError, MissingExtraError, OsgodeError, StateError
from osgode.graph.frame import Frame, View
from osgode.maths import Quat
from osgode.render import OffscreenDrawer, Quality, Window, measure_text
from osgode.render.canvas import samples_of
from osgode.render.renderer import FULL, QUICK, quality_of
from tests.render.scenes import CLEAR, RED, many, place, quad, unlit

ROOT = Path(__file__).parents[2]
SMALL = Quality(samples=0, shadow_size=64)


def frame(size):
    return Frame(View(), size, sky=CLEAR, opaque=[many(quad(), unlit(RED), place((0, 0, -5)))])


@pytest.mark.parametrize("size", [(0, 10), (10, -1)])
def test_picture_has_a_size(size):
    """A picture without pixels is refused."""
    with pytest.raises(FieldError, match="size"):
        OffscreenDrawer(size)


@pytest.mark.parametrize(
    "wrong", [{"samples": -1}, {"shadow_size": 0}, {"shadow_distances": (20, 10)}, {"shadow_distances": (0, 10)}]
)
def test_quality_is_checked(wrong):
    """A quality that can't be is refused where it is asked for."""
    with pytest.raises(FieldError, match="shadow_distances"):
        Quality(**wrong)


def test_more_samples_than_the_driver_has(drawer):
    """Quality is a wish: what the driver hasn't got is not asked of it."""
    with OffscreenDrawer((32, 20), Quality(samples=64, shadow_size=64)) as other:
        other.draw(frame((32, 20)))
        assert other.image()[10, 16].tolist() == [255, 0, 0]


@pytest.mark.parametrize(("wanted", "given"), [(0, 0), (1, 0), (2, 2), (3, 2), (4, 4), (6, 4), (64, 4)])
def test_samples_are_a_power_of_two(wanted, given):
    """Drivers have no others."""
    assert samples_of(SimpleNamespace(max_samples=4), wanted) == given
    assert samples_of(SimpleNamespace(max_samples=0), wanted) == 0


@pytest.mark.parametrize(
    ("renderer", "chosen"),
    [
        ("llvmpipe (LLVM 15.0.6, 256 bits)", (0, 1024)),
        ("softpipe", (0, 1024)),
        ("NVIDIA GeForce RTX 3060/PCIe/SSE2", (4, 2048)),
        ("Mesa Intel(R) UHD Graphics 620", (4, 2048)),
    ],
)
def test_quality_by_who_draws(renderer, chosen):
    """Full on a graphics card, cheap on the processor; what is asked for is kept on both."""
    context = SimpleNamespace(info={"GL_RENDERER": renderer})
    found = quality_of(context, None)
    assert (found.samples, found.shadow_size) == chosen
    assert quality_of(context, SMALL) is SMALL


def test_drawer_tells_its_quality(drawer):
    """That which it was given, or has chosen."""
    with OffscreenDrawer((8, 8), SMALL) as other:
        assert other.quality is SMALL
    with OffscreenDrawer((8, 8)) as other:
        assert other.quality in (FULL, QUICK)
        other.draw(frame((8, 8)))


def test_samples_smooth_edges(drawer):
    """With four samples a pixel on an edge is a mixture, with one it is this or that."""
    kinds, tilted = [], place((0, 0, -5), Quat.from_axis_angle((0, 0, 1), 0.3))
    for samples in (0, 4):
        with OffscreenDrawer((64, 40), Quality(samples=samples, shadow_size=64)) as other:
            other.draw(Frame(View(), (64, 40), [many(quad(), unlit(RED), tilted)], sky=CLEAR))
            kinds.append(len(np.unique(other.image()[..., 0])))
    assert kinds[1] > kinds[0]


def test_closing_twice(drawer):
    """A drawer may be closed again; what is closed doesn't draw."""
    with OffscreenDrawer((8, 8), SMALL) as other:
        other.close()
        with pytest.raises(StateError, match="closed"):
            other.draw(frame((8, 8)))


def test_nothing_heavy_is_imported_before_it_is_used():
    """Importing osgode.render loads neither OpenGL nor pygame, and prints nothing."""
    code = "import sys, osgode.render; print([m for m in ('moderngl', 'pygame', 'PIL') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("module", "use"),
    [
        ("moderngl", lambda: OffscreenDrawer((8, 8))),
        ("moderngl", Window),
        ("pygame", Window),
        ("pygame.font", lambda: measure_text("a")),
    ],
)
def test_missing_package_is_named(monkeypatch, module, use):
    """Without a package the message says what to install."""
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=r"pip install osgode\[render\]"):
        use()


def test_no_opengl_says_what_to_install(monkeypatch):
    """Without a driver the message names the packages that bring one."""
    moderngl = pytest.importorskip("moderngl")

    def refuse(**settings):
        raise Exception("no EGL here")  # noqa: TRY002 - as moderngl does it

    monkeypatch.setattr(moderngl, "create_context", refuse)
    with pytest.raises(OsgodeError, match=r"no EGL here.*libegl1 libgl1 libgl1-mesa-dri"):
        OffscreenDrawer((8, 8))


def test_no_screen_says_so(monkeypatch):
    """Without a screen the message names the ways to do without."""
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    with pytest.raises(OsgodeError, match="OffscreenDrawer"):
        Window((64, 40))


WINDOW = """
import numpy as np, pygame
from osgode.errors import StateError
from osgode.maths import Quat
from osgode.render import OffscreenDrawer, Quality, Window
from tests.render.test_drawers import SMALL, frame

def red(image): return image.reshape(40, 64, 3)[20, 32].tolist() == [255, 0, 0]
def shown():
    data = window._context.screen.read(viewport=(0, 0, 64, 40), components=3, alignment=1)
    return red(np.frombuffer(data, np.uint8))

window = Window((64, 40), quality=SMALL, vsync=False)
assert window.size == (64, 40)
for _ in range(2):
    window.pump()
    window.draw(frame(window.size))
assert window.counts.draws == 2
assert shown()

# A picture may be drawn offscreen between two frames of a window.
with OffscreenDrawer((64, 40), SMALL) as drawer:
    for _ in range(2):
        drawer.draw(frame((64, 40)))
        window.draw(frame(window.size))
        assert red(drawer.image())
        assert shown()

# Closing is noticed when events are pumped; other events are handed on, in their order.
window.pump()
for kind in (pygame.KEYDOWN, pygame.QUIT):
    pygame.event.post(pygame.event.Event(kind))
assert not window.closed
kinds = [event.type for event in window.pump() if event.type in (pygame.KEYDOWN, pygame.QUIT)]
assert kinds == [pygame.KEYDOWN, pygame.QUIT], kinds
assert window.closed
assert window.pump() == []
window.close()
window.close()
try:
    window.draw(frame((64, 40)))
except StateError:
    pass
else:
    raise AssertionError("a closed window drew")

with Window((32, 20), quality=SMALL, vsync=False) as window:
    window.draw(frame(window.size))

# With several samples a pixel, which the window itself hasn't got.
with Window((64, 40), quality=Quality(samples=4, shadow_size=64), vsync=False) as window:
    assert window.quality.samples == 4
    for _ in range(2):  # what is read afterwards may be either of two buffers
        window.draw(frame(window.size))
    assert window._context.error == "GL_NO_ERROR"
    assert shown()
"""


@pytest.mark.parametrize("driver", ["offscreen", "x11"])
def test_window(driver, request):
    """A window draws, lets drawers work beside it, hands on events, and can be opened again.

    In a process of its own: SDL's window in memory, when closed, takes every other context of the process along.
    """
    here = request.getfixturevalue("desktop").environment if driver == "x11" else os.environ
    settings = here | {"SDL_VIDEODRIVER": driver}
    command = [sys.executable, "-W", "error", "-c", WINDOW]
    done = subprocess.run(command, env=settings, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
