"""Trees to test on: a rig with some of everything, and photographs of a tree's whole state to compare."""

from typing import Any

import osgode as oo
from tests.strategies import CUBE, same


class Rig:
    """A World with several spaces, bodies of parts, static parts, and joints, nothing at its default."""

    def __init__(self) -> None:
        self.world = oo.World(name="world", gravity=(0.1, -9.7, 0.2))
        self.hash = self.world.attach(oo.HashSpace(name="hash", levels=(-1, 6)))
        self.sap = self.world.attach(oo.SweepAndPruneSpace(name="sap", axes="zxy"))
        self.tree = self.world.attach(oo.QuadTreeSpace(name="tree", depth=3, extent=(50, 40, 30)))
        self.simple = self.hash.attach(oo.SimpleSpace(name="simple"))
        self.world.collide(self.hash)
        self.world.collide(self.hash, self.tree)
        self.ground = self.tree.attach(oo.Plane((0, 2, 0.1), -3, name="ground", material="concrete"))
        self.bodies = [self.make_body(i) for i in range(4)]
        for i, (body, parent) in enumerate(zip(self.bodies, self.parents, strict=True)):
            parent.attach(body)
            body.angular_velocity = (0.25 * i, -0.5, 1.0)
        a, b, c, d = self.bodies
        self.joints = [
            oo.Hinge(a, b, anchor=(1, 2, 3), axis=(1, 2, -1), stops=(-2.5, 2.75), stop_bounce=0.25, name="hinge"),
            oo.Ball(b, c, anchor=(4, 2, 0), erp=0.5, name="ball"),
            oo.Slider(d, axis=(1, 1, 0), motor_velocity=0.5, motor_max_force=10.0, name="slider"),
        ]

    @property
    def parents(self) -> list[Any]:
        return [self.hash, self.simple, self.sap, self.world]

    @staticmethod
    def make_body(i: int) -> oo.Body:
        body = oo.Body(
            name=f"body {i}",
            position=(3.0 * i, 1.5, -0.25 * i),
            rotation=oo.Quat.from_axis_angle((1, i, 2), 0.5 + i),
            linear_velocity=(0.1 * i, 0.5, -1.0),
            gyroscopic=False,
            linear_damping=0.01,
        )
        geoms: list[oo.Geom] = [
            oo.Box((0.5, 1.0, 0.75), mass=2.0, material="wood", enabled=False, name=f"box {i}"),
            oo.Sphere(0.4, density=300.0, surface=oo.Surface(0.9), name=f"sphere {i}"),
            oo.Capsule(0.2, 0.6, mass=1.0, collides_with="default", name=f"capsule {i}"),
            oo.Trimesh(CUBE, mass=3.0, name=f"mesh {i}"),
            oo.ConvexHull(CUBE, mass=0.5, solid=bool(i % 2), name=f"hull {i}"),
            oo.Ray(2.0, reports="all", name=f"ray {i}"),
        ]
        for k, geom in enumerate(geoms):
            place = body.attach(oo.Placeable(name=f"place {i}{k}", position=(0.4 * k, 0.2 * i, 0.3)))
            place.rotation = oo.Quat.from_axis_angle((k, 1, 0), 0.7 * k)
            place.attach(geom)
        return body


def mass_of(body: oo.Body) -> oo.Mass | None:
    """The mass of a body, None if it can't be computed."""
    try:
        return body.mass_properties
    except oo.FieldError:
        return None


def photo(*tops: oo.Node) -> dict[tuple[int, str], Any]:
    """All that can be seen of the trees below ``tops`` and of their joints: where each stands, and every field."""
    seen: dict[tuple[int, str], Any] = {}
    joints: dict[int, oo.Joint] = {}
    for top in tops:
        for node in top.walk():
            seen[id(node), "parents"] = node.parents
            seen[id(node), "children"] = node.children if isinstance(node, oo.Group) else ()
            seen[id(node), "name"] = node.name
            if isinstance(node, oo.PhysicsNode):
                seen[id(node), "live"] = node.is_live
                seen[id(node), "world"] = node.world
                seen.update({(id(node), name): getattr(node, name) for name in node.FIELDS})
            if isinstance(node, oo.Body):
                seen[id(node), "joints"] = node.joints
                joints.update({id(joint): joint for joint in node.joints})
                seen[id(node), "mass"] = mass_of(node)
            if isinstance(node, oo.World):
                seen[id(node), "bodies"] = node.bodies
                seen[id(node), "poses"] = [tuple(map(float, row)) for row in node.poses]
            if isinstance(node, oo.Geom) and node.is_live:
                seen[id(node), "bounds"] = tuple(map(tuple, node.bounds))
    for joint in joints.values():
        seen[id(joint), "live"] = joint.is_live
        seen.update({(id(joint), name): getattr(joint, name) for name in joint.FIELDS})
        seen.update({(id(joint), name): v for name in ("anchor", "axis") if (v := getattr(joint, name, None))})
    return seen


def assert_photos_agree(before: dict[Any, Any], after: dict[Any, Any], tolerance: float = 0.0) -> None:
    """The same nodes with the same state, numbers within ``tolerance``."""
    assert before.keys() == after.keys()
    for key, value in before.items():
        name = before.get((key[0], "name"), "a joint")
        assert _alike(value, after[key], tolerance), f"{key[1]} of {name}: {value} became {after[key]}"


def _alike(one: Any, other: Any, tolerance: float) -> bool:
    if isinstance(one, list | tuple) and one and isinstance(one[0], tuple):
        return len(one) == len(other) and all(_alike(a, b, tolerance) for a, b in zip(one, other, strict=True))
    if isinstance(one, oo.Mass):
        return same(one.mass, other.mass, tolerance) and _alike(one.inertia, other.inertia, tolerance)
    return same(one, other, tolerance)


def is_consistent(world: oo.World) -> None:
    """The tree agrees with itself and with ODE: both ways, live below the World, bodies beside their poses."""
    nodes = [node for node in world.walk() if isinstance(node, oo.PhysicsNode)]
    assert len({id(node) for node in nodes}) == len(nodes)
    counts = {"bodies": 0, "geoms": 0, "spaces": 0}
    for node in nodes:
        if isinstance(node, oo.Group):
            for child in node.children:
                assert node in child.parents
                assert child.parents == (node,) or not isinstance(child, oo.PhysicsNode)
        assert node.is_live
        assert node.world is world
        counts["bodies"] += isinstance(node, oo.Body)
        counts["geoms"] += isinstance(node, oo.Geom)
        counts["spaces"] += isinstance(node, oo.Space)
    assert set(world.bodies) == {node for node in nodes if isinstance(node, oo.Body)}
    assert len(world.poses) == len(world.bodies) == counts["bodies"]
    assert set(world.joints) == {
        joint
        for body in world.bodies
        for joint in body.joints
        if joint.body2 is None or joint.body2.world is joint.body1.world
    }
    live = world._realm.ptr
    assert live.body_count == counts["bodies"]
    assert live.joint_count == len(world.joints)
