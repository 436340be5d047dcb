"""The timings of frames: what is kept, and the graph that shows them."""

import math

import pytest

import osgode as oo
from osgode.engine import FrameTimings
from osgode.engine.frametimings import COLOURS, PAPER, PHASES, RULE
from osgode.errors import FieldError
from osgode.graph.frame import Rectangle, Text
from osgode.render import OffscreenDrawer, Quality, measure_text

AREA = 30.0, 40.0, 420.0, 150.0


def bars(items):
    """The rectangles of bars: by their left edge, each from the bottom to the top."""
    found = {}
    for item in items:
        if isinstance(item, Rectangle) and item.colour in COLOURS.values() and item.width == 3:
            found.setdefault(item.x, []).append(item)
    return [found[x] for x in sorted(found)]


def name_of(item):
    return next(name for name, colour in COLOURS.items() if colour == item.colour)


def test_every_part_has_a_colour_of_its_own():
    assert tuple(COLOURS) == PHASES
    assert len(set(COLOURS.values())) == len(PHASES)


def test_frames_are_kept_in_a_ring():
    timings = FrameTimings(frames=3)
    assert timings.last == dict.fromkeys(PHASES, 0.0)
    for k in range(5):
        timings.add({"draw": 0.001 * k, "app": 7.0})
    assert len(timings) == 3
    assert timings.last["draw"] == 0.004
    assert timings.means()["draw"] == pytest.approx((0.002 + 0.003 + 0.004) / 3)
    assert timings.means(2)["draw"] == pytest.approx(0.0035)
    assert "app" not in timings.last


def test_steps_are_divided_into_their_parts():
    """No second is counted twice: the parts and the rest are the time of the steps."""
    step = oo.StepTimings(collide=1e-3, respond=2e-3, solve=4e-3, report=8e-3, listeners=16e-3, total=31e-3, steps=2)
    timings = FrameTimings()
    timings.add({"steps": 0.05, "cull": 0.01}, step)
    last = timings.last
    assert last["collide"] == pytest.approx(1e-3)
    assert last["solve"] == pytest.approx(14e-3)
    assert last["listeners"] == pytest.approx(16e-3)
    assert last["steps"] == pytest.approx(0.05 - 31e-3)
    assert sum(last.values()) == pytest.approx(0.06)


def test_step_timings_add_up():
    one, other = oo.StepTimings(1, 2, 3, 4, 5, 15, 1), oo.StepTimings(10, 20, 30, 40, 50, 150, 2)
    assert one + other == oo.StepTimings(11, 22, 33, 44, 55, 165, 3)
    assert sum([one, other], start=oo.StepTimings()) == one + other


def test_real_steps_fit_in():
    """What a World says of its steps is no more than what the clock says around them."""
    import time

    world = oo.World()
    world.attach(oo.Body())
    timings = FrameTimings()
    for _ in range(3):
        start = time.perf_counter()
        world.step(5)
        timings.add({"steps": time.perf_counter() - start}, world.timings)
    assert all(seconds >= 0.0 for seconds in timings.last.values())
    assert timings.last["solve"] > 0.0


@pytest.mark.parametrize("seconds", [-1e-9, math.nan, math.inf, "long", None])
def test_times_that_cannot_be(seconds):
    timings = FrameTimings()
    with pytest.raises(FieldError, match="draw"):
        timings.add({"draw": seconds})
    assert len(timings) == 0


@pytest.mark.parametrize("frames", [0, -1, 2.5])
def test_rings_that_cannot_be(frames):
    with pytest.raises(FieldError, match="frames"):
        FrameTimings(frames=frames)


def test_bars_are_stacked_to_scale():
    """Below 9.5 ms in a frame the graph is 10 ms high; each part is as high as its share, one upon the other."""
    timings = FrameTimings()
    timings.add({"events": 0.001, "update": 0.002, "draw": 0.004})
    _x, y, _width, height = AREA
    (column,) = bars(timings.overlay(*AREA))
    high = height - 16
    assert [name_of(bar) for bar in column] == ["events", "update", "draw"]
    assert [bar.height for bar in column] == [pytest.approx(high * part, abs=1) for part in (0.1, 0.2, 0.4)]
    foot = y + height - 8
    for bar in column:
        assert bar.y + bar.height == foot
        foot = bar.y


def test_new_frames_come_from_the_right_and_old_ones_leave():
    timings = FrameTimings()
    timings.add({"draw": 0.001})
    timings.add({"draw": 0.004})
    first, second = (column[0] for column in bars(timings.overlay(*AREA)))
    assert second.x > first.x
    assert second.height > first.height
    for _ in range(300):
        timings.add({"draw": 0.002})
    columns = bars(timings.overlay(*AREA))
    assert len({column[0].height for column in columns}) == 1
    assert columns[-1][0].x == second.x
    x, _, width, _ = AREA
    assert x < columns[0][0].x < columns[-1][0].x < x + width


@pytest.mark.parametrize(
    ("seconds", "lines"), [(0.0, 0), (1e-5, 0), (0.003, 0), (0.016, 1), (0.03, 2), (0.04, 3), (0.3, 3), (20.0, 3)]
)
def test_all_of_it_stays_on_the_paper(seconds, lines):
    """However long frames take; the rulers are at 60, 30 and 10 a second as far as the graph goes."""
    timings = FrameTimings()
    for _ in range(200):
        timings.add(dict.fromkeys(PHASES, seconds / len(PHASES)))
    x, y, width, height = AREA
    items = timings.overlay(*AREA)
    paper = items[0]
    assert paper == Rectangle(x, y, width, height, PAPER)
    for item in items:
        right, low = item.x, item.y
        if isinstance(item, Rectangle):
            right, low = right + item.width, low + item.height
        else:
            wide, high = measure_text(item.text, item.size)
            right, low = right + wide, low + high
        assert item.x >= x
        assert item.y >= y
        assert right <= x + width
        assert low <= y + height
    rulers = [item for item in items if isinstance(item, Rectangle) and item.colour == RULE]
    assert len(rulers) == lines


def test_one_long_frame_does_not_flatten_the_graph():
    timings = FrameTimings()
    for k in range(60):
        timings.add({"draw": 0.5 if k == 30 else 0.004})
    columns = bars(timings.overlay(*AREA))
    assert max(column[0].height for column in columns) == 134
    assert min(column[0].height for column in columns) > 50


def test_the_legend_has_all_parts_and_the_whole():
    """In milliseconds; the figures stay for some frames so that they can be read."""
    timings = FrameTimings()
    timings.add({"draw": 0.004, "cull": 0.0015})
    texts = [item.text for item in timings.overlay(*AREA) if isinstance(item, Text)]
    assert set(PHASES) | {"frame", "4.00", "1.50", "5.50", "182/s"} <= set(texts)
    timings.add({"draw": 0.008})
    assert "4.00" in [item.text for item in timings.overlay(*AREA) if isinstance(item, Text)]
    for _ in range(60):
        timings.add({"draw": 0.008})
    assert "8.00" in [item.text for item in timings.overlay(*AREA) if isinstance(item, Text)]


@pytest.mark.parametrize("size", [(40, 150), (420, 40), (0, 0), (10, 10)])
def test_where_there_is_no_room_less_is_shown(size):
    timings = FrameTimings()
    timings.add({"draw": 0.004})
    items = timings.overlay(0, 0, *size)
    assert items[0] == Rectangle(0, 0, *size, PAPER)
    texts = {item.text for item in items if isinstance(item, Text)}
    assert ("draw" in texts) == (size[1] == 150)
    assert bool(bars(items)) == (size[0] == 420)


def test_rectangles_come_before_texts():
    """Those without a texture are one draw call."""
    timings = FrameTimings()
    for k in range(80):
        timings.add(dict.fromkeys(PHASES, 0.001 + 1e-5 * k))
    items = timings.overlay(0, 0, 300, 150)
    kinds = [isinstance(item, Text) for item in items]
    assert kinds == sorted(kinds)
    try:
        drawer = OffscreenDrawer((320, 200), Quality(samples=0, shadow_size=256))
    except oo.OsgodeError as error:
        pytest.skip(str(error))
    with drawer:
        drawer.draw(oo.Frame(oo.View(), (320, 200)))
        plain = drawer.counts.draws
        drawer.draw(oo.Frame(oo.View(), (320, 200), overlay=items))
        assert drawer.counts.draws == plain + 1 + sum(kinds)
        image = drawer.image()
        assert (image[8:142, 8:150].reshape(-1, 3).max(axis=1) > 200).any()
