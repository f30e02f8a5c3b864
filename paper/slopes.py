"""Examples 3.3 and 3.4, slopes of many blocks: which runs are made and what is read from them. SI units; angles in degrees where the name says so."""

import math
import tomllib
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from runs import Case, Openclose, Reference, outlines

_SCENES = Path(__file__).parent / "scenes"
METHODS = ("soft", "hard", "dem", "shi")
BEHAVIOURS = ("ductile", "lost_on_opening", "lost_on_slip")
MODELS = ("wedge", "toe", "shifted")

# What a search and a run after failure may cost; one that is stopped stays in the tables with this reason.
FOS_CPU_LIMIT_S = {"soft": 15, "hard": 15, "dem": 15, "shi": 5}
POST_FAILURE_CPU_LIMIT_S = 150
# How far the toe block is followed; where that is less than in the scene, the whole way would cost more than all other runs together.
POST_FAILURE_END_M = {"soft": 40.0, "hard": 40.0, "dem": 40.0, "shi": 40.0}

# Shi's scheme takes the friction of the pass before, so it needs the paper's step; dem divides the step that is asked for into stable ones.
POST_FAILURE_STEP_S = {"soft": 0.01, "hard": 0.01, "dem": 0.01, "shi": 0.001}
STARTS = {"settled": "from the settled state", "unloaded": "cold: gravity dropped on unloaded springs"}
# Whose own rules for equilibrium the paper gives: DDA-SC's relative displacement and UDEC's unbalanced force.
PAPER_RULES = ("soft", "dem")
PAPER_RULES_WIDTH = 0.02
PAPER_RULES_UPPER_LIMIT = 3.0  # beyond it, their factor says nothing about the slope

MOVED_M = 0.1  # blocks that moved less take no part in the mechanism

# The tight search that shows what the short one costs in accuracy.
TIGHT_WIDTH = 1e-4
TIGHT_FAILURE_DISPLACEMENT_M = 1.0

Polygons = dict[str, list[tuple[float, float]]]


@dataclass(frozen=True)
class Inputs:
    """What a scene file with a domain says."""

    height: float
    face_angle_deg: float
    dips_deg: tuple[float, ...]
    spacings: tuple[float, ...]
    unit_weight: float
    gravity: float
    friction_angle_deg: float
    cohesion: float
    tensile_strength: float
    normal_stiffness: float
    shear_stiffness: float
    damping_ratio: float
    dt: float
    failure_displacement: float | None
    width: float | None
    strength_reduction_factor: float | None
    end_displacement: float | None


def read_inputs(scene_file: Path) -> Inputs:
    scene = tomllib.loads(scene_file.read_text(encoding="utf-8"))
    corners, joint, sets = scene["domain"]["vertices_m"], scene["joint"][0], scene["joint_set"]
    toe, crest = [0.0, 0.0], corners[3]
    return Inputs(
        height=crest[1] - toe[1],
        face_angle_deg=math.degrees(math.atan2(crest[1] - toe[1], crest[0] - toe[0])),
        dips_deg=tuple(s["dip_deg"] for s in sets),
        spacings=tuple(s["spacing_m"] for s in sets),
        unit_weight=scene["material"][0]["unit_weight_n_per_m3"],
        gravity=math.hypot(*scene["gravity_m_per_s2"]),
        friction_angle_deg=joint["friction_angle_deg"],
        cohesion=joint["cohesion_pa"],
        tensile_strength=joint["tensile_strength_pa"],
        normal_stiffness=joint["normal_stiffness_pa_per_m"],
        shear_stiffness=joint["shear_stiffness_pa_per_m"],
        damping_ratio=joint.get("damping_ratio", 0.0),
        dt=scene["step"]["dt_s"],
        failure_displacement=scene.get("settle", {}).get("failure_displacement_m"),
        width=scene.get("strength_reduction", {}).get("width"),
        strength_reduction_factor=scene.get("run", {}).get("strength_reduction_factor"),
        end_displacement=scene.get("end", {}).get("displacement_m"),
    )


@dataclass(frozen=True)
class Fos:
    """A strength reduction: the factor and what is known of it, or the reason why there is none."""

    value: float | None
    reason: str
    warning: str


def _fos(openclose: Openclose, case: Case) -> Fos:
    summary = openclose.summary(case)
    if not summary.get("factor_of_safety"):
        return Fos(None, summary["reason"], "")
    return Fos(summary["factor_of_safety"], "", "; ".join(summary["warnings"]))


class CutBlocks:
    """A scene's domain, cut by `openclose cut`, and the limit analysis of the file that this wrote."""

    def __init__(self, name: str, scene: Path, openclose: Openclose, reference: Reference):
        self.case = Case(f"{name}-cut", "cut", scene)
        self._openclose = openclose
        self._reference = reference

    @cached_property
    def blocks(self) -> list[dict]:
        return tomllib.loads(self._openclose.blocks_file(self.case).read_text(encoding="utf-8"))["block"]

    @property
    def outlines(self) -> Polygons:
        return {block["name"]: [tuple(v) for v in block["vertices_m"]] for block in self.blocks}

    @property
    def fixed(self) -> set[str]:
        return {block["name"] for block in self.blocks if block.get("fixed")}

    @cache
    def limit(self, cohesion: float | None = None) -> float:
        """[-] factor of safety of rigid-block limit analysis, with another cohesion if one is given"""
        options: dict[str, object] = {"mechanism": self._mechanism_file}
        if cohesion is not None:
            options = {"cohesion-pa": cohesion}
        rows = self._reference.table("limit-analysis", options, (str(self._openclose.blocks_file(self.case)),))
        return next(float(row["value"]) for row in rows if row["quantity"] == "factor_of_safety")

    def mechanism(self) -> dict[str, list[tuple[float, float]]]:
        """Velocities of the vertices of each block at failure, up to a common factor."""
        self.limit()
        velocities: dict[str, list[tuple[float, float]]] = {}
        for row in self._openclose.table(self.case, self._mechanism_file.name):
            velocities.setdefault(row["block"], []).append((float(row["velocity_x_m_per_s"]), float(row["velocity_y_m_per_s"])))
        return velocities

    @property
    def _mechanism_file(self) -> Path:
        return self._openclose.folder_of(self.case) / "mechanism.csv"


class PlanarSlope:
    """Example 3.3: parallel joints in three sizes of model."""

    def __init__(self, openclose: Openclose, reference: Reference):
        self._openclose = openclose
        self._reference = reference
        self.inputs = read_inputs(self._scene("wedge"))
        self.cut = {model: CutBlocks(f"3.3-{model}", self._scene(model), openclose, reference) for model in MODELS}

    def cases(self) -> list[Case]:
        return [*(cut.case for cut in self.cut.values()), *(self._case(model, method) for model in MODELS for method in METHODS)]

    def factor_of_safety(self, model: str, method: str) -> Fos:
        return _fos(self._openclose, self._case(model, method))

    @cache
    def closed_form(self, unit_weight: float | None = None) -> float:
        """[-] of the wedge on the joint through the toe"""
        i = self.inputs
        options = {"height": i.height, "face-deg": i.face_angle_deg, "plane-deg": i.dips_deg[0], "cohesion": i.cohesion,
                   "phi-deg": i.friction_angle_deg, "unit-weight": i.unit_weight if unit_weight is None else unit_weight}
        return next(float(row["value"]) for row in self._reference.table("wedge", options) if row["quantity"] == "factor_of_safety")

    def back_wall(self, model: str) -> float:
        """[m] behind the crest"""
        corners = tomllib.loads(self._scene(model).read_text(encoding="utf-8"))["domain"]["vertices_m"]
        return corners[2][0] - corners[3][0]

    def states(self, model: str, method: str) -> tuple[Polygons, Polygons]:
        """Blocks as settled, and in the state in which failure was found."""
        rows = self._openclose.table(self._case(model, method), "blocks.csv")
        return outlines(rows, "settled"), outlines(rows, "failed")

    @staticmethod
    def _scene(model: str) -> Path:
        return _SCENES / f"example_3_3_{model}.toml"

    def _case(self, model: str, method: str) -> Case:
        return Case(f"3.3-{model}-{method}", "fos", self._scene(model), (("method.contact", method),), FOS_CPU_LIMIT_S[method])


@dataclass(frozen=True)
class Milestone:
    """When the toe block's centroid had moved so far; CPU seconds without settling."""

    displacement: float
    time: float
    cpu: float


class JointedSlope:
    """Example 3.4: two joint sets."""

    SCENE = _SCENES / "example_3_4.toml"
    POST_FAILURE = _SCENES / "example_3_4_post_failure.toml"

    def __init__(self, openclose: Openclose, reference: Reference, printed: dict):
        self._openclose = openclose
        self._printed = printed["jointed_slope"]
        self.inputs = read_inputs(self.SCENE)
        self.post_failure_inputs = read_inputs(self.POST_FAILURE)
        self.cut = CutBlocks("3.4", self.SCENE, openclose, reference)

    def cases(self) -> list[Case]:
        """The longest first, so that no process idles at the end."""
        rules = [self._by_paper_rules(m) for m in PAPER_RULES]
        return [self.cut.case, *rules, *(self._post_failure(m, start) for m in METHODS for start in STARTS), *self._reductions(), self._tight()]

    def _reductions(self) -> list[Case]:
        return [self._reduction(method, behaviour) for method in METHODS for behaviour in BEHAVIOURS]

    # -- factors of safety --

    def factor_of_safety(self, method: str, behaviour: str) -> Fos:
        return _fos(self._openclose, self._reduction(method, behaviour))

    def tight_factor_of_safety(self) -> Fos:
        """Of `soft` with ductile cohesion, by a narrow bracket and a long way."""
        return _fos(self._openclose, self._tight())

    def paper_factor_of_safety(self, method: str) -> Fos:
        """By the paper's own rules for equilibrium, cohesion lost on slip."""
        return _fos(self._openclose, self._by_paper_rules(method))

    def limit(self, behaviour: str) -> float:
        """[-] limit analysis; cohesion that is lost on slip is gone everywhere in the end"""
        return self.cut.limit(0.0 if behaviour == "lost_on_slip" else None)

    def size(self) -> tuple[float, float, float]:
        """[m] bench before the toe, rock below it, top behind the crest"""
        corners = tomllib.loads(self.SCENE.read_text(encoding="utf-8"))["domain"]["vertices_m"]
        return -corners[0][0], -corners[0][1], corners[2][0] - corners[3][0]

    @property
    def unknowns(self) -> int:
        """Three for every block, as the paper counts them, fixed or not."""
        return 3 * len(self.cut.blocks)

    # -- after failure --

    def summary(self, method: str, start: str) -> dict:
        return self._openclose.summary(self._post_failure(method, start))

    def steady_cpu(self, method: str) -> float | None:
        """[s] from unloaded springs to static equilibrium"""
        return self.summary(method, "settled").get("cpu_s", {}).get("start")

    def milestones(self, method: str, start: str) -> list[Milestone]:
        rows = self._openclose.table(self._post_failure(method, start), "milestones.csv")
        return [Milestone(float(r["displacement_m"]), float(r["time_s"]), float(r["cpu_s"])) for r in rows if not r["reason"]]

    def cpu_at(self, method: str, start: str, displacement: float) -> float | None:
        return next((m.cpu for m in self.milestones(method, start) if m.displacement == displacement), None)

    def reason(self, method: str, start: str) -> str:
        """Why a run did not come to the displacement asked for; empty if it did."""
        summary = self.summary(method, start)
        if summary.get("ended_by") != "end.displacement_m":
            return summary["reason"] or f"ended by {summary['ended_by']}"
        short = POST_FAILURE_END_M[method] < self.post_failure_inputs.end_displacement
        return f"followed to {POST_FAILURE_END_M[method]:g} m only, for its run time" if short else ""

    def common_distance(self, start: str) -> float | None:
        """[m] the farthest milestone that every method came to that came anywhere"""
        ways = [{m.displacement for m in self.milestones(method, start)} for method in METHODS]
        return max(set.intersection(*(way for way in ways if way)), default=None)

    @cache
    def blocks(self, method: str, start: str, state: str) -> Polygons:
        """Outlines; none if the run did not come to that state."""
        return outlines(self._openclose.table(self._post_failure(method, start), "blocks.csv"), state)

    def motions(self, method: str, start: str, state: str) -> dict[str, "Motion"]:
        before, after = self.blocks(method, start, "start"), self.blocks(method, start, state)
        return {name: Motion.between(before[name], after[name]) for name in after}

    # -- cases --

    def _reduction(self, method: str, behaviour: str) -> Case:
        settings = (("method.contact", method), ("joint[0].cohesion_behaviour", behaviour))
        return Case(f"3.4-{method}-{behaviour}", "fos", self.SCENE, settings, FOS_CPU_LIMIT_S[method])

    def _by_paper_rules(self, method: str) -> Case:
        settings = [("method.contact", method), ("joint[0].cohesion_behaviour", "lost_on_slip"), ("strength_reduction.width", PAPER_RULES_WIDTH),
                    ("strength_reduction.upper_limit", PAPER_RULES_UPPER_LIMIT)]
        if method == "dem":
            fraction = self._printed["unbalanced_force_limit_n"]["value"] / self._heaviest_block()
            settings += [("method.damping", "automatic"), ("settle.unbalanced_fraction", fraction),
                         ("settle.max_explicit_steps", self._printed["unbalanced_force_steps"]["value"])]
        else:
            settings += [("settle.criterion", "paper"), ("settle.relative_displacement", self._printed["relative_max_displacement_m"]["value"]),
                         ("step.dt_s", self._printed["dt_s"]["value"])]
        return Case(f"3.4-{method}-paper-rules", "fos", self.SCENE, tuple(settings), FOS_CPU_LIMIT_S["dem"])

    def rules_velocity(self) -> float:
        """[m/s] that the paper's limit on the relative displacement of a step lets pass as steady: Shi's measure is half the height of the model"""
        _, below, _ = self.size()
        half_height = 0.5 * (self.inputs.height + below)
        return self._printed["relative_max_displacement_m"]["value"] * half_height / self._printed["dt_s"]["value"]

    def _heaviest_block(self) -> float:
        """[N/m] weight of the heaviest whole block: one spacing of each joint set"""
        sine = math.sin(math.radians(self.inputs.dips_deg[1] - self.inputs.dips_deg[0]))
        return self.inputs.spacings[0] * self.inputs.spacings[1] / sine * self.inputs.unit_weight

    def _tight(self) -> Case:
        settings = (("method.contact", "soft"), ("strength_reduction.width", TIGHT_WIDTH),
                    ("settle.failure_displacement_m", TIGHT_FAILURE_DISPLACEMENT_M))
        return Case("3.4-soft-tight", "fos", self.SCENE, settings, FOS_CPU_LIMIT_S["soft"])

    def _post_failure(self, method: str, start: str) -> Case:
        settings = (("method.contact", method), ("method.start", start), ("step.dt_s", POST_FAILURE_STEP_S[method]),
                    ("end.displacement_m", POST_FAILURE_END_M[method]))
        return Case(f"3.4-after-failure-{method}-{start}", "run", self.POST_FAILURE, settings, POST_FAILURE_CPU_LIMIT_S)


@dataclass(frozen=True)
class Motion:
    """Of a rigid block between two outlines: of its corners' mean, and its turn."""

    start: tuple[float, float]
    x: float
    y: float
    rotation_deg: float

    @property
    def distance(self) -> float:
        return math.hypot(self.x, self.y)

    @staticmethod
    def between(before: list[tuple[float, float]], after: list[tuple[float, float]]) -> "Motion":
        def mean(points: list[tuple[float, float]]) -> tuple[float, float]:
            return sum(p[0] for p in points) / len(points), sum(p[1] for p in points) / len(points)

        def direction(points: list[tuple[float, float]]) -> float:
            # The longest edge of the outline before: a short one would tell the angle badly.
            k = max(range(len(before)), key=lambda i: math.dist(before[i - 1], before[i]))
            return math.atan2(points[k][1] - points[k - 1][1], points[k][0] - points[k - 1][0])

        (x0, y0), (x1, y1) = mean(before), mean(after)
        turn = math.degrees(direction(after) - direction(before))
        return Motion((x0, y0), x1 - x0, y1 - y0, (turn + 180) % 360 - 180)
