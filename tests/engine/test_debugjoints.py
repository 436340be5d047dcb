"""Joints in the debug overlay, against what each of them says."""

import numpy as np
import pytest

import osgode as oo
from osgode.engine import DebugOverlay
from osgode.engine import debugjoints as looks
from osgode.engine.stamps import HEAD
from tests.joints.held import each_kind

SIZE = 0.25


def pair(**fields):
    """Two bodies side by side, turned, moving, and large enough for marks of full size."""
    world = oo.World(gravity=(0, 0, 0))
    bodies = []
    for k in range(2):
        spin = {"angular_velocity": (0.3, -0.2 * k, 0.1), "linear_velocity": (0.1 * k, 0.2, 0)}
        turn = oo.Quat.from_axis_angle((1, k, 1), 0.4)
        body = world.attach(oo.Body(position=(3.0 * k, 1, 0), rotation=turn, **spin))
        body.attach(oo.Placeable(position=(0, 0.2, 0))).attach(oo.Box((1, 2, 1)))
        bodies.append(body)
    overlay = DebugOverlay(world, shapes=False, contacts=False, size=SIZE, **fields)
    return world, *bodies, overlay


def by_colour(overlay):
    """The lines of each colour."""
    found = overlay.lines(1.0)
    assert all(lines.in_front for lines in found)
    if not found:
        return {}
    colours = found[0].colours.view(np.uint32).ravel()
    return {int(c): found[0].points[colours == c] for c in np.unique(colours)}


def near(one, other):
    return np.allclose(one, other, atol=2e-5)


KINDS = [
    lambda a, b: oo.Ball(a, b, anchor=(1.5, 1, 0)),
    lambda a, b: oo.Hinge(a, b, anchor=(1.5, 1, 0), axis=(0, 0, 1)),
    lambda a, b: oo.Slider(a, b, axis=(1, 0.2, 0)),
    oo.Fixed,
    lambda a, b: oo.Universal(a, b, anchor=(1.5, 1, 0), axis1=(1, 0, 0), axis2=(0, 1, 0)),
    lambda a, b: oo.Hinge2(a, b, anchor=(1.5, 1, 0), axis1=(0, 1, 0), axis2=(0, 0, 1)),
    lambda a, b: oo.DoubleBall(a, b, anchor1=(0.5, 1, 0), anchor2=(2.5, 1, 0)),
    lambda a, b: oo.PU(a, b, anchor=(1.5, 1, 0), axis1=(1, 0, 0), axis2=(0, 1, 0), axis3=(0, 0, 1)),
]


@pytest.mark.parametrize("number", range(len(KINDS)))
def test_marks_are_where_the_joint_says(number):
    """Before and after motion: the mark of body 1's anchor, lines to the centres of mass, axes in their order."""
    world, first, second, overlay = pair()
    joint = KINDS[number](first, second)
    for _ in range(2):
        found = by_colour(overlay)
        points = [getattr(joint, name) for name, spot in joint.SPOTS.items() if spot.is_point]
        start = points[0] if points else found[looks.ANCHORS[0]].reshape(-1, 3).mean(axis=0)
        assert near(found[looks.ANCHORS[0]].reshape(-1, 3).mean(axis=0), start)
        assert near(found[looks.HOLDS[0]], [[first.world_centre_of_mass, start]])
        assert near(found[looks.HOLDS[1]][0][0], second.world_centre_of_mass)
        if len(points) == 2:  # a rod
            assert near(found[looks.APART], [points])
            assert near(found[looks.ANCHORS[1]].reshape(-1, 3).mean(axis=0), points[1])
        axes = [getattr(joint, name) for name, spot in joint.SPOTS.items() if not spot.is_point]
        for n, axis in enumerate(axes):
            shaft = found[looks.AXES[n]][0]
            assert near(shaft[1] - shaft[0], np.array(axis) * SIZE)
        assert len(axes) == len(set(looks.AXES) & set(found))
        world.step(30)


@each_kind
def test_every_kind_of_joint_is_shown(kind):
    """With as many axes as `joint_marks` has arrows, and an anchor unless it has no place of its own."""
    world = oo.World()
    bodies = [world.attach(oo.Body()) for _ in range(2 if True in kind.attached else 1)]
    joint = kind.make(*bodies)
    overlay = DebugOverlay(world, shapes=False, contacts=False)
    found = by_colour(overlay)
    marks = world.attach(oo.joint_marks(world))
    arrows = sum("arrow" in mark.drawables()[0].mesh.name for mark in marks.children)
    assert sum(colour in found for colour in looks.AXES) == arrows
    free = isinstance(joint, oo.AngularMotor | oo.LinearMotor | oo.Plane2D)
    assert (looks.ANCHORS[0] in found) != free


def test_what_slides_has_two_heads():
    """An arrow within the arrow, shorter by most of a head."""
    _world, first, second, overlay = pair()
    slider = oo.Slider(first, second, axis=(1, 0, 0))
    lines = by_colour(overlay)[looks.AXES[0]]
    assert len(lines) == 10
    assert near(lines[5, 1] - lines[5, 0], np.array(slider.axis) * SIZE * (1 - 0.7 * HEAD))
    slider.release()
    oo.Hinge(first, second)
    assert len(by_colour(overlay)[looks.AXES[0]]) == 5


def test_motors_have_axes_at_the_first_body():
    """They hold no point: neither anchors nor lines, only axes as they stand now."""
    world, first, second, overlay = pair()
    motor = oo.AngularMotor(first, second, axes=[(1, 0, 0), (0, 1, 0)], relative_to=["body1", "world"])
    for _ in range(2):
        found = by_colour(overlay)
        assert set(found) == set(looks.AXES[:2])
        for n in range(2):
            shaft = found[looks.AXES[n]][0]
            assert near(shaft[0], first.world_centre_of_mass)
            assert near(shaft[1] - shaft[0], np.array(motor.axes[n]) * SIZE)
        world.step(20)


def test_a_joint_to_the_static_world_has_one_body():
    world, first, second, overlay = pair()
    world.detach(second)
    joint = oo.Ball(first, anchor=(0, 2, 0))
    world.step(10)
    found = by_colour(overlay)
    assert looks.HOLDS[1] not in found
    assert near(found[looks.HOLDS[0]][0][1], joint.anchor)
    assert near(found[looks.APART][0][1], (0, 2, 0))


def test_an_anchor_that_is_torn_apart_is_seen_on_both_sides():
    """Together they have one mark; apart each has its own, with a line between."""
    _world, first, second, overlay = pair()
    joint = oo.Ball(first, second, anchor=(1.5, 1, 0))
    assert looks.ANCHORS[1] not in by_colour(overlay)
    first.position += (0, 0.5, 0)
    found = by_colour(overlay)
    assert near(found[looks.ANCHORS[1]].reshape(-1, 3).mean(axis=0), joint.anchor2)
    assert near(found[looks.ANCHORS[0]].reshape(-1, 3).mean(axis=0), joint.anchor)
    assert near(found[looks.APART][0], [joint.anchor, joint.anchor2])


def test_joints_that_hold_nothing_are_left_out():
    """Disabled or released ones; what comes, or is anchored anew, is seen in the next picture."""
    world, first, second, overlay = pair()
    hinge = oo.Hinge(first, second, anchor=(1, 1, 0))
    assert by_colour(overlay)
    hinge.enabled = False
    assert by_colour(overlay) == {}
    hinge.enabled = True
    hinge.anchor = (2, 1, 0)
    assert near(by_colour(overlay)[looks.HOLDS[0]][0][1], (2, 1, 0))
    ball = oo.Ball(first, second, anchor=(1, 1, 0))
    assert len(by_colour(overlay)[looks.HOLDS[0]]) == 2
    hinge.release()
    assert near(by_colour(overlay)[looks.HOLDS[0]][0][1], (1, 1, 0))
    world.detach(second)
    assert not ball.is_live
    assert by_colour(overlay) == {}


def test_bodies_that_change_rows_keep_their_joints():
    """The last body takes the row of one that leaves, while its joint stays as it is."""
    world, first, second, overlay = pair()
    third = world.attach(oo.Body(position=(0, 5, 0)))
    ball = oo.Ball(second, third, anchor=(0, 3, 0))
    by_colour(overlay)
    world.detach(first)
    assert ball.is_live
    found = by_colour(overlay)
    assert near(found[looks.HOLDS[0]][0], [second.world_centre_of_mass, (0, 3, 0)])
    assert near(found[looks.HOLDS[1]][0], [(0, 5, 0), (0, 3, 0)])


def test_joints_enabled_tells_in_bulk():
    world, first, second, _ = pair()
    joints = [oo.Ball(first, second), oo.Hinge(first, second), oo.Fixed(first, second)]
    joints[1].enabled = False
    assert world.joints_enabled.tolist() == [joint.enabled for joint in world.joints] == [True, False, True]
