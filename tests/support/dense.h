// A matrix of blocks with its zeros, to compare with.
#pragma once

#include <Eigen/Core>

#include "openclose/linear/block_matrix.h"

namespace openclose::test {

inline Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(matrix.unknowns(), matrix.unknowns());
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) all.block<dofs, dofs>(dofs * i, dofs * matrix.column(s)) = matrix.value(s);
  }
  return all;
}

}  // namespace openclose::test
