"""Calls the two commands, `openclose` and `openclose-reference`, and reads what they write."""

import csv
import io
import json
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

PARALLEL_PROCESSES = 2


class RunFailed(Exception):
    """A command did not end well; the message holds the command line and what it said."""


@dataclass(frozen=True)
class Case:
    """One call of `openclose`: `command` is run or fos, `settings` are --set KEY=VALUE pairs, `name` is that of its folder."""

    name: str
    command: str
    scene: Path
    settings: tuple[tuple[str, object], ...]


def _call(arguments: list[str]) -> str:
    try:
        done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    except OSError as error:
        raise RunFailed(f"cannot run {arguments[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise RunFailed(f"exit status {done.returncode} from: {' '.join(arguments)}\n{done.stderr.strip()}")
    return done.stdout


class Openclose:
    """Runs cases of `openclose`, each into a folder of its own below `folder`."""

    def __init__(self, executable: Path, folder: Path):
        self._executable = executable
        self._folder = folder

    def folder_of(self, case: Case) -> Path:
        return self._folder / case.name

    def run_all(self, cases: list[Case]) -> None:
        """Runs all cases, two at a time; raises RunFailed for the first that fails."""
        with ThreadPoolExecutor(PARALLEL_PROCESSES) as pool:
            jobs = [pool.submit(self._run, case) for case in cases]
            try:
                for job in jobs:
                    job.result()
            except RunFailed:
                pool.shutdown(cancel_futures=True)
                raise

    def table(self, case: Case, file: str) -> list[dict[str, str]]:
        """Rows of a CSV file that the case has written."""
        with open(self.folder_of(case) / file, newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    def summary(self, case: Case) -> dict:
        return json.loads((self.folder_of(case) / "summary.json").read_text(encoding="utf-8"))

    def _run(self, case: Case) -> None:
        arguments = [str(self._executable), case.command, str(case.scene), "--quiet", "-o", str(self.folder_of(case))]
        for key, value in case.settings:
            arguments += ["--set", f"{key}={value}"]
        _call(arguments)


class Reference:
    """The closed forms and the reference ODE of `openclose-reference`."""

    def __init__(self, executable: Path):
        self._executable = executable

    def table(self, command: str, options: dict[str, object], flags: tuple[str, ...] = ()) -> list[dict[str, str]]:
        """Rows of the CSV that a subcommand prints."""
        arguments = [str(self._executable), command, *flags]
        for key, value in options.items():
            arguments += [f"--{key}", str(value)]
        return list(csv.DictReader(io.StringIO(_call(arguments))))


def outlines(rows: list[dict[str, str]], state: str) -> dict[str, list[tuple[float, float]]]:
    """Vertices [m] of every block in one state, from the rows of blocks.csv."""
    blocks: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        if row["state"] == state:
            blocks.setdefault(row["block"], []).append((float(row["x_m"]), float(row["y_m"])))
    return blocks
