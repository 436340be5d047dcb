"""For testing games: a scene that is played by a script, without a window, the same way each time.

::

    from osgode.testing import Play

    def test_the_door_opens():
        with Play(MyGame) as play:
            play.look_at(play.body("door").position)
            play.hold("forward")
            play.seconds(2)
            assert play.body("door").joints[0].angle > 0.5
            play.picture("door.png")
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from typing import Any, Self

import numpy as np

from osgode.engine.app import HEADLESS_RATE, App, AppConfig
from osgode.engine.clock import HandTime
from osgode.engine.inputs import InputEvent, MouseMotion, Press, Release, ScriptedInput, Wheel
from osgode.engine.scene import Scene
from osgode.errors import FieldError, StateError
from osgode.fields import number, whole
from osgode.graph.appearance import Image
from osgode.graph.node import Node
from osgode.maths import Vec3Like
from osgode.nodes.body import Body
from osgode.render import save_png

COUNT = whole(0, 10**9)
SECONDS = number(0.0, 1e6)


class Play:
    """An App that a script plays: a context manager.

    Time is `HandTime`: a frame takes just what the frame limit says, 1/60 s if there is none.

    Args:
        scene: as for `App`.
        config: as for `App`; its video mode becomes ``"none"``: nothing is drawn but what `picture` is asked for.
        **others: ``modules`` of `App`.

    Raises:
        FieldError: as `App`.
    """

    def __init__(self, scene: type[Scene] | Scene, config: AppConfig | None = None, **others: Any) -> None:
        config = AppConfig.given(config, "Play")
        config = replace(config, video=replace(config.video, mode="none"))
        self._time = HandTime()
        self.input = ScriptedInput()
        self.app = App(scene, config, timer=self._time, source=self.input, **others)

    def __enter__(self) -> Self:
        self.app.open()
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self.app.__exit__(kind, error, trace)

    @property
    def scene(self) -> Any:
        """The scene that is played."""
        return self.app.scene

    # -- what the player does

    def send(self, *events: InputEvent) -> None:
        """Let these events happen in the next frame."""
        self.input.send(*events)

    def hold(self, *names: str) -> None:
        """Press actions, keys or buttons and keep them down."""
        self.send(*(Press(self._input(name)) for name in names))

    def release(self, *names: str) -> None:
        """Let them go."""
        self.send(*(Release(self._input(name)) for name in names))

    def tap(self, name: str, frames: int = 1) -> None:
        """Press an action, key or button, hold it for so many frames, and let it go."""
        self.hold(name)
        self.frames(frames)
        self.release(name)
        self.frames(1)

    def look(self, right: float = 0.0, down: float = 0.0) -> None:
        """Move the mouse so that the camera turns by so many radians in the next frame; the pointer is held for it.

        Raises:
            StateError: if the mouse can't turn anything.
        """
        events = self.app.events
        events.captured = True
        pixel = events.config.mouse_sensitivity
        if not pixel:
            raise StateError("Play.look(): the mouse sensitivity of the config is 0, so no mouse can turn the camera")
        self.send(MouseMotion(right / pixel, down / pixel))

    def look_at(self, target: Vec3Like) -> None:
        """Turn the camera to a point of the world at once, as `Camera.look_at`."""
        self.scene.camera.look_at(target)

    def turn_wheel(self, clicks: float) -> None:
        """Turn the mouse wheel in the next frame."""
        self.send(Wheel(clicks))

    def _input(self, name: str) -> str:
        inputs = self.app.events.inputs(name)
        if not inputs:
            raise FieldError(f"Play: no key or mouse button is bound to {name!r}")
        return inputs[0]

    # -- time

    def _frame(self, seconds: float | None = None) -> None:
        """Play one frame, which takes so long."""
        clock = self.app.clock
        limit = clock.frame_limit
        if seconds is None and limit is not None:
            self.app.cycle()
            return
        clock.frame_limit = None
        try:
            self._time.advance(1 / HEADLESS_RATE if seconds is None else seconds)
            self.app.cycle()
        finally:
            if clock.frame_limit is None:
                clock.frame_limit = limit

    def frames(self, count: int) -> None:
        """Play so many frames, or until somebody quits."""
        for _ in range(COUNT("Play.frames()", "count", count)):
            if self.app.quitting:
                return
            self._frame()

    def seconds(self, seconds: float) -> None:
        """Play frames for so many seconds."""
        limit = self.app.clock.frame_limit or HEADLESS_RATE
        self.frames(round(SECONDS("Play.seconds()", "seconds", seconds) * limit))

    def steps(self, count: int) -> None:
        """Play frames of one step each, until so many steps have been simulated, or somebody quits.

        Raises:
            StateError: if the simulation stands still, or comes to do so.
        """
        clock, world = self.app.clock, self.scene.world
        wanted = world.steps + COUNT("Play.steps()", "count", count)
        while world.steps < wanted and not self.app.quitting:
            if clock.paused or clock.speed == 0.0:
                raise StateError("Play.steps(): the simulation is paused, or its speed is 0")
            self._frame(world.step_size / clock.speed)

    def until(self, condition: Callable[[], object], seconds: float = 10.0) -> float:
        """Play until ``condition()`` is true; returns the seconds that it took.

        Raises:
            AssertionError: if it isn't true after ``seconds``, or when somebody quits.
        """
        limit = SECONDS("Play.until()", "seconds", seconds)
        begin = self.app.clock.elapsed
        while not condition():
            passed = self.app.clock.elapsed - begin
            if passed >= limit or self.app.quitting:
                why = ", when the App was quit" if self.app.quitting else ""
                raise AssertionError(f"Play.until(): it wasn't so after {passed:.3f} s{why}")
            self._frame()
        return self.app.clock.elapsed - begin

    # -- what is there

    def node(self, name: str) -> Node:
        """The first node of that name.

        Raises:
            FieldError: if there is none.
        """
        found: Node | None = self.scene.root.find(name)
        if found is None:
            names = sorted({node.name for node in self.scene.root.walk() if node.name})
            raise FieldError(f"Play.node(): no node is called {name!r}; there are {', '.join(names)}")
        return found

    def body(self, name: str) -> Body:
        """The body of that name.

        Raises:
            FieldError: if there is none.
        """
        found = self.node(name)
        if not isinstance(found, Body):
            raise FieldError(f"Play.body(): {found.describe()} is no Body")
        return found

    def fingerprint(self) -> str:
        """A hash of the state of all bodies and joints and of the camera: the same bits give the same."""
        world, camera = self.scene.world, self.scene.camera
        digest = hashlib.sha256()
        for table in (world.poses, world.velocities, world.joint_states, np.array([*camera.pose[0], *camera.pose[1]])):
            digest.update(np.ascontiguousarray(table).tobytes())
        return digest.hexdigest()

    def picture(self, path: str | PathLike[str] | None = None, size: tuple[int, int] | None = None) -> Image:
        """A picture of the scene as it is now, (height, width, 3) bytes; written as a PNG if a path is given.

        Raises:
            MissingExtraError: if what draws isn't installed.
        """
        image = self.app.video.picture(size)
        if path is not None:
            save_png(image, path)
        return image
