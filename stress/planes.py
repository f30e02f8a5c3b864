"""Rock above one plane that goes through, cut by joints that cross the plane and each other at any angle, many of them through one point: for `fos`, with a
bound that no joint below the plane, nor above it, can raise."""

import math
import random

from scene import Scene, log_uniform, rounded

PART = "planes"
REACH, DEPTH, HEIGHT = 10.0, 9.0, 10.0  # [m] of the domain, from the middle of the plane
JUST_BELOW = 0.05  # [m] what is touched by a line so far below the plane is fixed
SLIVER_M = 1e-5  # what is thinner is united with a neighbour, which roughens the plane by that: by default a millimetre, and teeth of that size hold
MOST_JOINTS = 5
THROUGH_ONE_POINT = 0.5  # share of joints that go through the point where another one crosses the plane
SMALL_ANGLE_SHARE, LARGEST_SMALL_ANGLE = 0.6, 18.0  # [-], [deg] of joints that cross the plane at a small angle


def draw(seed: int, attempt: int = 0) -> Scene:
    r = random.Random(f"{PART} {seed} {attempt}")
    dip, side = rounded(r.uniform(8, 38), 5), r.choice((-1, 1))
    friction = rounded(r.uniform(10, 45), 4)
    kn, ratio = rounded(log_uniform(r, 1e9, 1e12), 4), rounded(log_uniform(r, 0.05, 1), 3)

    def on_line(x: float, angle: float, through: tuple[float, float] = (0.0, 0.0)) -> list[float]:
        return [side * x, rounded(through[1] + (x - through[0]) * math.tan(math.radians(angle)), 12)]

    lines = [{"from_m": on_line(-2 * REACH, dip), "to_m": on_line(2 * REACH, dip), "joint": "plane"}]
    knot = _on_plane(r, dip)
    for _ in range(r.randint(1, MOST_JOINTS)):
        through = knot if r.random() < THROUGH_ONE_POINT else _on_plane(r, dip)
        small = r.random() < SMALL_ANGLE_SHARE
        angle = dip + r.choice((-1, 1)) * r.uniform(0.5, LARGEST_SMALL_ANGLE) if small else dip + r.uniform(LARGEST_SMALL_ANGLE, 180 - LARGEST_SMALL_ANGLE)
        if abs(abs(angle) - 90) > 1:  # the line through two points at a distance along x
            lines.append({"from_m": on_line(-2 * REACH, angle, through), "to_m": on_line(2 * REACH, angle, through)})
    springs = {"normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": rounded(kn * ratio, 4)}
    corners = [[-REACH, -DEPTH], [REACH, -DEPTH], [REACH, HEIGHT], [-REACH, HEIGHT]]
    below = [[side * x, rounded(x * math.tan(math.radians(dip)) - JUST_BELOW, 12)] for x in (-REACH, REACH)]
    document = {
        "title": f"{PART} {seed}",
        "material": [{"name": "rock", "density_kg_per_m3": 2600.0}],
        "joint": [{"materials": ["rock", "rock"], "friction_angle_deg": rounded(max(friction, r.uniform(30, 60)), 4)} | springs,
                  {"name": "plane", "friction_angle_deg": friction} | springs],
        "domain": {"material": "rock", "vertices_m": corners, "sliver_width_m": SLIVER_M},
        "joint_line": lines,
        "fixed_line": [{"from_m": below[0], "to_m": below[1]}, {"from_m": corners[0], "to_m": corners[1]}],
        "strength_reduction": {"width": 5e-4},
    }
    # Whatever the forces on the plane are, none pulls and none is beyond its friction: sum T = W sin dip is at most tan phi / F times sum N = W cos dip.
    bound = math.tan(math.radians(friction)) / math.tan(math.radians(dip))
    return Scene(PART, seed, "fos", document, {"dip_deg": dip, "friction_deg": friction, "joints": len(lines) - 1, "kn": kn, "ks_over_kn": ratio}, most=bound)


def _on_plane(r: random.Random, dip: float) -> tuple[float, float]:
    x = r.uniform(-0.8, 0.8) * REACH
    return x, x * math.tan(math.radians(dip))
