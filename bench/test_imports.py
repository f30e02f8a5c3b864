"""python3 -m unittest discover -s bench"""

import importlib
import importlib.util
import unittest
from pathlib import Path


class Imports(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "the figures need matplotlib")
    def test_every_script_finds_what_it_imports(self):
        for file in sorted(Path(__file__).parent.glob("*.py")):
            with self.subTest(file.name):
                importlib.import_module(file.stem)


if __name__ == "__main__":
    unittest.main()
