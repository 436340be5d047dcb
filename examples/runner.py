"""What the examples share: how a scene is looked at, checked, and run from the command line.

``python -m osgode.examples.heap`` opens a window, or, where there is no screen, writes pictures and a video into
``out/``. ``--headless`` opens no window, and draws only what ``--picture`` and ``--video`` ask for: without these it
takes nothing but osgode itself.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import inspect
import math
import os
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

import osgode as oo
from osgode.engine import App, AppConfig, Camera, ClockConfig, Scene, SceneConfig, VideoConfig
from osgode.render import VideoWriter, save_png

ASSETS = Path(__file__).parent / "assets"
OUT = Path("out")
SIZE = (960, 540)
"""Of windows, pictures and videos, pixels."""
FPS = 30
LONGEST_FRAME = 0.1
"""Seconds of simulation that one frame may ask for: a machine that is too slow shows slow motion."""
DRAG, STEP, ZOOM = 0.008, 0.06, 0.9
"""How far the camera goes for a pixel of the mouse and a frame of an arrow key (radians), and a click of the wheel."""


KEYS = (
    "drag or arrow keys: look around; wheel: nearer, farther; p: pause; period: single step; "
    "minus, equals: slower, faster; f3: debug overlay; f11: full screen; escape: close"
)


class BrokenPromiseError(AssertionError):
    """An example doesn't do what it promises."""


@dataclass
class Orbit:
    """A camera on a sphere about what it looks at.

    Args:
        target: what is in the middle of the picture.
        distance: from it, metres.
        yaw: 0 looks along -Z, positive from farther to the right, radians.
        pitch: how far down it looks, radians.
        turn: how fast it goes round by itself, rad/s.
    """

    target: oo.Vec3
    distance: float
    yaw: float = 0.0
    pitch: float = 0.3
    turn: float = 0.0

    def place(self, camera: Camera, seconds: float = 0.0) -> None:
        """Put a camera there, as it is after so many seconds."""
        yaw = self.yaw + self.turn * seconds
        turned = oo.Quat.from_yaw_pitch_roll(yaw, -self.pitch)
        camera.position = self.target + turned.rotate((0, 0, self.distance))
        camera.yaw, camera.pitch = yaw, -self.pitch
        camera.update(0.0)

    def drag(self, right: float, down: float) -> None:
        """Go round by hand; it no longer turns by itself."""
        self.turn = 0.0
        self.yaw -= right
        self.pitch = min(max(self.pitch + down, -0.2), 1.5)


class Example(Scene, ABC):
    """A scene with a script, what it promises, and how it is looked at.

    A subclass builds its scene in ``build``, acts in ``before_step``, and says in ``check`` what must be true after
    `SECONDS` of simulation.
    """

    SECONDS: ClassVar[float] = 8.0
    """How long the script takes."""
    MOMENTS: ClassVar[tuple[float, ...]] = (0.5, 2.0, 5.0)
    """When pictures are taken if nobody says otherwise, seconds."""
    WORLD: ClassVar[dict[str, Any]] = {}
    """Settings of the World."""

    def __init__(self) -> None:
        step_size = self.WORLD.get("step_size", 1 / 120)
        super().__init__(SceneConfig(step_size=step_size, max_steps=max(round(LONGEST_FRAME / step_size), 1)))
        for name, value in self.WORLD.items():
            setattr(self.world, name, value)
        self.moving, self.fixed = self.dynamic, self.static
        self.orbit = Orbit(oo.Vec3(0.0, 1.0, 0.0), 10.0)
        self.camera.field_of_view = 0.8
        self.build()

    @abstractmethod
    def build(self) -> None:
        """Put everything into the world, and the camera around it."""

    def body(
        self,
        shape: oo.Geom,
        position: oo.Vec3Like,
        rotation: oo.QuatLike = (1.0, 0.0, 0.0, 0.0),
        *,
        name: str = "",
        collides: bool = True,
    ) -> oo.Body:
        """A body of one part; without ``collides`` it is in no space, and passes through everything."""
        body = oo.Body(name=name, position=position, rotation=rotation)
        body.attach(oo.Placeable()).attach(shape)
        return (self.moving if collides else self.world).attach(body)

    def still(
        self, shape: oo.Geom, position: oo.Vec3Like = (0.0, 0.0, 0.0), rotation: oo.QuatLike = (1.0, 0.0, 0.0, 0.0)
    ) -> oo.Placeable:
        """A part of the static world."""
        place = self.fixed.attach(oo.Placeable(position=position, rotation=rotation))
        place.attach(shape)
        return place

    def ground(self, texture: str = "concrete", tint: tuple[float, float, float] = (0.8, 0.8, 0.8)) -> None:
        """Level ground."""
        self.fixed.attach(oo.Plane(material="concrete", appearance=look(texture, tint, scale=4.0, shine=0.0)))

    def show_joints(self, size: float = 0.3) -> None:
        """Draw anchors and axes of all joints over the picture."""
        self.world.attach(oo.joint_marks(self.world, size=size))

    @abstractmethod
    def check(self) -> None:
        """Raise `BrokenPromiseError` if a promise isn't kept after `SECONDS`."""

    def steer(self) -> None:
        """Go round by the mouse and the arrow keys, nearer and farther by the wheel."""
        events, orbit = self.events, self.orbit
        right = events.axis("arrow_right", "arrow_left") * STEP
        down = events.axis("arrow_down", "arrow_up") * STEP
        if events.held("mouse_left"):
            right += events.mouse_motion[0] * DRAG
            down += events.mouse_motion[1] * DRAG
        if right or down:
            orbit.drag(right, down)
        orbit.distance *= ZOOM**events.wheel

    def move_camera(self) -> None:
        """Put the camera where the orbit says."""
        self.orbit.place(self.camera, self.world.time)


def expect(truth: bool, promise: str) -> None:
    """Raise `BrokenPromiseError` with the promise unless it is kept."""
    if not truth:
        raise BrokenPromiseError(promise)


@cache
def texture(name: str) -> oo.Texture | None:
    """An image of the assets; None without Pillow, and the thing has its plain colour."""
    return oo.load_texture(ASSETS / f"{name}.png") if is_installed("PIL") else None


def look(
    name: str, tint: tuple[float, float, float] = (1.0, 1.0, 1.0), *, scale: float | None = None, shine: float = 0.1
) -> oo.Appearance:
    """A textured appearance.

    Args:
        name: of an image of the assets.
        tint: what its colours are multiplied with.
        scale: metres that the image covers; None stretches it over each face.
        shine: 0 to 1.
    """
    metres = None if scale is None else (scale, scale)
    return oo.Appearance((*tint, 1.0), texture(name), metres, shine)


def painted(red: float, green: float, blue: float, shine: float = 0.6) -> oo.Appearance:
    """One colour, shining a little."""
    return oo.Appearance((red, green, blue, 1.0), shininess=shine)


ALONG_X, ALONG_Y = oo.Quat.between((0, 0, 1), (1, 0, 0)), oo.Quat.between((0, 0, 1), (0, 1, 0))
"""Rotations that lay a cylinder or capsule along x or y."""


def is_installed(*modules: str) -> bool:
    """Whether they can be imported."""
    return all(importlib.util.find_spec(module) is not None for module in modules)


def has_screen() -> bool:
    """Whether a window could be opened."""
    served = sys.platform in ("win32", "darwin") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(served) and is_installed("pygame", "moderngl")


def progress(count: int, doing: str) -> Iterator[int]:
    """0 to count - 1, with a bar on a terminal: tqdm's where that is installed. A log gets no more than a few lines."""
    live = sys.stderr.isatty()
    if is_installed("tqdm"):
        often = 0.1 if live else 20.0
        bar = importlib.import_module("tqdm").tqdm(range(count), desc=doing, unit="", ncols=78, mininterval=often)
        yield from bar
        return
    for k in range(count):
        if live:
            done = 30 * k // count
            print(f"\r{doing} [{'#' * done}{'.' * (30 - done)}] {k}/{count}", end="", file=sys.stderr, flush=True)
        yield k
    print("\r" * live + f"{doing} [{'#' * 30}] {count}/{count}", file=sys.stderr)


class Stopwatch:
    """Frames played, and the time that their steps took, without what the drawing takes."""

    def __init__(self, example: Example) -> None:
        self._example = example
        self._before = example.world.steps
        self.seconds = 0.0

    def cycle(self, app: App) -> None:
        """Play a frame, and count."""
        app.cycle()
        self.seconds += self._example.timings["steps"]

    def __str__(self) -> str:
        world = self._example.world
        steps = world.steps - self._before
        rate = steps / max(self.seconds, 1e-9)
        return (
            f"{steps} steps of {len(world.bodies)} bodies in {self.seconds:.1f} s: {rate:.0f} steps per second, "
            f"{rate * world.step_size:.1f} times real time"
        )


def without_window(example: Example, fps: float) -> App:
    """An App that plays by itself, so many frames a second of simulation."""
    video = VideoConfig(mode="none", size=SIZE)
    return App(example, AppConfig(clock=ClockConfig(frame_limit=fps), video=video))


def simulate(example: Example, seconds: float) -> list[str]:
    """Run without drawing; returns what to tell."""
    watch = Stopwatch(example)
    count = max(round(seconds * FPS), 1)
    with without_window(example, count / seconds) as app:
        for _ in progress(count, "simulating"):
            watch.cycle(app)
    return [str(watch)]


def film(example: Example, frames: int, pictures: dict[int, Path], video: Path | None) -> list[str]:
    """Draw frames without a window.

    Args:
        example: what is shown.
        frames: how many, `FPS` of them a second.
        pictures: frames to be written as pictures, numbered from 1, and their files.
        video: where to write the video, if there is to be one.

    Returns:
        What to tell.
    """
    watch = Stopwatch(example)
    written = [*pictures.values(), *([video] if video else [])]
    for path in written:
        path.parent.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    with without_window(example, FPS) as app, ExitStack() as stack:
        writer = stack.enter_context(VideoWriter(video, FPS, SIZE)) if video else None
        for number in progress(frames, "drawing"):
            watch.cycle(app)
            picture = pictures.get(number + 1)
            if writer is None and picture is None:
                continue
            image = app.video.picture()
            if writer is not None:
                writer.write(image)
            if picture is not None:
                save_png(image, picture)
    took = time.perf_counter() - start
    return [f"{watch}; {took:.1f} s with the drawing", *(f"written: {path}" for path in written)]


def play(example: Example, frames: int | None) -> list[str] | None:
    """Show it in a window until that is closed, or for so many frames.

    Returns:
        What to tell; None, after saying why, if there can't be a window.
    """
    if not has_screen():
        return None
    app = App(example, AppConfig(video=VideoConfig(size=SIZE, title=f"osgode: {type(example).__name__}")))
    try:
        app.open()
    except oo.OsgodeError as error:
        print(error)
        return None
    print(KEYS)
    watch = Stopwatch(example)
    with app:
        left = frames
        while not app.quitting and left != 0:
            watch.cycle(app)
            left = None if left is None else left - 1
    slow = [f"too slow by {example.lost:.1f} s, which were left out"] if example.lost > 1 else []
    return [str(watch), *slow]


def run(kind: type[Example], arguments: Sequence[str] | None = None) -> None:
    """Run an example from the command line, and check it if its whole script has been run.

    Raises:
        BrokenPromiseError: if it doesn't do what it promises.
    """
    name = Path(inspect.getfile(kind)).stem
    options = parse(kind, name, arguments)
    example = kind()  # not for `play`: that may fill one, and then get no window
    drawn = options.picture or options.video
    try:
        told = None if options.headless or drawn else play(kind(), options.frames)
        if told is not None:
            options.seconds = 0.0  # whoever watches may stop whenever they like, so nothing is promised
        elif not drawn and (options.headless or not is_installed("moderngl", "PIL")):
            if not options.headless:
                print("simulating only; to see it: pip install 'osgode[render,video]'")
            told = simulate(example, options.seconds)
        else:
            told = film(example, *shots(example, name, options))
    except oo.MissingExtraError as error:
        sys.exit(f"{name}: {error}")
    for line in told:
        print(f"{name}: {line}")
    if math.isclose(options.seconds, kind.SECONDS):
        example.check()
        print(f"{name}: did what it promises")


def shots(example: Example, name: str, options: argparse.Namespace) -> tuple[int, dict[int, Path], Path | None]:
    """The number of frames, the frames to be written as pictures, and the video's file."""
    frames = max(round(options.seconds * FPS), 1)
    if options.picture or options.video:
        return frames, ({frames: options.picture} if options.picture else {}), options.video
    at = [round(moment * FPS) for moment in example.MOMENTS]
    pictures = {frame: OUT / f"{name}-{k}.png" for k, frame in enumerate(at, 1) if frame <= frames}
    video = OUT / f"{name}.mp4" if is_installed("imageio_ffmpeg") else None
    return frames, pictures or {frames: OUT / f"{name}.png"}, video


def parse(kind: type[Example], name: str, arguments: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    about = (sys.modules[kind.__module__].__doc__ or "").partition("\n\n")[0]
    parser = argparse.ArgumentParser(prog=f"python -m osgode.examples.{name}", description=about)
    parser.add_argument("--headless", action="store_true", help="open no window; draw only what is asked for")
    parser.add_argument("--seconds", type=float, default=kind.SECONDS, help="of simulation (default: %(default)s)")
    parser.add_argument("--frames", type=int, help=f"stop after so many frames, {FPS} a second")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="write the last frame into this file")
    parser.add_argument("--video", type=Path, metavar="MP4", help="write a video into this file")
    options = parser.parse_args(arguments)
    if options.frames is not None:
        options.seconds = options.frames / FPS
    if not 0 < options.seconds < math.inf:
        parser.error(f"there is nothing to be done in {options.seconds} seconds")
    return options
