// Why a step that has been solved is done again with a part of its length: a corner enters a block that it is not in contact with, or the step
// creates energy where much has been created already.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "openclose/analysis/energy_ledger.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

class StepCuts {
 public:
  /// [-] Part of the step after which a corner has entered a block that it is not in contact with by what is tolerated, see first_entry(); 1 if there
  /// is none, or where a shorter step would not help.
  /// \param moved  [m] largest_move() of the step
  /// \param pairs  of blocks that may touch
  double part_before_entry(const StepProblem& problem, const StepSolution& solution, const Enforcement& enforcement, double moved,
                           const std::vector<std::pair<int, int>>& pairs) const;
  /// Whether the step creates energy where much has been created already, see allow_energy(). What cannot be cut is taken; whether it was too much is
  /// for the watch to say.
  /// \param shortest  [s] steps are not cut to less
  bool creates_energy(const StepProblem& problem, const StepSolution& solution, const Enforcement& enforcement, const EnergyLedger& before,
                      const EnergyLedger& of_step, double shortest) const;

  /// [J] What may be created in all. Once half of it has been, steps that go on creating energy are cut.
  void allow_energy(double energy) { creatable_energy_ = energy; }
  void cut_at_entry(double moved) {
    ++at_entry_;
    way_at_entry_ = moved;
  }
  void cut_for_energy() { ++for_energy_; }
  /// Cuts since the last step that was accepted.
  bool has_cut_at_entry() const { return at_entry_ > 0; }
  /// Another state is begun with.
  void forget() { at_entry_ = for_energy_ = 0; }
  void accept(const EnergyLedger& ledger) {
    forget();
    lowest_energy_ = std::min(lowest_energy_, ledger.mechanical());
  }
  void restart_ledger() { lowest_energy_ = 0.0; }
  void exchange(Archive& archive) { archive(at_entry_, for_energy_, lowest_energy_, creatable_energy_); }

 private:
  int at_entry_ = 0, for_energy_ = 0;
  double way_at_entry_ = 0.0;                                          ///< [m] of the farthest vertex in the last step that was cut there
  double creatable_energy_ = std::numeric_limits<double>::infinity();  ///< [J] see allow_energy()
  double lowest_energy_ = 0.0;                                         ///< [J] mechanical, against that at the start
};

}  // namespace openclose
