"""python3 -m unittest discover -s stress: a seed makes one scene; scenes are what their part promises."""

import math
import tomllib
import unittest
from types import SimpleNamespace

import campaign
import geometry
import maps
import masonry
import page
import planes
import slopes
import tumbles
import variants
from campaign import Row
from geometry import Body
from scene import POINT_MARK, measured, to_toml
from verdicts import APART

SEEDS = range(1, 41)


def bodies(document: dict) -> list[Body]:
    return [Body([tuple(p) for p in b["vertices_m"]]) for b in document["block"]]


class Scenes(unittest.TestCase):
    def test_a_seed_makes_one_scene(self):
        for draw in campaign.PARTS.values():
            self.assertEqual(draw(7), draw(7))
            self.assertNotEqual(draw(7).document, draw(8).document)

    def test_files_hold_the_scene(self):
        for draw in campaign.PARTS.values():
            document = draw(3).document
            read = tomllib.loads(to_toml(document))
            self.assertEqual(read["joint"], document["joint"])
            self.assertEqual(read.get("block"), document.get("block"))

    def test_slopes_stay_in_their_ranges(self):
        for seed in SEEDS:
            drawn, document = slopes.draw(seed).drawn, slopes.draw(seed).document
            self.assertTrue(0.5 <= drawn["height_m"] <= 500 and 40 <= drawn["face_deg"] <= 85 and 15 <= drawn["friction_deg"] <= 50)
            self.assertTrue(1e8 <= drawn["kn"] <= 1e11 and 0.05 <= drawn["ks_over_kn"] <= 1)
            dips = [s["dip_deg"] for s in document["joint_set"]]
            self.assertIn(len(dips), (2, 3))
            self.assertGreaterEqual(min(slopes._between(a, b) for i, a in enumerate(dips) for b in dips[:i]), slopes.CLOSEST_SETS_DEG)

    def test_planes_have_the_bound_of_their_plane(self):
        for seed in SEEDS:
            scene = planes.draw(seed)
            plane = next(j for j in scene.document["joint"] if j.get("name") == "plane")
            (x0, y0), (x1, y1) = (scene.document["joint_line"][0][key] for key in ("from_m", "to_m"))
            self.assertAlmostEqual(scene.most, math.tan(math.radians(plane["friction_angle_deg"])) / abs((y1 - y0) / (x1 - x0)), 9)
            self.assertLessEqual(plane["friction_angle_deg"], scene.document["joint"][0]["friction_angle_deg"])

    def test_blocks_of_tumbles_and_masonry_do_not_overlap(self):
        for draw in (tumbles.draw, masonry.draw):
            for seed in SEEDS:
                parts = [b.at(b.vertices) for b in bodies(draw(seed).document)]
                smallest = min(b.integrals.area for b in bodies(draw(seed).document))
                for i, j in geometry.near_pairs(parts):
                    self.assertLess(geometry.overlap(parts[i], parts[j]).area, 1e-6 * smallest, f"seed {seed}")

    def test_tumbles_begin_inside_their_walls(self):
        for seed in SEEDS:
            scene = tumbles.draw(seed)
            x0, y0, x1, y1 = scene.enclosure
            thrown = [b for b in scene.document["block"] if not b.get("fixed")]
            self.assertTrue(1 <= len(thrown) <= 100)
            for x, y in (p for b in thrown for p in b["vertices_m"]):
                self.assertTrue(x0 < x < x1 and y0 < y < y1, f"seed {seed}")

    def test_maps_have_every_cell_once(self):
        self.assertEqual(len({maps.cell(seed) for seed in range(5, 5 + maps.CELLS)}), maps.CELLS)
        for seed in SEEDS:
            kind, step, stiffness = maps.cell(seed)
            drawn = maps.draw(seed).drawn
            self.assertEqual(drawn["scene"], kind.__name__)
            for value, low, high, number, count in ((drawn["dt_s"], maps.SHORTEST_STEP_S, maps.LONGEST_STEP_S, step, maps.STEPS),
                                                    (drawn["kn"], maps.SOFTEST_PA_PER_M, maps.STIFFEST_PA_PER_M, stiffness, maps.STIFFNESSES)):
                self.assertTrue(0.999 * maps._between(low, high, number / count) <= value <= 1.001 * maps._between(low, high, (number + 1) / count))

    def test_two_points_of_every_free_block_are_measured(self):
        document = measured(tumbles.draw(5).document)
        free = [b["name"] for b in document["block"] if not b.get("fixed")]
        self.assertEqual([p["name"] for p in document["measured_point"]], [f"{n}{POINT_MARK}{k}" for n in free for k in (0, 1)])


class Variants(unittest.TestCase):
    def test_weights_and_cohesion_keep_their_ratio(self):
        document = masonry.draw(1).document | {"load": [{"block": "a", "point_m": [1.0, 2.0], "force_n": [3.0, 4.0]}]}
        document["joint"][0]["cohesion_pa"] = 7.0
        large = variants.VARIANTS["scaled x 1000"](document)
        ratio = bodies(large)[0].integrals.area / bodies(document)[0].integrals.area
        self.assertAlmostEqual(ratio, 1e6, 3)
        self.assertEqual(large["load"][0], {"block": "a", "point_m": [1000.0, 2000.0], "force_n": [3e6, 4e6]})
        self.assertEqual(large["joint"][0]["cohesion_pa"], 7000.0)  # of a length a thousand times as long: a million times the force
        self.assertEqual(document["joint"][0]["cohesion_pa"], 7.0)

    def test_mirrored_blocks_are_counter_clockwise_and_fall_the_other_way(self):
        document = masonry.draw(2).document
        other = variants.mirrored(document)
        self.assertEqual(other["gravity_m_per_s2"][0], -document["gravity_m_per_s2"][0])
        for a, b in zip(document["block"], other["block"]):
            self.assertAlmostEqual(geometry.integrals(a["vertices_m"]).area, geometry.integrals(b["vertices_m"]).area, 9)

    def test_mirrored_edges_keep_their_joints(self):
        document = {"block": [{"vertices_m": [[0, 0], [2, 0], [0, 1]], "edge_joints": ["floor", "slope", ""]}], "joint": []}
        (block,) = variants.mirrored(document)["block"]
        edges = {frozenset(map(tuple, edge)): name for edge, name in zip(geometry.edges(block["vertices_m"]), block["edge_joints"])}
        self.assertEqual(edges, {frozenset(((0, 0), (-2, 0))): "floor", frozenset(((-2, 0), (0, 1))): "slope", frozenset(((0, 1), (0, 0))): ""})


class Page(unittest.TestCase):
    ROWS = [Row("tumbles", 1, "a=1", "soft", 3, "right", "", energy_rise=0.001, overlap=1e-6, exit=0),
            Row("tumbles", 2, "a=1", "dem", 3, "FALSE", "energy created: 12.4 of the start's", energy_rise=12.4, exit=0),
            Row("slopes", 3, "cohesion_pa=0 kn=1", "soft", 30, "right", "", "certified", 0.9, 0.9, 0.91, 1.0, exit=0)]

    def test_the_false_one_is_the_worst(self):
        self.assertEqual([(r.part, r.seed) for r in page.worst(self.ROWS)], [("tumbles", 2), ("slopes", 3), ("tumbles", 1)])

    def test_it_counts_and_gives_distances(self):
        text = "\n".join(page._counts(self.ROWS) + page._reasons(self.ROWS) + page._distances(self.ROWS) + page._energy(self.ROWS))
        for line in ("| tumbles | dem | 1 | 0 | 0 | 0 | 1 | 0 |", "| FALSE | dem | energy created: ... of the start's | 1 |",
                     "| slopes | soft | c = 0 | 1 | 0.9000 | 0.9000 | 0.9000 | 0 of 1 |", "| tumbles | dem | 1 | 12 | 12 | 12 | 12 |"):
            self.assertIn(line, text)


class Comparisons(unittest.TestCase):
    def test_two_brackets_of_one_slope_have_to_meet(self):
        scene = slopes.draw(1)

        def of(stable, failed):
            return SimpleNamespace(stable=stable, failed=failed, answer="certified")

        self.assertEqual([r.verdict for r in campaign.Campaign._same(scene, of(1.0, 1.004), of(1.005, 1.006))], ["FALSE"])
        self.assertEqual([r.verdict for r in campaign.Campaign._same(scene, of(1.0, 1.01), of(1.005, 1.006))], ["FALSE"])
        self.assertEqual([r.verdict for r in campaign.Campaign._same(scene, of(1.0, 1.004), of(1.002, 1.006))], ["right"])
        self.assertEqual(campaign.Campaign._same(scene, of(1.0, 1.004), of(None, None)), [])
        self.assertEqual([r.verdict for r in campaign._comparison(scene, "shi = soft", "instead of", of(1.0, 1.004), of(0.9, 0.904), APART)], ["apart"])


if __name__ == "__main__":
    unittest.main()
