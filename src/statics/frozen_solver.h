// How a method finds out whether a FrozenSystem stands.
#pragma once

#include <functional>

#include "openclose/statics/certificate.h"

namespace openclose {

enum class RelaxationEnd {
  stable,     ///< equilibrium, proved by its forces
  mechanism,  ///< failure, proved by forces and accelerations
  escaped,    ///< blocks have gone too far without becoming steady: no proof
  undecided,  ///< no increment was found, or too many were needed
};

struct RelaxationResult {
  RelaxationEnd end = RelaxationEnd::undecided;
  FrozenState state;          ///< where it ended
  Eigen::VectorXd mechanism;  ///< direction of the accelerations, three numbers a block, the largest 1; if it ended so
  long steps = 0;
  double travel = 0.0;  ///< in closures, of any component of a block's motion
};

/// How much work a state is worth before it stays undecided.
enum class Effort {
  full,
  reduced,  ///< a third, which suffices for 19 of 20 states that end at all
};

inline constexpr long share_of(Effort effort, long most) {
  return effort == Effort::full ? most : most / 3;
}

class FrozenSolver {
 public:
  virtual ~FrozenSolver() = default;
  /// The state of blocks whose joints neither slip nor open in shear, springs unloaded before: gravity on the intact rock. Not stable only where no
  /// strength of the joints in shear could hold the blocks.
  virtual RelaxationResult bonded_state() = 0;
  /// From a state, at the present strength.
  virtual RelaxationResult relax(const FrozenState& from, Effort effort) = 0;
  RelaxationResult relax(const FrozenState& from) { return relax(from, Effort::full); }
  virtual long linear_solves() const { return 0; }
  /// Whether so much work has been done that what is undecided may stay so.
  virtual bool is_exhausted() const = 0;
  /// What it remembers from one state to the next.
  virtual void exchange(Archive&) {}
  /// Called often, a fraction of a second apart; may throw to end the work. Nothing is to be asked of the solver after that.
  virtual void set_interruption(std::function<void()> f) = 0;
};

}  // namespace openclose
