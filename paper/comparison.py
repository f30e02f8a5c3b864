"""The comparison: one row for each quantity, with the paper, the reference and our methods side by side."""

import csv
from dataclasses import dataclass, field
from pathlib import Path

from openclose_scripts.examples import incline
from openclose_scripts.examples import plane_failure
from openclose_scripts.examples.incline import Incline, Study
from openclose_scripts.examples.jointed_rock import JointedRock
from openclose_scripts.examples.plane_failure import PlaneFailure

METHODS = ("soft", "hard", "shi", "dem")
COLUMNS = ("item", "quantity", "unit", "paper", "closed_form", *METHODS, *(f"deviation_{m}" for m in METHODS))

Values = dict[str, float]


@dataclass
class Row:
    """`closed_form` is the closed form or the reference ODE; a deviation is (ours - reference)/reference of what the quantity measures."""

    item: str
    quantity: str
    unit: str
    paper: float | str | None = None
    closed_form: float | None = None
    ours: Values = field(default_factory=dict)
    deviation: Values = field(default_factory=dict)

    def cells(self) -> list:
        values = [self.ours.get(m) for m in METHODS] + [self.deviation.get(m) for m in METHODS]
        return [self.item, self.quantity, self.unit, self.paper, self.closed_form, *values]


def relative(ours: Values, reference: float) -> Values:
    return {m: v / reference - 1 for m, v in ours.items()} if reference else {}


def build(slider: Incline, wedge: PlaneFailure, printed: dict) -> list[Row]:
    """All rows of examples 3.1 and 3.2, in the order of the paper."""
    return [
        *_incline_inputs(slider, printed["incline"]),
        *_figure_3(slider),
        *_figure_4(slider, printed["incline"]),
        *_convergence(slider),
        *_table_1(wedge, printed["plane_failure"]),
        *_figure_6(wedge, printed["plane_failure"]),
    ]


def input_row(item: str, quantity: str, unit: str, printed: float, scene: float, methods: tuple[str, ...]) -> Row:
    ours = {m: scene for m in methods}
    return Row(item, quantity, unit, printed, None, ours, relative(ours, printed))


def jointed_rock(i: JointedRock) -> tuple[tuple[str, str, float], ...]:
    """Name, key of printed.toml and value of what the slopes have in common."""
    return (
        ("unit weight", "unit_weight_n_per_m3", i.unit_weight),
        ("joint friction angle", "friction_angle_deg", i.friction_angle_deg),
        ("joint cohesion", "cohesion_pa", i.cohesion),
        ("tensile strength", "tensile_strength_pa", i.tensile_strength),
        ("normal stiffness kn", "normal_stiffness_pa_per_m", i.normal_stiffness),
        ("shear stiffness ks", "shear_stiffness_pa_per_m", i.shear_stiffness),
        ("time step", "dt_s", i.dt),
        ("gravity", "gravity_m_per_s2", i.gravity),
    )


def rock_inputs(item: str, quantities: tuple[tuple[str, str, float], ...], printed: dict, methods: tuple[str, ...]) -> list[Row]:
    return [input_row(item, name, _unit_of(key), printed[key]["value"], value, methods) for name, key, value in quantities]


def _unit_of(key: str) -> str:
    """The unit that the name of a key ends in."""
    units = (("_pa_per_m", "Pa/m"), ("_n_per_m3", "N/m3"), ("_m_per_s2", "m/s2"), ("_deg", "deg"), ("_pa", "Pa"), ("_s", "s"), ("_m", "m"))
    for ending, unit in units:
        if key.endswith(ending):
            return unit
    return "-"


def _incline_inputs(slider: Incline, printed: dict) -> list[Row]:
    i = slider.inputs
    quantities = (
        ("block length", "m", "block_length_m", i.length),
        ("block height", "m", "block_height_m", i.height),
        ("slope angle", "deg", "slope_angle_deg", i.slope_angle_deg),
        ("normal stiffness kn", "Pa/m", "normal_stiffness_pa_per_m", i.normal_stiffness),
        ("shear stiffness ks", "Pa/m", "shear_stiffness_pa_per_m", i.shear_stiffness),
    )
    return [input_row("Fig. 2 inputs", name, unit, printed[key]["value"], value, incline.METHODS) for name, unit, key, value in quantities]


def _figure_3(slider: Incline) -> list[Row]:
    rows = []
    end = slider.inputs.end_time
    for angle in incline.ANGLES_DEG:
        exact = slider.closed_form(angle)[end]
        ours = {m: slider.steady(m, angle, incline.STEADY_STEPS_S[0])[end] for m in incline.METHODS}
        name = f"displacement at {end:g} s, phi = {angle} deg, dt = {incline.STEADY_STEPS_S[0]:g} s"
        rows.append(Row("Fig. 3", name, "m", None, exact, ours, relative(ours, exact)))
    for dt in incline.STEADY_STEPS_S:
        ours = {m: max(slider.largest_steady_error(m, a, dt) for a in incline.ANGLES_DEG) for m in incline.METHODS}
        name = f"largest error, t >= {incline.EARLIEST_S:g} s, five phi, dt = {dt:g} s"
        rows.append(Row("Fig. 3", name, "-", None, 0.0, ours))
    return rows


def _percent(displacement: float, exact: float) -> float:
    return 100 * (displacement / exact - 1)


def _error_row(slider: Incline, start: str, angle: int, time: float, *, shi: str = incline.SHI_JOINT) -> Row:
    """The reference is the ODE on the joint's springs; `hard` has no springs and answers to eq. (8) itself."""
    exact, ode = slider.closed_form(angle)[time], slider.ode(start, angle)[time]
    d = {m: slider.from_start(shi if m == "shi" else m, start, angle)[time] for m in incline.METHODS}
    ours = {m: _percent(d[m], exact) for m in incline.METHODS}
    deviation = {m: d[m] / (exact if m == "hard" else ode) - 1 for m in incline.METHODS}
    name = f"{incline.STARTS[start]} {start}: error at {time:g} s, phi = {angle} deg"
    return Row("Fig. 4", name, "%", None, _percent(ode, exact), ours, deviation)


def _default_penalty_row(slider: Incline, start: str, time: float) -> Row:
    angle = incline.MAIN_ANGLE_DEG
    ours = {"shi": _percent(slider.from_start("shi", start, angle)[time], slider.closed_form(angle)[time])}
    return Row("Fig. 4", f"{incline.STARTS[start]} error at {time:g} s, phi = {angle} deg, shi's own penalty", "%", ours=ours)


def _soft_shear_row(slider: Incline, time: float) -> Row:
    angle = incline.MAIN_ANGLE_DEG
    ours = {"shi": _percent(slider.from_start(incline.SHI_SOFT_SHEAR, "normal_balanced", angle)[time], slider.closed_form(angle)[time])}
    return Row("Fig. 4", f"(b) error at {time:g} s, phi = {angle} deg, ks of shi 1/4", "%", ours=ours)


def _claim_row(slider: Incline, start: str, printed: dict) -> Row:
    end = slider.inputs.end_time
    rows = [_error_row(slider, start, angle, end) for angle in incline.ANGLES_DEG]
    soft, shi = (printed[f"largest_error_dda_{m}_percent"]["value"] for m in ("sc", "shi"))
    ours = {m: max(abs(row.ours[m]) for row in rows) for m in incline.METHODS}
    reference = max(abs(row.closed_form) for row in rows)
    return Row("Fig. 4", f"{incline.STARTS[start]} largest error of five phi at {end:g} s", "%", f"SC <{soft:g}, Shi <{shi:g}", reference, ours)


def _figure_4(slider: Incline, printed: dict) -> list[Row]:
    rows = [_error_row(slider, start, incline.MAIN_ANGLE_DEG, time) for start in incline.STARTS for time in incline.TIMES_S]
    end = slider.inputs.end_time
    others = [angle for angle in incline.ANGLES_DEG if angle != incline.MAIN_ANGLE_DEG]
    rows += [_error_row(slider, start, angle, end) for start in ("unloaded", "normal_balanced") for angle in others]
    rows += [_claim_row(slider, start, printed) for start in ("unloaded", "normal_balanced")]
    rows += [_default_penalty_row(slider, start, time) for start in ("unloaded", "normal_balanced") for time in (incline.TIMES_S[0], end)]
    rows.append(_soft_shear_row(slider, end))
    return rows


def _convergence(slider: Incline) -> list[Row]:
    """Every step of the studies at the main angle with Shi's scheme; of the others the order alone."""
    angle, sticking = incline.MAIN_ANGLE_DEG, incline.STICKING_ANGLE_DEG
    rows = []
    for start in ("unloaded", "normal_balanced"):
        label = f"{incline.STARTS[start]} phi = {angle} deg"
        both = {"soft": Study("soft", start, angle), "shi": Study(incline.SHI_JOINT, start, angle)}
        for dt in incline.CONVERGENCE_STEPS_S:
            ours = {m: slider.refinement_error(study, dt) for m, study in both.items()}
            rows.append(Row("Fig. 4 convergence", f"{label}: distance from the ODE, dt = {dt:.3g} s", "m", None, 0.0, ours))
        rows.append(_order_row(slider, both, f"{label}: observed order", 1.0))
        rows.append(_order_row(slider, {"soft": Study("soft", start, angle, theta=0.5)}, f"{label}, trapezoid: observed order", 2.0))
    both = {"soft": Study("soft", "unloaded", sticking), "shi": Study(incline.SHI_JOINT, "unloaded", sticking)}
    rows.append(_order_row(slider, both, f"(a) phi = {sticking} deg: observed order", 1.0))
    return rows


def _order_row(slider: Incline, studies: dict[str, Study], quantity: str, theory: float) -> Row:
    return Row("Fig. 4 convergence", quantity, "-", None, theory, {m: slider.observed_order(study) for m, study in studies.items()})


def _table_1(wedge: PlaneFailure, printed: dict) -> list[Row]:
    i = wedge.inputs
    shape = (("slope height", "slope_height_m", i.height), ("slope face angle", "face_angle_deg", i.face_angle_deg),
             ("joint dip", "joint_angle_deg", i.joint_angle_deg))
    steps = (("steps to the displacement of Fig. 6", "steps_to_measured_displacement", i.curve_time / i.dt),)
    return rock_inputs("Table 1", (*shape, *jointed_rock(i), *steps), printed, plane_failure.METHODS)


def _figure_6(wedge: PlaneFailure, printed: dict) -> list[Row]:
    exact = wedge.closed_form
    analytical, dda_sc = printed["factor_of_safety_analytical"]["value"], printed["factor_of_safety_dda_sc"]["value"]
    rows = [Row("Fig. 6", "factor of safety, paper's analytical", "-", analytical, exact)]
    ours = {m: wedge.factor_of_safety(m) for m in plane_failure.METHODS}
    rows.append(Row("Fig. 6", "factor of safety, ductile cohesion", "-", dda_sc, exact, ours, relative(ours, exact)))
    failed = {m: wedge.bracket(m)[1] for m in plane_failure.METHODS}
    rows.append(Row("Fig. 6", "smallest factor that fails", "-", None, exact, failed, relative(failed, exact)))
    for behaviour in plane_failure.BRITTLE:
        lost = {"soft": wedge.brittle_factor_of_safety(behaviour)}
        rows.append(Row("Fig. 6", f"factor of safety, cohesion {behaviour}", "-", dda_sc, None, lost))
    return rows


def as_text(rows: list[Row]) -> list[dict[str, str]]:
    """Rows as read_rows gives them, numbers with all digits."""
    def text(cell: object) -> str:
        return "" if cell is None else repr(cell) if isinstance(cell, float) else str(cell)

    return [{column: text(cell) for column, cell in zip(COLUMNS, row.cells())} for row in rows]


def write_csv(rows: list[Row], file: Path) -> None:
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(as_text(rows))
