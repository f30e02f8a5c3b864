"""Draws scenes, runs them by every method and judges what comes out: rows of stress.csv."""

import csv
import shutil
import tomllib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import slopes
import tumbles
import verdicts
from outcome import METHODS, OF_MOTION_ONLY, Programs
from scene import Scene, measured

PARTS = {"slopes": slopes.draw, "tumbles": tumbles.draw}
MOST_ATTEMPTS = 50


@dataclass(frozen=True)
class Row:
    part: str
    seed: int
    drawn: str
    method: str
    blocks: int
    verdict: str
    reason: str
    factor: float | None
    stable: float | None
    failed: float | None
    limit_analysis: float | None
    energy_created: float | None
    energy_rise: float | None
    overlap: float | None
    cpu_s: float
    exit: int | None


@dataclass(frozen=True)
class Campaign:
    programs: Programs
    folder: Path  # scenes and what was written for them
    methods: tuple[str, ...]

    def scene(self, part: str, seed: int) -> tuple[Scene, Path]:
        """Draws it, and writes it as blocks. Slopes in which every block is fixed are drawn anew."""
        for attempt in range(MOST_ATTEMPTS):
            scene = PARTS[part](seed, attempt)
            folder = self.folder / scene.name
            shutil.rmtree(folder, ignore_errors=True)
            drawn, blocks = folder / "scene.toml", folder / "blocks.toml"
            scene.write(drawn)
            if "domain" not in scene.document:
                return replace(scene, document=measured(scene.document) if scene.command == "run" else scene.document), drawn
            cut = self.programs.cut(drawn, blocks)
            if cut.exit == 0 and any(not b.get("fixed") for b in tomllib.loads(blocks.read_text(encoding="utf-8"))["block"]):
                return scene, drawn
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
        assembly = verdicts.Assembly(tomllib.loads(blocks.read_text(encoding="utf-8")))
        limit = self.programs.limit_analysis(blocks)
        rows = []
        for method in self.methods:
            if method in OF_MOTION_ONLY:
                continue
            outcome = self.programs.analyse("fos", file, METHODS[method], file.parent / method)
            verdict = verdicts.of_factor(outcome, assembly, limit)
            rows.append(_row(scene, method, len(assembly.vertices), verdict, outcome))
            self._tidy(outcome.folder, verdict)
        return rows

    @staticmethod
    def _tidy(folder: Path, verdict: verdicts.Verdict) -> None:
        """What is right needs no second look."""
        if verdict.kind == verdicts.RIGHT:
            shutil.rmtree(folder, ignore_errors=True)


def _row(scene: Scene, method: str, blocks: int, verdict: verdicts.Verdict, outcome) -> Row:
    return Row(scene.part, scene.seed, scene.described(), method, blocks, verdict.kind, verdict.reason, verdict.factor, verdict.stable, verdict.failed,
               verdict.limit, verdict.created, verdict.rise, verdict.overlap, round(outcome.cpu_s, 4), outcome.exit)


def run(campaign: Campaign, seeds: list[tuple[str, int]], jobs: int) -> list[Row]:
    """In the order of the seeds, a scene a process."""
    rows = []
    with ProcessPoolExecutor(jobs) as pool:
        for judged in pool.map(campaign.judge, *zip(*seeds)):
            rows += judged
            for row in judged:
                if row.verdict != verdicts.RIGHT:
                    print(f"{row.part} {row.seed} {row.method}: {row.verdict}: {row.reason}", flush=True)
    return rows


def write_csv(rows: list[Row], file: Path) -> None:
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, [f.name for f in fields(Row)])
        writer.writeheader()
        for row in rows:
            writer.writerow({k: "" if v is None else v for k, v in asdict(row).items()})
