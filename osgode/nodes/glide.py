"""Kinematic bodies that are told where to be, and have the velocities of their way there."""

from __future__ import annotations

from typing import Any

from osgode.errors import FieldError, StateError
from osgode.fields import POSITION_LIMIT, ROTATION, VELOCITY_LIMIT, number, vector
from osgode.maths import Pose, QuatLike, Vec3Like
from osgode.native import checked, ffi, lib
from osgode.nodes.bodymass import BodyMass

DURATION = number(0.0, 1e9)


class Gliding(BodyMass):
    """A body that can be told where to be."""

    @property
    def gliding(self) -> bool:
        """Whether it is on its way (`glide_to`)."""
        return self._realm is not None and bool(lib.oo_glides(self._live("gliding").ptr, self._index))

    def glide_to(
        self, position: Vec3Like | None = None, rotation: QuatLike | None = None, *, seconds: float | None = None
    ) -> None:
        """Let this kinematic body move to a pose, carrying what lies on it and pushing what is in its way.

        In each step its velocities are those of its way, so contacts and joints see it moving; with the last step it
        is at the pose, to the very bits that setting `position` and `rotation` gives, and stands still. The frame's
        origin moves linearly, and it turns at a constant rate, the shorter way round.

        A second call replaces the first. Setting a pose, a velocity or ``enabled = False``, and leaving the World,
        end it; the body then stands still, or does what was set. ``kinematic = False`` ends it too, and the body
        flies on with the velocities of that moment.

        Args:
            position: of the frame in the world, metres; the present one if not given.
            rotation: quaternion (w, x, y, z); the present one if not given.
            seconds: how long it takes, rounded to whole steps, at least one; one step if not given. If the World's
                step size changes on the way, it takes as long, to one step.

        Raises:
            FieldError: for numbers that are not finite or out of bounds, neither pose nor rotation, or a way that is
                too long for the time: 1e9 m/s and rad/s.
            StateError: if it isn't kinematic, outside of a World, or while another thread is in a step of it.
        """
        name = f"{self.describe()}.glide_to()"
        if position is None and rotation is None:
            raise FieldError(f"{name}: give position or rotation, or both")
        target = Pose(
            self.position if position is None else vector(POSITION_LIMIT)(name, "position", position),
            self.rotation if rotation is None else ROTATION(name, "rotation", rotation),
        )
        wanted = 0.0 if seconds is None else DURATION(name, "seconds", seconds)
        with self._live("glide_to").editing() as realm:
            if not self.kinematic:
                raise StateError(f"{name}: it is not kinematic, so forces move it; set kinematic=True first")
            step = realm.ptr.step_size
            duration = max(round(wanted / step), 1) * step
            self._check_speed(name, target, duration)
            row = ffi.new("double[7]", [*target.position, *target.rotation])
            checked(lib.oo_glide_start(realm.ptr, self._index, row, duration), name)

    def stop_gliding(self) -> None:
        """Stand still where it is; does nothing if it isn't on its way."""
        if self._realm is not None:
            with self._realm.editing():
                self._halt()

    def _check_speed(self, name: str, target: Pose, duration: float) -> None:
        speed = target.transform(self.centre_of_mass).distance(self.world_centre_of_mass) / duration
        speed = max(speed, target.position.distance(self.position) / duration)
        rate = (target.rotation * self.rotation.conjugate()).angle / duration
        if not max(speed, rate) <= VELOCITY_LIMIT:
            raise FieldError(
                f"{name}: {tuple(target.position)} in {duration:g} s takes {speed:g} m/s and {rate:g} rad/s; "
                f"it must be at most {VELOCITY_LIMIT:g}, so give it more seconds"
            )

    def _copy_from(self, other: Any) -> None:
        super()._copy_from(other)
        if other.gliding:  # the copy stays where it is
            for name in ("linear_velocity", "angular_velocity"):
                self._record.pop(name, None)
