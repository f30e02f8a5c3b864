"""The figures of the benchmarks."""

from collections.abc import Callable
from pathlib import Path

import failure
import matplotlib.pyplot as plt
import motion
import peers
import scaling
import skips
import statics
import table_4
from measure import Bench, Row
from openclose_scripts.drawing import METHOD_COLOUR, METHOD_MARKER, save
from winner import LARGEST_ERROR

SMALLEST_ERROR = 1e-9  # smaller ones, rounding, are drawn there
SMALLEST_SHOWN = 1e-4  # of a critical angle: finer than the brackets
LEGEND_COLUMNS = 4  # below the panels
LEGEND_LINE_INCHES = 0.2
COLOUR = {**METHOD_COLOUR, "soft shi": "#1f77b4", "soft theta 1/2": "#17becf", "soft generalized_alpha": "#e377c2", "soft tr_bdf2": "#bcbd22",
          "soft path_average": "#8c564b", "soft path_average adaptive": "#ff7f0e", "soft shi adaptive": "#000080", "soft, 10 ms": "#8c564b"}
MARKER = {**METHOD_MARKER, "soft shi": "o", "soft theta 1/2": "P", "soft generalized_alpha": "X", "soft tr_bdf2": "v", "soft path_average": "*",
          "soft path_average adaptive": "<", "soft shi adaptive": ">"}


# Of methods that share a colour, as they come.
VARIANTS = (("-", "full"), ("--", "none"), (":", "left"), ("-.", "right"), ((0, (1, 1)), "top"), ((0, (5, 1)), "bottom"))


def _methods(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(row.method for row in rows))


def _styles(methods: list[str]) -> dict[str, dict]:
    """\\return how to draw each: variants of a method, whose names begin with its name, in its colour and with its marker."""
    styles, met = {}, {}
    for method in methods:
        known = [name for name in COLOUR if method == name or method.startswith((name + " ", name + ","))]
        base = max(known, key=len, default=method)
        line, fill = VARIANTS[met.get(base, 0) % len(VARIANTS)]
        met[base] = met.get(base, 0) + 1
        styles[method] = {"color": COLOUR.get(base), "marker": MARKER.get(base, "o"), "linestyle": line, "fillstyle": fill}
    return styles


def _spread(axes: plt.Axes, rows: list[Row], x: Callable[[Row], float], y: Callable[[Row], float], style: dict) -> None:
    low = [y(r) * (1 - r.cpu_min_s / r.cpu_s) if r.cpu_s else 0.0 for r in rows]
    high = [y(r) * (r.cpu_max_s / r.cpu_s - 1) if r.cpu_s else 0.0 for r in rows]
    axes.errorbar([x(r) for r in rows], [y(r) for r in rows], yerr=[low, high], markersize=5, linewidth=1.1, capsize=2, label=rows[0].method, **style)


def _work_precision(axes: plt.Axes, rows: list[Row], title: str, styles: dict[str, dict]) -> None:
    for method in _methods(rows):
        good = [r for r in rows if r.method == method and not r.reason and r.error is not None and r.cpu_s]
        if good:
            _spread(axes, good, lambda r: max(r.error, SMALLEST_ERROR), lambda r: r.cpu_s, styles[method])
    axes.axvline(LARGEST_ERROR, color="#222222", linestyle="--", linewidth=1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("error [-]; right of the dashed line nothing wins")
    axes.set_ylabel("CPU time [s]")


def _panels(bench: Bench, study: str, file: Path, columns: int = 2) -> bool:
    scenes = list(dict.fromkeys(row.scene for row in bench.of(study) if not row.reason and row.error is not None))
    if not scenes:
        return False
    lines = -(-len(scenes) // columns)
    wide = min(columns, len(scenes))
    styles = _styles(_methods(bench.of(study)))
    legend = 0.3 + LEGEND_LINE_INCHES * -(-len(styles) // LEGEND_COLUMNS)
    high = 4.4 * lines + legend
    figure, axes = plt.subplots(lines, wide, figsize=(6.2 * wide, high), squeeze=False)
    figure.subplots_adjust(left=0.6 / (6.2 * wide) * 1.4, right=0.985, top=1 - 0.35 / high, bottom=(legend + 0.5) / high, wspace=0.2, hspace=0.3)
    for place, scene in zip(axes.flat, scenes):
        _work_precision(place, bench.of(study, scene), scene, styles)
    for place in list(axes.flat)[len(scenes):]:
        place.axis("off")
    handles = {label: handle for place in axes.flat for handle, label in zip(*place.get_legend_handles_labels())}
    figure.legend(handles.values(), handles.keys(), loc="lower center", ncol=LEGEND_COLUMNS, fontsize=8)
    save(figure, file)
    return True


def _by_size(bench: Bench, file: Path) -> bool:
    settled, moved = ([r for r in bench.of(study) if not r.reason] for study in (scaling.SETTLING, scaling.MOTION))
    if not settled:
        return False
    figure, axes = plt.subplots(2, 2, figsize=(11, 8.4), constrained_layout=True)
    panels = ((axes[0, 0], settled, lambda r: r.cpu_s, "static equilibrium from nothing: CPU time [s]"),
              (axes[0, 1], moved, lambda r: r.cpu_s / r.steps, "a step of motion (dem: its own): CPU time [s]"),
              (axes[1, 0], moved, lambda r: r.cpu_s / r.iterations if r.iterations else None, "an iteration of motion: CPU time [s]"),
              (axes[1, 1], settled, lambda r: r.peak_memory_bytes / r.blocks, "peak memory of the process over the blocks [bytes]"))
    for place, rows, of, title in panels:
        for method in _methods(rows):
            good = [r for r in rows if r.method == method and of(r)]
            if good:
                place.plot([r.blocks for r in good], [of(r) for r in good], color=COLOUR.get(method), marker=MARKER.get(method), label=method)
        place.set_xscale("log")
        place.set_yscale("log")
        place.set_title(title, fontsize=10)
        place.set_xlabel("blocks")
        place.legend()
    save(figure, file)
    return True


def _stages(bench: Bench, file: Path) -> bool:
    found = skips.stages(bench) if bench.of(skips.STUDY) else {}
    if not found:
        return False
    figure, axes = plt.subplots(figsize=(7, 3.2), constrained_layout=True)
    colours = {"detection": "#4c72b0", "solution": "#dd8452", "bookkeeping": "#8c8c8c"}
    left = dict.fromkeys(found, 0.0)
    for stage in next(iter(found.values())):
        parts = {m: 100 * times[stage] / sum(times.values()) for m, times in found.items()}
        axes.barh(list(parts), list(parts.values()), left=list(left.values()), color=colours.get(stage), label=stage)
        left = {m: left[m] + part for m, part in parts.items()}
    axes.set_xlabel("part of the time [%], example 3.4 settled and in failure")
    axes.invert_yaxis()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.2), ncol=3)
    save(figure, file)
    return True


def _fig_10(bench: Bench, file: Path, printed: dict) -> bool:
    if not bench.of(table_4.STUDY):
        return False
    distances = printed["table_4"]["milestones_m"]["value"]
    found = table_4.rows(bench, printed)[1:]
    figure, axes = plt.subplots(figsize=(8.4, 4.6), constrained_layout=True)
    for method in found[0][1]:
        points = [(d, ours[method]) for d, (_, ours, _) in zip(distances, found) if ours[method]]
        if points:
            axes.plot(*zip(*points), color=COLOUR.get(method), marker=MARKER.get(method, "o"), label=f"{method}, here")
        points = [(d, paper[method]) for d, (_, _, paper) in zip(distances, found) if paper.get(method)]
        if points:
            axes.plot(*zip(*points), color=COLOUR.get(method), linestyle="--", marker=MARKER.get(method, "o"), markerfacecolor="none",
                      label=f"{method}, paper")
    axes.set_yscale("log")
    axes.set_xlabel("way of the toe block [m]")
    axes.set_ylabel("time over that of soft with 1 ms [-]")
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5))
    save(figure, file)
    return True


def _peers(found: peers.Findings | None, file: Path) -> bool:
    if found is None:
        return False
    known = [c for c in found.compared if c.row.error is not None and c.per_second]
    figure, axes = plt.subplots(figsize=(7, 4.4), constrained_layout=True)
    for title, theirs, marker, colour in (("Openclose", False, "o", "#1f77b4"), ("other engines", True, "s", "#d62728")):
        points = [(max(c.row.error, SMALLEST_SHOWN), c.per_second) for c in known if bool(c.settings) == theirs]
        if points:
            axes.plot(*zip(*points), linestyle="", marker=marker, color=colour, label=title)
    for c in known:
        axes.annotate(c.name, (max(c.row.error, SMALLEST_SHOWN), c.per_second), xytext=(8, -4), textcoords="offset points", fontsize=8)
    axes.axvline(LARGEST_ERROR, color="#222222", linestyle="--", linewidth=1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(x=0.25, y=0.1)
    axes.legend(loc="lower left")
    axes.set_xlabel("error of the critical coefficient of friction [-]; right of the dashed line nothing wins")
    axes.set_ylabel("CPU time of a simulated second [s]")
    save(figure, file)
    return True


def draw(bench: Bench, found: dict, printed: dict, folder: Path) -> list[tuple[str, str]]:
    """(section, file) of the figures that there are data for."""
    figures = [
        (motion.STUDY, "motion.png", lambda file: _panels(bench, motion.STUDY, file)),
        (statics.EQUILIBRIUM, "equilibrium.png", lambda file: _panels(bench, statics.EQUILIBRIUM, file)),
        (statics.REDUCTION, "strength_reduction.png", lambda file: _panels(bench, statics.REDUCTION, file)),
        (failure.STUDY, "failure.png", lambda file: _panels(bench, failure.STUDY, file)),
        (scaling.SETTLING, "size.png", lambda file: _by_size(bench, file)),
        ("stages", "stages.png", lambda file: _stages(bench, file)),
        (table_4.STUDY, "fig_10.png", lambda file: _fig_10(bench, file, printed)),
        (peers.STUDY, "other_engines.png", lambda file: _peers(found.get("peers"), file)),
    ]
    return [(section, name) for section, name, make in figures if make(folder / name)]
