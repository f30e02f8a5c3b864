// Whether a FrozenSystem stands at its present strength: an overdamped motion from a given state, in increments of falling viscosity (balance.h),
// until forces are in balance or the motion has become a mechanism.
#pragma once

#include "openclose/statics/balance.h"
#include "openclose/statics/frozen_solver.h"
#include "openclose/statics/weakening_pace.h"

namespace openclose {

/// How the increments are found.
enum class IncrementRule {
  newton,      ///< to the last digit
  open_close,  ///< as Shi's method does: passes with the friction of the pass before until no contact changes its state
};

class Relaxation : public FrozenSolver {
 public:
  Relaxation(const FrozenSystem& system, const FrozenStrength& strength, IncrementRule rule, int most_steps = default_most_steps)
      : system_(system), strength_(strength), rule_(rule), most_steps_(most_steps), balance_(system, strength) {}

  static constexpr int default_most_steps = 80;

  RelaxationResult bonded_state() override;
  using FrozenSolver::relax;
  RelaxationResult relax(const FrozenState& from, Effort effort) override;
  long linear_solves() const override { return balance_.counters().factorisations; }
  bool is_exhausted() const override;
  void exchange(Archive& archive) override { archive(balance_); }
  void set_interruption(std::function<void()> f) override { balance_.set_interruption(std::move(f)); }

 private:
  void accept(const Eigen::VectorXd& x, FrozenState& state, double eps);
  double weaken(FrozenState& state, SlipOfState slip);
  Eigen::VectorXd guess(const Eigen::VectorXd& velocity, double eps);
  bool solve(Eigen::VectorXd& x, bool is_first);
  bool ends_in_a_short_increment(const Eigen::VectorXd& velocity, RelaxationResult& result);
  bool ended(RelaxationResult& result, const Eigen::VectorXd& x);

  const FrozenSystem& system_;
  const FrozenStrength& strength_;
  IncrementRule rule_;
  int most_steps_;
  Balance balance_;
  WeakeningPace pace_;
};

}  // namespace openclose
