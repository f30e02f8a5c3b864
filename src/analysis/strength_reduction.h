// Factor of safety by strength reduction: the largest factor by which tan(phi), c and the tensile strength can be divided so that the system still
// stands. What stands and fails means is strength_reduction.definition:
//   small_displacements  the drawn geometry; both ends of the bracket are proved (frozen_trials.h)
//   joint_closures       the same on the geometry that the joints' closures under gravity leave
//   large_displacements  blocks move; stable is what settles, failed what moves beyond settle.failure_displacement_m (settling_trials.h)
//
// With strength_reduction.increase the strength stays, and the factor is the multiplier of a load, see increased_load.h: the largest for which the
// system stands, at small displacements.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "openclose/analysis/loose_motion.h"
#include "openclose/analysis/run.h"
#include "openclose/analysis/second_opinion.h"
#include "openclose/analysis/strength_search.h"

namespace openclose {

/// Displacement after a stated time of motion with reduced strength, from the settled state.
struct CurvePoint {
  double srf = 1.0;
  std::string point;
  double displacement = 0.0;  ///< [m]

  void exchange(Archive& archive) {
    auto& [a, b, c] = *this;
    archive(a, b, c);
  }
};

enum class FactorVerdict {
  certified,       ///< a stable and a failed factor, no farther apart than asked for
  interval,        ///< farther apart, or without a failed one
  no_failure,      ///< stable up to the limit of the search
  no_equilibrium,  ///< failed down to the smallest factor, of a multiplier 0
  undecided,       ///< no stable state found
};

/// What is searched, in words: the factor of safety, or the multiplier of the load that strength_reduction.increase names.
std::string name_of_answer(const std::optional<std::string>& increase);
/// The name of its values in tables of results.
const char* column_of_answer(const std::optional<std::string>& increase);

/// As summary.json has it.
const char* factor_verdict_word(FactorVerdict verdict);

/// Blocks as they are to be drawn, with the forces between them.
struct NamedState {
  std::string name;
  BlockSystem system;
  std::vector<Contact> contacts;
  bool is_mechanism = false;  ///< moved by velocities as if they were displacements: to first order, so that what turns as one body stays joined
};

struct FactorOfSafety {
  FactorVerdict verdict = FactorVerdict::undecided;
  StrengthBracket bracket;
  std::string reason;  ///< in words, unless certified
  std::vector<std::string> warnings;
  std::vector<StrengthTrial> trials;
  std::vector<CurvePoint> curve;
  std::vector<NamedState> states;
  std::vector<FailingBlock> mechanism;  ///< blocks that move faster than a hundredth of the fastest
  std::optional<LimitAnalysisResult> limit_analysis;
  std::vector<StiffnessEffect> stiffness_effects;
  std::optional<double> largest_travel;  ///< [m] between two stable states of the search, of any point of a block
  long linear_solves = 0;                ///< at small displacements

  /// Whether the factor can be used: a stable end, and a failed one or the limit of the search.
  bool found() const { return bracket.stable && verdict != FactorVerdict::undecided && verdict != FactorVerdict::no_equilibrium; }
  double stable() const { return bracket.stable.value_or(0.0); }
  double failed() const { return bracket.failed.value_or(0.0); }
};

/// What a search tells while it goes on.
struct SearchObserver {
  std::function<void(double fraction)> progress;  ///< may throw Stopped: what is known by then is the answer
  std::function<void(std::string state)>
      done;  ///< after every trial and other piece of work, with all that is known: resume_search() goes on from it
  std::function<void(const StrengthTrial& trial)> trial = {};  ///< after every trial of the search, also those that a restart already has
  std::function<void()> interruption = {};                     ///< called a fraction of a second apart; may throw Stopped, too
};

FactorOfSafety factor_of_safety(Simulation& simulation, const SearchObserver& observer);
FactorOfSafety factor_of_safety(Simulation& simulation, const std::function<void(double fraction)>& progress = {});

/// Goes on, bit for bit, from the state that an observer was given, in a simulation of the same scene that has not been used. Throws DamagedState if
/// the state does not fit the scene.
FactorOfSafety resume_search(Simulation& simulation, const SearchObserver& observer, std::string state);

}  // namespace openclose
