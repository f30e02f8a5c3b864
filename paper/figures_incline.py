"""Figs 3 and 4: displacement and error of the block on the incline."""

from pathlib import Path

from openclose_scripts import drawing
from openclose_scripts.drawing import METHOD_COLOUR, METHOD_LABEL, METHOD_MARKER, REFERENCE, plt
from openclose_scripts.examples import incline
from openclose_scripts.examples.incline import Incline

_ROUNDING = 1e-17  # errors that are exactly zero are drawn here


def figure_3(slider: Incline, file: Path) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5.2), constrained_layout=True)
    _displacements(slider, left)
    _steady_errors(slider, right)
    drawing.save(figure, file)


def _displacements(slider: Incline, axes: plt.Axes) -> None:
    dt = incline.STEADY_STEPS_S[0]
    end = slider.inputs.end_time
    for angle in incline.ANGLES_DEG:
        exact = slider.closed_form(angle)
        axes.plot(list(exact), list(exact.values()), color=REFERENCE, linewidth=1)
        axes.annotate(f"$\\varphi$ = {angle}°", (end, exact[end]), xytext=(5, 0), textcoords="offset points", va="center")
        for k, method in enumerate(incline.METHODS):
            # Each method at its own times: they would hide one another.
            ours = {t: d for t, d in slider.steady(method, angle, dt).items() if round(t / 0.1) % 3 == k and _is_multiple(t, 0.1)}
            axes.plot(list(ours), list(ours.values()), METHOD_MARKER[method], color=METHOD_COLOUR[method], markersize=5, markerfacecolor="none")
    axes.plot([], [], color=REFERENCE, linewidth=1, label="eq. (8)")
    for method in incline.METHODS:
        axes.plot([], [], METHOD_MARKER[method], color=METHOD_COLOUR[method], markerfacecolor="none", label=method)
    axes.set_xlim(0, end * 1.16)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("displacement of the centroid along the slope [m]")
    axes.set_title(f"Fig. 3  Displacement from steady sliding, dt = {dt:g} s")
    axes.legend(loc="upper left")


def _is_multiple(time: float, interval: float) -> bool:
    return abs(time / interval - round(time / interval)) < 1e-6


def _steady_errors(slider: Incline, axes: plt.Axes) -> None:
    for method in incline.METHODS:
        for dt, line in zip(incline.STEADY_STEPS_S, ("-", "--", ":")):
            errors = _largest_over_angles(slider, method, dt)
            axes.semilogy(*zip(*errors.items()), line, color=METHOD_COLOUR[method], label=f"{method}, dt = {dt:g} s")
    axes.axhline(1e-10, color=REFERENCE, linewidth=1)
    axes.annotate("goal: 1e-10", (2.5, 1e-10), xytext=(0, 4), textcoords="offset points")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("relative error |d / d(8) - 1| [-], largest of the five angles")
    axes.set_title("Error of Fig. 3: rounding only, at any step")
    axes.set_ylim(1e-17, 1e-7)
    axes.legend(ncol=3, loc="upper center", fontsize=8.5)


def _largest_over_angles(slider: Incline, method: str, dt: float) -> dict[float, float]:
    largest: dict[float, float] = {}
    for angle in incline.ANGLES_DEG:
        exact = slider.closed_form(angle)
        for time, d in slider.steady(method, angle, dt).items():
            if _is_multiple(time, 0.05) and time > 0:
                largest[time] = max(largest.get(time, _ROUNDING), abs(d / exact[time] - 1))
    return largest


def figure_4(slider: Incline, file: Path) -> None:
    figure, panels = plt.subplots(2, 2, figsize=(13, 10), constrained_layout=True)
    _unloaded_errors(slider, panels[0, 0])
    _balanced_errors(slider, panels[0, 1])
    _sliding_errors(slider, panels[1, 0])
    _convergence(slider, panels[1, 1])
    phi, dt = incline.MAIN_ANGLE_DEG, incline.FIG4_STEP_S
    figure.suptitle(f"Fig. 4  Residual error in displacement, $\\varphi$ = {phi}°, dt = {dt:g} s, from three starts")
    drawing.save(figure, file)


def _error_in_time(slider: Incline, displacement: dict[float, float], unit: float) -> tuple[list[float], list[float]]:
    exact = slider.closed_form(incline.MAIN_ANGLE_DEG)
    times = [t for t in displacement if t > 0]
    return times, [max(abs(displacement[t] - exact[t]), _ROUNDING) / unit for t in times]


def _error_axes(axes: plt.Axes, title: str, unit: str) -> None:
    axes.set_title(title)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"residual error e = |d(8) - d| [{unit}]")


def _method_lines(slider: Incline, axes: plt.Axes, start: str, methods: tuple[str, ...], unit: float) -> None:
    """Markers, each method at its own times: they would hide one another."""
    for k, method in enumerate(methods):
        curve = _error_in_time(slider, slider.from_start(method, start, incline.MAIN_ANGLE_DEG), unit)
        axes.plot(*curve, METHOD_MARKER[method], color=METHOD_COLOUR[method], markersize=4.5, markerfacecolor="none",
                  markevery=(6 * k + 3, 24), label=METHOD_LABEL[method])


def _hard_error(slider: Incline, start: str) -> float:
    return max(_error_in_time(slider, slider.from_start("hard", start, incline.MAIN_ANGLE_DEG), 1.0)[1])


def _unloaded_errors(slider: Incline, axes: plt.Axes) -> None:
    mm = 1e-3
    inset = axes.inset_axes((0.67, 0.12, 0.31, 0.2))
    ode = _error_in_time(slider, slider.ode("unloaded", incline.MAIN_ANGLE_DEG), mm)
    for method in ("shi", incline.SHI_JOINT, "soft"):
        curve = _error_in_time(slider, slider.from_start(method, "unloaded", incline.MAIN_ANGLE_DEG), mm)
        for panel in (axes, inset):
            panel.plot(*curve, color=METHOD_COLOUR[method], linewidth=1.3, label=METHOD_LABEL[method])
    for panel in (axes, inset):
        panel.plot(*ode, color=REFERENCE, linewidth=0.8, label="reference ODE, the joint's springs")
    axes.plot([], [], " ", label=f"hard: below {_upper_power(_hard_error(slider, 'unloaded'))} m")
    inset.set_xlim(0, 0.5)
    inset.set_ylim(0, 0.55)
    inset.set_title("the beginning [s, mm]", fontsize=8.5)
    inset.tick_params(labelsize=8)
    axes.set_ylim(-0.3, 24)
    _error_axes(axes, "(a) gravity dropped on unloaded springs", "mm")
    axes.legend(loc="upper left", fontsize=8.5)


def _balanced_errors(slider: Incline, axes: plt.Axes) -> None:
    phi, mm = incline.MAIN_ANGLE_DEG, 1e-3
    ode = slider.ode("normal_balanced", phi)
    axes.plot(*_error_in_time(slider, ode, mm), color=REFERENCE, linewidth=1.2, label="reference ODE, the joint's springs")
    locked = slider.ode("normal_balanced", phi, rotation_locked=True)
    axes.plot(*_error_in_time(slider, locked, mm), "--", color=REFERENCE, linewidth=1, label="the same, rotation locked: one unknown")
    _method_lines(slider, axes, "normal_balanced", ("soft", "hard", "shi", "shi_joint_springs"), mm)
    axes.set_ylim(bottom=-2)
    _error_axes(axes, "(b) normal forces in balance, shear springs relaxed", "mm")
    axes.legend(loc="upper left", fontsize=8.5)


def _sliding_errors(slider: Incline, axes: plt.Axes) -> None:
    _method_lines(slider, axes, "steady_sliding", ("soft", "hard", "shi", "shi_joint_springs"), 1.0)
    axes.set_yscale("log")
    axes.set_ylim(1e-18, 1e-8)
    _error_axes(axes, "(c) steady sliding: rounding only", "m")
    axes.legend(loc="upper left", fontsize=8.5, ncol=2)


def _study_style(study: incline.Study) -> dict:
    line = {"unloaded": "-", "normal_balanced": "--"}[study.start]
    name = {"soft": "soft", incline.SHI_JOINT: "shi"}[study.method]
    label = f"{name} {incline.STARTS[study.start]}"
    colour, marker = METHOD_COLOUR[study.method], METHOD_MARKER[study.method]
    if study.theta != 1.0:
        return {"linestyle": line, "color": "#9467bd", "marker": "D", "label": label + ", trapezoid"}
    if study.angle_deg != incline.MAIN_ANGLE_DEG:
        return {"linestyle": ":", "color": colour, "marker": marker, "label": label + f", $\\varphi$ = {study.angle_deg}°"}
    return {"linestyle": line, "color": colour, "marker": marker, "label": label}


def _convergence(slider: Incline, axes: plt.Axes) -> None:
    steps = incline.CONVERGENCE_STEPS_S
    for study in incline.STUDIES:
        errors = [slider.refinement_error(study, dt) for dt in steps]
        axes.loglog(steps, errors, markersize=5, markerfacecolor="none", linewidth=1, **_study_style(study))
    for order, at_coarse, above in ((1, 5e-2, 8), (2, 1.5e-6, -14)):
        guide = [at_coarse * (dt / steps[0]) ** order for dt in (steps[0], steps[2])]
        axes.loglog((steps[0], steps[2]), guide, color="#888888", linewidth=2)
        axes.annotate(f"order {order}", (steps[1], guide[0] * (steps[1] / steps[0]) ** order), xytext=(6, above),
                      textcoords="offset points", color="#555555")
    axes.set_xlabel("step dt [s]")
    axes.set_ylabel(f"largest |d - d of the ODE| for t <= {incline.CONVERGENCE_END_S:g} s [m]")
    axes.set_title("Convergence on the reference ODE")
    axes.set_ylim(1e-12, 1e2)
    axes.legend(loc="upper left", fontsize=8.5, ncol=3)


def _upper_power(value: float) -> str:
    """The next power of ten above a positive number."""
    exponent = int(f"{value:e}".split("e")[1]) + 1
    return f"1e{exponent:d}"
