"""The engine: what a game needs around the simulation."""

from osgode.engine.debug import DebugOverlay

__all__ = ["DebugOverlay"]
