// GMRES with a preconditioner on the right (Y. Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14 (1993)).
//
// Eigen's GMRES works on the preconditioned residual, which is not the one that Newton's method is to bring down, and goes on to its last iteration:
// here the caller learns from the residuals so far whether it is worth going on.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace openclose {

template <class Scalar>
using VectorOf = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
/// From the first vector to the second, which has its size.
template <class Scalar>
using MapInto = std::function<void(const VectorOf<Scalar>&, VectorOf<Scalar>&)>;
using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Room for the basis and what the preconditioner makes of it. Who keeps it spares large vectors their way to the system and back in every solve.
template <class Scalar>
struct KrylovRoom {
  std::vector<VectorOf<Scalar>> basis, directions;

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto* vectors : {&basis, &directions}) {
      for (const VectorOf<Scalar>& vector : *vectors) sum += sizeof(Scalar) * static_cast<std::size_t>(vector.size());
    }
    return sum;
  }
};

struct KrylovResult {
  bool converged = false;
  int iterations = 0;  ///< each is one product with the matrix and one with the preconditioner
};

template <class Scalar>
struct KrylovStep : KrylovResult {
  VectorOf<Scalar> step;  ///< none if it has not converged
};

/// [bytes] With right sides like this one: two vectors an iteration.
inline std::size_t bytes_of_basis(const Eigen::VectorXd& right_side, int iterations) {
  return 2 * sizeof(double) * static_cast<std::size_t>(iterations) * static_cast<std::size_t>(right_side.size());
}

/// What brings a residual down to `wanted`, as far as the rotations of the basis tell: rounding is for the caller to see. Gives up after
/// `most_iterations`, and as soon as the residual falls too slowly to get there. Sums are formed in double precision. For float and double.
/// \param wanted  Euclidean norm, in the unit of the residual
template <class Scalar>
KrylovStep<Scalar> krylov_step(const MapInto<Scalar>& matrix, const MapInto<Scalar>& preconditioner, const VectorOf<Scalar>& residual, double wanted,
                               int most_iterations, KrylovRoom<Scalar>& room);

/// [-] The residual may be this much larger than the rotations say, from rounding; beyond, the basis has lost its meaning.
inline constexpr double rounding_excess = 2.0;

/// Adds to x what brings the residual down to `wanted`, all digits of it.
/// \param residual  right side minus matrix times x, on entry and on return (there to rounding: from the matrix's product with the step)
/// \param wanted    Euclidean norm, in the unit of the residual
KrylovResult gmres(const LinearMap& matrix, const LinearMap& preconditioner, Eigen::VectorXd& residual, Eigen::VectorXd& x, double wanted,
                   int most_iterations);

}  // namespace openclose
