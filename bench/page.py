"""results/bench.md: what was asked, what was measured, who wins at which error, and the figures."""

from pathlib import Path

import failure
import motion
import scaling
import skips
import statics
import table_4
import targets
from measure import Bench, Row
from winner import ERRORS, LARGEST_ERROR, judge


def number(value: float | None, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}g}"


def _table(head: list[str], lines: list[list[str]]) -> str:
    rule = ["---"] * len(head)
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, rule, *lines]) + "\n"


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
                lines.append([scene, number(error), "nobody", "", "", "", ""])
                continue
            w = verdict.winner
            others = ", ".join(f"{name} {number(ratio)}{' (spreads overlap)' if name in verdict.tied else ''}" for name, ratio in
                               sorted(verdict.ratios.items(), key=lambda item: item[1]))
            lines.append([scene, number(error), f"**{w.method}**", number(w.dt_s), f"{number(1e3 * w.cpu_s)} ({_spread(w)})", number(w.error), others])
    return _table(["scene", "error at most", "winner", "dt [s]", "CPU [ms]", "its error", "the others, over the winner"], lines)


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
    return "\n" + _rows(bench.of(study), ["scene", "method", "dt [s]", "steps", "iterations", "CPU [ms]", "spread", "error", "deepest [m]"], lambda r: [
        r.scene, r.method, number(r.dt_s), str(r.steps), str(r.iterations), number(1e3 * r.cpu_s), _spread(r), number(r.error),
        number(r.max_penetration_m)])


def _sizes(bench: Bench) -> str:
    lines = []
    moved = {(r.scene, r.method): r for r in bench.of(scaling.MOTION) if not r.reason}
    for r in bench.of(scaling.SETTLING):
        if r.reason:
            lines.append([r.method, r.scene, "", "", r.reason, "", "", "", ""])
            continue
        m = moved.get((r.scene, r.method))
        lines.append([r.method, f"{r.blocks:,}", f"{r.contacts:,}", str(r.steps), number(r.cpu_s), number(1e3 * m.cpu_s / m.steps) if m else "-",
                      number(1e3 * m.cpu_s / m.iterations) if m and m.iterations else "-", number(r.peak_memory_bytes / r.blocks),
                      str(scaling.krylov_iterations(bench, r) or "-")])
    fits = [[f.method, f.what, number(f.value), str(f.sizes)] for f in scaling.fits(bench)]
    return (_table(["method", "blocks", "closed contacts", "steps of settling", "settling [s]", "a step of motion [ms]", "an iteration [ms]",
                    "memory [bytes a block]", "Krylov iterations, settling"], lines)
            + f"\nExponents of the number of blocks, from {scaling.FIT_RANGE[0]:,} to {scaling.FIT_RANGE[1]:,}:\n\n"
            + _table(["method", "of", "exponent", "sizes"], fits))


def _skips(bench: Bench) -> str:
    lines = []
    for scene in dict.fromkeys(row.scene for row in bench.of(skips.STUDY)):
        rows = bench.of(skips.STUDY, scene)
        on = next((r for r in rows if r.method == skips.ALL), None)
        for r in rows:
            if r.reason or on is None or not on.cpu_s:
                lines.append([scene, r.method, r.reason, "", "", ""])
            else:
                lines.append([scene, r.method, number(r.cpu_s), number(r.cpu_s / on.cpu_s), _spread(r), number(r.error)])
    return _table(["scene", "skips", "CPU [s]", "over all on", "spread", "toe block elsewhere by"], lines)


def _stages(bench: Bench) -> str:
    found = skips.stages(bench)
    names = list(next(iter(found.values()), {}))
    lines = [[m, *(f"{number(times[n])} s, {100 * times[n] / sum(times.values()):.0f} %" for n in names)] for m, times in found.items()]
    return _table(["method", *names], lines)


def _table_4(bench: Bench, printed: dict) -> str:
    found = table_4.rows(bench, printed)
    names = list(found[0][1])
    lines = [[what, *(f"{number(ours[n])} / {number(paper.get(n))}" for n in names)] for what, ours, paper in found]
    return ("Time over that of `soft` with the paper's step of 1 ms, here / in the paper's Table 4 (minutes of its machine; dem: its UDEC):\n\n"
            + _table(["", *names], lines) + _failed(bench, table_4.STUDY))


def _failure(bench: Bench, findings) -> str:
    text = ""
    if findings:
        text = (f"The reference and the same with twice its step differ by {100 * findings.converged:.2g} % of the times (mean of the starts), starts that "
                f"differ by {failure.PERTURBATION:g} in strength by up to {100 * findings.reference.spread:.2g} %: where that is more than the step's "
                "error, the motion is chaotic and a single run tells its times no better than that.\n\n")
        text += _table(["method", "step [s], dem: fraction", "10 m [s]", "20 m", "30 m", "40 m", "half the spread of the starts"],
                       [[m, number(v), *(f"{t:.4f}" for t in a.times), f"{100 * a.spread:.2g} %"] for (m, v), a in findings.spreads.items()]) + "\n"
    return text + _comparison(bench, failure.STUDY)


def write(bench: Bench, found: dict, printed: dict, description: dict, figures: list[tuple[str, str]], file: Path) -> None:
    drawn = dict(figures)

    def section(title: str, study: str, body) -> str:
        if not bench.of(study):
            return ""
        picture = f"\n![{title}](bench/{drawn[study]})\n" if study in drawn else ""
        return f"\n## {title}\n\n{body()}{picture}"

    d = description
    head = (f"# Benchmarks\n\n{d['version']} ({d['commit']}), {d['compiler']}, {d['build_type']}{', tuned' if d['tuned'] else ''}; {d['processor']}, "
            f"{d['processors']} processors, load {d['load_average_at_start']:.1f} at the start; {d['system']}. One thread, CPU time, medians of repeats "
            f"made in turn ({d['mode']}). Every row: `bench.csv`. Nothing with an error above {100 * LARGEST_ERROR:g} % wins.\n")
    goals = targets.measured(bench, found)
    text = head + "\n## Asked and measured\n\n" + _table(["what", "asked", "measured", "kept"], [[t.what, t.asked, t.measured, t.verdict] for t in goals])
    text += section("Single blocks in motion", motion.STUDY, lambda: _comparison(bench, motion.STUDY))
    text += section("Static equilibrium from nothing", statics.EQUILIBRIUM,
                    lambda: _comparison(bench, statics.EQUILIBRIUM) + _all_runs(bench, statics.EQUILIBRIUM))
    text += section("Strength reduction", statics.REDUCTION, lambda: _comparison(bench, statics.REDUCTION) + _all_runs(bench, statics.REDUCTION))
    text += section("After failure", failure.STUDY, lambda: _failure(bench, found.get("failure")) + _all_runs(bench, failure.STUDY))
    text += section("By size", scaling.SETTLING, lambda: _sizes(bench))
    text += section("What the skips save", skips.STUDY, lambda: _skips(bench))
    if bench.of(skips.STUDY):
        text += "\n## Time by stage\n\n" + _stages(bench) + (f"\n![Time by stage](bench/{drawn['stages']})\n" if "stages" in drawn else "")
    text += section("Table 4 and Fig. 10", table_4.STUDY, lambda: _table_4(bench, printed))
    file.write_text(text, encoding="utf-8")
