"""A game for the tests of the real window: says what it sees and does what it is told, a line of JSON each."""

import contextlib
import json
import queue
import sys
import threading
from dataclasses import astuple

import pygame

import osgode as oo
from osgode.engine import App, AppConfig, ClockConfig, EventsConfig, HudBox, HudText, Scene, Video, VideoConfig
from osgode.graph.appearance import Appearance
from osgode.render import OffscreenDrawer, Quality, save_png
from tests.engine.player import MARK, TITLE


def say(**what):
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


class Told:
    """What was written to standard input, line by line; None at its end."""

    def __init__(self):
        self.lines = queue.SimpleQueue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in sys.stdin:
            self.lines.put(line)
        self.lines.put(None)


class Game(Scene):
    """Crates on the ground, which stand still: the clock is paused."""

    def __init__(self, config=None, told=None):
        super().__init__(config)
        self.told = told
        self.looked = [0.0, 0.0]
        self.moved = [0.0, 0.0]
        self.names = {}

    def populate_world(self):
        self.static.attach(oo.Plane((0, 1, 0), material="concrete"))
        for k in range(4):
            colour = Appearance((1.0, 0.3 * k, 0.1, 1.0))
            body = self.dynamic.attach(oo.Body(position=(1.3 * k - 2.0, 0.4, -4.0)))
            body.attach(oo.Placeable()).attach(oo.Box((0.8, 0.8, 0.8), density=90, appearance=colour))
        self.camera.position = (0, 1.7, 2)

    def populate_hud(self):
        self.hud.attach(HudText("Crates 123", x=20, y=16, size=40))
        self.hud.attach(HudBox("centre", width=MARK, height=MARK, colour=(1, 0, 1, 1)))
        self.events.on_event(self.hear)

    def hear(self, event):
        say(event=type(event).__name__, values=astuple(event))

    def each_frame(self):
        for total, part in ((self.looked, self.events.look), (self.moved, self.events.mouse_motion)):
            total[0] += part[0]
            total[1] += part[1]
        with contextlib.suppress(queue.Empty):  # one in a frame, so that the next sees what this has done
            line = self.told.lines.get_nowait()
            if line is None:  # whoever started this has gone
                self.app.quit()
            else:
                self.answer(json.loads(line))

    def draw(self, path, size):
        """What the window should show, drawn without one."""
        with OffscreenDrawer(size, self.app.video.window.quality) as drawer:
            drawer.draw(self.frame(size))
            save_png(drawer.image(), path)

    def answer(self, words):
        names = self.names
        names |= {"app": self.app, "scene": self, "clock": self.clock, "events": self.events, "video": self.app.video}
        names |= {"window": self.app.video.window, "camera": self.camera, "pygame": pygame}
        if "do" in words:
            exec(words["do"], names)  # noqa: S102 - the tests are the only ones that write here
            say(answer=None)
        else:
            say(answer=eval(words["ask"], names))  # noqa: S307


class FailsInTheLoop(Game):
    """A module that fails once it has been seen."""

    def each_frame(self):
        super().each_frame()
        if self.clock.frames == 3:
            raise RuntimeError("broken on purpose")


class FailsAtTheStart(Video):
    """A module that fails when the window is there already."""

    def start(self):
        super().start()
        self.window.pump()
        raise RuntimeError("broken on purpose")


def play(scene, config, *modules):
    App(scene, config, modules=modules).run()


def main(kind, size, capture, full_screen, samples):
    told = Told()
    quality = None if samples is None else Quality(samples=samples, shadow_size=1024)
    video = VideoConfig(size=size, title=TITLE, full_screen=full_screen, quality=quality)
    clock = ClockConfig(frame_limit=60, paused=True)
    config = AppConfig(clock=clock, events=EventsConfig(capture=capture), video=video)
    try:
        if kind == "fails in the loop":
            play(FailsInTheLoop(config.scene, told), config)
        elif kind == "fails at the start":
            play(Game(config.scene, told), config, FailsAtTheStart(video))
        elif kind == "plays twice":
            play(Game(config.scene, told), config)
    except RuntimeError as error:
        say(failed=str(error))
    if kind != "plays":
        say(between=bool(pygame.display.get_init()))
        told.lines.get()  # wait for a line
    play(Game(config.scene, told), config)
    say(ended=True)


if __name__ == "__main__":
    main(**json.loads(sys.argv[1]))
