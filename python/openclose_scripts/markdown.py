"""Tables in Markdown."""

from collections.abc import Iterable


def markdown_table(headings: Iterable[object], rows: Iterable[Iterable[object]]) -> str:
    """Without a line end after the last row."""
    headings = list(headings)
    return _lines(headings, "---|" * len(headings), rows)


def number_table(headings: Iterable[object], rows: Iterable[Iterable[object]]) -> str:
    """The same, with text in the first column and all others aligned to the right."""
    headings = list(headings)
    return _lines(headings, "---|" + "---:|" * (len(headings) - 1), rows)


def _lines(headings: list[object], rule: str, rows: Iterable[Iterable[object]]) -> str:
    return "\n".join([_line(headings), "|" + rule, *map(_line, rows)])


def _line(cells: Iterable[object]) -> str:
    return "| " + " | ".join(map(str, cells)) + " |"
