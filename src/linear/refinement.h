// Solving with a factor that is not quite that of the matrix: GMRES with the factor as preconditioner, down to a stated residual.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "openclose/linear/block_matrix.h"
#include "openclose/linear/krylov.h"

namespace openclose {

/// What rounding leaves in the residual: units in the last place of the products in it.
inline double rounding_of_residual(const BlockMatrix& matrix, const Eigen::VectorXd& x) {
  constexpr double rounding_units = 16.0;  // [-] so many units may meet in one residual
  double sum = 0.0;
  for (int i = 0; i < matrix.rows(); ++i) {
    double row = 0.0;
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) {
      row += matrix.value(s).norm() * x.segment<dofs>(dofs * matrix.column(s)).norm();
    }
    sum += row * row;
  }
  return rounding_units * std::numeric_limits<double>::epsilon() * std::sqrt(sum);
}

struct Refined {
  std::optional<Eigen::VectorXd> x;  ///< nothing if the residual is not brought down
  int iterations = 0;
};

/// [-] Rounding leaves less than this in a residual as long as the matrix is not singular to half of all digits.
inline constexpr double above_rounding = 1e-8;

/// \param factor     has solve(), about the inverse of the matrix
/// \param x          what to start from; of size 0: nothing
/// \param reduction  [-] of the Euclidean norm of the residual; rounding errors of the product of matrix and solution always pass
template <class Factor>
Refined refine(const BlockMatrix& matrix, const Factor& factor, const Eigen::VectorXd& right_side, Eigen::VectorXd x, double reduction,
               int most_iterations) {
  if (!x.allFinite()) return {};
  const double size = right_side.norm();
  double wanted = reduction * size;
  Eigen::VectorXd residual = right_side;
  if (x.size() > 0) {
    residual -= matrix.multiply(x);
    if (reduction < above_rounding) wanted = std::max(wanted, rounding_of_residual(matrix, x));
  }
  if (x.size() == 0 || residual.norm() > size) {  // worse than nothing
    x.setZero(right_side.size());
    residual = right_side;
  }
  const KrylovResult result = gmres([&](const Eigen::VectorXd& v) { return matrix.multiply(v); },
                                    [&](const Eigen::VectorXd& v) { return factor.solve(v); }, residual, x, wanted, most_iterations);
  if (!result.converged) return {{}, result.iterations};
  return {std::move(x), result.iterations};
}

}  // namespace openclose
