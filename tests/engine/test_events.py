"""What is held, pressed and released, and what it is called."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.engine import (
    BINDINGS,
    INPUTS,
    Events,
    EventsConfig,
    Focus,
    MouseMotion,
    Press,
    Quit,
    Release,
    Resize,
    ScriptedInput,
    Wheel,
)
from osgode.engine.keys import BUTTON_NAMES, KEY_NAMES, SCANCODES
from osgode.errors import FieldError


def make(**config):
    """Events and the script that feeds them."""
    source = ScriptedInput()
    return Events(EventsConfig(**config), source), source


def feed(events, *what):
    """One frame in which this happens."""
    events.source.send(*what)
    events.cycle()


def test_down_held_up():
    """Pressed in one frame, held until it comes up, released in one frame; by key and by action."""
    events, _ = make()
    for name in ("w", "forward"):
        assert not events.held(name)
    feed(events, Press("w"))
    for name in ("w", "forward"):
        assert (events.held(name), events.pressed(name), events.released(name)) == (True, True, False)
    feed(events)
    for name in ("w", "forward"):
        assert (events.held(name), events.pressed(name), events.released(name)) == (True, False, False)
    feed(events, Release("w"))
    for name in ("w", "forward"):
        assert (events.held(name), events.pressed(name), events.released(name)) == (False, False, True)
    feed(events)
    assert not events.released("w")
    assert not events.held("s")
    assert not events.pressed("backward")


def test_down_and_up_within_a_frame():
    """A short tap is not lost, though it is never held."""
    events, _ = make()
    feed(events, Press("e"), Release("e"))
    assert (events.held("attach"), events.pressed("attach"), events.released("attach")) == (False, True, True)
    feed(events)
    assert (events.pressed("attach"), events.released("attach")) == (False, False)


def test_keys_that_repeat_are_pressed_once():
    """What is down can't go down again, and what is up can't come up."""
    events, _ = make()
    heard = []
    events.on_press("space")(lambda: heard.append(1))
    feed(events, Press("space"))
    feed(events, Press("space"), Press("space"))
    assert events.held("space")
    assert not events.pressed("space")
    assert heard == [1]
    feed(events, Release("space"), Release("space"), Press("space"))
    assert heard == [1, 1]
    feed(events, Release("x"))
    assert not events.released("x")


@given(st.lists(st.tuples(st.booleans(), st.sampled_from(["w", "arrow_up", "s", "mouse_left"])), max_size=40))
def test_an_action_is_held_while_any_of_its_keys_is(what):
    """Two keys of one action: it is held as long as one of them is."""
    events, _ = make()
    down = set()
    for is_down, name in what:
        feed(events, Press(name) if is_down else Release(name))
        was = set(down)
        (down.add if is_down else down.discard)(name)
        assert events.held("forward") == bool(down & {"w", "arrow_up"})
        assert events.pressed(name) == (is_down and name not in was)
        assert events.released(name) == (not is_down and name in was)
        assert events.axis("backward", "forward") == events.held("forward") - ("s" in down)


def test_axis():
    events, _ = make()
    assert events.axis("left", "right") == 0.0
    feed(events, Press("d"))
    assert events.axis("left", "right") == 1.0
    feed(events, Press("a"))
    assert events.axis("left", "right") == 0.0
    feed(events, Release("d"))
    assert events.axis("left", "right") == -1.0


def test_bindings_can_be_given_and_changed():
    """A config adds to the common bindings, or replaces those of the same name; a copy is handed out."""
    events, _ = make(bindings={"jump": "space", "fire": ["mouse_left", "f"], "forward": "i"})
    assert events.inputs("jump") == ("space",)
    assert events.inputs("fire") == ("mouse_left", "f")
    assert events.inputs("forward") == ("i",)
    assert events.inputs("backward") == BINDINGS["backward"]
    assert events.inputs("q") == ("q",)
    feed(events, Press("mouse_left"))
    assert events.held("fire")
    events.bind("fire", "g")
    assert not events.held("fire")
    events.bindings["fire"] = ()
    assert events.bindings["fire"] == ("g",)
    events.bind("fire", ())
    assert not events.held("fire")
    assert "jump" not in BINDINGS


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (lambda events: events.held("foward"), r"'foward' is no action.*did you mean 'forward'"),
        (lambda events: events.pressed("spaec"), r"did you mean 'space'"),
        (lambda events: events.released("zzzzzz"), r"'zzzzzz'.*INPUTS"),
        (lambda events: events.axis("left", "rihgt"), r"did you mean 'right'"),
        (lambda events: events.inputs(3), r"3 is no action"),
        (lambda events: events.inputs(["w"]), r"\['w'\] is no action"),
        (lambda events: events.on_press("atack"), r"did you mean 'attach'"),
        (lambda events: events.on_press("e")(3), r"on_press\('e'\).*callable"),
        (lambda events: events.on_event("hear"), r"on_event.*callable"),
        (lambda events: events.bind("jump", "spce"), r"bind\('jump'\).*did you mean 'space'"),
        (lambda events: events.bind("jump", "forward"), r"'forward' is no key"),
        (lambda events: events.bind("jump", 32), r"bind\('jump'\): 32"),
        (lambda events: events.bind("jump", ["j", 3]), r"bind\('jump'\): 3"),
        (lambda events: events.bind("jump", [["j"]]), r"bind\('jump'\)"),
        (lambda events: events.bind("", "j"), r"'' can't be an action"),
        (lambda events: events.bind("w", "j"), r"'w' can't be an action"),
        (lambda events: events.bind(4, "j"), r"4 can't be an action"),
        (lambda events: setattr(events, "captured", "yes"), r"Events.captured"),
    ],
)
def test_bad_names_of_inputs(act, words):
    """A wrong name is told with one that was perhaps meant, and nothing is changed."""
    events, _ = make()
    before = events.bindings
    with pytest.raises(FieldError, match=words):
        act(events)
    assert events.bindings == before


def test_bad_bindings_in_a_config():
    with pytest.raises(FieldError, match="did you mean"):
        make(bindings={"jump": "spacebar"})


def test_losing_the_keyboard_lets_go():
    """Nobody tells when keys come up in another window: they count as released at once."""
    events, _ = make()
    feed(events, Press("w"), Press("mouse_right"))
    feed(events, Focus(gained=False))
    assert not events.focused
    assert not events.held("w")
    assert not events.held("mouse_right")
    assert events.released("forward")
    assert events.released("mouse_right")
    feed(events, Focus(gained=True))
    assert events.focused
    assert not events.held("w")
    assert not events.pressed("w")
    feed(events, Press("w"))
    assert events.pressed("w")


def test_losing_the_keyboard_lets_the_pointer_go():
    """The pointer is let go with the focus and taken again with it, if it is wished for."""
    events, source = make()
    events.captured = True
    assert source.captured
    feed(events, Focus(gained=False))
    assert not source.captured
    assert events.captured, "it is still wished for"
    feed(events, Focus(gained=True))
    assert source.captured
    events.captured = False
    feed(events, Focus(gained=False), Focus(gained=True))
    assert not source.captured
    feed(events, Focus(gained=False))
    events.captured = True
    assert not source.captured, "not while another window has the keyboard"
    feed(events, Focus(gained=True))
    assert source.captured
    events.stop()
    assert not source.captured


def test_capture_from_the_start():
    events, source = make(capture=True)
    events.start()
    assert events.captured
    assert source.captured
    events.stop()
    assert not source.captured


def test_another_source_takes_over_the_pointer():
    """The window that is opened after the events were started holds the pointer then."""
    events, source = make(capture=True)
    events.start()
    window = ScriptedInput()
    events.source = window
    assert window.captured
    assert not source.captured
    window.send(Press("w"))
    events.cycle()
    assert events.held("w")
    events.captured = False
    events.source = source
    assert not source.captured


def test_looking_needs_a_held_pointer():
    """The mouse turns the camera only while it is held: pixels times sensitivity."""
    events, _ = make(mouse_sensitivity=0.01)
    feed(events, MouseMotion(30, -20, 130, 80))
    assert events.mouse_motion == (30, -20)
    assert events.mouse_position == (130, 80)
    assert events.look == (0.0, 0.0)
    events.captured = True
    feed(events, MouseMotion(10, 5, 140, 85), MouseMotion(20, 15, 160, 100))
    assert events.mouse_motion == (30, 20)
    assert events.mouse_position == (130, 80), "it stands still while it is held"
    assert events.look == pytest.approx((0.3, 0.2))
    feed(events)
    assert events.look == (0.0, 0.0)
    assert events.mouse_motion == (0.0, 0.0)


def test_the_wheel_adds_up_within_a_frame():
    events, _ = make()
    feed(events, Wheel(1.0), Wheel(2.0), Wheel(-0.5))
    assert events.wheel == 2.5
    feed(events)
    assert events.wheel == 0.0


def test_listeners_hear_in_order():
    """Those of an action and of its key, in the order of events; all events are heard by `on_event`."""
    events, _ = make()
    heard = []
    events.on_press("forward")(lambda: heard.append(("forward", events.held("forward"))))
    events.on_press("w")(lambda: heard.append("w"))
    events.on_event(heard.append)
    what = [Press("arrow_up"), Press("w"), Resize(10, 20), Quit(), Release("w")]
    feed(events, *what)
    assert heard == [("forward", True), what[0], ("forward", True), "w", *what[1:]]


def test_listeners_can_be_decorated():
    """A decorated function stays what it is."""
    events, _ = make()

    @events.on_press("e")
    def attach():
        return 3

    @events.on_event
    def hear(event):
        return 4

    assert (attach(), hear(None)) == (3, 4)


def test_a_listener_may_listen_and_bind():
    """What is registered while an event is told is heard from the next on."""
    events, _ = make()
    heard = []

    @events.on_press("e")
    def first():
        events.on_press("e")(lambda: heard.append("second"))
        events.bind("attach", "q")
        heard.append("first")

    events.on_press("attach")(lambda: heard.append("attach"))
    feed(events, Press("e"), Release("e"))
    assert heard == ["first", "attach"]
    feed(events, Press("q"))
    assert heard == ["first", "attach", "attach"]


def test_a_listener_that_fails_loses_nothing():
    """All others hear, all events are taken in, and no key stays held; then the errors come out."""
    events, _ = make()
    heard = []

    @events.on_press("w")
    def fail():
        raise ValueError("no")

    events.on_press("forward")(lambda: heard.append("forward"))

    @events.on_event
    def fail_too(event):
        if event == Wheel(1.0):
            raise KeyError("neither")

    feed_all = (Press("w"), Wheel(1.0), Release("w"), Press("d"))
    with pytest.raises(ExceptionGroup, match="listeners of events") as caught:
        feed(events, *feed_all)
    assert [type(error) for error in caught.value.exceptions] == [ValueError, KeyError]
    assert "Press(name='w')" in caught.value.exceptions[0].__notes__[0]
    assert heard == ["forward"]
    assert not events.held("w")
    assert events.released("w")
    assert events.held("d")
    with pytest.raises(ValueError, match="no"):
        feed(events, Press("w"))
    events.cycle()


def test_names_of_keys():
    """Numbers of the USB tables, some of which everybody knows, without doubles."""
    known = {"a": 4, "z": 29, "1": 30, "0": 39, "return": 40, "space": 44, "f1": 58, "f12": 69}
    known |= {"arrow_right": 79, "arrow_up": 82, "keypad_0": 98, "left_ctrl": 224, "right_gui": 231}
    for name, number in known.items():
        assert SCANCODES[name] == number
        assert KEY_NAMES[number] == name
    assert len(set(SCANCODES.values())) == len(SCANCODES)
    assert BUTTON_NAMES[1] == "mouse_left"
    assert len(INPUTS) == len(SCANCODES) + len(BUTTON_NAMES)
    for inputs in BINDINGS.values():
        assert set(inputs) <= INPUTS
    every = [name for inputs in BINDINGS.values() for name in inputs]
    assert len(every) == len(set(every)), "no key has two actions"


def test_scripted_input_is_taken_once():
    source = ScriptedInput()
    source.send(Press("a"), Release("a"))
    source.send(Quit())
    assert source.poll() == [Press("a"), Release("a"), Quit()]
    assert source.poll() == []
