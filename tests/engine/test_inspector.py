"""What the inspector tells of nodes, line by line, against what they say themselves."""

import math
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

import osgode as oo
from osgode.engine import inspect
from osgode.engine.inspector import yaw_pitch_roll
from osgode.errors import FieldError
from tests.joints.held import each_kind

ANGLE = st.floats(-math.pi, math.pi)


def new_world():
    root = oo.Group(name="root")
    world = root.attach(oo.World(name="world"))
    space = world.attach(oo.HashSpace(name="things"))
    world.collide(space)
    return root, world, space


def lines_of(what):
    return inspect(what).split("\n")


@given(ANGLE, st.floats(-1.57, 1.57), ANGLE)
def test_angles_give_the_rotation_back(yaw, pitch, roll):
    """Whatever the angles: the rotation that they make is the same."""
    rotation = oo.Quat.from_yaw_pitch_roll(yaw, pitch, roll)
    again = oo.Quat.from_yaw_pitch_roll(*yaw_pitch_roll(rotation))
    assert (rotation * again.conjugate()).angle < 1e-5


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
@pytest.mark.parametrize("roll", [0.0, 1.0, -2.0])
def test_angles_straight_up_and_down(pitch, roll):
    """There yaw and roll turn about the same axis: all of it is told as roll."""
    rotation = oo.Quat.from_yaw_pitch_roll(0.7, pitch, roll)
    angles = yaw_pitch_roll(rotation)
    assert angles[0] == 0.0
    assert angles[1] == pytest.approx(pitch, abs=1e-6)
    assert (rotation * oo.Quat.from_yaw_pitch_roll(*angles).conjugate()).angle < 1e-6


def test_a_geom_of_a_body():
    """Path, shape, material, the body's pose, velocities and mass."""
    _root, _world, space = new_world()
    turn = oo.Quat.from_yaw_pitch_roll(math.pi / 2, 0, 0)
    body = space.attach(oo.Body(name="crate", position=(1, 2, -3), rotation=turn, linear_velocity=(3, 0, 4)))
    place = body.attach(oo.Placeable(name="lid", position=(0, 0.5, 0)))
    geom = place.attach(oo.Box((1, 0.25, 2), material="wood", density=100, collides_with={"default"}))
    body.angular_velocity = (0, 2, 0)
    assert lines_of(geom) == [
        "root/world/things/crate/lid/Box",
        "Box, size 1 x 0.25 x 2 m",
        "material wood, kind default, meets default",
        "of Body 'crate'",
        "position (1.00, 2.00, -3.00) m, yaw 90, pitch 0, roll 0 deg",
        "velocity (3.00, 0.00, 4.00) = 5.000 m/s, turning 2.000 rad/s",
        "mass 50 kg, centre of mass (0.00, 0.50, 0.00), awake",
        "touches nothing",
    ]
    assert "Body, 1 geom" in lines_of(body)
    assert lines_of(body)[2:] == lines_of(geom)[4:]
    assert lines_of(place)[2:4] == lines_of(geom)[3:5]


def test_states_are_told():
    _root, _world, space = new_world()
    body = space.attach(oo.Body())
    geom = body.attach(oo.Placeable()).attach(oo.Sphere(0.5, sensor=True, mass=1, visible=False))
    assert lines_of(geom)[1] == "Sphere, radius 0.5 m, hidden"
    assert lines_of(geom)[2].endswith("sensor")
    geom.sensor, geom.enabled, body.enabled = False, False, False
    assert lines_of(geom)[2].endswith("disabled")
    assert "asleep" in inspect(geom)
    assert "touches nothing, or what it touches sleeps too" in inspect(geom)
    body.kinematic = True
    assert "kinematic" in inspect(body)
    space.detach(body)
    assert "in no World" in inspect(body)
    assert "touches" not in inspect(body)


def test_contacts_are_counted_and_named():
    """How many, how deep, with whom, of what, and how slippery: that of the table, or of the geom's own surface."""
    _root, world, space = new_world()
    ground = space.attach(oo.Plane(name="ground", material="ice"))
    body = space.attach(oo.Body(name="crate", position=(0, 0.4995, 0)))
    box = body.attach(oo.Placeable()).attach(oo.Box(material="wood"))
    ball = space.attach(oo.Body(name="ball", position=(0, 1.499, 0)))
    ball.attach(oo.Placeable()).attach(oo.Sphere(0.5, surface=oo.Surface(friction=0.125)))
    world.step()
    lines = lines_of(body)
    depth = 1e3 * world.contacts["geom"]["depth"].max()
    at = lines.index(f"5 contacts, deepest {depth:.3f} mm")
    friction = world.surfaces["wood", "ice"].friction
    assert lines[at + 1] == f"  4 with Plane 'ground': ice, friction {friction:g}"
    assert lines[at + 2] == "  1 with Sphere of Body 'ball': default, friction 0.125"
    assert f"  4 with Box of Body 'crate': wood, friction {friction:g}" in lines_of(ground)
    box.surface = oo.Surface(friction=0.0625)
    assert "  1 with Box of Body 'crate': wood, friction 0.0625" in lines_of(ball)


def test_of_many_the_first_are_named():
    _root, world, space = new_world()
    table = space.attach(oo.Placeable()).attach(oo.Box((20, 1, 1)))
    for k in range(7):
        body = space.attach(oo.Body(position=(2 * k - 6, 0.999, 0)))
        body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    world.step()
    lines = lines_of(table)
    assert sum(" with Sphere" in line for line in lines) == 4
    assert lines[-1] == "  and 3 more"
    assert "7 contacts" in inspect(table)


def test_joints_are_told_with_what_they_read():
    _root, world, space = new_world()
    door = space.attach(oo.Body(name="door", gravity=False, angular_velocity=(0, 1, 0)))
    frame = space.attach(oo.Body(name="frame", gravity=False, kinematic=True))
    hinge = oo.Hinge(door, frame, name="pin", axis=(0, 1, 0))
    slider = oo.Slider(door, axis=(1, 0, 0))
    slider.enabled = False
    world.step(60)
    lines = lines_of(door)
    at = lines.index("2 joints")
    assert lines[at + 1].startswith(f"  Hinge 'pin' with Body 'frame', angle {math.degrees(hinge.angle):.1f} deg")
    assert lines[at + 2].startswith(f"  Slider with the static world, position {slider.position:.3f} m, disabled")
    assert inspect(hinge).startswith("Hinge 'pin' of Body 'door' and Body 'frame', angle")
    hinge.release()
    assert inspect(hinge) == "Hinge 'pin' of Body 'door' and Body 'frame', released"
    assert "1 joint" in lines_of(door)


def test_errors_of_joints_are_told():
    _root, _world, space = new_world()
    body = space.attach(oo.Body())
    oo.Ball(body, anchor=(0, 1, 0))
    assert "error" not in inspect(body)
    body.position = (0.002, 0, 0)
    assert "error 2.000 mm" in inspect(body)


@each_kind
def test_every_kind_of_joint_can_be_inspected(kind):
    """All of what it reads is told, whatever its mode."""
    world = oo.World()
    bodies = [world.attach(oo.Body(name=name)) for name in ("one", "other")]
    joint = kind.make(*bodies[: 2 if True in kind.attached else 1])
    world.step(3)
    text = inspect(joint)
    assert text.startswith(f"{joint.describe()} of Body 'one' and ")
    coordinates = [name for name, spot in vars(type(joint)).items() if getattr(spot, "row", "") == "position"]
    assert all(f", {name} " in text for name in coordinates)
    assert f"  {joint.describe()} with " in inspect(bodies[0])


def test_what_stands_still():
    """Static geometry has a place and no mass; planes have a normal, meshes triangles, heightfields samples."""
    _root, _world, space = new_world()
    place = space.attach(oo.Placeable(position=(1, 2, 3)))
    mesh = place.attach(oo.Trimesh(([(0, 0, 0), (0, 0, 1), (1, 0, 0)], [(0, 1, 2)])))
    assert lines_of(mesh)[1:4] == [
        "Trimesh, 1 triangle",
        "material default, kind default, static",
        "position (1.00, 2.00, 3.00) m, yaw 0, pitch 0, roll 0 deg",
    ]
    assert "Heightfield, size 4 x 5 m, 2 x 3 samples" in lines_of(
        place.attach(oo.Heightfield([(0, 0, 0), (0, 0, 0)], (4, 5)))
    )
    assert "normal (0.00, 1.00, 0.00), offset 2 m" in lines_of(space.attach(oo.Plane((0, 3, 0), 2.0)))
    assert "mass" not in inspect(mesh)


def test_hits_tell_where():
    _root, world, space = new_world()
    body = space.attach(oo.Body(name="target", position=(0, 0, -5)))
    geom = body.attach(oo.Placeable()).attach(oo.Sphere(1.0))
    hit = world.cast_ray((0, 0, 0), (0, 0, -1), 10.0)
    assert lines_of(hit) == [*lines_of(geom), "at (0.00, 0.00, -4.00) m, 4 m away"]
    sweep = world.sweep(oo.Sphere(0.5), (0, 0, 0), (0, 0, -10))
    assert lines_of(sweep)[-1].startswith("at (0.00, 0.00, -3.5")
    assert lines_of(sweep)[-1].endswith("35.0% of the way")


def test_rays_tell_what_they_meet():
    _root, world, space = new_world()
    body = space.attach(oo.Body(name="target", position=(0, 0, -5)))
    body.attach(oo.Placeable()).attach(oo.Sphere(1.0))
    ray = space.attach(oo.Placeable()).attach(oo.Ray(20.0))
    assert lines_of(ray)[-1] == "meets nothing"
    world.step()
    assert lines_of(ray)[-1] == "meets Sphere of Body 'target' at 4 m"


def test_worlds_spaces_and_plain_nodes():
    root, world, space = new_world()
    for k in range(2):
        body = space.attach(oo.Body(position=(5 * k, 5, 0)))
        body.attach(oo.Placeable()).attach(oo.Box())
        body.attach(oo.Placeable(position=(0, 1, 0))).attach(oo.Sphere())
    world.bodies[0].enabled = False
    world.step(3)
    assert "2 bodies (1 awake), 0 joints, 0 contacts" in lines_of(world)
    assert lines_of(world)[2].startswith("step 3,")
    assert lines_of(space)[2] == "2 bodies, 4 geoms"
    assert lines_of(root) == ["root", "Group"]
    tower = root.attach(oo.PositionAttitudeTransform(name="tower", position=(0, 7, 0)))
    assert lines_of(tower)[2].startswith("position (0.00, 7.00, 0.00) m")


def test_what_is_drawn_on_a_body_tells_of_the_body():
    """A leaf below a visual group below it: whose picture it is, is what matters."""
    _root, _world, space = new_world()
    body = space.attach(oo.Body(name="car"))
    lamp = body.attach(oo.Group(name="lamps")).attach(oo.Leaf(name="lamp"))
    assert lines_of(lamp)[:3] == ["root/world/things/car/lamps/lamp", "Leaf", "of Body 'car'"]


def test_what_was_picked_is_what_it_shows():
    @dataclass
    class Picked:
        node: oo.Node

    _root, world, _space = new_world()
    assert inspect(Picked(world)) == inspect(world)


def test_units_are_told_once_for_several_of_a_kind():
    _root, _world, space = new_world()
    body = space.attach(oo.Body())
    joint = oo.Universal(body, axis1=(1, 0, 0), axis2=(0, 1, 0))
    assert inspect(joint) == "Universal of Body and the static world, angle1 0.0, angle2 0.0 deg"


@pytest.mark.parametrize("width", [20, 30, 60])
def test_long_lines_are_broken(width):
    """None is longer; what goes on is indented deeper than where it began; not a word is lost."""
    _root, world, space = new_world()
    body = space.attach(oo.Body(name="a body with a long name"))
    other = space.attach(oo.Body(name="another body with a long name", position=(3, 0, 0)))
    oo.Universal(body, other, name="joint", axis1=(1, 0, 0), axis2=(0, 1, 0))
    world.step(3)
    plain, broken = inspect(body), inspect(body, width=width)
    assert max(map(len, broken.split("\n"))) <= width
    assert "".join(broken.split()) == "".join(plain.split())
    assert "\n      " in broken


@pytest.mark.parametrize("width", [0, 19, 2.5, "wide"])
def test_widths_of_lines_that_cannot_be(width):
    with pytest.raises(FieldError, match="width"):
        inspect(oo.Group(), width=width)


@pytest.mark.parametrize("what", [None, 5, "crate"])
def test_only_nodes_joints_and_hits_can_be_inspected(what):
    with pytest.raises(FieldError, match="must be a node, a joint, or a hit"):
        inspect(what)
