// LU factorisation of a block matrix without exchange of blocks, on the fill that the pattern leaves after an approximate minimum degree ordering of
// the block graph (factor_plan.h).
//
// Row by row (Duff, Erisman, Reid, Direct methods for sparse matrices, 2017, chapter 10): row i of the matrix is laid into the slots of row i of L
// and U, and the rows above are subtracted from it in ascending order. The pattern is symmetric, so that L has the transposed pattern of U. The
// diagonal blocks are inverted and the rows of U multiplied by these inverses (Crout's form), so that a row is subtracted as often as its block in L
// says; nothing is exchanged between blocks, which is safe while each block is held by its own inertia and contacts: where a pivot has lost its
// digits, the matrix is given to the plain solver, which exchanges rows.
//
// Single precision has been tried in a prototype: rows of U have six blocks on average (387 rows), so that half of the instructions are for fetching
// and not for products, and the elimination takes 0.9 of the time, which one refinement of each solution takes back.
//
// From matrix to matrix most rows stay as they are but for the turning of blocks. A row of the factor whose own row of the matrix has changed by no
// more than it may, and which subtracts only rows that are kept, is kept: the factor is always that of a matrix each of whose rows is as it was when
// it was last taken. Putting rows last that change in nearly every matrix gains nothing: those that change now and then lie anywhere. And weak
// couplings are left out of the factor (factor_plan.h): what they carry is found by iteration, whose residual they are.
#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/linear/factor_plan.h"
#include "openclose/linear/row_factor.h"
#include "openclose/linear/solver.h"

namespace openclose {
namespace {

/// [bytes] Before room is made for a larger factor, freed memory goes back to the system. For smaller ones that costs more time than the memory is
/// worth: 0.1 ms of finding it and touching it again.
constexpr std::size_t largest_factor_beside_holes_bytes = 4u << 20;

/// Iterations for the couplings left out, each of which leaves a part of the residual that is about their strength over the inertia of the blocks; in
/// motion two are enough for 1e-7. Where more are needed, these couplings are no weak ones.
constexpr int most_refinements = 6;
/// [-] Of the residual, at least. An iteration takes a tenth of one of Newton's method, of which there are 13 % more with 1e-5 and 1 % more with
/// this.
constexpr double refined_reduction = 1e-7;

class BlockLuSolver : public LinearSolver {
 public:
  explicit BlockLuSolver(Factoring factoring) : factoring_(factoring) {}

  bool factor(const BlockMatrix& matrix, double kept_change) override {
    matrix_ = &matrix;
    if (version_ != matrix.pattern_version()) {
      analyse(factored_slots(matrix, factoring_));
    } else {
      ++counters_.symbolic_skipped;
    }
    return factor_analysed(kept_change);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override {
    ++counters_.solves;
    return solve_once(right_side, reduction);
  }

  Memory memory() const override {
    Memory of = plain_ ? plain_->memory() : Memory();
    of.factor += factor_.bytes() + bytes_of(slots_, left_out_, working_place_);
    for (const std::vector<int>& place : working_place_) of.factor += bytes_of(place);
    return of;
  }

  void let_go() override {
    has_factor_ = use_plain_ = false;
    let_go_of_rows();
    plain_.reset();
  }

  void exchange(Archive& archive, const BlockMatrix& matrix) override {
    LinearSolver::exchange(archive, matrix);
    auto slots = exchange_slots(archive, matrix, version_ == matrix.pattern_version(), slots_);
    if (!slots) return;
    bool has_factor = has_factor_;
    archive(has_factor);
    if (archive.reading()) plan(matrix, std::move(*slots));
    if (has_factor) exchange_factor(archive);
  }

 private:
  /// What is stored is the matrix that it is the factor of.
  void exchange_factor(Archive& archive) {
    for (BlockMatrix::Block& block : factor_.taken) archive(block);
    if (!archive.reading()) return;
    for (int i = 0; i < factor_.rows(); ++i) note_scale(factor_, i);
    std::fill(factor_.stale.begin(), factor_.stale.end(), true);
    has_factor_ = eliminate();
  }

  bool factor_analysed(double kept_change) {
    ++counters_.factorisations;
    make_room();
    std::fill(factor_.stale.begin(), factor_.stale.end(), factoring_ == Factoring::whole || !has_factor_);
    counters_.rows += factor_.rows();
    counters_.rows_kept += take_changes(*matrix_, factor_, kept_change);
    has_factor_ = eliminate();
    use_plain_ = !has_factor_;
    if (has_factor_) return true;
    ++counters_.pivots_lost;
    let_go_of_rows();
    if (!plain_) plain_ = make_sparse_solver();
    return plain_->factor(*matrix_);
  }

  Eigen::VectorXd solve_once(const Eigen::VectorXd& right_side, double reduction) {
    if (use_plain_) return plain_->solve(right_side);
    Eigen::VectorXd x(right_side.size());
    substitute(right_side.data(), x.data());
    if (left_out_.empty() || refine(right_side, refined_to(reduction), x)) return x;
    return take_in() ? solve_once(right_side, reduction) : Eigen::VectorXd();
  }

  /// Where all digits are asked for, as many as a factor of the whole matrix gives.
  static double refined_to(double reduction) {
    return reduction > full_reduction ? std::min(reduction, refined_reduction) : std::numeric_limits<double>::epsilon();
  }

  /// Brings the residual, which is what the couplings left out carry, down to `wanted`. False if that takes too long.
  bool refine(const Eigen::VectorXd& right_side, double reduction, Eigen::VectorXd& x) {
    Eigen::VectorXd step = x, residual = right_side;
    const double wanted = reduction * right_side.norm();
    for (int iteration = 0; iteration <= most_refinements; ++iteration) {
      subtract_product(step, residual);
      if (residual.norm() <= wanted) return true;
      ++counters_.refinements;
      substitute(residual.data(), step.data());
      x += step;
    }
    return false;
  }

  /// Of the matrix and a step that the factor has found for the residual.
  void subtract_product(const Eigen::VectorXd& step, Eigen::VectorXd& residual) const {
    // To the last digit: the factor's part of the product is the residual.
    residual.setZero();
    for (const LeftOut& e : left_out_) residual.segment<dofs>(dofs * e.row) -= matrix_->value(e.slot) * step.segment<dofs>(dofs * e.column);
  }

  /// Factors anew with the couplings that have become strong, or, if there are none, with all. False if the matrix is singular.
  bool take_in() {
    ++counters_.couplings_taken_in;
    std::vector<char> slots = factored_slots(*matrix_, factoring_);
    if (slots == slots_) slots = factored_slots(*matrix_, Factoring::whole);
    analyse(std::move(slots));
    return factor_analysed(0.0);
  }

  /// False if a pivot has lost its digits.
  bool eliminate() {
    const int subtrees = static_cast<int>(factor_.subtrees.size()), panels = static_cast<int>(factor_.panels.size());
    std::atomic<bool> done = true;
    for_each_part(SharedWork::factorisation, threads_, subtrees, [&](int part) {
      if (!eliminate_rows(factor_, factor_.subtrees[part], 0, working_place_[part].data())) done = false;
    });
    for (int panel = 0; panel <= panels && done; ++panel) {
      if (panel > 0) done = eliminate_rows(factor_, factor_.panels[panel - 1], panel, working_place_[0].data());
      for_each_part(SharedWork::factorisation, threads_, panels - panel,
                    [&](int later) { advance(factor_, factor_.panels[panel + later], panel, working_place_[later].data()); });
    }
    return done;
  }

  void substitute(const double* right_side, double* x) {
    const int subtrees = static_cast<int>(factor_.subtrees.size());
    for_each_part(SharedWork::substitution, threads_, subtrees, [&](int part) { substitute_forward(factor_, factor_.subtrees[part], right_side); });
    for (const std::vector<int>& panel : factor_.panels) substitute_forward(factor_, panel, right_side);
    for (auto panel = factor_.panels.rbegin(); panel != factor_.panels.rend(); ++panel) substitute_back(factor_, *panel, x);
    for_each_part(SharedWork::substitution, threads_, subtrees, [&](int part) { substitute_back(factor_, factor_.subtrees[part], x); });
  }

  /// \param slots  of the matrix: whether the factor gets them
  void analyse(std::vector<char> slots) {
    ++counters_.symbolic;
    plan(*matrix_, std::move(slots));
  }

  void plan(const BlockMatrix& matrix, std::vector<char> slots) {
    version_ = matrix.pattern_version();
    has_factor_ = false;
    slots_ = std::move(slots);
    plan_factor(matrix, slots_, factor_, left_out_);
    make_room();
    factor_.taken.resize(factor_.entries.size());
    factor_.scale.assign(factor_.rows(), PaddedVector());
    factor_.stale.assign(factor_.rows(), true);
    working_place_.assign(std::max(factor_.subtrees.size(), factor_.panels.size()), std::vector<int>(factor_.rows()));
  }

  // One of the two is there at a time: pivots are seldom lost, and the plain factor is as large as the rows.
  void let_go_of_rows() { std::vector<PaddedBlock>().swap(factor_.value); }

  /// For the numbers of the factor.
  void make_room() {
    const std::size_t size = factor_.column.size();
    if (factor_.value.capacity() < size) {
      let_go_of_rows();  // else the old and the new ones would be there at once
      // Ordering and pattern have left holes too small for the factor.
      if (size * sizeof(PaddedBlock) > largest_factor_beside_holes_bytes) return_freed_memory();
    }
    factor_.value.resize(factor_.column.size());
  }

  Factoring factoring_;
  const BlockMatrix* matrix_ = nullptr;
  long version_ = -1;
  RowFactor factor_;
  bool has_factor_ = false;                      ///< of what it has taken
  std::vector<char> slots_;                      ///< of the matrix: whether the factor has them
  std::vector<LeftOut> left_out_;                ///< those that it has not
  std::vector<std::vector<int>> working_place_;  ///< for each part: slot of a column in the row under work
  bool use_plain_ = false;
  std::unique_ptr<LinearSolver> plain_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_block_solver(Factoring factoring) {
  return std::make_unique<BlockLuSolver>(factoring);
}

}  // namespace openclose
