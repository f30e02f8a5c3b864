#!/usr/bin/env python3
"""Published limits of other codes on their geometry, against `openclose fos` and the limit analysis of openclose-reference.

    verification/blind/run.py [--bin build/release] [--results results/blind] [--quick] [scene ...]

The load (tilt of the table, or horizontal acceleration) at which a system falls is the multiplier of horizontal gravity that `openclose fos --increase`
proves; without cohesion the tangent of a tilt is such a multiplier. Limit analysis finds it by bisection: a system stands where its factor is at least
1. Each source is named in the scene. The program's answer is repeated with other stiffnesses, which no source gives, and with the friction angle half a
degree up and down. Nothing here passes or fails: the table says what comes out.
"""
import argparse
import csv
import json
import math
import pathlib
import tempfile

from openclose_scripts.csv_rows import read_rows
from openclose_scripts.processes import run_process

HERE = pathlib.Path(__file__).resolve().parent
GRAVITY = 9.81
# Share of the printed value at which the search begins on either side, and the width, in shares, at which it ends.
REACH, WIDTH = 0.2, 2e-4


def gravity_of(load, value):
    if load == "tilt_deg":
        angle = math.radians(value)
        return GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle)
    return GRAVITY * value, -GRAVITY


class Programs:
    def __init__(self, folder):
        self._folder = pathlib.Path(folder)

    def fos(self, scene, case, settings):
        """The load up to which the system is proved to stand; None where the program gives no multiplier."""
        with tempfile.TemporaryDirectory() as out:
            options = [f"gravity_m_per_s2=[0, {-GRAVITY}]", *settings]
            command = [str(self._folder / "openclose"), "fos", "-q", str(scene), "--increase", "gravity_x", "-o", out]
            run_process([*command, *(word for o in options for word in ("--set", o))])
            summary = pathlib.Path(out) / "summary.json"
            multiplier = json.loads(summary.read_text())["load_multiplier"] if summary.exists() else None
        if multiplier is None:
            return None
        return math.degrees(math.atan(multiplier)) if case["load"] == "tilt_deg" else multiplier

    def limit_analysis(self, scene, case, _):
        """The largest load with a factor of at least 1; None if it is not within reach of the printed one."""
        printed = float(case["printed"])

        def stands(value):
            found = self._factor(scene, gravity_of(case["load"], value))
            return found is not None and found >= 1.0

        low, high = printed * (1 - REACH), printed * (1 + REACH)
        if not stands(low) or stands(high):
            return None
        while high - low > WIDTH * printed:
            middle = (low + high) / 2
            low, high = (middle, high) if stands(middle) else (low, middle)
        return (low + high) / 2

    def _factor(self, scene, gravity):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as copy:
            lines = (line for line in scene.read_text().splitlines(True) if not line.startswith("gravity_m_per_s2"))
            copy.write(f"gravity_m_per_s2 = [{gravity[0]!r}, {gravity[1]!r}]\n" + "".join(lines))
            copy.flush()
            run = run_process([str(self._folder / "analytical/openclose-reference"), "limit-analysis", copy.name])
            values = dict(line.split(",", 1) for line in run.stdout.splitlines() if "," in line)
            return float(values["factor_of_safety"]) if values.get("factor_of_safety") else None


def variants(scene, quick):
    friction = next(float(line.split("=")[1]) for line in scene.read_text().splitlines() if line.startswith("friction_angle_deg"))
    yield "soft", ["method.contact=soft"]
    yield "hard", ["method.contact=hard"]
    if quick:
        return
    yield "stiffness x 0.1", ["joint[0].normal_stiffness_pa_per_m=1e9", "joint[0].shear_stiffness_pa_per_m=4e8"]
    yield "stiffness x 100", ["joint[0].normal_stiffness_pa_per_m=1e12", "joint[0].shear_stiffness_pa_per_m=4e11"]
    yield "ks/kn 0.1", ["joint[0].shear_stiffness_pa_per_m=1e9"]
    yield "ks/kn 1", ["joint[0].shear_stiffness_pa_per_m=1e10"]
    yield "friction -0.5 deg", [f"joint[0].friction_angle_deg={friction - 0.5}"]
    yield "friction +0.5 deg", [f"joint[0].friction_angle_deg={friction + 0.5}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release")
    parser.add_argument("--results", default="results/blind")
    parser.add_argument("--quick", action="store_true", help="only the values that the sources give")
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    programs = Programs(options.bin)
    results = pathlib.Path(options.results)
    results.mkdir(parents=True, exist_ok=True)
    with open(results / "blind.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["scene", "load", "printed", "rounding", "variant", "found", "difference_percent"])
        for case in read_rows(HERE / "cases.csv"):
            if options.scenes and case["scene"] not in options.scenes:
                continue
            scene = HERE / f"{case['scene']}.toml"
            for name, factor, settings in [("limit analysis", programs.limit_analysis, ()), *((n, programs.fos, s) for n, s in variants(scene, options.quick))]:
                found = factor(scene, case, settings)
                difference = "" if found is None else f"{100 * (found / float(case['printed']) - 1):.2f}"
                row = [case["scene"], case["load"], case["printed"], case["rounding"], name, "none" if found is None else f"{found:.4f}", difference]
                table.writerow(row)
                file.flush()
                print(*row, sep="  ", flush=True)


if __name__ == "__main__":
    main()
