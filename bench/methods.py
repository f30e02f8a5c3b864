"""The ways to solve a scene that are compared, each a name and its settings."""

from dataclasses import dataclass

Settings = tuple[tuple[str, object], ...]


@dataclass(frozen=True)
class Method:
    name: str
    settings: Settings
    rigid: bool = False     # contacts that do not give: another reference
    adaptive: bool = False  # chooses its steps by a tolerance

    @property
    def explicit(self) -> bool:
        return ("method.contact", "dem") in self.settings


def _soft(integrator: str, *more: tuple[str, object]) -> Settings:
    return (("method.contact", "soft"), ("method.integrator", integrator), *more)


SOFT_SHI = Method("soft shi", _soft("shi"))
SOFT_PATH_AVERAGE = Method("soft path_average", _soft("path_average"))
INTEGRATORS = (
    SOFT_SHI,
    Method("soft theta 1/2", _soft("theta", ("method.theta", 0.5))),
    Method("soft generalized_alpha", _soft("generalized_alpha")),
    Method("soft tr_bdf2", _soft("tr_bdf2")),
    SOFT_PATH_AVERAGE,
)
# Their contacts found in the middle of the step.
AHEAD = tuple(Method(f"{method.name} looking ahead", (*method.settings, ("step.look_ahead", 0.5))) for method in (SOFT_SHI, SOFT_PATH_AVERAGE))
ADAPTIVE = tuple(Method(f"{method.name} adaptive", (*method.settings, ("step.adaptive", "true")), adaptive=True)
                 for method in (SOFT_SHI, SOFT_PATH_AVERAGE))
SOFT = Method("soft", (("method.contact", "soft"),))
HARD = Method("hard", (("method.contact", "hard"),), rigid=True)
SHI = Method("shi", (("method.contact", "shi"),))
DEM = Method("dem", (("method.contact", "dem"),))
# Contacts found anew after ten times the way: half of dem's time after failure goes into finding them.
WIDE_SKIN: Settings = (("solver.contact_skin_m", 0.01),)
DEM_WIDE = Method("dem, skin of 10 mm", (*DEM.settings, *WIDE_SKIN))
AHEAD_WIDE = tuple(Method(f"{m.name}, skin of 10 mm", (*m.settings, *WIDE_SKIN)) for m in AHEAD)
ADAPTIVE_AHEAD_WIDE = Method("soft shi adaptive looking ahead, skin of 10 mm",
                             (*ADAPTIVE[0].settings, ("step.look_ahead", 0.5), *WIDE_SKIN), adaptive=True)
# Steps that blocks of 20 m/s need not cut, and forces that balance to 1e-7 of the largest, which at 10,000 blocks is a thousand weights of a block:
# what is left accelerates it by 1e-4 g, now this way and now that.
LONG_WAYS: Settings = (("step.look_ahead", 0.5), *WIDE_SKIN, ("step.max_displacement_m", 0.3), ("solver.residual_tolerance", 1e-7),
                       ("settle.unbalanced_fraction", 2e-4))
# Rock that trembles under what falls on it is at rest.
COARSE_REST: Settings = (("rest.acceleration_m_per_s2", 3.0), ("rest.displacement_m", 1e-3))
# Shi's steps damp the waves that break bonds when the strength is lost.
FIRST_TR_BDF2: Settings = (("method.first_integrator", "tr_bdf2"), ("method.first_integrator_s", 0.5))
LONG = (
    Method("soft shi, long ways", (*SOFT_SHI.settings, *LONG_WAYS)),
    Method("soft shi, long ways, coarse rest", (*SOFT_SHI.settings, *LONG_WAYS, *COARSE_REST)),
    Method("soft tr_bdf2 first, then shi, long ways", (*SOFT_SHI.settings, *FIRST_TR_BDF2, *LONG_WAYS)),
    Method("soft tr_bdf2 first, then shi, long ways, coarse rest", (*SOFT_SHI.settings, *FIRST_TR_BDF2, *LONG_WAYS, *COARSE_REST)),
)
DEM_COARSE_REST = Method("dem, skin of 10 mm, coarse rest", (*DEM_WIDE.settings, *COARSE_REST))


def on_joint_springs(stiffness_pa_per_m: float) -> Method:
    """shi with the joint's springs for its penalty, so that it has the reference of the others, and room for them to give."""
    return Method("shi", (*SHI.settings, ("method.penalty_pa_per_m", stiffness_pa_per_m), ("method.penalty_shear_ratio", 1.0),
                          ("solver.penetration_tolerance_m", 1.0)))
