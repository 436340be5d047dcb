"""Joints of two anchors: a rod with a ball, or with a hinge, at each end."""

from __future__ import annotations

from typing import Any, Unpack

from osgode.errors import FieldError
from osgode.fields import Field, number, optional
from osgode.joints.base import Joint, JointFields
from osgode.joints.limits import SpringFields, spring_fields
from osgode.joints.spots import BODY1, BODY2, Anchor, Axis, Coordinate
from osgode.maths import Vec3, Vec3Like
from osgode.native import lib
from osgode.nodes.body import Body


class RodFields(JointFields, SpringFields, total=False):
    """The keyword arguments of `DoubleBall` and `DoubleHinge` beside anchors and axis."""

    distance: float | None


class _Rod(Joint):
    """Two points that keep their distance."""

    anchor1 = Anchor(BODY1, "The end at body1.")
    anchor2 = Anchor(BODY2, "The end at body2, or in the static world.")
    length = Coordinate.position(0, "How far the ends are apart now.")
    length_rate = Coordinate.position_rate(0, "How fast they go apart.")

    distance: Field[float | None, float | None] = Field(
        None,
        optional(number(0.0, 1e8)),
        after="_stretched",
        unit="m",
        doc="How far the ends are to be apart; None: as they were when anchored.",
    )
    erp, cfm, stiffness, damping = spring_fields((lib.dParamERP, lib.dParamCFM), ("", ""), "the rod", turning=False)

    @property
    def target_distance(self) -> float:
        """How far the ends are to be apart, metres: `distance`, or that at rest."""
        at_rest = self._spots["anchor1"].distance(self._spots["anchor2"])
        return at_rest if self.distance is None else self.distance

    @property
    def error(self) -> float:
        """How much longer or shorter the rod is than it should be, metres."""
        return abs(self.anchor1.distance(self.anchor2) - self.target_distance)

    def _stretched(self) -> None:
        if self._realm is not None:
            self._set_param(lib.OO_DISTANCE, self.target_distance)
            self._wake()

    def _enter_fields(self) -> None:
        super()._enter_fields()
        self._set_param(lib.OO_DISTANCE, self.target_distance)


def _ends(joint_anchors: tuple[Any, Any], body1: object, body2: object) -> dict[str, Any]:
    ends = []
    for anchor, body in zip(joint_anchors, (body1, body2), strict=True):
        ends.append(body.position if anchor is None and isinstance(body, Body) else anchor)
    return {"anchor1": ends[0], "anchor2": ends[1]}


class DoubleBall(_Rod):
    """Keeps a point of one body at a distance from a point of the other: a rod without mass and a ball at each end.

    With ``stiffness`` and ``damping`` it is a spring, whose rest length is ``distance``.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor1: the end at ``body1``, in the world, metres; its origin if not given.
        anchor2: the end at ``body2``; its origin if not given. Needed where there is no ``body2``.
    """

    KIND = lib.OO_DBALL

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor1: Vec3Like | None = None,
        anchor2: Vec3Like | None = None,
        name: str = "",
        **fields: Unpack[RodFields],
    ) -> None:
        super().__init__(body1, body2, name=name, spots=_ends((anchor1, anchor2), body1, body2), **fields)


class DoubleHinge(_Rod):
    """A rod without mass with a hinge at each end, both about the same axis.

    It keeps the anchors at their distance, and lets the bodies turn about the axis only.

    Args:
        body1: the first body.
        body2: the second body, None for the static world.
        anchor1: the end at ``body1``, in the world, metres; its origin if not given.
        anchor2: the end at ``body2``; its origin if not given. Needed where there is no ``body2``.
        axis: direction in the world, of both hinges.
    """

    KIND = lib.OO_DHINGE

    axis = Axis(BODY1, "The axis of both hinges, as body1 has it.")

    def __init__(
        self,
        body1: Body,
        body2: Body | None = None,
        *,
        anchor1: Vec3Like | None = None,
        anchor2: Vec3Like | None = None,
        axis: Vec3Like = (0.0, 0.0, 1.0),
        name: str = "",
        **fields: Unpack[RodFields],
    ) -> None:
        spots = _ends((anchor1, anchor2), body1, body2) | {"axis": axis}
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        # ODE keeps both ends in one plane across the axis, and gives an error in it no way out but that plane.
        way = spots["anchor2"] - spots["anchor1"]
        if abs(way.dot(spots["axis"])) > 0.01 * max(way.length, 1e-6):
            raise FieldError(
                f"{self.describe()}.anchor2 is {tuple(spots['anchor2'])}; it must lie in the plane through "
                f"anchor1={tuple(spots['anchor1'])} across axis={tuple(spots['axis'])}"
            )
        return spots

    @property
    def angular_error(self) -> float:
        """The angle between the axis as one body has it and as the other has it, radians."""
        return self._bend("axis")
