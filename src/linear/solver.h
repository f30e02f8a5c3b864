// Solvers for BlockMatrix behind one interface.
#pragma once

#include <memory>

#include "openclose/core/archive.h"
#include "openclose/linear/block_matrix.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// [-] Residual of a solve over its right side where nothing less is asked for; rounding errors of the product of matrix and solution always pass.
inline constexpr double full_reduction = 1e-12;

struct LinearCounters {
  long symbolic = 0;
  long symbolic_skipped = 0;  ///< factorisations on a known pattern
  long factorisations = 0;
  long solves = 0;
  long plain = 0;              ///< factorisations that the solver had to give to the plain one
  long factors_kept = 0;       ///< matrices solved with the factor of an earlier one
  long krylov_iterations = 0;  ///< of GMRES
  long krylov_given_up = 0;    ///< solves with an earlier factor that were given up for a new one

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h] = *this;
    archive(a, b, c, d, e, f, g, h);
  }
};

template <int N>
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Factors the matrix, or keeps what is to be known of it; false if a pivot is zero or not finite. The symbolic part is kept while the pattern
  /// stands. The matrix must stay as it is until the last solve() with it.
  virtual bool factor(const BlockMatrix<N>& matrix) = 0;
  /// Nothing (size 0) if the matrix turns out to be singular only here.
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& right_side) = 0;
  const LinearCounters& counters() const { return counters_; }
  /// What the next solves depend on; the symbolic work is done again after reading.
  virtual void exchange(Archive& archive) { archive(counters_); }

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

/// When the multifrontal solver factors.
enum class Refactor {
  always,       ///< every matrix
  when_needed,  ///< once GMRES with the last factor takes too long
};

/// Multifrontal LU of supernodes, refined by GMRES: for large systems.
/// \param reduction  [-] of the Euclidean norm of the residual, in a solve
template <int N>
std::unique_ptr<LinearSolver<N>> make_multifrontal_solver(Refactor refactor, double reduction = full_reduction);

/// The solver for a system of this many blocks.
template <int N>
std::unique_ptr<LinearSolver<N>> make_solver(int blocks, LinearSolverKind kind = LinearSolverKind::automatic);

}  // namespace openclose
