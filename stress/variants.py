"""The same slope drawn in another way, which has the same factor of safety: other stiffness, mirrored, far away, small or large."""

import copy
from collections.abc import Callable


def _points(document: dict, change: Callable[[float, float], list[float]]) -> dict:
    changed = copy.deepcopy(document)
    for table in (t for tables in changed.values() if isinstance(tables, list) for t in tables if isinstance(t, dict)):
        if "vertices_m" in table:
            table["vertices_m"] = [change(*p) for p in table["vertices_m"]]
        if "point_m" in table:
            table["point_m"] = change(*table["point_m"])
    return changed


def stiffer(factor: float) -> Callable[[dict], dict]:
    def change(document: dict) -> dict:
        changed = copy.deepcopy(document)
        for joint in changed["joint"]:
            joint["normal_stiffness_pa_per_m"] *= factor
            joint["shear_stiffness_pa_per_m"] *= factor
        return changed

    return change


def mirrored(document: dict) -> dict:
    changed = _points(document, lambda x, y: [-x, y])
    for block in changed["block"]:
        block["vertices_m"].reverse()
        if "edge_joints" in block:  # each from its vertex to the next one: the edge between the last and the first vertex stays the last one
            block["edge_joints"] = block["edge_joints"][-2::-1] + block["edge_joints"][-1:]
    gravity = changed.get("gravity_m_per_s2", [0.0, -9.81])
    changed["gravity_m_per_s2"] = [-gravity[0], gravity[1]]
    for load in changed.get("load", []):
        load["force_n"] = [-load["force_n"][0], load["force_n"][1]]
    return changed


def moved(distance: float) -> Callable[[dict], dict]:
    return lambda document: _points(document, lambda x, y: [x + distance, y - distance])


def scaled(factor: float) -> Callable[[dict], dict]:
    """Weights grow with the square and cohesive forces with the length: cohesion is scaled alike, so that they grow as the weights. Loads, too."""
    def change(document: dict) -> dict:
        changed = _points(document, lambda x, y: [x * factor, y * factor])
        for joint in changed["joint"]:
            for key in ("cohesion_pa", "tensile_strength_pa"):
                if key in joint:
                    joint[key] *= factor
        for load in changed.get("load", []):
            load["force_n"] = [f * factor**2 for f in load["force_n"]]
        return changed

    return change


VARIANTS = {
    "stiffness x 0.01": stiffer(1e-2),
    "stiffness x 1000": stiffer(1e3),
    "mirrored": mirrored,
    "moved 5e6 m": moved(5e6),
    "scaled x 0.001": scaled(1e-3),
    "scaled x 1000": scaled(1e3),
}
