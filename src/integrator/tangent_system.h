// The matrix of a step and its solver. The pattern has the pairs of blocks in contact, open ones included; it stands while no new pair comes up, so
// that the symbolic work of the solver is seldom done.
#pragma once

#include "openclose/integrator/contact_batch.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

class TangentSystem {
 public:
  /// Makes room for the contacts of this step and finds their slots.
  void fit(const StepProblem& problem);
  /// The same, the slots in the order of the batches.
  void fit(const StepProblem& problem, const std::vector<ContactBatch>& contacts);

  /// The same for a system of `rows` blocks that has nothing to do with the last one.
  /// \param blocks    those with rows come first
  /// \param contacts  the blocks of each
  void fit_part(const MethodInput& method, int rows, int blocks, const std::vector<std::pair<int, int>>& contacts);

  const MatrixSlots& slots() const { return slots_; }
  BlockMatrix& matrix() { return matrix_; }
  /// False if the matrix is singular.
  /// \param kept_change  [-] see LinearSolver::factor()
  bool factor(double kept_change);
  /// By the last matrix that was factored; size 0 if it turns out to be singular only here.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction = full_reduction, double enough = 0.0);
  LinearSolver& solver() { return *solver_; }
  /// Of what there is now, and of the largest factor since the solver was chosen.
  Memory memory() const;
  /// The pattern, which decides in which order the solver eliminates and so how it rounds; the symbolic work is done again after reading.
  void exchange(Archive& archive);
  LinearCounters counters() const { return solver_ ? solver_->counters() : LinearCounters(); }

 private:
  template <class BlocksOf>
  void fit_pattern(const StepProblem& problem, const BlocksOf& blocks_of);
  /// False if a pair of blocks has none.
  /// \param blocks_of  the two blocks of a contact
  template <class BlocksOf>
  bool find_slots(std::size_t count, const BlocksOf& blocks_of);
  template <class BlocksOf>
  void renew_pattern(const MethodInput& method, int rows, std::size_t count, const BlocksOf& blocks_of);
  void set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings);
  void choose_solver(int rows);

  BlockMatrix matrix_;
  MatrixSlots slots_;
  std::vector<int> row_of_;  ///< by block, negative without
  LinearSolverKind kind_ = LinearSolverKind::automatic;
  Factoring factoring_ = Factoring::needed;
  bool skip_symbolic_ = true;
  static constexpr int no_solver = -1;
  int solver_rows_ = no_solver;  ///< of the first matrix, by which the solver was chosen: blocks may come to rest since
  std::unique_ptr<LinearSolver> solver_;
  Memory solver_memory_;  ///< the largest
};

}  // namespace openclose
