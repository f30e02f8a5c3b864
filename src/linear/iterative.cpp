// The solver of large systems in motion, where inertia holds every block: GMRES with an incomplete factor, which costs in proportion to the number of
// blocks. It waits for memory, and so works in single precision, again with what is left of the residual where that does not reach. At rest, where
// only the neighbours hold a block, it does not get there, and the matrices go to a direct solver.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/linear/factorisation_work.h"
#include "openclose/linear/incomplete.h"
#include "openclose/linear/krylov.h"
#include "openclose/linear/single_matrix.h"
#include "openclose/linear/solver.h"

namespace openclose {
namespace {

/// Iterations of GMRES that take as long as a factorisation, counted in blocks: an iteration multiplies each block of the matrix and of the
/// incomplete factor by a vector, and takes from it, and asks of the next one, its part of each direction before it: six products of numbers a row
/// beside the nine of a block. A block by a vector takes about as long as the product of two blocks in a factorisation, since both wait for memory
/// (6 to 8 ns beside 7 to 8 on slopes of 4,568 and 9,745 rows and a wall of 10,040).
///
/// \param products  of blocks, in the factorisation, less those of the incomplete one
int iterations_of_a_factorisation(double products, double blocks, int rows) {
  const double blocks_a_direction = 6.0 / 9.0 * rows;
  const double iterations = 2.0 * products / (blocks + std::sqrt(blocks * blocks + 2.0 * blocks_a_direction * products));
  return static_cast<int>(std::ceil(std::min<double>(iterations, dofs * rows)));  // after which GMRES is at its end
}

/// After a try in vain one matrix is factored at once before the next, twice as many after each further one, up to this many. Half as many
/// again after a success, and one after one at half the price.
constexpr int longest_pause = 64;
/// [-] The work of a factorisation is counted anew where the incomplete factor has become so many times larger or smaller. Of a matrix that grows,
/// all counts together cost no more than twice the last one.
constexpr double most_scaling = 2.0;
/// [-] Of a residual, as far as it is brought down in single precision at a time, at most and at least. Of 500 solves to 1e-5 of a failing slope of
/// 50,106 blocks half leave what the rotations say, nine tenths 1.01 times as much, the worst 11 times.
constexpr double most_of_single_precision = 1e-5, least_of_single_precision = 0.4;
/// [-] Of what is wanted, to be asked of the rotations.
constexpr double to_spare = 0.8;
/// [-] Of a residual; where more of it is left then, rounding outweighs the digits of single precision.
constexpr double slowest_decrease = 0.8;
/// [-] The residual may be this much larger than the rotations say, from rounding; beyond, the basis has lost its meaning.
constexpr double rounding_excess = 2.0;
/// [-] Rounding leaves less than this in a residual as long as the matrix is not singular to half of all digits.
constexpr double above_rounding = 1e-8;

/// What rounding leaves in the residual: units in the last place of the products in it.
double rounding_of_residual(const BlockMatrix& matrix, const Eigen::VectorXd& x) {
  double sum = 0.0;
  for (int i = 0; i < matrix.rows(); ++i) {
    double row = 0.0;
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) {
      row += matrix.value(s).norm() * x.segment<dofs>(dofs * matrix.column(s)).norm();
    }
    sum += row * row;
  }
  return tolerance::rounding_of_sums * std::sqrt(sum);
}

struct Refined {
  std::optional<Eigen::VectorXd> x;  ///< nothing if the residual is not brought down
  int iterations = 0;
};

class IncompleteSolver : public LinearSolver {
 public:
  IncompleteSolver(std::unique_ptr<LinearSolver> direct, int smallest_system, Factoring factoring)
      : direct_(std::move(direct)), smallest_system_(smallest_system), factoring_(factoring), incomplete_(factoring) {}

  bool factor(const BlockMatrix& matrix, double kept_change) override {
    matrix_ = &matrix;
    kept_change_ = kept_change;
    use_direct_ = matrix.rows() < smallest_system_ || left_to_pause_ > 0;
    if (use_direct_) {
      left_to_pause_ = std::max(0, left_to_pause_ - 1);
      return direct_->factor(*matrix_, kept_change_);
    }
    ++(incomplete_.analyse(matrix) ? counters_.symbolic : counters_.symbolic_skipped);
    ++counters_.incomplete;
    count_work();
    if (!incomplete_.factor(matrix)) return give_up();
    single_.take(matrix, incomplete_.order());
    counters_.rows += matrix.rows();
    counters_.rows_kept += incomplete_.rows_kept();
    return true;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override {
    if (!use_direct_) {
      Refined result = refine(right_side, reduction);
      counters_.krylov_iterations += result.iterations;
      if (result.x) {
        ++counters_.solves;
        const bool is_cheap = 2 * result.iterations <= most_iterations();
        pause_ = is_cheap ? 1 : std::max(1, pause_ / 2);
        if (is_cheap) direct_->let_go();  // several times as large as what has taken its place
        return std::move(*result.x);
      }
      if (!give_up()) return {};
    }
    return direct_->solve(right_side, reduction);
  }

  LinearCounters counters() const override { return LinearCounters(counters_) += direct_->counters(); }

  Memory memory() const override {
    Memory of = direct_->memory();
    of.factor += incomplete_.bytes() + single_.bytes();
    of.krylov = std::max(of.krylov, krylov_bytes_);
    return of;
  }

  void use_threads(int threads) override {
    direct_->use_threads(threads);
    single_.use_threads(threads);
  }

  void exchange(Archive& archive, const BlockMatrix& matrix) override {
    LinearSolver::exchange(archive, matrix);
    direct_->exchange(archive, matrix);
    incomplete_.exchange(archive, matrix);
    archive(pause_, left_to_pause_, counted_products_, counted_blocks_);
    archive.require(pause_ >= 1 && pause_ <= longest_pause && left_to_pause_ >= 0, "the saved state has a solver that there is not");
    // A factorisation of n rows takes no more than n^3 products, and the incomplete factor has a block of each row.
    const bool is_work = counted_blocks_ >= 0.0 && counted_products_ >= 0.0 && counted_products_ <= std::pow(counted_blocks_, 3);
    archive.require(is_work && std::isfinite(counted_products_), "the saved state has counted the work of no factorisation");
  }

 private:
  double stored_blocks() const { return static_cast<double>(incomplete_.stored_blocks()); }

  void count_work() {
    const double blocks = stored_blocks();
    if (blocks <= most_scaling * counted_blocks_ && most_scaling * blocks >= counted_blocks_) return;
    counted_blocks_ = blocks;
    counted_products_ = products_of_factorisation(*matrix_, factoring_);
  }

  /// Beyond, the direct solver is quicker. In the plane the work of a factorisation in an order of little fill grows with the power 1.5 of what is in
  /// the matrix (R. J. Lipton, D. J. Rose, R. E. Tarjan, Generalized nested dissection, SIAM J. Numer. Anal. 16 (1979)).
  int most_iterations() const {
    const double blocks = stored_blocks();
    const double products = blocks > 0.0 ? counted_products_ * std::pow(blocks / counted_blocks_, 1.5) : 0.0;
    return iterations_of_a_factorisation(std::max(0.0, products - static_cast<double>(incomplete_.products())),
                                         blocks + matrix_->row_start(matrix_->rows()), matrix_->rows());
  }

  /// GMRES in single precision, as often as it takes for the residual in double precision.
  Refined refine(const Eigen::VectorXd& right_side, double reduction) {
    Refined result;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(right_side.size()), residual = right_side;
    double size = residual.norm(), wanted = reduction * size;
    if (!std::isfinite(size)) return result;
    const bool is_one_go = reduction >= most_of_single_precision && reduction <= least_of_single_precision;
    // What rounding leaves beside one go would cost another one, a tenth of the iterations of 50,106 blocks; who asks for so little needs less.
    const double excess = is_one_go ? rounding_excess : 1.0;
    while (size > excess * wanted) {
      const KrylovStep found = step_in_single_precision(residual, size, wanted / size, most_iterations() - result.iterations);
      result.iterations += found.iterations;
      if (!found.converged) return result;
      add_in_order(found.step, size, incomplete_.order(), x);
      residual = right_side - matrix_->multiply(x);
      const double left = residual.norm();
      if (!(left <= slowest_decrease * size)) return result;
      size = left;
      if (reduction < above_rounding) wanted = std::max(wanted, rounding_of_residual(*matrix_, x));
    }
    result.x = std::move(x);
    return result;
  }

  /// Of a residual of this size, down to this part of it or as far as single precision goes.
  KrylovStep step_in_single_precision(const Eigen::VectorXd& residual, double size, double wanted, int most) {
    const double part = std::clamp(to_spare * wanted, most_of_single_precision, least_of_single_precision);
    // As many of the iterations as it is of the way.
    const int share = static_cast<int>(std::ceil(most * std::min(1.0, std::log(part) / std::log(to_spare * wanted))));
    KrylovStep found = krylov_step([&](const Eigen::VectorXf& v, Eigen::VectorXf& product) { single_.multiply(v, product); },
                                   [&](const Eigen::VectorXf& v, Eigen::VectorXf& product) { incomplete_.solve_in_order(v, product); },
                                   in_order(residual, size, incomplete_.order()), part, share, room_);
    krylov_bytes_ = std::max(krylov_bytes_, room_.bytes());
    return found;
  }

  bool give_up() {
    ++counters_.krylov_given_up;
    left_to_pause_ = pause_;
    pause_ = std::min(2 * pause_, longest_pause);
    use_direct_ = true;
    incomplete_.let_go();
    room_ = {};
    return direct_->factor(*matrix_, kept_change_);
  }

  std::unique_ptr<LinearSolver> direct_;
  int smallest_system_;
  const BlockMatrix* matrix_ = nullptr;
  double kept_change_ = 0.0;
  Factoring factoring_;
  IncompleteLu incomplete_;
  double counted_products_ = 0.0, counted_blocks_ = 0.0;  ///< of a direct factorisation, and stored in the incomplete one of the same matrix
  SingleMatrix single_;
  bool use_direct_ = false;
  int pause_ = 1, left_to_pause_ = 0;  ///< matrices
  KrylovRoom room_;
  std::size_t krylov_bytes_ = 0;
};

}  // namespace

std::unique_ptr<LinearSolver> make_incomplete_solver(std::unique_ptr<LinearSolver> direct, int smallest_system, Factoring factoring) {
  return std::make_unique<IncompleteSolver>(std::move(direct), smallest_system, factoring);
}

}  // namespace openclose
