"""The frame of a body, and what is given in it or in the world."""

from __future__ import annotations

from osgode.maths import Pose, Vec3, Vec3Like
from osgode.nodes.bodystate import BodyState


class BodyFrame(BodyState):
    """A body as a moving frame: points and directions go from one to the other side."""

    @property
    def pose(self) -> Pose:
        """Position and rotation of the body's frame."""
        return Pose(self.position, self.rotation)

    def local_to_world(self, point: Vec3Like) -> Vec3:
        """A point of the body's frame in the world, metres."""
        return self.pose.transform(point)

    def world_to_local(self, point: Vec3Like) -> Vec3:
        """A point of the world in the body's frame, metres."""
        return self.pose.inverse().transform(point)

    def vector_to_world(self, vector: Vec3Like) -> Vec3:
        """A direction in body axes, turned to world axes."""
        return self.rotation.rotate(vector)

    def vector_to_local(self, vector: Vec3Like) -> Vec3:
        """A direction in world axes, turned to body axes."""
        return self.rotation.conjugate().rotate(vector)

    def velocity_at(self, point: Vec3Like) -> Vec3:
        """The velocity (m/s) of the material point of the body that is at ``point`` of the world now."""
        x, y, z = point
        px, py, pz = self.position
        return self.linear_velocity + self.angular_velocity.cross((x - px, y - py, z - pz))
