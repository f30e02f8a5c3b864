"""The same scene with its fixed blocks cut by more joints, which never open: nothing that stands or moves on them can tell."""

import copy
import math
import random

from geometry import Polygon, convex, cross, edges, integrals, on_segment

MOST_CUTS = 4
AT_A_FOOT = 0.75  # share of the cuts that go through a corner that stands on a fixed block, or past it by one of these
PAST_THE_FOOT_M = 0.0, 0.0, 1e-9, 1e-6, -1e-6, 1e-4, -1e-4, 1e-3
ALONG_A_FACE, LARGEST_SMALL_ANGLE = 0.6, 15.0  # [-], [deg] of the cuts that leave a face at a small angle
LEAST_WIDTH = 1e-3  # [-] of the longest edge: twice the area over its square
LEAST_EDGE_M = 1e-3  # of the longest one of a piece
ON_A_FACE_M = 1e-9


def cut(r: random.Random, document: dict) -> dict:
    changed = copy.deepcopy(document)
    feet = _feet(document)
    faces = [e for b in document["block"] if b.get("fixed") for e in edges(b["vertices_m"])]
    for _ in range(r.randint(1, MOST_CUTS)):
        if feet and r.random() < AT_A_FOOT:
            point, face = r.choice(feet)
            past = r.choice(PAST_THE_FOOT_M)
        else:
            face = r.choice(faces)
            point, past = face[0], r.uniform(0, math.dist(*face))
        along = math.atan2(face[1][1] - face[0][1], face[1][0] - face[0][0])
        angle = along + math.radians(r.choice((-1, 1)) * r.uniform(0.5, LARGEST_SMALL_ANGLE) if r.random() < ALONG_A_FACE else r.uniform(0, 180))
        through = point[0] + past * math.cos(along), point[1] + past * math.sin(along)
        changed["block"] = [piece for b in changed["block"] for piece in (_pieces(b, through, angle) if b.get("fixed") else [b])]
    return changed


def _feet(document: dict) -> list[tuple[tuple[float, float], tuple]]:
    """Corners of free blocks on edges of fixed ones, with the edge."""
    faces = [e for b in document["block"] if b.get("fixed") for e in edges(b["vertices_m"])]
    corners = [p for b in document["block"] if not b.get("fixed") for p in b["vertices_m"]]
    return [(p, face) for p in corners for face in faces if on_segment(p, *face, ON_A_FACE_M)]


def _pieces(block: dict, through: tuple[float, float], angle: float) -> list[dict]:
    """Of a convex block on both sides of a line; the block itself where the line passes it by or would leave a sliver."""
    vertices = [tuple(p) for p in block["vertices_m"]]
    if not convex(vertices):
        return [block]
    ahead = through[0] + math.cos(angle), through[1] + math.sin(angle)
    left = [cross(through, ahead, p) for p in vertices]
    names = block.get("edge_joints", [""] * len(vertices))
    sides, joints = ([], []), ([], [])  # of the pieces: corners, and the joint of the edge that begins at each; the cut has none of its own
    for i, (p, q) in enumerate(edges(vertices)):
        here, there = left[i], left[(i + 1) % len(vertices)]
        for corners, joint, sign in ((sides[0], joints[0], 1), (sides[1], joints[1], -1)):
            if here * sign >= 0:
                corners.append(p)
                joint.append(names[i] if here * sign > 0 or there * sign > 0 else "")
            if here * there < 0:
                corners.append(_between(p, q, here / (here - there), through))
                joint.append(names[i] if there * sign > 0 else "")
    if any(len(s) < 3 or _is_sliver(s) for s in sides):
        return [block]
    return [block | {"name": f"{block['name']}{mark}", "vertices_m": [list(p) for p in s]} | ({"edge_joints": j} if "edge_joints" in block else {})
            for mark, s, j in zip("lr", sides, joints)]


def _is_sliver(piece: Polygon) -> bool:
    longest = max(math.dist(*e) for e in edges(piece))
    return longest < LEAST_EDGE_M or 2 * integrals(piece).area < LEAST_WIDTH * longest**2


def _between(p: tuple[float, float], q: tuple[float, float], part: float, through: tuple[float, float]) -> tuple[float, float]:
    """The crossing of the line with an edge: the very point that it was drawn through, if it is that one, and on the edge if that runs along an axis."""
    x, y = (a if a == b else a + part * (b - a) for a, b in zip(p, q))
    return through if math.dist((x, y), through) < ON_A_FACE_M else (x, y)
