"""The paper's Table 4 and Fig. 10 as ratios between methods in one run. CPU seconds of ours, minutes of the paper's."""

from measure import Bench, Trial
from methods import DEM, SHI, SOFT, Method
from openclose_scripts.examples.slopes import JointedSlope
from openclose_scripts.runs import Case

STUDY = "Table 4"
PAPER_STEP_S = 0.001
LIMIT_S = 200
METHODS = {"shi": (SHI, PAPER_STEP_S), "soft": (SOFT, PAPER_STEP_S), "dem": (DEM, 0.01)}
LONG_STEP, LONG_STEP_S = "soft, 10 ms", 0.01


def _case(method: Method, dt: float) -> Case:
    return Case(f"table-4-{method.name}-{dt:g}", "run", JointedSlope.POST_FAILURE, (*method.settings, ("step.dt_s", dt)), LIMIT_S)


def _cases() -> dict[str, tuple[Case, float]]:
    cases = {name: (_case(method, dt), dt) for name, (method, dt) in METHODS.items()}
    return cases | {LONG_STEP: (_case(SOFT, LONG_STEP_S), LONG_STEP_S)}


def run(bench: Bench) -> None:
    bench.measure([Trial(STUDY, "3.4 in failure", name, case, "motion", "", lambda _: None, dt) for name, (case, dt) in _cases().items()])


def rows(bench: Bench, printed: dict) -> list[tuple[str, dict[str, float | None], dict[str, float | None]]]:
    """(what, ours, the paper's), each by method, over that of `soft` with the paper's step"""
    cases = {name: case for name, (case, _) in _cases().items()}
    table = printed["table_4"]
    steady = {name: bench.openclose.summary(case).get("cpu_s", {}).get("start") for name, case in cases.items()}
    found = [("steady state", _over(steady, "soft"), _over({m: table[m]["steady_minutes"] for m in METHODS}, "soft"))]
    reached = {name: {float(r["displacement_m"]): float(r["cpu_s"]) for r in bench.openclose.table(case, "milestones.csv") if not r["reason"]}
               for name, case in cases.items()}
    for i, distance in enumerate(table["milestones_m"]["value"]):
        ours = {name: way.get(float(distance)) for name, way in reached.items()}
        found.append((f"{distance} m", _over(ours, "soft"), _over({m: table[m]["post_failure_minutes"][i] for m in METHODS}, "soft")))
    return found


def _over(values: dict[str, float | None], whose: str) -> dict[str, float | None]:
    base = values.get(whose)
    return {name: None if not base or value is None else value / base for name, value in values.items()}
