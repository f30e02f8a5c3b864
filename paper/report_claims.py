"""The claims in words and rows: what the paper says, what was measured, the verdict. Every number comes from the runs or printed.toml."""

from pathlib import Path

import claims
from claims import Claims, Cost
from comparison import Row
from openclose_scripts.examples import incline
from openclose_scripts.fits import exponent
from openclose_scripts.formats import significant
from openclose_scripts.markdown import number_table

_TEMPLATE = Path(__file__).parent / "report_claims_template.md"


def text(tested: Claims, printed: dict) -> str:
    """The chapter of the report."""
    parts = (_tolerances, _penalties, _hard_contact, _multipliers)
    fields = {key: value for part in parts for key, value in part(tested).items()}
    return _TEMPLATE.read_text(encoding="utf-8").format(**fields, **_sizes(tested, printed), **_explicit(tested, printed))


def rows(tested: Claims, printed: dict) -> list[Row]:
    return [*_size_rows(tested), *_tolerance_rows(tested), *_penalty_rows(tested), *_multiplier_rows(tested), *_explicit_rows(tested, printed)]


def _verdict(holds: bool, but: str = "") -> str:
    return ("**Holds**" if holds else "**Does not hold**") + (f", {but}" if but else "")


def _growth(costs: list[Cost]) -> float:
    return exponent([c.blocks for c in costs], [c.solves for c in costs])


def _sizes(tested: Claims, printed: dict) -> dict[str, str]:
    shi, soft = tested.sizes("shi"), tested.sizes("soft")
    table = ([f"{a.blocks}", f"{a.free}", *map(significant, (a.solves, a.cuts, a.cpu, b.solves, b.cpu))] for a, b in zip(shi, soft))
    grows, soft_grows = _growth(shi), _growth(soft)
    bound = printed["blocks_of_rise"]["value"]
    largest_below = max(c.blocks for c in shi if c.blocks <= bound)
    below, above = _growth([c for c in shi if c.blocks <= largest_below]), _growth([c for c in shi if c.blocks >= largest_below])
    ratios = [a.solves / b.solves for a, b in zip(shi, soft)]
    sharp = (f"the rise {'is' if above > below else 'is not'} steeper above {bound} blocks (^{significant(below, 2)} up to {largest_below}, "
             f"^{significant(above, 2)} beyond)")
    return {
        "size_table": number_table(("blocks", "free", "shi: solves", "shi: cuts", "shi: CPU [s]", "soft: solves", "soft: CPU [s]"), table),
        "size_exponent": significant(grows, 2),
        "size_exponent_soft": significant(soft_grows, 2),
        "time_exponent": significant(exponent([c.blocks for c in shi], [c.cpu for c in shi]), 2),
        "time_exponent_soft": significant(exponent([c.blocks for c in soft], [c.cpu for c in soft]), 2),
        "size_ratio": f"{significant(min(ratios), 2)} to {significant(max(ratios), 2)}",
        "verdict_1": _verdict(grows > 0.1, f"with a condition: the iterations of `shi` grow as blocks^{significant(grows, 2)}, those of `soft` as "
                              f"blocks^{significant(soft_grows, 2)}, and {sharp}"),
    }


def _size_rows(tested: Claims) -> list[Row]:
    found = []
    for factor in claims.FACTORS:
        costs = {m: tested.size(m, factor) for m in ("soft", "shi")}
        name = f"{costs['shi'].blocks} blocks"
        found.append(Row("Claim 1", f"{name}: linear solves per step", "-", ours={m: c.solves for m, c in costs.items()}))
        found.append(Row("Claim 1", f"{name}: CPU per step", "s", ours={m: c.cpu for m, c in costs.items()}))
    found.append(Row("Claim 1", "exponent of the solves in the blocks", "-", ours={m: _growth(tested.sizes(m)) for m in ("soft", "shi")}))
    return found


def _tolerances(tested: Claims) -> dict[str, str]:
    depths = claims.PENETRATION_TOLERANCES_M
    slope = {v: tested.slope_penetration(v) for v in depths}
    slide = {v: tested.incline_penetration(v) for v in depths}
    closing = {v: tested.incline_closing(v) for v in claims.CLOSING_TOLERANCES_M}
    zero = tested.slope_closing(0.0)
    stuck, fine = [v for v in depths if not slope[v].finished], [v for v in depths if slope[v].finished]
    wrong = [v for v in closing if abs(closing[v].displacement_error) > 0.01]
    table = ([f"{v:g}", _reached(slope[v]), significant(slope[v].solves), "yes" if slide[v].finished else "no"] for v in depths)
    closing_table = ([f"{v:g}", _reached(c := tested.slope_closing(v)), significant(c.solves), f"{100 * closing[v].displacement_error:+.2f} %",
                      f"{100 * closing[v].force_error:+.2f} %"] for v in closing)
    small = bool(stuck) and bool(fine) and max(stuck) < min(fine)
    return {
        "penetration_table": number_table(("tolerance [m]", "3.4: part of the time reached", "3.4: solves per step", "3.1 finished"), table),
        "closing_table": number_table(("tolerance [m]", "3.4: part of the time reached", "3.4: solves per step", "3.1: displacement",
                                          "3.1: normal forces"), closing_table),
        "coarse_blocks": str(slope[depths[-1]].blocks),
        "deepest": significant(slope[depths[-1]].penetration),
        "verdict_2a": _verdict(small, f"up to {max(stuck):g} m the run gets stuck, from {min(fine):g} m on the tolerance does not act" if small else ""),
        "verdict_2b": _verdict(bool(wrong), f"of the closing tolerance: from {min(wrong):g} m on the displacement is off by more than 1 %"
                               if wrong else ""),
        "zero_closing": "does not get to the end" if not zero.finished else "gets to the end",
    }


def _reached(cost: Cost) -> str:
    return f"{100 * cost.reached:.0f} %"


def _tolerance_rows(tested: Claims) -> list[Row]:
    found = []
    for v in claims.PENETRATION_TOLERANCES_M:
        cost = tested.slope_penetration(v)
        found.append(Row("Claim 2", f"part of the time reached, penetration tolerance {v:g} m", "-", ours={"shi": cost.reached}))
    for v in claims.CLOSING_TOLERANCES_M:
        slide = tested.incline_closing(v)
        found.append(Row("Claim 2", f"error of the displacement, closing tolerance {v:g} m", "-", None, 0.0, {"shi": slide.displacement_error}))
        found.append(Row("Claim 2", f"error of the normal forces, closing tolerance {v:g} m", "-", None, 0.0, {"shi": slide.force_error}))
    return found


def _penalties(tested: Claims) -> dict[str, str]:
    penalties = claims.SLOPE_PENALTIES
    spectra, costs = {p: tested.spectrum(p) for p in penalties}, {p: tested.slope_penalty(p) for p in penalties}
    slides = {p: tested.incline_penalty(p) for p in claims.INCLINE_PENALTIES}
    table = ([f"{p:.0e}", significant(spectra[p].condition), significant(spectra[p].detached), _reached(costs[p]),
              *map(significant, (costs[p].solves, 1e3 * costs[p].cpu, 1e3 * costs[p].penetration))] for p in penalties)
    result = ([f"{p:.0e}", f"{100 * slides[p].displacement_error:+.4f} %"] for p in claims.INCLINE_PENALTIES)
    low, high = penalties[0], penalties[-1]
    off = [p for p in slides if abs(slides[p].displacement_error) > 0.01]
    dearer = costs[high].solves / costs[low].solves
    return {
        "penalty_table": number_table(("penalty [Pa/m]", "condition, all stick", "condition, one unknown free", "reached", "solves per step",
                                          "CPU per step [ms]", "penetration [mm]"), table),
        "penalty_result_table": number_table(("penalty [Pa/m]", "3.1: error of the displacement"), result),
        "condition_limit": significant(spectra[high].condition, 4),
        "condition_free": significant(spectra[high].detached, 2),
        "dearer": significant(dearer, 2),
        "verdict_3": _verdict(dearer > 2, f"with another reason: between {low:.0e} and {high:.0e} Pa/m a step takes "
                              f"{significant(dearer, 2)} times the solves"
                              + (f", while up to {max(off):.0e} Pa/m the penalty makes an error beyond 1 %" if off else "")),
    }


def _penalty_rows(tested: Claims) -> list[Row]:
    found = []
    for p in claims.SLOPE_PENALTIES:
        spectrum, cost = tested.spectrum(p), tested.slope_penalty(p)
        found.append(Row("Claim 3", f"condition number, penalty {p:.0e} Pa/m", "-", ours={"shi": spectrum.condition}))
        found.append(Row("Claim 3", f"linear solves per step, penalty {p:.0e} Pa/m", "-", ours={"shi": cost.solves}))
    for p in claims.INCLINE_PENALTIES:
        found.append(Row("Claim 3", f"error of the displacement, penalty {p:.0e} Pa/m", "-", None, 0.0,
                         {"shi": tested.incline_penalty(p).displacement_error}))
    return found


def _hard_contact(tested: Claims) -> dict[str, str]:
    def largest(method: str, start: str) -> float:
        return max(abs(e) for e in tested.incline_errors(method, start))

    methods = ("soft", "shi", incline.SHI_JOINT, "hard")
    found = {s: {m: largest(m, s) for m in methods} for s in ("unloaded", "normal_balanced")}
    more = [incline.STARTS[s] for s in found if found[s]["shi"] > found[s]["soft"]]
    exact = all(errors["hard"] < 0.01 * errors["soft"] for errors in found.values())
    but = f"with a condition: `shi` deviates more from start {' and '.join(more)} only" if 0 < len(more) < len(found) else ""
    but += "; `hard`, which does forbid penetration, is exact from both, so that it is not hard contact that deviates" if exact else ""
    table = ([f"{incline.STARTS[s]} {s}", *(f"{found[s][m]:.2g} %" for m in methods)] for s in found)
    return {
        "hard_contact_table": number_table(("start", "soft", "shi, own penalty", "shi, joint's springs", "hard"), table),
        "verdict_4": _verdict(bool(more), but),
    }


def _multipliers(tested: Claims) -> dict[str, str]:
    found = {m: tested.solves(m) for m in claims.METHODS}
    names = list(found["soft"])
    both = [n for n in names if n in found["hard"]]
    more = [n for n in both if found["hard"][n] > found["soft"][n]]
    ratio = [found["hard"][n] / found["soft"][n] for n in both]
    lost = [n for n in names if n not in found["hard"]]
    table = ([n, *(significant(found[m][n]) if n in found[m] else f"not in {claims.HARD_LIMIT_S} s" for m in claims.METHODS)] for n in names)
    but = f"`hard` takes {significant(min(ratio), 2)} to {significant(max(ratio), 2)} times the solves of `soft`, more in {len(more)} of {len(both)} examples"
    but += f"; {', '.join(lost)}: it does not get to the end" if lost else ""
    return {
        "multiplier_table": number_table(("example", *claims.METHODS), table),
        "verdict_5": _verdict(bool(more), ("with a condition: " if len(more) < len(both) else "") + but),
    }


def _multiplier_rows(tested: Claims) -> list[Row]:
    found = {m: tested.solves(m) for m in claims.METHODS}
    return [Row("Claim 5", f"linear solves per step, {n}", "-", ours={m: v[n] for m, v in found.items() if n in v}) for n in found["soft"]]


def _explicit(tested: Claims, printed: dict) -> dict[str, str]:
    found = {s: tested.explicit(s) for s in claims.EXPLICIT_SCENES}
    two, three = (printed[f"explicit_step_table_{t}_s"]["value"] for t in (2, 3))
    stiffer = printed["stiffness_table_3_pa_per_m"]["value"] / printed["stiffness_table_2_pa_per_m"]["value"]
    slope, planar = found["example_3_4"], found["example_3_3_shifted"]
    table = ([s, *(f"{1e3 * v:.3f}" for v in (e.exact, e.bound, e.two_body, claims.UDEC_FRACTION * e.two_body)), significant(e.smallest_area, 4)]
             for s, e in found.items())
    return {
        "explicit_table": number_table(("scene", "2/w_max [ms]", "bound of dem [ms]", "two-body [ms]", "a tenth of it [ms]", "smallest block [m2]"),
                                          table),
        "printed_2": f"{1e3 * two:g}",
        "printed_3": f"{1e3 * three:g}",
        "mass_ratio": significant((three / two) ** 2 * stiffer),
        "our_mass_ratio": significant(slope.smallest_area / planar.smallest_area),
        "tenth_off": f"{100 * (claims.UDEC_FRACTION * planar.two_body / two - 1):+.1f} %",
        "swap_off": f"{100 * (slope.exact / two - 1):+.1f} %",
        "above": significant(three / slope.exact, 2),
        "misprint_off": f"{100 * (three / 10 / slope.exact - 1):+.0f} %",
        "verdict_6": _verdict(three < slope.exact and two < planar.exact,
                              f"Table 2's step is {'stable' if two < planar.exact else 'unstable'} in our model "
                              f"({significant(two / planar.exact, 2)} of 2/w_max), Table 3's {'stable' if three < slope.exact else 'unstable'} "
                              f"({significant(three / slope.exact, 2)} times 2/w_max)"),
    }


def _explicit_rows(tested: Claims, printed: dict) -> list[Row]:
    found = []
    for scene in claims.EXPLICIT_SCENES:
        e = tested.explicit(scene)
        paper = printed[f"explicit_step_table_{3 if scene == 'example_3_4' else 2}_s"]["value"]
        found.append(Row("Claim 6", f"{scene}: explicit step; reference: 2/w_max", "s", paper, e.exact, {"dem": e.bound}, {"dem": e.bound / e.exact - 1}))
    return found
