"""Tables that the programs and the scripts write as CSV."""

import csv
from pathlib import Path


def read_rows(file: Path) -> list[dict[str, str]]:
    with open(file, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))
