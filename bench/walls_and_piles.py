"""Scenes that did not shape the program: a wall of 10,040 bricks, at rest and under a weight that comes at once, and 1,000 boxes dropped on a pile. SI units."""

import random
from dataclasses import dataclass
from pathlib import Path

from measure import Bench, Trial
from methods import DEM, HARD, SOFT, Method, Settings
from openclose_scripts.examples.slopes import JointedSlope
from openclose_scripts.runs import Case
from scaling import LARGEST_STEP, spacings

STUDY = "walls and piles"
REST, COLD, PILE = "wall at rest", "wall loaded at once", "dropped pile"
SOLVERS = ("automatic", "direct", "iterative")
LIMIT_S = 300
WALL_DT_S, REST_STEPS, COLD_STEPS = 0.01, 40, 20
PILE_DT_S, PILE_END_S, PILE_QUICK_END_S = 0.005, 3.0, 1.5
SLOPES, QUICK_SLOPES = (500, 2000, 10000, 50000), (500, 2000)
SLOPE_DT_S, SLOPE_STEPS = 0.01, 10
SEED = 1
FRICTION_DEG = 30

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
    return HEAD.format(stiffness="1e10", friction=FRICTION_DEG) + "".join(blocks) + "[step]\ndt_s = 0.01\n[end]\ntime_s = 0.2\n"


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
    return HEAD.format(stiffness="1e9", friction=FRICTION_DEG) + "".join(blocks) + "[step]\ndt_s = 0.005\n[end]\ntime_s = 1.0\n"


def _write(folder: Path, name: str, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.toml"
    file.write_text(text)
    return file


def _case(name: str, scene: Path, method: Method, start: str, solver: str, dt: float, end: float, more: Settings = ()) -> Case:
    settings = (*method.settings, ("method.start", start), *((("solver.linear_solver", solver),) if solver else ()), ("step.dt_s", dt),
                ("end.time_s", end), ("output.every_s", end), *more)
    return Case(f"{name}-{method.name}-{solver or 'explicit'}", "run", scene, settings, LIMIT_S)


def _way_of_a_wall(bench: Bench):
    """[m] The farthest that a block has gone since it has settled."""
    def of(case: Case) -> float:
        rows = bench.openclose.table(case, "history.csv")
        ways = [[float(row[key]) for key in ("displacement_x_m", "displacement_y_m")] for row in (rows[0], rows[-1])]
        return max(abs(a - b) for a, b in zip(*ways))
    return of


@dataclass(frozen=True)
class Load:
    """A scene whose gravity comes at once."""

    name: str
    stem: str
    file: Path
    dt: float
    end: float
    methods: tuple[Method, ...]

    def case(self, method: Method, solver: str = "automatic") -> Case:
        return _case(self.stem, self.file, method, "unloaded", "" if method == DEM else solver, self.dt, self.end)


def loads(bench: Bench) -> tuple[Load, Load]:
    """`dem` takes minutes for the wall."""
    folder = bench.openclose.folder_of(Case("walls-and-piles", "run", Path()))
    pile_end = PILE_QUICK_END_S if bench.quick else PILE_END_S
    return (Load(COLD, "wall-cold", _write(folder, "wall", wall_scene()), WALL_DT_S, WALL_DT_S * COLD_STEPS, (SOFT, HARD)),
            Load(PILE, "pile", _write(folder, "pile", pile_scene()), PILE_DT_S, pile_end, (SOFT, HARD, DEM)))


def _chosen(bench: Bench, scene: str, case_of, dt: float) -> None:
    """The same steps with each way to solve the linear equations."""
    bench.measure([Trial(STUDY, scene, f"{m.name}, {s}", case_of(m, s), "motion", "", lambda _: None, dt) for m in (SOFT, HARD) for s in SOLVERS])


def run(bench: Bench) -> None:
    cold, pile = loads(bench)
    bench.measure([Trial(STUDY, REST, m.name, _case("wall-at-rest", cold.file, m, "settled", "automatic", WALL_DT_S, WALL_DT_S * REST_STEPS), "motion",
                         "way of a block of a wall that stands [m]", _way_of_a_wall(bench), WALL_DT_S) for m in (SOFT, HARD)])
    for load in (cold, pile):
        _chosen(bench, load.name, load.case, load.dt)
    bench.measure([Trial(STUDY, PILE, DEM.name, pile.case(DEM), "motion", "", lambda _: None, PILE_DT_S)])
    for blocks in QUICK_SLOPES if bench.quick else SLOPES:
        more = (*spacings(blocks), *LARGEST_STEP, ("output.milestones_m", []))
        _chosen(bench, slope(blocks), lambda m, s: _case(f"slope-{blocks}", JointedSlope.POST_FAILURE, m, "unloaded", s, SLOPE_DT_S,
                                                         SLOPE_DT_S * SLOPE_STEPS, more), SLOPE_DT_S)


def slope(blocks: int) -> str:
    return f"3.4 of {blocks}, loaded at once"


def scenes(bench: Bench) -> list[str]:
    return list(dict.fromkeys(row.scene for row in bench.of(STUDY)))


def per_step(bench: Bench, scene: str, method: str) -> float | None:
    """[s] CPU time of a step, mean over the run."""
    row = next((r for r in bench.of(STUDY, scene) if r.method == method and not r.reason), None)
    return row.cpu_s / row.steps if row and row.steps else None


def cost(bench: Bench, scene: str, method: str) -> float | None:
    """[s] CPU time of the run"""
    return next((r.cpu_s for r in bench.of(STUDY, scene) if r.method == method and not r.reason), None)


def over_the_best(bench: Bench, scene: str, method: str) -> float | None:
    """What the solver that the program chooses costs over the best of them."""
    costs = [cost(bench, scene, f"{method}, {s}") for s in SOLVERS]
    return costs[0] / min(c for c in costs if c) if costs[0] else None
