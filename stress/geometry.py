"""Polygons of the campaign: integrals, convex parts, overlap. Written anew here, so that a fault in the program's geometry cannot hide itself. SI units."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

Point = tuple[float, float]
Polygon = Sequence[Point]


@dataclass(frozen=True)
class Integrals:
    area: float      # [m2] positive: counter-clockwise
    centroid: Point  # [m]
    polar: float     # [m4] second moment of area about the centroid


def integrals(polygon: Polygon) -> Integrals:
    """Taken about the first vertex, so that a polygon far from the origin loses no digits."""
    ox, oy = polygon[0]
    twice_area = first_x = first_y = polar = 0.0
    for (ax, ay), (bx, by) in edges([(x - ox, y - oy) for x, y in polygon]):
        cross = ax * by - bx * ay
        twice_area += cross
        first_x += cross * (ax + bx)
        first_y += cross * (ay + by)
        polar += cross * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by)
    area = twice_area / 2
    x, y = first_x / (6 * area), first_y / (6 * area)
    return Integrals(area, (ox + x, oy + y), polar / 12 - area * (x * x + y * y))


def edges(polygon: Polygon) -> list[tuple[Point, Point]]:
    return [(polygon[i], polygon[(i + 1) % len(polygon)]) for i in range(len(polygon))]


def cross(o: Point, a: Point, b: Point) -> float:
    """Twice the area of the triangle; positive where it turns left."""
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def counter_clockwise(polygon: Polygon) -> list[Point]:
    return list(polygon) if integrals(polygon).area > 0 else list(reversed(polygon))


def convex(polygon: Polygon) -> bool:
    """Of a counter-clockwise polygon."""
    n = len(polygon)
    return all(cross(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]) >= 0 for i in range(n))


def convex_parts(polygon: Polygon) -> list[list[int]]:
    """Indices of vertices of convex parts that make up a simple counter-clockwise polygon: itself, or triangles (ears cut off one by one)."""
    left = list(range(len(polygon)))
    if convex(polygon):
        return [left]
    parts = []
    while len(left) > 3:
        ear = next((i for i in range(len(left)) if _is_ear(polygon, left, i)), None)
        if ear is None:
            raise ValueError("a polygon that is not simple")
        parts.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    return [*parts, left]


def _is_ear(polygon: Polygon, left: list[int], i: int) -> bool:
    corners = left[i - 1], left[i], left[(i + 1) % len(left)]
    a, b, c = (polygon[k] for k in corners)
    if cross(a, b, c) <= 0:
        return False
    return not any(cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0 for p in (polygon[k] for k in left if k not in corners))


def clip(subject: Polygon, window: Polygon) -> list[Point]:
    """What two convex counter-clockwise polygons have in common (Sutherland and Hodgman)."""
    common = list(subject)
    for a, b in edges(window):
        if not common:
            break
        sides = [cross(a, b, p) for p in common]
        cut = []
        for i, p in enumerate(common):
            before, here = sides[i - 1], sides[i]
            if (before < 0) != (here < 0):
                q, s = common[i - 1], before / (before - here)
                cut.append((q[0] + s * (p[0] - q[0]), q[1] + s * (p[1] - q[1])))
            if here >= 0:
                cut.append(p)
        common = cut
    return common


@dataclass(frozen=True)
class Overlap:
    area: float   # [m2]
    chord: float  # [m] the largest distance of two of its points

    @property
    def depth(self) -> float:
        """[m] Mean width: no deeper than one polygon is in the other."""
        return self.area / self.chord if self.chord > 0 else 0.0


class Body:
    """A polygon with its integrals and convex parts."""

    def __init__(self, vertices: Polygon):
        self.vertices = counter_clockwise(vertices)
        self.integrals = integrals(self.vertices)
        self._parts = convex_parts(self.vertices)
        self.reach = max(math.dist(self.integrals.centroid, p) for p in self.vertices)

    def at(self, vertices: Polygon) -> "Placed":
        return Placed(vertices, self._parts)


def turned(p: Point, shift: Point, rotation: float, about: Point) -> Point:
    """A point of a body that has turned about another one, which has moved by `shift`."""
    c, s = math.cos(rotation), math.sin(rotation)
    x, y = p[0] - about[0], p[1] - about[1]
    return about[0] + shift[0] + c * x - s * y, about[1] + shift[1] + s * x + c * y


class Placed:
    """A body in one place, with the box around it."""

    def __init__(self, vertices: Polygon, parts: list[list[int]]):
        self.vertices = list(vertices)
        self.parts = [[self.vertices[i] for i in part] for part in parts]
        xs, ys = [p[0] for p in vertices], [p[1] for p in vertices]
        self.low, self.high = (min(xs), min(ys)), (max(xs), max(ys))

    def near(self, other: "Placed") -> bool:
        return all(self.low[k] < other.high[k] and other.low[k] < self.high[k] for k in (0, 1))


def overlap(a: Placed, b: Placed) -> Overlap:
    area, points = 0.0, []
    for part in a.parts:
        for other in b.parts:
            common = clip(part, other)
            if len(common) > 2:
                area += integrals_area(common)
                points += common
    return Overlap(area, diameter(points))


def integrals_area(polygon: Polygon) -> float:
    o = polygon[0]
    return sum(cross(o, polygon[i], polygon[i + 1]) for i in range(1, len(polygon) - 1)) / 2


def diameter(points: Sequence[Point]) -> float:
    return max((math.dist(p, q) for i, p in enumerate(points) for q in points[:i]), default=0.0)


def near_pairs(placed: Sequence[Placed]) -> list[tuple[int, int]]:
    """Pairs whose boxes overlap, found by a sweep along x."""
    pairs, open_ones = [], []
    for i in sorted(range(len(placed)), key=lambda k: placed[k].low[0]):
        open_ones = [k for k in open_ones if placed[k].high[0] > placed[i].low[0]]
        pairs += [(k, i) for k in open_ones if placed[k].near(placed[i])]
        open_ones.append(i)
    return pairs


def on_segment(p: Point, a: Point, b: Point, tolerance: float) -> bool:
    length = math.dist(a, b)
    if length == 0:
        return math.dist(p, a) <= tolerance
    along = ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) / length
    return abs(cross(a, b, p)) / length <= tolerance and -tolerance <= along <= length + tolerance
