"""What pygame reports becomes events, without a window."""

import pytest

from osgode.engine.inputs import Focus, MouseMotion, Press, Quit, Release, Resize, ScriptedInput, Wheel, WindowInput
from osgode.errors import FieldError

pg = pytest.importorskip("pygame")


class FakeWindow:
    """A window to which just this has happened."""

    size = (640, 400)

    def __init__(self, *events, focused=True):
        self.focused = focused
        self._events = [*events]

    def pump(self):
        events, self._events = self._events, []
        return events


@pytest.fixture
def typing(monkeypatch):
    """Whether an input method would take keys."""
    stopped = []
    monkeypatch.setattr(pg.key, "stop_text_input", lambda: stopped.append(True))
    return stopped


def happened(kind, **what):
    return pg.event.Event(kind, **what)


def test_each_kind_of_event(typing):
    window = FakeWindow(
        happened(pg.KEYDOWN, scancode=pg.KSCAN_W, key=pg.K_z),
        happened(pg.KEYUP, scancode=pg.KSCAN_LSHIFT, key=pg.K_LSHIFT),
        happened(pg.MOUSEBUTTONDOWN, button=pg.BUTTON_RIGHT, pos=(1, 2)),
        happened(pg.MOUSEBUTTONUP, button=pg.BUTTON_X2, pos=(1, 2)),
        happened(pg.MOUSEMOTION, rel=(3, -4), pos=(50, 60)),
        happened(pg.MOUSEWHEEL, precise_y=-0.5, y=0),
        happened(pg.WINDOWSIZECHANGED, x=800, y=300),
        happened(pg.WINDOWFOCUSLOST),
        happened(pg.WINDOWFOCUSGAINED),
        happened(pg.QUIT),
    )
    assert WindowInput(window).poll() == [
        Focus(True),
        Press("w"),
        Release("left_shift"),
        Press("mouse_right"),
        Release("mouse_5"),
        MouseMotion(3, -4, 50, 60),
        Wheel(-0.5),
        Resize(800, 300),
        Focus(False),
        Focus(True),
        Quit(),
    ]
    assert typing == [True]


def test_what_has_no_name_is_left_out(typing):
    """Keys that few keyboards have, the wheel as a button, the wheel turned sideways, and what no game asks for."""
    window = FakeWindow(
        happened(pg.KEYDOWN, scancode=999, key=0),
        happened(pg.MOUSEBUTTONDOWN, button=pg.BUTTON_WHEELUP, pos=(1, 2)),
        happened(pg.MOUSEWHEEL, precise_y=0.0, y=0),
        happened(pg.WINDOWEXPOSED),
    )
    assert WindowInput(window).poll() == [Focus(True)]


def test_first_of_all_it_tells_who_has_the_keyboard(typing):
    source = WindowInput(FakeWindow(focused=False))
    assert source.poll() == [Focus(False)]
    assert source.poll() == []


def test_pointer_is_held_and_let_go_once(typing, monkeypatch):
    """Also where the other events come from."""
    done = []
    monkeypatch.setattr(pg.mouse, "get_focused", lambda: False)
    monkeypatch.setattr(pg.mouse, "set_pos", done.append)
    monkeypatch.setattr(pg.mouse, "set_relative_mode", done.append)
    script = ScriptedInput()
    source = WindowInput(FakeWindow(), script)
    source.capture(wanted=False)
    assert done == []
    source.capture(wanted=True)
    source.capture(wanted=True)
    assert done == [True, (320, 200)]
    assert script.captured
    source.capture(wanted=False)
    assert done[2:] == [(320, 200), False]
    assert not script.captured


def test_other_events_come_along(typing):
    """A script may play in a window; its own end and the user's keys are heard too."""
    script = ScriptedInput()
    source = WindowInput(FakeWindow(happened(pg.QUIT)), script)
    script.send(Press("w"))
    assert source.poll() == [Focus(True), Quit(), Press("w")]


@pytest.mark.parametrize("kind", [Press, Release])
def test_there_is_no_event_of_a_key_that_there_is_not(kind):
    """A script with a slip in it would else play on, and nothing would happen."""
    with pytest.raises(FieldError, match=f"{kind.__name__}: 'spce' is no key or mouse button; did you mean 'space'"):
        kind("spce")


def test_only_events_can_be_sent():
    source = ScriptedInput()
    with pytest.raises(FieldError, match="'w' is no event such as"):
        source.send(Press("a"), "w")
    assert source.poll() == []
