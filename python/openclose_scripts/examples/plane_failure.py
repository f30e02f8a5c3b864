"""Example 3.2, plane failure: which runs are made and what is read from them. SI units; angles in degrees where the name says so."""

import math
import tomllib
from dataclasses import dataclass

from openclose_scripts import PAPER_SCENES
from openclose_scripts.examples.jointed_rock import JointedRock
from openclose_scripts.runs import Case, Openclose, Reference, outlines

SCENE = PAPER_SCENES / "example_3_2.toml"
METHODS = ("soft", "hard", "shi")
BRITTLE = ("lost_on_opening", "lost_on_slip")


@dataclass(frozen=True)
class Inputs(JointedRock):
    """What the scene file says, height and angles measured on its polygons."""

    height: float
    face_angle_deg: float
    joint_angle_deg: float
    curve: tuple[float, ...]
    curve_time: float
    width: float
    unbalanced_fraction: float
    failure_displacement: float


def read_inputs() -> Inputs:
    scene = tomllib.loads(SCENE.read_text(encoding="utf-8"))
    toe, back, crest = next(b["vertices_m"] for b in scene["block"] if b["name"] == "wedge")
    settle, reduction = scene["settle"], scene["strength_reduction"]

    def dip(point: list[float]) -> float:
        return math.degrees(math.atan2(point[1] - toe[1], point[0] - toe[0]))

    return Inputs(
        **vars(JointedRock.of(scene)),
        height=crest[1] - toe[1],
        face_angle_deg=dip(crest),
        joint_angle_deg=dip(back),
        curve=tuple(reduction["curve"]),
        curve_time=reduction["curve_time_s"],
        width=reduction["width"],
        unbalanced_fraction=settle["unbalanced_fraction"],
        failure_displacement=settle["failure_displacement_m"],
    )


@dataclass(frozen=True)
class Trial:
    """One strength reduction factor tried."""

    srf: float
    stage: str
    stable: bool
    displacement: float


@dataclass(frozen=True)
class Point:
    """The measured point after the time of Fig. 6."""

    srf: float
    displacement: float
    speed: float | None = None


class PlaneFailure:
    """All runs of example 3.2 with the closed form beside them."""

    def __init__(self, openclose: Openclose, reference: Reference):
        self.inputs = read_inputs()
        self._openclose = openclose
        self._wedge = self._closed_form(reference)

    def cases(self) -> list[Case]:
        return [*map(self._fos, METHODS), *map(self._brittle, BRITTLE), *map(self._unsettled, self.inputs.curve)]

    @property
    def closed_form(self) -> float:
        """[-] factor of safety"""
        return self._wedge["factor_of_safety"]

    def factor_of_safety(self, method: str) -> float:
        return self._openclose.summary(self._fos(method))["factor_of_safety"]

    def bracket(self, method: str) -> tuple[float, float]:
        """[-] the largest factor found stable and the smallest found failing"""
        bracket = self._openclose.summary(self._fos(method))["bracket"]
        return bracket["stable"], bracket["failed"]

    def brittle_factor_of_safety(self, behaviour: str) -> float:
        """With `soft` and a cohesion that is lost."""
        return self._openclose.summary(self._brittle(behaviour))["factor_of_safety"]

    def trials(self, method: str) -> list[Trial]:
        rows = self._openclose.table(self._fos(method), "trials.csv")
        return [Trial(float(r["srf"]), r["stage"], r["stable"] == "1", float(r["displacement_m"])) for r in rows]

    def brackets(self, method: str) -> list[tuple[float, float]]:
        """[-] stable and failed end after every trial that has both."""
        stable, failed, ends = 0.0, math.inf, []
        for trial in self.trials(method):
            if trial.stage == "curve":
                continue
            if trial.stable:
                stable = max(stable, trial.srf)
            else:
                failed = min(failed, trial.srf)
            if stable > 0 and failed < math.inf:
                ends.append((stable, failed))
        return ends

    def settled_curve(self) -> list[Trial]:
        """Displacement at rest (or when failure was found) of `soft`."""
        return [t for t in self.trials("soft") if t.stage == "curve"]

    def moving_curve(self) -> list[Point]:
        """Displacement after the steps of Fig. 6 with `soft`, strength reduced in the settled state."""
        return [Point(float(r["srf"]), float(r["displacement_m"])) for r in self._openclose.table(self._fos("soft"), "curve.csv")]

    def unsettled_curve(self) -> list[Point]:
        """The same with gravity dropped on unloaded springs and the strength reduced from the start."""
        points = []
        for srf in self.inputs.curve:
            last = self._openclose.table(self._unsettled(srf), "history.csv")[-1]
            displacement = math.hypot(float(last["displacement_x_m"]), float(last["displacement_y_m"]))
            speed = math.hypot(float(last["velocity_x_m_per_s"]), float(last["velocity_y_m_per_s"]))
            points.append(Point(srf, displacement, speed))
        return points

    def blocks(self, state: str) -> dict[str, list[tuple[float, float]]]:
        return outlines(self._openclose.table(self._fos("soft"), "blocks.csv"), state)

    def _closed_form(self, reference: Reference) -> dict[str, float]:
        i = self.inputs
        options = {"height": i.height, "face-deg": i.face_angle_deg, "plane-deg": i.joint_angle_deg, "cohesion": i.cohesion,
                   "phi-deg": i.friction_angle_deg, "unit-weight": i.unit_weight}
        return {row["quantity"]: float(row["value"]) for row in reference.table("wedge", options)}

    def _fos(self, method: str) -> Case:
        return Case(f"3.2-{method}", "fos", SCENE, (("method.contact", method),))

    def _brittle(self, behaviour: str) -> Case:
        return Case(f"3.2-soft-{behaviour}", "fos", SCENE, (("method.contact", "soft"), ("joint[0].cohesion_behaviour", behaviour)))

    def _unsettled(self, srf: float) -> Case:
        friction_deg = math.degrees(math.atan(math.tan(math.radians(self.inputs.friction_angle_deg)) / srf))
        settings = (
            ("method.contact", "soft"),
            ("method.start", "unloaded"),
            ("joint[0].friction_angle_deg", friction_deg),
            ("joint[0].cohesion_pa", self.inputs.cohesion / srf),
            ("end.time_s", self.inputs.curve_time),
            ("output.every_s", self.inputs.curve_time),
        )
        return Case(f"3.2-soft-unloaded-srf{srf:g}", "run", SCENE, settings)
