"""Small scenes in which a seed changes several keys at once and adds loads and supports: what keys do that meet, which no sweep of a single one tries."""

import copy
import random
import sys
import tomllib
from collections.abc import Callable, Iterator

from case import Case
from openclose_scripts import ROOT
from scenes import COMPANIONS, HILL, METHODS, MOTIONS, SCHEMA, YARD, landing, leaning_columns, shaken

sys.path += [str(ROOT / "stress"), str(ROOT / "docs")]

import maps  # noqa: E402
import masonry  # noqa: E402
import slopes  # noqa: E402
import tumbles  # noqa: E402
from check_schema import faults  # noqa: E402
from scene import to_toml  # noqa: E402

SEEDS = 1000
SEEDS_PER_CASE = 10
STEPS = (5, 15, 60)  # of a motion
# Of settling, so that what does not come to rest ends, too.
MOST_STEPS = {"max_steps": 60, "max_explicit_steps": 20000}
# How often the keys of a table are changed; of one that stands several times in a scene in one of its rows or in all.
WEIGHTS = {"method": 6, "joint": 6, "step": 2, "solver": 3, "rest": 1, "run": 1, "settle": 2, "strength_reduction": 3, "domain": 1, "joint_set": 2,
           "block": 3, "material": 1, "output": 1, "load": 1, "support": 1, "surcharge": 1}
# What only the soft contact has.
OF_SOFT = {"method": ("integrator", "first_integrator", "first_integrator_s", "theta", "rho_inf", "dissipation"), "step": ("adaptive", "error_tolerance_m")}
# Names of things that the scene would have to have, places, lengths of what is computed, and milestones, which put CPU times into checkpoints.
LEFT = {"name", "unit_weight_n_per_m3", "material", "materials", "block", "vertices_m", "edge_joints", "holes_m", "joint", "bridge", "region_m", "origin_m", "point_m", "from_m", "to_m",
        "threads", "max_blocks", "milestones_m", "curve", "curve_time_s", "checkpoint_every_s", "every_s", "snapshots_every_s", "max_steps", "max_explicit_steps", "max_time_steps"}


def read(name: str) -> dict:
    return tomllib.loads((ROOT / "examples" / name / "scene.toml").read_text(encoding="utf-8"))


def bases() -> list[Callable[[int], tuple[str, dict]]]:
    """Commands and scenes, by a number that those of the campaign are drawn by."""
    def drawn(part) -> Callable[[int], tuple[str, dict]]:
        def scene(seed: int) -> tuple[str, dict]:
            found = part.draw(seed)
            return found.command, found.document
        return scene

    def fixed(command: str, document: dict) -> Callable[[int], tuple[str, dict]]:
        return lambda seed: (command, document)

    own = [("run", YARD), ("fos", HILL), ("run", landing()), ("run", leaning_columns(2, [9.0, 7.0], 0.02, 0.4, 6.0)), *(("run", shaken(kind)) for kind in MOTIONS)]
    examples = [("run", "rockfall"), ("fos", "planar_slope"), ("fos", "retaining_blocks"), ("fos", "roof_wedge"), ("fos", "toppling_slope"), ("fos", "dry_stone_tower")]
    return [*(fixed(*scene) for scene in own), *(fixed(command, read(name)) for command, name in examples), *(2 * [drawn(part) for part in (slopes, masonry, tumbles, maps)])]


def keys() -> Iterator[tuple[str, str, dict]]:
    for table, schema in SCHEMA.items():
        if table in WEIGHTS:
            fields = (schema["items"] if schema["type"] == "array" else schema)["properties"]
            yield from ((table, key, of_key) for key, of_key in fields.items() if key not in LEFT)


def rounded(value: float) -> float:
    return float(f"{value:.3g}")


def number(r: random.Random, schema: dict, base) -> float:
    known = base if isinstance(base, (int, float)) and not isinstance(base, bool) else schema.get("default", 1)
    choice = r.random()
    if choice < 0.1:
        return 0
    if choice < 0.2:
        limits = [schema[name] for name in ("minimum", "maximum") if abs(schema.get(name, 1e9)) < 1e6]
        return r.choice(limits) if limits else 1
    value = rounded((known or 1) * 10.0 ** r.gauss(0.0, 0.3) * (-1 if choice > 0.95 else 1))
    return int(value) if schema["type"] == "integer" else value


def value(r: random.Random, schema: dict, base):
    kind = schema["type"]
    if "enum" in schema:
        return r.choice(schema["enum"])
    if kind == "boolean":
        return r.random() < 0.5
    if kind == "array":
        item, count = schema["items"], schema.get("minItems", 2)
        return [value(r, item, old) for old in (base if isinstance(base, list) else [None] * count)]
    return number(r, schema, base)


def has(scene: dict, table: str) -> bool:
    """Whether a table can have other keys: one that makes blocks has to be there."""
    return bool(scene.get(table)) or SCHEMA[table]["type"] != "array" and table != "domain"


def change(r: random.Random, scene: dict) -> None:
    """One key, to a value that its schema accepts, in one row of its table or in all."""
    tables = [table for table in WEIGHTS if has(scene, table)]
    table = r.choices(tables, [WEIGHTS[table] for table in tables])[0]
    key, schema = r.choice([(key, schema) for name, key, schema in keys() if name == table])
    found = scene.setdefault(table, {})
    rows = [found] if isinstance(found, dict) else found if r.random() < 0.5 else [r.choice(found)]
    new = value(r, schema, rows[0].get(key))
    if faults(new, schema):
        return
    for row in rows:
        row[key] = new
        for name, needed in COMPANIONS.get(f"{table}.{key}", {}).items():
            if needed is None:
                row.pop(name, None)
            else:
                row.setdefault(name, needed)


def agree(scene: dict, method: str) -> None:
    """Mends what would be refused whatever the other keys are."""
    for table, names in OF_SOFT.items():
        for name in names if method != "soft" else ():
            scene.get(table, {}).pop(name, None)
    for joint in scene.get("joint", []):
        friction = joint.get("friction_angle_deg", 0)
        if joint.get("residual_friction_angle_deg", 0) >= friction:
            joint.pop("residual_friction_angle_deg", None)
        if "residual_friction_angle_deg" not in joint:
            joint.pop("slip_weakening_distance_m", None)
        elif joint.get("cohesion_pa"):
            joint["cohesion_behaviour"] = "lost_on_slip"
    for block in scene.get("block", []):
        if block.get("fixed") or block.get("rotation_locked"):
            block.pop("angular_velocity_rad_per_s", None)
        if block.get("fixed"):
            block.pop("velocity_m_per_s", None)
    scene.get("output", {}).get("snapshots_s", []).sort()


def add_force(r: random.Random, scene: dict) -> None:
    """A load, a support or a surcharge on a block, about as large as the weight of a cubic metre."""
    block = r.choice([block for block in scene["block"] if not block.get("fixed")])
    corners = block["vertices_m"]
    at, _ = r.sample(range(len(corners)), 2)
    middle = [rounded(sum(corner[axis] for corner in corners) / len(corners)) for axis in (0, 1)]
    size = 10.0 ** r.uniform(3.0, 5.0)
    forces = {
        "load": {"point_m": middle, "force_n": [rounded(r.gauss(0, size)), rounded(r.gauss(0, size))]},
        "support": {"point_m": r.choice([middle, corners[at]]), "stiffness_n_per_m": [rounded(100 * size), rounded(r.choice([0, 1e3]) * size)]},
        "surcharge": {"from_m": corners[at], "to_m": corners[(at + r.choice([1, -1])) % len(corners)], "pressure_pa": rounded(size), "shear_pa": rounded(r.gauss(0, size))},
    }
    table = r.choice(list(forces))
    scene.setdefault(table, []).append({"block": block["name"]} | forces[table])


def mixture(seed: int) -> tuple[dict, list[str]]:
    """A scene, and what is done with it."""
    r = random.Random(seed)
    command, scene = r.choice(bases())(seed % 7)
    scene = copy.deepcopy(scene)
    if scene.get("block"):
        for _ in range(r.choice([0, 0, 1, 2])):
            add_force(r, scene)
    for _ in range(r.randint(1, 6)):
        change(r, scene)
    if r.random() < 0.2:
        scene["gravity_m_per_s2"] = [rounded(r.gauss(0, 2)), rounded(-10.0 ** r.gauss(0.7, 0.4))]
    method = r.choice([*METHODS, "soft", "soft"])
    options = ["--contact", method] if command == "run" or r.random() < 0.3 else []
    agree(scene, method)
    scene.setdefault("settle", {}).update(MOST_STEPS)
    if "rest" in scene:
        scene.setdefault("solver", {})["skip_resting"] = True
    if command == "fos" and r.random() < 0.3:
        command = "run"
        options = ["--contact", method]
    if command == "run":
        dt = scene.setdefault("step", {}).setdefault("dt_s", 1e-2)
        options += ["--end", f"{r.choice(STEPS) * dt:.3g}", "--set", "output.checkpoint_every_s=1e6"]
    return scene, [command, *options]


def shown(seed: int) -> list[list[str]]:
    """Pictures and a page of every fifth one."""
    if seed % 5:
        return []
    r = random.Random(seed)
    colour = [["--colour", name] for name in ("displacement", "velocity", "state")]
    options = r.choice([[], ["--forces"], ["--cracks"], ["--state", "initial"], ["--state", "start"], *colour])
    return [["draw", f"{seed}", *options, "-o", f"{seed}.svg"], ["report", f"{seed}", "--quiet", "-o", f"{seed}.html"]]


def cases() -> list[Case]:
    found = []
    for first in range(0, SEEDS, SEEDS_PER_CASE):
        files, commands = {}, []
        for seed in range(first, first + SEEDS_PER_CASE):
            scene, (command, *options) = mixture(seed)
            files[f"{seed}.toml"] = to_toml(scene)
            commands += [[command, f"{seed}.toml", "--quiet", *options, "-o", f"{seed}"], *shown(seed)]
        found.append(Case(f"mixtures from {first}", commands, files, together=True))
    return found
