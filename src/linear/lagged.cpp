// The solver of large systems at rest: a multifrontal factor of an earlier matrix as preconditioner of GMRES for the present one. A factorisation
// costs as much as many solves (about 15 at 40,000 blocks), while from one Newton iteration or step to the next few contacts change: a factor serves
// until GMRES takes too long with it.
//
// Milliseconds of CPU time, first iteration of settling a slope with two joint sets (one core, SSE2):
//
//     free blocks                  387   1514   8386   40824   85333
//     row by row   factor         0.17   2.12   41.7     605    2958
//                  solve          0.01   0.13    3.0      23      57
//     fronts       order           0.3    0.9    4.7      26      63
//                  factor         0.34   2.50   29.0     280    1233
//                  solve          0.03   0.26    3.8      24      57
//                  bytes a block  1384   2018   3018    4072    4961
//
// Row by row has become three times as fast since, which is why it serves up to the limit in solver.cpp.
//
// Nested dissection by METIS instead of minimum degree: the same work at 8,000 and 40,000 blocks and 0.6 of it at 85,000, but five to eight times as
// long to order, for every new pattern.
#include <algorithm>
#include <optional>

#include "openclose/linear/multifrontal.h"
#include "openclose/linear/refinement.h"
#include "openclose/linear/solver.h"

namespace openclose {
namespace {

/// [-] A multiplication in a solve takes as long as so many in a factorisation, which works on dense matrices in cache while a solve waits for
/// memory.
constexpr double solve_slowness = 8.0;
/// A factor is renewed for the next matrix once the iterations with it, over what one solve takes anyway, have cost this part of a factorisation.
constexpr double patience = 1.0;
/// Where contacts change state by the thousand no factor serves twice: after a try in vain so many matrices are factored at once before the next,
/// twice as many after each further one, up to the most.
constexpr int first_pause = 1;
constexpr int longest_pause = 8;
/// With the factor of the matrix itself GMRES only makes up for lost digits of small pivots.
constexpr int refinements = 8;

template <int N>
class LaggedSolver : public LinearSolver<N> {
 public:
  explicit LaggedSolver(Refactor refactor) : lag_(refactor == Refactor::when_needed) {}

  bool factor(const BlockMatrix<N>& matrix, double) override {
    matrix_ = &matrix;
    use_plain_ = false;
    const bool usable = has_factor_ && factored_rows_ == matrix.rows();
    exact_ = false;
    if (lag_ && usable && spent_ < patience * budget() && left_to_pause_ == 0) return true;
    left_to_pause_ = std::max(0, left_to_pause_ - 1);
    return refactor();
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override {
    ++this->counters_.solves;
    if (use_plain_) return plain_->solve(right_side, reduction);
    if (!exact_) {
      if (std::optional<Eigen::VectorXd> x = iterate(right_side, reduction, static_cast<int>(budget()))) {
        ++this->counters_.factors_kept;
        pause_ = first_pause;
        return *x;
      }
      ++this->counters_.krylov_given_up;
      left_to_pause_ = pause_;
      pause_ = std::min(2 * pause_, longest_pause);
      if (!refactor()) return {};
      if (use_plain_) return plain_->solve(right_side, reduction);
    }
    if (std::optional<Eigen::VectorXd> x = iterate(right_side, reduction, refinements)) return *x;
    return factor_plainly() ? plain_->solve(right_side, reduction) : Eigen::VectorXd();
  }

  Memory memory() const override {
    Memory of = plain_ ? plain_->memory() : Memory();
    of.factor += lu_.bytes();
    of.krylov = krylov_bytes_;
    return of;
  }

  void let_go() override {
    if (lag_) return;  // later matrices are solved with it
    has_factor_ = exact_ = false;
    lu_.let_go();
  }

  void exchange(Archive& archive, const BlockMatrix<N>& matrix) override {
    LinearSolver<N>::exchange(archive, matrix);
    archive(lu_, has_factor_, factored_rows_, spent_, pause_, left_to_pause_);
  }

 private:
  double budget() const { return std::max(2.0, lu_.factor_work() / (solve_slowness * lu_.solve_work())); }

  bool refactor() {
    if (lu_.analyse(*matrix_)) {
      ++this->counters_.symbolic;
    } else {
      ++this->counters_.symbolic_skipped;
    }
    ++this->counters_.factorisations;
    has_factor_ = lu_.factor(*matrix_);
    exact_ = has_factor_;
    factored_rows_ = matrix_->rows();
    spent_ = 0.0;
    return has_factor_ || factor_plainly();
  }

  bool factor_plainly() {
    ++this->counters_.plain;
    if (!plain_) plain_ = make_sparse_solver<N>();
    use_plain_ = plain_->factor(*matrix_);
    return use_plain_;
  }

  /// Nothing if the residual is not brought down.
  std::optional<Eigen::VectorXd> iterate(const Eigen::VectorXd& right_side, double reduction, int most_iterations) {
    Refined result = refine(*matrix_, lu_, right_side, lu_.solve(right_side), reduction, most_iterations);
    this->counters_.krylov_iterations += result.iterations;
    krylov_bytes_ = std::max(krylov_bytes_, bytes_of_basis(right_side, result.iterations));
    if (!exact_) spent_ += result.iterations;
    return std::move(result.x);
  }

  bool lag_;
  const BlockMatrix<N>* matrix_ = nullptr;
  MultifrontalLu<N> lu_;
  bool has_factor_ = false;
  bool exact_ = false;  ///< the factor is that of the present matrix
  int factored_rows_ = 0;
  double spent_ = 0.0;                           ///< iterations with the factor
  int pause_ = first_pause, left_to_pause_ = 0;  ///< matrices
  bool use_plain_ = false;
  std::size_t krylov_bytes_ = 0;
  std::unique_ptr<LinearSolver<N>> plain_;
};

}  // namespace

template <int N>
std::unique_ptr<LinearSolver<N>> make_multifrontal_solver(Refactor refactor) {
  return std::make_unique<LaggedSolver<N>>(refactor);
}

template std::unique_ptr<LinearSolver<3>> make_multifrontal_solver<3>(Refactor);

}  // namespace openclose
