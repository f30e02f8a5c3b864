#include "openclose/analysis/step_cuts.h"

#include <algorithm>
#include <cmath>

#include "openclose/analysis/corner_entry.h"
#include "openclose/analysis/solved_step.h"
#include "openclose/analysis/watch.h"
#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// A step that has been cut so often where corners enter, because the shorter one goes another way, is taken as it is: the next step finds what is
/// in.
constexpr int most_cuts_at_entry = 8;
/// [-] The same in statics, where a contact that is found with a penetration is pushed out however short the pseudo-time step is: a step whose way
/// has not become shorter than this by a cut.
constexpr double shorter_by_cut = 0.9;

/// [-] Of solver.gap_tolerance_m: rigid blocks that come to be deeper in each other within a step are met earlier. Half of what the watch lets pass.
constexpr double passing_of_tolerance = 0.5 * watch_bound::gap_tolerances;
constexpr double halved = 0.5;  ///< [-] part of a step

/// [-] Of the width of the narrower block: behind an edge that it is not in contact with, a corner at whose contact springs are to act may be four
/// times as deep at the end of a step (see corner_entry.cpp). A sixth of what the watch lets it close.
constexpr double unnoticed_part_of_width = 0.01;

/// [-] Of the energy that may be created in all: once this share has been, a step that creates more than the second share is cut. What the time
/// integration of a turning block makes of the force of an impact goes with the square of the step.
constexpr double share_before_cuts = 0.5, share_of_step = 0.02;
/// [-] Of the present kinetic energy: what may be created, where that is more than what has last been allowed.
constexpr double creatable_part_of_kinetic = 0.01;
/// What so many halvings do not cure is not of the step.
constexpr int most_cuts_for_energy = 6;

}  // namespace

double StepCuts::part_before_entry(const StepProblem& problem, const StepSolution& solution, const Enforcement& enforcement, double moved,
                                   const std::vector<std::pair<int, int>>& pairs) const {
  const bool is_elastic = enforcement.has_elastic_contacts();
  // Joints at rest give way by more than a corner that comes to one.
  if (problem.statics && is_elastic) return 1.0;
  const bool is_no_shorter = problem.statics && at_entry_ > 0 && moved > shorter_by_cut * way_at_entry_;
  if (is_no_shorter || at_entry_ == most_cuts_at_entry) return 1.0;
  if (is_elastic) {
    const EntryTolerance tolerance{tolerance::rounding_of_ways_m, unnoticed_part_of_width, enforcement.deepest_entry(problem.method)};
    return first_entry(problem.system, solution, pairs, tolerance, problem.contacts);
  }
  const double tolerated = std::max(problem.method.gap_tolerance, tolerance::rounding_of_ways_m);
  if (2.0 * moved <= tolerated) return 1.0;
  const double part = first_entry(problem.system, solution, pairs, {tolerated});
  return part == 1.0 && pass_into_each_other(problem.system, solution, pairs, passing_of_tolerance * tolerated) ? halved : part;
}

bool StepCuts::creates_energy(const StepProblem& problem, const StepSolution& solution, const Enforcement& enforcement, const EnergyLedger& before,
                              const EnergyLedger& of_step, double shortest) const {
  if (problem.statics || !std::isfinite(creatable_energy_) || for_energy_ == most_cuts_for_energy) return false;
  if (problem.dt * enforcement.step_cut(problem.method) < shortest) return false;
  EnergyLedger after = before;
  after += of_step;
  after.kinetic += kinetic_change(problem, solution);
  const double rise = after.mechanical() - before.mechanical(), above_lowest = after.mechanical() - lowest_energy_;
  const double allowed = std::max(creatable_energy_, creatable_part_of_kinetic * problem.system.kinetic_energy());
  const auto is_much = [&](double in_all, double in_step) { return in_all > share_before_cuts * allowed && in_step > share_of_step * allowed; };
  return is_much(above_lowest, rise) || is_much(-after.scheme, -of_step.scheme) || is_much(-after.impact, -of_step.impact);
}

}  // namespace openclose
