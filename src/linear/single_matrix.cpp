#include "openclose/linear/single_matrix.h"

#include <algorithm>

#include "openclose/core/parallel.h"
#include "openclose/linear/packed_block.h"

namespace openclose {
namespace {

/// Of a product, about ten microseconds: more than it takes to hand them over.
constexpr int rows_of_a_part = 1000;

/// Of a matrix of blocks, row by row.
struct Rows {
  const float* values;
  const int *start, *columns;
};

/// A block times a part of a vector. The fourth number of a column is the next one's first, that of the last what comes after the block.
OPENCLOSE_KERNEL packed::FourDoubles product(const float* block, packed::FourDoubles x) {
  const auto column = [block](int k) { return packed::widened(packed::four(block + dofs * k)); };
  return (column(0) * x[0] + column(1) * x[1]) + column(2) * x[2];
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void multiply_rows(const Rows& rows, int first, int end, const float* x, float* y) {
  static_assert(dofs + 1 == numbers_of_row);
  const auto part = [x](int row) { return packed::widened(packed::four(x + static_cast<std::ptrdiff_t>(numbers_of_row) * row)); };
  const float* block = rows.values + static_cast<std::ptrdiff_t>(dofs * dofs) * rows.start[first];
  for (int i = first; i < end; ++i) {
    const packed::FourDoubles own = part(i);
    packed::FourDoubles sum = product(block, own);
    block += dofs * dofs;
    for (int s = rows.start[i] + 1; s < rows.start[i + 1]; ++s, block += dofs * dofs) sum += product(block, part(rows.columns[s]) - own);
    sum[dofs] = 0.0;
    packed::store(y + static_cast<std::ptrdiff_t>(numbers_of_row) * i, __builtin_convertvector(sum, packed::Four));
  }
}

}  // namespace

Eigen::VectorXf in_order(const Eigen::VectorXd& vector, double size, const std::vector<int>& order) {
  Eigen::VectorXf result(numbers_of_row * static_cast<Eigen::Index>(order.size()));
  const double scale = 1.0 / size;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double* const numbers = vector.data() + static_cast<std::ptrdiff_t>(dofs) * order[i];
    float* const row = result.data() + numbers_of_row * i;
    for (int k = 0; k < dofs; ++k) row[k] = static_cast<float>(scale * numbers[k]);
    row[dofs] = 0.0f;
  }
  return result;
}

void add_in_order(const Eigen::VectorXf& vector, double size, const std::vector<int>& order, Eigen::VectorXd& sum) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    const float* const row = vector.data() + numbers_of_row * i;
    double* const numbers = sum.data() + static_cast<std::ptrdiff_t>(dofs) * order[i];
    for (int k = 0; k < dofs; ++k) numbers[k] += size * static_cast<double>(row[k]);
  }
}

void SingleMatrix::plan(const BlockMatrix& matrix, const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
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
  const int all = static_cast<int>(row_start_.size()) - 1, parts = std::max(1, all / rows_of_a_part);
  const Rows rows{values_.data(), row_start_.data(), columns_.data()};
  for_each_part(SharedWork::product, threads_, parts, [&](int part) {
    const int first = part * rows_of_a_part, end = part + 1 < parts ? first + rows_of_a_part : all;
    multiply_rows(rows, first, end, x.data(), product.data());
  });
}

}  // namespace openclose
