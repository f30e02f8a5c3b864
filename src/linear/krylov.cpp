#include "openclose/linear/krylov.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <vector>

namespace openclose {
namespace {

/// Numbers of a vector that stay in the nearest cache while two things are done with them, and of which a sum in single precision is good enough.
constexpr Eigen::Index piece = 1024;

double product(const Eigen::VectorXf& a, const Eigen::VectorXf& b) {
  double sum = 0.0;
  for (Eigen::Index first = 0; first < a.size(); first += piece) {
    const Eigen::Index count = std::min(piece, a.size() - first);
    sum += static_cast<double>(a.segment(first, count).dot(b.segment(first, count)));
  }
  return sum;
}

/// Takes `part` of a direction from a vector. Returns the product of what is left with `other`, which may be that itself.
double subtract(Eigen::VectorXf& vector, double part, const Eigen::VectorXf& direction, const Eigen::VectorXf& other) {
  double sum = 0.0;
  for (Eigen::Index first = 0; first < vector.size(); first += piece) {
    const Eigen::Index count = std::min(piece, vector.size() - first);
    auto left = vector.segment(first, count);
    left -= static_cast<float>(part) * direction.segment(first, count);
    sum += static_cast<double>(left.dot(other.segment(first, count)));
  }
  return sum;
}

/// One of the vectors; makes it if it is not there yet.
Eigen::VectorXf& vector_of(std::vector<Eigen::VectorXf>& vectors, int number, Eigen::Index size) {
  if (static_cast<int>(vectors.size()) <= number) vectors.resize(number + 1);
  vectors[number].resize(size);
  return vectors[number];
}

}  // namespace

KrylovStep krylov_step(const MapInto& matrix, const MapInto& preconditioner, const Eigen::VectorXf& residual, double wanted, int most_iterations,
                       KrylovRoom& room) {
  KrylovStep result;
  const double start = std::sqrt(product(residual, residual));
  result.converged = start <= wanted;
  if (result.converged) result.step = Eigen::VectorXf::Zero(residual.size());
  if (result.converged || !std::isfinite(start)) return result;

  auto& [basis, directions] = room;
  std::vector<Eigen::JacobiRotation<double>> rotations;
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(most_iterations + 1, most_iterations);  // of the Hessenberg matrix, rotated
  Eigen::VectorXd right = Eigen::VectorXd::Zero(most_iterations + 1);
  right[0] = start;
  vector_of(basis, 0, residual.size()) = residual / static_cast<float>(start);
  while (!result.converged && result.iterations < most_iterations) {
    const int k = result.iterations++;
    Eigen::VectorXf& next = vector_of(basis, k + 1, residual.size());
    preconditioner(basis[k], vector_of(directions, k, residual.size()));
    matrix(directions[k], next);
    upper(0, k) = product(basis[0], next);
    for (int i = 0; i < k; ++i) upper(i + 1, k) = subtract(next, upper(i, k), basis[i], basis[i + 1]);
    const double length = std::sqrt(subtract(next, upper(k, k), basis[k], next));
    upper(k + 1, k) = length;
    for (int i = 0; i < k; ++i) upper.col(k).applyOnTheLeft(i, i + 1, rotations[i].adjoint());
    rotations.emplace_back();
    rotations[k].makeGivens(upper(k, k), upper(k + 1, k));
    upper.col(k).applyOnTheLeft(k, k + 1, rotations[k].adjoint());
    right.applyOnTheLeft(k, k + 1, rotations[k].adjoint());
    const double now = std::abs(right[k + 1]);
    if (upper(k, k) == 0.0) return result;  // a singular matrix
    result.converged = now <= wanted;
    if (result.converged || !(length > 0.0)) break;
    next /= static_cast<float>(length);
  }
  if (!result.converged) return result;
  const int used = result.iterations;
  const Eigen::VectorXd part = upper.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(right.head(used));
  result.step = static_cast<float>(part[0]) * directions[0];
  for (int i = 1; i < used; ++i) result.step += static_cast<float>(part[i]) * directions[i];
  return result;
}

}  // namespace openclose
