#!/usr/bin/env python3
"""Limits that others have published on their geometry, of other codes and of tests, against `openclose fos` and the limit analysis of openclose-reference.

    verification/blind/run.py [--bin build/release] [--results results/blind] [--quick] [case ...]

What limits a system is its factor of safety ("factor") or the load at which it falls: the tilt of a table, a horizontal acceleration or a force. The load is
the multiplier that `openclose fos --increase` proves; without cohesion the tangent of a tilt is such a multiplier of horizontal gravity. Limit analysis finds
the load by bisection: a system stands where its factor is at least 1. Each source is named in the scene. `cases.csv` has the published value and the range
that its rounding or the scatter of the tests leaves. The program's answer is repeated with other stiffnesses, which no source gives, with the friction angle
half a degree up and down, and with the inputs of the case that are not sure; the last two rows of a case are the least and the greatest of these answers.
Nothing here passes or fails: the table says what comes out.
"""
import argparse
import csv
import json
import math
import pathlib
import re
import tempfile

from openclose_scripts.csv_rows import read_rows
from openclose_scripts.processes import run_process

HERE = pathlib.Path(__file__).resolve().parent
GRAVITY = 9.81
# Force of "push" in its scene, per metre of thickness, that is 1 kN on a wall 0.2 m thick.
PUSH_N = 5e3
# Share of the printed value at which the search begins on either side, and the width, in shares, at which it ends.
REACH, WIDTH = 0.2, 2e-4
INCREASE = {"tilt_deg": "gravity_x", "acceleration_g": "gravity_x", "push_kn": "push"}


def gravity_of(load, value):
    if load == "tilt_deg":
        angle = math.radians(value)
        return GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle)
    return GRAVITY * value, -GRAVITY


def under_load(text, case, value):
    """The scene with the load at this value; a factor has none."""
    if case["load"] == "factor":
        return text
    if case["load"] == "push_kn":
        dead = re.search(r"load\.dead\.force_n=(\S+)", case["settings"])
        text = re.sub(r'(name = "dead"\n.*\n.*\nforce_n = ).*', rf"\g<1>{dead[1]}", text)
        return re.sub(r'(name = "push"\n.*\n.*\nforce_n = ).*', rf"\g<1>[{PUSH_N * value!r}, 0]", text)
    return re.sub(r"(?m)^gravity_m_per_s2.*", f"gravity_m_per_s2 = {list(gravity_of(case['load'], value))!r}", text)


class Programs:
    def __init__(self, folder):
        self._folder = pathlib.Path(folder)

    def fos(self, scene, case, settings):
        """The factor, or the load up to which the system is proved to stand; None where the program gives neither."""
        increase = INCREASE.get(case["load"])
        with tempfile.TemporaryDirectory() as out:
            options = [f"gravity_m_per_s2=[0, {-GRAVITY}]", *case["settings"].split(), *settings]
            command = [str(self._folder / "openclose"), "fos", "-q", str(scene), "-o", out]
            command += ["--increase", increase] if increase else []
            run_process([*command, *(word for o in options for word in ("--set", o))])
            summary = pathlib.Path(out) / "summary.json"
            found = json.loads(summary.read_text())["load_multiplier" if increase else "factor_of_safety"] if summary.exists() else None
        if found is None:
            return None
        return math.degrees(math.atan(found)) if case["load"] == "tilt_deg" else found

    def limit_analysis(self, scene, case, _):
        """The factor, or the largest load with a factor of at least 1; None if it is not within reach of the printed one."""
        text, printed = scene.read_text(), float(case["printed"])
        if case["load"] == "factor":
            return self._factor(text)

        def stands(value):
            found = self._factor(under_load(text, case, value))
            return found is not None and found >= 1.0

        low, high = printed * (1 - REACH), printed * (1 + REACH)
        if not stands(low) or stands(high):
            return None
        while high - low > WIDTH * printed:
            middle = (low + high) / 2
            low, high = (middle, high) if stands(middle) else (low, middle)
        return (low + high) / 2

    def _factor(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as copy:
            copy.write(text)
            copy.flush()
            run = run_process([str(self._folder / "analytical/openclose-reference"), "limit-analysis", copy.name])
            values = dict(line.split(",", 1) for line in run.stdout.splitlines() if "," in line)
            return float(values["factor_of_safety"]) if values.get("factor_of_safety") else None


def variants(scene, case, quick):
    """Names and settings of what the program is asked; settings of "*." are those of every joint."""
    text = scene.read_text()
    friction = float(re.search(r"(?m)^friction_angle_deg = (\S+)", text)[1])

    def joints(*settings):
        return [s.replace("*.", f"joint[{k}].") for s in settings for k in range(text.count("[[joint]]"))]

    yield "soft", ["method.contact=soft"]
    yield "hard", ["method.contact=hard"]
    if quick:
        return
    yield "stiffness x 0.1", joints("*.normal_stiffness_pa_per_m=1e9", "*.shear_stiffness_pa_per_m=4e8")
    yield "stiffness x 100", joints("*.normal_stiffness_pa_per_m=1e12", "*.shear_stiffness_pa_per_m=4e11")
    yield "ks/kn 0.1", joints("*.shear_stiffness_pa_per_m=1e9")
    yield "ks/kn 1", joints("*.shear_stiffness_pa_per_m=1e10")
    yield "friction -0.5 deg", joints(f"*.friction_angle_deg={friction - 0.5}")
    yield "friction +0.5 deg", joints(f"*.friction_angle_deg={friction + 0.5}")
    for name, settings in (part.split(": ") for part in case["inputs"].split("; ") if part):
        yield name, joints(settings) if settings.startswith("*.") else [settings]


def rows_of(programs, case, quick):
    """Name, value and its difference from the printed one in per cent, for everything that is asked, and the range of the program's answers."""
    scene, printed = HERE / f"{case['scene']}.toml", float(case["printed"])

    def row(name, found):
        return (name, "none", "") if found is None else (name, f"{found:.4f}", f"{100 * (found / printed - 1):.2f}")

    yield row("limit analysis", programs.limit_analysis(scene, case, ()))
    answers = []
    for name, settings in variants(scene, case, quick):
        answers.append(programs.fos(scene, case, settings))
        yield row(name, answers[-1])
    known = [a for a in answers if a is not None]
    if known:
        yield row("least", min(known))
        yield row("greatest", max(known))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release")
    parser.add_argument("--results", default="results/blind")
    parser.add_argument("--quick", action="store_true", help="only the values that the sources give")
    parser.add_argument("cases", nargs="*")
    options = parser.parse_args()
    programs = Programs(options.bin)
    results = pathlib.Path(options.results)
    results.mkdir(parents=True, exist_ok=True)
    with open(results / "blind.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["case", "load", "printed", "lowest", "highest", "variant", "found", "difference_percent"])
        for case in read_rows(HERE / "cases.csv"):
            if options.cases and case["case"] not in options.cases:
                continue
            for found in rows_of(programs, case, options.quick):
                row = [case["case"], case["load"], case["printed"], case["lowest"], case["highest"], *found]
                table.writerow(row)
                file.flush()
                print(*row, sep="  ", flush=True)


if __name__ == "__main__":
    main()
