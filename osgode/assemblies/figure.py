"""The figures of a human body: how long, how heavy and how bendy its segments are.

Lengths as parts of the height: R. Drillis and R. Contini, Body Segment Parameters (1966), as in D. A. Winter,
Biomechanics and Motor Control of Human Movement, figure 4.1. Masses as parts of the whole: Winter, table 4.1 (after
Dempster); the torso is thorax and abdomen. How thick the segments are, and what the collision shapes are, is our own.
Ranges: American Academy of Orthopaedic Surgeons, Joint Motion: Method of Measuring and Recording (1965); where they
differ is said below.

The figure stands upright with its arms down, looks along -Z, and has its origin on the ground between its feet; its
right side is at +X. Segments and movements of the left side mirror those of the right.
"""

from __future__ import annotations

from dataclasses import dataclass

from osgode.maths import Vec3

SOLE, ANKLE, KNEE, HIP, WAIST, SHOULDER, CHIN, TOP = 0.0, 0.039, 0.285, 0.530, 0.600, 0.818, 0.870, 1.0
"""Heights; that of the waist, where the torso bends, is our own."""
ELBOW, WRIST, FINGERTIP = SHOULDER - 0.186, SHOULDER - 0.186 - 0.146, SHOULDER - 0.186 - 0.146 - 0.108
SHOULDER_OUT, HIP_OUT = 0.129, 0.050
"""From the middle to the joints of one side."""


@dataclass(frozen=True)
class Rod:
    """A capsule from one point to another, the middles of its caps; ``weight`` is its part of the segment's mass."""

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    weight: float = 1.0


@dataclass(frozen=True)
class Slab:
    """A box between two corners."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    weight: float = 1.0


@dataclass(frozen=True)
class Segment:
    """One rigid part of a body, of the right side if it has one: everything in parts of the height."""

    mass: float
    solids: tuple[Rod | Slab, ...]
    look: str


@dataclass(frozen=True)
class Movement:
    """About one axis, from where the figure stands upright: degrees, positive as the name says, on the right side."""

    name: str
    low: float
    high: float


@dataclass(frozen=True)
class Link:
    """A joint between two segments: ``far`` moves against ``near``.

    Args:
        near, far: names of segments.
        anchor: where it is.
        flexion: the axis of the first movement, which ``near`` carries.
        other: the axis of the last, which ``far`` carries: along the limb for three movements.
        movements: one for a hinge, two for a universal joint, three for a ball joint with an angular motor.
    """

    near: str
    far: str
    anchor: tuple[float, float, float]
    flexion: Vec3
    other: Vec3
    movements: tuple[Movement, ...]


X, Y, Z = Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0)

MIDDLE = {
    "pelvis": Segment(0.142, (Rod((-0.037, 0.555, 0.0), (0.037, 0.555, 0.0), 0.058),), "trousers"),
    "torso": Segment(
        0.355,
        (
            Rod((-0.036, 0.655, 0.0), (-0.036, 0.760, 0.0), 0.056, 0.45),
            Rod((0.036, 0.655, 0.0), (0.036, 0.760, 0.0), 0.056, 0.45),
            Rod((-0.095, 0.795, 0.0), (0.095, 0.795, 0.0), 0.030, 0.10),
        ),
        "shirt",
    ),
    "head": Segment(
        0.081,
        (
            Rod((0.0, 0.925, -0.005), (0.0, 0.945, -0.005), 0.055, 0.9),
            Rod((0.0, 0.835, 0.0), (0.0, 0.880, 0.0), 0.030, 0.1),
        ),
        "skin",
    ),
}
_ARM, _LEG = SHOULDER_OUT, HIP_OUT
SIDES = {
    "upper arm": Segment(0.028, (Rod((_ARM, SHOULDER - 0.01, 0.0), (_ARM, ELBOW, 0.0), 0.026),), "shirt"),
    "forearm": Segment(0.016, (Rod((_ARM, ELBOW, 0.0), (_ARM, WRIST + 0.01, 0.0), 0.021),), "skin"),
    "hand": Segment(0.006, (Slab((_ARM - 0.009, FINGERTIP + 0.01, -0.025), (_ARM + 0.009, WRIST, 0.025)),), "skin"),
    "thigh": Segment(0.100, (Rod((_LEG, HIP - 0.02, 0.0), (_LEG, KNEE, 0.0), 0.041),), "trousers"),
    "shank": Segment(0.0465, (Rod((_LEG, KNEE, 0.0), (_LEG, ANKLE + 0.02, 0.0), 0.030),), "trousers"),
    "foot": Segment(0.0145, (Slab((_LEG - 0.0275, SOLE, -0.114), (_LEG + 0.0275, ANKLE, 0.038)),), "shoes"),
}
"""Of the right side."""

MIDDLE_LINKS = {
    "waist": Link(
        "pelvis",
        "torso",
        (0.0, WAIST, 0.0),
        -X,
        Y,
        (Movement("flexion", -25, 80), Movement("bending", -35, 35), Movement("rotation", -45, 45)),
    ),
    "neck": Link(
        "torso",
        "head",
        (0.0, SHOULDER + 0.015, 0.0),
        -X,
        Y,
        (Movement("flexion", -45, 45), Movement("bending", -45, 45), Movement("rotation", -60, 60)),
    ),
}
SIDE_LINKS = {
    # Ours lifts by 180 both ways. Here the motor's middle angle must stay off 90, and the outer ones off 180.
    "shoulder": Link(
        "torso",
        "upper arm",
        (_ARM, SHOULDER - 0.01, 0.0),
        X,
        Y,
        (Movement("flexion", -60, 170), Movement("abduction", -15, 80), Movement("rotation", -90, 70)),
    ),
    "elbow": Link("upper arm", "forearm", (_ARM, ELBOW, 0.0), X, Z, (Movement("flexion", 0, 150),)),
    "wrist": Link(
        "forearm", "hand", (_ARM, WRIST, 0.0), -Z, X, (Movement("flexion", -70, 80), Movement("deviation", -30, 20))
    ),
    "hip": Link(
        "pelvis",
        "thigh",
        (_LEG, HIP, 0.0),
        X,
        Y,
        (Movement("flexion", -30, 120), Movement("abduction", -30, 45), Movement("rotation", -45, 45)),
    ),
    "knee": Link("thigh", "shank", (_LEG, KNEE, 0.0), -X, Z, (Movement("flexion", 0, 135),)),
    "ankle": Link(
        "shank", "foot", (_LEG, ANKLE, 0.0), X, -Z, (Movement("flexion", -50, 20), Movement("inversion", -15, 35))
    ),
}
"""Of the right side."""
