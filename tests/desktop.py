"""A screen in memory with a window manager, and a person at its keyboard and mouse: Xvfb, jwm and xdotool."""

import contextlib
import os
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np

PROGRAMS = ("Xvfb", "jwm", "xdotool", "setxkbmap")
SIZE = (1024, 768)
PATIENCE = 90.0
"""Seconds that something may take on a busy machine; nothing waits longer than it has to."""

MANAGER = """<?xml version="1.0"?>
<JWM>
    <FocusModel>click</FocusModel>
    <Desktops width="1" height="1"/>
    <Key mask="A" key="F4">close</Key>
</JWM>
"""


def missing_programs():
    """What of the programs isn't there."""
    return [name for name in PROGRAMS if shutil.which(name) is None]


def until(condition, what, seconds=PATIENCE):
    """Wait for ``condition()`` and return what it gave."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not so after {seconds} s")
        time.sleep(0.02)
    return found


class Desktop:
    """A context manager; `environment` is what programs need to find the screen."""

    def __init__(self, folder):
        self._folder = Path(folder)
        self._open = contextlib.ExitStack()
        self.environment = {}

    def __enter__(self):
        with contextlib.ExitStack() as opening:
            number = self._start_screen(opening)
            hidden = ("WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "XAUTHORITY")
            self.environment = {key: value for key, value in os.environ.items() if key not in hidden}
            self.environment |= {"DISPLAY": f":{number}", "SDL_VIDEODRIVER": "x11"}
            settings = self._folder / "jwmrc"
            settings.write_text(MANAGER)
            self._start(opening, ["jwm", "-f", str(settings)], "jwm.log", env=self.environment)
            until(self._is_managed, "the window manager rules")
            self._open = opening.pop_all()
        return self

    def __exit__(self, *error):
        self._open.close()

    def _start(self, stack, command, log, **settings):
        file = stack.enter_context((self._folder / log).open("w"))
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, **settings)
        stack.callback(stop, process)
        return process

    def _start_screen(self, stack):
        """Start Xvfb on a display that is free, and return its number."""
        reader, writer = os.pipe()
        with os.fdopen(reader) as told:
            width, height = SIZE
            command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", f"{width}x{height}x24", "-noreset"]
            command += ["-nolisten", "tcp", "-fbdir", str(self._folder)]
            try:
                self._start(stack, command, "Xvfb.log", pass_fds=[writer])
            finally:
                os.close(writer)
            number = told.readline().strip()  # empty if it ended instead
        if not number:
            raise AssertionError(f"Xvfb did not start: {(self._folder / 'Xvfb.log').read_text()}")
        return number

    def _is_managed(self):
        command = ["xdotool", "get_num_desktops"]
        return subprocess.run(command, env=self.environment, capture_output=True, check=False).returncode == 0

    def xdotool(self, *words):
        """Do something at keyboard or mouse, or ask for something; returns what was answered."""
        command = ["xdotool", *map(str, words)]
        done = subprocess.run(
            command, env=self.environment, capture_output=True, text=True, check=False, timeout=PATIENCE
        )
        if done.returncode:
            raise AssertionError(f"{' '.join(command)}: {done.stderr or 'failed'}")
        return done.stdout

    def windows(self, process):
        """Numbers of the windows of a process that can be seen."""
        command = ["xdotool", "search", "--onlyvisible", "--pid", str(process.pid)]  # fails where there is none
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False)
        return done.stdout.split()

    def pointer(self):
        """Where the pointer is on the screen."""
        words = self.xdotool("getmouselocation", "--shell").split()
        values = dict(word.split("=") for word in words)
        return int(values["X"]), int(values["Y"])

    def set_layout(self, name):
        """What is printed on the keys."""
        command = ["setxkbmap", name]
        subprocess.run(command, env=self.environment, check=True, timeout=PATIENCE)

    def picture(self):
        """The whole screen: (height, width, 3) bytes."""
        data = (self._folder / "Xvfb_screen0").read_bytes()
        header = np.frombuffer(data, ">u4", 25)  # that of the X Window Dump format, version 7
        size, width, height, stride, colours = (int(header[k]) for k in (0, 4, 5, 12, 19))
        rows = np.frombuffer(data, np.uint8, stride * height, size + 12 * colours).reshape(height, stride)
        return rows[:, : 4 * width].reshape(height, width, 4)[:, :, 2::-1]


def stop(process):
    """End a process that was started here."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
    process.wait()
