"""Models made into things that move: what they collide as, weigh, and look like."""

import importlib

import numpy as np
import pytest

import osgode as oo
from osgode.graph.mesh import Mesh
from tests.strategies import CUBE

pytest.importorskip("scipy")
pytest.importorskip("vhacdx")


def ring():
    """A square frame of four bars, closed: outside 2 x 2 m, inside 1 x 1 m, 0.5 m high; 1.5 m3."""
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    vertices = [(s * x, y, s * z) for y in (-0.25, 0.25) for s in (1.0, 0.5) for x, z in corners]
    quads = []
    for i in range(4):
        j = (i + 1) % 4
        low_out, low_in, top_out, top_in = ((k + i, k + j) for k in (0, 4, 8, 12))
        quads += [
            (top_out[0], top_in[0], top_in[1], top_out[1]),
            (low_out[0], low_out[1], low_in[1], low_in[0]),
            (low_out[0], top_out[0], top_out[1], low_out[1]),
            (low_in[0], low_in[1], top_in[1], top_in[0]),
        ]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return np.array(vertices), np.array(triangles)


def model():
    vertices, triangles = ring()
    drawable = oo.Drawable(Mesh(vertices, triangles), oo.Appearance((1, 0, 0, 1)))
    return oo.Model("ring", (drawable,), vertices, triangles)


def body_of(geoms):
    body = oo.Body()
    place = body.attach(oo.Placeable())
    for geom in geoms:
        place.attach(geom)
    return body


def test_the_ring_is_closed_and_has_the_volume_of_its_bars():
    assert oo.Mass.mesh(*ring(), density=1).mass == pytest.approx(1.5)


@pytest.mark.parametrize("policy", ["hull", "decompose", "mesh"])
@pytest.mark.parametrize(
    ("given", "total"), [({"mass": 4.0}, 4.0), ({"density": 10.0}, 15.0), ({"material": "wood"}, 1.5 * 710)]
)
def test_all_together_weigh_what_the_model_weighs(policy, given, total):
    """Though the hull has 2 m3 where the model has 1.5."""
    body = body_of(oo.colliders(model(), policy, **given))
    assert body.mass == pytest.approx(total)
    assert tuple(body.centre_of_mass) == pytest.approx((0, 0, 0), abs=0.02)


def test_the_moment_of_inertia_is_near_that_of_the_model():
    exact = np.array(oo.Mass.mesh(*ring(), mass=6.0).inertia)
    for policy, tolerance in (("mesh", 1e-9), ("decompose", 0.1)):
        body = body_of(oo.colliders(model(), policy, mass=6.0))
        assert np.array(body.inertia) == pytest.approx(exact, rel=tolerance, abs=tolerance * exact.max())


@pytest.mark.parametrize("policy", ["hull", "decompose", "mesh"])
def test_one_of_them_shows_the_model_and_the_others_nothing(policy):
    source = model()
    first, *others = oo.colliders(source, policy)
    assert first.drawables() == source.drawables
    assert all(geom.drawables() == () for geom in others)
    (plain, *_) = oo.colliders(ring(), policy, material="wood")
    assert len(plain.drawables()[0].mesh.triangles) == 32
    assert plain.drawables()[0].appearance == oo.Box(material="wood").drawables()[0].appearance
    green = oo.Appearance((0, 1, 0, 1))
    assert oo.colliders(source, policy, appearance=green)[0].drawables()[0].appearance is green
    own = source.drawables[0]
    assert oo.colliders(ring(), policy, shown=own)[0].drawables() == (own,)


@pytest.mark.parametrize(("policy", "through"), [("hull", False), ("decompose", True), ("mesh", True)])
def test_a_ball_falls_through_the_ring_unless_it_is_filled(policy, through):
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    for geom in oo.colliders(model(), policy):
        space.attach(oo.Placeable()).attach(geom)
    balls = [space.attach(oo.Body(position=at)) for at in ((0, 1, 0), (0.75, 1, 0))]
    for ball in balls:
        ball.attach(oo.Placeable()).attach(oo.Sphere(0.2))
    world.run(0.6)
    assert (balls[0].position.y < -0.5) == through
    assert balls[1].position.y > 0.3


def test_decomposing_covers_the_model_and_is_the_same_every_time():
    parts = oo.colliders(model(), "decompose", name="ring")
    assert 2 <= len(parts) <= 16
    assert [part.name for part in parts] == [f"ring {k}" for k in range(1, len(parts) + 1)]
    assert sum(part.volume for part in parts) == pytest.approx(1.5, rel=0.1)
    again = oo.colliders(model(), "decompose", name="ring")
    for one, other in zip(parts, again, strict=True):
        assert np.array_equal(one.data.vertices, other.data.vertices)
    assert len(oo.colliders(model(), "decompose", most_hulls=2, resolution=2000)) <= 2


def test_fields_are_those_of_the_geoms():
    for policy in ("hull", "decompose"):
        for geom in oo.colliders(model(), policy, solid=True, material="steel", collides_with="default"):
            assert (geom.solid, geom.material, geom.collides_with) == (True, "steel", {"default"})
    with pytest.raises(oo.FieldError, match="only hulls can be solid"):
        oo.colliders(model(), "mesh", solid=True)
    with pytest.raises(TypeError, match="no field 'colour'"):
        oo.colliders(model(), "hull", colour="red")


def test_a_weightless_part_and_a_model_that_is_open():
    assert [geom.mass for geom in oo.colliders(model(), "hull", mass=0)] == [0.0]
    vertices, triangles = CUBE
    (hull,) = oo.colliders((vertices, triangles[1:]), "hull", density=3.0)
    assert hull.mass == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"policy": "best"}, "one of 'hull', 'decompose', 'mesh'"),
        ({"policy": None}, "one of 'hull'"),
        ({"policy": "hull", "mass": 1.0, "density": 2.0}, "give one"),
        ({"policy": "hull", "mass": -1.0}, "mass is -1"),
        ({"policy": "hull", "density": 0.0}, "density is 0"),
        ({"policy": "decompose", "most_hulls": 0}, "most_hulls is 0"),
        ({"policy": "decompose", "resolution": 5}, "resolution is 5"),
    ],
)
def test_wrong_arguments_are_refused(arguments, words):
    with pytest.raises(oo.FieldError, match=words):
        oo.colliders(model(), **arguments)


def test_a_policy_has_to_be_said():
    with pytest.raises(TypeError, match="policy"):
        oo.colliders(model())
    with pytest.raises(oo.ModelError):
        oo.colliders("house.obj", "hull")


def test_without_the_packages_the_extra_is_named(monkeypatch):
    def refuse(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", refuse)
    for policy in ("hull", "decompose"):
        with pytest.raises(oo.MissingExtraError, match=r"osgode\[convex\]"):
            oo.colliders(model(), policy)
    assert len(oo.colliders(CUBE, "hull")) == 1
    assert len(oo.colliders(model(), "mesh")) == 1
