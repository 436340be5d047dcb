"""The tree: who may stand where, coming and going as a whole or not at all, moving house, and the end of a World."""

import gc
import subprocess
import sys
import weakref
from typing import ClassVar

import pytest

import osgode as oo
from osgode import native
from osgode.joints import base as joints_base
from osgode.nodes import base as nodes_base
from osgode.nodes import bodymass as nodes_bodymass
from osgode.nodes import geom as nodes_geom
from osgode.nodes import realm as nodes_realm
from osgode.nodes import spaces as nodes_spaces
from osgode.nodes import trimesh as nodes_trimesh
from tests.strategies import CUBE, MAKERS, Stand
from tests.trees import Rig, assert_photos_agree, is_consistent, photo

# -- who may stand under whom

VISUAL = {"Group", "PositionAttitudeTransform", "MatrixTransform", "Switch", "LevelOfDetail"}
VISUAL |= {"Projection", "OverlayNode"}
LEAVES = {"Leaf", "LineSet", "Particles", "PointLight", "SpotLight"}
SPACES = {"SimpleSpace", "HashSpace", "QuadTreeSpace", "SweepAndPruneSpace"}
GROUPS = VISUAL | SPACES | {"World", "Body", "Placeable", "CentreOfMass"}

ALLOWED = {
    "World": VISUAL,
    **dict.fromkeys(SPACES, SPACES | {"World"}),
    "Body": SPACES | {"World"},
    "Placeable": SPACES | {"Body"},
    "CentreOfMass": {"Body"},
    **dict.fromkeys(
        ("Box", "Sphere", "Capsule", "Cylinder", "Trimesh", "ConvexHull", "Heightfield", "Ray"), SPACES | {"Placeable"}
    ),
    "Plane": SPACES,
    **dict.fromkeys(VISUAL | LEAVES, GROUPS),
}
"""The rules of spec N1, written down a second time."""


def make(name):
    cls = getattr(oo, name)
    if name in ("Trimesh", "ConvexHull"):
        return cls(CUBE, name=f"a {name}")
    if name == "Heightfield":
        return cls([[0, 1], [1, 0]], name=f"a {name}", mass=0)
    if name == "Leaf":
        return oo.Leaf([], name=f"a {name}")
    return cls(name=f"a {name}")


def test_every_class_of_nodes_has_its_rules_tested():
    nodes = {
        name
        for name in oo.__all__
        if isinstance(cls := getattr(oo, name), type) and issubclass(cls, oo.Node) and cls not in ABSTRACT
    }
    assert nodes == set(ALLOWED)


ABSTRACT = {oo.Node, oo.PhysicsNode, oo.Space, oo.Geom, oo.Transform}


@pytest.mark.parametrize("parent_name", sorted(GROUPS))
@pytest.mark.parametrize("child_name", sorted(ALLOWED))
def test_who_may_stand_under_whom(child_name, parent_name):
    """It may, or a TreeError names both and what would be right, and nothing has changed."""
    child, parent = make(child_name), make(parent_name)
    if parent_name in ALLOWED[child_name]:
        assert parent.attach(child) is child
        assert child.parent is parent
        assert parent.children == (child,)
        return
    with pytest.raises(oo.TreeError) as caught:
        parent.attach(child)
    message = str(caught.value)
    assert f"'a {child_name}'" in message
    assert f"'a {parent_name}'" in message
    assert any(allowed in message for allowed in (*child.PARENTS, "visual"))
    assert child.parents == ()
    assert parent.children == ()
    with pytest.raises(oo.TreeError):
        child.move_to(parent)
    assert child.parents == ()


@pytest.mark.parametrize("odd", [5, None, "a box", oo.Box, [], object()])
def test_what_is_no_node_has_no_place(odd):
    space = oo.SimpleSpace(name="space")
    with pytest.raises(oo.TreeError, match="no Node"):
        space.attach(odd)
    with pytest.raises(oo.TreeError, match=r"SimpleSpace 'space'"):
        space.detach(odd)
    with pytest.raises(oo.TreeError, match=r"SimpleSpace 'space'"):
        space.move_to(odd)
    world = oo.World()
    world.attach(space)
    with pytest.raises(oo.TreeError, match=r"SimpleSpace 'space'"):
        space.move_to(odd)
    assert world.children == (space,)


def test_a_world_stands_in_no_world_not_even_deep_down():
    outer = oo.World(name="outer")
    group = outer.attach(oo.Group()).attach(oo.Group(name="group"))
    with pytest.raises(oo.TreeError, match=r"'inner'.*'group'.*visual"):
        group.attach(oo.World(name="inner"))
    assert group.children == ()


def test_a_physics_node_has_one_parent():
    first, second = oo.SimpleSpace(name="first"), oo.SimpleSpace(name="second")
    body = first.attach(oo.Body(name="body"))
    for parent in (first, second):
        with pytest.raises(oo.TreeError, match=r"'body'.*'first'.*one parent.*move_to"):
            parent.attach(body)
    assert body.parents == (first,)
    assert first.children == (body,)
    assert second.children == ()


def test_no_space_stands_below_itself():
    world = oo.World()
    top = world.attach(oo.SimpleSpace(name="top"))
    low = top.attach(oo.HashSpace()).attach(oo.SimpleSpace(name="low"))
    before = photo(world)
    for node in (top, low):
        with pytest.raises(oo.TreeError, match=r"'top'.*below itself"):
            top.move_to(node)
    with pytest.raises(oo.TreeError):
        low.attach(top)
    assert_photos_agree(before, photo(world))
    world.detach(top)
    with pytest.raises(oo.TreeError, match=r"'top'.*below itself"):
        low.attach(top)


def test_spaces_nest_at_most_100_deep():
    """ODE walks them by recursion."""

    def chain(count):
        top = low = oo.SimpleSpace(name="first")
        for _ in range(count - 1):
            low = low.attach(oo.SimpleSpace())
        return top, low

    world = oo.World()
    top, low = chain(99)
    world.attach(top)
    other, _ = chain(2)
    with pytest.raises(oo.TreeError, match=r"101 deep.*100"):
        low.attach(other)
    assert low.children == ()
    low.attach(oo.SimpleSpace())
    world.step()


def test_children_keep_their_order():
    space = oo.SimpleSpace()
    bodies = [space.attach(oo.Body()) for _ in range(5)]
    assert space.children == tuple(bodies)
    space.detach(bodies[1])
    assert space.children == (bodies[0], *bodies[2:])
    space.attach(bodies[1])
    assert space.children[-1] is bodies[1]
    world = oo.World()
    world.attach(space)
    bodies[0].move_to(space)
    assert space.children == (*bodies[2:], bodies[1], bodies[0])


def test_detaching_needs_the_right_parent():
    first, second = oo.SimpleSpace(name="first"), oo.SimpleSpace(name="second")
    body = first.attach(oo.Body(name="body"))
    with pytest.raises(oo.TreeError, match=r"'body'.*can't be detached from .*'second'"):
        second.detach(body)
    assert body.parent is first
    assert first.detach(body) is body
    with pytest.raises(oo.TreeError, match="not one of its 0 children"):
        first.detach(body)


# -- live exactly below a World


@pytest.mark.parametrize("cls", [cls for cls in MAKERS if not issubclass(cls, oo.World | oo.Servo)])
def test_a_node_is_live_exactly_below_a_world(cls):
    stand = Stand(cls)
    node = stand.node
    assert not node.is_live
    assert node.world is None
    stand.enter()
    assert node.is_live
    assert node.world is stand.world
    is_consistent(stand.world)
    stand.leave()
    assert node.world is None
    is_consistent(stand.world)


def test_a_subtree_comes_and_goes_as_a_whole():
    """Its bodies, geoms, spaces and joints are made and freed, and its state is the same afterwards."""
    rig = Rig()
    is_consistent(rig.world)
    full = oo.live_natives()
    before = photo(rig.world)
    rig.world.detach(rig.hash)
    assert not any(node.is_live for node in rig.hash.walk())
    assert [joint.is_live for joint in rig.joints] == [False, False, True]
    is_consistent(rig.world)
    left = oo.live_natives()
    assert (left.bodies, left.geoms, left.spaces, left.joints, left.meshes) == (2, 13, 2, 1, 4)
    rig.world.attach(rig.hash)
    is_consistent(rig.world)
    assert oo.live_natives()[:6] == full[:6]
    after = photo(rig.world)
    for key in list(before):  # it is the last child now
        if key[1] in ("children", "bodies", "poses"):
            del before[key], after[key]
    assert_photos_agree(before, after, 1e-14)


def test_what_is_detached_keeps_what_the_simulation_did():
    """Position, rotation and velocities are those of the last step, to the bit, where nothing has to be computed."""
    world = oo.World()
    body = world.attach(oo.Body(linear_velocity=(1, 2, 3), angular_velocity=(0.5, 0.25, -1)))
    world.step(50)
    names = ("position", "rotation", "linear_velocity", "angular_velocity")
    state = [getattr(body, name) for name in names]
    assert state[0] != (0, 0, 0)
    world.detach(body)
    assert [getattr(body, name) for name in names] == state
    world.attach(body)
    assert [getattr(body, name) for name in names if name != "rotation"] == [state[0], *state[2:]]
    assert body.rotation == pytest.approx(state[1], abs=1e-15)


def test_the_table_of_poses_stays_parallel_to_the_bodies():
    """The last body takes the place of one that leaves."""
    world = oo.World()
    bodies = [world.attach(oo.Body(position=(i, 0, 0))) for i in range(40)]
    for body in (bodies[3], bodies[0], bodies[39], bodies[20]):
        world.detach(body)
        for row, other in zip(world.poses, world.bodies, strict=True):
            assert tuple(row[:3]) == other.position
            assert other.pose_row() == (world, list(world.bodies).index(other))
    assert bodies[39] not in world.bodies
    assert world.bodies[3] is bodies[37] or world.bodies[3] is bodies[38]


# -- all or nothing


class Failing:
    """The C core, whose ``name`` fails at its ``nth`` call."""

    def __init__(self, name, nth, result):
        self.name, self.left, self.result = name, nth, result

    def __getattr__(self, name):
        value = getattr(native.lib, name)
        if name != self.name:
            return value

        def call(*arguments):
            self.left -= 1
            return value(*arguments) if self.left else self.result

        return call

    def install(self, monkeypatch):
        for module in (nodes_base, nodes_bodymass, nodes_geom, nodes_realm, nodes_spaces, nodes_trimesh, joints_base):
            monkeypatch.setattr(module, "lib", self)


CALLS = {
    "oo_body_new": (native.lib.OO_NO_MEMORY, 4),
    "oo_body_set_mass": (native.lib.OO_ASSERT, 4),
    "oo_geom_new": (native.lib.OO_ASSERT, 16),
    "oo_space_new": (native.lib.OO_NO_MEMORY, 1),
    "oo_mesh_new": (native.ffi.NULL, 4),
    "oo_joint_new": (native.ffi.NULL, 2),
    "oo_set_surface": (native.lib.OO_NO_MEMORY, 4),
}


def loose_space():
    """A space outside of any World with bodies of four parts and two joints, nothing at its default."""
    space = oo.HashSpace(name="loose", levels=(0, 5))
    bodies = [space.attach(Rig.make_body(i)) for i in range(4)]
    bodies[2].enabled = False
    bodies[3].kinematic = True
    joints = [
        oo.Hinge(bodies[0], bodies[1], stops=(-1, 2), axis=(1, 2, 3)),
        oo.Ball(bodies[3], anchor=(1, 2, 3), cfm=0.5, enabled=False),
    ]
    return space, joints


@pytest.mark.parametrize("call", CALLS)
def test_an_attach_that_fails_in_the_middle_changes_nothing(call, monkeypatch):
    """Whichever native can't be made, all are freed again, and every node is outside with the state it had."""
    result, count = CALLS[call]
    rig = Rig()
    space, joints = loose_space()
    before = photo(rig.world, space)
    counts = oo.live_natives()[:6]
    for nth in range(1, count + 1):
        with monkeypatch.context() as patch:
            Failing(call, nth, result).install(patch)
            with pytest.raises(oo.PhysicsError):
                rig.world.attach(space)
        assert oo.live_natives()[:6] == counts
        assert_photos_agree(before, photo(rig.world, space))
        is_consistent(rig.world)
    rig.world.attach(space)
    assert all(joint.is_live for joint in joints)
    rig.world.step()


@pytest.mark.parametrize("call", CALLS)
def test_a_move_to_another_world_that_fails_changes_nothing(call, monkeypatch):
    """Everything stands where it stood, in the World where it was."""
    result, _ = CALLS[call]
    rig = Rig()
    space, _ = loose_space()
    rig.simple.attach(space)
    rig.simple.attach(oo.Body(name="after it"))
    other = oo.World()
    before = photo(rig.world)
    order = rig.simple.children
    with monkeypatch.context() as patch:
        failing = Failing(call, 1, result)
        failing.install(patch)
        attach = other.attach

        def attach_failing(child):
            failing.left = 1
            try:
                return attach(child)
            finally:
                failing.left = -1

        patch.setattr(other, "attach", attach_failing)
        failing.left = -1
        with pytest.raises(oo.PhysicsError):
            space.move_to(other)
    assert rig.simple.children == order
    assert other.children == ()
    is_consistent(rig.world)
    after = photo(rig.world)
    for key in list(before):
        if key[1] in ("bodies", "poses"):  # they have been in and out: the rows have another order
            del before[key], after[key]
    assert_photos_agree(before, after, 1e-13)


def test_a_full_space_takes_no_more_and_changes_nothing(monkeypatch):
    """ODE's hash space aborts above 131072 geoms."""
    monkeypatch.setattr(nodes_spaces, "MAX_GEOMS", 7)
    world = oo.World()
    full = world.attach(oo.HashSpace(name="full"))
    for _ in range(5):
        full.attach(oo.Sphere())
    space, _ = loose_space()
    body = space.children[0]
    space.detach(body)
    before = photo(world, body)
    with pytest.raises(oo.TreeError, match=r"can't be put into HashSpace 'full'.*7"):
        full.attach(body)
    assert_photos_agree(before, photo(world, body))
    home = world.attach(oo.SimpleSpace())
    home.attach(body)
    before = photo(world)
    with pytest.raises(oo.TreeError, match=r"HashSpace 'full'"):
        body.move_to(full)
    assert_photos_agree(before, photo(world))
    inner = home.attach(oo.HashSpace(name="inner", levels=(0, 3)))
    full.attach(oo.Sphere())
    full.attach(oo.Sphere())
    before = photo(world)
    with pytest.raises(oo.TreeError, match=r"HashSpace 'full'"):
        inner.move_to(full)
    assert_photos_agree(before, photo(world))
    loose = oo.HashSpace(name="loose", levels=(0, 3))
    with pytest.raises(oo.TreeError, match=r"HashSpace 'full'"):
        full.attach(loose)
    assert loose.levels == (0, 3)
    world.step()


OPEN = (CUBE[0], CUBE[1][1:])


@pytest.mark.parametrize("live", [False, True])
def test_a_part_that_has_no_mass_to_compute_is_refused(live):
    """An open mesh encloses nothing; the body it was to be a part of, and the mesh, are as they were."""
    rig = Rig()
    body = rig.bodies[0]
    place = body.children[1]
    mesh = oo.Trimesh(OPEN, name="open")
    if live:
        rig.simple.attach(mesh)
    before = photo(rig.world, mesh)
    with pytest.raises(oo.FieldError, match=r"Trimesh 'open'.*open.*mass=0"):
        mesh.move_to(place) if live else place.attach(mesh)
    assert_photos_agree(before, photo(rig.world, mesh))
    is_consistent(rig.world)
    mesh.mass = 0
    mesh.move_to(place)
    assert mesh in body.geoms
    with pytest.raises(oo.FieldError, match=r"Trimesh 'open'"):
        mesh.mass = 5.0
    assert mesh.mass == 0


def test_a_body_with_an_open_part_does_not_enter():
    world = oo.World()
    body = oo.Body(position=(1, 2, 3), enabled=False, name="body")
    body.attach(oo.Placeable()).attach(oo.Trimesh(OPEN, name="open"))
    before = photo(world, body)
    with pytest.raises(oo.FieldError, match=r"Trimesh 'open'"):
        world.attach(body)
    assert_photos_agree(before, photo(world, body))


def test_a_change_that_the_body_can_not_follow_is_taken_back():
    """Two parts of 9e14 kg are more than a body may have."""
    world = oo.World()
    body = world.attach(oo.Body(name="body"))
    place = body.attach(oo.Placeable())
    place.attach(oo.Box(mass=9e14))
    other = place.attach(oo.Box((1, 2, 3), mass=1.0, name="other"))
    before = photo(world)
    with pytest.raises(oo.FieldError, match="mass"):
        other.mass = 9e14
    with pytest.raises(oo.FieldError, match="mass"):
        place.attach(oo.Box(mass=9e14))
    with pytest.raises(oo.FieldError, match="mass"):
        body.fixed_mass = oo.Mass(-1)
    with pytest.raises(oo.FieldError, match="density"):
        other.density = 5.0
    with pytest.raises(oo.FieldError, match="mass"):
        other.mass = 1e-14
    assert_photos_agree(before, photo(world))
    world.step()


# -- moving house


def test_moving_within_a_world_destroys_nothing():
    """The natives are the same, the state is the same bits, and the joints go on holding."""
    rig = Rig()
    rig.world.step(3)
    natives = {id(node): node._id for node in rig.world.walk() if isinstance(node, oo.Body | oo.Geom | oo.Space)}
    joints = [joint._id for joint in rig.joints]
    for body in rig.bodies:
        for parent in (*rig.parents, rig.tree, body.parent):
            before = photo(rig.world)
            moved = {id(body), id(body.parent), id(parent)}
            body.move_to(parent)
            assert body.parent is parent
            assert parent.children[-1] is body
            assert all(geom.space is body.space for geom in body.geoms)
            after = photo(rig.world)
            for key in list(before):
                if key[0] in moved and key[1] in ("parents", "children"):
                    del before[key], after[key]
            assert_photos_agree(before, after)
            is_consistent(rig.world)
            rig.world.step()
    assert natives == {
        id(node): node._id for node in rig.world.walk() if isinstance(node, oo.Body | oo.Geom | oo.Space)
    }
    assert joints == [joint._id for joint in rig.joints]


def test_moving_takes_the_geoms_to_the_other_space():
    """They meet what is in the new space, and no longer what is in the old one."""
    world = oo.World(gravity=(0, 0, 0))
    spaces = [world.attach(cls()) for cls in (oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace)]
    for space in spaces:
        world.collide(space)
        space.attach(oo.Sphere(0.5, name=f"of {type(space).__name__}"))
    body = spaces[0].attach(oo.Body(position=(0.7, 0, 0)))
    body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    for _ in range(2):
        for space in spaces:
            body.move_to(space)
            body.position = (0.7, 0, 0)
            world.step()
            rows = world.contacts
            names = {world.geom_of_slot(slot).name for row in rows for slot in (row["slot1"], row["slot2"])}
            assert f"of {type(space).__name__}" in names
            assert len(names) == 2
    body.move_to(world)
    body.position = (0.7, 0, 0)
    world.step()
    assert len(world.contacts) == 0


def test_a_part_can_move_to_another_body():
    """It is fastened to the new body, counts there, and no longer moves with the old one."""
    world = oo.World(gravity=(0, 0, 0))
    first = world.attach(oo.Body(name="first"))
    second = world.attach(oo.Body(position=(5, 0, 0)))
    there = second.attach(oo.Placeable(position=(0, 1, 0)))
    first.attach(oo.Placeable()).attach(oo.Box(mass=1.0))
    place = first.attach(oo.Placeable(position=(2, 0, 0)))
    part = place.attach(oo.Sphere(0.5, mass=3.0))
    assert first.centre_of_mass == (1.5, 0, 0)
    part.move_to(there)
    assert first.centre_of_mass == (0, 0, 0)
    assert (first.mass, second.mass, second.centre_of_mass) == (1.0, 3.0, (0, 1, 0))
    assert part.bounds == ((4.5, 0.5, -0.5), (5.5, 1.5, 0.5))
    first.linear_velocity = (1, 0, 0)
    second.linear_velocity = (0, 0, 2)
    world.run(1.0)
    assert part.bounds[0] == pytest.approx((4.5, 0.5, 1.5), abs=1e-9)
    place.move_to(second)
    part.move_to(place)
    assert part.bounds[0] == pytest.approx((6.5, -0.5, 1.5), abs=1e-9)
    is_consistent(world)


def test_a_part_can_become_static_and_back():
    world = oo.World(gravity=(0, 0, 0))
    space = world.attach(oo.SimpleSpace())
    body = space.attach(oo.Body(position=(5, 0, 0), linear_velocity=(1, 0, 0)))
    place = body.attach(oo.Placeable(position=(0, 1, 0)))
    part = place.attach(oo.Sphere(0.5, mass=3.0))
    place.move_to(space)
    assert part.body is None
    assert part.bounds == ((-0.5, 0.5, -0.5), (0.5, 1.5, 0.5))
    world.run(1.0)
    assert part.bounds == ((-0.5, 0.5, -0.5), (0.5, 1.5, 0.5))
    assert body.position.x == pytest.approx(6.0)
    place.move_to(body)
    assert part.bounds[0] == pytest.approx((5.5, 0.5, -0.5))
    assert body.centre_of_mass == (0, 1, 0)


def test_moving_to_another_world_takes_state_and_joints_along():
    """Joints whose bodies both move come along; the others are not live, and are again when the body is back."""
    rig, other = Rig(), oo.World(name="other")
    space = other.attach(oo.HashSpace())
    rig.world.step(5)
    hinge, ball, _ = rig.joints
    both = photo(rig.hash)
    angle, anchor, axis = hinge.angle, hinge.anchor, hinge.axis
    rig.hash.move_to(space)
    assert hinge.world is other
    assert not ball.is_live
    assert hinge.angle == pytest.approx(angle, abs=1e-9)
    assert tuple(hinge.anchor) == pytest.approx(tuple(anchor), abs=1e-9)
    assert tuple(hinge.axis) == pytest.approx(tuple(axis), abs=1e-9)
    after = photo(rig.hash)
    for key in list(both):
        if key[1] in ("parents", "world", "live") or key[0] == id(ball):
            del both[key], after[key]
    assert_photos_agree(both, after, 1e-13)
    is_consistent(rig.world)
    is_consistent(other)
    other.step(5)
    rig.hash.move_to(rig.world)
    assert ball.world is hinge.world is rig.world
    rig.world.step(5)


def test_moving_out_of_every_world_is_detaching():
    rig = Rig()
    loose = oo.SimpleSpace()
    rig.bodies[0].move_to(loose)
    assert not rig.bodies[0].is_live
    assert loose.children == (rig.bodies[0],)
    rig.bodies[0].move_to(rig.hash)
    assert rig.bodies[0].is_live
    is_consistent(rig.world)


# -- copies


def test_a_copy_of_a_subtree_is_a_tree_of_its_own():
    rig = Rig()
    model = rig.bodies[0].attach(oo.Leaf([], name="seen"))
    twin = rig.bodies[0].copy()
    assert not twin.is_live
    assert [type(node) for node in twin.walk()] == [type(node) for node in rig.bodies[0].walk()]
    assert twin.find("seen") is model
    assert all(node not in list(rig.world.walk()) for node in twin.walk() if isinstance(node, oo.PhysicsNode))
    assert twin.joints == ()
    assert twin.mass_properties == rig.bodies[0].mass_properties
    rig.world.attach(twin)
    is_consistent(rig.world)
    rig.world.step()


def test_a_world_can_not_be_copied():
    with pytest.raises(oo.StateError, match=r"World 'it' can't be copied"):
        oo.World(name="it").copy()


class Crate(oo.Body):
    """A subclass whose ``__init__`` takes other arguments and builds its own parts."""

    made = 0

    def __init__(self, edge):
        super().__init__(name="crate")
        Crate.made += 1
        self.attach(oo.Placeable()).attach(oo.Box((edge, edge, edge), mass=edge))


def test_a_subclass_is_copied_without_running_its_init():
    Crate.made = 0
    twin = Crate(0.5).copy()
    assert type(twin) is Crate
    assert Crate.made == 1
    assert len(twin.geoms) == 1
    world = oo.World()
    world.attach(twin)
    assert twin.mass == 0.5
    world.step()


# -- the end of a World


def alive():
    gc.collect()
    return oo.live_natives()[:6]


def test_dropping_the_root_frees_everything():
    rig = Rig()
    assert alive() == (1, 4, 25, 4, 3, 8)
    del rig
    assert alive() == (0,) * 6


@pytest.mark.parametrize("held", ["body", "geom", "placeable", "space", "joint", "plane"])
def test_what_is_held_when_the_world_goes_becomes_plain_data(held):
    """It shows its last state, can be asked anything, and can enter another World."""
    rig = Rig()
    rig.world.step(3)
    node = {
        "body": rig.bodies[0],
        "geom": rig.bodies[1].geoms[0],
        "placeable": rig.bodies[2].children[0],
        "space": rig.hash,
        "joint": rig.joints[0],
        "plane": rig.ground,
    }[held]
    before = {name: getattr(node, name) for name in node.FIELDS if type(node.FIELDS[name]).__name__ == "Field"}
    below = [part for part in node.walk() if isinstance(part, oo.PhysicsNode)] if held != "joint" else []
    del rig
    assert alive() == (0,) * 6
    assert not node.is_live
    assert node.world is None
    assert {name: getattr(node, name) for name in before} == before
    assert not any(part.is_live for part in below)
    if held != "joint":
        assert node.parent is None
    world = oo.World()
    home = world.attach(oo.SimpleSpace())
    if held == "joint":
        for body in (node.body1, node.body2):
            home.attach(body)
    elif held == "geom":
        home.attach(oo.Placeable()).attach(node)
    else:
        home.attach(node)
    assert node.is_live
    world.step()


@pytest.mark.parametrize("threshold", [1, 700])
@pytest.mark.parametrize("seed", range(4))
def test_no_order_of_drops_and_no_moment_of_collection_matters(seed, threshold):
    """References go in a drawn order, with a collection at every chance (``gc.set_threshold(1)``)."""
    import random

    draw = random.Random(seed)
    before = gc.get_threshold()
    gc.set_threshold(threshold)
    try:
        rig, other = Rig(), Rig()
        rig.bodies[0].move_to(other.hash)
        other.world.me = other.world  # only the collector finds it
        held = [rig.world, other.world, *rig.bodies, *other.bodies, *rig.joints, *other.joints, rig.hash, other.tree]
        held += [geom for body in rig.bodies for geom in body.geoms]
        rig.world.step()
        other.world.step()
        del rig, other
        draw.shuffle(held)
        while held:
            node = held.pop()
            if isinstance(node, oo.Body) and node.is_live and draw.random() < 0.5:
                node.parent.detach(node)
            if isinstance(node, oo.Joint) and draw.random() < 0.5:
                node.release()
        del node
    finally:
        gc.set_threshold(*before)
    assert alive() == (0,) * 6


def test_a_world_in_a_circle_is_collected():
    world = oo.World()
    world.me = [world]
    body = world.attach(oo.Body(position=(1, 2, 3)))
    ref = weakref.ref(world)
    del world
    assert body.is_live
    assert alive() == (0,) * 6
    assert ref() is None
    assert not body.is_live
    assert body.position == (1, 2, 3)


@pytest.mark.parametrize("how", ["listener", "attribute", "update", "geom listener"])
def test_a_node_that_knows_its_world_does_not_keep_it(how):
    """A listener that uses the World, or a subclass that remembers it, is an ordinary circle."""

    def build():
        rig = Rig()
        rig.world.collide(rig.simple)
        if how == "listener":
            rig.bodies[0].on_touch(lambda touch: rig.world.detach(touch.body))
        elif how == "geom listener":
            rig.ground.on_touch(lambda touch: repr(rig.world))
        elif how == "attribute":
            rig.bodies[0].game = rig
        else:
            rig.bodies[0].on_update(lambda node: repr(rig.world))
        return rig.bodies[3]

    body = build()
    assert alive() == (0,) * 6
    assert not body.is_live


def test_what_left_in_a_step_does_not_keep_the_world_either():
    """A node that listened and was detached is remembered until its end is told, but no longer than the World lives."""

    def build():
        world = oo.World()
        space = world.attach(oo.SimpleSpace())
        world.collide(space)
        space.attach(oo.Plane())
        body = space.attach(oo.Body(position=(0, 0.4, 0)))
        body.attach(oo.Placeable()).attach(oo.Sphere())
        body.on_touch(lambda touch: space.detach(body) and world)
        world.step()
        assert not body.is_live

    build()
    assert alive() == (0,) * 6


def test_a_world_under_a_visual_group_goes_with_it():
    root = oo.Group()
    world = root.attach(oo.World())
    body = world.attach(oo.Body())
    del world
    gc.collect()
    assert body.is_live
    assert body.world.parent is root
    root.detach(body.world)
    gc.collect()
    assert not body.is_live


def test_parents_do_not_keep_children_and_children_no_parents():
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    body = space.attach(oo.Body())
    refs = [weakref.ref(node) for node in (space, body)]
    world.detach(space)
    del space
    gc.collect()
    assert refs[0]() is None
    assert body.parent is None
    del body
    assert refs[1]() is None


class Mourner(oo.Body):
    """Asks itself for its position when it is collected."""

    heard: ClassVar[list] = []

    def __del__(self):
        try:
            Mourner.heard.append(self.position)
        except oo.StateError as error:
            Mourner.heard.append(error)


def test_a_node_with_a_del_of_its_own_reaches_no_freed_native():
    """In a circle with its World it is asked only after the World has gone: that is an error, not a crash."""
    Mourner.heard.clear()

    def build():
        world = oo.World()
        world.attach(Mourner(position=(1, 2, 3))).world_of_mine = world
        world.attach(Mourner(position=(4, 5, 6)))

    build()
    gc.collect()
    assert len(Mourner.heard) == 2
    assert all(isinstance(heard, oo.StateError) or len(heard) == 3 for heard in Mourner.heard)
    Mourner.heard.clear()


EXITS = {
    "a World at the top": "world = oo.World(); body = world.attach(oo.Body())",
    "a World in a circle": "world = oo.World(); world.me = world; body = world.attach(oo.Body())",
    "a held leaf": "world = oo.World(); body = world.attach(oo.Body()); del world",
    "a World stepping in another thread": (
        "import threading, time; world = oo.World(); world.attach(oo.Body())\n"
        "threading.Thread(target=world.step, args=(100_000_000,), daemon=True).start(); time.sleep(0.05)"
    ),
    "an error": "world = oo.World(); body = world.attach(oo.Body()); hold = [world, body]",
}


@pytest.mark.parametrize("how", EXITS)
def test_the_process_ends_well(how):
    """Whatever exists at the end, the exit code is 0 and nothing is printed."""
    code = f"import osgode as oo\n{EXITS[how]}\n"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
