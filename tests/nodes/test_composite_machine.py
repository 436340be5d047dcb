"""B7 and B8: whatever comes, goes, moves and changes in a body, the sum is right and what should stay stays.

One machine for each kind of joint, which holds the body while its mass is kept in the books.
"""

import math
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

import osgode as oo
from osgode.native import ffi, lib
from tests.nodes.test_body import native_mass, numpy_mass
from tests.strategies import geoms, poses, sizes, vectors

KINDS = {
    "ball": (oo.Ball, ("anchor",)),
    "hinge": (oo.Hinge, ("anchor", "axis")),
    "slider": (oo.Slider, ("axis",)),
    "fixed": (oo.Fixed, ()),
    "universal": (oo.Universal, ("anchor",)),
    "hinge2": (oo.Hinge2, ("anchor",)),
    "euler": (oo.AngularMotor, ("axes", "mode")),
    "linear": (oo.LinearMotor, ()),
    "pr": (oo.PR, ("anchor",)),
    "pu": (oo.PU, ("anchor",)),
    "piston": (oo.Piston, ("anchor", "axis")),
    "rod": (oo.DoubleBall, ("anchor1", "anchor2")),
    "double_hinge": (oo.DoubleHinge, ("anchor1", "anchor2")),
}
"""Each kind of joint, and which of what is given below its constructor takes."""
READINGS = (
    *("anchor", "anchor1", "anchor2", "axis", "axis1", "axis2", "axis3", "axes", "angle", "angle1", "angle2", "angle3"),
    *("position", "compression", "length", "error", "angular_error"),
)
"""What a joint may tell of where it holds its bodies; a kind has some of them."""
MASSES = (oo.Mass(2.0, (0.5, 0, -0.25), ((1, 0.1, 0), (0.1, 2, 0), (0, 0, 2.5))), oo.Mass.sphere(0.5, mass=30.0))


def numbers(value):
    return np.ravel(np.array(value, dtype=float))


def close(one, other, tolerance=1e-8):
    return float(np.abs(numbers(one) - numbers(other)).max()) <= tolerance * (1 + float(np.abs(numbers(one)).max()))


def due_mass(body):
    """What should be in force when the body is recentred, by numpy."""
    if body.fixed_mass is not None:
        given = body.fixed_mass
        return given.mass, np.array(given.centre), np.array(given.inertia)
    if not any(geom.mass != 0.0 for geom in body.geoms):
        return 1.0, np.zeros(3), np.identity(3)
    return numpy_mass(body.geoms)


class Composite(RuleBasedStateMachine):
    """A body of parts that two joints hold, one to the world and one to another body, and two Worlds."""

    kind = "ball"

    @initialize(pose=poses(), velocity=vectors(3), spin=vectors(2))
    def start(self, pose, velocity, spin):
        self.worlds = [oo.World(gravity=(0, 0, 0)) for _ in range(2)]
        self.spaces = [world.attach(kind()) for world in self.worlds for kind in (oo.SimpleSpace, oo.HashSpace)]
        for world, space in zip(self.worlds, self.spaces[::2], strict=True):
            world.collide(space)
        self.home = self.spaces[0].attach(oo.SimpleSpace())
        self.body = self.home.attach(
            oo.Body(position=pose.position, rotation=pose.rotation, linear_velocity=velocity, angular_velocity=spin)
        )
        self.partner = self.home.attach(oo.Body(position=pose.transform((2, 0, 0)), angular_velocity=spin))
        self.partner.attach(oo.Placeable()).attach(oo.Box((0.5, 0.6, 0.7), mass=2.0))
        cls, takes = KINDS[self.kind]
        anchor = pose.transform((1, 0, 0))
        held = {
            "anchor": anchor,
            "axis": (0, 1, 1),
            "anchor1": anchor,
            "anchor2": anchor + oo.Vec3(0.3, 0.4, 0.0),
            "axes": [(1, 0, 0), (0, 0, 1)],
            "mode": "euler",
        }
        given = {name: held[name] for name in takes}
        pairs = ((self.body, None), (self.body, self.partner), (self.partner, self.body))
        if cls is oo.Hinge2:
            pairs = (pairs[1], pairs[2], pairs[2])
        self.joints = [cls(*pair, **given) for pair in pairs]
        self.joints[2].enabled = False  # two that hold the same may be at odds by rounding
        self.rest = [self.turn(joint) for joint in self.joints]
        self.places = []
        self.blocks = []
        self.force = due_mass(self.body)

    def teardown(self):
        while getattr(self, "blocks", []):
            self.leave_block()

    # -- what is looked at

    def held(self):
        """What the joints tell, by joint and name."""
        seen = {}
        for i, joint in enumerate(self.joints):
            for name in READINGS:
                try:
                    value = getattr(joint, name)
                except (AttributeError, oo.StateError):  # not of this kind, or only while it is live
                    continue
                seen[i, name] = math.cos(value) if name.startswith("angle") else value  # half a turn has two signs
        return seen

    @contextmanager
    def bookkeeping(self, *, changes=True):
        """Only the books change: what stays is the geometry, or in a block the centre of mass; and always the joints.

        Args:
            changes: whether the mass in force may change, if the body follows its parts.
        """
        body = self.body
        frame = body.pose, body.linear_velocity
        spin, centre, drift = body.angular_velocity, body.world_centre_of_mass, body.centre_of_mass_velocity
        held = self.held()
        yield
        if changes:
            self.force = due_mass(body)
        now = body.pose, body.linear_velocity
        assert close(now[0].rotation, frame[0].rotation)
        assert close(body.angular_velocity, spin)
        if self.blocks and changes:
            assert close(body.world_centre_of_mass, centre)
            assert close(body.centre_of_mass_velocity, drift)
        else:
            assert close(now[0].position, frame[0].position)
            assert close(now[1], frame[1])
        after = self.held()
        for i, name in held.keys() & after.keys():
            told = f"{self.joints[i]}.{name} was {held[i, name]}, is {after[i, name]}"
            assert close(after[i, name], held[i, name], self.tolerance(i, name)), told

    def turn(self, joint):
        other = oo.Quat(1, 0, 0, 0) if joint.body2 is None else joint.body2.rotation
        return other.conjugate() * joint.body1.rotation

    def tolerance(self, i, name):
        """A slider measures at some point of the body: where its bodies are twisted, against its will, that matters."""
        twist = (self.turn(self.joints[i]) * self.rest[i].conjugate()).angle
        return 1e-7 + 10 * twist if isinstance(self.joints[i], oo.Slider) and name in ("position", "error") else 1e-7

    def changing_parts(self):
        return self.bookkeeping(changes=self.body.auto_recentre)

    def place(self, data):
        return data.draw(st.sampled_from(self.places))

    # -- parts

    @rule(geom=geoms(), pose=poses(2), first=st.booleans())
    def add(self, geom, pose, first):
        """With its geom already, or empty at first."""
        place = oo.Placeable(position=pose.position, rotation=pose.rotation)
        with self.changing_parts():
            if first:
                place.attach(geom)
                self.body.attach(place)
            else:
                self.body.attach(place).attach(geom)
        self.places.append(place)

    @precondition(lambda self: self.places)
    @rule(data=st.data(), geom=geoms())
    def add_to_a_place(self, data, geom):
        with self.changing_parts():
            self.place(data).attach(geom)

    @precondition(lambda self: self.places)
    @rule(data=st.data())
    def take_away(self, data):
        place = self.place(data)
        self.places.remove(place)
        with self.changing_parts():
            self.body.detach(place)
        assert not place.is_live

    @precondition(lambda self: self.places)
    @rule(data=st.data(), pose=poses(2))
    def move(self, data, pose):
        place = self.place(data)
        with self.changing_parts():
            place.position, place.rotation = pose

    @precondition(lambda self: self.body.geoms)
    @rule(data=st.data(), value=st.sampled_from([0.0, 0.5, 4.0, None]))
    def weigh(self, data, value):
        geom = data.draw(st.sampled_from(self.body.geoms))
        with self.changing_parts():
            geom.density = None
            geom.mass = value

    @precondition(lambda self: self.body.geoms)
    @rule(data=st.data(), material=st.sampled_from(["wood", "steel", "ice", "default"]))
    def change_material(self, data, material):
        geom = data.draw(st.sampled_from(self.body.geoms))
        with self.changing_parts():
            geom.material = material

    @precondition(lambda self: self.body.geoms)
    @rule(data=st.data(), size=sizes())
    def resize(self, data, size):
        geom = data.draw(st.sampled_from(self.body.geoms))
        with self.changing_parts():
            for name, value in (("radius", size), ("length", size), ("size", (size, 2 * size, 0.5))):
                if name in geom.FIELDS:
                    setattr(geom, name, value)

    @precondition(lambda self: len(self.places) > 1 and self.body.geoms)
    @rule(data=st.data())
    def move_to_another_place(self, data):
        geom = data.draw(st.sampled_from(self.body.geoms))
        with self.changing_parts():
            geom.move_to(self.place(data))

    @precondition(lambda self: self.places)
    @rule(data=st.data())
    def move_only_in_the_books(self, data):
        """A part goes to another place with the same pose: not even the momenta change."""
        place, body = self.place(data), self.body
        before = body.momentum, body.angular_momentum, body.kinetic_energy
        with self.changing_parts():
            twin = body.attach(oo.Placeable(position=place.position, rotation=place.rotation))
            for geom in place.children:
                geom.move_to(twin)
            self.places[self.places.index(place)] = twin
            body.detach(place)
        for now, then in zip((body.momentum, body.angular_momentum, body.kinetic_energy), before, strict=True):
            assert close(now, then, 1e-7)

    # -- how the books are kept

    @rule(mass=st.sampled_from([None, *MASSES]))
    def fix_the_mass(self, mass):
        with self.bookkeeping():
            self.body.fixed_mass = mass

    @rule(follow=st.booleans())
    def switch(self, follow):
        with self.bookkeeping(changes=follow):
            self.body.auto_recentre = follow

    @rule()
    def recentre(self):
        with self.bookkeeping():
            self.body.recentre()

    @precondition(lambda self: len(self.blocks) < 2)
    @rule()
    def enter_block(self):
        with self.bookkeeping(changes=False):
            block = self.body.keeping_reference_point()
            block.__enter__()
        self.blocks.append(block)

    @precondition(lambda self: self.blocks)
    @rule()
    def leave_block(self):
        with self.bookkeeping(changes=False):
            self.blocks.pop().__exit__(None, None, None)

    # -- coming, going, moving

    @rule(data=st.data(), alone=st.booleans())
    def move_house(self, data, alone):
        """To any space: in the same World, in the other, in none; the body alone, or with its partner."""
        top = self.body if alone else self.home
        space = data.draw(st.sampled_from(self.spaces if top is self.home else [*self.spaces, self.home]))
        with self.bookkeeping(changes=False):
            top.move_to(space)

    @rule(alone=st.booleans())
    def come_and_go(self, alone):
        top = self.body if alone else self.home
        above = top.parent
        if above is not None:
            with self.bookkeeping(changes=False):
                above.detach(top)
                above.attach(top)

    @rule(alone=st.booleans())
    def go(self, alone):
        top = self.body if alone else self.home
        if top.parent is not None:
            with self.bookkeeping(changes=False):
                top.parent.detach(top)

    @rule(kinematic=st.booleans())
    def set_kinematic(self, kinematic):
        with self.bookkeeping(changes=False):
            self.body.kinematic = kinematic

    @rule(pose=poses(), velocity=vectors(3), spin=vectors(2))
    def put_elsewhere(self, pose, velocity, spin):
        body = self.body
        body.position, body.rotation = pose
        body.angular_velocity = spin
        body.centre_of_mass_velocity = velocity
        assert close(body.position, pose.position)
        assert close(body.centre_of_mass_velocity, velocity)
        assert close(body.angular_velocity, spin)

    @rule(count=st.integers(1, 3))
    def step(self, count):
        for world in self.worlds:
            world.step(count)

    @rule()
    def copy(self):
        """A copy has the same mass in force, the same frame, and no joints."""
        twin = self.body.copy()
        assert close(twin.mass, self.body.mass)
        assert close(twin.centre_of_mass, self.body.centre_of_mass)
        assert close(twin.inertia, self.body.inertia)
        assert close(twin.position, self.body.position)
        assert twin.auto_recentre == self.body.auto_recentre
        assert not twin.joints

    # -- what always holds

    @invariant()
    def what_is_in_force_is_known_and_is_what_ode_has(self):
        body = self.body
        total, centre, tensor = self.force
        scale = 1e-9 * float(np.trace(tensor))
        assert body.mass == pytest.approx(total)
        assert close(body.centre_of_mass, centre)
        assert body.inertia == pytest.approx(tensor, abs=scale)
        turn = np.array(body.rotation.to_matrix())
        assert close(body.world_centre_of_mass, np.array(body.position) + turn @ centre)
        assert body.world_inertia == pytest.approx(turn @ tensor @ turn.T, abs=10 * scale)
        assert close(body.momentum, total * np.array(body.centre_of_mass_velocity))
        if body.is_live:
            m, c, inertia = native_mass(body)
            assert (m, c) == (body.mass, [0, 0, 0])
            assert np.array_equal(np.reshape(inertia, (3, 3)), body.inertia)
            assert tuple(body._com) == tuple(body._realm.ptr.bodies[body._index].com) == body.centre_of_mass
            assert close(ffi.unpack(lib.dBodyGetPosition(body._id), 3), body.world_centre_of_mass)
            assert close(ffi.unpack(lib.dBodyGetLinearVel(body._id), 3), body.centre_of_mass_velocity)

    @invariant()
    def the_sum_of_the_parts_is_told(self):
        """Whether it is in force or not."""
        told = self.body.parts_mass
        if not any(geom.mass != 0.0 for geom in self.body.geoms):
            assert told is None
            return
        total, centre, tensor = numpy_mass(self.body.geoms)
        assert told.mass == pytest.approx(total)
        assert close(told.centre, centre)
        assert np.array(told.inertia) == pytest.approx(tensor, abs=1e-9 * float(np.trace(tensor)))

    @invariant()
    def every_geom_is_where_the_tree_says(self):
        for place in self.places:
            wanted = self.body.pose * place.pose
            for geom in place.children:
                assert close(geom.pose.position, wanted.position)
                if geom.is_live:
                    out = ffi.new("dQuaternion")
                    lib.dGeomGetQuaternion(geom._id, out)
                    assert close(ffi.unpack(lib.dGeomGetPosition(geom._id), 3), wanted.position)
                    assert abs(sum(a * b for a, b in zip(out, wanted.rotation, strict=True))) == pytest.approx(1.0)

    @invariant()
    def joints_are_live_where_their_bodies_are(self):
        for joint in self.joints:
            worlds = {id(body.world) for body in (joint.body1, joint.body2) if body is not None}
            assert joint.is_live == (len(worlds) == 1 and self.body.is_live)


for name in KINDS:
    test = type(f"Composite{name.title()}", (Composite,), {"kind": name}).TestCase
    test.settings = settings(
        max_examples=8, stateful_step_count=20, suppress_health_check=list(HealthCheck), report_multiple_bugs=False
    )
    globals()[f"TestComposite{name.title()}"] = test
    del test
