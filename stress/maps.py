"""Maps of step size and stiffness on scenes whose answer is known: a stack, a slider, an arch and the slope of the paper's example 3.4 in failure."""

import math
import random
import tomllib
from pathlib import Path

import masonry
from scene import Expected, Scene, rounded

PART = "maps"
GRAVITY = 9.81
DENSITY = 2600.0
STEPS, STIFFNESSES = 6, 6  # cells of each map; the seeds after the last cell begin anew, elsewhere in the cells
SPREAD = 89  # no factor in common with the number of cells: few seeds lie all over the maps
LONGEST_STEP_S, SHORTEST_STEP_S = 0.1, 2e-4
SOFTEST_PA_PER_M, STIFFEST_PA_PER_M = 1e5, 1e12
SLOPE = Path(__file__).resolve().parent.parent / "paper" / "scenes" / "example_3_4_post_failure.toml"
SLOPE_S = 2.0
OUTPUTS = 50
# A stack or an arch on springs stands if what the springs of a joint hold against tilting is so many times what the weight tips with.
SAFE_FROM_BUCKLING = 5.0
# [-] Of the way: what a first-order method may err by besides a step's share of it.
SMALL = 0.01


def draw(seed: int, attempt: int = 0) -> Scene:
    r = random.Random(f"{PART} {seed} {attempt}")
    kind, step, stiffness = cell(seed)
    dt = rounded(_between(SHORTEST_STEP_S, LONGEST_STEP_S, (step + r.random()) / STEPS), 4)
    kn = rounded(_between(SOFTEST_PA_PER_M, STIFFEST_PA_PER_M, (stiffness + r.random()) / STIFFNESSES), 4)
    document, expected, floor = kind(r, dt, kn)
    document["step"] = {"dt_s": dt}
    document.setdefault("output", {"every_s": document["end"]["time_s"] / OUTPUTS})
    return Scene(PART, seed, "run", document, {"scene": kind.__name__, "dt_s": dt, "kn": kn}, floor_m=floor, expected=expected)


def cell(seed: int) -> tuple:
    """Scene, number of the step, number of the stiffness."""
    number = SPREAD * seed % CELLS
    return KINDS[number % len(KINDS)], *divmod(number // len(KINDS), STIFFNESSES)


def _between(low: float, high: float, part: float) -> float:
    return low * (high / low) ** part


def _document(blocks: dict, kn: float, friction: float, start: str, time: float) -> dict:
    return {
        "gravity_m_per_s2": [0.0, -GRAVITY],
        "material": [{"name": "rock", "density_kg_per_m3": DENSITY}],
        "joint": [{"materials": ["rock", "rock"], "normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": kn, "friction_angle_deg": friction}],
        "block": [{"name": n, "material": "rock", "vertices_m": [[x, y] for x, y in v]} | ({"fixed": True} if n.startswith("fixed") else {})
                  for n, v in blocks.items()],
        "method": {"start": start},
        "end": {"time_s": time},
    }


def stack(r: random.Random, dt: float, kn: float) -> tuple[dict, tuple, float]:
    """Three cubes of 1 m whose weight comes at once: they sink by no more than twice the closure of all joints, and stay. Joints that bear no pull let a cube
    be thrown up by the waves, by no more than the weight of the others that have sunk can lift it."""
    blocks = {"fixed_base": masonry.rectangle(-3, -1, 6, 1)} | {f"b{k}": masonry.rectangle(-0.5, k, 1, 1) for k in range(3)}
    closures = [DENSITY * GRAVITY * above / kn for above in (3, 2, 1)]
    sunk = [sum(closures[: k + 1]) for k in range(3)]
    expected = ()
    if kn / 12 > SAFE_FROM_BUCKLING * 3 * DENSITY * GRAVITY * 3:
        expected = tuple(Expected(f"b{k}", 0.0, sum(sunk) - 2 * sunk[k], sum(sunk) * (1 + SMALL) + SMALL * GRAVITY * dt * dt + 1e-6) for k in range(3))
    return _document(blocks, kn, 30.0, "unloaded", 1.0), expected, 0.0


def slider(r: random.Random, dt: float, kn: float) -> tuple[dict, tuple, float]:
    """A block that slides down 30 degrees with friction of 20 degrees from the state of steady sliding."""
    slope, friction, time, way = math.radians(30), 20.0, 1.0, 30.0
    c, s = math.cos(slope), math.sin(slope)

    def at(along: float, above: float) -> tuple[float, float]:
        return along * c + above * s, -along * s + above * c

    blocks = {"fixed_plane": [at(-5, -2), at(way, -2), at(way, 0), at(-5, 0)], "b": [at(0, 0), at(2, 0), at(2, 1), at(0, 1)]}
    acceleration = GRAVITY * (s - c * math.tan(math.radians(friction)))
    moved = acceleration * time**2 / 2
    closure = DENSITY * GRAVITY / kn
    expected = ()
    # Beyond, the block leans into its springs by more than a tenth of itself, and what it does is no longer the closed form.
    if closure < 0.1:
        expected = (Expected("b", *at(moved, 0.0), SMALL * moved + acceleration * time * dt + closure),)
    return _document(blocks, kn, friction, "steady_sliding", time), expected, -way * s - 1


def arch(r: random.Random, dt: float, kn: float) -> tuple[dict, tuple, float]:
    """Twelve settled voussoirs, thick enough by far: nothing moves."""
    count, radius, thickness = 12, 5.0, 1.0
    angles = [math.pi * (k / count - 0.5) for k in range(count + 1)]

    def at(angle: float, q: float) -> tuple[float, float]:
        return (radius + q * thickness / 2) * math.sin(angle), (radius + q * thickness / 2) * math.cos(angle)

    blocks = {f"v{k}": [at(b, -1), at(b, 1), at(a, 1), at(a, -1)] for k, (a, b) in enumerate(zip(angles, angles[1:]))}
    for name, way in (("left", -1), ("right", 1)):
        x = way * radius
        blocks[f"fixed_{name}"] = masonry.rectangle(x - thickness / 2, -1, thickness, 1)
    weight = DENSITY * GRAVITY * math.pi * radius * thickness
    expected = ()
    if kn * thickness**3 / 12 > SAFE_FROM_BUCKLING * weight * radius:
        expected = tuple(Expected(f"v{k}", 0.0, 0.0, SMALL * weight / (kn * thickness) + 1e-7) for k in range(count))
    return _document(blocks, kn, 40.0, "settled", 1.0), expected, 0.0


def slope(r: random.Random, dt: float, kn: float) -> tuple[dict, tuple, float]:
    """Only the rules that hold for every motion."""
    document = tomllib.loads(SLOPE.read_text(encoding="utf-8"))
    del document["measured_point"]
    document["joint"][0] |= {"normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": kn}
    document |= {"end": {"time_s": SLOPE_S}, "output": {"every_s": SLOPE_S / OUTPUTS}}
    return document, (), -100.0


KINDS = (stack, slider, arch, slope)
CELLS = len(KINDS) * STEPS * STIFFNESSES
