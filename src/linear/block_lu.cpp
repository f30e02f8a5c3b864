// LU factorisation of a block matrix without exchange of blocks, on the fill that the pattern leaves after an approximate minimum degree ordering of
// the block graph (P. R. Amestoy, T. A. Davis, I. S. Duff 1996; Eigen's implementation).
//
// Row by row (Duff, Erisman, Reid, Direct methods for sparse matrices, 2017, chapter 10): row i of the matrix is laid into the slots of row i of L
// and U, and the rows above are subtracted from it in ascending order. The pattern is symmetric, so that L has the transposed pattern of U. The
// diagonal blocks are inverted; nothing is exchanged between blocks, which is safe while each block is held by its own inertia and contacts: where a
// pivot has lost its digits, the factorisation is given to the plain solver, which exchanges rows.
#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "openclose/linear/solver.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define OPENCLOSE_HAS_WIDE_REGISTERS
#endif

namespace openclose {
namespace {

/// [-] A diagonal block whose norm has shrunk by more than this, or whose determinant is smaller than this times the product of its columns' norms,
/// has lost more digits than a Newton step can do without.
constexpr double smallest_pivot = 1e-11;

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

/// A row of blocks from which others are to be subtracted, and what is needed to find them.
template <int N>
struct Elimination {
  const int* row_start;
  const int* diagonal;
  const int* column;
  PaddedBlock<N>* value;
  int* place;  ///< working memory: slot of a column in the row under work
};

/// Subtracts from row i what the rows above it contribute. Each number is computed by the same operations in the same order however wide the
/// registers are, so that results do not depend on the processor.
template <int N>
[[gnu::always_inline]] inline void subtract_rows_above(const Elimination<N>& e, int i) {
  for (int s = e.row_start[i]; s < e.row_start[i + 1]; ++s) e.place[e.column[s]] = s;
  for (int s = e.row_start[i]; s < e.diagonal[i]; ++s) {
    const int k = e.column[s];
    const PaddedBlock<N> above = e.value[s], inverse = e.value[e.diagonal[k]];
    PaddedBlock<N> factor;
    for (int r = 0; r < N; ++r) {
      factor.row[r] = above.row[r][0] * inverse.row[0];
      for (int c = 1; c < N; ++c) factor.row[r] += above.row[r][c] * inverse.row[c];
    }
    e.value[s] = factor;
    double f[N][N];
    for (int r = 0; r < N; ++r) {
      for (int c = 0; c < N; ++c) f[r][c] = factor.row[r][c];
    }
    for (int u = e.diagonal[k] + 1; u < e.row_start[k + 1]; ++u) {
      const PaddedBlock<N>& right = e.value[u];
      PaddedBlock<N>& target = e.value[e.place[e.column[u]]];
      for (int r = 0; r < N; ++r) {
        Lanes sum = f[r][0] * right.row[0];
        for (int c = 1; c < N; ++c) sum += f[r][c] * right.row[c];
        target.row[r] -= sum;
      }
    }
  }
}

template <int N>
void subtract_with_any_registers(const Elimination<N>& e, int i) {
  subtract_rows_above(e, i);
}

#ifdef OPENCLOSE_HAS_WIDE_REGISTERS
template <int N>
[[gnu::target("avx2")]] void subtract_with_wide_registers(const Elimination<N>& e, int i) {
  subtract_rows_above(e, i);
}
#endif

/// The function for the registers of this processor.
template <int N>
auto choose_subtraction([[maybe_unused]] bool wide_registers) {
#ifdef OPENCLOSE_HAS_WIDE_REGISTERS
  if (wide_registers && __builtin_cpu_supports("avx2")) return &subtract_with_wide_registers<N>;
#endif
  return &subtract_with_any_registers<N>;
}

template <int N>
class BlockLuSolver : public LinearSolver<N> {
 public:
  explicit BlockLuSolver(bool wide_registers) : subtract_rows_above_(choose_subtraction<N>(wide_registers)) {}

  bool factor(const BlockMatrix<N>& matrix) override {
    if (version_ != matrix.pattern_version()) {
      analyse(matrix);
    } else {
      ++this->counters_.symbolic_skipped;
    }
    ++this->counters_.factorisations;
    use_plain_ = !eliminate(matrix);
    if (!use_plain_) return true;
    ++this->counters_.plain;
    if (!plain_) plain_ = make_sparse_solver<N>();
    return plain_->factor(matrix);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) override {
    ++this->counters_.solves;
    if (use_plain_) return plain_->solve(right_side);
    const int rows = static_cast<int>(row_start_.size()) - 1;
    for (int i = 0; i < rows; ++i) {
      double sum[N];
      for (int k = 0; k < N; ++k) sum[k] = right_side[N * order_[i] + k];
      subtract_product(row_start_[i], diagonal_[i], sum);
      for (int k = 0; k < N; ++k) solution_[i].entries[k] = sum[k];
    }
    Eigen::VectorXd x(right_side.size());
    for (int i = rows - 1; i >= 0; --i) {
      double sum[N];
      for (int k = 0; k < N; ++k) sum[k] = solution_[i].entries[k];
      subtract_product(diagonal_[i] + 1, row_start_[i + 1], sum);
      const PaddedBlock<N>& inverse = value_[diagonal_[i]];
      for (int k = 0; k < N; ++k) {
        double entry = inverse.row[k][0] * sum[0];
        for (int c = 1; c < N; ++c) entry += inverse.row[k][c] * sum[c];
        solution_[i].entries[k] = entry;
        x[N * order_[i] + k] = entry;
      }
    }
    return x;
  }

 private:
  using Block = typename BlockMatrix<N>::Block;

  /// Subtracts the sum over the slots of value times solution.
  void subtract_product(int begin, int end, double* sum) const {
    Lanes products[N]{};
    for (int s = begin; s < end; ++s) {
      const Lanes& x = solution_[column_[s]].entries;
      for (int r = 0; r < N; ++r) products[r] += value_[s].row[r] * x;
    }
    for (int r = 0; r < N; ++r) {
      for (int c = 0; c < N; ++c) sum[r] -= products[r][c];
    }
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
      for (int s = matrix.row_start(order_[i]); s < matrix.row_start(order_[i] + 1); ++s) take(place_[matrix.column(s)]);
      for (int child : children[i]) std::for_each(upper[child].begin(), upper[child].end(), take);
      std::sort(row.begin(), row.end());
      if (!row.empty()) children[row.front()].push_back(i);
    }
    lay_out(upper);

    target_.clear();
    for (int i = 0; i < rows; ++i) {
      for (int s = row_start_[i]; s < row_start_[i + 1]; ++s) working_place_[column_[s]] = s;
      for (int s = matrix.row_start(order_[i]); s < matrix.row_start(order_[i] + 1); ++s) target_.push_back(working_place_[place_[matrix.column(s)]]);
    }
  }

  void order_rows(const BlockMatrix<N>& matrix) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < matrix.rows(); ++i) {
      for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) entries.emplace_back(i, matrix.column(s), 1.0);
    }
    Eigen::SparseMatrix<double> graph(matrix.rows(), matrix.rows());
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(graph, permutation);
    order_.assign(permutation.indices().data(), permutation.indices().data() + matrix.rows());
    place_.resize(matrix.rows());
    for (int i = 0; i < matrix.rows(); ++i) place_[order_[i]] = i;
  }

  /// Rows of L, diagonal and U one after another in one array.
  void lay_out(const std::vector<std::vector<int>>& upper) {
    const int rows = static_cast<int>(upper.size());
    std::vector<std::vector<int>> lower(rows);
    for (int i = 0; i < rows; ++i) {
      for (int j : upper[i]) lower[j].push_back(i);
    }
    row_start_.assign(1, 0);
    diagonal_.clear();
    column_.clear();
    for (int i = 0; i < rows; ++i) {
      column_.insert(column_.end(), lower[i].begin(), lower[i].end());
      diagonal_.push_back(static_cast<int>(column_.size()));
      column_.push_back(i);
      column_.insert(column_.end(), upper[i].begin(), upper[i].end());
      row_start_.push_back(static_cast<int>(column_.size()));
    }
    value_.resize(column_.size());
    solution_.resize(rows);
    working_place_.resize(rows);
  }

  /// False if a pivot has lost its digits.
  bool eliminate(const BlockMatrix<N>& matrix) {
    const int rows = matrix.rows();
    const Elimination<N> elimination{row_start_.data(), diagonal_.data(), column_.data(), value_.data(), working_place_.data()};
    std::size_t next = 0;
    for (int i = 0; i < rows; ++i) {
      std::fill(value_.begin() + row_start_[i], value_.begin() + row_start_[i + 1], PaddedBlock<N>{});
      for (int s = matrix.row_start(order_[i]); s < matrix.row_start(order_[i] + 1); ++s) pad(matrix.value(s), value_[target_[next++]]);
      PaddedBlock<N>& pivot = value_[diagonal_[i]];
      const double size = square_norm(pivot);
      subtract_rows_above_(elimination, i);
      if (!invert(pivot, size)) return false;
    }
    return true;
  }

  static void pad(const Block& block, PaddedBlock<N>& padded) {
    for (int r = 0; r < N; ++r) {
      for (int c = 0; c < N; ++c) padded.row[r][c] = block(r, c);
    }
  }

  static double square_norm(const PaddedBlock<N>& block) {
    Lanes sum = block.row[0] * block.row[0];
    for (int r = 1; r < N; ++r) sum += block.row[r] * block.row[r];
    double total = sum[0];
    for (int c = 1; c < N; ++c) total += sum[c];
    return total;
  }

  /// Replaces the pivot by its inverse; false if it has none worth the name.
  /// \param original_size  square of the block's norm before the elimination
  static bool invert(PaddedBlock<N>& pivot, double original_size) {
    constexpr double square = smallest_pivot * smallest_pivot;
    Block block;
    for (int r = 0; r < N; ++r) {
      for (int c = 0; c < N; ++c) block(r, c) = pivot.row[r][c];
    }
    const double columns = block.colwise().squaredNorm().prod(), determinant = block.determinant();
    if (!(block.squaredNorm() > square * original_size) || !(determinant * determinant > square * columns)) return false;
    block = block.inverse().eval();
    pad(block, pivot);
    return block.allFinite();
  }

  long version_ = -1;
  std::vector<int> order_, place_;  ///< row of the matrix at a place in the factor, and back
  std::vector<int> row_start_, diagonal_, column_;
  std::vector<int> target_;             ///< slot in the factor of the matrix's entries, in the order in which elimination meets them
  std::vector<int> working_place_;      ///< slot of a column in the row under work
  std::vector<PaddedBlock<N>> value_;   ///< L, inverted diagonal, U
  std::vector<PaddedVector> solution_;  ///< a block row each, in the factor's order
  void (*subtract_rows_above_)(const Elimination<N>&, int);
  bool use_plain_ = false;
  std::unique_ptr<LinearSolver<N>> plain_;
};

}  // namespace

template <int N>
std::unique_ptr<LinearSolver<N>> make_block_solver(bool wide_registers) {
  return std::make_unique<BlockLuSolver<N>>(wide_registers);
}

template std::unique_ptr<LinearSolver<3>> make_block_solver<3>(bool);

}  // namespace openclose
