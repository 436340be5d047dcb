"""Who is warned of that it is too fast, and how many shots pass."""

import importlib.util
import logging
from pathlib import Path

import pytest

import osgode as oo
from tests.nodes.shots import H, ball, scene, shot, wall

spec = importlib.util.spec_from_file_location("table", Path(__file__).parents[2] / "tools" / "tunnelling.py")
table = importlib.util.module_from_spec(spec)
spec.loader.exec_module(table)


# -- the warning


def warnings_of(caplog):
    return [record.getMessage() for record in caplog.records if "may pass through" in record.getMessage()]


def test_a_body_that_is_too_fast_is_warned_of_once_with_its_way_and_size(caplog):
    world, moving, _ = scene()
    ball(moving, (0, 0, 0), (0, 0, 0.25 / H), None)
    with caplog.at_level(logging.WARNING):
        world.step(5)
        world.step(5)
    (text,) = warnings_of(caplog)
    assert "'shot'" in text
    assert "0.25 m" in text
    assert "0.2 m" in text
    assert "tunnelling='sweep'" in text


def test_the_warning_tells_the_speed_it_warns_of_though_a_wall_has_stopped_the_body_since(caplog):
    world, moving, fixed = scene()
    wall(fixed, thick=5.0)
    ball(moving, (0, 0, 1.3), (0, 0, -0.5 / H), None)
    with caplog.at_level(logging.WARNING):
        world.step(30)
    assert "moves 0.5 m" in warnings_of(caplog)[0]


@pytest.mark.parametrize(
    ("times", "fields", "count"),
    [
        (0.99, {"mode": None}, 0),
        (1.01, {"mode": None}, 1),
        (9.0, {"mode": "ray"}, 0),
        (9.0, {"mode": "sweep"}, 0),
        (9.0, {"mode": None, "kinematic": True}, 0),
    ],
)
def test_who_is_warned_of(caplog, times, fields, count):
    """Faster than the thinnest side of the body in a step, unless it is followed, or nothing can stop it anyway."""
    world, moving, _ = scene()
    ball(moving, (0, 0, 0), (0, 0, times * 0.2 / H), **fields)
    with caplog.at_level(logging.WARNING):
        world.step(2)
    assert len(warnings_of(caplog)) == count


def test_sensors_and_bodies_in_no_space_are_not_warned_of_until_they_are_solid(caplog):
    world, moving, _ = scene()
    ball(world, (0, 0, 0), (0, 0, 60), None)
    feeler = shot(moving, oo.Sphere(0.1, mass=1.0, sensor=True), (3, 0, 0), (0, 0, 60), None)
    with caplog.at_level(logging.WARNING):
        world.step(2)
        assert not warnings_of(caplog)
        feeler.geoms[0].sensor = False
        world.step(2)
    assert len(warnings_of(caplog)) == 1


# -- the table


@pytest.mark.parametrize("shape", table.SHAPES)
@pytest.mark.parametrize("times", table.SPEEDS)
def test_no_shot_passes_that_is_swept(shape, times, caplog):
    """The table of docs/tunnelling.md with fewer shots: sweep 0 everywhere, an edge included."""
    caplog.set_level(logging.ERROR)
    for wall_name in (*table.WALLS, "edge"):
        assert table.count("sweep", shape, wall_name, times, 40, seed=1) == 0, wall_name


@pytest.mark.parametrize("shape", table.SHAPES)
def test_the_table_can_fail(shape, caplog):
    """Unfollowed, nearly all pass at 50 times the safe speed; a ray stops them, but none that grazes an edge."""
    caplog.set_level(logging.ERROR)
    assert table.count(None, shape, "1 cm, head on", 50, 20) >= 18
    assert table.count("ray", shape, "1 cm, head on", 50, 20) == 0
    assert table.count("ray", shape, "edge", 50, 20) >= 18
