"""Bodies that are too fast for what stands in their way."""

from __future__ import annotations

import math
from typing import Any

from osgode.fields import Field, choice, optional
from osgode.native import lib
from osgode.nodes.glide import Gliding

MODES = {None: lib.OO_TUNNEL, "ray": lib.OO_TUNNEL_RAY, "sweep": lib.OO_TUNNEL_SWEEP}


def _read(body: Any) -> str | None:
    mode = body._live("tunnelling").ptr.bodies[body._index].tunnelling
    return next(name for name, value in MODES.items() if value == mode)


class Tunnelling(Gliding):
    """A body that may be followed on its way from one step to the next."""

    tunnelling: Field[str | None, str | None] = Field(
        None,
        optional(choice("ray", "sweep")),
        _read,
        lambda body, value: lib.oo_body_set_tunnelling(body._live("tunnelling").ptr, body._index, MODES[value]),
        doc="How it is kept from passing through what is thinner than its way in a step. 'sweep': its shapes are "
        "followed along their way, and it is put where they first touch; 'ray': its centre of mass alone is, which "
        "misses what it grazes; None: it isn't followed.",
    )

    def _parts_changed(self) -> None:
        super()._parts_changed()
        if self._realm is not None:
            self._measure()

    def _settle(self) -> None:
        super()._settle()
        self._measure()

    def _measure(self) -> None:
        solid = (geom for geom in self.geoms if not geom.sensor) if self.space is not None else ()
        thinnest = min((geom._half_thickness() for geom in solid), default=math.inf)
        self._live("measuring it").ptr.bodies[self._index].thin = thinnest
