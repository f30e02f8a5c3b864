"""Figs 7 to 10: the slopes of examples 3.3 and 3.4."""

from pathlib import Path

from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from openclose_scripts import drawing
from openclose_scripts.drawing import INK, METHOD_COLOUR, METHOD_MARKER, ROCK, plt
from openclose_scripts.examples import slopes
from openclose_scripts.examples.slopes import JointedSlope, Milestone, PlanarSlope, Polygons

_EXAGGERATION = 10  # of the displacements in Fig. 7
_MECHANISM_STATES = ("moved 10 m", "moved 5 m", "moved 2 m", "moved 1 m", "moved 0.5 m")  # of each method the first that it came to
_FIG_8_STATES = ("start", "moved 1 m", "moved 10 m", "moved 40 m")
_LEAST_SPEED = 0.01  # [-] of the largest; slower blocks of the limit analysis stand still
_VIEW = (-75, 420, -65, 275)  # [m] the part of the slope of example 3.4 that takes part


def _block_axes(axes: plt.Axes, title: str) -> None:
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_title(title, fontsize=10)
    axes.grid(False)


def _draw_blocks(axes: plt.Axes, polygons: Polygons, fixed: set[str]) -> None:
    colours = [ROCK if name in fixed else "#ffffff" for name in polygons]
    axes.add_collection(PolyCollection(list(polygons.values()), facecolors=colours, edgecolors=INK, linewidths=0.5))
    axes.autoscale_view()


def _draw_coloured(axes: plt.Axes, polygons: Polygons, fixed: set[str], values: dict[str, float], colours: ScalarMappable,
                   least: float = 0.0) -> None:
    """Blocks with a smaller value than `least` are white, so that their joints can be seen."""
    faces = [ROCK if name in fixed else "#ffffff" if abs(values[name]) < least else colours.to_rgba(values[name]) for name in polygons]
    axes.add_collection(PolyCollection(list(polygons.values()), facecolors=faces, edgecolors=INK, linewidths=0.4))
    axes.autoscale_view()


def figure_7(planar: PlanarSlope, file: Path) -> None:
    figure, panels = plt.subplots(1, 3, figsize=(18, 6.0), constrained_layout=True)
    cut = planar.cut["toe"]
    _draw_blocks(panels[0], cut.outlines, cut.fixed)
    i = planar.inputs
    panels[0].annotate(f"{len(cut.blocks)} blocks\njoints at {i.dips_deg[0]:g}°, every {i.spacings[0]:g} m\nface at {i.face_angle_deg:.3g}°",
                       (0.03, 0.95), xycoords="axes fraction", va="top")
    _block_axes(panels[0], f"Fig. 7  Geometry: joint through the toe,\nback wall {planar.back_wall('toe'):.0f} m behind the crest; grey: fixed")
    for axes, model in zip(panels[1:], ("toe", "shifted")):
        _planar_mechanism(planar, model, figure, axes)
    drawing.save(figure, file)


def _planar_mechanism(planar: PlanarSlope, model: str, figure: plt.Figure, axes: plt.Axes) -> None:
    cut = planar.cut[model]
    before, after = planar.states(model, "soft")
    moved = {name: slopes.Motion.between(before[name], after[name]).distance for name in after}
    shown = {name: [(a[0] + _EXAGGERATION * (b[0] - a[0]), a[1] + _EXAGGERATION * (b[1] - a[1])) for a, b in zip(before[name], after[name])]
             for name in after}
    colours = ScalarMappable(Normalize(0, max(moved.values())), "viridis")
    _draw_coloured(axes, shown, cut.fixed, moved, colours)
    figure.colorbar(colours, ax=axes, label="displacement when failure was found [m]", shrink=0.8)
    factor = planar.factor_of_safety(model, "soft").value
    lowest = {"toe": "joint through the toe", "shifted": "lowest joint above the toe"}[model]
    _block_axes(axes, f"Mechanism, {lowest}\n(soft, FOS {factor:.4f}; displacements x {_EXAGGERATION})")


def figure_8(jointed: JointedSlope, printed: dict, file: Path) -> None:
    method, start = "soft", "settled"
    figure, panels = plt.subplots(2, 2, figsize=(15, 10.6), constrained_layout=True)
    names = ("initial geometry", "failure initiates at the toe", "sliding", "sliding and rotation")
    dt = printed["dt_s"]["value"]
    steps = (1, *(printed[f"step_of_{key}"]["value"] for key in ("failure_initiation", "sliding", "rotation")))
    reached = [state for state in _FIG_8_STATES if jointed.blocks(method, start, state)]
    rotations = {state: {name: m.rotation_deg for name, m in jointed.motions(method, start, state).items()} for state in reached}
    largest = max(abs(r) for of_state in rotations.values() for r in of_state.values())
    colours = ScalarMappable(Normalize(-largest, largest), "RdBu_r")
    times = {m.displacement: m.time for m in jointed.milestones(method, start)}
    for axes, letter, name, state, step in zip(panels.flat, "abcd", names, _FIG_8_STATES, steps):
        _view(axes)
        if state not in reached:
            _block_axes(axes, f"({letter}) {name}: not reached, {jointed.reason(method, start)}")
            continue
        _draw_coloured(axes, jointed.blocks(method, start, state), jointed.cut.fixed, rotations[state], colours)
        _block_axes(axes, f"({letter}) {name}: {_when(state, times)} (paper: step {step}, {step * dt:.2f} s)")
    figure.colorbar(colours, ax=panels, label="rotation [deg], positive counter-clockwise", shrink=0.8)
    inputs = jointed.post_failure_inputs
    figure.suptitle(f"Fig. 8  The failing slope, {method}, strength over {inputs.strength_reduction_factor:g}, cohesion lost on slip (grey: fixed)")
    drawing.save(figure, file)


def _when(state: str, times: dict[float, float]) -> str:
    if state == "start":
        return "t = 0"
    moved = float(state.split()[1])
    return f"toe block moved {moved:g} m, t = {times[moved]:.2f} s"


def _view(axes: plt.Axes) -> None:
    axes.set_autoscale_on(False)
    axes.set_xlim(*_VIEW[:2])
    axes.set_ylim(*_VIEW[2:])


def figure_9(jointed: JointedSlope, file: Path) -> None:
    figure, panels = plt.subplots(3, 2, figsize=(15, 15.6), constrained_layout=True)
    start = "settled"
    for axes, method in zip(panels.flat, ("soft", "dem", "shi", "hard")):
        _view(axes)
        paper = {"soft": ", the paper's DDA-SC", "dem": ", the paper's UDEC", "shi": ", the paper's DDA-Shi"}.get(method, "")
        state = next((s for s in _MECHANISM_STATES if jointed.blocks(method, start, s)), None)
        if state is None:
            _draw_blocks(axes, jointed.cut.outlines, jointed.cut.fixed)
            _block_axes(axes, f"{method}{paper}: not reached ({jointed.reason(method, start)})")
            continue
        _method_mechanism(jointed, method, start, state, figure, axes)
        _block_axes(axes, f"{method}{paper}: toe block {state}")
    _limit_mechanism(jointed, figure, panels[2, 0])
    panels[2, 1].axis("off")
    inputs = jointed.post_failure_inputs
    panels[2, 1].text(0.05, 0.6, f"Methods: strength over {inputs.strength_reduction_factor:g}, cohesion lost on slip.\n"
                      f"White: moved less than {slopes.MOVED_M:g} m; grey: fixed.\nArrows: displacement, scaled in each picture.",
                      va="top", fontsize=11)
    figure.suptitle("Fig. 9  Failure mechanisms")
    drawing.save(figure, file)


def _method_mechanism(jointed: JointedSlope, method: str, start: str, state: str, figure: plt.Figure, axes: plt.Axes) -> None:
    polygons, motions = jointed.blocks(method, start, state), jointed.motions(method, start, state)
    colours = ScalarMappable(Normalize(0, max(m.distance for m in motions.values())), "viridis")
    _draw_coloured(axes, polygons, jointed.cut.fixed, {name: m.distance for name, m in motions.items()}, colours, slopes.MOVED_M)
    moving = [m for m in motions.values() if m.distance > slopes.MOVED_M]
    axes.quiver([m.start[0] + m.x for m in moving], [m.start[1] + m.y for m in moving], [m.x for m in moving], [m.y for m in moving],
                color=drawing.JOINT, width=0.0022, zorder=3)
    figure.colorbar(colours, ax=axes, label="displacement [m]", shrink=0.8)


def _limit_mechanism(jointed: JointedSlope, figure: plt.Figure, axes: plt.Axes) -> None:
    _view(axes)
    outlines, velocities = jointed.cut.outlines, jointed.cut.mechanism()
    means = {name: [sum(v[k] for v in of_block) / len(of_block) for k in (0, 1)] for name, of_block in velocities.items()}
    fastest = max((x * x + y * y) ** 0.5 for x, y in means.values())
    speed = {name: (x * x + y * y) ** 0.5 / fastest for name, (x, y) in means.items()}
    colours = ScalarMappable(Normalize(0, 1), "viridis")
    _draw_coloured(axes, outlines, jointed.cut.fixed, speed, colours, _LEAST_SPEED)
    moving = [name for name, s in speed.items() if s > _LEAST_SPEED]
    centres = [[sum(p[k] for p in outlines[name]) / len(outlines[name]) for name in moving] for k in (0, 1)]
    axes.quiver(*centres, [means[n][0] for n in moving], [means[n][1] for n in moving], color=drawing.JOINT, width=0.0022, zorder=3)
    figure.colorbar(colours, ax=axes, label="velocity over the largest [-]", shrink=0.8)
    _block_axes(axes, f"limit analysis, with cohesion: velocities at F = {jointed.limit('ductile'):.3f}")


def figure_10(jointed: JointedSlope, printed: dict, file: Path) -> None:
    figure, (ours, paper, ratios) = plt.subplots(1, 3, figsize=(18, 7.0), constrained_layout=True)
    _our_run_times(jointed, ours)
    distances = printed["milestones_m"]["value"]
    for method in ("soft", "dem", "shi"):
        row = printed[method]
        minutes = [0, *row["post_failure_minutes"]]
        paper.plot(minutes, [0, *distances], METHOD_MARKER[method] + "-", color=METHOD_COLOUR[method], label=row["name"])
    paper.set_xlabel("CPU time [min]")
    paper.set_title("The paper's Table 4")
    _run_time_ratios(jointed, printed, ratios)
    for axes in (ours, paper):
        axes.set_ylabel("displacement of the toe block's centroid [m]")
        axes.set_ylim(bottom=0)
        axes.set_xlim(left=0)
    for axes in (ours, paper, ratios):
        axes.legend(fontsize=8.5, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=2)
    drawing.save(figure, file)


def _our_run_times(jointed: JointedSlope, axes: plt.Axes) -> None:
    for follower, run in slopes.FOLLOWERS.items():
        for start, line in zip(slopes.STARTS, ("-", "--")):
            reached = [Milestone(0.0, 0.0, 0.0), *jointed.milestones(follower, start)]
            axes.plot([m.cpu for m in reached], [m.displacement for m in reached], line, marker=METHOD_MARKER[follower], markersize=4,
                      color=METHOD_COLOUR[follower], markerfacecolor="none", label=f"{run.name}, {start}{_short_of(jointed, follower, start)}")
    axes.set_xlabel("CPU time of the motion [s]")
    axes.set_title("Fig. 10  Run time after failure, ours")


def _short_of(jointed: JointedSlope, follower: str, start: str) -> str:
    return " (not to the end)" if jointed.reason(follower, start) else ""


def _run_time_ratios(jointed: JointedSlope, printed: dict, axes: plt.Axes) -> None:
    """Over dem, and over UDEC, at the paper's distances."""
    distances = printed["milestones_m"]["value"]
    explicit = {m.displacement: m.cpu for m in jointed.milestones("dem", "settled")}
    for follower, run in slopes.FOLLOWERS.items():
        known = [(m.displacement, m.cpu / explicit[m.displacement]) for m in jointed.milestones(follower, "settled") if m.displacement in explicit]
        if known and follower != "dem":
            axes.plot(*zip(*known), METHOD_MARKER[follower] + "-", color=METHOD_COLOUR[follower], label=f"{run.name} / dem")
    for method in ("soft", "shi"):
        over = [a / b for a, b in zip(printed[method]["post_failure_minutes"], printed["dem"]["post_failure_minutes"])]
        axes.plot(distances, over, METHOD_MARKER[method] + ":", color=METHOD_COLOUR[method], markerfacecolor="none",
                  label=f"paper: {printed[method]['name']} / {printed['dem']['name']}")
    axes.set_yscale("log")
    axes.set_xlim(left=0)
    axes.set_xlabel("displacement of the toe block's centroid [m]")
    axes.set_ylabel("ratio of CPU times [-]")
    axes.set_title("Ratios between methods, from the settled state")
