"""stress.md: counts by part and method, how much energy was created, how far below limit analysis factors are, and the worst scenes drawn."""

import statistics
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from campaign import Row
from openclose_scripts.markdown import markdown_table
from verdicts import APART, AT_THE_LIMIT, FALSE, REFUSED, RIGHT, SLOW, WIDEST_BRACKET

VERDICTS = RIGHT, APART, REFUSED, FALSE, SLOW
WORST = 10
QUANTILES = (("median", 0.5), ("90 %", 0.9), ("99 %", 0.99), ("largest", 1.0))


def write(rows: list[Row], pictures: list[tuple[Row, str]], command: str, file: Path) -> None:
    """`pictures` are files, from the folder of the page."""
    lines = ["# Random scenes", "", f"Made by `{command}`. A verdict comes from rules that know nothing of the method (`stress/verdicts.py`); every row is in `stress.csv`.", ""]
    lines += _counts(rows) + _reasons(rows) + _energy(rows) + _distances(rows) + _brackets(rows) + _times(rows) + _worst(pictures)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _groups(rows: list[Row], key: Callable[[Row], tuple] = lambda row: (row.part, row.method)) -> dict[tuple, list[Row]]:
    groups: dict[tuple, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def _counts(rows: list[Row]) -> list[str]:
    body = []
    for key, group in _groups(rows).items():
        count = Counter(row.verdict for row in group)
        body.append([*key, len(group), *(count[v] for v in VERDICTS)])
    return ["## Verdicts", "", markdown_table(["part", "method", "scenes", *VERDICTS], body), ""]


def _reasons(rows: list[Row]) -> list[str]:
    """Numbers left out, so that like reasons stand together."""
    count = Counter((row.verdict, row.method.split(",")[0], _without_numbers(row.reason)) for row in rows if row.verdict != RIGHT)
    body = [[*key, n] for key, n in sorted(count.items(), key=lambda item: (item[0][0], -item[1]))]
    return ["## Reasons", "", markdown_table(["verdict", "method", "reason", "scenes"], body), ""]


def _without_numbers(reason: str) -> str:
    return " ".join("..." if any(c.isdigit() for c in word) else word for word in reason.split())


def _quantile(values: list[float], part: float) -> float:
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))]


def _energy(rows: list[Row]) -> list[str]:
    body = []
    for key, group in _groups([row for row in rows if row.energy_rise is not None]).items():
        values = [row.energy_rise for row in group]
        body.append([*key, len(values), *(f"{_quantile(values, part):.2g}" for _, part in QUANTILES)])
    text = "Largest rise of kinetic, potential and stored energy from any earlier output time, over the start's (or the work done), of all scenes with a result."
    return ["## Energy created", "", text, "", markdown_table(["part", "method", "scenes", *(name for name, _ in QUANTILES)], body), ""] if body else []


def _distances(rows: list[Row]) -> list[str]:
    known = [row for row in rows if row.verdict == RIGHT and row.stable and row.limit_analysis not in (None, 0.0, float("inf"))]
    body = []
    for key, group in _groups(known, lambda row: (row.part, row.method, "c = 0" if "cohesion_pa=0 " in row.drawn else "c > 0")).items():
        ratios = [row.stable / row.limit_analysis for row in group]
        body.append([*key, len(ratios), f"{statistics.median(ratios):.4f}", f"{_quantile(ratios, 0.1):.4f}", f"{min(ratios):.4f}",
                     f"{sum(q >= AT_THE_LIMIT for q in ratios)} of {len(ratios)}"])
    head = ["part", "method", "cohesion", "scenes", "median", "10 %", "least", f"at least {AT_THE_LIMIT}"]
    return ["## Factor over limit analysis", "", markdown_table(head, body), ""] if body else []


def _brackets(rows: list[Row]) -> list[str]:
    """What `fos` says of its own answers."""
    count = {key: Counter(row.answer for row in group) for key, group in _groups([row for row in rows if row.answer]).items()}
    answers = sorted({a for c in count.values() for a in c})
    narrow = Counter((row.part, row.method) for row in rows if row.stable and row.failed and row.failed - row.stable <= WIDEST_BRACKET * row.stable)
    head = ["part", "method", *answers, f"both ends proved, within {WIDEST_BRACKET:.1%}"]
    return ["## Answers of `fos`", "", markdown_table(head, [[*key, *(c[a] for a in answers), narrow[key]] for key, c in count.items()]), ""] if count else []


def _times(rows: list[Row]) -> list[str]:
    body = [[*key, f"{statistics.median(row.cpu_s for row in group):.3g}", f"{_quantile([row.cpu_s for row in group], 0.9):.3g}", f"{max(row.cpu_s for row in group):.3g}"]
            for key, group in _groups([row for row in rows if row.exit is not None]).items()]
    return ["## CPU time [s]", "", markdown_table(["part", "method", "median", "90 %", "largest"], body), ""]


def severity(row: Row) -> tuple[bool, float]:
    """To find the worst: a false answer before others, then what was created, what overlaps, and how far from limit analysis a factor is."""
    distance = abs(1 - row.stable / row.limit_analysis) if row.stable and row.limit_analysis else 0.0
    return row.verdict == FALSE, max(row.energy_rise or 0.0, row.overlap or 0.0, distance)


def worst(rows: list[Row]) -> list[Row]:
    """One of each scene, as far as there are that many."""
    chosen: dict[tuple, Row] = {}
    for row in sorted((row for row in rows if row.exit is not None), key=severity, reverse=True):
        chosen.setdefault((row.part, row.seed), row)
    return list(chosen.values())[:WORST]


def _worst(pictures: list[tuple[Row, str]]) -> list[str]:
    lines = ["## The worst", ""]
    for row, picture in pictures:
        lines += [f"**{row.part} {row.seed}, {row.method}**: {row.verdict}{': ' if row.reason else ''}{row.reason}  ", f"{row.drawn}", "", f"![]({picture})", ""]
    return lines if pictures else []
