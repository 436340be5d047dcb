"""Listeners that detach, destroy, re-attach, add and move at random in the middle of steps, thousands of them."""

import random

import numpy as np
import pytest

import osgode as oo
from tests.trees import is_consistent

SHAPES = [
    lambda: oo.Sphere(0.3),
    lambda: oo.Box((0.5, 0.4, 0.6)),
    lambda: oo.Capsule(0.2, 0.4),
    lambda: oo.Cylinder(0.25, 0.5),
]


class Chaos:
    """A World in a box, and listeners on all its levels that change anything that they get hold of."""

    def __init__(self, seed, broad):
        self.draw = random.Random(seed)
        self.world = oo.World(broad_phase=broad, step_size=0.01, auto_disable=seed % 2 == 1)
        self.other = oo.World(gravity=(0, 0, 0))
        self.spaces = [self.world.attach(kind()) for kind in (oo.HashSpace, oo.SimpleSpace)]
        self.abroad = self.other.attach(oo.HashSpace())
        for space in self.spaces:
            self.world.collide(space)
        self.world.collide(*self.spaces)
        self.floor = self.spaces[1].attach(oo.Plane())
        for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            self.spaces[1].attach(oo.Plane((x, 0, z), -3))
        self.loose = []
        self.acts = self.told = 0
        self.open = {}
        for _ in range(14):
            self.add()
        self.world.on_touch(self.hear)
        self.spaces[0].on_collide(self.act)

    def add(self, _=None):
        if len(self.world.bodies) > 30:
            return
        body = oo.Body(position=tuple(self.draw.uniform(-2, 2) + 2 * (k == 1) for k in range(3)))
        for _ in range(self.draw.choice([1, 1, 2])):
            place = body.attach(oo.Placeable(position=tuple(self.draw.uniform(-0.3, 0.3) for _ in range(3))))
            place.attach(self.draw.choice(SHAPES)())
        self.draw.choice(self.spaces).attach(body)
        if self.draw.random() < 0.3:
            body.on_collide(self.act)
        if self.draw.random() < 0.3:
            body.on_touch(self.act)

    def hear(self, touch):
        """Begin, stay and end of a pair come in order, whatever happens in between."""
        self.told += 1
        key = (touch.geom, touch.other) if id(touch.geom) < id(touch.other) else (touch.other, touch.geom)
        if touch.begin:
            # a geom that left and came back within a step ends and begins in any order
            self.open[key] = self.open.get(key, 0) + 1
        elif touch.end:
            self.open[key] = self.open.get(key, 0) - 1
        assert np.isfinite(touch.points).all()
        assert np.isfinite(touch.normals).all()
        if self.draw.random() < 0.05:
            self.act(touch)

    def act(self, about):
        if self.draw.random() > 0.25:
            return
        self.acts += 1
        bodies = list(self.world.bodies)
        body = self.draw.choice([*bodies, about.body, about.other_body])
        verbs = [
            self.take, self.take, self.put_back, self.put_back, self.add, self.move, self.house, self.part, self.join,
            self.send, self.change, self.query, self.listen, self.destroy,
        ]  # fmt: skip
        self.draw.choice(verbs)(body if body is not None else about.geom)
        if isinstance(about, oo.CollisionFeedback):
            if self.draw.random() < 0.2:
                about.refuse()
            elif self.draw.random() < 0.3:
                about.set_surface(oo.Surface(self.draw.random(), bounce=self.draw.random()))
        if self.draw.random() < 0.03:
            raise LookupError("now and then")

    def take(self, node):
        if node.parent is not None and node is not self.floor:
            node.parent.detach(node)
            if isinstance(node, oo.Body):
                self.loose.append(node)

    def destroy(self, node):
        if node.parent is not None and isinstance(node, oo.Body):
            node.parent.detach(node)

    def put_back(self, _):
        if self.loose:
            body = self.loose.pop(self.draw.randrange(len(self.loose)))
            if body.parent is None:
                body.position = (0, 2, 0)
                body.linear_velocity = body.angular_velocity = (0, 0, 0)
                self.draw.choice(self.spaces).attach(body)

    def move(self, node):
        if isinstance(node, oo.Body):
            node.position = tuple(self.draw.uniform(-2, 2) + 2 * (k == 1) for k in range(3))
            node.linear_velocity = (0, 0, 0)

    def house(self, node):
        if isinstance(node, oo.Body) and node.is_live:
            node.move_to(self.draw.choice(self.spaces))

    def part(self, node):
        """A geom goes to another body, or becomes static for good."""
        bodies = [body for body in self.world.bodies if body.children]
        if isinstance(node, oo.Body) and node.geoms and bodies:
            node.geoms[0].move_to(self.draw.choice(bodies).children[0])

    def join(self, node):
        if isinstance(node, oo.Body) and node.is_live and len(node.joints) < 2:
            other = self.draw.choice([body for body in self.world.bodies if body is not node] or [None])
            joint = oo.Ball(node, other, anchor=node.position)
            joint.release() if self.draw.random() < 0.7 else None

    def send(self, node):
        """To the other World and back."""
        if isinstance(node, oo.Body) and node.is_live:
            home = node.parent
            node.move_to(self.abroad)
            if self.draw.random() < 0.7:
                node.move_to(home)
            else:
                self.abroad.detach(node)
                self.loose.append(node)

    def change(self, node):
        geoms = node.geoms if isinstance(node, oo.Body) else (node,)
        for geom in geoms:
            if geom is not self.floor and not isinstance(geom, oo.Plane):
                setattr(*self.draw.choice([
                    (geom, "enabled", self.draw.random() < 0.8), (geom, "sensor", self.draw.random() < 0.2),
                    (geom, "surface", oo.Surface(self.draw.random())), (geom, "surface_velocity", (0.1, 0, 0)),
                    (geom, "material", "ice"),
                ]))  # fmt: skip

    def query(self, node):
        self.world.cast_ray((0, 5, 0), (0, -1, 0), exclude=[node])
        self.world.overlaps(oo.Sphere(1), (0, 1, 0))

    def listen(self, node):
        if isinstance(node, oo.Body):
            node.on_collide(self.act)
            node.on_touch(self.act)
            if self.draw.random() < 0.6:
                node.remove_on_collide(self.act)
                node.remove_on_touch(self.act)


@pytest.mark.parametrize("broad", ["own", "ode"])
@pytest.mark.parametrize("seed", range(3))
def test_listeners_that_change_anything_at_random_leave_the_world_sound(seed, broad):
    """700 steps each: no crash, no leak (every test counts natives), the tree and ODE agree all the time."""
    chaos = Chaos(seed, broad)
    errors = 0
    for i in range(700):
        steps = chaos.world.steps
        try:
            chaos.world.step()
        except* LookupError:
            errors += 1
        assert chaos.world.steps == steps + 1
        if i % 20 == 0:
            is_consistent(chaos.world)
            assert np.isfinite(chaos.world.poses).all()
            for slot in np.unique(np.concatenate([chaos.world.contacts[name] for name in ("slot1", "slot2")])):
                assert chaos.world.geom_of_slot(int(slot)) is not None
        if len(chaos.world.bodies) < 6:
            chaos.add()
        for body in chaos.world.bodies:
            if body.position.length > 20 or body.linear_velocity.length > 50:
                body.parent.detach(body)
    assert chaos.acts > 100
    assert chaos.told > 1000
    assert errors > 3
    assert set(chaos.open.values()) <= {0, 1}
    assert chaos.world._realm.ptr.geom_count < 200
