// LU factorisation of a block matrix without exchange of blocks, on the fill that the pattern leaves after an approximate minimum degree ordering of
// the block graph (P. R. Amestoy, T. A. Davis, I. S. Duff 1996; Eigen's implementation).
//
// Row by row (Duff, Erisman, Reid, Direct methods for sparse matrices, 2017, chapter 10): row i of the matrix is spread out over a work row, the rows
// above are subtracted in ascending order, and what is left is gathered as row i of L and U. The pattern is symmetric, so that L has the transposed
// pattern of U. The diagonal blocks are inverted; nothing is exchanged between blocks, which is safe while each block is held by its own inertia and
// contacts: where a pivot has lost its digits, the factorisation is given to the plain solver, which exchanges rows.
#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "openclose/linear/solver.h"

namespace openclose {
namespace {

/// [-] A diagonal block whose norm has shrunk by more than this, or whose determinant is smaller than this times the product of its columns' norms, has
/// lost more digits than a Newton step can do without.
constexpr double smallest_pivot = 1e-11;

template <int N>
class BlockLuSolver : public LinearSolver<N> {
 public:
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
    Eigen::VectorXd y(right_side.size()), x(right_side.size());
    for (int i = 0; i < rows; ++i) {
      auto sum = right_side.segment<N>(N * order_[i]).eval();
      for (int s = row_start_[i]; s < diagonal_[i]; ++s) sum.noalias() -= value_[s] * y.segment<N>(N * column_[s]);
      y.segment<N>(N * i) = sum;
    }
    for (int i = rows - 1; i >= 0; --i) {
      auto sum = y.segment<N>(N * i).eval();
      for (int s = diagonal_[i] + 1; s < row_start_[i + 1]; ++s) sum.noalias() -= value_[s] * y.segment<N>(N * column_[s]);
      y.segment<N>(N * i) = value_[diagonal_[i]] * sum;
    }
    for (int i = 0; i < rows; ++i) x.segment<N>(N * order_[i]) = y.segment<N>(N * i);
    return x;
  }

 private:
  using Block = typename BlockMatrix<N>::Block;

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

    source_.clear();
    for (int i = 0; i < rows; ++i) {
      for (int s = matrix.row_start(order_[i]); s < matrix.row_start(order_[i] + 1); ++s) source_.push_back(place_[matrix.column(s)]);
    }
    work_.resize(rows);
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
  }

  /// False if a pivot has lost its digits.
  bool eliminate(const BlockMatrix<N>& matrix) {
    const int rows = matrix.rows();
    std::size_t next = 0;
    for (int i = 0; i < rows; ++i) {
      for (int s = row_start_[i]; s < row_start_[i + 1]; ++s) work_[column_[s]].setZero();
      const int original = order_[i];
      for (int s = matrix.row_start(original); s < matrix.row_start(original + 1); ++s) work_[source_[next++]] = matrix.value(s);
      const double size = work_[i].norm();
      for (int s = row_start_[i]; s < diagonal_[i]; ++s) {
        const int k = column_[s];
        value_[s].noalias() = work_[k] * value_[diagonal_[k]];
        for (int u = diagonal_[k] + 1; u < row_start_[k + 1]; ++u) work_[column_[u]].noalias() -= value_[s] * value_[u];
      }
      if (!invert(work_[i], size, value_[diagonal_[i]])) return false;
      for (int s = diagonal_[i] + 1; s < row_start_[i + 1]; ++s) value_[s] = work_[column_[s]];
    }
    return true;
  }

  static bool invert(const Block& pivot, double original_size, Block& inverse) {
    const double columns = pivot.colwise().norm().prod(), determinant = std::abs(pivot.determinant());
    if (!(pivot.norm() > smallest_pivot * original_size) || !(determinant > smallest_pivot * columns)) return false;
    inverse = pivot.inverse();
    return inverse.allFinite();
  }

  long version_ = -1;
  std::vector<int> order_, place_;     ///< row of the matrix at a place in the factor, and back
  std::vector<int> row_start_, diagonal_, column_;
  std::vector<int> source_;            ///< column in the factor of the matrix's entries, in the order in which elimination meets them
  std::vector<Block> value_;           ///< L, inverted diagonal, U
  std::vector<Block> work_;            ///< one row
  bool use_plain_ = false;
  std::unique_ptr<LinearSolver<N>> plain_;
};

}  // namespace

template <int N>
std::unique_ptr<LinearSolver<N>> make_block_solver() {
  return std::make_unique<BlockLuSolver<N>>();
}

template std::unique_ptr<LinearSolver<3>> make_block_solver<3>();

}  // namespace openclose
