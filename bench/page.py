"""results/bench.md: what was asked, what was measured, who wins at which error, and the figures."""

from pathlib import Path

import failure
import micro
import motion
import peers
import scaling
import skips
import statics
import table_4
import targets
import walls_and_piles
from measure import Bench, Row
from openclose_scripts.formats import significant
from openclose_scripts.markdown import markdown_table
from winner import ERRORS, LARGEST_ERROR, judge


def _table(head: list[str], lines: list[list[str]]) -> str:
    return markdown_table(head, lines) + "\n"


def _spread(row: Row) -> str:
    if row.repeats < 2 or not row.cpu_s:
        return f"{row.repeats} run"
    return f"-{100 * (1 - row.cpu_min_s / row.cpu_s):.0f} % +{100 * (row.cpu_max_s / row.cpu_s - 1):.0f} %"


def _winners(bench: Bench, study: str) -> str:
    """Who gets to an error in the least time; judge() lets nothing win beyond LARGEST_ERROR."""
    lines = []
    for scene in dict.fromkeys(row.scene for row in bench.of(study)):
        for error in ERRORS:
            verdict = judge(bench.of(study, scene), error)
            if verdict.winner is None:
                lines.append([scene, significant(error), "nobody", "", "", "", ""])
                continue
            w = verdict.winner
            others = ", ".join(f"{name} {significant(ratio)}{' (spreads overlap)' if name in verdict.tied else ''}" for name, ratio in
                               sorted(verdict.ratios.items(), key=lambda item: item[1]))
            lines.append([scene, significant(error), f"**{w.method}**", significant(w.dt_s), f"{significant(1e3 * w.cpu_s)} ({_spread(w)})",
                          significant(w.error), others])
    return _table(["scene", "error at most", "winner", "dt [s]", "CPU [ms]", "its error", "the others, over the winner"], lines)


def _integrators(bench: Bench) -> str:
    """The ways of `soft` among themselves: which gets to an error in the least time, scene by scene."""
    lines = []
    for study in (motion.STUDY, failure.STUDY):
        for scene in dict.fromkeys(row.scene for row in bench.of(study)):
            rows = [row for row in bench.of(study, scene) if row.method.startswith("soft")]
            winners = [judge(rows, error).winner for error in ERRORS]
            lines.append([scene, *(w.method.removeprefix("soft ") if w else "nobody" for w in winners)])
    return ("The quickest way of `soft` to an error; the default is `shi`.\n\n"
            + _table(["scene", *(f"error at most {significant(error)}" for error in ERRORS)], lines))


def _failed(bench: Bench, study: str) -> str:
    failed: dict[tuple[str, str, str], int] = {}
    for row in bench.of(study):
        if row.reason:
            key = (row.scene, row.method, row.reason)
            failed[key] = failed.get(key, 0) + 1
    if not failed:
        return ""
    return "\nNot there:\n\n" + _table(["scene", "method", "runs", "reason"], [[s, m, str(n), r] for (s, m, r), n in failed.items()])


def _errors(bench: Bench, study: str) -> str:
    return "\n".join(f"- {scene}: {what}" for scene, what in
                     dict.fromkeys((row.scene, row.error_of) for row in bench.of(study) if row.error_of)) + "\n\n"


def _rows(rows: list[Row], head: list[str], cells) -> str:
    return _table(head, [cells(row) for row in rows if not row.reason])


def _comparison(bench: Bench, study: str) -> str:
    return "Errors:\n\n" + _errors(bench, study) + _winners(bench, study) + _failed(bench, study)


def _all_runs(bench: Bench, study: str) -> str:
    head = ["scene", "method", "dt [s]", "steps", "iterations", "CPU [ms]", "spread", "error", "deepest [m]"]
    return "\n" + _rows(bench.of(study), head, lambda r: [
        r.scene, r.method, significant(r.dt_s), str(r.steps), significant(r.iterations), significant(1e3 * r.cpu_s), _spread(r), significant(r.error),
        significant(r.max_penetration_m)])


def _per(whole: int | None, parts: int) -> str:
    return "-" if whole is None else significant(whole / parts)


def _sizes(bench: Bench) -> str:
    lines = []
    moved = {(r.scene, r.method): r for r in bench.of(scaling.MOTION) if not r.reason}
    for r in bench.of(scaling.SETTLING):
        if r.reason:
            lines.append([r.method, r.scene, "", "", r.reason, "", "", "", "", ""])
            continue
        m = moved.get((r.scene, r.method))
        lines.append([r.method, f"{r.blocks:,}", f"{r.contacts:,}", str(r.steps), significant(r.cpu_s), significant(1e3 * m.cpu_s / m.steps) if m else "-",
                      significant(1e3 * m.cpu_s / m.iterations) if m and m.iterations else "-", significant(r.peak_memory_bytes / r.blocks),
                      _per(scaling.memory_without_factor(bench, r), r.blocks), str(scaling.krylov_iterations(bench, r) or "-")])
    fits = [[f.method, f.what, significant(f.value), str(f.sizes)] for f in scaling.fits(bench)]
    return (_table(["method", "blocks", "closed contacts", "steps of settling", "settling [s]", "a step of motion [ms]", "an iteration [ms]",
                    "memory [bytes a block]", "without the factor", "Krylov iterations, settling"], lines)
            + f"\nExponents of the number of blocks, from {scaling.FIT_RANGE[0]:,} to {scaling.FIT_RANGE[1]:,}:\n\n"
            + _table(["method", "of", "exponent", "sizes"], fits))


def _walls_and_piles(bench: Bench) -> str:
    lines = [[r.scene, r.method, str(r.blocks or ""), f"{significant(1e3 * r.cpu_s / r.steps)} ({_spread(r)})" if r.cpu_s else "-",
              significant(r.iterations / r.steps) if r.iterations is not None and r.steps else "-", significant(r.max_penetration_m), r.reason]
             for r in bench.of(walls_and_piles.STUDY)]
    return (f"A wall in running bond, {walls_and_piles.REST_STEPS} steps after it has settled and {walls_and_piles.COLD_STEPS} with gravity that comes at "
            f"once; boxes that fall on each other, steps of {1e3 * walls_and_piles.PILE_DT_S:g} ms. No closed form stands beside them: they are here for "
            "what they cost, the deepest penetration beside it. Iterations of the wall at rest are those of settling; `dem` counts its own steps.\n\n"
            + _table(["scene", "method", "blocks", "a step [ms]", "iterations a step", "deepest penetration [m]", "reason"], lines))


def _skips(bench: Bench) -> str:
    lines = []
    for scene in dict.fromkeys(row.scene for row in bench.of(skips.STUDY)):
        rows = bench.of(skips.STUDY, scene)
        on = next((r for r in rows if r.method == skips.ALL), None)
        for r in rows:
            if r.reason or on is None or not on.cpu_s:
                lines.append([scene, r.method, r.reason, "", "", ""])
            else:
                lines.append([scene, r.method, significant(r.cpu_s), significant(r.cpu_s / on.cpu_s), _spread(r), significant(r.error)])
    return _table(["scene", "skips", "CPU [s]", "over all on", "spread", "toe block elsewhere by"], lines)


def _stages(bench: Bench) -> str:
    found = skips.stages(bench)
    names = list(next(iter(found.values()), {}))
    lines = [[m, *(f"{significant(times[n])} s, {100 * times[n] / sum(times.values()):.0f} %" for n in names)] for m, times in found.items()]
    return _table(["method", *names], lines)


def _table_4(bench: Bench, printed: dict) -> str:
    found = table_4.rows(bench, printed)
    names = list(found[0][1])
    lines = [[what, *(f"{significant(ours[n])} / {significant(paper.get(n))}" for n in names)] for what, ours, paper in found]
    return ("Time over that of `soft` with the paper's step of 1 ms, here / in the paper's Table 4 (minutes of its machine; dem: its UDEC):\n\n"
            + _table(["", *names], lines) + _failed(bench, table_4.STUDY))


def _failure(bench: Bench, findings: failure.Findings | None) -> str:
    text = ""
    if findings:
        text = (f"The reference and the same with twice its step differ by {100 * findings.converged:.2g} % of the times. Starts that differ by "
                f"{failure.PERTURBATION:g} in strength spread its times by {100 * findings.reference.spread:.2g} %, those of the other runs as the "
                "table says: a run is no surer than that, and where it is much more than the step's error the motion is chaotic. Times are means "
                "over the starts.\n\n")
        text += "".join(f"With {blocks:,} blocks the reference, dem with shorter steps, is known to {100 * converged:.2g} %.\n\n"
                        for blocks, converged in findings.large_converged.items())
        text += _table(["method", "step [s]; dem: part of the critical; adaptive: tolerance [m]",
                        "10 m [s]", "20 m", "30 m", "40 m", "half the spread of the starts"],
                       [[m, significant(v), *(f"{t:.4f}" for t in a.times), f"{100 * a.spread:.2g} %"] for (m, v), a in findings.arrivals.items()]) + "\n"
    return text + _comparison(bench, failure.STUDY)


def _peers(findings: peers.Findings) -> str:
    volume = findings.constant_volume_deg
    text = (f"Slope of example 3.4 without cohesion, gravity dropped on it, {peers.ANGLE_DEG:.2f} degrees of friction, {peers.END_S:g} s. The angle "
            f"at which it just stands is {findings.exact_deg:.2f} degrees by limit analysis with sliding at the friction angle"
            f"{f', {volume:.2f} at constant volume' if volume else ''}; the engines are asked by bisection to {peers.WIDTH_DEG:g} degrees whether "
            f"any block moves {peers.STANDS_M:g} m, ours by strength reduction. Penetration is what each program's own contacts tell. `dem` counts "
            "its own steps.\n\n")
    lines = [[c.name, significant(c.row.dt_s), f"{significant(1e3 * c.step)} ({_spread(c.row)})" if c.step else "-", significant(c.per_second),
              significant(1e6 * c.iteration) if c.iteration else "-", significant(c.critical_deg, 4),
              "-" if c.row.error is None else f"{100 * c.row.error:.2g} %", significant(c.row.max_penetration_m), c.row.reason] for c in findings.compared]
    head = ["", "dt [s]", "a step [ms]", "a simulated second [s]", "a Newton iteration [us]", "critical angle [degrees]", "its error (tan)",
            "deepest penetration [m]", "reason"]
    return (text + _table(head, lines) + "\n" + "\n".join(f"- {c.name}: {c.settings}" for c in findings.compared if c.settings) + "\n")


def _peers_on_walls_and_piles(bench: Bench) -> str:
    lines = [[r.scene, r.method, significant(r.dt_s), str(r.steps or ""), f"{significant(r.cpu_s)} ({_spread(r)})" if r.cpu_s else "-",
              significant(r.max_penetration_m), r.reason] for r in bench.of(peers.BLOCKS_STUDY)]
    return ("The wall with gravity that comes at once and the boxes that fall on each other, as above: the same time of the scene for all, steps that "
            "are cut count as several.\n\n"
            + _table(["scene", "", "dt [s]", "steps", "all of it [s]", "deepest penetration [m]", "reason"], lines))


def _micro(timed: list[micro.Timed]) -> str:
    sizes = list(dict.fromkeys(t.blocks for t in timed))
    names = list(dict.fromkeys(t.name for t in timed))
    of = {(t.name, t.blocks): t for t in timed}

    def cell(t: micro.Timed | None) -> str:
        if t is None:
            return "-"
        return f"{significant(1e6 * t.cpu)} ({100 * t.variation:.0f} %)" + (f", {t.iterations} iterations" if t.iterations else "")

    return ("Microseconds of CPU time, median of repeats in random order (standard deviation); the slope of example 3.4 half a second into failure. "
            "`residual` is the forces of all contacts and blocks at a position, `assembly` the contacts' derivatives into the matrix, `factor` and "
            "`solve` the block solver for up to 3,000 blocks, `step_of_soft` a whole step from its start with the solver that the program takes.\n\n"
            + _table(["", *(f"{n:,} blocks" for n in sizes)], [[name, *(cell(of.get((name, n))) for n in sizes)] for name in names]))


def write(bench: Bench, found: dict, printed: dict, description: dict, figures: list[tuple[str, str]], file: Path) -> None:
    drawn = dict(figures)

    def section(title: str, study: str, body) -> str:
        if not bench.of(study):
            return ""
        picture = f"\n![{title}](bench/{drawn[study]})\n" if study in drawn else ""
        return f"\n## {title}\n\n{body()}{picture}"

    d = description
    head = (f"# Benchmarks\n\n{d['version']} ({d['commit']}), {d['compiler']}, {d['build_type']}{', tuned' if d['tuned'] else ''}; {d['processor']}, "
            f"{d['processors']} processors, load {d['load_average_at_start']:.1f} at the start; {d['system']}. One thread, CPU time, medians of "
            f"repeats made in turn ({d['mode']}). Every row: `bench.csv`. Nothing with an error above {100 * LARGEST_ERROR:g} % wins.\n")
    goals = targets.measured(bench, found)
    text = head + "\n## Asked and measured\n\n"
    text += _table(["what", "asked", "measured", "kept"], [[t.what, t.asked, t.measured, t.verdict] for t in goals])
    text += section("Single blocks in motion", motion.STUDY, lambda: _comparison(bench, motion.STUDY))
    text += section("Static equilibrium from nothing", statics.EQUILIBRIUM,
                    lambda: f"{statics.NOTE}\n\n" + _comparison(bench, statics.EQUILIBRIUM) + _all_runs(bench, statics.EQUILIBRIUM))
    text += section("Strength reduction", statics.REDUCTION, lambda: _comparison(bench, statics.REDUCTION) + _all_runs(bench, statics.REDUCTION))
    text += section("After failure", failure.STUDY, lambda: _failure(bench, found.get("failure")) + _all_runs(bench, failure.STUDY))
    if bench.of(motion.STUDY) or bench.of(failure.STUDY):
        text += "\n## Which integrator\n\n" + _integrators(bench)
    text += section("By size", scaling.SETTLING, lambda: _sizes(bench))
    text += section("What the skips save", skips.STUDY, lambda: _skips(bench))
    if bench.of(skips.STUDY):
        text += "\n## Time by stage\n\n" + _stages(bench) + (f"\n![Time by stage](bench/{drawn['stages']})\n" if "stages" in drawn else "")
    text += section("Walls and piles", walls_and_piles.STUDY, lambda: _walls_and_piles(bench))
    text += section("Table 4 and Fig. 10", table_4.STUDY, lambda: _table_4(bench, printed))
    if found.get("micro"):
        text += "\n## Parts of a step\n\n" + _micro(found["micro"])
    if found.get("peers"):
        text += "\n## Other engines\n\n" + _peers(found["peers"]) + "\n![Other engines](bench/other_engines.png)\n\n" + _peers_on_walls_and_piles(bench)
    file.write_text(text, encoding="utf-8")
