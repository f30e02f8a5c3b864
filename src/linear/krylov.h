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

/// From the first vector to the second, which has its size.
using MapInto = std::function<void(const Eigen::VectorXf&, Eigen::VectorXf&)>;

/// Room for the basis and what the preconditioner makes of it. Who keeps it spares large vectors their way to the system and back in every solve.
struct KrylovRoom {
  std::vector<Eigen::VectorXf> basis, directions;

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto* vectors : {&basis, &directions}) {
      for (const Eigen::VectorXf& vector : *vectors) sum += sizeof(float) * static_cast<std::size_t>(vector.size());
    }
    return sum;
  }
};

struct KrylovStep {
  bool converged = false;
  int iterations = 0;    ///< each is one product with the matrix and one with the preconditioner
  Eigen::VectorXf step;  ///< none if it has not converged
};

/// What brings a residual down to `wanted`, as far as the rotations of the basis tell: rounding is for the caller to see. Gives up after
/// `most_iterations`. Sums are formed in double precision.
/// \param wanted  Euclidean norm, in the unit of the residual
KrylovStep krylov_step(const MapInto& matrix, const MapInto& preconditioner, const Eigen::VectorXf& residual, double wanted, int most_iterations,
                       KrylovRoom& room);

}  // namespace openclose
