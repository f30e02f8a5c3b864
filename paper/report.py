"""Fills report_template.md. Every number comes from the runs, the reference or printed.toml."""

from pathlib import Path

import comparison
import tables
from openclose_scripts.examples import incline
from openclose_scripts.examples.incline import Incline, Study
from openclose_scripts.examples.plane_failure import BRITTLE, METHODS, PlaneFailure, Point
from openclose_scripts.formats import significant
from openclose_scripts.markdown import number_table

_TEMPLATE = Path(__file__).parent / "report_template.md"
_MM = 1e-3


def write(slider: Incline, wedge: PlaneFailure, rows: list[comparison.Row], printed: dict, more: dict[str, str], folder: Path) -> None:
    """Writes report.md and table1.md; `more` are fields of the template that others fill."""
    table_1 = _table_1(rows)
    fields = {
        **_incline_fields(slider, printed["incline"]),
        **_balanced_fields(slider, printed["incline"]),
        **_unloaded_fields(slider),
        **_convergence_fields(slider),
        **_plane_failure_fields(wedge, printed["plane_failure"]),
        **_curve_fields(wedge, printed["plane_failure"]),
        **more,
        "table_1": table_1,
        "note": tables.NOTE.replace("\n", " "),
        "comparison_table": tables.comparison_markdown(comparison.as_text(rows)),
    }
    (folder / "table1.md").write_text(f"# Table 1: the paper's input and ours\n\n{table_1}\n", encoding="utf-8")
    (folder / "report.md").write_text(_TEMPLATE.read_text(encoding="utf-8").format(**fields), encoding="utf-8")


def _mm(length: float, digits: int = 4) -> str:
    return significant(length / _MM, digits)


def _incline_fields(slider: Incline, printed: dict) -> dict[str, str]:
    i = slider.inputs
    return {
        "density": significant(i.density, 4),
        "end": significant(i.end_time, 4),
        "angles": ", ".join(str(a) for a in incline.ANGLES_DEG),
        "angle_count": str(len(incline.ANGLES_DEG)),
        "phi": str(incline.MAIN_ANGLE_DEG),
        "sticking_phi": str(incline.STICKING_ANGLE_DEG),
        "earliest": significant(incline.EARLIEST_S, 4),
        "fig4_dt": significant(incline.FIG4_STEP_S, 4),
        "steady_table": _steady_table(slider),
        "shi_penetration_mm": _mm(slider.deepest_shi_penetration(), 3),
        "claim_soft": significant(printed["largest_error_dda_sc_percent"]["value"], 4),
        "claim_shi": significant(printed["largest_error_dda_shi_percent"]["value"], 4),
        **{f"time_{k}": significant(time, 4) for k, time in enumerate(incline.TIMES_S)},
    }


def _steady_table(slider: Incline) -> str:
    def cells(dt: float) -> list[str]:
        return [f"{max(slider.largest_steady_error(m, a, dt) for a in incline.ANGLES_DEG):.1e}" for m in incline.METHODS]

    return number_table(("dt [s]", *incline.METHODS), ([f"{dt:g}", *cells(dt)] for dt in incline.STEADY_STEPS_S))


def _residual(slider: Incline, displacement: dict[float, float], time: float) -> float:
    """[m] beyond eq. (8) at the main angle"""
    return displacement[time] - slider.closed_form(incline.MAIN_ANGLE_DEG)[time]


def _percent(slider: Incline, method: str, start: str, angle: int, time: float) -> float:
    """[%] beyond eq. (8)"""
    return 100 * (slider.from_start(method, start, angle)[time] / slider.closed_form(angle)[time] - 1)


def _balanced_fields(slider: Incline, printed: dict) -> dict[str, str]:
    start, phi = "normal_balanced", incline.MAIN_ANGLE_DEG
    _, early, middle, end = incline.TIMES_S
    ode, locked = slider.ode(start, phi), slider.ode(start, phi, rotation_locked=True)
    quarter, joint = (_residual(slider, slider.from_start(m, start, phi), end) for m in (incline.SHI_SOFT_SHEAR, incline.SHI_JOINT))
    claim = printed["largest_error_dda_sc_percent"]["value"]
    return {
        "rate_first": _mm((_residual(slider, ode, middle) - _residual(slider, ode, early)) / (middle - early)),
        "rate_second": _mm((_residual(slider, ode, end) - _residual(slider, ode, middle)) / (end - middle)),
        "locked_mm": _mm(_residual(slider, locked, end)),
        "rocking_mm": _mm(_residual(slider, ode, end)),
        "quarter_ratio": significant(quarter / joint, 3),
        "angles_below": str(sum(_percent(slider, "soft", start, a, end) < claim for a in incline.ANGLES_DEG)),
        "balanced_table": _start_table(slider, start),
    }


def _unloaded_fields(slider: Incline) -> dict[str, str]:
    start, phi, first = "unloaded", incline.MAIN_ANGLE_DEG, incline.TIMES_S[0]
    return {
        "unloaded_shi": significant(_percent(slider, "shi", start, phi, first), 3),
        "unloaded_soft": significant(_percent(slider, "soft", start, phi, first), 2),
        "unloaded_table": _start_table(slider, start),
    }


def _start_table(slider: Incline, start: str) -> str:
    phi = incline.MAIN_ANGLE_DEG
    lines = [(phi, time) for time in incline.TIMES_S]
    lines += [(angle, slider.inputs.end_time) for angle in incline.ANGLES_DEG if angle != phi]
    headings = ("phi, time", "reference ODE", "soft", "hard", "shi, joint's springs", "shi, own penalty")
    return number_table(headings, ([f"{angle} deg, {time:g} s", *_start_cells(slider, start, angle, time)] for angle, time in lines))


def _start_cells(slider: Incline, start: str, angle: int, time: float) -> list[str]:
    percents = [100 * (slider.ode(start, angle)[time] / slider.closed_form(angle)[time] - 1)]
    percents += [_percent(slider, m, start, angle, time) for m in ("soft", "hard", incline.SHI_JOINT, "shi")]
    return [f"{p:.2g}" if 1e-6 < abs(p) < 1e-3 else f"{p:.3f}" if abs(p) > 1e-6 else "0" for p in percents]


def _convergence_fields(slider: Incline) -> dict[str, str]:
    headings = ("run", *(f"dt = {dt:.3g} s" for dt in incline.CONVERGENCE_STEPS_S), "order")
    return {
        "convergence_end": significant(incline.CONVERGENCE_END_S, 4),
        "refinement": str(incline.REFINEMENT),
        "ratio_1": str(incline.REFINEMENT),
        "ratio_2": str(incline.REFINEMENT**2),
        "rounding_floor": significant(incline.ROUNDING_FLOOR_M, 4),
        "convergence_table": number_table(headings, (_study_cells(slider, study) for study in incline.STUDIES)),
    }


def _study_cells(slider: Incline, study: Study) -> list[str]:
    method = "shi, joint's springs" if study.method == incline.SHI_JOINT else study.method
    scheme = "Shi's scheme" if study.theta == 1.0 else "trapezoid"
    errors = [slider.refinement_error(study, dt) for dt in incline.CONVERGENCE_STEPS_S]
    refined = (f"{fine:.2e} ({coarse / fine:.2f})" for coarse, fine in zip(errors, errors[1:]))
    name = f"{method}, {incline.STARTS[study.start]}, {study.angle_deg} deg, {scheme}"
    return [name, f"{errors[0]:.2e}", *refined, f"{slider.observed_order(study):.2f}"]


def _table_1(rows: list[comparison.Row]) -> str:
    inputs = (row for row in rows if row.item == "Table 1")
    lines = ((f"{r.quantity} [{r.unit}]", significant(r.paper, 6), significant(r.ours["soft"], 6)) for r in inputs)
    return number_table(("input", "paper", "ours"), lines)


def _plane_failure_fields(wedge: PlaneFailure, printed: dict) -> dict[str, str]:
    i, (stable, failed) = wedge.inputs, wedge.bracket("soft")
    return {
        "paper_max_displacement": significant(printed["max_displacement_m"]["value"], 4),
        "unbalanced_fraction": significant(i.unbalanced_fraction, 4),
        "failure_displacement": significant(i.failure_displacement, 4),
        "safety_table": _safety_table(wedge, printed),
        "inside": "inside" if stable <= wedge.closed_form <= failed else "outside",
        "width": significant(failed - stable, 2),
        "width_asked": significant(i.width, 4),
        "paper_fos": significant(printed["factor_of_safety_dda_sc"]["value"], 4),
        "fos_opening": f"{wedge.brittle_factor_of_safety('lost_on_opening'):.5f}",
        "fos_slip": f"{wedge.brittle_factor_of_safety('lost_on_slip'):.5f}",
    }


def _safety_table(wedge: PlaneFailure, printed: dict) -> str:
    def against(value: float) -> str:
        return f"{100 * (value / wedge.closed_form - 1):+.3f} %"

    paper = printed["factor_of_safety_dda_sc"]["value"]
    rows = [
        ("closed form", f"{wedge.closed_form:.5f}", ""),
        ("paper, analytical", f"{printed['factor_of_safety_analytical']['value']:g}", ""),
        ("paper, DDA-SC", f"{paper:g}", against(paper)),
    ]
    for method in METHODS:
        stable, failed = wedge.bracket(method)
        rows.append((f"{method}: stable, failed", f"{stable:.5f}, {failed:.5f}", f"{against(stable)}, {against(failed)}"))
    for behaviour in BRITTLE:
        value = wedge.brittle_factor_of_safety(behaviour)
        rows.append((f"soft, cohesion {behaviour}", f"{value:.5f}", against(value)))
    return number_table(("", "factor of safety", "against the closed form"), rows)


def _curve_fields(wedge: PlaneFailure, printed: dict) -> dict[str, str]:
    """Fig. 6 at the points of its curves nearest to the two printed factors of safety."""
    paper, analytical = (printed[f"factor_of_safety_{name}"]["value"] for name in ("dda_sc", "analytical"))

    def nearest(points: list[Point], srf: float) -> Point:
        return min(points, key=lambda p: abs(p.srf - srf))

    moved, dropped = wedge.moving_curve(), wedge.unsettled_curve()
    return {
        "steps": significant(wedge.inputs.curve_time / wedge.inputs.dt, 4),
        "srf_paper": significant(nearest(moved, paper).srf, 4),
        "srf_analytical": significant(nearest(moved, analytical).srf, 4),
        "rest_mm": _mm(min(wedge.settled_curve(), key=lambda t: abs(t.srf - paper)).displacement, 2),
        "moved_mm": _mm(nearest(moved, paper).displacement, 2),
        "moved_late_mm": _mm(nearest(moved, analytical).displacement, 2),
        "dropped_mm": _mm(nearest(dropped, paper).displacement, 3),
        "dropped_mm_per_s": _mm(nearest(dropped, paper).speed, 3),
        "dropped_late_mm": _mm(nearest(dropped, analytical).displacement, 3),
    }
