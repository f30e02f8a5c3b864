#include "openclose/analysis/second_opinion.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "openclose/analysis/frozen_trials.h"

namespace openclose {
namespace {

/// [-] The bound lies above what a path has reached, often by less than a bracket and seldom by more than a tenth: tried first and next.
constexpr double first_above = 1.002;
constexpr double ratio_above = 1.1;
constexpr double first_of_effect = 0.8;  ///< [-] of the smaller of 1 and the factor: where gravity acts first. Loads grow from 0

}  // namespace

void LimitAnalysisResult::exchange(Archive& archive) {
  std::vector<Eigen::Vector3d> motion;
  for (const limit_analysis::BlockVelocity& v : mechanism) motion.emplace_back(v.velocity.x(), v.velocity.y(), v.rotation);
  archive(factor, verdict, programs, failed, motion, is_conclusive, no_equilibrium);
  mechanism.clear();
  for (const Eigen::Vector3d& m : motion) mechanism.push_back({m.head<2>(), m[2]});
}

LimitAnalysisResult limit_analysis_of(const Scene& scene, const FrozenSystem& system, double upper_limit, double near,
                                      const std::function<void()>& interruption, LoneCorners lone_corners) {
  using Verdict = limit_analysis::Bracket::Verdict;
  LimitAnalysisResult result;
  limit_analysis::Options options;
  options.upper_limit = std::max(options.upper_limit, 2.0 * upper_limit);
  if (system.has_live_load()) options.lower_limit = smallest_multiplier(system);
  if (near > 0.0) options.first = first_above * near;
  options.ratio = ratio_above;
  options.interruption = interruption;
  try {
    const limit_analysis::Problem problem = limit_problem(system, FrozenStrength(system, scene), lone_corners);
    limit_analysis::Bracket bracket = limit_analysis::limit_analysis(problem, options);
    result.programs = bracket.programs;
    result.verdict = bracket.found() ? "found" : bracket.reason;
    result.is_conclusive = bracket.verdict != Verdict::undecided;
    result.no_equilibrium = bracket.verdict == Verdict::no_equilibrium;
    if (!bracket.mechanism.empty()) {
      // Forces hold at the other end of the bracket: an end from below is no bound.
      if (!result.no_equilibrium) result.factor = bracket.failed;
      result.failed = bracket.failed;
      result.mechanism = std::move(bracket.mechanism);
    }
  } catch (const std::invalid_argument& error) {
    result.verdict = error.what();
  }
  return result;
}

namespace {

/// From the factor of the scene's own stiffness up or down in growing steps, until one trial stands and the next does not.
class EffectSearch {
 public:
  /// \param first  [-] the factor at which gravity acts
  /// \param upper  [-] as far as the search of the scene's own stiffness goes
  EffectSearch(StrengthTrials& trials, double ratio, double first, double factor, double upper, std::optional<double> proved_failure)
      : trials_(trials), first_(first), factor_(factor), upper_(std::max(upper, factor)), proved_failure_(proved_failure) {
    effect_.ratio = ratio;
  }

  StiffnessEffect run() {
    if (trials_.first(first_).outcome != TrialOutcome::stable) return effect_;
    effect_.stable = first_;
    double step = width_of_stiffness_effect;
    if (stands(factor_)) {
      while (*effect_.stable < upper_ && stands(std::min(factor_ * (1.0 + step), upper_))) step *= 2.0;
    } else {
      while (factor_ * (1.0 - step) > first_ && !stands(factor_ * (1.0 - step))) step *= 2.0;
    }
    return effect_;
  }

 private:
  bool stands(double srf) {
    if (proved_failure_ && srf >= *proved_failure_) {
      effect_.failed = *proved_failure_;
      return false;
    }
    const TrialOutcome outcome = trials_.next(srf, OnBreak::go_on).outcome;
    if (outcome == TrialOutcome::stable) effect_.stable = srf;
    if (outcome == TrialOutcome::failed) effect_.failed = srf;
    return outcome == TrialOutcome::stable;
  }

  StrengthTrials& trials_;
  double first_, factor_, upper_;
  std::optional<double> proved_failure_;
  StiffnessEffect effect_;
};

}  // namespace

std::string in_words(const StiffnessEffect& effect) {
  if (!effect.stable) return "no equilibrium found";
  if (!effect.failed) return fmt::format("at least {:.4g}", *effect.stable);
  const bool is_narrow = *effect.failed - *effect.stable <= 2.0 * width_of_stiffness_effect * *effect.stable;
  return is_narrow ? fmt::format("{:.4g}", *effect.stable) : fmt::format("between {:.4g} and {:.4g}", *effect.stable, *effect.failed);
}

bool is_unknown(const StiffnessEffect& effect, double factor) {
  return effect.stable && !effect.failed && *effect.stable < (1.0 - 0.5 * width_of_stiffness_effect) * factor;
}

bool has_stiffness_ratio(const Scene& scene, double ratio) {
  return std::ranges::all_of(scene.joints, [&](const JointProperties& joint) { return joint.shear_stiffness == ratio * joint.normal_stiffness; });
}

StiffnessEffect stiffness_effect(const Scene& scene, double ratio, double factor, std::optional<double> proved_failure,
                                 const std::function<void()>& interruption) {
  Scene other = scene;
  other.method.contact = "soft";
  for (JointProperties& joint : other.joints) joint.shear_stiffness = ratio * joint.normal_stiffness;
  FrozenSystem system(other);
  FrozenTrials trials(other, system);
  trials.solver().set_interruption(interruption);
  trials.reduce_effort();  // a bracket of a per cent, and what it cannot decide says no more than that
  const double first = system.has_live_load() ? 0.0 : first_of_effect * std::min(1.0, factor);
  return EffectSearch(trials, ratio, first, factor, scene.strength_reduction.upper_limit, proved_failure).run();
}

}  // namespace openclose
