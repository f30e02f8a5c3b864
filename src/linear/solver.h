// Direct solvers for BlockMatrix behind one interface.
#pragma once

#include <memory>

#include "openclose/core/archive.h"
#include "openclose/linear/block_matrix.h"

namespace openclose {

struct LinearCounters {
  long symbolic = 0;
  long symbolic_skipped = 0;  ///< factorisations on a known pattern
  long factorisations = 0;
  long solves = 0;
  long plain = 0;  ///< factorisations that the block solver had to give to the plain one

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e] = *this;
    archive(a, b, c, d, e);
  }
};

template <int N>
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Factors the matrix; false if a pivot is zero or not finite. The symbolic part is kept while the pattern stands.
  virtual bool factor(const BlockMatrix<N>& matrix) = 0;
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& right_side) = 0;
  const LinearCounters& counters() const { return counters_; }
  void exchange(Archive& archive) { archive(counters_); }

 protected:
  LinearCounters counters_;
};

/// Dense LU with partial pivoting: cheapest for a handful of blocks.
template <int N>
std::unique_ptr<LinearSolver<N>> make_dense_solver();

/// Eigen's sparse LU with column ordering and exchange of rows: the plain reference for larger systems.
template <int N>
std::unique_ptr<LinearSolver<N>> make_sparse_solver();

/// LU of the blocks, without exchange between them, in an order of little fill; goes over to the plain one where a pivot has lost its digits.
/// \param wide_registers  false: only the instructions that every processor has, for comparison; the bits of the answer are the same
template <int N>
std::unique_ptr<LinearSolver<N>> make_block_solver(bool wide_registers = true);

/// The solver for a system of this many blocks.
template <int N>
std::unique_ptr<LinearSolver<N>> make_solver(int blocks);

}  // namespace openclose
