"""Scenes that did not shape the program: a wall of 10,040 bricks, at rest and under a weight that comes at once, and 1,000 boxes dropped on a pile. SI units."""

import random
from pathlib import Path

from measure import Bench, Row, Trial
from methods import DEM, HARD, SOFT, Method
from openclose_scripts.runs import Case

STUDY = "walls and piles"
REST, COLD, PILE = "wall at rest", "wall loaded at once", "dropped pile"
SOLVERS = ("automatic", "direct", "iterative")
LIMIT_S = 300
WALL_DT_S, WALL_STEPS = 0.01, 20
PILE_DT_S, PILE_END_S, PILE_QUICK_END_S = 0.005, 3.0, 1.5
SEED = 1

HEAD = """[[material]]
name = "stone"
density_kg_per_m3 = 2500
[[joint]]
materials = ["stone", "stone"]
normal_stiffness_pa_per_m = {stiffness}
shear_stiffness_pa_per_m = {stiffness}
friction_angle_deg = {friction}
"""


def _block(name: str, corners: list[tuple[float, float]], fixed: bool = False) -> str:
    vertices = ", ".join(f"[{x:.6g}, {y:.6g}]" for x, y in corners)
    return f'[[block]]\nname = "{name}"\nmaterial = "stone"\n{"fixed = true" + chr(10) if fixed else ""}vertices_m = [{vertices}]\n'


def _box(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def wall_scene(courses: int = 80, bricks: int = 126, length: float = 0.5, height: float = 0.25) -> str:
    """In running bond; every second course has a brick less."""
    blocks = [_block("base", _box(-1.0, -1.0, bricks * length + 2.0, 1.0), True)]
    for course in range(courses):
        shifted = course % 2
        blocks += [_block(f"b{course}_{k}", _box((k + 0.5 * shifted) * length, course * height, length, height)) for k in range(bricks - shifted)]
    return HEAD.format(stiffness="1e10", friction=30) + "".join(blocks) + "[step]\ndt_s = 0.01\n[end]\ntime_s = 0.2\n"


def pile_scene(columns: int = 25, rows: int = 40, seed: int = SEED) -> str:
    """Boxes of 0.3 to 0.5 m, turned a little, above a floor between two walls."""
    draw = random.Random(seed)
    width, cell = 0.6 * columns, 0.6
    blocks = [_block("floor", _box(-1.0, -1.0, width + 2.0, 1.0), True), _block("left", _box(-1.0, 0.0, 1.0, cell * rows), True),
              _block("right", _box(width, 0.0, 1.0, cell * rows), True)]
    for row in range(rows):
        for column in range(columns):
            a, b, turn = draw.uniform(0.15, 0.2), draw.uniform(0.15, 0.2), draw.uniform(-0.05, 0.05)
            x, y = cell * (column + 0.5), cell * (row + 0.5)
            corners = [(x + s * a - t * b * turn, y + t * b + s * a * turn) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            blocks.append(_block(f"b{row}_{column}", corners))
    return HEAD.format(stiffness="1e9", friction=30) + "".join(blocks) + "[step]\ndt_s = 0.005\n[end]\ntime_s = 1.0\n"


def _write(folder: Path, name: str, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.toml"
    file.write_text(text)
    return file


def _wall(scene: Path, method: Method, start: str, solver: str, steps: int) -> Case:
    settings = (*method.settings, ("method.start", start), ("solver.linear_solver", solver), ("step.dt_s", WALL_DT_S),
                ("end.time_s", WALL_DT_S * steps), ("output.every_s", WALL_DT_S * steps))
    return Case(f"wall-{method.name}-{start}-{solver}-{steps}", "run", scene, settings, LIMIT_S)


def _pile(scene: Path, method: Method, solver: str, end: float) -> Case:
    settings = (*method.settings, ("method.start", "unloaded"), ("step.dt_s", PILE_DT_S), ("end.time_s", end), ("output.every_s", end))
    return Case(f"pile-{method.name}-{solver}", "run", scene, settings if method is DEM else (*settings, ("solver.linear_solver", solver)), LIMIT_S)


def _farthest(bench: Bench):
    """[m] that the blocks of a wall at rest have moved."""
    def of(case: Case) -> float:
        rows = bench.openclose.table(case, "history.csv")
        return float(rows[-1]["max_displacement_m"]) - float(rows[0]["max_displacement_m"])
    return of


def run(bench: Bench) -> None:
    folder = bench.openclose.folder_of(Case("walls-and-piles", "run", Path()))
    wall, pile = _write(folder, "wall", wall_scene()), _write(folder, "pile", pile_scene())
    end = PILE_QUICK_END_S if bench.quick else PILE_END_S
    bench.measure([Trial(STUDY, REST, m.name, _wall(wall, m, "settled", "automatic", WALL_STEPS), "motion", "way of a wall that stands", _farthest(bench), WALL_DT_S)
                   for m in (SOFT, HARD)])
    bench.measure([Trial(STUDY, COLD, f"{m.name}, {s}", _wall(wall, m, "unloaded", s, WALL_STEPS), "motion", "", lambda _: None, WALL_DT_S)
                   for m in (SOFT, HARD) for s in SOLVERS])
    bench.measure([Trial(STUDY, PILE, f"{m.name}, {s}" if m is not DEM else m.name, _pile(pile, m, s, end), "motion", "", lambda _: None, PILE_DT_S)
                   for m, solvers in ((SOFT, SOLVERS), (HARD, SOLVERS), (DEM, ("",))) for s in solvers])


def per_step(row: Row) -> float | None:
    """[s] CPU time"""
    return row.cpu_s / row.steps if row.cpu_s and row.steps else None
