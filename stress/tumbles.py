"""Random polygons thrown at each other, at plates and at walls. Seeds make scenes for `run`."""

import math
import random

import cut_ground
from geometry import Polygon, convex_parts, diameter, edges, integrals
from scene import Scene, log_uniform, rounded

PART = "tumbles"
GRAVITY = 9.81
DENSITY = 2600.0
SPACING = 1.25          # of places over the largest block: no two blocks overlap at the start, however they are turned
OUTPUTS = 60
MOST_STEPS = 4000
# What a sharp corner gives way by that stops the heaviest block at the fastest speed, over the narrowest width of a block or plate. Beyond a quarter springs
# are too soft for these blocks, and to refuse is right: one scene in five or so.
CLOSURE_OF_WIDTH = 0.06, 0.4
TOO_SOFT = 0.25
WAY_OF_SIZE_IN_A_STEP = 2e-3, 0.1
CONCAVE_SHARE = 0.3
GROUND_CUT_SHARE = 0.4
LEAST_AREA = 0.03  # [-] of the square of a block's size


def draw(seed: int, attempt: int = 0) -> Scene:
    r = random.Random(f"{PART} {seed} {attempt}")
    count = round(log_uniform(r, 1, 100))
    size = log_uniform(r, 0.05, 10)
    spread = 1.0 if r.random() < 0.5 else log_uniform(r, 1, 5)
    sizes = [size / log_uniform(r, 1, spread) for _ in range(count)]
    speed = log_uniform(r, 0.1, 50)
    columns = max(1, min(count, round(math.sqrt(count * log_uniform(r, 0.3, 3)))))
    rows = -(-count // columns)
    pitch = SPACING * size
    half_width = pitch * (columns / 2 + r.uniform(0.1, 1.5))
    height = pitch * (rows + r.uniform(0.3, 3))
    places = [((k % columns - (columns - 1) / 2) * pitch, (k // columns + 0.6) * pitch) for k in range(count)]
    obstacles, places = _obstacles(r, places, pitch)
    blocks = _walls(r, size, half_width, height) + obstacles
    for k, place in enumerate(places):
        blocks.append(_thrown(r, f"b{k}", place, sizes[k], speed))
    impact = math.hypot(speed, math.sqrt(2 * GRAVITY * height))
    closure = log_uniform(r, *CLOSURE_OF_WIDTH)
    kn = rounded(_stiffness(blocks, impact, closure), 4)
    ratio, friction = rounded(log_uniform(r, 0.1, 1), 3), rounded(r.uniform(0, 45), 4)
    damping = 0.0 if r.random() < 0.7 else rounded(r.uniform(0.02, 0.5), 3)
    duration = min(2.5 * max(height, 2 * half_width) / impact + math.sqrt(2 * height / GRAVITY), 20.0)
    dt = max(log_uniform(r, *WAY_OF_SIZE_IN_A_STEP) * size / impact, duration / MOST_STEPS)
    document = {
        "title": f"{PART} {seed}",
        "gravity_m_per_s2": [0.0, -GRAVITY],
        "material": [{"name": "rock", "density_kg_per_m3": DENSITY}],
        "joint": [{"materials": ["rock", "rock"], "normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": rounded(kn * ratio, 4),
                   "friction_angle_deg": friction, "damping_ratio": damping}],
        "block": blocks,
        "method": {"start": "unloaded"},
        "step": {"dt_s": rounded(dt, 4), "max_displacement_m": rounded(size / 10, 4)},
        "end": {"time_s": rounded(duration, 4)},
        "output": {"every_s": rounded(duration / OUTPUTS, 4)},
    }
    drawn = {"thrown": len(places), "size_m": size, "spread": spread, "speed": speed, "kn": kn, "ks_over_kn": ratio, "friction_deg": friction, "damping": damping,
             "dt_s": dt, "closure_over_width": closure}
    whether = random.Random(f"{PART} {seed} {attempt} ground")
    drawn["ground_cut"] = int(whether.random() < GROUND_CUT_SHARE)
    if drawn["ground_cut"]:
        document = cut_ground.cut(whether, document)
    return Scene(PART, seed, "run", document, drawn, (-half_width, 0.0, half_width, height), 0.0, too_soft=closure > TOO_SOFT)


def _stiffness(blocks: list[dict], speed: float, closure: float) -> float:
    """A right angle that is d deep has a chord of 2 d: it stops m at the speed v where m v^2 = kn 2 d^3. The width of a block is 2 area/perimeter."""
    parts = [(integrals(b["vertices_m"]).area, sum(math.dist(p, q) for p, q in edges(b["vertices_m"])), b.get("fixed", False)) for b in blocks]
    narrowest = min(2 * area / perimeter for area, perimeter, _ in parts)
    mass = DENSITY * max(area for area, _, fixed in parts if not fixed)
    return mass * speed**2 / (2 * (closure * narrowest) ** 3)


def _walls(r: random.Random, size: float, half_width: float, height: float) -> list[dict]:
    """A closed box, of four plates or of a deep cup with a lid. Plates are as thin as a thirtieth of a block."""
    t = size * log_uniform(r, 0.03, 1)
    w, h = half_width, height
    lid = [[-w - t, h], [w + t, h], [w + t, h + t], [-w - t, h + t]]
    if r.random() < 0.5:
        cup = [[-w - t, -t], [w + t, -t], [w + t, h], [w, h], [w, 0.0], [-w, 0.0], [-w, h], [-w - t, h]]
        walls = {"cup": cup, "lid": lid}
    else:
        walls = {"floor": [[-w - t, -t], [w + t, -t], [w + t, 0.0], [-w - t, 0.0]], "lid": lid,
                 "left": [[-w - t, 0.0], [-w, 0.0], [-w, h], [-w - t, h]], "right": [[w, 0.0], [w + t, 0.0], [w + t, h], [w, h]]}
    return [_fixed(name, vertices) for name, vertices in walls.items()]


def _obstacles(r: random.Random, places: list, pitch: float) -> tuple[list[dict], list]:
    """Up to three of the places get a fixed polygon instead of a block that is thrown, so that blocks meet corners and notches, too."""
    number = min(r.choice((0, 0, 1, 2, 3)), len(places) - 1)
    taken = set(r.sample(range(len(places)), number))
    fixed = [_fixed(f"obstacle{k}", polygon(r, places[k], pitch / SPACING)) for k in sorted(taken)]
    return fixed, [place for k, place in enumerate(places) if k not in taken]


def _fixed(name: str, vertices: Polygon) -> dict:
    return {"name": name, "material": "rock", "fixed": True, "vertices_m": [[float(x), float(y)] for x, y in vertices]}


def _thrown(r: random.Random, name: str, place: tuple[float, float], size: float, speed: float) -> dict:
    direction, v = r.uniform(0, 2 * math.pi), speed * math.sqrt(r.random())
    spin = 0.0 if r.random() < 0.5 else r.uniform(-2, 2) * speed / size
    return {"name": name, "material": "rock", "vertices_m": polygon(r, place, size), "velocity_m_per_s": [v * math.cos(direction), v * math.sin(direction)],
            "angular_velocity_rad_per_s": spin}


def polygon(r: random.Random, centre: tuple[float, float], size: float) -> list[list[float]]:
    """Inside a circle of diameter `size`: convex ones have their corners on an ellipse, thin ones too; the others between two circles."""
    while True:
        shape = _star(r) if r.random() < CONCAVE_SHARE else _inscribed(r)
        points = [[rounded(centre[0] + size / 2 * x, 9), rounded(centre[1] + size / 2 * y, 9)] for x, y in shape]
        if _sound(points, size):
            return points


def _inscribed(r: random.Random) -> list[tuple[float, float]]:
    flat, turn = log_uniform(r, 0.15, 1), r.uniform(0, 2 * math.pi)
    angles = sorted(r.uniform(0, 2 * math.pi) for _ in range(r.randint(3, 9)))
    on_ellipse = [(math.cos(a), flat * math.sin(a)) for a in angles]
    return [(x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)) for x, y in on_ellipse]


def _star(r: random.Random) -> list[tuple[float, float]]:
    n, turn = r.randint(4, 8), r.uniform(0, 2 * math.pi)
    angles = [turn + 2 * math.pi * (k + r.uniform(-0.3, 0.3)) / n for k in range(n)]
    return [(q * math.cos(a), q * math.sin(a)) for a, q in ((a, r.uniform(0.25, 1)) for a in angles)]


def _sound(points: Polygon, size: float) -> bool:
    """A simple polygon that is no needle: area, edges and width are those of a block."""
    if integrals(points).area < LEAST_AREA * size**2 or min(math.dist(a, b) for a, b in edges(points)) < 0.01 * size:
        return False
    try:
        convex_parts(points)
    except ValueError:
        return False
    return diameter(points) > 0.3 * size
