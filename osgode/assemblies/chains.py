"""Chains and ropes: capsules one after the other, joined at their ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Unpack

import numpy as np

from osgode.assemblies.base import MASS, Assembly, Joining, PartFields, check_parent
from osgode.assemblies.catenary import LEAST_SPAN, STRAIGHT, hanging_angles
from osgode.errors import FieldError, TreeError, shown
from osgode.fields import LENGTH, POSITION_LIMIT, SIZE_LIMITS, choice, number, optional, vector, whole
from osgode.graph.shapes import capsule_drawable
from osgode.joints.ball import Ball
from osgode.joints.base import Joint
from osgode.joints.fixed import Fixed
from osgode.joints.hinge import Hinge
from osgode.joints.universal import Universal
from osgode.maths import FloatArray, Quat, Vec3, Vec3Like
from osgode.nodes.body import Body
from osgode.nodes.placeable import Placeable
from osgode.nodes.primitives import Capsule
from osgode.nodes.spaces import HashSpace, Space
from osgode.nodes.world import World

KINDS = ("ball", "hinge", "universal", "fixed")
FREE = choice("none", "start", "end", "both")
MOST_LINKS = 10_000

JointMaker = Callable[..., Joint]
"""Makes a joint of ``(body1, body2, anchor=point)``, as the classes of joints do; body2 may be None."""


class Chain(Assembly[Space]):
    """A chain or rope, made by `chain`.

    Its knots are numbered from 0 at the start to ``len(links)`` at the end: knot ``k`` is between the links ``k - 1``
    and ``k``.
    """

    def __init__(self, space: Space, links: Sequence[Body], knots: Sequence[Joint | None], link_length: float) -> None:
        super().__init__(space, links, [joint for joint in knots if joint is not None])
        self._knots = tuple(knots)
        self._link_length = link_length

    @property
    def links(self) -> tuple[Body, ...]:
        """Its links, from the start to the end; the z axis of each points along the chain."""
        return self._bodies

    @property
    def knots(self) -> tuple[Joint | None, ...]:
        """The joint at each knot; None where an end is free."""
        return self._knots

    @property
    def ends(self) -> tuple[Joint | None, Joint | None]:
        """The joints that hold the start and the end, None where it is free."""
        return self._knots[0], self._knots[-1]

    @property
    def link_length(self) -> float:
        """Of one link from knot to knot, metres."""
        return self._link_length

    @property
    def length(self) -> float:
        """Of all links, metres, also of a chain that has been cut."""
        return self._link_length * len(self._bodies)

    @property
    def points(self) -> tuple[Vec3, ...]:
        """Where the knots are in the world, each as the link before it has it; the first as the first link has it."""
        half = Vec3(0.0, 0.0, 0.5 * self._link_length)
        return self._bodies[0].local_to_world(-half), *(link.local_to_world(half) for link in self._bodies)

    def cut(self, knot: int) -> None:
        """Release the joint at a knot: 0 lets go of the start, ``len(links)`` of the end; a second time does nothing.

        Raises:
            FieldError: for a knot that it hasn't got, or that nothing holds.
        """
        k = whole(0, len(self._bodies))(f"{self.describe()}.cut()", "knot", knot)
        joint = self._knots[k]
        if joint is None:
            raise FieldError(f"{self.describe()}.cut().knot is {k}, where this chain is free; there is nothing to cut")
        joint.release()


def chain(
    parent: Space | World,
    start: Vec3Like,
    end: Vec3Like | None = None,
    *,
    length: float | None = None,
    links: int | None = None,
    link_length: float | None = None,
    radius: float = 0.03,
    mass: float | None = None,
    density: float | None = None,
    joint: str | JointMaker = "ball",
    body1: Body | None = None,
    body2: Body | None = None,
    free: str = "none",
    damping: float | None = None,
    name: str = "chain",
    **geom: Unpack[PartFields],
) -> Chain:
    """Hang a chain, or a rope, between two points, or down from one.

    With a ``length`` above the straight way it starts in the shape in which its links hang at rest (see
    `osgode.assemblies.catenary`), in the upright plane through both points; up is against the World's gravity. Its
    links stand in a space of their own below ``parent``. Neighbours never collide, nor an end and what holds it, but
    for the static world.

    Long chains with heavy loads want more ``iterations`` of the World's quick solver, or smaller steps.

    Args:
        parent: the space, or World, that its own space is put under.
        start: where it begins, a point of the world, metres.
        end: where it ends; None: straight below ``start`` by ``length``, and free there unless ``body2`` is given.
        length: of the whole chain, metres; None: the straight way.
        links: how many; None: by ``link_length``.
        link_length: about how long one is, metres: the whole is divided evenly; None: 8 radii.
        radius: of the links, metres; a link must be longer than two of them.
        mass: of the whole chain, kg; None: by density.
        density: kg/m3; None: the material's.
        joint: "ball"; "universal", which can't be twisted; "hinge", which bends in the chain's plane only, as a
            bicycle's; "fixed"; or what makes one of ``(body1, body2, anchor=point)``: a joint's class or a function.
        body1: what the start is held by, None for the static world.
        body2: what the end is held by, the same.
        free: which ends are held by nothing: "none", "start", "end" or "both".
        damping: part of its velocity that a link loses in each step; None: the World's.
        name: of its space; links and joints are "link 0" and "knot 0" and so on.
        **geom: of the links, such as ``material`` (steel if not given), ``kind``, ``appearance``.

    Raises:
        FieldError: for a bad value, or a chain that is shorter than the way.
        TreeError: for a bad parent or body. In all cases nothing is changed.
    """
    call = "chain()"
    space = check_parent(call, parent)
    up = _up(space)
    first, last, total, loose = _ends(call, start, end, length=length, free=free, up=up, has_end=body2 is not None)
    held = tuple(_held(call, which, body, loose) for which, body in (("body1", body1), ("body2", body2)))
    thick = LENGTH(call, "radius", radius)
    count = _count(call, total, thick, links, link_length)
    each = total / count
    across, angles = _shape(call, first, last, up, total=total, count=count)
    normal = across.cross(up)
    make = _maker(call, joint, normal)
    weight = optional(MASS)(call, "mass", mass)
    lost = optional(number(0.0, 1.0))(call, "damping", damping)
    fields: PartFields = {"material": "steel", **geom}

    own, bodies, points = HashSpace(name=name), [], [first]
    for k, angle in enumerate(angles):
        along = across * math.cos(angle) + up * math.sin(angle)
        turned = Quat.from_matrix(list(zip(normal.cross(along), normal, along, strict=True)))
        middle = points[-1] + along * (each / 2)
        points.append(points[-1] + along * each)
        link = Body(name=f"link {k}", position=middle, rotation=turned, linear_damping=lost, angular_damping=lost)
        part = None if weight is None else weight / count
        geometry = Capsule(thick, each - 2.0 * thick, mass=part, density=density, **fields)
        if geometry.shown is None:  # up to the knots, so that no gap is seen where it bends
            geometry.shown = (capsule_drawable(thick, each, geometry._look()),)
        link.attach(Placeable()).attach(geometry)
        bodies.append(own.attach(link))
    points[-1] = last

    with Joining.begin() as made:
        knots: list[Joint | None] = []
        for k, point in enumerate(points):
            if (k == 0 and loose in ("start", "both")) or (k == count and loose in ("end", "both")):
                knots.append(None)
                continue
            one, other = (bodies[k], held[0] if k == 0 else bodies[k - 1]) if k < count else (bodies[-1], held[1])
            knot = made.add(make(one, other, point))
            knot.name = knot.name or f"knot {k}"
            knots.append(knot)
        space.attach(own)
    return Chain(own, bodies, knots, each)


def _up(parent: Space | World) -> Vec3:
    world = parent.world
    gravity = Vec3(0.0, 0.0, 0.0) if world is None else world.gravity
    return -gravity.normalized() if gravity.length > 0.0 else Vec3(0.0, 1.0, 0.0)


def _ends(
    call: str,
    start: Vec3Like,
    end: Vec3Like | None,
    *,
    length: float | None,
    free: str,
    up: Vec3,
    has_end: bool,
) -> tuple[Vec3, Vec3, float, str]:
    """Start, end, length, and which ends are free."""
    first = vector(POSITION_LIMIT)(call, "start", start)
    total = optional(LENGTH)(call, "length", length)
    loose = FREE(call, "free", free)
    if end is None:
        if total is None:
            raise FieldError(f"{call}.length is None; without an end it must be the length of the chain in metres")
        if not has_end:
            loose = {"none": "end", "start": "both"}.get(loose, loose)
        return first, first - up * total, total, loose
    last = vector(POSITION_LIMIT)(call, "end", end)
    way = first.distance(last)
    if way < SIZE_LIMITS[0] and total is None:
        raise FieldError(f"{call}.end is {tuple(last)}, where it starts; it must be another point, or give a length")
    if total is None:
        total = LENGTH(call, "length", way)
    if total < way * (1.0 - 1e-9):
        raise FieldError(f"{call}.length is {total:g}; it must be at least {way:g} m, the way from start to end")
    return first, last, total, loose


def _held(call: str, which: str, body: object, loose: str) -> Body | None:
    if body is None:
        return None
    if not isinstance(body, Body):
        raise TreeError(f"{call}.{which} is {shown(body)}; it must be a Body or None")
    if loose in ("both", "start" if which == "body1" else "end"):
        raise FieldError(f"{call}.{which} is {body.describe()} beside free={loose!r}; a free end is held by nothing")
    return body


def _count(call: str, total: float, radius: float, links: int | None, link_length: float | None) -> int:
    """How many links it has."""
    if links is not None and link_length is not None:
        raise FieldError(f"{call} was given links={links} and link_length={link_length}; give one, the other None")
    if links is not None:
        count = whole(1, MOST_LINKS)(call, "links", links)
    else:
        wanted = 8.0 * radius if link_length is None else LENGTH(call, "link_length", link_length)
        count = max(1, round(total / wanted))
        if count > MOST_LINKS:
            raise FieldError(
                f"{call}.link_length is {wanted:g}, which makes {count} links; at most {MOST_LINKS} may be"
            )
    if total / count <= 2.0 * radius:
        raise FieldError(
            f"{call}.radius is {radius:g}; it must be below {total / count / 2.0:g} m, "
            f"half the length of each of the {count} links"
        )
    return count


def _shape(call: str, first: Vec3, last: Vec3, up: Vec3, *, total: float, count: int) -> tuple[Vec3, FloatArray]:
    """A level direction from the first to the last point, and the angle of each link above it."""
    way = last - first
    rise = way.dot(up)
    level = way - up * rise
    aside = level.length
    if aside > 1e-9 * total:
        across = level / aside
    else:
        across = up.cross((1.0, 0.0, 0.0) if abs(up.x) < 0.9 else (0.0, 1.0, 0.0)).normalized()
    if total * (1.0 - STRAIGHT) <= way.length:
        return across, np.full(count, math.atan2(rise, aside))
    if count < 2:
        raise FieldError(f"{call}.links is 1; a chain that is longer than the way needs at least 2")
    least = LEAST_SPAN * total / count
    if aside < least:
        raise FieldError(
            f"{call}.end is {tuple(last)}, {aside:g} m aside of the start; a chain of length={total:g}, which is "
            f"longer than the way, needs at least {least:g} m, or it would hang through itself"
        )
    return across, hanging_angles(count, total / count, aside, rise)


def _maker(call: str, joint: object, normal: Vec3) -> Callable[[Body, Body | None, Vec3], Joint]:
    """What makes the joints of the wanted kind."""
    if isinstance(joint, str):
        kind = choice(*KINDS)(call, "joint", joint)
        return lambda one, other, point: _known(kind, one, other, point, normal)
    if not callable(joint):
        kinds = ", ".join(map(repr, KINDS))
        raise FieldError(f"{call}.joint is {shown(joint)}; it must be one of {kinds}, a class of joints, or a function")

    def make(one: Body, other: Body | None, point: Vec3) -> Joint:
        made = joint(one, other, anchor=point)
        if not isinstance(made, Joint):
            raise FieldError(f"{call}.joint has returned {shown(made)}; it must return a Joint")
        return made

    return make


def _known(kind: str, one: Body, other: Body | None, point: Vec3, normal: Vec3) -> Joint:
    if kind == "ball":
        return Ball(one, other, anchor=point)
    if kind == "hinge":
        return Hinge(one, other, anchor=point, axis=normal)
    if kind == "universal":
        return Universal(one, other, anchor=point, axis1=normal, axis2=one.vector_to_world((1.0, 0.0, 0.0)))
    return Fixed(one, other)
