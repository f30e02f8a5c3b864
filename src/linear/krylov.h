// GMRES with a preconditioner on the right (Y. Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14 (1993)).
//
// Eigen's GMRES works on the preconditioned residual, which is not the one that Newton's method is to bring down, and goes on to its last iteration:
// here the caller learns from the residuals so far whether it is worth going on.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

namespace openclose {

template <class Scalar>
using VectorOf = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
template <class Scalar>
using LinearMapOf = std::function<VectorOf<Scalar>(const VectorOf<Scalar>&)>;
using LinearMap = LinearMapOf<double>;

struct KrylovResult {
  bool converged = false;
  int iterations = 0;  ///< each is one product with the matrix and one with the preconditioner
};

/// [bytes] With right sides of so many numbers: two vectors an iteration.
template <class Scalar>
std::size_t bytes_of_basis(Eigen::Index size, int iterations) {
  return 2 * sizeof(Scalar) * static_cast<std::size_t>(iterations) * static_cast<std::size_t>(size);
}

template <class Scalar>
struct KrylovStep : KrylovResult {
  VectorOf<Scalar> step;  ///< none if it has not converged
};

/// What brings a residual down to `wanted`, as far as the rotations of the basis tell: rounding is for the caller to see. Gives up after
/// `most_iterations`, and as soon as the residual falls too slowly to get there. Sums are formed in double precision.
/// \param wanted  Euclidean norm, in the unit of the residual
template <class Scalar>
KrylovStep<Scalar> krylov_step(const LinearMapOf<Scalar>& matrix, const LinearMapOf<Scalar>& preconditioner, const VectorOf<Scalar>& residual,
                               double wanted, int most_iterations);

extern template KrylovStep<float> krylov_step<float>(const LinearMapOf<float>&, const LinearMapOf<float>&, const VectorOf<float>&, double, int);
extern template KrylovStep<double> krylov_step<double>(const LinearMapOf<double>&, const LinearMapOf<double>&, const VectorOf<double>&, double, int);

/// [-] The residual may be this much larger than the rotations say, from rounding; beyond, the basis has lost its meaning.
inline constexpr double rounding_excess = 2.0;

/// Adds to x what brings the residual down to `wanted`, all digits of it.
/// \param residual  right side minus matrix times x, on entry and on return (there to rounding: from the matrix's product with the step)
/// \param wanted    Euclidean norm, in the unit of the residual
KrylovResult gmres(const LinearMap& matrix, const LinearMap& preconditioner, Eigen::VectorXd& residual, Eigen::VectorXd& x, double wanted,
                   int most_iterations);

}  // namespace openclose
