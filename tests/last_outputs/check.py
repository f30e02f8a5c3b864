#!/usr/bin/env python3
"""Compares what the program prints and writes with what it printed and wrote last, to the last bit.

    tests/last_outputs/check.py OPENCLOSE                    digests of all cases against digests.csv
    tests/last_outputs/check.py OPENCLOSE --only WORD...     cases with one of these words in their title
    tests/last_outputs/check.py OPENCLOSE --show TITLE       what the digests of a case are made of, to compare two programs with diff
    tests/last_outputs/check.py OPENCLOSE --renew            writes digests.csv anew

These are no checks of physics: they say that an answer is another one, not which of the two is right. A change that is meant to alter outputs
renews the digests and says why. Times of computing and memory of the process are left out. The bits hold where
sines, cosines and powers of the C library are those of the table's first row; elsewhere nothing is compared.

Exit status: 0 if all are the same, 1 if one is another, 2 if no case has the title, 77 if the machine's sines are others.
"""

import argparse
import csv
import hashlib
import math
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import commands
import mixtures
import sweeps
from case import Case
from openclose_scripts import ROOT
from openclose_scripts.csv_rows import read_rows

DIGESTS = Path(__file__).resolve().parent / "digests.csv"
COLUMNS = ["case", "output", "digest"]
SKIPPED = 77  # what ctest takes for skipped
SINES = ("the C library", "sines, cosines and powers")
# [s] Fifty times what the longest command takes alone on a machine.
LIMIT_S = 100
# Digits of sha256 that are kept: two of a thousand digests are the same by chance once in 1e13.
DIGITS = 16
# Thousands of small files are written: not to a disk where there is a file system in memory.
MEMORY = Path("/dev/shm")
# Seals of files that hold times, and a picture with an axis of times.
NOT_COMPARED = {".openclose", "study.svg"}
# In files of text: times of computing, what the process holds of the machine's memory, and what is made of them.
FLEETING = [re.compile(pattern) for pattern in (
    r'("(?:cpu_s|stage_s)":\s*)\{[^}]*\}',
    r'("(?:cpu[a-z_]*_s|wall_s|peak_memory_bytes|program|without_factor|milestones\.csv)":\s*)[-+0-9.e]+',
    r"(<!-- Written by openclose )[0-9a-f]+",
)]


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:DIGITS]


def steady(text: str) -> str:
    for pattern in FLEETING:
        text = pattern.sub(r"\1#", text)
    return text


def without_times(table: str) -> str:
    """A table in which columns of CPU time are empty."""
    lines = [line.split(",") for line in table.splitlines()]
    timed = [i for i, name in enumerate(lines[0] if lines else []) if name.startswith("cpu")]
    return "\n".join(",".join("#" if i in timed else word for i, word in enumerate(line)) for line in lines) if timed else table


def content_of(path: Path) -> bytes:
    content = path.read_bytes()
    if path.suffix == ".bin":
        return content
    text = content.decode("utf-8", "surrogateescape")
    return (without_times(text) if path.suffix == ".csv" else steady(text)).encode("utf-8", "surrogateescape")


def said_by(arguments: list[str], folder: Path) -> str:
    """What a command prints, and its exit status."""
    try:
        done = subprocess.run(["./openclose", *arguments], cwd=folder, capture_output=True, encoding="utf-8", errors="surrogateescape", timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return "[too long]\n"
    return f"{done.stdout}{done.stderr}[{done.returncode}]\n"


def outputs_of(case: Case, openclose: Path) -> dict[str, bytes]:
    """What the commands of a case print and write, by name; they run one after the other in a folder of their own, in which they find the tree's scenes."""
    outputs = {}
    with tempfile.TemporaryDirectory(dir=MEMORY if os.access(MEMORY, os.W_OK) else None) as name:
        folder = Path(name)
        for scenes in ("examples", "paper", "verification"):
            (folder / scenes).symlink_to(ROOT / scenes)
        # Help and messages name the program as it was called.
        (folder / "openclose").symlink_to(openclose)
        for file, text in case.files.items():
            (folder / file).write_text(text, encoding="utf-8")
        said = []
        for arguments in case.commands:
            said.append(f"$ {' '.join(arguments)}\n{said_by(arguments, folder)}")
            if case.must_succeed and not said[-1].endswith("[0]\n"):
                raise SystemExit(f"{case.title}: this must succeed:\n{said[-1]}")
        outputs["printed"] = steady("".join(said)).encode("utf-8", "surrogateescape")
        for path in sorted(folder.rglob("*")):
            name = str(path.relative_to(folder))
            if path.is_file() and not path.is_symlink() and path.name not in NOT_COMPARED and name not in case.files:
                outputs[name] = content_of(path)
    return {"all": b"".join(name.encode() + b"\n" + content for name, content in outputs.items())} if case.together else outputs


def sines() -> str:
    """A digest of what the C library makes of some thousand arguments; Python calls the same functions."""
    values = [f(0.37 * i) for i in range(-1000, 1000) for f in (math.sin, math.cos, math.tan, math.atan)]
    values += [f(0.013 * i) for i in range(1, 1000) for f in (math.exp, math.log, math.tanh, lambda x: math.pow(x, 1.7), lambda x: math.hypot(x, 1.0))]
    return digest("\n".join(v.hex() for v in values).encode())


def cases() -> list[Case]:
    return [*commands.cases(), *sweeps.cases(), *mixtures.cases()]


def measured(selected: list[Case], openclose: Path, jobs: int) -> Iterator[tuple[str, dict[str, str]]]:
    """Titles of cases and the digests of their outputs, as they come."""
    with ThreadPoolExecutor(jobs) as pool:
        try:
            for case, outputs in zip(selected, pool.map(lambda case: outputs_of(case, openclose), selected)):
                yield case.title, {name: digest(content) for name, content in sorted(outputs.items())}
        finally:
            pool.shutdown(cancel_futures=True)


def write_digests(openclose: Path, jobs: int) -> None:
    rows = [(title, name, value) for title, digests in measured(cases(), openclose, jobs) for name, value in digests.items()]
    with open(DIGESTS, "w", newline="", encoding="utf-8") as stream:
        csv.writer(stream, lineterminator="\n").writerows([COLUMNS, (*SINES, sines()), *rows])


def read_digests() -> dict[str, dict[str, str]]:
    kept: dict[str, dict[str, str]] = {}
    for row in read_rows(DIGESTS):
        kept.setdefault(row["case"], {})[row["output"]] = row["digest"]
    return kept


def changes(found: dict[str, str], kept: dict[str, str]) -> list[str]:
    """Names of outputs that are others, are no longer there or are new."""
    def told(name: str) -> str:
        return name if name in found and name in kept else f"{name} (no longer there)" if name in kept else f"{name} (new)"
    return [told(name) for name in {**kept, **found} if found.get(name) != kept.get(name)]


def compare(selected: list[Case], openclose: Path, options) -> int:
    kept = read_digests()
    if kept.pop(SINES[0], {}) != {SINES[1]: sines()}:
        print("skipped: this machine's C library has other sines than the one that digests.csv was made on")
        return SKIPPED
    gone = [] if options.only else [title for title in kept if title not in {case.title for case in selected}]
    for title in gone:
        print(f"{title}: no such case")
    same = 0
    for title, digests in measured(selected, openclose, options.jobs):
        found = changes(digests, kept.get(title, {}))
        same += not found
        if found:
            print(f"{title}: {', '.join(found)}", flush=True)
            if options.abort:
                return 1
    print(f"{same} of {len(selected)} cases print and write what they did")
    return 1 if gone or same < len(selected) else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("openclose", type=Path)
    parser.add_argument("--only", nargs="+", metavar="WORD", help="only cases with one of these words in their title")
    parser.add_argument("--show", metavar="TITLE", help="print what the digests of this case are made of")
    parser.add_argument("--renew", action="store_true", help="write digests.csv anew")
    parser.add_argument("--abort", action="store_true", help="end with the first case that is another")
    parser.add_argument("--jobs", type=int, default=1, help="commands at a time (default: %(default)s)")
    options = parser.parse_args()
    openclose = options.openclose.resolve()
    if options.show:
        selected = [c for c in cases() if c.title == options.show]
    else:
        selected = [c for c in cases() if not options.only or any(word in c.title for word in options.only)]
    if not selected:
        parser.error("no case has this title")
    if options.show:
        for name, content in outputs_of(selected[0], openclose).items():
            sys.stdout.buffer.write(f"=== {name}\n".encode() + content + b"\n")
        return 0
    if options.renew:
        write_digests(openclose, options.jobs)
        return 0
    return compare(selected, openclose, options)


if __name__ == "__main__":
    sys.exit(main())
