// LU factorisation of a block matrix without exchange of blocks, on the fill that the pattern leaves after an approximate minimum degree ordering of
// the block graph (P. R. Amestoy, T. A. Davis, I. S. Duff 1996; Eigen's implementation).
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
// The rows above that row i subtracts lie below it in the elimination tree (J. W. H. Liu, The role of elimination trees in sparse factorization, SIAM
// J. Matrix Anal. Appl. 11 (1990)). Large systems are therefore cut into subtrees, which do not depend on each other, and the rows where these meet,
// the top. A row of the top subtracts those of the subtrees first and then, panel by panel, those of the top; with one panel done, the rows of all
// later ones can subtract it at the same time. The cut depends on the pattern alone, so that the number of threads changes no digit.
//
// From matrix to matrix most rows stay as they are but for the turning of blocks. A row of the factor whose own row of the matrix has changed by no
// more than it may, and which subtracts only rows that are kept, is kept: the factor is always that of a matrix each of whose rows is as it was when
// it was last taken. Putting rows last that change in nearly every matrix gains nothing: those that change now and then lie anywhere. And weak
// couplings are left out of the factor (weak_couplings.h): what they carry is found by iteration, whose residual they are.
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "openclose/core/packs.h"
#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/linear/solver.h"
#include "openclose/linear/weak_couplings.h"

namespace openclose {
namespace {

/// [-] A diagonal block whose norm has shrunk by more than this, or whose determinant is smaller than this times the product of its columns' norms,
/// has lost more digits than a Newton step can do without.
constexpr double smallest_pivot = 1e-11;

/// [-] Rows from which on the work is cut into parts. Below, a part takes less than the few microseconds it takes to hand it over.
constexpr int smallest_shared_system = 1000;
/// The work of a subtree is at most the whole over this, which leaves parts to choose from for as many threads as there may be.
constexpr double subtrees_of_equal_work = 2.0 * most_threads;
constexpr int subtree_parts = 2 * most_threads;
/// [-] Rows of the top that are eliminated one after the other before the others go on: a part of the work small against the rest, and large against
/// a call upon the threads.
constexpr int panel_rows = 32;

/// [bytes] Before room is made for a larger factor, freed memory goes back to the system. For smaller ones that costs more time than the memory is
/// worth: 0.1 ms of finding it and touching it again.
constexpr std::size_t largest_factor_beside_holes_bytes = 4u << 20;

/// Iterations for the couplings left out, each of which leaves a part of the residual that is about their strength over the inertia of the blocks; in
/// motion two are enough for 1e-7. Where more are needed, these couplings are no weak ones.
constexpr int most_refinements = 6;
/// [-] Of the residual, at least. An iteration takes a tenth of one of Newton's method, of which there are 13 % more with 1e-5 and 1 % more with
/// this.
constexpr double refined_reduction = 1e-7;
/// [-] Where all digits are asked for, as those of a factor of the whole matrix.
constexpr double refined_to_rounding = std::numeric_limits<double>::epsilon();

/// Rows of blocks are padded to four numbers, one register of four. The padding of products is that of their right factor; nobody reads it.
constexpr int alignment = sizeof(Lanes);

/// N x N, row by row.
struct alignas(alignment) PaddedBlock {
  static_assert(dofs < batch_size);
  Lanes row[dofs];
  PaddedBlock() {}  // nothing: a factor is written before it is read
};

struct alignas(alignment) PaddedVector {
  Lanes entries;
};

/// A block of the matrix that goes into the factor.
struct Entry {
  int slot;    ///< in the matrix
  int target;  ///< slot in the factor
  int column;  ///< in the factor
};

/// A block of the matrix that does not.
struct LeftOut {
  int slot, row, column;  ///< in the matrix
};

/// L, inverted diagonal and U (multiplied by it) on their pattern, and the way there from the matrix.
struct Factor {
  std::vector<int> order;  ///< row of the matrix at a place in the factor
  std::vector<int> row_start, diagonal, column;
  std::vector<char> same_as_next;          ///< of rows: to the right of the next diagonal this row of U has the next one's pattern
  std::vector<Entry> entries;              ///< in the order in which elimination meets them
  std::vector<int> entries_start;          ///< where in `entries` a row begins
  std::vector<BlockMatrix::Block> taken;   ///< of the entries, from the matrix: the factor is that of these
  std::vector<PaddedVector> scale;         ///< of rows: sizes of the diagonal entries in `taken`
  std::vector<char> stale;                 ///< of rows: to be eliminated anew
  std::vector<double> size;                ///< of rows: square of the pivot's norm before the elimination
  std::vector<int> panel;                  ///< of rows: 0 in a subtree; of the top from 1 on
  std::vector<std::vector<int>> subtrees;  ///< rows of one or several subtrees each; all rows of a small system
  std::vector<std::vector<int>> panels;    ///< rows of the top
  std::vector<PaddedBlock> value;
  std::vector<PaddedVector> solution;  ///< a block row each, in the factor's order

  int rows() const { return static_cast<int>(diagonal.size()); }
  std::size_t bytes() const {
    std::size_t lists = bytes_of(subtrees, panels);
    for (const auto* parts : {&subtrees, &panels}) {
      for (const std::vector<int>& part : *parts) lists += bytes_of(part);
    }
    return lists +
           bytes_of(order, row_start, diagonal, column, same_as_next, entries, entries_start, taken, scale, stale, size, panel, value, solution);
  }
  /// The row that is the first to subtract row i; -1 for a root.
  int parent(int i) const {
    const int next = diagonal[i] + 1;
    return next < row_start[i + 1] ? column[next] : -1;
  }
};

/// The entries of a block one by one, as they multiply the rows of another.
struct Multipliers {
  double entry[dofs][dofs];
  OPENCLOSE_KERNEL explicit Multipliers(const PaddedBlock& block) {
    for (int r = 0; r < dofs; ++r) {
      for (int c = 0; c < dofs; ++c) entry[r][c] = block.row[r][c];
    }
  }
  OPENCLOSE_KERNEL void subtract_row_of_product(int r, const PaddedBlock& right, Lanes& target) const {
    Lanes sum = entry[r][0] * right.row[0];
    for (int c = 1; c < dofs; ++c) sum += entry[r][c] * right.row[c];
    target -= sum;
  }
  OPENCLOSE_KERNEL void replace_by_product(PaddedBlock& right) const {
    PaddedBlock result;
    for (int r = 0; r < dofs; ++r) {
      result.row[r] = entry[r][0] * right.row[0];
      for (int c = 1; c < dofs; ++c) result.row[r] += entry[r][c] * right.row[c];
    }
    right = result;
  }
};

OPENCLOSE_KERNEL void subtract_row(Factor& f, int s, int k, const int* place) {
  const Multipliers left(f.value[s]);
  for (int u = f.diagonal[k] + 1; u < f.row_start[k + 1]; ++u) {
    const PaddedBlock& right = f.value[u];
    PaddedBlock& target = f.value[place[f.column[u]]];
    for (int r = 0; r < dofs; ++r) left.subtract_row_of_product(r, right, target.row[r]);
  }
}

/// Rows k and k + 1 of one pattern: every block of the row under work is fetched once for both.
OPENCLOSE_KERNEL void subtract_two_rows(Factor& f, int s, int k, const int* place) {
  PaddedBlock* const value = f.value.data();
  const int* const column = f.column.data();
  const int first = f.diagonal[k] + 2, second = f.diagonal[k + 1] + 1, count = f.row_start[k + 1] - first;
  const Multipliers left(value[s]);
  for (int r = 0; r < dofs; ++r) left.subtract_row_of_product(r, value[first - 1], value[s + 1].row[r]);
  const Multipliers next_left(value[s + 1]);
  for (int u = 0; u < count; ++u) {
    const PaddedBlock &right = value[first + u], &next_right = value[second + u];
    PaddedBlock& target = value[place[column[second + u]]];
    for (int r = 0; r < dofs; ++r) {
      Lanes row = target.row[r];
      left.subtract_row_of_product(r, right, row);
      next_left.subtract_row_of_product(r, next_right, row);
      target.row[r] = row;
    }
  }
}

/// Subtracts from row i what the rows of a panel above it contribute.
/// \param place  room for the slot of each column in the row
OPENCLOSE_KERNEL void subtract_panel(Factor& f, int i, int panel, int* place) {
  for (int s = f.row_start[i]; s < f.row_start[i + 1]; ++s) place[f.column[s]] = s;
  for (int s = f.row_start[i]; s < f.diagonal[i]; ++s) {
    const int k = f.column[s];
    if (f.panel[k] != panel) continue;
    if (f.same_as_next[k] && s + 1 < f.diagonal[i] && f.panel[k + 1] == panel) {
      subtract_two_rows(f, s++, k, place);
    } else {
      subtract_row(f, s, k, place);
    }
  }
}

/// By value: clang++ takes what a reference refers to for aligned in full.
OPENCLOSE_KERNEL Lanes lanes_at(const double* from) {
  Lanes numbers;
  std::memcpy(&numbers, from, sizeof numbers);
  return numbers;
}

/// A block of the matrix, column by column. The padding repeats the last column.
OPENCLOSE_KERNEL void pad(const double* block, PaddedBlock& padded) {
  const Lanes first = lanes_at(block), next = lanes_at(block + 3), last = lanes_at(block + 5);  // of this the numbers from one on
  const Lanes even = __builtin_shufflevector(first, next, 0, 4, 2, 6), odd = __builtin_shufflevector(first, next, 1, 5, 3, 7);
  padded.row[0] = __builtin_shufflevector(even, last, 0, 1, 5, 5);
  padded.row[1] = __builtin_shufflevector(odd, last, 0, 1, 6, 6);
  padded.row[2] = __builtin_shufflevector(even, last, 2, 3, 7, 7);
}

/// Three rows of a block by columns.
struct Columns {
  Lanes first, next, last;

  OPENCLOSE_KERNEL explicit Columns(const Lanes (&rows)[3]) {
    const Lanes even = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6), odd = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
    first = __builtin_shufflevector(even, rows[2], 0, 1, 4, 5);
    next = __builtin_shufflevector(odd, rows[2], 0, 1, 5, 6);
    last = __builtin_shufflevector(even, rows[2], 2, 3, 6, 6);
  }
};

OPENCLOSE_KERNEL double sum_of_three(const Lanes& x) {
  return x[0] + x[1] + x[2];
}

OPENCLOSE_KERNEL Lanes squares_of_columns(const PaddedBlock& block) {
  Lanes sum = block.row[0] * block.row[0];
  for (int r = 1; r < dofs; ++r) sum += block.row[r] * block.row[r];
  return sum;
}

OPENCLOSE_KERNEL Lanes cross_product(const Lanes& a, const Lanes& b) {
  return __builtin_shufflevector(a, a, 1, 2, 0, 3) * __builtin_shufflevector(b, b, 2, 0, 1, 3) -
         __builtin_shufflevector(a, a, 2, 0, 1, 3) * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}

/// Replaces the pivot by its inverse; false if it has none worth the name.
/// \param original_size  square of the block's norm before the elimination
OPENCLOSE_KERNEL bool invert(PaddedBlock& pivot, double original_size) {
  constexpr double square = smallest_pivot * smallest_pivot;
  const Lanes squares = squares_of_columns(pivot);
  const Lanes cofactors[dofs] = {cross_product(pivot.row[1], pivot.row[2]), cross_product(pivot.row[2], pivot.row[0]),
                                 cross_product(pivot.row[0], pivot.row[1])};
  const double determinant = sum_of_three(pivot.row[0] * cofactors[0]), columns = squares[0] * squares[1] * squares[2];
  if (!(sum_of_three(squares) > square * original_size) || !(determinant * determinant > square * columns)) return false;
  const Columns rows(cofactors);
  const double factor = 1.0 / determinant;
  pivot.row[0] = rows.first * factor;
  pivot.row[1] = rows.next * factor;
  pivot.row[2] = rows.last * factor;
  return std::isfinite(sum_of_three(squares_of_columns(pivot)));
}

/// The nine entries of a block, column by column, as two registers and one number.
struct Entries {
  Lanes first, next;
  double last;

  OPENCLOSE_KERNEL explicit Entries(const double* block) : first(lanes_at(block)), next(lanes_at(block + batch_size)), last(block[2 * batch_size]) {}
  OPENCLOSE_KERNEL Entries(const Lanes& rows, const Lanes& columns)
      : first(__builtin_shufflevector(rows, rows, 0, 1, 2, 0) * __builtin_shufflevector(columns, columns, 0, 0, 0, 1)),
        next(__builtin_shufflevector(rows, rows, 1, 2, 0, 1) * __builtin_shufflevector(columns, columns, 1, 1, 2, 2)),
        last(rows[2] * columns[2]) {}
  OPENCLOSE_KERNEL Entries& operator-=(const Entries& other) {
    first -= other.first, next -= other.next, last -= other.last;
    return *this;
  }
};

/// Whether no entry of row i has changed by more than `change` times the root of the diagonal entries of its row and column.
OPENCLOSE_KERNEL bool is_as_taken(const BlockMatrix& matrix, const Factor& f, int i, double change) {
  const Lanes s = change * change * f.scale[i].entries;
  auto within = s <= s;
  bool last_within = true;
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) {
    Entries difference(matrix.value(f.entries[e].slot).data());
    difference -= Entries(f.taken[e].data());
    const Entries allowed(s, f.scale[f.entries[e].column].entries);
    within &= (difference.first * difference.first <= allowed.first) & (difference.next * difference.next <= allowed.next);
    last_within = last_within && difference.last * difference.last <= allowed.last;
  }
  return last_within && (within[0] & within[1] & within[2] & within[3]) != 0;
}

OPENCLOSE_KERNEL void note_scale(Factor& f, int i) {
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) {
    if (f.entries[e].column != i) continue;
    for (int r = 0; r < dofs; ++r) f.scale[i].entries[r] = std::abs(f.taken[e](r, r));
  }
}

OPENCLOSE_KERNEL void take_row(const BlockMatrix& matrix, Factor& f, int i) {
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) f.taken[e] = matrix.value(f.entries[e].slot);
  note_scale(f, i);
}

/// Takes the rows that are stale, because they or rows that they subtract have changed, from the matrix. The number of those that are not.
OPENCLOSE_FOR_WIDE_REGISTERS_TOO int take_changes(const BlockMatrix& matrix, Factor& f, double change) {
  int kept = 0;
  for (int i = 0; i < f.rows(); ++i) {
    if (!f.stale[i] && is_as_taken(matrix, f, i, change)) {
      ++kept;
      continue;
    }
    f.stale[i] = true;
    take_row(matrix, f, i);
    const int parent = f.parent(i);
    if (parent >= 0) f.stale[parent] = true;
  }
  return kept;
}

/// Lays row i of the matrix into its slots.
OPENCLOSE_KERNEL void lay_row(Factor& f, int i) {
  for (int s = f.row_start[i]; s < f.row_start[i + 1]; ++s) {
    for (Lanes& row : f.value[s].row) row = Lanes{};
  }
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) pad(f.taken[e].data(), f.value[f.entries[e].target]);
  f.size[i] = sum_of_three(squares_of_columns(f.value[f.diagonal[i]]));
}

/// Subtracts a panel from stale rows of later ones.
OPENCLOSE_FOR_WIDE_REGISTERS_TOO void advance(Factor& f, const std::vector<int>& rows, int panel, int* place) {
  for (int i : rows) {
    if (!f.stale[i]) continue;
    if (panel == 0) lay_row(f, i);
    subtract_panel(f, i, panel, place);
  }
}

/// Ends the elimination of stale rows of a panel, which have subtracted all before it. False if a pivot has lost its digits.
OPENCLOSE_FOR_WIDE_REGISTERS_TOO bool eliminate_rows(Factor& f, const std::vector<int>& rows, int panel, int* place) {
  for (int i : rows) {
    if (!f.stale[i]) continue;
    if (panel == 0) lay_row(f, i);
    subtract_panel(f, i, panel, place);
    if (!invert(f.value[f.diagonal[i]], f.size[i])) return false;
    const Multipliers inverse(f.value[f.diagonal[i]]);
    for (int s = f.diagonal[i] + 1; s < f.row_start[i + 1]; ++s) inverse.replace_by_product(f.value[s]);
  }
  return true;
}

/// `sum` less the sum over the slots of value times solution. The solution that is found last, on which everything waits, comes last.
/// \tparam direction  1 or -1: from slot to slot
template <int direction>
OPENCLOSE_KERNEL Lanes less_product(const Factor& f, int first, int end, const Lanes& sum) {
  Lanes products[dofs]{};
  for (int s = first; s != end; s += direction) {
    const Lanes& x = f.solution[f.column[s]].entries;
    for (int r = 0; r < dofs; ++r) products[r] += f.value[s].row[r] * x;
  }
  const Columns columns(products);
  return sum - columns.first - columns.next - columns.last;
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void substitute_forward(Factor& f, const std::vector<int>& rows, const double* right_side) {
  for (int i : rows) {
    const double* const b = right_side + dofs * f.order[i];
    const Lanes sum = less_product<1>(f, f.row_start[i], f.diagonal[i], Lanes{b[0], b[1], b[2], 0.0});
    Lanes products[dofs];
    for (int r = 0; r < dofs; ++r) products[r] = f.value[f.diagonal[i]].row[r] * sum;
    const Columns columns(products);
    f.solution[i].entries = columns.first + columns.next + columns.last;
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void substitute_back(Factor& f, const std::vector<int>& rows, double* x) {
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    const int i = *row;
    const Lanes entries = less_product<-1>(f, f.row_start[i + 1] - 1, f.diagonal[i], f.solution[i].entries);
    f.solution[i].entries = entries;
    for (int k = 0; k < dofs; ++k) x[dofs * f.order[i] + k] = entries[k];
  }
}

class BlockLuSolver : public LinearSolver {
 public:
  explicit BlockLuSolver(Factoring factoring) : factoring_(factoring) {}

  bool factor(const BlockMatrix& matrix, double kept_change) override {
    matrix_ = &matrix;
    if (version_ != matrix.pattern_version()) {
      analyse(factored_slots(matrix, factoring_));
    } else {
      ++this->counters_.symbolic_skipped;
    }
    return factor_analysed(kept_change);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override { return solve(right_side, reduction, 0.0); }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction, double enough) override {
    ++this->counters_.solves;
    return solve_once(right_side, reduction, enough);
  }

  Memory memory() const override {
    Memory of = plain_ ? plain_->memory() : Memory();
    of.factor += factor_.bytes() + bytes_of(slots_, left_out_, working_place_, place_);
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
    bool known = version_ == matrix.pattern_version(), has_factor = has_factor_;
    std::vector<char> slots = slots_;
    archive(known);
    if (!known) return;
    archive(slots, has_factor);
    archive.require(slots.size() == static_cast<std::size_t>(matrix.row_start(matrix.rows())), "the saved state has a factor of another matrix");
    if (archive.reading()) plan(matrix, std::move(slots));
    if (has_factor) exchange_factor(archive);
  }

 private:
  /// What is stored is the matrix that it is the factor of.
  void exchange_factor(Archive& archive) {
    for (auto& block : factor_.taken) archive(block);
    if (!archive.reading()) return;
    for (int i = 0; i < factor_.rows(); ++i) note_scale(factor_, i);
    std::fill(factor_.stale.begin(), factor_.stale.end(), true);
    has_factor_ = eliminate();
  }

  bool factor_analysed(double kept_change) {
    ++this->counters_.factorisations;
    make_room();
    std::fill(factor_.stale.begin(), factor_.stale.end(), factoring_ == Factoring::whole || !has_factor_);
    this->counters_.rows += factor_.rows();
    this->counters_.rows_kept += take_changes(*matrix_, factor_, kept_change);
    has_factor_ = eliminate();
    use_plain_ = !has_factor_;
    if (has_factor_) return true;
    ++this->counters_.pivots_lost;
    let_go_of_rows();
    if (!plain_) plain_ = make_sparse_solver();
    return plain_->factor(*matrix_);
  }

  Eigen::VectorXd solve_once(const Eigen::VectorXd& right_side, double reduction, double enough) {
    if (use_plain_) return plain_->solve(right_side);
    Eigen::VectorXd x(right_side.size());
    substitute(right_side.data(), x.data());
    if (left_out_.empty() || refine(right_side, std::max(enough, refined_to(reduction)), x)) return x;
    return take_in() ? solve_once(right_side, reduction, enough) : Eigen::VectorXd();
  }

  static double refined_to(double reduction) { return reduction > full_reduction ? std::min(reduction, refined_reduction) : refined_to_rounding; }

  /// Brings the residual, which is what the couplings left out carry, down to `wanted`. False if that takes too long.
  bool refine(const Eigen::VectorXd& right_side, double reduction, Eigen::VectorXd& x) {
    Eigen::VectorXd step = x, residual = right_side;
    const double wanted = reduction * right_side.norm();
    for (int iteration = 0; iteration <= most_refinements; ++iteration) {
      subtract_product(step, residual);
      if (residual.norm() <= wanted) return true;
      ++this->counters_.refinements;
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
    ++this->counters_.couplings_taken_in;
    std::vector<char> slots = factored_slots(*matrix_, factoring_);
    if (slots == slots_) slots = factored_slots(*matrix_, Factoring::whole);
    analyse(std::move(slots));
    return factor_analysed(0.0);
  }

  /// False if a pivot has lost its digits.
  bool eliminate() {
    const int subtrees = static_cast<int>(factor_.subtrees.size()), panels = static_cast<int>(factor_.panels.size());
    std::atomic<bool> done = true;
    for_each_part(SharedWork::factorisation, this->threads_, subtrees, [&](int part) {
      if (!eliminate_rows(factor_, factor_.subtrees[part], 0, working_place_[part].data())) done = false;
    });
    for (int panel = 0; panel <= panels && done; ++panel) {
      if (panel > 0) done = eliminate_rows(factor_, factor_.panels[panel - 1], panel, working_place_[0].data());
      for_each_part(SharedWork::factorisation, this->threads_, panels - panel,
                    [&](int later) { advance(factor_, factor_.panels[panel + later], panel, working_place_[later].data()); });
    }
    return done;
  }

  void substitute(const double* right_side, double* x) {
    const int subtrees = static_cast<int>(factor_.subtrees.size());
    for_each_part(SharedWork::substitution, this->threads_, subtrees,
                  [&](int part) { substitute_forward(factor_, factor_.subtrees[part], right_side); });
    for (const std::vector<int>& panel : factor_.panels) substitute_forward(factor_, panel, right_side);
    for (auto panel = factor_.panels.rbegin(); panel != factor_.panels.rend(); ++panel) substitute_back(factor_, *panel, x);
    for_each_part(SharedWork::substitution, this->threads_, subtrees, [&](int part) { substitute_back(factor_, factor_.subtrees[part], x); });
  }

  /// \param slots  of the matrix: whether the factor gets them
  void analyse(std::vector<char> slots) {
    ++this->counters_.symbolic;
    plan(*matrix_, std::move(slots));
  }

  void plan(const BlockMatrix& matrix, std::vector<char> slots) {
    version_ = matrix.pattern_version();
    has_factor_ = false;
    slots_ = std::move(slots);
    const RowGraph graph = graph_of(matrix, slots_);
    order_rows(graph);

    lay_out(find_upper_pattern(graph));
    cut_into_subtrees();
    find_entries(matrix);
  }

  /// Of rows one after another: what each has above the diagonal, in any order.
  struct UpperPattern {
    std::vector<int> start, column;
    std::span<const int> row(int i) const { return {column.data() + start[i], column.data() + start[i + 1]}; }
  };

  /// In the new order. Each row hands its pattern down to the first row it meets.
  UpperPattern find_upper_pattern(const RowGraph& graph) const {
    const int rows = graph.rows();
    UpperPattern upper;
    upper.start.assign(1, 0);
    std::vector<int> first_child(rows, -1), next_child(rows, -1), seen(rows, -1);
    for (int i = 0; i < rows; ++i) {
      seen[i] = i;
      const auto take = [&](int j) {
        if (j <= i || seen[j] == i) return;
        seen[j] = i;
        upper.column.push_back(j);
      };
      for (int k = graph.start[factor_.order[i]]; k < graph.start[factor_.order[i] + 1]; ++k) take(place_[graph.neighbour[k]]);
      for (int child = first_child[i]; child >= 0; child = next_child[child]) {
        for (int k = upper.start[child]; k < upper.start[child + 1]; ++k) take(upper.column[k]);
      }
      upper.start.push_back(static_cast<int>(upper.column.size()));
      if (upper.row(i).empty()) continue;
      const int parent = *std::ranges::min_element(upper.row(i));
      next_child[i] = std::exchange(first_child[parent], i);
    }
    return upper;
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

  void find_entries(const BlockMatrix& matrix) {
    const int rows = matrix.rows();
    factor_.entries.clear();
    factor_.entries_start.assign(1, 0);
    left_out_.clear();
    std::vector<int> place(rows);
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.row_start[i + 1]; ++s) place[factor_.column[s]] = s;
      const int row = factor_.order[i];
      for (int s = matrix.row_start(row); s < matrix.row_start(row + 1); ++s) {
        if (slots_[s]) {
          factor_.entries.push_back({s, place[place_[matrix.column(s)]], place_[matrix.column(s)]});
        } else {
          left_out_.push_back({s, row, matrix.column(s)});
        }
      }
      factor_.entries_start.push_back(static_cast<int>(factor_.entries.size()));
    }
    make_room();
    factor_.taken.resize(factor_.entries.size());
    factor_.scale.assign(rows, PaddedVector());
    factor_.stale.assign(rows, true);
  }

  /// The connected parts of the graph one after another, each ordered for itself: in what is not cut into subtrees none of its numbers depends on
  /// what else is in the system.
  void order_rows(const RowGraph& graph) {
    const int rows = graph.rows();
    factor_.order.clear();
    place_.assign(rows, unplaced);
    for (int first = 0; first < rows; ++first) {
      if (place_[first] == unplaced) order_part(graph, connected_rows(graph, first));
    }
    for (int i = 0; i < rows; ++i) place_[factor_.order[i]] = i;
  }

  /// In ascending order; their places become those in the list.
  std::vector<int> connected_rows(const RowGraph& graph, int first) {
    std::vector<int> part = {first};
    place_[first] = 0;
    for (std::size_t next = 0; next < part.size(); ++next) {
      for (int k = graph.start[part[next]]; k < graph.start[part[next] + 1]; ++k) {
        const int neighbour = graph.neighbour[k];
        if (place_[neighbour] != unplaced) continue;
        place_[neighbour] = 0;
        part.push_back(neighbour);
      }
    }
    std::sort(part.begin(), part.end());
    for (std::size_t i = 0; i < part.size(); ++i) place_[part[i]] = static_cast<int>(i);
    return part;
  }

  void order_part(const RowGraph& graph, const std::vector<int>& part) {
    const int rows = static_cast<int>(part.size());
    if (rows <= 2) {  // no order fills more than another
      factor_.order.insert(factor_.order.end(), part.begin(), part.end());
      return;
    }
    // One half, from the diagonal on.
    Eigen::SparseMatrix<float> pattern(rows, rows);
    const auto after = [&](int i) {
      const auto begin = graph.neighbour.begin() + graph.start[part[i]], end = graph.neighbour.begin() + graph.start[part[i] + 1];
      return std::span(std::upper_bound(begin, end, part[i]), end);
    };
    for (int i = 0; i < rows; ++i) pattern.outerIndexPtr()[i + 1] = pattern.outerIndexPtr()[i] + 1 + static_cast<int>(after(i).size());
    pattern.resizeNonZeros(pattern.outerIndexPtr()[rows]);
    std::fill(pattern.valuePtr(), pattern.valuePtr() + pattern.nonZeros(), 1.0F);
    for (int i = 0; i < rows; ++i) {
      int* column = pattern.innerIndexPtr() + pattern.outerIndexPtr()[i];
      *column++ = i;
      for (const int j : after(i)) *column++ = place_[j];
    }
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), permutation);
    for (int i = 0; i < rows; ++i) factor_.order.push_back(part[permutation.indices()[i]]);
  }

  /// Rows of L, diagonal and U one after another in one array.
  void lay_out(const UpperPattern& upper) {
    const int rows = static_cast<int>(upper.start.size()) - 1;
    std::vector<int> below(rows, 0), place(rows);  // of L: numbers in a row; of L, then of U: where the next one goes
    for (const int j : upper.column) ++below[j];
    factor_.row_start.resize(rows + 1);
    factor_.diagonal.resize(rows);
    factor_.column.resize(rows + 2 * upper.column.size());
    factor_.same_as_next.resize(rows);
    int end = 0;
    for (int i = 0; i < rows; ++i) {
      factor_.row_start[i] = place[i] = end;
      factor_.diagonal[i] = end + below[i];
      factor_.column[factor_.diagonal[i]] = i;
      end = factor_.diagonal[i] + 1 + static_cast<int>(upper.row(i).size());
    }
    factor_.row_start[rows] = end;
    // Row by row, so that each list is in ascending order.
    for (int i = 0; i < rows; ++i) {
      for (const int j : upper.row(i)) factor_.column[place[j]++] = i;
    }
    for (int i = 0; i < rows; ++i) ++place[i];  // over the diagonal
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.diagonal[i]; ++s) factor_.column[place[factor_.column[s]]++] = i;
    }
    for (int i = 0; i < rows; ++i) {
      factor_.same_as_next[i] = factor_.parent(i) == i + 1 && upper.row(i).size() == upper.row(i + 1).size() + 1;
    }
    factor_.solution.resize(rows);
    factor_.size.resize(rows);
  }

  /// Products of blocks in the elimination of row i and all below it in the tree.
  std::vector<double> work_of_subtrees() const {
    const int rows = factor_.rows();
    std::vector<double> work(rows, 0.0);
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.diagonal[i]; ++s)
        work[i] += factor_.row_start[factor_.column[s] + 1] - factor_.diagonal[factor_.column[s]];
      work[i] += 1.0;
      if (factor_.parent(i) >= 0) work[factor_.parent(i)] += work[i];
    }
    return work;
  }

  void cut_into_subtrees() {
    const int rows = factor_.rows();
    factor_.panel.assign(rows, 0);
    factor_.panels.clear();
    factor_.subtrees.assign(1, {});
    std::vector<int> part_of(rows, 0);
    if (rows >= smallest_shared_system) part_of = share_out_subtrees();
    for (int i = 0, top = 0; i < rows; ++i) {
      if (part_of[i] != in_top) {
        factor_.subtrees[part_of[i]].push_back(i);
        continue;
      }
      if (top % panel_rows == 0) factor_.panels.emplace_back();
      factor_.panels.back().push_back(i);
      factor_.panel[i] = 1 + top++ / panel_rows;
    }
    working_place_.assign(std::max(factor_.subtrees.size(), factor_.panels.size()), std::vector<int>(rows));
  }

  /// The part of each row; large subtrees are dealt out first, each to the part with the least work.
  std::vector<int> share_out_subtrees() {
    const int rows = factor_.rows();
    const std::vector<double> work = work_of_subtrees();
    double whole = 0.0;
    for (int i = 0; i < rows; ++i) whole += factor_.parent(i) < 0 ? work[i] : 0.0;
    const double most = whole / subtrees_of_equal_work;
    std::vector<int> part_of(rows, in_top), roots;
    for (int i = 0; i < rows; ++i) {
      if (work[i] <= most && (factor_.parent(i) < 0 || work[factor_.parent(i)] > most)) roots.push_back(i);
    }
    std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return work[a] > work[b]; });
    factor_.subtrees.assign(subtree_parts, {});
    std::vector<double> given(subtree_parts, 0.0);
    for (int root : roots) {
      const auto least = std::min_element(given.begin(), given.end());
      *least += work[root];
      part_of[root] = static_cast<int>(least - given.begin());
    }
    for (int i = rows - 1; i >= 0; --i) {
      if (work[i] <= most && factor_.parent(i) >= 0 && work[factor_.parent(i)] <= most) part_of[i] = part_of[factor_.parent(i)];
    }
    return part_of;
  }

  static constexpr int unplaced = -1, in_top = -1;
  Factoring factoring_;
  const BlockMatrix* matrix_ = nullptr;
  long version_ = -1;
  Factor factor_;
  bool has_factor_ = false;                      ///< of what it has taken
  std::vector<char> slots_;                      ///< of the matrix: whether the factor has them
  std::vector<LeftOut> left_out_;                ///< those that it has not
  std::vector<std::vector<int>> working_place_;  ///< for each part: slot of a column in the row under work
  std::vector<int> place_;                       ///< in the factor, of a row of the matrix
  bool use_plain_ = false;
  std::unique_ptr<LinearSolver> plain_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_block_solver(Factoring factoring) {
  return std::make_unique<BlockLuSolver>(factoring);
}

}  // namespace openclose
