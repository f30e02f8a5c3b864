// How far joints that weaken along their slip will weaken, before they have slipped so far.
//
// A state is balanced with the strength that the slips before it have left; its own slips d take more, the next state slips on, and so forth: a fixed
// point that is approached like a geometric series, slowly where the springs are hardly stiffer than the joints weaken. Less strength makes no joint
// slip less (to first order, as long as the same joints slide), so that the next slips are B d with a matrix B >= 0. Where each slip is at least rho
// times the one before, all that follow are together at least rho/(1 - rho) d (Collatz and Wielandt's bound): as much is taken at once, and never too
// much. What joints then really slip is counted against it. Once a joint has nothing more to lose, or another one slides, the series is another one:
// none is prolonged past that, and what has not been slipped when all is at rest is given back, which makes joints stronger and leaves the state what
// it is, in balance within its strength.
#pragma once

#include <cstddef>
#include <vector>

#include "openclose/statics/frozen_state.h"

namespace openclose {

class WeakeningPace {
 public:
  void restart(std::size_t contacts);
  /// To be called before lose_strength(): makes the slips of a state larger by what will follow them for sure.
  /// \param is_balanced  whether nothing but its strength keeps the state from being the last one; what moves has no pace
  void prolong(const FrozenStrength& strength, FrozenState& state, bool is_balanced);
  /// At rest: joints that still have something to lose lose no more than what they have slipped.
  /// \param closure_unit  [m]
  void give_back(double closure_unit, FrozenState& state);

 private:
  static bool breaks_any(const FrozenStrength& strength, const FrozenState& state, const std::vector<double>& slips, double pace);

  std::vector<double> last_;   ///< in closures: slips of the state before; empty if there is none
  std::vector<double> ahead_;  ///< in closures: slips that have been taken in advance
};

}  // namespace openclose
