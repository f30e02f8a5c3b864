#!/usr/bin/env python3
"""Runs the examples as their pages say, and compares their answers with theory.

    examples/check.py OPENCLOSE [--renew-pictures]

Every command of examples/NAME/README.md must print what stands there, every answer must agree with examples/theory.py within its tolerance, and the committed
picture must be what the program draws. Exit status: 0 if all of this holds, else 1.
"""

import argparse
import csv
import json
import math
import re
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "docs"))

import check_examples  # noqa: E402
import make_blocks  # noqa: E402
import theory  # noqa: E402

GRAVITY = 9.81
# [-] Brackets are narrower than 1e-4 of the factor; the joints' closures, tens of micrometres on blocks of metres, turn what is drawn by as much at most.
BRACKET = 2e-4
# [-] The recursion's forces act on columns as drawn; the closures under 16 columns of up to 40 m turn the columns by 1e-3 of their width over their height.
CLOSING_COLUMNS = 1e-3
# [m] A time step moves the blow of a landing by up to dt = 1 ms on its way of 8 m/s, half of which friction takes back.
LANDING_M = 8e-3
# [m] A closed or sticking contact of `hard` may be 3e-7 m from its place (solver.gap_tolerance_m), along and across each of nine beds, on one side at the start and
# on the other at the end; what moves farther has slipped or opened.
CLOSING_COURSES_M = 2 * 9 * math.hypot(3e-7, 3e-7)


@dataclass
class Row:
    """One answer between its bounds."""

    what: str
    least: float
    most: float
    measured: float

    @property
    def holds(self) -> bool:
        return self.least <= self.measured <= self.most  # false for NaN, too


def near(what: str, expected: float, measured: float, tolerance: float) -> Row:
    return Row(what, expected - tolerance, expected + tolerance, measured)


def summary(folder: Path) -> dict:
    return json.loads((folder / "summary.json").read_text())


def certified(folder: Path, key: str) -> float:
    """What is proved; NaN if the bracket is not certified, so that nothing else can pass."""
    answer = summary(folder)
    return answer[key] if answer["verdict"] == "certified" else math.nan


def factor(folder: Path) -> float:
    return certified(folder, "factor_of_safety")


def multiplier(folder: Path) -> float:
    return certified(folder, "load_multiplier")


def final_states(folder: Path) -> list[dict]:
    with open(folder / "block_states.csv") as stream:
        return [row for row in csv.DictReader(stream) if row["state"] == "final"]


def farthest_m(folder: Path) -> float:
    return max(math.hypot(float(row["displacement_x_m"]), float(row["displacement_y_m"])) for row in final_states(folder))


def tilt_deg(folder: Path) -> float:
    across, down = re.search(r"gravity_m_per_s2 = \[(\S+), (\S+)\]", (folder / "scene_as_read.toml").read_text()).groups()
    return math.degrees(math.atan2(float(across), -float(down)))


def planar_slope(results: Path) -> list[Row]:
    expected = theory.planar_slope(height_m=40, face_deg=60, plane_deg=35, unit_weight=26e3, friction_deg=32, cohesion_pa=50e3)
    return [near("factor, closed form", expected, factor(results / "planar"), BRACKET * expected)]


def toppling_slope(results: Path) -> list[Row]:
    limit = theory.toppling_friction(make_blocks.COLUMN_WIDTH_M, make_blocks.COLUMNS, make_blocks.CREST, make_blocks.RISE_M, make_blocks.RISE_M,
                                     make_blocks.STEP_M, make_blocks.STEP_DIP_DEG)
    expected = math.tan(math.radians(45)) / limit
    return [near("factor, limit equilibrium", expected, factor(results / "toppling"), CLOSING_COLUMNS * expected)]


def roof_wedge(results: Path) -> list[Row]:
    weight = 2600 * GRAVITY * (4.8 + 1.2) / 2 * 6
    expected = theory.roof_wedge(squeeze_n=200e3 * 6, weight_n=weight, half_angle_deg=math.degrees(math.atan(1.8 / 6)), friction_deg=38)
    return [near("factor, limit equilibrium", expected, factor(results / "wedge"), BRACKET * expected)]


def between_tilts(results: Path, limit_deg: float, source: str) -> list[Row]:
    """It stands at the smaller tilt, proved, and has no equilibrium at the larger one; the limit lies between."""
    fallen = summary(results / "falls")
    return [Row(f"limit of the tilt [deg], {source}", tilt_deg(results / "stands"), tilt_deg(results / "falls"), limit_deg),
            Row("factor where it stands", 1, math.inf, factor(results / "stands")),
            Row("no equilibrium beyond (1: yes)", 1, 1, float(fallen["verdict"] == "no_equilibrium"))]


def tilting_arch(results: Path) -> list[Row]:
    voussoirs = [corners for name, corners in make_blocks.arch().items() if name != "base"]
    expected = math.tan(math.radians(theory.arch_tilt_deg(voussoirs)))
    return [near("tangent of the tilt, line of thrust", expected, multiplier(results / "arch"), BRACKET * expected)]


def dry_stone_tower(results: Path) -> list[Row]:
    stones = [corners for name, corners in make_blocks.tower().items() if name != "base"]
    slides = math.tan(math.radians(40)) / math.tan(math.radians(tilt_deg(results / "stands")))
    return [*between_tilts(results, theory.tower_tilt_deg(stones), "moments about each bed"),
            near("factor against sliding, closed form", slides, factor(results / "stands"), BRACKET * slides)]


def retaining_blocks(results: Path) -> list[Row]:
    widths, pressures = [1.8, 1.6, 1.4, 1.2, 1.0], [19103.1, 14858.0, 10612.8, 6367.70, 2122.57]
    expected = theory.retaining_wall(widths, 0.8, 24e3, pressures, 35)
    overturning = theory.overturning(widths, 0.8, 24e3, pressures)
    return [near("factor against sliding, closed form", expected, factor(results / "wall"), BRACKET * expected),
            Row("ratio of moments: does not overturn first", 1, math.inf, overturning)]


def rockfall(results: Path) -> list[Row]:
    slab = final_states(results / "fall")[-1]
    ledger = summary(results / "fall")["energy_ledger"]
    expected = theory.rockfall(speed=8, drop_m=5, friction_deg=math.degrees(math.atan(0.5)), gravity=GRAVITY)
    return [near("way of the slab [m], closed form", expected, float(slab["displacement_x_m"]), LANDING_M),
            near("drop of the slab [m]", -5, float(slab["displacement_y_m"]), 1e-6),
            Row("speed at the end [m/s]", 0, 1e-9, math.hypot(float(slab["velocity_x_m_per_s"]), float(slab["velocity_y_m_per_s"]))),
            Row("mechanical energy gained [J], physics", -math.inf, 0, ledger["kinetic_j"] + ledger["gravity_j"])]


def shaken_wall(results: Path) -> list[Row]:
    peak = max(abs(float(line.split(",")[1])) for line in (HERE / "shaken_wall" / "record.csv").read_text().splitlines()[2:])
    holds = math.tan(math.radians(35)) * GRAVITY
    return [Row("peak of the weak shaking [m/s2]: at most what is proved to stand", 0, 2.5, 0.5 * peak),
            Row("factor at 2.5 m/s2 to the right", 1, math.inf, factor(results / "right")),
            Row("factor at 2.5 m/s2 to the left", 1, math.inf, factor(results / "left")),
            Row("way of any stone after it [m], safe theorem", 0, CLOSING_COURSES_M, farthest_m(results / "weak")),
            Row("peak of the strong shaking [m/s2]: more than friction can hold", holds, math.inf, 2 * peak),
            Row("way of some stone after it [m], slides on its base", CLOSING_COURSES_M, math.inf, farthest_m(results / "strong"))]


ANSWERS = {f.__name__: f for f in (planar_slope, toppling_slope, roof_wedge, tilting_arch, shaken_wall, retaining_blocks, rockfall, dry_stone_tower)}


# With which the last line of a file begins that is not replaced once it is edited.
SEAL = "<!-- Written by openclose"


def same_picture(committed: Path, drawn: Path) -> bool:
    """The same shapes and words; digits may differ by another compiler's rounding, and with them the sum in the last line."""
    if not committed.exists():
        return False
    shapes = [check_examples.NUMBER.sub("#", path.read_text().split(SEAL)[0]) for path in (committed, drawn)]
    return shapes[0] == shapes[1]


def check(name: str, openclose: Path, renew: bool) -> list[str]:
    """What is wrong with an example; prints its answers."""
    folder = HERE / name
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        _, wrong = check_examples.check(folder / "README.md", openclose, work)
        if wrong:
            return wrong
        if renew:
            shutil.copy(work / "picture.svg", folder / "picture.svg")
        if not same_picture(folder / "picture.svg", work / "picture.svg"):
            wrong.append(f"{name}: picture.svg is not what openclose draws now; examples/check.py OPENCLOSE --renew-pictures")
        for row in ANSWERS[name](work / "results"):
            print(f"{name:16} {row.what:70} {row.measured:12.6g} in [{row.least:.6g}, {row.most:.6g}] {'pass' if row.holds else 'FAIL'}")
            if not row.holds:
                wrong.append(f"{name}: {row.what}")
    if name in make_blocks.SCENES and (folder / "scene.toml").read_text() != make_blocks.scene(name):
        wrong.append(f"{name}: scene.toml is not what examples/make_blocks.py writes")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("openclose", type=Path)
    parser.add_argument("--renew-pictures", action="store_true")
    arguments = parser.parse_args()
    folders = {path.parent.name for path in HERE.glob("*/README.md")}
    wrong = [f"{name}: no answer is checked, or there is no page" for name in folders ^ ANSWERS.keys()]
    for name in ANSWERS:
        if name in folders:
            wrong += check(name, arguments.openclose.resolve(), arguments.renew_pictures)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    print(f"{len(ANSWERS)} examples, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
