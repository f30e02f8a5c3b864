"""The comparison as a table of text on a terminal, and in Markdown."""

from collections.abc import Iterable

import comparison
from openclose_scripts.formats import significant
from openclose_scripts.markdown import number_table

_HEADINGS = ("quantity", "unit", "paper", "reference", *comparison.METHODS, *(f"dev. {m}" for m in comparison.METHODS))
_LEFT_ALIGNED = 2
NOTE = (
    "reference: closed form; in Fig. 4 the event-resolved ODE on the joint's springs. dev.: (ours - reference)/reference of the quantity, of the\n"
    "displacement itself where an error in % is shown; hard has no springs to stretch and is compared with eq. (8). In Fig. 4 shi has the joint's\n"
    "springs unless its own penalty is named. Shi's sliding contact locks only when slip turns round: at 25 deg its limit is not the ODE.\n"
    "Of examples 3.3 and 3.4 the reference is the closed form for the whole wedge, else rigid-block limit analysis (without cohesion where slip ends it)."
)


def number(text: str, digits: int = 6) -> str:
    """A cell of the comparison with few digits, fewer still where it is tiny; what is no number stays as it is."""
    try:
        value = float(text)
    except ValueError:
        return text
    return significant(value, digits) if value == 0 or abs(value) >= 1e-3 else f"{value:.{min(digits, 3) - 1}e}"


def _line(cells: Iterable[str], widths: list[int]) -> str:
    aligned = [c.ljust(w) if i < _LEFT_ALIGNED else c.rjust(w) for i, (c, w) in enumerate(zip(cells, widths))]
    return "  ".join(aligned).rstrip()


def _short(row: dict[str, str]) -> list[str]:
    values = [number(row[c]) for c in ("paper", "closed_form", *comparison.METHODS)]
    deviations = [number(row[f"deviation_{m}"], 2) for m in comparison.METHODS]
    return [row["quantity"], row["unit"], *values, *deviations]


def comparison_text(rows: list[dict[str, str]]) -> str:
    """The comparison in aligned columns, a heading for each item."""
    short = [_short(row) for row in rows]
    widths = [max(len(cells[i]) for cells in (_HEADINGS, *short)) for i in range(len(_HEADINGS))]
    heading = _line(_HEADINGS, widths)
    lines = [heading, "-" * len(heading)]
    item = None
    for row, cells in zip(rows, short):
        if row["item"] != item:
            item = row["item"]
            lines.append(item)
        lines.append(_line(cells, widths))
    return "\n".join(lines)


def comparison_markdown(rows: list[dict[str, str]]) -> str:
    return number_table(("item", *_HEADINGS), ([row["item"], *_short(row)] for row in rows))
