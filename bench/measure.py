"""Runs trials several times in turn and keeps what each cost: the rows of bench.csv. CPU time of one thread, medians."""

import csv
import statistics
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path

from openclose_scripts.processes import RunFailed
from openclose_scripts.runs import Case, Openclose

MODES = ("quick", "full", "long")
CPU_LIMIT_S = 120
# Repeats by what the first run took: the spread of long runs is small, and the whole is to end.
REPEATS = ((1.0, 5), (5.0, 3), (float("inf"), 1))
QUICK_REPEATS = 3


@dataclass(frozen=True)
class Trial:
    """One line of a comparison. `cost` is the part of the CPU time that is asked for: start, motion or search; `error` reads the finished run."""

    study: str
    scene: str
    method: str
    case: Case
    cost: str
    error_of: str
    error: Callable[[Case], float | None]
    dt: float | None = None
    starts: tuple[Case, ...] = ()  # instead of repeats of the case: the same from slightly different starts, the case itself first
    steps_before: int = 0       # of settling, which are not part of the cost
    iterations_before: float = 0


@dataclass
class Row:
    """In the order of the columns of bench.csv; what is not known is empty."""

    scene: str
    method: str
    blocks: int | None
    contacts: int | None
    dt_s: float | None
    steps: int | None
    iterations: float | None  # of Newton's method, those of parts by the part of the rows that they have; steps of relaxation are none
    cpu_s: float | None
    error: float | None
    max_penetration_m: float | None
    peak_memory_bytes: int | None
    repeats: int
    cpu_min_s: float | None
    cpu_max_s: float | None
    study: str
    error_of: str
    reason: str


def closed_contacts(openclose: Openclose, case: Case) -> int:
    """In the last state that was written."""
    rows = openclose.table(case, "contacts.csv")
    return sum(row["state"] == rows[-1]["state"] and row["status"] != "open" for row in rows)


class Bench:
    """Keeps the rows of all studies and how often to repeat."""

    def __init__(self, openclose: Openclose, mode: str):
        self.openclose = openclose
        self.mode = mode  # one of MODES
        self.rows: list[Row] = []
        self._summaries: dict[str, list[dict]] = {}

    @property
    def quick(self) -> bool:
        return self.mode == "quick"

    def measure(self, trials: list[Trial]) -> list[Row]:
        """Round after round through all trials, so that what slows the machine down for a while slows them all down."""
        if not trials:
            return []
        print(f"  {trials[0].study}: {len(trials)} runs, repeated", flush=True)
        runs: dict[str, list[dict]] = {trial.case.name: [] for trial in trials}
        for turn in range(max(count for _, count in REPEATS)):
            for trial in trials:
                done = runs[trial.case.name]
                if turn and len(done) >= self._repeats(trial, done[0]):
                    continue
                done.append(self.run(trial.starts[turn] if trial.starts else trial.case))
                if sys.stderr.isatty():
                    print(f"\r  round {turn + 1}: {trial.method:40}", end="", file=sys.stderr)
        errors = {t.case.name: t.error(t.case) for t in trials if not any(_reason(run) for run in runs[t.case.name])}
        rows = [self._row(trial, runs[trial.case.name], errors.get(trial.case.name)) for trial in trials]
        self._summaries |= runs
        self.rows += rows
        return rows

    def run(self, case: Case) -> dict:
        """The summary; of a run that the program refused, its message for a reason."""
        try:
            self.openclose.run(case)
        except RunFailed as failure:
            return {"converged": False, "reason": f"refused: {str(failure).splitlines()[-1].removeprefix('openclose: ')}"}
        return self.openclose.summary(case)

    def summaries(self, case: Case) -> list[dict]:
        """Of every repeat."""
        return self._summaries[case.name]

    def leave_out(self, study: str, scene: str, method: str, reason: str) -> None:
        """A method that has no place in a comparison stays there with the reason."""
        self.rows.append(Row(scene, method, *[None] * 9, 0, None, None, study, "", reason))

    def of(self, study: str, scene: str | None = None) -> list[Row]:
        return [row for row in self.rows if row.study == study and scene in (None, row.scene)]

    def _repeats(self, trial: Trial, first: dict) -> int:
        """A run that failed is not tried again."""
        cpu = self._cpu(trial, first)
        if cpu is None:
            return 1
        if trial.starts:
            return len(trial.starts)
        count = next(count for limit, count in REPEATS if cpu <= limit)
        return min(count, QUICK_REPEATS) if self.quick else count

    @staticmethod
    def _cpu(trial: Trial, summary: dict) -> float | None:
        return None if _reason(summary) else summary["cpu_s"][trial.cost]

    def _row(self, trial: Trial, runs: list[dict], error: float | None) -> Row:
        first = runs[0]
        reason = next((found for run in runs if (found := _reason(run))), "")
        counters = first.get("counters", {})
        cpu = [] if reason else [run["cpu_s"][trial.cost] for run in runs]
        steps = counters.get("steps")
        dt = trial.dt
        if dt is None and steps and trial.cost == "motion":
            dt = first["time_s"] / (steps - trial.steps_before)
        if "explicit" in first:
            dt = first["explicit"]["longest_step_s"] if dt is None else min(dt, first["explicit"]["longest_step_s"])
        return Row(
            scene=trial.scene,
            method=trial.method,
            blocks=first.get("blocks"),
            contacts=closed_contacts(self.openclose, trial.case) if counters else None,
            dt_s=dt,
            steps=None if steps is None else steps - trial.steps_before,
            iterations=None if steps is None else _iterations(first) - trial.iterations_before,
            cpu_s=statistics.median(cpu) if cpu else None,
            error=error,
            max_penetration_m=first.get("max_penetration_m"),
            peak_memory_bytes=first.get("peak_memory_bytes"),
            repeats=len(cpu),
            cpu_min_s=min(cpu, default=None),
            cpu_max_s=max(cpu, default=None),
            study=trial.study,
            error_of=trial.error_of,
            reason=reason,
        )


def _iterations(summary: dict) -> float:
    counters = summary["counters"]
    return counters["iterations"] + counters["part_rows"] / summary["free_blocks"]


def _reason(summary: dict) -> str:
    return "" if summary.get("converged") else summary.get("reason") or "not converged"


def write_csv(rows: list[Row], file: Path) -> None:
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        names = [field.name for field in fields(Row)]
        writer.writerow(names)
        for row in rows:
            writer.writerow(["" if (value := getattr(row, name)) is None else value for name in names])
