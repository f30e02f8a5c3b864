"""Jointed slopes as a user would draw them without much thought: nothing here is chosen to be easy. Seeds make scenes for `fos`."""

import math
import random

from scene import Scene, log_uniform, rounded

PART = "slopes"
MOST_BLOCKS = 600
DAYLIGHTING_SHARE = 0.5  # of scenes whose first set dips out of the face for sure: with dips of any direction most slopes never fail
CLOSEST_SETS_DEG = 10  # joint sets nearer than this to each other would be one set
NAMED_SHARE = 0.25
BRITTLE = "lost_on_slip"
GRAVITY = 9.81


def draw(seed: int, attempt: int = 0) -> Scene:
    """Every number comes from the seed and, where the blocks of earlier attempts were all fixed, from the attempt."""
    r = random.Random(f"{PART} {seed} {attempt}")
    height = rounded(log_uniform(r, 0.5, 500))
    face = r.uniform(40, 85)
    face_width = height / math.tan(math.radians(face))
    bench, depth, behind = (rounded(height * f, 4) for f in (r.uniform(0.3, 0.8), r.uniform(0.2, 0.5), r.uniform(0.8, 2.0)))
    right = rounded(face_width + behind, 8)
    corners = [[-bench, -depth], [right, -depth], [right, height], [rounded(face_width, 8), height], [0.0, 0.0], [-bench, 0.0]]
    area = (bench + right) * depth + (right - face_width / 2) * height
    count = 3 if r.random() < 0.35 else 2
    sets = [_joint_set(r, seed + k, height) for k in range(count)]
    if r.random() < DAYLIGHTING_SHARE:
        sets[0]["dip_deg"] = rounded(r.uniform(15, face), 5)
    _separate(r, sets)
    _widen(sets, area, log_uniform(r, 12, MOST_BLOCKS))
    density, ratio = r.uniform(2300, 2800), rounded(log_uniform(r, 0.05, 1), 3)
    kn = rounded(log_uniform(r, 1e8, 1e11), 4)
    friction = rounded(r.uniform(15, 50), 4)
    # Cohesion as a share of what the height weighs, so that it matters on any height.
    cohesion = 0.0 if r.random() < 0.5 else rounded(log_uniform(r, 1e-3, 0.05) * density * GRAVITY * height, 4)
    joint = {"materials": ["rock", "rock"], "normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": rounded(kn * ratio, 4),
             "friction_angle_deg": friction, "cohesion_pa": cohesion} | _tension(random.Random(f"{PART} {seed} {attempt} tension"), density * GRAVITY * height)
    named = _named_joints(random.Random(f"{PART} {seed} {attempt} named"), sets, joint, density * GRAVITY * height)
    _weaken(random.Random(f"{PART} {seed} {attempt} weakening"), named, density * GRAVITY * height)
    document = {
        "title": f"{PART} {seed}",
        "material": [{"name": "rock", "density_kg_per_m3": rounded(density, 5)}],
        "joint": [joint, *named],
        "domain": {"material": "rock", "vertices_m": corners, "enclosed_joints": "drop"},
        "joint_set": sets,
        "fixed_line": [{"from_m": a, "to_m": b} for a, b in ((corners[0], corners[1]), (corners[0], corners[5]), (corners[1], corners[2]))],
        "strength_reduction": {"width": 5e-4},
    }
    drawn = {"height_m": height, "face_deg": face, "sets": count, "finite": sum("persistence" in s for s in sets), "friction_deg": friction,
             "cohesion_pa": cohesion, "tension_pa": joint.get("tensile_strength_pa", 0.0), "named": len(named),
             "brittle": sum(j.get("cohesion_behaviour") == BRITTLE for j in named),
             "weakening": sum("slip_weakening_distance_m" in j for j in named), "kn": kn, "ks_over_kn": ratio}
    return Scene(PART, seed, "fos", document, drawn)


def _tension(r: random.Random, weight_pa: float) -> dict:
    """In a quarter of the slopes, below the tip of the cone of friction and cohesion or far beyond it. With random numbers of its own."""
    return {"tensile_strength_pa": rounded(log_uniform(r, 1e-3, 0.05) * weight_pa, 4)} if r.random() < 0.25 else {}


def _named_joints(r: random.Random, sets: list[dict], joint: dict, weight_pa: float) -> list[dict]:
    """In a quarter of the slopes the first set has strength and stiffness of its own, and in a quarter of those with finite traces rock breaks between
    these. Cohesion is lost on slip in half of what has any, and some of its friction in a third."""
    named = []

    def add(name: str, friction: tuple[float, float], cohesion: tuple[float, float] | None, tensile_part: float) -> None:
        kn = rounded(joint["normal_stiffness_pa_per_m"] * log_uniform(r, 0.1, 10), 4)
        strength = {"friction_angle_deg": rounded(r.uniform(*friction), 4)}
        if cohesion:
            strength["cohesion_pa"] = rounded(log_uniform(r, *cohesion) * weight_pa, 4)
            strength |= {"tensile_strength_pa": rounded(tensile_part * strength["cohesion_pa"], 4)} if tensile_part else {}
            strength |= {"cohesion_behaviour": BRITTLE} if r.random() < 0.5 else {}
            strength |= {"residual_friction_angle_deg": rounded(r.uniform(0.5, 1) * strength["friction_angle_deg"], 4)} if r.random() < 0.3 else {}
        named.append({"name": name, "normal_stiffness_pa_per_m": kn, "shear_stiffness_pa_per_m": rounded(kn * log_uniform(r, 0.05, 1), 4)} | strength)

    if r.random() < NAMED_SHARE:
        add("first", (10, 45), (1e-3, 0.05) if r.random() < 0.5 else None, r.choice((0.0, 0.5)))
        sets[0]["joint"] = "first"
    finite = [joints for joints in sets if "persistence" in joints]
    if finite and r.random() < NAMED_SHARE:
        add("intact", (35, 55), (0.02, 0.5), r.uniform(0.1, 0.5))
        finite[0]["bridge"] = "intact"
    return named


def _weaken(r: random.Random, named: list[dict], weight_pa: float) -> None:
    """Half of the joints that lose strength by slip lose it over a distance: a small or a large part of what their springs give way under the slope."""
    for joint in named:
        if (joint.get("cohesion_behaviour") == BRITTLE or "residual_friction_angle_deg" in joint) and r.random() < 0.5:
            joint["slip_weakening_distance_m"] = rounded(log_uniform(r, 0.03, 3) * weight_pa / joint["shear_stiffness_pa_per_m"], 4)


def _joint_set(r: random.Random, seed: int, height: float) -> dict:
    """The first spacing is one of proportions only."""
    joints = {"dip_deg": rounded(r.uniform(-90, 90), 5), "spacing_m": height * log_uniform(r, 0.5, 1.6),
              "origin_m": [rounded(height * r.uniform(-0.05, 0.05)), rounded(height * r.uniform(-0.05, 0.05))]}
    if r.random() < 0.35:
        joints |= {"trace_length_m": r.uniform(1.5, 5), "persistence": rounded(r.uniform(0.5, 0.95), 3), "stagger": 0.5, "seed": seed % 100000 + 1}
    return joints


def _separate(r: random.Random, sets: list[dict]) -> None:
    """Draws anew the dip of a set that would be one with an earlier set."""
    for k, joints in enumerate(sets):
        while any(_between(joints["dip_deg"], other["dip_deg"]) < CLOSEST_SETS_DEG for other in sets[:k]):
            joints["dip_deg"] = rounded(r.uniform(-90, 90), 5)


def _between(a: float, b: float) -> float:
    difference = abs(a - b) % 180
    return min(difference, 180 - difference)


def _widen(sets: list[dict], area: float, blocks: float) -> None:
    """Scales the spacings so that through-going joints would cut about so many blocks: each pair of sets meets sin(angle)/(s1 s2) times a unit area."""
    meetings = sum(math.sin(math.radians(_between(a["dip_deg"], b["dip_deg"]))) / (a["spacing_m"] * b["spacing_m"])
                   for i, a in enumerate(sets) for b in sets[:i])
    scale = math.sqrt(area * meetings / blocks)
    for joints in sets:
        joints["spacing_m"] = rounded(joints["spacing_m"] * scale)
        if "trace_length_m" in joints:
            joints["trace_length_m"] = rounded(joints["trace_length_m"] * joints["spacing_m"])
