"""Every key of a scene file at its limits, just beyond them, at its other values and left out, in small scenes that use all tables: a case a key."""

import copy
import json
import sys

from case import Case
from openclose_scripts import ROOT

sys.path += [str(ROOT / "stress"), str(ROOT / "docs")]

from check_schema import faults  # noqa: E402
from scene import to_toml  # noqa: E402

SCHEMA = json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))["properties"]
METHODS = ("soft", "hard", "shi", "dem")
OF_METHODS = {"method", "step", "solver", "rest", "run", "end", "output"}  # tables tried in a motion by each method
OF_SEARCHES = {"strength_reduction", "settle"}
OF_CUTS = {"domain", "joint_set", "joint_line", "fixed_line", "region"}
END = "0.03"
# Limits beyond this are of memory and of time: what stands there would not end.
LARGEST = 1e4
JOINT = {"normal_stiffness_pa_per_m": 1e8, "shear_stiffness_pa_per_m": 4e7, "friction_angle_deg": 30, "cohesion_pa": 2e3, "tensile_strength_pa": 1e3,
         "cohesion_behaviour": "lost_on_slip", "residual_friction_angle_deg": 25, "slip_weakening_distance_m": 1e-3, "damping_ratio": 0.05}
YARD = {
    "title": "yard",
    "gravity_m_per_s2": [1.5, -9.0],
    "material": [{"name": "rock", "density_kg_per_m3": 2500}, {"name": "brick", "unit_weight_n_per_m3": 18e3}],
    "joint": [{"name": "smooth"} | JOINT, {"materials": ["rock", "brick"]} | JOINT, {"materials": ["rock", "rock"]} | JOINT,
              {"materials": ["brick", "brick"]} | JOINT],
    "block": [
        {"name": "ground", "material": "rock", "vertices_m": [[-1, -1], [6, -1], [6, 0], [-1, 0]], "fixed": True, "edge_joints": ["", "", "smooth", ""]},
        {"name": "low", "material": "rock", "vertices_m": [[0, 0], [2, 0], [2, 1], [0, 1]], "edge_joints": ["smooth", "", "", ""]},
        {"name": "high", "material": "brick", "vertices_m": [[0.2, 1], [1.5, 1], [0.9, 2.5], [0.2, 2]], "velocity_m_per_s": [0.3, 0], "angular_velocity_rad_per_s": -0.2},
        {"name": "guided", "material": "brick", "vertices_m": [[3, 0.01], [4, 0.01], [4, 1], [3, 1]], "rotation_locked": True},
    ],
    "load": [{"name": "crane", "block": "high", "point_m": [0.9, 2.5], "force_n": [500, -800]}],
    "support": [{"name": "anchor", "block": "low", "point_m": [2, 0.5], "stiffness_n_per_m": [1e6, 2e5]}],
    "surcharge": [{"name": "soil", "block": "low", "from_m": [0, 1], "to_m": [0, 0.2], "pressure_pa": 900, "shear_pa": 50}],
    "measured_point": [{"name": "top", "block": "high", "point_m": [0.9, 2.5]}],
    "measured_contact": [{"name": "bed", "point_m": [0.5, 1], "block_a": "low", "block_b": "high"}],
    "method": {"contact": "soft", "start": "unloaded"},
    "step": {"dt_s": 2e-3},
    "end": {"time_s": 0.03},
    "output": {"every_s": 0.01, "checkpoint_every_s": 1e6},
}
MOTIONS = {
    "harmonic": {"kind": "harmonic", "factor": 2, "amplitude_m_per_s2": [2, 1], "frequency_hz": 15, "phase_deg": 40},
    "record": {"kind": "record", "factor": 3, "horizontal_time_s": [0, 0.01, 0.05], "horizontal_m_per_s2": [0, 4, -3],
               "vertical_time_s": [0, 0.02, 0.04], "vertical_m_per_s2": [0, -2, 1]},
    "pulses": {"kind": "pulses", "factor": 1.5},
}
PULSES = [{"start_s": 0.004, "duration_s": 0.01, "acceleration_m_per_s2": [3, -1]}]
HILL = {
    "title": "hill",
    "material": [{"name": "rock", "density_kg_per_m3": 2500}, {"name": "clay", "density_kg_per_m3": 1900}],
    "joint": [{"materials": ["rock", "rock"]} | JOINT, {"materials": ["rock", "clay"]} | JOINT, {"materials": ["clay", "clay"]} | JOINT,
              {"name": "smooth"} | JOINT | {"friction_angle_deg": 27}, {"name": "bridge"} | JOINT | {"cohesion_pa": 3e4}],
    "domain": {"material": "rock", "vertices_m": [[-6, -3], [16, -3], [16, 9], [4, 9], [0, 0], [-6, 0]], "holes_m": [[[12, 2], [14, 2], [14, 4], [12, 4]]],
               "sliver_width_m": 0.02, "sliver_area_m2": 1e-3, "joint_end_reach_m": 0.05, "enclosed_joints": "drop", "section_direction_deg": 90, "max_blocks": 300},
    "joint_set": [{"dip_deg": 38, "spacing_m": 2.5, "origin_m": [0, 0], "joint": "smooth", "bridge": "bridge", "trace_length_m": 6, "gap_m": 1, "stagger": 0.4,
                   "dip_direction_deg": 70, "dip_scatter_deg": 4, "spacing_scatter": 0.2, "trace_scatter": 0.3, "seed": 5,
                   "region_m": [[-6, -3], [16, -3], [16, 9], [-6, 9]]},
                  {"dip_deg": -60, "spacing_m": 3, "origin_m": [0.3, 0], "persistence": 0.8, "trace_length_m": 8}],
    "joint_line": [{"from_m": [-7, -1], "to_m": [17, 3], "joint": "smooth", "bridge": "bridge"}],
    "fixed_line": [{"from_m": [-6, -3], "to_m": [16, -3]}, {"from_m": [16, -3], "to_m": [16, 9]}],
    "region": [{"material": "clay", "vertices_m": [[-7, -4], [17, -4], [17, -0.5], [-7, -0.5]]}],
    "strength_reduction": {"width": 1e-3},
    "step": {"dt_s": 2e-3},
}
MISSING = object()


def beside(value: float) -> list[float]:
    """A little less and a little more."""
    step = 1e-6 * abs(value) if value else 1e-12
    return [value - step, value + step]


def numbers(schema: dict, base) -> list:
    limits = [v for v in (schema.get(k) for k in ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum")) if v is not None and abs(v) <= LARGEST]
    around = [v for limit in limits for v in (limit, *beside(limit))]
    # What is allowed only just beyond an exclusive limit of 0 would never end: a step of 1e-12 s, a spacing of 1e-12 m.
    around = [v for v in around if not 0 < v < 1e-6]
    known = base if isinstance(base, (int, float)) and not isinstance(base, bool) else schema.get("default", 1)
    values = [*around, known / 2, known * 2, 0, 0.5, 1, 2, -1]
    return [int(v) if schema["type"] == "integer" and float(v).is_integer() else v for v in values]


def values(schema: dict, base) -> list:
    """What stands for `base`, which is MISSING where the scene does not use the key."""
    kind = schema["type"]
    if "enum" in schema:
        found = [*schema["enum"], "nonsense", ""]
    elif kind == "boolean":
        found = [True, False]
    elif kind in ("number", "integer"):
        found = numbers(schema, base)
    elif kind == "string":
        found = ["nonsense", "", "smooth", "rock", "low", "gravity_x", "-gravity_y"]
    else:
        found = lists(schema, base)
    return [MISSING, 3 if kind in ("string", "array") else "x", *found]


def lists(schema: dict, base) -> list:
    if base is MISSING:
        item = values(schema["items"], MISSING)[2:] if schema["items"]["type"] in ("number", "string") else []
        return [[0, 0], [1, -2], *([v] for v in item), [0.01, 0.02]]
    changed = [base[:-1], [*base, base[-1]], base[::-1], [base[0]] * len(base)]
    if isinstance(base[0], list):
        return [*changed, *([other, *base[1:]] for other in lists({"items": schema["items"].get("items", {})}, base[0]))]
    if isinstance(base[0], str):
        return [*changed, ["nonsense", *base[1:]]]
    return [*changed, [base[0] + 0.1, *base[1:]], [-base[0] - 0.3, *base[1:]], [0, *base[1:]], [1e9, *base[1:]], ["x", *base[1:]]]


def put(scene: dict, table: str, key: str, value) -> dict:
    """The scene with another value; of a table that comes several times in its first one."""
    scene = copy.deepcopy(scene)
    found = scene.setdefault(table, {})
    row = found[0] if isinstance(found, list) else found
    row.pop(key, None)
    if value is not MISSING:
        row[key] = value
    return scene


def base_of(scene: dict, table: str, key: str):
    found = scene.get(table, {})
    return (found[0] if isinstance(found, list) else found).get(key, MISSING)


def attempts(table: str, file: str) -> list[list[str]]:
    """What is tried with a value that the schema accepts."""
    folder = file.removesuffix(".toml")
    quiet = [file, "--quiet", "-o", folder]
    if table in OF_METHODS:
        return [["run", *quiet[:-1], f"{folder}_{m}", "--contact", m, "--end", END] for m in METHODS]
    if table in OF_CUTS:
        return [["cut", file, "--quiet", "-o", f"{folder}_cut.toml"], ["fos", *quiet]]
    if table in OF_SEARCHES:
        return [["fos", *quiet]]
    return [["run", *quiet, "--end", END]]


def case_of(scene: dict, table: str, key: str, schema: dict, title: str) -> Case:
    files, commands = {}, []
    for value in values(schema, base_of(scene, table, key)):
        text = to_toml(put(scene, table, key, value))
        if text not in files.values():
            name = f"{len(files)}.toml"
            files[name] = text
            commands += [["check", name]] if value is not MISSING and faults(value, schema) else attempts(table, name)
    return Case(title, commands, files, together=True)


def fields(table: str, schema: dict):
    """Names and schemas of a table's keys; of a table within one by its name with a dot."""
    for key, found in (schema["items"] if schema["type"] == "array" else schema)["properties"].items():
        if found["type"] == "array" and found["items"]["type"] == "object":
            yield from fields(f"{table}.{key}", found)
        else:
            yield table, key, found


def shaken(kind: str) -> dict:
    return YARD | {"base_motion": MOTIONS[kind]} | ({"base_motion.pulse": PULSES} if kind == "pulses" else {})


def bases() -> Case:
    """What is varied has to be right as it stands: otherwise all of its variations say the same."""
    scenes = {"yard": YARD, "hill": HILL} | {kind: shaken(kind) for kind in MOTIONS}
    commands = [["fos" if name == "hill" else "run", f"{name}.toml", "-o", name] for name in scenes]
    return Case("scenes that are varied", commands, {f"{name}.toml": to_toml(scene) for name, scene in scenes.items()}, must_succeed=True)


def former_names() -> Case:
    """Solver switches where they stood once, in the scene and on the command line."""
    files, commands = {}, []
    for key, schema in SCHEMA["solver"]["properties"].items():
        for value in [v for v in values(schema, MISSING)[2:] if not faults(v, schema)][:2]:
            table = "step" if key == "smallest_fraction" else "method"
            name = f"{len(files)}.toml"
            files[name] = to_toml(put(YARD, table, key, value))
            commands += [["check", name], ["check", name, "--set", f"{table}.{key}={json.dumps(value)}"]]
    return Case("former names of keys", commands, files, together=True)


def cases() -> list[Case]:
    found = [bases(), former_names()]
    for top, schema in SCHEMA.items():
        if schema["type"] == "string" or schema.get("items", {}).get("type") == "number":
            found.append(Case(f"key {top}", [["check", "a.toml"], ["run", "b.toml", "-q", "-o", "b"]],
                              {"a.toml": to_toml(YARD | {top: 3}), "b.toml": to_toml({k: v for k, v in YARD.items() if k != top})}, together=True))
            continue
        for table, key, of_key in fields(top, schema):
            if top == "base_motion":
                kinds = ("pulses",) if table != top else tuple(MOTIONS)
                found += [case_of(shaken(kind), table, key, of_key, f"key {table}.{key} of {kind}") for kind in kinds]
            else:
                found.append(case_of(HILL if top in OF_CUTS | OF_SEARCHES else YARD, table, key, of_key, f"key {table}.{key}"))
    return found
