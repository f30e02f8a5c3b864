"""Stops runs at random moments and goes on from what they leave: no table, no checkpoint and no bit may be lost by it.

    python3 tests/cli/interrupt.py OPENCLOSE [--count 50] [--seed 1]

Every run, and every search for a factor of safety, is made once without a stop. Then it is begun `count` times with each signal, SIGKILL (no chance to say
anything) and SIGINT (Ctrl-C), sent at a moment drawn from its whole length, and continued; of what was continued, every third is stopped once more. In the
end all tables and the hash of the state must be those of the one that was never stopped. A run that is stopped while its start settles with `dem` has no
checkpoint: it must have left its folder as it was. Exit status 0 or 1.
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

STATE_TABLES = ("blocks.csv", "contacts.csv", "block_states.csv", "cracks.csv")
TABLES = {"run": ("history.csv", "energy.csv", *STATE_TABLES), "fos": ("trials.csv", *STATE_TABLES)}
METHODS = ("soft", "hard", "dem", "shi")
# Short, so that settling is much of it.
SETTLED_FIRST = ["--start", "settled", "--end", "0.1"]
# Narrower than anyone needs, for more trials.
SEARCHES = {
    "small displacements": ["strength_reduction.width=1e-9"],
    "multiplier of a load": ["strength_reduction.increase=gravity_x", "strength_reduction.width=1e-9"],
    "joint closures": ["strength_reduction.definition=joint_closures", "strength_reduction.width=1e-9"],
    "large displacements": ["strength_reduction.definition=large_displacements", "strength_reduction.width=1e-4", "settle.failure_displacement_m=0.05"],
    "large displacements, dem": ["method.contact=dem", "strength_reduction.definition=large_displacements", "settle.failure_displacement_m=0.05"],
}
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


def boxes(head, place):
    """The scene of rows of them; place(row, column) is the lower left corner of one."""
    text = head
    for row in range(ROWS):
        for column in range(COLUMNS):
            x, y = place(row, column)
            corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]]
            text += f'[[block]]\nname = "box {row}-{column}"\nmaterial = "rock"\nvertices_m = {corners}\n'
    return text + '[[measured_point]]\nname = "top"\npoint_m = [2.7, 7.5]\n'


def falling_pile():
    """Boxes a little apart, each row moved sideways, so that they knock each other over."""
    return boxes(HEAD, lambda row, column: (1.05 * column + 0.21 * (row % 3), 0.02 + 1.03 * row))


def leaning_wall():
    """Boxes on each other, every other row moved by a fifth of one, on a floor that is tilted a little."""
    return boxes('gravity_m_per_s2 = [1.0, -9.81]\n' + HEAD, lambda row, column: (column + 0.2 * (row % 2), float(row)))


class Case:
    """One command with its results when nothing stops it."""

    def __init__(self, openclose, place, title, command, scene, arguments):
        self.place, self.title, self.kind = place, title, command
        name = title.replace(",", "").replace(" ", "-")
        self.whole, self.stopped = place / f"{name}-whole", place / f"{name}-stopped"
        self.command = [openclose, command, scene, "--quiet", *arguments, "-o"]

    def run_whole(self):
        """The seconds that it takes."""
        begin = time.monotonic()
        subprocess.run([*self.command, self.whole.name], cwd=self.place, check=True)
        return time.monotonic() - begin

    def differences(self):
        """Between what was stopped and what was not; empty if there are none."""
        different = [name for name in TABLES[self.kind] if (self.whole / name).read_bytes() != (self.stopped / name).read_bytes()]
        if state_hash(self.whole) != state_hash(self.stopped):
            different.append("state_hash")
        return ", ".join(different)


class Trial:
    """One folder of results, made by a command that is stopped."""

    def __init__(self, case):
        self.case, self.folder = case, case.stopped
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self):
        checkpoint = self.folder / "checkpoint.bin"
        restart = ["--restart", f"{self.folder.name}/checkpoint.bin"] if checkpoint.is_file() else []
        return subprocess.Popen([*self.case.command, self.folder.name, *restart], cwd=self.case.place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

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
        return f"exit status {process.returncode} of what went on: {errors.strip()}" if process.returncode else self.case.differences()


def state_hash(folder):
    return json.loads((folder / "summary.json").read_text())["state_hash"]


def content_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()} if folder.is_dir() else {}


def expected_end(sign, status, touched):
    """Whether a stopped process may end like this: before the signal came, by SIGKILL, with all that is known saved, or before it has touched anything."""
    if sign == signal.SIGKILL:
        return status in (0, -signal.SIGKILL)
    return status in (0, STOPPED_BY_INTERRUPT) or (status == -signal.SIGINT and not touched)


def is_lost(trial, status, touched):
    """Whether what was stopped has changed its folder, and left nothing to go on from."""
    return status == STOPPED_BY_INTERRUPT and touched and not (trial.folder / "checkpoint.bin").is_file()


def interrupt(trial, sign, length, moments, again):
    """What went wrong, or an empty text; and how many of the signals came in time."""
    in_time = 0
    for _ in range(2 if again else 1):
        before = content_of(trial.folder)
        status, errors = trial.stop_after(moments.uniform(0.0, length), sign)
        touched = content_of(trial.folder) != before
        if is_lost(trial, status, touched):
            return f"stopped without a checkpoint, and the folder is not as it was: {errors.strip()}", in_time
        if not expected_end(sign, status, touched):
            return f"exit status {status} after signal {sign}: {errors.strip()}", in_time
        in_time += status != 0
    return trial.finish(), in_time


def try_case(case, count, moments):
    length = case.run_whole()
    faults = 0
    for sign in (signal.SIGKILL, signal.SIGINT):
        in_time = 0
        for number in range(count):
            fault, hits = interrupt(Trial(case), sign, length, moments, again=number % 3 == 2)
            in_time += hits
            if fault:
                faults += 1
                print(f"{case.title}, {sign.name}, number {number}: {fault}")
        print(f"{case.title}: {count} stopped by {sign.name} ({in_time} signals in time) and continued", flush=True)
    return faults


def cases(openclose, place, methods):
    (place / "pile.toml").write_text(falling_pile())
    (place / "wall.toml").write_text(leaning_wall())
    for method in methods:
        yield Case(openclose, place, f"run {method}", "run", "pile.toml", ["--contact", method])
        yield Case(openclose, place, f"run {method}, settled", "run", "wall.toml", ["--contact", method, *SETTLED_FIRST])
    for definition, settings in SEARCHES.items():
        arguments = [argument for setting in settings for argument in ("--set", setting)]
        yield Case(openclose, place, f"fos {definition}", "fos", "wall.toml", arguments)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("openclose", type=Path)
    parser.add_argument("--count", type=int, default=50, help="moments for each signal and case (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the moments (default: %(default)s)")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    arguments = parser.parse_args()
    moments = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        found = cases(arguments.openclose.resolve(), Path(folder), arguments.methods)
        faults = sum(try_case(case, arguments.count, moments) for case in found)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
