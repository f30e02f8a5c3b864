// Solvers for BlockMatrix behind one interface.
#pragma once

#include <memory>

#include "openclose/core/archive.h"
#include "openclose/core/memory.h"
#include "openclose/linear/block_matrix.h"
#include "openclose/linear/factor_plan.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// [-] Residual of a solve over its right side where nothing less is asked for; rounding errors of the product of matrix and solution always pass.
inline constexpr double full_reduction = 1e-12;

struct LinearCounters {
  using Numbers = long;
  long symbolic = 0;
  long symbolic_skipped = 0;  ///< factorisations on a known pattern
  long factorisations = 0;
  long solves = 0;
  long pivots_lost = 0;         ///< factorisations row by row that the plain solver did again, with exchange of rows
  long krylov_iterations = 0;   ///< of GMRES
  long krylov_given_up = 0;     ///< solves with an incomplete factor that were given up for a direct one
  long incomplete = 0;          ///< incomplete factorisations, not counted in `factorisations`
  long rows = 0;                ///< block rows of all matrices that were to be factored row by row, incomplete factors included
  long rows_kept = 0;           ///< of these: as they were in the factor before
  long refinements = 0;         ///< solves for what weak couplings left of a residual, not counted in `solves`
  long couplings_taken_in = 0;  ///< factorisations done again because weak couplings were too strong for that

  LinearCounters& operator+=(const LinearCounters& other) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = *this;
    const auto& [a2, b2, c2, d2, e2, f2, g2, h2, i2, j2, k2, l2] = other;
    a += a2, b += b2, c += c2, d += d2, e += e2, f += f2, g += g2, h += h2, i += i2, j += j2, k += k2, l += l2;
    return *this;
  }
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Factors the matrix, or keeps what is to be known of it; false if a pivot is zero or not finite. The symbolic part is kept while the pattern
  /// stands. The matrix must stay as it is until the last solve() with it.
  /// \param kept_change  [-] what a solver has done for rows that have changed by no more it may keep: change of an entry over the root of the
  ///                     diagonal entries of its row and column. The solution is then that of a matrix which differs by so much.
  virtual bool factor(const BlockMatrix& matrix, double kept_change = 0.0) = 0;
  /// Nothing (size 0) if the matrix turns out to be singular only here.
  /// \param reduction  [-] of the Euclidean norm of the residual over that of the right side, at least, but for rounding: of 1e-5 and more single
  ///                   precision may leave twice as much. Factors of the matrix itself do not ask.
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction = full_reduction) = 0;
  virtual LinearCounters counters() const { return counters_; }
  /// Of the factors that there are now, and of the largest basis of GMRES so far.
  virtual Memory memory() const { return {}; }
  /// Gives back the memory of a factor that is not needed for a while; the next factor() starts anew. Not where later matrices are solved with it.
  virtual void let_go() {}
  /// That share the work where it is worth it; the results are the same to the last bit.
  virtual void use_threads(int threads) { threads_ = threads; }
  /// What the next solves depend on; the symbolic work is done again after reading.
  /// \param matrix  with the pattern that it had when it was factored last, or a newer one; it stays where it is
  virtual void exchange(Archive& archive, const BlockMatrix& /*matrix*/) { archive(counters_); }

 protected:
  LinearCounters counters_;
  int threads_ = 1;
};

/// Eigen's sparse LU with column ordering and exchange of rows: the plain reference for larger systems.
std::unique_ptr<LinearSolver> make_sparse_solver();

/// LU of the blocks, without exchange between them, in an order of little fill; goes over to the plain solver where a pivot has lost its digits.
std::unique_ptr<LinearSolver> make_block_solver(Factoring factoring = Factoring::needed);

/// GMRES with an incomplete factor of each matrix; those that this does not serve, and small ones, go to `direct`.
/// \param smallest_system  [-] block rows
std::unique_ptr<LinearSolver> make_incomplete_solver(std::unique_ptr<LinearSolver> direct, int smallest_system,
                                                     Factoring factoring = Factoring::needed);

/// A solver for estimates: the whole factor of a matrix, kept as whole numbers of 16 bits (see incomplete.h). Four to five digits of the solution are
/// right where the matrix is as well conditioned as groups of blocks that neighbours hold; solves read a fifth of the bytes of a factor in double
/// precision. Rows are eliminated in an order for narrow bands: for matrices of which only small groups of rows hang together. Where more digits are
/// needed, as for blocks that hold on to each other but to hardly anything else, it goes over to the solver with all of them.
std::unique_ptr<LinearSolver> make_estimating_solver();

/// The solver that serves every system, or the one asked for.
std::unique_ptr<LinearSolver> make_solver(LinearSolverKind kind = LinearSolverKind::automatic, Factoring factoring = Factoring::needed);

}  // namespace openclose
