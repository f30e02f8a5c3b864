"""What the scenes of the slopes have in common: one rock, one joint, gravity, a step. SI units; angles in degrees where the name says so."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class JointedRock:
    unit_weight: float
    gravity: float
    friction_angle_deg: float
    cohesion: float
    tensile_strength: float
    normal_stiffness: float
    shear_stiffness: float
    dt: float

    @staticmethod
    def of(scene: dict) -> "JointedRock":
        joint = scene["joint"][0]
        return JointedRock(
            unit_weight=scene["material"][0]["unit_weight_n_per_m3"],
            gravity=math.hypot(*scene["gravity_m_per_s2"]),
            friction_angle_deg=joint["friction_angle_deg"],
            cohesion=joint["cohesion_pa"],
            tensile_strength=joint["tensile_strength_pa"],
            normal_stiffness=joint["normal_stiffness_pa_per_m"],
            shear_stiffness=joint["shear_stiffness_pa_per_m"],
            dt=scene["step"]["dt_s"],
        )
