"""Showing where a body's centre of mass is."""

from __future__ import annotations

from typing import TypedDict, Unpack

from osgode.fields import LENGTH, NumberField
from osgode.graph.drawable import Drawable
from osgode.graph.shapes import centre_of_mass_drawable
from osgode.graph.transforms import Transform
from osgode.maths import FloatArray, Pose
from osgode.nodes.base import PhysicsNode, nearest_body


class CentreOfMassFields(TypedDict, total=False):
    """The keyword arguments of `CentreOfMass`."""

    radius: float


class CentreOfMass(PhysicsNode, Transform):
    """Axes at the centre of mass of the body above, along the body's, and a marker there.

    It follows by itself when parts come, go or change. What is attached to it follows along. It is only seen: it has
    no mass and touches nothing.
    """

    PARENTS = ("Body",)

    radius = NumberField(0.1, LENGTH, after="_touch", unit="m", doc="Of the marker, a ball in black and yellow.")

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Unpack[CentreOfMassFields]) -> None:
        super().__init__(name=name, visible=visible, **fields)

    @property
    def pose(self) -> Pose:
        """Where it is in the body's frame."""
        body = nearest_body(self.parent)
        return Pose() if body is None else Pose(body.centre_of_mass)

    def local_matrix(self) -> FloatArray:
        """The 4x4 matrix to the axes of the body."""
        return self.pose.matrix()

    def drawables(self) -> tuple[Drawable, ...]:
        """The marker."""
        return (centre_of_mass_drawable(self.radius),)

    def _recentred(self) -> None:
        self._touch()
