#!/usr/bin/env python3
"""What each mechanism of the solver is worth: the same runs with it and without it, one mechanism at a time.

    bench/ablation.py [--results DIR] [--slopes N] [--seed S] [NAME...]     all mechanisms of ablation.toml, or those whose name has a NAME in it

A mechanism is taken out by settings or by edits of the sources, which are made in a copy under build/ablation. The runs are the slope of example 3.4
with three spacings of its joints, a dropped pile, and random slopes of stress/slopes.py. Each cell of ablation.csv and ablation.md is the ratio of the
run without the mechanism to the run with it: of instructions (valgrind) for the small runs, of CPU time for the others; "fails" where only the run
without it does. A mechanism stays if it saves 10 % in one column, or if a run fails without it.

Exit status: 0, or 2 if an edit does not fit the sources or the build fails.
"""

import argparse
import csv
import json
import os
import re
import shutil
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from openclose_scripts import ROOT
from openclose_scripts.csv_rows import read_rows
from openclose_scripts.markdown import markdown_table
from openclose_scripts.processes import DONE, NOT_CONVERGED, call, run_process, was_stopped
from walls_and_piles import PILE_DT_S, PILE_END_S, pile_scene

SCENE = ROOT / "paper/scenes/example_3_4_post_failure.toml"
COPIED = ("CMakeLists.txt", "CMakePresets.json", "analytical", "cmake", "mutants", "paper", "scripts", "src", "tests", "verification")
FOLDER = ROOT / "build/ablation"
SLOPE_METHODS = ("soft", "hard")
LIMIT_S = 600
TIME_LIMIT = "time limit"
SLOPE_LIMIT_S = 10  # a random slope that takes longer with all mechanisms counts for nothing
REPEATS = 2  # of large runs, which are measured by CPU time; the shortest counts


@dataclass(frozen=True)
class Run:
    name: str
    command: str
    scene: Path
    settings: tuple[str, ...]
    counted: bool  # instructions by valgrind, else CPU time
    repeats: int = REPEATS
    limit_s: int = LIMIT_S


def _of_34(blocks: str, factor: float, contact: str, end_s: float, counted: bool) -> Run:
    """The joint spacings of the paper times a factor; steps of 10 ms after settling."""
    settings = (f"joint_set[0].spacing_m={40 * factor}", f"joint_set[1].spacing_m={10 * factor}", "step.max_displacement_m=0.2",
                f"end.time_s={end_s}", f"output.every_s={end_s}", "output.milestones_m=[]", f"method.contact={contact}")
    return Run(f"{blocks} {contact}", "run", SCENE, settings, counted)


def runs(slope_count: int, seed: int, program: Path) -> list[Run]:
    found = [_of_34("387", 1, "soft", 4.0, True), _of_34("387", 1, "hard", 1.0, True), _of_34("1.8k", 0.48, "soft", 0.1, True),
             _of_34("1.8k", 0.48, "hard", 0.1, True), _of_34("9.7k", 0.206, "soft", 0.1, False)]
    # Long enough for the boxes to lie on each other: what helps a heap may do nothing in a fall.
    pile = FOLDER / "pile.toml"
    pile.write_text(pile_scene())
    settings = (f"step.dt_s={PILE_DT_S}", f"end.time_s={PILE_END_S}", f"output.every_s={PILE_END_S}")
    found += [Run(f"pile {contact}", "run", pile, (*settings, f"method.contact={contact}", "method.start=unloaded"), False) for contact in SLOPE_METHODS]
    for s in range(seed, seed + slope_count):
        # Drawn where random scenes are at home.
        file = Path(call([sys.executable, str(ROOT / "stress/stress.py"), "--part", "slopes", "--keep", str(s), "--openclose", str(program), "--results", str(FOLDER)]).strip())
        found += [Run(f"slope {s} {contact}", "fos", file, (f"method.contact={contact}", "strength_reduction.definition=large_displacements"), False, 1,
                      SLOPE_LIMIT_S) for contact in SLOPE_METHODS]
    return found


@dataclass(frozen=True)
class Outcome:
    cost: float
    answer: str  # what a run without the mechanism has to give, too
    iterations: int
    failed: bool


def measure(program: Path, run: Run, more: tuple[str, ...]) -> Outcome:
    output = FOLDER / "output"
    arguments = [str(program), run.command, str(run.scene), "-q", "-o", str(output)]
    for setting in (*run.settings, *more):
        arguments += ["--set", setting]
    if run.counted:
        arguments = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null", *arguments]
    costs = []
    for _ in range(1 if run.counted else run.repeats):
        shutil.rmtree(output, ignore_errors=True)
        before = os.times()
        # Of CPU time: what else the machine does must not look like a failure.
        done = run_process(arguments, run.limit_s)
        after = os.times()
        counted = re.search(r"I +refs: +([\d,]+)", done.stderr)
        costs.append(float(counted[1].replace(",", "")) if counted else after.children_user - before.children_user)
        if was_stopped(done):
            return Outcome(run.limit_s, TIME_LIMIT, 0, True)
        if done.returncode not in (DONE, NOT_CONVERGED) or not (output / "summary.json").is_file():
            return Outcome(min(costs), f"exit {done.returncode}", 0, True)
    summary = json.loads((output / "summary.json").read_text())
    iterations = summary.get("counters", {}).get("iterations", 0)
    if run.command == "fos":
        answer = json.dumps(summary.get("factor_of_safety"))
        return Outcome(min(costs), answer, iterations, answer in ("null", "{}"))
    last = read_rows(output / "history.csv")[-1]
    return Outcome(min(costs), f"{float(last['displacement_x_m']):.8g} {float(last['displacement_y_m']):.8g}", iterations, not summary["converged"])


def sources_without(mechanism: dict) -> dict[str, str]:
    """The files that its edits change."""
    edited = {}
    for file, original, replacement in mechanism.get("edit", []):
        text = edited.get(file) or (ROOT / file).read_text()
        if text.count(original) != 1:
            stop(f"{mechanism['name']}: found {text.count(original)} times in {file}: {original}")
        edited[file] = text.replace(original, replacement)
    return edited


def stop(why: str) -> NoReturn:
    print(f"ablation: {why}", file=sys.stderr)
    sys.exit(2)


def build(mechanism: dict) -> Path:
    """The program without a mechanism."""
    name = re.sub(r"\W+", "_", mechanism["name"])
    program = FOLDER / "bin" / name
    if program.is_file():
        return program
    tree = FOLDER / "tree"
    edited = sources_without(mechanism)
    for entry in COPIED:
        source = ROOT / entry
        for path in [source] if source.is_file() else sorted(p for p in source.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
            relative = str(path.relative_to(ROOT))
            content = edited[relative].encode() if relative in edited else path.read_bytes()
            target = tree / relative
            if target.is_file() and target.read_bytes() == content:
                continue  # keeps its time, so that it is not compiled again
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            shutil.copymode(path, target)
    done = run_process(["scripts/build", "release", "openclose"], folder=tree)
    if done.returncode != DONE:
        stop(f"{mechanism['name']}: {done.stdout[-3000:]}{done.stderr[-1000:]}")
    program.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(tree / "build/release/openclose", program)
    return program


def cell(without: Outcome, reference: Outcome) -> str:
    if without.failed != reference.failed:
        return "fails" if without.failed else "fails with it"
    change = "" if without.answer == reference.answer else " ~"
    steps = "" if without.iterations == reference.iterations else f" ({without.iterations / max(1, reference.iterations):.3f})"
    return f"{without.cost / max(reference.cost, 1e-9):.3f}{steps}{change}"


def write(results: Path, columns: list[str], rows: list[list[str]]) -> None:
    results.mkdir(parents=True, exist_ok=True)
    with open(results / "ablation.csv", "w", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows([["without", *columns], *rows])
    note = "Cost without over cost with; in brackets the iterations, where they differ; ~ where the answer does."
    (results / "ablation.md").write_text(f"{note}\n\n{markdown_table(['without', *columns], rows)}\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=ROOT / "results/ablation")
    parser.add_argument("--slopes", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="runs whose name has this in it")
    parser.add_argument("name", nargs="*")
    given = parser.parse_args()
    with open(Path(__file__).resolve().parent / "ablation.toml", "rb") as stream:
        mechanisms = tomllib.load(stream)["mechanism"]
    chosen = [m for m in mechanisms if not given.name or any(n in m["name"] for n in given.name)]
    for mechanism in chosen:
        sources_without(mechanism)
    shutil.rmtree(FOLDER / "bin", ignore_errors=True)
    plain = build({"name": "nothing"})
    wanted = [r for r in runs(given.slopes, given.seed, plain) if given.only in r.name]
    reference = [measure(plain, run, ()) for run in wanted]
    # All random slopes of a method are one column: their costs added up.
    columns = [r.name for r in wanted if not r.name.startswith("slope")]
    methods = sorted({r.name.split()[2] for r in wanted if r.name.startswith("slope")})
    rows = []
    for mechanism in chosen:
        program = build(mechanism) if "edit" in mechanism else plain
        found = [measure(program, run, tuple(mechanism.get("set", ()))) for run in wanted]
        row = [cell(f, r) for run, f, r in zip(wanted, found, reference) if run.name in columns]
        for method in methods:
            pairs = [(f, r) for run, f, r in zip(wanted, found, reference) if run.name.startswith("slope") and run.name.endswith(method) and r.answer != TIME_LIMIT]
            fails, mends = sum(f.failed and not r.failed for f, r in pairs), sum(r.failed and not f.failed for f, r in pairs)
            ratio = sum(f.cost for f, _ in pairs) / sum(r.cost for _, r in pairs)
            others = sum(f.answer != r.answer for f, r in pairs)
            row.append(f"{ratio:.2f}" + (f" {fails} fail" if fails else "") + (f" {mends} mended" if mends else "") + (f" ~{others}" if others else ""))
        rows.append([mechanism["name"], *row])
        write(given.results, columns + [f"{given.slopes} slopes {m}" for m in methods], rows)
        print(" | ".join(rows[-1]), flush=True)


if __name__ == "__main__":
    main()
