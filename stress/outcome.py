"""One call of `openclose`, and what it left behind."""

import csv
import json
import math
import resource
import shutil
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from openclose_scripts.csv_rows import read_rows
from openclose_scripts.processes import DONE, run_process, was_stopped

# Settings of each way to solve a scene; those that only motion knows have no factor of safety of their own.
METHODS = {
    "soft": {"method.contact": "soft"},
    "hard": {"method.contact": "hard"},
    "shi": {"method.contact": "shi"},
    "dem": {"method.contact": "dem"},
    "path_average": {"method.contact": "soft", "method.integrator": "path_average"},
}
LIMITS_WITHOUT_A_FACTOR = {"no equilibrium at any factor": 0.0, "stands at every factor": math.inf}
OF_MOTION_ONLY = ("path_average",)


@dataclass
class Outcome:
    folder: Path
    exit: int | None  # None: stopped at the limit of CPU time
    message: str      # what it said on standard error
    cpu_s: float

    @cached_property
    def summary(self) -> dict:
        file = self.folder / "summary.json"
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}

    @property
    def reason(self) -> str:
        """Why there is no result: what the summary says, or the last line that is no warning."""
        lines = [line for line in self.message.splitlines() if line and "warning:" not in line]
        return self.summary.get("reason") or (lines[-1].removeprefix("openclose: ") if lines else "")

    def table(self, file: str) -> list[dict[str, str]]:
        path = self.folder / file
        return read_rows(path) if path.exists() else []

    def not_a_number(self) -> str:
        """The first place where a table or the summary has a number that is none; empty if there is no such place."""
        for path in sorted(self.folder.glob("*.csv")):
            with open(path, newline="", encoding="utf-8") as stream:
                for line, row in enumerate(csv.reader(stream), 1):
                    if any(_is_no_number(cell) for cell in row):
                        return f"{path.name}, line {line}"
        return "summary.json" if _holds_no_number(self.summary) else ""


def _is_no_number(cell: str) -> bool:
    return cell.strip().lower().lstrip("+-") in ("nan", "inf", "infinity")


def _holds_no_number(value: object) -> bool:
    if isinstance(value, dict):
        return any(_holds_no_number(v) for v in value.values())
    if isinstance(value, list):
        return any(_holds_no_number(v) for v in value)
    return isinstance(value, float) and not math.isfinite(value)


class Programs:
    """The command and the reference, called with a limit of CPU time. A process calls one at a time, so that its children's time is that of the call."""

    def __init__(self, openclose: Path, reference: Path, limit_s: int):
        self.openclose, self.reference, self.limit_s = openclose, reference, limit_s

    def analyse(self, command: str, scene: Path, settings: dict[str, object], folder: Path) -> Outcome:
        shutil.rmtree(folder, ignore_errors=True)
        arguments = [str(self.openclose), command, str(scene), "--quiet", "-o", str(folder)]
        for key, value in settings.items():
            arguments += ["--set", f"{key}={value}"]
        return self._call(arguments, folder)

    def cut(self, scene: Path, blocks: Path) -> Outcome:
        return self._call([str(self.openclose), "cut", str(scene), "--quiet", "-o", str(blocks), "--svg", str(blocks.with_suffix(".svg"))], blocks.parent)

    def limit_analysis(self, blocks: Path) -> dict[str, float] | None:
        """Largest feasible and smallest infeasible factor, both 0 without equilibrium at any factor and infinite where all stand; none without an answer."""
        done = run_process([str(self.reference), "limit-analysis", str(blocks)], self.limit_s)
        if done.returncode != DONE:
            answer = next((factor for words, factor in LIMITS_WITHOUT_A_FACTOR.items() if words in done.stderr), None)
            return None if answer is None else {"factor": answer, "failed": answer}
        values = {row["quantity"]: float(row["value"]) for row in csv.DictReader(done.stdout.splitlines())}
        return {"factor": values["factor_of_safety"], "failed": values["smallest_failed_factor"]}

    def _call(self, arguments: list[str], folder: Path) -> Outcome:
        before = _cpu_of_children()
        done = run_process(arguments, self.limit_s)
        return Outcome(folder, None if was_stopped(done) else done.returncode, done.stderr.strip(), _cpu_of_children() - before)


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
