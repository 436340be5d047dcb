"""What a World tells of itself in bulk, for those who watch it: debug views, profilers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from osgode.native import ffi, lib, row_dtype
from osgode.nodes.base import PhysicsNode

BODY_STATE, GEOM_STATE = row_dtype("oo_body_state"), row_dtype("oo_geom_state")
NO_TIME = ffi.new("oo_timings *")[0]


class StepTimings(NamedTuple):
    """How long the parts of a call of `World.step` took, seconds.

    ``collide``, ``respond``, ``solve`` and ``report`` are spent in C, ``listeners`` in Python; ``total`` is the sum.
    """

    collide: float = 0.0
    """Finding the pairs whose boxes overlap, and their contacts."""
    respond: float = 0.0
    """Making contact joints of these."""
    solve: float = 0.0
    """Forces and velocities, new positions, following what is fast."""
    report: float = 0.0
    """Who touches whom, which joints break, poses for the picture."""
    listeners: float = 0.0
    """All that is Python: listeners, scheduled calls, and the little about them."""
    total: float = 0.0
    """From the call to its end."""
    steps: int = 0
    """How many were done in that time."""

    def __add__(self, other: StepTimings) -> StepTimings:  # type: ignore[override]
        """Both together: those of several calls of a frame."""
        return StepTimings(*(one + another for one, another in zip(self, other, strict=True)))  # type: ignore[arg-type]


class Exports(PhysicsNode):
    """What a World tells in bulk."""

    _took = 0.0
    """By the last call of `World.step`, which also sets the C core's timings to 0."""

    @property
    def timings(self) -> StepTimings:
        """Where the time of the last call of `step` (or `run`) went, for all of its steps together."""
        part = self._live("timings").ptr.timings
        phases = part.collide, part.respond, part.solve, part.report
        return StepTimings(*phases, max(self._took - sum(phases), 0.0), self._took, part.steps)

    @property
    def body_states(self) -> np.ndarray[Any, np.dtype[Any]]:
        """A new structured array of one row a body, in the order of `bodies`, as they are now.

        ``com``: (3,), the centre of mass in the body's frame, metres; ``asleep`` and ``kinematic``: 0 or 1.
        """
        realm = self._live("body_states")
        out = np.empty(realm.body_count, BODY_STATE)
        lib.oo_export_bodies(realm.ptr, ffi.cast("oo_body_state *", out.ctypes.data))
        return out

    @property
    def joints_enabled(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Whether each joint of `joints` holds anything, as a new array of as many."""
        realm = self._live("joints_enabled")
        out = np.empty(realm.ptr.joint_count, np.bool_)
        lib.oo_export_enabled(realm.ptr, ffi.cast("unsigned char *", out.ctypes.data))
        return out

    @property
    def geom_states(self) -> np.ndarray[Any, np.dtype[Any]]:
        """A new structured array of one row a slot (see `World.geom_of_slot`), as they are now.

        ``low``, ``high``: (3,) each, the corners of the geom's box along the world's axes, metres; those of planes are
        infinite. ``flags``: 1 if there is something, 4 if it is a space, 32 a ray, 256 a sensor; ``enabled``: 0 or 1.
        """
        realm = self._live("geom_states")
        out = np.empty(realm.ptr.geom_count, GEOM_STATE)
        lib.oo_export_geoms(realm.ptr, ffi.cast("oo_geom_state *", out.ctypes.data))
        return out
