#include "openclose/linear/krylov.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <vector>

namespace openclose {
namespace {

/// After so many iterations, and this part of those allowed, the residuals tell how fast they fall.
constexpr int iterations_to_judge = 3;
constexpr double part_to_judge = 0.3;
/// [-] The residual may be this much larger than the rotations say, from rounding; beyond, the basis has lost its meaning.
constexpr double rounding_excess = 2.0;

bool too_slow(double start, double now, double wanted, int iterations, int most_iterations) {
  if (iterations < std::max<double>(iterations_to_judge, part_to_judge * most_iterations)) return false;
  if (!(now < start)) return true;
  return iterations * std::log(start / wanted) > most_iterations * std::log(start / now);
}

}  // namespace

KrylovResult gmres(const LinearMap& matrix, const LinearMap& preconditioner, Eigen::VectorXd& residual, Eigen::VectorXd& x, double wanted,
                   int most_iterations) {
  KrylovResult result;
  const double start = residual.norm();
  result.converged = start <= wanted;
  if (result.converged || !std::isfinite(start)) return result;

  std::vector<Eigen::VectorXd> basis{residual / start}, directions;
  std::vector<Eigen::JacobiRotation<double>> rotations;
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(most_iterations + 1, most_iterations);  // of the Hessenberg matrix, rotated
  Eigen::VectorXd right = Eigen::VectorXd::Zero(most_iterations + 1);
  right[0] = start;
  while (!result.converged && result.iterations < most_iterations) {
    const int k = result.iterations++;
    directions.push_back(preconditioner(basis[k]));
    Eigen::VectorXd next = matrix(directions[k]);
    for (int i = 0; i <= k; ++i) {
      upper(i, k) = basis[i].dot(next);
      next -= upper(i, k) * basis[i];
    }
    const double length = next.norm();
    upper(k + 1, k) = length;
    for (int i = 0; i < k; ++i) upper.col(k).applyOnTheLeft(i, i + 1, rotations[i].adjoint());
    rotations.emplace_back();
    rotations[k].makeGivens(upper(k, k), upper(k + 1, k));
    upper.col(k).applyOnTheLeft(k, k + 1, rotations[k].adjoint());
    right.applyOnTheLeft(k, k + 1, rotations[k].adjoint());
    const double now = std::abs(right[k + 1]);
    if (upper(k, k) == 0.0) return result;  // a singular matrix
    result.converged = now <= wanted;
    if (!(length > 0.0) || (!result.converged && too_slow(start, now, wanted, result.iterations, most_iterations))) break;
    basis.push_back(next / length);
  }
  const int used = result.iterations;
  if (!result.converged) return result;
  const Eigen::VectorXd part = upper.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(right.head(used));
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  for (int i = 0; i < used; ++i) step += part[i] * directions[i];
  const Eigen::VectorXd left = residual - matrix(step);
  result.converged = left.norm() <= rounding_excess * wanted;
  if (!result.converged) return result;
  x += step;
  residual = left;
  return result;
}

}  // namespace openclose
