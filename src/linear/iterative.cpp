// The solver of large systems in motion, where inertia holds every block: GMRES with an incomplete factor, which costs in proportion to the number of
// blocks. At rest, where only the neighbours hold a block, it does not get there, and the matrices go to a direct solver.
#include <algorithm>
#include <cmath>
#include <utility>

#include "openclose/linear/incomplete.h"
#include "openclose/linear/refinement.h"
#include "openclose/linear/solver.h"

namespace openclose {
namespace {

/// [-] Times the root of the number of block rows: iterations that take as long as a factorisation row by row, whose work grows with the power 1.5 of
/// that number (measured 0.31, 0.30 and 0.35 at 1,773, 4,568 and 9,745 rows). Beyond, the direct solver is quicker.
constexpr double iterations_of_a_factorisation = 0.3;
/// After a try in vain so many matrices are factored at once before the next, twice as many after each further one, up to the most. Half as many
/// again after a success, and the first number after one at half the price.
constexpr int first_pause = 1;
constexpr int longest_pause = 64;

template <int N>
class IncompleteSolver : public LinearSolver<N> {
 public:
  IncompleteSolver(std::unique_ptr<LinearSolver<N>> direct, int smallest_system, Factoring factoring)
      : direct_(std::move(direct)), smallest_system_(smallest_system), incomplete_(factoring) {}

  bool factor(const BlockMatrix<N>& matrix, double kept_change) override {
    matrix_ = &matrix;
    kept_change_ = kept_change;
    use_direct_ = matrix.rows() < smallest_system_ || left_to_pause_ > 0;
    if (use_direct_) {
      left_to_pause_ = std::max(0, left_to_pause_ - 1);
      return factor_directly();
    }
    if (incomplete_.analyse(matrix)) {
      ++own_.symbolic;
    } else {
      ++own_.symbolic_skipped;
    }
    ++own_.incomplete;
    direct_->let_go();  // several times as large as what takes its place
    if (!incomplete_.factor(matrix)) return give_up();
    own_.rows += matrix.rows();
    own_.rows_kept += incomplete_.rows_kept();
    return count(true);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override { return solve(right_side, reduction, 0.0); }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double asked, double enough) override {
    const double reduction = std::max(asked, enough);
    if (!use_direct_) {
      Refined result = refine(*matrix_, incomplete_, right_side, start(right_side, reduction), reduction, most_iterations());
      own_.krylov_iterations += result.iterations;
      krylov_bytes_ = std::max(krylov_bytes_, bytes_of_basis(right_side, result.iterations));
      if (result.x) {
        ++own_.solves;
        pause_ = 2 * result.iterations <= most_iterations() ? first_pause : std::max(first_pause, pause_ / 2);
        count(true);
        return std::move(*result.x);
      }
      if (!give_up()) return {};
    }
    Eigen::VectorXd x = direct_->solve(right_side, asked, enough);
    count(true);
    return x;
  }

  Memory memory() const override {
    Memory of = direct_->memory();
    of.factor += incomplete_.bytes();
    of.krylov = std::max(of.krylov, krylov_bytes_);
    return of;
  }

  void let_rows_lag(bool lag) override { direct_->let_rows_lag(lag); }
  void use_threads(int threads) override { direct_->use_threads(threads); }

  void exchange(Archive& archive, const BlockMatrix<N>& matrix) override {
    LinearSolver<N>::exchange(archive, matrix);
    direct_->exchange(archive, matrix);
    incomplete_.exchange(archive, matrix);
    archive(own_, pause_, left_to_pause_);
  }

 private:
  int most_iterations() const { return static_cast<int>(std::ceil(iterations_of_a_factorisation * std::sqrt(matrix_->rows()))); }

  /// GMRES starts from nothing, or, to know what rounding leaves of the residual, from something of the size of the solution.
  Eigen::VectorXd start(const Eigen::VectorXd& right_side, double reduction) const {
    return reduction < above_rounding ? incomplete_.solve(right_side) : Eigen::VectorXd();
  }

  bool give_up() {
    ++own_.krylov_given_up;
    left_to_pause_ = pause_;
    pause_ = std::min(2 * pause_, longest_pause);
    use_direct_ = true;
    incomplete_.let_go();
    return factor_directly();
  }

  bool factor_directly() { return count(direct_->factor(*matrix_, kept_change_)); }

  /// Passes on what it is given.
  bool count(bool done) {
    this->counters_ = own_;
    this->counters_ += direct_->counters();
    return done;
  }

  std::unique_ptr<LinearSolver<N>> direct_;
  int smallest_system_;
  const BlockMatrix<N>* matrix_ = nullptr;
  double kept_change_ = 0.0;
  IncompleteLu<N> incomplete_;
  bool use_direct_ = false;
  int pause_ = first_pause, left_to_pause_ = 0;  ///< matrices
  std::size_t krylov_bytes_ = 0;
  LinearCounters own_;  ///< without those of the direct solver
};

}  // namespace

template <int N>
std::unique_ptr<LinearSolver<N>> make_incomplete_solver(std::unique_ptr<LinearSolver<N>> direct, int smallest_system, Factoring factoring) {
  return std::make_unique<IncompleteSolver<N>>(std::move(direct), smallest_system, factoring);
}

template std::unique_ptr<LinearSolver<3>> make_incomplete_solver<3>(std::unique_ptr<LinearSolver<3>>, int, Factoring);

}  // namespace openclose
