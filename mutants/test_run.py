"""In which order faults are tried."""

import unittest

import run


class Order(unittest.TestCase):
    FAULTS = [{"id": "a", "file": "x.h"}, {"id": "b", "file": "x.cpp"}, {"id": "c", "file": "y.cpp"}]

    def ids(self, *wanted):
        return [fault["id"] for fault in run.in_order(self.FAULTS, list(wanted))]

    def test_headers_come_last(self):
        self.assertEqual(self.ids(), ["b", "c", "a"])

    def test_only_those_that_are_asked_for(self):
        self.assertEqual(self.ids("a", "c"), ["c", "a"])


if __name__ == "__main__":
    unittest.main()
