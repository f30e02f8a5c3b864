"""Draws results/convergence.csv: one picture a study."""

import argparse
import math
import sys
from pathlib import Path

from openclose_scripts import drawing
from openclose_scripts.csv_rows import read_rows
from openclose_scripts.drawing import plt

LINES = ("-", "--", ":", "-.")


def read(file: Path) -> dict[str, dict[str, list[dict[str, str]]]]:
    """Rows by study and series."""
    studies: dict[str, dict[str, list[dict[str, str]]]] = {}
    for row in read_rows(file):
        studies.setdefault(row["case"], {}).setdefault((row["method"], row["abscissa"]), []).append(row)
    return studies


def draw(study: str, series: dict, file: Path) -> None:
    kinds = sorted({abscissa for _, abscissa in series})
    figure, axes = plt.subplots(figsize=(8.5, 5.6), constrained_layout=True)
    markers = "osD^v<>PX*"
    for k, ((method, _), rows) in enumerate(series.items()):
        size = [float(r["size"]) for r in rows]
        error = [float(r["error"]) for r in rows]
        fitted = [(s, e) for s, e, r in zip(size, error, rows) if r["in_fit"] == "1"]
        colour = f"C{k % 10}"
        order, band = float(rows[0]["observed_order"]), float(rows[0]["order_band"])
        name = f"{method}: {order:.2f} ± {band:.2f}" + ("" if rows[0]["status"] == "pass" else "  OUT OF BOUNDS")
        axes.loglog(size, error, markers[k % len(markers)], color=colour, markersize=5, markerfacecolor="none")
        axes.loglog([], [], markers[k % len(markers)] + LINES[k // 10 % 4], color=colour, markerfacecolor="none", label=name)
        if len(fitted) > 1:
            # The fitted line, through the middle of the points it was fitted to.
            middle_x = sum(math.log(s) for s, _ in fitted) / len(fitted)
            middle_y = sum(math.log(e) for _, e in fitted) / len(fitted)
            ends = (min(s for s, _ in fitted), max(s for s, _ in fitted))
            axes.loglog(ends, [math.exp(middle_y + order * (math.log(x) - middle_x)) for x in ends], LINES[k // 10 % 4], color=colour, linewidth=1)
    unit = {"dt_s": "time step [s]"}
    axes.set_xlabel(", ".join(unit.get(kind, kind) for kind in kinds))
    axes.set_ylabel("error" + (" [-]" if study in ("spring", "sway_rock", "support", "blocks") else " [m]"))
    axes.legend(fontsize=8, title="order and its 95 % band", title_fontsize=8)
    drawing.save_titled(figure, axes, f"Convergence: {study.replace('_', ' ')}", file)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", type=Path, help="convergence.csv")
    parser.add_argument("folder", type=Path, help="where the pictures go")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for study, series in read(arguments.table).items():
        draw(study, series, arguments.folder / f"{study}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
