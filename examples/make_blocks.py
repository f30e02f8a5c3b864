#!/usr/bin/env python3
"""Writes the scenes of the examples whose blocks are too many to type: a head of options, kept as text, and the blocks by their geometry.

    examples/make_blocks.py            writes examples/NAME/scene.toml for every NAME in SCENES
    examples/make_blocks.py NAME       prints one of them
"""

import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
Corners = list[tuple[float, float]]

# The columns of Goodman and Bray (1976) [m]: width, number of columns and of the highest one, rise of the tops, height of a step.
COLUMN_WIDTH_M, COLUMNS, CREST, RISE_M, STEP_M = 10.0, 16, 10, 5.0, 1.0
STEP_DIP_DEG = 30.0
# The arch: number of voussoirs, angle between its springers, radius of the centre line and thickness [m].
VOUSSOIRS, ARCH_OPENS_DEG, ARCH_RADIUS_M, ARCH_THICKNESS_M = 15, 150.0, 2.0, 0.36
# The wall [m]: brick, courses, bricks in a course; openings as (left, right, first course, course of the lintel), in bricks.
BRICK_M, COURSE_M, WALL_COURSES, WALL_BRICKS = 0.6, 0.4, 9, 9
OPENINGS = ((1.5, 3.0, 0, 5), (5.5, 7.0, 2, 5))
# The tower [m]: left and right end of each course on the one below, and its height.
TOWER = ((-1.50, 1.50, 0.5), (-1.40, 1.35, 0.45), (-1.25, 1.30, 0.5), (-1.20, 1.15, 0.4), (-1.00, 1.10, 0.5), (-1.00, 0.90, 0.45), (-0.80, 0.85, 0.5),
         (-0.75, 0.70, 0.4), (-0.60, 0.65, 0.5), (-0.60, 0.45, 0.4), (-0.35, 0.45, 0.45), (-0.30, 0.30, 0.6))


def rectangle(left: float, bottom: float, right: float, top: float) -> Corners:
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def columns() -> dict[str, Corners]:
    """Columns on a stepped base, turned so that the steps dip out of the slope."""
    cos, sin = math.cos(math.radians(STEP_DIP_DEG)), math.sin(math.radians(STEP_DIP_DEG))

    def height(k: int) -> float:
        return min(k, CREST) * (RISE_M - STEP_M) - max(0, k - CREST) * (RISE_M + STEP_M)

    blocks, steps = {}, []
    for k in range(1, COLUMNS + 1):
        left, foot = (k - 1) * COLUMN_WIDTH_M, (k - 1) * STEP_M
        blocks[f"column_{k}"] = rectangle(left, foot, left + COLUMN_WIDTH_M, foot + height(k))
        steps += [(left, foot), (left + COLUMN_WIDTH_M, foot)]
    depth = 2 * COLUMN_WIDTH_M
    blocks["base"] = [(0, -depth), (COLUMNS * COLUMN_WIDTH_M, -depth), *reversed(steps)]
    return {name: [(x * cos - y * sin, x * sin + y * cos) for x, y in corners] for name, corners in blocks.items()}


def arch() -> dict[str, Corners]:
    """Voussoirs with straight edges between radial joints, from left to right, and a springer at either side."""
    half = math.radians(ARCH_OPENS_DEG) / 2
    angles = [half * (2 * k / VOUSSOIRS - 1) for k in range(VOUSSOIRS + 1)]

    def at(angle: float, outwards: float) -> tuple[float, float]:
        radius = ARCH_RADIUS_M + outwards * ARCH_THICKNESS_M / 2
        return radius * math.sin(angle), radius * math.cos(angle)

    blocks = {f"voussoir_{k + 1}": [at(b, -1), at(b, 1), at(a, 1), at(a, -1)] for k, (a, b) in enumerate(zip(angles, angles[1:]))}
    bottom = at(half, -1)[1] - 0.5
    (x1, y1), (x2, y2) = at(half, -1), at(half, 1)
    side = x2 + 0.3
    blocks["base"] = [(-side, bottom), (side, bottom), (side, y2), (x2, y2), (x1, y1), (x1, bottom + 0.2), (-x1, bottom + 0.2), (-x1, y1), (-x2, y2), (-side, y2)]
    return blocks


def wall() -> dict[str, Corners]:
    """Running bond with a door and a window; a lintel of one stone reaches half a brick beyond its opening at both sides."""
    blocks = {"base": rectangle(-BRICK_M, -COURSE_M, (WALL_BRICKS + 1) * BRICK_M, 0.0)}
    for course in range(WALL_COURSES):
        joints = sorted({0.0, float(WALL_BRICKS), *(k + course % 2 / 2 for k in range(WALL_BRICKS))})
        pieces = list(zip(joints, joints[1:]))
        for left, right, low, lintel in OPENINGS:
            if low <= course < lintel:
                pieces = without(pieces, left, right)
            if course == lintel:
                pieces = [*without(pieces, left - 0.5, right + 0.5), (left - 0.5, right + 0.5)]
        for number, (a, b) in enumerate(sorted(pieces), 1):
            blocks[f"course_{course + 1}_{number}"] = rectangle(a * BRICK_M, course * COURSE_M, b * BRICK_M, (course + 1) * COURSE_M)
    return blocks


def without(pieces: list[tuple[float, float]], left: float, right: float) -> list[tuple[float, float]]:
    """The pieces of a course outside an opening; those that reach into it are cut."""
    outside = [(a, min(b, left)) for a, b in pieces] + [(max(a, right), b) for a, b in pieces]
    return [(a, b) for a, b in outside if b > a]


def tower() -> dict[str, Corners]:
    blocks, bottom = {"base": rectangle(-2.5, -0.5, 2.5, 0.0)}, 0.0
    for number, (left, right, height) in enumerate(TOWER, 1):
        blocks[f"stone_{number}"] = rectangle(left, bottom, right, bottom + height)
        bottom += height
    return blocks


SCENES = {"toppling_slope": columns, "tilting_arch": arch, "shaken_wall": wall, "dry_stone_tower": tower}


def number(value: float) -> str:
    """To a nanometre, without a sign of zero."""
    return repr(round(value, 9) + 0.0)


def scene(name: str) -> str:
    text = (HERE / name / "head.toml").read_text()
    for block, corners in SCENES[name]().items():
        points = ", ".join(f"[{number(x)}, {number(y)}]" for x, y in corners)
        text += f'\n[[block]]\nname = "{block}"\nmaterial = "stone"\n' + ("fixed = true\n" if block == "base" else "") + f"vertices_m = [{points}]\n"
    return text


def main() -> None:
    if len(sys.argv) > 1:
        sys.stdout.write(scene(sys.argv[1]))
        return
    for name in SCENES:
        (HERE / name / "scene.toml").write_text(scene(name))


if __name__ == "__main__":
    main()
