"""The drawer that only records."""

import subprocess
import sys

import pytest

from osgode.graph.frame import Drawer, Frame, View
from osgode.render import RecordingDrawer
from tests.render.scenes import SIZE, yard


def test_frames_are_kept_in_order():
    """Frames are kept as they were given, and counted."""
    drawer: Drawer = RecordingDrawer()
    frames = [Frame(View(), SIZE) for _ in range(3)]
    for frame in frames:
        drawer.draw(frame)
    assert list(drawer.frames) == frames
    assert drawer.drawn == 3
    assert drawer.last is frames[-1]


def test_only_the_last_are_kept():
    """A long run keeps no more than was asked for."""
    drawer = RecordingDrawer(keep=2)
    for _ in range(5):
        drawer.draw(Frame(View(), SIZE))
    assert (len(drawer.frames), drawer.drawn) == (2, 5)


def test_bins_and_instances_are_counted():
    """Counted is what the camera sees in the last frame."""
    drawer = RecordingDrawer()
    drawer.draw(yard())
    assert (drawer.bins, drawer.instances) == (6, 7)
    drawer.draw(Frame(View(), SIZE))
    assert (drawer.bins, drawer.instances) == (0, 0)


def test_nothing_recorded():
    """Without a frame there is no last one."""
    with pytest.raises(IndexError):
        _ = RecordingDrawer().last


def test_recording_needs_no_graphics():
    """A frame can be recorded where no drawing package is installed."""
    code = (
        "import sys\n"
        "for name in ('moderngl', 'pygame', 'PIL', 'imageio_ffmpeg'): sys.modules[name] = None\n"
        "from osgode.graph.frame import Frame, View\n"
        "from osgode.render import RecordingDrawer\n"
        "drawer = RecordingDrawer(); drawer.draw(Frame(View(), (8, 8))); print(drawer.drawn)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1"
