// The search for equilibrium that a scene asks for with settle.criterion: the one place where it is chosen. A criterion is a class in equilibrium.cpp
// and a line in make_equilibrium_search().
//
// `unbalanced_force`: settle().
//
// `paper`, after section 3.4 of the reference paper: steps of step.dt in time, in which the motion is damped by the scheme and by friction only. The
// relative displacement of a step is the way of the farthest point of a block in it over half the height of the model (Shi's); the state is steady
// once it has stayed below settle.relative_displacement for settle.steady_steps steps in a row. One step alone tells nothing: a step from rest is
// g dt^2/2 long at most, whatever comes later, and swinging blocks stand still at their turning points. The first settling counts its steps. A trial
// with reduced strength goes on from the state that this left, velocities included, for twice that number of steps; it has failed if its last ones
// are not steady. It is watched to its end, because a slope that begins to fail moves slowly at first.
//
// `paper` with an explicit method is what the same section says of UDEC: settled once the largest unbalanced force is below
// settle.unbalanced_force_n, failed when settle.max_time_steps explicit steps have not brought it there, however far blocks have moved. Every
// settling has as many, and joints lose on the way what they have to lose.
//
// Steps from rest (statics) would make no sense here: with the paper's step of 1 ms none is longer than g dt^2/2 = 5e-6 m, failing or not.
#pragma once

#include <memory>
#include <string>

#include "openclose/analysis/settle.h"

namespace openclose {

class EquilibriumSearch {
 public:
  virtual ~EquilibriumSearch() = default;
  /// From the state the scene starts in; what this needed may be the measure of the trials.
  virtual SettleResult settle_first(const SettleProgress& progress) = 0;
  /// From a state in which settle_first() succeeded, with another strength of the joints.
  virtual SettleResult settle_trial(const SettleProgress& progress) = 0;
  /// Where the first settling stands after `progress` has thrown, and goes on from; null where it would have to begin anew.
  virtual SettleCourse* course() { return nullptr; }
  virtual void exchange(Archive&) {}  ///< the measure of the trials
  /// What a trial takes for resting though it moves on, in words; nothing where forces are in balance.
  virtual std::string unseen() const { return {}; }
};

/// The simulation must outlive the search.
std::unique_ptr<EquilibriumSearch> make_equilibrium_search(Simulation& simulation);

}  // namespace openclose
