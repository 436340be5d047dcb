"""A closed line on the ground, as drivers and race tracks need it: how far along, how bent, who is where on it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import osgode as oo


class ClosedLine:
    """Points, each joined to the next and the last to the first.

    Lengths along it and bends are those of its plan, seen from above.

    Args:
        points: at least three, metres in the world, none at the same place as the next.

    Raises:
        FieldError: for fewer, or for two at one place.
    """

    def __init__(self, points: Sequence[oo.Vec3Like]) -> None:
        self.points = tuple(oo.Vec3(*map(float, point)) for point in points)
        if len(self.points) < 3:
            raise oo.FieldError(f"ClosedLine: there are {len(self.points)} points; a closed line needs at least 3")
        self._starts = [0.0]
        self._plan: list[tuple[float, float, float, float, float]] = []  # of each piece: x, z; how far in x, z; length
        for k, point in enumerate(self.points):
            way = _plan(self.points[(k + 1) % len(self.points)] - point)
            step = way.length
            if step < 1e-6:
                raise oo.FieldError(f"ClosedLine: points {k} and the next are both at {tuple(point)}")
            self._starts.append(self._starts[-1] + step)
            self._plan.append((point.x, point.z, way.x, way.z, step))

    def __len__(self) -> int:
        return len(self.points)

    def __iter__(self) -> Iterator[oo.Vec3]:
        return iter(self.points)

    @property
    def length(self) -> float:
        """All the way round, metres."""
        return self._starts[-1]

    def start_of(self, index: int) -> float:
        """How far along the line a point of it is, metres."""
        return self._starts[index % len(self.points)]

    def _index(self, distance: float) -> tuple[int, float]:
        """The point before ``distance``, and what part of the way to the next is done."""
        along = distance % self.length
        low, high = 0, len(self.points)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if self._starts[middle] <= along else (low, middle)
        return low, (along - self._starts[low]) / (self._starts[low + 1] - self._starts[low])

    def at(self, distance: float) -> oo.Vec3:
        """The place so many metres along it; any number, it goes round."""
        index, part = self._index(distance)
        first, second = self.points[index], self.points[(index + 1) % len(self.points)]
        return first + (second - first) * part

    def ahead(self, distance: float) -> oo.Vec3:
        """The level direction in which it leads there, length 1."""
        index, _ = self._index(distance)
        return _plan(self.points[(index + 1) % len(self.points)] - self.points[index]).normalized()

    def yaw(self, distance: float) -> float:
        """The yaw of what looks along it there, radians."""
        ahead = self.ahead(distance)
        return math.atan2(-ahead.x, -ahead.z)

    def bend(self, distance: float) -> float:
        """How strongly it bends there, 1/m, positive to the left.

        That of the circle through three neighbouring points: ``4 area / (a b c)`` of their triangle.
        """
        index, part = self._index(distance)
        middle = index + round(part)
        one, two, three = (self.points[(middle + k) % len(self.points)] for k in (-1, 0, 1))
        first, second = _plan(two - one), _plan(three - two)
        sides = first.length * second.length * (first + second).length
        return 2.0 * first.cross(second).y / sides if sides > 1e-12 else 0.0

    def nearest(self, place: oo.Vec3Like, near: float | None = None, reach: float = 25.0) -> tuple[float, float]:
        """Where on the line someone is, seen from above.

        Args:
            place: in the world.
            near: only so far along the line is looked, and ``reach`` before and behind: for one who was there before.
            reach: metres.

        Returns:
            How far along, and how far aside, metres, positive to the right.
        """
        count = len(self.points)
        if near is None:
            indices: Iterator[int] | range = range(count)
        else:
            first, last = self._index(near - reach)[0], self._index(near + reach)[0]
            indices = range(first, (last if last >= first else last + count) + 1)
        x, _, z = place
        best = (math.inf, 0.0, 0.0)
        for k in indices:
            begin_x, begin_z, way_x, way_z, length = self._plan[k % count]
            to_x, to_z = x - begin_x, z - begin_z
            along = min(max((to_x * way_x + to_z * way_z) / length, 0.0), length)
            off = math.hypot(to_x - way_x * (along / length), to_z - way_z * (along / length))
            if off < best[0]:
                side = math.copysign(off, way_x * to_z - way_z * to_x)
                best = (off, self._starts[k % count] + along, side)
        return best[1] % self.length, best[2]


def _plan(way: oo.Vec3) -> oo.Vec3:
    """What is left of it seen from above."""
    return oo.Vec3(way.x, 0.0, way.z)


def rounded(corners: Sequence[tuple[float, float, float]], spacing: float) -> list[tuple[float, float]]:
    """A polygon whose corners are arcs, as evenly spaced points.

    Args:
        corners: x, z and the radius of the arc at each, metres.
        spacing: about how far apart the points are, metres.

    Raises:
        FieldError: where two arcs don't leave room for each other.
    """
    count = len(corners)
    arcs = []
    for k, (x, z, radius) in enumerate(corners):
        before, after = corners[k - 1], corners[(k + 1) % count]
        into = oo.Vec3(x - before[0], 0.0, z - before[1])
        out = oo.Vec3(after[0] - x, 0.0, after[1] - z)
        turn = math.atan2(into.cross(out).y, into.dot(out))  # positive to the left
        arcs.append((oo.Vec3(x, 0.0, z), into.normalized(), turn, radius, radius * math.tan(abs(turn) / 2)))
    pieces: list[tuple[oo.Vec3, oo.Vec3, float, float]] = []  # start, direction, length, bend
    for k, (corner, into, turn, radius, cut) in enumerate(arcs):
        last = arcs[k - 1]
        straight = last[0].distance(corner) - last[4] - cut
        if straight < 0:
            raise oo.FieldError(f"rounded(): the arcs at corners {(k - 1) % count} and {k} meet; give smaller radii")
        begin = corner - into * cut
        pieces.append((begin - into * straight, into, straight, 0.0))
        pieces.append((begin, into, radius * abs(turn), math.copysign(1 / radius, turn)))
    total = sum(length for _, _, length, _ in pieces)
    number = round(total / spacing)
    points: list[tuple[float, float]] = []
    done = 0.0
    for start, way, length, bend in pieces:
        while len(points) < number and len(points) * total / number < done + length:
            along = len(points) * total / number - done
            left = oo.Vec3(way.z, 0.0, -way.x)
            turn = along * bend
            at = start + way * along
            if bend:
                at = start + way * (math.sin(turn) / bend) + left * ((1 - math.cos(turn)) / bend)
            points.append((at.x, at.z))
        done += length
    return points
