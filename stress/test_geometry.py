"""python3 -m unittest discover -s stress"""

import math
import unittest

import geometry
from geometry import Body

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
L_SHAPE = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)]


def moved(polygon, x, y):
    return [(p[0] + x, p[1] + y) for p in polygon]


def common(a, b):
    return geometry.overlap(Body(a).at(a), Body(b).at(b))


class Geometry(unittest.TestCase):
    def test_integrals_far_from_the_origin(self):
        for shift in (0.0, 5e6):
            of = geometry.integrals(moved(SQUARE, shift, -shift))
            self.assertAlmostEqual(of.area, 1.0, 12)
            self.assertAlmostEqual(of.polar, 1 / 6, 12)
            self.assertAlmostEqual(of.centroid[0] - shift, 0.5, 8)
        self.assertAlmostEqual(geometry.integrals(L_SHAPE).area, 5.0, 12)

    def test_overlap(self):
        corner = common(SQUARE, moved(SQUARE, 0.75, 0.5))
        self.assertAlmostEqual(corner.area, 0.125, 12)
        self.assertAlmostEqual(corner.chord, math.hypot(0.25, 0.5), 12)
        self.assertAlmostEqual(common(SQUARE, moved(SQUARE, 1.0, 0.5)).area, 0.0, 12)
        self.assertAlmostEqual(common(SQUARE, [(0.25, 0.25), (0.5, 0.25), (0.5, 0.5)]).area, 1 / 32, 12)

    def test_overlap_of_polygons_that_are_not_convex(self):
        self.assertAlmostEqual(common(L_SHAPE, moved(SQUARE, 1.5, 1.5)).area, 0.0, 12)
        self.assertAlmostEqual(common(L_SHAPE, moved(SQUARE, 0.5, 0.5)).area, 0.75, 12)
        self.assertAlmostEqual(common(L_SHAPE, L_SHAPE).area, 5.0, 12)

    def test_near_pairs(self):
        placed = [Body(p).at(p) for p in (SQUARE, moved(SQUARE, 0.5, 0.5), moved(SQUARE, 5, 0), moved(SQUARE, 0.5, 3), moved(SQUARE, 5.9, -0.9))]
        self.assertEqual({frozenset(p) for p in geometry.near_pairs(placed)}, {frozenset((0, 1)), frozenset((2, 4))})


if __name__ == "__main__":
    unittest.main()
