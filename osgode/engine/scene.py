"""The scene: what is simulated, what is laid over it, and what is done with both in a frame."""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass, field

from osgode.engine.aids import Aids
from osgode.engine.camera import Camera
from osgode.engine.clock import Accumulator, Clock
from osgode.engine.controllable import MOVES
from osgode.engine.events import Events
from osgode.engine.module import Config, Module
from osgode.errors import StateError
from osgode.fields import number, vector, whole
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import Frame, Sky, Sun
from osgode.graph.node import Group
from osgode.graph.projection import Projection
from osgode.graph.visitors import UpdateVisitor
from osgode.maths import Vec3Like
from osgode.nodes.exports import StepTimings
from osgode.nodes.spaces import HashSpace, SimpleSpace
from osgode.nodes.world import World

log = logging.getLogger("osgode")

LOSS = 1.0
"""Seconds of simulation: when so much was left out the log says so, and again whenever it has doubled."""
SLOWEST, FASTEST = 1 / 64, 16.0
"""Between these the keys change the speed of the simulation."""


@dataclass(frozen=True, kw_only=True)
class SceneConfig(Config):
    """Settings of a Scene.

    Args:
        step_size: of the World, seconds.
        gravity: m/s2.
        max_steps: for one frame; what a slow machine can't do is left out (`Scene.lost`).
        sun, sky: light and background.
        hud_height: how many units of the overlay the picture is high.
    """

    CHECKS = {  # noqa: RUF012 - Config has it as a ClassVar
        "step_size": number(1e-6, 1.0),
        "gravity": vector(1e6),
        "max_steps": whole(1, 10**6),
        "hud_height": number(1.0, 1e6),
    }

    step_size: float = 1 / 120
    gravity: Vec3Like = (0.0, -9.81, 0.0)
    max_steps: int = 12
    sun: Sun = field(default_factory=Sun)
    sky: Sky = field(default_factory=Sky)
    hud_height: float = 720.0


class Scene(Module):
    """A game's World, overlay and camera; a game subclasses it and fills both in `populate_world` and `populate_hud`.

    In each frame: the camera is turned and its carrier steered, as many steps as the time is worth are simulated, the
    camera comes along, callbacks of `Node.on_update` are called; then `Video` draws what `frame` describes.

    Args:
        config: its settings.
    """

    NAME = "scene"
    NEEDS = ("clock", "events")

    def __init__(self, config: SceneConfig | None = None) -> None:
        self.config = config = SceneConfig.given(config, type(self).__name__)
        self.root = Group(name=type(self).__name__)
        """What everything stands below."""
        self.world = self.root.attach(World(name="world", step_size=config.step_size, gravity=config.gravity))
        self.dynamic = self.world.attach(HashSpace(name="dynamic"))
        """What moves; collides with itself."""
        self.static = self.world.attach(SimpleSpace(name="static"))
        """What stands still; collides with what moves."""
        self.world.collide(self.dynamic)
        self.world.collide(self.dynamic, self.static)
        self.hud = self.root.attach(Projection(config.hud_height, name="hud"))
        """What is laid over the picture."""
        self.camera = Camera(world=self.world, obstacles=self.static)
        self.sun, self.sky = config.sun, config.sky
        self.accumulator = Accumulator(config.max_steps)
        self.aids = Aids(self)
        """Debug overlay, inspector, timings: off until somebody wants them."""
        self._report_at = LOSS
        self._filled = False
        self._interpolation = 1.0
        self._held_moves = dict.fromkeys(MOVES, False)
        self.timings: dict[str, float] = {}
        """Seconds that the parts of the last frame took."""
        self._update = UpdateVisitor(self.root)
        self._cull = CullVisitor(self.root)

    # -- what a game overrides

    def populate_world(self) -> None:
        """Put everything into the World; called once, when the App is there."""

    def populate_hud(self) -> None:
        """Put everything into the overlay; called after `populate_world`."""

    def before_step(self) -> None:
        """Called before each step of the simulation."""

    def each_frame(self) -> None:
        """Called in each frame, before its steps."""

    # -- the rest of the game

    @property
    def clock(self) -> Clock:
        """The App's clock."""
        return self.app.clock

    @property
    def events(self) -> Events:
        """The App's events."""
        return self.app.events

    @property
    def lost(self) -> float:
        """Seconds of simulation that the machine was too slow for."""
        return self.accumulator.lost

    @property
    def interpolation(self) -> float:
        """How far the picture is between the step before the last (0) and the last (1)."""
        return self._interpolation

    # -- frames

    def start(self) -> None:
        """Fill the World and the overlay.

        Raises:
            StateError: if that was done before, for another App.
        """
        if self._filled:
            raise StateError(f"{self.describe()} has been filled before, for another App; make a new one")
        self._filled = True
        self.populate_world()
        self.populate_hud()
        self.bind_actions()
        self.camera.update(0.0)

    def stop(self) -> None:
        """Leave the carrier."""
        self.camera.dismount()

    def cycle(self) -> None:
        """Do a frame, but for drawing it."""
        self.steer()
        self.each_frame()
        before = time.perf_counter()
        self.advance(self._steps_now())
        between = time.perf_counter()
        self.update()
        self.timings = {"steps": between - before, "update": time.perf_counter() - between}

    def _steps_now(self) -> int:
        step_size = self.world.step_size
        single = self.clock.take_single_steps()
        if single:  # the picture shows just this step
            self.accumulator.rest, self._interpolation = 0.0, 1.0
            return single
        steps = self.accumulator.take(self.clock.simulation_delta, step_size)
        if self.lost >= self._report_at:
            self._report_at = 2.0 * self.lost
            log.warning(
                "%s: %.1f s of simulation were left out so far, since a frame takes longer than %d steps of %g s. "
                "Draw less, take larger steps, or allow more of them in SceneConfig.max_steps.",
                self.describe(),
                self.lost,
                self.accumulator.max_steps,
                step_size,
            )
        if not self.clock.paused:
            self._interpolation = self.accumulator.interpolation(step_size)
        return steps

    def advance(self, steps: int) -> None:
        """Simulate so many steps, each after `before_step`."""
        aids = self.aids
        aids.step = StepTimings()
        for _ in range(steps):
            self.before_step()
            self.world.step()
            if aids.inspecting:
                aids.step += self.world.timings

    def update(self) -> None:
        """Get ready for a picture: move the camera, and call what was registered with `Node.on_update`."""
        self.move_camera()
        self._update.update()
        self.aids.update()

    def frame(self, size: tuple[int, int]) -> Frame:
        """The picture of ``size`` pixels, described."""
        before = time.perf_counter()
        frame = self._cull.cull(self.camera.view(), size, self.interpolation, sun=self.sun, sky=self.sky)
        self.timings["cull"] = time.perf_counter() - before
        return frame

    # -- keys

    def steer(self) -> None:
        """Turn the camera by the mouse and move it by the keys; a game may do otherwise.

        The camera is told of keys that went down or came up since the last frame, so what a program wishes by
        `Camera.move` stays as long as no key says otherwise.
        """
        right, down = self.events.look
        if right or down:
            self.camera.look(right, down)
        held = {name: self.events.held(name) for name in MOVES}
        self.camera.move(**{name: down for name, down in held.items() if down != self._held_moves[name]})
        self._held_moves = held
        self.camera.steer()

    def attach(self) -> None:
        """Leave the carrier, or ride what is aimed at: what the key of that name does; a game may do otherwise."""
        if self.camera.carrier is not None:
            self.camera.dismount()
        else:
            self.camera.ride_what_is_aimed_at()

    def move_camera(self) -> None:
        """Take the camera to where this frame's picture is taken from, after its steps; a game may do otherwise."""
        seconds = 0.0 if self._app is None else self.clock.delta
        self.camera.update(seconds, self.interpolation)

    def bind_actions(self) -> None:
        """Let the actions that every game has do what they are called; a game may leave some out, or add its own."""
        self._bind_time()
        self._bind_view()
        self.events.on_press("quit")(self.app.quit)

    def _bind_time(self) -> None:
        events, clock = self.events, self.clock

        @events.on_press("pause")
        def pause() -> None:
            clock.paused = not clock.paused

        events.on_press("single_step")(clock.single_step)

        @events.on_press("slower")
        def slower() -> None:
            clock.speed = min(clock.speed, max(clock.speed / 2, SLOWEST))

        @events.on_press("faster")
        def faster() -> None:
            clock.speed = max(clock.speed, min(max(clock.speed * 2, SLOWEST), FASTEST))

    def _bind_view(self) -> None:
        events, camera, aids = self.events, self.camera, self.aids

        events.on_press("attach")(self.attach)

        @events.on_press("third_person")
        def third_person() -> None:
            camera.distance = 0.0 if camera.distance else 5.0

        @events.on_press("release_mouse")
        def release_mouse() -> None:
            events.captured = not events.captured

        events.on_press("debug")(aids.next_debugging)

        @events.on_press("inspect")
        def inspect() -> None:
            aids.inspecting = not aids.inspecting

        @events.on_press("full_screen")
        def full_screen() -> None:
            self.app.video.full_screen = not self.app.video.full_screen
