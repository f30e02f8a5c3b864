#include "openclose/linear/block_matrix.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <stdexcept>

#include "openclose/core/lane_memory.h"
#include "openclose/core/parallel.h"

namespace openclose {
namespace {

/// Sum of the products of a row's blocks with x, column by column of each: the operations of Eigen in their order, three rows at a time.
OPENCLOSE_KERNEL void multiply_row(const double* block, const int* column, int count, const double* x, double* y) {
  Lanes sum{};
  for (int s = 0; s < count; ++s, block += dofs * dofs) {
    const double* const part = x + dofs * column[s];
    const Lanes last = lanes::load(block + 2 * dofs - 1);
    sum += (lanes::load(block) * part[0] + lanes::load(block + dofs) * part[1]) + __builtin_shufflevector(last, last, 1, 2, 3, 3) * part[2];
  }
  for (int k = 0; k < dofs; ++k) y[k] = sum[k];
}

}  // namespace

void BlockMatrix::set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings) {
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
  values_.assign(columns_.size() + 1, Block::Zero());
  renew_version();
}

void BlockMatrix::renew_version() {
  static std::atomic<long> latest{0};  // over all matrices, so that a solver can tell them apart
  pattern_version_ = ++latest;
}

std::vector<std::pair<int, int>> BlockMatrix::couplings() const {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < rows(); ++i) {
    for (int s = row_start_[i]; s < row_start_[i + 1]; ++s) {
      if (columns_[s] > i) pairs.emplace_back(i, columns_[s]);
    }
  }
  return pairs;
}

void BlockMatrix::set_zero() {
  for (Block& v : values_) v.setZero();
}

int BlockMatrix::find(int row, int column) const {
  const auto begin = columns_.begin() + row_start_[row], end = columns_.begin() + row_start_[row + 1];
  const auto it = std::lower_bound(begin, end, column);
  return it == end || *it != column ? -1 : static_cast<int>(it - columns_.begin());
}

int BlockMatrix::slot(int row, int column) const {
  const int s = find(row, column);
  if (s < 0) throw std::logic_error("BlockMatrix: entry outside the pattern");
  return s;
}

void BlockMatrix::eliminate(int row, int k) {
  for (int s = row_start_[row]; s < row_start_[row + 1]; ++s) {
    values_[s].row(k).setZero();
    values_[slot(columns_[s], row)].col(k).setZero();
  }
  values_[slot(row, row)](k, k) = 1.0;
}

Eigen::VectorXd BlockMatrix::multiply(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(unknowns());
  for_each_range(SharedWork::product, threads_, rows(), [&](int first, int end) { multiply_rows(first, end, x.data(), y.data()); });
  return y;
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void BlockMatrix::multiply_rows(int first, int end, const double* x, double* y) const {
  for (int i = first; i < end; ++i) {
    const int begin = row_start_[i];
    multiply_row(values_[begin].data(), columns_.data() + begin, row_start_[i + 1] - begin, x, y + dofs * i);
  }
}

}  // namespace openclose
