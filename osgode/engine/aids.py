"""What every scene has for who wants to see what goes on: the debug overlay, the inspector, the timings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from osgode.engine.debug import DebugOverlay
from osgode.engine.frametimings import FrameTimings
from osgode.engine.hud import HudBox, HudElement, HudText
from osgode.engine.inspector import inspect
from osgode.graph.projection import Area, OverlayItem, Projection
from osgode.nodes.exports import StepTimings
from osgode.nodes.hit import Hit

if TYPE_CHECKING:
    from osgode.engine.scene import Scene

REACH = 200.0
"""How far the inspector looks, metres."""
MARGIN, LINE = 12.0, 17.0
"""Of the inspector's box, and of a line of its text, in units of the overlay."""
TEXT_SIZE, COLUMNS = 14, 60
REFRESH = 0.2
"""Seconds from one reading of the inspector to the next: nobody reads faster, and text costs time."""
GRAPH = (440.0, 150.0)


class TimingsGraph(HudElement):
    """The graph of where the time of the last frames went, see `FrameTimings`.

    Args:
        anchor: as for `HudElement`.
        **place: as for `HudElement`.
    """

    def __init__(self, anchor: str = "bottom right", *, x: float = 0.0, y: float = 0.0) -> None:
        super().__init__(anchor, x=x, y=y, width=GRAPH[0], height=GRAPH[1], name="timings")
        self.timings = FrameTimings()

    def overlay_items(self, area: Area) -> Sequence[OverlayItem]:
        """The bars and their legend."""
        return self.timings.overlay(*area)


class Aids:
    """The aids of a scene, in an overlay of their own; nothing is made before it is first wanted.

    Args:
        scene: that is looked at.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._debug: DebugOverlay | None = None
        self._panel: Projection | None = None
        self._next = 0.0
        self.step = StepTimings()
        """What the steps of the present frame took; added up by the scene while `inspecting`."""

    # -- the debug overlay

    @property
    def debug(self) -> DebugOverlay:
        """Shapes, joints, contacts as ODE has them; hidden until it is switched on."""
        if self._debug is None:
            self._debug = self._scene.root.attach(DebugOverlay(self._scene.world, visible=False))
        return self._debug

    @property
    def debugging(self) -> bool:
        """Whether the debug overlay is shown."""
        return self._debug is not None and self._debug.visible

    @debugging.setter
    def debugging(self, value: bool) -> None:
        if value or self._debug is not None:
            self.debug.visible = value

    def next_debugging(self) -> None:
        """Show the debug overlay, then all that it has, then nothing: what its key does."""
        debug = self.debug
        everything = debug.visible and not debug.boxes
        debug.visible = not debug.visible or everything
        debug.axes = debug.centres = debug.boxes = everything

    # -- the inspector

    @property
    def inspecting(self) -> bool:
        """Whether the inspector and the timings are shown."""
        return self._panel is not None and self._panel.visible

    @inspecting.setter
    def inspecting(self, value: bool) -> None:
        if value and self._panel is None:
            self._make_panel()
        if self._panel is not None:
            self._panel.visible = value

    def _make_panel(self) -> None:
        self._panel = panel = self._scene.root.attach(Projection(self._scene.config.hud_height, name="inspector"))
        panel.attach(HudText("+", "centre", size=26, colour=(1.0, 1.0, 1.0, 0.8)))
        self._box = panel.attach(HudBox("top left", x=MARGIN, y=MARGIN, width=430.0, colour=(0.03, 0.04, 0.06, 0.72)))
        self._text = self._box.attach(HudText("", x=MARGIN, y=MARGIN, size=TEXT_SIZE, shadow=False))
        self._graph = panel.attach(TimingsGraph(x=-MARGIN, y=-MARGIN))

    @property
    def text(self) -> str:
        """What the inspector says now."""
        return self._text.text if self._panel is not None else ""

    def aimed_at(self) -> Hit | None:
        """What is under the crosshair."""
        return self._scene.camera.aim(REACH)

    def note(self, timings: Mapping[str, float]) -> None:
        """Add a frame to the graph: what `App.timings` says of it, once it is drawn."""
        if self.inspecting:
            self._graph.timings.add(timings, self.step)

    def update(self) -> None:
        """Say what there is to say in this frame."""
        if not self.inspecting:
            return
        app = self._scene.app
        if app.clock.elapsed < self._next:
            return
        self._next = app.clock.elapsed + REFRESH
        hit = self.aimed_at()
        lost = f"\n{self._scene.lost:.1f} s left out, for the machine was too slow" if self._scene.lost else ""
        clock = app.clock
        pace = "paused" if clock.paused else f"at {clock.speed:g} times real time"
        about = inspect(hit, width=COLUMNS) if hit is not None else "nothing in sight"
        self._text.text = f"{clock.frame_rate:.0f} frames a second, {pace}{lost}\n\n{about}"
        self._box.resize(430.0, 2 * MARGIN + LINE * (self._text.text.count("\n") + 1))
