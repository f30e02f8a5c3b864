// In the motion of a large system a few contacts that change their states would make all blocks iterate. Between two iterations of the whole, the
// parts around them are solved for themselves (the nonlinear elimination of P. J. Lanzkron, D. J. Rose and J. T. Wilkes, 1996), so that the number of
// iterations of the whole does not grow with the system.
#pragma once

#include <vector>

#include "openclose/integrator/step_equations.h"

namespace openclose {

class Subdomains {
 public:
  /// The contacts of another step.
  void begin_step() { neighbourhood_.clear(); }
  /// Solves the parts around the largest residuals, each for itself, and moves solution.d on with those that got better unless the residual of the
  /// whole is larger then. Returns its norm.
  double solve(StepEquations& whole, StepSolution& solution, double norm);

  const LinearCounters& counters() const { return counters_; }
  const Memory& memory_of_parts() const { return memory_; }  ///< the largest of the last solve()
  std::size_t bytes() const { return neighbourhood_.bytes(); }
  void exchange(Archive& archive) { archive(counters_); }

 private:
  std::vector<Part> unbalanced_parts(const StepEquations& whole, double norm, double end);

  Neighbourhood neighbourhood_;  ///< of this step, once it is needed
  LinearCounters counters_;
  Memory memory_;
};

}  // namespace openclose
