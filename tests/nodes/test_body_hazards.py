"""What ODE does with bad masses and bad states of bodies is known: it ends the process, or goes on with NaN.

Each row is one such misuse, on a body in a World and outside of one: a clear error that names the body and what is
wrong, nothing has changed, and the World goes on.
"""

import math

import pytest

import osgode as oo
from osgode.fields import fields_of
from tests.strategies import CUBE
from tests.trees import assert_photos_agree, photo

NAN, INF = math.nan, math.inf
DIAGONAL = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
VECTORS = ((NAN, 0, 0), (0, INF, 0), (0, 0, -INF), (1e160, 0, 0), (1e308, 1e308, 1e308), (1, 2), "abc", None, 7)
PUSHES = (
    "add_force",
    "add_local_force",
    "add_torque",
    "add_local_torque",
    "apply_impulse",
    "apply_local_impulse",
    "apply_angular_impulse",
    "apply_local_angular_impulse",
)
AT = ("add_force", "add_local_force", "apply_impulse", "apply_local_impulse")
OPEN = (CUBE[0], CUBE[1][:-1])
INSIDE_OUT = (CUBE[0], [(a, c, b) for a, b, c in CUBE[1]])


def setting(name, *values):
    return [(f"{name} = {value!r}"[:60], lambda body, value=value: setattr(body, name, value)) for value in values]


def massing(**arguments):
    """A mass for the body that is no mass: already making it is refused."""
    given = {"mass": 1.0, "centre": (0, 0, 0), "inertia": DIAGONAL, **arguments}
    return (str(arguments)[:60], lambda body: setattr(body, "fixed_mass", oo.Mass(**given)))


def with_part(*make):
    def act(body):
        place = oo.Placeable(name="it")
        for each in make:
            place.attach(each())
        body.attach(place)

    return act


def placed(name, value):
    return lambda body: setattr(body.children[0], name, value)


def of_part(name, value):
    return lambda body: setattr(body.children[0].children[0], name, value)


ROWS = {
    "position is not finite or out of bounds": setting("position", *VECTORS, (2e8, 0, 0)),
    "velocity is not finite, or so fast that ODE aborts": [
        *setting("linear_velocity", *VECTORS),
        *setting("angular_velocity", *VECTORS),
        *setting("centre_of_mass_velocity", *VECTORS),
    ],
    "force or torque is not finite": [*setting("force", *VECTORS), *setting("torque", *VECTORS)],
    "a quaternion is zero, not finite, or has no length that can be computed": setting(
        "rotation",
        (0, 0, 0, 0),
        (NAN, 0, 0, 0),
        (0, INF, 0, 0),
        (1e-170, 0, 0, 0),
        (1e200, 0, 0, 0),
        (1, 0, 0),
        None,
        1,
    ),
    "mass is not above 0, too small, or not finite": [
        massing(mass=mass) for mass in (0.0, -1.0, 1e-320, 1e-13, NAN, INF, -INF, 1e300, None)
    ],
    "inertia is not positive definite": [
        massing(inertia=inertia)
        for inertia in (
            ((0, 0, 0), (0, 0, 0), (0, 0, 0)),
            ((1, 0, 0), (0, -1, 0), (0, 0, 1)),
            ((1, 2, 0), (2, 1, 0), (0, 0, 1)),
            ((1e-320, 0, 0), (0, 1e-320, 0), (0, 0, 1e-320)),
        )
    ],
    "inertia is not finite": [
        massing(inertia=((value, 0, 0), (0, value, 0), (0, 0, value))) for value in (NAN, INF, 1e300)
    ],
    "inertia of nothing real": [
        massing(inertia=((1, 0, 0), (0, 1, 0), (0, 0, 3))),
        massing(inertia=((1, 0.1, 0), (0, 1, 0), (0, 0, 1))),
    ],
    "the centre of mass is not finite or too far": [
        massing(centre=centre) for centre in ((NAN, 0, 0), (INF, 0, 0), (1e8, 0, 0), (0, 0), None)
    ],
    "no mass at all": setting("fixed_mass", 5.0, "heavy", (1, 2, 3)),
    "the mass of a part is not above 0 or not finite": [
        (f"{name}={value}", of_part(name, value))
        for name, value in (
            *(("mass", value) for value in (-1.0, NAN, INF, 1e300, "heavy")),
            *(("density", value) for value in (0.0, -1.0, NAN, INF, 1e300)),
        )
    ],
    "a part so small that its inertia is": [
        ("radius 1e-6", with_part(lambda: oo.Sphere(1e-6, mass=1e-3, name="it"))),
        ("box of 1e-6", with_part(lambda: oo.Box((1e-6, 1e-6, 1e-6), density=1.0, name="it"))),
    ],
    "a part so heavy that the sum is out of range": [
        ("two of 1e15", with_part(*[lambda: oo.Sphere(1.0, mass=9e14, name="it")] * 2)),
    ],
    "a mesh that is open or inside out": [
        ("open", with_part(lambda: oo.Trimesh(OPEN, mass=1.0, name="it"))),
        ("inside out", with_part(lambda: oo.Trimesh(INSIDE_OUT, density=1.0, name="it"))),
    ],
    "a part is nowhere": [
        (f"{name}={value}", placed(name, value))
        for name, value in (
            *(("position", value) for value in ((NAN, 0, 0), (INF, 0, 0), (1e8, 0, 0), (1, 2))),
            *(("rotation", value) for value in ((0, 0, 0, 0), (NAN, 0, 0, 1), (1, 0))),
        )
    ],
    "damping above 1 or below 0": [
        *setting("linear_damping", 1.5, -0.1, NAN, INF),
        *setting("angular_damping", 1.5, -0.1, NAN, INF),
        *setting("linear_damping_threshold", -1.0, NAN, INF),
        *setting("angular_damping_threshold", -1.0, NAN, INF),
    ],
    "counts and limits of falling asleep": [
        *setting("auto_disable_samples", 2**32 - 1, 0, -1, 1.5, NAN),
        *setting("auto_disable_steps", -1, 2**32, NAN),
        *setting("auto_disable_time", -1.0, NAN, INF),
        *setting("auto_disable_linear_threshold", -1.0, NAN, INF),
        *setting("auto_disable_angular_threshold", -1.0, NAN, INF),
    ],
    "an axis or a limit of turning": [
        *setting("finite_rotation_axis", (NAN, 0, 0), (1e-320, 0, 0), (1, 0), 5),
        *setting("max_angular_speed", -1.0, NAN),
    ],
    "what is no flag": [
        action
        for name in ("kinematic", "gravity", "gyroscopic", "enabled", "auto_recentre", "auto_disable")
        for action in setting(name, 1, "yes", NAN, (True,))
    ],
    "no way of being followed": setting("tunnelling", "fast", "", 1, True),
}
"""Of both: in a World and outside."""

LIVE_ROWS = {
    "a push that is not finite": [
        (f"{name}({value!r})"[:60], lambda body, name=name, value=value: getattr(body, name)(value))
        for name in PUSHES
        for value in VECTORS
    ],
    "a push at a point that is none": [
        (f"{name}(at={value!r})"[:60], lambda body, name=name, value=value: getattr(body, name)((1, 0, 0), at=value))
        for name in AT
        for value in VECTORS
        if value is not None
    ],
    "a glide to a place that is none": [
        (f"glide_to({value!r})"[:60], lambda body, value=value: body.glide_to(value)) for value in VECTORS
    ],
    "a glide that turns nowhere": [
        ("glide_to(rotation=0)", lambda body: body.glide_to(rotation=(0, 0, 0, 0))),
        ("glide_to(rotation=NaN)", lambda body: body.glide_to(rotation=(NAN, 0, 0, 1))),
    ],
    "a glide of a time that is none": [
        (f"glide_to(seconds={value})", lambda body, value=value: body.glide_to((1, 0, 0), seconds=value))
        for value in (NAN, INF, -1.0, "soon")
    ],
}
"""Of a body in a World."""


def cases(rows):
    return [
        pytest.param(act, id=f"{row}: {label}".replace("\n", " "))
        for row, actions in rows.items()
        for label, act in actions
    ]


def make_body():
    """A World, and a body of two parts that moves in it."""
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.HashSpace())
    world.collide(space)
    body = space.attach(oo.Body(name="it", position=(1, 2, 3), linear_velocity=(1, 0, 0), angular_velocity=(0, 1, 0)))
    body.attach(oo.Placeable(name="it", position=(0.5, 0, 0))).attach(oo.Box(mass=2.0, name="it"))
    body.attach(oo.Placeable(rotation=(0, 1, 0, 0))).attach(oo.Sphere(0.3, mass=1.0))
    return world, space, body


def refuse_and_go_on(world, body, act):
    before = photo(body)
    with pytest.raises(oo.FieldError) as caught:
        act(body)
    message = str(caught.value)
    assert "'it'" in message or "Mass" in message
    assert "must" in message or "mass=0" in message or "give" in message
    after = photo(body)
    assert_photos_agree(before, after)
    world.step(3)
    assert all(map(math.isfinite, (*body.position, *body.rotation, *body.linear_velocity, *body.angular_velocity)))


@pytest.mark.parametrize("act", cases(ROWS))
def test_a_hazard_is_refused_in_a_world(act):
    world, _, body = make_body()
    refuse_and_go_on(world, body, act)


LATER = ("a part so", "a mesh that")
"""Outside of a World a part may come before what makes it right: these are told when the mass is asked for."""


@pytest.mark.parametrize("act", cases({row: some for row, some in ROWS.items() if not row.startswith(LATER)}))
def test_a_hazard_is_refused_outside_of_a_world(act):
    world, space, body = make_body()
    space.detach(body)
    refuse_and_go_on(world, body, act)


@pytest.mark.parametrize("act", cases({row: some for row, some in ROWS.items() if row.startswith(LATER)}))
def test_parts_without_a_usable_mass_are_refused_when_the_body_enters(act):
    world, space, body = make_body()
    space.detach(body)
    act(body)
    with pytest.raises(oo.FieldError):
        _ = body.mass_properties
    with pytest.raises(oo.FieldError):
        space.attach(body)
    assert not body.is_live
    assert body.parent is None
    world.step()
    body.detach(body.children[-1])
    space.attach(body)
    assert body.mass == 3.0


@pytest.mark.parametrize("act", cases(LIVE_ROWS))
def test_a_hazardous_push_or_glide_is_refused(act):
    world, _, body = make_body()
    body.kinematic = True
    body.enabled = False
    refuse_and_go_on(world, body, act)
    assert not body.gliding
    assert body.asleep


def test_every_field_of_a_body_has_its_row():
    """A field that comes new is thought of here too."""
    told = " ".join(label for actions in ROWS.values() for label, _ in actions)
    assert [name for name in fields_of(oo.Body) if f"{name} = " not in told and name != "fixed_mass"] == []


@pytest.mark.parametrize("act", [*PUSHES, "glide_to"])
def test_a_body_outside_of_a_world_reaches_no_native(act):
    """A handle that is used after its end is a segmentation fault in ODE."""
    _, space, body = make_body()
    space.detach(body)
    with pytest.raises(oo.StateError, match=r"'it'.*needs a World"):
        getattr(body, act)((1, 0, 0))
