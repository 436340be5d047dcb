"""The camera: it flies freely, or rides on something that can be steered."""

from __future__ import annotations

import math
from typing import Any, Literal

from osgode.engine.composite import ControllableObject, carrier_of
from osgode.engine.controllable import MOVES, Controllable
from osgode.errors import FieldError, StateError, shown
from osgode.fields import POSITION_LIMIT, number, vector
from osgode.graph.frame import View
from osgode.maths import Pose, Vec3, Vec3Like
from osgode.nodes.base import PhysicsNode
from osgode.nodes.geom import Geom
from osgode.nodes.hit import Hit
from osgode.nodes.primitives import Sphere
from osgode.nodes.spaces import Space
from osgode.nodes.world import World

Matching = Literal["absolute", "delta"]

FIELD_OF_VIEW = number(0.01, 3.1)
DISTANCE = number(0.0, 1e4)
ASIDE = number(-1e4, 1e4)
SPEED = number(0.0, 1e4)
CLIP = number(1e-4, 1e7)


class Camera(Controllable):
    """What the picture is taken with.

    Free, it flies at a constant speed where its `wish` and its angles lead, through everything. On a carrier
    (`ride`) its place is the carrier's eye, and the carrier is steered: it is told the camera's moves, and

    - with matching ``"absolute"`` the camera's own angles, to turn towards: a walker;
    - with matching ``"delta"`` what they changed by in each frame, while the camera looks where the carrier's eye
      does: a car, an aeroplane.

    Args:
        position: metres in the world.
        speed: of free flight, m/s.
        field_of_view: vertical, radians.
        near, far: distances of the clipping planes, metres.
        distance: in metres how far behind the carrier's eye it stands: 0 first person, more: third person.
        aside: how far to the right of it then, metres.
        world: that it aims in; a `Scene` sets it.
        obstacles: what mustn't come between it and the carrier's eye in third person; a `Scene` gives its static space.

    Raises:
        FieldError: for bad numbers.
    """

    CLEARANCE = 0.25
    """Metres that it keeps from obstacles in third person."""

    def __init__(
        self,
        position: Vec3Like = (0.0, 1.7, 0.0),
        *,
        speed: float = 8.0,
        field_of_view: float = 1.1,
        near: float = 0.1,
        far: float = 1000.0,
        distance: float = 0.0,
        aside: float = 0.0,
        world: World | None = None,
        obstacles: Space | None = None,
    ) -> None:
        super().__init__()
        self.position = position
        self.speed = speed
        self.field_of_view = field_of_view
        self.set_clipping(near, far)
        self.distance = distance
        self.aside = aside
        self.world = world
        self.obstacles = obstacles
        self._carrier: ControllableObject | None = None
        self._matching: Matching = "absolute"
        self._pose = Pose()
        self._behind = 0.0
        self._interpolation = 1.0
        self._probe = Sphere(self.CLEARANCE)

    # -- settings

    @property
    def position(self) -> Vec3:
        """Where it is in the world, metres; on a carrier that is the carrier's business."""
        return self._position

    @position.setter
    def position(self, value: Vec3Like) -> None:
        self._position = vector(POSITION_LIMIT)("Camera", "position", value)

    @property
    def speed(self) -> float:
        """Of free flight, m/s."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._speed = SPEED("Camera", "speed", value)

    @property
    def field_of_view(self) -> float:
        """Vertical, radians."""
        return self._field_of_view

    @field_of_view.setter
    def field_of_view(self, value: float) -> None:
        self._field_of_view = FIELD_OF_VIEW("Camera", "field_of_view", value)

    @property
    def aside(self) -> float:
        """Metres to the right of the carrier's eye in third person, so that its head hides nothing."""
        return self._aside

    @aside.setter
    def aside(self, value: float) -> None:
        self._aside = ASIDE("Camera", "aside", value)

    @property
    def distance(self) -> float:
        """Metres behind the carrier's eye; 0 is first person."""
        return self._distance

    @distance.setter
    def distance(self, value: float) -> None:
        self._distance = DISTANCE("Camera", "distance", value)

    @property
    def clipping(self) -> tuple[float, float]:
        """Distances of the near and the far clipping plane, metres."""
        return self._clipping

    def set_clipping(self, near: float, far: float) -> None:
        """Set both clipping planes, metres.

        Raises:
            FieldError: unless 0 < near < far.
        """
        planes = CLIP("Camera", "near", near), CLIP("Camera", "far", far)
        if planes[0] >= planes[1]:
            raise FieldError(f"Camera: near is {near!r} and far is {far!r}; near must be less")
        self._clipping = planes

    # -- looking

    @property
    def pose(self) -> Pose:
        """Where the picture is taken from: in free flight where it is now, on a carrier as of the last `update`."""
        return Pose(self._position, self.rotation) if self._carrier is None else self._pose

    def view(self) -> View:
        """What the picture is taken with."""
        return View(self.pose, self._field_of_view, *self._clipping)

    def look_at(self, target: Vec3Like) -> None:
        """Turn towards a point of the world; with matching ``"delta"`` it is the carrier that turns there.

        Raises:
            FieldError: if it stands just there.
        """
        way = vector(POSITION_LIMIT)("Camera.look_at()", "target", target) - self._eye
        if way.length < 1e-9:
            raise FieldError(f"Camera.look_at(): target is {shown(target)}, which is where the camera is")
        yaw, pitch = self._angles_towards(way)
        if self._carrier is not None and self._matching == "delta":
            old_yaw, old_pitch = self._angles_towards(self.forward)
            self._carrier.controls.turn(math.remainder(yaw - old_yaw, math.tau), pitch - old_pitch)
            return
        self.yaw, self.pitch, self.roll = yaw, pitch, 0.0
        if self._carrier is not None:
            self.update(0.0, self._interpolation)

    def look(self, right: float, down: float) -> None:
        """Turn by so many radians: what a mouse does."""
        if self._carrier is not None and self._matching == "delta":
            self._carrier.controls.turn(-right, -down)
        else:
            self.turn(-right, -down)

    @property
    def forward(self) -> Vec3:
        """The direction in which it looks, length 1."""
        return self.pose.rotation.rotate((0.0, 0.0, -1.0))

    @property
    def _eye(self) -> Vec3:
        """What it turns about and aims from: in third person it stands behind that."""
        return self.pose.position + self.forward * self._behind

    def _angles_towards(self, way: Vec3) -> tuple[float, float]:
        """Yaw and pitch that look along ``way``; straight up or down the yaw is as it is."""
        level = math.hypot(way.x, way.z)
        yaw = math.atan2(-way.x, -way.z) if level > 1e-9 * way.length else self.yaw
        return yaw, math.atan2(way.y, level)

    # -- riding

    @property
    def carrier(self) -> ControllableObject | None:
        """What it rides on, None in free flight."""
        return self._carrier

    @property
    def matching(self) -> Matching:
        """How the carrier follows the camera's angles."""
        return self._matching

    def ride(self, carrier: ControllableObject, matching: Matching = "absolute") -> None:
        """Ride on ``carrier`` from now on, and steer it.

        Raises:
            FieldError: if it is no ControllableObject, or there is no such matching.
            StateError: if it is in no World, or has no body.
        """
        if not isinstance(carrier, ControllableObject):
            raise FieldError(f"Camera.ride(): carrier is {shown(carrier)}; it must be a ControllableObject")
        if matching not in ("absolute", "delta"):
            raise FieldError(f"Camera.ride(): matching is {matching!r}; it must be 'absolute' or 'delta'")
        if not carrier.is_live:
            raise StateError(f"Camera.ride(): {carrier.describe()} is in no World; attach it first")
        _ = carrier.main_body  # or it has no eye
        self.dismount()
        self._carrier = carrier
        self._matching = matching
        if matching == "absolute":
            self.yaw, self.pitch = carrier.controls.yaw, carrier.controls.pitch
        try:
            carrier.boarded()
            self.update(0.0)
        except BaseException:
            if self._carrier is carrier:  # it is of no use as one
                self._carrier = None
            raise

    def ride_what_is_aimed_at(self, reach: float = 100.0, matching: Matching = "absolute") -> ControllableObject | None:
        """Ride on the controllable object in the middle of the picture, if there is one within reach; returns it."""
        hit = self.aim(reach)
        carrier = carrier_of(hit.geom) if hit is not None else None
        if carrier is not None:
            self.ride(carrier, matching)
        return carrier

    def dismount(self) -> None:
        """Leave the carrier and fly freely from here, looking the same way; nothing happens if there is none."""
        carrier = self._carrier
        if carrier is None:
            return
        self._position = self._pose.position
        if self._matching == "delta":
            self.yaw, self.pitch = self._angles_towards(self.forward)
            self.roll = 0.0
        self._carrier, self._behind = None, 0.0
        carrier.left()

    def _lose(self) -> None:
        """Dismount from what was destroyed."""
        if self._carrier is not None and not (self._carrier.is_live and self._carrier.bodies):
            self.dismount()

    # -- frames

    def steer(self) -> None:
        """Tell the carrier what the camera wants, before the steps of a frame."""
        self._lose()
        carrier = self._carrier
        if carrier is None:
            return
        carrier.controls.move(**{name: name in self._moves for name in MOVES})
        if self._matching == "absolute":
            carrier.controls.yaw, carrier.controls.pitch = self.yaw, self.pitch

    def update(self, seconds: float, interpolation: float = 1.0) -> None:
        """Come to where the picture of this frame is taken from.

        Args:
            seconds: that the frame took, for free flight.
            interpolation: between the last two steps, as in `World.interpolated_poses`.
        """
        self._lose()
        carrier, self._interpolation = self._carrier, interpolation
        if carrier is None:
            self.position = self._position + self.movement * (self._speed * seconds)
            return
        eye = carrier.eye_pose(interpolation)
        rotation = self.rotation if self._matching == "absolute" else eye.rotation
        way = rotation.rotate((self._aside, 0.0, self._distance))
        share = self._room_for(eye.position, way) if self._distance > 0.0 else 0.0
        self._behind = self._distance * share
        self._pose = Pose(eye.position + way * share, rotation)
        self._position = self._pose.position

    def _room_for(self, eye: Vec3, way: Vec3) -> float:
        """What part of its way back it may go: a small sphere is swept, so that no wall cuts the near plane."""
        space, passed = self.obstacles, list[Geom]()
        while space is not None and space.is_live:
            hit = space.sweep(self._probe, eye, way, exclude=passed)
            if hit is None:
                break
            if not hit.geom.sensor:
                return hit.fraction
            passed.append(hit.geom)
        return 1.0

    @property
    def aiming_ray(self) -> tuple[Vec3, Vec3]:
        """Where the ray through the middle of the picture begins, and its direction of length 1.

        In third person it begins beside the carrier's eye: what is between that and the camera is behind the one who
        aims.
        """
        return self._eye, self.forward

    def aim(self, reach: float = 1000.0, **filters: Any) -> Hit | None:
        """What is in the middle of the picture: the first geom that the camera looks at, or None.

        Its carrier is left out, and so is, in third person, what stands between camera and eye. Sensors are looked
        through.

        Args:
            reach: metres from the eye.
            **filters: ``kinds`` and ``exclude`` of `World.cast_ray`.

        Raises:
            StateError: if the camera has no world.
        """
        if self.world is None:
            raise StateError("Camera.aim(): the camera has no world to aim in; set Camera.world")
        given = filters.pop("exclude", ())
        exclude = [given] if isinstance(given, PhysicsNode) else list(given)
        if self._carrier is not None and self._carrier.world is self.world:
            exclude.append(self._carrier)
        while True:
            hit = self.world.cast_ray(self._eye, self.forward, reach, exclude=exclude, **filters)
            if hit is None or not hit.geom.sensor:
                return hit
            exclude.append(hit.geom)
