"""Runs the game: in a window, or, where there is no screen, as a film that tours everything in it."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import osgode as oo
from osgode.engine import App, ClockConfig
from osgode.examples.game.scene import Game, config
from osgode.examples.game.tour import SECONDS, Tour
from osgode.examples.runner import OUT, has_screen, is_installed, progress
from osgode.render import VideoWriter, save_png

FPS = 24
SIZE = (854, 480)
"""Of the film, pixels."""
EVERY = 6.0
"""Seconds from one picture to the next."""


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m osgode.examples.game", description=(__doc__ or "").strip())
    parser.add_argument("--headless", action="store_true", help="play the tour without a window")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of the tour (default: %(default)s)")
    parser.add_argument("--video", type=Path, metavar="MP4", help="the film's file (default: out/game.mp4)")
    parser.add_argument("--no-pictures", action="store_true", help="simulate the tour, draw nothing")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    options = parse(arguments)
    if not options.headless and options.video is None and has_screen():
        try:
            App(Game, config()).run()
        except oo.OsgodeError as error:  # a screen that nothing can be shown on
            print(error)
        else:
            return
    drawn = not options.no_pictures and is_installed("moderngl", "PIL")
    if not drawn and not options.no_pictures:
        print("simulating only; to see it: pip install 'osgode[render,video]'")
    for line in tour(options.seconds, options.video or OUT / "game.mp4", drawn=drawn):
        print(f"game: {line}")


def tour(seconds: float, video: Path, *, drawn: bool) -> list[str]:
    """Play the tour, as fast as can be, and film it; returns what to tell."""
    mode = "offscreen" if drawn else "none"
    settings = replace(config(mode=mode, size=SIZE), clock=ClockConfig(frame_limit=FPS))
    written: list[Path] = []
    spent = 0.0
    with App(Tour, settings) as app, ExitStack() as stack:
        writer = None
        if drawn:
            video.parent.mkdir(parents=True, exist_ok=True)
            if is_installed("imageio_ffmpeg"):
                writer = stack.enter_context(VideoWriter(video, FPS, SIZE))
                written.append(video)
        frames = round(seconds * FPS)
        for number in progress(frames, "playing"):
            app.cycle()
            spent += app.scene.timings["steps"]
            taken = drawn and (number + 1) % round(EVERY * FPS) == 0
            if writer is None and not taken:
                continue
            drawer = app.video.drawer
            if drawer is None:
                continue
            image = drawer.image()
            if writer is not None:
                writer.write(image)
            if taken:
                written.append(video.with_name(f"{video.stem}-{len(written)}.png"))
                save_png(image, written[-1])
        world = app.scene.world
        shown = ", ".join(name.replace("_", " ") for name in getattr(app.scene, "told", ()))
        rate = world.time / max(spent, 1e-9)
    told = [f"{world.steps} steps in {spent:.1f} s: {rate:.1f} times real time", f"shown: {shown}"]
    return [*told, *(f"written: {path}" for path in written)]
