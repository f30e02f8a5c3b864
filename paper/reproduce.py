"""Reproduces the paper: runs everything, draws Figs 1-10, writes the comparison and the report.

Exit status: 0 done, 1 a run failed, 2 wrong options or no matplotlib.
"""

import argparse
import sys
import time
from pathlib import Path

import claims
import comparison
import comparison_slopes
import tables
from openclose_scripts.csv_rows import read_rows
from openclose_scripts.examples.incline import Incline
from openclose_scripts.examples.plane_failure import PlaneFailure
from openclose_scripts.examples.slopes import JointedSlope, PlanarSlope
from openclose_scripts.printed import read_printed
from openclose_scripts.processes import RunFailed
from openclose_scripts.runs import Openclose, OpencloseOnDemand, Reference

EXIT_RUN_FAILED = 1
EXIT_CANNOT_START = 2


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--openclose", type=Path, default=Path("build/release/openclose"), help="the solver (default: %(default)s)")
    parser.add_argument("--reference", type=Path, default=Path("build/release/analytical/openclose-reference"),
                        help="closed forms and reference ODE (default: %(default)s)")
    parser.add_argument("--results", type=Path, default=Path("results/paper"), help="folder to write (default: %(default)s)")
    parser.add_argument("--figure", type=int, choices=range(1, 11), help="run only what this figure shows, and draw it")
    parser.add_argument("--print-only", action="store_true", help="print the comparison of an earlier run, run nothing")
    return parser.parse_args()


def print_comparison(results: Path) -> None:
    print(tables.comparison_text(read_rows(results / "comparison.csv")))
    print(f"\n{tables.NOTE}")
    print(f"Figures, tables and text: {results / 'report.md'}; all digits: {results / 'comparison.csv'}")


def reproduce(arguments: argparse.Namespace) -> None:
    """The comparison is written last: where it is, everything is."""
    import figures
    import figures_claims
    import report
    import report_claims
    import report_slopes

    results = arguments.results
    results.mkdir(parents=True, exist_ok=True)
    (results / "comparison.csv").unlink(missing_ok=True)
    openclose, reference = Openclose(arguments.openclose, results / "runs"), Reference(arguments.reference)
    printed = read_printed()
    slider, wedge = Incline(openclose, reference), PlaneFailure(openclose, reference)
    planar, jointed = PlanarSlope(openclose, reference), JointedSlope(openclose, reference, printed)
    claimed = claims.Claims(openclose, slider)
    cases = [*jointed.cases(), *planar.cases(), *claimed.cases(), *slider.cases(), *wedge.cases()]
    print(f"{len(cases)} runs of the examples and the claims ...", flush=True)
    openclose.run_all(cases)
    figures.draw_all(figures.Examples(slider, wedge, planar, jointed, printed), results)
    figures_claims.draw(claimed, printed["claims"], results)
    rows = [*comparison.build(slider, wedge, printed), *comparison_slopes.build(planar, jointed, printed), *report_claims.rows(claimed, printed["claims"])]
    more = {**report_slopes.fields(planar, jointed, rows, printed), "claims": report_claims.text(claimed, printed["claims"])}
    report.write(slider, wedge, rows, printed, more, results)
    comparison.write_csv(rows, results / "comparison.csv")


def reproduce_figure(arguments: argparse.Namespace) -> None:
    """What an earlier run of everything has left stays valid: the runs are the same."""
    import figures

    arguments.results.mkdir(parents=True, exist_ok=True)
    openclose, reference = OpencloseOnDemand(arguments.openclose, arguments.results / "runs"), Reference(arguments.reference)
    print(f"figure {arguments.figure}: about {figures.FIGURES[arguments.figure].seconds} s", flush=True)
    start, printed = time.monotonic(), read_printed()
    examples = figures.Examples(Incline(openclose, reference), PlaneFailure(openclose, reference), PlanarSlope(openclose, reference),
                                JointedSlope(openclose, reference, printed), printed)
    file = figures.draw(arguments.figure, examples, arguments.results)
    print(f"{file} after {time.monotonic() - start:.0f} s")


def main() -> int:
    arguments = parse_arguments()
    try:
        if arguments.figure:
            reproduce_figure(arguments)
            return 0
        if not arguments.print_only:
            reproduce(arguments)
        print_comparison(arguments.results)
    except RunFailed as failure:
        print(f"reproduce: {failure}", file=sys.stderr)
        return EXIT_RUN_FAILED
    except ModuleNotFoundError as missing:
        print(f"reproduce: {sys.executable} has no module {missing.name} (Debian: python3-{missing.name})", file=sys.stderr)
        return EXIT_CANNOT_START
    except OSError as error:
        print(f"reproduce: {error}", file=sys.stderr)
        return EXIT_CANNOT_START
    return 0


if __name__ == "__main__":
    sys.exit(main())
