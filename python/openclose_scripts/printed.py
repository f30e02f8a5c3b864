"""The numbers that the paper prints, from paper/printed.toml."""

import tomllib

from openclose_scripts import ROOT


def read_printed() -> dict[str, dict[str, dict]]:
    """By example and quantity: value and place in the paper."""
    return tomllib.loads((ROOT / "paper/printed.toml").read_text(encoding="utf-8"))
