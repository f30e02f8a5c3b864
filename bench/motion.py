"""Work against precision for single blocks in motion, where closed forms and reference ODEs say what is right. SI units."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from measure import CPU_LIMIT_S, Bench, Trial
from methods import ADAPTIVE, DEM, HARD, INTEGRATORS, Method, Settings, on_joint_springs
from openclose_scripts.examples import incline
from openclose_scripts.runs import Case, Reference

STUDY = "motion"
_SCENES = Path(__file__).parent / "scenes"
STEPS = 7  # halvings and the longest step
TOLERANCES_M = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)  # of the adaptive steps
SLOPE_DEG = 20.0  # of the shaken incline

Path_ = dict[float, float]  # by time


@dataclass(frozen=True)
class Scene:
    """`place` reads the quantity that is compared off a row of the history; `elastic` and `rigid` are its references, by time, for contacts that
    give and for hard ones. Errors are the largest distance over all times after `from_time`, over `scale`."""

    name: str
    file: Path
    rigid_file: Path
    settings: Settings
    longest_step: float
    every: float
    stiffness: float  # [Pa/m]
    place: Callable[[dict], float]
    elastic: Callable[[], Path_]
    rigid: Callable[[], Path_] | None
    scale: float
    error_of: str
    no_rigid: str = ""


def _along(angle_deg: float) -> Callable[[dict], float]:
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return lambda row: cosine * float(row["displacement_x_m"]) - sine * float(row["displacement_y_m"])


def _key(time: float) -> float:
    return round(time, 7)


def scenes(reference: Reference) -> list[Scene]:
    inputs = incline.read_inputs()
    sliding_every, bounce_every, rocking_every, shaken_every = 0.5, 0.1, 0.01, 0.125

    def table(command: str, options: dict, column: str, offset: float = 0.0) -> Path_:
        return {_key(float(row["time_s"])): float(row[column]) + offset for row in reference.table(command, options)}

    slide = {"phi-deg": incline.MAIN_ANGLE_DEG, "alpha-deg": inputs.slope_angle_deg, "start": "normal_balanced", "density": inputs.density,
             "stiffness": inputs.normal_stiffness, "width": inputs.length, "height": inputs.height, "gravity": inputs.gravity,
             "end": inputs.end_time, "every": sliding_every}
    way = max(table("incline", slide, "rigid_displacement_m").values())
    bounce = {"end": 2.0, "every": bounce_every}
    rocking, lean = {"end": 0.35, "every": rocking_every}, math.radians(0.5)
    shaken = {"end": 1.0, "every": shaken_every}
    slip = max(table("shaken-incline", shaken, "rigid_displacement_m").values())
    return [
        Scene("3.1 in motion", incline.SCENE, incline.SCENE,
              (("method.start", "normal_balanced"), ("joint[0].friction_angle_deg", incline.MAIN_ANGLE_DEG), ("step.max_displacement_m", 1.0)),
              0.02, sliding_every, inputs.normal_stiffness, _along(inputs.slope_angle_deg),
              lambda: table("incline", slide, "displacement_m"), lambda: table("incline", slide, "rigid_displacement_m"), way,
              "place along the slope, largest in 3 s, over the way; of hard against rigid contact"),
        Scene("D2 bounce", _SCENES / "bounce.toml", _SCENES / "bounce.toml", (), 8e-3, bounce_every, 50e6,
              lambda row: float(row["displacement_y_m"]), lambda: table("bounce", bounce, "height_m", -1.0), None, 1.0,
              "height, largest in 2 s, over the fall", "rigid contacts do not rebound"),
        Scene("D5 rocking", _SCENES / "rocking.toml", _SCENES / "rocking_rigid.toml", (), 5e-3, rocking_every, 200e6,
              lambda row: float(row["rotation_rad"]), lambda: table("rocking", rocking, "rotation_rad", -lean),
              lambda: table("rocking", rocking, "rigid_rotation_rad", -lean), lean,
              "angle, largest in 0.35 s, over that of the release; of hard against Housner's block"),
        Scene("C2 harmonic incline", _SCENES / "shaken_incline.toml", _SCENES / "shaken_incline.toml", (), 1.25e-2, shaken_every, 50e6,
              _along(SLOPE_DEG), lambda: table("shaken-incline", shaken, "displacement_m"),
              lambda: table("shaken-incline", shaken, "rigid_displacement_m"), slip,
              "place along the slope, largest in 1 s, over the slip; of hard against Newmark's block"),
    ]


def _error(bench: Bench, scene: Scene, exact: Path_) -> Callable[[Case], float | None]:
    def largest(case: Case) -> float | None:
        rows = bench.openclose.table(case, "history.csv")
        places = {_key(float(row["time_s"])): scene.place(row) for row in rows}
        if not set(exact) <= set(places):
            return None
        return max(abs(places[t] - exact[t]) for t in exact) / scene.scale

    return largest


def _trial(bench: Bench, scene: Scene, method: Method, exact: Path_, dt: float, tolerance: float | None) -> Trial:
    settings = [*method.settings, *scene.settings, ("step.dt_s", dt), ("output.every_s", scene.every)]
    name = f"{scene.name}-{method.name}-{dt if tolerance is None else tolerance:g}"
    if tolerance is not None:
        settings.append(("step.error_tolerance_m", tolerance))
    file = scene.rigid_file if method.rigid else scene.file
    case = Case(f"motion-{name}".replace(" ", "_").replace("/", "_"), "run", file, tuple(settings), CPU_LIMIT_S)
    return Trial(STUDY, scene.name, method.name, case, "motion", scene.error_of, _error(bench, scene, exact), None if method.adaptive else dt)


def run(bench: Bench, reference: Reference) -> None:
    for scene in scenes(reference):
        elastic, rigid = scene.elastic(), scene.rigid() if scene.rigid else None
        trials = []
        for method in (*INTEGRATORS, HARD, on_joint_springs(scene.stiffness), DEM):
            exact = rigid if method.rigid else elastic
            if exact is None:
                bench.leave_out(STUDY, scene.name, method.name, scene.no_rigid)
                continue
            trials += [_trial(bench, scene, method, exact, scene.longest_step / 2**k, None) for k in range(STEPS)]
        trials += [_trial(bench, scene, method, elastic, scene.every, tolerance) for method in ADAPTIVE for tolerance in TOLERANCES_M]
        bench.measure(trials)
