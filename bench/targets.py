"""What was asked of the program, each beside what this run measured. A ratio counts only between runs whose errors are small enough."""

from dataclasses import dataclass

import failure
import peers
import scaling
import statics
import walls_and_piles
from measure import Bench, Row
from winner import LARGEST_ERROR, fastest, may_win

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


def _is_dem(row: Row) -> bool:
    return row.method.split(",")[0] == "dem"


def _at_least(what: str, ratio: float | None, asked: float, note: str = "") -> Target:
    return Target(what, f">= {asked:g} x", "-" if ratio is None else f"{ratio:.3g} x{note}", None if ratio is None else ratio >= asked)


def _at_most(what: str, value: float | None, asked: float, unit: str = "", note: str = "") -> Target:
    return Target(what, f"<= {asked:g}{unit}", "-" if value is None else f"{value:.3g}{unit}{note}", None if value is None else value <= asked)


def _note(implicit: Row, explicit: Row) -> str:
    return (f" ({implicit.method} {1e3 * implicit.cpu_s:.3g} ms, error {implicit.error:.1g}; "
            f"{explicit.method} {1e3 * explicit.cpu_s:.3g} ms, {explicit.error:.1g})")


def _against_dem(bench: Bench, study: str, scene: str, what: str, asked: float) -> Target:
    """The fastest implicit run that may win over the fastest explicit one that may."""
    rows = bench.of(study, scene)
    implicit, explicit = fastest([r for r in rows if not _is_dem(r)]), fastest([r for r in rows if _is_dem(r)])
    if implicit is None:
        return _at_least(what, None, asked)
    if explicit is None:
        failed = next((r for r in rows if _is_dem(r) and r.cpu_s and r.error is not None), None)
        if failed is None:
            return _at_least(what, None, asked)
        return _at_least(what, failed.cpu_s / implicit.cpu_s, asked, f"; dem's error {failed.error:.2g} is no match")
    return _at_least(what, explicit.cpu_s / implicit.cpu_s, asked, _note(implicit, explicit))


def _failure(bench: Bench, scene: str, what: str, floor: float) -> list[Target]:
    """Fastest run of dem over the fastest implicit one, of those that may win; then with no larger error than this run of dem has. Errors below
    `floor`, what the reference is sure of, are equal."""
    rows = bench.of(failure.STUDY, scene)
    explicit = fastest([r for r in rows if _is_dem(r)])
    implicit_rows = [r for r in rows if not _is_dem(r)]
    found = []
    for error, of_whom in ((LARGEST_ERROR, f"{100 * LARGEST_ERROR:g} %"), (max(explicit.error, floor) if explicit else 0.0, "that of dem")):
        at_error = f"{what}, error at most {of_whom}: dem over implicit"
        implicit = fastest(implicit_rows, error)
        if explicit is None:
            found.append(_at_least(at_error, None, 1.0))
        elif implicit is None:
            found.append(Target(at_error, ">= 1 x", f"no implicit run has this error, {error:.1g}", False))
        else:
            found.append(_at_least(at_error, explicit.cpu_s / implicit.cpu_s, 1.0, _note(implicit, explicit)))
    return found


def _failures(bench: Bench, findings: failure.Findings | None) -> list[Target]:
    floor = findings.converged if findings else 0.0
    found = _failure(bench, failure.SCENE, "40 m after failure, 482 blocks", floor)
    found += _failure(bench, failure.RESTING_SCENE, "the same with blocks at rest left alone", floor)
    large_floors = findings.large_converged if findings else {}
    for n in failure.LARGE["long"]:
        found += _failure(bench, failure.large_scene(n), f"the same, {n:,} blocks", large_floors.get(n, 0.0))
    return found


def _hard(bench: Bench) -> list[Target]:
    """By settling, strength reduction and motion of the same slope."""
    reductions = {r.method: r for r in bench.of(statics.REDUCTION, "3.4") if may_win(r)}
    found = []
    if "hard" in reductions and "soft" in reductions:
        found.append(_at_most("strength reduction of 3.4: hard over soft in time", reductions["hard"].cpu_s / reductions["soft"].cpu_s, 1.2, " x"))
    for study in (scaling.SETTLING, scaling.MOTION):
        rows = {r.method: r for r in bench.of(study, "3.4 of 500") if not r.reason}
        if "hard" in rows and "soft" in rows:
            found.append(_at_most(f"{study}, 500 blocks: hard over soft in time", rows["hard"].cpu_s / rows["soft"].cpu_s, 1.2, " x"))
    small = [r for scene in (failure.SCENE, failure.RESTING_SCENE) for r in bench.of(failure.STUDY, scene)]
    for rows, blocks in ((small, "482 blocks"), (bench.of(scaling.MOTION), "20 steps, all sizes")):
        deepest = [r.max_penetration_m for r in rows if r.method == "hard" and not r.reason]
        found.append(_at_most(f"hard: deepest penetration, 3.4 in failure, {blocks}", max(deepest, default=None), LARGEST_PENETRATION_M, " m"))
    return found


def _sizes(bench: Bench) -> list[Target]:
    fits = {(f.method, f.what): f.value for f in scaling.fits(bench)}
    settled = [r for r in bench.of(scaling.SETTLING) if r.method == "soft"]
    largest = next((r for r in settled if r.scene == "3.4 of 100000"), None)
    found = [_at_most(f"soft: exponent of {what}, 500 to 50,000 blocks", fits.get(("soft", what)), 1.2)
             for what in ("an iteration of motion", "an iteration of settling", "a step of relaxation")]
    if largest is None:
        found.append(Target("100,000 blocks settle", "yes", "-", None))
    else:
        found.append(Target("100,000 blocks settle", "yes", largest.reason or f"{largest.blocks:,} in {largest.cpu_s:.3g} s", not largest.reason))
    return [*found, _memory(bench, "soft", "memory in all: soft", 12.0),
            _memory(bench, "soft", "memory without the factor: soft", 2.0, scaling.memory_without_factor),
            _memory(bench, "dem", "memory without the factor: dem, which has none", 2.0)]


def _memory(bench: Bench, method: str, what: str, asked_kb: float, bytes_of=lambda _, row: row.peak_memory_bytes) -> Target:
    """While the largest slope that it settles settles, program and input included."""
    rows = [r for r in bench.of(scaling.SETTLING) if r.method == method and not r.reason]
    if not rows:
        return _at_most(what, None, asked_kb, " kB a block")
    row = max(rows, key=lambda r: r.blocks)
    found = bytes_of(bench, row)
    return _at_most(what, None if found is None else found / row.blocks / 1e3, asked_kb, " kB a block", f" ({row.blocks:,} blocks)")


def _walls_and_piles(bench: Bench) -> list[Target]:
    def milliseconds(value: float | None) -> float | None:
        return None if value is None else 1e3 * value

    rest, cold, pile = walls_and_piles.REST, walls_and_piles.COLD, walls_and_piles.PILE
    found = []
    for method in ("soft", "hard"):
        found.append(_at_most(f"{rest}: a step of {method}", milliseconds(walls_and_piles.per_step(bench, rest, method)), 3.0, " ms"))
        found.append(_at_most(f"{cold}: a step of {method}", milliseconds(walls_and_piles.per_step(bench, cold, f"{method}, automatic")), 60.0, " ms"))
    for scene in walls_and_piles.scenes(bench):
        if scene == rest:
            continue
        for method in ("soft", "hard"):
            found.append(_at_most(f"{scene}, {method}: the solver that is chosen over the best", walls_and_piles.over_the_best(bench, scene, method), 1.1, " x"))
    soft, hard = (walls_and_piles.cost(bench, pile, f"{m}, automatic") for m in ("soft", "hard"))
    found.append(_at_most(f"{pile}: hard over soft in time", hard / soft if hard and soft else None, 2.0, " x"))
    return found


def _iteration(method: str, times: float | None) -> Target:
    """How many of them a step of Box2D takes."""
    what = f"a Newton iteration of {method} (residual, assembly, factor, solve) over a step of Box2D"
    return Target(what, "<= 1/18", "- (make bench-peers)", None) if times is None else Target(what, "<= 1/18", f"1/{times:.3g}", times >= 18)


def _peers(findings: peers.Findings | None) -> list[Target]:
    second = f"a simulated second: Box2D over ours, with ours right in the critical friction angle to {100 * LARGEST_ERROR:g} %"
    if findings is None:
        return [_iteration(method, None) for method in ("soft", "hard")] + [Target(second, ">= 5 x", "- (make bench-peers)", None)]
    box2d = next(c for c in findings.compared if c.name.startswith("Box2D"))
    ours = [c for c in findings.compared if not c.name.startswith(("Box2D", "Chipmunk"))]
    best = fastest([c.row for c in ours])
    found = []
    for method in ("soft", "hard"):
        iteration = min((c.iteration for c in ours if c.iteration and c.name.startswith(method)), default=None)
        found.append(_iteration(method, box2d.step / iteration if iteration else None))
    if best is None:
        return [*found, Target(second, ">= 5 x", "none of ours has the critical angle", False)]
    return [*found, _at_least(second, box2d.row.cpu_s / best.cpu_s, 5.0, f" ({best.method}, its error {best.error:.1g}, that of Box2D "
                              f"{'unknown' if box2d.row.error is None else f'{box2d.row.error:.1g}'})")]


def measured(bench: Bench, found: dict) -> list[Target]:
    return [
        _against_dem(bench, statics.EQUILIBRIUM, "3.3", "3.3, static equilibrium from nothing: dem over implicit", 20),
        _against_dem(bench, statics.EQUILIBRIUM, "3.4", "3.4, static equilibrium from nothing: dem over implicit", 20),
        _against_dem(bench, statics.REDUCTION, "3.4", "3.4, strength reduction to 0.005: dem over implicit", 20),
        *_failures(bench, found.get("failure")),
        *_hard(bench),
        *_sizes(bench),
        *_walls_and_piles(bench),
        *_peers(found.get("peers")),
    ]
