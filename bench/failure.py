"""Example 3.4 after failure: run time against the error of the times at which the toe block has moved so far. SI units."""

import statistics
from collections.abc import Callable
from dataclasses import dataclass

from measure import Bench, Trial
from methods import (ADAPTIVE, ADAPTIVE_AHEAD_WIDE, AHEAD, AHEAD_WIDE, DEM, DEM_COARSE_REST, DEM_WIDE, HARD, LONG, SHI, SOFT_PATH_AVERAGE,
                     SOFT_SHI, Method, Settings)
from openclose_scripts.runs import Case
from scaling import spacings
from openclose_scripts.examples.slopes import JointedSlope

STUDY, SCENE = "failure", "3.4 in failure"
# The same with blocks at rest left alone.
RESTING_SCENE, RESTING = "3.4 in failure, blocks at rest left alone", (("solver.skip_resting", "true"),)
DISTANCES_M = (10.0, 20.0, 30.0, 40.0)
LIMIT_S = 250
# The strength is divided by the scene's factor times 1 + k of this, for a number of starts: what these differ by tells how much one run says.
PERTURBATION = 1e-6
FACTOR = 2.11
STARTS, QUICK_STARTS = 3, 2
# The reference is the finer of two steps, which show that it has converged. No run that is judged has its step.
REFERENCE = SOFT_PATH_AVERAGE
REFERENCE_STEPS_S = (2e-3, 1e-3)
QUICK_REFERENCE_STEPS_S = (4e-3, 2e-3)
# More blocks, smaller ones: the contacts of a step are those of its start, and blocks of 2 m that move at 15 m/s leave and meet corners within steps
# of milliseconds. From the same state of 10,000 blocks at 10 m path_average comes to the motion of dem with the first power of its step (after 0.3 s
# they are 0.76, 0.45, 0.12 mm rms apart with 2.5, 1.25, 0.5 ms; two fractions of dem's step 0.06 mm), so that two of its steps agree long before
# either is right. The reference is dem here, whose steps are a tenth of a millisecond.
LARGE = {"full": (2000,), "long": (2000, 10000)}
LARGE_STARTS = 2

DT_S, FRACTION = "step.dt_s", "method.step_fraction"
LARGE_REFERENCE_FRACTIONS = (0.6, 0.3)
# What friction holds in a settled slope depends on how it has settled; motions are compared from the same equilibrium.
SAME_START: Settings = (("run.settled_by", "soft"),)
# Adaptive steps are as long as their tolerance lets them be, and end together with dt_s only: the shorter that is, the more of them are cut there.
# Forces need not balance to more digits than the tolerance leaves: with 1e-12 the times differ by 1e-6 of them, at 2,000 blocks by 1e-4.
# Settling is then to ask for no more, over the weight of a block, which is a thousandth of the largest force.
USUAL: Settings = ((DT_S, 0.01),)
ADAPTIVE_USUAL: Settings = ((DT_S, 0.05), ("solver.residual_tolerance", 1e-8), ("settle.unbalanced_fraction", 1e-5))


@dataclass(frozen=True)
class Follower:
    method: Method
    values: tuple[float, ...]  # of what refines its steps, those of quick runs first
    key: str = DT_S            # or the part of dem's critical step, or the tolerance of adaptive ones


STEPS_S = (0.02, 0.01, 0.05, 0.03, 0.005, 0.003)
TOLERANCES_M = (1e-4, 3e-5, 1e-3, 1e-5)
FRACTIONS = (0.9, 0.45, 0.225)
FOLLOWERS = (
    *(Follower(method, STEPS_S) for method in (SOFT_SHI, SOFT_PATH_AVERAGE, HARD)),
    *(Follower(method, (0.01, 0.005, 0.02)) for method in AHEAD),
    *(Follower(method, (0.01, 0.005, 0.02)) for method in AHEAD_WIDE),
    *(Follower(method, TOLERANCES_M, "step.error_tolerance_m") for method in ADAPTIVE),
    Follower(ADAPTIVE_AHEAD_WIDE, (1e-4, 3e-4, 3e-5), "step.error_tolerance_m"),
    Follower(SHI, (0.005, 0.01, 0.002)),
    *(Follower(method, FRACTIONS, FRACTION) for method in (DEM, DEM_WIDE)),
)
QUICK_FOLLOWER_STEPS = 2
LARGE_FOLLOWERS: dict[int, tuple[Follower, ...]] = {2000: (
    Follower(SOFT_SHI, (0.02, 0.01, 0.003)),
    *(Follower(method, (0.01,)) for method in (*AHEAD, *AHEAD_WIDE)),
    Follower(ADAPTIVE_AHEAD_WIDE, (1e-3, 1e-4, 3e-5), "step.error_tolerance_m"),
    *(Follower(method, (0.02,)) for method in (SOFT_PATH_AVERAGE, HARD)),
    Follower(ADAPTIVE[0], (1e-3, 3e-4), "step.error_tolerance_m"),
    *(Follower(method, (0.01,)) for method in LONG),
    *(Follower(method, (0.9,), FRACTION) for method in (DEM, DEM_WIDE, DEM_COARSE_REST)),
), 10000: (  # what has been found to be quick with fewer blocks: all of it is to end within half an hour
    *(Follower(method, (0.01,)) for method in (*AHEAD_WIDE, *LONG)),
    *(Follower(method, (0.9,), FRACTION) for method in (DEM, DEM_WIDE, DEM_COARSE_REST)),
)}


@dataclass(frozen=True)
class Arrival:
    """At the distances: mean over the starts, and the spread between them."""

    times: tuple[float, ...]
    spread: float  # [-] largest of the distances: half of what lies between the starts, over the mean


def _case(method: Method, key: str, value: float, start: int = 0, name: str = "", more: Settings = ()) -> Case:
    usual = ADAPTIVE_USUAL if method.adaptive else USUAL
    strength = ("run.strength_reduction_factor", FACTOR * (1 + PERTURBATION * start))
    settings = [*method.settings, *(SAME_START if method.explicit else ()), *usual, (key, value), strength,
                ("output.every_s", 1.0), ("output.milestones_m", list(DISTANCES_M)), *more]
    return Case(f"failure-{method.name}-{value:g}-{start}{name}".replace(" ", "_"), "run", JointedSlope.POST_FAILURE, tuple(settings), LIMIT_S)


def _arrival(bench: Bench, cases: list[Case]) -> Arrival | None:
    """Of runs that are made; none if one did not get there."""
    of_starts = []
    for case in cases:
        rows = bench.openclose.table(case, "milestones.csv")
        if not rows or any(row["reason"] for row in rows):
            return None
        of_starts.append([float(row["time_s"]) for row in rows])
    by_distance = list(zip(*of_starts))
    means = tuple(statistics.fmean(times) for times in by_distance)
    return Arrival(means, max((max(t) - min(t)) / 2 / m for t, m in zip(by_distance, means)))


def _distance(a: Arrival, b: Arrival) -> float:
    return max(abs(x / y - 1) for x, y in zip(a.times, b.times))


@dataclass
class Findings:
    """`converged` is what the two references differ by; `arrivals` are those of the runs that are judged, by method and step. `large_converged`, by
    numbers of blocks, is what is not known of their references, of those that got to 40 m."""

    reference: Arrival
    converged: float
    arrivals: dict[tuple[str, float], Arrival]
    large_converged: dict[int, float]


def run(bench: Bench) -> Findings | None:
    starts = range(QUICK_STARTS if bench.quick else STARTS)
    references = []
    for dt in QUICK_REFERENCE_STEPS_S if bench.quick else REFERENCE_STEPS_S:
        cases = [_case(REFERENCE, DT_S, dt, k) for k in starts]
        for case in cases:
            bench.run(case)
        references.append((dt, _arrival(bench, cases)))
    (_, coarse), (finest, fine) = references
    if coarse is None or fine is None:
        bench.leave_out(STUDY, SCENE, "all", "the reference did not get to 40 m")
        return None
    findings = Findings(fine, _distance(coarse, fine), {}, {})

    def trial(follower: Follower, value: float, scene: str = SCENE, name: str = "", more: Settings = ()) -> Trial:
        cases = [_case(follower.method, follower.key, value, k, name, more) for k in starts]

        def error(_: Case) -> float | None:
            arrival = _arrival(bench, cases)
            if arrival is None:
                return None
            if scene == SCENE:
                findings.arrivals[follower.method.name, value] = arrival
            return _distance(arrival, fine)

        return Trial(STUDY, scene, follower.method.name, cases[0], "motion",
                     f"time at which the toe block has moved 10, 20, 30, 40 m, mean of {len(starts)} starts, largest of the four against "
                     f"{REFERENCE.name} with {1e3 * finest:g} ms", error, value if follower.key == DT_S else None, tuple(cases))

    judged = [(f, value) for f in FOLLOWERS for value in (f.values[:QUICK_FOLLOWER_STEPS] if bench.quick else f.values)]
    bench.measure([trial(*run) for run in judged] + [trial(*run, RESTING_SCENE, "-resting", RESTING) for run in judged])
    for blocks in LARGE.get(bench.mode, ()):
        converged = _large(bench, blocks)
        if converged is not None:
            findings.large_converged[blocks] = converged
    return findings


def large_scene(blocks: int) -> str:
    return f"{RESTING_SCENE}, {blocks:,} blocks"


def _large(bench: Bench, blocks: int) -> float | None:
    """What is not known of the reference: the difference of the two, or half of what the starts differ by if that is more."""
    name, more, starts = f"-of-{blocks}", spacings(blocks), range(LARGE_STARTS)
    references = []
    for fraction in LARGE_REFERENCE_FRACTIONS:
        cases = [_case(DEM, FRACTION, fraction, k, name, more) for k in starts]
        for case in cases:
            bench.run(case)
        arrival = _arrival(bench, cases)
        if arrival is None:
            bench.leave_out(STUDY, large_scene(blocks), "all", f"the reference did not get to 40 m: {bench.openclose.summary(cases[0])['reason']}")
            return None
        references.append(arrival)
    coarse, fine = references

    def error_against(cases: list[Case]) -> Callable[[Case], float | None]:
        def of(_: Case) -> float | None:
            arrival = _arrival(bench, cases)
            return None if arrival is None else _distance(arrival, fine)

        return of

    what = (f"time at which the toe block has moved 10, 20, 30, 40 m, mean of {LARGE_STARTS} starts, largest of the four against dem with "
            f"{LARGE_REFERENCE_FRACTIONS[-1]:g} of the critical step, no block left alone")
    trials = []
    for follower in LARGE_FOLLOWERS[blocks]:
        for value in follower.values:
            cases = [_case(follower.method, follower.key, value, k, name, (*more, *RESTING)) for k in starts]
            trials.append(Trial(STUDY, large_scene(blocks), follower.method.name, cases[0], "motion", what, error_against(cases),
                                value if follower.key == DT_S else None, tuple(cases)))
    bench.measure(trials)
    return max(_distance(coarse, fine), fine.spread)
