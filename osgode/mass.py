"""Mass, centre of mass and inertia of bodies and their parts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from osgode.errors import FieldError
from osgode.fields import LENGTH, OFFSET_LIMIT, POSITION_LIMIT, SIZE, SMALLEST, Check, number, vector
from osgode.maths import IDENTITY, ZERO, Pose, Quat, Vec3, Vec3Like

Matrix3: TypeAlias = tuple[Vec3, Vec3, Vec3]

TOTAL: Check[float] = number(SMALLEST, 1e15)
ROUNDING = 1e-12
"""What is left of a mass after a subtraction, when that was all of it."""
CENTRE: Check[Vec3] = vector(OFFSET_LIMIT)


def _matrix(rows: Any) -> Matrix3:
    a, b, c = rows
    row = vector(1e35).convert
    return row(a), row(b), row(c)


INERTIA: Check[Matrix3] = Check("3 rows of 3 numbers within +-1e35", _matrix)


@dataclass(frozen=True, slots=True)
class Mass:
    """How much, where, and how it resists turning.

    Args:
        mass: kg, above 0.
        centre: of mass, metres, in the frame that the mass is described in.
        inertia: about the centre of mass, along the axes of that frame: 3 rows, kg m2.
    """

    mass: float
    centre: Vec3 = ZERO
    inertia: Matrix3 = (Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0))

    def __post_init__(self) -> None:
        for name, check in (("mass", TOTAL), ("centre", CENTRE), ("inertia", INERTIA)):
            object.__setattr__(self, name, check("Mass", name, getattr(self, name)))
        problem = self._problem()
        if problem:
            raise FieldError(f"Mass(mass={self.mass}, centre={tuple(self.centre)}, ...): {problem}")

    def _problem(self) -> str:
        tensor = np.array(self.inertia)
        size = float(np.abs(tensor).max())
        if float(np.abs(tensor - tensor.T).max()) > 1e-9 * size:
            return "inertia must be symmetric"
        if tensor[0, 1] == tensor[0, 2] == tensor[1, 2] == 0.0:
            low, middle, high = sorted((tensor[0, 0], tensor[1, 1], tensor[2, 2]))
        else:
            low, middle, high = np.linalg.eigvalsh(tensor)
        if not low >= SMALLEST:
            return f"inertia must be positive definite, each principal moment at least 1e-12 kg m2 (least: {low:g})"
        if high > (low + middle) * (1 + 1e-6):
            return "inertia must be of a real thing: no principal moment above the sum of the other two"
        return ""

    # -- shapes: formulas as in any table of moments of inertia (ODE's own order of operations, for the same bits)

    @classmethod
    def sphere(cls, radius: float, *, mass: float | None = None, density: float | None = None) -> Mass:
        """A solid sphere about the origin, of a total ``mass`` (kg) or a ``density`` (kg/m3)."""
        r = LENGTH("Mass.sphere", "radius", radius)
        m = _total(mass, density, 4.0 / 3.0 * math.pi * r**3, "sphere")
        return _diagonal(m, *(3 * (0.4 * m * r * r,)))

    @classmethod
    def box(cls, size: Vec3Like, *, mass: float | None = None, density: float | None = None) -> Mass:
        """A solid box about the origin, of a total ``mass`` (kg) or a ``density`` (kg/m3)."""
        x, y, z = SIZE("Mass.box", "size", size)
        m = _total(mass, density, x * y * z, "box")
        return _diagonal(m, m / 12.0 * (y * y + z * z), m / 12.0 * (x * x + z * z), m / 12.0 * (x * x + y * y))

    @classmethod
    def capsule(cls, radius: float, length: float, *, mass: float | None = None, density: float | None = None) -> Mass:
        """A solid capsule along z about the origin; ``length`` is that of the cylindrical part."""
        a, b = LENGTH("Mass.capsule", "radius", radius), LENGTH("Mass.capsule", "length", length)
        barrel = math.pi * a * a * b
        caps = (4.0 / 3.0) * math.pi * a * a * a
        m = _total(mass, density, barrel + caps, "capsule")
        across = barrel * (0.25 * a * a + (1.0 / 12.0) * b * b) + caps * (0.4 * a * a + 0.375 * a * b + 0.25 * b * b)
        along = (barrel * 0.5 + caps * 0.4) * a * a
        scale = m / (barrel + caps)
        return _diagonal(m, across * scale, across * scale, along * scale)

    @classmethod
    def cylinder(cls, radius: float, length: float, *, mass: float | None = None, density: float | None = None) -> Mass:
        """A solid cylinder along z about the origin."""
        r, h = LENGTH("Mass.cylinder", "radius", radius), LENGTH("Mass.cylinder", "length", length)
        r2 = r * r
        m = _total(mass, density, math.pi * r2 * h, "cylinder")
        across = m * (0.25 * r2 + (1.0 / 12.0) * h * h)
        return _diagonal(m, across, across, m * 0.5 * r2)

    @classmethod
    def mesh(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        mass: float | None = None,
        density: float | None = None,
    ) -> Mass:
        """What a closed surface of triangles, counter-clockwise from outside, encloses.

        Volume, centre and second moments are sums over the tetrahedra from the origin to each triangle
        (J. Blow, A. Binstock, "How to find the inertia tensor of a 3D solid body", 2004).

        Raises:
            FieldError: if the surface is open or turned inside out.
        """
        try:
            refuse_complex(vertices)
            given, indices = np.asarray(vertices, dtype=np.float64), np.asarray(triangles)
        except (TypeError, ValueError, OverflowError) as error:
            raise FieldError(f"Mass.mesh: vertices and triangles must be tables of numbers: {error}") from error
        if given.shape[1:] != (3,) or indices.shape[1:] != (3,) or not len(indices) or indices.dtype.kind not in "iu":
            raise FieldError("Mass.mesh: vertices must be (n, 3) numbers, and triangles (m, 3) indices, at least one")
        if indices.min() < 0 or indices.max() >= len(given):
            raise FieldError(f"Mass.mesh: triangles must be indices of the {len(given)} vertices")
        # Models repeat a vertex for each texture seam; what counts here is where it is.
        points, merged = np.unique(given, axis=0, return_inverse=True)
        faces = merged.reshape(-1)[indices]
        corners = points[faces]
        if not is_closed(faces):
            raise FieldError("the mesh is open: each edge must belong to two triangles, once in each direction")
        origin = corners.reshape(-1, 3).mean(axis=0)  # near the solid, so that nothing cancels
        a, b, c = np.moveaxis(corners - origin, 1, 0)
        six = np.einsum("ij,ij->i", a, np.cross(b, c))
        volume = six.sum() / 6.0
        if not volume > 0.0:
            raise FieldError(f"the mesh encloses {volume:g} m3; its triangles must be counter-clockwise from outside")
        m = _total(mass, density, float(volume), "mesh")
        total = a + b + c
        centre = (six[:, None] * total).sum(axis=0) / (24.0 * volume)
        second = sum(np.einsum("i,ij,ik->jk", six, v, v) for v in (a, b, c, total)) / 120.0
        second = second / volume - np.outer(centre, centre)
        tensor = m * (np.trace(second) * np.identity(3) - second)
        tensor = (tensor + tensor.T) / 2
        return cls(m, Vec3(*map(float, centre + origin)), _rows(tensor))

    # -- arithmetic

    def __add__(self, other: Mass) -> Mass:
        """Both together, by the parallel-axis theorem."""
        if not isinstance(other, Mass):
            return NotImplemented
        m = self.mass + other.mass
        centre = (self.centre * self.mass + other.centre * other.mass) / m
        tensor = self.inertia_about(centre) + other.inertia_about(centre)
        return Mass(m, centre, _rows(tensor))

    def __radd__(self, other: object) -> Mass:
        """So that ``sum()``, which begins with 0, adds masses."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __sub__(self, other: Mass) -> Mass:
        """What is left when ``other`` is cut out, by the parallel-axis theorem: ``(a + b) - b`` is ``a``.

        Raises:
            FieldError: if nothing real is left: ``other`` is no part of this, or all of it.
        """
        if not isinstance(other, Mass):
            return NotImplemented
        m = self.mass - other.mass
        whole = f"{self.mass:g} kg about {tuple(self.centre)} less {other.mass:g} kg about {tuple(other.centre)}"
        if m <= ROUNDING * self.mass:
            raise FieldError(f"{whole}: nothing is left; the second must be a part of the first")
        centre = (self.centre * self.mass - other.centre * other.mass) / m
        tensor = self.inertia_about(centre) - other.inertia_about(centre)
        try:
            return Mass(m, centre, _rows(tensor))
        except FieldError as error:
            raise FieldError(
                f"{whole} leaves nothing real, so the second must be no part of the first: {error}"
            ) from error

    def __mul__(self, factor: float) -> Mass:
        """The same distribution ``factor`` times as heavy, as of another density."""
        if not isinstance(factor, (int, float, np.integer, np.floating)) or isinstance(factor, bool):
            return NotImplemented
        return self.scaled(number(0.0, 1e30)("Mass *", "factor", factor) * self.mass)

    def __rmul__(self, factor: float) -> Mass:
        return self * factor

    def __truediv__(self, divisor: float) -> Mass:
        """The same distribution with that part of the mass."""
        if not isinstance(divisor, (int, float, np.integer, np.floating)) or isinstance(divisor, bool):
            return NotImplemented
        return self.scaled(self.mass / number(1e-30, 1e30)("Mass /", "divisor", divisor))

    def inertia_about(self, point: Vec3Like) -> npt.NDArray[np.float64]:
        """The inertia tensor about another point, 3x3, by the parallel-axis theorem."""
        x, y, z = self.centre - point
        shift = np.array(
            [[y * y + z * z, -x * y, -x * z], [-x * y, x * x + z * z, -y * z], [-x * z, -y * z, x * x + y * y]]
        )
        return np.array(self.inertia) + self.mass * shift

    def translated(self, by: Vec3Like) -> Mass:
        """The same mass elsewhere."""
        return Mass(self.mass, self.centre + vector(POSITION_LIMIT)("Mass.translated()", "by", by), self.inertia)

    def rotated(self, by: Quat) -> Mass:
        """The same mass turned about the origin."""
        if by == IDENTITY:
            return self
        turn = np.array(by.to_matrix())
        tensor = turn @ np.array(self.inertia) @ turn.T
        return Mass(self.mass, by.rotate(self.centre), _rows((tensor + tensor.T) / 2))

    def moved(self, by: Pose) -> Mass:
        """A mass given in a frame, seen from the frame that ``by`` places it in."""
        return self if by == Pose() else self.rotated(by.rotation).translated(by.position)

    def scaled(self, mass: float) -> Mass:
        """The same distribution with another total."""
        factor = TOTAL("Mass.scaled()", "mass", mass) / self.mass
        rows = (self.inertia[0] * factor, self.inertia[1] * factor, self.inertia[2] * factor)
        return Mass(mass, self.centre, rows)


def refuse_complex(table: npt.ArrayLike) -> None:
    """Raise TypeError for complex numbers: numpy would drop the imaginary part with a mere warning."""
    if np.iscomplexobj(table):
        raise TypeError("complex numbers")


def is_closed(triangles: npt.ArrayLike) -> bool:
    """Whether each edge of the (m, 3) triangles is met exactly as often in one direction as in the other."""
    t = np.asarray(triangles, dtype=np.int64)
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    key = edges.max() + 1
    there, back = edges[:, 0] * key + edges[:, 1], edges[:, 1] * key + edges[:, 0]
    return bool(np.array_equal(np.sort(there), np.sort(back)))


def _total(mass: float | None, density: float | None, volume: float, shape: str) -> float:
    if (mass is None) == (density is None):
        raise FieldError(f"Mass.{shape}: give either mass or density")
    if mass is not None:
        return TOTAL(f"Mass.{shape}", "mass", mass)
    value = number(0.0)(f"Mass.{shape}", "density", density) * volume
    return TOTAL(f"Mass.{shape}", "density * volume", value)


def _diagonal(mass: float, x: float, y: float, z: float) -> Mass:
    return Mass(mass, ZERO, (Vec3(x, 0.0, 0.0), Vec3(0.0, y, 0.0), Vec3(0.0, 0.0, z)))


def _rows(tensor: npt.NDArray[np.float64]) -> Matrix3:
    a, b, c = (Vec3(*map(float, row)) for row in tensor)
    return a, b, c
