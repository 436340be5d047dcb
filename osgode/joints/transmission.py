"""Gears, bevel gears and chain drives."""

from __future__ import annotations

import math
from typing import Unpack

from osgode.errors import FieldError, StateError
from osgode.fields import SIZE_LIMITS, Field, NumberField, choice, number, optional
from osgode.joints.anchored import origin_of, right_angle
from osgode.joints.base import TWO_BODIES, Joint, JointFields
from osgode.joints.limits import SpringFields, spring_fields
from osgode.joints.spots import BODY1, BODY2, Anchor, Axis, Coordinate
from osgode.maths import Vec3, Vec3Like
from osgode.native import ffi, lib
from osgode.nodes.body import Body

MODES = ("parallel", "intersecting", "chain")
MODE = choice(*MODES)
RADIUS = optional(number(*SIZE_LIMITS))


class TransmissionFields(JointFields, SpringFields, total=False):
    """The keyword arguments of `Transmission` beside its anchors and axes."""

    ratio: float
    radius1: float | None
    radius2: float | None
    backlash: float


class Transmission(Joint):
    """Passes turning on from one wheel to another: spur gears, bevel gears, or sprockets with a chain.

    It neither holds the wheels nor their axles: each needs a hinge (to a frame, or to the static world) at the same
    anchor about the same axis. How far its wheels have turned is counted since the joint was made, so what is left of
    a chain's or a gear's error is forgotten when it is made again (a body left and came back, or its centre of mass
    moved) or switched on: the wheels go on from where they stand. A wheel may not turn by more than a quarter of a
    turn in a step: ODE loses count there.

    - "parallel": gears on parallel axes, whose radii are in the relation ``ratio`` = radius1 / radius2: ``body2`` turns
      ``ratio`` times as fast, the other way round.
    - "intersecting": bevel gears at a right angle; the radii follow from where the planes of the wheels meet. (For
      other angles ODE's equations depend on where in the world the gears are.)
    - "chain": sprockets of ``radius1`` and ``radius2``: ``body2`` turns radius1 / radius2 times as fast, the same way.
      ODE mixes up rows and columns where it places the chain, so its pull, not its ratio, depends on how the sprockets
      lie in the world; with ``axis1`` along the world's Y it is right, and where it would vanish you are told so.

    Args:
        body1: the first wheel.
        body2: the second wheel; ODE needs both.
        anchor1: the middle of the first wheel in the world, metres; its origin if not given.
        anchor2: the middle of the second wheel.
        axis1: direction in the world that the first wheel turns about.
        axis2: the same of the second; it must be parallel to ``axis1`` for gears and chains, where it may be left out,
            and within 0.01 rad of a right angle to it for bevel gears, and is made exact.
        mode: "parallel", "intersecting" or "chain"; it can't be changed.
        ratio: of gears on parallel axes.
        radius1, radius2: metres, of sprockets.
        backlash: metres at the teeth.
    """

    KIND = lib.OO_TRANSMISSION
    BODIES = TWO_BODIES

    anchor1 = Anchor(BODY1, "The middle of the first wheel.")
    anchor2 = Anchor(BODY2, "The middle of the second wheel.")
    axis1 = Axis(BODY1, "The axis of the first wheel.")
    axis2 = Axis(BODY2, "The axis of the second wheel.")
    angle1 = Coordinate.angle(0, "How far the first wheel has turned since the joint was made; it goes on beyond pi.")
    angle2 = Coordinate.angle(1, "How far the second wheel has turned.")
    angle_rate1 = Coordinate.angle_rate(0, "How fast the first wheel turns.")
    angle_rate2 = Coordinate.angle_rate(1, "How fast the second wheel turns.")

    ratio = NumberField(1.0, number(1e-3, 1e3), after="_regear", doc="radius1 / radius2 of gears on parallel axes.")
    radius1: Field[float | None, float | None] = Field(
        None, RADIUS, after="_regear", unit="m", doc="Of the first sprocket, in the mode 'chain' only."
    )
    radius2: Field[float | None, float | None] = Field(
        None, RADIUS, after="_regear", unit="m", doc="Of the second sprocket, in the mode 'chain' only."
    )
    backlash = NumberField(
        0.0,
        number(0.0, 1e6),
        lambda joint: joint._param(lib.OO_BACKLASH),
        lambda joint, value: joint._set_param(lib.OO_BACKLASH, value),
        unit="m",
        doc="Play between the teeth.",
    )
    erp, cfm, stiffness, damping = spring_fields((lib.dParamERP, lib.dParamCFM), ("", ""), "the teeth", turning=False)

    def __init__(
        self,
        body1: Body,
        body2: Body,
        *,
        anchor1: Vec3Like | None = None,
        anchor2: Vec3Like | None = None,
        axis1: Vec3Like = (0.0, 0.0, 1.0),
        axis2: Vec3Like | None = None,
        mode: str = "parallel",
        name: str = "",
        **fields: Unpack[TransmissionFields],
    ) -> None:
        self.name = name
        self._mode = MODE(self.describe(), "mode", mode)
        spots = {
            "anchor1": origin_of(body1) if anchor1 is None else anchor1,
            "anchor2": origin_of(body2) if anchor2 is None else anchor2,
            "axis1": axis1,
            "axis2": axis1 if axis2 is None else axis2,
        }
        super().__init__(body1, body2, name=name, spots=spots, **fields)

    @property
    def mode(self) -> str:
        """Either "parallel", "intersecting" or "chain"."""
        return self._mode

    # -- what fits together

    def _fit(self, spots: dict[str, Vec3]) -> dict[str, Vec3]:
        way = spots["anchor2"] - spots["anchor1"]
        if self._mode == "intersecting":
            spots = spots | {"axis2": right_angle(self, spots, "axis1", "axis2")}
            for radius, name in zip(map(abs, _bevel_arms(spots)), ("anchor1", "anchor2"), strict=True):
                if radius < SIZE_LIMITS[0]:
                    raise FieldError(
                        f"{self.describe()}.{name} is {tuple(spots[name])}, in the plane of the other wheel; "
                        "it must be off that plane, by the radius of its wheel"
                    )
            return spots
        if spots["axis1"].dot(spots["axis2"]) < 0.9999:
            raise FieldError(
                f"{self.describe()}.axis2 is {tuple(spots['axis2'])}; it must be that of axis1={tuple(spots['axis1'])} "
                f"in the mode {self._mode!r}"
            )
        if way.length < SIZE_LIMITS[0] or abs(way.dot(spots["axis1"])) > 0.01 * way.length:
            raise FieldError(
                f"{self.describe()}.anchor2 is {tuple(spots['anchor2'])}; it must lie in the plane of the first wheel, "
                f"through anchor1={tuple(spots['anchor1'])} across axis1={tuple(spots['axis1'])}, and beside anchor1"
            )
        spots = spots | {"axis2": spots["axis1"]}
        if self._ready:
            self._check_gears(spots)
        return spots

    def _complete(self) -> None:
        self._check_gears()

    def _check_gears(self, spots: dict[str, Vec3] | None = None) -> None:
        spots = self._spots if spots is None else spots
        chain = self._mode == "chain"
        for name in ("radius1", "radius2"):
            if chain != (getattr(self, name) is not None):
                what = "needs" if chain else "can't have"
                raise FieldError(f"{self.describe()}: the mode {self._mode!r} {what} {name}")
        if self._mode != "parallel" and self.ratio != 1.0:
            raise FieldError(f"{self.describe()}.ratio is {self.ratio:g}; only the mode 'parallel' can be given one")
        apart = spots["anchor1"].distance(spots["anchor2"])
        if chain and abs((self.radius1 or 0.0) - (self.radius2 or 0.0)) >= apart:
            raise FieldError(
                f"{self.describe()}: radius1={self.radius1} and radius2={self.radius2} differ by more than the "
                f"{apart:g} m between the anchors"
            )
        if chain and self._pull(spots) < 0.05:
            raise FieldError(
                f"{self.describe()}.axis1 is {tuple(spots['axis1'])}, across the way from anchor1 to anchor2 in "
                "a direction in which ODE's chain can't pull; it must be another, (0, 1, 0) for instance"
            )

    def _pull(self, spots: dict[str, Vec3]) -> float:
        """The part of the chain's pull that ODE lets act: 1 where its sprockets lie as it expects them."""
        n, way = spots["axis1"], spots["anchor1"] - spots["anchor2"]
        d = way.normalized()
        side = d.cross(n)
        c = ((self.radius2 or 0.0) - (self.radius1 or 0.0)) / way.length
        along = (c, 0.0, math.sqrt(max(0.0, 1.0 - c * c)))
        # ODE multiplies by the matrix of rows d, n and d x n, where its transpose would be right.
        return Vec3(d.dot(along), n.dot(along), side.dot(along)).cross(n).length

    def _regear(self) -> None:
        if not self._ready:
            return
        self._check_gears()
        self._remake()

    def _layout(self) -> tuple[list[float], list[int]]:
        self._check_gears()
        flat, _ = super()._layout()
        return [*flat, self.ratio, self.radius1 or 0.0, self.radius2 or 0.0], [MODES.index(self._mode)]

    # -- what it reads

    @property
    def contact_points(self) -> tuple[Vec3, Vec3]:
        """Where the teeth, or the chain and the sprockets, touched in the last step: points of the world.

        Raises:
            StateError: while the joint isn't live, or before its first step.
        """
        self._read("contact_points")
        realm = self._live("contact_points")
        if realm.ptr.steps == self._native.born:
            raise StateError(f"{self.describe()}.contact_points are known after the joint's first step only")
        out = ffi.new("dVector3[2]")
        lib.dJointGetTransmissionContactPoint1(self._id, out[0])
        lib.dJointGetTransmissionContactPoint2(self._id, out[1])
        return Vec3(*out[0][0:3]), Vec3(*out[1][0:3])

    @property
    def radii(self) -> tuple[float, float]:
        """Of both wheels, metres: as given, or as they follow from the anchors, the axes and the ratio."""
        if self._mode == "chain":
            return self.radius1 or 0.0, self.radius2 or 0.0
        if self._mode == "intersecting":
            arm1, arm2 = _bevel_arms(self._spots)
            return abs(arm1), abs(arm2)
        apart = self._spots["anchor1"].distance(self._spots["anchor2"])
        return apart * self.ratio / (1.0 + self.ratio), apart / (1.0 + self.ratio)

    @property
    def error(self) -> float:
        """How far the teeth are off each other, or the chain is stretched, beyond the backlash, metres."""
        angle1, angle2 = self._read("error").position[0:2]
        arm1, arm2 = _bevel_arms(self._spots) if self._mode == "intersecting" else self.radii
        if self._mode == "parallel":
            arm2 = -arm2
        off: float = abs(arm1 * angle1 - arm2 * angle2)
        return max(0.0, off - self.backlash)


def _bevel_arms(spots: dict[str, Vec3]) -> tuple[float, float]:
    """How far each anchor is from the line in which the planes of the wheels meet.

    Negative where a wheel that turns forwards moves backwards along that line.
    """
    n1, n2 = spots["axis1"], spots["axis2"]
    along = n1.cross(n2).normalized()
    result = []
    for own, other, anchor, far in ((n1, n2, "anchor1", "anchor2"), (n2, n1, "anchor2", "anchor1")):
        across = along.cross(own)  # in the plane of the wheel, towards the line; a turn moves its end along the line
        height = (spots[far] - spots[anchor]).dot(other)
        result.append(height / across.dot(other))
    return result[0], result[1]
