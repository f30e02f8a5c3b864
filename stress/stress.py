"""A campaign of random scenes, each with a verdict by rules that know nothing of the method. Writes stress.csv, stress.md and the folder stress/.

    stress/stress.py --seed 1 --count 100 --part tumbles --methods soft dem
    stress/stress.py --keep 17 --part tumbles             only writes the scene of that seed, to debug

Exit status: 0 no false answer, 1 at least one, 2 wrong options or a program that is missing.
"""

import argparse
import os
import sys
from collections import Counter
from pathlib import Path

import campaign
import page
from outcome import METHODS, Programs
from verdicts import FALSE, REFUSED, SLOW

EXIT_FALSE, EXIT_CANNOT_START = 1, 2
ALL = "all"


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1, help="the first one (default: %(default)s)")
    parser.add_argument("--count", type=int, default=20, help="scenes of each part (default: %(default)s)")
    parser.add_argument("--part", choices=(*campaign.PARTS, ALL), default=ALL)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS), metavar="METHOD", help=f"of {', '.join(METHODS)} (default: all)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default: %(default)s)")
    parser.add_argument("--limit-s", type=int, default=60, help="CPU time of a run, beyond which it is slow (default: %(default)s)")
    parser.add_argument("--invariances", action="store_true", help="slopes also with other stiffness, mirrored, far away, small and large")
    parser.add_argument("--regression", action="store_true", help="the seeds that stay, without pictures")
    parser.add_argument("--keep", type=int, metavar="SEED", help="write the scene of this seed and stop")
    parser.add_argument("--openclose", type=Path, default=Path("build/release/openclose"))
    parser.add_argument("--reference", type=Path, default=Path("build/release/analytical/openclose-reference"))
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write (default: %(default)s)")
    return parser.parse_args()


def parts(arguments: argparse.Namespace) -> list[str]:
    return list(campaign.PARTS) if arguments.part == ALL else [arguments.part]


def seeds(arguments: argparse.Namespace, part: str) -> range:
    return campaign.REGRESSION[part] if arguments.regression else range(arguments.seed, arguments.seed + arguments.count)


def report(rows: list[campaign.Row]) -> None:
    counts = Counter((row.part, row.method, row.verdict) for row in rows)
    for (part, method, verdict), number in sorted(counts.items()):
        print(f"{part:8} {method:13} {verdict:8} {number}")


def draw_worst(one: campaign.Campaign, rows: list[campaign.Row], results: Path) -> list[tuple[campaign.Row, str]]:
    """Rows and their pictures; none without matplotlib."""
    drawn = []
    for row in page.worst([row for row in rows if row.method in METHODS]):
        file = results / "stress" / f"{row.part}-{row.seed}-{row.method}.png"
        try:
            if one.draw_again(row, file):
                drawn.append((row, str(file.relative_to(results))))
        except ModuleNotFoundError:
            print("stress: no matplotlib, so stress.md has no pictures", file=sys.stderr)
            break
    return drawn


def main() -> int:
    arguments = parse_arguments()
    if arguments.regression:
        arguments.limit_s = campaign.REGRESSION_LIMIT_S
    for program in (arguments.openclose,) if arguments.keep is not None else (arguments.openclose, arguments.reference):
        if not program.exists():
            print(f"stress: no {program}; make build makes it", file=sys.stderr)
            return EXIT_CANNOT_START
    one = campaign.Campaign(Programs(arguments.openclose, arguments.reference, arguments.limit_s), arguments.results / "stress", tuple(arguments.methods),
                            arguments.invariances)
    if arguments.keep is not None:
        for part in parts(arguments):
            print(one.written(part, arguments.keep))
        return 0
    rows = campaign.run(one, [(part, seed) for part in parts(arguments) for seed in seeds(arguments, part)], arguments.jobs,
                        (FALSE,) if arguments.regression else (FALSE, REFUSED, SLOW))
    arguments.results.mkdir(parents=True, exist_ok=True)
    campaign.write_csv(rows, arguments.results / "stress.csv")
    page.write(rows, [] if arguments.regression else draw_worst(one, rows, arguments.results), " ".join(["stress/stress.py", *sys.argv[1:]]), arguments.results / "stress.md")
    if arguments.regression:
        print("random scenes:", ", ".join(f"{sum(row.verdict == verdict for row in rows)} {verdict}" for verdict in page.VERDICTS))
    else:
        report(rows)
    return EXIT_FALSE if any(row.verdict == FALSE for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
