"""Placing geometry in a body, or in the static world."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict, Unpack

from osgode.fields import OFFSET_LIMIT, ROTATION, RotationField, VectorField, vector
from osgode.graph.transforms import Transform
from osgode.maths import IDENTITY, ZERO, FloatArray, Pose, QuatLike, Vec3Like
from osgode.nodes.base import PhysicsNode, nearest_body, physics_nodes

if TYPE_CHECKING:
    from osgode.graph.node import Group
    from osgode.nodes.body import Body


class PlaceableFields(TypedDict, total=False):
    """The keyword arguments of `Placeable`."""

    position: Vec3Like
    rotation: QuatLike


class Placeable(PhysicsNode, Transform):
    """Where geometry is: relative to the Body above, or, below a space, in the world.

    Below a Body its geoms are parts that move with it. It has no native of its own, so ODE never changes its pose;
    setting it moves the geoms below at once, in a body also the centre of mass.
    """

    PARENTS = ("Body", "Space")

    position = VectorField(ZERO, vector(OFFSET_LIMIT), after="_moved", unit="m", doc="In the axes above.")
    rotation = RotationField(IDENTITY, ROTATION, after="_moved", doc="Quaternion (w, x, y, z) to the axes above.")

    def __init__(self, *, name: str = "", visible: bool = True, **fields: Unpack[PlaceableFields]) -> None:
        super().__init__(name=name, visible=visible, **fields)

    @property
    def body(self) -> Body | None:
        """The Body that it belongs to, or None for static geometry."""
        return nearest_body(self.parent)

    @property
    def pose(self) -> Pose:
        """Position and rotation together."""
        return Pose(self.position, self.rotation)

    def local_matrix(self) -> FloatArray:
        """The 4x4 matrix to the axes above."""
        return self.pose.matrix()

    def _moved(self) -> None:
        body = self.body
        if body is not None:
            body._parts_changed()
        if self._realm is not None:
            for geom in physics_nodes(self)[1:]:
                geom._place()
        self._touch()

    def _arrived(self, parent: Group) -> None:
        if (body := nearest_body(parent)) is not None:
            body._parts_changed()

    def _departed(self, parent: Group) -> None:
        if (body := nearest_body(parent)) is not None:
            body._parts_changed()
