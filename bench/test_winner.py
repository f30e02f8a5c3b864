"""python3 -m unittest discover -s bench"""

import math
import unittest

from measure import Row
from winner import fastest, judge, may_win


def row(method: str, cpu: float | None, error: float | None, reason: str = "") -> Row:
    low, high = (None, None) if cpu is None else (0.9 * cpu, 1.1 * cpu)
    return Row("scene", method, 1, 1, 1e-3, 1, 1, cpu, error, 0.0, 1, 1, low, high, "study", "what", reason)


class Winner(unittest.TestCase):
    def test_beyond_one_per_cent_nothing_wins(self):
        self.assertIsNone(fastest([row("fast", 1e-3, 0.0101)]))
        self.assertIsNone(fastest([row("fast", 1e-3, 0.5)], error=1.0))
        self.assertEqual(judge([row("fast", 1e-3, 0.02), row("right", 1.0, 1e-3)]).winner.method, "right")

    def test_without_an_error_or_with_a_reason_nothing_wins(self):
        self.assertFalse(may_win(row("unknown", 1.0, None)))
        self.assertFalse(may_win(row("failed", 1.0, 0.0, "not converged")))
        self.assertFalse(may_win(row("stopped", None, 0.0)))
        self.assertFalse(may_win(row("not a number", 1.0, math.nan)))

    def test_the_fastest_of_a_method_counts(self):
        verdict = judge([row("a", 2.0, 1e-3), row("a", 1.0, 5e-3), row("b", 3.0, 1e-5)])
        self.assertEqual((verdict.winner.method, verdict.winner.cpu_s), ("a", 1.0))
        self.assertEqual(verdict.ratios, {"b": 3.0})
        self.assertEqual(judge([row("a", 2.0, 1e-3), row("a", 1.0, 5e-3), row("b", 3.0, 1e-5)], 1e-3).winner.cpu_s, 2.0)

    def test_overlapping_spreads_are_a_tie(self):
        self.assertEqual(judge([row("a", 1.0, 1e-3), row("b", 1.1, 1e-3), row("c", 2.0, 1e-3)]).tied, ("b",))


if __name__ == "__main__":
    unittest.main()
