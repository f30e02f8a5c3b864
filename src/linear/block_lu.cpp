// LU factorisation of a block matrix without exchange of blocks, on the fill that the pattern leaves after an approximate minimum degree ordering of
// the block graph (P. R. Amestoy, T. A. Davis, I. S. Duff 1996; Eigen's implementation).
//
// Row by row (Duff, Erisman, Reid, Direct methods for sparse matrices, 2017, chapter 10): row i of the matrix is laid into the slots of row i of L
// and U, and the rows above are subtracted from it in ascending order. The pattern is symmetric, so that L has the transposed pattern of U. The
// diagonal blocks are inverted; nothing is exchanged between blocks, which is safe while each block is held by its own inertia and contacts: where a
// pivot has lost its digits, the matrix is given to the multifrontal solver, which exchanges rows within its fronts.
//
// The rows above that row i subtracts lie below it in the elimination tree (J. W. H. Liu, The role of elimination trees in sparse factorization, SIAM
// J. Matrix Anal. Appl. 11 (1990)). Large systems are therefore cut into subtrees, which do not depend on each other, and the rows where these meet,
// the top. A row of the top subtracts those of the subtrees first and then, panel by panel, those of the top; with one panel done, the rows of all
// later ones can subtract it at the same time. The cut depends on the pattern alone, so that the number of threads changes no digit.
#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "openclose/core/parallel.h"
#include "openclose/linear/solver.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define OPENCLOSE_HAS_WIDE_REGISTERS
#endif

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

/// Rows of blocks are padded to four numbers, one register of four. The padding of products is that of their right factor; nobody reads it.
constexpr int lanes = 4;
constexpr int alignment = lanes * sizeof(double);  // said in full: left to itself it depends on the instructions that a function may use
typedef double Lanes __attribute__((vector_size(alignment), aligned(alignment)));

/// N x N, row by row.
template <int N>
struct alignas(alignment) PaddedBlock {
  static_assert(N <= lanes);
  Lanes row[N];
};

struct alignas(alignment) PaddedVector {
  Lanes entries;
};

/// L, inverted diagonal and U on their pattern, and the way there from the matrix.
template <int N>
struct Factor {
  std::vector<int> order;  ///< row of the matrix at a place in the factor
  std::vector<int> row_start, diagonal, column;
  std::vector<char> same_as_next;          ///< of rows: to the right of the next diagonal this row of U has the next one's pattern
  std::vector<int> target;                 ///< slot in the factor of the matrix's entries, in the order in which elimination meets them
  std::vector<int> target_start;           ///< where in `target` a row begins
  std::vector<double> size;                ///< of rows: square of the pivot's norm before the elimination
  std::vector<int> panel;                  ///< of rows: 0 in a subtree; of the top from 1 on
  std::vector<std::vector<int>> subtrees;  ///< rows of one or several subtrees each; all rows of a small system
  std::vector<std::vector<int>> panels;    ///< rows of the top
  std::vector<PaddedBlock<N>> value;
  std::vector<PaddedVector> solution;  ///< a block row each, in the factor's order

  int rows() const { return static_cast<int>(diagonal.size()); }
};

// What follows is compiled once for every processor and once for wide registers. Each number is computed by the same operations in the same order,
// so that results do not depend on the processor.
#define OPENCLOSE_KERNEL [[gnu::always_inline]] inline

template <int N>
OPENCLOSE_KERNEL PaddedBlock<N> product(const PaddedBlock<N>& left, const PaddedBlock<N>& right) {
  PaddedBlock<N> result;
  for (int r = 0; r < N; ++r) {
    result.row[r] = left.row[r][0] * right.row[0];
    for (int c = 1; c < N; ++c) result.row[r] += left.row[r][c] * right.row[c];
  }
  return result;
}

/// The entries of a block one by one, as they multiply the rows of another.
template <int N>
struct Multipliers {
  double entry[N][N];
  OPENCLOSE_KERNEL explicit Multipliers(const PaddedBlock<N>& block) {
    for (int r = 0; r < N; ++r) {
      for (int c = 0; c < N; ++c) entry[r][c] = block.row[r][c];
    }
  }
  OPENCLOSE_KERNEL void subtract_row_of_product(int r, const PaddedBlock<N>& right, Lanes& target) const {
    Lanes sum = entry[r][0] * right.row[0];
    for (int c = 1; c < N; ++c) sum += entry[r][c] * right.row[c];
    target -= sum;
  }
};

template <int N>
OPENCLOSE_KERNEL void subtract_row(Factor<N>& f, int s, int k, const int* place) {
  f.value[s] = product(f.value[s], f.value[f.diagonal[k]]);
  const Multipliers<N> left(f.value[s]);
  for (int u = f.diagonal[k] + 1; u < f.row_start[k + 1]; ++u) {
    const PaddedBlock<N>& right = f.value[u];
    PaddedBlock<N>& target = f.value[place[f.column[u]]];
    for (int r = 0; r < N; ++r) left.subtract_row_of_product(r, right, target.row[r]);
  }
}

/// Rows k and k + 1 of one pattern: every block of the row under work is fetched once for both.
template <int N>
OPENCLOSE_KERNEL void subtract_two_rows(Factor<N>& f, int s, int k, const int* place) {
  PaddedBlock<N>* const value = f.value.data();
  const int* const column = f.column.data();
  const int first = f.diagonal[k] + 2, second = f.diagonal[k + 1] + 1, count = f.row_start[k + 1] - first;
  value[s] = product(value[s], value[first - 2]);
  const Multipliers<N> left(value[s]);
  for (int r = 0; r < N; ++r) left.subtract_row_of_product(r, value[first - 1], value[s + 1].row[r]);
  value[s + 1] = product(value[s + 1], value[second - 1]);
  const Multipliers<N> next_left(value[s + 1]);
  for (int u = 0; u < count; ++u) {
    const PaddedBlock<N>&right = value[first + u], &next_right = value[second + u];
    PaddedBlock<N>& target = value[place[column[second + u]]];
    for (int r = 0; r < N; ++r) {
      Lanes row = target.row[r];
      left.subtract_row_of_product(r, right, row);
      next_left.subtract_row_of_product(r, next_right, row);
      target.row[r] = row;
    }
  }
}

/// Subtracts from row i what the rows of a panel above it contribute.
/// \param place  room for the slot of each column in the row
template <int N>
OPENCLOSE_KERNEL void subtract_panel(Factor<N>& f, int i, int panel, int* place) {
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

template <int N>
OPENCLOSE_KERNEL void pad(const typename BlockMatrix<N>::Block& block, PaddedBlock<N>& padded) {
  for (int r = 0; r < N; ++r) {
    for (int c = 0; c < N; ++c) padded.row[r][c] = block(r, c);
  }
}

template <int N>
OPENCLOSE_KERNEL double square_norm(const PaddedBlock<N>& block) {
  Lanes sum = block.row[0] * block.row[0];
  for (int r = 1; r < N; ++r) sum += block.row[r] * block.row[r];
  double total = sum[0];
  for (int c = 1; c < N; ++c) total += sum[c];
  return total;
}

/// Replaces the pivot by its inverse; false if it has none worth the name.
/// \param original_size  square of the block's norm before the elimination
template <int N>
bool invert(PaddedBlock<N>& pivot, double original_size) {
  constexpr double square = smallest_pivot * smallest_pivot;
  typename BlockMatrix<N>::Block block;
  for (int r = 0; r < N; ++r) {
    for (int c = 0; c < N; ++c) block(r, c) = pivot.row[r][c];
  }
  const double columns = block.colwise().squaredNorm().prod(), determinant = block.determinant();
  if (!(block.squaredNorm() > square * original_size) || !(determinant * determinant > square * columns)) return false;
  block = block.inverse().eval();
  pad<N>(block, pivot);
  return block.allFinite();
}

/// Lays row i of the matrix into its slots.
template <int N>
OPENCLOSE_KERNEL void lay_row(const BlockMatrix<N>& matrix, Factor<N>& f, int i) {
  std::fill(f.value.begin() + f.row_start[i], f.value.begin() + f.row_start[i + 1], PaddedBlock<N>{});
  int next = f.target_start[i];
  for (int s = matrix.row_start(f.order[i]); s < matrix.row_start(f.order[i] + 1); ++s) pad<N>(matrix.value(s), f.value[f.target[next++]]);
  f.size[i] = square_norm(f.value[f.diagonal[i]]);
}

/// Subtracts a panel from rows of later ones.
template <int N>
OPENCLOSE_KERNEL void advance(const BlockMatrix<N>& matrix, Factor<N>& f, const std::vector<int>& rows, int panel, int* place) {
  for (int i : rows) {
    if (panel == 0) lay_row(matrix, f, i);
    subtract_panel(f, i, panel, place);
  }
}

/// Ends the elimination of rows of a panel, which have subtracted all before it. False if a pivot has lost its digits.
template <int N>
OPENCLOSE_KERNEL bool eliminate(const BlockMatrix<N>& matrix, Factor<N>& f, const std::vector<int>& rows, int panel, int* place) {
  for (int i : rows) {
    if (panel == 0) lay_row(matrix, f, i);
    subtract_panel(f, i, panel, place);
    if (!invert(f.value[f.diagonal[i]], f.size[i])) return false;
  }
  return true;
}

/// Subtracts the sum over the slots of value times solution.
template <int N>
OPENCLOSE_KERNEL void subtract_product(const Factor<N>& f, int begin, int end, double* sum) {
  Lanes products[N]{};
  for (int s = begin; s < end; ++s) {
    const Lanes& x = f.solution[f.column[s]].entries;
    for (int r = 0; r < N; ++r) products[r] += f.value[s].row[r] * x;
  }
  for (int r = 0; r < N; ++r) {
    for (int c = 0; c < N; ++c) sum[r] -= products[r][c];
  }
}

template <int N>
OPENCLOSE_KERNEL void substitute_forward(Factor<N>& f, const std::vector<int>& rows, const double* right_side) {
  for (int i : rows) {
    double sum[N];
    for (int k = 0; k < N; ++k) sum[k] = right_side[N * f.order[i] + k];
    subtract_product(f, f.row_start[i], f.diagonal[i], sum);
    for (int k = 0; k < N; ++k) f.solution[i].entries[k] = sum[k];
  }
}

template <int N>
OPENCLOSE_KERNEL void substitute_back(Factor<N>& f, const std::vector<int>& rows, double* x) {
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    const int i = *row;
    double sum[N];
    for (int k = 0; k < N; ++k) sum[k] = f.solution[i].entries[k];
    subtract_product(f, f.diagonal[i] + 1, f.row_start[i + 1], sum);
    const PaddedBlock<N>& inverse = f.value[f.diagonal[i]];
    for (int k = 0; k < N; ++k) {
      double entry = inverse.row[k][0] * sum[0];
      for (int c = 1; c < N; ++c) entry += inverse.row[k][c] * sum[c];
      f.solution[i].entries[k] = entry;
      x[N * f.order[i] + k] = entry;
    }
  }
}

/// The functions for the registers of a processor.
template <int N>
struct Kernels {
  void (*advance)(const BlockMatrix<N>&, Factor<N>&, const std::vector<int>&, int, int*);
  bool (*eliminate)(const BlockMatrix<N>&, Factor<N>&, const std::vector<int>&, int, int*);
  void (*substitute_forward)(Factor<N>&, const std::vector<int>&, const double*);
  void (*substitute_back)(Factor<N>&, const std::vector<int>&, double*);
};

#define OPENCLOSE_KERNELS_WITH(registers, target)                                                                                           \
  template <int N>                                                                                                                          \
  target void advance_with_##registers(const BlockMatrix<N>& matrix, Factor<N>& f, const std::vector<int>& rows, int panel, int* place) {   \
    advance(matrix, f, rows, panel, place);                                                                                                 \
  }                                                                                                                                         \
  template <int N>                                                                                                                          \
  target bool eliminate_with_##registers(const BlockMatrix<N>& matrix, Factor<N>& f, const std::vector<int>& rows, int panel, int* place) { \
    return eliminate(matrix, f, rows, panel, place);                                                                                        \
  }                                                                                                                                         \
  template <int N>                                                                                                                          \
  target void substitute_forward_with_##registers(Factor<N>& f, const std::vector<int>& rows, const double* right_side) {                   \
    substitute_forward(f, rows, right_side);                                                                                                \
  }                                                                                                                                         \
  template <int N>                                                                                                                          \
  target void substitute_back_with_##registers(Factor<N>& f, const std::vector<int>& rows, double* x) {                                     \
    substitute_back(f, rows, x);                                                                                                            \
  }                                                                                                                                         \
  template <int N>                                                                                                                          \
  Kernels<N> kernels_with_##registers() {                                                                                                   \
    return {&advance_with_##registers<N>, &eliminate_with_##registers<N>, &substitute_forward_with_##registers<N>,                          \
            &substitute_back_with_##registers<N>};                                                                                          \
  }

OPENCLOSE_KERNELS_WITH(any_registers, )
#ifdef OPENCLOSE_HAS_WIDE_REGISTERS
OPENCLOSE_KERNELS_WITH(wide_registers, [[gnu::target("avx2")]])
#endif

template <int N>
Kernels<N> choose_kernels([[maybe_unused]] bool wide_registers) {
#ifdef OPENCLOSE_HAS_WIDE_REGISTERS
  if (wide_registers && __builtin_cpu_supports("avx2")) return kernels_with_wide_registers<N>();
#endif
  return kernels_with_any_registers<N>();
}

template <int N>
class BlockLuSolver : public LinearSolver<N> {
 public:
  explicit BlockLuSolver(bool wide_registers) : kernels_(choose_kernels<N>(wide_registers)) {}

  bool factor(const BlockMatrix<N>& matrix) override {
    if (version_ != matrix.pattern_version()) {
      analyse(matrix);
    } else {
      ++this->counters_.symbolic_skipped;
    }
    ++this->counters_.factorisations;
    use_fronts_ = !eliminate(matrix);
    if (!use_fronts_) return true;
    ++this->counters_.pivots_lost;
    if (!fronts_) fronts_ = make_multifrontal_solver<N>(Refactor::always);
    const bool regular = fronts_->factor(matrix);
    count_help();
    return regular;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override {
    ++this->counters_.solves;
    Eigen::VectorXd x(right_side.size());
    if (use_fronts_) {
      x = fronts_->solve(right_side, reduction);
      count_help();
      return x;
    }
    substitute(right_side.data(), x.data());
    return x;
  }

 private:
  /// False if a pivot has lost its digits.
  bool eliminate(const BlockMatrix<N>& matrix) {
    const int subtrees = static_cast<int>(factor_.subtrees.size()), panels = static_cast<int>(factor_.panels.size());
    std::atomic<bool> done = true;
    for_each_part(SharedWork::factorisation, this->threads_, subtrees, [&](int part) {
      if (!kernels_.eliminate(matrix, factor_, factor_.subtrees[part], 0, working_place_[part].data())) done = false;
    });
    for (int panel = 0; panel <= panels && done; ++panel) {
      if (panel > 0) done = kernels_.eliminate(matrix, factor_, factor_.panels[panel - 1], panel, working_place_[0].data());
      for_each_part(SharedWork::factorisation, this->threads_, panels - panel,
                    [&](int later) { kernels_.advance(matrix, factor_, factor_.panels[panel + later], panel, working_place_[later].data()); });
    }
    return done;
  }

  void substitute(const double* right_side, double* x) {
    const int subtrees = static_cast<int>(factor_.subtrees.size());
    for_each_part(SharedWork::substitution, this->threads_, subtrees,
                  [&](int part) { kernels_.substitute_forward(factor_, factor_.subtrees[part], right_side); });
    for (const std::vector<int>& panel : factor_.panels) kernels_.substitute_forward(factor_, panel, right_side);
    for (auto panel = factor_.panels.rbegin(); panel != factor_.panels.rend(); ++panel) kernels_.substitute_back(factor_, *panel, x);
    for_each_part(SharedWork::substitution, this->threads_, subtrees,
                  [&](int part) { kernels_.substitute_back(factor_, factor_.subtrees[part], x); });
  }

  /// The factorisation is counted already, what the fronts needed on top of it is not.
  void count_help() {
    const LinearCounters& help = fronts_->counters();
    this->counters_.plain += help.plain - counted_.plain;
    this->counters_.krylov_iterations += help.krylov_iterations - counted_.krylov_iterations;
    counted_ = help;
  }

  void analyse(const BlockMatrix<N>& matrix) {
    ++this->counters_.symbolic;
    version_ = matrix.pattern_version();
    const int rows = matrix.rows();
    order_rows(matrix);

    // Entries above the diagonal, row by row in the new order; each row hands its pattern down to the first row it meets.
    std::vector<std::vector<int>> upper(rows), children(rows);
    std::vector<int> seen(rows, -1);
    for (int i = 0; i < rows; ++i) {
      std::vector<int>& row = upper[i];
      seen[i] = i;
      const auto take = [&](int j) {
        if (j <= i || seen[j] == i) return;
        seen[j] = i;
        row.push_back(j);
      };
      for (int s = matrix.row_start(factor_.order[i]); s < matrix.row_start(factor_.order[i] + 1); ++s) take(place_[matrix.column(s)]);
      for (int child : children[i]) std::for_each(upper[child].begin(), upper[child].end(), take);
      std::sort(row.begin(), row.end());
      if (!row.empty()) children[row.front()].push_back(i);
    }
    lay_out(upper);
    cut_into_subtrees();

    factor_.target.clear();
    factor_.target_start.clear();
    std::vector<int> place(rows);
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.row_start[i + 1]; ++s) place[factor_.column[s]] = s;
      factor_.target_start.push_back(static_cast<int>(factor_.target.size()));
      for (int s = matrix.row_start(factor_.order[i]); s < matrix.row_start(factor_.order[i] + 1); ++s)
        factor_.target.push_back(place[place_[matrix.column(s)]]);
    }
  }

  /// The connected parts of the pattern one after another, each ordered for itself: in what is not cut into subtrees none of its numbers depends on
  /// what else is in the system.
  void order_rows(const BlockMatrix<N>& matrix) {
    const int rows = matrix.rows();
    factor_.order.clear();
    place_.assign(rows, unplaced);
    for (int first = 0; first < rows; ++first) {
      if (place_[first] == unplaced) order_part(matrix, connected_rows(matrix, first));
    }
    for (int i = 0; i < rows; ++i) place_[factor_.order[i]] = i;
  }

  /// In ascending order; their places become those in the list.
  std::vector<int> connected_rows(const BlockMatrix<N>& matrix, int first) {
    std::vector<int> part = {first};
    place_[first] = 0;
    for (std::size_t next = 0; next < part.size(); ++next) {
      for (int s = matrix.row_start(part[next]); s < matrix.row_start(part[next] + 1); ++s) {
        const int neighbour = matrix.column(s);
        if (place_[neighbour] != unplaced) continue;
        place_[neighbour] = 0;
        part.push_back(neighbour);
      }
    }
    std::sort(part.begin(), part.end());
    for (std::size_t i = 0; i < part.size(); ++i) place_[part[i]] = static_cast<int>(i);
    return part;
  }

  void order_part(const BlockMatrix<N>& matrix, const std::vector<int>& part) {
    const int rows = static_cast<int>(part.size());
    if (rows <= 2) {  // no order fills more than another
      factor_.order.insert(factor_.order.end(), part.begin(), part.end());
      return;
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < rows; ++i) {
      for (int s = matrix.row_start(part[i]); s < matrix.row_start(part[i] + 1); ++s) entries.emplace_back(i, place_[matrix.column(s)], 1.0);
    }
    Eigen::SparseMatrix<double> graph(rows, rows);
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(graph, permutation);
    for (int i = 0; i < rows; ++i) factor_.order.push_back(part[permutation.indices()[i]]);
  }

  /// Rows of L, diagonal and U one after another in one array.
  void lay_out(const std::vector<std::vector<int>>& upper) {
    const int rows = static_cast<int>(upper.size());
    std::vector<std::vector<int>> lower(rows);
    for (int i = 0; i < rows; ++i) {
      for (int j : upper[i]) lower[j].push_back(i);
    }
    factor_.row_start.assign(1, 0);
    factor_.diagonal.clear();
    factor_.column.clear();
    factor_.same_as_next.clear();
    for (int i = 0; i < rows; ++i) {
      factor_.column.insert(factor_.column.end(), lower[i].begin(), lower[i].end());
      factor_.diagonal.push_back(static_cast<int>(factor_.column.size()));
      factor_.column.push_back(i);
      factor_.column.insert(factor_.column.end(), upper[i].begin(), upper[i].end());
      factor_.row_start.push_back(static_cast<int>(factor_.column.size()));
      factor_.same_as_next.push_back(!upper[i].empty() && upper[i].front() == i + 1 && upper[i].size() == upper[i + 1].size() + 1);
    }
    if (factor_.value.capacity() < factor_.column.size())
      std::vector<PaddedBlock<N>>().swap(factor_.value);  // else old and new one would be there at once
    factor_.value.resize(factor_.column.size());
    factor_.solution.resize(rows);
    factor_.size.resize(rows);
  }

  /// The row that is the first to subtract row i; -1 for a root.
  int parent(int i) const {
    const int next = factor_.diagonal[i] + 1;
    return next < factor_.row_start[i + 1] ? factor_.column[next] : -1;
  }

  /// Products of blocks in the elimination of row i and all below it in the tree.
  std::vector<double> work_of_subtrees() const {
    const int rows = factor_.rows();
    std::vector<double> work(rows, 0.0);
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.diagonal[i]; ++s)
        work[i] += factor_.row_start[factor_.column[s] + 1] - factor_.diagonal[factor_.column[s]];
      work[i] += 1.0;
      if (parent(i) >= 0) work[parent(i)] += work[i];
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
    for (int i = 0; i < rows; ++i) whole += parent(i) < 0 ? work[i] : 0.0;
    const double most = whole / subtrees_of_equal_work;
    std::vector<int> part_of(rows, in_top), roots;
    for (int i = 0; i < rows; ++i) {
      if (work[i] <= most && (parent(i) < 0 || work[parent(i)] > most)) roots.push_back(i);
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
      if (work[i] <= most && parent(i) >= 0 && work[parent(i)] <= most) part_of[i] = part_of[parent(i)];
    }
    return part_of;
  }

  static constexpr int unplaced = -1, in_top = -1;
  long version_ = -1;
  Kernels<N> kernels_;
  Factor<N> factor_;
  std::vector<std::vector<int>> working_place_;  ///< for each part: slot of a column in the row under work
  std::vector<int> place_;                       ///< in the factor, of a row of the matrix
  bool use_fronts_ = false;
  std::unique_ptr<LinearSolver<N>> fronts_;
  LinearCounters counted_;  ///< of the fronts
};

}  // namespace

template <int N>
std::unique_ptr<LinearSolver<N>> make_block_solver(bool wide_registers) {
  return std::make_unique<BlockLuSolver<N>>(wide_registers);
}

template std::unique_ptr<LinearSolver<3>> make_block_solver<3>(bool);

}  // namespace openclose
