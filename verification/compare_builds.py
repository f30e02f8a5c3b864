#!/usr/bin/env python3
"""Runs the same scenes with two builds of the program and compares what they write byte by byte.

    compare_builds.py FIRST SECOND      two openclose programs, e.g. of g++ and of clang++

Compared are all tables of results but for CPU times, and for runs the state at the end with all its bits (checkpoint.bin). Exit status 1 if anything
differs; the first line that does is printed.
"""
import pathlib
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


def results_of(program: str, arguments: list, folder: pathlib.Path) -> tuple[int, dict[str, bytes]]:
    command = [program, *map(str, arguments), "--quiet", "-o", str(folder)]
    status = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
    names = [*folder.glob("*.csv"), *folder.glob("checkpoint.bin")]
    return status, {f.name: f.read_bytes() for f in names if f.name not in WITH_TIMES}


def first_difference(name: str, one: bytes, other: bytes) -> str:
    if name.endswith(".bin"):
        at = next((i for i, (a, b) in enumerate(zip(one, other)) if a != b), min(len(one), len(other)))
        return f"{name}: byte {at} of {len(one)} and {len(other)}"
    for number, (a, b) in enumerate(zip(one.splitlines(), other.splitlines()), 1):
        if a != b:
            return f"{name}:{number}:\n    {a.decode()}\n    {b.decode()}"
    return f"{name}: one is longer"


def differences(first: str, second: str, arguments: list) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        one, a = results_of(first, arguments, pathlib.Path(folder) / "first")
        other, b = results_of(second, arguments, pathlib.Path(folder) / "second")
    if one != other:
        return [f"exit status {one} and {other}"]
    if not a:
        return [f"no results, exit status {one}"]
    if a.keys() != b.keys():
        return [f"files {sorted(a)} and {sorted(b)}"]
    return [first_difference(name, a[name], b[name]) for name in sorted(a) if a[name] != b[name]]


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    failed = 0
    for title, arguments in CASES.items():
        found = differences(sys.argv[1], sys.argv[2], arguments)
        print(f"{title}: {'the same bits' if not found else 'DIFFERS: ' + '; '.join(found)}", flush=True)
        failed += bool(found)
    print(f"{len(CASES) - failed} of {len(CASES)} scenes agree bit for bit")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
