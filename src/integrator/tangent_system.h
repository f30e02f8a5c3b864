// The matrix of a step and its solver. The pattern has the pairs of blocks in contact, open ones included; it stands while no new pair comes up, so
// that the symbolic work of the solver is seldom done.
#pragma once

#include "openclose/integrator/enforcement.h"

namespace openclose {

class TangentSystem {
 public:
  /// Makes room for the contacts of a step and finds their slots.
  /// \param rows  blocks with equations: they have the first places
  void fit(const MethodInput& method, int rows, const ContactTrial& contacts);
  /// The next fit() has nothing to do with the last one.
  void forget() { solver_ = nullptr; }

  const MatrixSlots& slots() const { return slots_; }
  BlockMatrix& matrix() { return matrix_; }
  /// False if the matrix is singular.
  /// \param kept_change  [-] see LinearSolver::factor()
  bool factor(double kept_change);
  /// By the last matrix that was factored; size 0 if it turns out to be singular only here.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction = full_reduction);
  /// Of what there is now, and of the largest factor since the solver was chosen.
  Memory memory() const;
  /// The pattern, which decides in which order the solver eliminates and so how it rounds; the symbolic work is done again after reading.
  void exchange(Archive& archive);
  LinearCounters counters() const { return solver_ ? solver_->counters() : LinearCounters(); }

 private:
  /// False if a pair of blocks has none.
  bool find_slots(const ContactTrial& contacts);
  void renew_pattern(const MethodInput& method, int rows, const ContactTrial& contacts);
  void set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings);

  BlockMatrix matrix_;
  MatrixSlots slots_;
  LinearSolverKind kind_ = LinearSolverKind::automatic;
  Factoring factoring_ = Factoring::needed;
  bool skip_symbolic_ = true;
  std::unique_ptr<LinearSolver> solver_;
  Memory solver_memory_;  ///< the largest
};

}  // namespace openclose
