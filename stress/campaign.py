"""Draws scenes, runs them by every method and judges what comes out: rows of stress.csv."""

import csv
import random
import shutil
import tomllib
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, fields, replace
from functools import partial
from pathlib import Path

import cut_ground
import maps
import masonry
import planes
import slopes
import tumbles
import verdicts
from motion import outlines_of
from outcome import METHODS, OF_MOTION_ONLY, Programs
from scene import Scene, measured, of_blocks, to_toml
from variants import VARIANTS

PARTS = {part.PART: part.draw for part in (slopes, planes, masonry, tumbles, maps)}
MOST_ATTEMPTS = 50
# `make regression`: seeds that stay, a few of each part. Whoever accepts a change draws others.
REGRESSION = {slopes.PART: range(2000, 2012), planes.PART: range(2000, 2012), masonry.PART: range(2000, 2012), tumbles.PART: range(2000, 2016), maps.PART: range(2000, 2018)}
REGRESSION_LIMIT_S = 5
SAME = {"soft", "hard"}  # in statics they are one solver


@dataclass(frozen=True)
class Row:
    part: str
    seed: int
    drawn: str
    method: str
    blocks: int
    verdict: str
    reason: str
    answer: str = ""  # of `fos`: certified, interval, no_failure, no_equilibrium, undecided
    factor: float | None = None
    stable: float | None = None
    failed: float | None = None
    limit_analysis: float | None = None
    energy_created: float | None = None  # [-] over the start's
    energy_rise: float | None = None
    overlap: float | None = None         # [-] over the smaller block's area
    cpu_s: float = 0.0
    exit: int | None = None


def read(file: Path) -> dict:
    return tomllib.loads(file.read_text(encoding="utf-8"))


def _to_follow(scene: Scene) -> Scene:
    return replace(scene, document=measured(scene.document)) if scene.command == "run" else scene


@dataclass(frozen=True)
class Campaign:
    programs: Programs
    folder: Path  # scenes and what was written for them
    methods: tuple[str, ...]
    invariances: bool = False  # slopes also drawn in other ways, by every method

    def scene(self, part: str, seed: int) -> tuple[Scene, Path]:
        """Draws it, and writes it as blocks. Slopes in which every block is fixed are drawn anew."""
        for attempt in range(MOST_ATTEMPTS):
            scene = PARTS[part](seed, attempt)
            folder = self.folder / scene.name
            shutil.rmtree(folder, ignore_errors=True)
            drawn, blocks = folder / "scene.toml", folder / "blocks.toml"
            scene.write(drawn)
            if "domain" not in scene.document:
                return _to_follow(scene), drawn
            cut = self.programs.cut(drawn, blocks)
            if cut.exit == 0 and any(not b.get("fixed") for b in read(blocks)["block"]):
                return _to_follow(replace(scene, document=of_blocks(scene.document, read(blocks)))) if scene.command == "run" else scene, drawn
        raise ValueError(f"{part}, seed {seed}: no scene that can be cut and has a free block in {MOST_ATTEMPTS} attempts; the last: {cut.message}")

    def written(self, part: str, seed: int) -> Path:
        """Writes the scene of a seed as the campaign runs it."""
        scene, file = self.scene(part, seed)
        scene.write(file)
        return file

    def judge(self, part: str, seed: int) -> list[Row]:
        scene, file = self.scene(part, seed)
        return self._factors(scene, file) if scene.command == "fos" else self._motions(scene, file)

    def _motions(self, scene: Scene, file: Path) -> list[Row]:
        scene.write(file)
        rows = []
        for method in self.methods:
            outcome = self.programs.analyse("run", file, METHODS[method], file.parent / method)
            verdict = verdicts.of_motion(scene, method, outcome)
            rows.append(_row(scene, method, len(scene.document["block"]), verdict, outcome))
            self._tidy(outcome.folder, verdict)
        return rows

    def _factors(self, scene: Scene, file: Path) -> list[Row]:
        blocks = file.parent / "blocks.toml"
        if not blocks.exists():
            shutil.copy(file, blocks)
        methods = [m for m in self.methods if m not in OF_MOTION_ONLY]
        rows, found = self._factors_of(scene, file, blocks, methods)
        if SAME <= set(found):
            rows += self._same(scene, *(found[method] for method in sorted(SAME)))
        for method in set(found) - SAME if "soft" in found else ():
            rows += _comparison(scene, f"{method} = soft", verdicts.nearly_same(found["soft"], found[method]), found["soft"], found[method], verdicts.APART)
        rows += self._drawn_otherwise(scene, blocks, methods, found, self._variants(scene))
        return rows

    def _variants(self, scene: Scene) -> dict[str, Callable[[dict], dict]]:
        variants = {"ground cut": partial(cut_ground.cut, random.Random(f"cut {scene.name}"))}
        return variants | (VARIANTS if self.invariances and scene.part == slopes.PART else {})

    def _factors_of(self, scene: Scene, file: Path, blocks: Path, methods: list[str], variant: str = "") -> tuple[list[Row], dict[str, verdicts.Verdict]]:
        assembly, limit = verdicts.Assembly(read(blocks)), self.programs.limit_analysis(blocks)
        rows, found = [], {}
        for method in methods:
            outcome = self.programs.analyse("fos", file, METHODS[method], file.parent / f"{method}{variant}".replace(" ", "_"))
            found[method] = verdicts.of_factor(outcome, assembly, limit, scene.most)
            rows.append(_row(scene, f"{method}{variant}", len(assembly.vertices), found[method], outcome))
            self._tidy(outcome.folder, found[method])
        return rows, found

    @staticmethod
    def _same(scene: Scene, one: verdicts.Verdict, other: verdicts.Verdict) -> list[Row]:
        wide = next((f"a bracket of {v.stable:.6g} to {v.failed:.6g}" for v in (one, other) if verdicts.too_wide(v)), "")
        return _comparison(scene, " = ".join(sorted(SAME)), verdicts.same_bracket(one, other) or wide, one, other)

    def _drawn_otherwise(self, scene: Scene, blocks: Path, methods: list[str], found: dict[str, verdicts.Verdict],
                         variants: dict[str, Callable[[dict], dict]]) -> list[Row]:
        """The brackets of the same scene drawn in other ways."""
        document = of_blocks(scene.document, read(blocks))
        rows = []
        for name, change in variants.items():
            file = blocks.parent / f"{name}.toml".replace(" ", "_")
            file.write_text(to_toml(change(document)), encoding="utf-8")
            more, changed = self._factors_of(scene, file, file, methods, f", {name}")
            rows += more
            for method in methods:
                alike = verdicts.same_bracket if method in SAME else verdicts.nearly_same  # explicit steps come to rest at a place of their own
                wrong = alike(found[method], changed[method])
                rows += _comparison(scene, f"{method} = {method}, {name}", wrong, found[method], changed[method])
        return rows

    def draw_again(self, row: Row, file: Path) -> bool:
        """A picture of what a row is about, from a run of its own; false if it left no blocks."""
        import pictures

        folder = file.with_suffix("")
        scene, path = replace(self, folder=folder).scene(row.part, row.seed)
        scene.write(path)
        outcome = self.programs.analyse(scene.command, path, METHODS[row.method], path.parent / row.method)
        states = outlines_of(outcome)
        blocks = path.parent / "blocks.toml"
        document = read(blocks) if blocks.exists() else scene.document
        shutil.rmtree(folder, ignore_errors=True)
        if not states:
            return False
        title = f"{row.part} {row.seed}, {row.method}: {row.verdict}"
        pictures.draw(states, {b["name"] for b in document["block"] if b.get("fixed")}, title, file)
        return True

    @staticmethod
    def _tidy(folder: Path, verdict: verdicts.Verdict) -> None:
        """What is right needs no second look."""
        if verdict.kind == verdicts.RIGHT:
            shutil.rmtree(folder, ignore_errors=True)


def _comparison(scene: Scene, what: str, wrong: str, one: verdicts.Verdict, other: verdicts.Verdict, otherwise: str = verdicts.FALSE) -> list[Row]:
    """A row for two answers that have to be one; none where there are not two.

    otherwise: the verdict where something is wrong
    """
    if one.stable is None or other.stable is None:
        return []
    return [Row(scene.part, scene.seed, scene.described(), what, 0, otherwise if wrong else verdicts.RIGHT, wrong)]


def _row(scene: Scene, method: str, blocks: int, verdict: verdicts.Verdict, outcome) -> Row:
    return Row(scene.part, scene.seed, scene.described(), method, blocks, verdict.kind, verdict.reason,
               outcome.summary.get("verdict", ""), verdict.factor, verdict.stable, verdict.failed,
               verdict.limit, verdict.created, verdict.rise, verdict.overlap, round(outcome.cpu_s, 4), outcome.exit)


def run(campaign: Campaign, seeds: list[tuple[str, int]], jobs: int, told: tuple[str, ...]) -> list[Row]:
    """In the order of the seeds, a scene a process; prints the rows of these verdicts."""
    rows = []
    with ProcessPoolExecutor(jobs) as pool:
        for judged in pool.map(campaign.judge, *zip(*seeds)):
            rows += judged
            for row in judged:
                if row.verdict in told:
                    print(f"{row.part} {row.seed} {row.method}: {row.verdict}: {row.reason}", flush=True)
    return rows


def write_csv(rows: list[Row], file: Path) -> None:
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, [f.name for f in fields(Row)])
        writer.writeheader()
        for row in rows:
            writer.writerow({k: "" if v is None else v for k, v in asdict(row).items()})
