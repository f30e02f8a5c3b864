// What an engineer asks beside a factor of safety at small displacements: what limit analysis says of the same blocks, and what the ratio of the
// joints' shear and normal stiffness, which is seldom known, does to the factor.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "openclose/analysis/frozen_limit.h"
#include "openclose/analysis/strength_search.h"
#include "openclose/limit_analysis/limit_analysis.h"
#include "openclose/statics/frozen_system.h"

namespace openclose {

/// Rigid-block limit analysis: an upper bound of every factor, or multiplier of a load, at small displacements.
struct LimitAnalysisResult {
  std::optional<double> factor;         ///< [-] the bound: a mechanism proves failure from there on; none where nothing fails, or everything
  std::string verdict;                  ///< in words, "found" where forces exist just below the factor
  int programs = 0;                     ///< linear programs
  std::optional<double> failed;         ///< [-] smallest factor at which failure is proved
  limit_analysis::Mechanism mechanism;  ///< there
  bool is_conclusive = false;           ///< no smaller bound is to be had, or it is proved that there is none
  bool no_equilibrium = false;          ///< proved: at any factor, or without the load that grows

  void exchange(Archive& archive);
};

/// \param upper_limit  [-] of the search
/// \param near         [-] a factor near which the answer may lie: it saves programs
/// \param interruption called now and then; may throw
LimitAnalysisResult limit_analysis_of(const Scene& scene, const FrozenSystem& system, double upper_limit, double near,
                                      const std::function<void()>& interruption = {}, LoneCorners lone_corners = LoneCorners::counted);

/// The factor if all joints had this ratio of shear to normal stiffness.
struct StiffnessEffect {
  double ratio = 0.0;  ///< [-]
  std::optional<double> stable, failed;

  void exchange(Archive& archive) {
    auto& [a, b, c] = *this;
    archive(a, b, c);
  }
};

/// A bracket as narrow as it was to be in one number; a wide or open one as it is, since its lower end alone would say too much.
std::string in_words(const StiffnessEffect& effect);

/// The ratios between which joints are found to lie.
inline constexpr double stiffness_ratios[] = {0.1, 1.0};
/// [-] Over the factor: what differs by less is not told apart.
inline constexpr double width_of_stiffness_effect = 0.01;

/// Whether its search ended undecided so far below the factor of the scene that it says nothing of the factor at its ratio.
bool is_unknown(const StiffnessEffect& effect, double factor);

/// True if all joints have this ratio already, so that the factor of the scene is the factor at it.
bool has_stiffness_ratio(const Scene& scene, double ratio);

/// By Newton's method, whatever the method of the scene.
/// \param ratio           [-] of shear to normal stiffness
/// \param factor          [-] of the scene with its own stiffness
/// \param proved_failure  [-] where no stiffness helps
/// \param interruption    called often; may throw
StiffnessEffect stiffness_effect(const Scene& scene, double ratio, double factor, std::optional<double> proved_failure,
                                 const std::function<void()>& interruption = {});

}  // namespace openclose
