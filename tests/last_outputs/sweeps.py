"""Every key of a scene file at its limits, just beyond them, at its other values and left out, in small scenes that use all tables: a case a key."""

import copy
import json
import sys

from case import Case
from openclose_scripts import ROOT
from scenes import COMPANIONS, HILL, METHODS, MOTIONS, SCHEMA, YARD, shaken

sys.path += [str(ROOT / "stress"), str(ROOT / "docs")]

from check_schema import faults  # noqa: E402
from scene import to_toml  # noqa: E402

OF_METHODS = {"method", "step", "solver", "rest", "run", "end", "output"}  # tables tried in a motion by each method
OF_SEARCHES = {"strength_reduction"}
OF_CUTS = {"domain", "joint_set", "joint_line", "fixed_line", "region"}
END = "0.03"
# Limits beyond this are of memory and of time: what stands there would not end.
LARGEST = 1e4
# What the scenes call things, and loads that increase: one of them is accepted where another is not known.
NAMES = ("smooth", "bridge", "rock", "clay", "low", "high", "guided", "gravity_x", "-gravity_y")
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
        found = ["nonsense", "", *NAMES]
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
    return [*changed, [base[0] + 0.1, *base[1:]], [base[0] - 0.1, *base[1:]], [*base[:-1], base[-1] - 0.05], [-base[0] - 0.3, *base[1:]], [0, *base[1:]], [1e9, *base[1:]], ["x", *base[1:]]]


def put(scene: dict, table: str, key: str, value) -> dict:
    """The scene with another value; of a table that comes several times in its first one."""
    scene = copy.deepcopy(scene)
    found = scene.setdefault(table, {})
    row = found[0] if isinstance(found, list) else found
    for name, wanted in {**COMPANIONS.get(f"{table}.{key}", {}), key: None if value is MISSING else value}.items():
        row.pop(name, None)
        if wanted is not None:
            row[name] = wanted
    return scene


def base_of(scene: dict, table: str, key: str):
    found = scene.get(table, {})
    return (found[0] if isinstance(found, list) else found).get(key, MISSING)


def attempts(table: str, file: str) -> list[list[str]]:
    """What is tried with a value that the schema accepts."""
    folder = file.removesuffix(".toml")
    quiet = [file, "--quiet", "-o", folder]

    def run(name: str, *options: str) -> list[str]:
        return ["run", file, "--quiet", "-o", f"{folder}_{name}", "--end", END, *options]

    settled = [run(f"{m}_settled", "--contact", m, "--set", "method.start=settled") for m in METHODS]
    if table in OF_METHODS:
        return [run(m, "--contact", m) for m in METHODS] + (settled if table == "solver" else [])
    if table == "settle":
        # Each criterion and method has keys of its own.
        return [*settled, run("paper", "--set", "method.start=settled", "--set", "settle.criterion=paper")]
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


def outside_of_tables(key: str, schema: dict) -> Case:
    scenes = [{k: v for k, v in YARD.items() if k != key}, *(YARD | {key: value} for value in values(schema, YARD[key])[1:])]
    files = {f"{i}.toml": to_toml(scene) for i, scene in enumerate(scenes)}
    return Case(f"key {key}", [["run", file, "-q", "--end", END, "-o", file.removesuffix(".toml")] for file in files], files, together=True)


def cases() -> list[Case]:
    found = [bases(), former_names()]
    for top, schema in SCHEMA.items():
        if schema["type"] == "string" or schema.get("items", {}).get("type") == "number":
            found.append(outside_of_tables(top, schema))
            continue
        for table, key, of_key in fields(top, schema):
            if top == "base_motion":
                kinds = ("pulses",) if table != top else tuple(MOTIONS)
                found += [case_of(shaken(kind), table, key, of_key, f"key {table}.{key} of {kind}") for kind in kinds]
            else:
                found.append(case_of(HILL if top in OF_CUTS | OF_SEARCHES else YARD, table, key, of_key, f"key {table}.{key}"))
    return found
