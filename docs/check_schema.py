#!/usr/bin/env python3
"""Holds every scene of the tree, and some that are wrong, against the JSON Schema of scene files.

    docs/check_schema.py SCHEMA

Exit status: 0 if every scene is accepted and every wrong one is refused, else 1. The few words of JSON Schema that the schema uses are checked here, any other
one is an error: no package is needed. Where python3-jsonschema is installed, its verdict has to be the same.
"""

import json
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SILENT = {"$schema", "title", "description", "default"}
TYPES = {
    "boolean": lambda v: isinstance(v, bool),
    "number": lambda v: isinstance(v, (int, float)) and not isinstance(v, bool),
    "integer": lambda v: isinstance(v, (int, float)) and not isinstance(v, bool) and v == int(v),
    "string": lambda v: isinstance(v, str),
    "array": lambda v: isinstance(v, list),
    "object": lambda v: isinstance(v, dict),
}
LIMITS = {
    "minimum": lambda v, limit: v >= limit,
    "maximum": lambda v, limit: v <= limit,
    "exclusiveMinimum": lambda v, limit: v > limit,
    "exclusiveMaximum": lambda v, limit: v < limit,
    "minItems": lambda v, limit: len(v) >= limit,
    "maxItems": lambda v, limit: len(v) <= limit,
    "enum": lambda v, words: v in words,
}
# Added to a scene that is right.
WRONG = {
    "an unknown key": "[method]\nthetta = 1\n",
    "a number out of range": "[method]\ntheta = 0.4\n",
    "a word that is none": "[method]\nstart = 'cold'\n",
    "a text for a number": "[step]\ndt_s = '1'\n",
    "a number for a flag": "[method]\nstatics = 1\n",
    "part of a whole number": "[method]\nthreads = 1.5\n",
    "a list with a text": "[output]\nmilestones_m = [1, 'x']\n",
    "a key of another table": "[step]\ntheta = 1\n",
    "a block without a name": "[[block]]\nmaterial = 'a'\nvertices_m = [[0, 0], [1, 0], [0, 1]]\n",
    "a block with two corners": "[[block]]\nname = 'a'\nmaterial = 'a'\nvertices_m = [[0, 0], [1, 0]]\n",
    "a corner with three coordinates": "[[block]]\nname = 'a'\nmaterial = 'a'\nvertices_m = [[0, 0], [1, 0], [0, 1, 2]]\n",
    "a pulse without a duration": "[base_motion]\nkind = 'pulses'\n[[base_motion.pulse]]\nacceleration_m_per_s2 = [1, 0]\n",
    "a form of results that is none": "[output]\nformats = ['dxf']\n",
    "an unknown table": "[water]\nlevel_m = 1\n",
}


def faults(value, schema: dict, key: str = "") -> list[str]:
    if not TYPES[schema["type"]](value):
        return [f"{key}: {value!r} is no {schema['type']}"]
    found = [f"{key}: {value!r} against {word} {limit}" for word, limit in schema.items() if word in LIMITS and not LIMITS[word](value, limit)]
    for word in schema.keys() - LIMITS.keys() - SILENT - {"type", "properties", "additionalProperties", "items", "required"}:
        raise SystemExit(f"check_schema: {key}: the schema uses {word}, which this script does not know")
    if "items" in schema:
        found += [fault for i, item in enumerate(value) for fault in faults(item, schema["items"], f"{key}[{i}]")]
    if "properties" in schema:
        properties = schema["properties"]
        found += [f"{key}: {name} is missing" for name in schema.get("required", []) if name not in value]
        for name, item in value.items():
            if name in properties:
                found += faults(item, properties[name], f"{key}.{name}".lstrip("."))
            elif schema.get("additionalProperties") is False:
                found.append(f"{key}: {name} is not known")
    return found


def scenes() -> dict[str, dict]:
    """Scene files, and the scenes in the documents."""
    found = {}
    for file in sorted(path for path in ROOT.rglob("*.toml") if not {"build", "results"} & set(path.relative_to(ROOT).parts)):
        document = tomllib.loads(file.read_text(encoding="utf-8"))
        if "material" in document:
            found[str(file.relative_to(ROOT))] = document
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        texts: dict[str, str] = {}
        for name, body in re.findall(r"^```toml (\S+)(?: \+)?\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S):
            texts[name] = texts.get(name, "") + body
        found |= {f"{page.relative_to(ROOT)}: {name}": tomllib.loads(text) for name, text in texts.items()}
    return found


def main() -> int:
    schema = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    try:
        from jsonschema import Draft202012Validator
        validator = Draft202012Validator(schema)
    except ImportError:
        validator = None
    wrong = 0
    good = scenes()
    for name, scene in good.items():
        found = faults(scene, schema)
        if validator and bool(found) == validator.is_valid(scene):
            found.append("jsonschema is of another opinion")
        for fault in found:
            print(f"{name}: {fault}")
        wrong += bool(found)
    for name, text in WRONG.items():
        scene = next(iter(good.values())) | tomllib.loads(text)
        if not faults(scene, schema) or (validator and validator.is_valid(scene)):
            print(f"{name} is accepted")
            wrong += 1
    print(f"{len(good)} scenes, {len(WRONG)} faults{', jsonschema agrees' if validator else ''}: {wrong} wrong")
    return 1 if wrong or len(good) < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
