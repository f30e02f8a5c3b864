#include "openclose/linear/single_matrix.h"

#include "openclose/core/parallel.h"
#include "openclose/linear/factor_plan.h"
#include "openclose/linear/packed_block.h"

namespace openclose {
namespace {

/// A block times a part of a vector. The fourth number of a column is the next one's first, that of the last what comes after the block.
OPENCLOSE_KERNEL Lanes product(const float* block, Lanes x) {
  const auto column = [block](int k) { return packed::widened(packed::four(block + dofs * k)); };
  return (column(0) * x[0] + column(1) * x[1]) + column(2) * x[2];
}

}  // namespace

Eigen::VectorXf in_order(const Eigen::VectorXd& vector, double size, const std::vector<int>& order) {
  Eigen::VectorXf result(batch_size * static_cast<Eigen::Index>(order.size()));
  const double scale = 1.0 / size;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double* const numbers = vector.data() + static_cast<std::ptrdiff_t>(dofs) * order[i];
    float* const row = result.data() + batch_size * i;
    for (int k = 0; k < dofs; ++k) row[k] = static_cast<float>(scale * numbers[k]);
    row[dofs] = 0.0f;
  }
  return result;
}

void add_in_order(const Eigen::VectorXf& vector, double size, const std::vector<int>& order, Eigen::VectorXd& sum) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    const float* const row = vector.data() + batch_size * i;
    double* const numbers = sum.data() + static_cast<std::ptrdiff_t>(dofs) * order[i];
    for (int k = 0; k < dofs; ++k) numbers[k] += size * static_cast<double>(row[k]);
  }
}

void SingleMatrix::plan(const BlockMatrix& matrix, const std::vector<int>& order) {
  const std::vector<int> place = places_in(order);
  row_start_.assign(1, 0);
  columns_.clear();
  for (int i = 0; i < matrix.rows(); ++i) {
    columns_.push_back(i);
    for (int s = matrix.row_start(order[i]); s < matrix.row_start(order[i] + 1); ++s) {
      if (s != matrix.diagonal(order[i])) columns_.push_back(place[matrix.column(s)]);
    }
    row_start_.push_back(static_cast<int>(columns_.size()));
  }
  values_.assign(static_cast<std::size_t>(dofs * dofs) * columns_.size() + 1, 0.0f);
  version_ = matrix.pattern_version();
}

void SingleMatrix::take(const BlockMatrix& matrix, const std::vector<int>& order) {
  if (version_ != matrix.pattern_version()) plan(matrix, order);
  const auto put = [](const BlockMatrix::Block& block, float* to) {
    for (int k = 0; k < dofs * dofs; ++k) to[k] = static_cast<float>(block.data()[k]);
  };
  float* to = values_.data();
  for (const int row : order) {
    BlockMatrix::Block sum = matrix.value(matrix.diagonal(row));
    float* const of_sum = to;
    for (int s = matrix.row_start(row); s < matrix.row_start(row + 1); ++s) {
      if (s == matrix.diagonal(row)) continue;
      put(matrix.value(s), to += dofs * dofs);
      sum += matrix.value(s);
    }
    put(sum, of_sum);
    to += dofs * dofs;
  }
}

void SingleMatrix::multiply(const Eigen::VectorXf& x, Eigen::VectorXf& product) const {
  for_each_range(SharedWork::product, threads_, static_cast<int>(row_start_.size()) - 1,
                 [&](int first, int end) { multiply_rows(first, end, x.data(), product.data()); });
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void SingleMatrix::multiply_rows(int first, int end, const float* x, float* y) const {
  static_assert(dofs + 1 == batch_size);
  const auto part = [x](int row) { return packed::widened(packed::four(x + static_cast<std::ptrdiff_t>(batch_size) * row)); };
  const float* block = values_.data() + static_cast<std::ptrdiff_t>(dofs * dofs) * row_start_[first];
  for (int i = first; i < end; ++i) {
    const Lanes own = part(i);
    Lanes sum = product(block, own);
    block += dofs * dofs;
    for (int s = row_start_[i] + 1; s < row_start_[i + 1]; ++s, block += dofs * dofs) sum += product(block, part(columns_[s]) - own);
    sum[dofs] = 0.0;
    packed::store(y + static_cast<std::ptrdiff_t>(batch_size) * i, __builtin_convertvector(sum, FloatLanes));
  }
}

}  // namespace openclose
