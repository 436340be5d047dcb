"""Particles: how they come, move, age and go, and which of them a picture holds."""

from __future__ import annotations

import gc
import math
import weakref
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osgode.errors import FieldError, TreeError
from osgode.graph.cull import CullVisitor
from osgode.graph.frame import Sprites, View
from osgode.graph.leaf import Switch
from osgode.graph.lod import LevelOfDetail
from osgode.graph.node import Group, Node
from osgode.graph.particles import Particles
from osgode.graph.spray import DUST, FIRE, SMOKE, SPARKS, Spray
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform, matrix_to_root
from osgode.graph.visitors import UpdateVisitor
from osgode.maths import Pose, Quat, Vec3, look_at
from tests.graph.graphs import at

SIZE = (100, 100)
STILL = Spray(velocity=Vec3(0, 0, 0), spread=0.0, jitter=0.0, lifetime=100.0, size=(0.1, 0.1))
"""Particles that stay where they came out."""


def seen(root: Node, view: View = View(Pose(Vec3(0, 0, 30)))) -> list[Sprites]:  # noqa: B008
    return CullVisitor(root).cull(view, SIZE).particles


# -- motion


@given(
    st.floats(0, 3).map(lambda x: round(x, 2)),
    st.floats(0.05, 3),
    st.tuples(*[st.floats(-5, 5).map(lambda x: round(x, 2))] * 3),
)
def test_motion_is_that_of_the_equation(drag: float, time: float, wind: tuple[float, float, float]) -> None:
    """Against many small steps of ``v' = gravity - drag * (v - wind)``."""
    spray = Spray(velocity=Vec3(1, 4, 2), spread=0, jitter=0, lifetime=50, gravity=Vec3(0, -9, 1), drag=drag, wind=wind)  # type: ignore[arg-type]
    particles = Particles(spray).burst(1)
    particles.advance(time)
    place, velocity, steps = np.zeros(3), np.array([1.0, 4.0, 2.0]), 2000
    for _ in range(steps):  # midpoints: wrong by the square of the step only
        middle = velocity + (np.array([0, -9.0, 1]) - drag * (velocity - wind)) * (time / steps / 2)
        place += middle * (time / steps)
        velocity = velocity + (np.array([0, -9.0, 1]) - drag * (middle - wind)) * (time / steps)
    assert particles.positions[0] == pytest.approx(place, abs=1e-3)


@given(st.lists(st.floats(0.01, 0.7), min_size=1, max_size=12), st.integers(0, 5))
def test_how_time_is_cut_does_not_matter(pieces: list[float], seed: int) -> None:
    """One long advance and many short ones give the same particles at the same places."""
    one, many = (Particles(SMOKE, rate=40, seed=seed) for _ in range(2))
    one.advance(sum(pieces))
    for piece in pieces:
        many.advance(piece)
    assert abs(len(one) - len(many)) <= 1  # the last may come just before or after the end by rounding
    count = min(len(one), len(many))
    assert np.allclose(one.positions[:count], many.positions[:count], atol=1e-6)


def test_the_seed_decides() -> None:
    a, b, c = (Particles(SPARKS, rate=200, seed=seed) for seed in (1, 1, 2))
    for each in (a, b, c):
        each.advance(0.3)
    assert (a.positions == b.positions).all()
    assert not np.allclose(a.positions, c.positions)


def test_the_rate_is_kept() -> None:
    """However seldom or often one comes; when it rises, no more come at once."""
    particles = Particles(STILL, rate=2.5)
    for _ in range(100):
        particles.advance(0.1)
    assert len(particles) == 25
    particles.rate = 10.0
    particles.advance(1.0)
    assert len(particles) == 35
    particles.rate = 0.0
    particles.advance(5.0)
    assert len(particles) == 35


def test_lifetimes_end() -> None:
    """Within the jitter about the lifetime all go, and none before."""
    particles = Particles(SMOKE, lifetime=1.0, jitter=0.25).burst(400)
    particles.advance(0.74)
    assert len(particles) == 400
    particles.advance(0.26)
    assert 100 < len(particles) < 300
    particles.advance(0.26)
    assert len(particles) == 0
    assert particles  # a node, though it is empty


def test_the_oldest_make_room() -> None:
    """Also when a single advance brings more than there is room for."""
    root = at(0)
    particles = root.attach(Particles(STILL, capacity=10))
    for x in range(4):
        root.position = (x, 0, 0)
        particles.burst(4)
    assert particles.positions[:, 0].tolist() == [1, 1, 2, 2, 2, 2, 3, 3, 3, 3]
    particles.rate = 1000.0
    particles.advance(60.0)
    assert len(particles) == 10


def test_directions_stay_in_their_cone() -> None:
    """About the velocity as the emitter stands, evenly; speeds within the jitter."""
    root = PositionAttitudeTransform(rotation=Quat.from_axis_angle((0, 0, 1), -math.pi / 2))  # +Y becomes +X
    spray = replace_spray(STILL, velocity=(0, 2, 0), spread=0.5, jitter=0.1)
    particles = root.attach(Particles(spray)).burst(500)
    particles.advance(1.0)
    ways = particles.positions
    speeds = np.linalg.norm(ways, axis=1)
    assert 1.8 <= speeds.min() < 1.82
    assert 2.18 < speeds.max() <= 2.2
    angles = np.arccos(ways[:, 0] / speeds)
    assert 0.49 < angles.max() <= 0.5 + 1e-9
    assert np.cos(angles).mean() == pytest.approx((1 + math.cos(0.5)) / 2, abs=0.005)
    assert np.abs(ways[:, 1:].mean(axis=0)).max() < 0.06


def replace_spray(spray: Spray, **changes: Any) -> Spray:
    return Particles(spray, **changes).spray


def test_they_appear_within_the_radius() -> None:
    """Evenly in a ball: half of them within the cube root of a half."""
    places = np.linalg.norm(Particles(STILL, radius=3.0).burst(1000).positions, axis=1)
    assert places.max() <= 3.0
    assert np.median(places) == pytest.approx(3.0 * 0.5 ** (1 / 3), abs=0.08)


# -- where they come from


def test_they_stay_where_they_came_out() -> None:
    """The emitter moves on, its particles don't; a fast one leaves no gaps."""
    root = Group()
    carrier = root.attach(at(0))
    particles = carrier.attach(at(0, 1)).attach(Particles(STILL, rate=10))
    particles.advance(1.0)
    assert particles.positions == pytest.approx(np.tile([0.0, 1.0, 0.0], (10, 1)))
    carrier.position = (20, 0, 0)
    particles.advance(1.0)
    assert particles.positions[10:, 0] == pytest.approx(np.arange(2.0, 21.0, 2.0))
    assert particles.positions[10:, 1] == pytest.approx(1.0)


def test_they_take_a_share_of_the_motion_along() -> None:
    carrier = at(0)
    particles = carrier.attach(Particles(STILL, inherit=0.5, rate=0.0))
    particles.advance(1.0)
    carrier.position = (4, 0, 0)
    particles.rate = 1.0
    particles.advance(1.0)  # one comes out at the end, at x = 4, with 2 m/s
    particles.rate = 0.0
    particles.advance(3.0)
    assert particles.positions == pytest.approx(np.array([[10.0, 0, 0]]))


def test_matrix_to_root() -> None:
    """The product along the first parents, from the nearest absolute transform on."""
    root = at(100)
    inner = root.attach(at(10)).attach(PositionAttitudeTransform(scale=2))
    node = inner.attach(at(1)).attach(Node())
    assert matrix_to_root(node) @ (0, 0, 0, 1) == pytest.approx((112, 0, 0, 1))
    assert matrix_to_root(inner) @ (1, 0, 0, 1) == pytest.approx((112, 0, 0, 1))
    absolute = inner.attach(MatrixTransform(at(5).local_matrix(), absolute=True))
    assert matrix_to_root(absolute.attach(Node())) @ (0, 0, 0, 1) == pytest.approx((5, 0, 0, 1))


def test_a_clock_moves_them_on() -> None:
    """By as much as it has gone since the last update; backwards nothing happens."""
    root, now = Group(), [5.0]
    particles = root.attach(Particles(STILL, rate=10))
    callback = particles.follow(lambda: now[0])
    update = UpdateVisitor(root)
    update.update()
    assert len(particles) == 0
    now[0] = 5.5
    update.update()
    assert len(particles) == 5
    now[0] = 2.0
    update.update()
    assert len(particles) == 5
    now[0] = 2.375
    update.update()
    assert len(particles) == 8
    particles.remove_on_update(callback)
    now[0] = 9.0
    update.update()
    assert len(particles) == 8


def test_an_emitter_has_one_parent() -> None:
    one, other = Group(), Group()
    particles = one.attach(Particles())
    with pytest.raises(TreeError, match="one parent only"):
        other.attach(particles)


def test_a_copy_begins_anew() -> None:
    """The same settings and the same clock, none of the particles."""
    now = [0.0]
    first = Particles(SPARKS, rate=30, capacity=77, seed=5, name="fuse", drag=0.9).burst(9)
    first.follow(lambda: now[0])
    twin = first.copy()
    assert (twin.spray, twin.rate, twin.capacity, twin.name) == (first.spray, 30, 77, "fuse")
    assert (len(first), len(twin)) == (9, 0)
    other = Particles(SPARKS, seed=5, drag=0.9).burst(9)
    assert (other.positions == first.positions).all()
    now[0] = 0.25
    UpdateVisitor(twin).update()
    assert len(twin) == 7
    assert len(first) == 9


def test_below_what_is_shared_they_are_drawn_once() -> None:
    """On the first way that isn't hidden."""
    root = Group()
    mount = at(0, 1)
    for x in (0, 5):
        root.attach(at(x)).attach(mount)
    mount.attach(Particles(STILL)).burst(3)
    assert [len(shown.rows) for shown in seen(root)] == [3]
    root.children[0].visible = False
    assert [len(shown.rows) for shown in seen(root)] == [3]
    root.children[1].visible = False
    assert seen(root) == []


# -- in the picture


def test_rows_of_a_frame() -> None:
    """Place, radius and colour by age, the way along which it is drawn out."""
    spray = Spray(
        velocity=Vec3(0, 2, 0),
        spread=0,
        jitter=0,
        lifetime=4.0,
        size=(1.0, 3.0),
        colours=((1, 0, 0, 1), (0, 1, 0, 0.5), (0, 0, 1, 0)),
        streak=0.25,
        additive=True,
    )
    particles = Particles(spray).burst(2)
    particles.advance(1.0)
    (shown,) = seen(particles)
    assert shown.additive
    assert shown.rows.dtype == np.float32
    assert shown.rows == pytest.approx(np.tile([0, 2, 0, 1.5, 0.5, 0.5, 0, 0.75, 0, 0.5, 0, 0], (2, 1)))


def test_only_what_is_in_the_picture() -> None:
    """By the radius of each; an emitter of which nothing is seen isn't there at all."""
    root = at(0)
    particles = root.attach(Particles(STILL, size=(1, 1)))
    for x in (-60.0, 0.0, 5.0):
        root.position = (x, 0, 0)
        particles.burst(1)
    view = View(Pose(Vec3(0, 0, 10)), field_of_view=math.pi / 2)
    (shown,) = seen(root, view)
    assert sorted(shown.rows[:, 0].tolist()) == [0, 5]
    assert seen(root, View(look_at((0, 0, 10), (0, 0, 20)))) == []
    particles.clear()
    assert seen(root, view) == []


@pytest.mark.parametrize("additive", [False, True])
def test_those_that_hide_come_far_to_near(additive: bool) -> None:
    """What shines adds up in any order and stays as it is."""
    root = at(0)
    particles = root.attach(Particles(STILL, additive=additive))
    order = [3.0, -5.0, 8.0, 0.0]
    for z in order:
        root.position = (0, 0, z)
        particles.burst(1)
    (shown,) = seen(root)
    assert shown.rows[:, 2].tolist() == (order if additive else sorted(order))


def test_emitters_come_far_to_near() -> None:
    root = Group()
    for z in (0.0, -9.0, 9.0):
        root.attach(at(0, 0, z)).attach(Particles(STILL)).burst(1)
    assert [float(shown.rows[0, 2]) for shown in seen(root)] == [-9, 0, 9]


def test_hidden_ones_move_on_unseen() -> None:
    """By `visible`, a switch or a level of detail; without a walk when only the particles have moved."""
    root = Group()
    lod = root.attach(LevelOfDetail(centre=(0, 0, 0)))
    switch = lod.attach(Switch(), far=50)
    particles = switch.attach(Particles(STILL, rate=1)).burst(1)
    revision = root._revision
    particles.advance(3.0)
    assert root._revision == revision
    assert len(seen(root)[0].rows) == 4
    assert seen(root, View(Pose(Vec3(0, 0, 60)))) == []
    for hide in ("on", "visible"):
        setattr(switch, hide, False)
        assert seen(root) == []
        setattr(switch, hide, True)
    particles.visible = False
    assert seen(root) == []


def test_frames_keep_their_particles() -> None:
    particles = Particles(STILL, velocity=(0, 1, 0)).burst(1)
    (shown,) = seen(particles)
    particles.advance(1.0)
    assert shown.rows[0, 1] == 0


def test_emitters_that_left_are_not_kept() -> None:
    root = Group()
    particles = root.attach(Particles(STILL)).burst(1)
    visitor = CullVisitor(root)
    assert visitor.cull(View(Pose(Vec3(0, 0, 30))), SIZE).particles
    root.detach(particles)
    gone = weakref.ref(particles)
    del particles
    gc.collect()
    assert gone() is None
    assert visitor.cull(View(Pose(Vec3(0, 0, 30))), SIZE).particles == []


# -- what is refused

NAN = float("nan")


@pytest.mark.parametrize(
    ("field", "wrong"),
    [
        *[("velocity", value) for value in ((1, 2), (1, 2, NAN), 3, None)],
        *[("spread", value) for value in (-0.1, 3.2, NAN, "wide")],
        *[("lifetime", value) for value in (0, -1, NAN, math.inf)],
        *[("jitter", value) for value in (-0.1, 1.1)],
        *[("drag", value) for value in (-1, NAN)],
        *[("size", value) for value in (1, (1,), (-1, 2), (1, math.inf))],
        *[("colours", value) for value in ((), ((1, 1, 1),), ((1, 1, 1, 1.5),), ((1, 1, NAN, 1),))],
        *[(name, -1) for name in ("radius", "inherit", "streak")],
    ],
)
def test_wrong_sprays_are_refused(field: str, wrong: object) -> None:
    """In the line that gives them, naming the field and what would be right."""
    with pytest.raises(FieldError, match=rf"Spray\.{field} is .*(must be)"):
        Spray(**{field: wrong})  # type: ignore[arg-type]
    with pytest.raises(FieldError, match=field):
        Particles(SMOKE, **{field: wrong})


def test_wrong_calls_are_refused() -> None:
    """They name the node and change nothing."""
    particles = Particles(STILL, name="chimney", rate=5).burst(3)
    for wrong in (-1, NAN, math.inf, None):
        with pytest.raises(FieldError, match=r"Particles 'chimney'\.advance\(\) is"):
            particles.advance(wrong)  # type: ignore[arg-type]
        with pytest.raises(FieldError, match=r"Particles 'chimney'\.rate is"):
            particles.rate = wrong  # type: ignore[assignment]
    with pytest.raises(FieldError, match=r"burst\(\) of -2"):
        particles.burst(-2)
    with pytest.raises(FieldError, match="capacity"):
        Particles(capacity=0)
    assert (len(particles), particles.rate) == (3, 5)


@pytest.mark.parametrize("spray", [SMOKE, FIRE, SPARKS, DUST])
def test_what_is_ready_made_ends(spray: Spray) -> None:
    """It fades out: nothing vanishes that is still seen."""
    assert spray.colours[-1][3] == 0
    particles = Particles(spray, rate=100, capacity=1000)
    particles.advance(2 * spray.lifetime)
    assert 0.5 * 100 * spray.lifetime < len(particles) < 1.5 * 100 * spray.lifetime
