"""Fig. 6: displacement against the strength reduction factor."""

from pathlib import Path

from matplotlib.ticker import MultipleLocator

from openclose_scripts import drawing
from openclose_scripts.drawing import METHOD_COLOUR, REFERENCE, plt
from openclose_scripts.examples.plane_failure import METHODS, PlaneFailure

_MM = 1e-3
_ZOOM = (1.808, 1.852)


def figure_6(wedge: PlaneFailure, printed: dict, file: Path) -> None:
    figure, panels = plt.subplots(1, 3, figsize=(17, 5.6), constrained_layout=True)
    _whole_curve(wedge, printed, panels[0])
    _near_failure(wedge, printed, panels[1])
    _bisection(wedge, panels[2])
    drawing.save(figure, file)


def _marks(wedge: PlaneFailure, printed: dict, axes: plt.Axes) -> None:
    """Vertical lines at the three factors of safety."""
    paper = printed["factor_of_safety_dda_sc"]["value"]
    axes.axvline(paper, color="#8c564b", linestyle=":", linewidth=1.6, label=f"paper's DDA-SC: {paper:g}")
    axes.axvline(wedge.closed_form, color=REFERENCE, linewidth=1.2, label=f"closed form: {wedge.closed_form:.5f}")
    stable, failed = wedge.bracket("soft")
    axes.axvspan(stable, failed, color="#2ca02c", alpha=0.5, label=f"ours (soft): {stable:.5f} to {failed:.5f}")


def _moving_lines(wedge: PlaneFailure, axes: plt.Axes) -> None:
    """Displacement after the steps of Fig. 6."""
    steps = f"{wedge.inputs.curve_time / wedge.inputs.dt:.0f} steps"
    for points, marker, colour, name in (
        (wedge.moving_curve(), "o-", METHOD_COLOUR["soft"], f"after {steps}, reduced once settled"),
        (wedge.unsettled_curve(), "^-", METHOD_COLOUR["shi_joint_springs"], f"after {steps}, gravity dropped on unloaded springs"),
    ):
        axes.plot([p.srf for p in points], [p.displacement / _MM for p in points], marker, color=colour, markersize=4, linewidth=1, label=name)


def _axis_names(axes: plt.Axes, title: str) -> None:
    axes.set_xlabel("strength reduction factor SRF [-]")
    axes.set_ylabel("displacement of the crest [mm]")
    axes.set_title(title)


def _whole_curve(wedge: PlaneFailure, printed: dict, axes: plt.Axes) -> None:
    _moving_lines(wedge, axes)
    _marks(wedge, printed, axes)
    _axis_names(axes, "Fig. 6  Displacement of the measured point (soft)")
    axes.legend(loc="upper left", fontsize=8.5)


def _near_failure(wedge: PlaneFailure, printed: dict, axes: plt.Axes) -> None:
    _moving_lines(wedge, axes)
    at_rest = [t for t in wedge.settled_curve() if t.stable]
    failing = [t for t in wedge.settled_curve() if not t.stable]
    axes.plot([t.srf for t in at_rest], [t.displacement / _MM for t in at_rest], "s", color="#9467bd", markersize=4.5, label="at rest again")
    axes.plot([t.srf for t in failing], [t.displacement / _MM for t in failing], "x", color=METHOD_COLOUR["shi"], markersize=6,
              label=f"no rest: moved beyond {wedge.inputs.failure_displacement:g} m")
    _marks(wedge, printed, axes)
    axes.set_xlim(*_ZOOM)
    axes.xaxis.set_major_locator(MultipleLocator(0.01))
    axes.set_yscale("log")
    axes.set_ylim(1e-2, 1e7)
    _axis_names(axes, "Near failure, on a logarithmic scale")
    axes.legend(loc="upper left", fontsize=8.5)


def _bisection(wedge: PlaneFailure, axes: plt.Axes) -> None:
    brackets = wedge.brackets("soft")
    last = sum(trial.stage != "curve" for trial in wedge.trials("soft"))
    trials = range(last - len(brackets) + 1, last + 1)
    exact = wedge.closed_form
    axes.semilogy(trials, [abs(stable - exact) for stable, _ in brackets], "o-", color="#2ca02c", markersize=5, linewidth=1, label="stable end")
    axes.semilogy(trials, [abs(failed - exact) for _, failed in brackets], "x-", color=METHOD_COLOUR["shi"], markersize=6, linewidth=1,
                  label="failed end")
    axes.semilogy(trials, [failed - stable for stable, failed in brackets], "--", color=REFERENCE, linewidth=1, label="width of the bracket")
    axes.axhline(wedge.inputs.width, color="#888888", linewidth=1, linestyle=":", label=f"width asked for: {wedge.inputs.width:g}")
    axes.set_xlabel("trial number [-]")
    axes.set_ylabel("distance of the bracket's end from the closed form [-]")
    same = [m for m in METHODS if wedge.brackets(m) == brackets]
    axes.set_title(f"Bisection ({', '.join(same)}{': the same brackets' if len(same) > 1 else ''})")
    axes.legend(loc="upper right", fontsize=8.5)
