"""The numbers that the paper prints, from printed.toml."""

import tomllib
from pathlib import Path


def read_printed() -> dict[str, dict[str, dict]]:
    """By example and quantity: value and place in the paper."""
    return tomllib.loads((Path(__file__).parent / "printed.toml").read_text(encoding="utf-8"))
