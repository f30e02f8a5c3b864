// The distinct-element way to static equilibrium on a FrozenSystem: steps of central difference with local damping, the inertia of every block scaled
// to its springs so that all blocks share one critical step (density scaling; the end does not depend on it where forces are unique).
//
// What stands is found by these steps alone. What does not come to rest is judged by the viscous increments of relaxation.h, which bring a failing
// motion to the steady accelerations that prove it.
#pragma once

#include "openclose/statics/frozen_solver.h"

namespace openclose {

class ExplicitRelaxation : public FrozenSolver {
 public:
  /// \param local_damping  [-] of the unbalanced force, against the motion
  ExplicitRelaxation(const FrozenSystem& system, const FrozenStrength& strength, double local_damping, long most_steps);

  RelaxationResult bonded_state() override;
  RelaxationResult relax(const FrozenState& from) override;

 private:
  enum class ShearBound { strength, none };
  RelaxationResult settle(const FrozenState& from, ShearBound bound);
  /// Joints that stick where they have come to rest, but have gone farther on the way there than their springs could carry, have slid. (What waves do
  /// on the way counts for nothing: only where it ends.) Marks those that lose strength by it.
  void note_slip(const FrozenState& from, FrozenState& state) const;
  bool fails(const FrozenState& from, RelaxationResult& result) const;
  void move(FrozenState& state, ShearBound bound);

  const FrozenSystem& system_;
  const FrozenStrength& strength_;
  double local_damping_;
  long most_steps_;
  std::vector<BlockVector> inertia_;  ///< by which one step of time is stable for every block
  std::vector<BlockVector> velocity_;
  std::vector<ContactStrength> strengths_;
};

}  // namespace openclose
