"""Arches, walls with openings, columns and piles, with or without a push. Seeds make scenes for `fos`, and for `run` on a shaken base."""

import math
import random

from geometry import integrals
from scene import Scene, log_uniform, rounded

PART = "masonry"
GRAVITY = 9.81
SHAKEN_SHARE = 0.25
LOADED_SHARE = 0.4
SHAKEN_S = 1.5
OUTPUTS = 60


def draw(seed: int, attempt: int = 0) -> Scene:
    r = random.Random(f"{PART} {seed} {attempt}")
    kind = r.choice((arch, wall, column, pile))
    size = log_uniform(r, 0.05, 2)  # of a stone
    blocks, drawn = kind(r, size)
    density, ratio = r.uniform(1600, 2800), rounded(log_uniform(r, 0.05, 1), 3)
    kn = rounded(log_uniform(r, 1e9, 1e12), 4)
    friction = rounded(r.uniform(25, 45), 4)
    cohesion = 0.0 if r.random() < 0.7 else rounded(log_uniform(r, 1e3, 1e5), 4)
    tension = 0.0 if cohesion == 0 or r.random() < 0.5 else rounded(cohesion * r.uniform(0.1, 0.8), 4)
    shaken = r.random() < SHAKEN_SHARE
    tilt = 0.0 if shaken else rounded(math.radians(r.uniform(-12, 12)), 4)
    document = {
        "title": f"{PART} {seed}",
        "gravity_m_per_s2": [GRAVITY * math.sin(tilt), -GRAVITY * math.cos(tilt)],
        "material": [{"name": "stone", "density_kg_per_m3": rounded(density, 5)}],
        "joint": [{"materials": ["stone", "stone"], "normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": rounded(kn * ratio, 4),
                   "friction_angle_deg": friction, "cohesion_pa": cohesion, "tensile_strength_pa": tension}],
        "block": [{"name": name, "material": "stone", "vertices_m": [[rounded(x, 9), rounded(y, 9)] for x, y in vertices]} |
                  ({"fixed": True} if name.startswith("fixed") else {}) for name, vertices in blocks.items()],
    }
    drawn = {"kind": kind.__name__, **drawn, "size_m": size, "tilt_deg": math.degrees(tilt), "friction_deg": friction, "cohesion_pa": cohesion, "kn": kn,
             "ks_over_kn": ratio}
    if shaken:
        return _shaken(r, seed, document, drawn, size)
    document["strength_reduction"] = {"width": 5e-4}
    document["load"] = _loads(random.Random(f"{PART} {seed} {attempt} loads"), document["block"], density)
    return Scene(PART, seed, "fos", document, {**drawn, "loads": len(document["load"])})


def _loads(r: random.Random, blocks: list[dict], density: float) -> list[dict]:
    """One or two pushes in any direction, of up to half a stone's weight, on one of its corners. Random numbers of its own."""
    if r.random() >= LOADED_SHARE:
        return []
    loads = []
    for block in r.choices([b for b in blocks if not b.get("fixed")], k=r.randint(1, 2)):
        force, direction = r.uniform(0.02, 0.5) * density * GRAVITY * abs(integrals(block["vertices_m"]).area), r.uniform(0, 2 * math.pi)
        loads.append({"block": block["name"], "point_m": r.choice(block["vertices_m"]),
                      "force_n": [rounded(force * math.cos(direction)), rounded(force * math.sin(direction))]})
    return loads


def _shaken(r: random.Random, seed: int, document: dict, drawn: dict, size: float) -> Scene:
    """By a few pulses of up to half of gravity."""
    pulses = [{"start_s": rounded(r.uniform(0, 0.8), 3), "duration_s": rounded(r.uniform(0.05, 0.3), 3),
               "acceleration_m_per_s2": [rounded(r.uniform(-0.5, 0.5) * GRAVITY, 4), rounded(r.uniform(-0.2, 0.2) * GRAVITY, 4)]} for _ in range(r.randint(1, 4))]
    dt = rounded(log_uniform(r, 5e-4, 5e-3), 3)
    document |= {"base_motion": {"kind": "pulses"}, "base_motion.pulse": pulses, "step": {"dt_s": dt, "max_displacement_m": rounded(size / 5, 3)},
                 "end": {"time_s": SHAKEN_S}, "output": {"every_s": SHAKEN_S / OUTPUTS}}
    lowest = min(y for b in document["block"] for _, y in b["vertices_m"])
    return Scene(PART, seed, "run", document, {**drawn, "pulses": len(pulses), "dt_s": dt}, floor_m=lowest)


def rectangle(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def arch(r: random.Random, size: float) -> tuple[dict, dict]:
    """Voussoirs with straight edges between radial joints; the springers' faces belong to fixed stones."""
    count, half = r.randint(5, 30), math.radians(r.uniform(45, 90))
    radius = size * count / (2 * half)
    thickness = radius * r.uniform(0.09, 0.3)
    angles = [half * (2 * k / count - 1) for k in range(count + 1)]

    def at(angle: float, q: float) -> tuple[float, float]:
        return (radius + q * thickness / 2) * math.sin(angle), (radius + q * thickness / 2) * math.cos(angle)

    blocks = {f"v{k}": [at(b, -1), at(b, 1), at(a, 1), at(a, -1)] for k, (a, b) in enumerate(zip(angles, angles[1:]))}
    for name, angle, way in (("left", -half, -1), ("right", half, 1)):
        inner, outer = at(angle, -1), at(angle, 1)
        away = (way * thickness * math.cos(angle), -way * thickness * math.sin(angle))
        blocks[f"fixed_{name}"] = [inner, outer, (outer[0] + away[0], outer[1] + away[1]), (inner[0] + away[0], inner[1] + away[1])]
    return blocks, {"stones": count, "half_deg": math.degrees(half), "thickness_over_radius": thickness / radius}


def wall(r: random.Random, size: float) -> tuple[dict, dict]:
    """Running bond on a fixed base, with an opening under a lintel where there is room for one."""
    courses, bricks = r.randint(3, 10), r.randint(4, 9)
    height = size * r.uniform(0.25, 0.6)
    opening = None
    if courses >= 5 and r.random() < 0.7:
        first, low = r.uniform(1, bricks - 3), r.randint(0, courses - 4)
        opening = (first * size, (first + r.uniform(1, 2)) * size, low, low + r.randint(1, courses - 3 - low))
    blocks = {"fixed_base": rectangle(-2 * size, -size, (bricks + 4) * size, size)}
    for c in range(courses):
        ends = sorted({0.0, bricks * size, *((k + c % 2 / 2) * size for k in range(bricks + 1) if 0 < (k + c % 2 / 2) < bricks)})
        for k, (a, b) in enumerate(_pieces(ends, opening, c, size)):
            blocks[f"c{c}_{k}"] = rectangle(a, c * height, b - a, height)
    return blocks, {"courses": courses, "bricks": bricks, "opening": "no" if opening is None else "yes", "height_over_length": height / size}


def _pieces(ends: list[float], opening: tuple | None, course: int, size: float) -> list[tuple[float, float]]:
    """Of a course: without the bricks in the opening, which are cut at its sides, and with the lintel over it."""
    pieces = list(zip(ends, ends[1:]))
    if opening is None:
        return pieces
    left, right, low, top = opening
    if low <= course < top:
        return [(a, b) for a, b in ((a, min(b, left)) for a, b in pieces) if b > a] + [(a, b) for a, b in ((max(a, right), b) for a, b in pieces) if b > a]
    if course == top:
        start, end = max(0.0, left - size / 2), min(ends[-1], right + size / 2)
        return [(a, b) for a, b in ((a, min(b, start)) for a, b in pieces) if b > a] + [(start, end)] + \
               [(a, b) for a, b in ((max(a, end), b) for a, b in pieces) if b > a]
    return pieces


def column(r: random.Random, size: float) -> tuple[dict, dict]:
    """Drums on each other, each a little beside the one below and a little narrower or not."""
    drums, taper = r.randint(2, 15), r.choice((0.0, r.uniform(0, 0.03)))
    height, scatter = size * r.uniform(0.3, 2), size * r.choice((0.0, 0.02, 0.08))
    blocks = {"fixed_base": rectangle(-3 * size, -size, 6 * size, size)}
    for k in range(drums):
        width = size * (1 - taper * k)
        blocks[f"d{k}"] = rectangle(r.uniform(-scatter, scatter) - width / 2, k * height, width, height)
    return blocks, {"drums": drums, "height_over_width": height / size, "taper": taper}


def pile(r: random.Random, size: float) -> tuple[dict, dict]:
    """A pyramid of stones of many widths, with open joints between them or none, on a fixed base."""
    rows, height = r.randint(2, 9), size * r.uniform(0.4, 1)
    gap = r.choice((0.0, 1e-5, 1e-4, 1e-3, 1e-2)) * size
    blocks = {"fixed_base": rectangle(-2 * size, -size, (1.4 * rows + 4) * size, size)}
    left, right = 0.0, 1.2 * rows * size
    for row in range(rows):
        x = left
        number = 0
        while x + 0.5 * size < right:
            width = min(size * r.uniform(0.6, 1.4), right - x)
            blocks[f"p{row}_{number}"] = rectangle(x, row * height, width, height)
            x += width + gap
            number += 1
        left, right = left + 0.55 * size, right - 0.55 * size
    return blocks, {"rows": rows, "gap_m": gap, "height_over_width": height / size}
