#!/usr/bin/env python3
"""Plants the faults of faults.toml one by one in copies of the source tree and reports which check notices each.

    mutants/run.py [--jobs N] [--results DIR] [--unit-tests-only] [ID...]     all faults, or the named ones
    mutants/run.py --check-list                                               only whether every fault still fits the source
    mutants/run.py --random 200 --seed 1                                      faults of one token at random places, see random_faults.py

Every worker has a copy of the tree with a build of its own under build/mutants. A fault is tried on the unit tests of its own folder, then on those
of the folders after it in the order of the data, then of those before it, then on the verification cases, one group after the other until one is red;
only what they need is built, and what comes out the same, byte for byte, as without the fault is not run again. Writes mutants.csv and mutants.md; named
faults replace their rows there and leave the others. A fault that only ends checks by an exception that no test expects, by a signal or by their time
limit has not been caught by an assertion: it is listed as such.

Random faults are tried on what the program printed and wrote last, too (tests/last_outputs), after the tests of their own folder: that says that an answer has
changed, not that it is wrong. They go to mutants-random.csv and .md. One that does not compile is none, and neither is one that compiles to the same program, however it is
written. Those that survive are to be judged one by one: the same answers, or a check that is missing; their rate is of all others.

Exit status: 0 if every fault was caught, 1 if one was not, 2 if the list does not fit the source or the source without a fault is red.
"""

import argparse
import csv
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as xml
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

try:
    import tomllib
except ImportError:
    sys.exit("mutants: Python 3.11 or later is needed, which reads TOML")

import random_faults
from openclose_scripts import ROOT
from openclose_scripts.csv_rows import read_rows
from openclose_scripts.markdown import markdown_table

FAULTS = Path(__file__).resolve().parent / "faults.toml"
COPIED = ["CMakeLists.txt", "CMakePresets.json", "analytical", "cmake", "docs", "examples", "mutants", "paper", "python", "scripts", "src", "stress", "tests",
          "verification"]
COLUMNS = ["id", "folder", "file", "description", "caught_by", "kind", "seconds"]
CAUGHT = ("unit test", "verification")
DOES_NOT_COMPILE = "does not compile"
SAME_PROGRAM = "same program"
NO_FAULTS = (DOES_NOT_COMPILE, SAME_PROGRAM)
# What a random fault is noticed by, too: whoever changes the code sees it.
LAST_OUTPUTS = "last outputs"
NOTICED = (*CAUGHT, LAST_OUTPUTS, "crash", "time-out")
# A check may take this many times as long as without a fault, and so much more: others use the machine, too.
TIME_FACTOR, TIME_MARGIN_S = 4.0, 60.0
FEWEST_PER_FOLDER = 4
SKIPPED = 77  # exit status of a comparison that this machine's sines forbid
OPENCLOSE = "build/release/openclose"


class ListError(Exception):
    pass


def folders():
    """The folders of src/ in the order of the data, and limit analysis before those that link it."""
    found = re.findall(r"^add_subdirectory\((\w+)\)", (ROOT / "src/CMakeLists.txt").read_text(), re.M)
    found.insert(found.index("analysis"), "limit_analysis")
    return found


def folder_of(fault):
    return Path(fault["file"]).parts[1]


def read_faults():
    with open(FAULTS, "rb") as stream:
        faults = tomllib.load(stream)["fault"]
    for fault in faults:
        name = fault.get("id", "a fault without id")
        if sorted(set(fault) - {"note"}) != ["description", "file", "id", "original", "replacement"]:
            raise ListError(f"{name}: the keys are {', '.join(sorted(fault))}; needed: description, file, id, original, replacement, "
                            "and a note where it is known why the fault survives")
        if [other["id"] for other in faults].count(name) != 1:
            raise ListError(f"{name}: the id is there twice")
        if "\n" in fault["original"] + fault["replacement"] or fault["original"] == fault["replacement"]:
            raise ListError(f"{name}: a fault changes one line")
        if not re.fullmatch(r"(src/\w+|analytical/limit_analysis)/[\w.]+", fault["file"]) or not (ROOT / fault["file"]).is_file():
            raise ListError(f"{name}: there is no source {fault['file']}")
        found = (ROOT / fault["file"]).read_text().count(fault["original"])
        if found != 1:
            raise ListError(f"{name}: the original text is found {found} times in {fault['file']}; it must be there once: {fault['original']}")
    for folder in folders():
        count = sum(folder_of(fault) == folder for fault in faults)
        if count < FEWEST_PER_FOLDER:
            raise ListError(f"{folder} has {count} faults; at least {FEWEST_PER_FOLDER} are needed")
    return faults


class Outcome:
    """Of one check: kind is None where it is green."""

    def __init__(self, kind=None, by="", text=""):
        self.kind, self.by, self.text = kind, by, text


class Worker:
    """A copy of the tree, its build, and what checks take there without a fault."""

    def __init__(self, number):
        self.tree = ROOT / "build/mutants" / str(number)
        self.limits = {}
        self.faultless = {}
        self.environment = dict(os.environ)
        for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
            self.environment.pop(name, None)
        if shutil.which("ccache"):
            # All copies look alike to the cache.
            self.environment |= {"CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "CCACHE_BASEDIR": str(self.tree), "CCACHE_NOHASHDIR": "1"}

    def prepare(self):
        self.tree.mkdir(parents=True, exist_ok=True)
        for name in COPIED:
            source, target = ROOT / name, self.tree / name
            # Files that are the same keep their time, so that what an earlier study has built stays up to date.
            if source.is_dir():
                links = [p.relative_to(source) for p in source.rglob("*") if p.is_symlink()]
                wanted = {p.relative_to(source) for p in source.rglob("*") if p.is_file() and not p.is_symlink() and "__pycache__" not in p.parts}
                for path in target.rglob("*") if target.is_dir() else []:
                    if path.is_file() and path.relative_to(target) not in wanted:
                        path.unlink()
                for path in sorted(wanted):
                    self.copy(source / path, target / path)
                for path in links:
                    self.link(source / path, target / path)
            else:
                self.copy(source, target)

    @staticmethod
    def copy(source, target):
        content = source.read_bytes()
        if target.is_file() and target.read_bytes() == content:
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
        shutil.copymode(source, target)

    @staticmethod
    def link(source, target):
        if target.is_symlink() or target.exists():
            target.unlink()
        target.parent.mkdir(parents=True, exist_ok=True)
        target.symlink_to(source.readlink())

    def build(self, target):
        run = subprocess.run(["scripts/build", "release", target], cwd=self.tree, env=self.environment, capture_output=True, text=True)
        return run.returncode == 0, run.stdout + run.stderr

    def command(self, check):
        """One red check is enough."""
        if check == "verification":
            return "openclose-verify", ["build/release/verification/openclose-verify", "--results", "build/verification-results"]
        if check == LAST_OUTPUTS:
            return "openclose", [sys.executable, "tests/last_outputs/check.py", OPENCLOSE, "--abort"]
        return f"test_{check}", [f"build/release/tests/{check}/test_{check}", "--abort", "--reporter", "junit", "--out", f"build/{check}.xml"]

    def programs(self, check):
        """Digests of what a check runs."""
        files = ([] if check == LAST_OUTPUTS else [self.command(check)[1][0]]) + ([OPENCLOSE] if check in ("cli", LAST_OUTPUTS) else [])
        return [hashlib.sha256((self.tree / file).read_bytes()).hexdigest() for file in files]

    def remember_faultless(self, checks):
        """Builds the source without a fault and keeps the digests of its programs, which name the folder of their tree."""
        for check in checks:
            built, text = self.build(self.command(check)[0])
            if not built:
                raise ListError(f"without any fault {check} does not compile\n{text[-3000:]}")
            self.faultless[check] = self.programs(check)

    def run(self, check):
        """Builds what a check needs and runs it, if that is another program than without the fault."""
        target, command = self.command(check)
        built, text = self.build(target)
        if not built:
            return Outcome(DOES_NOT_COMPILE, target, text)
        if self.programs(check) == self.faultless.get(check):
            return Outcome(SAME_PROGRAM)
        begin = time.monotonic()
        runs = {"verification": self.run_verification, LAST_OUTPUTS: self.compare_last_outputs}
        outcome = runs[check](command) if check in runs else self.run_tests(check, command)
        if check not in self.limits and outcome.kind is None:
            self.limits[check] = TIME_FACTOR * (time.monotonic() - begin) + TIME_MARGIN_S
        return outcome

    def finished(self, command, limit):
        """Exit status and output; None for the status of what the limit of time has ended, with all that it had started."""
        run = subprocess.Popen(command, cwd=self.tree, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
        try:
            text, _ = run.communicate(timeout=limit)
            return run.returncode, text
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            run.communicate()
            return None, ""

    def run_tests(self, check, command):
        report = self.tree / "build" / f"{check}.xml"
        report.unlink(missing_ok=True)
        status, text = self.finished(command, self.limits.get(check))
        if status is None:
            return Outcome("time-out", f"tests/{check}")
        if status == 0:
            return Outcome()
        failures, errors = self.red_tests(report)
        if failures:
            return Outcome("unit test", f"tests/{check}: {failures[0]}")
        return Outcome("crash", f"tests/{check}: {errors[0]}" if errors else f"tests/{check}", text)

    @staticmethod
    def red_tests(report):
        """Names of the test cases in which an assertion failed, and of those that something unexpected ended."""
        try:
            cases = xml.parse(report).getroot().iter("testcase")
        except (OSError, xml.ParseError):
            return [], []
        red = {"failure": [], "error": []}
        for case in cases:
            for kind, names in red.items():
                if case.find(kind) is not None:
                    names.append(case.get("name"))
        return red["failure"], red["error"]

    def compare_last_outputs(self, command):
        status, text = self.finished(command, self.limits.get(LAST_OUTPUTS))
        if status is None:
            return Outcome("time-out", LAST_OUTPUTS)
        return Outcome() if status in (0, SKIPPED) else Outcome(LAST_OUTPUTS, (text.splitlines() or [f"exit status {status}"])[0], text)

    def run_verification(self, command):
        """Ends with the first row that is red."""
        run = subprocess.Popen(command, cwd=self.tree, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        late = threading.Event()
        timer = threading.Timer(self.limits.get("verification", 3600.0), lambda: (late.set(), run.kill()))
        timer.start()
        group = text = ""
        try:
            for line in run.stdout:
                text += line
                if re.match(r"\S", line):
                    group = line.split()[0]
                if line.endswith(" FAIL\n"):
                    run.kill()
                    return Outcome("verification", f"{group}: {re.split(r'  +', line.strip())[0]}")
            run.wait()
        finally:
            timer.cancel()
            run.stdout.close()
            run.wait()
        if late.is_set():
            return Outcome("time-out", "verification")
        return Outcome() if run.returncode == 0 else Outcome("crash", f"verification: {group}", text)

    def try_fault(self, fault, checks, enough):
        """Goes through the checks until one notices the fault in a way that is enough."""
        begin = time.monotonic()
        path = self.tree / fault["file"]
        original = path.read_text()
        first, changed = Outcome(), False
        path.write_text(planted(fault, original))
        try:
            for check in checks:
                outcome = self.run(check)
                if outcome.kind == SAME_PROGRAM:
                    continue
                changed = True
                if first.kind is None:
                    first = outcome
                if outcome.kind in (*enough, DOES_NOT_COMPILE):
                    first = outcome
                    break
        finally:
            path.write_text(original)
        green = "survived" if changed else SAME_PROGRAM
        row = described(fault) | {"caught_by": first.by, "kind": first.kind or green, "seconds": f"{time.monotonic() - begin:.1f}"}
        return row


def planted(fault, text):
    """The source with the fault; those of the list are where their text stands, random ones at a place."""
    at = fault["at"] if "at" in fault else text.index(fault["original"])
    return text[:at] + fault["replacement"] + text[at + len(fault["original"]):]


def described(fault):
    return {"id": fault["id"], "folder": folder_of(fault), "file": fault["file"], "description": fault["description"]}


def checks_for(folder, options):
    """The folder's own tests come first."""
    order = folders()
    at = order.index(folder)
    return order[at:at + 1] + ([LAST_OUTPUTS] if options.random else []) + order[at + 1:] + order[:at] + ([] if options.unit_tests_only else ["verification"])


def earlier_rows(path, faults):
    """What an earlier run has found for faults that are still the same."""
    if not path.is_file():
        return {}
    rows = [row for row in read_rows(path) if list(row) == COLUMNS]
    known = [described(fault) for fault in faults]
    return {row["id"]: row for row in rows if {key: row[key] for key in ("id", "folder", "file", "description")} in known}


def write_csv(path, rows):
    with open(path, "w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def write_page(path, rows, notes, enough):
    not_caught = [row for row in rows if row["kind"] not in enough]
    by_kind = {kind: sum(row["kind"] == kind for row in rows) for kind in enough}
    lines = ["# Planted faults", "",
             f"{len(rows)} faults of one line each, {sum(float(row['seconds']) for row in rows) / 60.0:.0f} minutes of builds and checks: "
             f"{len(rows) - len(not_caught)} caught "
             f"({', '.join(f'{count} by {kind}' for kind, count in by_kind.items())}), {len(not_caught)} not.", ""]
    by_folder = []
    for folder in folders():
        own = [row for row in rows if row["folder"] == folder]
        caught = [row for row in own if row["kind"] in enough]
        near = [row for row in caught if row["caught_by"].startswith(f"tests/{folder}:")]
        if own:
            by_folder.append([folder, len(own), len(caught), len(near)])
    lines += [markdown_table(("folder", "faults", "caught", "by the folder's own tests"), by_folder), "", "## Not caught", ""]
    lines += [f"- {row['id']} ({row['file']}): {row['description']}; {row['kind']}" + (f", {row['caught_by']}" if row["caught_by"] else "")
              + (f". {notes[row['id']]}" if row["id"] in notes else "")
              for row in not_caught] or ["None."]
    found = ([row["id"], row["file"], row["description"].replace("|", "/"), row["caught_by"].replace("|", "/")] for row in rows if row["kind"] in enough)
    lines += ["", "## Caught", "", markdown_table(("fault", "file", "what it does", "first check that is red"), found)]
    path.write_text("\n".join(lines) + "\n")


def digest_of_sources():
    files = sorted(p for name in COPIED for p in ([ROOT / name] if (ROOT / name).is_file() else (ROOT / name).rglob("*"))
                   if p.is_file() and "__pycache__" not in p.parts)
    return hashlib.sha256(b"".join(str(p.relative_to(ROOT)).encode() + p.read_bytes() for p in files)).hexdigest()


def baseline(worker, checks):
    """The limits of time; the source without a fault must be green, which is asked once as long as nothing changes."""
    known, key = ROOT / "build/mutants/baseline.json", digest_of_sources()
    kept = json.loads(known.read_text()) if known.is_file() else {}
    if kept.get("sources") == key and set(checks) <= set(kept["limits"]):
        worker.limits = kept["limits"]
        return
    for check in checks:
        outcome = worker.run(check)
        if outcome.kind:
            raise ListError(f"without any fault {outcome.by} is red: {outcome.kind}\n{outcome.text[-3000:]}")
    known.write_text(json.dumps({"sources": key, "limits": worker.limits}))


def study(faults, wanted, options):
    workers = [Worker(number) for number in range(options.jobs)]
    for worker in workers:
        worker.prepare()
    checks = checks_for(folders()[0], options)
    print("builds and checks the source without a fault", flush=True)
    baseline(workers[0], checks)
    for worker in workers:
        worker.limits = dict(workers[0].limits)
        worker.remember_faultless(checks)
    options.results.mkdir(parents=True, exist_ok=True)
    name = "mutants-random" if options.random else "mutants"
    table, page = options.results / f"{name}.csv", options.results / f"{name}.md"
    rows = earlier_rows(table, faults) if len(wanted) < len(faults) else {}
    free, done, lock = list(workers), [], threading.Lock()
    enough = NOTICED if options.random else CAUGHT

    def are_faults(found):
        """A random one may turn out to be none."""
        return [row for row in found if not (options.random and row["kind"] in NO_FAULTS)]

    def try_one(fault):
        with lock:
            worker = free.pop()
        try:
            row = worker.try_fault(fault, checks_for(folder_of(fault), options), enough)
        finally:
            with lock:
                free.append(worker)
        with lock:
            rows[row["id"]] = row
            done.append(row)
            print(f"{len(done):3}/{len(wanted)} {row['id']:<14} {row['kind']:<12} {row['seconds']:>6} s  {row['caught_by']}", flush=True)
            ordered = [rows[f["id"]] for f in faults if f["id"] in rows]
            write_csv(table, ordered)
            write_page(page, are_faults(ordered), {f["id"]: f["note"] for f in faults if "note" in f}, enough)

    with ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(try_one, wanted))
    done = are_faults(done)
    caught = sum(row["kind"] in enough for row in done)
    print(f"{caught} of {len(done)} faults caught; {table}, {page}")
    return 0 if caught == len(done) else 1


def in_order(faults, ids):
    """The faults with these ids, or all, in the order in which they are tried: what many sources include is compiled for long and comes last."""
    return sorted((f for f in faults if not ids or f["id"] in ids), key=lambda f: f["file"].endswith(".h"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ids", nargs="*", metavar="ID", help="faults to try (default: all)")
    parser.add_argument("--jobs", type=int, default=2, help="workers, each with a build of its own (default: 2)")
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="folder of mutants.csv and mutants.md")
    parser.add_argument("--unit-tests-only", action="store_true", help="leave out the verification cases, with which some faults then survive")
    parser.add_argument("--random", type=int, metavar="COUNT", help="so many faults at random places in place of those of the list")
    parser.add_argument("--seed", type=int, default=1, help="of the random places (default: %(default)s)")
    parser.add_argument("--check-list", action="store_true", help="only check that every fault fits the source")
    options = parser.parse_args()
    try:
        faults = random_faults.draw(ROOT, options.seed, options.random) if options.random else read_faults()
        unknown = set(options.ids) - {fault["id"] for fault in faults}
        if unknown:
            raise ListError(f"there is no fault {', '.join(sorted(unknown))}")
        if options.check_list:
            print(f"{len(faults)} faults fit the source")
            return 0
        return study(faults, in_order(faults, options.ids), options)
    except (ListError, tomllib.TOMLDecodeError) as error:
        print(f"mutants: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
