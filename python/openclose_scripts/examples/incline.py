"""Example 3.1, the block on an incline: which runs are made and what is read from them. SI units; angles in degrees where the name says so."""

import math
import tomllib
from dataclasses import dataclass

from openclose_scripts import PAPER_SCENES
from openclose_scripts.runs import Case, Openclose, Reference, outlines

SCENE = PAPER_SCENES / "example_3_1.toml"

# The paper prints neither the five friction angles nor the times: these are ours.
ANGLES_DEG = (5, 10, 15, 20, 25)
MAIN_ANGLE_DEG = 20
TIMES_S = (0.5, 1.0, 2.0, 3.0)
EARLIEST_S = 0.5  # before it, the relative error of a displacement that starts from zero means little
OUTPUT_EVERY_S = 0.005  # a tenth of the period of the block's bounce on its springs

STARTS = {"unloaded": "(a)", "normal_balanced": "(b)", "steady_sliding": "(c)"}
METHODS = ("soft", "hard", "shi")
SHI_JOINT = "shi_joint_springs"
SHI_SOFT_SHEAR = "shi_quarter_shear"
STEADY_STEPS_S = (1e-2, 1e-3, 1e-4)
FIG4_STEP_S = 1e-4

REFINEMENT = 4
CONVERGENCE_STEPS_S = tuple(1e-3 / REFINEMENT**k for k in range(6))
CONVERGENCE_END_S = 0.5
CONVERGENCE_EVERY_S = 0.01
ROUNDING_FLOOR_M = 1e-9  # smaller distances from the ODE are half rounding and tell no order
STICKING_ANGLE_DEG = 25  # the block sticks in the first bounces of start (a)


@dataclass(frozen=True)
class Study:
    """Refinement of the step against the reference ODE."""

    method: str
    start: str
    angle_deg: int
    theta: float = 1.0


STUDIES = (
    Study("soft", "normal_balanced", MAIN_ANGLE_DEG),
    Study(SHI_JOINT, "normal_balanced", MAIN_ANGLE_DEG),
    Study("soft", "unloaded", MAIN_ANGLE_DEG),
    Study(SHI_JOINT, "unloaded", MAIN_ANGLE_DEG),
    Study("soft", "normal_balanced", MAIN_ANGLE_DEG, theta=0.5),
    Study("soft", "unloaded", MAIN_ANGLE_DEG, theta=0.5),
    Study("soft", "unloaded", STICKING_ANGLE_DEG),
    Study(SHI_JOINT, "unloaded", STICKING_ANGLE_DEG),
)


@dataclass(frozen=True)
class Inputs:
    """What the scene file says, lengths and angle measured on its polygons."""

    length: float
    height: float
    slope_angle_deg: float
    downhill: tuple[float, float]
    density: float
    gravity: float
    normal_stiffness: float
    shear_stiffness: float
    end_time: float


def read_inputs() -> Inputs:
    scene = tomllib.loads(SCENE.read_text(encoding="utf-8"))
    blocks = {block["name"]: block["vertices_m"] for block in scene["block"]}
    top, foot = blocks["incline"][0], blocks["incline"][-1]
    lower, lower_top, _, upper = blocks["slider"]
    run, rise = foot[0] - top[0], top[1] - foot[1]
    slope = math.hypot(run, rise)
    joint = scene["joint"][0]
    return Inputs(
        length=math.dist(lower, upper),
        height=math.dist(lower, lower_top),
        slope_angle_deg=math.degrees(math.atan2(rise, run)),
        downhill=(run / slope, -rise / slope),
        density=scene["material"][0]["density_kg_per_m3"],
        gravity=math.hypot(*scene["gravity_m_per_s2"]),
        normal_stiffness=joint["normal_stiffness_pa_per_m"],
        shear_stiffness=joint["shear_stiffness_pa_per_m"],
        end_time=scene["end"]["time_s"],
    )


def _method_settings(method: str, inputs: Inputs) -> list[tuple[str, object]]:
    if method in METHODS:
        return [("method.contact", method)]
    # The springs of the joint in place of shi's own penalty. They are softer and want room for the first bounce.
    ratio = inputs.shear_stiffness / inputs.normal_stiffness
    if method == SHI_SOFT_SHEAR:
        ratio /= 4
    return [
        ("method.contact", "shi"),
        ("method.penalty_pa_per_m", inputs.normal_stiffness),
        ("method.penalty_shear_ratio", ratio),
        ("solver.penetration_tolerance_m", 0.01),
    ]


def _case(inputs: Inputs, method: str, start: str, angle_deg: int, dt: float, *, theta=1.0, end=None, every=OUTPUT_EVERY_S) -> Case:
    end = inputs.end_time if end is None else end
    settings = _method_settings(method, inputs) + [
        ("method.start", start),
        ("joint[0].friction_angle_deg", angle_deg),
        ("method.theta", theta),
        ("step.dt_s", dt),
        ("end.time_s", end),
        ("output.every_s", every),
    ]
    name = f"3.1-{method}-{start}-phi{angle_deg}-dt{dt:.3g}-end{end:g}" + ("" if theta == 1.0 else f"-theta{theta:g}")
    return Case(name, "run", SCENE, tuple(settings))


def _key(time: float) -> float:
    """Times of different files as keys: they differ in the last digits."""
    return round(time, 7)


class Incline:
    """All runs of example 3.1 with the reference beside them. Displacements are along the slope, by time."""

    def __init__(self, openclose: Openclose, reference: Reference):
        self.inputs = read_inputs()
        self._openclose = openclose
        self._reference = reference
        self._references: dict[tuple, dict[float, tuple[float, float]]] = {}

    def cases(self) -> list[Case]:
        """Every run that the figures and tables ask for, each once, the long ones first."""
        steady = [self._steady(m, a, dt) for m in METHODS for a in ANGLES_DEG for dt in STEADY_STEPS_S]
        starts = [self._start(m, s, a) for m in (*METHODS, SHI_JOINT) for s in STARTS for a in ANGLES_DEG]
        refined = [self._refined(study, dt) for study in STUDIES for dt in reversed(CONVERGENCE_STEPS_S)]
        return list(dict.fromkeys([*refined, *starts, self._start(SHI_SOFT_SHEAR, "normal_balanced", MAIN_ANGLE_DEG), *steady]))

    def steady(self, method: str, angle_deg: int, dt: float) -> dict[float, float]:
        return self._displacement(self._steady(method, angle_deg, dt))

    def from_start(self, method: str, start: str, angle_deg: int) -> dict[float, float]:
        """At the step of Fig. 4."""
        return self._displacement(self._start(method, start, angle_deg))

    def ode(self, start: str, angle_deg: int, *, rotation_locked=False, end=None, every=OUTPUT_EVERY_S) -> dict[float, float]:
        """The event-resolved motion on two corner springs."""
        rows = self._reference_rows(start, angle_deg, rotation_locked, end or self.inputs.end_time, every)
        return {time: row[0] for time, row in rows.items()}

    def closed_form(self, angle_deg: int) -> dict[float, float]:
        """Eq. (8) of the paper."""
        rows = self._reference_rows("steady_sliding", angle_deg, False, self.inputs.end_time, OUTPUT_EVERY_S)
        return {time: row[1] for time, row in rows.items()}

    def largest_steady_error(self, method: str, angle_deg: int, dt: float) -> float:
        """Largest relative deviation from eq. (8) from EARLIEST_S on, starting from steady sliding."""
        exact = self.closed_form(angle_deg)
        ours = self.steady(method, angle_deg, dt)
        return max(abs(ours[t] / exact[t] - 1) for t in ours if t >= EARLIEST_S)

    def refinement_error(self, study: Study, dt: float) -> float:
        """Largest distance [m] from the reference ODE over the time of the study."""
        exact = self.ode(study.start, study.angle_deg, end=CONVERGENCE_END_S, every=CONVERGENCE_EVERY_S)
        ours = self._displacement(self._refined(study, dt))
        return max(abs(ours[t] - exact[t]) for t in ours)

    def observed_order(self, study: Study) -> float:
        """Order in dt between the two smallest steps whose errors are above rounding."""
        errors = [self.refinement_error(study, dt) for dt in CONVERGENCE_STEPS_S]
        coarse, fine = [e for e in errors if e > ROUNDING_FLOOR_M][-2:]
        return math.log(coarse / fine, REFINEMENT)

    def blocks(self) -> dict[str, list[tuple[float, float]]]:
        """Outlines at the beginning."""
        return outlines(self._openclose.table(self._drawn(), "blocks.csv"), "initial")

    def deepest_shi_penetration(self) -> float:
        """[m] with its own penalty, from the steady start."""
        return max(self._openclose.summary(self._steady("shi", a, dt))["max_penetration_m"] for a in ANGLES_DEG for dt in STEADY_STEPS_S)

    def _drawn(self) -> Case:
        return self._steady("soft", MAIN_ANGLE_DEG, STEADY_STEPS_S[0])

    def _steady(self, method: str, angle_deg: int, dt: float) -> Case:
        return _case(self.inputs, method, "steady_sliding", angle_deg, dt)

    def _start(self, method: str, start: str, angle_deg: int) -> Case:
        return _case(self.inputs, method, start, angle_deg, FIG4_STEP_S)

    def _refined(self, study: Study, dt: float) -> Case:
        return _case(self.inputs, study.method, study.start, study.angle_deg, dt, theta=study.theta, end=CONVERGENCE_END_S, every=CONVERGENCE_EVERY_S)

    def _displacement(self, case: Case) -> dict[float, float]:
        cosine, sine = self.inputs.downhill
        rows = self._openclose.table(case, "history.csv")
        return {_key(float(r["time_s"])): float(r["displacement_x_m"]) * cosine + float(r["displacement_y_m"]) * sine for r in rows}

    def _reference_rows(self, start: str, angle_deg: int, rotation_locked: bool, end: float, every: float) -> dict[float, tuple[float, float]]:
        asked = (start, angle_deg, rotation_locked, end, every)
        if asked not in self._references:
            i = self.inputs
            options = {"phi-deg": angle_deg, "alpha-deg": i.slope_angle_deg, "start": start, "density": i.density, "stiffness": i.normal_stiffness,
                       "width": i.length, "height": i.height, "gravity": i.gravity, "end": end, "every": every}
            rows = self._reference.table("incline", options, ("--rotation-locked",) if rotation_locked else ())
            self._references[asked] = {
                _key(float(r["time_s"])): (float(r["displacement_m"]), float(r["rigid_displacement_m"])) for r in rows}
        return self._references[asked]
