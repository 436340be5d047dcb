"""A small engine for games: an App of modules, a scene with a camera and an overlay, with a window or without."""

from __future__ import annotations

from osgode.engine.aids import Aids, TimingsGraph
from osgode.engine.app import App, AppConfig
from osgode.engine.camera import Camera
from osgode.engine.clock import Accumulator, Clock, ClockConfig, HandTime, RealTime, Timer
from osgode.engine.composite import CompositeObject, ControllableObject, carrier_of
from osgode.engine.controllable import Controllable
from osgode.engine.debug import DebugOverlay
from osgode.engine.events import BINDINGS, Events, EventsConfig
from osgode.engine.frametimings import FrameTimings
from osgode.engine.hud import HudBox, HudElement, HudText, HudWindow
from osgode.engine.inputs import (
    Focus,
    InputEvent,
    InputSource,
    MouseMotion,
    Press,
    Quit,
    Release,
    Resize,
    ScriptedInput,
    Wheel,
)
from osgode.engine.inspector import inspect
from osgode.engine.keys import INPUTS
from osgode.engine.module import Config, Module
from osgode.engine.scene import Scene, SceneConfig
from osgode.engine.video import Video, VideoConfig

__all__ = [
    "BINDINGS",
    "INPUTS",
    "Accumulator",
    "Aids",
    "App",
    "AppConfig",
    "Camera",
    "Clock",
    "ClockConfig",
    "CompositeObject",
    "Config",
    "Controllable",
    "ControllableObject",
    "DebugOverlay",
    "Events",
    "EventsConfig",
    "Focus",
    "FrameTimings",
    "HandTime",
    "HudBox",
    "HudElement",
    "HudText",
    "HudWindow",
    "InputEvent",
    "InputSource",
    "Module",
    "MouseMotion",
    "Press",
    "Quit",
    "RealTime",
    "Release",
    "Resize",
    "Scene",
    "SceneConfig",
    "ScriptedInput",
    "Timer",
    "TimingsGraph",
    "Video",
    "VideoConfig",
    "Wheel",
    "carrier_of",
    "inspect",
]
