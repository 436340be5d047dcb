"""The real window, on a screen in memory: what a person does at keyboard, mouse and window arrives, and is seen."""

import subprocess
import sys

import numpy as np
import pytest

from tests.desktop import SIZE as SCREEN
from tests.desktop import stop, until
from tests.engine.player import MARK, SIZE, TITLE, Player

pytest.importorskip("pygame")
pytest.importorskip("moderngl")

OTHER = """
import pygame
pygame.display.set_mode((150, 100))
while (kind := pygame.event.wait().type) != pygame.QUIT:
    if kind == pygame.WINDOWFOCUSGAINED:
        print("focused", flush=True)
"""


@pytest.fixture
def other(desktop):
    """Another program's window, which has taken the keyboard."""
    environment = desktop.environment | {"PYGAME_HIDE_SUPPORT_PROMPT": "1"}
    command = [sys.executable, "-c", OTHER]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "focused\n"
            (number,) = until(lambda: desktop.windows(process), "the other window is there")
            yield number
        finally:
            stop(process)


def test_keys_go_down_and_come_up(desktop, game):
    """By the key's own name and by what the game calls it."""
    desktop.xdotool("keydown", "w", "keydown", "Shift_L")
    game.until("events.held('forward') and events.held('descend')")
    assert game.ask("[events.held('w'), events.held('left_shift'), events.held('a')]") == [True, True, False]
    assert game.ask("events.axis('backward', 'forward')") == 1.0
    desktop.xdotool("keyup", "w")
    game.until("not events.held('forward')")
    assert game.ask("events.held('descend')")
    desktop.xdotool("keyup", "Shift_L")
    game.until("not events.held('descend')")
    keys = [event for event in game.seen if event[0] in {"Press", "Release"}]
    assert [key for n, key in enumerate(keys) if key not in keys[:n]] == [  # a key that is held repeats
        ("Press", "w"),
        ("Press", "left_shift"),
        ("Release", "w"),
        ("Release", "left_shift"),
    ]


def test_keys_that_move_the_camera(desktop, game):
    """From the key to the camera's place: it flies while the key is held, and stops."""
    begin = game.ask("camera.position")
    desktop.xdotool("keydown", "d")
    game.until(f"camera.position[0] > {begin[0]} + 1.0")
    desktop.xdotool("keyup", "d")
    game.until("not events.held('right')")
    frames = game.ask("clock.frames")
    game.until(f"clock.frames > {frames} + 1")
    stood = game.ask("camera.position")
    game.until(f"clock.frames > {frames} + 4")
    assert game.ask("camera.position") == stood


def test_keys_are_known_by_their_place(desktop):
    """On a French keyboard Z is printed where W is on others: it is the same key."""
    desktop.set_layout("fr")
    try:
        with Player(desktop) as game:
            game.ready()
            desktop.xdotool("keydown", "z", "keydown", "q")
            game.until("events.held('w') and events.held('forward') and events.held('a')")
            desktop.xdotool("keyup", "z", "keyup", "q")
            game.until("not events.held('w') and not events.held('a')")
    finally:
        desktop.set_layout("us")


def test_script_plays_in_the_window(desktop, game):
    """Beside the person at the keyboard."""
    game.do("from osgode.engine import Press; events.source.beside.send(Press('w'))")
    desktop.xdotool("keydown", "a")
    game.until("events.held('forward') and events.held('left')")
    desktop.xdotool("keyup", "a")


def test_mouse_buttons_are_held(desktop, game):
    desktop.xdotool("mousemove", "--window", game.number, 100, 100)
    numbers = {1: "left", 2: "middle", 3: "right", 8: "4", 9: "5"}  # as X counts them
    for button, name in numbers.items():
        desktop.xdotool("mousedown", button)
        game.until(f"events.held('mouse_{name}')")
    assert game.ask(f"[events.held('mouse_' + name) for name in {list(numbers.values())}]") == [True] * 5
    for button, name in numbers.items():
        desktop.xdotool("mouseup", button)
        game.until(f"not events.held('mouse_{name}')")


def test_wheel_turns(desktop, game):
    """Away from the user is up; that it turns is no button."""
    desktop.xdotool("mousemove", "--window", game.number, 100, 100)
    desktop.xdotool("click", "--repeat", 3, 4, "click", 5, "click", "--repeat", 2, 6, "click", 1)
    game.until("events.released('mouse_left') or not events.held('mouse_left')")
    until(lambda: game.ask("None") or ("Release", "mouse_left") in game.seen, "the click has arrived")
    turns = [event for event in game.seen if event[0] in {"Wheel", "Press"}]
    assert turns == [("Wheel", 1), ("Wheel", 1), ("Wheel", 1), ("Wheel", -1), ("Press", "mouse_left")]


def test_free_pointer_tells_where_it_is(desktop, game):
    """And turns no camera."""
    desktop.xdotool("mousemove", "--window", game.number, 123, 45)
    game.until("events.mouse_position == (123, 45)")
    desktop.xdotool("mousemove", "--window", game.number, 600, 399)
    game.until("events.mouse_position == (600, 399)")
    assert game.ask("scene.looked") == [0, 0]
    assert desktop.pointer() == tuple(np.add(game.origin, (600, 399)))


def test_free_pointer_in_the_units_of_the_overlay(desktop, game):
    """A corner of the square in the middle, found with the pointer: 360 units down, less half of the square's edge."""
    desktop.xdotool("windowsize", game.number, 500, 360)
    game.until("window.size == (500, 360)")
    corner = (250 - MARK // 4, 180 - MARK // 4)  # 2 units a pixel
    desktop.xdotool("mousemove", "--window", game.number, *corner)
    game.until(f"events.mouse_position == {corner}")
    assert game.ask("scene.hud.from_pixels(events.mouse_position, video.size)") == [500 - MARK / 2, 360 - MARK / 2]
    until(lambda: mark(game.picture()) == (MARK // 2, MARK // 2), "the square is drawn anew")
    assert np.argwhere(game.picture()[:, :, 1] == 0).min(axis=0).tolist() == [corner[1], corner[0]]


NEAR = [(7, -3), (1, 0), (0, 1), (-250, 40), (-1, -1), (120, 90)]
FAR = [(3000, -2000), (-900, 700)]


@pytest.mark.parametrize(("inside", "raw"), [(False, True), (True, True), (True, False)])
def test_held_pointer_is_exact_to_the_pixel(desktop, inside, raw):
    """From the first motion on, slow or fast, farther than the window and the screen are wide.

    Where a system doesn't tell what the mouse itself did, SDL moves the pointer back to the middle again and again;
    that is exact too, but each motion must fit into the window. Let go, the pointer comes back where it was; in the
    middle if it wasn't in the window.
    """
    desktop.xdotool("mousemove", *((512, 384) if inside else (3, 3)))
    with Player(desktop, capture=True, env={} if raw else {"SDL_MOUSE_RELATIVE_MODE_WARP": "1"}) as game:
        game.ready()
        game.until("pygame.mouse.get_relative_mode()")
        place = game.ask("events.mouse_position")
        moves = NEAR + FAR if raw else NEAR
        total = np.zeros(2)
        for right, down in moves:
            desktop.xdotool("mousemove_relative", "--", right, down)
            total += right, down
            game.until(f"scene.moved == {total.tolist()}")
        if raw:
            rush = [word for _ in range(20) for word in ("mousemove_relative", 30, 20)]
            desktop.xdotool(*rush)
            total += 600, 400
            game.until(f"scene.moved == {total.tolist()}")
        motions = [event[1:3] for event in game.seen if event[0] == "MouseMotion"]
        assert np.sum(motions, axis=0).tolist() == total.tolist()
        pixel = game.ask("events.config.mouse_sensitivity")
        assert game.ask("scene.looked") == pytest.approx(pixel * total)
        assert game.ask("events.mouse_position") == place
        game.do("events.captured = False")
        middle = (SIZE[0] // 2, SIZE[1] // 2)
        game.until(f"events.mouse_position == {(512 - game.origin[0], 384 - game.origin[1]) if inside else middle}")


def test_pointer_is_held_and_let_go_by_a_key(desktop, game):
    """It comes back where it was, and what it does meanwhile and before is no look."""
    desktop.xdotool("mousemove", "--window", game.number, 200, 150)
    game.until("events.mouse_position == (200, 150)")
    where = desktop.pointer()
    for turn in (1, 2):
        desktop.xdotool("key", "Tab")
        game.until("events.captured and pygame.mouse.get_relative_mode()")
        desktop.xdotool("mousemove_relative", "--", 90, -60, "mousemove_relative", 10, 20)
        game.until(f"scene.looked == [{turn} * 100 * 0.0025, {turn} * -40 * 0.0025]")
        desktop.xdotool("key", "Tab")
        game.until("not events.captured and not pygame.mouse.get_relative_mode()")
        until(lambda: desktop.pointer() == where, "the pointer is back")
        assert game.ask("events.mouse_position") == [200, 150]
    desktop.xdotool("mousemove_relative", 50, 50)
    game.until("events.mouse_position == (250, 200)")
    assert game.ask("scene.looked") == [0.5, -0.2]


def test_pointer_let_go_and_held_again_at_once_is_exact(desktop, game):
    """Though SDL moves it in between."""
    desktop.xdotool("mousemove", "--window", game.number, 200, 150)
    game.until("events.mouse_position == (200, 150)")
    game.do("events.captured = True; events.captured = False; events.captured = True")
    desktop.xdotool("mousemove_relative", 20, 40)
    game.until("scene.looked != [0, 0]")
    desktop.xdotool("mousemove_relative", 20, 40)
    game.until("scene.looked == [0.1, 0.2]")


def test_lost_keyboard_lets_everything_go(desktop, game, other):
    """Keys that were held count as released, the pointer is free and turns nothing; and back again."""
    game.until("not events.focused")
    desktop.xdotool("windowactivate", game.number)
    game.until("events.focused")
    game.do("events.captured = True")
    game.until("pygame.mouse.get_relative_mode()")
    desktop.xdotool("keydown", "w", "mousedown", 1)
    game.until("events.held('forward') and events.held('mouse_left')")

    desktop.xdotool("windowactivate", other)
    game.until("not events.focused")
    assert not game.ask("events.held('forward') or events.held('mouse_left') or pygame.mouse.get_relative_mode()")
    assert {("Release", "w"), ("Release", "mouse_left"), ("Focus", False)} <= {*game.seen}
    assert game.ask("events.captured")  # as soon as it can be again
    desktop.xdotool("keyup", "w", "mouseup", 1)
    desktop.xdotool("mousemove", "--window", game.number, 30, 30, "mousemove", "--window", game.number, 60, 80)
    game.until("events.mouse_position == (60, 80)")
    desktop.xdotool("mousemove", 1, 1)
    assert desktop.pointer() == (1, 1)
    assert game.ask("scene.looked") == [0, 0]
    desktop.xdotool("key", "w")

    desktop.xdotool("windowactivate", game.number)
    game.until("events.focused and pygame.mouse.get_relative_mode()")
    assert not game.ask("events.held('forward')")
    desktop.xdotool("mousemove_relative", 20, 40)
    game.until("scene.looked == [0.05, 0.1]")


def close_enough(image, expected):
    """Of the same size and everywhere nearly the same: another driver may place the edges a little elsewhere."""
    if image.shape != expected.shape:
        return False
    far = np.abs(image.astype(int) - expected).max(axis=2)
    return (far > 24).mean() < 0.01 and far.mean() < 1.5


def matches(game, tmp_path, size):
    """Whether the window shows what is drawn without one."""
    image = pytest.importorskip("PIL.Image")
    path = tmp_path / "expected.png"
    game.do(f"scene.draw({str(path)!r}, {tuple(size)!r})")
    with image.open(path) as file:
        expected = np.asarray(file.convert("RGB"))
    until(lambda: close_enough(game.picture(), expected), "the window shows the picture")
    return expected


def mark(image):
    """Width and height of the magenta square, pixels."""
    rows, columns = np.nonzero((image[:, :, 0] > 200) & (image[:, :, 1] < 50) & (image[:, :, 2] > 200))
    return int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1


def test_picture_is_that_which_is_drawn_without_a_window(desktop, game, tmp_path):
    first = matches(game, tmp_path, SIZE)
    assert game.picture().shape == (SIZE[1], SIZE[0], 3)
    game.do("camera.look(0.4, 0.2)")
    second = matches(game, tmp_path, SIZE)
    assert not close_enough(second, first)


@pytest.mark.parametrize("size", [(800, 300), (300, 500), (97, 60)])
def test_window_is_resized(desktop, game, tmp_path, size):
    """The picture gets the new shape and is not stretched: what is square stays so."""
    desktop.xdotool("windowsize", game.number, *size)
    game.until(f"window.size == {size}")
    until(lambda: game.ask("None") or ("Resize", *size) in game.seen, "the game is told")
    matches(game, tmp_path, size)
    edge = size[1] * MARK / 720
    assert mark(game.picture()) == pytest.approx((edge, edge), abs=1.01)
    assert game.ask("video.size") == [*size]


def test_smoothed_window(desktop, tmp_path):
    """With several samples a pixel, which the window itself hasn't got: in each size that it takes."""
    with Player(desktop, samples=4) as game:
        number = game.ready()
        assert game.ask("window.quality.samples") == 4
        rough = matches(game, tmp_path, SIZE)
        for size in ((800, 300), (300, 500)):
            desktop.xdotool("windowsize", number, *size)
            game.until(f"window.size == {size}")
            matches(game, tmp_path, size)
        desktop.xdotool("key", "F11")
        game.until(f"video.full_screen and window.size == {SCREEN}")
        until(lambda: game.origin == (0, 0), "it begins where the screen does")
        matches(game, tmp_path, SCREEN)
        desktop.xdotool("key", "F11")
        game.until("not video.full_screen and window.size == (300, 500)")
        desktop.xdotool("windowminimize", number)
        game.until("window.minimised")
        desktop.xdotool("windowactivate", number)
        game.until("not window.minimised and events.focused")
        desktop.xdotool("windowsize", number, *SIZE)
        game.until(f"window.size == {SIZE}")
        assert np.array_equal(matches(game, tmp_path, SIZE), rough)


def test_quality_is_chosen_by_who_draws(game):
    """A software rasteriser smooths nothing, so that it can be played; a graphics card does."""
    software = game.ask("any(name in window.renderer for name in ('llvmpipe', 'softpipe', 'SwiftShader'))")
    assert game.ask("[window.quality.samples, window.quality.shadow_size]") == ([0, 1024] if software else [4, 2048])


def test_full_screen_and_back(desktop, game, tmp_path):
    """By its key, and by the property."""
    desktop.xdotool("key", "F11")
    game.until(f"video.full_screen and window.size == {SCREEN}")
    until(lambda: game.origin == (0, 0), "it begins where the screen does")
    matches(game, tmp_path, SCREEN)
    desktop.xdotool("key", "F11")
    game.until(f"not video.full_screen and window.size == {SIZE}")
    matches(game, tmp_path, SIZE)
    game.do("video.full_screen = True; video.full_screen = True")
    game.until(f"video.full_screen and window.size == {SCREEN}")
    game.do("video.full_screen = False")
    game.until(f"not video.full_screen and window.size == {SIZE}")
    matches(game, tmp_path, SIZE)


def test_full_screen_from_the_start(desktop, tmp_path):
    with Player(desktop, full_screen=True) as game:
        game.ready()
        game.until(f"video.full_screen and window.size == {SCREEN}")
        matches(game, tmp_path, SCREEN)


def test_minimised_window_goes_on(desktop, game, tmp_path):
    """The game runs on, draws nothing, and is seen again as it has become."""
    game.do("shown = []; flip = pygame.display.flip")
    game.do("pygame.display.flip = lambda: (shown.append(1), flip())")
    game.until("len(shown) > 2")
    desktop.xdotool("windowminimize", game.number)
    game.until("window.minimised and not events.focused")
    frames = game.ask("(clock.frames, len(shown))")
    game.until(f"clock.frames > {frames[0]} + 5")
    assert game.ask("len(shown)") == frames[1]
    game.do("camera.look(0.4, 0.2)")
    desktop.xdotool("windowactivate", game.number)
    game.until("not window.minimised and events.focused")
    matches(game, tmp_path, SIZE)


def test_title_is_shown(desktop, game):
    assert desktop.xdotool("getwindowname", game.number).strip() == TITLE
