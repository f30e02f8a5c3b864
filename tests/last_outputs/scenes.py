"""Scenes of these cases alone: as documents, whose keys can be varied."""

import json
import tomllib

from openclose_scripts import ROOT

SCHEMA = json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))["properties"]
METHODS = tuple(SCHEMA["method"]["properties"]["contact"]["enum"])
INTEGRATORS = tuple(SCHEMA["method"]["properties"]["integrator"]["enum"])
JOINT = {"normal_stiffness_pa_per_m": 1e8, "shear_stiffness_pa_per_m": 4e7, "friction_angle_deg": 30, "cohesion_pa": 2e3, "tensile_strength_pa": 1e3,
         "cohesion_behaviour": "lost_on_slip", "residual_friction_angle_deg": 25, "slip_weakening_distance_m": 1e-3, "damping_ratio": 0.05}
YARD = {
    "title": "yard",
    "gravity_m_per_s2": [1.5, -9.0],
    "material": [{"name": "rock", "density_kg_per_m3": 2500}, {"name": "brick", "unit_weight_n_per_m3": 18e3}],
    "joint": [{"name": "smooth"} | JOINT, {"materials": ["rock", "brick"]} | JOINT, {"materials": ["rock", "rock"]} | JOINT,
              {"materials": ["brick", "brick"]} | JOINT],
    "block": [
        {"name": "high", "material": "brick", "vertices_m": [[0.2, 1], [1.5, 1], [0.9, 2.5], [0.2, 2]], "velocity_m_per_s": [0.3, 0], "angular_velocity_rad_per_s": -0.2,
         "edge_joints": ["", "", "smooth", ""]},
        {"name": "ground", "material": "rock", "vertices_m": [[-1, -1], [6, -1], [6, 0], [-1, 0]], "fixed": True, "edge_joints": ["", "", "smooth", ""]},
        {"name": "low", "material": "rock", "vertices_m": [[0, 0], [2, 0], [2, 1], [0, 1]], "edge_joints": ["smooth", "", "", ""]},
        {"name": "guided", "material": "brick", "vertices_m": [[3, 0.01], [4, 0.01], [4, 1], [3, 1]], "rotation_locked": True},
    ],
    "load": [{"name": "crane", "block": "high", "point_m": [0.8, 2.2], "force_n": [500, -800]}],
    "support": [{"name": "anchor", "block": "low", "point_m": [1.8, 0.5], "stiffness_n_per_m": [1e6, 2e5]}],
    "surcharge": [{"name": "soil", "block": "low", "from_m": [0, 1], "to_m": [0, 0.2], "pressure_pa": 900, "shear_pa": 50}],
    "measured_point": [{"name": "top", "block": "high", "point_m": [0.8, 2.2]}],
    "measured_contact": [{"name": "bed", "point_m": [0.5, 1], "block_a": "low", "block_b": "high"}],
    "method": {"contact": "soft", "start": "unloaded"},
    "step": {"dt_s": 2e-3},
    "end": {"time_s": 0.03},
    "output": {"every_s": 0.01, "checkpoint_every_s": 1e6},
}
MOTIONS = {
    "harmonic": {"kind": "harmonic", "factor": 2, "amplitude_m_per_s2": [2, 1], "frequency_hz": 15, "phase_deg": 40},
    "record": {"kind": "record", "factor": 3, "horizontal_time_s": [0, 0.01, 0.05], "horizontal_m_per_s2": [0, 4, -3],
               "vertical_time_s": [0, 0.02, 0.04], "vertical_m_per_s2": [0, -2, 1]},
    "pulses": {"kind": "pulses", "factor": 1.5},
}
PULSES = [{"start_s": 0.004, "duration_s": 0.01, "acceleration_m_per_s2": [3, -1]}]
HILL = {
    "title": "hill",
    "material": [{"name": "rock", "density_kg_per_m3": 2500}, {"name": "clay", "density_kg_per_m3": 1900}],
    "joint": [{"materials": ["rock", "rock"]} | JOINT, {"materials": ["rock", "clay"]} | JOINT, {"materials": ["clay", "clay"]} | JOINT,
              {"name": "smooth"} | JOINT | {"friction_angle_deg": 27}, {"name": "bridge"} | JOINT | {"cohesion_pa": 3e4}],
    "domain": {"material": "rock", "vertices_m": [[-6, -3], [16, -3], [16, 9], [4, 9], [0, 0], [-6, 0]], "holes_m": [[[12, 2], [14, 2], [14, 4], [12, 4]]],
               "sliver_width_m": 0.02, "sliver_area_m2": 1e-3, "joint_end_reach_m": 0.05, "enclosed_joints": "drop", "section_direction_deg": 90, "max_blocks": 300},
    "joint_set": [{"dip_deg": 38, "spacing_m": 2.5, "origin_m": [0, 0], "joint": "smooth", "bridge": "bridge", "trace_length_m": 6, "gap_m": 1, "stagger": 0.4,
                   "dip_direction_deg": 70, "dip_scatter_deg": 4, "spacing_scatter": 0.2, "trace_scatter": 0.3, "seed": 5,
                   "region_m": [[-6, -3], [16, -3], [16, 9], [-6, 9]]},
                  {"dip_deg": -60, "spacing_m": 3, "origin_m": [0.3, 0], "persistence": 0.8, "trace_length_m": 8}],
    "joint_line": [{"from_m": [-7, -1], "to_m": [17, 3], "joint": "smooth", "bridge": "bridge"}],
    "fixed_line": [{"from_m": [-6, -3], "to_m": [16, -3]}, {"from_m": [16, -3], "to_m": [16, 9]}],
    "region": [{"material": "clay", "vertices_m": [[-7, -4], [17, -4], [17, -0.5], [-7, -0.5]]}],
    "strength_reduction": {"width": 1e-3},
    "step": {"dt_s": 2e-3},
}
# Keys that mean nothing alone, by table and key: what goes with them; None takes a key out that excludes them.
COMPANIONS = {
    "method.theta": {"integrator": "theta"},
    "method.rho_inf": {"integrator": "generalized_alpha"},
    "method.dissipation": {"integrator": "path_average"},
    "method.first_integrator": {"first_integrator_s": 0.015},
    "method.first_integrator_s": {"first_integrator": "tr_bdf2"},
    "strength_reduction.curve_time_s": {"definition": "large_displacements", "curve": [1, 2]},
    "strength_reduction.curve": {"definition": "large_displacements", "curve_time_s": 0.02},
    "joint_set.persistence": {"gap_m": None},
    "material.unit_weight_n_per_m3": {"density_kg_per_m3": None},
    "material.density_kg_per_m3": {"unit_weight_n_per_m3": None},
}


def of_rock(title: str, blocks: list[dict], joint: dict, **tables: dict) -> dict:
    joint = {"materials": ["rock", "rock"], "normal_stiffness_pa_per_m": 1e9} | joint
    return {"title": title, "material": [{"name": "rock", "density_kg_per_m3": 2500}], "joint": [joint], "block": [{"material": "rock"} | b for b in blocks]} | tables


def landing() -> dict:
    """A block comes down and may go a third of its way in a step: steps are parted until it has landed, and grow again."""
    blocks = [{"name": "ground", "vertices_m": [[-5, -1], [5, -1], [5, 0], [-5, 0]], "fixed": True},
              {"name": "block", "vertices_m": [[0, 0.33], [1, 0.33], [1, 1.33], [0, 1.33]], "velocity_m_per_s": [0.5, -3]}]
    return of_rock("landing", blocks, {"shear_stiffness_pa_per_m": 4e8, "friction_angle_deg": 30}, method={"start": "unloaded"},
                   step={"dt_s": 0.1, "max_displacement_m": 0.1}, end={"time_s": 0.3}, output={"every_s": 0.1})


def leaning_columns(columns: int, heights: list[float], gap: float, lean: float, width: float) -> dict:
    """Columns [m] that lean against a wall, with joints that are open by `gap`: where they close, places may be asked for that exclude each other."""
    def sheared(x0: float, x1: float, low: float, high: float) -> list[list[float]]:
        return [[x0 + lean * low, low], [x1 + lean * low, low], [x1 + lean * high, high], [x0 + lean * high, high]]

    end, top = columns * width, 20.0 + sum(heights)
    blocks = [{"name": "base", "vertices_m": [[-600.0, -30.0], [end, -30.0], [end, 0.0], [-600.0, 0.0]], "fixed": True},
              {"name": "wall", "vertices_m": sheared(end, end + 60.0, 0.0, top), "fixed": True}]
    for column in range(columns):
        low = 0.0
        for height in heights:
            vertices = sheared(column * width + 0.7 * gap, (column + 1) * width - 0.7 * gap, low + 0.5 * gap, low + height - 0.5 * gap)
            blocks.append({"name": str(len(blocks)), "vertices_m": vertices})
            low += height
    return of_rock("leaning columns", blocks, {"shear_stiffness_pa_per_m": 1e9, "friction_angle_deg": 40}, method={"contact": "hard", "start": "settled"},
                   step={"dt_s": 1e-3, "max_displacement_m": 1}, end={"time_s": 2e-3})


def closely_jointed_slope() -> dict:
    """The slope of example 3.4 with closer joints, in motion from the start: so many blocks that parts of it are solved for themselves."""
    scene = tomllib.loads((ROOT / "paper/scenes/example_3_4_post_failure.toml").read_text(encoding="utf-8"))
    joints = [joint | {"spacing_m": 0.7 * joint["spacing_m"]} for joint in scene["joint_set"]]
    kept = {key: value for key, value in scene.items() if key != "measured_point"}
    return kept | {"joint_set": joints, "method": {"start": "unloaded"}, "end": {"time_s": 0.05}, "output": {"every_s": 0.01}}


def wall_with_points() -> dict:
    """Points at corners: they move as their blocks turn, too."""
    scene = tomllib.loads((ROOT / "examples/retaining_blocks/scene.toml").read_text(encoding="utf-8"))
    corners = [(block["name"], corner) for block in scene["block"] for corner in block["vertices_m"][1:3]]
    return scene | {"measured_point": [{"name": f"{name} {i}", "block": name, "point_m": corner} for i, (name, corner) in enumerate(corners)]}


def shaken_late(size: float) -> dict:
    """A pile of blocks of this size [m] that has come to rest when the ground begins to move."""
    def rectangle(x0: float, x1: float, low: float, high: float) -> list[list[float]]:
        return [[size * x, size * y] for x, y in ((x0, low), (x1, low), (x1, high), (x0, high))]

    blocks = [{"name": "ground", "vertices_m": rectangle(-5, 5, -1, 0), "fixed": True}, *({"name": f"{i}", "vertices_m": rectangle(0, 2, i, i + 1)} for i in range(3))]
    joint = {"shear_stiffness_pa_per_m": 4e8, "friction_angle_deg": 30}
    scene = of_rock("shaken late", blocks, joint, method={"start": "settled"}, step={"dt_s": 0.01}, end={"time_s": 0.2}, output={"every_s": 0.01},
                    solver={"skip_resting": True}, rest={"time_s": 0.02})
    return scene | {"base_motion": MOTIONS["pulses"], "base_motion.pulse": [PULSES[0] | {"start_s": 0.1}]}


def shaken(kind: str) -> dict:
    return YARD | {"base_motion": MOTIONS[kind]} | ({"base_motion.pulse": PULSES} if kind == "pulses" else {})
