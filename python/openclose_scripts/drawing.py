"""What the figures share: colours, the canvas, dimension lines, springs."""

import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

DPI = 130
ROCK, BLOCK, JOINT, INK = "#d9d2c5", "#a9bcd0", "#b03a2e", "#222222"
METHOD_COLOUR = {"soft": "#1f77b4", "soft_paper_step": "#17becf", "hard": "#2ca02c", "shi": "#d62728", "dem": "#9467bd",
                 "shi_joint_springs": "#ff7f0e"}
METHOD_LABEL = {"soft": "soft", "hard": "hard", "shi": "shi, its own penalty", "shi_joint_springs": "shi, the joint's springs"}
METHOD_MARKER = {"soft": "o", "hard": "s", "shi": "^", "dem": "D", "soft_paper_step": "P", "shi_joint_springs": "v"}
REFERENCE = "#000000"

plt.rcParams.update({"font.size": 9.5, "axes.grid": True, "grid.alpha": 0.3, "axes.axisbelow": True, "legend.framealpha": 0.95})

Point = tuple[float, float]


def save(figure: plt.Figure, file: Path) -> None:
    figure.savefig(file, dpi=DPI)
    plt.close(figure)


def save_titled(figure: plt.Figure, axes: plt.Axes, title: str, file: Path) -> None:
    axes.set_title(title, fontsize=10)
    save(figure, file)


def sketch(width: float, height: float) -> tuple[plt.Figure, plt.Axes]:
    """A canvas without axes, equal scales."""
    figure, axes = plt.subplots(figsize=(width, height), constrained_layout=True)
    axes.set_aspect("equal")
    axes.axis("off")
    return figure, axes


def geometry(width: float, height: float) -> tuple[plt.Figure, plt.Axes]:
    """Axes in metres, equal scales."""
    figure, axes = plt.subplots(figsize=(width, height), constrained_layout=True)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    return figure, axes


def polygon(axes: plt.Axes, vertices: list[Point], colour: str, **style) -> None:
    x, y = zip(*vertices)
    axes.fill(x, y, facecolor=colour, edgecolor=INK, linewidth=1.2, **style)


def label(axes: plt.Axes, at: Point, text: str, **style) -> None:
    axes.text(*at, text, **{"ha": "center", "va": "center", **style})


def arrow(axes: plt.Axes, tail: Point, head: Point, style: str = "-|>", colour: str = INK) -> None:
    axes.annotate("", xy=head, xytext=tail, arrowprops={"arrowstyle": style, "color": colour, "shrinkA": 0, "shrinkB": 0, "lw": 1.2})


def dimension(axes: plt.Axes, a: Point, b: Point, offset: float, text: str, gap: float) -> None:
    """A dimension line parallel to ab, `offset` to its left (negative: right), with the text `gap` beyond it."""
    length = math.dist(a, b)
    direction = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
    left = (-direction[1], direction[0])

    def moved(p: Point, distance: float) -> Point:
        return (p[0] + left[0] * distance, p[1] + left[1] * distance)

    for p in (a, b):
        axes.plot(*zip(p, moved(p, offset)), color=INK, linewidth=0.6)
    arrow(axes, moved(a, offset), moved(b, offset), style="<|-|>")
    angle = math.degrees(math.atan2(direction[1], direction[0]))
    upright = (angle + 89.9) % 180 - 89.9
    middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    label(axes, moved(middle, offset + math.copysign(gap, offset)), text, rotation=upright, rotation_mode="anchor")


def angle_mark(axes: plt.Axes, corner: Point, radius: float, start_deg: float, end_deg: float, text: str, text_at: Point) -> None:
    """An arc with its text between two directions."""
    steps = [math.radians(start_deg + (end_deg - start_deg) * k / 40) for k in range(41)]
    axes.plot([corner[0] + radius * math.cos(s) for s in steps], [corner[1] + radius * math.sin(s) for s in steps], color=INK, linewidth=0.9)
    label(axes, text_at, text)


def spring(axes: plt.Axes, a: Point, b: Point, amplitude: float, colour: str) -> None:
    """A zigzag from a to b with straight ends."""
    length = math.dist(a, b)
    along = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
    across = (-along[1], along[0])
    turns = 8
    stations = [(0.0, 0.0), (0.18, 0.0)]
    stations += [(0.18 + 0.64 * (k + 0.5) / turns, amplitude if k % 2 else -amplitude) for k in range(turns)]
    stations += [(0.82, 0.0), (1.0, 0.0)]
    points = [(a[0] + s * length * along[0] + w * across[0], a[1] + s * length * along[1] + w * across[1]) for s, w in stations]
    axes.plot(*zip(*points), color=colour, linewidth=1.8, solid_joinstyle="round")
