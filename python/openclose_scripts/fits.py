"""Laws through measured points."""

import math


def exponent(x: list[float], y: list[float]) -> float:
    """Of the power law through the points, by least squares of the logarithms."""
    lx, ly = [math.log(v) for v in x], [math.log(v) for v in y]
    mx, my = sum(lx) / len(lx), sum(ly) / len(ly)
    return sum((a - mx) * (b - my) for a, b in zip(lx, ly)) / sum((a - mx) ** 2 for a in lx)
