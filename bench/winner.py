"""Who wins a comparison: a speed counts only together with an error that is small enough."""

from dataclasses import dataclass

from measure import Row

LARGEST_ERROR = 0.01  # [-] no run beyond it wins anything, whatever is asked for
ERRORS = (1e-2, 1e-3, 1e-4)


@dataclass(frozen=True)
class Verdict:
    """The fastest of a comparison at an error, and how much slower each other method is that gets there (its own fastest run over the winner's)."""

    error: float
    winner: Row | None
    ratios: dict[str, float]
    tied: tuple[str, ...]  # methods whose spread overlaps the winner's


def may_win(row: Row, error: float = LARGEST_ERROR) -> bool:
    return not row.reason and row.cpu_s is not None and row.error is not None and row.error <= min(error, LARGEST_ERROR)


def fastest(rows: list[Row], error: float = LARGEST_ERROR) -> Row | None:
    return min((row for row in rows if may_win(row, error)), key=lambda row: row.cpu_s, default=None)


def judge(rows: list[Row], error: float = LARGEST_ERROR) -> Verdict:
    best = {method: row for method in dict.fromkeys(row.method for row in rows)
            if (row := fastest([r for r in rows if r.method == method], error))}
    winner = min(best.values(), key=lambda row: row.cpu_s, default=None)
    if winner is None:
        return Verdict(error, None, {}, ())
    ratios = {method: row.cpu_s / winner.cpu_s for method, row in best.items() if row is not winner}
    tied = tuple(method for method, row in best.items() if row is not winner and row.cpu_min_s <= winner.cpu_max_s)
    return Verdict(error, winner, ratios, tied)
