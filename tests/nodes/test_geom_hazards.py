"""Whatever makes ODE end the process, write into foreign memory or go wrong in silence is a clear error here.

Each row is a misuse of a geom or space, the error, and words of the message; the World is stepped afterwards.
"""

import math

import numpy as np
import pytest

import osgode as oo
from tests.strategies import CUBE

NAN, INF = math.nan, math.inf
FLAT = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
BAD_LENGTHS = (0, -1, NAN, INF, 1e-320, 1e9)


def sizes():
    """Dimensions: the name of a row, what is done, the error, and what must be in the message."""
    sized = {"Sphere": "radius", "Capsule": "radius", "Cylinder": "length", "Ray": "length"}
    for name, field in sized.items():
        for bad in BAD_LENGTHS:
            yield f"{name} {bad}", _made(name, **{field: bad}), oo.FieldError, rf"{name} 'it'\.{field} is "
            yield f"live {name} {bad}", _set(name, field, bad), oo.FieldError, rf"{name} 'it'\.{field} is "
    for bad in BAD_LENGTHS:
        yield f"box {bad}", _made("Box", size=(1, bad, 1)), oo.FieldError, r"Box 'it'\.size is .*three lengths"
        yield f"field {bad}", _field(size=(1, bad)), oo.FieldError, r"Heightfield 'it'\.size is .*two lengths"
        yield f"live field {bad}", _set("Heightfield", "size", (bad, 1)), oo.FieldError, r"\.size is .*two lengths"
    for bad in (-1, NAN, INF, 1e9):
        yield f"thickness {bad}", _set("Heightfield", "thickness", bad), oo.FieldError, r"\.thickness is "
    for bad in ((0, 0, 0), (NAN, 0, 1), (0, INF, 0), (1e-320, 0, 0)):
        yield f"plane {bad}", _made("Plane", normal=bad), oo.FieldError, r"Plane 'it'\.normal is .*direction"
        yield f"live plane {bad}", _set("Plane", "normal", bad), oo.FieldError, r"Plane 'it'\.normal is .*direction"
    for bad in (NAN, INF, 1e9):
        yield f"plane offset {bad}", _set("Plane", "offset", bad), oo.FieldError, r"Plane 'it'\.offset is "


def shapes():
    """Meshes, hulls, heightfields."""
    mesh_errors = {
        "empty": (([], []), "must be"),
        "no triangles": ((CUBE[0], np.zeros((0, 3), int)), "no triangle"),
        "index too high": ((CUBE[0], [(0, 1, 8)]), "triangles refer to vertices 0 to 8 of 8"),
        "index below 0": ((CUBE[0], [(0, 1, -1)]), "triangles refer to vertices -1"),
        "nan": (([*CUBE[0][:7], (NAN, 0, 0)], CUBE[1]), "not finite"),
        "no area": (([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), "no triangle with an area"),
        "shape": ((CUBE[0], [(0, 1)]), r"\(m, 3\)"),
        "far": (([*CUBE[0][:7], (1e9, 0, 0)], CUBE[1]), "farther than"),
    }
    for name, (source, words) in mesh_errors.items():
        for cls in (oo.Trimesh, oo.ConvexHull):
            yield f"{cls.__name__} {name}", _call(cls, source, name="it"), oo.ModelError, words
    for name, points in {
        "flat": FLAT,
        "three": FLAT[:3],
        "same": [(1, 1, 1)] * 6,
        "nan": [*FLAT, (0, 0, NAN)],
        "pairs": [(0, 0)] * 5,
    }.items():
        yield f"hull {name}", _call(oo.ConvexHull, points, name="it"), oo.ModelError, "ConvexHull 'it'"
    clockwise, open_ = [t[::-1] for t in CUBE[1]], CUBE[1][1:]
    for name, triangles in (("clockwise", clockwise), ("open", open_)):
        data = oo.MeshData(CUBE[0], triangles)
        yield (
            f"hull data {name}",
            _hull_data(data),
            oo.FieldError,
            r"ConvexHull 'it'\.data is .*closed, convex, and counter",
        )
    for name, heights in {
        "row": [[1, 2, 3]],
        "column": [[1], [2]],
        "flat list": [1, 2, 3],
        "ragged": [[1, 2], [3]],
        "nan": [[0, 1], [NAN, 0]],
        "inf": [[0, 1], [INF, 0]],
        "high": [[0, 1], [1e9, 0]],
        "words": [["a", "b"], ["c", "d"]],
        "complex": [[0, 1j], [0, 0]],
        "too many": np.zeros((2, 8193)),
    }.items():
        yield f"heights {name}", _call(oo.Heightfield, heights, (1, 1), name="it"), oo.ModelError, "HeightData 'it'"


def places():
    """Poses, offsets, spaces, the tree."""
    for bad in ((0, 0, 0, 0), (NAN, 0, 0, 1), (1e-170, 0, 0, 0), (1e200, 0, 0, 0)):
        yield f"turn {bad}", _place(rotation=bad), oo.FieldError, r"Placeable 'it'\.rotation is "
    for bad in ((NAN, 0, 0), (0, INF, 0), (1e9, 0, 0)):
        yield f"put {bad}", _place(position=bad), oo.FieldError, r"Placeable 'it'\.position is "
    yield "plane in a body", _below_body(oo.Plane(name="it")), oo.TreeError, "Plane 'it' can't be attached"
    yield "geom without a place", _in_body(oo.Sphere(name="it")), oo.TreeError, "Sphere 'it' can't be attached to Body"
    yield "geom in two spaces", _twice, oo.TreeError, "Sphere 'it'"
    yield "detached elsewhere", _wrong_parent, oo.TreeError, "Sphere.*'it'.*detached"
    yield "space in itself", _space_in_itself, oo.TreeError, "HashSpace 'it'"
    yield "spaces too deep", _too_deep, oo.TreeError, "nested 101 deep; at most 100"
    yield "field with mass in a body", _below_body(_new("Heightfield")), oo.FieldError, "no volume; mass=0"
    for bad in ((3, 1), (-31, 3), (0, 31), (NAN, 3)):
        yield f"levels {bad}", _call(oo.HashSpace, name="it", levels=bad), oo.FieldError, r"HashSpace 'it'\.levels is "
    for bad in (-1, 16, 2.5):
        yield f"depth {bad}", _call(oo.QuadTreeSpace, name="it", depth=bad), oo.FieldError, r"'it'\.depth is "
    for bad in ((-1, 1, 1), (NAN, 1, 1), (INF, 1, 1), (0, 1, 1)):
        yield f"extent {bad}", _call(oo.QuadTreeSpace, name="it", extent=bad), oo.FieldError, r"'it'\.extent is "
    for bad in ("xxy", "xyw", 3):
        yield f"axes {bad}", _call(oo.SweepAndPruneSpace, name="it", axes=bad), oo.FieldError, r"'it'\.axes is "
    for bad in (0, -1, 65536, 1e9):
        yield f"contacts {bad}", _contacts(bad), oo.FieldError, r"World 'it'\.contacts_per_pair is "


def _new(name):
    if name == "Heightfield":
        return oo.Heightfield([[0, 1], [1, 0]], name="it")
    return getattr(oo, name)(name="it")


def _call(function, *args, **kwargs):
    return lambda world, space: function(*args, **kwargs)


def _made(name, **fields):
    return _call(getattr(oo, name), name="it", **fields)


def _field(**fields):
    return _call(oo.Heightfield, [[0, 1], [1, 0]], name="it", **fields)


def _set(name, field, value):
    def run(world, space):
        node = _new(name)
        (space if name == "Plane" else space.attach(oo.Placeable())).attach(node)
        before = getattr(node, field), node.bounds
        try:
            setattr(node, field, value)
        finally:
            assert (getattr(node, field), node.bounds) == before

    return run


def _hull_data(data):
    return lambda world, space: setattr(oo.ConvexHull(CUBE, name="it"), "data", data)


def _place(**fields):
    def run(world, space):
        place = space.attach(oo.Body()).attach(oo.Placeable(name="it"))
        place.attach(oo.Box())
        for name, value in fields.items():
            setattr(place, name, value)

    return run


def _below_body(geom):
    return lambda world, space: space.attach(oo.Body()).attach(oo.Placeable()).attach(geom)


def _in_body(geom):
    return lambda world, space: space.attach(oo.Body()).attach(geom)


def _twice(world, space):
    geom = space.attach(oo.Sphere(name="it"))
    world.attach(oo.SimpleSpace()).attach(geom)


def _wrong_parent(world, space):
    geom = space.attach(oo.Sphere(name="it"))
    world.attach(oo.SimpleSpace()).detach(geom)


def _space_in_itself(world, space):
    it = space.attach(oo.HashSpace(name="it"))
    it.attach(it)


def _too_deep(world, space):
    for _ in range(101):
        space = space.attach(oo.SimpleSpace())


def _contacts(value):
    def run(world, space):
        world.name = "it"
        world.contacts_per_pair = value

    return run


ROWS = [*sizes(), *shapes(), *places()]


@pytest.mark.parametrize(("misuse", "error", "words"), [row[1:] for row in ROWS], ids=[row[0] for row in ROWS])
def test_a_misuse_of_geoms_is_a_clear_error(misuse, error, words):
    world = oo.World()
    space = world.attach(oo.HashSpace())
    world.collide(space)
    body = space.attach(oo.Body(position=(0, 3, 0)))
    body.attach(oo.Placeable()).attach(oo.Box())
    with pytest.raises(error, match=words):
        misuse(world, space)
    world.step(3)
    assert body.linear_velocity.y < 0


def test_no_geom_is_lost_to_the_hazards_of_collide():
    """Every pair of shapes, concentric and apart, with one contact and with many: no assert, no NaN."""
    makes = [
        *(oo.Box, oo.Sphere, oo.Capsule, oo.Cylinder, oo.Ray),
        lambda: oo.Trimesh(CUBE),
        lambda: oo.ConvexHull(CUBE),
        lambda: oo.ConvexHull(CUBE, solid=True),
        lambda: oo.Heightfield(np.random.default_rng(3).random((6, 6)), (2, 2), mass=0),
    ]
    for contacts in (1, 3, 100):
        for first in makes:
            for second in makes:
                for offset in ((0, 0, 0), (0.1, 0.4, 0.2), (0.9, 0.1, 0.0)):
                    world = oo.World(gravity=(0, 0, 0), contacts_per_pair=contacts)
                    space = world.attach(oo.SimpleSpace())
                    world.collide(space)
                    for make, position in ((first, (0, 0, 0)), (second, offset)):
                        space.attach(oo.Body(position=position)).attach(oo.Placeable()).attach(make())
                    world.step(2)
                    assert len(world.contacts) <= contacts
                    assert np.isfinite(world.poses).all()
