"""What the scripts of verification/, mutants/, paper/, stress/, bench/ and tests/last_outputs/ share. Each of these folders has a link to it, so that its scripts find it."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]  # of the source tree
PAPER_SCENES = ROOT / "paper/scenes"
