"""python3 -m unittest discover -s stress: every rule turns red on a false result that is planted."""

import csv
import json
import math
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import verdicts
from outcome import Outcome
from scene import Scene, measured

GRAVITY, DENSITY, WIDTH = 10.0, 2000.0, 1.0
HEIGHT, SPEED, SPIN = 5.0, 3.0, 2.0


def square(x: float, y: float, turn: float = 0.0, width: float = WIDTH) -> list[list[float]]:
    """About its centre."""
    corners = [(-width / 2, -width / 2), (width / 2, -width / 2), (width / 2, width / 2), (-width / 2, width / 2)]
    return [[x + p * math.cos(turn) - q * math.sin(turn), y + p * math.sin(turn) + q * math.cos(turn)] for p, q in corners]


def scene_of(blocks: list[dict], floor: float = 0.0) -> Scene:
    document = {
        "gravity_m_per_s2": [0.0, -GRAVITY],
        "material": [{"name": "rock", "density_kg_per_m3": DENSITY}],
        "joint": [{"materials": ["rock", "rock"], "normal_stiffness_pa_per_m": 1e9, "shear_stiffness_pa_per_m": 1e9, "friction_angle_deg": 30.0}],
        "block": blocks,
    }
    return Scene("tests", 0, "run", measured(document), enclosure=(-10.0, 0.0, 10.0, 20.0), floor_m=floor)


THROWN = {"name": "b", "material": "rock", "vertices_m": square(0, HEIGHT)}
FLOOR = {"name": "floor", "material": "rock", "fixed": True, "vertices_m": [[-10, -1], [10, -1], [10, 0], [-10, 0]]}


class Flight:
    """A block that is thrown and turns in free flight, as the program would write it; `plant` changes place, velocity and spin at a time."""

    def __init__(self, folder: str, plant=lambda t, place, velocity, spin: (place, velocity, spin), stored: float = 0.0, late: float = 0.0):
        """`late`: kinetic energy that the ledger says to be gone already when something is stored."""
        self.scene = scene_of([FLOOR, THROWN])
        self.folder = Path(folder)
        history, energy = [], []
        for t in (0.0, 0.1, 0.2, 0.3):
            place, velocity = (SPEED * t, HEIGHT - GRAVITY * t * t / 2), (SPEED, -GRAVITY * t)
            place, velocity, spin = plant(t, place, velocity, SPIN)
            turn = SPIN * t
            corners = square(*place, turn)
            for point in self.scene.document["measured_point"]:
                start = point["point_m"]
                now = corners[THROWN["vertices_m"].index(start)]
                arm = (now[0] - place[0], now[1] - place[1])
                history.append([t, point["name"], now[0] - start[0], now[1] - start[1], turn, velocity[0] - spin * arm[1], velocity[1] + spin * arm[0]])
            fallen = WIDTH**2 * DENSITY * (GRAVITY * t) ** 2 / 2
            energy.append([t, fallen - late * (t > 0), stored * (t > 0), 0, 0, 0])
        self.write("history.csv", "time_s,point,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s", history)
        self.write("energy.csv", "time_s,kinetic_j,contact_springs_j,support_springs_j,loads_j,base_motion_j", energy)
        outlines = [[state, b["name"], k, *p] for state in ("initial", "start", "final") for b in (FLOOR, THROWN)
                    for k, p in enumerate(corners if state == "final" and b is THROWN else b["vertices_m"])]
        self.write("blocks.csv", "state,block,vertex,x_m,y_m", outlines)

    def write(self, file: str, header: str, rows: list[list]) -> None:
        with open(self.folder / file, "w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows([header.split(","), *rows])

    def verdict(self, method: str = "soft", exit_status: int = 0, message: str = "") -> verdicts.Verdict:
        return verdicts.of_motion(self.scene, method, Outcome(self.folder, exit_status, message, 0.1))


def came_to_rest_at(y: float):
    return lambda t, place, velocity, spin: ((0.0, y), (0.0, 0.0), 0.0) if t > 0.25 else (place, velocity, spin)


class OfMotion(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def flight(self, *plant, **more) -> Flight:
        return Flight(self.folder.name, *plant, **more)

    def false(self, flight: Flight, reason: str, method: str = "soft") -> None:
        verdict = flight.verdict(method)
        self.assertEqual(verdict.kind, verdicts.FALSE)
        self.assertIn(reason, verdict.reason)

    def test_free_flight_is_right(self):
        verdict = self.flight().verdict()
        self.assertEqual((verdict.kind, verdict.reason), (verdicts.RIGHT, ""))
        self.assertLess(abs(verdict.created), 1e-12)
        self.assertEqual(verdict.overlap, 0)

    def test_energy_from_nothing(self):
        # The start has 2000 kg (3^2/2 + 2^2/12 + 10 * 5 m2/s2) = 109.7 kJ: 1.5 % of it is in 0.55 m/s more, 0.5 % in 0.18 m/s.
        def faster(by):
            return lambda t, place, velocity, spin: (place, (velocity[0] + by * (t > 0.15), velocity[1]), spin)

        self.false(self.flight(faster(0.55)), "energy created")
        self.assertEqual(self.flight(faster(0.17)).verdict().kind, verdicts.RIGHT)

    def test_inclined_gravity_does_work_sideways(self):
        def pulled(t, place, velocity, spin):
            return (place[0] + 4 * t * t / 2, place[1]), (velocity[0] + 4 * t, velocity[1]), spin

        flight = self.flight(pulled)
        self.assertEqual(flight.verdict().kind, verdicts.FALSE)
        flight.scene.document["gravity_m_per_s2"] = [4.0, -GRAVITY]
        self.assertEqual(flight.verdict().kind, verdicts.RIGHT)

    def test_spin_from_nothing(self):
        self.false(self.flight(lambda t, place, velocity, spin: (place, velocity, spin * (4 if t > 0.25 else 1))), "energy created")

    def test_stored_energy_counts(self):
        self.false(self.flight(stored=2e3), "energy created")
        # Velocities of half a step before: what is stored is kinetic there still.
        self.assertEqual(self.flight(stored=2e3, late=2e3).verdict().kind, verdicts.RIGHT)

    def test_energy_that_was_lost_stays_lost(self):
        def lost_for_a_while(t, place, velocity, spin):
            return place, (velocity[0] * (0.1 if 0.05 < t < 0.15 else 1), velocity[1]), spin

        self.false(self.flight(lost_for_a_while), "energy rises")

    def test_outside_the_walls(self):
        self.false(self.flight(lambda t, place, velocity, spin: ((place[0] - 11 * (t > 0.25), place[1]), velocity, spin)), "outside the walls")

    def test_higher_than_energy_permits(self):
        def lifted(t, place, velocity, spin):
            return (place[0], place[1] + 3 * (t > 0.25)), (0.0, 0.0), 0.0

        self.false(self.flight(lifted), "high")

    def test_deep_overlap(self):
        # The lowest corner of the turned square is 0.695 m below its centre. At 5 m/s a chord of 1 cm gives way by 7 cm, one of 1 m by 7 mm.
        self.false(self.flight(came_to_rest_at(0.3)), "overlap")
        self.assertEqual(self.flight(came_to_rest_at(0.69)).verdict().kind, verdicts.RIGHT)

    def test_hard_contacts_keep_their_tolerance(self):
        flight = self.flight(came_to_rest_at(0.69))
        self.assertEqual(flight.verdict("soft").kind, verdicts.RIGHT)
        self.false(flight, "overlap", "hard")

    def test_tables_that_contradict_each_other(self):
        flight = self.flight()
        flight.write("blocks.csv", "state,block,vertex,x_m,y_m", [[s, b["name"], k, *p] for s in ("initial", "final") for b in (FLOOR, THROWN)
                                                                  for k, p in enumerate(b["vertices_m"])])
        self.false(flight, "apart")

    def test_no_number(self):
        flight = self.flight()
        flight.write("contacts.csv", "state,normal_force_n", [["final", "nan"]])
        self.false(flight, "contacts.csv")

    def test_refused_needs_a_reason(self):
        flight = self.flight()
        self.assertEqual(flight.verdict(exit_status=1, message="openclose: steps too long").kind, verdicts.REFUSED)
        flight.scene = replace(flight.scene, too_soft=True)
        self.assertEqual(flight.verdict(exit_status=1, message="openclose: steps too long").kind, verdicts.RIGHT)
        self.assertEqual(flight.verdict(exit_status=1, message="openclose: warning: something").kind, verdicts.FALSE)
        self.assertEqual(flight.verdict(exit_status=3, message="openclose: disk full").kind, verdicts.FALSE)
        self.assertEqual(flight.verdict(exit_status=-11).kind, verdicts.FALSE)
        self.assertEqual(flight.verdict(exit_status=None).kind, verdicts.SLOW)


# A block of 1 m x 1 m on an incline whose slope is 3 in 4, friction tan(45 deg): it stands up to tan(45)/0.75 = 4/3.
SLOPE = [[0.0, 0.0], [8.0, 0.0], [8.0, 6.0]]
ON_SLOPE = [[3.2, 2.4], [4.0, 3.0], [3.4, 3.8], [2.6, 3.2]]
WEIGHT = DENSITY * GRAVITY


def incline(corner: bool = False, seam: tuple[list[str], list[str]] | None = None) -> verdicts.Assembly:
    """With `corner` the block stands on one corner instead: it is turned a little. `seam`: what the edges of base and block name, a joint without friction."""
    on_slope = [[3.2, 2.4], [4.0, 3.2], [3.2, 4.0], [2.4, 3.2]] if corner else ON_SLOPE
    blocks = [{"name": "base", "material": "rock", "fixed": True, "vertices_m": SLOPE}, {"name": "b", "material": "rock", "vertices_m": on_slope}]
    joints = [{"materials": ["rock", "rock"], "friction_angle_deg": 45.0, "cohesion_pa": 0.0}, {"name": "seam", "friction_angle_deg": 0.0}]
    for block, names in zip(blocks, seam or ()):
        block["edge_joints"] = names
    return verdicts.Assembly({"gravity_m_per_s2": [0.0, -GRAVITY], "material": [{"name": "rock", "density_kg_per_m3": DENSITY}], "joint": joints, "block": blocks})


def _lifted(points: list, by: float) -> list:
    """The block of the last stable state has moved, by far too much for a joint: forces balance where it was drawn."""
    return [(x + by, y + by) for x, y in points]


class OfFactors(unittest.TestCase):
    """The forces: N = 0.8 W, T = 0.6 W at the two lower corners; their moments balance with 0.5 (N -+ T) at each."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def verdict(self, assembly=None, limit=4 / 3, scale=1.0, shear=0.6, exit_status=0, points=((3.2, 2.4), (4.0, 3.0)), factor=None, reason="", most=None,
                **bracket):
        bracket = {"stable": 1.33, "failed": 1.335, "failed_by": "mechanism"} | bracket
        summary = {"factor_of_safety": factor or bracket["stable"], "verdict": "certified", "bracket": bracket, "reason": reason}
        folder = Path(self.folder.name)
        (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
        normal = [0.5 * (0.8 + 0.6) * WEIGHT * scale, 0.5 * (0.8 - 0.6) * WEIGHT * scale]
        assembly_of = assembly or incline()
        rows = [["stable", "b", "base", *_lifted([p], 0.125)[0], -0.6, 0.8, 0.5, n, -shear * WEIGHT * n / sum(normal), "sticking"] for p, n in zip(points, normal)]
        with open(folder / "contacts.csv", "w", newline="", encoding="utf-8") as stream:
            header = "state,block_a,block_b,x_m,y_m,normal_x,normal_y,length_m,normal_force_n,shear_force_n,status"
            csv.writer(stream).writerows([header.split(","), *rows])
        outlines = [[state, name, k, *p] for state, lift in (("initial", 0.0), ("stable", 0.125)) for name, polygon in assembly_of.vertices.items()
                    for k, p in enumerate(_lifted(polygon, lift if name == "b" else 0.0))]
        with open(folder / "blocks.csv", "w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows(["state,block,vertex,x_m,y_m".split(","), *outlines])
        known = None if limit is None else {"factor": limit, "failed": limit * (1 + 1e-5)}
        return verdicts.of_factor(Outcome(folder, exit_status, "", 0.1), assembly_of, known, most)

    def false(self, reason: str, **planted) -> None:
        verdict = self.verdict(**planted)
        self.assertEqual(verdict.kind, verdicts.FALSE)
        self.assertIn(reason, verdict.reason)

    def test_what_balances_is_right(self):
        self.assertEqual(self.verdict(), verdicts.Verdict(verdicts.RIGHT, "", 1.33, 1.33, 1.335, 4 / 3, answer="certified"))

    def test_nothing_stands_beyond_a_closed_form(self):
        self.assertEqual(self.verdict(most=1.33).kind, verdicts.RIGHT)
        self.false("nothing can stand beyond 1.32", most=1.32)

    def test_forces_that_do_not_balance(self):
        self.false("out of balance", scale=1 + 1e-5)
        self.false("out of balance", shear=-0.6)
        self.false("out of balance", points=((4.0, 3.0), (3.2, 2.4)))

    def test_forces_that_are_missing(self):
        self.false("no forces", points=())

    def test_forces_beyond_the_reduced_strength(self):
        self.false("beyond the strength", stable=1.334, limit=None)

    def test_slip_takes_friction_from_what_pulls_only_where_cohesion_stays(self):
        joint = {"friction_angle_deg": 45.0, "residual_friction_angle_deg": 0.0, "cohesion_pa": 100.0, "tensile_strength_pa": 50.0, "slip_weakening_distance_m": 0.001}

        def shear(normal_force, **changed):
            return verdicts._strength(joint | changed, verdicts.Force("a", "b", (0, 0), (0, 1), 2.0, normal_force, 0.0), 1.0)[1]

        self.assertAlmostEqual(shear(-80.0), 200.0)
        for changed in {"cohesion_behaviour": "lost_on_slip"}, {"slip_weakening_distance_m": 0.0}:
            self.assertAlmostEqual(shear(-80.0, **changed), 120.0)
        self.assertAlmostEqual(shear(80.0), 280.0)

    def test_the_joint_is_the_one_that_both_edges_name(self):
        base, block = ["", "", "seam"], ["seam", "", "", ""]
        self.false("beyond the strength", assembly=incline(seam=(base, block)), limit=None)
        # The block, or the base, names it for an edge that is not touched.
        self.assertEqual(self.verdict(assembly=incline(seam=(base, ["", "", "seam", ""]))).kind, verdicts.RIGHT)
        self.assertEqual(self.verdict(assembly=incline(seam=(["seam", "seam", ""], block))).kind, verdicts.RIGHT)

    def test_above_limit_analysis(self):
        self.false("limit analysis", limit=1.32)

    def test_to_refuse_is_right_without_any_equilibrium(self):
        self.assertEqual(self.verdict(exit_status=1, limit=1.5, reason="no equilibrium").kind, verdicts.REFUSED)
        self.assertEqual(self.verdict(exit_status=1, limit=0.0, reason="no equilibrium").kind, verdicts.RIGHT)
        self.false("limit analysis", limit=0.0)

    def test_lone_corners_are_not_compared(self):
        assembly = incline(corner=True)
        force = verdicts.Force("b", "base", (3.2, 2.4), (-0.6, 0.8), 0.5, WEIGHT, 0.0)
        self.assertEqual(assembly.lone_corners([force]), 1)
        self.assertEqual(incline().lone_corners([force]), 0)
        # The forces of the block on its edge are loaded where the turned one has none.
        verdict = self.verdict(assembly=assembly, limit=1.0)
        self.assertIsNone(verdict.limit)
        self.assertNotIn("limit analysis 1", verdict.reason)

    def test_a_failed_end_is_proved(self):
        self.false("without proof", failed_by="steps")
        self.false("without proof", failed_by=None)
        self.false("feasible", failed_by="limit_analysis", failed=1.3325)
        self.assertEqual(self.verdict(failed=None, failed_by=None).kind, verdicts.RIGHT)

    def test_bracket_and_factor_agree(self):
        self.false("not below", failed=1.32)
        self.false("not the stable end", factor=1.2)
        self.false("without a stable factor", stable=None)

    def test_brackets_of_one_slope(self):
        def of(stable, failed):
            return verdicts.Verdict(verdicts.RIGHT, stable=stable, failed=failed)

        self.assertEqual(verdicts.same_bracket(of(1.0, 1.004), of(1.003, 1.006)), "")
        self.assertIn("no factor in common", verdicts.same_bracket(of(1.0, 1.004), of(1.005, 1.006)))
        self.assertIn("no factor in common", verdicts.same_bracket(of(1.005, None), of(1.0, 1.004)))
        at_the_limit = verdicts.Verdict(verdicts.RIGHT, stable=1.0, limit=1.002)
        self.assertIn("instead of", verdicts.nearly_same(at_the_limit, of(0.98, 0.985)))
        self.assertEqual(verdicts.nearly_same(at_the_limit, of(0.992, 0.995)), "")
        self.assertEqual(verdicts.nearly_same(verdicts.Verdict(verdicts.RIGHT, stable=1.0, limit=1.1), of(0.98, 0.985)), "")
        # An interval says itself what it does not know, as long as the other factor lies in it.
        self.assertEqual(verdicts.nearly_same(at_the_limit, replace(of(0.68, 1.001), answer="interval")), "")
        self.assertIn("instead of", verdicts.nearly_same(at_the_limit, replace(of(0.68, 0.9), answer="interval")))
        self.assertIn("instead of", verdicts.nearly_same(at_the_limit, replace(of(1.02, 1.1), answer="interval")))
        self.assertTrue(verdicts.too_wide(of(1.0, 1.006)))
        self.assertFalse(verdicts.too_wide(of(1.0, 1.0049)))
        self.assertFalse(verdicts.too_wide(replace(of(1.0, 1.1), answer="interval")))


if __name__ == "__main__":
    unittest.main()
