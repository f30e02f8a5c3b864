"""What the examples are compared with: closed forms and limit equilibrium, from geometry and strength alone. Knows nothing of the program."""

import itertools
import math

Point = tuple[float, float]
Corners = list[Point]


def tan_deg(angle_deg: float) -> float:
    return math.tan(math.radians(angle_deg))


def planar_slope(height_m: float, face_deg: float, plane_deg: float, unit_weight: float, friction_deg: float, cohesion_pa: float) -> float:
    """Factor of safety of a wedge on a plane that comes out of the face (Hoek and Bray, Rock Slope Engineering, 1981; dry, no tension crack)."""
    face, plane = math.radians(face_deg), math.radians(plane_deg)
    return tan_deg(friction_deg) / math.tan(plane) + 2 * cohesion_pa * math.sin(face) / (unit_weight * height_m * math.sin(face - plane) * math.sin(plane))


def toppling_friction(width: float, count: int, crest: int, rise: float, fall: float, step: float, dip_deg: float) -> float:
    """tan(friction angle) at the limit of a toppling slope: the recursion from the crest down to the toe of Goodman and Bray (1976)."""
    sin, cos = math.sin(math.radians(dip_deg)), math.cos(math.radians(dip_deg))

    def toe_force(mu: float) -> float:
        force = 0.0
        for k in range(count, 0, -1):
            height = min(k, crest) * (rise - step) - max(0, k - crest) * (fall + step)
            weight = width * height
            slides = force - weight * (cos * mu - sin) / (1 - mu**2)
            if k == 1:
                return slides
            above, below = height - (fall if k >= crest else 0), height - (rise if k <= crest else 0)
            topples = (force * (above - width * mu) + weight * (height * sin - width * cos) / 2) / below
            force = max(0.0, slides, topples)
        raise AssertionError("the first column returns")

    return bisect(lambda mu: toe_force(mu) > 0, math.tan(math.radians(dip_deg)), 1 - 1e-9)


def roof_wedge(squeeze_n: float, weight_n: float, half_angle_deg: float, friction_deg: float) -> float:
    """Factor of safety of a symmetric wedge, narrower above, between walls that press with a known force: equilibrium alone gives the forces on its faces."""
    sin, cos = math.sin(math.radians(half_angle_deg)), math.cos(math.radians(half_angle_deg))
    normal, shear = squeeze_n * cos - weight_n / 2 * sin, squeeze_n * sin + weight_n / 2 * cos
    return normal * tan_deg(friction_deg) / shear


def retaining_wall(widths_m: list[float], height_m: float, unit_weight: float, pressures_pa: list[float], friction_deg: float) -> float:
    """The least factor against sliding on any bed; courses and pressures from below, one height for all."""
    weights = [w * height_m * unit_weight for w in widths_m]
    pushes = [p * height_m for p in pressures_pa]
    return min(sum(weights[k:]) * tan_deg(friction_deg) / sum(pushes[k:]) for k in range(len(weights)))


def overturning(widths_m: list[float], height_m: float, unit_weight: float, pressures_pa: list[float]) -> float:
    """The least ratio of resisting to overturning moment about the front end of any bed; the backs are in one vertical plane."""
    factors = []
    for k in range(len(widths_m)):
        resisting = sum(w * height_m * unit_weight * (widths_m[k] - w / 2) for w in widths_m[k:])
        turning = sum(p * height_m * (i + 0.5) * height_m for i, p in enumerate(pressures_pa[k:]))
        factors.append(resisting / turning)
    return min(factors)


def rockfall(speed: float, drop_m: float, friction_deg: float, gravity: float) -> float:
    """Horizontal way [m] of a slab that leaves a crest level, lands flat without rebound, and slides to rest. The blow stops the fall, m v_n, and friction takes
    tan(friction angle) of that impulse from the horizontal velocity."""
    mu = tan_deg(friction_deg)
    flight = speed * math.sqrt(2 * drop_m / gravity)
    after = max(0.0, speed - mu * math.sqrt(2 * gravity * drop_m))
    return flight + after**2 / (2 * mu * gravity)


def area_and_centroid(corners: Corners) -> tuple[float, Point]:
    double_area = x = y = 0.0
    for (x1, y1), (x2, y2) in zip(corners, corners[1:] + corners[:1]):
        cross = x1 * y2 - x2 * y1
        double_area, x, y = double_area + cross, x + (x1 + x2) * cross, y + (y1 + y2) * cross
    return double_area / 2, (x / (3 * double_area), y / (3 * double_area))


def tower_tilt_deg(stones: list[Corners]) -> float:
    """Tilt of the base at which the first part of a stack of rectangles turns about the lower end of the bed below it; friction has to hold it until then."""
    tilts = []
    for k in range(len(stones)):
        parts = [area_and_centroid(stone) for stone in stones[k:]]
        area = sum(a for a, _ in parts)
        x, y = (sum(a * c[i] for a, c in parts) / area for i in (0, 1))
        below = stones[k - 1] if k else stones[0]
        end = min(max(c[0] for c in stones[k]), max(c[0] for c in below))
        tilts.append(math.degrees(math.atan((end - x) / (y - min(c[1] for c in stones[k])))))
    return min(tilts)


def arch_tilt_deg(voussoirs: list[Corners]) -> float:
    """Tilt of the base at which no line of thrust stays within the arch any more (Heyman's assumptions: no tension, no sliding, no crushing). Voussoirs stand from
    left to right, with the corners inner right, outer right, outer left, inner left."""
    return bisect(lambda tilt: thrust_line_exists(voussoirs, tilt), 0.0, 80.0)


def thrust_line_exists(voussoirs: list[Corners], tilt_deg: float) -> bool:
    """Some force at the left springer, (H, V) through the outer corner there and a moment M, gives every joint a resultant between its ends. The two conditions of
    a joint, moments about its ends of opposite signs, are linear in H, V and M; if any point satisfies all of them, so does a vertex of the region."""
    sin, cos = math.sin(math.radians(tilt_deg)), math.cos(math.radians(tilt_deg))
    origin = voussoirs[0][2]
    joints = [(voussoirs[0][3], voussoirs[0][2], 0.0, 0.0, 0.0)]
    area = ax = ay = 0.0
    for corners in voussoirs:
        a, (x, y) = area_and_centroid(corners)
        area, ax, ay = area + a, ax + a * x, ay + a * y
        joints.append((corners[0], corners[1], area, ax, ay))
    # The moment of everything to the left of a joint about (x, y), as a row (H, V, M, constant); the weight of an area a is (a sin, -a cos).
    rows = []
    for inner, outer, area, ax, ay in joints:
        for (x, y), sign in ((inner, 1.0), (outer, -1.0)):
            constant = (ax - area * x) * -cos - (ay - area * y) * sin
            rows.append([sign * v for v in (-(origin[1] - y), origin[0] - x, 1.0, constant)])
    return any(all(r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3] <= 1e-9 for r in rows) for p in vertices(rows))


def vertices(rows: list[list[float]]):
    """Points where three of the planes row . (H, V, M, 1) = 0 meet."""
    for a, b, c in itertools.combinations(rows, 3):
        cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
        determinant = sum(a[i] * cross[i] for i in range(3))
        if abs(determinant) < 1e-12:
            continue
        other = [[c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0]],
                 [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]]
        yield [-(a[3] * cross[i] + b[3] * other[0][i] + c[3] * other[1][i]) / determinant for i in range(3)]


def bisect(holds, low: float, high: float) -> float:
    """Where a condition that holds at `low` stops to hold."""
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return high
