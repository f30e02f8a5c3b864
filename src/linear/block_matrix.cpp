#include "openclose/linear/block_matrix.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <stdexcept>

namespace openclose {

template <int N>
void BlockMatrix<N>::set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings) {
  // Rows one after another with room for repetitions, then each in order.
  std::vector<int> begin(rows + 1, 0), end(rows);
  const auto count = [&](int i) { ++begin[i + 1]; };
  for (int i = 0; i < rows; ++i) count(i);
  for (const auto& [i, j] : couplings) {
    count(i);
    count(j);
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  columns_.resize(begin[rows]);
  std::copy(begin.begin(), begin.end() - 1, end.begin());
  const auto put = [&](int i, int j) { columns_[end[i]++] = j; };
  for (int i = 0; i < rows; ++i) put(i, i);
  for (const auto& [i, j] : couplings) {
    put(i, j);
    put(j, i);
  }
  row_start_.assign(rows + 1, 0);
  auto last = columns_.begin();
  for (int i = 0; i < rows; ++i) {
    const auto first = columns_.begin() + begin[i];
    std::sort(first, columns_.begin() + end[i]);
    last = std::copy(first, std::unique(first, columns_.begin() + end[i]), last);
    row_start_[i + 1] = static_cast<int>(last - columns_.begin());
  }
  columns_.erase(last, columns_.end());
  diagonal_.resize(rows);
  for (int i = 0; i < rows; ++i) diagonal_[i] = find(i, i);
  values_.assign(columns_.size(), Block::Zero());
  renew_version();
}

template <int N>
void BlockMatrix<N>::renew_version() {
  static std::atomic<long> latest{0};  // over all matrices, so that a solver can tell them apart
  pattern_version_ = ++latest;
}

template <int N>
std::vector<std::pair<int, int>> BlockMatrix<N>::couplings() const {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < rows(); ++i) {
    for (int s = row_start_[i]; s < row_start_[i + 1]; ++s) {
      if (columns_[s] > i) pairs.emplace_back(i, columns_[s]);
    }
  }
  return pairs;
}

template <int N>
void BlockMatrix<N>::set_zero() {
  for (Block& v : values_) v.setZero();
}

template <int N>
int BlockMatrix<N>::find(int row, int column) const {
  const auto begin = columns_.begin() + row_start_[row], end = columns_.begin() + row_start_[row + 1];
  const auto it = std::lower_bound(begin, end, column);
  return it == end || *it != column ? -1 : static_cast<int>(it - columns_.begin());
}

template <int N>
int BlockMatrix<N>::slot(int row, int column) const {
  const int s = find(row, column);
  if (s < 0) throw std::logic_error("BlockMatrix: entry outside the pattern");
  return s;
}

template <int N>
void BlockMatrix<N>::eliminate(int row, int k) {
  for (int s = row_start_[row]; s < row_start_[row + 1]; ++s) {
    values_[s].row(k).setZero();
    values_[slot(columns_[s], row)].col(k).setZero();
  }
  values_[slot(row, row)](k, k) = 1.0;
}

template <int N>
Eigen::VectorXd BlockMatrix<N>::multiply(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(unknowns());
  for (int i = 0; i < rows(); ++i) {
    for (int s = row_start_[i]; s < row_start_[i + 1]; ++s) y.segment<N>(N * i) += values_[s] * x.segment<N>(N * columns_[s]);
  }
  return y;
}

template <int N>
Eigen::MatrixXd BlockMatrix<N>::dense() const {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(unknowns(), unknowns());
  for (int i = 0; i < rows(); ++i) {
    for (int s = row_start_[i]; s < row_start_[i + 1]; ++s) a.block<N, N>(N * i, N * columns_[s]) = values_[s];
  }
  return a;
}

template class BlockMatrix<3>;

}  // namespace openclose
