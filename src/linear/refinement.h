// Solving with a factor that is not quite that of the matrix: GMRES with the factor as preconditioner, down to a stated residual.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "openclose/linear/block_matrix.h"
#include "openclose/linear/krylov.h"

namespace openclose {

/// What rounding leaves in the residual: units in the last place of the products in it.
template <int N>
double rounding_of_residual(const BlockMatrix<N>& matrix, const Eigen::VectorXd& x) {
  constexpr double rounding_units = 16.0;  // [-] so many units may meet in one residual
  double sum = 0.0;
  for (int i = 0; i < matrix.rows(); ++i) {
    double row = 0.0;
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) {
      row += matrix.value(s).norm() * x.segment<N>(N * matrix.column(s)).norm();
    }
    sum += row * row;
  }
  return rounding_units * std::numeric_limits<double>::epsilon() * std::sqrt(sum);
}

struct Refined {
  std::optional<Eigen::VectorXd> x;  ///< nothing if the residual is not brought down
  int iterations = 0;
};

/// \param factor     has solve(), about the inverse of the matrix
/// \param reduction  [-] of the Euclidean norm of the residual; rounding errors of the product of matrix and solution always pass
template <int N, class Factor>
Refined refine(const BlockMatrix<N>& matrix, const Factor& factor, const Eigen::VectorXd& right_side, double reduction, int most_iterations) {
  const double size = right_side.norm();
  Eigen::VectorXd x = factor.solve(right_side);
  if (!x.allFinite()) return {};
  Eigen::VectorXd residual = right_side - matrix.multiply(x);
  const double wanted = std::max(reduction * size, rounding_of_residual(matrix, x));
  if (residual.norm() > size) {  // worse than nothing
    x.setZero();
    residual = right_side;
  }
  const KrylovResult result = gmres([&](const Eigen::VectorXd& v) { return matrix.multiply(v); },
                                    [&](const Eigen::VectorXd& v) { return factor.solve(v); }, residual, x, wanted, most_iterations);
  if (!result.converged) return {{}, result.iterations};
  return {std::move(x), result.iterations};
}

}  // namespace openclose
