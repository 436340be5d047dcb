"""The engine: what a game needs around the simulation."""

from osgode.engine.debug import DebugOverlay
from osgode.engine.frametimings import FrameTimings
from osgode.engine.inspector import inspect

__all__ = ["DebugOverlay", "FrameTimings", "inspect"]
