"""Ragdolls: human bodies of fifteen segments, whose joints bend as far as ours do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple, TypeVar, Unpack

from osgode.assemblies.base import MASS, Assembly, CollisionFields, Joining, check_parent
from osgode.assemblies.figure import MIDDLE, MIDDLE_LINKS, SIDE_LINKS, SIDES, Link, Rod, Segment, Slab
from osgode.errors import FieldError, shown
from osgode.fields import POSITION_LIMIT, ROTATION, number, vector
from osgode.graph.appearance import Appearance
from osgode.joints.anchored import Anchored
from osgode.joints.ball import Ball
from osgode.joints.base import Joint
from osgode.joints.hinge import Hinge
from osgode.joints.limits import STRONGEST_AT_STOP
from osgode.joints.motors import AngularMotor
from osgode.joints.universal import Universal
from osgode.maths import IDENTITY, ZERO, Pose, Quat, QuatLike, Vec3, Vec3Like
from osgode.nodes.body import Body
from osgode.nodes.geom import Geom
from osgode.nodes.placeable import Placeable
from osgode.nodes.primitives import Box, Capsule
from osgode.nodes.spaces import SimpleSpace, Space
from osgode.nodes.world import World

LOOKS: Mapping[str, Appearance] = MappingProxyType(
    {
        "skin": Appearance((0.87, 0.68, 0.55, 1.0), shininess=0.1),
        "shirt": Appearance((0.75, 0.22, 0.18, 1.0), shininess=0.05),
        "trousers": Appearance((0.20, 0.27, 0.42, 1.0), shininess=0.05),
        "shoes": Appearance((0.14, 0.12, 0.11, 1.0), shininess=0.3),
    }
)
"""What a ragdoll wears unless it is told otherwise."""
WEIGHT = 9.81
"""N/kg, of which `Ragdoll.tone` is a part."""
RIGHT, LEFT = 1.0, -1.0


class Axis(NamedTuple):
    """One movement of a joint: which joint measures and stops it, by which of its numbered fields."""

    joint: Hinge | Universal | AngularMotor
    number: str
    low: float
    high: float


class Ragdoll(Assembly[Space]):
    """A human body, made by `ragdoll`: ``doll.body("left hand")``, ``doll.joint("neck")``, ``doll.angles``."""

    def __init__(
        self, space: Space, parts: Sequence[Body], joints: Sequence[Joint], axes: dict[str, dict[str, Axis]]
    ) -> None:
        super().__init__(space, parts, joints)
        self._axes = axes
        self._tone = 0.0
        self._moments = _moments(joints)

    # -- its joints

    @property
    def ranges(self) -> dict[str, dict[str, tuple[float, float]]]:
        """The stops of each movement of each joint, radians: ``ranges["left knee"]["flexion"]``."""
        return {
            joint: {movement: (axis.low, axis.high) for movement, axis in movements.items()}
            for joint, movements in self._axes.items()
        }

    @property
    def angles(self) -> dict[str, dict[str, float]]:
        """How far each joint is moved in each way from standing upright, radians.

        Raises:
            StateError: while it is in no World.
        """
        return {
            joint: {movement: getattr(axis.joint, f"angle{axis.number}") for movement, axis in movements.items()}
            for joint, movements in self._axes.items()
        }

    # -- limp or stiff

    @property
    def tone(self) -> float:
        """How much its joints resist being moved: 0 is limp, at 1 each could just hold what is beyond it straight out.

        It is dry friction, by a motor in each axis of the joint: at most ``tone * 9.81 m d``, where m is the mass
        beyond the joint and d how far that mass' centre is from it in an outstretched limb.
        """
        return self._tone

    @tone.setter
    def tone(self, value: float) -> None:
        most = min(1e6, STRONGEST_AT_STOP / max(self._moments.values()))
        part = number(0.0, most)(self.describe(), "tone", value)
        for name, movements in self._axes.items():
            for axis in movements.values():
                setattr(axis.joint, f"motor_max_force{axis.number}", part * self._moments[name])
        self._tone = part


def ragdoll(
    parent: Space | World,
    *,
    height: float = 1.8,
    mass: float = 75.0,
    position: Vec3Like = ZERO,
    rotation: QuatLike = IDENTITY,
    tone: float = 0.05,
    looks: Mapping[str, Appearance] | None = None,
    name: str = "ragdoll",
    **geom: Unpack[CollisionFields],
) -> Ragdoll:
    """Put up a human body that stands upright, looks along its -Z, and will fall.

    Its figures and their sources (Winter; Drillis and Contini; the AAOS) are in `osgode.assemblies.figure`.

    Parts: "pelvis", "torso", "head", and "left ..." and "right ..." "upper arm", "forearm", "hand", "thigh", "shank",
    "foot". Joints: "waist", "neck", and "shoulder", "elbow", "wrist", "hip", "knee", "ankle" of each side. Elbows and
    knees are hinges, wrists and ankles universal joints; the others are ball joints, each with an `AngularMotor` of the
    same name and " range" that stops them.

    Args:
        parent: the space, or World, that its own space is put under.
        height: metres.
        mass: kg.
        position: where it stands: the middle between its soles, in the world, metres.
        rotation: of the whole, about that point.
        tone: how much its joints resist, see `Ragdoll.tone`.
        looks: appearances instead of those of "skin", "shirt", "trousers", "shoes".
        name: of its space.
        **geom: of all its geoms: ``material``, ``kind``, ``collides_with``, ``surface``.

    Raises:
        FieldError: for a bad value.
        TreeError: for a bad parent. In both cases nothing is changed.
    """
    call = "ragdoll()"
    space = check_parent(call, parent)
    size, kg = number(0.01, 1000.0)(call, "height", height), MASS(call, "mass", mass)
    place = Pose(vector(POSITION_LIMIT)(call, "position", position), ROTATION(call, "rotation", rotation))
    figure = _Figure(place, size, kg, _worn(call, looks), geom)

    own, parts = SimpleSpace(name=name), {}
    for part, side, segment in _both_sides(MIDDLE, SIDES):
        parts[part] = own.attach(figure.part(part, side, segment))
    axes: dict[str, dict[str, Axis]] = {}
    with Joining.begin() as made:
        for joint, side, link in _both_sides(MIDDLE_LINKS, SIDE_LINKS):
            word = joint.removesuffix(joint.rpartition(" ")[2])  # "left " of "left knee"
            near, far = (parts[part if part in parts else word + part] for part in (link.near, link.far))
            joints, axes[joint] = figure.join(joint, side, link, near, far)
            for each in joints:
                made.add(each)
        doll = Ragdoll(own, list(parts.values()), made.joints, axes)
        doll.tone = tone
        space.attach(own)
    return doll


def _worn(call: str, looks: Mapping[str, Appearance] | None) -> dict[str, Appearance]:
    worn = dict(LOOKS)
    for what, look in (looks or {}).items():
        if what not in LOOKS or not isinstance(look, Appearance):
            raise FieldError(
                f"{call}.looks has {shown(what)}: {shown(look)}; it must have Appearances, for any of "
                + ", ".join(map(repr, LOOKS))
            )
        worn[what] = look
    return worn


PieceT = TypeVar("PieceT")


def _both_sides(middle: Mapping[str, PieceT], sides: Mapping[str, PieceT]) -> list[tuple[str, float, PieceT]]:
    """Names, sides, and what is there: the middle first, then the left and the right."""
    return [(name, RIGHT, piece) for name, piece in middle.items()] + [
        (f"{word} {name}", side, piece)
        for word, side in (("left", LEFT), ("right", RIGHT))
        for name, piece in sides.items()
    ]


@dataclass(frozen=True)
class _Figure:
    """What the segments and links of one ragdoll are made with."""

    place: Pose
    size: float
    mass: float
    looks: Mapping[str, Appearance]
    geom: CollisionFields

    def part(self, name: str, side: float, segment: Segment) -> Body:
        """A body for a segment, its frame at the centre of mass."""
        solids = [self._solid(solid, side, segment) for solid in segment.solids]
        centre = sum(
            (middle * solid.weight for solid, (_, middle, _) in zip(segment.solids, solids, strict=True)), ZERO
        )
        body = Body(name=name, position=self.place.transform(centre), rotation=self.place.rotation)
        for shape, middle, turn in solids:
            body.attach(Placeable(position=middle - centre, rotation=turn)).attach(shape)
        return body

    def _solid(self, solid: Rod | Slab, side: float, segment: Segment) -> tuple[Geom, Vec3, Quat]:
        """A geom, and where it is in the figure."""
        mass, look = self.mass * segment.mass * solid.weight, self.looks[segment.look]
        if isinstance(solid, Slab):
            low, high = self._point(solid.low, side), self._point(solid.high, side)
            edges = Vec3(abs(high.x - low.x), high.y - low.y, high.z - low.z)
            return Box(edges, mass=mass, appearance=look, **self.geom), (low + high) / 2, IDENTITY
        start, end = self._point(solid.start, side), self._point(solid.end, side)
        shape = Capsule(solid.radius * self.size, start.distance(end), mass=mass, appearance=look, **self.geom)
        return shape, (start + end) / 2, Quat.between((0.0, 0.0, 1.0), end - start)

    def _point(self, point: tuple[float, float, float], side: float) -> Vec3:
        return Vec3(side * point[0], point[1], point[2]) * self.size

    def join(self, name: str, side: float, link: Link, near: Body, far: Body) -> tuple[list[Joint], dict[str, Axis]]:
        """The joints of one link, and how its movements are measured."""
        anchor = self.place.transform(self._point(link.anchor, side))
        flexion, other = (self.place.rotation.rotate(_axis(axis, side)) for axis in (link.flexion, link.other))
        ranges = [(math.radians(each.low), math.radians(each.high)) for each in link.movements]
        names = [each.name for each in link.movements]
        if len(ranges) == 1:
            hinge = Hinge(far, near, anchor=anchor, axis=flexion, stops=ranges[0], name=name)
            return [hinge], {names[0]: Axis(hinge, "", *ranges[0])}
        if len(ranges) == 2:
            cross = Universal(
                far, near, anchor=anchor, axis1=other, axis2=flexion, stops1=ranges[1], stops2=ranges[0], name=name
            )
            return [cross], {names[0]: Axis(cross, "2", *ranges[0]), names[1]: Axis(cross, "1", *ranges[1])}
        ball = Ball(far, near, anchor=anchor, name=name)
        motor = AngularMotor(
            far,
            near,
            axes=(other, flexion),
            mode="euler",
            stops1=ranges[2],
            stops2=ranges[1],
            stops3=ranges[0],
            name=f"{name} range",
        )
        return [ball, motor], {
            each: Axis(motor, number, *limits) for each, number, limits in zip(names, "321", ranges, strict=True)
        }


def _axis(axis: Vec3, side: float) -> Vec3:
    """An axis of turning of one side: mirrored in the plane x = 0, it turns the other way but for its x."""
    return Vec3(axis.x, side * axis.y, side * axis.z)


def _moments(joints: Iterable[Joint]) -> dict[str, float]:
    """What gravity turns each joint with while all beyond it is straight out, N m."""
    anchored = [joint for joint in joints if isinstance(joint, Anchored)]

    def beyond(body: Body) -> list[Body]:
        return [body, *(each for joint in anchored if joint.body2 is body for each in beyond(joint.body1))]

    result = {}
    for joint in anchored:
        far = beyond(joint.body1)
        mass = sum(body.mass for body in far)
        centre = sum((body.world_centre_of_mass * body.mass for body in far), ZERO) / mass
        result[joint.name] = WEIGHT * mass * centre.distance(joint.anchor)
    return result
