"""What the examples share: how a scene is looked at, checked, and run from the command line.

``python -m osgode.examples.heap`` opens a window, or, where there is no screen, writes pictures and a video into
``out/``. ``--headless`` simulates without drawing anything, which takes nothing but osgode itself.
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
from osgode.render import OffscreenDrawer, VideoWriter, Window, save_png

ASSETS = Path(__file__).parent / "assets"
OUT = Path("out")
SIZE = (960, 540)
"""Of windows, pictures and videos, pixels."""
FPS = 30
LONGEST_FRAME = 0.1
"""Seconds of simulation that one frame may ask for: a machine that is too slow shows slow motion."""
DRAG, STEP, ZOOM = 0.008, 0.06, 0.9
"""How far the camera goes for a pixel of the mouse and a frame of an arrow key (radians), and a click of the wheel."""


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

    def view(self, seconds: float = 0.0) -> oo.View:
        """What the camera sees after so many seconds."""
        turned = oo.Quat.from_yaw_pitch_roll(self.yaw + self.turn * seconds, -self.pitch)
        return oo.View(oo.Pose(self.target + turned.rotate((0, 0, self.distance)), turned), field_of_view=0.8)

    def drag(self, right: float, down: float) -> None:
        """Go round by hand; it no longer turns by itself."""
        self.turn = 0.0
        self.yaw -= right
        self.pitch = min(max(self.pitch + down, -0.2), 1.5)


class Example(ABC):
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
        self.root = oo.Group(name=type(self).__name__)
        self.world = self.root.attach(oo.World(**self.WORLD))
        self.moving = self.world.attach(oo.HashSpace(name="moving"))
        self.fixed = self.world.attach(oo.SimpleSpace(name="fixed"))
        self.world.collide(self.moving)
        self.world.collide(self.moving, self.fixed)
        self.camera = Orbit(oo.Vec3(0.0, 1.0, 0.0), 10.0)
        self.sun = oo.Sun()
        self._cull = oo.CullVisitor(self.root)
        self._update = oo.UpdateVisitor(self.root)
        self.build()

    @abstractmethod
    def build(self) -> None:
        """Put everything into the world, and the camera before it."""

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

    def before_step(self) -> None:  # noqa: B027  (most do nothing)
        """Called before each step: what the script does, and what is to be watched."""

    @abstractmethod
    def check(self) -> None:
        """Raise `BrokenPromiseError` if a promise isn't kept after `SECONDS`."""

    def advance(self, steps: int) -> None:
        """Simulate."""
        for _ in range(steps):
            self.before_step()
            self.world.step()

    def update(self) -> None:
        """What is done once for each frame, drawn or not."""
        self._update.update()

    def frame(self, size: tuple[int, int], interpolation: float = 1.0) -> oo.Frame:
        """One picture, described."""
        view = self.camera.view(self.world.time)
        return self._cull.cull(view, size, interpolation, sun=self.sun)


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


@dataclass
class Pacemaker:
    """Turns seconds into whole steps, and keeps the rest for the next time.

    Args:
        step_size: seconds.
        longest: seconds that are simulated at once at most. What is above is lost: a machine too slow for the scene
            would else fall behind more and more.
    """

    step_size: float
    longest: float = LONGEST_FRAME
    left: float = 0.0
    lost: float = 0.0

    def take(self, seconds: float) -> int:
        """How many steps to do now."""
        self.lost += max(seconds - self.longest, 0.0)
        self.left += min(seconds, self.longest)
        steps = int(self.left / self.step_size + 1e-6)
        self.left = max(self.left - steps * self.step_size, 0.0)
        return steps

    @property
    def interpolation(self) -> float:
        """How far the picture is between the step before the last and the last."""
        return self.left / self.step_size


class Stopwatch:
    """Steps, and the time they took, without what the drawing takes."""

    def __init__(self, example: Example) -> None:
        self._example = example
        self.steps = 0
        self.seconds = 0.0

    def advance(self, steps: int) -> None:
        """Simulate, and count."""
        start = time.perf_counter()
        self._example.advance(steps)
        self.seconds += time.perf_counter() - start
        self.steps += steps

    def __str__(self) -> str:
        world = self._example.world
        rate = self.steps / max(self.seconds, 1e-9)
        return (
            f"{self.steps} steps of {len(world.bodies)} bodies in {self.seconds:.1f} s: {rate:.0f} steps per second, "
            f"{rate * world.step_size:.1f} times real time"
        )


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


def simulate(example: Example, seconds: float) -> list[str]:
    """Run without drawing; returns what to tell."""
    watch = Stopwatch(example)
    count = max(round(seconds * FPS), 1)
    pace = Pacemaker(example.world.step_size)
    for _ in progress(count, "simulating"):
        watch.advance(pace.take(seconds / count))
        example.update()
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
    pace = Pacemaker(example.world.step_size)
    written = [*pictures.values(), *([video] if video else [])]
    for path in written:
        path.parent.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    with ExitStack() as stack:
        drawer = stack.enter_context(OffscreenDrawer(SIZE))
        writer = stack.enter_context(VideoWriter(video, FPS, SIZE)) if video else None
        for number in progress(frames, "drawing"):
            watch.advance(pace.take(1 / FPS))
            example.update()
            picture = pictures.get(number + 1)
            if writer is None and picture is None:
                continue
            drawer.draw(example.frame(SIZE, pace.interpolation))
            image = drawer.image()
            if writer is not None:
                writer.write(image)
            if picture is not None:
                save_png(image, picture)
    took = time.perf_counter() - start
    return [f"{watch}; {took:.1f} s with the drawing", *(f"written: {path}" for path in written)]


def open_window(example: Example) -> Window | None:
    """A window, or None, after saying why, if there can't be one."""
    if not has_screen():
        return None
    try:
        return Window(SIZE, f"osgode: {type(example).__name__}")
    except oo.OsgodeError as error:
        print(error)
        return None


def play(example: Example, window: Window, frames: int | None) -> list[str]:
    """Show it in a window until that is closed, or for so many frames; returns what to tell."""
    watch = Stopwatch(example)
    pace = Pacemaker(example.world.step_size)
    print("drag or arrow keys: look around; wheel: nearer, farther; escape: close")
    with window:
        last = time.perf_counter()
        shown = 0
        while not window.closed and shown != frames:
            window.pump()
            steer(window, example.camera)
            now = time.perf_counter()
            watch.advance(pace.take(now - last))
            last = now
            example.update()
            window.draw(example.frame(window.size, pace.interpolation))
            shown += 1
    slow = [f"too slow by {pace.lost:.1f} s, which were left out"] if pace.lost > 1 else []
    return [str(watch), *slow]


def steer(window: Window, camera: Orbit) -> None:
    """Move the camera by mouse and keys; escape closes the window."""
    pg = importlib.import_module("pygame")
    for event in pg.event.get((pg.MOUSEMOTION, pg.MOUSEWHEEL, pg.KEYDOWN)):
        if event.type == pg.MOUSEMOTION and event.buttons[0]:
            camera.drag(event.rel[0] * DRAG, event.rel[1] * DRAG)
        elif event.type == pg.MOUSEWHEEL:
            camera.distance *= ZOOM**event.y
        elif event.type == pg.KEYDOWN and event.key == pg.K_ESCAPE:
            window.closed = True
    held = pg.key.get_pressed()
    right, down = held[pg.K_LEFT] - held[pg.K_RIGHT], held[pg.K_UP] - held[pg.K_DOWN]
    if right or down:
        camera.drag(right * STEP, down * STEP)


def run(kind: type[Example], arguments: Sequence[str] | None = None) -> None:
    """Run an example from the command line, and check it if its whole script has been run.

    Raises:
        BrokenPromiseError: if it doesn't do what it promises.
    """
    name = Path(inspect.getfile(kind)).stem
    options = parse(kind, name, arguments)
    example = kind()
    drawn = options.picture or options.video
    window = None if options.headless or drawn else open_window(example)
    try:
        if window:
            told = play(example, window, options.frames)
            options.seconds = 0.0  # whoever watches may stop whenever they like, so nothing is promised
        elif options.headless or not (drawn or is_installed("moderngl", "PIL")):
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
    parser.add_argument("--headless", action="store_true", help="simulate and check, draw nothing")
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
