"""Static equilibrium from nothing and strength reduction: run time against error. SI units."""

import math
from collections.abc import Callable
from pathlib import Path

from measure import CPU_LIMIT_S, Bench, Trial
from methods import DEM, HARD, SHI, SOFT, Method, Settings
from openclose_scripts import PAPER_SCENES
from openclose_scripts.examples.slopes import SHI_SETTLE_STEPS, PlanarSlope
from openclose_scripts.runs import Case, Reference, outlines

EQUILIBRIUM, REDUCTION = "equilibrium", "strength reduction"
SCENES = {"3.3": PAPER_SCENES / "example_3_3_wedge.toml", "3.4": PAPER_SCENES / "example_3_4.toml"}
METHODS = (SOFT, HARD, SHI, DEM)

# What is left unbalanced, over the weight of the heaviest block; the converged state has less than all of them. Close to each other where errors
# are about 1 %, so that each method is seen near the largest error that counts.
FRACTIONS = (9e-1, 3e-1, 1e-1, 3e-2, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
# [s] The first step of the implicit methods: what its inertia carries is missing, so that longer ones need no second, and shorter ones are found
# sooner. dem has none.
FIRST_STEPS_S = {SOFT: (0.5, 1.0, 10.0), HARD: (1.0, 10.0), SHI: (0.5, 1.0, 10.0)}
CONVERGED_FRACTION = 1e-10
NOTE = "`soft`, `hard` and `shi` are tried with several first steps (`settle.first_dt_s`, column dt), of which the quickest counts; `dem` has none."
ERROR_OF = f"place of any vertex against the method's own converged state (unbalanced {CONVERGED_FRACTION:g}), over the settlement of soft"
WIDTH = 0.005
TIGHT = (("strength_reduction.width", 1e-4), ("settle.failure_displacement_m", 1.0))
EXTRA: dict[str, Settings] = {"shi": (("settle.max_steps", SHI_SETTLE_STEPS),)}


def settling(scene: str, method: Method, fraction: float, more: Settings = (), file: Path | None = None, limit: int = CPU_LIMIT_S) -> Case:
    """Settles from unloaded springs; the one step of motion afterwards is there because a run has one."""
    dt = 1e-3
    settings = (*method.settings, *EXTRA.get(method.name, ()), ("settle.unbalanced_fraction", fraction), ("step.dt_s", dt), ("end.time_s", dt), *more)
    return Case(f"settle-{scene}-{method.name}-{fraction:g}".replace(" ", "_"), "run", file or SCENES[scene], settings, limit)


def _settling_from(scene: str, method: Method, fraction: float, first_step: float | None) -> Case:
    """With a first step [s], if it is not the usual one."""
    if first_step is None:
        return settling(scene, method, fraction)
    return settling(f"{scene} from {first_step:g} s", method, fraction, (("settle.first_dt_s", first_step),), SCENES[scene])


def _settlement(bench: Bench, case: Case) -> dict[str, list[tuple[float, float]]]:
    """[m] way of every vertex into the state in which the run starts"""
    rows = bench.openclose.table(case, "blocks.csv")
    before, after = outlines(rows, "initial"), outlines(rows, "start")
    return {block: [(q[0] - p[0], q[1] - p[1]) for p, q in zip(before[block], after[block])] for block in before}


def _largest_difference(a: dict, b: dict) -> float:
    return max(math.dist(p, q) for block in a for p, q in zip(a[block], b[block]))


def _largest(a: dict) -> float:
    return max(math.hypot(*p) for way in a.values() for p in way)


def _distance_from(bench: Bench, converged: dict, scale: float) -> Callable[[Case], float]:
    return lambda case: _largest_difference(_settlement(bench, case), converged) / scale


def _equilibrium(bench: Bench, scene: str) -> None:
    """Friction makes the state depend on the way there, so each method is held against its own converged state, in parts of the settlement of `soft`
    (rigid contacts hardly have one)."""
    scale = None
    trials = []
    for method in METHODS:
        converged = settling(scene, method, CONVERGED_FRACTION)
        summary = bench.run(converged)
        if not summary.get("converged"):
            bench.leave_out(EQUILIBRIUM, scene, method.name, f"no converged state to compare with: {summary.get('reason')}")
            continue
        state = _settlement(bench, converged)
        scale = _largest(state) if scale is None else scale
        trials += [Trial(EQUILIBRIUM, scene, method.name, _settling_from(scene, method, f, first), "start", ERROR_OF,
                         _distance_from(bench, state, scale), first)
                   for f in FRACTIONS for first in FIRST_STEPS_S.get(method, (None,))]
    bench.measure(trials)


def _reduction(scene: str, method: Method, more: Settings = (("strength_reduction.width", WIDTH),), name: str = "") -> Case:
    settings = (*method.settings, *EXTRA.get(method.name, ()), *more)
    return Case(f"fos-{scene}-{method.name}{name}", "fos", SCENES[scene], settings, CPU_LIMIT_S)


def _relative(bench: Bench, exact: float) -> Callable[[Case], float | None]:
    return lambda case: abs(bench.openclose.summary(case)["factor_of_safety"] / exact - 1)


def _reductions(bench: Bench, scene: str, exact: float, error_of: str) -> None:
    bench.measure([Trial(REDUCTION, scene, m.name, _reduction(scene, m), "search", error_of, _relative(bench, exact)) for m in METHODS])


def run(bench: Bench, reference: Reference) -> None:
    for scene in SCENES:
        _equilibrium(bench, scene)
    closed_form = PlanarSlope(bench.openclose, reference).closed_form()
    _reductions(bench, "3.3", closed_form, f"factor of safety against the closed form, {closed_form:.5g}")
    tight = bench.run(_reduction("3.4", SOFT, TIGHT, "-tight"))["factor_of_safety"]
    _reductions(bench, "3.4", tight, f"factor of safety against a search by soft to a bracket of 1e-4 and 1 m of way, {tight:.5g}")
