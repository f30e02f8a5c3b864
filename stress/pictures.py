"""Draws what came out of a scene: where blocks began (outlines) and where they are (filled). Needs matplotlib."""

from pathlib import Path

from matplotlib.collections import PolyCollection
from openclose_scripts.drawing import BLOCK, INK, JOINT, ROCK, geometry, plt, save_titled

BEGIN = "start", "initial"
END = "final", "failed", "stable", "settled"
MARGIN = 0.15  # of the model around it: blocks that have left are named, not shown


def draw(states: dict[str, dict[str, list]], fixed: set[str], title: str, file: Path) -> None:
    begin = next(states[s] for s in BEGIN if s in states)
    end = next((states[s] for s in END if s in states), begin)
    figure, axes = geometry(7.5, 6)
    axes.add_collection(PolyCollection([v for n, v in end.items() if n in fixed], facecolors=ROCK, edgecolors=INK, linewidths=0.5))
    axes.add_collection(PolyCollection([v for n, v in end.items() if n not in fixed], facecolors=BLOCK, edgecolors=INK, linewidths=0.6, alpha=0.75))
    axes.add_collection(PolyCollection([v for n, v in begin.items() if n not in fixed], facecolors="none", edgecolors=JOINT, linewidths=0.4))
    xs, ys = ([p[k] for v in begin.values() for p in v] for k in (0, 1))
    margin = MARGIN * max(max(xs) - min(xs), max(ys) - min(ys))
    axes.set_xlim(min(xs) - margin, max(xs) + margin)
    axes.set_ylim(min(ys) - margin, max(ys) + margin)
    gone = sum(not any(axes.get_xlim()[0] < x < axes.get_xlim()[1] and axes.get_ylim()[0] < y < axes.get_ylim()[1] for x, y in v) for v in end.values())
    save_titled(figure, axes, title + (f"; {gone} blocks are outside the picture" if gone else ""), file)
    plt.close(figure)
