"""The micro-benchmarks of openclose-bench (Google Benchmark): what it says, as a table."""

import json
from dataclasses import dataclass
from pathlib import Path

from openclose_scripts.processes import call

SHORT_S, QUICK_S = 0.3, 0.05  # of each measurement
REPEATS, QUICK_REPEATS = 5, 3
QUICK_FILTER = "/(482|2000)$"  # blocks


@dataclass(frozen=True)
class Timed:
    name: str
    blocks: int
    contacts: int
    cpu: float        # [s] median
    variation: float  # [-] standard deviation over the mean of the repeats
    iterations: int | None  # of Newton's method, in a step


def run(program: Path, quick: bool, file: Path) -> list[Timed]:
    """Repeats of all measurements are mixed by the library."""
    file.write_text(call([str(program), "--benchmark_format=json", f"--benchmark_min_time={QUICK_S if quick else SHORT_S}",
                          f"--benchmark_repetitions={QUICK_REPEATS if quick else REPEATS}", "--benchmark_enable_random_interleaving=true",
                          "--benchmark_report_aggregates_only=true", *((f"--benchmark_filter={QUICK_FILTER}",) if quick else ())]), encoding="utf-8")
    answer = json.loads(file.read_text(encoding="utf-8"))["benchmarks"]
    unit = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    variation = {b["run_name"]: b["cpu_time"] for b in answer if b["aggregate_name"] == "cv"}
    return [Timed(b["run_name"].split("/")[0], int(b["blocks"]), int(b["contacts"]), b["cpu_time"] * unit[b["time_unit"]], variation[b["run_name"]],
                  int(b["newton_iterations"]) if "newton_iterations" in b else None)
            for b in answer if b["aggregate_name"] == "median"]
