"""Calls the two commands, `openclose` and `openclose-reference`, and reads what they write."""

import csv
import io
import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from openclose_scripts.csv_rows import read_rows
from openclose_scripts.processes import DONE, NOT_CONVERGED, RunFailed, call, run_process, was_stopped

PARALLEL_PROCESSES = 2


@dataclass(frozen=True)
class Case:
    """One call of `openclose`: `command` is run, fos, cut or check, `settings` are --set KEY=VALUE pairs, `name` is that of its folder.

    A case with a `cpu_limit_s` may fail: by not converging, or by being stopped there. Its summary holds the reason.
    """

    name: str
    command: str
    scene: Path
    settings: tuple[tuple[str, object], ...] = ()
    cpu_limit_s: int | None = None


class Openclose:
    """Runs cases of `openclose`, each into a folder of its own below `folder`."""

    def __init__(self, executable: Path, folder: Path):
        self._executable = executable
        self._folder = folder

    def folder_of(self, case: Case) -> Path:
        return self._folder / case.name

    def run(self, case: Case) -> None:
        """Runs one case, over what an earlier run of it has left."""
        output = self.blocks_file(case) if case.command == "cut" else self.folder_of(case)
        options = ["--spectrum", str(output / "spectrum.csv")] if case.command == "check" else ["--quiet", "-o", str(output)]
        arguments = [str(self._executable), case.command, str(case.scene), *options]
        for key, value in case.settings:
            arguments += ["--set", f"{key}={value}"]
        if case.command == "cut":
            output.parent.mkdir(parents=True, exist_ok=True)
        if case.cpu_limit_s is None:
            call(arguments)
        else:
            self._run_limited(case, arguments)

    def run_all(self, cases: list[Case]) -> None:
        """Runs all cases, two at a time; raises RunFailed for the first that fails."""
        with ThreadPoolExecutor(PARALLEL_PROCESSES) as pool:
            jobs = [pool.submit(self.run, case) for case in cases]
            try:
                for job in jobs:
                    job.result()
            except RunFailed:
                pool.shutdown(cancel_futures=True)
                raise

    def table(self, case: Case, file: str) -> list[dict[str, str]]:
        """Rows of a CSV file that the case has written; none if it was stopped before."""
        if case.cpu_limit_s is not None and self.summary(case).get("stopped"):
            return []
        return read_rows(self.folder_of(case) / file)

    def summary(self, case: Case) -> dict:
        return json.loads((self.folder_of(case) / "summary.json").read_text(encoding="utf-8"))

    def blocks_file(self, case: Case) -> Path:
        """What a case of `cut` has written."""
        return self.folder_of(case) / "blocks.toml"

    def _run_limited(self, case: Case, arguments: list[str]) -> None:
        folder = self.folder_of(case)
        shutil.rmtree(folder, ignore_errors=True)
        done = run_process(arguments, case.cpu_limit_s)
        if was_stopped(done):
            stopped = {"converged": False, "stopped": True, "reason": f"stopped after {case.cpu_limit_s} s of CPU time"}
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "summary.json").write_text(json.dumps(stopped), encoding="utf-8")
        elif done.returncode not in (DONE, NOT_CONVERGED):
            raise RunFailed(f"exit status {done.returncode} from: {' '.join(arguments)}\n{done.stderr.strip()}")


class OpencloseOnDemand(Openclose):
    """Runs a case when its results are asked for the first time, so that one figure needs no more than it shows."""

    def __init__(self, executable: Path, folder: Path):
        super().__init__(executable, folder)
        self._asked: set[Case] = set()

    def table(self, case: Case, file: str) -> list[dict[str, str]]:
        self._run_once(case)
        return super().table(case, file)

    def summary(self, case: Case) -> dict:
        self._run_once(case)
        return super().summary(case)

    def blocks_file(self, case: Case) -> Path:
        self._run_once(case)
        return super().blocks_file(case)

    def _run_once(self, case: Case) -> None:
        if case in self._asked:
            return
        self._asked.add(case)
        print(f"  {case.command} {case.name}", flush=True)
        self.run(case)


class Reference:
    """The closed forms and the reference ODE of `openclose-reference`."""

    def __init__(self, executable: Path):
        self._executable = executable

    def table(self, command: str, options: dict[str, object], flags: tuple[str, ...] = ()) -> list[dict[str, str]]:
        """Rows of the CSV that a subcommand prints."""
        arguments = [str(self._executable), command, *flags]
        for key, value in options.items():
            arguments += [f"--{key}", str(value)]
        return list(csv.DictReader(io.StringIO(call(arguments))))


def outlines(rows: list[dict[str, str]], state: str) -> dict[str, list[tuple[float, float]]]:
    """Vertices [m] of every block in one state, from the rows of blocks.csv."""
    blocks: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        if row["state"] == state:
            blocks.setdefault(row["block"], []).append((float(row["x_m"]), float(row["y_m"])))
    return blocks
