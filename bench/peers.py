"""Other engines on the slope of example 3.4 without cohesion: time and, beside it, how near they come to its critical friction angle; and on the wall and
the pile of boxes of walls_and_piles.py: time and penetration. SI units."""

import json
import math
import statistics
from dataclasses import dataclass
from pathlib import Path

import walls_and_piles
from measure import Bench, Row, Trial
from methods import DEM, HARD, SOFT_PATH_AVERAGE, SOFT_SHI, Method
from openclose_scripts.examples.slopes import CutBlocks, JointedSlope
from openclose_scripts.processes import call
from openclose_scripts.runs import Case, Reference

STUDY, BLOCKS_STUDY = "other engines", "other engines, walls and piles"
SCENE = "3.4 without cohesion, in failure"
ENGINES = ("box2d", "chipmunk")
DT_S, END_S, REPEATS = 0.01, 5.0, 3
ANGLE_DEG = math.degrees(math.atan(math.tan(math.radians(40.0)) / 2.11))  # of example_3_4_post_failure.toml
OURS = ((SOFT_SHI, 0.01), (SOFT_SHI, 0.02), (SOFT_PATH_AVERAGE, 0.01), (SOFT_PATH_AVERAGE, 0.02), (HARD, 0.01), (HARD, 0.02), (DEM, 0.01))
LIMIT_S = 120

# A slope stands if no block has moved this far in this time; the bracket of the angle.
STANDS_M, STANDS_S, QUICK_STANDS_S = 1.0, 20.0, 10.0
LOW_DEG, HIGH_DEG, WIDTH_DEG = 10.0, 60.0, 0.1


@dataclass(frozen=True)
class Compared:
    """One engine or method."""

    name: str
    settings: str
    row: Row
    critical_deg: float | None
    simulated: float     # [s]
    iteration: float | None  # [s] CPU time of a Newton iteration: residual, assembly, factor, solve

    @property
    def step(self) -> float | None:
        return self.row.cpu_s / self.row.steps if self.row.cpu_s else None

    @property
    def per_second(self) -> float | None:
        return self.row.cpu_s / self.simulated if self.row.cpu_s else None


@dataclass(frozen=True)
class Findings:
    exact_deg: float  # limit analysis, sliding at the friction angle
    constant_volume_deg: float | None
    compared: list[Compared]


class Peers:
    def __init__(self, program: Path, blocks: Path):
        self._program = program
        self._blocks = blocks

    def run(self, engine: str, angle_deg: float, end: float, dt: float = DT_S) -> dict:
        answer = call([str(self._program), str(self._blocks), "--engine", engine, "--friction-angle-deg", f"{angle_deg:.17g}", "--dt", str(dt),
                       "--end", str(end)])
        # Chipmunk greets on standard output.
        return json.loads(answer[answer.index("{"):])

    def critical(self, engine: str, end: float) -> float | None:
        """[degrees] the smallest friction angle with which the slope stands, to WIDTH_DEG; none if it does not even with the largest"""
        def stands(angle: float) -> bool:
            return self.run(engine, angle, end)["farthest_m"] < STANDS_M

        low, high = LOW_DEG, HIGH_DEG
        if not stands(high) or stands(low):
            return None
        while high - low > WIDTH_DEG:
            middle = (low + high) / 2
            low, high = (low, middle) if stands(middle) else (middle, high)
        return (low + high) / 2


def _settings(method: Method) -> tuple[tuple[str, object], ...]:
    return (*method.settings, ("joint[0].cohesion_pa", 0.0), ("joint[0].friction_angle_deg", ANGLE_DEG), ("run.strength_reduction_factor", 1.0))


def _case(method: Method, dt: float) -> Case:
    settings = (*_settings(method), ("method.start", "unloaded"), ("step.dt_s", dt), ("end.time_s", END_S), ("output.every_s", END_S),
                ("output.milestones_m", []))
    return Case(f"peers-{method.name}-{dt:g}".replace(" ", "_"), "run", JointedSlope.POST_FAILURE, settings, LIMIT_S)


def _critical_of_ours(bench: Bench, method: Method) -> float | None:
    """[degrees] by strength reduction of friction alone, from 40 degrees"""
    settings = (("method.contact", dict(method.settings)["method.contact"]), ("joint[0].cohesion_pa", 0.0), ("strength_reduction.width", 1e-3))
    summary = bench.run(Case(f"peers-critical-{dict(settings)['method.contact']}", "fos", JointedSlope.SCENE, settings, LIMIT_S))
    factor = summary.get("factor_of_safety")
    return math.degrees(math.atan(math.tan(math.radians(40.0)) / factor)) if factor else None


def _error(angle_deg: float | None, exact_deg: float) -> float | None:
    """Of the coefficient of friction."""
    return None if angle_deg is None else abs(math.tan(math.radians(angle_deg)) / math.tan(math.radians(exact_deg)) - 1)


def _error_of(exact_deg: float) -> str:
    return f"critical coefficient of friction of the slope without cohesion against limit analysis, {exact_deg:.4g} degrees"


def _row(runs: list[dict], error: float | None, error_of: str, study: str = STUDY, scene: str = SCENE, dt: float = DT_S) -> Row:
    cpu = [run["cpu_s"] for run in runs]
    first = runs[0]
    return Row(scene, first["engine"], first["blocks"], None, dt, first["steps"], None, statistics.median(cpu), error, first["max_penetration_m"],
               first["peak_memory_bytes"], len(cpu), min(cpu), max(cpu), study, error_of, "")


def _walls_and_piles(bench: Bench, program: Path) -> None:
    """The scenes that did not shape the program, in steps of one length for all; nothing tells how wrong an engine is on them."""
    for load in walls_and_piles.loads(bench):
        engines = Peers(program, load.file)
        runs = {engine: [engines.run(engine, walls_and_piles.FRICTION_DEG, load.end, load.dt) for _ in range(REPEATS)] for engine in ENGINES}
        bench.measure([Trial(BLOCKS_STUDY, load.name, m.name, load.case(m), "motion", "", lambda _: None, load.dt) for m in load.methods])
        bench.rows += [_row(of_engine, None, "", BLOCKS_STUDY, load.name, load.dt) for of_engine in runs.values()]


def run(bench: Bench, reference: Reference, program: Path) -> Findings:
    cut = CutBlocks("peers", JointedSlope.SCENE, bench.openclose, reference)
    bench.openclose.run(cut.case)
    blocks = bench.openclose.blocks_file(cut.case)
    peers = Peers(program, blocks)

    def limit(*flags: str) -> float:
        rows = reference.table("limit-analysis", {}, (str(blocks), "--critical-friction", *flags))
        return next(float(row["value"]) for row in rows if row["quantity"] == "critical_friction_angle_deg")

    exact = limit()
    end = QUICK_STANDS_S if bench.quick else STANDS_S
    critical = {engine: peers.critical(engine, end) for engine in ENGINES}
    ours_critical = {method.name: _critical_of_ours(bench, method) for method in dict.fromkeys(m for m, _ in OURS)}

    # Theirs before and after ours, so that a change in the machine shows in the spread.
    theirs: dict[str, list[dict]] = {engine: [] for engine in ENGINES}
    for _ in range(REPEATS):
        for engine, runs in theirs.items():
            runs.append(peers.run(engine, ANGLE_DEG, END_S))
    rows = bench.measure([Trial(STUDY, SCENE, f"{m.name}, {1e3 * dt:g} ms", _case(m, dt), "motion", _error_of(exact),
                                lambda _, m=m: _error(ours_critical[m.name], exact), dt) for m, dt in OURS])
    for engine, runs in theirs.items():
        runs.append(peers.run(engine, ANGLE_DEG, END_S))
    compared = []
    for engine, runs in theirs.items():
        row = _row(runs, _error(critical[engine], exact), _error_of(exact))
        bench.rows.append(row)
        compared.append(Compared(row.method, runs[0]["settings"] + f"; {runs[0]['split_blocks']} blocks split", row, critical[engine], END_S, None))
    for (method, dt), row in zip(OURS, rows):
        compared.append(Compared(row.method, "", row, ours_critical[method.name], END_S, _iteration(bench, _case(method, dt), row)))
    _walls_and_piles(bench, program)
    return Findings(exact, limit("--zero-dilatancy"), compared)


def _iteration(bench: Bench, case: Case, row: Row) -> float | None:
    """Stages are told in wall time: their part of the whole on the CPU time."""
    stages = bench.summaries(case)[0].get("stage_s")
    if not row.cpu_s or not row.iterations or not stages:
        return None
    return row.cpu_s * stages["solution"] / sum(stages.values()) / row.iterations
