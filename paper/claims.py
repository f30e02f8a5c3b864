"""The paper's claims on cost and accuracy: which runs test them and what is read from those. SI units."""

import math
import tomllib
from dataclasses import dataclass

from openclose_scripts import PAPER_SCENES
from openclose_scripts.examples import incline
from openclose_scripts.examples.incline import Incline
from openclose_scripts.examples.slopes import FACE_SPACING_M, HORIZONTAL_SPACING_M
from openclose_scripts.runs import Case, Openclose, outlines

SLOPE = PAPER_SCENES / "example_3_4.toml"
WEDGE = PAPER_SCENES / "example_3_2.toml"
EXPLICIT_SCENES = ("example_3_3_shifted", "example_3_3_toe", "example_3_3_wedge", "example_3_4")
METHODS = ("soft", "hard", "shi")

# Example 3.4 with its joints (40 m and 10 m) closer or wider by a factor; gravity drops on unloaded springs, where most contacts change.
FACTORS = (3.0, 2.1, 1.4, 1.0, 0.7, 0.46)
HARD_FACTORS = (3.0, 2.1, 1.4, 1.0)
HARD_LIMIT_S = 4
COARSE_FACTOR = 2.0
DT_S = 1e-3
SIZE_END_S = 0.004
COARSE_END_S = 0.01
INCLINE_END_S = 0.5

PENETRATION_TOLERANCES_M = (1e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 1e-3, 1e-2)
CLOSING_TOLERANCES_M = (0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
NO_TOLERANCE_M = 10.0  # deeper than any contact of these runs
SLOPE_PENALTIES = tuple(10.0**k for k in range(9, 17))  # [Pa/m]
INCLINE_PENALTIES = tuple(10.0**k for k in range(5, 17))
UDEC_FRACTION = 0.1  # UDEC's default factor on its critical step


@dataclass(frozen=True)
class Cost:
    """What a run of example 3.4 took."""

    blocks: int
    free: int
    solves: float         # linear solves a step of DT_S in the time reached, thrown-away attempts included
    cuts: float           # attempts thrown away, likewise
    cpu: float            # [s] likewise
    reached: float        # part of the time that was reached
    penetration: float    # [m]
    reason: str

    @property
    def finished(self) -> bool:
        return not self.reason


@dataclass(frozen=True)
class Sliding:
    """Example 3.1 after INCLINE_END_S from unloaded springs."""

    finished: bool
    displacement_error: float  # [-] against eq. (8)
    force_error: float         # [-] of the normal forces' sum against the weight's part
    solves: float              # a step


@dataclass(frozen=True)
class Spectrum:
    highest: float        # [rad/s]
    critical_step: float  # [s]
    condition: float      # [-] all contacts stick
    detached: float       # [-] one unknown has lost all its contacts: nothing but its inertia is left


@dataclass(frozen=True)
class Explicit:
    """Time step of the explicit method in one scene."""

    scene: str
    exact: float           # [s] 2/w_max
    bound: float           # [s] what `dem` takes for it
    smallest_area: float   # [m2] of the free blocks
    two_body: float        # [s] 2 sqrt(m/(2 kn 1 m2)) of the smallest free block


def _area(vertices: list[tuple[float, float]]) -> float:
    return 0.5 * sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(vertices, vertices[1:] + vertices[:1]))


def _common(end: float) -> list[tuple[str, object]]:
    return [("method.start", "unloaded"), ("step.dt_s", DT_S), ("end.time_s", end)]


def _spacings(factor: float) -> list[tuple[str, object]]:
    return [("joint_set[0].spacing_m", HORIZONTAL_SPACING_M * factor), ("joint_set[1].spacing_m", FACE_SPACING_M * factor)]


def _slope(method: str, factor: float, end: float, name: str = "", more: tuple = (), limit: int | None = None) -> Case:
    settings = [("method.contact", method), *_common(end), *_spacings(factor), ("output.every_s", end), *more]
    return Case(f"claims-3.4-{method}-x{factor:g}{name}", "run", SLOPE, tuple(settings), limit)


def _tolerant(key: str, value: float) -> tuple:
    """Other tolerances do not act where one is studied."""
    return (("solver.penetration_tolerance_m", NO_TOLERANCE_M), (key, value))


def _slide(method: str, name: str = "", more: tuple = (), limit: int | None = None) -> Case:
    settings = [("method.contact", method), *_common(INCLINE_END_S), *more]
    return Case(f"claims-3.1-{method}{name}", "run", incline.SCENE, tuple(settings), limit)


def _wedge(method: str) -> Case:
    return Case(f"claims-3.2-{method}", "run", WEDGE, (("method.contact", method), *_common(INCLINE_END_S)))


MAY_FAIL_S = 20  # [s] of CPU time, far above what these runs take
_PENETRATION, _CLOSING, _PENALTY = "solver.penetration_tolerance_m", "solver.closing_tolerance_m", "method.penalty_pa_per_m"


class Claims:
    def __init__(self, openclose: Openclose, slider: Incline):
        self.slider = slider
        self._openclose = openclose

    def cases(self) -> list[Case]:
        """The long ones first."""
        sizes = [self._size(m, f) for f in reversed(FACTORS) for m in ("shi", "soft")] + [self._size("hard", f) for f in reversed(HARD_FACTORS)]
        tolerances = [c(v) for v in PENETRATION_TOLERANCES_M for c in (self._slope_penetration, self._incline_penetration)]
        tolerances += [c(v) for v in CLOSING_TOLERANCES_M for c in (self._slope_closing, self._incline_closing)]
        penalties = [c(p) for p in reversed(SLOPE_PENALTIES) for c in (self._slope_penalty, self._penalty_spectrum)]
        penalties += [self._incline_penalty(p) for p in INCLINE_PENALTIES]
        small = [c(m) for m in METHODS for c in (_slide, _wedge)]
        explicit = [c(s) for s in EXPLICIT_SCENES for c in (self._explicit_spectrum, self._explicit_run)]
        return [*sizes, *penalties, *tolerances, *small, *explicit]

    def size(self, method: str, factor: float) -> Cost:
        return self._cost(self._size(method, factor), SIZE_END_S)

    def sizes(self, method: str) -> list[Cost]:
        return [self.size(method, f) for f in (HARD_FACTORS if method == "hard" else FACTORS)]

    def slope_penetration(self, value: float) -> Cost:
        return self._cost(self._slope_penetration(value), COARSE_END_S)

    def slope_closing(self, value: float) -> Cost:
        return self._cost(self._slope_closing(value), COARSE_END_S)

    def slope_penalty(self, value: float) -> Cost:
        return self._cost(self._slope_penalty(value), COARSE_END_S)

    def incline_penetration(self, value: float) -> Sliding:
        return self._sliding(self._incline_penetration(value))

    def incline_closing(self, value: float) -> Sliding:
        return self._sliding(self._incline_closing(value))

    def incline_penalty(self, value: float) -> Sliding:
        return self._sliding(self._incline_penalty(value))

    def spectrum(self, penalty: float) -> Spectrum:
        return self._read_spectrum(self._penalty_spectrum(penalty))

    def solves(self, method: str) -> dict[str, float]:
        """Linear solves a step asked for, by example; only of runs that finished."""
        found = {"3.1": self._per_step(_slide(method), INCLINE_END_S), "3.2": self._per_step(_wedge(method), INCLINE_END_S)}
        for factor in HARD_FACTORS:
            cost = self.size(method, factor)
            if cost.finished:
                found[f"3.4, {cost.blocks} blocks"] = cost.solves
        return found

    def explicit(self, scene: str) -> Explicit:
        run = self._explicit_run(scene)
        free = {row["point"] for row in self._openclose.table(run, "history.csv")}
        initial = outlines(self._openclose.table(run, "blocks.csv"), "initial")
        area = min(_area(vertices) for name, vertices in initial.items() if name in free)
        inputs = _slope_inputs(scene)
        return Explicit(
            scene=scene,
            exact=self._read_spectrum(self._explicit_spectrum(scene)).critical_step,
            bound=self._openclose.summary(run)["explicit"]["critical_step_s"],
            smallest_area=area,
            two_body=2 * math.sqrt(area * inputs["density"] / (2 * inputs["stiffness"])),
        )

    def incline_errors(self, method: str, start: str) -> list[float]:
        """[%] beyond eq. (8) at the end of Fig. 4, by friction angle."""
        end = self.slider.inputs.end_time
        return [100 * (self.slider.from_start(method, start, a)[end] / self.slider.closed_form(a)[end] - 1) for a in incline.ANGLES_DEG]

    def _size(self, method: str, factor: float) -> Case:
        return _slope(method, factor, SIZE_END_S, limit=HARD_LIMIT_S if method == "hard" else None)

    def _slope_penetration(self, value: float) -> Case:
        return _slope("shi", COARSE_FACTOR, COARSE_END_S, f"-penetration{value:g}", ((_PENETRATION, value),), MAY_FAIL_S)

    def _slope_closing(self, value: float) -> Case:
        return _slope("shi", COARSE_FACTOR, COARSE_END_S, f"-closing{value:g}", _tolerant(_CLOSING, value), MAY_FAIL_S)

    def _slope_penalty(self, value: float) -> Case:
        return _slope("shi", COARSE_FACTOR, COARSE_END_S, f"-penalty{value:g}", _tolerant(_PENALTY, value), MAY_FAIL_S)

    def _incline_penetration(self, value: float) -> Case:
        return _slide("shi", f"-penetration{value:g}", ((_PENETRATION, value),), MAY_FAIL_S)

    def _incline_closing(self, value: float) -> Case:
        return _slide("shi", f"-closing{value:g}", _tolerant(_CLOSING, value), MAY_FAIL_S)

    def _incline_penalty(self, value: float) -> Case:
        return _slide("shi", f"-penalty{value:g}", _tolerant(_PENALTY, value), MAY_FAIL_S)

    def _penalty_spectrum(self, value: float) -> Case:
        settings = (("method.contact", "shi"), ("step.dt_s", DT_S), *_spacings(COARSE_FACTOR), (_PENALTY, value))
        return Case(f"claims-spectrum-penalty{value:g}", "check", SLOPE, settings)

    def _explicit_spectrum(self, scene: str) -> Case:
        return Case(f"claims-spectrum-{scene}", "check", PAPER_SCENES / f"{scene}.toml", (("method.contact", "dem"), ("step.dt_s", DT_S)))

    def _explicit_run(self, scene: str) -> Case:
        return Case(f"claims-dem-{scene}", "run", PAPER_SCENES / f"{scene}.toml", (("method.contact", "dem"), *_common(2 * DT_S)))

    def _per_step(self, case: Case, end: float) -> float:
        return self._openclose.summary(case)["counters"]["iterations"] / (end / DT_S)

    def _cost(self, case: Case, end: float) -> Cost:
        s = self._openclose.summary(case)
        if s.get("stopped"):
            return Cost(0, 0, math.inf, math.inf, math.inf, 0.0, math.nan, s["reason"])
        steps = max(s["time_s"], DT_S * 1e-3) / DT_S
        counters = s["counters"]
        return Cost(s["blocks"], s["free_blocks"], counters["iterations"] / steps, counters["steps_cut"] / steps, s["cpu_s"]["motion"] / steps,
                    s["time_s"] / end, s["max_penetration_m"], s["reason"])

    def _sliding(self, case: Case) -> Sliding:
        summary, i = self._openclose.summary(case), self.slider.inputs
        last = self._openclose.table(case, "history.csv")[-1]
        cosine, sine = i.downhill
        moved = float(last["displacement_x_m"]) * cosine + float(last["displacement_y_m"]) * sine
        carried = sum(float(row["normal_force_n"]) for row in self._openclose.table(case, "contacts.csv") if row["state"] == "final")
        weight = i.density * i.gravity * i.length * i.height * math.cos(math.radians(i.slope_angle_deg))
        exact = self.slider.closed_form(incline.MAIN_ANGLE_DEG)[INCLINE_END_S]
        return Sliding(summary["converged"], moved / exact - 1, carried / weight - 1,
                       self._per_step(case, max(summary["time_s"], DT_S * 1e-3)))

    def _read_spectrum(self, case: Case) -> Spectrum:
        row = self._openclose.table(case, "spectrum.csv")[0]
        highest = float(row["highest_rad_per_s"])
        # Shi's scheme has the inertia 2 M/dt^2.
        return Spectrum(highest, float(row["critical_step_s"]), float(row["condition_number"]), 1 + (highest * DT_S) ** 2 / 2)


def _slope_inputs(scene: str) -> dict[str, float]:
    data = tomllib.loads((PAPER_SCENES / f"{scene}.toml").read_text(encoding="utf-8"))
    density = data["material"][0]["unit_weight_n_per_m3"] / math.hypot(*data["gravity_m_per_s2"])
    return {"density": density, "stiffness": data["joint"][0]["normal_stiffness_pa_per_m"]}
