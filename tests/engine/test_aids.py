"""What every scene has for who wants to see what goes on."""

import logging

import osgode as oo
from osgode.engine import AppConfig, Scene, SceneConfig
from osgode.testing import Play


class Yard(Scene):
    def populate_world(self):
        self.static.attach(oo.Plane(material="concrete", name="ground"))
        crate = self.dynamic.attach(oo.Body(name="crate", position=(0, 0.5, -5)))
        crate.attach(oo.Placeable()).attach(oo.Box((1, 1, 1), mass=5, material="wood"))


def test_nothing_is_made_before_it_is_wanted():
    with Play(Yard) as play:
        before = len(list(play.scene.root.walk()))
        play.frames(3)
        assert len(list(play.scene.root.walk())) == before
        assert not play.scene.aids.debugging
        assert not play.scene.aids.inspecting
        assert play.scene.aids.text == ""


def test_one_key_shows_the_physics_then_all_of_it_then_nothing():
    with Play(Yard) as play:
        scene, aids = play.scene, play.scene.aids
        for shown, everything in ((True, False), (True, True), (False, False), (True, False)):
            play.tap("debug")
            assert aids.debugging == shown
            assert aids.debug.boxes == everything
            assert aids.debug.axes == everything
            assert bool(scene.frame((64, 40)).lines) == shown


def test_the_inspector_tells_of_what_is_aimed_at_and_where_time_goes():
    with Play(Yard) as play:
        play.look_at((0, 0.5, -5))
        play.tap("inspect")
        play.seconds(0.5)
        aids = play.scene.aids
        assert aids.inspecting
        assert "crate" in aids.text
        assert "60 frames a second" in aids.text
        assert aids.step.steps == 2  # of the last frame
        assert aids.step.total > 0
        drawn = [item for item in play.scene.frame((1024, 640)).overlay if isinstance(item, oo.Text)]
        assert any("crate" in item.text for item in drawn)
        assert any("listeners" in item.text for item in drawn)
        play.look_at((0, 5, -5))
        play.tap("pause")
        play.seconds(0.5)
        assert "nothing in sight" in aids.text
        assert "paused" in aids.text
        play.tap("inspect")
        assert not [item for item in play.scene.frame((1024, 640)).overlay if isinstance(item, oo.Text)]


def test_simulation_that_is_left_out_is_reported(caplog):
    """A stall of 5 s is told once, and so is each doubling of what is lost; the figures are what the cap leaves out."""
    config = AppConfig(scene=SceneConfig(step_size=1 / 100, max_steps=10))
    with Play(Yard, config) as play, caplog.at_level(logging.WARNING, "osgode"):
        play.frames(2)
        assert not caplog.records
        play.app.clock.timer.advance(5.0)
        play.frames(10)
        (told,) = [record for record in caplog.records if "left out" in record.message]
        assert "4.9 s" in told.message
        assert "max_steps" in told.message
        assert abs(play.scene.lost - 4.9) < 0.05
