"""A machine that draws moves in two Worlds and compares every state with a simple model of what it should be."""

import gc

import numpy as np
import pytest
from hypothesis import assume, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

import osgode as oo
from osgode.native import LiveCounts
from tests.nodes.test_base import ALLOWED
from tests.nodes.test_body import numpy_mass
from tests.strategies import CUBE, MAKERS, Case, accepted, refused, same, vectors
from tests.trees import Rig, assert_photos_agree, is_consistent, photo

MOVED_BY_ODE = {"position", "rotation", "linear_velocity", "angular_velocity", "force", "torque", "enabled"}
"""Of a body: what the simulation changes, so that the model can't know it."""

OWN_TESTS = {"density", "auto_recentre"}
"""Which the model doesn't know: of two, one may be given; and masses that don't follow the parts."""

NEW = {
    "simple space": oo.SimpleSpace,
    "hash space": oo.HashSpace,
    "quadtree": lambda: oo.QuadTreeSpace(depth=2),
    "sweep and prune": oo.SweepAndPruneSpace,
    "body": lambda: Rig.make_body(1),
    "bare body": oo.Body,
    "placeable": lambda: oo.Placeable(position=(0.5, 1, 0)),
    "box": lambda: oo.Box((1, 0.5, 0.25)),
    "sphere": lambda: oo.Sphere(0.3, mass=1.5),
    "capsule": lambda: oo.Capsule(0.2, 0.4, density=200.0),
    "cylinder": lambda: oo.Cylinder(0.3, 0.5, material="ice"),
    "plane": lambda: oo.Plane((0, 1, 0), -50),
    "mesh": lambda: oo.Trimesh(CUBE, mass=2.0),
    "hull": lambda: oo.ConvexHull(CUBE, mass=2.0),
    "solid hull": lambda: oo.ConvexHull(CUBE, mass=2.0, solid=True),
    "terrain": lambda: oo.Heightfield([[0, 1, 0], [1, 0, 1]], (3, 2), mass=0),
    "ray": lambda: oo.Ray(3),
    "group": oo.Group,
}


def is_legal(child, parent):
    """By the table of test_base, written without the library's."""
    if not isinstance(parent, oo.Group) or type(parent).__name__ not in ALLOWED[type(child).__name__]:
        return False
    above = parent
    while above is not None:
        if above is child:
            return False
        above = above.parent
    return True


class Machine(RuleBasedStateMachine):
    """The model: who stands under whom in what order, the values that were set, the joints, the listeners."""

    @initialize()
    def start(self):
        gc.collect()
        self.before = oo.live_natives()  # not 0 while hypothesis holds the traceback of an example that failed
        self.rig, self.other = Rig(), oo.World(name="other", gravity=(0, 0, 0))
        self.rig.world.gravity = (0, 0, 0)
        self.rig.world.stop_colliding(self.rig.hash, self.rig.tree)  # one may be moved into the other
        self.worlds = [self.rig.world, self.other]
        for world in self.worlds:
            for cls in (oo.HashSpace, oo.SimpleSpace):
                world.collide(world.attach(cls()))
        self.children = {}
        self.known = {}
        self.loose = []
        self.joints = [(joint, joint.body1, joint.body2) for joint in self.rig.joints]
        self.heard = []
        for world in self.worlds:
            self.learn(world)

    # -- the model

    def learn(self, top):
        """Take a subtree that was just made into the model."""
        for node in top.walk():
            self.known[node] = {}
            if isinstance(node, oo.Group):
                self.children[node] = list(node.children)

    def parent_of(self, node):
        return next((group for group, some in self.children.items() if node in some), None)

    def root_of(self, node):
        while (above := self.parent_of(node)) is not None:
            node = above
        return node

    def below(self, node):
        yield node
        for child in self.children.get(node, ()):
            yield from self.below(child)

    def is_live(self, node):
        return isinstance(self.root_of(node), oo.World) and isinstance(node, oo.PhysicsNode)

    def forget(self, top):
        for node in list(self.below(top)):
            self.known.pop(node)
            self.children.pop(node, None)

    # -- legal moves

    def draw_node(self, data, *kinds):
        some = [node for node in self.known if isinstance(node, kinds)]
        assume(some)
        return data.draw(st.sampled_from(some))

    def draw_place(self, data, node):
        places = [group for group in self.children if is_legal(node, group)]
        return data.draw(st.sampled_from(places)) if places else None

    @rule(data=st.data(), what=st.sampled_from(sorted(NEW)))
    def make(self, data, what):
        """A new node, attached at once or kept loose."""
        node = NEW[what]()
        self.learn(node)
        place = self.draw_place(data, node)
        if place is not None and data.draw(st.booleans()):
            assert place.attach(node) is node
            self.children[place].append(node)
        else:
            self.loose.append(node)

    @precondition(lambda self: self.loose)
    @rule(data=st.data())
    def attach(self, data):
        node = data.draw(st.sampled_from(self.loose))
        place = self.draw_place(data, node)
        if place is not None:
            if isinstance(node, oo.PhysicsNode) and data.draw(st.booleans()):
                node.move_to(place)
            else:
                place.attach(node)
            self.children[place].append(node)
            self.loose.remove(node)

    @rule(data=st.data())
    def detach(self, data):
        node = data.draw(st.sampled_from([node for some in self.children.values() for node in some]))
        parent = self.parent_of(node)
        parent.detach(node)
        self.children[parent].remove(node)
        self.loose.append(node)

    @rule(data=st.data())
    def move(self, data):
        """To any legal place: in the same World, in the other, outside."""
        node = self.draw_node(data, oo.PhysicsNode)
        place = self.draw_place(data, node)
        if isinstance(node, oo.World) or place is None:
            return
        before = self.parent_of(node)
        stays = self.is_live(node) and self.root_of(place) is self.root_of(node)
        native = getattr(node, "_id", None)
        moving = {
            body: (body.position, body.rotation, body.linear_velocity, body.angular_velocity)
            for body in self.below(node)
            if isinstance(body, oo.Body)
        }
        assert node.move_to(place) is node
        if before is None:
            self.loose.remove(node)
        else:
            self.children[before].remove(node)
        self.children[place].append(node)
        if stays:
            assert getattr(node, "_id", None) is native or node._id == native
        for body, state in moving.items():
            now = (body.position, body.rotation, body.linear_velocity, body.angular_velocity)
            for one, two in zip(now, state, strict=True):
                assert one == pytest.approx(two, abs=1e-9, rel=1e-9)

    @rule(data=st.data())
    def set_field(self, data):
        """Any field of any node but the World, to a value that it takes."""
        node = self.draw_node(data, oo.PhysicsNode)
        names = [name for name in node.FIELDS if not (name in MOVED_BY_ODE and isinstance(node, oo.Body))]
        names = [name for name in names if name not in OWN_TESTS and not isinstance(node, oo.World)]
        if not names:
            return
        name = data.draw(st.sampled_from(names))
        value = data.draw(st.sampled_from(accepted(Case(type(node), name))))
        if node.FIELDS[name].fixed and self.is_live(node):
            with pytest.raises(oo.StateError):
                setattr(node, name, value)
            return
        if name == "mass" and (node.density is not None or isinstance(node, oo.Heightfield)):
            return
        if isinstance(node, oo.Plane) and name in ("normal", "offset"):
            return
        setattr(node, name, value)
        self.known[node][name] = value

    @rule(data=st.data(), where=vectors(3))
    def place_a_part(self, data, where):
        node = self.draw_node(data, oo.Placeable)
        node.position = where
        self.known[node]["position"] = where

    @rule(data=st.data(), velocity=vectors(2))
    def push(self, data, velocity):
        body = self.draw_node(data, oo.Body)
        body.linear_velocity = velocity
        body.angular_velocity = velocity
        assert body.linear_velocity == pytest.approx(velocity, abs=1e-9)

    @rule(data=st.data(), kind=st.sampled_from([oo.Ball, oo.Hinge, oo.Slider, oo.Fixed]))
    def join(self, data, kind):
        first = self.draw_node(data, oo.Body)
        second = data.draw(
            st.sampled_from([None, *(b for b in self.known if isinstance(b, oo.Body) and b is not first)])
        )
        self.joints.append((kind(first, second), first, second))

    @precondition(lambda self: self.joints)
    @rule(data=st.data())
    def release(self, data):
        entry = data.draw(st.sampled_from(self.joints))
        entry[0].release()
        self.joints.remove(entry)

    @rule(data=st.data())
    def listen(self, data):
        node = self.draw_node(data, oo.Body, oo.Geom)
        if node._touch_listeners:
            node.remove_on_touch(self.heard.append)
        else:
            node.on_touch(self.heard.append)

    @rule(count=st.integers(1, 3), which=st.integers(0, 1))
    def step(self, count, which):
        world = self.worlds[which]
        before = world.steps
        world.step(count)
        assert world.steps == before + count
        for touch in self.heard:
            assert touch.geom is not touch.other
        self.heard.clear()

    @rule(data=st.data())
    def copy(self, data):
        """The copy is equal and outside."""
        node = self.draw_node(data, oo.PhysicsNode)
        if isinstance(node, oo.World):
            return
        twin = node.copy()
        self.learn(twin)
        for ours, theirs in zip(twin.walk(), self.below(node), strict=True):
            self.known[ours] = dict(self.known[theirs])
            if not isinstance(ours, oo.PhysicsNode):  # shared, and known already
                assert ours is theirs
        if any(not isinstance(part, oo.PhysicsNode) for part in twin.walk()):
            self.forget_twin(twin)
        else:
            self.loose.append(twin)

    def forget_twin(self, twin):
        for node in twin.walk():
            if isinstance(node, oo.PhysicsNode):
                self.known.pop(node)
                self.children.pop(node, None)

    @precondition(lambda self: self.loose)
    @rule(data=st.data())
    def drop(self, data):
        """Nobody refers to a loose node any more; joints to bodies in it are held by the bodies alone."""
        node = data.draw(st.sampled_from(self.loose))
        gone = [body for body in self.below(node) if isinstance(body, oo.Body)]
        for entry in [entry for entry in self.joints if entry[1] in gone or entry[2] in gone]:
            entry[0].release()
            self.joints.remove(entry)
        self.loose.remove(node)
        self.forget(node)
        del node, gone
        gc.collect(0)

    # -- illegal moves

    @rule(data=st.data())
    def break_a_rule(self, data):
        """A place where a node must not stand: TreeError, and nothing has changed."""
        node = data.draw(st.sampled_from(list(self.known)))
        wrong = [group for group in self.children if not is_legal(node, group)]
        if isinstance(node, oo.PhysicsNode) and self.parent_of(node) is not None:
            wrong += [group for group in self.children if is_legal(node, group)]
        if not wrong:
            return
        place = data.draw(st.sampled_from(wrong))
        before = photo(*self.worlds, *self.loose)
        with pytest.raises(oo.TreeError) as caught:
            place.attach(node)
        assert node.describe() in str(caught.value)
        assert place.describe() in str(caught.value)
        if isinstance(node, oo.PhysicsNode) and not is_legal(node, place):
            with pytest.raises(oo.TreeError):
                node.move_to(place)
        assert_photos_agree(before, photo(*self.worlds, *self.loose))

    @rule(data=st.data())
    def detach_a_stranger(self, data):
        group = data.draw(st.sampled_from(list(self.children)))
        strangers = [node for node in self.known if node not in self.children[group]]
        node = data.draw(st.sampled_from(strangers))
        with pytest.raises(oo.TreeError):
            group.detach(node)

    @rule(data=st.data())
    def set_nonsense(self, data):
        node = self.draw_node(data, *MAKERS)
        if not node.FIELDS:
            return
        case = Case(type(node), data.draw(st.sampled_from(sorted(node.FIELDS))))
        before = photo(node)
        with pytest.raises(oo.FieldError):
            setattr(node, case.name, data.draw(st.sampled_from(refused(case))))
        assert_photos_agree(before, photo(node))

    # -- what always holds

    @invariant()
    def the_tree_is_the_model(self):
        for group, some in self.children.items():
            assert group.children == tuple(some)
        for node in self.known:
            above = self.parent_of(node)
            assert node.parents == (() if above is None else (above,))
            if isinstance(node, oo.PhysicsNode):
                assert node.is_live == self.is_live(node)
                assert node.world is (self.root_of(node) if self.is_live(node) else None)

    @invariant()
    def worlds_are_consistent(self):
        for world in self.worlds:
            is_consistent(world)

    @invariant()
    def values_are_as_set(self):
        for node, values in self.known.items():
            for name, value in values.items():
                assert same(getattr(node, name), value, 1e-12), (node, name)

    @invariant()
    def natives_are_counted(self):
        counts = LiveCounts(*(now - then for now, then in zip(oo.live_natives(), self.before, strict=True)))
        live = [node for node in self.known if self.is_live(node)]
        assert counts.worlds == 2
        assert counts.bodies == sum(isinstance(node, oo.Body) for node in live)
        assert counts.geoms == sum(isinstance(node, oo.Geom) for node in live)
        assert counts.spaces == sum(isinstance(node, oo.Space) for node in live)
        assert counts.joints == sum(joint.is_live for joint, _, _ in self.joints)
        meshes = {
            (id(node.data), id(node.world), type(node), getattr(node, "solid", False))
            for node in live
            if hasattr(node, "data")
        }
        assert counts.meshes == len(meshes)

    @invariant()
    def joints_are_live_where_their_bodies_meet(self):
        for joint, first, second in self.joints:
            worlds = {first.world, first.world if second is None else second.world}
            assert joint.world is (worlds.pop() if len(worlds) == 1 else None)
            assert joint in first.joints

    @invariant()
    def masses_are_sums(self):
        for body in self.known:
            parts = [geom for geom in self.below(body) if isinstance(geom, oo.Geom) and geom.mass != 0.0]
            parts = [geom for geom in parts if not isinstance(geom, oo.Ray)]
            if not isinstance(body, oo.Body) or body.fixed_mass is not None or not parts:
                continue
            assert set(body.geoms) >= set(parts)
            total, centre, inertia = numpy_mass(parts)
            assert body.mass == pytest.approx(total)
            assert tuple(body.centre_of_mass) == pytest.approx(tuple(centre), abs=1e-8)
            assert body.inertia == pytest.approx(inertia, abs=1e-8 * float(np.trace(inertia)))

    def teardown(self):
        self.__dict__.clear()


TestMachine = Machine.TestCase
TestMachine.settings = settings(max_examples=12, stateful_step_count=25)
