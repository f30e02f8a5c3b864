#!/usr/bin/env python3
"""Makes verification.md, a page to read, from what openclose-verify wrote: verify.csv, verify_series.csv and verify_cases.csv.

Draws and arranges only; every number comes from those files.

    verification/report.py --results results
"""

import argparse
import math
from collections import defaultdict
from pathlib import Path

from matplotlib.ticker import LogFormatterSciNotation, MaxNLocator, NullFormatter
from openclose_scripts.csv_rows import read_rows
from openclose_scripts.drawing import METHOD_COLOUR, METHOD_MARKER, plt, save
from openclose_scripts.markdown import markdown_table

METHODS = ["soft", "hard", "shi", "dem"]
LAST_VALUE = "last value: "
FAILS = "fails: "
COLUMNS = 3  # panels beside each other
OPEN = {"linestyle": "none", "fillstyle": "none"}  # so that points in one place are all seen


def number(text: str) -> float:
    return float(text) if text else math.nan


class Row:
    """A line of verify.csv."""

    def __init__(self, line: dict):
        self.case, self.quantity, self.method = line["case"], line["quantity"], line["method"]
        self.unit, self.status, self.source = line["unit"], line["status"], line["source"]
        self.expected, self.measured = number(line["expected"]), number(line["measured"])
        self.error, self.tolerance = number(line["error"]), number(line["tolerance"])

    @property
    def left_out(self) -> bool:
        return self.status == "left out"

    def bounds(self) -> tuple[float, float]:
        """Least and largest value allowed; tolerances are absolute or relative as the error is."""
        absolute = math.isclose(self.error, abs(self.measured - self.expected), rel_tol=1e-3, abs_tol=1e-300)
        half = self.tolerance if absolute else self.tolerance * abs(self.expected)
        return self.expected - half, self.expected + half

    def key(self) -> tuple:
        """Rows that differ in nothing but the method stand in one line."""
        return self.quantity, self.expected, self.tolerance, self.unit


class Series(dict):
    """Points (size, error) by case, quantity, method."""

    def __init__(self, lines: list[dict]):
        super().__init__()
        self.size_name = {}
        for p in lines:
            key = p["case"], p["quantity"], p["method"]
            self.setdefault(key, []).append((number(p["size"]), number(p["error"])))
            self.size_name[key] = p["size_name"]

    def of(self, row: Row) -> list[tuple[float, float]]:
        return self.get((row.case, row.quantity, row.method), [])


SIZES = {
    "dt_s": "dt [s]",
    "compliance_m2_per_n": "1/kn of a corner [m²/N]",
    "stiffness_n_per_m2": "k of a corner [N/m²]",
    "compliance_m_per_pa": "1/kn of the joint [m/Pa]",
}


def panels(count: int, height: float = 2.6):
    columns = min(COLUMNS, count)
    rows = math.ceil(count / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.9 * columns, height * rows), squeeze=False, constrained_layout=True)
    for unused in axes.flat[count:]:
        unused.axis("off")
    return figure, list(axes.flat[:count])


def wrapped(text: str, width: int = 44) -> str:
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)


def style(method: str) -> dict:
    return {"color": METHOD_COLOUR.get(method, "#555555"), "marker": METHOD_MARKER.get(method, "o")}


def theoretical_order(row: Row) -> float:
    """The whole number within the bounds, the lower one of two."""
    low, high = row.expected - row.tolerance, row.expected + row.tolerance
    return float(math.ceil(low)) if math.ceil(low) <= high else row.expected


def draw_convergence(rows: list[Row], series: Series, file: Path) -> None:
    """A panel for each quantity: error over size by method, and the slope that theory gives."""
    quantities = list(dict.fromkeys(r.quantity for r in rows))
    figure, axes = panels(len(quantities))
    for ax, quantity in zip(axes, quantities):
        here = [r for r in rows if r.quantity == quantity]
        for r in here:
            x, y = zip(*sorted(series.of(r)))
            ax.loglog(x, y, label=r.method, markersize=4, **style(r.method), linewidth=1.2, alpha=0.85)
        for order in dict.fromkeys(theoretical_order(r) for r in here):
            x, y = zip(*sorted(series.of(next(r for r in here if theoretical_order(r) == order))))
            # Beside the points, a third below.
            ax.loglog(x, [0.33 * y[-1] * (v / x[-1]) ** order for v in x], color="k", linestyle="--", linewidth=1, label=f"slope {order:g}")
        ax.set_title(wrapped(quantity), fontsize=8)
        size = series.size_name[here[0].case, quantity, here[0].method]
        ax.set_xlabel(SIZES.get(size, size), fontsize=8)
        ax.set_ylabel("error", fontsize=8)
        ax.tick_params(labelsize=7)
        for axis in (ax.xaxis, ax.yaxis):
            decades = math.log10(axis.get_view_interval()[1] / axis.get_view_interval()[0])
            axis.set_minor_formatter(LogFormatterSciNotation(minor_thresholds=(1.2, 0.5)) if decades < 1.2 else NullFormatter())
        ax.tick_params(which="minor", labelsize=6)
        low, high = ax.get_ylim()
        ax.set_ylim(low, high * (high / low) ** 0.4)  # room for the legend
        ax.legend(fontsize=7, ncol=3, loc="upper left")
    save(figure, file)


def draw_values(rows: list[Row], file: Path) -> None:
    """Measured against expected by unit, where something else than zero is expected; how much of the tolerance the error uses."""
    units = list(dict.fromkeys(r.unit for r in rows if r.expected != 0 and math.isfinite(r.measured)))
    figure, axes = panels(len(units) + 1)
    for ax, unit in zip(axes, units):
        here = [r for r in rows if r.unit == unit and r.expected != 0 and math.isfinite(r.measured)]
        for method in dict.fromkeys(r.method for r in here):
            mine = [r for r in here if r.method == method]
            ax.plot([r.expected for r in mine], [r.measured for r in mine], markersize=5, label=method, **OPEN, **style(method))
        bounds = [(r.expected, *r.bounds()) for r in here]
        ax.vlines(*zip(*bounds), color="#bbbbbb", linewidth=4, zorder=1, label="allowed")
        values = [v for r in here for v in (r.expected, r.measured)] + [v for b in bounds for v in b[1:]]
        low, high = min(values), max(values)
        if low > 0 and high > 100 * low:
            ax.set_xscale("log")
            ax.set_yscale("log")
            ends = [low / 2, high * 2]
        else:
            room = max(0.1 * (high - low), 1e-6 * abs(high))
            ends = [low - room, high + room]
        ax.plot(ends, ends, color="k", linewidth=0.8, zorder=0)
        ax.set_xlim(ends)
        ax.set_ylim(ends)
        ax.set_xlabel(f"expected [{unit}]", fontsize=8)
        ax.set_ylabel(f"measured [{unit}]", fontsize=8)
        if ax.get_xscale() == "linear":
            ax.ticklabel_format(useOffset=False)
            ax.xaxis.set_major_locator(MaxNLocator(3))
        ax.tick_params(labelsize=7)
        ax.legend(fontsize=7, loc="lower right")
    ax = axes[-1]
    floor = 1e-8  # what is exact is drawn there
    line = {key: i for i, key in enumerate(dict.fromkeys(r.key() for r in rows), start=1)}
    for method in dict.fromkeys(r.method for r in rows):
        mine = [(line[r.key()], r) for r in rows if r.method == method and math.isfinite(r.error)]
        share = [max(floor, r.error / r.tolerance if r.tolerance > 0 else (floor if r.error == 0 else math.inf)) for _, r in mine]
        ax.semilogy([i for i, _ in mine], share, markersize=4, label=method, **OPEN, **style(method))
    ax.axhline(1.0, color="k", linestyle="--", linewidth=1)
    ax.set_ylim(floor * 3e-4, 5)  # room for the legend
    ax.set_xlim(0.5, len(line) + 0.5)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_xlabel("line of the table", fontsize=8)
    ax.set_ylabel("error over what is allowed", fontsize=8)
    ax.tick_params(labelsize=7)
    ax.legend(fontsize=7, ncol=2, loc="lower right", framealpha=0.6)
    save(figure, file)


def in_unit(row: Row) -> str:
    return f"{row.expected:.9g}" + ("" if row.unit == "-" else f" {row.unit}")


def escaped(text: str) -> str:
    return text.replace("|", "\\|")


def cell(row: Row, series: Series) -> str:
    if series.of(row):
        errors = [e for _, e in series.of(row)]
        ratios = ", ".join(f"{a / b:.3g}" if b else "-" for a, b in zip(errors, errors[1:]))
        text = f"{row.measured:.3f} ({ratios})"
    else:
        text = f"{row.measured:.9g} ({row.error:.1e})"
    return text if row.status == "pass" else f"**FAIL** {text}"


def table(rows: list[Row], series: Series, head: tuple[str, str], expected) -> list[str]:
    """One line a quantity, a column for each method that occurs."""
    methods = [m for m in METHODS if any(r.method == m for r in rows)]
    methods += [m for m in dict.fromkeys(r.method for r in rows) if m not in METHODS]
    lines = []
    groups = defaultdict(list)
    for r in rows:
        groups[r.key()].append(r)
    for group in groups.values():
        # The same quantity may be checked twice by one method; each check has its line.
        for turn in range(max(sum(r.method == m for r in group) for m in methods)):
            mine = {}
            for m in methods:
                of_method = [r for r in group if r.method == m]
                if turn < len(of_method):
                    mine[m] = of_method[turn]
            first = next(iter(mine.values()))
            source = first.source.split(" (")[0] if series.of(first) else first.source
            cells = (cell(mine[m], series) if m in mine else "" for m in methods)
            lines.append([escaped(first.quantity), expected(first), *cells, escaped(source)])
    return [markdown_table([*head, *methods, "from"], lines), ""]


def counts(rows: list[Row]) -> str:
    passed, failed, left_out = (sum(r.status == s for r in rows) for s in ("pass", "fail", "left out"))
    parts = [f"{passed} passed"] + ([f"**{failed} failed**"] if failed else []) + ([f"{left_out} left out"] if left_out else [])
    return ", ".join(parts)


def case_section(name: str, title: str, rows: list[Row], series: Series, folder: Path) -> list[str]:
    lines = [f"## {name}: {title}", "", counts(rows) + ".", ""]
    orders = [r for r in rows if series.of(r)]
    last = [r for r in rows if r.quantity.startswith(LAST_VALUE)]
    values = [r for r in rows if not r.left_out and r not in orders and r not in last]
    drawn = [r for r in orders if all(e > 0 for _, e in series.of(r))]
    if drawn:
        draw_convergence(drawn, series, folder / f"{name.lower()}_convergence.png")
        lines += [f"![{name}: convergence](verification/{name.lower()}_convergence.png)", ""]
    if orders:
        lines += ["Observed order (ratio of the errors of one refinement to the next):", ""]
        lines += table(orders, series, ("quantity", "order, from theory"), lambda r: f"{r.expected - r.tolerance:.3g} to {r.expected + r.tolerance:.3g}")
    if values:
        draw_values(values, folder / f"{name.lower()}_values.png")
        lines += [f"![{name}: values](verification/{name.lower()}_values.png)", "", "Measured (error; relative or absolute as its tolerance):", ""]
        lines += table(values, series, ("quantity", "expected, allowed"), lambda r: f"{in_unit(r)}, {r.tolerance:.1e}")
    if last:
        lines += [f"Last values: {sum(r.status == 'pass' for r in last)} of {len(last)} unchanged."]
        changed = [r for r in last if r.status != "pass"]
        lines += [f"- **changed**: {r.quantity.removeprefix(LAST_VALUE)}, {r.method}: {r.expected:.12g}, now {r.measured:.12g}" for r in changed]
        lines += [""]
    reasons = [r for r in rows if r.left_out]
    if reasons:
        lines += ["Left out:", ""] + [f"- {r.quantity}, `{r.method}`: {r.source}" for r in reasons] + [""]
    return lines


INTRODUCTION = """# Verification

Made by `make verify` from `verify.csv` and `verify_series.csv`. Every row compares a result of the program with a closed form or a reference
solution; its tolerance comes from theory, or its order is bounded from both sides. With a solver that does nothing every row fails.

Pictures: errors over step or compliance with the slope that theory gives; measured over expected values by unit, grey what is allowed; errors over
what is allowed, which fail above the dashed line (what is exact is drawn at 1e-8).
"""


def how_far(row: Row) -> str:
    if row.left_out:
        return row.source.removeprefix(FAILS)
    return f"{row.measured:.6g} for {row.expected:.6g}, error {row.error:.2e} of {row.tolerance:.2e}"


def page(rows: list[Row], titles: dict, series: Series, folder: Path) -> str:
    cases = list(dict.fromkeys(r.case for r in rows))
    by_case = {c: [r for r in rows if r.case == c] for c in cases}
    unreached = [r for r in rows if r.status == "fail" or (r.left_out and r.source.startswith(FAILS))]
    lines = [INTRODUCTION, f"In all: {counts(rows)}.", "", "## Goals not reached", ""]
    lines += [f"- {r.case}, {r.quantity}, `{r.method}`: {how_far(r)}" for r in unreached] or ["None."]
    lines += ["", "## Cases", "", markdown_table(("case", "what", "rows"), ([c, titles.get(c, ""), counts(by_case[c])] for c in cases)), ""]
    for c in cases:
        lines += case_section(c, titles.get(c, ""), by_case[c], series, folder)
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description="Makes verification.md and its pictures from the files of openclose-verify.")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder of verify.csv, and of the page")
    results = parser.parse_args().results
    rows = [Row(line) for line in read_rows(results / "verify.csv")]
    titles = defaultdict(list)
    for line in read_rows(results / "verify_cases.csv"):
        titles[line["case"]].append(line["title"])
    folder = results / "verification"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("*.png"):
        old.unlink()
    series = Series(read_rows(results / "verify_series.csv"))
    text = page(rows, {case: "; ".join(t) for case, t in titles.items()}, series, folder)
    (results / "verification.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
