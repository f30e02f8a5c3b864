"""Benchmarks: run time beside error, cost by size, what skips save, other programs. Writes bench.csv, bench_machine.json, bench/ and bench.md.

Exit status: 0 done, 1 a run failed, 2 wrong options or no matplotlib.
"""

import argparse
import sys
import time
from pathlib import Path

import failure
import machine
import micro
import motion
import peers
import scaling
import skips
import statics
import table_4
import walls_and_piles
from measure import MODES, Bench, write_csv
from openclose_scripts import ROOT
from openclose_scripts.printed import read_printed
from openclose_scripts.processes import RunFailed, run_process
from openclose_scripts.runs import Openclose, Reference

EXIT_RUN_FAILED = 1
EXIT_CANNOT_START = 2
STUDIES = ("motion", "statics", "failure", "scaling", "skips", "walls_and_piles", "table_4", "micro", "peers")


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--openclose", type=Path, default=Path("build/release/openclose"), help="the solver (default: %(default)s)")
    parser.add_argument("--reference", type=Path, default=Path("build/release/analytical/openclose-reference"),
                        help="closed forms and reference ODE (default: %(default)s)")
    parser.add_argument("--micro", type=Path, help="the micro-benchmarks, openclose-bench")
    parser.add_argument("--peers", type=Path, help="the program that runs other engines, openclose-peers")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write (default: %(default)s)")
    parser.add_argument("--mode", choices=MODES, default="full", help="quick: fewer sizes, steps and repeats; long: 10,000 blocks after failure, too")
    parser.add_argument("--only", nargs="+", choices=STUDIES, default=STUDIES, help="these studies alone (default: all)")
    return parser.parse_args()


def commit() -> str:
    return run_process(["git", "describe", "--always", "--dirty"], folder=ROOT).stdout.strip()


def run_studies(arguments: argparse.Namespace, bench: Bench, reference: Reference) -> dict:
    """What the studies found besides their rows."""
    found: dict = {}
    studies = {
        "motion": lambda: motion.run(bench, reference),
        "statics": lambda: statics.run(bench, reference),
        "failure": lambda: failure.run(bench),
        "scaling": lambda: scaling.run(bench),
        "skips": lambda: skips.run(bench),
        "walls_and_piles": lambda: walls_and_piles.run(bench),
        "table_4": lambda: table_4.run(bench),
    }
    if arguments.micro:
        studies["micro"] = lambda: micro.run(arguments.micro, bench.quick, arguments.results / "bench" / "micro.json")
    if arguments.peers:
        studies["peers"] = lambda: peers.run(bench, reference, arguments.peers)
    for name, study in studies.items():
        if name in arguments.only:
            begin = time.monotonic()
            print(f"{name} ...", flush=True)
            found[name] = study()
            write_csv(bench.rows, arguments.results / "bench" / "rows.csv")
            print(f"  {time.monotonic() - begin:.0f} s", flush=True)
    return found


def run(arguments: argparse.Namespace) -> None:
    """Table and page are written last: where they are, everything is. A run that is stopped leaves the rows of its studies in bench/rows.csv."""
    import figures_bench
    import page

    folder = arguments.results / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    openclose, reference = Openclose(arguments.openclose, folder / "runs"), Reference(arguments.reference)
    description = machine.describe(arguments.openclose, commit(), arguments.mode)
    bench = Bench(openclose, arguments.mode)
    found = run_studies(arguments, bench, reference)
    write_csv(bench.rows, arguments.results / "bench.csv")
    machine.write(description, arguments.results / "bench_machine.json")
    printed = read_printed()
    figures = figures_bench.draw(bench, found, printed, folder)
    page.write(bench, found, printed, description, figures, arguments.results / "bench.md")
    print(f"{len(bench.rows)} rows: {arguments.results / 'bench.csv'}; read {arguments.results / 'bench.md'}")


def main() -> int:
    arguments = parse_arguments()
    try:
        run(arguments)
    except RunFailed as failed:
        print(f"bench: {failed}", file=sys.stderr)
        return EXIT_RUN_FAILED
    except ModuleNotFoundError as missing:
        print(f"bench: {sys.executable} has no module {missing.name} (Debian: python3-{missing.name})", file=sys.stderr)
        return EXIT_CANNOT_START
    except OSError as error:
        print(f"bench: {error}", file=sys.stderr)
        return EXIT_CANNOT_START
    return 0


if __name__ == "__main__":
    sys.exit(main())
