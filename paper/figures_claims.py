"""One figure for each claim of the paper that is tested."""

from pathlib import Path

import claims
from claims import Claims
from openclose_scripts import drawing
from openclose_scripts.drawing import METHOD_COLOUR, METHOD_MARKER, REFERENCE, plt
from openclose_scripts.examples import incline

_ROUNDING = 1e-9  # [-] smaller errors are drawn here
_LEAST_PERCENT = 1e-6


def draw(tested: Claims, printed: dict, folder: Path) -> None:
    """Writes claim_1.png to claim_6.png."""
    for number, figure in enumerate((_sizes, _tolerances, _penalties, _hard_contact, _multipliers, _explicit), 1):
        drawing.save(figure(tested, printed), folder / f"claim_{number}.png")


def _panels(count: int) -> tuple:
    return plt.subplots(1, count, figsize=(6.3 * count, 5.0), constrained_layout=True)


def _names(axes: plt.Axes, x: str, y: str, title: str) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(title, fontsize=10)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8.5)


def _style(method: str) -> dict:
    return {"color": METHOD_COLOUR[method], "marker": METHOD_MARKER[method], "markersize": 5, "linewidth": 1.2}


def _sizes(tested: Claims, printed: dict) -> plt.Figure:
    figure, panels = _panels(3)
    for method in ("shi", "soft"):
        costs = tested.sizes(method)
        blocks = [c.blocks for c in costs]
        for axes, values in zip(panels, ([c.solves for c in costs], [c.cuts for c in costs], [c.cpu for c in costs])):
            axes.plot(blocks, values, label=method, **_style(method))
    for axes in panels:
        axes.set_xscale("log")
        axes.axvline(printed["blocks_of_rise"]["value"], color="#888888", linestyle=":", label="the paper's 500 blocks")
    panels[0].set_yscale("log")
    panels[2].set_yscale("log")
    _names(panels[0], "blocks", "linear solves per step asked for", "Claim 1: iterations, example 3.4 cut finer")
    _names(panels[1], "blocks", "attempts cut per step asked for", "Steps that did not settle")
    _names(panels[2], "blocks", "CPU time per step asked for [s]", "Time")
    return figure


def _marked(axes: plt.Axes, x: list[float], y: list[float], finished: list[bool], label: str, colour: str) -> None:
    axes.plot(x, y, "-", color=colour, linewidth=1.2, label=label)
    for done, marker in ((True, "o"), (False, "x")):
        chosen = [(a, b) for a, b, f in zip(x, y, finished) if f == done]
        if chosen:
            axes.plot(*zip(*chosen), marker, color=colour, markersize=6, label=None if done else f"{label}: did not get to the end")


def _tolerances(tested: Claims, _: dict) -> plt.Figure:
    figure, panels = _panels(3)
    depths = claims.PENETRATION_TOLERANCES_M
    costs = [tested.slope_penetration(v) for v in depths]
    slides = [tested.incline_penetration(v) for v in depths]
    _marked(panels[0], depths, [c.solves for c in costs], [c.finished for c in costs], f"example 3.4, {costs[0].blocks} blocks", METHOD_COLOUR["shi"])
    _marked(panels[0], depths, [s.solves for s in slides], [s.finished for s in slides], "example 3.1", METHOD_COLOUR["soft"])
    _log(panels[0])
    _names(panels[0], "penetration tolerance [m]", "linear solves per step of 1 ms reached", "Claim 2: too small a tolerance cuts steps without end")
    closings = [v if v > 0 else 1e-10 for v in claims.CLOSING_TOLERANCES_M]
    costs = [tested.slope_closing(v) for v in claims.CLOSING_TOLERANCES_M]
    label = f"example 3.4, {costs[-1].blocks} blocks"
    _marked(panels[1], closings, [c.solves for c in costs], [c.finished for c in costs], label, METHOD_COLOUR["shi"])
    _log(panels[1])
    x = "closing tolerance [m], 0 drawn at 1e-10"
    _names(panels[1], x, "linear solves per step of 1 ms reached", "Open contacts that close too readily never settle")
    slides = [tested.incline_closing(v) for v in claims.CLOSING_TOLERANCES_M]
    for name, values, colour in (("displacement", [s.displacement_error for s in slides], METHOD_COLOUR["soft"]),
                                 ("sum of the normal forces", [s.force_error for s in slides], METHOD_COLOUR["shi"])):
        panels[2].plot(closings, [max(abs(v), _ROUNDING) for v in values], "o-", color=colour, markersize=5, linewidth=1.2, label=name)
    _log(panels[2])
    _names(panels[2], x, "relative error at 0.5 s [-]", "Too large a tolerance: example 3.1 against the closed form")
    return figure


def _log(axes: plt.Axes) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")


def _penalties(tested: Claims, _: dict) -> plt.Figure:
    figure, panels = _panels(3)
    penalties = claims.SLOPE_PENALTIES
    spectra = [tested.spectrum(p) for p in penalties]
    panels[0].plot(penalties, [s.condition for s in spectra], "o-", color=METHOD_COLOUR["shi"], label="all contacts stick")
    panels[0].plot(penalties, [s.detached for s in spectra], "s--", color=METHOD_COLOUR["soft"], label="one unknown has lost its contacts")
    panels[0].axhline(2.0**52, color=REFERENCE, linewidth=1, label="all digits lost")
    costs = [tested.slope_penalty(p) for p in penalties]
    panels[1].plot(penalties, [c.solves for c in costs], "o-", color=METHOD_COLOUR["shi"], label="linear solves")
    panels[1].plot(penalties, [1e3 * c.cpu for c in costs], "s--", color=METHOD_COLOUR["soft"], label="CPU time [ms]")
    slides = [tested.incline_penalty(p) for p in claims.INCLINE_PENALTIES]
    panels[2].plot(claims.INCLINE_PENALTIES, [max(abs(s.displacement_error), _ROUNDING) for s in slides], "o-", color=METHOD_COLOUR["shi"])
    for axes in panels:
        _log(axes)
    _names(panels[0], "penalty [Pa/m]", "condition number of a step's matrix [-]", f"Claim 3: conditioning, example 3.4, {costs[0].blocks} blocks")
    _names(panels[1], "penalty [Pa/m]", "per step asked for", "Run time")
    _names(panels[2], "penalty [Pa/m]", "relative error of the displacement at 0.5 s [-]", "Result: example 3.1 against eq. (8)")
    return figure


def _hard_contact(tested: Claims, _: dict) -> plt.Figure:
    figure, panels = _panels(2)
    for axes, start in zip(panels, ("unloaded", "normal_balanced")):
        for k, method in enumerate(("soft", incline.SHI_JOINT, "shi", "hard")):
            errors = [abs(e) for e in tested.incline_errors(method, start)]
            label = drawing.METHOD_LABEL[method] + (f": below {_LEAST_PERCENT:g} %" if max(errors) < _LEAST_PERCENT else "")
            at = [a + 0.8 * (k - 1.5) for a in incline.ANGLES_DEG]
            axes.bar(at, [max(e, _LEAST_PERCENT) for e in errors], 0.75, color=METHOD_COLOUR[method], label=label)
        axes.set_yscale("log")
        axes.set_ylim(_LEAST_PERCENT, 1e3)
        end = tested.slider.inputs.end_time
        _names(axes, "friction angle [deg]", f"error of the displacement at {end:g} s [%]", f"Claim 4: start {incline.STARTS[start]} {start}")
    return figure


def _multipliers(tested: Claims, _: dict) -> plt.Figure:
    figure, axes = plt.subplots(figsize=(9, 5), constrained_layout=True)
    names = list(dict.fromkeys(n for m in claims.METHODS for n in tested.solves(m)))
    for k, method in enumerate(claims.METHODS):
        found = {names.index(n): v for n, v in tested.solves(method).items()}
        axes.bar([i + 0.27 * (k - 1) for i in found], list(found.values()), 0.25, color=METHOD_COLOUR[method], label=method)
    axes.set_xticks(range(len(names)), [n.replace(", ", "\n") for n in names])
    axes.set_yscale("log")
    _names(axes, "example, gravity dropped on unloaded springs", "linear solves per step asked for",
           "Claim 5: multipliers (hard) against springs; no bar: did not get to the end")
    return figure


def _explicit(tested: Claims, printed: dict) -> plt.Figure:
    figure, axes = plt.subplots(figsize=(9, 5), constrained_layout=True)
    found = [tested.explicit(s) for s in claims.EXPLICIT_SCENES]
    series = (
        ("2/w_max of all contacts", [e.exact for e in found], "o"),
        ("bound that dem uses", [e.bound for e in found], "s"),
        ("2 sqrt(m/(2 kn 1 m2)), smallest block", [e.two_body for e in found], "^"),
        ("a tenth of it (UDEC's factor)", [claims.UDEC_FRACTION * e.two_body for e in found], "v"),
    )
    for label, values, marker in series:
        axes.plot(range(len(found)), values, marker, markersize=8, markerfacecolor="none", label=label)
    for table, style in (("2", "-"), ("3", "--")):
        step = printed[f"explicit_step_table_{table}_s"]["value"]
        axes.axhline(step, color=REFERENCE, linestyle=style, linewidth=1, label=f"printed in Table {table}: {step:g} s")
    axes.set_xticks(range(len(found)), [e.scene.removeprefix("example_").replace("_", ".", 1) for e in found])
    axes.set_yscale("log")
    _names(axes, "scene", "time step [s]", "Claim 6: the explicit method's critical step")
    return figure
