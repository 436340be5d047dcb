"""The whole game: its tour, its keys, random play, and the floor of the world."""

import logging
import random

import numpy as np
import pytest

import osgode as oo
from osgode.engine import INPUTS, MouseMotion, Press, Release
from osgode.examples.game import play as game
from osgode.examples.game.explosion import Explosion
from osgode.examples.game.rocket import Rocket
from osgode.examples.game.scene import BINDINGS, DEEPEST, FARTHEST, START, Game, config
from osgode.examples.game.tour import SECONDS, Tour
from osgode.testing import Play


def test_the_tour_shows_everything_and_all_of_it_works():
    with Play(Tour, config()) as play:
        scene = play.scene
        crates = [crate.position for crate in scene.crates]
        widest, airborne, presses = 0.0, 0.0, scene.parts.button.presses
        while not scene.finished:
            play.frames(1)
            widest = max(widest, abs(scene.parts.door.angle))
            airborne = max(airborne, scene.car.hull.position.y)
            assert play.app.clock.elapsed < SECONDS + 20
        assert scene.told[0] == "arrive"
        assert scene.told[-1] == "depart"
        assert len(scene.told) == 10
        assert widest > 0.4  # the door was pushed open
        assert sorted(scene.player.arsenal.weapons) == [1, 2, 3]
        assert scene.parts.button.presses == presses + 1
        moved = [a.distance(crate.position) for a, crate in zip(crates, scene.crates, strict=True) if crate.is_live]
        assert sum(distance > 1 for distance in moved) >= 5  # by balls, cubes, and the rocket
        assert airborne > 1.5  # over the ramp
        assert scene.rival.speed > 5
        assert np.isfinite(scene.world.poses).all()


def test_the_tour_is_the_same_each_time():
    prints = []
    for _ in range(2):
        with Play(Tour, config()) as play:
            play.seconds(12)
            prints.append(play.fingerprint())
    assert prints[0] == prints[1]


def test_somebody_plays_it_by_keys_and_mouse():
    """To the car on foot, in, a drive, out, and back into the first person; windows and weapons by their keys."""
    with Play(Game, config()) as play:
        scene = play.scene
        assert scene.camera.carrier is scene.player
        play.tap("controls_window")
        assert scene.board.controls.visible
        play.tap("hints_window")
        assert scene.board.hints.visible
        assert not scene.board.controls.visible  # one lies over the other
        play.tap("hints_window")
        assert not scene.board.hints.visible
        play.tap("weapon_2")
        assert scene.player.arsenal.in_hand is None  # it has none
        for weapon in scene.weapons:
            scene.player.pick_up(weapon)
        for slot in (1, 2, 3, 1):
            play.tap(f"weapon_{slot}")
            assert scene.player.arsenal.in_hand is scene.weapons[slot - 1]
            assert scene.board.weapon.text == scene.weapons[slot - 1].TITLE
        shots = len(scene.dynamic.children)
        play.hold("fire_left")
        play.seconds(0.5)
        assert scene.board.charge.visible
        play.release("fire_left")
        play.frames(2)
        assert len(scene.dynamic.children) == shots + 1
        place = scene.car.way_out()
        scene.player.place(oo.Pose(place + oo.Vec3(0, scene.player.reach, 0)), at_rest=True)
        play.frames(2)
        play.tap("attach")
        assert scene.camera.carrier is scene.car
        assert not scene.player.in_simulation
        assert not scene.weapons[0].in_simulation
        play.tap("weapon_2")  # there is no hand free
        assert scene.player.arsenal.in_hand is None
        play.hold("forward")
        play.seconds(2)
        assert scene.car.speed > 5
        assert scene.board.speed.text.endswith("km/h")
        assert scene.board.wheels.visible
        play.release("forward")
        play.hold("backward")
        play.until(lambda: scene.car.speed < 1)
        play.release("backward")
        play.tap("attach")
        assert scene.camera.carrier is scene.player
        assert scene.player.arsenal.in_hand is scene.weapons[0]
        play.tap("third_person")
        assert scene.camera.distance > 0
        play.seconds(0.5)
        assert scene.player.on_ground


def test_what_falls_out_of_the_world_is_caught_and_reported(caplog):
    with Play(Game, config()) as play, caplog.at_level(logging.WARNING, "osgode.game"):
        scene = play.scene
        crate, player = scene.crates[0], scene.player
        crate.position = (0, 5, FARTHEST + 10)
        player.place(oo.Pose(oo.Vec3(-FARTHEST - 20, 5, 0)), at_rest=True)
        play.seconds(1.5)
        assert not crate.is_live
        assert "crate 0 has fallen out of the world" in caplog.text
        assert player.feet.distance(START) < 3
        assert player.in_simulation


def test_cars_weapons_and_the_walker_that_are_lost_begin_anew_as_a_whole(caplog):
    """Even while somebody drives the car, and holds a weapon; a rocket is taken away."""
    with Play(Game, config()) as play, caplog.at_level(logging.WARNING, "osgode.game"):
        scene = play.scene
        gun, launcher, flail = scene.weapons
        lost = (scene.car, scene.rival, scene.walker, gun, launcher)
        homes = [thing.pose.position for thing in lost]
        scene.player.pick_up(flail)
        rocket = scene.dynamic.attach(Rocket((0, 40, 0)))
        blast = scene.dynamic.attach(Explosion((0, 5, -FARTHEST - 30)))
        scene.get_in(scene.car)
        for k, thing in enumerate((*lost, rocket)):
            thing.place(oo.Pose(oo.Vec3(FARTHEST + 20 + 10 * k, 5, 0)), at_rest=True)
        play.seconds(1.1)
        for thing, home in zip(lost, homes, strict=True):
            assert thing.main_body.position.distance(home) < 1.0
            assert f"{thing.path} has fallen out of the world" in caplog.text
        assert all(scene.car.on)
        assert not rocket.in_simulation
        assert not blast.in_simulation
        assert scene.camera.carrier is scene.car
        scene.get_out(scene.car)
        assert scene.player.arsenal.in_hand is flail
        scene.player.place(oo.Pose(oo.Vec3(-FARTHEST - 20, 5, 0)), at_rest=True)
        play.seconds(1.1)
        assert scene.player.feet.distance(START) < 1.0
        assert scene.player.arsenal.in_hand is flail
        assert flail.main_body.position.distance(START) < 3.0


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_random_play_breaks_nothing(seed):
    """Keys, buttons and mouse at random, ten minutes in four parts; nothing piles up in ODE."""
    dice = random.Random(seed)
    keys = sorted({*INPUTS, *BINDINGS} - {"escape", "f11", "p", "period", "minus", "equals"} - set(BINDINGS))
    likely = ["w", "a", "s", "d", "space", "e", "1", "2", "3", "v", "r", "mouse_left", "mouse_right"]
    with Play(Game, config()) as play:
        scene = play.scene
        for weapon in scene.weapons:
            scene.player.pick_up(weapon)
        held, natives = set(), []
        for turn in range(150 * 12):
            name = dice.choice(likely if dice.random() < 0.85 else keys)
            if name in held:
                held.discard(name)
                play.send(Release(name))
            else:
                held.add(name)
                play.send(Press(name))
            play.send(MouseMotion(dice.gauss(0, 60), dice.gauss(0, 25)))
            play.frames(5)
            poses = scene.world.poses
            assert np.isfinite(poses).all()
            assert poses[:, 1].min() > 2 * DEEPEST
            if turn % 600 == 599:
                natives.append(oo.live_natives())
        assert all(count.blocks < 1.3 * natives[0].blocks and count.bodies < 250 for count in natives)
        assert scene.world.time > 145
        assert not play.app.quitting


def test_it_runs_from_the_command_line(monkeypatch, tmp_path, capsys):
    """Without a screen the tour is played; with no means to draw it is only simulated."""
    monkeypatch.setattr(game, "has_screen", lambda: False)
    monkeypatch.setattr(game, "is_installed", lambda *_: False)
    game.main(["--seconds", "1"])
    told = capsys.readouterr().out
    assert "120 steps" in told
    assert "pip install" in told


def test_it_films_its_tour(monkeypatch, tmp_path):
    pytest.importorskip("moderngl")
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    try:
        from osgode.render import OffscreenDrawer

        OffscreenDrawer((16, 16)).close()
    except oo.OsgodeError as error:
        pytest.skip(str(error))
    monkeypatch.setattr(game, "SIZE", (160, 90))
    monkeypatch.setattr(game, "EVERY", 0.2)
    video = tmp_path / "out" / "tour.mp4"
    told = game.tour(0.5, video, drawn=True)
    frames, _ = ffmpeg.count_frames_and_secs(str(video))
    assert frames == round(0.5 * game.FPS)
    assert sorted(path.name for path in video.parent.iterdir()) == ["tour-1.png", "tour-2.png", "tour.mp4"]
    assert any("times real time" in line for line in told)
