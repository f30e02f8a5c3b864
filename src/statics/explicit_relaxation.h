// The distinct-element way to static equilibrium on a FrozenSystem: steps of central difference with local damping, the inertia of every block scaled
// to its springs so that all blocks share one critical step (density scaling; the end does not depend on it where forces are unique).
//
// What stands is found by these steps alone. What does not come to rest is judged by the viscous increments of relaxation.h, which bring a failing
// motion to the steady accelerations that prove it.
#pragma once

#include "openclose/statics/frozen_solver.h"
#include "openclose/statics/increment_packs.h"

namespace openclose {

class ExplicitRelaxation : public FrozenSolver {
 public:
  /// \param local_damping  [-] of the unbalanced force, against the motion
  ExplicitRelaxation(const FrozenSystem& system, const FrozenStrength& strength, double local_damping, long most_steps);

  RelaxationResult bonded_state() override;
  bool is_exhausted() const override { return steps_ >= 2 * most_steps_; }
  void exchange(Archive& archive) override { archive(steps_); }
  void set_interruption(std::function<void()> f) override { interruption_ = std::move(f); }
  using FrozenSolver::relax;
  RelaxationResult relax(const FrozenState& from, Effort effort) override;

 private:
  RelaxationResult settle(const FrozenState& from, ShearLaw law, Effort effort);
  /// Joints that stick where they have come to rest, but have gone farther on the way there than their springs could carry, have slid. (What waves do
  /// on the way counts for nothing: only where it ends.) Marks those that lose strength by it.
  void note_slip(const FrozenState& from, FrozenState& state) const;
  bool fails(const FrozenState& from, ShearLaw law, Effort effort, RelaxationResult& result) const;
  void begin(const FrozenState& from, ShearLaw law);
  void move(ShearLaw law, FrozenState& state);
  void read_contacts(FrozenState& state) const;

  const FrozenSystem& system_;
  const FrozenStrength& strength_;
  double local_damping_;
  long most_steps_;                   ///< of a state; of all together twice as many
  long steps_ = 0;                    ///< of all states so far
  std::vector<BlockVector> inertia_;  ///< by which one step of time is stable for every block
  IncrementPacks contacts_;
  Eigen::VectorXd velocity_, force_;  ///< three numbers a block and three for fixed ones
  std::vector<ContactStrength> strengths_;
  std::function<void()> interruption_;
};

}  // namespace openclose
