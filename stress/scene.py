"""A scene of the campaign: a document of scene keys, what was drawn for it, and what its judges have to know."""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Expected:
    """Displacement of a block's centroid at the end, from the start of the motion [m]."""

    block: str
    x: float
    y: float
    tolerance: float


@dataclass(frozen=True)
class Scene:
    part: str
    seed: int
    command: str  # of openclose: run or fos
    document: dict
    drawn: dict[str, float | str] = field(default_factory=dict)  # what the seed chose, for the table
    # Free blocks stay inside [x0, y0, x1, y1] [m] for good; None: nothing encloses them.
    enclosure: tuple[float, float, float, float] | None = None
    floor_m: float = 0.0  # no centroid can come lower: potential energy counts from here
    expected: tuple[Expected, ...] = ()
    most: float | None = None  # of `fos`: no forces balance beyond this factor, by a closed form
    too_soft: bool = False  # springs that give way by too much for these blocks: to refuse is right

    @property
    def name(self) -> str:
        return f"{self.part}-{self.seed}"

    def described(self) -> str:
        return " ".join(f"{key}={value:.4g}" if isinstance(value, float) else f"{key}={value}" for key, value in self.drawn.items())

    def write(self, file: Path) -> None:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(to_toml(self.document), encoding="utf-8")


def to_toml(document: dict) -> str:
    """Tables one level deep, and arrays of them, as scene files have them; a dot in a name makes a table within one."""
    lines = [f"{key} = {_value(value)}" for key, value in document.items() if not _is_table(value)]
    for key, value in document.items():
        if _is_table(value):
            tables, heading = (value, f"[[{key}]]") if isinstance(value, list) else ([value], f"[{key}]")
            for table in tables:
                lines += ["", heading, *(f"{k} = {_value(v)}" for k, v in table.items())]
    return "\n".join(lines) + "\n"


def _is_table(value: object) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def _value(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)


def log_uniform(random, low: float, high: float) -> float:
    return low * (high / low) ** random.random()


def rounded(value: float, digits: int = 6) -> float:
    """To significant digits, so that scene files can be read."""
    return float(f"{value:.{digits}g}")

# What `openclose cut` has worked in already.
OF_THE_CUT = "domain", "joint_set", "joint_line", "fixed_line", "region", "material", "joint", "block", "gravity_m_per_s2"


def of_blocks(scene: dict, cut: dict) -> dict:
    """A scene with a domain as one of blocks: those of the file that `openclose cut` wrote, with the scene's own analysis."""
    return {**{k: v for k, v in cut.items() if k in OF_THE_CUT}, **{k: v for k, v in scene.items() if k not in OF_THE_CUT}}


def densities(document: dict) -> dict[str, float]:
    """[kg/m3] By material."""
    gravity = math.hypot(*document.get("gravity_m_per_s2", (0.0, -9.81)))
    return {m["name"]: m["density_kg_per_m3"] if "density_kg_per_m3" in m else m["unit_weight_n_per_m3"] / gravity for m in document["material"]}


POINT_MARK = ":"  # between the name of a block and the number of one of its two measured points


def measured(document: dict) -> dict:
    """The document with two corners of every free block measured, the farthest from each other: what they do is all that a rigid block does."""
    points = []
    for block in document["block"]:
        if not block.get("fixed"):
            corners = block["vertices_m"]
            pair = max(((p, q) for i, p in enumerate(corners) for q in corners[:i]), key=lambda pq: math.dist(*pq))
            points += [{"name": f"{block['name']}{POINT_MARK}{k}", "block": block["name"], "point_m": list(p)} for k, p in enumerate(pair)]
    return {**document, "measured_point": points}
