"""Stops runs at random moments and goes on from what they leave: no table, no checkpoint and no bit may be lost by it.

    python3 tests/cli/interrupt.py OPENCLOSE [--count 50] [--seed 1]

Every scene and method is run once without a stop. Then it is begun `count` times with each signal, SIGKILL (no chance to say anything) and SIGINT (Ctrl-C),
sent at a moment drawn from the whole length of the run, and continued; of what was continued, every third is stopped once more. In the end all tables and
the hash of the state must be those of the run that was never stopped. Exit status 0 or 1.
"""

import argparse
import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TABLES = ("history.csv", "energy.csv", "blocks.csv", "contacts.csv", "block_states.csv", "cracks.csv")
METHODS = ("soft", "hard", "dem", "shi")
STOPPED_BY_INTERRUPT = 130
HEAD = """title = "A pile of boxes that falls"
[[material]]
name = "rock"
density_kg_per_m3 = 2500
[[joint]]
materials = ["rock", "rock"]
normal_stiffness_pa_per_m = 1e8
shear_stiffness_pa_per_m = 4e7
friction_angle_deg = 30
[method]
start = "unloaded"
[step]
dt_s = 0.002
[end]
time_s = 2.0
[output]
every_s = 0.01
snapshots_every_s = 0.05
checkpoint_every_s = 0.1
[[block]]
name = "floor"
material = "rock"
fixed = true
vertices_m = [[-3, -1], [9, -1], [9, 0], [-3, 0]]
"""
ROWS, COLUMNS = 8, 5


def scene():
    """Boxes a little apart, each row moved sideways, so that they knock each other over."""
    text = HEAD
    for row in range(ROWS):
        for column in range(COLUMNS):
            x, y = 1.05 * column + 0.21 * (row % 3), 0.02 + 1.03 * row
            corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]]
            text += f'[[block]]\nname = "box {row}-{column}"\nmaterial = "rock"\nvertices_m = {corners}\n'
    return text + '[[measured_point]]\nname = "top"\npoint_m = [2.7, 7.5]\n'


class Trial:
    """One folder of results, with what it should be in the end."""

    def __init__(self, openclose, place, method, whole):
        self.place, self.whole, self.folder = place, whole, place / f"{method}-stopped"
        self.command = [openclose, "run", "scene.toml", "--contact", method, "--quiet", "-o", self.folder.name]
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self):
        checkpoint = self.folder / "checkpoint.bin"
        restart = ["--restart", f"{self.folder.name}/checkpoint.bin"] if checkpoint.is_file() else []
        return subprocess.Popen(self.command + restart, cwd=self.place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def stop_after(self, seconds, sign):
        """Exit status, and what was said."""
        process = self.start()
        time.sleep(seconds)
        process.send_signal(sign)
        errors = process.communicate()[1]
        return process.returncode, errors

    def finish(self):
        process = self.start()
        errors = process.communicate()[1]
        return f"exit status {process.returncode} of the run that went on: {errors.strip()}" if process.returncode else differences(self.whole, self.folder)


def state_hash(folder):
    return json.loads((folder / "summary.json").read_text())["state_hash"]


def differences(whole, other):
    """Empty if there are none."""
    different = [name for name in TABLES if (whole / name).read_bytes() != (other / name).read_bytes()]
    if state_hash(whole) != state_hash(other):
        different.append("state_hash")
    return ", ".join(different)


def content_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()} if folder.is_dir() else {}


def expected_end(sign, status, touched):
    """Whether a stopped process may end like this: before the signal came, by SIGKILL, with all that is known saved, or before it has touched anything."""
    if sign == signal.SIGKILL:
        return status in (0, -signal.SIGKILL)
    return status in (0, STOPPED_BY_INTERRUPT) or (status == -signal.SIGINT and not touched)


def interrupt(trial, sign, length, moments, again):
    """What went wrong, or an empty text; and how many of the signals came in time."""
    in_time = 0
    for _ in range(2 if again else 1):
        before = content_of(trial.folder)
        status, errors = trial.stop_after(moments.uniform(0.0, length), sign)
        if not expected_end(sign, status, content_of(trial.folder) != before):
            return f"exit status {status} after signal {sign}: {errors.strip()}", in_time
        in_time += status != 0
    return trial.finish(), in_time


def try_method(openclose, place, method, count, moments):
    whole = place / f"{method}-whole"
    begin = time.monotonic()
    subprocess.run([openclose, "run", "scene.toml", "--contact", method, "--quiet", "-o", whole.name], cwd=place, check=True)
    length = time.monotonic() - begin
    faults = 0
    for sign in (signal.SIGKILL, signal.SIGINT):
        in_time = 0
        for number in range(count):
            trial = Trial(openclose, place, method, whole)
            fault, hits = interrupt(trial, sign, length, moments, again=number % 3 == 2)
            in_time += hits
            if fault:
                faults += 1
                print(f"{method}, {sign.name}, number {number}: {fault}")
        print(f"{method}: {count} runs stopped by {sign.name} ({in_time} signals in time) and continued")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("openclose", type=Path)
    parser.add_argument("--count", type=int, default=50, help="moments for each signal and method (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the moments (default: %(default)s)")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    arguments = parser.parse_args()
    moments = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "scene.toml").write_text(scene())
        faults = sum(try_method(arguments.openclose.resolve(), place, method, arguments.count, moments) for method in arguments.methods)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
