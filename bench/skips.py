"""What each skip saves: the same run with it and without, and whether the answer is the same. SI units."""

from measure import Bench, Trial
from methods import DEM, HARD, SHI, SOFT, Method
from openclose_scripts.examples.slopes import JointedSlope
from openclose_scripts.runs import Case

STUDY = "skips"
END_S, LIMIT_S = 4.0, 100
STEP_S = {"soft": 0.01, "hard": 0.01, "shi": 0.001, "dem": 0.01}
QUICK_END_S = 1.0
ALL = "all skips on"
SWITCHED_ON = ("skip_resting",)  # that a scene has to ask for


def _case(bench: Bench, method: Method, off: tuple[str, ...]) -> Case:
    end = QUICK_END_S if bench.quick else END_S
    settings = (*method.settings, ("step.dt_s", STEP_S[method.name]), ("end.time_s", end), ("output.every_s", end), ("output.milestones_m", []),
                *((f"solver.{key}", "false" if key in off else "true") for key in dict.fromkeys((*SWITCHED_ON, *off))))
    return Case(f"skips-{method.name}-{'-'.join(off) or 'on'}", "run", JointedSlope.POST_FAILURE, settings, LIMIT_S)


def _toe(bench: Bench, case: Case) -> tuple[float, float]:
    last = bench.openclose.table(case, "history.csv")[-1]
    return float(last["displacement_x_m"]), float(last["displacement_y_m"])


def _error(bench: Bench, method: Method):
    def of(case: Case) -> float:
        x, y = _toe(bench, _case(bench, method, ()))
        a, b = _toe(bench, case)
        return ((a - x) ** 2 + (b - y) ** 2) ** 0.5 / (x * x + y * y) ** 0.5

    return of


def keys(summary: dict) -> tuple[str, ...]:
    return tuple(key for key in summary.get("options", {}).get("solver", {}) if key.startswith("skip_"))


def run(bench: Bench) -> None:
    methods = (SOFT, HARD, SHI, DEM)
    trials = []
    for method in methods:
        all_on = _case(bench, method, ())
        found = keys(bench.run(all_on))
        for off in ((), *((key,) for key in found), *((found,) if len(found) > 1 else ())):
            name = ALL if not off else ("all off" if len(off) > 1 else f"{off[0]} off")
            trials.append(Trial(STUDY, f"3.4 in failure, {method.name}", name, _case(bench, method, off), "motion",
                                "place of the toe block against the run with all skips, over its way", _error(bench, method), STEP_S[method.name]))
    bench.measure(trials)


def stages(bench: Bench) -> dict[str, dict[str, float]]:
    """[s] by method and stage, of the run with all skips; settling included."""
    return {m.name: summary["stage_s"] for m in (SOFT, HARD, SHI, DEM)
            if (summary := bench.summaries(_case(bench, m, ()))[0]).get("stage_s")}
