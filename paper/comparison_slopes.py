"""Rows of the comparison for examples 3.3 and 3.4: Tables 2 to 4 and the factors of safety."""

from comparison import Row, Values, jointed_rock, relative, rock_inputs
from openclose_scripts.examples import slopes
from openclose_scripts.examples.slopes import BEHAVIOURS, METHODS, Fos, Inputs, JointedSlope, PlanarSlope

# Which printed number each model of example 3.3 explains.
PRINTED_OF_MODEL = {"wedge": "closed_form", "toe": "dda_sc", "shifted": "udec"}
MODEL_NAMES = {"wedge": "whole wedge", "toe": "cut by the back wall, joint through the toe", "shifted": "cut by the back wall, joints shifted"}


def build(planar: PlanarSlope, jointed: JointedSlope, printed: dict) -> list[Row]:
    return [
        *_inputs("Table 2", planar.inputs, printed["planar_slope"], (("joint spacing", "joint_spacing_m", planar.inputs.spacings[0]),
                                                                   ("joint dip", "joint_angle_deg", planar.inputs.dips_deg[0]))),
        *_planar(planar, printed),
        *_inputs("Table 3", jointed.inputs, printed["jointed_slope"],
                 (("spacing of the horizontal joints", "horizontal_spacing_m", jointed.inputs.spacings[0]),
                  ("spacing of the joints parallel to the face", "face_parallel_spacing_m", jointed.inputs.spacings[1]))),
        *_factors(jointed, printed["table_4"]),
        *_run_times(jointed, printed["table_4"]),
        *_energy(jointed),
    ]


def known(factors: dict[str, Fos]) -> Values:
    """Those that were found without a warning; the report has the others with their reasons."""
    return {method: fos.value for method, fos in factors.items() if fos.value is not None and not fos.warning}


def _inputs(item: str, i: Inputs, printed: dict, joints: tuple[tuple[str, str, float], ...]) -> list[Row]:
    shape = (("slope height", "slope_height_m", i.height), ("slope face angle", "face_angle_deg", i.face_angle_deg), *joints)
    return rock_inputs(item, (*shape, *jointed_rock(i)), printed, METHODS)


def _planar(planar: PlanarSlope, printed: dict) -> list[Row]:
    paper = printed["planar_slope"]
    exact = planar.closed_form()
    gamma = printed["plane_failure"]["unit_weight_n_per_m3"]["value"]
    closed = paper["factor_of_safety_closed_form"]["value"]
    rows = [
        Row("Example 3.3", "factor of safety, closed form, unit weight of Table 2", "-", closed, exact),
        Row("Example 3.3", "factor of safety, closed form, unit weight of Table 1", "-", closed, planar.closed_form(gamma)),
    ]
    for model, name in MODEL_NAMES.items():
        reference = exact if model == "wedge" else planar.cut[model].limit()
        ours = known({m: planar.factor_of_safety(model, m) for m in METHODS})
        blocks = paper["blocks"]["value"] if model != "wedge" else None
        rows.append(Row("Example 3.3", f"blocks, {name}", "-", blocks, None, {m: len(planar.cut[model].blocks) for m in METHODS}))
        rows.append(Row("Example 3.3", f"factor of safety, {name}", "-", paper[f"factor_of_safety_{PRINTED_OF_MODEL[model]}"]["value"], reference,
                        ours, relative(ours, reference)))
    return rows


def _of_methods(printed: dict, key: str) -> str:
    return ", ".join(f"{printed[m]['name']} {printed[m][key]:g}" for m in ("dem", "soft", "shi"))


def _factors(jointed: JointedSlope, printed: dict) -> list[Row]:
    rows = [
        Row("Table 4", "blocks", "-", _of_methods(printed, "blocks"), None, {m: len(jointed.cut.blocks) for m in METHODS}),
        Row("Table 4", "unknowns, fixed blocks counted", "-", _of_methods(printed, "unknowns"), None, {m: jointed.unknowns for m in METHODS}),
    ]
    for behaviour in BEHAVIOURS:
        limit = jointed.limit(behaviour)
        ours = known({m: jointed.factor_of_safety(m, behaviour) for m in METHODS})
        rows.append(Row("Table 4", f"factor of safety, cohesion {behaviour}", "-", _of_methods(printed, "factor_of_safety"), limit, ours,
                        relative(ours, limit)))
    tight = jointed.tight_factor_of_safety().value
    name = f"the same, ductile, bracket {slopes.TIGHT_WIDTH:g}, failed beyond {slopes.TIGHT_FAILURE_DISPLACEMENT_M:g} m"
    rows.append(Row("Table 4", name, "-", None, jointed.limit("ductile"), {"soft": tight} if tight else {}))
    return rows


def _run_times(jointed: JointedSlope, printed: dict) -> list[Row]:
    steady = {m: s for m in METHODS if (s := jointed.steady_cpu(m)) is not None}
    rows = [Row("Table 4", "CPU time to the steady state", "s", _minutes(printed, "steady_minutes"), None, steady)]
    for start, name in slopes.STARTS.items():
        for distance in printed["milestones_m"]["value"]:
            rows.append(Row("Table 4", f"CPU time to {distance} m, {name}", "s", None, None, cpu_at(jointed, start, distance)))
    rows.append(Row("Table 4", "CPU time to the steady state over dem's", "-", ratio_text(printed, steady_ratio), None, over_dem(steady)))
    by_rule = over_dem(paper_steady(jointed))
    rows.append(Row("Table 4", "the same by the paper's rule and step", "-", ratio_text(printed, steady_ratio), None, by_rule))
    for start, name in slopes.STARTS.items():
        theirs, ratios = ratio_text(printed, post_failure_ratio), over_dem(mean_cpu(jointed, printed, start))
        rows.append(Row("Table 4", f"CPU time after failure over dem's, mean of the distances, {name}", "-", theirs, None, ratios))
        rows.append(Row("Table 4", "the same with the paper's step", "-", theirs, None, by_method(ratios, ("dem", slopes.PAPER_STEP, "shi"))))
    return rows


def by_method(values: Values, followers: tuple[str, ...]) -> Values:
    """The values of these runs under the names of their methods."""
    return {slopes.FOLLOWERS[f].method: values[f] for f in followers if f in values}


def paper_steady(jointed: JointedSlope) -> Values:
    """[s] CPU time to the paper's steady state"""
    return {m: found[0] for m in slopes.RULE_METHODS if (found := jointed.paper_steady(m)) is not None}


def cpu_at(jointed: JointedSlope, start: str, distance: float) -> Values:
    """[s] of the runs that came so far"""
    return {f: c for f in slopes.FOLLOWERS if (c := jointed.cpu_at(f, start, distance)) is not None}


def _minutes(printed: dict, key: str) -> str:
    return ", ".join(f"{printed[m]['name']} {printed[m][key]:g} min" for m in ("dem", "soft", "shi"))


def steady_ratio(printed: dict, method: str) -> float:
    return printed[method]["steady_minutes"] / printed["dem"]["steady_minutes"]


def post_failure_ratio(printed: dict, method: str) -> float:
    """Of the sums over the distances, which is that of the means."""
    return sum(printed[method]["post_failure_minutes"]) / sum(printed["dem"]["post_failure_minutes"])


def ratio_text(printed: dict, ratio) -> str:
    return ", ".join(f"{printed[m]['name']} {ratio(printed, m):.3g}" for m in ("dem", "soft", "shi"))


def mean_cpu(jointed: JointedSlope, printed: dict, start: str) -> Values:
    """[s] mean over the paper's distances, of the runs that came to all of them"""
    distances = printed["milestones_m"]["value"]
    times = {f: [jointed.cpu_at(f, start, d) for d in distances] for f in slopes.FOLLOWERS}
    return {m: sum(t) / len(t) for m, t in times.items() if None not in t}


def over_dem(cpu: Values) -> Values:
    return {m: c / cpu["dem"] for m, c in cpu.items()} if cpu.get("dem") else {}


def _energy(jointed: JointedSlope) -> list[Row]:
    rows = []
    for start, name in slopes.STARTS.items():
        summaries = {m: jointed.summary(m, start) for m in METHODS}
        finished = {m: s for m, s in summaries.items() if "energy_ledger" in s}
        rows.append(Row("After failure", f"energy imbalance over turnover, {name}", "-", None, 0.0, {m: imbalance(s) for m, s in finished.items()}))
        rows.append(Row("After failure", f"deepest penetration, {name}", "m", None, None, {m: s["max_penetration_m"] for m, s in finished.items()}))
    return rows


def imbalance(summary: dict) -> float:
    ledger = summary["energy_ledger"]
    return abs(ledger["imbalance_j"]) / ledger["turnover_j"]
