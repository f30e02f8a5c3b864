"""Where random faults may fall, and that a seed draws the same ones again."""

import tempfile
import unittest
from pathlib import Path

import random_faults

SOURCE = """#include <x - y>
// a - b in a comment
static_assert(a - b > 0);
const char* text = "a - b";
/* c + d
   over lines */
double f(double a, double b) { return g(a, b) - 0.5 * b; }
"""


class RandomFaults(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        (self.root / "src/core").mkdir(parents=True)
        (self.root / "src/core/f.cpp").write_text(SOURCE)

    def test_only_code_is_changed(self):
        found = {(fault["original"], fault["replacement"]) for fault in random_faults.places(self.root)}
        self.assertEqual(found, {("-", "+"), ("*", "/"), ("0.5", "1.0"), ("a, b", "b, a")})
        body = SOURCE.index("return")
        for fault in random_faults.places(self.root):
            self.assertGreater(fault["at"], body)
            self.assertEqual(SOURCE[fault["at"]:].startswith(fault["original"]), True)

    def test_a_seed_draws_the_same_again(self):
        (self.root / "src/core/long.cpp").write_text("x = a + b;\n" * 100)

        def drawn(seed):
            return [(f["file"], f["at"], f["replacement"]) for f in random_faults.draw(self.root, seed, 20)]
        self.assertEqual(drawn(3), drawn(3))
        self.assertNotEqual(drawn(3), drawn(4))

    def test_a_fault_says_where_it_is(self):
        for fault in random_faults.draw(self.root, 1, 10):
            self.assertIn("line 7", fault["description"])
            self.assertTrue(fault["id"].startswith("random-1-"))


if __name__ == "__main__":
    unittest.main()
