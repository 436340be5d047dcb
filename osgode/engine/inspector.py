"""The inspector: what there is to know of a node, as lines of text."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from textwrap import wrap
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from osgode.errors import FieldError, shown
from osgode.fields import whole
from osgode.graph.node import Node
from osgode.joints.base import Joint
from osgode.joints.spots import Coordinate
from osgode.maths import Quat, Vec3
from osgode.nodes.base import nearest_body
from osgode.nodes.body import Body
from osgode.nodes.geom import Geom
from osgode.nodes.heightdata import HeightData
from osgode.nodes.hit import Hit, Sweep
from osgode.nodes.meshdata import MeshData
from osgode.nodes.plane import Plane
from osgode.nodes.ray import Ray
from osgode.nodes.spaces import Space
from osgode.nodes.world import World

MOST = 4
"""Joints, and things touched, that are told one by one."""
NO_RESPONSE = 0x7FFFFFFF
"""As the ``surface`` of a row of `World.contacts`: the hit of a ray."""


@runtime_checkable
class ShowsNode(Protocol):
    """What was picked in a picture: it knows its node."""

    @property
    def node(self) -> Node:
        """What was picked."""


Inspected: TypeAlias = Node | Joint | Hit | Sweep | ShowsNode


def inspect(what: Inspected, *, width: int | None = None) -> str:
    """What there is to know of a node now, one thing a line: for a text in the overlay, a log, a prompt.

    Where it stands, what it is, pose, velocities, mass, whether it sleeps, what it is made of, what it touches and how
    deep, and by what joints it is held, with their angles and errors.

    Args:
        what: a node, a joint, the hit of a ray or sweep (also a `Ray`'s), or what was picked in a picture.
        width: letters in a line: longer lines are broken, and go on indented; None for as long as they are.

    Raises:
        FieldError: for anything else, and a width below 20.
    """
    lines = _lines(what)
    if width is not None:
        columns = whole(20, 10_000)("inspect()", "width", width)
        lines = [part for line in lines for part in _broken(line, columns)]
    return "\n".join(lines)


def _lines(what: Inspected) -> list[str]:
    if isinstance(what, Hit | Sweep):
        where = f"at {_vector(what.point if isinstance(what, Hit) else what.position)} m"
        away = f", {what.distance:.3g} m away" if isinstance(what, Hit) else f", after {what.fraction:.1%} of the way"
        return [*_node(what.geom), where + away]
    if isinstance(what, Joint):
        return [_joint(what, None)]
    node = what.node if isinstance(what, ShowsNode) else what
    if not isinstance(node, Node):
        raise FieldError(f"inspect().what is {shown(what)}; it must be a node, a joint, or a hit")
    return _node(node)


def yaw_pitch_roll(rotation: Quat) -> tuple[float, float, float]:
    """The angles in radians for which `Quat.from_yaw_pitch_roll` gives ``rotation``.

    Read from the elements of Ry(yaw) Rx(pitch) Rz(roll). Straight up or down, where yaw and roll are one, yaw is 0.
    """
    (a, b, c), (d, e, f), (_, _, g) = rotation.to_matrix()
    pitch = math.asin(max(-1.0, min(1.0, -f)))
    if math.hypot(c, g) < 1e-6:
        return 0.0, pitch, math.atan2(-b, a)
    return math.atan2(c, g), pitch, math.atan2(d, e)


# -- nodes


def _node(node: Node) -> list[str]:
    lines = [node.path, _kind(node)]
    body = nearest_body(node) or next((above for above in node.ancestors if isinstance(above, Body)), None)
    if isinstance(node, Geom):
        lines.append(_made_of(node))
    if body is not None:
        lines += _body(body, is_itself=body is node)
    elif isinstance(node, World):
        lines += _world(node)
    elif isinstance(node, Space):
        geoms = [each for each in node.walk() if isinstance(each, Geom)]
        bodies = {id(geom.body) for geom in geoms if geom.body is not None}
        lines.append(f"{_count(len(bodies), 'body', 'bodies')}, {_count(len(geoms), 'geom')}")
    elif isinstance(node, Plane):
        lines.append(f"normal {_vector(node.normal)}, offset {node.offset:.3g} m")
    elif (pose := getattr(node, "pose", None)) is not None:
        lines.append(_pose(pose.position, pose.rotation))
    if isinstance(node, Ray):
        lines.append(_ray(node))
    elif isinstance(node, Geom | Body) and node.world is not None:
        lines += _contacts(node, node.world)
    if body is not None:
        lines += _joints(body)
    return lines


def _kind(node: Node) -> str:
    words = [type(node).__name__]
    if isinstance(node, Geom):
        names = [name for name in ("size", "radius", "length") if name in node.FIELDS]
        words += [f"{name} {_size(getattr(node, name))} m" for name in names]
    data = getattr(node, "data", None)
    if isinstance(data, MeshData):
        words.append(_count(len(data.triangles), "triangle"))
    elif isinstance(data, HeightData):
        words.append("{} x {} samples".format(*data.shape))
    if isinstance(node, Body):
        words.append(_count(sum(isinstance(each, Geom) for each in node.walk()), "geom"))
    if not node.visible:
        words.append("hidden")
    return ", ".join(words)


def _made_of(geom: Geom) -> str:
    words = [f"material {geom.material}", f"kind {geom.kind}"]
    if geom.collides_with is not None:
        words.append("meets " + (", ".join(sorted(geom.collides_with)) or "nothing"))
    if geom.surface is not None:
        words.append(f"own friction {geom.surface.friction:g}")
    words += [word for word, said in (("sensor", geom.sensor), ("disabled", not geom.enabled)) if said]
    return ", ".join(words) + (", static" if geom.body is None else "")


def _body(body: Body, *, is_itself: bool) -> list[str]:
    lines = [] if is_itself else [f"of {body.describe()}"]
    lines.append(_pose(body.position, body.rotation))
    linear, angular = body.linear_velocity, body.angular_velocity
    lines.append(f"velocity {_vector(linear)} = {linear.length:.3f} m/s, turning {angular.length:.3f} rad/s")
    state = "kinematic" if body.kinematic else "asleep" if body.asleep else "awake"
    centre = body.centre_of_mass
    off = f", centre of mass {_vector(centre)}" if centre.length > 1e-6 else ""
    lines.append(f"mass {body.mass:.4g} kg{off}, {state}" + ("" if body.is_live else ", in no World"))
    return lines


def _world(world: World) -> list[str]:
    awake = int((world.body_states["asleep"] == 0).sum())
    things = (
        _count(len(world.bodies), "body", "bodies") + f" ({awake} awake)",
        _count(len(world.joints), "joint"),
        _count(len(world.contacts), "contact"),
    )
    return [f"step {world.steps}, {world.time:.2f} s, step size {world.step_size:.4g} s", ", ".join(things)]


def _ray(ray: Ray) -> str:
    hits = ray.hits
    if not hits:
        return "meets nothing"
    more = f" and {len(hits) - 1} more" if len(hits) > 1 else ""
    return f"meets {_called(hits[0].geom)} at {hits[0].distance:.3g} m{more}"


# -- what it touches


def _contacts(node: Geom | Body, world: World) -> list[str]:
    geoms = [node] if isinstance(node, Geom) else [each for each in node.walk() if isinstance(each, Geom)]
    mine = {geom._slot: geom for geom in geoms}
    rows = world.contacts
    rows = rows[rows["surface"] != NO_RESPONSE]
    own = np.array(list(mine), np.int64)
    first, second = np.isin(rows["slot1"], own), np.isin(rows["slot2"], own)
    rows, first = rows[first | second], first[first | second]
    if not len(rows):
        return ["touches nothing" + (", or what it touches sleeps too" if _sleeps(node) else "")]
    slots = np.stack([rows["slot1"], rows["slot2"]], axis=1)
    slots[~first] = slots[~first, ::-1]
    deepest = float(rows["geom"]["depth"].max())
    pairs = Counter(map(tuple, slots.tolist()))
    lines = [f"{_count(len(rows), 'contact')}, deepest {1e3 * deepest:.3f} mm"]
    for (slot, other), count in pairs.most_common(MOST):
        geom = world.geom_of_slot(other)
        if isinstance(geom, Geom):
            lines.append(f"  {count} with {_called(geom)}: {geom.material}, friction {_friction(mine[slot], geom):g}")
    return _cut(lines, len(pairs), "more")


def _friction(one: Geom, other: Geom) -> float:
    """That of the surface which counts for two geoms, unless a listener gives them another."""
    own = [geom.surface.friction for geom in (one, other) if geom.surface is not None]
    if own or one.world is None:
        return min(own, default=math.nan)
    return one.world.surfaces[one.material, other.material].friction


def _sleeps(node: Geom | Body) -> bool:
    body = node.body
    return body is not None and body.asleep


def _called(geom: Geom) -> str:
    body = geom.body
    return geom.describe() if body is None else f"{geom.describe()} of {body.describe()}"


# -- what holds it


def _joints(body: Body) -> list[str]:
    joints = body.joints
    lines = [_count(len(joints), "joint")] if joints else []
    return _cut(lines + ["  " + _joint(joint, body) for joint in joints[:MOST]], len(joints), "more")


def _joint(joint: Joint, seen_from: Body | None) -> str:
    others = [body for body in (joint.body1, joint.body2) if body is not seen_from or body is None]
    names = " and ".join("the static world" if body is None else body.describe() for body in others)
    words = [f"{joint.describe()} {'with' if seen_from is not None else 'of'} {names}"]
    if not joint.is_live:
        return words[0] + (", broken" if joint.broken else ", released" if joint.released else ", not live")
    values = [(f"{name} {_coordinate(getattr(joint, name), unit)}", unit) for name, unit in _coordinates(type(joint))]
    for k, (value, unit) in enumerate(values):
        same_follows = k + 1 < len(values) and values[k + 1][1] == unit
        words.append(value if same_follows else f"{value} {'deg' if unit == 'rad' else unit}")
    if not joint.enabled:
        words.append("disabled")
    if joint.error > 1e-9:
        words.append(f"error {1e3 * joint.error:.3f} mm")
    if joint.angular_error > 1e-6:
        words.append(f"{math.degrees(joint.angular_error):.2g} deg off")
    return ", ".join(words)


def _coordinates(kind: type[Joint]) -> Iterable[tuple[str, str]]:
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        for name, value in vars(base).items():
            if isinstance(value, Coordinate) and value.row == "position":
                found[name] = value.unit
    return found.items()


def _coordinate(value: float, unit: str) -> str:
    return f"{math.degrees(value):.1f}" if unit == "rad" else f"{value:.3f}"


# -- words


def _broken(line: str, columns: int) -> list[str]:
    indent = " " * (len(line) - len(line.lstrip()))
    return wrap(line, columns, subsequent_indent=indent + "    ", break_on_hyphens=False)


def _cut(lines: list[str], count: int, word: str) -> list[str]:
    return lines if count <= MOST else [*lines, f"  and {count - MOST} {word}"]


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"


def _pose(position: Vec3, rotation: Quat) -> str:
    angles = ", ".join(
        f"{name} {round(math.degrees(angle)) + 0}"
        for name, angle in zip(("yaw", "pitch", "roll"), yaw_pitch_roll(rotation), strict=True)
    )
    return f"position {_vector(position)} m, {angles} deg"


def _vector(value: Iterable[float]) -> str:
    return "(" + ", ".join(f"{round(part, 2) + 0.0:.2f}" for part in value) + ")"


def _size(value: Any) -> str:
    parts = value if isinstance(value, tuple) else (value,)
    return " x ".join(f"{part:.3g}" for part in parts)
