"""The camera: it flies freely, or rides on something that can be steered."""

from __future__ import annotations

import math
from typing import Any, Literal

from osgode.engine.composite import ControllableObject, carrier_of
from osgode.engine.controllable import MOVES, Controllable
from osgode.errors import FieldError, StateError, shown
from osgode.fields import POSITION_LIMIT, number, vector
from osgode.graph.frame import View
from osgode.maths import Pose, Quat, Vec3, Vec3Like, look_at
from osgode.nodes.hit import Hit
from osgode.nodes.primitives import Sphere
from osgode.nodes.spaces import Space
from osgode.nodes.world import World

Matching = Literal["absolute", "delta"]

FIELD_OF_VIEW = number(0.01, 3.1)
DISTANCE = number(0.0, 1e4)
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
        world: World | None = None,
        obstacles: Space | None = None,
    ) -> None:
        super().__init__()
        self.position = position
        self.speed = speed
        self.field_of_view = field_of_view
        self.set_clipping(near, far)
        self.distance = distance
        self.world = world
        self.obstacles = obstacles
        self._carrier: ControllableObject | None = None
        self._matching: Matching = "absolute"
        self._pose = Pose(self.position, self.rotation)
        self._behind = 0.0
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
        """Where the picture is taken from, as of the last `update`."""
        return self._pose

    def view(self) -> View:
        """What the picture is taken with, as of the last `update`."""
        return View(self._pose, self._field_of_view, *self._clipping)

    def look_at(self, target: Vec3Like) -> None:
        """Turn towards a point of the world.

        Raises:
            FieldError: if it stands just there.
        """
        point = vector(POSITION_LIMIT)("Camera.look_at()", "target", target)
        if point.distance(self._pose.position if self._carrier else self._position) < 1e-9:
            raise FieldError(f"Camera.look_at(): target is {shown(target)}, which is where the camera is")
        self._turn_to(look_at(self._pose.position if self._carrier else self._position, point).rotation)

    def look(self, right: float, down: float) -> None:
        """Turn by so many radians: what a mouse does."""
        if self._carrier is not None and self._matching == "delta":
            self._carrier.controls.turn(-right, -down)
        else:
            self.turn(-right, -down)

    def _turn_to(self, rotation: Quat) -> None:
        forward = rotation.rotate((0.0, 0.0, -1.0))
        self.yaw = math.atan2(-forward.x, -forward.z)
        self.pitch = math.asin(min(max(forward.y, -1.0), 1.0))
        self.roll = 0.0

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
            StateError: if it is in no World.
        """
        if not isinstance(carrier, ControllableObject):
            raise FieldError(f"Camera.ride(): carrier is {shown(carrier)}; it must be a ControllableObject")
        if matching not in ("absolute", "delta"):
            raise FieldError(f"Camera.ride(): matching is {matching!r}; it must be 'absolute' or 'delta'")
        if not carrier.is_live:
            raise StateError(f"Camera.ride(): {carrier.describe()} is in no World; attach it first")
        self.dismount()
        self._carrier = carrier
        self._matching = matching
        if matching == "absolute":
            self.yaw, self.pitch = carrier.controls.yaw, carrier.controls.pitch
        carrier.boarded()
        self.update(0.0)

    def ride_what_is_aimed_at(self, reach: float = 100.0, matching: Matching = "absolute") -> ControllableObject | None:
        """Ride on the controllable object in the middle of the picture, if there is one within reach; returns it."""
        hit = self.aim(reach)
        carrier = carrier_of(hit.geom) if hit is not None else None
        if carrier is not None:
            self.ride(carrier, matching)
        return carrier

    def dismount(self) -> None:
        """Leave the carrier and fly freely from here, looking the same way; nothing happens if there is none."""
        carrier, self._carrier = self._carrier, None
        if carrier is None:
            return
        self.position = self._pose.position
        self._turn_to(self._pose.rotation)
        self._behind = 0.0
        carrier.left()

    # -- frames

    def steer(self) -> None:
        """Tell the carrier what the camera wants, before the steps of a frame."""
        carrier = self._carrier
        if carrier is None:
            return
        if not carrier.is_live:  # it was destroyed
            self.dismount()
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
        carrier = self._carrier
        if carrier is not None and not carrier.is_live:
            self.dismount()
            carrier = None
        if carrier is None:
            self.position = self._position + self.movement * (self._speed * seconds)
            self._pose = Pose(self._position, self.rotation)
            return
        eye = carrier.eye_pose(interpolation)
        rotation = self.rotation if self._matching == "absolute" else eye.rotation
        back = rotation.rotate((0.0, 0.0, 1.0))
        self._behind = self._room_behind(eye.position, back) if self._distance > 0.0 else 0.0
        self._pose = Pose(eye.position + back * self._behind, rotation)
        self._position = self._pose.position

    def _room_behind(self, eye: Vec3, back: Vec3) -> float:
        """How far it may go back: a small sphere is swept from the eye, so that no wall cuts the near plane."""
        space = self.obstacles
        if space is None or not space.is_live:
            return self._distance
        hit = space.sweep(self._probe, eye, back * self._distance)
        return self._distance if hit is None else self._distance * hit.fraction

    def aim(self, reach: float = 1000.0, **filters: Any) -> Hit | None:
        """What is in the middle of the picture: the first geom that the camera looks at, its carrier left out.

        Args:
            reach: metres from the eye.
            **filters: ``kinds`` and ``exclude`` of `World.cast_ray`.

        Raises:
            StateError: if the camera has no world.
        """
        if self.world is None:
            raise StateError("Camera.aim(): the camera has no world to aim in; set Camera.world")
        forward = self.forward
        exclude = list(filters.pop("exclude", ()))
        if self._carrier is not None and self._carrier.is_live:
            exclude.append(self._carrier)
        # In third person what is between the camera and the eye is behind the one who aims.
        origin = self._pose.position + forward * self._behind
        return self.world.cast_ray(origin, forward, reach, exclude=exclude, **filters)

    @property
    def forward(self) -> Vec3:
        """The direction in which it looks, length 1."""
        return self._pose.rotation.rotate((0.0, 0.0, -1.0))
