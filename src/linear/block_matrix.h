// Sparse matrix of small dense blocks, three unknowns each, on a pattern given by the pairs of blocks that may touch. Both triangles are stored,
// because sliding contacts make the tangent non-symmetric.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "openclose/core/memory.h"
#include "openclose/core/vector.h"

namespace openclose {

class BlockMatrix {
 public:
  using Block = Eigen::Matrix<double, dofs, dofs>;

  /// \param couplings  pairs of different block rows, in any order, repetitions allowed; the diagonal is always there
  void set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings);

  int rows() const { return static_cast<int>(row_start_.size()) - 1; }
  int unknowns() const { return dofs * rows(); }
  std::vector<std::pair<int, int>> couplings() const;        ///< with which set_pattern() makes this pattern
  long pattern_version() const { return pattern_version_; }  ///< changes with every new pattern, differs between matrices
  void renew_version();                                      ///< lets the pattern pass for a new one

  int find(int row, int column) const;  ///< slot of the pair, -1 if not in the pattern
  /// Whether this is the slot of the pair.
  bool is_at(int slot, int row, int column) const { return slot >= row_start_[row] && slot < row_start_[row + 1] && columns_[slot] == column; }
  int diagonal(int row) const { return diagonal_[row]; }  ///< slot
  /// A slot after all others, which nothing reads: for what belongs to no row.
  int nobody() const { return static_cast<int>(columns_.size()); }

  void set_zero();
  /// Throws std::logic_error if the pair is not in the pattern.
  void add(int row, int column, const Block& value) { values_[slot(row, column)] += value; }

  /// Takes unknown k of a row out of the system: its row and column become those of the unit matrix.
  void eliminate(int row, int k);

  int row_start(int row) const { return row_start_[row]; }
  int column(int slot) const { return columns_[slot]; }
  const Block& value(int slot) const { return values_[slot]; }
  Block& value(int slot) { return values_[slot]; }  ///< slots stand as long as the pattern

  void use_threads(int threads) { threads_ = threads; }  ///< for products; they are the same to the last bit
  Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;
  std::size_t bytes() const { return bytes_of(row_start_, columns_, diagonal_, values_); }

 private:
  int slot(int row, int column) const;
  void multiply_rows(int first, int end, const double* x, double* y) const;

  long pattern_version_ = 0;
  int threads_ = 1;
  std::vector<int> row_start_{0};
  std::vector<int> columns_;
  std::vector<int> diagonal_;
  std::vector<Block, Eigen::aligned_allocator<Block>> values_;
};

}  // namespace openclose
