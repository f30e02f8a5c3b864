"""Verdicts on what the program gave, by rules that know nothing of the method: forces balance and stay inside the strength, a factor lies at or below limit
analysis, energy at or below the start's, blocks no deeper in each other than closures allow and where they can be. SI units."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import geometry
from motion import Block, Motion, outlines_of
from openclose_scripts.processes import BAD_INPUT, DONE, NOT_CONVERGED
from outcome import Outcome
from scene import Scene, densities

RIGHT, REFUSED, FALSE, SLOW = "right", "refused", "FALSE", "slow"
# Of two factors, each proved by forces below and by a mechanism above: without dilatancy there can be an equilibrium and a mechanism at one strength,
# and which of them is met depends on the way. No answer is false, but they are not the same.
APART = "apart"

# [-] Of the start's energy above the floor, or of the work done: the one bound of created energy.
CREATED_ENERGY = 0.01
# [-] Of the smaller block's area: beyond, springs are too soft for these blocks, whatever the closure, and which edge a corner belongs to has no meaning.
DEEPEST_OVERLAP = 0.25
# `hard` keeps contacts to its gap tolerance; what it may err besides is that a corner is found at the end of a step (a few tolerances).
GAP_TOLERANCE_M, TOLERANCES = 3e-7, 10
# [-] Of the size of a block: places that are computed in two ways from numbers of 17 digits.
SAME_PLACE = 1e-6
# [-] Of the weight of the heaviest free block: the program asks 1e-8 of itself, and the sums of large forces on a block lose some digits.
BALANCE = 1e-6
# [-] Both ends of the bracket of limit analysis lie within 1e-5 of the factor, and its programs are solved to 1e-9.
LIMIT_ANALYSIS = 1e-4
# [m] From the line of an edge: what limit analysis takes for an interface.
ON_AN_EDGE = 1e-6
# [-] Between normals: coordinates of files are exact to 1e-9 m, edges are longer than 1e-3 m.
SAME_DIRECTION = 1e-5
# [-] Of the same weight: contacts with less carry nothing.
LOADED = 1e-9
# [-] Of the factor: soft and hard, which are one solver in statics, give one bracket no wider than this.
WIDEST_BRACKET = 0.005
# [-] Of limit analysis: from here on all methods give one factor, to within
AT_THE_LIMIT, METHODS_DIFFER = 0.995, 0.01


@dataclass(frozen=True)
class Verdict:
    kind: str
    reason: str = ""
    factor: float | None = None
    stable: float | None = None
    failed: float | None = None
    limit: float | None = None        # factor of limit analysis
    created: float | None = None      # largest energy above the start's, over the scale of energy
    rise: float | None = None         # largest rise of energy from any earlier time, over the same
    answer: str = ""                  # what `fos` calls its own: certified, interval, ...
    overlap: float | None = None      # largest overlap at an output time, over the smaller block's area


def of_exit(outcome: Outcome) -> Verdict | None:
    """What can be said without looking at any result; none if there is a result."""
    if outcome.exit is None:
        return Verdict(SLOW, f"stopped after {outcome.cpu_s:.0f} s of CPU time")
    if outcome.exit in (NOT_CONVERGED, BAD_INPUT):
        return Verdict(REFUSED, outcome.reason) if outcome.reason else Verdict(FALSE, f"exit status {outcome.exit} without a reason")
    if outcome.exit != DONE:
        return Verdict(FALSE, f"exit status {outcome.exit}: {outcome.reason}")
    wrong = outcome.not_a_number()
    return Verdict(FALSE, f"no number in {wrong}") if wrong else None


def of_motion(scene: Scene, method: str, outcome: Outcome) -> Verdict:
    known = of_exit(outcome)
    if known:
        return replace(known, kind=RIGHT) if known.kind == REFUSED and scene.too_soft else known
    motion = Motion(scene, outcome)
    energy = Energy(motion)
    overlaps = list(_overlaps(motion))
    wrong = next((reason for reason in (_place(scene, motion, energy), energy.wrong(), _too_deep(motion, overlaps, scene, method),
                                        _elsewhere(scene, motion), _bookkeeping(motion)) if reason), "")
    return Verdict(FALSE if wrong else RIGHT, wrong, created=energy.created, rise=energy.rise, overlap=max((o.share for o in overlaps), default=0.0))


class Energy:
    """Kinetic and potential energy from places and velocities, and what the springs hold, at every output time. Nothing but work adds to their sum: what has
    been lost on the way and comes back is created as well."""

    def __init__(self, motion: Motion):
        steps = range(len(motion.times))
        self.times = motion.times
        work = [motion.work_done(k) for k in steps]
        without_work = [motion.energy(k) - work[k] for k in steps]
        self.start = without_work[0]
        fallen = motion.potential(0) - min(motion.potential(k) for k in steps)
        self.scale = max(self.start, fallen, *(abs(w) for w in work), math.ulp(0.0))
        self.worst = max(steps, key=lambda k: without_work[k])
        self.created = (without_work[self.worst] - self.start) / self.scale
        lowest, self.rise, self.risen = math.inf, 0.0, 0
        for k, e in enumerate(without_work):
            lowest = min(lowest, e)
            if e - lowest > self.rise * self.scale:
                self.rise, self.risen = (e - lowest) / self.scale, k

    def wrong(self) -> str:
        if self.created > CREATED_ENERGY:
            return f"energy created: {self.created:.3g} of the start's at t = {self.times[self.worst]:.4g} s"
        if self.rise > CREATED_ENERGY:
            return f"energy rises by {self.rise:.3g} of the start's until t = {self.times[self.risen]:.4g} s"
        return ""


def _place(scene: Scene, motion: Motion, energy: Energy) -> str:
    """Inside the walls, and no higher than all the energy at the start could lift that block alone."""
    for k, time in enumerate(motion.times):
        for b in motion.free:
            x, y = motion.states[k][b.name].centroid
            if scene.enclosure:
                x0, y0, x1, y1 = scene.enclosure
                if not (x0 <= x <= x1 and y0 <= y <= y1):
                    return f"{b.name} is outside the walls at t = {time:.4g} s, centroid ({x:.4g}, {y:.4g})"
            highest = (1 + CREATED_ENERGY) * energy.scale / (b.mass * motion.gravity) if motion.gravity > 0 and motion.sideways == 0 else math.inf
            if y - scene.floor_m > highest:
                return f"{b.name} is {y - scene.floor_m:.4g} m high at t = {time:.4g} s; the energy of the start lifts it {highest:.4g} m"
    return ""


@dataclass(frozen=True)
class BlocksOverlap:
    step: int
    a: Block
    b: Block
    depth: float
    chord: float
    share: float  # of the area of the smaller one


OVERLAPS_LOOKED_AT = 20


def _overlaps(motion: Motion) -> Iterator[BlocksOverlap]:
    """At some of the output times and at the end."""
    last = len(motion.times) - 1
    for k in sorted({round(last * i / OVERLAPS_LOOKED_AT) for i in range(OVERLAPS_LOOKED_AT + 1)}):
        placed = motion.placed(k)
        for i, j in geometry.near_pairs([p for _, p in placed]):
            (a, pa), (b, pb) = placed[i], placed[j]
            if a.fixed and b.fixed:
                continue
            common = geometry.overlap(pa, pb)
            if common.area > 0:
                yield BlocksOverlap(k, a, b, common.depth, common.chord, common.area / min(a.body.integrals.area, b.body.integrals.area))


def _too_deep(motion: Motion, overlaps: list[BlocksOverlap], scene: Scene, method: str) -> str:
    """The worst of the overlaps that are deeper than allowed."""
    joints = scene.document["joint"]
    kn = min(j["normal_stiffness_pa_per_m"] for j in joints)
    heaviest = max(b.mass for b in motion.free)
    weight = sum(b.mass for b in motion.free) * motion.gravity
    fastest, speeds = 0.0, []
    for k in range(len(motion.times)):
        fastest = max(fastest, motion.fastest(k))
        speeds.append(fastest)
    wrong = []
    for o in overlaps:
        allowed = GAP_TOLERANCE_M * TOLERANCES if method == "hard" else closure(speeds[o.step], heaviest, weight, kn * o.chord)
        if o.depth > allowed or o.share > DEEPEST_OVERLAP:
            wrong.append((o.share, f"{o.a.name} and {o.b.name} overlap by {100 * o.share:.3g} % of the smaller one at t = {motion.times[o.step]:.4g} s, "
                                   f"{o.depth:.3g} m deep; closure allows {allowed:.3g} m"))
    return max(wrong)[1] if wrong else ""


AT_ONCE = 2  # [-] a weight that comes at once goes twice as deep as one that rests


def closure(speed: float, mass: float, weight: float, stiffness: float) -> float:
    """[m] By which a spring gives way that stops a mass and carries a weight. With the stiffness of the joint on the chord of the overlap it is the softest
    that two blocks can be to each other; with the heaviest block, the fastest speed so far and all the weight it is an upper bound of what can happen."""
    return speed * math.sqrt(mass / stiffness) + AT_ONCE * weight / stiffness


def _elsewhere(scene: Scene, motion: Motion) -> str:
    """Where the answer is known."""
    for e in scene.expected:
        x, y = (motion.states[-1][e.block].centroid[k] - motion.blocks[e.block].centroid[k] for k in (0, 1))
        if math.hypot(x - e.x, y - e.y) > e.tolerance:
            return f"{e.block} has moved by ({x:.5g}, {y:.5g}) m instead of ({e.x:.5g}, {e.y:.5g}) m, tolerance {e.tolerance:.3g} m"
    return ""


def _bookkeeping(motion: Motion) -> str:
    """The last places in history.csv are those in blocks.csv."""
    for b in motion.free:
        off = max(math.dist(p, q) for p, q in zip(motion.states[-1][b.name].vertices, motion.final[b.name]))
        if off > SAME_PLACE * b.body.reach:
            return f"{b.name}: the last places in history.csv and blocks.csv are {off:.3g} m apart"
    return ""


@dataclass(frozen=True)
class Bracket:
    stable: float | None
    failed: float | None
    failed_by: str
    verdict: str
    complete: bool  # the format that says by what the failed end is proved


PROVED_BY = "mechanism", "limit_analysis", "limit analysis"
STABLE = "stable"  # of the states in contacts.csv and blocks.csv: the last one that was certified
PROVED_BEFORE = "displacement"
NO_FAILURE, INTERVAL = "no_failure", "interval"


def read_bracket(summary: dict) -> Bracket:
    bracket = summary["bracket"]
    if isinstance(bracket, dict):
        return Bracket(bracket.get("stable"), bracket.get("failed"), bracket.get("failed_by") or "", summary.get("verdict", ""), True)
    stable, failed = bracket
    return Bracket(stable, failed or None, summary.get("criterion", ""), "", False)


def of_factor(outcome: Outcome, assembly: "Assembly", limit: dict[str, float] | None, most: float | None = None) -> Verdict:
    """most: factor beyond which nothing can stand, if one is known"""
    known = of_exit(outcome)
    if known:
        known = replace(known, limit=limit and limit["factor"])
        if known.kind == REFUSED and limit and limit["factor"] == 0:
            return replace(known, kind=RIGHT)  # there is no equilibrium to be found
        return known
    bracket = read_bracket(outcome.summary)
    factor = outcome.summary.get("factor_of_safety")
    forces = assembly.forces(outcome)
    corners = assembly.lone_corners(forces)
    if corners:
        limit = None
    wrong = next((reason for reason in (_unproved(bracket), _unordered(bracket, factor), assembly.unbalanced(forces, bracket.stable) if bracket.complete else "", _above(bracket, limit),
                                        _above_known(bracket, most),
                                        _unproved_by_limit_analysis(bracket, limit)) if reason), "")
    note = f"{corners} lone corners carry load, not compared with limit analysis" if corners else ""
    return Verdict(FALSE if wrong else RIGHT, wrong or note, factor, bracket.stable, bracket.failed, limit and limit["factor"], answer=bracket.verdict)


def _unproved(bracket: Bracket) -> str:
    """A failed end needs a proof; in what came before, a block that has moved far was the nearest to one."""
    if bracket.failed is None or (bracket.failed_by in PROVED_BY if bracket.complete else bracket.failed_by == PROVED_BEFORE):
        return ""
    return f"failed at {bracket.failed:.6g} without proof: {bracket.failed_by or 'no reason'}"


def _unordered(bracket: Bracket, factor: float | None) -> str:
    if bracket.stable is None or (factor is None and bracket.verdict != NO_FAILURE):
        return "exit status 0 without a stable factor"
    if bracket.verdict == NO_FAILURE:
        return f"no failure, but failed at {bracket.failed:.6g}" if bracket.failed is not None else ""
    if bracket.failed is not None and not bracket.stable < bracket.failed:
        return f"stable at {bracket.stable:.6g}, not below failed at {bracket.failed:.6g}"
    return "" if factor == bracket.stable else f"factor {factor:.6g} is not the stable end {bracket.stable:.6g}"


def _above(bracket: Bracket, limit: dict[str, float] | None) -> str:
    if limit is None or bracket.stable is None or bracket.stable <= limit["failed"] * (1 + LIMIT_ANALYSIS):
        return ""
    return f"stable at {bracket.stable:.6g}, limit analysis {limit['factor']:.6g}"


def _above_known(bracket: Bracket, most: float | None) -> str:
    if most is None or bracket.stable is None or bracket.stable <= most * (1 + LIMIT_ANALYSIS):
        return ""
    return f"stable at {bracket.stable:.6g}, but nothing can stand beyond {most:.6g}"


def _unproved_by_limit_analysis(bracket: Bracket, limit: dict[str, float] | None) -> str:
    """A failed end that the program took from limit analysis is one of ours, too."""
    if "limit" not in bracket.failed_by or limit is None or bracket.failed >= limit["factor"] * (1 - LIMIT_ANALYSIS):
        return ""
    return f"failed at {bracket.failed:.6g} by limit analysis, which is feasible to {limit['factor']:.6g}"


@dataclass(frozen=True)
class Force:
    a: str
    b: str
    point: geometry.Point
    normal: geometry.Point  # from b to a
    length: float
    normal_force: float
    shear_force: float


def _on_drawn(rows: list[dict[str, str]], states: dict[str, dict[str, list[geometry.Point]]]) -> list[Force]:
    """Corners and edges of contacts.csv are those of the blocks where they have moved to; their numbers tell which they are in the drawing."""
    moved, drawn = states.get(STABLE, states["initial"]), states["initial"]
    forces = []
    for row in rows:
        a, b = row["block_a"], row["block_b"]
        point, normal = (float(row["x_m"]), float(row["y_m"])), (float(row["normal_x"]), float(row["normal_y"]))
        corner = min(range(len(moved[a])), key=lambda i: math.dist(moved[a][i], point))
        edge = _edge_of(moved[b], point, normal)
        forces.append(Force(a, b, drawn[a][corner], _outward(*geometry.edges(drawn[b])[edge]), float(row["length_m"]), float(row["normal_force_n"]),
                            float(row["shear_force_n"])))
    return forces


def _edge_of(polygon: geometry.Polygon, point: geometry.Point, normal: geometry.Point) -> int:
    """Number of the edge with this normal; of several the nearest."""
    edges = geometry.edges(polygon)
    off = [math.dist(_outward(*e), normal) for e in edges]
    parallel = [i for i, o in enumerate(off) if o <= min(off) + SAME_PLACE]
    return min(parallel, key=lambda i: abs(geometry.cross(*edges[i], point)) / math.dist(*edges[i]))


def _outward(p: geometry.Point, q: geometry.Point) -> geometry.Point:
    length = math.dist(p, q)
    return (q[1] - p[1]) / length, (p[0] - q[0]) / length


class Assembly:
    """Blocks of a file that `openclose cut` wrote, with gravity, loads and joints: equilibrium and strength are computed from these alone."""

    def __init__(self, document: dict):
        self.gravity = document.get("gravity_m_per_s2", [0.0, -9.81])
        density = densities(document)
        self.joints = {frozenset(j["materials"]): j for j in document["joint"] if "materials" in j}
        self.named = {j["name"]: j for j in document["joint"] if "name" in j}
        self.edge_joints = {b["name"]: _joints_of_edges(b) for b in document["block"]}
        self.material = {b["name"]: b["material"] for b in document["block"]}
        self.vertices = {b["name"]: geometry.counter_clockwise([tuple(p) for p in b["vertices_m"]]) for b in document["block"]}
        self.fixed = {b["name"] for b in document["block"] if b.get("fixed")}
        self.parts = {name: geometry.integrals(v) for name, v in self.vertices.items()}
        self.mass = {name: density[self.material[name]] * part.area for name, part in self.parts.items()}
        self.loads = document.get("load", [])
        self.supported = {s["block"] for s in document.get("support", [])}

    @property
    def free(self) -> list[str]:
        return [name for name in self.vertices if name not in self.fixed]

    @property
    def heaviest(self) -> float:
        """[N]"""
        return max(self.mass[name] for name in self.free) * math.hypot(*self.gravity)

    def forces(self, outcome: Outcome) -> list[Force]:
        """Of the last stable state, on the drawn corners and edges, where they balance at small displacements; none where they are not written."""
        rows = [row for row in outcome.table("contacts.csv") if row["state"] == STABLE]
        return _on_drawn(rows, outlines_of(outcome)) if rows else []

    def unbalanced(self, forces: list[Force], factor: float | None) -> str:
        """Forces that are missing, do not balance, or exceed the strength over the factor."""
        if factor is None:
            return ""
        if not forces:
            return "contacts.csv has no forces of the stable state"
        return self._out_of_balance(forces) or self._too_strong(forces, factor)

    def _out_of_balance(self, forces: list[Force]) -> str:
        total = {name: [self.mass[name] * self.gravity[0], self.mass[name] * self.gravity[1], 0.0] for name in self.free if name not in self.supported}

        def add(name: str, point: geometry.Point, force: geometry.Point) -> None:
            if name in total:
                arm = (point[0] - self.parts[name].centroid[0], point[1] - self.parts[name].centroid[1])
                for k, value in enumerate((*force, arm[0] * force[1] - arm[1] * force[0])):
                    total[name][k] += value

        for f in forces:
            # Shear is positive on a along the edge of b, counter-clockwise around b.
            along = (-f.normal[1], f.normal[0])
            force = tuple(f.normal_force * f.normal[k] + f.shear_force * along[k] for k in (0, 1))
            add(f.a, f.point, force)
            add(f.b, f.point, (-force[0], -force[1]))
        for load in self.loads:
            add(load["block"], load["point_m"], load["force_n"])
        for name, (x, y, moment) in total.items():
            reach = max(math.dist(self.parts[name].centroid, p) for p in self.vertices[name])
            off = max(math.hypot(x, y), abs(moment) / reach) / self.heaviest
            if off > BALANCE:
                return f"forces on {name} are {off:.3g} of the heaviest weight out of balance"
        return ""

    def _too_strong(self, forces: list[Force], factor: float) -> str:
        allowed = BALANCE * self.heaviest
        for f in forces:
            strengths = [_strength(joint, f, factor) for joint in self.possible_joints(f)]
            if not any(f.normal_force >= -tension - allowed and abs(f.shear_force) <= bound + allowed for tension, bound in strengths):
                return (f"{f.a} on {f.b}: normal force {f.normal_force:.6g} N, shear force {f.shear_force:.6g} N beyond the strength over {factor:.6g} "
                        f"({max(bound for _, bound in strengths):.6g} N)")
        return ""

    def possible_joints(self, f: Force) -> list[dict]:
        """What an edge that is touched names, if one of the two edges at the corner does so, too; else that of the materials. At the end of an edge that
        another one continues it may be either of the two."""
        outline, names = self.vertices[f.b], self.edge_joints[f.b]
        touched = [i for i, (p, q) in enumerate(geometry.edges(outline)) if math.dist(_outward(p, q), f.normal) <= SAME_DIRECTION and geometry.on_segment(f.point, p, q, 2 * ON_AN_EDGE)]
        corner = min(range(len(self.vertices[f.a])), key=lambda i: math.dist(self.vertices[f.a][i], f.point))
        at_corner = self.edge_joints[f.a][corner], self.edge_joints[f.a][corner - 1]
        found = {names[i] if names[i] in at_corner else "" for i in touched} or {""}
        return [self.named[name] if name else self.joints[frozenset((self.material[f.a], self.material[f.b]))] for name in found]

    def lone_corners(self, forces: list[Force]) -> int:
        """Loaded contacts that lie on no two edges facing each other: limit analysis does not know them."""
        return sum(max(abs(f.normal_force), abs(f.shear_force)) > LOADED * self.heaviest and not self._on_interface(f) for f in forces)

    def _on_interface(self, f: Force) -> bool:
        a, b = ([(p, q) for p, q in geometry.edges(self.vertices[name]) if geometry.on_segment(f.point, p, q, 2 * ON_AN_EDGE)] for name in (f.a, f.b))
        return any(_face(one, other) for one in a for other in b)


def _strength(joint: dict, f: Force, factor: float) -> tuple[float, float]:
    """[N] That a contact bears in tension and, under its normal force, in shear, if slip has taken nothing that makes it weaker: where a contact pulls,
    friction is what its cohesion loses."""
    tension, cohesion = (joint.get(key, 0.0) * f.length / factor for key in ("tensile_strength_pa", "cohesion_pa"))
    friction_deg = joint["friction_angle_deg"]
    if f.normal_force < 0.0 and joint.get("slip_weakening_distance_m", 0.0) > 0.0 and joint.get("cohesion_behaviour", "ductile") == "ductile":
        friction_deg = joint.get("residual_friction_angle_deg", friction_deg)
    return tension, max(0.0, cohesion + f.normal_force * math.tan(math.radians(friction_deg)) / factor)


def _joints_of_edges(block: dict) -> list[str]:
    """By the corners as the assembly has them, counter-clockwise."""
    vertices = [tuple(p) for p in block["vertices_m"]]
    names = block.get("edge_joints", [""] * len(vertices))
    return names if geometry.counter_clockwise(vertices) == vertices else names[-2::-1] + names[-1:]


def _face(one: tuple, other: tuple) -> bool:
    """Two edges of blocks run against each other along more than a point of one line."""
    (p, q), (r, s) = one, other
    length = math.dist(p, q)
    along = [((x[0] - p[0]) * (q[0] - p[0]) + (x[1] - p[1]) * (q[1] - p[1])) / length for x in (r, s)]
    beside = [abs(geometry.cross(p, q, x)) / length for x in (r, s)]
    shared_low, shared_high = max(0.0, min(along)), min(length, max(along))
    if shared_high - shared_low <= ON_AN_EDGE or along[0] < along[1]:
        return False
    # The distance at the ends of what they share, along the other edge.
    span = along[0] - along[1]
    return all(abs(beside[1] + (beside[0] - beside[1]) * (x - along[1]) / span) <= ON_AN_EDGE for x in (shared_low, shared_high))


def same_bracket(one: Verdict, other: Verdict) -> str:
    """Why two certified brackets of one slope are not the same answer: they have a factor in common and are narrow; empty if they are."""
    if one.stable is None or other.stable is None:
        return ""
    if one.failed is not None and one.failed < other.stable or other.failed is not None and other.failed < one.stable:
        return f"brackets {_written(one)} and {_written(other)} have no factor in common"
    return ""


def nearly_same(one: Verdict, other: Verdict) -> str:
    """Where the factor is that of limit analysis, neither the way to equilibrium nor ks/kn matters on all but a few slopes: methods agree."""
    if one.stable is None or other.stable is None or one.limit is None or one.stable < AT_THE_LIMIT * one.limit or abs(other.stable / one.stable - 1) <= METHODS_DIFFER:
        return ""
    if other.answer == INTERVAL and other.stable < one.stable and (other.failed is None or other.failed >= one.stable):
        return ""  # it says itself that it does not know better
    return f"stable at {other.stable:.6g} instead of {one.stable:.6g}, limit analysis {one.limit:.6g}"


def too_wide(verdict: Verdict) -> bool:
    """A certified bracket; what is called an interval says itself that it is none."""
    return verdict.answer != INTERVAL and verdict.stable is not None and verdict.failed is not None and verdict.failed - verdict.stable > WIDEST_BRACKET * verdict.stable


def _written(v: Verdict) -> str:
    return f"[{v.stable:.6g}, {'open' if v.failed is None else format(v.failed, '.6g')}]"
