"""The marks of joints lie where the joints say that they are."""

import math

import numpy as np
import pytest

import osgode as oo
from osgode.graph.arrows import arrow_mesh

SIZE = 0.5
X, Y, Z = oo.Vec3(1, 0, 0), oo.Vec3(0, 1, 0), oo.Vec3(0, 0, 1)
FAR = oo.View(oo.Pose(oo.Vec3(0, 0, 500)), far=2000)
"""From so far away that all is in the picture."""
RED, GREEN, BLUE = range(3)


def empty():
    return oo.World(gravity=(0, 0, 0))


def body(world, position, **fields):
    made = world.attach(oo.Body(position=position, **fields))
    made.attach(oo.Placeable()).attach(oo.Box((0.4, 0.3, 0.2), mass=2))
    return made


def scene():
    """A World, and two bodies in it that move and turn."""
    world = empty()
    first = body(world, (1, 2, 0), rotation=oo.Quat.from_axis_angle((1, 1, 0), 0.7))
    second = body(world, (0, 0, 1), rotation=oo.Quat.from_axis_angle((0, 1, 3), -0.4))
    first.linear_velocity, first.angular_velocity = (1, 0.5, -2), (0.5, 2, 1)
    second.linear_velocity, second.angular_velocity = (-1, 0.5, 1), (2, 0, -1)
    return world, (first, second)


class Marks:
    """What is drawn in front of a picture of the World."""

    def __init__(self, root, interpolation=1.0):
        oo.UpdateVisitor(root).update()
        front = oo.CullVisitor(root).cull(FAR, (400, 300), interpolation).front
        self.all = [(one, matrix.astype(float)) for one in front for matrix in one.matrices]

    def named(self, name):
        return [(one, matrix) for one, matrix in self.all if one.mesh.name == name]

    @property
    def balls(self):
        """The middles of balls and of halos."""
        seen = self.named("sphere")
        return tuple([m[:3, 3] for one, m in seen if one.appearance.transparent == halo] for halo in (False, True))

    @property
    def arrows(self):
        """By colour: start, direction and mesh."""
        found = {}
        for one, matrix in self.named("arrow"):
            number = int(np.argmax(one.appearance.colour[:3]))
            found.setdefault(number, []).append((matrix[:3, 3], matrix[:3, 2] / SIZE, one.mesh))
        return found

    @property
    def lines(self):
        """Both ends of each."""
        return [(m[:3, 3] - m[:3, 2] / 2, m[:3, 3] + m[:3, 2] / 2) for _, m in self.named("cylinder")]


def near(value):
    return pytest.approx(np.array(value), abs=2e-5)


MADE = {
    "Ball": lambda a, b: oo.Ball(a, b, anchor=(1, 1, 1)),
    "Hinge": lambda a, b: oo.Hinge(a, b, anchor=(1, 1, 1), axis=(1, 2, 2)),
    "Fixed": lambda a, b: oo.Fixed(a, b, anchor=(1, 1, 1)),
    "Universal": lambda a, b: oo.Universal(a, b, anchor=(1, 1, 1), axis1=X, axis2=Y),
    "Hinge2": lambda a, b: oo.Hinge2(a, b, anchor=(1, 1, 1), axis1=Y, axis2=Z),
    "Piston": lambda a, b: oo.Piston(a, b, anchor=(1, 1, 1), axis=(1, 2, 2)),
    "PR": lambda a, b: oo.PR(a, b, anchor=(1, 1, 1), axis1=X, axis2=Y),
    "PU": lambda a, b: oo.PU(a, b, anchor=(1, 1, 1), axis1=Y, axis2=Z, axis3=X),
    "DoubleBall": lambda a, b: oo.DoubleBall(a, b, anchor1=(1, 1, 1), anchor2=(0, 0, 2)),
    "DoubleHinge": lambda a, b: oo.DoubleHinge(a, b, anchor1=(1, 1, 1), anchor2=(0, 2, 1), axis=Z),
    "Transmission": lambda a, b: oo.Transmission(a, b, anchor1=(1, 1, 1), anchor2=(0, 2, 1), axis1=Z),
    "Slider": lambda a, b: oo.Slider(a, b, axis=(1, 2, 2)),
}


@pytest.mark.parametrize("kind", MADE)
def test_anchors_and_axes_are_drawn_where_each_body_has_them(kind):
    """After some steps, in which the weak joint lets the bodies drift apart, compared with the joint's own answers."""
    world, pair = scene()
    joint = MADE[kind](*pair)
    world.erp, world.cfm = 0.01, 0.5
    world.attach(oo.joint_marks(world, size=SIZE))
    world.run(steps=20)
    marks = Marks(world)
    names = list(joint.SPOTS)
    points = [name for name in names if joint.SPOTS[name].is_point]
    if points:
        ends = getattr(joint, points[0]), joint.anchor2
    else:  # a slider is marked at the centre of mass: now, and where body 2 carries the place where it was
        rest, carried = joint._rest, pair[1].pose * joint._rest[1].inverse()
        ends = pair[0].position, carried.transform(rest[0].position)
    assert marks.balls == ([near(ends[0])], [near(ends[1])])
    ((start, end),) = marks.lines
    assert (start, end) == (near(ends[0]), near(ends[1]))
    axes = [name for name in names if not joint.SPOTS[name].is_point]
    assert sum(map(len, marks.arrows.values())) == len(axes)
    for number, name in enumerate(axes):
        ((start, way, _),) = marks.arrows[number]
        assert way == near(getattr(joint, name))
        assert start == near(ends[joint.SPOTS[name].side])


@pytest.mark.parametrize("kind", [kind for kind in MADE if kind not in ("Hinge2", "Transmission")])
def test_a_joint_to_the_static_world_has_its_halo_there(kind):
    world, (first, _) = scene()
    joint = MADE[kind](first, None)
    place = joint.anchor2 if joint.SPOTS and kind != "Slider" else first.position
    world.attach(oo.joint_marks(world, size=SIZE))
    world.run(steps=5)
    assert Marks(world).balls[1] == [near(place)]


TURNS, SLIDES, BOTH = (False, True), (True, False), (True, True)


@pytest.mark.parametrize(
    ("kind", "expected"),
    {
        "Hinge": [TURNS],
        "Slider": [SLIDES],
        "Piston": [BOTH],
        "Universal": [TURNS, TURNS],
        "Hinge2": [BOTH, TURNS],
        "PR": [SLIDES, TURNS],
        "PU": [TURNS, TURNS, SLIDES],
        "DoubleHinge": [TURNS],
        "Transmission": [TURNS, TURNS],
    }.items(),
)
def test_an_arrow_shows_what_its_axis_is_for(kind, expected):
    """A ring about an axis of turning, a second head on one of sliding."""
    world, pair = scene()
    MADE[kind](*pair)
    world.attach(oo.joint_marks(world, size=SIZE))
    world.step()
    arrows = Marks(world).arrows
    meshes = [arrows[number][0][2] for number in range(len(expected))]
    assert meshes == [arrow_mesh(slides=slides, turns=turns) for slides, turns in expected]


@pytest.mark.parametrize(
    ("make", "mesh"),
    [
        (lambda a, b: oo.LinearMotor(a, b, axes=(X, Y), relative_to=("world", "body2")), {"slides": True}),
        (lambda a, b: oo.AngularMotor(a, b, axes=(X, (0, 1, 1), Z), relative_to="body1"), {"turns": True}),
        (lambda a, b: oo.AngularMotor(a, b, axes=(X, Z), mode="euler"), {"turns": True}),
    ],
)
def test_the_axes_of_a_motor_start_at_the_centre_of_mass_of_body_1(make, mesh):
    world, pair = scene()
    joint = make(*pair)
    world.attach(oo.joint_marks(world, size=SIZE))
    world.run(steps=10)
    marks = Marks(world)
    for number, axis in enumerate(joint.axes):
        ((start, way, shape),) = marks.arrows[number]
        assert (start, way) == (near(pair[0].position), near(axis))
        assert shape is arrow_mesh(**{"slides": False, "turns": False} | mesh)
    assert len(marks.arrows) == len(joint.axes)
    assert marks.lines == []


def test_a_plane_2d_shows_the_plane_of_the_world_and_the_axis_across_it():
    world = empty()
    flat = body(world, (1, 2, 0), angular_velocity=(0, 0, 3), linear_velocity=(1, 0, 0))
    oo.Plane2D(flat)
    world.attach(oo.joint_marks(world, size=SIZE))
    world.run(steps=10)
    arrows = Marks(world).arrows
    for number, (axis, turns) in enumerate(((X, False), (Y, False), (Z, True))):
        assert arrows[number] == [(near(flat.position), near(axis), arrow_mesh(slides=not turns, turns=turns))]


@pytest.mark.parametrize("part", [0.0, 0.25, 1.0])
def test_between_two_steps_the_marks_are_where_the_picture_has_the_bodies(part):
    """A body that flies at 6 m/s is 5 cm farther after each step of 1/120 s."""
    world = empty()
    flying = body(world, (0, 0, 0), linear_velocity=(6, 0, 0))
    oo.Slider(flying, axis=X)
    world.attach(oo.joint_marks(world, size=SIZE))
    world.run(steps=3)
    ((middle,), (start,)) = Marks(world, part).balls
    assert middle == near((0.05 * (2 + part), 0, 0))
    assert start == near((0, 0, 0))


def test_joints_come_and_go():
    """Those of a World are marked while they hold something, from one update to the next."""
    world, pair = scene()
    world.attach(oo.joint_marks(world, size=SIZE))
    world.step()
    assert Marks(world).all == []
    ball, hinge = oo.Ball(*pair), oo.Hinge(pair[0])
    assert len(Marks(world).balls[0]) == 2
    ball.enabled = False
    assert len(Marks(world).balls[0]) == 1
    ball.enabled = True
    hinge.release()
    marks = Marks(world)
    assert (len(marks.balls[0]), marks.arrows) == (1, {})
    world.detach(pair[1])
    assert Marks(world).all == []
    world.attach(pair[1])
    assert len(Marks(world).balls[0]) == 1


def test_a_joint_that_has_just_gone_leaves_nothing_in_the_picture():
    """Even without an update: its marks are shrunk to nothing."""
    world, pair = scene()
    root = oo.Group()
    root.attach(world)
    joint = oo.Hinge(pair[0])
    world.attach(oo.joint_marks(world, size=SIZE))
    world.step()
    joint.release()
    for one in oo.CullVisitor(root).cull(FAR, (400, 300)).front:
        assert not one.matrices[:, :3].any()


def test_an_anchor_that_is_set_is_followed():
    world, pair = scene()
    joint = oo.Hinge(pair[0], anchor=(1, 1, 1), axis=X)
    world.attach(oo.joint_marks(world, size=SIZE))
    world.step()
    Marks(world)
    joint.anchor_anew(anchor=(3, 1, 2), axis=Y)
    marks = Marks(world)
    assert marks.balls == ([near((3, 1, 2))], [near((3, 1, 2))])
    assert marks.arrows[RED][0][1] == near(Y)


def test_a_few_joints_of_several_worlds_can_be_marked():
    worlds = [oo.World(gravity=(0, 0, 0)) for _ in range(2)]
    joints = [oo.Ball(body(world, (k, 0, 0))) for k, world in enumerate(worlds)]
    oo.Ball(worlds[0].bodies[0], anchor=(9, 9, 9))
    root = oo.Group()
    root.attach(oo.joint_marks(joints, size=SIZE))
    for world in worlds:
        world.step()
    assert sorted(ball[0] for ball in Marks(root).balls[0]) == [near(0), near(1)]
    lone = oo.Group()
    lone.attach(oo.joint_marks(joints[1]))
    assert len(Marks(lone).balls[0]) == 1


def test_marks_move_with_the_world_that_they_stand_in():
    """Below the World, whose axes stand elsewhere, they do too."""
    world, pair = scene()
    oo.Ball(pair[0], anchor=(1, 1, 1))
    world.attach(oo.joint_marks(world))
    root = oo.PositionAttitudeTransform(position=(10, 0, 0))
    root.attach(world)
    world.step()
    assert Marks(root).balls[1] == [near((11, 1, 1))]


def test_marks_throw_no_shadow_and_are_no_part_of_the_scene():
    world, pair = scene()
    oo.Hinge(*pair)
    world.attach(oo.joint_marks(world))
    world.step()
    frame = oo.CullVisitor(world).cull(oo.View(oo.Pose(oo.Vec3(0, 0, 30))), (400, 300))
    assert {one.mesh.name for one in frame.casters} == {"box"}
    assert {one.mesh.name for one in frame.opaque + frame.transparent} == {"box"}
    assert all(one.appearance.in_front for one in frame.front)
    assert len(frame.front) == 4
    assert len(world.joints) == 1


def test_marks_keep_no_world():
    world = oo.World()
    marks = world.attach(oo.joint_marks(world))
    oo.Ball(body(world, (0, 0, 0)))
    oo.UpdateVisitor(world).update()
    del world
    assert oo.live_natives().bodies == 0
    oo.UpdateVisitor(marks).update()
    assert marks.children == ()


@pytest.mark.parametrize("wrong", [None, 3, "hinge", [1, 2], oo.Vec3(0, 0, 0)])
def test_what_has_no_joints_is_refused(wrong):
    with pytest.raises(oo.FieldError, match=r"joint_marks\(\)\.joints is .*must be a World, a Joint, or several"):
        oo.joint_marks(wrong)


@pytest.mark.parametrize("size", [0, -1, math.nan, math.inf, "big"])
def test_a_size_that_is_none_is_refused(size):
    world = empty()
    with pytest.raises(oo.FieldError, match=r"joint_marks\(\)\.size is"):
        oo.joint_marks(world, size=size)


def test_no_joints_are_no_mistake():
    assert oo.joint_marks([]).children == ()
