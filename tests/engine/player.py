"""Runs the game of `window_game` in a process of its own, on a desktop, and talks with it."""

import json
import queue
import subprocess
import sys
import threading
from pathlib import Path

from tests.desktop import PATIENCE, stop, until

ROOT = Path(__file__).parents[2]
SIZE = (640, 400)
"""Of the game's window, pixels."""
MARK = 72
"""Edge of the square in the middle of its overlay, of 720 units."""
TITLE = "Crates and keys"


class Player:
    """A context manager: the game and who plays it.

    Args:
        desktop: where it is shown.
        kind: what `window_game` shall do.
        others: settings of the game.
    """

    def __init__(self, desktop, kind="plays", *, size=SIZE, capture=False, full_screen=False, samples=None, env=None):
        self.desktop = desktop
        self.seen = []
        settings = {"kind": kind, "size": size, "capture": capture, "full_screen": full_screen, "samples": samples}
        self._command = [sys.executable, "-W", "error", "-m", "tests.engine.window_game", json.dumps(settings)]
        self._environment = desktop.environment | (env or {})
        self._said = queue.SimpleQueue()

    def __enter__(self):
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(
            self._command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, env=self._environment, cwd=ROOT
        )
        self._errors = []
        self._readers = [threading.Thread(target=reads, daemon=True) for reads in (self._read, self._read_errors)]
        for reader in self._readers:
            reader.start()
        return self

    def __exit__(self, *error):
        stop(self.process)
        for reader in self._readers:
            reader.join()
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            pipe.close()

    def _read(self):
        for line in self.process.stdout:
            self._said.put(json.loads(line))
        self._said.put(None)

    def _read_errors(self):
        self._errors += self.process.stderr

    def hear(self, key):
        """Take in what the game says up to the next line with that key, and return its value."""
        while True:
            try:
                words = self._said.get(timeout=PATIENCE)
            except queue.Empty:
                raise AssertionError(f"the game said nothing of {key!r} in {PATIENCE} s; seen: {self.seen}") from None
            if words is None:
                stop(self.process)
                raise AssertionError(f"the game ended before {key!r}: {''.join(self._errors)}")
            if "event" in words:
                self.seen.append((words["event"], *words["values"]))
            if key in words:
                return words[key]

    def _tell(self, **words):
        self.process.stdin.write(json.dumps(words) + "\n")
        self.process.stdin.flush()

    def ask(self, expression):
        """What an expression is in the game, between two frames."""
        self._tell(ask=expression)
        return self.hear("answer")

    def do(self, statement):
        """Have a statement done."""
        self._tell(do=statement)
        self.hear("answer")

    def go_on(self):
        """Let the game begin again."""
        self._tell()

    def until(self, expression):
        """Wait until an expression is true in the game; returns its value."""
        return until(lambda: self.ask(expression), f"{expression} (seen: {self.seen})")

    def ready(self):
        """Wait until the window is there, has the keyboard and shows a picture; returns its number."""
        self.until("window is not None and window.focused and events.focused and clock.frames > 3")
        (number,) = until(lambda: self.desktop.windows(self.process), "there is a window")
        return number

    def ended(self):
        """Wait until the process has ended; returns what it leaves: exit code and errors."""
        code = self.process.wait(PATIENCE)
        for reader in self._readers:
            reader.join()
        return code, "".join(self._errors)

    @property
    def origin(self):
        """Where the top left pixel of the window's inside is on the screen."""
        (number,) = self.desktop.windows(self.process)
        before = self.desktop.pointer()
        self.desktop.xdotool("mousemove", "--window", number, 0, 0)
        place = self.desktop.pointer()
        self.desktop.xdotool("mousemove", *before)
        return place

    def picture(self):
        """What is on the screen where the window's inside is."""
        (x, y), (width, height) = self.origin, self.ask("window.size")
        return self.desktop.picture()[y : y + height, x : x + width]
