"""Numbers as text."""


def significant(value: float | None, digits: int = 3) -> str:
    """With this many significant digits; a dash for what is not known."""
    return "-" if value is None else f"{value:.{digits}g}"
