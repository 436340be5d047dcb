"""Draws frames with OpenGL, in a window or in memory; nothing of it is loaded before it is used."""

from __future__ import annotations

from osgode.render.drawer import OffscreenDrawer
from osgode.render.output import VideoWriter, save_png
from osgode.render.recording import RecordingDrawer
from osgode.render.renderer import Counts, Quality
from osgode.render.text import measure_text
from osgode.render.window import Window

__all__ = [
    "Counts",
    "OffscreenDrawer",
    "Quality",
    "RecordingDrawer",
    "VideoWriter",
    "Window",
    "measure_text",
    "save_png",
]
