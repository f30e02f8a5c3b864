// A block matrix in single precision, for GMRES with an incomplete factor, which waits for memory: half of the bytes, its rows in the order of the
// factor, and vectors in which each block row is one register.
//
// Where blocks that move together stay far from their places, the large forces of their contacts cancel: sum_j A_ij x_j is small beside its terms.
// Its product is therefore (sum_j A_ij) x_i + sum_j A_ij (x_j - x_i), the sum of the blocks formed before they are rounded, and all of it is done in
// double precision on the numbers kept. With products in single precision GMRES on the matrices of 50,106 failing blocks took up to 60 iterations
// instead of 25.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "openclose/linear/block_matrix.h"

namespace openclose {

/// A vector over `size`, which makes its numbers fit, in the order of the rows, with batch_size numbers for each: its unknowns, and zero.
Eigen::VectorXf in_order(const Eigen::VectorXd& vector, double size, const std::vector<int>& order);
/// Adds `size` times a vector in the order of the rows.
void add_in_order(const Eigen::VectorXf& vector, double size, const std::vector<int>& order, Eigen::VectorXd& sum);

class SingleMatrix {
 public:
  /// Takes over the numbers.
  /// \param order  row of the matrix at each place; the same as long as the pattern is
  void take(const BlockMatrix& matrix, const std::vector<int>& order);

  void use_threads(int threads) { threads_ = threads; }  ///< for products; they are the same to the last bit
  void multiply(const Eigen::VectorXf& x, Eigen::VectorXf& product) const;
  std::size_t bytes() const { return bytes_of(row_start_, columns_, values_); }

 private:
  void plan(const BlockMatrix& matrix, const std::vector<int>& order);
  void multiply_rows(int first, int end, const float* x, float* y) const;

  long version_ = -1;
  int threads_ = 1;
  std::vector<int> row_start_, columns_;
  std::vector<float> values_;  ///< block by block, each column by column; of each row the sum of all comes first, in place of the diagonal
};

}  // namespace openclose
