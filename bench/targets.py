"""What was asked of the program, each beside what this run measured. A ratio counts only between runs whose errors are small enough."""

from dataclasses import dataclass

import scaling
import statics
from measure import Bench, Row
from winner import fastest

LARGEST_PENETRATION_M = 1e-6


@dataclass(frozen=True)
class Target:
    what: str
    asked: str
    measured: str
    kept: bool | None  # none: not measured in this run

    @property
    def verdict(self) -> str:
        return "not measured" if self.kept is None else "yes" if self.kept else "**no**"


def _of(rows: list[Row], method: str) -> Row | None:
    return fastest([row for row in rows if row.method == method])


def _at_least(what: str, ratio: float | None, asked: float, note: str = "") -> Target:
    return Target(what, f">= {asked:g} x", "-" if ratio is None else f"{ratio:.3g} x{note}", None if ratio is None else ratio >= asked)


def _at_most(what: str, value: float | None, asked: float, unit: str = "", note: str = "") -> Target:
    return Target(what, f"<= {asked:g}{unit}", "-" if value is None else f"{value:.3g}{unit}{note}", None if value is None else value <= asked)


def _against_dem(bench: Bench, study: str, scene: str, what: str, asked: float) -> Target:
    """The fastest implicit run that may win over the fastest explicit one that may."""
    rows = bench.of(study, scene)
    implicit, explicit = fastest([r for r in rows if r.method != "dem"]), _of(rows, "dem")
    if implicit is None:
        return _at_least(what, None, asked)
    if explicit is None:
        failed = next((r for r in rows if r.method == "dem" and r.cpu_s and r.error is not None), None)
        target = _at_least(what, failed.cpu_s / implicit.cpu_s if failed else None, asked, f"; dem's error {failed.error:.2g} is no match" if failed else "")
        return target
    return _at_least(what, explicit.cpu_s / implicit.cpu_s, asked,
                     f" ({implicit.method} {1e3 * implicit.cpu_s:.3g} ms, error {implicit.error:.1g}; dem {1e3 * explicit.cpu_s:.3g} ms, {explicit.error:.1g})")


def _failure(bench: Bench) -> Target:
    return _against_dem(bench, "failure", "3.4 in failure", "40 m after failure, 482 blocks: dem over implicit", 1.0)


def _hard(bench: Bench) -> list[Target]:
    """By settling and motion of the same slope."""
    found = []
    for study in (scaling.SETTLING, scaling.MOTION):
        rows = {r.method: r for r in bench.of(study, "3.4 of 500") if not r.reason}
        if "hard" in rows and "soft" in rows:
            found.append(_at_most(f"{study}, 500 blocks: hard over soft in time", rows["hard"].cpu_s / rows["soft"].cpu_s, 1.2, " x"))
    deepest = [r.max_penetration_m for r in bench.of(scaling.MOTION) if r.method == "hard" and not r.reason]
    found.append(_at_most("hard: deepest penetration, 3.4 in failure", max(deepest, default=None), LARGEST_PENETRATION_M, " m"))
    return found


def _sizes(bench: Bench) -> list[Target]:
    fits = {(f.method, f.what): f.value for f in scaling.fits(bench)}
    settled = [r for r in bench.of(scaling.SETTLING) if r.method == "soft"]
    largest = next((r for r in settled if r.scene == "3.4 of 100000"), None)
    memory = max((r.peak_memory_bytes / r.blocks for r in settled if not r.reason and r.blocks >= 1000), default=None)
    found = [_at_most("soft: exponent of a step of motion, 500 to 50,000 blocks", fits.get(("soft", "a step of motion")), 1.2),
             _at_most("soft: exponent of settling, 500 to 50,000 blocks", fits.get(("soft", "settling")), 1.2)]
    if largest is None:
        found.append(Target("100,000 blocks settle", "yes", "-", None))
    else:
        found.append(Target("100,000 blocks settle", "yes", largest.reason or f"{largest.blocks:,} in {largest.cpu_s:.3g} s", not largest.reason))
    found.append(_at_most("soft: memory in all, most of the sizes from 1,000 blocks", None if memory is None else memory / 1e3, 12, " kB a block"))
    return found


def measured(bench: Bench, found: dict) -> list[Target]:
    return [
        _against_dem(bench, statics.EQUILIBRIUM, "3.3", "3.3, static equilibrium from nothing: dem over implicit", 20),
        _against_dem(bench, statics.EQUILIBRIUM, "3.4", "3.4, static equilibrium from nothing: dem over implicit", 20),
        _against_dem(bench, statics.REDUCTION, "3.4", "3.4, strength reduction to 0.005: dem over implicit", 20),
        _failure(bench),
        *_hard(bench),
        *_sizes(bench),
    ]
