"""Lamps: nodes that throw light on what is near them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from weakref import ReferenceType

import numpy as np

from osgode.errors import FieldError
from osgode.graph.frame import MAX_LIGHTS, Light
from osgode.graph.lod import Gated
from osgode.graph.movers import Anchor, Marks, Movers, Place, Tables
from osgode.graph.node import Node
from osgode.maths import FloatArray, Vec3, finite

WHITE = (1.0, 1.0, 1.0)


class PointLight(Node):
    """A lamp at the origin of the axes that it stands in, which shines to all sides; it throws no shadows.

    It goes where transforms and moving bodies take it. A surface at a distance ``d`` that faces it gets
    ``intensity * colour * (1 - (d / reach)**2)**2`` of light, nothing beyond the reach. Of the lamps whose reach
    comes into a picture the 8 nearest to the camera shine.

    Args:
        colour: red, green, blue; may be above 1.
        reach: metres, not scaled by transforms.
        intensity: 0 for off; costs nothing to change, as the colour.
        name: for messages and paths.
        visible: whether it shines.

    Raises:
        FieldError: if the colour or the intensity is below 0, the reach is not above 0, or a number is not finite.
    """

    def __init__(
        self,
        colour: Sequence[float] = WHITE,
        reach: float = 10.0,
        *,
        intensity: float = 1.0,
        name: str = "",
        visible: bool = True,
    ) -> None:
        super().__init__(name=name, visible=visible)
        self.colour = colour
        self.intensity = intensity
        self._reach = self._number("reach", reach, 0.0, math.inf)

    @property
    def colour(self) -> tuple[float, float, float]:
        """Red, green, blue; may be above 1."""
        return self._colour

    @colour.setter
    def colour(self, value: Sequence[float]) -> None:
        try:
            red, green, blue = map(float, value)
        except (TypeError, ValueError):
            red = green = blue = math.nan
        if not finite((red, green, blue)) or min(red, green, blue) < 0.0:
            raise FieldError(f"{self.describe()}.colour is {value!r}; it must be three finite numbers, 0 or more")
        self._colour = red, green, blue

    @property
    def intensity(self) -> float:
        """What the colour is multiplied with, 0 or more."""
        return self._intensity

    @intensity.setter
    def intensity(self, value: float) -> None:
        try:
            intensity = float(value)
        except (TypeError, ValueError):
            intensity = math.nan
        if not 0.0 <= intensity < math.inf:
            raise FieldError(f"{self.describe()}.intensity is {value!r}; it must be finite, 0 or more")
        self._intensity = intensity

    @property
    def reach(self) -> float:
        """How far it shines, metres."""
        return self._reach

    @reach.setter
    def reach(self, value: float) -> None:
        self._reach = self._number("reach", value, 0.0, math.inf)
        self._touch()

    def light(self, position: Vec3, direction: Vec3) -> Light:
        """What it throws from a place in the world; a lamp to all sides passes over the direction."""
        del direction
        return Light(position, self._amount(), self._reach)

    def _amount(self) -> tuple[float, float, float]:
        red, green, blue = self._colour
        return red * self._intensity, green * self._intensity, blue * self._intensity

    def _number(self, name: str, value: float, above: float, most: float) -> float:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not above < number <= most or math.isinf(number):
            upper = "and finite" if math.isinf(most) else f"and at most {most:.6g}"
            raise FieldError(f"{self.describe()}.{name} is {value!r}; it must be above {above:g} {upper}")
        return number


class SpotLight(PointLight):
    """A lamp that shines along -Z of the axes that it stands in, as a camera looks, in a cone.

    Args:
        colour: red, green, blue; may be above 1.
        reach: metres, not scaled by transforms.
        angle: from the middle of the cone to its edge, radians, at most pi / 2.
        softness: the share of the angle over which the edge fades out, above 0 to 1.
        intensity: 0 for off; costs nothing to change, as the colour.
        name: for messages and paths.
        visible: whether it shines.

    Raises:
        FieldError: as PointLight, and if the angle or the softness can't be.
    """

    def __init__(
        self,
        colour: Sequence[float] = WHITE,
        reach: float = 20.0,
        *,
        angle: float = math.radians(25),
        softness: float = 0.2,
        intensity: float = 1.0,
        name: str = "",
        visible: bool = True,
    ) -> None:
        super().__init__(colour, reach, intensity=intensity, name=name, visible=visible)
        self.angle = angle
        self.softness = softness

    @property
    def angle(self) -> float:
        """From the middle of the cone to its edge, radians."""
        return self._angle

    @angle.setter
    def angle(self, value: float) -> None:
        self._angle = self._number("angle", value, 0.0, math.pi / 2)

    @property
    def softness(self) -> float:
        """The share of the angle over which the edge fades out."""
        return self._softness

    @softness.setter
    def softness(self, value: float) -> None:
        self._softness = self._number("softness", value, 0.0, 1.0)

    def light(self, position: Vec3, direction: Vec3) -> Light:
        """What it throws from a place in the world."""
        inner = self._angle * (1.0 - self._softness)
        return Light(position, self._amount(), self._reach, direction, self._angle, inner)


class Lamp(NamedTuple):
    """A light on one way from the root, which isn't kept alive, and the gates that must be open."""

    node: ReferenceType[PointLight]
    place: Place
    gates: tuple[int, ...]


class Lamps:
    """All lights below a root, moved and chosen from in bulk.

    Args:
        lamps: in the order of the walk.
        anchors: what their places refer to.
    """

    def __init__(self, lamps: Sequence[Lamp], anchors: Sequence[Anchor]) -> None:
        columns = np.zeros((len(lamps), 4, 2))
        columns[:, 3, 0] = 1.0  # where it is
        columns[:, 2, 1] = -1.0  # and whither it looks
        self._movers = Movers([lamp.place for lamp in lamps], columns, anchors)
        self._columns = self._movers.start.copy()
        self._gated = Gated([lamp.gates for lamp in lamps])
        self._lamps = lamps
        nodes = [lamp.node() for lamp in lamps]
        self._reaches = np.array([0.0 if node is None else node.reach for node in nodes])

    def lights(self, tables: Tables, opened: Marks, planes: FloatArray, eye: Vec3) -> list[Light]:
        """What shines into the picture: the nearest lamps first, at most `MAX_LIGHTS`."""
        if not self._lamps:
            return []
        for part, moved in self._movers.moved(tables):
            self._columns[part] = moved
        columns = self._columns[self._movers.slots]
        distances = planes[:, :3] @ columns[:, :3, 0].T + planes[:, 3:]
        inside = distances.min(axis=0) > -self._reaches
        passed = self._gated.passed(opened)
        if passed is not None:
            inside &= passed
        chosen = np.flatnonzero(inside)
        away = ((columns[chosen, :3, 0] - eye) ** 2).sum(axis=1)
        result: list[Light] = []
        for k in chosen[np.argsort(away, kind="stable")].tolist():
            node = self._lamps[k].node()
            if node is not None and node.intensity * max(node.colour) > 0.0:
                position, direction = (Vec3(*column) for column in columns[k, :3].T.tolist())
                result.append(node.light(position, direction.normalized()))
                if len(result) == MAX_LIGHTS:
                    break
        return result
