#!/usr/bin/env python3
"""Runs the same scenes with two builds of the program and compares what they write byte by byte.

    compare_builds.py FIRST SECOND                 two openclose programs, e.g. of g++ and of clang++
    compare_builds.py FIRST SECOND --only fos      only scenes whose title or command has one of these words
    compare_builds.py FIRST SECOND --answers       only what fos finds, where machines have other sines and tangents; both without limit analysis

A program may be a command, such as 'qemu-aarch64 -L build/sysroot-arm64 build/arm64/openclose'. Compared are all tables of results but for CPU times, the
hash of the state at the end, and for runs that state with all its bits (checkpoint.bin). Exit status 1 if anything differs; the first line that does is
printed.
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAPER, SCENES = ROOT / "paper/scenes", ROOT / "verification/scenes"
STATE = ["--set", "output.checkpoint_every_s=1e6"]
CASES = {
    "sliding block, soft": ["run", PAPER / "example_3_1.toml", *STATE],
    "sliding block, dem": ["run", PAPER / "example_3_1.toml", "--contact", "dem", "--end", "0.5", *STATE],
    "toppling, soft": ["run", PAPER / "example_3_2.toml", "--end", "1", *STATE],
    "wedge, factor of safety": ["fos", PAPER / "example_3_3_wedge.toml"],
    "toe, factor of safety": ["fos", PAPER / "example_3_3_toe.toml"],
    "483 blocks, factor of safety": ["fos", PAPER / "example_3_4.toml"],
    "483 blocks in failure, soft": ["run", PAPER / "example_3_4_post_failure.toml", "--end", "1", *STATE],
    "483 blocks in failure, hard": ["run", PAPER / "example_3_4_post_failure.toml", "--contact", "hard", "--end", "0.3", *STATE],
    "shaken block": ["run", SCENES / "shaken_block.toml", *STATE],
    "slope with columns, factor of safety": ["fos", SCENES / "slope_face_60_columns_m70.toml"],
    "slope, factor of safety": ["fos", SCENES / "slope_face_70_joints_20_m60.toml"],
}
WITH_TIMES = {"milestones.csv"}
ANSWERS = ["factor_of_safety", "verdict", "bracket"]


def run(program: str, arguments: list, folder: pathlib.Path) -> int:
    command = [*shlex.split(program), *map(str, arguments), "--quiet", "-o", str(folder)]
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode


def summary_of(folder: pathlib.Path) -> dict:
    summary = folder / "summary.json"
    return json.loads(summary.read_text()) if summary.exists() else {}


def results_of(program: str, arguments: list, folder: pathlib.Path) -> tuple[int, dict[str, bytes]]:
    status = run(program, arguments, folder)
    names = [*folder.glob("*.csv"), *folder.glob("checkpoint.bin")]
    results = {f.name: f.read_bytes() for f in names if f.name not in WITH_TIMES}
    if summary := summary_of(folder):
        results["state_hash"] = summary["state_hash"].encode()
    return status, results


def answer_of(program: str, arguments: list, folder: pathlib.Path) -> tuple[int, dict[str, bytes]]:
    status = run(program, [*arguments, "--set", "strength_reduction.limit_analysis=false"], folder)
    summary = summary_of(folder)
    answers = {key: json.dumps(summary[key]).encode() for key in ANSWERS if key in summary}
    answers["failing_blocks"] = json.dumps(summary.get("failing_blocks", {}).get("names")).encode()
    return status, answers if summary else {}


def first_difference(name: str, one: bytes, other: bytes) -> str:
    if name.endswith(".bin"):
        at = next((i for i, (a, b) in enumerate(zip(one, other)) if a != b), min(len(one), len(other)))
        return f"{name}: byte {at} of {len(one)} and {len(other)}"
    for number, (a, b) in enumerate(zip(one.splitlines(), other.splitlines()), 1):
        if a != b:
            return f"{name}:{number}:\n    {a.decode()}\n    {b.decode()}"
    return f"{name}: one is longer"


def differences(first: str, second: str, arguments: list, results_by) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        one, a = results_by(first, arguments, pathlib.Path(folder) / "first")
        other, b = results_by(second, arguments, pathlib.Path(folder) / "second")
    if one != other:
        return [f"exit status {one} and {other}"]
    if not a:
        return [f"no results, exit status {one}"]
    if a.keys() != b.keys():
        return [f"files {sorted(a)} and {sorted(b)}"]
    return [first_difference(name, a[name], b[name]) for name in sorted(a) if a[name] != b[name]]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first")
    parser.add_argument("second")
    parser.add_argument("--only", nargs="+", metavar="WORD")
    parser.add_argument("--answers", action="store_true")
    options = parser.parse_args()
    cases = {
        title: arguments
        for title, arguments in CASES.items()
        if not options.only or any(word in title or word == arguments[0] for word in options.only)
        if not options.answers or arguments[0] == "fos"
    }
    if not cases:
        parser.error("no scene has one of these words")
    same = "the same answer" if options.answers else "the same bits"
    failed = 0
    for title, arguments in cases.items():
        found = differences(options.first, options.second, arguments, answer_of if options.answers else results_of)
        print(f"{title}: {same if not found else 'DIFFERS: ' + '; '.join(found)}", flush=True)
        failed += bool(found)
    print(f"{len(cases) - failed} of {len(cases)} scenes: {same}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
