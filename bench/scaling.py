"""Cost and memory against the number of blocks: example 3.4 with closer joints. SI units."""

from dataclasses import dataclass

from measure import Bench, Row, Trial
from methods import DEM, HARD, SHI, SOFT, Method, Settings
from openclose_scripts.examples.slopes import FACE_SPACING_M, HORIZONTAL_SPACING_M, JointedSlope
from openclose_scripts.fits import exponent
from openclose_scripts.runs import Case
from statics import settling

SETTLING, MOTION = "settling by size", "motion by size"
# Blocks to be had from these factors on both joint spacings: 4 times as many for half.
SPACING_FACTORS = {100: 2.5, 500: 0.98, 1000: 0.676, 2000: 0.48, 5000: 0.298, 10000: 0.206, 20000: 0.146, 50000: 0.0918, 100000: 0.0648}
QUICK_SIZES = (100, 500, 2000, 5000)
LARGEST = {"soft": 100000, "hard": 10000, "shi": 1000, "dem": 10000}
LIMIT_S = 300
# Joints of the same stiffness per area make softer rock where they are closer: 50,000 blocks settle by 0.115 m, 100,000 by 0.164 m. They do so all
# together, which is no reason to cut a step; where steps may be longer than that, contacts are kept over gaps wider than the blocks.
LARGEST_STEP: Settings = (("step.max_displacement_m", 0.2),)
DT_S, STEPS = 0.01, 20
FRACTION = 1e-8
FIT_RANGE = (500, 50000)


def spacings(blocks: int) -> Settings:
    factor = SPACING_FACTORS[blocks]
    return (("joint_set[0].spacing_m", HORIZONTAL_SPACING_M * factor), ("joint_set[1].spacing_m", FACE_SPACING_M * factor))


def _settle(method: Method, blocks: int) -> Case:
    settings = (*spacings(blocks), *LARGEST_STEP, ("output.milestones_m", []))
    return settling(f"3.4-of-{blocks}", method, FRACTION, settings, JointedSlope.POST_FAILURE, LIMIT_S)


def _move(method: Method, blocks: int) -> Case:
    settings = (*method.settings, *spacings(blocks), *LARGEST_STEP, ("step.dt_s", DT_S), ("end.time_s", DT_S * STEPS),
                ("output.every_s", DT_S * STEPS), ("output.milestones_m", []))
    return Case(f"move-3.4-of-{blocks}-{method.name}", "run", JointedSlope.POST_FAILURE, settings, LIMIT_S)


def run(bench: Bench) -> None:
    """From the small ones up; a method that fails at one size is not tried at the next."""
    stopped: set[str] = set()
    for blocks in QUICK_SIZES if bench.quick else SPACING_FACTORS:
        methods = [m for m in (SOFT, HARD, SHI, DEM) if blocks <= LARGEST[m.name] and m.name not in stopped]
        name = f"3.4 of {blocks}"
        settled = bench.measure([Trial(SETTLING, name, m.name, _settle(m, blocks), "start", "", lambda _: None) for m in methods])
        stopped |= {row.method for row in settled if row.reason}
        before = {row.method: row for row in settled if not row.reason}
        # The one step that follows settling there is one of the steps here.
        bench.measure([Trial(MOTION, name, m.name, _move(m, blocks), "motion", "", lambda _: None, DT_S,
                             steps_before=before[m.name].steps - 1, iterations_before=before[m.name].iterations)
                       for m in methods if m.name in before])


@dataclass(frozen=True)
class Fit:
    method: str
    what: str
    value: float | None
    sizes: int


def fits(bench: Bench) -> list[Fit]:
    """Exponents of the power laws through the sizes of FIT_RANGE."""
    def fit(study: str, method: str, what: str, of) -> Fit:
        rows = [r for r in bench.of(study) if r.method == method and not r.reason and FIT_RANGE[0] * 0.9 <= r.blocks <= FIT_RANGE[1] * 1.1 and of(r)]
        value = exponent([float(r.blocks) for r in rows], [of(r) for r in rows]) if len(rows) > 2 else None
        return Fit(method, what, value, len(rows))

    def per_step(row: Row) -> float:
        return row.cpu_s / row.steps

    def per_iteration(row: Row) -> float:
        return row.cpu_s / row.iterations if row.iterations else 0.0

    def relaxation_steps(row: Row) -> int:
        return _settled(bench, row).get("counters", {}).get("relaxation_steps", 0)

    def per_newton_iteration(row: Row) -> float:
        return 0.0 if relaxation_steps(row) else per_iteration(row)

    def per_relaxation_step(row: Row) -> float:
        return row.cpu_s / relaxation_steps(row) if relaxation_steps(row) else 0.0

    found = []
    for method in LARGEST:
        found += [fit(SETTLING, method, "settling", lambda r: r.cpu_s), fit(MOTION, method, "a step of motion", per_step)]
        if method != "dem":
            found += [fit(SETTLING, method, "an iteration of settling", per_newton_iteration),
                      fit(MOTION, method, "an iteration of motion", per_iteration)]
        if method == "soft":
            found.append(fit(SETTLING, method, "a step of relaxation", per_relaxation_step))
        found.append(fit(SETTLING, method, "memory", lambda r: r.peak_memory_bytes))
    return found


def _settled(bench: Bench, row: Row) -> dict:
    """The summary of the settling of a size."""
    method = next(m for m in (SOFT, HARD, SHI, DEM) if m.name == row.method)
    return bench.summaries(_settle(method, int(row.scene.rsplit(" ", 1)[1])))[0]


def memory_without_factor(bench: Bench, row: Row) -> int | None:
    """Of the settling of a size [bytes]: program, blocks, contacts and matrix, each as large as it has been."""
    return _settled(bench, row).get("memory_bytes", {}).get("without_factor")


def krylov_iterations(bench: Bench, row: Row) -> int | None:
    """Of the settling of a size."""
    return _settled(bench, row).get("counters", {}).get("krylov_iterations")
