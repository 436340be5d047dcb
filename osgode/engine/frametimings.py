"""Where the time of each frame goes, as a small graph in the overlay."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping

import numpy as np

from osgode.fields import number, whole
from osgode.graph.frame import Rectangle, Text
from osgode.maths import FloatArray
from osgode.nodes.exports import StepTimings

PHASES = ("events", "steps", "collide", "solve", "listeners", "update", "cull", "draw")
"""Of a frame, in their order; ``steps`` is what of the steps is none of the next three."""
COLOURS: dict[str, tuple[float, float, float, float]] = {
    "events": (0.62, 0.62, 0.66, 1.0),
    "steps": (0.36, 0.47, 0.62, 1.0),
    "collide": (0.25, 0.60, 0.95, 1.0),
    "solve": (0.20, 0.85, 0.75, 1.0),
    "listeners": (0.98, 0.85, 0.25, 1.0),
    "update": (0.98, 0.58, 0.22, 1.0),
    "cull": (0.90, 0.35, 0.60, 1.0),
    "draw": (0.62, 0.42, 0.95, 1.0),
}
PAPER, RULE, INK = (0.03, 0.04, 0.06, 0.72), (1.0, 1.0, 1.0, 0.22), (0.93, 0.94, 0.96, 1.0)
BAR, GAP, EDGE = 3, 1, 8
"""Pixels: width of a bar, space to the next, and to the edges of the paper."""
LEGEND = 122
"""Pixels: width of the names and figures."""
LARGEST, SMALLEST = 14, 9
"""Sizes of letters, pixels."""
STILL = 15
"""Frames for which the figures stay, or nobody could read them."""
RULERS = (1 / 60, 1 / 30, 0.1)
"""Seconds of a frame: the lines of the graph."""
TOPS = (0.005, 0.01, 0.02, 0.04, 0.1, 0.2, 0.5, 1.0)
"""Seconds that the graph is high."""


class FrameTimings:
    """The timings of the last frames by name, and how they are shown.

    Args:
        frames: how many are kept.

    Raises:
        FieldError: for a number that isn't whole and above 0.
    """

    def __init__(self, frames: int = 240) -> None:
        self._rows: deque[FloatArray] = deque(maxlen=whole(1, 100_000)("FrameTimings", "frames", frames))
        self._count = 0
        self._means = dict.fromkeys(PHASES, 0.0)

    def __len__(self) -> int:
        return len(self._rows)

    def add(self, seconds: Mapping[str, float], step: StepTimings | None = None) -> None:
        """Note one frame.

        Args:
            seconds: by the names of `PHASES`; other names are left out, so a whole dict of timings can be given.
            step: what the steps of the frame took, added up: it is taken out of ``steps`` and told by its parts;
                contact joints and reports count as ``solve``.

        Raises:
            FieldError: for a time below 0, or one that isn't finite.
        """
        check = number(0.0, math.inf)
        row = {name: check("FrameTimings.add()", name, seconds.get(name, 0.0)) for name in PHASES}
        if step is not None:
            row["collide"] += step.collide
            row["solve"] += step.respond + step.solve + step.report
            row["listeners"] += step.listeners
            row["steps"] = max(row["steps"] - step.total, 0.0)
        self._rows.append(np.array(list(row.values())))
        if self._count % STILL == 0:
            self._means = self.means(2 * STILL)
        self._count += 1

    @property
    def last(self) -> dict[str, float]:
        """Seconds of the last frame by name; 0 before the first."""
        return self.means(1)

    def means(self, frames: int | None = None) -> dict[str, float]:
        """The mean seconds by name, over so many of the last frames, or over all that are kept."""
        rows = self._table(len(self) if frames is None else frames)
        means = rows.mean(axis=0).tolist() if len(rows) else [0.0] * len(PHASES)
        return dict(zip(PHASES, means, strict=True))

    def overlay(self, x: float, y: float, width: float = 420, height: float = 150) -> list[Rectangle | Text]:
        """The graph, to be drawn in a `Frame.overlay`: a bar a frame, the newest to the right, and a legend.

        The lines across it are 60, 30 and 10 frames a second. Figures are means, taken four times a second.

        Args:
            x: of the left edge, pixels.
            y: of the top edge, pixels.
            width: pixels; what the legend leaves is for the bars.
            height: pixels.
        """
        items: list[Rectangle | Text] = [Rectangle(x, y, width, height, PAPER)]
        wide, high = int(width - 3 * EDGE - LEGEND), int(height - 2 * EDGE)
        if wide >= BAR and high > 0:
            items += self._graph(int(x) + EDGE, int(y) + EDGE, wide, high)
        items += self._legend(x + width - EDGE - LEGEND, y + EDGE, high)
        # What has no texture is drawn in one call if it stands together; no text is below a rectangle.
        return sorted(items, key=lambda item: isinstance(item, Text))

    def _table(self, frames: int) -> FloatArray:
        count = len(self._rows)
        return np.array([self._rows[k] for k in range(max(count - frames, 0), count)]).reshape(-1, len(PHASES))

    def _graph(self, x: int, y: int, width: int, height: int) -> list[Rectangle | Text]:
        rows = self._table((width + GAP) // (BAR + GAP))
        # A single long frame may leave the picture.
        usual = float(np.quantile(rows.sum(axis=1), 0.95)) if len(rows) else 0.0
        top = next((top for top in TOPS if usual <= 0.95 * top), TOPS[-1])
        heights = [round(height * ruler / top) for ruler in RULERS if ruler <= top]
        items: list[Rectangle | Text] = [Rectangle(x, y + height - up, width, 1, RULE) for up in heights]
        # Borders between the parts are whole pixels, or they would shimmer.
        ends = np.minimum(np.rint(rows.cumsum(axis=1) * (height / top)), height).astype(int)
        left = x + width + GAP - len(rows) * (BAR + GAP)
        for k, column in enumerate(ends.tolist()):
            start = 0
            for name, end in zip(PHASES, column, strict=True):
                if end > start:
                    bar = Rectangle(left + k * (BAR + GAP), y + height - end, BAR, end - start, COLOURS[name])
                    items.append(bar)
                    start = end
        items.append(Text(x, y, f"{1e3 * top:g} ms", SMALLEST + 2, (*INK[:3], 0.7)))
        return items

    def _legend(self, x: float, y: float, height: int) -> list[Rectangle | Text]:
        """The parts from top to bottom as they are stacked, and the whole."""
        pitch = height / (len(PHASES) + 1)
        size = int(min(LARGEST, pitch / 1.1))
        if size < SMALLEST:
            return []
        whole_frame = sum(self._means.values())
        items: list[Rectangle | Text] = [Text(x, y, "frame", size, INK), _figure(x, y, size, whole_frame)]
        if whole_frame > 0.0:
            items.append(Text(x + 3.7 * size, y, f"{1 / whole_frame:.0f}/s", size, (*INK[:3], 0.7)))
        for k, name in enumerate(reversed(PHASES), 1):
            at = y + k * pitch
            items.append(Rectangle(x, round(at + 0.15 * pitch), 8, max(round(0.6 * pitch), 2), COLOURS[name]))
            items += [Text(x + 14, at, name, size, INK), _figure(x, at, size, self._means[name])]
        return items


def _figure(x: float, y: float, size: int, seconds: float) -> Text:
    """Milliseconds that end at the same place in each row, whatever the widths of letters."""
    text = f"{1e3 * seconds:.2f}"
    # Digits are as wide as each other, and about 0.56 of the size; the point is half of that.
    return Text(x + LEGEND - 0.56 * size * (len(text) - 0.5), y, text, size, INK)
