// GMRES with a preconditioner on the right (Y. Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14 (1993)).
//
// Eigen's GMRES works on the preconditioned residual, which is not the one that Newton's method is to bring down, and goes on to its last iteration:
// here the caller learns from the residuals so far whether it is worth going on.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace openclose {

struct KrylovResult {
  bool converged = false;
  int iterations = 0;  ///< each is one product with the matrix and one with the preconditioner
};

/// [bytes] With right sides like this one: two vectors an iteration.
inline std::size_t bytes_of_basis(const Eigen::VectorXd& right_side, int iterations) {
  return 2 * sizeof(double) * static_cast<std::size_t>(iterations) * static_cast<std::size_t>(right_side.size());
}

using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Adds to x what brings the residual down to `wanted`. Gives up after `most_iterations`, and as soon as the residual falls too slowly to get there.
/// \param residual  right side minus matrix times x, on entry and on return (there to rounding: from the matrix's products with the basis)
/// \param wanted    Euclidean norm, in the unit of the residual
KrylovResult gmres(const LinearMap& matrix, const LinearMap& preconditioner, Eigen::VectorXd& residual, Eigen::VectorXd& x, double wanted,
                   int most_iterations);

}  // namespace openclose
