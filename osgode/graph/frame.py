"""The description of one picture: plain data that any drawer can read.

The scene graph makes it, `osgode.render` draws it. Nodes hold nothing of a renderer, and a test can
look at a Frame instead of at pixels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError
from osgode.fields import DIRECTION, FLAG, Check, number, optional, three
from osgode.graph.appearance import Appearance, Texture
from osgode.graph.mesh import Mesh
from osgode.maths import Float32Array, FloatArray, Pose, Vec3, finite


def _light(value: Any) -> tuple[float, float, float]:
    parts = three(value)
    if not (finite(parts) and min(parts) >= 0.0):
        raise ValueError
    return (parts.x, parts.y, parts.z)


LIGHT: Check[tuple[float, float, float]] = Check("three finite numbers, 0 or more", _light)
HAZE = optional(number(1e-6, 1e9))


def _check(owner: Sun | Sky, **checks: Check[Any]) -> None:
    for name, check in checks.items():
        object.__setattr__(owner, name, check(type(owner).__name__, name, getattr(owner, name)))


@dataclass(frozen=True)
class View:
    """Where the picture is taken from, and how.

    Args:
        pose: of the camera, which looks along its own -Z with Y up.
        field_of_view: vertical, radians.
        near, far: distances of the clipping planes, metres.
    """

    pose: Pose = Pose()
    field_of_view: float = 1.0
    near: float = 0.1
    far: float = 1000.0

    def view_matrix(self) -> FloatArray:
        """The 4x4 matrix from world to camera axes."""
        return self.pose.inverse().matrix()

    def projection_matrix(self, aspect: float) -> FloatArray:
        """The 4x4 OpenGL perspective matrix (depth -1 to 1) for a picture ``aspect`` times as wide as high."""
        f = 1.0 / np.tan(self.field_of_view / 2)
        n, r = self.near, self.far
        out = np.zeros((4, 4))
        out[0, 0] = f / aspect
        out[1, 1] = f
        out[2, 2] = (r + n) / (n - r)
        out[2, 3] = 2 * r * n / (n - r)
        out[3, 2] = -1.0
        return out

    def ray(self, x: float, y: float, size: tuple[int, int]) -> tuple[Vec3, Vec3]:
        """What lies behind a point of the picture: the eye, and the direction of length 1 from there, in the world.

        Args:
            x: pixels from the left of the picture; the middle of the first pixel is at 0.5.
            y: pixels from its top.
            size: of the picture, pixels (width, height).

        Raises:
            FieldError: if the point is not two finite numbers, or the size not two positive ones.
        """
        width, height = size
        if not (width > 0 and height > 0):
            raise FieldError(f"View.ray: size is {size!r}; both must be above 0")
        if not finite((x, y)):
            raise FieldError(f"View.ray: the point is {(x, y)!r}; it must be two finite numbers")
        slope = math.tan(self.field_of_view / 2)
        right, up = (2.0 * x - width) / height * slope, (1.0 - 2.0 * y / height) * slope
        return self.pose.position, self.pose.rotation.rotate(Vec3(right, up, -1.0).normalized())


@dataclass(frozen=True)
class Sun:
    """Light from far away, which casts shadows.

    Args:
        direction: in which the light travels, of any length.
        colour: red, green, blue; may be above 1.
        ambient: the light that comes from everywhere, red, green, blue.
        shadows: whether it casts them.

    Raises:
        FieldError: for what is no direction, or no colour.
    """

    direction: Vec3 = Vec3(-0.45, -0.8, -0.4)
    colour: tuple[float, float, float] = (1.0, 0.96, 0.88)
    ambient: tuple[float, float, float] = (0.38, 0.42, 0.5)
    shadows: bool = True

    def __post_init__(self) -> None:
        _check(self, direction=DIRECTION, colour=LIGHT, ambient=LIGHT, shadows=FLAG)


@dataclass(frozen=True)
class Sky:
    """What is seen where nothing is: a gradient from the horizon to the zenith, and the haze before it.

    Args:
        zenith, horizon: red, green, blue.
        haze: distance in metres at which things have almost taken the horizon's colour; None for clear air.

    Raises:
        FieldError: for what is no colour, or a distance that isn't above 0.
    """

    zenith: tuple[float, float, float] = (0.30, 0.52, 0.82)
    horizon: tuple[float, float, float] = (0.78, 0.86, 0.93)
    haze: float | None = 400.0

    def __post_init__(self) -> None:
        _check(self, zenith=LIGHT, horizon=LIGHT, haze=HAZE)


MAX_LIGHTS = 8
"""How many lights a picture may have beside the sun."""


@dataclass(frozen=True)
class Light:
    """A lamp in the world, without shadows.

    Args:
        position: where it is, metres.
        colour: red, green, blue, as of the `Sun`; what arrives at a distance ``d`` is this times
            ``(1 - (d / reach)**2)**2``.
        reach: metres beyond which nothing arrives.
        direction: the middle of its cone, of length 1; None if it shines to all sides.
        outer: the angle from there to where the cone ends, radians.
        inner: the angle up to which it is fully bright, below ``outer``.

    Raises:
        FieldError: if the reach is not above 0.
    """

    position: Vec3
    colour: tuple[float, float, float]
    reach: float
    direction: Vec3 | None = None
    outer: float = math.pi / 2
    inner: float = 0.0

    def __post_init__(self) -> None:
        if not self.reach > 0.0:
            raise FieldError(f"Light.reach is {self.reach!r}; it must be above 0")


@dataclass(frozen=True, eq=False)
class Bin:
    """Many copies of one mesh with one appearance: one instanced draw.

    Args:
        matrices: (n, 4, 4) float32, ``v_world = matrix @ v_mesh``.
        spheres: (n, 4), the centre and the radius of a sphere about each copy, in the world; None if nobody has
            worked them out, then who needs them does.
        mirrored: whether some of the copies may be turned inside out by their matrix; None if nobody knows.
    """

    mesh: Mesh
    appearance: Appearance
    matrices: Float32Array
    spheres: FloatArray | None = None
    mirrored: bool | None = None


@dataclass(frozen=True, eq=False)
class Sprites:
    """Many soft round patches that face the camera: one instanced draw.

    Args:
        rows: (n, 12) float32, in the order in which they are drawn: where the middle is (3), the radius in metres,
            red, green, blue and opacity (4, from 0 to 1), the vector along which it is drawn out in metres (3), and 0.
        additive: whether they shine and add to what is behind them, instead of hiding it and being lit.
    """

    rows: Float32Array
    additive: bool = False


@dataclass(frozen=True, eq=False)
class Lines:
    """Straight lines, of one width in pixels however far they are: one draw call.

    They have neither light nor shadow nor haze. A later line is drawn over an earlier one.

    Args:
        points: (n, 2, 3), the ends of each, metres.
        colours: (n, 4) red, green, blue, opacity of each, bytes or numbers from 0 to 1; or (4,) for all.
        in_front: whether they are seen through everything.
        width: pixels.

    Raises:
        FieldError: if the shapes don't fit, a number is not finite, a colour out of range, or the width not above 0.
    """

    points: Float32Array
    colours: npt.NDArray[np.uint8]
    in_front: bool = False
    width: float = 1.5

    def __post_init__(self) -> None:
        points = np.ascontiguousarray(self.points, np.float32)
        if points.ndim != 3 or points.shape[1:] != (2, 3):
            raise FieldError(f"Lines.points has shape {points.shape}; it must be (n, 2, 3)")
        if not np.isfinite(points).all():
            raise FieldError("Lines.points holds a number that is not finite")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "colours", _colour_bytes(self.colours, len(points)))
        if not 0.0 < self.width < np.inf:
            raise FieldError(f"Lines.width is {self.width!r}; it must be above 0 and finite")

    def __len__(self) -> int:
        return len(self.points)

    def moved(self, matrix: FloatArray) -> Lines:
        """The same lines with ``v = matrix @ v_here``, (4, 4)."""
        moved = (self.points @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
        return Lines(moved, self.colours, self.in_front, self.width)


def _colour_bytes(value: npt.ArrayLike, count: int) -> npt.NDArray[np.uint8]:
    colours = np.asarray(value)
    if colours.shape not in ((4,), (count, 4)):
        raise FieldError(f"Lines.colours has shape {colours.shape}; it must be ({count}, 4) or (4,)")
    if colours.dtype != np.uint8:
        if not (np.isrealobj(colours) and np.issubdtype(colours.dtype, np.number)):
            raise FieldError(f"Lines.colours has type {colours.dtype}; it must be bytes, or numbers from 0 to 1")
        if not ((colours >= 0) & (colours <= 1)).all():
            raise FieldError(
                "Lines.colours holds a number outside of 0 to 1; whole ones up to 255 must be of type uint8"
            )
        colours = np.rint(colours * 255.0).astype(np.uint8)
    return np.ascontiguousarray(np.broadcast_to(colours, (count, 4)))


@dataclass(frozen=True)
class Rectangle:
    """A filled rectangle of the overlay, in pixels from the top left."""

    x: float
    y: float
    width: float
    height: float
    colour: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.5)
    texture: Texture | None = None


@dataclass(frozen=True)
class Text:
    """A line (or lines) of text of the overlay.

    Args:
        x, y: pixels from the top left of the picture.
        text: with line feeds between lines.
        size: height of its em, pixels.
        align: which point of the text is there, in parts of its width and height: (0, 0) its top left corner,
            (0.5, 0.5) its middle, (1, 1) its bottom right corner.
    """

    x: float
    y: float
    text: str
    size: int = 18
    colour: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    align: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Frame:
    """Everything that a drawer needs for one picture.

    ``opaque`` and ``transparent`` hold what the camera sees, ``transparent`` from far to near (each Bin a run
    of neighbours in that order with the same mesh and appearance); ``casters`` what throws shadows into
    the picture; ``front`` what is seen through all of these, as if they weren't there, opaque before transparent;
    ``particles`` come after what is transparent, in order, ``lines`` after what they are hidden by, or after all of it;
    ``overlay`` is drawn last, in order. ``lights`` shine beside the sun, at most `MAX_LIGHTS` of them.
    """

    view: View
    size: tuple[int, int]
    opaque: list[Bin] = field(default_factory=list)
    transparent: list[Bin] = field(default_factory=list)
    casters: list[Bin] = field(default_factory=list)
    overlay: list[Rectangle | Text] = field(default_factory=list)
    sun: Sun = Sun()
    sky: Sky = Sky()
    front: list[Bin] = field(default_factory=list)
    lines: list[Lines] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    particles: list[Sprites] = field(default_factory=list)


class Drawer(Protocol):
    """What draws frames: the real one (`osgode.render`) or one that only records them."""

    def draw(self, frame: Frame) -> None:
        """Draw one picture."""
