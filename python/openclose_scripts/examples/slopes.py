"""Examples 3.3 and 3.4, slopes of many blocks: which runs are made and what is read from them. SI units; angles in degrees where the name says so."""

import math
import tomllib
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from openclose_scripts import PAPER_SCENES
from openclose_scripts.examples.jointed_rock import JointedRock
from openclose_scripts.runs import Case, Openclose, Reference, outlines

METHODS = ("soft", "hard", "dem", "shi")
HORIZONTAL_SPACING_M, FACE_SPACING_M = 40.0, 10.0  # of the joints of example 3.4
BEHAVIOURS = ("ductile", "lost_on_opening", "lost_on_slip")
MODELS = ("wedge", "toe", "shifted")

# What a search and a run after failure may cost; one that is stopped stays in the tables with this reason.
FOS_CPU_LIMIT_S = {"soft": 15, "hard": 15, "dem": 15, "shi": 30}
POST_FAILURE_CPU_LIMIT_S = 150
# The friction of shi is that of the pass before: static steps converge on rest only linearly, the more slowly the nearer to failure.
SHI_SETTLE_STEPS = 400


@dataclass(frozen=True)
class Follower:
    """How the slope is followed after failure; dem divides the step that is asked for into stable ones."""

    method: str
    dt: float
    name: str


# Shi's scheme takes the friction of the pass before, so it needs the paper's step.
PAPER_STEP = "soft_paper_step"
FOLLOWERS = {
    "soft": Follower("soft", 0.01, "soft, 10 ms"),
    PAPER_STEP: Follower("soft", 0.001, "soft, 1 ms"),
    "hard": Follower("hard", 0.01, "hard, 10 ms"),
    "dem": Follower("dem", 0.01, "dem, critical step"),
    "shi": Follower("shi", 0.001, "shi, 1 ms"),
}
STARTS = {"settled": "from the settled state", "unloaded": "cold: gravity dropped on unloaded springs"}

# Whose own rules for equilibrium the paper gives: DDA's relative displacement, which its tables print as a length, and UDEC's unbalanced force.
# By the length soft takes so many steps to its first steady state that a search would cost more than all other runs together.
RULE_METHODS = ("soft", "shi", "dem")
PAPER_RULES = (("soft", "relative"), ("shi", "relative"), ("shi", "length"), ("dem", "force"))
PAPER_RULES_WIDTH = 0.05
PAPER_RULES_UPPER_LIMIT = 2.2  # beyond it, their factor says nothing about the slope
PAPER_RULES_CPU_LIMIT_S = {"soft": 60, "shi": 200, "dem": 90}

MOVED_M = 0.1  # blocks that moved less take no part in the mechanism

# The tight search that shows what the short one costs in accuracy.
TIGHT_WIDTH = 1e-4
TIGHT_FAILURE_DISPLACEMENT_M = 1.0

Polygons = dict[str, list[tuple[float, float]]]


@dataclass(frozen=True)
class Inputs(JointedRock):
    """What a scene file with a domain says."""

    height: float
    face_angle_deg: float
    dips_deg: tuple[float, ...]
    spacings: tuple[float, ...]
    damping_ratio: float
    failure_displacement: float | None
    width: float | None
    strength_reduction_factor: float | None


def read_inputs(scene_file: Path) -> Inputs:
    scene = tomllib.loads(scene_file.read_text(encoding="utf-8"))
    corners, sets = scene["domain"]["vertices_m"], scene["joint_set"]
    toe, crest = [0.0, 0.0], corners[3]
    return Inputs(
        **vars(JointedRock.of(scene)),
        height=crest[1] - toe[1],
        face_angle_deg=math.degrees(math.atan2(crest[1] - toe[1], crest[0] - toe[0])),
        dips_deg=tuple(s["dip_deg"] for s in sets),
        spacings=tuple(s["spacing_m"] for s in sets),
        damping_ratio=scene["joint"][0].get("damping_ratio", 0.0),
        failure_displacement=scene.get("settle", {}).get("failure_displacement_m"),
        width=scene.get("strength_reduction", {}).get("width"),
        strength_reduction_factor=scene.get("run", {}).get("strength_reduction_factor"),
    )


@dataclass(frozen=True)
class Fos:
    """A strength reduction: the factor and what is known of it, or the reason why there is none."""

    value: float | None
    reason: str
    warning: str
    failed: float | None = None  # the other end of the bracket


def _fos(openclose: Openclose, case: Case) -> Fos:
    summary = openclose.summary(case)
    if not summary.get("factor_of_safety") or summary["verdict"] == "no_failure":
        return Fos(None, summary["reason"], "")  # a slope that stands at every factor tried has none
    return Fos(summary["factor_of_safety"], "", "; ".join(summary["warnings"]), summary["bracket"]["failed"])


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
        return PAPER_SCENES / f"example_3_3_{model}.toml"

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

    SCENE = PAPER_SCENES / "example_3_4.toml"
    POST_FAILURE = PAPER_SCENES / "example_3_4_post_failure.toml"

    def __init__(self, openclose: Openclose, reference: Reference, printed: dict):
        self._openclose = openclose
        self._printed = printed["jointed_slope"]
        self.inputs = read_inputs(self.SCENE)
        self.post_failure_inputs = read_inputs(self.POST_FAILURE)
        self.cut = CutBlocks("3.4", self.SCENE, openclose, reference)

    def cases(self) -> list[Case]:
        """The longest first, so that no process idles at the end."""
        after = [self._post_failure(f, start) for f in FOLLOWERS for start in STARTS]
        rules = [self._by_paper_rules(method, reading) for method, reading in PAPER_RULES]
        steady = [self._steady_by_paper_rule(m) for m in RULE_METHODS]
        return [self.cut.case, *rules, *steady, *after, *self._reductions(), self._breaking_on_the_way(), self._tight()]

    def _reductions(self) -> list[Case]:
        return [self._reduction(method, behaviour) for method in METHODS for behaviour in BEHAVIOURS]

    # -- factors of safety --

    def factor_of_safety(self, method: str, behaviour: str) -> Fos:
        return _fos(self._openclose, self._reduction(method, behaviour))

    def tight_factor_of_safety(self) -> Fos:
        """Of `soft` with ductile cohesion, by a narrow bracket and a long way."""
        return _fos(self._openclose, self._tight())

    def breaking_factor_of_safety(self) -> Fos:
        """Of `dem` with cohesion lost on opening, also in the waves on the way to rest."""
        return _fos(self._openclose, self._breaking_on_the_way())

    def paper_factor_of_safety(self, method: str, reading: str) -> Fos:
        """By the paper's own rules for equilibrium, cohesion lost on slip; one of PAPER_RULES."""
        return _fos(self._openclose, self._by_paper_rules(method, reading))

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

    def summary(self, follower: str, start: str) -> dict:
        return self._openclose.summary(self._post_failure(follower, start))

    def steady_cpu(self, method: str) -> float | None:
        """[s] from unloaded springs to static equilibrium"""
        return self.summary(method, "settled").get("cpu_s", {}).get("start")

    def paper_steady(self, method: str) -> tuple[float, int] | None:
        """CPU seconds and steps from unloaded springs to the paper's steady state, its limit read as a length; none if it is not reached"""
        summary = self._openclose.summary(self._steady_by_paper_rule(method))
        if not summary.get("converged"):
            return None
        return summary["cpu_s"]["start"], summary["settling"]["steps"]

    def critical_step(self) -> float | None:
        """[s] the shortest that dem had to keep to after failure"""
        return self.summary("dem", "settled").get("explicit", {}).get("critical_step_s")

    def milestones(self, follower: str, start: str) -> list[Milestone]:
        rows = self._openclose.table(self._post_failure(follower, start), "milestones.csv")
        return [Milestone(float(r["displacement_m"]), float(r["time_s"]), float(r["cpu_s"])) for r in rows if not r["reason"]]

    def cpu_at(self, follower: str, start: str, displacement: float) -> float | None:
        return next((m.cpu for m in self.milestones(follower, start) if m.displacement == displacement), None)

    def reason(self, follower: str, start: str) -> str:
        """Why a run did not come to the displacement asked for; empty if it did."""
        summary = self.summary(follower, start)
        if summary.get("ended_by") == "end.displacement_m":
            return ""
        return summary["reason"] or f"ended by {summary['ended_by']}"

    def common_distance(self, start: str) -> float | None:
        """[m] the farthest milestone that every run came to that came anywhere"""
        ways = [{m.displacement for m in self.milestones(follower, start)} for follower in FOLLOWERS]
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
        settings = [("method.contact", method), ("joint[0].cohesion_behaviour", behaviour)]
        if method == "shi":
            settings.append(("settle.max_steps", SHI_SETTLE_STEPS))
        return Case(f"3.4-{method}-{behaviour}", "fos", self.SCENE, tuple(settings), FOS_CPU_LIMIT_S[method])

    def _breaking_on_the_way(self) -> Case:
        settings = (("method.contact", "dem"), ("joint[0].cohesion_behaviour", "lost_on_opening"), ("settle.keep_bonds", "false"))
        return Case("3.4-dem-lost_on_opening-on-the-way", "fos", self.SCENE, settings, FOS_CPU_LIMIT_S["dem"])

    def _paper_rules(self, method: str, reading: str) -> tuple[tuple[str, object], ...]:
        """Settings of the paper's criterion; cohesion lost on slip."""
        settings = [("method.contact", method), ("joint[0].cohesion_behaviour", "lost_on_slip"), ("settle.criterion", "paper")]
        if method == "dem":
            settings += [("method.damping", "automatic"), ("settle.unbalanced_force_n", self._printed["unbalanced_force_limit_n"]["value"]),
                         ("settle.max_time_steps", self._printed["unbalanced_force_steps"]["value"])]
        else:
            limit = self._printed["relative_max_displacement_m"]["value"]
            settings += [("settle.relative_displacement", limit if reading == "relative" else limit / self._half_height()),
                         ("step.dt_s", self._printed["dt_s"]["value"])]
        return tuple(settings)

    def _by_paper_rules(self, method: str, reading: str) -> Case:
        search = (("strength_reduction.width", PAPER_RULES_WIDTH), ("strength_reduction.upper_limit", PAPER_RULES_UPPER_LIMIT))
        settings = (*self._paper_rules(method, reading), *search)
        return Case(f"3.4-{method}-paper-rules-{reading}", "fos", self.SCENE, settings, PAPER_RULES_CPU_LIMIT_S[method])

    def _steady_by_paper_rule(self, method: str) -> Case:
        """Settles by the paper's rule, the limit read as a length, and stops after one step."""
        dt = self._printed["dt_s"]["value"]
        settings = (*self._paper_rules(method, "length"), ("end.time_s", dt))
        return Case(f"3.4-{method}-paper-steady", "run", self.SCENE, settings, PAPER_RULES_CPU_LIMIT_S[method])

    def rules_velocity(self) -> float:
        """[m/s] that the paper's limit on the relative displacement of a step lets pass as steady: Shi's measure is half the height of the model"""
        return self._printed["relative_max_displacement_m"]["value"] * self._half_height() / self._printed["dt_s"]["value"]

    def _half_height(self) -> float:
        """[m] of the model"""
        _, below, _ = self.size()
        return 0.5 * (self.inputs.height + below)

    def _tight(self) -> Case:
        settings = (("method.contact", "soft"), ("strength_reduction.width", TIGHT_WIDTH),
                    ("settle.failure_displacement_m", TIGHT_FAILURE_DISPLACEMENT_M))
        return Case("3.4-soft-tight", "fos", self.SCENE, settings, FOS_CPU_LIMIT_S["soft"])

    def _post_failure(self, follower: str, start: str) -> Case:
        run = FOLLOWERS[follower]
        settings = (("method.contact", run.method), ("method.start", start), ("step.dt_s", run.dt))
        return Case(f"3.4-after-failure-{follower}-{start}", "run", self.POST_FAILURE, settings, POST_FAILURE_CPU_LIMIT_S)


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
