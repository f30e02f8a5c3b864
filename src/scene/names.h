// The words of the scene file that stand for the values of an enumeration. A new value is one line here.
#pragma once

#include <array>
#include <string_view>

#include "openclose/scene/domain.h"
#include "openclose/scene/limits.h"
#include "openclose/scene/scene.h"

namespace openclose {

inline constexpr std::array base_motion_words{
    Word{"pulses", BaseMotionKind::pulses},
    Word{"harmonic", BaseMotionKind::harmonic},
    Word{"record", BaseMotionKind::record},
};

inline constexpr std::array cohesion_behaviour_words{
    Word{"ductile", CohesionBehaviour::ductile},
    Word{"lost_on_opening", CohesionBehaviour::lost_on_opening},
    Word{"lost_on_slip", CohesionBehaviour::lost_on_slip},
};

inline constexpr std::array enclosed_joints_words{
    Word{"refuse", EnclosedJoints::refuse},
    Word{"drop", EnclosedJoints::drop},
};

inline constexpr std::array linear_solver_words{
    Word{"automatic", LinearSolverKind::automatic},
    Word{"direct", LinearSolverKind::direct},
    Word{"iterative", LinearSolverKind::iterative},
    Word{"plain", LinearSolverKind::plain},
};

inline constexpr std::array mass_damping_words{
    Word{"none", MassDamping::none},
    Word{"local", MassDamping::local},
    Word{"automatic", MassDamping::automatic},
};

inline constexpr std::array rotation_words{
    Word{"exact", RotationKind::exact},
    Word{"linear", RotationKind::linear},
};

inline constexpr std::array settle_criterion_words{
    Word{"unbalanced_force", SettleCriterion::unbalanced_force},
    Word{"paper", SettleCriterion::paper},
};

inline constexpr std::array factor_definition_words{
    Word{"small_displacements", FactorDefinition::small_displacements},
    Word{"joint_closures", FactorDefinition::joint_closures},
    Word{"large_displacements", FactorDefinition::large_displacements},
};

inline constexpr std::array static_solver_words{
    Word{"automatic", StaticSolver::automatic},
    Word{"newton", StaticSolver::newton},
    Word{"relaxation", StaticSolver::relaxation},
};

inline constexpr std::array start_words{
    Word{"unloaded", Start::unloaded},
    Word{"settled", Start::settled},
    Word{"normal_balanced", Start::normal_balanced},
    Word{"steady_sliding", Start::steady_sliding},
};

/// The word for a value; every value has one.
template <typename Words, typename Enum>
constexpr std::string_view word_for(const Words& words, Enum value) {
  for (const auto& word : words) {
    if (word.value == value) return word.text;
  }
  return {};
}

}  // namespace openclose
