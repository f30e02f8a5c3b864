"""The fields of report_template.md for examples 3.3 and 3.4. Every number comes from the runs, the references or printed.toml."""

import comparison_slopes
from comparison import Row
from comparison_slopes import MODEL_NAMES, PRINTED_OF_MODEL
from openclose_scripts.examples import slopes
from openclose_scripts.examples.slopes import BEHAVIOURS, METHODS, Fos, JointedSlope, PlanarSlope
from openclose_scripts.formats import significant
from openclose_scripts.markdown import number_table

_PRINTED_NAMES = {"closed_form": "closed form", "dda_sc": "DDA-SC", "udec": "UDEC"}
_PAPER_METHODS = ("dem", "soft", "shi")


def fields(planar: PlanarSlope, jointed: JointedSlope, rows: list[Row], printed: dict) -> dict[str, str]:
    return {
        "table_2": _inputs("Table 2", rows),
        "table_3": _inputs("Table 3", rows),
        **_planar_fields(planar, printed),
        **_jointed_fields(jointed, printed),
        **_after_failure_fields(jointed, printed),
    }


def _inputs(item: str, rows: list[Row]) -> str:
    lines = ((f"{r.quantity} [{r.unit}]", significant(r.paper, 6), significant(r.ours["soft"], 6)) for r in rows if r.item == item)
    return number_table(("input", "paper", "ours"), lines)


def _fos_cell(fos: Fos, digits: int = 4) -> str:
    if fos.value is None:
        return f"none: {fos.reason}"
    return f"{fos.value:.{digits}f}{' (1)' if fos.warning else ''}"


def _planar_fields(planar: PlanarSlope, printed: dict) -> dict[str, str]:
    paper = printed["planar_slope"]
    lines = []
    for model, name in MODEL_NAMES.items():
        cut, key = planar.cut[model], PRINTED_OF_MODEL[model]
        value = paper[f"factor_of_safety_{key}"]["value"]
        lines.append((f"{name}; wall {planar.back_wall(model):.0f} m behind the crest", str(len(cut.blocks)), f"{_PRINTED_NAMES[key]} {value:g}",
                      f"{planar.closed_form():.4f}" if model == "wedge" else "", f"{cut.limit():.4f}",
                      *(_fos_cell(planar.factor_of_safety(model, m)) for m in METHODS)))
    other_weight = printed["plane_failure"]["unit_weight_n_per_m3"]["value"]
    return {
        "planar_table": number_table(("model", "blocks", "explains the paper's", "closed form", "limit analysis", *METHODS), lines),
        "planar_blocks": str(paper["blocks"]["value"]),
        "planar_printed": significant(paper["factor_of_safety_closed_form"]["value"], 5),
        "planar_closed": f"{planar.closed_form():.5f}",
        "planar_other_weight": significant(other_weight / 1e6, 4),
        "planar_weight": significant(planar.inputs.unit_weight / 1e6, 4),
        "planar_closed_other": f"{planar.closed_form(other_weight):.4f}",
        "planar_udec": significant(paper["factor_of_safety_udec"]["value"], 4),
        "planar_dda_sc": significant(paper["factor_of_safety_dda_sc"]["value"], 4),
        "planar_toe_limit": f"{planar.cut['toe'].limit():.4f}",
        "planar_shifted_limit": f"{planar.cut['shifted'].limit():.4f}",
        "planar_toe_wall": f"{planar.back_wall('toe'):.0f}",
        "planar_shifted_wall": f"{planar.back_wall('shifted'):.0f}",
    }


def _jointed_fields(jointed: JointedSlope, printed: dict) -> dict[str, str]:
    lines = [(b.replace("_", " "), f"{jointed.limit(b):.3f}", *(_fos_cell(jointed.factor_of_safety(m, b), 3) for m in METHODS)) for b in BEHAVIOURS]
    paper = printed["table_4"]
    warned = {m: w for m in METHODS for b in BEHAVIOURS if (w := jointed.factor_of_safety(m, b).warning)}
    tight, ours = jointed.tight_factor_of_safety(), jointed.factor_of_safety("soft", "ductile")
    return {
        "jointed_table": number_table(("cohesion", "limit analysis", *METHODS), lines),
        "jointed_notes": "\n".join(f"(1) {method}: {warning}." for method, warning in warned.items()),
        "jointed_blocks": str(len(jointed.cut.blocks)),
        "jointed_unknowns": str(jointed.unknowns),
        **{f"jointed_{side}": f"{length:.0f}" for side, length in zip(("bench", "below", "top"), jointed.size())},
        "opening_kept": _fos_cell(jointed.factor_of_safety("dem", "lost_on_opening"), 3),
        "opening_broken": _fos_cell(jointed.breaking_factor_of_safety(), 3),
        "shi_settle_steps": str(slopes.SHI_SETTLE_STEPS),
        "jointed_dem": significant(paper["dem"]["factor_of_safety"], 4),
        "jointed_soft": significant(paper["soft"]["factor_of_safety"], 4),
        "jointed_shi": significant(paper["shi"]["factor_of_safety"], 4),
        "jointed_limit": f"{jointed.limit('ductile'):.3f}",
        "jointed_limit_frictional": f"{jointed.limit('lost_on_slip'):.3f}",
        "rules_table": _rules(jointed, printed),
        **{f"rules_steps_{m}": _steps_to_paper_steady(jointed, m) for m in slopes.RULE_METHODS},
        "rules_length": significant(printed["jointed_slope"]["relative_max_displacement_m"]["value"] * 1e3, 4),
        "rules_velocity": significant(jointed.rules_velocity(), 2),
        "rules_upper": significant(slopes.PAPER_RULES_UPPER_LIMIT, 4),
        "rules_width": significant(slopes.PAPER_RULES_WIDTH, 4),
        "rules_displacement": significant(printed["jointed_slope"]["relative_max_displacement_m"]["value"], 4),
        "rules_force": significant(printed["jointed_slope"]["unbalanced_force_limit_n"]["value"] / 1e3, 4),
        "rules_steps": significant(printed["jointed_slope"]["unbalanced_force_steps"]["value"], 6),
        "jointed_width": significant(jointed.inputs.width, 4),
        "jointed_failure": significant(jointed.inputs.failure_displacement, 4),
        "jointed_tight_width": significant(slopes.TIGHT_WIDTH, 4),
        "jointed_tight_failure": significant(slopes.TIGHT_FAILURE_DISPLACEMENT_M, 4),
        "jointed_tight": _fos_cell(tight),
        "jointed_short": _fos_cell(ours),
    }


def _rules(jointed: JointedSlope, printed: dict) -> str:
    """Factors of safety by the paper's own rules."""
    meanings = {"relative": "relative displacement as printed", "length": "displacement read as a length", "force": "unbalanced force"}
    paper = printed["table_4"]
    lines = [(f"{method}: {meanings[reading]}", _bracket_cell(jointed.paper_factor_of_safety(method, reading)),
              f"{paper[method]['name']} {paper[method]['factor_of_safety']:g}") for method, reading in slopes.PAPER_RULES]
    return number_table(("rule", "ours: stable, failed", "paper"), lines)


def _bracket_cell(fos: Fos) -> str:
    return _fos_cell(fos) if fos.value is None else f"{fos.value:.3f}, {fos.failed:.3f}"


def _steps_to_paper_steady(jointed: JointedSlope, method: str) -> str:
    found = jointed.paper_steady(method)
    return str(found[1]) if found else "too many"


def _after_failure_fields(jointed: JointedSlope, printed: dict) -> dict[str, str]:
    inputs, paper = jointed.post_failure_inputs, printed["table_4"]
    law = jointed.factor_of_safety("soft", "lost_on_slip").value
    after = comparison_slopes.over_dem(comparison_slopes.mean_cpu(jointed, paper, "settled"))
    steady = comparison_slopes.over_dem(comparison_slopes.paper_steady(jointed))
    return {
        "ratio_steady_paper": _proportion([comparison_slopes.steady_ratio(paper, m) for m in _PAPER_METHODS]),
        "ratio_after_paper": _proportion([comparison_slopes.post_failure_ratio(paper, m) for m in _PAPER_METHODS]),
        "ratio_steady_ours": _proportion([steady.get(m) for m in _PAPER_METHODS]),
        "ratio_after_ours": _proportion([after.get(f) for f in ("dem", slopes.PAPER_STEP, "shi")]),
        "ratio_after_soft": significant(after["soft"], 2) if "soft" in after else "more than all",
        "after_soft_dt": significant(slopes.FOLLOWERS["soft"].dt, 4),
        "after_srf": significant(inputs.strength_reduction_factor, 4),
        "after_law": significant(law, 4),
        "after_ratio": significant(inputs.strength_reduction_factor / law, 3),
        "after_damping": significant(inputs.damping_ratio, 4),
        "after_steps": ", ".join(f"`{run.method}` {significant(run.dt, 4)} s" for run in slopes.FOLLOWERS.values() if run.method != "dem"),
        "after_critical": f"{significant(jointed.critical_step() * 1e3, 3)} ms" if jointed.critical_step() else "not reached",
        "paper_dda_dt": significant(printed["jointed_slope"]["dt_s"]["value"], 4),
        "paper_udec_dt": significant(printed["jointed_slope"]["udec_dt_s"]["value"], 4),
        "after_table": _table_4(jointed, paper),
        "after_ratios": _ratios(jointed, paper),
        "after_energy": _energy(jointed),
        "after_limit": str(slopes.POST_FAILURE_CPU_LIMIT_S),
        "mechanism": _mechanism_text(jointed),
    }


def _proportion(values: list[float | None]) -> str:
    return " : ".join("-" if v is None else significant(v, 3) for v in values)


def _seconds(value: float | None, missing: str = "not reached") -> str:
    return missing if value is None else f"{significant(value, 3)} s"


def _table_4(jointed: JointedSlope, paper: dict) -> str:
    def line(name: str, ours, theirs) -> list[str]:
        return [name, *(ours(f) for f in slopes.FOLLOWERS), *(theirs(paper[m]) for m in _PAPER_METHODS)]

    def of_method(value, other: str = "as soft"):
        """A cell that does not depend on the step after failure."""
        return lambda follower: value(follower) if follower in METHODS else other

    lines = [
        line("blocks", lambda f: str(len(jointed.cut.blocks)), lambda p: str(p["blocks"])),
        line("degrees of freedom", lambda f: str(jointed.unknowns), lambda p: str(p["unknowns"])),
        line("mechanism", lambda f: _mechanism(jointed, f), lambda p: p["mechanism"]),
        *(line(f"factor of safety, cohesion {b.replace('_', ' ')}", of_method(lambda m, b=b: _fos_cell(jointed.factor_of_safety(m, b), 3)),
               lambda p: f"{p['factor_of_safety']:g}") for b in BEHAVIOURS),
        line("CPU to the steady state", of_method(lambda m: _seconds(jointed.steady_cpu(m))), lambda p: f"{p['steady_minutes']:g} min"),
        line("the same by the paper's rule and step", lambda f: _paper_steady(jointed, f), lambda p: f"{p['steady_minutes']:g} min"),
    ]
    for start, name in slopes.STARTS.items():
        for k, distance in enumerate(paper["milestones_m"]["value"]):
            lines.append(line(f"CPU to {distance} m, {name}", lambda f, s=start, d=distance: _seconds(jointed.cpu_at(f, s, d)),
                              lambda p, k=k: f"{p['post_failure_minutes'][k]:g} min"))
        if any(jointed.reason(f, start) for f in slopes.FOLLOWERS):
            lines.append(line(f"why not all, {name}", lambda f, s=start: jointed.reason(f, s), lambda p: ""))
    headings = ("", *(run.name for run in slopes.FOLLOWERS.values()), *(f"paper: {paper[m]['name']}" for m in _PAPER_METHODS))
    return number_table(headings, lines)


def _paper_steady(jointed: JointedSlope, follower: str) -> str:
    """Only runs with the paper's step have it."""
    run = slopes.FOLLOWERS[follower]
    if follower not in (slopes.PAPER_STEP, "dem", "shi"):
        return ""
    found = jointed.paper_steady(run.method)
    return f"{_seconds(found[0])}, {found[1]} steps" if found else "not reached"


def _mechanism(jointed: JointedSlope, method: str) -> str:
    """The farthest way and the largest turn of a block in the last state."""
    state = "final"
    if not jointed.blocks(method, "settled", state):
        return jointed.reason(method, "settled")
    motions = jointed.motions(method, "settled", state).values()
    return f"sliding by up to {max(m.distance for m in motions):.0f} m, rotation by up to {max(abs(m.rotation_deg) for m in motions):.0f} deg"


def _mechanism_text(jointed: JointedSlope) -> str:
    """Of `soft`: turn of the layer of blocks at the toe and of those above."""
    motions = jointed.motions("soft", "settled", "final").values()
    layer = jointed.inputs.spacings[0]
    moving = [m for m in motions if m.distance > slopes.MOVED_M]
    toe = [abs(m.rotation_deg) for m in moving if 0 < m.start[1] < layer]
    above = sorted(abs(m.rotation_deg) for m in moving if m.start[1] > layer)
    if not toe or not above:
        return "no block moved"
    return (f"the {len(toe)} moving blocks of the layer at the toe turn by up to {max(toe):.0f} deg; of the {len(above)} above, which slide, "
            f"half turn by less than {above[len(above) // 2]:.1f} deg")


def _ratios(jointed: JointedSlope, paper: dict) -> str:
    def cells(ours: dict[str, float], theirs) -> list[str]:
        return [*(f"{ours[f]:.3g}" if f in ours else "-" for f in slopes.FOLLOWERS), *(f"{theirs(paper, m):.3g}" for m in _PAPER_METHODS)]

    steady = {m: s for m in METHODS if (s := jointed.steady_cpu(m)) is not None}
    by_rule = comparison_slopes.over_dem(comparison_slopes.paper_steady(jointed))
    if "soft" in by_rule:
        by_rule[slopes.PAPER_STEP] = by_rule.pop("soft")
    lines = [
        ["steady state", *cells(comparison_slopes.over_dem(steady), comparison_slopes.steady_ratio)],
        ["steady state, the paper's rule and step", *cells(by_rule, comparison_slopes.steady_ratio)],
    ]
    for start, name in slopes.STARTS.items():
        after = comparison_slopes.over_dem(comparison_slopes.mean_cpu(jointed, paper, start))
        lines.append([f"after failure, mean of the distances, {name}", *cells(after, comparison_slopes.post_failure_ratio)])
        common = jointed.common_distance(start)
        if common is not None and common < max(paper["milestones_m"]["value"]):
            ours = comparison_slopes.over_dem(comparison_slopes.cpu_at(jointed, start, common))
            lines.append([f"after failure, at {common:g} m, {name}", *(f"{ours[f]:.3g}" if f in ours else "-" for f in slopes.FOLLOWERS), "", "", ""])
    names = (run.name for run in slopes.FOLLOWERS.values())
    headings = ("CPU time over dem's, over UDEC's", *names, *(f"paper: {paper[m]['name']}" for m in _PAPER_METHODS))
    return number_table(headings, lines)


def _energy(jointed: JointedSlope) -> str:
    lines = []
    for follower, run in slopes.FOLLOWERS.items():
        for start in slopes.STARTS:
            summary = jointed.summary(follower, start)
            if "energy_ledger" not in summary:
                lines.append([f"{run.name}, {start}", summary["reason"], "", "", ""])
                continue
            lines.append([f"{run.name}, {start}", f"{summary['time_s']:.3g} s", f"{summary['energy_ledger']['turnover_j']:.3g}",
                          f"{comparison_slopes.imbalance(summary):.1e}", f"{summary['max_penetration_m'] * 1e3:.3g}"])
    return number_table(("run", "motion lasted", "energy turned over [J]", "imbalance over it [-]", "deepest penetration [mm]"), lines)
