"""Example 3.4 after failure: run time against the error of the times at which the toe block has moved so far. SI units."""

import statistics
from collections.abc import Callable
from dataclasses import dataclass

from measure import Bench, Trial
from methods import DEM, HARD, SHI, SOFT_PATH_AVERAGE, SOFT_SHI, Method
from runs import Case
from slopes import JointedSlope

STUDY, LARGE = "failure", "failure, more blocks"
DISTANCES_M = (10.0, 20.0, 30.0, 40.0)
LIMIT_S = 200
# The strength is divided by the scene's factor times 1 + k of this: what a mean over starts differs by tells how much a single run says.
PERTURBATION = 1e-6
FACTOR = 2.11
STARTS, QUICK_STARTS = 5, 3
REFERENCE_STEPS_S = (1e-3, 5e-4)
QUICK_REFERENCE_STEPS_S = (2e-3, 1e-3)


@dataclass(frozen=True)
class Follower:
    method: Method
    steps: tuple[float, ...]  # [s]
    key: str = "step.dt_s"    # dem is refined by the fraction of its critical step


FOLLOWERS = (
    Follower(SOFT_SHI, (0.05, 0.02, 0.01, 0.005, 0.002, 0.001)),
    Follower(SOFT_PATH_AVERAGE, (0.05, 0.02, 0.01, 0.005, 0.002, 0.001)),
    Follower(HARD, (0.05, 0.02, 0.01, 0.005, 0.002, 0.001)),
    Follower(SHI, (0.01, 0.005, 0.002, 0.001)),
    Follower(DEM, (0.9, 0.45, 0.225), "method.step_fraction"),
)


@dataclass(frozen=True)
class Arrival:
    """At the distances: mean over the starts, and the spread between them."""

    times: tuple[float, ...]
    spread: float  # [-] largest of the distances: half of what lies between the starts, over the mean


def _case(method: Method, key: str, value: float, start: int) -> Case:
    settings = [*method.settings, ("step.dt_s", 0.01), (key, value), ("run.strength_reduction_factor", FACTOR * (1 + PERTURBATION * start)),
                ("output.every_s", 1.0), ("output.milestones_m", list(DISTANCES_M))]
    return Case(f"failure-{method.name}-{value:g}-{start}".replace(" ", "_"), "run", JointedSlope.POST_FAILURE, tuple(settings), LIMIT_S)


def _times(bench: Bench, case: Case) -> list[float] | None:
    rows = bench.openclose.table(case, "milestones.csv")
    return None if not rows or any(row["reason"] for row in rows) else [float(row["time_s"]) for row in rows]


def _arrival(bench: Bench, cases: list[Case]) -> Arrival | None:
    """The runs are made already, or are made now."""
    of_starts = []
    for case in cases:
        if not (bench.openclose.folder_of(case) / "milestones.csv").exists():
            bench.run(case)
        times = _times(bench, case)
        if times is None:
            return None
        of_starts.append(times)
    by_distance = list(zip(*of_starts))
    means = tuple(statistics.fmean(times) for times in by_distance)
    return Arrival(means, max((max(t) - min(t)) / 2 / m for t, m in zip(by_distance, means)))


def _distance(a: Arrival, b: Arrival) -> float:
    return max(abs(x / y - 1) for x, y in zip(a.times, b.times))


@dataclass
class Findings:
    """`converged` is what the two references differ by, the finer one's spread over its starts beside it; `spreads` likewise by method and step."""

    reference: Arrival
    converged: float
    spreads: dict[tuple[str, float], Arrival]


def run(bench: Bench) -> Findings | None:
    starts = range(QUICK_STARTS if bench.quick else STARTS)
    steps = QUICK_REFERENCE_STEPS_S if bench.quick else REFERENCE_STEPS_S
    coarse, fine = (_arrival(bench, [_case(SOFT_PATH_AVERAGE, "step.dt_s", dt, k) for k in starts]) for dt in steps)
    if coarse is None or fine is None:
        bench.leave_out(STUDY, "3.4 in failure", "all", "the reference did not get to 40 m")
        return None
    findings = Findings(fine, _distance(coarse, fine), {})

    def error(follower: Follower, value: float) -> Callable[[Case], float | None]:
        def of(_: Case) -> float | None:
            arrival = _arrival(bench, [_case(follower.method, follower.key, value, k) for k in starts])
            if arrival is None:
                return None
            findings.spreads[follower.method.name, value] = arrival
            return _distance(arrival, fine)

        return of

    bench.measure([
        Trial(STUDY, "3.4 in failure", f.method.name, _case(f.method, f.key, value, 0), "motion",
              f"time at which the toe block has moved 10, 20, 30, 40 m, mean of {len(starts)} starts, largest of the four against soft path_average with "
              f"{1e3 * steps[1]:g} ms", error(f, value), value if f.key == "step.dt_s" else None)
        for f in FOLLOWERS for value in (f.steps[:4] if bench.quick else f.steps)])
    return findings
